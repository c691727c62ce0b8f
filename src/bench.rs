//! `bench`: what classification costs, in floating point and exactly, and what a campaign manages.

// Longer than 400 lines: one command and the table of each measure that it prints.

use crate::exit::{ExitStatus, Outcome, print, print_json, print_note};
use crate::table::{counted, grouped, table};
use clap::ValueEnum;
use rockproof_bench::accuracy::{self, AccuracyOptions, AccuracyRow};
use rockproof_bench::exact_stepping::scenes;
use rockproof_bench::plot::PlotError;
use rockproof_bench::{
    BenchEntry, SKIPS, Sample, SampleKind, SteppingCost, Throughput, ThroughputRun, TimedPart, Timing, TimingPlan,
    bench_entries, exact_stepping, rock, skip_cost, skip_scenes, stack, stepping, throughput, time_interleaved, wall,
};
use rockproof_model::simulation::Solver;
use rockproof_model::{BlockError, Motion, Precision, Scene};
use rockproof_report::latex::latex;
use rockproof_report::table::{Table, TableCell};
use rockproof_results::{Claim, Directory, FileKind, Owner, Start};
use serde_json::{Map, Value, json};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Measure classification in f32, f64, exactly and in plain rationals, and the speed of campaigns
///
/// All engines take turns on the same pairs within one run, so that their ratios hold on a machine that is busy with
/// other things. The generic pairs hold no exact tie; the directed ones are at or near the boundary of a decision.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof bench                            two minutes or three
  rockproof bench --format csv > speed.csv
  rockproof bench --wall 100,1000 --format latex > walls.tex
  rockproof bench --quick --format json
  rockproof bench --quick                    a few seconds, rough figures
  rockproof bench --error --out reports/bench  run time against error, as CSV and plots (docs/bench.md)
  rockproof bench --wall 100,1000,5000       steps of brick walls: time, shares of the phases in %, memory
  rockproof bench --stack 1000               steps of cubes on one another; memory is sure with one scene at a time
  rockproof bench --rock 1000 --rigid        steps of rock cut by joints, of rigid blocks
  rockproof bench --skips                    what steps gain by leaving out what cannot have changed
  rockproof bench --exact-steps              certified steps of two blocks and of walls, beside those in f64

Plain rationals of GMP take part in a build with --features gmp.

CSV columns: measure (classify, prepare+classify, prepare or campaign), sample, engine, pairs, us_per_pair, ratio_to_f64,
ratio_to_certified, the share of signs each level of the oracle decided (f64 … heap), pairs_per_second, findings.

Exit status: 0 done, 2 usage error, or exact engines that disagree.")]
pub(crate) struct Bench {
    /// How the figures are printed
    #[arg(long, value_enum, default_value_t = OutputFormat::Table)]
    format: OutputFormat,
    /// Pairs of each sort
    #[arg(long, default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pairs: u32,
    /// Seed of all pairs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Worker threads of the campaigns
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Few pairs and rounds
    #[arg(long, conflicts_with = "pairs")]
    quick: bool,
    /// Measure run time against error instead: scenes with closed forms, and pairs, by every engine, tolerance set and Δt
    #[arg(long, conflicts_with_all = ["wall", "stack", "rock", "threads"])]
    error: bool,
    /// Directory for bench.csv, its front as a table for a paper (bench.tex), and the plots bench_scenes.svg and bench_pairs.svg
    #[arg(long, requires = "error")]
    out: Option<PathBuf>,
    /// Discard the measurements in the directory; other files there stay
    #[arg(long, requires = "out")]
    overwrite: bool,
    /// Measure the steps of brick walls instead, of so many bricks; may be repeated
    #[arg(long, value_name = "BRICKS", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=20_000))]
    wall: Vec<u16>,
    /// The same of cubes on one another; may be repeated
    #[arg(long, value_name = "CUBES", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=20_000))]
    stack: Vec<u16>,
    /// The same of rock cut by joints, of so many blocks; may be repeated
    #[arg(long, value_name = "BLOCKS", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=20_000))]
    rock: Vec<u16>,
    /// Rigid blocks in walls, stacks and rock, instead of deformable ones
    #[arg(long)]
    rigid: bool,
    /// Steps of walls, stacks and rock in single precision
    #[arg(long)]
    single: bool,
    /// How steps of walls, stacks and rock solve their systems: auto, factor, conjugate-gradients
    #[arg(long, default_value = "auto", value_name = "SOLVER", value_parser = crate::simulate::solver)]
    solver: Solver,
    /// Measure certified steps instead: of two blocks, and of walls of 10 and 100 bricks
    #[arg(long, conflicts_with_all = ["wall", "stack", "rock"])]
    exact_steps: bool,
    /// Measure what steps gain by leaving out what cannot have changed: where ten blocks of 5,000 move, where a wall stands, where all fly
    #[arg(long, conflicts_with_all = ["wall", "stack", "rock", "error", "exact_steps"])]
    skips: bool,
    /// Steps of each wall, or of each scene
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    steps: u32,
}

/// The files of run time against error.
const FILES: [&str; 4] = ["bench.csv", "bench.tex", "bench_scenes.svg", "bench_pairs.svg"];

#[derive(Clone, Copy, ValueEnum)]
enum OutputFormat {
    Table,
    Csv,
    /// One document (docs/formats.md)
    Json,
    /// The printed tables for a paper
    Latex,
}

/// A table as it is printed.
struct PrintedTable {
    name: &'static str,
    caption: &'static str,
    header: Vec<&'static str>,
    /// The columns that hold numbers.
    numbers: Vec<usize>,
    rows: Vec<Vec<String>>,
}

impl PrintedTable {
    /// For people.
    fn text(&self) -> String {
        table(&self.header, &self.numbers, self.rows.iter().cloned())
    }

    /// For a paper.
    fn latex(&self) -> String {
        let mut table = Table::new(self.name, self.caption, &self.header);
        for row in &self.rows {
            let cell = |(column, text): (usize, &String)| match self.numbers.contains(&column) {
                true => cell(text),
                false => TableCell::Text(text.clone()),
            };
            table.push(row.iter().enumerate().map(cell).collect());
        }
        latex(&table, usize::MAX)
    }
}

/// Makes a scene of so many blocks.
type Make = fn(u16) -> Result<Scene, BlockError>;

/// Everything measured.
struct Report {
    races: Vec<(Sample, Vec<Timing>)>,
    campaigns: Vec<Throughput>,
}

impl Bench {
    pub(crate) fn run(&self) -> Outcome {
        if !(self.wall.is_empty() && self.stack.is_empty() && self.rock.is_empty()) {
            return self.steps();
        }
        if self.error {
            return self.errors();
        }
        if self.exact_steps {
            return self.exact_steps();
        }
        if self.skips {
            return self.skips();
        }
        let report = self.measure()?;
        self.print("classification", &tables(&report), ["", ""], || as_csv(&report))
    }

    /// Prints what was measured in the form asked for; before and after tables for people stand `around`.
    fn print(
        &self,
        measure: &str,
        tables: &[PrintedTable],
        around: [&str; 2],
        csv: impl FnOnce() -> anyhow::Result<String>,
    ) -> Outcome {
        let all =
            |one: fn(&PrintedTable) -> String, between: &str| tables.iter().map(one).collect::<Vec<_>>().join(between);
        match self.format {
            OutputFormat::Table => {
                print(&format!("{}{}\n{}", around[0], all(PrintedTable::text, "\n\n"), around[1]))?;
            }
            OutputFormat::Latex => print(&all(PrintedTable::latex, "\n"))?,
            OutputFormat::Csv => print(&csv()?)?,
            OutputFormat::Json => print_json(&as_json(measure, &csv()?)?)?,
        }
        Ok(ExitStatus::Passed)
    }

    /// Scenes from small to large, so that the most memory held is mostly that of the last one.
    fn steps(&self) -> Outcome {
        let kinds: [(&str, Make, &[u16]); 3] =
            [("stack", stack, &self.stack), ("wall", wall, &self.wall), ("rock", rock, &self.rock)];
        let of_kind = |(name, make, sizes): (&'static str, Make, &'_ [u16])| -> Vec<(&str, Make, u16)> {
            sizes.iter().map(|&blocks| (name, make, blocks)).collect()
        };
        let mut scenes: Vec<(&str, Make, u16)> = kinds.into_iter().flat_map(of_kind).collect();
        scenes.sort_by_key(|&(_, _, blocks)| blocks);
        let mut rows = Vec::new();
        for (name, scene, blocks) in scenes {
            print_note(&format!(
                "{} of {name} {}",
                counted(self.steps.into(), "step", "steps"),
                grouped(blocks.into())
            ));
            let make = || {
                let mut scene = scene(blocks)?;
                let moving = scene.blocks.iter_mut().filter(|block| self.rigid && !block.body.is_fixed());
                moving.for_each(|block| block.body.motion = Motion::Rigid);
                scene.simulation.control.solver = self.solver;
                Ok(scene)
            };
            let cost = match self.single {
                true => stepping::<f32>(make, self.steps, Precision::F32)?,
                false => stepping::<f64>(make, self.steps, Precision::F64)?,
            };
            let micros = 1e6 * cost.step;
            let mut row = vec![name.to_owned(), grouped(cost.blocks as u64), grouped(cost.contacts as u64)];
            row.extend([cost.retries, cost.solves, micros / 1e3].map(digits));
            row.push(cost.processor.map_or(String::new(), |s| digits(1e3 * s)));
            row.push(digits(micros / cost.blocks as f64));
            row.extend(cost.shares.map(|share| digits(100.0 * share)));
            row.push(cost.memory.map_or(String::new(), |m| digits(m as f64 / 1000.0 / cost.blocks as f64)));
            rows.push(row);
        }
        let mut header = vec![
            "scene",
            "blocks",
            "contacts",
            "retries a step",
            "solves a step",
            "ms a step",
            "processor ms",
            "µs a block",
        ];
        header.extend(SteppingCost::PHASES);
        header.push("kB a block");
        let table = PrintedTable {
            name: "bench_steps",
            caption: "Steps of brick walls, stacks and rock; the phases in % of a step",
            numbers: (1..header.len()).collect(),
            header,
            rows,
        };
        self.print_one("steps", table)
    }

    /// What is gained by what steps leave out.
    fn skips(&self) -> Outcome {
        let mut rows = Vec::new();
        for scene in skip_scenes(self.quick) {
            print_note(&format!(
                "{} steps of {} blocks: {}",
                scene.steps,
                grouped(u64::from(scene.blocks)),
                scene.name
            ));
            let cost = skip_cost(&scene)?;
            for ((skips, _), (rate, processor)) in SKIPS.iter().zip(cost.rates.iter().zip(cost.processor)) {
                let mut row = vec![scene.name.to_owned(), grouped(cost.blocks as u64), (*skips).to_owned()];
                row.push(digits(*rate));
                row.push(processor.map_or(String::new(), |s| digits(1e3 * s)));
                row.push(digits(rate / cost.rates[SKIPS.len() - 1]));
                rows.push(row);
            }
        }
        let header = ["scene", "blocks", "left out", "steps a second", "processor ms a step", "over nothing left out"];
        let table = PrintedTable {
            name: "bench_skips",
            caption: "What steps gain by leaving out what cannot have changed",
            header: header.to_vec(),
            numbers: vec![1, 3, 4, 5],
            rows,
        };
        self.print_one("skips", table)
    }

    /// Run time against error.
    fn errors(&self) -> Outcome {
        // Of each family, under each preset; plain rationals take their time.
        let pairs = if self.quick { 32 } else { (self.pairs as usize).min(512) };
        let effort = AccuracyOptions { pairs, seed: self.seed, quick: self.quick };
        let start = Start::of(false, self.overwrite);
        let claim = |dir| Directory::claim(Claim { dir, owner: Owner::Bench, start, files: &FILES });
        let directory = self.out.as_deref().map(claim).transpose()?;
        let rows = accuracy::measure(effort, &mut |subject| print_note(&format!("measuring {subject}")))?;
        let csv = accuracy::to_csv(&rows)?;
        let table = front(&rows);
        if let Some(mut directory) = directory {
            let plots = [("bench_scenes.svg", "scene"), ("bench_pairs.svg", "family")];
            let plots = plots.map(|(name, kind)| Ok((name, accuracy::plot(&rows, kind)?.into_bytes())));
            for file in
                plots.into_iter().chain([Ok(("bench.csv", csv.clone())), Ok(("bench.tex", table.latex().into_bytes()))])
            {
                let (name, bytes) = file.map_err(|error: PlotError| anyhow::anyhow!(error))?;
                let kind = match Path::new(name).extension().and_then(OsStr::to_str) {
                    Some("csv") => FileKind::Table,
                    Some("tex") => FileKind::Text,
                    _ => FileKind::Picture,
                };
                directory.write(name, kind, &bytes)?;
            }
        }
        let count = format!("{} rows measured\n", rows.len());
        let around = ["What nothing beats in time and error at once:\n\n", &count];
        self.print("error", &[table], around, || Ok(String::from_utf8(csv)?))
    }

    /// Certified steps beside the stepper's.
    fn exact_steps(&self) -> Outcome {
        let mut rows = Vec::new();
        for (name, scene) in scenes(if self.quick { &[10] } else { &[10, 100] })? {
            print_note(&format!("{} of {name}", counted(self.steps.into(), "step", "steps")));
            let cost = exact_stepping(&name, &scene, self.steps)?;
            let levels = &cost.levels;
            let decided = [levels.float, levels.double, levels.wide.iter().sum(), levels.exact, levels.undecided];
            let total: u64 = decided.iter().sum();
            let mut row = vec![cost.name.clone(), cost.unknowns.to_string(), cost.contacts.to_string()];
            row.push(digits(cost.iterations));
            row.extend([cost.float, cost.conversion, cost.certified, cost.with_state].map(|s| digits(1e6 * s)));
            row.push(cost.plain.map_or(String::new(), |s| digits(1e6 * s)));
            row.extend([digits(cost.over_float()), digits(cost.lockstep())]);
            row.push(cost.plain_over_certified().map_or(String::new(), digits));
            row.extend(decided.map(|n| share(n, total)));
            rows.push(row);
        }
        let header = [
            "scene",
            "unknowns",
            "contacts",
            "solves a step",
            "f64 µs",
            "conversion µs",
            "certified µs",
            "with state µs",
            "plain solve µs",
            "over f64",
            "lockstep",
            "plain over",
            "f64",
            "double",
            "wide",
            "fractions",
            "undecided",
        ];
        let table = PrintedTable {
            name: "bench_exact_steps",
            caption: "Certified steps beside those in f64, and the share of decisions that each level of the oracle took",
            header: header.to_vec(),
            numbers: (1..header.len()).collect(),
            rows,
        };
        self.print_one("exact steps", table)
    }

    /// Prints the one table of a measure, of which the CSV is the same.
    fn print_one(&self, measure: &str, table: PrintedTable) -> Outcome {
        self.print(measure, std::slice::from_ref(&table), ["", ""], || Ok(plain_csv(&table.header, &table.rows)))
    }

    fn measure(&self) -> anyhow::Result<Report> {
        let plan = match self.quick {
            true => TimingPlan { chunk: 16, rounds: 3, slow_rounds: 1, slow_every: 16 },
            false => TimingPlan { chunk: 16, rounds: 15, slow_rounds: 3, slow_every: 16 },
        };
        let pairs = if self.quick { 64 } else { self.pairs as usize };
        let entrants: Vec<BenchEntry> = bench_entries();
        let mut races = Vec::new();
        for kind in SampleKind::ALL {
            print_note(&format!("timing {} {} pairs", grouped(pairs as u64), kind.name()));
            let sample = Sample::new(kind, self.seed, pairs)?;
            let figures = time_interleaved(&sample, &entrants, &plan)?;
            races.push((sample, figures));
        }
        let mut campaigns = Vec::new();
        for (kind, only_alike) in
            [(SampleKind::Generic, true), (SampleKind::Generic, false), (SampleKind::Directed, false)]
        {
            let pairs = match (self.quick, kind) {
                (true, _) => 512,
                (false, SampleKind::Generic) => 65_536,
                (false, SampleKind::Directed) => 8192,
            };
            print_note(&format!("running a campaign on {} {} pairs", grouped(pairs), kind.name()));
            let times = if self.quick { 1 } else { 3 };
            let run = ThroughputRun { kind, seed: self.seed, pairs, threads: self.threads.into(), only_alike, times };
            campaigns.push(throughput(&run, &std::env::temp_dir())?);
        }
        Ok(Report { races, campaigns })
    }
}

/// Three significant digits, and all digits before the point.
fn digits(value: f64) -> String {
    match value {
        v if v.is_nan() => String::new(),
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 100.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

/// What nothing beats in time and error at once, and what was not measured.
fn front(rows: &[AccuracyRow]) -> PrintedTable {
    let told = rows.iter().filter(|row| row.front || !row.note.is_empty()).map(|row| {
        let step = row.time_step.map_or(String::new(), |step| format!("{step:.2e}"));
        let start = [row.subject, row.engine.name(), row.tolerances, &step].map(str::to_owned);
        let figures = [grouped(row.units), digits(row.micros), format!("{:.1e} {}", row.error, row.of.name())];
        let last = if row.note.is_empty() { figures } else { [String::new(), String::new(), row.note.clone()] };
        start.into_iter().chain(last).collect()
    });
    PrintedTable {
        name: "bench",
        caption: "Run time against error: what nothing beats in both at once",
        header: vec!["subject", "engine", "tolerances", "Δt (s)", "steps or pairs", "µs each", "error"],
        numbers: vec![3, 4, 5],
        rows: told.collect(),
    }
}

/// The samples, what classification of them took, and what campaigns managed.
fn tables(report: &Report) -> [PrintedTable; 3] {
    let samples = report.races.iter().map(|(sample, _)| {
        let counts = [sample.pairs.len() as u64, sample.touching, sample.contacts, sample.ties].map(grouped);
        let total = sample.levels.total();
        let shares = sample.levels.by_name().map(|(_, n)| share(n, total));
        let signs = grouped(total / sample.pairs.len().max(1) as u64);
        [sample.kind.name().to_owned()].into_iter().chain(counts).chain([signs]).chain(shares).collect()
    });
    let mut header = vec!["sample", "pairs", "touching", "contacts", "with ties", "signs a pair"];
    header.extend(rockproof_oracle::LevelCounts::default().by_name().map(|(name, _)| name));
    let samples = PrintedTable {
        name: "bench_samples",
        caption: "The pairs, and the share of signs that each level of the oracle decided",
        numbers: (1..header.len()).collect(),
        header,
        rows: samples.collect(),
    };
    let times = report.races.iter().flat_map(|(sample, figures)| {
        figures.iter().map(|figure| {
            vec![
                sample.kind.name().to_owned(),
                figure.mode.name().to_owned(),
                figure.engine.to_owned(),
                grouped(figure.pairs as u64),
                digits(figure.micros),
                digits(figure.to_f64),
                digits(figure.to_certified),
            ]
        })
    });
    let times = PrintedTable {
        name: "bench_times",
        caption: "What classification takes",
        header: vec!["sample", "work", "engine", "pairs", "µs a pair", "over f64", "over certified"],
        numbers: vec![3, 4, 5, 6],
        rows: times.collect(),
    };
    let campaigns = report.campaigns.iter().map(|campaign| {
        vec![
            campaign_name(campaign).to_owned(),
            campaign.run.threads.to_string(),
            grouped(campaign.pairs),
            digits(campaign.examined as f64 / campaign.pairs.max(1) as f64),
            grouped(campaign.findings),
            grouped(campaign.pairs_with_findings),
            grouped(campaign.pairs_per_second as u64),
            digits(campaign.signs_per_pair),
        ]
    });
    let header = [
        "campaign",
        "threads",
        "pairs",
        "sets a pair",
        "findings",
        "pairs that differ",
        "pairs a second",
        "signs a pair",
    ];
    let campaigns = PrintedTable {
        name: "bench_campaigns",
        caption: "What campaigns manage",
        header: header.to_vec(),
        numbers: (1..header.len()).collect(),
        rows: campaigns.collect(),
    };
    [samples, times, campaigns]
}

/// What a campaign ran on.
fn campaign_name(campaign: &Throughput) -> &'static str {
    match (campaign.run.kind, campaign.run.only_alike) {
        (SampleKind::Generic, true) => "generic, nothing differs",
        (SampleKind::Generic, false) => "generic",
        (SampleKind::Directed, true) => "directed, nothing differs",
        (SampleKind::Directed, false) => "directed",
    }
}

/// A share in percent: enough digits to see a small one.
fn share(count: u64, total: u64) -> String {
    match count {
        0 => "0".to_owned(),
        n => format!("{:.3} %", 100.0 * n as f64 / total as f64),
    }
}

/// The rows of a table without the spaces that part thousands.
fn plain_csv(header: &[&str], rows: &[Vec<String>]) -> String {
    let lines = rows.iter().map(|row| row.join(",").replace('\u{202f}', "") + "\n");
    lines.fold(header.join(",") + "\n", |all, line| all + &line)
}

/// The same figures as the CSV: an object for each row.
fn as_json(measure: &str, csv: &str) -> anyhow::Result<Value> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let keys: Vec<String> =
        reader.headers()?.iter().map(|name| name.replace('µ', "u").replace([' ', '-'], "_")).collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let cells = record?;
        rows.push(keys.iter().cloned().zip(cells.iter().map(figure)).collect::<Map<String, Value>>());
    }
    Ok(json!({ "measure": measure, "rows": rows }))
}

/// A cell for programs.
fn figure(text: &str) -> Value {
    match cell(text) {
        TableCell::Empty => Value::Null,
        TableCell::Count(count) => count.into(),
        TableCell::Share(number) | TableCell::Number(number) | TableCell::Setting(number) => number.into(),
        TableCell::Text(text) | TableCell::Scope(text) => text.into(),
    }
}

/// What a cell holds: counts and other numbers, percentages as shares, texts; nothing where it is empty.
fn cell(text: &str) -> TableCell {
    let plain = text.replace('\u{202f}', "");
    if plain.is_empty() {
        return TableCell::Empty;
    }
    if let Ok(count) = plain.parse::<u64>() {
        return TableCell::Count(count);
    }
    if let Some(percent) = plain.strip_suffix(" %").and_then(|text| text.parse::<f64>().ok()) {
        return TableCell::Share(percent / 100.0);
    }
    plain.parse::<f64>().map_or_else(|_| TableCell::Text(text.to_owned()), TableCell::Number)
}

fn as_csv(report: &Report) -> anyhow::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let levels = rockproof_oracle::LevelCounts::default().by_name().map(|(name, _)| name);
    let before = ["measure", "sample", "engine", "pairs", "us_per_pair", "ratio_to_f64", "ratio_to_certified"];
    writer.write_record(before.iter().chain(&levels).chain(&["pairs_per_second", "findings"]))?;
    let number = |value: f64| if value.is_nan() { String::new() } else { format!("{value:.4}") };
    for (sample, figures) in &report.races {
        for figure in figures {
            let mut row = vec![
                figure.mode.name().to_owned(),
                sample.kind.name().to_owned(),
                figure.engine.to_owned(),
                figure.pairs.to_string(),
                number(figure.micros),
                number(figure.to_f64),
                number(figure.to_certified),
            ];
            let filtered = figure.engine == "certified" && figure.mode != TimedPart::Preparation;
            let total = sample.levels.total().max(1) as f64;
            row.extend(
                sample
                    .levels
                    .by_name()
                    .map(|(_, count)| if filtered { format!("{:.8}", count as f64 / total) } else { String::new() }),
            );
            row.extend([String::new(), String::new()]);
            writer.write_record(&row)?;
        }
    }
    for campaign in &report.campaigns {
        let mut row = ["campaign", campaign_name(campaign), "stepper-f32 and stepper-f64"].map(str::to_owned).to_vec();
        row.extend([campaign.pairs.to_string(), number(1e6 / campaign.pairs_per_second)]);
        row.extend(std::iter::repeat_n(String::new(), 2 + levels.len()));
        row.extend([number(campaign.pairs_per_second), campaign.findings.to_string()]);
        writer.write_record(&row)?;
    }
    Ok(String::from_utf8(writer.into_inner().map_err(|e| e.into_error())?)?)
}
