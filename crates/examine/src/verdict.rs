//! The answer in at most ten lines, each with a figure, and the next command.

use crate::assess::{Assessment, Examination, plural};
use crate::cases::KeptCase;
use crate::extents::short;
use crate::naming::{Naming, file_name};
use crate::next_command::{is_too_far_for_f32, next_command};
use crate::pairs::ExaminedPair;
use crate::recommend::Recommendation;
use crate::step_line::{step_fault, steps};
use crate::warning_lines::warning_lines;
use rockproof_model::text::noun;
use rockproof_model::tolerance_rules::{MeasuredModel, stiffness_slack};
use rockproof_model::{Precision, Scene, ToleranceSet};
use rockproof_report::table::grouped;
use rockproof_report::verdict::Severity;
use rockproof_simulate::Totals;

/// The file of the set to use.
pub(crate) const SET: &str = "tolerances.toml";
/// The answer where nothing is wrong, but too little was there to be wrong.
pub(crate) const NOT_DECIDED: &str = "not decided";

/// A line of the answer.
#[derive(Clone, Debug)]
pub struct Line {
    /// What it is about.
    pub about: &'static str,
    /// How it is meant.
    pub severity: Severity,
    /// What was found.
    pub text: String,
}

/// The answer.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Whether the model is safe with the tolerances that it was examined with.
    pub is_safe: bool,
    /// `safe`, `safe with another set`, `not safe` or `not decided`.
    pub answer: &'static str,
    /// The answer with its reasons.
    pub sentence: String,
    /// What it rests on.
    pub lines: Vec<Line>,
    /// The next command; none where there is no directory of results.
    pub next: Option<String>,
}

pub(crate) fn line(about: &'static str, severity: Severity, text: String) -> Line {
    Line { about, severity, text }
}

impl Verdict {
    /// The answer for a model that commands name so.
    pub fn of(found: &Examination, cases: &[KeptCase], naming: &Naming) -> Verdict {
        let precision = found.model.precision;
        let doubt = found.model.extents.unit_warning(found.model.format).filter(|_| !naming.units_are_meant);
        let may_be_safe = doubt.is_none() && found.model.coarse.is_none();
        let is_safe = may_be_safe && found.given.is_safe(precision);
        let with_other = may_be_safe && found.recommended().is_some_and(|other| other.is_safe(precision));
        let reasons = reasons(found, doubt.is_some());
        let (answer, sentence) = match (is_safe, with_other) {
            (true, _) => {
                let pairs = plural(found.given.pairs.len(), "neighbouring pair", "neighbouring pairs");
                let untried = untried(found);
                ("safe", format!("safe: nothing is wrong with {pairs} under {} in {precision}{untried}", found.name))
            }
            (false, true) => (
                "safe with another set",
                format!(
                    "safe with another set, {} (under {}: {reasons})",
                    naming.place_of(SET, "the one recommended"),
                    found.name
                ),
            ),
            (false, false) if doubt.is_none() && found.given.fault_counts(precision) == [0; 5] => {
                (NOT_DECIDED, format!("{NOT_DECIDED}: {reasons}"))
            }
            (false, false) => ("not safe", format!("not safe: {reasons}")),
        };
        let mut lines = vec![
            model(found, doubt.as_deref()),
            rules(&found.given, &found.model.scene, &found.name, precision),
            overlapping(&found.given),
            differing(found, precision, true),
            differing(found, other_than(precision), false),
            tolerances(&found.given),
            steps(&found.given),
        ];
        lines.extend(warning_lines(found));
        lines.push(recommended(found, precision, naming));
        let next = naming.dir.as_ref().map(|dir| next_command(found, cases, (naming, dir), (doubt.is_some(), answer)));
        Verdict { is_safe, answer, sentence, lines, next }
    }

    /// For a terminal.
    pub fn text(&self) -> String {
        let mut out = format!("{}\n", self.sentence);
        for Line { about, severity, text } in &self.lines {
            out += &format!("  {} {about:<10} {text}\n", mark(*severity));
        }
        if let Some(next) = &self.next {
            out += &format!("next: {next}\n");
        }
        out
    }
}

/// A sign for a severity, as the page has it.
pub fn mark(severity: Severity) -> char {
    match severity {
        Severity::Good => '✓',
        Severity::Fair => 'i',
        Severity::Bad => '✗',
    }
}

/// What a model called safe was not tried in, so that nobody takes little for much: blocks in no pair, and steps where none was made.
fn untried(found: &Examination) -> String {
    let all = found.model.scene.blocks.len();
    let lonely = Some(found.given.overlaps.lonely().len()).filter(|lonely| *lonely > 0);
    let lonely = lonely.map(|lonely| format!("{lonely} of {all} blocks {} nothing", noun(lonely, "touches", "touch")));
    let steps = found.given.steps.made().is_none().then(|| "no step was made".to_owned());
    let untried: Vec<String> = lonely.into_iter().chain(steps).collect();
    if untried.is_empty() { String::new() } else { format!(", but {}", untried.join(" and ")) }
}

/// Why there was no contact to be wrong.
fn untouched(given: &Assessment, scene: &Scene) -> String {
    match scene.blocks.len() {
        _ if scene.fixed().into_iter().all(|is_fixed| is_fixed) => "every block is fixed, so nothing moves".to_owned(),
        _ if given.pairs.iter().any(|pair| pair.touches) => {
            "of neighbouring blocks both are fixed, and no block that moves touches another".to_owned()
        }
        1 => "one block alone touches nothing".to_owned(),
        _ => {
            format!("no two blocks are near enough to touch (search is {} m)", short(given.set.search.approximate()))
        }
    }
}

/// Nothing found among the pairs is good news only where some touch.
fn good(given: &Assessment) -> Severity {
    if given.pairs.iter().any(|pair| pair.touches) { Severity::Good } else { Severity::Fair }
}

fn other_than(precision: Precision) -> Precision {
    match precision {
        Precision::F32 => Precision::F64,
        Precision::F64 => Precision::F32,
    }
}

/// What is wrong, or else what was not there to be, in a few words.
fn reasons(found: &Examination, units: bool) -> String {
    let (given, scene, precision) = (&found.given, &found.model.scene, found.model.precision);
    let mut said: Vec<String> = Vec::new();
    if units {
        said.push("the units are in doubt".to_owned());
    }
    if found.model.coarse.is_some() {
        said.push("coordinates of the file were rounded to f32".to_owned());
    }
    if given.overlaps.lost() > 0 {
        let pairs = plural(given.overlaps.lost(), "pair of blocks overlaps", "pairs of blocks overlap");
        said.push(format!("{pairs} so that contacts cannot hold them"));
    }
    if !given.violations.is_empty() {
        let far = ", and no tolerances keep all in f32 at such coordinates: only a local origin helps, or f64";
        let near = found.local_origin.as_ref().filter(|local| local.violations < given.violations.len());
        let far = match near {
            _ if is_too_far_for_f32(found) => far.to_owned(),
            Some(local) => format!(", {} relative to a local origin", none_or(local.violations)),
            None => String::new(),
        };
        said.push(format!("{} violated{far}", plural(given.violations.len(), "rule", "rules")));
    }
    let [_, broken] = given.differing(precision);
    if broken > 0 {
        let near = found.local_origin.as_ref().filter(|local| local.broken < broken);
        let near = near.map(|local| format!(", {} of them relative to a local origin", none_or(local.broken)));
        said.push(format!("{} broken in {precision}{}", plural(broken, "pair", "pairs"), near.unwrap_or_default()));
    }
    if given.steps.find_fault() {
        said.push(step_fault(&given.steps));
    }
    said.extend(doubts(given, scene));
    if said.is_empty() && !given.tries_contacts() {
        said.push(untouched(given, scene));
    }
    said.join("; ")
}

/// What keeps a model from being safe though nothing that is counted is wrong, or keeps it from being seen.
fn doubts(given: &Assessment, scene: &Scene) -> Vec<String> {
    let mut said: Vec<String> = Vec::new();
    if let Some(thin) = &given.thin {
        let [penetration, thickness] = [thin.penetration, thin.thickness].map(short);
        said.push(format!(
            "penetration, {penetration} m, is more than half of the thickness of block {}, {thickness} m, so it may be passed through unseen",
            thin.block
        ));
    }
    if given.steps.end_deep() && !given.steps.find_fault() {
        said.push("blocks overlap deeper than penetration after steps, held only by contacts closed before".to_owned());
    }
    if given.steps.lose_friction() {
        said.push(format!(
            "friction does not settle in a step, so that blocks move otherwise than it lets them: {}",
            Totals::SETTLES_FRICTION
        ));
    }
    if given.steps.have_decisive_false_entrances() {
        said.push("contacts push blocks where nothing holds them (false entrances), so that they move otherwise than rock does".to_owned());
    }
    said.extend(given.warnings.iter().map(|warning| warning.kind.title().to_owned()));
    said.extend(given.stored.first().map(|worst| worst.sentence(scene)));
    said.extend(given.bare_edges.first().map(|first| first.sentence(scene)));
    said
}

/// A count, or that there is none.
fn none_or(count: usize) -> String {
    if count == 0 { "none".to_owned() } else { grouped(count as u64) }
}

fn model(found: &Examination, doubt: Option<&str>) -> Line {
    let extents = &found.model.extents;
    let [x, y, z] = extents.sides().map(short);
    let (shortest, _) = extents.shortest();
    let blocks = plural(found.model.scene.blocks.len(), "block", "blocks");
    let text = format!("{blocks} in {x} × {y} × {z} m, shortest edge {} m", short(shortest));
    let lonely = found.given.overlaps.lonely_sentence(&found.model.scene);
    let remarks: Vec<&str> =
        found.model.coarse.iter().chain(&found.model.merging).chain(&lonely).map(String::as_str).collect();
    match doubt {
        None if remarks.is_empty() => line("model", Severity::Good, text),
        None => line("model", Severity::Fair, format!("{text}: {}", remarks.join("; "))),
        Some(doubt) => line("model", Severity::Bad, format!("{text}: {doubt}; `--scale 1` says that metres are meant")),
    }
}

fn rules(given: &Assessment, scene: &Scene, name: &str, precision: Precision) -> Line {
    if given.violations.is_empty() {
        let nearest = nearest_rule(scene, &given.set, precision);
        let nearest = nearest
            .map_or(String::new(), |(factor, formula)| format!(", the tightest by a factor of {factor:.2}: {formula}"));
        return line("rules", Severity::Good, format!("all met by {name} in {precision}{nearest}"));
    }
    let formulas: Vec<&str> = given.violations.iter().map(|violation| violation.rule.formula()).collect();
    line(
        "rules",
        Severity::Bad,
        format!("{} violated by {name} in {precision}: {}", formulas.len(), formulas.join("; ")),
    )
}

/// The tightest rule, and by what factor it is met.
fn nearest_rule(scene: &Scene, set: &ToleranceSet, precision: Precision) -> Option<(f64, &'static str)> {
    let mut slacks = MeasuredModel::of(&scene.shapes()).slacks(set, precision);
    let mut stiff = scene.clone();
    stiff.derive_stiffness(set);
    slacks.extend(stiffness_slack(set, &stiff));
    let nearest = slacks.into_iter().min_by(|one, other| one.factor.total_cmp(&other.factor))?;
    nearest.factor.is_finite().then(|| (nearest.factor, nearest.rule.formula()))
}

fn overlapping(given: &Assessment) -> Line {
    let overlaps = &given.overlaps;
    let said = overlaps.line();
    let mut text = said.strip_prefix("overlaps: ").unwrap_or(&said).to_owned();
    if overlaps.lost() > 0 {
        text += &format!("; penetration is {} m", short(given.set.penetration.approximate()));
    }
    let held = overlaps.all().any(|(_, severity)| severity == rockproof_oracle::audit::OverlapSeverity::Held);
    let severity = match (overlaps.lost(), held) {
        (0, false) => good(given),
        (0, true) => Severity::Fair,
        _ => Severity::Bad,
    };
    line("overlaps", severity, text)
}

/// The pairs that differ in a precision; in the one that the model is to be safe in, broken ones are bad.
fn differing(found: &Examination, precision: Precision, is_asked: bool) -> Line {
    let given = &found.given;
    let too_far = found.model.extents.too_far_for_f32().filter(|_| precision == Precision::F32);
    let too_far = too_far.map_or(String::new(), |why| format!("; {why}"));
    let about = if precision == Precision::F64 { "f64" } else { "f32" };
    let [differ, broken] = given.differing(precision);
    let pairs = plural(given.pairs.len(), "neighbouring pair", "neighbouring pairs");
    let verb = noun(given.pairs.len(), "differs", "differ");
    if differ == 0 {
        let severity = if too_far.is_empty() { good(given) } else { Severity::Fair };
        return line(about, severity, format!("0 of {pairs} {verb} from the exact contacts{too_far}"));
    }
    let sum =
        |of: fn(&ExaminedPair, Precision) -> u64| grouped(given.pairs.iter().map(|pair| of(pair, precision)).sum());
    let rounding = sum(|pair, precision| pair.in_precision(precision).representation);
    let arithmetic = sum(|pair, precision| pair.in_precision(precision).arithmetic);
    let defects = sum(|pair, precision| pair.in_precision(precision).defects);
    let severity = if broken > 0 && is_asked { Severity::Bad } else { Severity::Fair };
    let beyond = none_or(broken);
    let near = found.local_origin.as_ref().filter(|local| is_asked && local.broken < broken);
    let near = near.map_or(String::new(), |local| {
        format!(", but {} relative to a local origin at ({})", none_or(local.broken), local.point())
    });
    let text = format!(
        "{} of {pairs} {verb} from the exact contacts, {beyond} by more than rounding explains{near} (contacts that differ: {rounding} by rounding the input, \
         {arithmetic} by arithmetic, {defects} by mistakes in code){too_far}",
        grouped(differ as u64)
    );
    line(about, severity, text)
}

fn tolerances(given: &Assessment) -> Line {
    let changed = given.pairs.iter().filter(|pair| pair.tolerance > 0).count();
    let contacts: u64 = given.pairs.iter().map(|pair| pair.tolerance).sum();
    let (changed, pairs) = (grouped(changed as u64), plural(given.pairs.len(), "pair", "pairs"));
    let exact = noun(contacts, "exact contact", "exact contacts");
    let text = format!("change {} {exact} in {changed} of {pairs}", grouped(contacts));
    line("tolerances", if contacts == 0 { good(given) } else { Severity::Fair }, text)
}

fn recommended(found: &Examination, precision: Precision, naming: &Naming) -> Line {
    let other = match &found.other {
        Recommendation::Skipped(why) => return line("set", Severity::Fair, why.clone()),
        Recommendation::Given { candidates, refused } => {
            let severity = if found.given.is_safe(precision) { Severity::Good } else { Severity::Fair };
            let best = best_of(*candidates, *refused);
            return line("set", severity, format!("{} is the best of {best}", found.name));
        }
        Recommendation::Other(other) => other,
    };
    let is_safe = other.assessed.is_safe(precision);
    let file = naming.place_of(SET, "the one recommended");
    // With nothing wrong that is counted, it is not decided, and the figures do not say why.
    let safe = match doubts(&other.assessed, &found.model.scene).first() {
        _ if is_safe => "safe".to_owned(),
        Some(doubt) if other.assessed.fault_counts(precision) == [0; 5] => format!("{NOT_DECIDED} ({doubt})"),
        _ => "not safe".to_owned(),
    };
    let (origin, candidates, figures) = (other.origin, other.candidates, other.figures(&found.given, precision));
    let best = best_of(candidates, other.refused);
    let text = format!("{file} ({origin}) is the best of {best}, and {safe}: {}", figures.join(", "));
    line("set", if is_safe { Severity::Good } else { Severity::Fair }, text)
}

/// The sets tried, and how many of them the search prefers though the whole model does no better with them.
pub(crate) fn best_of(candidates: usize, refused: usize) -> String {
    let sets = plural(candidates, "set tried", "sets tried");
    match refused {
        0 => format!("the {sets}"),
        _ => format!(
            "the {sets}, but for {refused} that the search prefers and with which the whole model does no better"
        ),
    }
}

/// The head of the page and of the text.
pub(crate) fn title(found: &Examination) -> String {
    file_name(&found.model.file)
}
