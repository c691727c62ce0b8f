//! What an examination leaves in its directory.

use crate::assess::{Examination, plural};
use crate::cases::KeptCase;
use crate::checked::violations_text;
use crate::document::document;
use crate::error::ExamineError;
use crate::naming::Naming;
use crate::pairs::EngineDifferences;
use crate::recommend::Recommendation;
use crate::verdict::{NOT_DECIDED, Verdict, mark, title};
use crate::view::{BlockStatus, block_statuses, views};
use rockproof_model::vtu_writer::{DataArray, SCALAR, vtu};
use rockproof_model::{Precision, ToleranceSet};
use rockproof_oracle::audit::{Overlap, OverlapSeverity};
use rockproof_report::Report;
use rockproof_report::latex::{MAX_ROWS, latex};
use rockproof_report::page::page;
use rockproof_report::sections::{Section, SectionPart};
use rockproof_report::table::{Table, TableCell};
use rockproof_report::verdict::{Severity, VerdictLine};
use rockproof_results::{Directory, FileKind};
use rockproof_simulate::frame;
use rockproof_tune::report::as_toml;
use serde_json::Value;
use std::collections::BTreeMap;

/// The files that are always written.
pub const FILES: [&str; 9] = [
    "index.html",
    "examine.md",
    "examine.json",
    "blocks.vtu",
    "pairs.csv",
    "tolerances.toml",
    "tolerances.csv",
    "pairs.tex",
    "tolerances.tex",
];
/// Rows of pairs in the page, and in the text.
const EXCERPT_LENGTH: [usize; 2] = [200, 20];

/// Everything that was found of one pair under the set given.
pub(crate) struct PairFacts<'f> {
    /// The blocks, the lower number first.
    pub(crate) blocks: [usize; 2],
    /// The overlap at the start.
    pub(crate) overlap: Option<(&'f Overlap, OverlapSeverity)>,
    /// What differs in f32 and in f64.
    pub(crate) engines: Option<&'f [EngineDifferences; 2]>,
    /// Contacts that the tolerances change.
    pub(crate) tolerance: u64,
    /// The depth of a passage within the steps (m).
    pub(crate) passage_m: Option<f64>,
    /// The penetration after a step where no contact saw it (m).
    pub(crate) unseen_m: Option<f64>,
    precision: Precision,
}

/// What differs of a pair that was not near at the start.
static NOTHING: EngineDifferences =
    EngineDifferences { representation: 0, arithmetic: 0, defects: 0, broken: 0, worst: None };

impl<'f> PairFacts<'f> {
    /// What differs in a precision.
    pub(crate) fn in_precision(&self, precision: Precision) -> &EngineDifferences {
        self.engines.map_or(&NOTHING, |engines| &engines[usize::from(precision == Precision::F64)])
    }

    /// What differs in the precision that the model is to be safe in.
    pub(crate) fn asked(&self) -> &EngineDifferences {
        self.in_precision(self.precision)
    }

    /// The penetration at the start (m), where the blocks overlap.
    pub(crate) fn depth_m(&self) -> Option<f64> {
        self.overlap.map(|(overlap, _)| overlap.penetration.depth_m().unwrap_or(f64::INFINITY))
    }

    /// All neighbouring pairs, and those that met in the steps, in ascending order.
    pub(crate) fn all(found: &'f Examination) -> Vec<PairFacts<'f>> {
        let mut all: BTreeMap<[usize; 2], PairFacts<'f>> = BTreeMap::new();
        let empty = |blocks: [usize; 2]| PairFacts {
            blocks,
            overlap: None,
            engines: None,
            tolerance: 0,
            passage_m: None,
            unseen_m: None,
            precision: found.model.precision,
        };
        for pair in &found.given.pairs {
            let facts = PairFacts { engines: Some(&pair.engines), tolerance: pair.tolerance, ..empty(pair.blocks) };
            all.insert(pair.blocks, facts);
        }
        for (overlap, severity) in found.given.overlaps.all() {
            all.entry(overlap.blocks).or_insert_with(|| empty(overlap.blocks)).overlap = Some((overlap, severity));
        }
        if let Some(made) = found.given.steps.made() {
            for (&blocks, &depth) in &made.passages {
                all.entry(blocks).or_insert_with(|| empty(blocks)).passage_m = Some(depth);
            }
            for (&blocks, &depth) in &made.unseen {
                all.entry(blocks).or_insert_with(|| empty(blocks)).unseen_m = Some(depth);
            }
        }
        all.into_values().collect()
    }

    fn cells(&self) -> Vec<TableCell> {
        let (f32, f64) = (self.in_precision(Precision::F32), self.in_precision(Precision::F64));
        let asked = self.asked().worst.as_ref();
        let worst = asked.or(f64.worst.as_ref()).or(f32.worst.as_ref());
        let text = |text: Option<String>| text.map_or(TableCell::Empty, TableCell::Text);
        let [a, b] = self.blocks.map(|block| TableCell::Count(block as u64));
        vec![
            a,
            b,
            TableCell::number(self.depth_m()),
            text(self.overlap.map(|(_, severity)| severity.name().to_owned())),
            text(self.overlap.map(|(overlap, _)| overlap.sight.name().to_owned())),
            f32.total().into(),
            f32.broken.into(),
            f64.total().into(),
            f64.broken.into(),
            self.tolerance.into(),
            text(worst.map(|finding| finding.scope.to_string())),
            text(worst.map(|finding| finding.cause.to_string())),
            text(worst.map(|finding| finding.difference.change.to_string())),
            text(worst.and_then(|finding| finding.predicate()).map(|predicate| predicate.to_string())),
            TableCell::number(worst.and_then(|finding| finding.margin_ulps())),
            TableCell::number(self.passage_m),
            TableCell::number(self.unseen_m),
        ]
    }
}

/// The columns of `pairs.csv`.
const COLUMNS: [&str; 17] = [
    "block_a",
    "block_b",
    "overlap_m",
    "overlap",
    "contacts_see_it",
    "f32_differ",
    "f32_broken",
    "f64_differ",
    "f64_broken",
    "tolerances_change",
    "worst_engine",
    "worst_cause",
    "worst_change",
    "worst_predicate",
    "worst_roundoffs",
    "passage_m",
    "unseen_after_step_m",
];

/// What was written.
#[derive(Clone, Debug)]
pub struct WrittenFiles {
    /// The document of `--format json`.
    pub document: Value,
    /// The files.
    pub names: Vec<String>,
}

/// Writes everything.
///
/// # Errors
/// When a file cannot be made or written.
pub fn write(
    (found, naming): (&Examination, &Naming),
    verdict: &Verdict,
    cases: &[KeptCase],
    directory: &mut Directory,
) -> Result<WrittenFiles, ExamineError> {
    let pairs = PairFacts::all(found);
    let block_statuses = block_statuses(found, &pairs);
    let all = table_of(pairs.iter());
    let ranked = ranked(&pairs);
    let worst = |most: usize| table_of(ranked.iter().take(most).copied());
    let tolerances = tolerance_table(found);
    let views = views((found, naming), (&pairs, &block_statuses), (cases, directory.path()));
    let report = Report {
        title: title(found),
        verdict: lines(verdict),
        sections: vec![
            Section {
                id: "model",
                title: "The model",
                lead: "Each block in the colour of the worst that was found of it; click a name in the legend to hide its blocks, point at a block to see which it is. Below it \
                       the deepest overlaps and the worst differences: green is the true contact, orange the one that was seen."
                    .to_owned(),
                parts: vec![SectionPart::Findings(views)],
            },
            Section {
                id: "pairs",
                title: "Pairs of blocks",
                lead: format!(
                    "The worst of {} with something to say, of {} in pairs.csv.",
                    plural(ranked.len(), "pair", "pairs"),
                    pairs.len()
                ),
                parts: vec![SectionPart::Table(worst(EXCERPT_LENGTH[0]), EXCERPT_LENGTH[0])],
            },
            Section {
                id: "tolerances",
                title: "Tolerances",
                lead: match found.recommended() {
                    Some(_) => "What was examined, and what is recommended: the set of tolerances.toml.".to_owned(),
                    None => "What was examined: the set of tolerances.toml. No other one is recommended.".to_owned(),
                },
                parts: vec![SectionPart::Table(tolerances.clone(), usize::MAX)],
            },
        ],
    };
    let set = found.recommended().map_or(&found.given.set, |other| &other.set);
    let document = document(found, verdict);
    let json = serde_json::to_string_pretty(&document)? + "\n";
    let text = text(found, verdict, &worst(EXCERPT_LENGTH[1]), ranked.len());
    let mut files: Vec<(String, FileKind, Vec<u8>)> = vec![
        (FILES[0].to_owned(), FileKind::Text, page(&report)?.into_bytes()),
        (FILES[1].to_owned(), FileKind::Text, text.into_bytes()),
        (FILES[2].to_owned(), FileKind::Run, json.into_bytes()),
        (
            FILES[3].to_owned(),
            FileKind::Picture,
            vtu(&frame::model(&found.model.scene, block_data(found, &pairs, &block_statuses)))?,
        ),
        (FILES[4].to_owned(), FileKind::Table, all.to_csv()?),
        (FILES[5].to_owned(), FileKind::Input, as_toml(set).into_bytes()),
        (FILES[6].to_owned(), FileKind::Table, tolerances.to_csv()?),
        (FILES[7].to_owned(), FileKind::Text, latex(&worst(MAX_ROWS), MAX_ROWS).into_bytes()),
        (FILES[8].to_owned(), FileKind::Text, latex(&tolerances, usize::MAX).into_bytes()),
    ];
    if let Recommendation::Other(other) = &found.other {
        files.push(("tune.md".to_owned(), FileKind::Text, other.text.clone().into_bytes()));
    }
    for kept in cases {
        files.push((kept.file.clone(), FileKind::Case, kept.case.to_toml()?.into_bytes()));
    }
    let mut names: Vec<String> =
        files.iter().map(|(name, ..)| name.clone()).filter(|name| !name.contains('/')).collect();
    if !cases.is_empty() {
        names.push(plural(cases.len(), "case", "cases"));
    }
    directory.write_all(files)?;
    Ok(WrittenFiles { document, names })
}

/// All neighbouring pairs, and those that met in the steps, in ascending order: what `pairs.csv` holds.
pub fn pair_table(found: &Examination) -> Table {
    table_of(PairFacts::all(found).iter())
}

/// The pairs with something to say, the worst first, with the columns of [`pair_table`].
pub fn findings_table(found: &Examination) -> Table {
    table_of(ranked(&PairFacts::all(found)).into_iter())
}

/// The pairs with something to say, the worst first.
fn ranked<'p, 'f>(pairs: &'p [PairFacts<'f>]) -> Vec<&'p PairFacts<'f>> {
    let mut ranked: Vec<_> = pairs.iter().filter(|pair| BlockStatus::of(pair) != BlockStatus::Sound).collect();
    // A stable sort: of equally bad ones the first pair first.
    ranked.sort_by(|one, two| {
        let depth = |pair: &PairFacts<'_>| pair.depth_m().unwrap_or(0.0);
        BlockStatus::of(one).cmp(&BlockStatus::of(two)).then(depth(two).total_cmp(&depth(one)))
    });
    ranked
}

fn table_of<'p, 'f: 'p>(pairs: impl Iterator<Item = &'p PairFacts<'f>>) -> Table {
    let mut table = Table::new("pairs", "Pairs of blocks, the worst first", &COLUMNS);
    pairs.for_each(|pair| table.push(pair.cells()));
    table
}

/// The set given, beside the one recommended where there is one: what `tolerances.csv` holds.
pub fn tolerance_table(found: &Examination) -> Table {
    let sets: Vec<&ToleranceSet> =
        std::iter::once(&found.given).chain(found.recommended()).map(|assessed| &assessed.set).collect();
    let header = ["tolerance", "given", "recommended"];
    let mut table = Table::new("tolerances", "Lengths in m", &header[..=sets.len()]);
    let numbers: Vec<_> = sets.iter().map(|set| set.numbers()).collect();
    for (row, (name, _)) in numbers[0].iter().enumerate() {
        let values = numbers.iter().map(|numbers| TableCell::Setting(numbers[row].1.approximate()));
        table.push(std::iter::once((*name).into()).chain(values).collect());
    }
    let criteria = sets.iter().map(|set| set.criteria.name().into());
    table.push(std::iter::once("criteria".into()).chain(criteria).collect());
    table
}

/// The lines as the page has them.
fn lines(verdict: &Verdict) -> Vec<VerdictLine> {
    let severity = match verdict.answer {
        "safe" => Severity::Good,
        NOT_DECIDED => Severity::Fair,
        _ => Severity::Bad,
    };
    let mut lines = vec![VerdictLine { severity, text: verdict.sentence.clone() }];
    lines.extend(
        verdict
            .lines
            .iter()
            .map(|line| VerdictLine { severity: line.severity, text: format!("{}: {}", line.about, line.text) }),
    );
    let next = verdict.next.iter().map(|next| format!("next: {next}"));
    lines.extend(next.map(|text| VerdictLine { severity: Severity::Fair, text }));
    lines
}

/// The verdict, the worst pairs and the sets as a text.
fn text(found: &Examination, verdict: &Verdict, worst: &Table, all: usize) -> String {
    let clean = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace(['\n', '\r'], " ");
    let mut out = format!("# {}: {}\n\n", clean(&title(found)), verdict.answer);
    out += &format!("{}\n\n", clean(&verdict.sentence));
    for line in &verdict.lines {
        out += &format!("- {} **{}** {}\n", mark(line.severity), line.about, clean(&line.text));
    }
    if let Some(next) = &verdict.next {
        out += &format!("\nNext: `{}`\n", clean(next));
    }
    if !found.given.violations.is_empty() {
        out += &format!("\n## Rules\n\n```text\n{}```\n", violations_text(&found.given.violations));
    }
    if !worst.rows.is_empty() {
        out += &format!(
            "\n## Pairs\n\nThe worst {} of {all}; all in pairs.csv.\n\n{}",
            worst.rows.len(),
            worst.to_markdown(EXCERPT_LENGTH[1])
        );
    }
    let set = found.recommended().map_or(&found.given.set, |other| &other.set);
    let whose = if found.recommended().is_some() { "Recommended" } else { "As examined" };
    out + &format!("\n## Tolerances\n\n{whose}:\n\n```toml\n{}```\n", as_toml(set))
}

/// Data of each block for ParaView.
fn block_data(
    found: &Examination,
    pairs: &[PairFacts<'_>],
    block_statuses: &[(BlockStatus, String)],
) -> Vec<DataArray> {
    let blocks = &found.model.scene.blocks;
    let mut overlap = vec![0.0f64; blocks.len()];
    let mut counts: [Vec<i64>; 5] = std::array::from_fn(|_| vec![0; blocks.len()]);
    for pair in pairs {
        let is_lost = pair.overlap.is_some_and(|(_, severity)| severity == OverlapSeverity::Lost);
        let passes = pair.passage_m.is_some() || pair.unseen_m.is_some();
        let [f32, f64] = [Precision::F32, Precision::F64].map(|precision| pair.in_precision(precision).total() > 0);
        for block in pair.blocks {
            overlap[block] = overlap[block].max(pair.depth_m().unwrap_or(0.0));
            for (count, is_so) in counts.iter_mut().zip([is_lost, passes, f32, f64, pair.tolerance > 0]) {
                count[block] += i64::from(is_so);
            }
        }
    }
    let [lost, passes, f32, f64, tolerance] = counts;
    vec![
        DataArray::integers("block", SCALAR, (0..blocks.len() as i64).collect()),
        DataArray::integers("fixed", SCALAR, blocks.iter().map(|block| i64::from(block.body.is_fixed())).collect()),
        DataArray::integers("worst", SCALAR, block_statuses.iter().map(|(standing, _)| *standing as i64).collect()),
        DataArray::floats("worst_overlap_m", SCALAR, overlap),
        DataArray::integers("lost_pairs", SCALAR, lost),
        DataArray::integers("passing_pairs", SCALAR, passes),
        DataArray::integers("f32_pairs", SCALAR, f32),
        DataArray::integers("f64_pairs", SCALAR, f64),
        DataArray::integers("tolerance_pairs", SCALAR, tolerance),
    ]
}
