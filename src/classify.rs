//! `classify`: the contacts between the blocks of a file.

use crate::doubts::tell_of_tolerances;
use crate::exit::{ExitStatus, Outcome, print, write_to_stdout};
use crate::input::{ReadArgs, ToleranceArgs, model_help};
use crate::input_file::InputFile;
use crate::progress::{counted_while, overlaps};
use crate::table::table;
use anyhow::Context;
use clap::ValueEnum;
use rayon::prelude::*;
use rockproof_differential::neighbours::neighbours;
use rockproof_examine::Overlaps;
use rockproof_model::text::noun;
use rockproof_model::{Block, Contact, Precision, Sign, ToleranceSet};
use rockproof_oracle::combination::{Combination, combinations};
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_stepper::Real;
use rockproof_stepper::contact::{PreparedBlock as PreparedFloatBlock, SpecRules, Tolerances, classify};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::io::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};

/// Classify the contacts between the blocks of a file
///
/// Contacts of all neighbouring pairs, or of one, with their entrances and gaps; beside them what several contacts amount
/// to: faces on faces, edges on faces, parallel edges. Exits 0 also when nothing touches.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof classify cases/real/slope_joints.dda
  rockproof classify cases/real/voronoi_120.txt --planarity 1e-4 --format csv
  rockproof classify two.toml --engine stepper-f32 --tolerances shi --set search=1/10 --pair 0,1")]
pub(crate) struct Classify {
    #[arg(help = model_help(), value_hint = clap::ValueHint::FilePath)]
    file: InputFile,

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    tolerances: ToleranceArgs,

    /// Who classifies
    #[arg(long, value_enum, default_value = "exact")]
    engine: EngineChoice,

    /// Only this pair of blocks, numbered from 0
    #[arg(long, value_name = "I,J", value_parser = parse_pair)]
    pair: Option<(usize, usize)>,

    /// How to print
    #[arg(long, value_enum, default_value = "table")]
    format: OutputFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EngineChoice {
    /// The oracle
    Exact,
    /// The stepper in double precision
    #[value(name = "stepper-f64", alias = "f64")]
    F64,
    /// The stepper in single precision
    #[value(name = "stepper-f32", alias = "f32")]
    F32,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum OutputFormat {
    Table,
    Csv,
    Json,
}

fn parse_pair(text: &str) -> Result<(usize, usize), String> {
    let pair = text.split_once(',').and_then(|(i, j)| Some((i.trim().parse().ok()?, j.trim().parse().ok()?)));
    match pair {
        Some((i, j)) if i != j => Ok((i, j)),
        Some(_) => Err("a block is no pair with itself".to_owned()),
        None => Err("expected two block numbers, like 0,1".to_owned()),
    }
}

/// The contacts of one pair of blocks.
struct PairContacts {
    a: usize,
    b: usize,
    found: Vec<(Contact, f64)>,
    combined: Vec<Combination>,
}

impl Classify {
    pub(crate) fn run(&self) -> Outcome {
        let scene = self.read.scene(&self.file)?;
        let blocks = scene.shapes();
        let precision = if self.engine == EngineChoice::F32 { Precision::F32 } else { Precision::F64 };
        let place = || self.tolerances.place(self.file.path());
        let spec = self.tolerances.spec(scene.tolerances.as_ref())?;
        let tolerances = spec.derive(&blocks, precision).with_context(place)?;
        tell_of_tolerances(&blocks, &tolerances);
        let pairs = match self.pair {
            Some((i, j)) => {
                if let Some(missing) = [i, j].into_iter().find(|&n| n >= blocks.len()) {
                    let (file, count) = (self.file.path().display(), blocks.len());
                    anyhow::bail!("{file}: --pair names block {missing}; the file has {count}, numbered from 0");
                }
                vec![(i, j)]
            }
            None => neighbours(&blocks, &tolerances),
        };
        let classifier = Classifier::new(self.engine, &blocks, &tolerances).with_context(place)?;
        // Blocks that overlap deeper than any contact says are the first thing to know of a model. A row of CSV is a contact, so there it is not told.
        let audited = !matches!(self.format, OutputFormat::Csv);
        // Two fixed blocks never move, so they pass through nothing.
        let fixed = scene.fixed();
        let may_move: Vec<(usize, usize)> = pairs.iter().copied().filter(|&(i, j)| !(fixed[i] && fixed[j])).collect();
        let overlaps = audited.then(|| overlaps(&scene, &tolerances, Some(&may_move)));
        let mut rows = Vec::new();
        counted_while((pairs.len() as u64, "pairs"), "classified", |done| {
            let found = classifier.all(&pairs, done, audited);
            match self.format {
                OutputFormat::Table => Ok(write_table(&mut rows, found, pairs.len())?),
                // These two go out as they come, whatever the size of the model.
                OutputFormat::Csv => write_to_stdout(|out| write_csv(out, found)),
                OutputFormat::Json => {
                    let overlaps = overlaps.as_ref().map_or(Value::Null, Overlaps::json);
                    write_to_stdout(|out| write_json(out, overlaps, found))
                }
            }
        })?;
        if let (OutputFormat::Table, Some(overlaps)) = (self.format, overlaps) {
            writeln!(rows, "{}", overlaps.line())?;
            let both_fixed = pairs.len() - may_move.len();
            if both_fixed > 0 {
                let pairs = noun(both_fixed, "pair", "pairs");
                writeln!(rows, "({both_fixed} {pairs} of fixed blocks, which never move, left out of the overlaps)")?;
            }
            print(&String::from_utf8_lossy(&rows))?;
        }
        Ok(ExitStatus::Passed)
    }
}

/// Pairs that are classified at once, by all threads, before they are written.
const CHUNK: usize = 4096;

/// Who classifies, with the blocks prepared.
enum Classifier<'b> {
    Exact { blocks: &'b [&'b Block], prepared: Vec<PreparedBlock>, tolerances: &'b ToleranceSet },
    F64 { blocks: &'b [&'b Block], prepared: Vec<PreparedFloatBlock<f64>>, tolerances: Tolerances<f64> },
    F32 { blocks: &'b [&'b Block], prepared: Vec<PreparedFloatBlock<f32>>, tolerances: Tolerances<f32> },
}

impl<'b> Classifier<'b> {
    fn new(
        engine: EngineChoice,
        blocks: &'b [&'b Block],
        tolerances: &'b ToleranceSet,
    ) -> anyhow::Result<Classifier<'b>> {
        Ok(match engine {
            EngineChoice::Exact => {
                let prepared = blocks.par_iter().map(|block| PreparedBlock::new(block)).collect();
                Classifier::Exact { blocks, prepared, tolerances }
            }
            EngineChoice::F64 => {
                let tolerances = Tolerances::new(tolerances)?;
                Classifier::F64 { blocks, prepared: prepared_in_floats(blocks)?, tolerances }
            }
            EngineChoice::F32 => {
                let tolerances = Tolerances::new(tolerances)?;
                Classifier::F32 { blocks, prepared: prepared_in_floats(blocks)?, tolerances }
            }
        })
    }

    /// The contacts of pairs in their order, with what they amount to where `combined` asks for it; `done` counts pairs. No more than some
    /// thousand pairs are held at once.
    fn all(&self, pairs: &[(usize, usize)], done: &AtomicU64, combined: bool) -> impl Iterator<Item = PairContacts> {
        pairs.chunks(CHUNK).flat_map(move |chunk| {
            let classified = |&pair: &(usize, usize)| {
                let found = self.pair(pair, combined);
                done.fetch_add(1, Ordering::Relaxed);
                found
            };
            chunk.par_iter().map(classified).collect::<Vec<_>>()
        })
    }

    fn pair(&self, (i, j): (usize, usize), combined: bool) -> PairContacts {
        let (blocks, found) = match self {
            Classifier::Exact { blocks, prepared, tolerances } => {
                let pair = Pair::new(&prepared[i], &prepared[j]);
                let with_gap = |contact: Contact| {
                    let gap = pair.gap(&contact.entrance);
                    let size = gap.squared.sqrt_rounded().unwrap_or(f64::INFINITY);
                    (contact, if gap.sign == Sign::Negative { -size } else { size })
                };
                (blocks, pair.classify(tolerances).contacts.into_iter().map(with_gap).collect())
            }
            Classifier::F64 { blocks, prepared, tolerances } => {
                (blocks, in_floats(&prepared[i], &prepared[j], tolerances))
            }
            Classifier::F32 { blocks, prepared, tolerances } => {
                (blocks, in_floats(&prepared[i], &prepared[j], tolerances))
            }
        };
        let contacts: Vec<Contact> = found.iter().map(|(contact, _): &(Contact, f64)| *contact).collect();
        let combined = if combined { combinations(blocks[i], blocks[j], &contacts) } else { Vec::new() };
        PairContacts { a: i, b: j, found, combined }
    }
}

fn prepared_in_floats<R: Real>(blocks: &[&Block]) -> anyhow::Result<Vec<PreparedFloatBlock<R>>> {
    blocks
        .iter()
        .enumerate()
        .map(|(n, b)| PreparedFloatBlock::<R>::new(b).with_context(|| format!("block {n}")))
        .collect()
}

fn in_floats<R: Real + Into<f64>>(
    a: &PreparedFloatBlock<R>,
    b: &PreparedFloatBlock<R>,
    tolerances: &Tolerances<R>,
) -> Vec<(Contact, f64)> {
    classify::<R, SpecRules>(a, b, tolerances).into_iter().map(|f| (f.contact, f.gap.into())).collect()
}

const COLUMNS: [&str; 10] = [
    "block_a",
    "block_b",
    "kind",
    "feature_a",
    "feature_b",
    "entrance",
    "entrance_a",
    "entrance_b",
    "gap_sign",
    "gap_m",
];

/// A contact's row in the order of [`COLUMNS`].
fn row(pair: &PairContacts, contact: &Contact, gap_m: f64) -> [String; 10] {
    let [a, b] = contact.key.numbers().map(|number| number.to_string());
    let [entrance_a, entrance_b] = contact.entrance.numbers().map(|number| number.to_string());
    [
        pair.a.to_string(),
        pair.b.to_string(),
        contact.kind().to_string(),
        a,
        b,
        contact.entrance.kind().to_string(),
        entrance_a,
        entrance_b,
        contact.gap.as_i8().to_string(),
        format!("{gap_m:?}"),
    ]
}

fn write_csv(out: &mut dyn Write, pairs: impl Iterator<Item = PairContacts>) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS).map_err(cause_of)?;
    for pair in pairs {
        for (contact, gap_m) in &pair.found {
            writer.write_record(row(&pair, contact, *gap_m)).map_err(cause_of)?;
        }
    }
    writer.flush()
}

/// What the system said, which tells a reader that went away from a full disk; a writer of CSV wraps it.
fn cause_of(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        kind => io::Error::other(format!("{kind:?}")),
    }
}

fn write_table(out: &mut Vec<u8>, found: impl Iterator<Item = PairContacts>, examined: usize) -> io::Result<()> {
    let (mut contacts, mut joined, mut touching) = (Vec::new(), Vec::new(), 0);
    for pair in found {
        touching += usize::from(!pair.found.is_empty());
        contacts.extend(pair.found.iter().map(|(contact, gap_m)| row(&pair, contact, *gap_m).to_vec()));
        joined.extend(pair.combined.iter().map(|combination| {
            let [a, b, count] = [pair.a, pair.b, combination.contacts.len()].map(|n| n.to_string());
            let [fa, fb] = combination.joins.numbers().map(|n| n.to_string());
            vec![a, b, combination.joins.kind().to_string(), fa, fb, count]
        }));
    }
    let count = contacts.len();
    let header =
        ["block A", "block B", "kind", "feature A", "feature B", "entrance", "of A", "of B", "gap sign", "gap (m)"];
    writeln!(out, "{}", table(&header, &[0, 1, 3, 4, 6, 7, 8, 9], contacts))?;
    if !joined.is_empty() {
        let header = ["block A", "block B", "combination", "feature A", "feature B", "contacts"];
        writeln!(out, "\n{}", table(&header, &[0, 1, 3, 4, 5], joined))?;
    }
    let [contacts, pairs, examined_pairs] =
        [(count, "contact", "contacts"), (touching, "pair", "pairs"), (examined, "pair", "pairs")]
            .map(|(count, one, many)| format!("{count} {}", noun(count, one, many)));
    writeln!(out, "\n{contacts} in {pairs}; {examined_pairs} of neighbours examined")
}

/// A contact for programs, without its gap's size.
pub(crate) fn contact_json(c: &Contact) -> Value {
    let ([a, b], [entrance_a, entrance_b]) = (c.key.numbers(), c.entrance.numbers());
    json!({
        "kind": c.kind().name(), "feature_a": a, "feature_b": b, "entrance": c.entrance.kind().name(),
        "entrance_a": entrance_a, "entrance_b": entrance_b, "gap_sign": c.gap.as_i8(),
    })
}

/// Pairs as a list in JSON, each worked out when it is written.
struct Listed<I>(RefCell<I>);

impl<I: Iterator<Item = PairContacts>> Serialize for Listed<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut pairs = self.0.borrow_mut();
        let touching = pairs.by_ref().filter(|pair| !pair.found.is_empty());
        serializer.collect_seq(touching.map(|pair| pair_json(&pair)))
    }
}

fn pair_json(pair: &PairContacts) -> Value {
    let contact = |(c, gap_m): &(Contact, f64)| {
        let mut document = contact_json(c);
        document["gap_m"] = (*gap_m).into();
        document
    };
    let combination = |c: &Combination| {
        let [a, b] = c.joins.numbers();
        json!({ "kind": c.joins.kind().name(), "feature_a": a, "feature_b": b, "contacts": c.contacts })
    };
    json!({
        "block_a": pair.a, "block_b": pair.b,
        "contacts": pair.found.iter().map(contact).collect::<Vec<_>>(),
        "combinations": pair.combined.iter().map(combination).collect::<Vec<_>>(),
    })
}

/// What `--format json` prints.
#[derive(Serialize)]
struct ClassifyDocument<P: Serialize> {
    overlaps: Value,
    pairs: P,
}

fn write_json(mut out: &mut dyn Write, overlaps: Value, pairs: impl Iterator<Item = PairContacts>) -> io::Result<()> {
    let document = ClassifyDocument { overlaps, pairs: Listed(RefCell::new(pairs)) };
    serde_json::to_writer_pretty(&mut out, &document)?;
    writeln!(out)
}
