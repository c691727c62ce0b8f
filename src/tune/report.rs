//! What a search says to the one who asked.

use super::Workbench;
use super::measure::{Measurement, STEPS};
use super::search::{Search, Tried, formulas};
use crate::model::scene::write_tolerances;
use crate::model::{ToleranceSet, ToleranceSpec};
use std::fmt::Write;

/// Trade-offs told at most.
const MOST: usize = 6;

/// A set as a `[tolerances]` table ready to paste.
pub fn as_toml(set: &ToleranceSet) -> String {
    write_tolerances(&ToleranceSpec::from(set.clone()))
}

/// The whole answer as Markdown. A function of what was tried: no times, no machine.
pub fn markdown(name: &str, bench: &Workbench, search: &Search<'_>) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_all(&mut text, name, bench, search);
    text
}

fn write_all(out: &mut String, name: &str, bench: &Workbench, search: &Search<'_>) -> std::fmt::Result {
    let tried = search.tried();
    let (Some(best), Some(author)) = (search.best(), tried.first()) else {
        return writeln!(out, "Nothing was tried.");
    };
    writeln!(out, "# Tolerances for {name}, {}\n", bench.precision())?;
    verdict(out, &tried[best], best == 0)?;
    writeln!(out, "\n```toml\n{}```\n", as_toml(&tried[best].set))?;
    writeln!(out, "## Measured on\n")?;
    let d = tried[best].measurement.differences;
    let cluster = &bench.cluster;
    writeln!(
        out,
        "- {} candidates: {} given, the others drawn or turned from the best so far",
        tried.len(),
        search.given().min(tried.len())
    )?;
    writeln!(
        out,
        "- {} of the {} neighbouring pairs as they stand; {} of them moved at random, {} beside the boundary of a decision, {} on it",
        d.standing[0], bench.probes.neighbours, d.moved[0], d.near[0], d.boundary[0]
    )?;
    let part = if cluster.is_whole {
        "the whole scene".to_owned()
    } else {
        format!("{} blocks around block {}", cluster.members.len(), cluster.members[0])
    };
    writeln!(out, "- {STEPS} steps of {part}, depths of overlaps exact (convex blocks only)")?;
    writeln!(out, "- every rule of SPEC section 3, exactly\n")?;
    writeln!(out, "## What the author's current set would do instead\n")?;
    table(out, search, &[best, 0])?;
    compare(out, &tried[best].measurement, &author.measurement)?;
    let given: Vec<usize> = (1..search.given().min(tried.len())).collect();
    if !given.is_empty() {
        writeln!(out, "\n## The presets\n")?;
        table(out, search, &given)?;
    }
    writeln!(out, "\n## Trade-offs that remain\n")?;
    let front: Vec<usize> = search.front();
    let shown: Vec<usize> = front.iter().copied().take(MOST).collect();
    if shown.len() < 2 {
        writeln!(out, "None: no candidate that keeps every rule is better in anything.")?;
    } else {
        writeln!(
            out,
            "{} candidates keep every rule and are beaten by no other in everything at once; the first {} by pairs that differ, then penetration:\n",
            front.len(),
            shown.len()
        )?;
        table(out, search, &shown)?;
    }
    writeln!(out, "\n{NOTES}")
}

const NOTES: &str = "`differ`: pairs that engine and oracle answer differently, as they stand + moved + beside a boundary; in brackets those on a boundary, where \
rounding the input decides whatever the tolerances. `slack`: how many times the nearest rule is met. `changed`: contacts that the \
tolerances add, remove or change, compared with nearest features alone. `penetration`: the deepest overlap after the steps. A larger u means longer steps, and fewer of them.";

fn verdict(out: &mut String, best: &Tried, is_author: bool) -> std::fmt::Result {
    let m = &best.measurement;
    let d = &m.differences;
    if is_author {
        writeln!(out, "The author's own set is the best of what was tried.\n")?;
    }
    match d.avoidable() {
        0 => {
            writeln!(out, "Engine and oracle agree on all {} pairs that are not exactly on a boundary.", d.examined())?
        }
        n => writeln!(
            out,
            "Engine and oracle differ on {n} of {} pairs that are not exactly on a boundary; no candidate did better.",
            d.examined()
        )?,
    }
    match m.violated.is_empty() {
        true => writeln!(
            out,
            "Every rule is met {:.2} times or more; the nearest is `{}`.",
            m.tightest.factor,
            m.tightest.rule.formula()
        )?,
        false => writeln!(out, "No candidate met every rule; this one breaks: {}.", formulas(&m.violated))?,
    }
    match &m.stepped.stopped {
        None => {
            writeln!(out, "Blocks overlap by {:.3e} m at most after {} steps.", m.stepped.penetration, m.stepped.steps)
        }
        Some(why) => writeln!(out, "The steps stopped after {}: {why}.", m.stepped.steps),
    }
}

/// One row for each candidate.
fn table(out: &mut String, search: &Search<'_>, which: &[usize]) -> std::fmt::Result {
    writeln!(
        out,
        "| candidate | s | r | g | u | θo | θp | ε | criteria | differ | rules broken | slack | penetration | changed |"
    )?;
    writeln!(out, "| --- | --: | --: | --: | --: | --: | --: | --: | --- | --: | --: | --: | --: | --: |")?;
    for &number in which {
        let tried = &search.tried()[number];
        let (set, m) = (&tried.set, &tried.measurement);
        let d = &m.differences;
        let length = |value: &crate::model::Number| format!("{:.3e}", value.approximate());
        let angle = |sine: &crate::model::Number| format!("{:.2}°", sine.approximate().asin().to_degrees());
        let steps =
            m.stepped.stopped.as_ref().map_or(format!("{:.2e} m", m.stepped.penetration), |_| "stopped".to_owned());
        writeln!(
            out,
            "| {number} {} | {} | {} | {} | {} | {} | {} | {:.1e} | {} | {} + {} + {} ({}) | {} | {:.2} | {steps} | {} |",
            tried.origin.name(),
            length(&set.search),
            length(&set.territory),
            length(&set.penetration),
            length(&set.max_displacement),
            angle(&set.overlap_sine),
            angle(&set.parallel_sine),
            set.equal.approximate(),
            set.criteria.name(),
            d.standing[1],
            d.moved[1],
            d.near[1],
            d.boundary[1],
            m.violated.len(),
            m.tightest.factor,
            d.changed,
        )?;
    }
    Ok(())
}

fn compare(out: &mut String, best: &Measurement, author: &Measurement) -> std::fmt::Result {
    writeln!(out)?;
    if best == author {
        return writeln!(out, "The same.");
    }
    if !author.violated.is_empty() {
        writeln!(out, "- it breaks {} rules: {}", author.violated.len(), formulas(&author.violated))?;
    }
    let (ours, theirs) = (best.differences.avoidable(), author.differences.avoidable());
    writeln!(
        out,
        "- {theirs} of {} pairs differ instead of {ours} of {}",
        author.differences.examined(),
        best.differences.examined()
    )?;
    let stopped = |m: &Measurement| m.stepped.stopped.clone();
    match (stopped(author), author.stepped.penetration, best.stepped.penetration) {
        (Some(why), _, _) => writeln!(out, "- its steps stop after {}: {why}", author.stepped.steps),
        (None, theirs, ours) if ours > 0.0 => writeln!(out, "- overlaps of {:.2} times the depth", theirs / ours),
        (None, theirs, _) => writeln!(out, "- overlaps of {theirs:.2e} m instead of none"),
    }
}
