//! `replay` of a state file: one step again on both sides, beside each other.

use crate::classify::contact_json;
use crate::exit::{ExitStatus, Outcome, print_note};
use crate::input::FormatArgs;
use crate::table::table;
use anyhow::Context;
use rockproof_differential::lockstep::answer::described;
use rockproof_differential::lockstep::intrusion::PairIntrusion;
use rockproof_differential::lockstep::replay::recorded_depths;
use rockproof_differential::lockstep::{
    AttributedDifference, ComparedStep, Drift, Intrusion, ReplayedStep, StepCase, StepDecisions, WatchedStep,
};
use rockproof_model::Contact;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Makes the step of a state file again; messages call it by `path`. Exit 0 where it still differs and the oracle's answer is the one recorded, 1 otherwise.
pub(super) fn run(text: &str, path: &Path, format: &FormatArgs) -> Outcome {
    let case = StepCase::parse(text).with_context(|| path.display().to_string())?;
    let replayed = ReplayedStep::of(&case).with_context(|| path.display().to_string())?;
    let (compared, drift) = (&replayed.compared, replayed.drift);
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = show(&mut text, &case, compared, drift);
    let _ = show_depths(&mut text, &case, &replayed);
    let (recurs, undecided) = (replayed.recurs(), replayed.undecided());
    text += &match &undecided {
        Some(undecided) => format!("\nwhether the finding recurs is not known: {undecided}\n"),
        None if recurs => "\nthe finding recurs\n".to_owned(),
        None => "\nthe finding does not recur: nothing differs in the step now\n".to_owned(),
    };
    let is_expected = replayed.is_expected(&case);
    format.print(|| text, || document(&case, &replayed, is_expected))?;
    if is_expected {
        return Ok(if recurs { ExitStatus::Passed } else { ExitStatus::CheckFailed });
    }
    print_note("the oracle's answer is not the one recorded");
    Ok(ExitStatus::CheckFailed)
}

/// The same for programs.
fn document(case: &StepCase, replayed: &ReplayedStep, is_expected: bool) -> Value {
    let (step, drift) = (&replayed.compared, replayed.drift);
    let side = |answer: &StepDecisions| {
        let contact = |(number, (blocks, contact)): (usize, &([u32; 2], Contact))| {
            let modes: Vec<&str> = answer.modes.iter().filter_map(|all| Some(all.get(number)?.name())).collect();
            json!({ "blocks": blocks, "contact": contact_json(contact), "modes": modes })
        };
        json!({
            "contacts": answer.contacts.iter().enumerate().map(contact).collect::<Vec<_>>(),
            "solves": answer.iterations(),
            "converged": answer.converged,
            "given_up_before": answer.retries.iter().map(|why| why.name()).collect::<Vec<_>>(),
            "time_step_s": answer.time_step,
        })
    };
    let difference = |attributed: &AttributedDifference| {
        let one = &attributed.difference;
        json!({
            "cause": attributed.cause.name(), "change": one.change.name(),
            "blocks": one.contact.map(|(blocks, _)| blocks),
            "contact": one.contact.map(|(_, contact)| contact_json(&contact)),
            "solve": one.solve, "before": one.before, "after": one.after,
            "decision": attributed.deciding.map(|deciding| deciding.decision.to_string()),
            "margin": attributed.margin(),
        })
    };
    let intrusions = |watched: &WatchedStep| {
        let side = |found: &[PairIntrusion]| -> Vec<Value> {
            let one =
                |one: &PairIntrusion| json!({ "kind": one.kind.name(), "blocks": one.blocks, "depth_m": one.depth });
            found.iter().map(one).collect()
        };
        let causes = watched.attributed.iter().map(|one| {
            let [before, after] = one.words();
            json!({ "cause": one.cause.name(), "kind": one.kind.name(), "blocks": one.blocks, "before": before, "after": after })
        });
        json!({
            "oracle": side(&watched.oracle.found), "stepper": side(&watched.stepper.found),
            "undecided": { "oracle": watched.oracle.undecided, "stepper": watched.stepper.undecided },
            "causes": causes.collect::<Vec<_>>(),
        })
    };
    let failure = Some(&step.failure).filter(|failure| !failure.is_empty());
    let [stepper, oracle] = step.penetration;
    json!({
        "step": case.step, "engine": case.engine, "recorded_by": case.version,
        "recurs": replayed.recurs(),
        "not_known": replayed.undecided(),
        "exact_answer_as_recorded": is_expected,
        "oracle": step.oracle.as_ref().map(side),
        "stepper": step.stepper.as_ref().map(side),
        "failure": failure,
        "differences": step.differences.iter().map(difference).collect::<Vec<_>>(),
        "intrusions": step.watched.as_ref().map(intrusions),
        "state": drift.map(|drift| json!({ "cause": "defect", "change": drift.what.name(), "error": drift.error })),
        "penetration_m": { "stepper": stepper, "oracle": oracle },
    })
}

fn show(out: &mut String, case: &StepCase, step: &ComparedStep, drift: Option<Drift>) -> std::fmt::Result {
    writeln!(out, "step {} in {}, recorded by {}\n", case.step, case.engine, excerpt(&case.version, EXCERPT_LENGTH))?;
    let both = [&step.oracle, &step.stepper].map(Option::as_ref);
    let sides = both.map(|answer| answer.map_or_else(|| [(); 5].map(|()| "–".to_owned()), in_words));
    let names = ["contacts", "solves", "converged", "given up before", "Δt (s)"];
    let rows = (0..names.len()).map(|k| vec![names[k].to_owned(), sides[0][k].clone(), sides[1][k].clone()]);
    writeln!(out, "{}", table(&["", "oracle", "stepper"], &[1, 2], rows))?;
    let mut all: Vec<([u32; 2], Contact)> = both.iter().flatten().flat_map(|a| a.contacts.iter().copied()).collect();
    let key = |(pair, c): &([u32; 2], Contact)| (*pair, c.key);
    all.sort_by_key(key);
    all.dedup_by_key(|one| key(one));
    let rows = all.iter().map(|one| {
        let name = format!("{}-{} {}", one.0[0], one.0[1], one.1.key);
        let mut row = vec![name];
        row.extend(both.map(|answer| answer.map_or("–".to_owned(), |answer| of_contact(answer, one))));
        row
    });
    writeln!(out, "{}", table(&["contact", "oracle", "stepper"], &[], rows))?;
    if !step.failure.is_empty() {
        writeln!(out, "{}", step.failure)?;
    }
    for attributed in &step.differences {
        let d = &attributed.difference;
        let about = d.contact.map_or(String::new(), |([a, b], c)| format!(" {a}-{b} {}", c.key));
        let solve = d.solve.map_or(String::new(), |solve| format!(" after solve {solve}"));
        write!(out, "{}: {}{about}{solve}: {} → {}", attributed.cause, d.change.name(), d.before, d.after)?;
        let decision = attributed.deciding.map_or(String::new(), |deciding| format!("; {}", deciding.decision));
        let margin = attributed.margin().map_or(String::new(), |margin| {
            format!("{} margin {margin:e}", if decision.is_empty() { ";" } else { "," })
        });
        writeln!(out, "{decision}{margin}")?;
    }
    if let Some(drift) = drift {
        writeln!(out, "defect: {drift}")?;
    }
    if let Some(watched) = &step.watched {
        show_intrusions(out, watched)?;
    }
    if let Some(depths) = &step.depths {
        let [with_contacts, with_modes] = [depths.contacts, depths.modes];
        writeln!(
            out,
            "penetration {:e} m, {with_contacts:e} m with the oracle's contacts, {with_modes:e} m with its modes too, {:e} m exactly: {}",
            depths.stepper,
            depths.oracle,
            depths.effect().name()
        )?;
    }
    Ok(())
}

/// The depths of a case that is about them.
fn show_depths(out: &mut String, case: &StepCase, replayed: &ReplayedStep) -> std::fmt::Result {
    if let (None, Some(_), [Some(stepper), Some(oracle)]) =
        (&replayed.compared.depths, recorded_depths(case).next(), replayed.compared.penetration)
    {
        writeln!(out, "penetration {stepper:e} m, {oracle:e} m exactly")?;
    }
    replayed.depth.map_or(Ok(()), |depth| writeln!(out, "{}", depth.words()))
}

/// The passages and unseen overlaps of both sides, and their causes.
fn show_intrusions(out: &mut String, watched: &WatchedStep) -> std::fmt::Result {
    for (side, found) in [("oracle", &watched.oracle), ("stepper", &watched.stepper)] {
        for one in &found.found {
            let ([a, b], depth) =
                (one.blocks, one.depth.map_or("deep".to_owned(), |depth| format!("{depth:e} m deep")));
            match one.kind {
                Intrusion::Passage => writeln!(
                    out,
                    "{side}: {a} and {b} pass through one another: {depth} after {} of the step",
                    one.time
                )?,
                Intrusion::Unseen => writeln!(out, "{side}: {a} and {b} overlap unseen after the step: {depth}")?,
            }
        }
        for [a, b] in &found.undecided {
            writeln!(out, "{side}: whether {a} and {b} pass through one another stayed undecided")?;
        }
    }
    for attributed in &watched.attributed {
        let ([a, b], [before, after]) = (attributed.blocks, attributed.words());
        writeln!(out, "{}: {} {a}-{b}: {before} → {after}", attributed.cause, attributed.kind.name())?;
    }
    Ok(())
}

fn in_words(answer: &StepDecisions) -> [String; 5] {
    let retries = if answer.retries.is_empty() { "nothing".to_owned() } else { answer.retries_text() };
    let [contacts, solves] = [answer.contacts.len(), answer.iterations()].map(|count| count.to_string());
    [contacts, solves, answer.converged.to_string(), retries, answer.time_step.to_string()]
}

/// A contact's entrance and its modes after each solve, in one answer.
fn of_contact(answer: &StepDecisions, (pair, contact): &([u32; 2], Contact)) -> String {
    let same = |(blocks, c): &([u32; 2], Contact)| blocks == pair && c.key == contact.key;
    let Some(place) = answer.contacts.iter().position(same) else { return "–".to_owned() };
    let modes: Vec<&str> = answer.modes.iter().filter_map(|all| all.get(place)).map(|mode| mode.name()).collect();
    let whole = described(&answer.contacts[place].1);
    let entrance = whole.split_once(" by ").map_or(whole.as_str(), |(_, entrance)| entrance);
    format!("{entrance}: {}", modes.join(", "))
}
