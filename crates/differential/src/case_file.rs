//! Findings as files that stand for themselves: both blocks, every tolerance, what was expected and what was said.

// Longer than 400 lines: one file format, its reader and its writer side by side.

use super::attribution::{EnginePanel, WantedFindings, findings_wanted};
use super::compare::AnswerChange;
use super::engine::{Answer, Engine, EngineFailure, Oracle, catch_panic};
use super::external::protocol::{UNNAMED, completed};
use super::external::spec::is_name;
use super::finding::{Cause, Finding, FindingScope};
use super::metamorphic::ChangedPairs;
use super::subject::{NamedSet, Subject};
use super::transform::{ExactBlocks, Transformed};
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::files::read_text;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{
    Block, BlockError, BlockOptions, Contact, ContactKey, ContactKind, Entrance, EntranceKind, Number, Point,
    Precision, Sign, SpecError, ToleranceSet, ToleranceSpec, VertexId,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

/// A finding that can be replayed without the campaign it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What was found, and where it came from.
    pub about: CaseDescription,
    /// The first block, exact.
    pub a: Block,
    /// The second block, exact.
    pub b: Block,
    /// The tolerance set, exact.
    pub tolerances: ToleranceSet,
}

/// What a case is about, as written in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseDescription {
    /// An engine's name, `f32` or `f64` for every engine that rounds to it, or `any`.
    pub engine: String,
    /// The cause.
    pub cause: String,
    /// The change.
    pub change: String,
    /// The kind of the contact it is about, or `v-v to v-e` where the kind changed; empty where any will do.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub kind: String,
    /// The deciding predicate, under the cause `engine` the one nearest to a tie; empty where no trace tells.
    #[serde(default)]
    pub predicate: String,
    /// The features it was asked of.
    #[serde(default)]
    pub features: String,
    /// Its exact relative margin; 0 is a tie.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// The margin in units of the engine's roundoff.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin_ulps: Option<f64>,
    /// Where it came from: family, form, tolerance set, seed and index.
    #[serde(default)]
    pub origin: String,
    /// What the engine said when it gave no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// How the blocks lie and how the engine says they do, where it says only that: `apart 0.5, said overlapping -0.1`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub states: Option<String>,
    /// The contacts before the link that is the cause: under tolerance the exact ones without tolerances, under
    /// representation the exact ones of the exact input, else the exact ones of the rounded input.
    pub expected: Vec<ContactRow>,
    /// The contacts after it.
    pub found: Vec<ContactRow>,
    /// What an external engine said of the pair exchanged, numbered otherwise, moved or scaled, in the numbering of the pair itself, where it contradicts itself so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub changed: Option<Vec<ContactRow>>,
}

impl CaseDescription {
    /// What the engine said of how the blocks lie, as [`ReportedState`](super::separation_state::ReportedState) is shown.
    pub fn said_state(&self) -> Option<&str> {
        self.states.as_deref()?.split_once(", said ").map(|(_, said)| said)
    }

    /// The contacts of all lists.
    fn rows(&self) -> impl Iterator<Item = &ContactRow> {
        self.expected.iter().chain(&self.found).chain(self.changed.iter().flatten())
    }

    /// The contacts that both answers name, and name differently.
    pub fn differing_contacts(&self) -> BTreeSet<ContactKey> {
        let contacts = |rows: &[ContactRow]| -> Vec<Contact> { rows.iter().filter_map(ContactRow::contact).collect() };
        let found = contacts(&self.found);
        let differs = |right: &Contact| found.iter().any(|one| one.key == right.key && one != right);
        contacts(&self.expected).into_iter().filter(differs).map(|contact| contact.key).collect()
    }
}

/// What an engine says of a changed pair.
pub struct ChangedAnswers {
    /// What was changed.
    pub words: String,
    /// The answers, in the numbering of the pair itself; of a block far away one for each order of the two.
    pub said: Vec<Result<Answer, EngineFailure>>,
}

/// A contact as written in files; the names are those of `classify`'s columns.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactRow {
    kind: String,
    feature_a: u32,
    feature_b: u32,
    entrance: String,
    entrance_a: u32,
    entrance_b: u32,
    gap_sign: i8,
}

impl From<&Contact> for ContactRow {
    fn from(c: &Contact) -> ContactRow {
        let ([feature_a, feature_b], [entrance_a, entrance_b]) = (c.key.numbers(), c.entrance.numbers());
        ContactRow {
            kind: c.kind().name().to_owned(),
            feature_a,
            feature_b,
            entrance: c.entrance.kind().name().to_owned(),
            entrance_a,
            entrance_b,
            gap_sign: c.gap.as_i8(),
        }
    }
}

impl ContactRow {
    /// The contact, or `None` if a name or sign is not one.
    pub fn contact(&self) -> Option<Contact> {
        let key = ContactKey::of_kind(ContactKind::from_name(&self.kind)?, [self.feature_a, self.feature_b]);
        let entrance = Entrance::of_kind(EntranceKind::from_name(&self.entrance)?, [self.entrance_a, self.entrance_b]);
        let gap = match self.gap_sign {
            -1 => Sign::Negative,
            0 => Sign::Zero,
            1 => Sign::Positive,
            _ => return None,
        };
        Some(Contact { key, entrance, gap })
    }
}

/// The rows of a list of contacts.
pub fn contact_rows(contacts: &[Contact]) -> Vec<ContactRow> {
    contacts.iter().map(ContactRow::from).collect()
}

/// The file as it is parsed.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseFile {
    case: CaseDescription,
    tolerances: ToleranceSet,
    block: Vec<CaseBlock>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseBlock {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    vertices: Vec<[Number; 3]>,
    faces: Vec<Vec<VertexId>>,
}

/// Why a file is not a case.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The file cannot be read.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// Not TOML, or not the keys of a case.
    #[error("{file}: {source}")]
    Toml {
        /// The file.
        file: String,
        /// What, with line and column.
        source: Box<toml::de::Error>,
    },
    /// A value that is not one of those allowed.
    #[error("{file}: {key} is \"{found}\"; allowed are {allowed}")]
    Value {
        /// The file.
        file: String,
        /// The key.
        key: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// A tolerance that is none.
    #[error("{file}: [tolerances]: {source}")]
    Tolerance {
        /// The file.
        file: String,
        /// What is wrong.
        source: SpecError,
    },
    /// A case has two blocks.
    #[error("{file}: {found} [[block]] tables; a case has 2")]
    Blocks {
        /// The file.
        file: String,
        /// How many there are.
        found: usize,
    },
    /// A block that is none.
    #[error("{file}: block {block}: {source}")]
    Block {
        /// The file.
        file: String,
        /// Its number.
        block: usize,
        /// What is wrong.
        source: BlockError,
    },
}

impl Case {
    /// The case of a finding about one of `subject`'s sets. `expected` and `found` are worked out anew.
    ///
    /// Returns `None` when the finding names a set the subject does not have.
    pub fn of(finding: &Finding, subject: &Subject, seed: u64, panel: &EnginePanel) -> Option<Case> {
        let set = subject.sets.iter().find(|s| s.name == finding.set)?;
        let tolerances = set.of(precision_of(&finding.scope, panel)).clone();
        let origin =
            format!("{} {} under {}, seed {seed}, index {}", finding.family, finding.form, finding.set, finding.index);
        let mut case = Case {
            about: CaseDescription {
                engine: finding.scope.to_string(),
                cause: finding.cause.to_string(),
                change: finding.difference.change.to_string(),
                kind: finding.difference.kinds(),
                predicate: String::new(),
                features: String::new(),
                margin: None,
                margin_ulps: None,
                origin,
                note: None,
                states: None,
                expected: Vec::new(),
                found: Vec::new(),
                changed: None,
            },
            a: subject.a.clone(),
            b: subject.b.clone(),
            tolerances,
        };
        case.describe(finding, panel);
        Some(case)
    }

    /// The pair of the case, as one of a campaign.
    pub fn subject(&self) -> Subject {
        let set = NamedSet::same("case", &self.tolerances);
        Subject {
            index: 0,
            family: "case".into(),
            form: "case".into(),
            a: self.a.clone(),
            b: self.b.clone(),
            sets: vec![set],
        }
    }

    /// The findings of the same cause, change, kind, predicate and engine that the pair shows now.
    pub fn findings(&self, panel: &EnginePanel) -> Vec<Finding> {
        let about = &self.about;
        // What is nearest to a tie says nothing about an engine from outside.
        let predicate = (about.cause != Cause::Engine.name()).then_some(about.predicate.as_str());
        let wanted = WantedFindings { cause: &about.cause, change: &about.change, kind: &about.kind, predicate };
        let alike = |f: &Finding| {
            f.cause.name() == about.cause
                && f.difference.change.name() == about.change
                && (about.kind.is_empty() || f.difference.kinds() == about.kind)
                && predicate.is_none_or(|name| f.predicate().map_or("", Predicate::name) == name)
                // With one engine left, what a tolerance set for one precision does is the doing of all there are.
                && (f.cause == Cause::Tolerance || f.scope.to_string() == about.engine)
        };
        findings_wanted(&self.subject(), panel, wanted).into_iter().filter(alike).collect()
    }

    /// Takes what decided it, and both answers, from a finding about this pair.
    pub fn describe(&mut self, finding: &Finding, panel: &EnginePanel) {
        self.about.predicate = finding.predicate().map_or(String::new(), |p| p.to_string());
        self.about.features = finding.deciding.map_or(String::new(), |d| d.features());
        self.about.margin = finding.margin();
        self.about.margin_ulps = finding.margin_ulps();
        self.about.note = finding.note.clone();
        self.about.states = finding.comparison.map(|m| m.to_string());
        let answers = self.answers(finding, panel);
        [self.about.expected, self.about.found] = answers.map(|contacts| contact_rows(&contacts));
        let is_outside = finding.cause == Cause::Engine;
        let engine =
            panel.engines.iter().find(|e| is_outside && finding.scope == FindingScope::Engine(e.name().into()));
        let changed = engine.and_then(|engine| self.changed_answers(&**engine, &*panel.oracle));
        self.about.changed = match changed.as_ref().map(|changed| &changed.said[..]) {
            Some([Ok(Answer::Contacts(said))]) => Some(contact_rows(said)),
            _ => None,
        };
    }

    /// What an engine says of the pair changed as the finding says, in the numbering of the pair itself; `None` where it is about no such change, or the pair
    /// cannot be changed so.
    pub fn changed_answers(&self, engine: &dyn Engine, oracle: &dyn Oracle) -> Option<ChangedAnswers> {
        let precision = engine.precision();
        let blocks = [self.a.rounded(precision)?, self.b.rounded(precision)?];
        let tolerances = self.tolerances.rounded(precision).ok()?;
        let exact = ExactBlocks::new([&self.a, &self.b]);
        let (change, says_state) = (&self.about.change, self.about.states.is_some());
        let ChangedPairs { words, pairs } =
            ChangedPairs::of(change, &exact, &blocks, &tolerances, precision, says_state)?;
        let ask = |pair: &Transformed| {
            let ([a, b], tolerances) = (&pair.blocks, pair.tolerances(&tolerances));
            let answer = catch_panic(|| engine.prepare(a, b)?.answer(&tolerances))?;
            let Answer::Contacts(contacts) = answer else { return Ok(answer) };
            let right = oracle.prepare(a, b).pair().classify(&tolerances).contacts;
            Ok(Answer::Contacts(pair.to_original(&completed(contacts, &right))))
        };
        Some(ChangedAnswers { words, said: pairs.iter().map(ask).collect() })
    }

    fn answers(&self, finding: &Finding, panel: &EnginePanel) -> [Vec<Contact>; 2] {
        let exact = |a: &Block, b: &Block, t: &ToleranceSet| panel.oracle.prepare(a, b).pair().classify(t).contacts;
        let given = || exact(&self.a, &self.b, &self.tolerances);
        let precision = precision_of(&finding.scope, panel);
        let rounded = self
            .a
            .rounded(precision)
            .and_then(|a| Some((a, self.b.rounded(precision)?, self.tolerances.rounded(precision).ok()?)));
        match (finding.cause, rounded) {
            (Cause::Tolerance, _) => [exact(&self.a, &self.b, &self.tolerances.ideal()), given()],
            (_, None) => [given(), Vec::new()],
            (Cause::Representation, Some((a, b, t))) => [given(), exact(&a, &b, &t)],
            (Cause::Arithmetic | Cause::Defect | Cause::Engine, Some((a, b, t))) => {
                let engine = panel.engines.iter().find(|e| finding.scope == FindingScope::Engine(e.name().into()));
                let said = engine.and_then(|e| catch_panic(|| e.prepare(&a, &b)?.classify(&t)).ok());
                let right = exact(&a, &b, &t);
                let said = completed(said.unwrap_or_default(), &right);
                [right, said]
            }
        }
    }

    /// The case as TOML.
    ///
    /// # Errors
    /// Those of the TOML writer.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        let block = |block: &Block| CaseBlock {
            name: None,
            vertices: block.vertices().iter().map(|v| [v.x.clone(), v.y.clone(), v.z.clone()]).collect(),
            faces: block.topology().faces().to_vec(),
        };
        let file = CaseFile {
            case: self.about.clone(),
            tolerances: self.tolerances.clone(),
            block: vec![block(&self.a), block(&self.b)],
        };
        toml::to_string(&file)
    }

    /// The case in a file.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn load(path: &Path) -> Result<Case, CaseError> {
        let file = path.display().to_string();
        let text = read_text(path).map_err(|source| CaseError::Io { file: file.clone(), source })?;
        Case::from_toml(&text, file)
    }

    /// The case in a text; `file` is its name in messages.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn from_toml(text: &str, file: String) -> Result<Case, CaseError> {
        let parsed: CaseFile =
            toml::from_str(text).map_err(|source| CaseError::Toml { file: file.clone(), source: Box::new(source) })?;
        let about = parsed.case;
        let known = |key, found: &str, allowed: &[&str]| {
            if allowed.contains(&found) {
                return Ok(());
            }
            let (file, found, allowed) = (file.clone(), excerpt(found, EXCERPT_LENGTH), allowed.join(", "));
            Err(CaseError::Value { file, key, found, allowed })
        };
        if !["any", "f32", "f64"].contains(&about.engine.as_str()) && !is_name(&about.engine) {
            let allowed = "any, f32, f64, and names of letters, digits, '-', '_' and '.'".to_owned();
            return Err(CaseError::Value {
                file,
                key: "engine",
                found: excerpt(&about.engine, EXCERPT_LENGTH),
                allowed,
            });
        }
        for (key, margin) in [("margin", about.margin), ("margin_ulps", about.margin_ulps)] {
            if let Some(found) = margin.filter(|margin| !margin.is_finite()) {
                let allowed = "finite numbers".to_owned();
                return Err(CaseError::Value { file, key, found: found.to_string(), allowed });
            }
        }
        known("cause", &about.cause, &Cause::ALL.map(Cause::name))?;
        known("change", &about.change, &AnswerChange::ALL.map(AnswerChange::name))?;
        if about.kind.split(" to ").any(|kind| !kind.is_empty() && ContactKind::from_name(kind).is_none()) {
            known("kind", &about.kind, &ContactKind::ALL.map(ContactKind::name))?;
        }
        if !about.predicate.is_empty() {
            known("predicate", &about.predicate, &Predicate::ALL.map(Predicate::name))?;
        }
        for row in about.rows() {
            if row.contact().is_none() {
                let allowed = "kinds v-v v-e e-v v-f f-v e-e, entrances v-f f-v e-e, gap signs -1 0 1".to_owned();
                let found = excerpt(&format!("{row:?}"), EXCERPT_LENGTH);
                return Err(CaseError::Value { file, key: "expected, found or changed", found, allowed });
            }
        }
        let found = parsed.block.len();
        let [a, b] =
            <[CaseBlock; 2]>::try_from(parsed.block).map_err(|_| CaseError::Blocks { file: file.clone(), found })?;
        let block = |number, block: CaseBlock| {
            let vertices = block.vertices.into_iter().map(|[x, y, z]| Point::new(x, y, z)).collect();
            // Real blocks are kept as they were loaded, with faces as far from planar as their file had them.
            let options = BlockOptions { planarity: Number::from_integer(1) };
            Block::new(vertices, block.faces, &options).map_err(|source| CaseError::Block {
                file: file.clone(),
                block: number,
                source,
            })
        };
        let [a, b] = [block(0, a)?, block(1, b)?];
        for contact in about.rows().filter_map(ContactRow::contact) {
            if !has_features([&a, &b], &contact) {
                let allowed = "the vertices, edges and faces of the two blocks".to_owned();
                let found = format!("{} by {}", contact.key, contact.entrance);
                return Err(CaseError::Value { file, key: "a contact of expected, found or changed", found, allowed });
            }
        }
        let tolerances = parsed.tolerances;
        let mut spec = ToleranceSpec::empty();
        for (name, number) in tolerances.numbers() {
            spec.set_number(name, number.clone())
                .map_err(|source| CaseError::Tolerance { file: file.clone(), source })?;
        }
        Ok(Case { about, a, b, tolerances })
    }
}

/// Whether blocks have the features that a contact and its entrance name; an entrance that an engine did not name is none.
fn has_features(blocks: [&Block; 2], contact: &Contact) -> bool {
    let has = |feature: Feature| feature.is_in(blocks[usize::from(feature.side() == Side::B)].topology());
    let named = (contact.entrance != UNNAMED).then(|| contact.entrance.features());
    contact.key.features().into_iter().chain(named.into_iter().flatten()).all(has)
}

/// The precision whose input and tolerance set a finding is about; f64's where it is about all, if there is one.
pub fn precision_of(scope: &FindingScope, panel: &EnginePanel) -> Precision {
    match scope {
        FindingScope::Rounded(precision) => *precision,
        FindingScope::Any => panel.precisions().pop().unwrap_or(Precision::F64),
        FindingScope::Engine(name) => {
            panel.engines.iter().find(|e| e.name() == &**name).map_or(Precision::F64, |e| e.precision())
        }
    }
}
