//! What a search says to the one who asked.

// Longer than 400 lines: one text, paragraph by paragraph as it is read.

use super::evaluator::Measurement;
use super::rule_warnings::rule_warnings;
use super::search::{EvaluatedCandidate, Search, formulas};
use super::{AbsentPreset, Cluster, Evaluator, LockstepMeasures, StepMeasures, UnseenOverlaps};
use rockproof_model::scene::write_tolerances;
use rockproof_model::simulation::Unconverged;
use rockproof_model::text::noun;
use rockproof_model::{ToleranceSet, ToleranceSpec};
use std::fmt::Write;

/// Trade-offs told at most.
const MAX_TRADE_OFFS: usize = 6;

/// A set as a `[tolerances]` table ready to paste.
pub fn as_toml(set: &ToleranceSet) -> String {
    write_tolerances(&ToleranceSpec::from(set.clone()))
}

/// The file of the set that a search recommends: where the model is not safe under it, the first line says so.
pub fn tolerances_file(recommended: &EvaluatedCandidate, evaluator: &Evaluator) -> String {
    let warning = why_unsafe(&recommended.measurement, evaluator).map(|why| format!("# Not safe: {why}.\n"));
    format!("{}{}", warning.unwrap_or_default(), as_toml(&recommended.set))
}

/// The whole answer as Markdown. A function of what was tried: no times, no machine.
pub fn markdown(name: &str, evaluator: &Evaluator, search: &Search<'_>) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_all(&mut text, name, evaluator, search);
    text
}

fn write_all(out: &mut String, name: &str, evaluator: &Evaluator, search: &Search<'_>) -> std::fmt::Result {
    let evaluated = search.tried();
    let (Some(best), Some(author)) = (search.best(), evaluated.first()) else {
        return writeln!(out, "Nothing was tried.");
    };
    writeln!(out, "# Tolerances for {name}, {}\n", evaluator.precision())?;
    verdict(out, evaluated, best, evaluator)?;
    overlaps(out, &evaluated[best].measurement, evaluator.overlapping())?;
    let warnings = rule_warnings(&evaluated[best].set, evaluator.scene());
    if !warnings.is_empty() {
        writeln!(out, "\nUnder this set `check` warns (the energy of overlaps and reflex edges apart):\n")?;
        warnings.iter().try_for_each(|warning| writeln!(out, "- {warning}"))?;
    }
    writeln!(out, "\n```toml\n{}```\n", as_toml(&evaluated[best].set))?;
    writeln!(out, "## Measured on\n")?;
    let d = evaluated[best].measurement.differences;
    let (count, given) = (evaluated.len(), search.initial_count());
    let others = if count > given {
        format!("{given} given, the others drawn or turned from the best so far")
    } else {
        "all given".to_owned()
    };
    writeln!(out, "- {count} {}: {others}", noun(count, "candidate", "candidates"))?;
    writeln!(
        out,
        "- {} of {} neighbouring {} as given; copies of them: {} moved at random, {} moved beside the boundary of a decision, {} moved onto it",
        d.standing[0],
        evaluator.probes.neighbours,
        noun(evaluator.probes.neighbours, "pair", "pairs"),
        d.moved[0],
        d.near[0],
        d.boundary[0]
    )?;
    let lockstep = evaluated.iter().filter(|evaluated| compared_steps(&evaluated.measurement).is_some()).count();
    writeln!(
        out,
        "- {} {} of {}, {}; the oracle made the same steps exactly for {lockstep} {} that might be the best",
        evaluator.steps(),
        noun(evaluator.steps(), "step", "steps"),
        part(&evaluator.cluster),
        settling(evaluator),
        noun(lockstep, "candidate", "candidates")
    )?;
    let stopped = evaluated.iter().filter(|candidate| candidate.measurement.steps_measured.stopped.is_some()).count();
    if stopped > 0 {
        writeln!(
            out,
            "- the steps of {stopped} {} stopped before the last of these; what comes of blocks is measured of those made",
            noun(stopped, "candidate", "candidates")
        )?;
    }
    if evaluator.scene().simulation.control.unconverged == Unconverged::Stop {
        writeln!(out, "- steps that do not converge are accepted and counted; `simulate` would stop at the first")?;
    }
    writeln!(out, "- every rule of SPEC section 3, exactly\n")?;
    writeln!(out, "## What each would do\n")?;
    if let Some((columns, rows)) = sides(search) {
        writeln!(out, "| {} |", columns.join(" | ").trim_start())?;
        writeln!(out, "| --- |{}", " --: |".repeat(columns.len() - 1))?;
        for row in rows {
            writeln!(out, "| {} |", row.join(" | "))?;
        }
    }
    if best != 0 {
        compare(out, (&evaluated[best].measurement, &author.measurement), evaluator)?;
    }
    let given: Vec<usize> = (1..search.initial_count().min(evaluated.len())).collect();
    if !given.is_empty() {
        writeln!(out, "\n## The other sets that were given\n")?;
        table(out, search, &given)?;
    }
    absent_presets(out, search)?;
    writeln!(out, "\n## Trade-offs that remain\n")?;
    let front: Vec<usize> = search.front();
    let shown: Vec<usize> = front.iter().copied().take(MAX_TRADE_OFFS).collect();
    let keep: Vec<&EvaluatedCandidate> = evaluated.iter().filter(|one| one.measurement.violated.is_empty()).collect();
    let stepped = keep.iter().filter(|one| one.measurement.steps_measured.stopped.is_none()).count();
    let kept = if stepped < keep.len() { "keep every rule and make every step" } else { "keep every rule" };
    if evaluated[best].measurement.steps_measured.stopped.is_some() {
        writeln!(out, "None: sets are compared by all steps, and those of the one recommended stop.")?;
    } else if shown.len() < 2 {
        let keeps = if stepped < keep.len() { "keeps every rule and makes every step" } else { "keeps every rule" };
        writeln!(out, "None: no candidate that {keeps} is better in anything.")?;
    } else {
        writeln!(
            out,
            "Of {stepped} candidates that {kept}, {} are beaten by no other in all of: pairs that differ, sinking, slack, the length of a step, and contacts changed by tolerances. Here are {}: first the one recommended, then by pairs that differ, then by how far blocks sink:\n",
            front.len(),
            shown.len()
        )?;
        table(out, search, &shown)?;
    }
    let stopped = if stopped > 0 { STOPPED_NOTE } else { "" };
    writeln!(out, "\n{NOTES}{stopped}")
}

const NOTES: &str = "`differ`: pairs that engine and oracle answer differently: as given + moved at random + moved beside a boundary; in brackets those on a boundary, where \
rounding the input decides whatever the tolerances. `slack`: the factor by which the tightest rule is met. `changed`: contacts that the \
tolerances add, remove or change, compared with nearest features alone. `sinks`: the most by which the overlap of two blocks grows beyond that of the scene as \
given; `unconverged` where steps did not converge at which the scene stops, `unseen` where blocks overlap after a step and no contact sees it. `lockstep`: steps that differ from the oracle's, of those compared; – where the oracle was not asked. A larger u means longer steps, and fewer of them.";

/// A note more where steps stopped.
const STOPPED_NOTE: &str = " `stopped`: a step could not be made, so what blocks would do from there on is not known; such a set \
ranks behind all others but those that lose pairs of the model. Where none was made, there is none to compare with the oracle's.";

/// The part that is stepped, and what holds it.
fn part(cluster: &Cluster) -> String {
    let blocks = match cluster.is_whole {
        true => "the whole scene".to_owned(),
        false => format!("{} blocks around block {}", cluster.members.len(), cluster.members[0]),
    };
    let held = cluster.held.sentence();
    format!("{blocks} ({} contacts, {} unknowns; {held})", cluster.contacts, cluster.unknowns())
}

/// The settling before the steps.
fn settling(evaluator: &Evaluator) -> String {
    let [made, given] = settling_steps(evaluator);
    match made {
        0 => "without settling, as the scene has none".to_owned(),
        made if made < given => format!("after {made} of the {given} settling steps of the scene"),
        made => format!("after {made} of settling, as the scene has it"),
    }
}

/// Everything that was measured of the author's set and the one recommended, or of the author's alone where that is the best: names of the columns, the first
/// of them empty, and rows. Nothing where nothing was tried. Of steps that were not made there are no figures.
pub fn sides(search: &Search<'_>) -> Option<(Vec<&'static str>, Vec<Vec<String>>)> {
    let evaluated = search.tried();
    let (best, author) = (search.best()?, evaluated.first()?);
    let sets = match best {
        0 => vec![("author, and recommended", author)],
        _ => vec![("author", author), ("recommended", &evaluated[best])],
    };
    let columns = [""].into_iter().chain(sets.iter().map(|(name, _)| *name)).collect();
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut row = |name: &str, cell: &dyn Fn(&EvaluatedCandidate) -> String| {
        let cells = sets.iter().map(|(_, evaluated)| cell(evaluated));
        rows.push([name.to_owned()].into_iter().chain(cells).collect());
    };
    for (at, name) in NAMES.into_iter().enumerate() {
        row(name, &|evaluated| value(&evaluated.set, at));
    }
    row("criteria", &|evaluated| evaluated.set.criteria.name().to_owned());
    row("overlaps of the model too deep or unseen", &|evaluated| evaluated.measurement.lost_pairs.to_string());
    row("rules broken", &|evaluated| evaluated.measurement.violated.len().to_string());
    row("the tightest rule is met by a factor of", &|evaluated| {
        format!("{:.2}", evaluated.measurement.tightest.factor)
    });
    row("pairs as given that differ", &|evaluated| of(evaluated.measurement.differences.standing));
    row("pairs moved at random that differ", &|evaluated| of(evaluated.measurement.differences.moved));
    row("pairs beside a boundary that differ", &|evaluated| of(evaluated.measurement.differences.near));
    row("pairs on a boundary that differ", &|evaluated| of(evaluated.measurement.differences.boundary));
    row("contacts that tolerances change", &|evaluated| evaluated.measurement.differences.changed.to_string());
    row("steps made", &|evaluated| {
        let made = &evaluated.measurement.steps_measured;
        let stopped = if made.stopped.is_some() { " (stopped)" } else { "" };
        format!("{}{stopped}", made.steps)
    });
    let mut row_of_steps = |name: &str, cell: &dyn Fn(&StepMeasures) -> String| {
        row(name, &|evaluated| match &evaluated.measurement.steps_measured {
            made if made.made() == 0 => "–".to_owned(),
            made => cell(made),
        });
    };
    row_of_steps("unconverged, attempts given up", &|made| {
        let stops = if made.refused > 0 { " (a run stops)" } else { "" };
        format!("{}{stops}, {}", made.unconverged, made.retries)
    });
    row_of_steps("blocks sink by at most", &|made| format!("{:.3e} m", made.overlaps.sunk));
    row_of_steps("steps with blocks sunk deeper than penetration", &|made| made.deep.to_string());
    row_of_steps("steps with overlaps unseen by contacts (pairs, depth)", &|made| steps_pairs_and_depth(&made.unseen));
    if sets.iter().any(|(_, evaluated)| evaluated.measurement.steps_measured.explained.steps > 0) {
        row_of_steps("steps with unseen overlaps that springs elsewhere explain (pairs, depth)", &|made| {
            steps_pairs_and_depth(&made.explained)
        });
    }
    row_of_steps("deepest overlap after the last step", &|made| format!("{:.3e} m", made.overlaps.deepest));
    row("the same with the steps of the oracle", &|evaluated| {
        let deepest = evaluated.measurement.lockstep.as_ref().and_then(|lockstep| lockstep.deepest);
        deepest.map_or("–".to_owned(), |deepest| format!("{deepest:.3e} m"))
    });
    row("steps that differ from the oracle's", &|evaluated| lockstep(&evaluated.measurement));
    row("contacts, modes that differ in them", &|evaluated| {
        compared_steps(&evaluated.measurement).map_or("–".to_owned(), |l| {
            format!("{}, {} of {} ({:.1} %)", l.contacts, l.modes, l.found, 100.0 * l.share())
        })
    });
    row("steps that one side could not make", &|evaluated| {
        evaluated.measurement.lockstep.as_ref().map_or("–".to_owned(), |lockstep| lockstep.failed.to_string())
    });
    Some((columns, rows))
}

/// After how many steps, of how many pairs at most, how deep.
fn steps_pairs_and_depth(found: &UnseenOverlaps) -> String {
    match found.steps {
        0 => "0".to_owned(),
        steps => format!("{steps} ({}, {:.3e} m)", found.most_pairs, found.deepest),
    }
}

/// The tolerances of [`sides`], in the order of [`ToleranceSet::numbers`].
const NAMES: [&str; 10] = [
    "search",
    "territory",
    "penetration",
    "overlap angle",
    "parallel angle",
    "equal",
    "open",
    "close",
    "max_displacement",
    "max_rotation",
];

fn value(set: &ToleranceSet, at: usize) -> String {
    let number = set.numbers()[at].1.approximate();
    match NAMES[at].ends_with("angle") {
        true => format!("{:.2}°", number.asin().to_degrees()),
        false => format!("{number:.3e}"),
    }
}

fn of([examined, differ]: [u64; 2]) -> String {
    format!("{differ} of {examined}")
}

/// What the oracle says of steps, where it was asked and one side made any.
fn compared_steps(m: &Measurement) -> Option<&LockstepMeasures> {
    m.lockstep.as_ref().filter(|lockstep| lockstep.steps > 0)
}

fn lockstep(m: &Measurement) -> String {
    compared_steps(m).map_or("–".to_owned(), |lockstep| format!("{} of {}", lockstep.differ, lockstep.steps))
}

/// What of steps and overlaps makes the model unsafe under a set, if something does.
fn why_unsafe(m: &Measurement, evaluator: &Evaluator) -> Option<String> {
    let made = &m.steps_measured;
    let mut reasons = Vec::new();
    if m.lost_pairs > 0 {
        let pairs = noun(m.lost_pairs, "pair of the model overlaps", "pairs of the model overlap");
        reasons.push(format!("{} {pairs} deeper than `penetration` or unseen by contacts as given", m.lost_pairs));
    }
    if made.stopped.is_some() {
        reasons.push(format!("the steps stopped after {}", steps_made(made, evaluator)));
    }
    reasons.extend(unseen_in_words(made));
    if made.deep > 0 {
        let steps = noun(made.deep, "step", "steps");
        reasons.push(format!("blocks sink deeper than `penetration` after {} {steps}", made.deep));
    }
    m.is_unsafe().then(|| reasons.join("; "))
}

/// What overlaps after steps where no contact sees it, if something does.
fn unseen_in_words(made: &StepMeasures) -> Option<String> {
    let pairs = match made.unseen.most_pairs {
        0 => return None,
        1 => "1 pair overlaps".to_owned(),
        count => format!("up to {count} pairs overlap"),
    };
    let all = made.made();
    let steps = noun(all, "step", "steps");
    Some(format!(
        "{pairs} unseen by contacts after {} of {all} {steps}, worst {:.3e} m",
        made.unseen.steps, made.unseen.deepest
    ))
}

/// Settling steps of the part, and of the scene.
fn settling_steps(evaluator: &Evaluator) -> [u32; 2] {
    [&evaluator.cluster.scene, evaluator.scene()].map(|scene| scene.simulation.control.settle)
}

/// How many steps of how many were made, where they stopped.
fn steps_made(made: &StepMeasures, evaluator: &Evaluator) -> String {
    let [settling, _] = settling_steps(evaluator);
    let all = u64::from(settling) + evaluator.steps();
    let among = if settling > 0 { ", settling included" } else { "" };
    format!("{} of {all}{among}", made.made())
}

/// Which settling is among the steps made.
fn settling_among(made: &StepMeasures, evaluator: &Evaluator) -> String {
    match (made.settled, u64::from(settling_steps(evaluator)[1])) {
        (settled, given) if settled < given => format!("{settled} of the {given} settling steps of the scene included"),
        _ => "settling included".to_owned(),
    }
}

/// What was found of the best of these candidates.
fn verdict(out: &mut String, tried: &[EvaluatedCandidate], best: usize, evaluator: &Evaluator) -> std::fmt::Result {
    let m = &tried[best].measurement;
    let d = &m.differences;
    if let Some(why) = why_unsafe(m, evaluator) {
        let others = match tried.iter().all(|other| other.measurement.is_unsafe()) {
            true => " So it is under every set tried.",
            false => "",
        };
        writeln!(out, "**The model is not safe under this set: {why}.**{others}\n")?;
    }
    if best == 0 {
        writeln!(out, "The author's own set is the best of what was tried.\n")?;
    }
    match d.avoidable() {
        0 => {
            writeln!(out, "Engine and oracle agree on all {} pairs that are not exactly on a boundary.", d.examined())?
        }
        n => writeln!(
            out,
            "Engine and oracle differ on {n} of {} pairs that are not exactly on a boundary; {}.",
            d.examined(),
            with_fewer_differences(tried, m)
        )?,
    }
    match m.violated.is_empty() {
        true => writeln!(
            out,
            "Every rule is met, the tightest by a factor of {:.2}: `{}`.",
            m.tightest.factor,
            m.tightest.rule.formula()
        )?,
        false => {
            let keeping = || tried.iter().map(|other| &other.measurement).filter(|other| other.violated.is_empty());
            let [stops, stop] = match keeping().any(|other| other.steps_measured.stopped.is_some()) {
                true => [", stops in its steps", ", stop in their steps"],
                false => [""; 2],
            };
            let others = match keeping().count() {
                0 => "No candidate met every rule; this one breaks".to_owned(),
                1 => {
                    format!(
                        "One candidate meets every rule, but loses pairs of the model{stops} or lets some overlap unseen; this one breaks"
                    )
                }
                n => format!(
                    "{n} candidates meet every rule, but lose pairs of the model{stop} or let some overlap unseen; this one breaks"
                ),
            };
            writeln!(out, "{others}: {}.", formulas(&m.violated))?;
        }
    }
    let made = &m.steps_measured;
    if let Some(why) = &made.stopped {
        let others = match tried.iter().all(|other| other.measurement.steps_measured.stopped.is_some()) {
            true => "The steps stop under every set tried",
            false => "Under some other sets they do not, but these lose pairs of the model",
        };
        writeln!(out, "The steps stopped after {}: {why}. {others}.", steps_made(made, evaluator))?;
    }
    let steps = match (&made.stopped, made.made()) {
        (None, _) => Some(format!("In {} {}", made.steps, noun(made.steps, "step", "steps"))),
        (Some(_), 0) => None,
        (Some(_), _) => Some("Until then".to_owned()),
    };
    match steps {
        Some(steps) if made.overlaps.sunk == 0.0 => {
            writeln!(out, "{steps} no block sinks: no overlap grows beyond that of the scene as given.")?;
        }
        Some(steps) => writeln!(
            out,
            "{steps} blocks sink by at most {:.3e} m: by so much an overlap grows beyond that of the scene as given.",
            made.overlaps.sunk
        )?,
        None => writeln!(out, "So it is not known what blocks do under this set.")?,
    }
    if m.steps_measured.refused > 0 {
        writeln!(
            out,
            "{} of these steps, settling included, {}: the scene stops there (`unconverged = \"stop\"`), so `simulate` does not get as far with this set. {}.",
            m.steps_measured.refused,
            noun(m.steps_measured.refused, "does not converge", "do not converge"),
            match tried
                .iter()
                .map(|other| &other.measurement.steps_measured)
                .all(|o| o.refused > 0 || o.stopped.is_some())
            {
                true => "Nor with any other set tried: `simulate` says which contacts keep changing their mode",
                false =>
                    "With some other sets it does, but these are worse in what is compared before, or were not compared that far",
            }
        )?;
    }
    if m.steps_measured.deep > 0 {
        writeln!(
            out,
            "Blocks sink deeper than `penetration`, {:.3e} m, after {} {}, settling included, where no contact holds them that was not closed before. {}.",
            tried[best].set.penetration.approximate(),
            m.steps_measured.deep,
            noun(m.steps_measured.deep, "step", "steps"),
            match others_sink(tried) {
                Some(true) =>
                    "So they do under every set tried: joints are too soft for the loads, or no contact is there (`simulate --audit` tells)",
                Some(false) =>
                    "Under some other sets they do not, but these are worse in what is compared before, or were not compared that far",
                None => "So they do under every set tried under which the steps do not stop",
            }
        )?;
    }
    if made.explained.steps > 0 {
        let pairs = match made.explained.most_pairs {
            1 => "1 pair at a time".to_owned(),
            count => format!("up to {count} pairs"),
        };
        let all = made.made();
        writeln!(
            out,
            "Not counted are unseen overlaps that springs elsewhere explain: of {pairs} after {} of {all} {}, {:.3e} m at most.",
            made.explained.steps,
            noun(all, "step", "steps"),
            made.explained.deepest
        )?;
    }
    match &m.lockstep {
        Some(lockstep) => compared_with_oracle(out, lockstep, made, evaluator),
        None => Ok(()),
    }
}

/// Whether blocks sink deeper than `penetration` under every set; `None` where they do under all whose steps do not stop.
fn others_sink(tried: &[EvaluatedCandidate]) -> Option<bool> {
    let others = || tried.iter().map(|other| &other.measurement.steps_measured).filter(|other| other.deep == 0);
    match (others().count(), others().any(|other| other.stopped.is_none())) {
        (0, _) => Some(true),
        (_, true) => Some(false),
        (_, false) => None,
    }
}

/// How the steps made are the oracle's.
fn compared_with_oracle(
    out: &mut String,
    lockstep: &LockstepMeasures,
    made: &StepMeasures,
    evaluator: &Evaluator,
) -> std::fmt::Result {
    let among = settling_among(made, evaluator);
    let is_stopped = made.stopped.is_some();
    if lockstep.differ + lockstep.failed > 0 {
        let last = match (is_stopped, lockstep.steps > made.made()) {
            (false, _) => "",
            (true, true) => " The oracle makes the step at which the stepper stops.",
            (true, false) => " The oracle cannot make the step after them either.",
        };
        return writeln!(
            out,
            "{} of {} steps, {among}, differ from the oracle's ({} of {} contacts, and {} modes); one side could not make {}.{last}",
            lockstep.differ, lockstep.steps, lockstep.contacts, lockstep.found, lockstep.modes, lockstep.failed
        );
    }
    let [settling, given] = settling_steps(evaluator);
    let end = match is_stopped {
        true => ", which cannot make the next one either",
        false if settling < given => ": in a whole run others may differ",
        false => "",
    };
    match lockstep.steps {
        0 => writeln!(out, "The oracle cannot make the first step either."),
        1 => writeln!(out, "The one step made, {among}, equals the oracle's{end}."),
        steps => writeln!(out, "All {steps} steps, {among}, equal the oracle's{end}."),
    }
}

/// Which candidate differs on the fewest pairs, fewer than the best one, and why it is not the best: in the order of [`Measurement::merit`].
fn with_fewer_differences(tried: &[EvaluatedCandidate], best: &Measurement) -> String {
    let differ = |m: &Measurement| m.differences.avoidable();
    let fewer = tried.iter().enumerate().filter(|(_, other)| differ(&other.measurement) < differ(best));
    let Some((number, other)) = fewer.min_by_key(|(_, other)| differ(&other.measurement)) else {
        return "no candidate differs on fewer".to_owned();
    };
    let other = &other.measurement;
    let broken = other.violated.len();
    let unseen = |m: &Measurement| m.merit().unseen;
    let stopped = |m: &Measurement| m.merit().stopped;
    let why = if other.lost_pairs > 0 && best.lost_pairs == 0 {
        "but loses pairs of the model".to_owned()
    } else if stopped(other) > stopped(best) {
        format!("but its steps stop{}", if stopped(best).is_some() { " earlier" } else { "" })
    } else if unseen(other) > unseen(best) {
        let deeper = if unseen(best) > 0 { "deeper " } else { "" };
        format!("but lets pairs overlap {deeper}unseen by contacts in its steps")
    } else if broken > best.violated.len() {
        format!("but breaks {broken} {}", noun(broken as u64, "rule", "rules"))
    } else if other.differences.standing[1] > best.differences.standing[1] {
        "but on more of the pairs as they stand".to_owned()
    } else if other.lockstep.is_none() {
        "which may be chance: each set has perturbed pairs of its own; its steps were not compared with the oracle's"
            .to_owned()
    } else {
        "which may be chance: each set has perturbed pairs of its own; it is worse in what is compared next".to_owned()
    };
    format!("candidate {number} differs on {} of {}, {why}", differ(other), other.differences.examined())
}

/// What the set makes of blocks that overlap before the first step.
fn overlaps(out: &mut String, best: &Measurement, overlapping: u64) -> std::fmt::Result {
    match (best.lost_pairs, overlapping) {
        (0, 0) => writeln!(out, "Overlaps of the model by more than rounding: none."),
        (0, all) => {
            writeln!(out, "Overlaps of the model: {all}, each seen by a contact and none deeper than `penetration`.")
        }
        (lost, all) => writeln!(
            out,
            "Overlaps of the model: {all}, of which {lost} {are} deeper than `penetration` or seen by no contact, and some are under every candidate: \
             `simulate` will not begin (`check` names the pairs).",
            are = noun(lost, "is", "are")
        ),
    }
}

/// One row for each candidate.
fn table(out: &mut String, search: &Search<'_>, which: &[usize]) -> std::fmt::Result {
    writeln!(
        out,
        "| candidate | s | r | g | u | θo | θp | ε | criteria | differ | rules broken | slack | sinks | lockstep | changed |"
    )?;
    writeln!(out, "| --- | --: | --: | --: | --: | --: | --: | --: | --- | --: | --: | --: | --: | --: | --: |")?;
    for &number in which {
        let evaluated = &search.tried()[number];
        let (set, m) = (&evaluated.set, &evaluated.measurement);
        let d = &m.differences;
        let length = |value: &rockproof_model::Number| format!("{:.3e}", value.approximate());
        let angle = |sine: &rockproof_model::Number| format!("{:.2}°", sine.approximate().asin().to_degrees());
        let made = &m.steps_measured;
        let mut steps = match (&made.stopped, made.refused) {
            (Some(_), _) => "stopped".to_owned(),
            (None, 0) => format!("{:.2e} m", made.overlaps.sunk),
            (None, _) => format!("{:.2e} m, unconverged", made.overlaps.sunk),
        };
        if made.unseen.steps > 0 {
            steps.push_str(", unseen");
        }
        writeln!(
            out,
            "| {number} {} | {} | {} | {} | {} | {} | {} | {:.1e} | {} | {} + {} + {} ({}) | {} | {:.2} | {steps} | {} | {} |",
            evaluated.origin.name(),
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
            lockstep(m),
            d.changed,
        )?;
    }
    Ok(())
}

/// A line for each preset that has no row of its own.
fn absent_presets(out: &mut String, search: &Search<'_>) -> std::fmt::Result {
    if !search.absent().is_empty() {
        writeln!(out)?;
    }
    for (preset, why) in search.absent() {
        match why {
            AbsentPreset::Same(0) => writeln!(out, "- preset `{}`: the author's set", preset.name())?,
            AbsentPreset::Same(number) => writeln!(out, "- preset `{}`: the set of candidate {number}", preset.name())?,
            AbsentPreset::Refused(why) => writeln!(out, "- preset `{}`: not tried, {why}", preset.name())?,
        }
    }
    Ok(())
}

/// What the author's set does worse, in words.
fn compare(out: &mut String, (best, author): (&Measurement, &Measurement), evaluator: &Evaluator) -> std::fmt::Result {
    writeln!(out, "\nThe author's set:\n")?;
    if !author.violated.is_empty() {
        let count = author.violated.len();
        writeln!(out, "- breaks {count} {}: {}", noun(count, "rule", "rules"), formulas(&author.violated))?;
    }
    if author.lost_pairs != best.lost_pairs {
        let (theirs, ours) = (author.lost_pairs, best.lost_pairs);
        let overlaps = noun(theirs, "overlap", "overlaps");
        writeln!(out, "- leaves {theirs} {overlaps} of the model too deep or unseen, instead of {ours}")?;
    }
    let (ours, theirs) = (best.differences.avoidable(), author.differences.avoidable());
    if ours != theirs {
        let (ours_of, theirs_of) = (best.differences.examined(), author.differences.examined());
        writeln!(
            out,
            "- answers {theirs} of {theirs_of} pairs differently from the oracle, instead of {ours} of {ours_of}"
        )?;
    }
    // What is the same in the digits shown is not told.
    let share =
        |m: &Measurement| format!("{:.1} %", m.lockstep.as_ref().map_or(0.0, |lockstep| 100.0 * lockstep.share()));
    let (ours, theirs) = (share(best), share(author));
    // Those of some of the steps are no share of all.
    if ours != theirs && author.steps_measured.stopped.is_none() {
        writeln!(out, "- differs from the oracle in {theirs} of the contacts in steps, instead of {ours}")?;
    }
    let sunk = |m: &Measurement| format!("{:.3e} m", m.steps_measured.overlaps.sunk);
    let (ours, theirs) = (sunk(best), sunk(author));
    let stops = |m: &Measurement| m.steps_measured.stopped.clone().map(|why| (m.steps_measured.made(), why));
    match stops(author).filter(|_| stops(author) != stops(best)) {
        Some((_, why)) => writeln!(out, "- stops after {}: {why}", steps_made(&author.steps_measured, evaluator))?,
        None if ours != theirs && stops(best).is_none() => {
            writeln!(out, "- lets blocks sink by {theirs} instead of {ours}")?;
        }
        None => {}
    }
    let (ours, theirs) = (best.steps_measured.refused, author.steps_measured.refused);
    if ours != theirs {
        let steps = noun(theirs, "step", "steps");
        writeln!(
            out,
            "- leaves {theirs} {steps} unconverged, at the first of which `simulate` stops, instead of {ours}"
        )?;
    }
    let (ours, theirs) = (unseen_in_words(&best.steps_measured), unseen_in_words(&author.steps_measured));
    if ours != theirs {
        let [ours, theirs] = [ours, theirs].map(|words| words.unwrap_or("none".to_owned()));
        writeln!(out, "- has overlaps that no contact sees in steps: {theirs}; instead of: {ours}")?;
    }
    let (ours, theirs) = (best.steps_measured.deep, author.steps_measured.deep);
    if ours != theirs {
        writeln!(
            out,
            "- lets blocks sink deeper than its `penetration` in {theirs} {}, instead of {ours}",
            noun(theirs, "step", "steps")
        )?;
    }
    let [ours, theirs] = [best, author].map(|m| format!("{:.2}", m.tightest.factor));
    match ours == theirs {
        true => Ok(()),
        false => writeln!(out, "- meets the tightest rule by a factor of {theirs} instead of {ours}"),
    }
}
