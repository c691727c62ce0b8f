//! `classify`: the contacts between the blocks of a file.

use crate::exit::{Outcome, Verdict, print};
use crate::input::{ReadArgs, ToleranceArgs, model_help};
use crate::input_file::InputFile;
use crate::overlaps::overlaps;
use crate::table::table;
use anyhow::Context;
use clap::ValueEnum;
use rayon::prelude::*;
use rockproof_differential::neighbours::neighbours;
use rockproof_model::{Block, Contact, Precision, Sign, ToleranceSet};
use rockproof_oracle::combination::{Combination, combinations};
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_stepper::Real;
use rockproof_stepper::contact::{PreparedBlock as FloatSolid, SpecRules, Tolerances, classify};
use serde_json::{Value, json};
use std::io::{self, Write};

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
        let found = match self.engine {
            EngineChoice::Exact => exactly(&blocks, &pairs, &tolerances),
            EngineChoice::F64 => in_floats::<f64>(&blocks, &pairs, &tolerances).with_context(place)?,
            EngineChoice::F32 => in_floats::<f32>(&blocks, &pairs, &tolerances).with_context(place)?,
        };
        let mut out = Vec::new();
        match self.format {
            OutputFormat::Table => write_table(&mut out, &found).and_then(|()| {
                // Blocks that overlap deeper than any contact says are the first thing to know of a model.
                writeln!(out, "{}", overlaps(&blocks, &tolerances, Some(&pairs)).line())
            }),
            OutputFormat::Csv => write_csv(&mut out, &found),
            OutputFormat::Json => write_json(&mut out, &found),
        }?;
        print(&String::from_utf8_lossy(&out))?;
        Ok(Verdict::Passed)
    }
}

fn exactly(blocks: &[&Block], pairs: &[(usize, usize)], tolerances: &ToleranceSet) -> Vec<PairContacts> {
    let solids: Vec<PreparedBlock> = blocks.iter().map(|b| PreparedBlock::new(b)).collect();
    pairs
        .par_iter()
        .map(|&(i, j)| {
            let pair = Pair::new(&solids[i], &solids[j]);
            let with_gap = |contact: Contact| {
                let gap = pair.gap(&contact.entrance);
                let size = gap.squared.sqrt_rounded().unwrap_or(f64::INFINITY);
                (contact, if gap.sign == Sign::Negative { -size } else { size })
            };
            let found = pair.classify(tolerances).contacts.into_iter().map(with_gap).collect();
            with_combinations(blocks, (i, j), found)
        })
        .collect()
}

fn in_floats<R: Real + Into<f64> + Send + Sync>(
    blocks: &[&Block],
    pairs: &[(usize, usize)],
    tolerances: &ToleranceSet,
) -> anyhow::Result<Vec<PairContacts>> {
    let tolerances = Tolerances::<R>::new(tolerances)?;
    let solids = blocks
        .iter()
        .enumerate()
        .map(|(n, b)| FloatSolid::<R>::new(b).with_context(|| format!("block {n}")))
        .collect::<Result<Vec<_>, _>>()?;
    let contacts = |&(i, j): &(usize, usize)| {
        let found = classify::<R, SpecRules>(&solids[i], &solids[j], &tolerances);
        with_combinations(blocks, (i, j), found.into_iter().map(|f| (f.contact, f.gap.into())).collect())
    };
    Ok(pairs.iter().map(contacts).collect())
}

fn with_combinations(blocks: &[&Block], (a, b): (usize, usize), found: Vec<(Contact, f64)>) -> PairContacts {
    let contacts: Vec<Contact> = found.iter().map(|(contact, _)| *contact).collect();
    PairContacts { a, b, combined: combinations(blocks[a], blocks[b], &contacts), found }
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

fn write_csv(out: &mut impl Write, pairs: &[PairContacts]) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    for pair in pairs {
        for (contact, gap_m) in &pair.found {
            writer.write_record(row(pair, contact, *gap_m))?;
        }
    }
    writer.flush()
}

fn write_table(out: &mut impl Write, pairs: &[PairContacts]) -> io::Result<()> {
    let rows = pairs.iter().flat_map(|p| p.found.iter().map(move |(c, gap)| row(p, c, *gap).to_vec()));
    let header =
        ["block A", "block B", "kind", "feature A", "feature B", "entrance", "of A", "of B", "gap sign", "gap (m)"];
    writeln!(out, "{}", table(&header, &[0, 1, 3, 4, 6, 7, 8, 9], rows))?;
    let rows: Vec<Vec<String>> = pairs
        .iter()
        .flat_map(|p| p.combined.iter().map(move |c| (p, c)))
        .map(|(p, c)| {
            let [a, b, count] = [p.a, p.b, c.contacts.len()].map(|n| n.to_string());
            let [fa, fb] = c.joins.numbers().map(|n| n.to_string());
            vec![a, b, c.joins.kind().to_string(), fa, fb, count]
        })
        .collect();
    if !rows.is_empty() {
        let header = ["block A", "block B", "combination", "feature A", "feature B", "contacts"];
        writeln!(out, "\n{}", table(&header, &[0, 1, 3, 4, 5], rows))?;
    }
    let contacts: usize = pairs.iter().map(|p| p.found.len()).sum();
    let touching = pairs.iter().filter(|p| !p.found.is_empty()).count();
    writeln!(out, "\n{contacts} contacts in {touching} pairs; {} pairs of neighbours examined", pairs.len())
}

/// A contact for programs, without its gap's size.
pub(crate) fn contact_json(c: &Contact) -> Value {
    let ([a, b], [entrance_a, entrance_b]) = (c.key.numbers(), c.entrance.numbers());
    json!({
        "kind": c.kind().name(), "feature_a": a, "feature_b": b, "entrance": c.entrance.kind().name(),
        "entrance_a": entrance_a, "entrance_b": entrance_b, "gap_sign": c.gap.as_i8(),
    })
}

fn write_json(out: &mut impl Write, pairs: &[PairContacts]) -> io::Result<()> {
    let contact = |(c, gap_m): &(Contact, f64)| {
        let mut document = contact_json(c);
        document["gap_m"] = (*gap_m).into();
        document
    };
    let combination = |c: &Combination| {
        let [a, b] = c.joins.numbers();
        json!({ "kind": c.joins.kind().name(), "feature_a": a, "feature_b": b, "contacts": c.contacts })
    };
    let touching: Vec<Value> = pairs
        .iter()
        .filter(|p| !p.found.is_empty())
        .map(|p| {
            json!({
                "block_a": p.a, "block_b": p.b,
                "contacts": p.found.iter().map(contact).collect::<Vec<_>>(),
                "combinations": p.combined.iter().map(combination).collect::<Vec<_>>(),
            })
        })
        .collect();
    serde_json::to_writer_pretty(&mut *out, &json!({ "pairs": touching }))?;
    writeln!(out)
}
