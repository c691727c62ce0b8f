//! What the verdict says of runs of a scene: steps in lockstep, and the audit of steps.

use super::lockstep::LockstepRun;
use super::motion::MotionRun;
use super::table::{counted, grouped, short};
use super::verdict::{MIN_PAIRS, Severity, VerdictLine};
use rockproof_differential::finding::Cause;
use rockproof_simulate::AuditTotals;
use rockproof_simulate::audit::PairExtreme;

/// So many steps without a mistake must there be before that is called well, as of pairs. Steps of one run resemble one another, so they tell less than as
/// many pairs; fewer tell next to nothing.
const MIN_STEPS: u64 = MIN_PAIRS;

/// What differs in steps that stepper and oracle made from the same states: decisions, overlaps, mistakes in code.
pub(super) fn lockstep_lines(runs: &[LockstepRun]) -> Vec<VerdictLine> {
    if runs.is_empty() {
        return Vec::new();
    }
    let sum = |of: fn(&LockstepRun) -> u64| -> u64 { runs.iter().map(of).sum() };
    let [steps, contacts, iterations] = [sum(|r| r.steps), sum(|r| r.contacts_differ), sum(|r| r.iterations_differ)];
    let others = [
        (sum(|r| r.modes_differ), "a contact of another mode"),
        (sum(|r| r.converged_differ), "converged on one side alone"),
        (runs.iter().filter(|run| run.failure.is_some()).count() as u64, "could not be made by one side"),
    ];
    let differ = contacts + iterations + others.iter().map(|(count, _)| count).sum::<u64>();
    let severity = if differ == 0 && steps > 0 { Severity::Good } else { Severity::Fair };
    let mut text = format!(
        "In motion, {} of {} steps have other contacts than the exact ones, {} another number of iterations",
        grouped(contacts),
        grouped(steps),
        grouped(iterations)
    );
    for (count, what) in others.iter().filter(|(count, _)| *count > 0) {
        text += &format!(", {} {what}", grouped(*count));
    }
    let deepest = runs.iter().map(|r| r.penetration_difference_m).fold(0.0, f64::max);
    let overlaps = format!("Overlaps after a step differ from the exact ones by at most {} m.", short(deepest));
    let mistakes = match runs.iter().filter_map(|r| r.causes.get(&Cause::Defect)).sum::<u64>() {
        0 if steps == 0 => (Severity::Fair, "No step was compared.".to_owned()),
        0 if steps < MIN_STEPS => (
            Severity::Fair,
            format!(
                "No mistake in code was found in the steps. So few steps tell little: {MIN_STEPS} show a mistake of one step in a hundred with 95 %."
            ),
        ),
        0 => (Severity::Good, "No mistake in code was found in the steps.".to_owned()),
        1 => (Severity::Bad, "1 difference of the steps is a mistake in code.".to_owned()),
        n => (Severity::Bad, format!("{} differences of the steps are mistakes in code.", grouped(n))),
    };
    let lines = [(severity, format!("{text}.")), (Severity::Fair, overlaps), mistakes];
    lines.into_iter().map(|(severity, text)| VerdictLine { severity, text }).collect()
}

/// What audits found of passages and unseen overlaps: bad where a run has one, good where all were audited, passages were looked for, there are
/// none, no overlap was deeper than `penetration`, springs elsewhere had none to explain, nothing stayed undecided, and every run came to its end. `None`
/// without a run.
pub(super) fn motion_line(runs: &[MotionRun]) -> Option<VerdictLine> {
    let objecting: Vec<&MotionRun> =
        runs.iter().filter(|run| run.audit().is_some_and(AuditTotals::finds_fault)).collect();
    let of = |run: &MotionRun| {
        let cut = run.cut_short().map_or(String::new(), |cut| format!("{cut}; "));
        format!("{}: {cut}{}", run.name, run.sentence())
    };
    if let [first, others @ ..] = &objecting[..] {
        let more = match others.len() as u64 {
            0 => String::new(),
            n => format!("; so they do in {}", counted(n, "other run", "other runs")),
        };
        return Some(VerdictLine { severity: Severity::Bad, text: format!("{}{more}.", of(first)) });
    }
    let audits: Vec<&AuditTotals> = runs.iter().filter_map(MotionRun::audit).collect();
    let is_proved = |audit: &&AuditTotals| {
        audit.steps > 0 && audit.undecided == Some(0) && audit.steps_deep + audit.steps_explained == 0
    };
    let is_whole = audits.len() == runs.len() && runs.iter().all(|run| run.cut_short().is_none());
    let severity = if is_whole && audits.iter().all(is_proved) { Severity::Good } else { Severity::Fair };
    let text = match (runs, audits.len()) {
        ([], _) => return None,
        ([run], _) => of(run),
        (runs, 0) if runs.iter().all(|run| run.steps() == 0) => {
            "No step was made in any run, so nothing is known of overlaps".to_owned()
        }
        (_, 0) => "No run was audited (--no-audit); nobody looked for overlaps that no contact sees".to_owned(),
        (_, audited) => {
            let steps = counted(audits.iter().map(|audit| audit.steps).sum(), "audited step", "audited steps");
            let looked = audits.iter().filter(|audit| audit.passages.is_some()).count();
            let none = match looked {
                0 => "No unseen overlap",
                _ => "No passage and no unseen overlap",
            };
            let undecided = match audits.iter().filter_map(|audit| audit.undecided).sum::<u64>() {
                0 => String::new(),
                n => format!("; {} undecided", counted(n, "passage", "passages")),
            };
            let without = match audited - looked {
                0 => String::new(),
                n => format!("; passages within steps were not looked for in {n} of them (--audit does)"),
            };
            let deep = deeper(runs).map_or(String::new(), |deep| format!("; {deep}"));
            let but = explained(runs).map_or(String::new(), |explained| format!(" but those {explained}"));
            format!("{none}{but} in {steps} of {audited} of {} runs{deep}{undecided}{without}", runs.len())
        }
    };
    Some(VerdictLine { severity, text: format!("{text}.") })
}

/// After how many of all audited steps blocks overlap deeper than `penetration`, and how deep at most, in the first such run; none where they never do.
fn deeper(runs: &[MotionRun]) -> Option<String> {
    let found = worst_of(runs, |audit| (audit.steps_deep, audit.deepest))?;
    let WorstOfRuns { steps, all, depth, run } = found;
    Some(format!("blocks overlap deeper than `penetration` after {steps} of {all} (at most {depth} m, in {run})"))
}

/// After how many of all audited steps springs of other contacts explain an overlap that no contact sees, and how deep at most, in the first such run; none where
/// they never do.
fn explained(runs: &[MotionRun]) -> Option<String> {
    let found = worst_of(runs, |audit| (audit.steps_explained, audit.worst_explained))?;
    let WorstOfRuns { steps, all, depth, run } = found;
    Some(format!("that springs elsewhere explain (after {steps} of {all}; the deepest {depth} m, in {run})"))
}

/// In words, after how many of all audited steps there is something, how deep at most (m), and in which run first.
struct WorstOfRuns<'r> {
    steps: String,
    all: String,
    depth: String,
    run: &'r str,
}

/// Of what `of` tells of an audit: after how many steps, and the deepest; none where no run has such a step.
fn worst_of(runs: &[MotionRun], of: fn(&AuditTotals) -> (u64, Option<PairExtreme>)) -> Option<WorstOfRuns<'_>> {
    let audits = || runs.iter().filter_map(|run| Some((run, run.audit()?)));
    let depth = |audit: &AuditTotals| match of(audit) {
        (0, _) => None,
        (_, worst) => worst.map(|worst| worst.depth_m.0),
    };
    let (worst, depth) = audits()
        .filter_map(|(run, audit)| Some((run, depth(audit)?)))
        .rev()
        .max_by(|(_, one), (_, other)| one.total_cmp(other))?;
    let steps: u64 = audits().map(|(_, audit)| of(audit).0).sum();
    let all: u64 = audits().map(|(_, audit)| audit.steps).sum();
    Some(WorstOfRuns {
        steps: grouped(steps),
        all: counted(all, "step", "steps"),
        depth: short(depth),
        run: &worst.name,
    })
}

/// What makes a run doubtful though no block passed through another: rules that its tolerances violate, friction that did not settle, and false entrances. A line each, of the first such
/// run.
pub(super) fn doubt_lines(runs: &[MotionRun]) -> Vec<VerdictLine> {
    let forced = |run: &MotionRun| {
        let rules = counted(run.violated.len() as u64, "rule", "rules");
        let sentence = format!("run by --force although its tolerances violate {rules}: {}", run.violated.join("; "));
        (!run.violated.is_empty()).then_some(sentence)
    };
    let unsettled = |run: &MotionRun| Some(format!("friction {}", run.totals.unsettled_in_words()?));
    let entrances = |run: &MotionRun| {
        let audit = run.totals.audit.as_ref()?;
        Some(format!("false entrances: {}", audit.false_entrances.sentence()?))
    };
    let line = |doubt: &dyn Fn(&MotionRun) -> Option<String>| {
        let doubted: Vec<String> =
            runs.iter().filter_map(|run| Some(format!("{}: {}", run.name, doubt(run)?))).collect();
        let (first, others) = doubted.split_first()?;
        let more = match others.len() as u64 {
            0 => String::new(),
            n => format!("; likewise {}", counted(n, "other run", "other runs")),
        };
        Some(VerdictLine { severity: Severity::Fair, text: format!("{first}{more}.") })
    };
    [line(&forced), line(&unsettled), line(&entrances)].into_iter().flatten().collect()
}

/// Which of several runs ended before they were asked to, and why the first did; of one alone its line tells.
pub(super) fn cut_line(runs: &[MotionRun]) -> Option<VerdictLine> {
    let cut: Vec<String> = runs.iter().filter_map(|run| Some(format!("{}: {}", run.name, run.cut_short()?))).collect();
    let (first, others) = cut.split_first().filter(|_| runs.len() > 1)?;
    let more = match others.len() as u64 {
        0 => String::new(),
        n => format!("; {} ended early too", counted(n, "other run", "other runs")),
    };
    Some(VerdictLine { severity: Severity::Fair, text: format!("{first}{more}.") })
}
