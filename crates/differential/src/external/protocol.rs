//! The line protocol: one JSON object a line, question and answer (docs/engines.md).

use crate::answer_detail::AnswerDetail;
use crate::engine::{Answer, EngineFailure};
use crate::external::watched_json::WatchedJson;
use crate::separation_state::{ReportedState, SeparationState};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{
    Block, Contact, ContactKey, ContactKind, EdgeId, Entrance, EntranceKind, Sign, ToleranceSet, Topology, VertexId,
};
use serde_json::{Map, Value, json};

/// The feature number that stands for an entrance an engine did not name. Exchanging the blocks or numbering them
/// otherwise leaves it as it is.
pub(crate) const UNNAMED: Entrance = Entrance::EdgeEdge(EdgeId(u32::MAX), EdgeId(u32::MAX));

/// The part of a question that the tolerances do not change: `"a":{…},"b":{…}`.
pub fn blocks_text(a: &Block, b: &Block) -> String {
    format!("\"a\":{},\"b\":{}", block(a), block(b))
}

fn block(block: &Block) -> Value {
    let topology = block.topology();
    let vertices: Vec<[f64; 3]> = block.vertices().iter().map(|v| v.components().map(|c| c.approximate())).collect();
    let numbered = topology.edges().iter().zip(topology.edge_ids());
    let reflex: Vec<[VertexId; 2]> =
        numbered.filter(|(_, number)| !block.edge_is_convex(*number)).map(|(e, _)| [e.p, e.q]).collect();
    json!({ "vertices": vertices, "faces": topology.faces(), "reflex": reflex })
}

/// The question with the given number about two blocks, as [`blocks_text`] wrote them, and rounded tolerances.
pub fn question(id: u64, blocks: &str, tolerances: &ToleranceSet) -> String {
    let mut named: Map<String, Value> =
        tolerances.numbers().into_iter().map(|(name, value)| (name.to_owned(), value.approximate().into())).collect();
    named.insert("criteria".to_owned(), tolerances.criteria.name().into());
    format!("{{\"id\":{id},{blocks},\"tolerances\":{}}}", Value::Object(named))
}

/// The answer in a line to the question `id` about two blocks of the given topologies.
///
/// # Errors
/// [`EngineFailure::Unsupported`] as the engine says, [`EngineFailure::Malformed`] with what is wrong with the line.
pub fn answer(line: &[u8], id: u64, features: [&Topology; 2]) -> Result<Answer, EngineFailure> {
    detailed_answer(line, id, features).0
}

/// The same, with how much it says of contacts and states: nothing where it is no answer.
pub(super) fn detailed_answer(
    line: &[u8],
    id: u64,
    features: [&Topology; 2],
) -> (Result<Answer, EngineFailure>, AnswerDetail) {
    match read(line, id, features) {
        Ok((answer, detail)) => (Ok(answer), detail),
        Err(fault) => {
            let failure = match fault {
                ProtocolError::Unsupported(why) => EngineFailure::Unsupported(excerpt(&why, EXCERPT_LENGTH)),
                ProtocolError::Malformed(what) => EngineFailure::Malformed(format!(
                    "{}; the line was {}",
                    excerpt(&what, EXCERPT_LENGTH),
                    quoted(line)
                )),
            };
            (Err(failure), AnswerDetail::default())
        }
    }
}

/// Whether a line answers a question that was asked before the question `id`.
pub(super) fn is_of_earlier(line: &[u8], id: u64) -> bool {
    let value = serde_json::from_slice::<Value>(line).ok();
    value.and_then(|value| value.get("id")?.as_u64()).is_some_and(|found| found < id)
}

enum ProtocolError {
    Unsupported(String),
    Malformed(String),
}

impl From<String> for ProtocolError {
    fn from(what: String) -> ProtocolError {
        ProtocolError::Malformed(what)
    }
}

/// The start of a line, for messages.
pub(super) fn quoted(line: &[u8]) -> String {
    const EXCERPT_LENGTH: usize = 120;
    let text = String::from_utf8_lossy(line);
    let start: String = text.chars().take(EXCERPT_LENGTH).collect();
    let rest = if text.chars().nth(EXCERPT_LENGTH).is_some() { " …" } else { "" };
    format!("{start:?}{rest}")
}

/// Where a line is no JSON. What C and C++ print for numbers that are none is the usual reason.
fn not_json(line: &[u8], error: &serde_json::Error) -> String {
    let (at, around) = (error.column().saturating_sub(1).min(line.len()), 12);
    let place = &line[at.saturating_sub(around)..(at + around).min(line.len())];
    let hint = if is_no_number(word_at(line, at)) {
        "; JSON has no NaN and no infinity: where a gap is none, leave its key out"
    } else {
        ""
    };
    format!("not JSON ({error}: …{}…{hint})", String::from_utf8_lossy(place).escape_debug())
}

/// The word that a place is in or just behind, with its sign.
fn word_at(line: &[u8], at: usize) -> &[u8] {
    let is_of_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-._\"".contains(byte);
    let start = line[..at].iter().rposition(|byte| !is_of_word(byte)).map_or(0, |before| before + 1);
    let end = line[at..].iter().position(|byte| !is_of_word(byte)).map_or(line.len(), |length| at + length);
    &line[start..end]
}

/// Whether a word is NaN or an infinity, as C and C++ print them.
fn is_no_number(word: &[u8]) -> bool {
    let word = word.strip_prefix(b"-").unwrap_or(word);
    ["nan", "inf", "infinity"].iter().any(|name| word.eq_ignore_ascii_case(name.as_bytes()))
}

fn read(line: &[u8], id: u64, features: [&Topology; 2]) -> Result<(Answer, AnswerDetail), ProtocolError> {
    let WatchedJson { value, repeated } = serde_json::from_slice(line).map_err(|error| not_json(line, &error))?;
    if let Some(key) = repeated {
        return Err(format!("the key {key:?} is there twice in one object").into());
    }
    let Value::Object(object) = value else {
        return Err(format!("expected an object, found {}", kind_of(&value)).into());
    };
    match object.get("id") {
        Some(Value::Number(found)) if found.as_u64() == Some(id) => {}
        Some(found) => return Err(format!("id is {found}; the question's is {id}").into()),
        None => return Err(format!("there is no id; the question's is {id}").into()),
    }
    let (contacts, state, unsupported) = (object.get("contacts"), object.get("state"), object.get("unsupported"));
    match (contacts, state, unsupported) {
        (Some(contacts), None, None) => {
            let (contacts, detail) = read_contacts(contacts, features)?;
            Ok((Answer::Contacts(contacts), detail))
        }
        (None, Some(state), None) => {
            let said = read_state(state, &object)?;
            Ok((Answer::State(said), AnswerDetail::of_state(&said)))
        }
        (None, None, Some(Value::String(why))) => Err(ProtocolError::Unsupported(why.clone())),
        (None, None, Some(other)) => Err(format!("unsupported is {}; expected a text", kind_of(other)).into()),
        _ => {
            let given = [("contacts", contacts), ("state", state), ("unsupported", unsupported)];
            let given: Vec<&str> = given.iter().filter(|(_, value)| value.is_some()).map(|(name, _)| *name).collect();
            let found = match given.len() {
                0 => "none is there".to_owned(),
                _ => format!("given are {}", given.join(" and ")),
            };
            Err(format!("expected one of contacts, state, unsupported; {found}").into())
        }
    }
}

fn kind_of(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

fn read_state(state: &Value, object: &Map<String, Value>) -> Result<ReportedState, String> {
    let allowed = || SeparationState::ALL.map(SeparationState::name).join(", ");
    let state = state
        .as_str()
        .and_then(SeparationState::from_name)
        .ok_or_else(|| format!("state is {state}; allowed are {}", allowed()))?;
    let number = |value: &Value, name: &str| {
        value.as_f64().ok_or_else(|| format!("{name} holds {}; expected a number", kind_of(value)))
    };
    let gap_m = object.get("gap_m").map(|gap| number(gap, "gap_m")).transpose()?;
    let normal = object.get("normal").map(|normal| {
        let list = normal.as_array().filter(|list| list.len() == 3);
        let list = list.ok_or_else(|| format!("normal is {}; expected a list of 3 numbers", kind_of(normal)))?;
        let [x, y, z] = [0, 1, 2].map(|axis| number(&list[axis], "normal"));
        Ok::<_, String>([x?, y?, z?])
    });
    Ok(ReportedState { state, gap_m, normal: normal.transpose()? })
}

fn read_contacts(contacts: &Value, features: [&Topology; 2]) -> Result<(Vec<Contact>, AnswerDetail), String> {
    let list = contacts.as_array().ok_or_else(|| format!("contacts is {}; expected a list", kind_of(contacts)))?;
    let mut read = Vec::with_capacity(list.len());
    for (number, contact) in list.iter().enumerate() {
        read.push(read_contact(contact, features).map_err(|what| format!("contact {number}: {what}"))?);
    }
    read.sort_unstable();
    if let Some(twice) = read.windows(2).find(|two| two[0].key == two[1].key) {
        let (kind, [a, b]) = (twice[0].kind(), twice[0].key.numbers());
        return Err(format!("contact {kind} ({a}, {b}) is there twice"));
    }
    let count = |is: &dyn Fn(usize) -> bool| (0..list.len()).filter(|&at| is(at)).count() as u64;
    let detail = AnswerDetail {
        contacts: list.len() as u64,
        entrances: count(&|at| read[at].entrance != UNNAMED),
        gap_m: count(&|at| list[at].get("gap_m").is_some()),
        contact_answers: 1,
        ..AnswerDetail::default()
    };
    Ok((read, detail))
}

/// The kinds of feature a contact or entrance names, in A and in B.
type Names = [&'static str; 2];

fn read_contact(contact: &Value, features: [&Topology; 2]) -> Result<Contact, String> {
    let object = contact.as_object().ok_or_else(|| format!("expected an object, found {}", kind_of(contact)))?;
    let name = |key: &str| object.get(key).and_then(Value::as_str);
    let kinds = || ContactKind::ALL.map(ContactKind::name).join(", ");
    let kind = name("kind")
        .and_then(ContactKind::from_name)
        .ok_or_else(|| format!("kind is {}; allowed are {}", shown(object.get("kind")), kinds()))?;
    let numbers = |keys: [&str; 2], names: Names| {
        let number = |at: usize| {
            let (key, count) = (keys[at], count(features[at], names[at]));
            let found = object.get(key).and_then(Value::as_u64).and_then(|n| u32::try_from(n).ok());
            let pointed = object.get(key).is_some_and(Value::is_f64);
            let written = if pointed { ", written without a point or an exponent" } else { "" };
            let allowed = || format!("allowed are 0 to {}{written}, the block's {}", count - 1, plural(names[at]));
            found.filter(|n| *n < count).ok_or_else(|| format!("{key} is {}; {}", shown(object.get(key)), allowed()))
        };
        Ok::<_, String>([number(0)?, number(1)?])
    };
    let key = ContactKey::of_kind(kind, numbers(["feature_a", "feature_b"], names_of(kind))?);
    let gap = read_gap(object)?;
    if object.get("entrance").is_none() {
        if let Some(key) = ["entrance_a", "entrance_b"].into_iter().find(|key| object.contains_key(*key)) {
            return Err(format!(
                "entrance is absent, but {key} is there; allowed are all of entrance, entrance_a and entrance_b, or none of them"
            ));
        }
        // Kinds only: what is not said is not compared.
        return Ok(Contact { key, entrance: UNNAMED, gap: Sign::Positive });
    }
    let entrance = name("entrance")
        .and_then(EntranceKind::from_name)
        .ok_or_else(|| format!("entrance is {}; allowed are v-f, f-v, e-e", shown(object.get("entrance"))))?;
    let names = match entrance {
        EntranceKind::VertexFace => ["vertex", "face"],
        EntranceKind::FaceVertex => ["face", "vertex"],
        EntranceKind::EdgeEdge => ["edge", "edge"],
    };
    let entrance = Entrance::of_kind(entrance, numbers(["entrance_a", "entrance_b"], names)?);
    let gap = gap.ok_or_else(|| format!("gap_sign is absent; {GAPS}"))?;
    Ok(Contact { key, entrance, gap })
}

/// What a contact may say of its gap.
const GAPS: &str = "allowed are -1, 0, 1, or the number gap_m instead";

/// The sign of a contact's gap: `gap_sign`, or else that of `gap_m`. Where both are there, `gap_sign` counts, unless one is positive and the other negative: a
/// code may call a small gap none, or print a short number.
fn read_gap(object: &Map<String, Value>) -> Result<Option<Sign>, String> {
    let length = object.get("gap_m").map(|gap| {
        gap.as_f64().ok_or_else(|| format!("gap_m is there, but it is {}; expected a number", kind_of(gap)))
    });
    let of_length = length.transpose()?.and_then(|gap| gap.partial_cmp(&0.0)).map(Sign::of_ordering);
    let Some(found) = object.get("gap_sign") else { return Ok(of_length) };
    let sign = match found.as_i64() {
        Some(-1) => Sign::Negative,
        Some(0) => Sign::Zero,
        Some(1) => Sign::Positive,
        _ => return Err(format!("gap_sign is {found}; {GAPS}")),
    };
    match of_length {
        Some(other) if sign != Sign::Zero && other == sign.reversed() => {
            Err(format!("gap_sign {found} contradicts gap_m {}", shown(object.get("gap_m"))))
        }
        _ => Ok(Some(sign)),
    }
}

fn shown(value: Option<&Value>) -> String {
    value.map_or("absent".to_owned(), ToString::to_string)
}

fn names_of(kind: ContactKind) -> Names {
    match kind {
        ContactKind::VertexVertex => ["vertex", "vertex"],
        ContactKind::VertexEdge => ["vertex", "edge"],
        ContactKind::EdgeVertex => ["edge", "vertex"],
        ContactKind::VertexFace => ["vertex", "face"],
        ContactKind::FaceVertex => ["face", "vertex"],
        ContactKind::EdgeEdge => ["edge", "edge"],
    }
}

fn plural(name: &str) -> &'static str {
    match name {
        "vertex" => "vertices",
        "edge" => "edges",
        _ => "faces",
    }
}

/// How many features of a sort a block has; at least one.
fn count(topology: &Topology, name: &str) -> u32 {
    let count = match name {
        "vertex" => topology.vertex_count(),
        "edge" => topology.edges().len(),
        _ => topology.faces().len(),
    };
    u32::try_from(count).unwrap_or(u32::MAX).max(1)
}

/// The contacts with what an engine left unsaid taken from those they are compared with: an entrance that is not named is
/// not compared. A contact that is not among those keeps the placeholder.
pub fn completed(mut contacts: Vec<Contact>, reference: &[Contact]) -> Vec<Contact> {
    for contact in contacts.iter_mut().filter(|c| c.entrance == UNNAMED) {
        let known = reference.iter().find(|r| r.key == contact.key);
        if let Some(known) = known {
            *contact = *known;
        }
    }
    contacts
}

#[cfg(test)]
mod tests {
    use super::not_json;

    #[test]
    fn the_hint_on_numbers_that_are_none_comes_where_one_stands() {
        let is_hinted = |line: &str| {
            let error = serde_json::from_str::<serde_json::Value>(line).expect_err("no JSON");
            not_json(line.as_bytes(), &error).contains("JSON has no NaN")
        };
        for number in ["nan", "-nan", "NaN", "-NaN", "inf", "-inf", "Infinity", "-infinity", "-nan(ind)"] {
            assert!(is_hinted(&format!("{{\"gap_m\":{number}}}")) && is_hinted(&format!("[1,{number},2]")), "{number}");
        }
        for line in ["{\"info\":}", "{\"nan\":}", "{\"inf\":,\"a\":1}", "[info]", "[nano]", "[1 2]", "{\"a\":1", ""] {
            assert!(!is_hinted(line), "{line}");
        }
    }
}
