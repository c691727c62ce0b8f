//! Makes the benchmark set `cases/benchmark/pairs.jsonl` anew, or checks that it comes out again byte for byte:
//!
//! ```text
//! cargo run --release --example benchmark_set
//! cargo run --release --example benchmark_set -- --check
//! ```
//!
//! docs/benchmark_set.md says what stands in it. Pairs are taken in the order in which a campaign makes them until every family has its share of every
//! difficulty; where a family has no more of one within [`MAX_BATCHES`], the others have more.

use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::source;
use rockproof_differential::collision::separation::Separation;
use rockproof_model::{Block, BlockOptions, Contact, Number, ToleranceSet};
use rockproof_oracle::penetration::penetration;
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_pairs::batch::PairCase;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::{Classifier, Stepper};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;

/// The version of the format and of the pairs: another one is another benchmark.
const VERSION: u32 = 3;
/// How many pairs.
const PAIRS: usize = 2000;
/// The seed of the campaign that makes them.
const SEED: u64 = 2000;
/// Batches looked at.
const MAX_BATCHES: u64 = 2800;
/// Blocks of more vertices are left out: the file is for reading too.
const MAX_VERTICES: usize = 12;
/// Digits of the longest fraction allowed in an answer.
const MAX_DIGITS: usize = 600;
const FILE: &str = "cases/benchmark/pairs.jsonl";
/// The least precise arithmetic of the float code that answers a pair rightly; `exact` where f64 does not either.
const DIFFICULTIES: [&str; 3] = ["f32", "f64", "exact"];

fn main() -> Result<(), Box<dyn Error>> {
    let mut text = lines()?.join("\n");
    text.push('\n');
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    if std::env::args().any(|argument| argument == "--check") {
        if fs::read_to_string(&file)? != text {
            return Err(format!("{FILE} does not come out again").into());
        }
        println!("{FILE} is as committed");
        return Ok(());
    }
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(&file, text)?;
    println!("written: {FILE}");
    Ok(())
}

/// The file, line by line.
fn lines() -> Result<Vec<String>, Box<dyn Error>> {
    let config = CampaignConfig {
        seed: SEED,
        tolerances: vec!["auto".to_owned(), "shi".to_owned()],
        ..CampaignConfig::default()
    };
    let source = source::of(&config)?;
    let mut cells: BTreeMap<(&str, &str), Vec<(u64, Value)>> = BTreeMap::new();
    for case in (0..MAX_BATCHES).flat_map(|number| source.cases(number)) {
        let tolerances = case.sets[0].f64.clone();
        if ![&case.a, &case.b].into_iter().all(stands_for_itself) {
            continue;
        }
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let contacts = pair.classify(&tolerances).contacts;
        // What nothing touches is asked of no contact code.
        if contacts.is_empty() {
            continue;
        }
        let difficulty = difficulty(&case, &tolerances, &contacts);
        let cell = cells.entry((case.family, difficulty)).or_default();
        // More than a cell can have in the end are not needed.
        if cell.len() < PAIRS / DIFFICULTIES.len()
            && let Some(mut answer) = answers(&case, &tolerances, &pair, &contacts)
        {
            answer["difficulty"] = difficulty.into();
            // Steps may round to the same number, so that a campaign has the same pair again.
            let same = |other: &Value| ["a", "b", "tolerances"].iter().all(|&key| other[key] == answer[key]);
            if !cell.iter().any(|(_, other)| same(other)) {
                cell.push((case.index, answer));
            }
        }
    }
    Ok(chosen(cells).into_iter().map(|pair| pair.to_string()).collect())
}

/// Whether vertices and faces as they are written make the same block again.
fn stands_for_itself(block: &Block) -> bool {
    let again = || Block::new(block.vertices().to_vec(), block.topology().faces().to_vec(), &BlockOptions::default());
    block.vertices().len() <= MAX_VERTICES && again().is_ok_and(|again| again == *block)
}

fn difficulty(case: &PairCase, tolerances: &ToleranceSet, exact: &[Contact]) -> &'static str {
    let float = Stepper::<SpecRules>::new();
    let (a, b) = (&case.a, &case.b);
    if float.f32(a, b, tolerances).is_ok_and(|contacts| contacts == exact) {
        return DIFFICULTIES[0];
    }
    let in_f64 = float.f64(a, b, tolerances).is_ok_and(|contacts| contacts == exact);
    if in_f64 { DIFFICULTIES[1] } else { DIFFICULTIES[2] }
}

/// The pair with its exact answers; `None` where a fraction is longer than is of use.
fn answers(case: &PairCase, tolerances: &ToleranceSet, pair: &Pair<'_>, contacts: &[Contact]) -> Option<Value> {
    let short = |text: String| (text.len() <= MAX_DIGITS).then_some(text);
    let contacts: Option<Vec<Value>> = contacts
        .iter()
        .map(|contact| {
            let gap = pair.gap(&contact.entrance);
            let ([a, b], [entrance_a, entrance_b]) = (contact.key.numbers(), contact.entrance.numbers());
            Some(json!({
                "kind": contact.kind().name(), "feature_a": a, "feature_b": b,
                "entrance": contact.entrance.kind().name(), "entrance_a": entrance_a, "entrance_b": entrance_b,
                "gap_sign": contact.gap.as_i8(), "gap_squared": short(gap.squared.to_string())?,
            }))
        })
        .collect();
    let separation = match Separation::of(&case.a, &case.b) {
        None => Value::Null,
        Some(found) => json!({ "state": found.state.name(), "gap_squared": short(found.squared.to_string())? }),
    };
    let deep = penetration(&case.a, &case.b)?;
    let depth_squared = if deep.gap.sign.is_negative() { short(deep.gap.squared.to_string())? } else { "0".to_owned() };
    let set: BTreeMap<&str, String> = tolerances.numbers().into_iter().map(|(name, n)| (name, text(n))).collect();
    let mut set = serde_json::to_value(set).ok()?;
    set["criteria"] = tolerances.criteria.name().into();
    Some(json!({
        "version": VERSION,
        "family": case.family,
        "form": case.form.name(),
        "a": block(&case.a),
        "b": block(&case.b),
        "tolerances": set,
        "contacts": contacts?,
        "separation": separation,
        "penetration": { "depth_squared": depth_squared },
    }))
}

/// A number as every reader of fractions takes it.
fn text(number: &Number) -> String {
    number.to_rational().to_string()
}

fn block(block: &Block) -> Value {
    let vertices: Vec<[String; 3]> = block.vertices().iter().map(|v| v.components().map(text)).collect();
    json!({ "vertices": vertices, "faces": block.topology().faces() })
}

/// An equal share of each cell, in rounds: the first of every cell, then the second, until there are enough; then in the order of the campaign, numbered.
fn chosen(cells: BTreeMap<(&str, &str), Vec<(u64, Value)>>) -> Vec<Value> {
    let longest = cells.values().map(Vec::len).max().unwrap_or(0);
    let rounds = (0..longest).flat_map(|round| cells.values().filter_map(move |cell| cell.get(round)));
    let mut taken: Vec<&(u64, Value)> = rounds.take(PAIRS).collect();
    taken.sort_by_key(|(index, _)| *index);
    let numbered = taken.into_iter().enumerate().map(|(id, (_, pair))| {
        let mut pair = pair.clone();
        pair["id"] = id.into();
        pair
    });
    numbered.collect()
}
