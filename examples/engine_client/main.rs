//! A complete client for Rockproof in Rust, for a code that classifies contacts. The stepper in f64 stands for that code:
//! replace `contacts` by a call of your own.
//!
//! `rockproof campaign --engine-command "mine=target/release/examples/engine_client"` must then find exactly what it finds about
//! `stepper-f64`. A word as argument makes the client misbehave or make a mistake, for the tests and for docs/engines.md: see `trick` and `mistake`.

use rockproof_model::{
    Block, BlockOptions, Contact, Criteria, Entrance, EntranceKind, Number, Point, Sign, ToleranceSet,
};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::{Classifier, Stepper};
use serde_json::{Value, json};
use std::io::{BufRead, Write};

type Failure = Box<dyn std::error::Error>;

fn number(value: &Value) -> Result<Number, Failure> {
    Ok(Number::from_f64(value.as_f64().ok_or("not a number")?)?)
}

fn block(value: &Value) -> Result<Block, Failure> {
    let list = |key: &str| value[key].as_array().ok_or("not a list");
    let point = |p: &Value| Ok::<_, Failure>(Point::new(number(&p[0])?, number(&p[1])?, number(&p[2])?));
    let vertices = list("vertices")?.iter().map(point).collect::<Result<_, _>>()?;
    let faces: Vec<Vec<u32>> = serde_json::from_value(value["faces"].clone())?;
    // Rounding may have bent a face.
    let options = BlockOptions { planarity: Number::from_integer(1) };
    Ok(Block::new(vertices, faces, &options)?)
}

fn tolerances(value: &Value) -> Result<ToleranceSet, Failure> {
    let criteria = if value["criteria"] == "classic" { Criteria::Classic } else { Criteria::Revised };
    let mut set = ToleranceSet { criteria, ..ToleranceSet::ZERO };
    for (name, place) in set.numbers_mut() {
        *place = number(&value[name])?;
    }
    Ok(set)
}

/// Your code comes here.
fn contacts(question: &Value) -> Result<Vec<Contact>, Failure> {
    let (a, b) = (block(&question["a"])?, block(&question["b"])?);
    Ok(Stepper::<SpecRules>::new().f64(&a, &b, &tolerances(&question["tolerances"])?)?)
}

fn written(contact: &Contact) -> Value {
    let ([a, b], [entrance_a, entrance_b]) = (contact.key.numbers(), contact.entrance.numbers());
    json!({
        "kind": contact.kind().name(), "feature_a": a, "feature_b": b,
        "entrance": contact.entrance.kind().name(), "entrance_a": entrance_a, "entrance_b": entrance_b,
        "gap_sign": contact.gap.as_i8(),
    })
}

/// A mistake in what is read: input rounded to f32, a territory 1 % too large, or taken for 0 below a millimetre, ε ignored, coordinates taken in another
/// order (which adds up products in another order), A and B exchanged.
fn misread(word: &str, question: &mut Value) {
    let number = |value: &Value, f: &dyn Fn(f64) -> f64| json!(f(value.as_f64().unwrap_or_default()));
    let points = |block: &mut Value, f: &dyn Fn(&[Value]) -> Value| {
        for point in block["vertices"].as_array_mut().into_iter().flatten() {
            *point = f(point.as_array().map_or(&[], Vec::as_slice));
        }
    };
    match word {
        "f32" => {
            let near = |value: f64| f64::from(value as f32);
            for block in ["a", "b"] {
                points(&mut question[block], &|p| p.iter().map(|c| number(c, &near)).collect());
            }
            for value in question["tolerances"].as_object_mut().into_iter().flat_map(|set| set.values_mut()) {
                if value.is_number() {
                    *value = number(value, &near);
                }
            }
        }
        "territory" => {
            let set = &mut question["tolerances"];
            set["territory"] = number(&set["territory"], &|radius| 1.01 * radius);
        }
        "millimetre" => {
            let set = &mut question["tolerances"];
            set["territory"] = number(&set["territory"], &|radius| if radius < 1e-3 { 0.0 } else { radius });
        }
        "epsilon" => question["tolerances"]["equal"] = json!(0.0),
        "order" => {
            for block in ["a", "b"] {
                points(&mut question[block], &|p| p.iter().cycle().skip(1).take(p.len()).cloned().collect());
            }
        }
        "exchanged" => {
            let a = question["a"].take();
            question["a"] = question["b"].take();
            question["b"] = a;
        }
        _ => {}
    }
}

/// A mistake in what is found: gaps with the wrong sign or always the same, entrances all called v-f, corners of five and more edges left out, the first
/// corner of A left out, no more than four contacts listed, one contact forgotten in one pair of a thousand.
fn mistake(word: &str, question: &Value, contacts: &mut Vec<Contact>) {
    let constant = |sign: Sign| move |contact: &mut Contact| contact.gap = sign;
    let edges = |block: &str, vertex: u32| {
        let faces = question[block]["faces"].as_array().into_iter().flatten();
        faces.filter(|face| face.as_array().is_some_and(|face| face.contains(&json!(vertex)))).count()
    };
    match word {
        "sign" => contacts.iter_mut().for_each(|contact| contact.gap = contact.gap.reversed()),
        "positive" => contacts.iter_mut().for_each(constant(Sign::Positive)),
        "negative" => contacts.iter_mut().for_each(constant(Sign::Negative)),
        "zero" => contacts.iter_mut().for_each(constant(Sign::Zero)),
        "v-f" => contacts
            .iter_mut()
            .filter(|contact| contact.entrance.kind() != EntranceKind::VertexFace)
            .for_each(|contact| contact.entrance = Entrance::of_kind(EntranceKind::VertexFace, [0, 0])),
        "corners" => contacts.retain(|contact| {
            let (kind, [a, b]) = (contact.kind().name(), contact.key.numbers());
            !(kind.starts_with('v') && edges("a", a) > 4 || kind.ends_with('v') && edges("b", b) > 4)
        }),
        "first" => {
            contacts.retain(|contact| !(contact.kind().name().starts_with('v') && contact.key.numbers()[0] == 0));
        }
        "four" => contacts.truncate(4),
        "thousandth" => {
            let sum = question["b"]["vertices"]
                .to_string()
                .bytes()
                .fold(7_u64, |sum, byte| sum.wrapping_mul(0x0100_0000_01b3) ^ u64::from(byte));
            if sum % 1000 == 1 && !contacts.is_empty() {
                contacts.remove(0);
            }
        }
        _ => {}
    }
}

/// A way to misbehave, on pairs whose first coordinate says so, about a third of them; `second` does on every second question, `escape` wherever that
/// coordinate is not 0; `apart` says of the others that they are.
fn trick(word: &str, question: &Value) -> Option<String> {
    let first = question["a"]["vertices"][0][0].as_f64().unwrap_or(0.0).to_bits();
    // Not the first question, whose first coordinate is 0.
    let chosen = (first ^ (first >> 32) ^ (first >> 47)) % 3 == 1;
    let id = &question["id"];
    match word {
        "kinds" | "" | "f32" | "territory" | "millimetre" | "epsilon" | "order" | "exchanged" | "sign" | "positive"
        | "negative" | "zero" | "v-f" | "corners" | "first" | "four" | "thousandth" | "late" => None,
        "second" if id.as_u64().is_some_and(|id| id % 2 == 1) => std::process::exit(3),
        "second" => None,
        "escape" if first == 0 => None,
        "escape" => Some(json!({ "id": id, "unsupported": "\u{1b}[31mred\n::error::\u{0}" }).to_string()),
        // A code that says only how blocks lie, and does not take every pair.
        "apart" if !chosen => Some(json!({ "id": id, "state": "apart" }).to_string()),
        "apart" => Some(json!({ "id": id, "unsupported": "not today" }).to_string()),
        _ if !chosen => None,
        "crash" => std::process::exit(3),
        "hang" => loop {
            std::thread::sleep(std::time::Duration::from_secs(60));
        },
        // An answer with a line after it that nobody asked for, in one piece.
        "unasked" => Some(format!("{}\nand good morning\n", json!({ "id": id, "contacts": [] }))),
        "endless" => loop {
            // It ends with the pipe, or is ended.
            if writeln!(std::io::stdout(), "good morning").is_err() {
                std::process::exit(0);
            }
        },
        "malformed" => Some(format!("{{\"id\":{id},\"contacts\":[{{\"kind\":\"v-w\"}}]}}")),
        "unsupported" => Some(json!({ "id": id, "unsupported": "not today" }).to_string()),
        "unstable" if std::process::id().is_multiple_of(2) => None,
        "unstable" | "none" => Some(json!({ "id": id, "contacts": [] }).to_string()),
        "state" => Some(json!({ "id": id, "state": "apart" }).to_string()),
        _ => std::process::exit(2),
    }
}

fn main() -> Result<(), Failure> {
    let word = std::env::args().nth(1).unwrap_or_default();
    let mut out = std::io::stdout().lock();
    // Of `late`, which answers each question as the one before it.
    let mut waiting = json!({ "contacts": [] });
    for line in std::io::stdin().lock().lines() {
        let mut question: Value = serde_json::from_str(&line?)?;
        misread(&word, &mut question);
        let answer = trick(&word, &question).unwrap_or_else(|| {
            let mut found = contacts(&question);
            found.iter_mut().for_each(|contacts| mistake(&word, &question, contacts));
            let mut answer = match found {
                Ok(contacts) => json!({ "contacts": contacts.iter().map(written).collect::<Vec<_>>() }),
                Err(why) => json!({ "unsupported": why.to_string() }),
            };
            if word == "late" {
                std::mem::swap(&mut answer, &mut waiting);
            }
            answer["id"] = question["id"].clone();
            answer.to_string()
        });
        writeln!(out, "{answer}")?;
        out.flush()?;
    }
    Ok(())
}
