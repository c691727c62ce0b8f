//! `replay`: what each engine and the oracle say about a case, side by side, and decision by decision where they part.

use crate::classify::contact_json;
use crate::engine_decisions::{EngineDecisions, changed_answers, exact_state};
use crate::exit::{ExitStatus, Outcome, print_note};
use crate::input::{EngineArgs, FormatArgs};
use crate::input_file::InputFile;
use crate::replay_step;
use crate::table::table;
use rockproof_campaign::engines::Engines;
use rockproof_differential::answer_detail::left_unsaid;
use rockproof_differential::attribution::examine_pair;
use rockproof_differential::builtin::BuiltinOracle;
use rockproof_differential::case_file::{Case, contact_rows};
use rockproof_differential::engine::{Oracle, catch_panic};
use rockproof_differential::explain::{DivergentDecision, divergent_decisions};
use rockproof_differential::external::protocol::completed;
use rockproof_differential::finding::{Cause, Finding, FindingScope};
use rockproof_differential::indexed_trace::IndexedTrace;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Precision, ToleranceSet};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt;
use std::io::{self, Write};

/// Show what each engine and the oracle say about a case, decision by decision where they differ
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof replay reports/campaign-1/cases/v-f-arithmetic-….toml
  rockproof replay reports/simulate-incline/states/step_000012.json

Exit status: 0 the finding recurs, 1 it does not, or the exact answer is not the one the case records, 2 input error.")]
pub(crate) struct Replay {
    /// The case of a campaign (.toml), or a step of a lockstep run (.json); or - for stdin, with either
    #[arg(value_hint = clap::ValueHint::FilePath)]
    case: InputFile,
    #[command(flatten)]
    external: EngineArgs,
    #[command(flatten)]
    format: FormatArgs,
}

/// What everybody says about a case.
struct CaseAnswers {
    said: Vec<EngineDecisions>,
    partings: Vec<Divergence>,
    /// How the pair was changed that some of the answers are about, where the finding is about such a change.
    changed: Option<String>,
}

/// The margins of the decisions that parted, and the unit to count them in.
struct Divergence {
    title: String,
    parted: Vec<DivergentDecision>,
    margins: Vec<Option<f64>>,
    roundoff: f64,
}

impl Replay {
    pub(crate) fn run(&self) -> Outcome {
        let (text, path) = (self.case.case_text()?, self.case.path());
        if self.case.is_step(&text) {
            return replay_step::run(&text, path, &self.format);
        }
        let case = Case::from_toml(&text, path.display().to_string())?;
        let engines = self.external.engines_of(&case, path)?;
        let answers = answers(&case, &engines);
        let said = &answers.said;
        let recurrence = Recurrence::of(&case, &engines);
        engines.check_shortage()?;
        if !recurrence.recurs() {
            // An engine that answers nothing shows nothing: that its finding is gone means something only of one that answers.
            engines.probe_named(&case.about.engine)?;
        }
        let recorded = match case.about.cause.as_str() {
            "tolerance" => &said[0],
            "representation" => &said[1],
            _ => {
                said.iter().find(|s| s.name == format!("exact {}", precision_name(&case, &engines))).unwrap_or(&said[1])
            }
        };
        let is_expected =
            recorded.contacts.as_deref().is_ok_and(|contacts| contact_rows(contacts) == case.about.expected);
        let mut text = Vec::new();
        show(&mut text, &case, &answers)?;
        writeln!(text, "\n{recurrence}")?;
        if let (Recurrence::Gone(_), Some(note)) = (&recurrence, &case.about.note) {
            writeln!(text, "when it was found: {}", excerpt(note, NOTE_LENGTH))?;
        }
        self.format.print(
            || String::from_utf8_lossy(&text).into_owned(),
            || document(&case, &answers, &recurrence, is_expected),
        )?;
        if is_expected {
            return Ok(if recurrence.recurs() { ExitStatus::Passed } else { ExitStatus::CheckFailed });
        }
        print_note(&format!("the answer of \"{}\" is not the one the case expects", recorded.name));
        Ok(ExitStatus::CheckFailed)
    }
}

/// Whether the pair of a case still shows its finding.
enum Recurrence {
    /// What the engine said in place of an answer, each text once; the answers shown beside may be right, as where it answers an earlier question.
    Recurs(Vec<String>),
    /// What the pair shows in its place, about the same engine or the same rounding, each once.
    Gone(Vec<String>),
    /// What the engine says nothing of now, in words, though the finding is about it: nobody knows whether it recurs.
    Unsaid(String),
}

/// So many characters of a case's note are told.
const NOTE_LENGTH: usize = 400;

/// Findings in place of the one of a case that are told.
const TOLD: usize = 4;

impl Recurrence {
    fn of(case: &Case, engines: &Engines) -> Recurrence {
        let Some(panel) = engines.panel_of(case) else { return Recurrence::Gone(Vec::new()) };
        let found = case.findings(&panel);
        if !found.is_empty() {
            let mut said: Vec<String> = Vec::new();
            let of_engine = |finding: &Finding| {
                matches!(finding.scope, FindingScope::Engine(_)) && finding.difference.change.is_unusable()
            };
            for note in found.into_iter().filter(of_engine).filter_map(|finding| finding.note) {
                if !said.contains(&note) {
                    said.push(note);
                }
            }
            return Recurrence::Recurs(said);
        }
        let mut others: Vec<String> = Vec::new();
        for finding in examine_pair(&case.subject(), &panel).findings {
            let scope = finding.scope.to_string();
            let other = format!("{} {} by {scope}", finding.cause, finding.difference.change);
            if scope == case.about.engine && !others.contains(&other) {
                others.push(other);
            }
        }
        match unsaid(case, engines).filter(|_| others.is_empty()) {
            Some(unsaid) => Recurrence::Unsaid(format!("{} gives {unsaid} now", case.about.engine)),
            None => Recurrence::Gone(others),
        }
    }

    fn recurs(&self) -> bool {
        matches!(self, Recurrence::Recurs(_))
    }
}

impl fmt::Display for Recurrence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Recurrence::Recurs(said) => {
                f.write_str("the finding recurs")?;
                said.iter().take(TOLD).try_for_each(|note| write!(f, "\n  {}", excerpt(note, NOTE_LENGTH)))
            }
            Recurrence::Unsaid(what) => {
                write!(f, "whether the finding recurs is not known: {what}, and what is not given is not compared")
            }
            Recurrence::Gone(others) if others.is_empty() => {
                f.write_str("the finding does not recur: nothing differs there now")
            }
            Recurrence::Gone(others) => {
                let more = others.len().saturating_sub(TOLD);
                write!(f, "the finding does not recur: now it is {}", others[..others.len() - more].join(", "))?;
                if more > 0 { write!(f, " and {more} more") } else { Ok(()) }
            }
        }
    }
}

/// What an external engine leaves unsaid now of what the case is about.
fn unsaid(case: &Case, engines: &Engines) -> Option<&'static str> {
    let engine = engines.find(&case.about.engine).filter(|_| case.about.cause == Cause::Engine.name())?;
    let precision = engine.precision();
    let [a, b] = [case.a.rounded(precision)?, case.b.rounded(precision)?];
    let tolerances = case.tolerances.rounded(precision).ok()?;
    left_unsaid(&case.about, &catch_panic(|| engine.prepare(&a, &b)?.answer(&tolerances)).ok()?)
}

/// The precision of the engine the case is about.
fn precision_name(case: &Case, engines: &Engines) -> String {
    engines.find(&case.about.engine).map_or_else(|| case.about.engine.clone(), |e| e.precision().to_string())
}

fn answers(case: &Case, engines: &Engines) -> CaseAnswers {
    let prepared = BuiltinOracle.prepare(&case.a, &case.b);
    let pair = prepared.pair();
    let exact = |name: &str, tolerances: &ToleranceSet| EngineDecisions {
        name: name.to_owned(),
        contacts: Ok(pair.classify(tolerances).contacts),
        trace: Some(pair.trace(tolerances)),
        state: None,
        is_exact: true,
    };
    let all: Vec<_> = engines.names().iter().filter_map(|name| engines.find(name)).collect();
    let mut said = vec![exact("ideal", &case.tolerances.ideal()), exact("exact", &case.tolerances)];
    let (mut partings, mut changed) = (Vec::new(), None);
    let mut part = |title: String,
                    one: &EngineDecisions,
                    other: &EngineDecisions,
                    roundoff,
                    margins: &dyn Fn(&[_]) -> Vec<Option<f64>>| {
        let (Some(before), Some(after)) = (&one.trace, &other.trace) else { return };
        let parted = divergent_decisions(&IndexedTrace::of(before.clone()), after);
        if !parted.is_empty() {
            let decisions: Vec<_> = parted.iter().map(|p| p.decision).collect();
            partings.push(Divergence { title, margins: margins(&decisions), parted, roundoff });
        }
    };
    let unit = |precision: Precision| precision.epsilon() / 2.0;
    let given = |decisions: &[_]| pair.margins(&case.tolerances, decisions);
    part("tolerance: ideal, exact".to_owned(), &said[0], &said[1], unit(Precision::F64), &given);
    for precision in [Precision::F32, Precision::F64] {
        let near =
            || Some((case.a.rounded(precision)?, case.b.rounded(precision)?, case.tolerances.rounded(precision).ok()?));
        let Some((a, b, tolerances)) = near() else { continue };
        let blocks = [a, b];
        let [a, b] = &blocks;
        let prepared = BuiltinOracle.prepare(a, b);
        let rounded = prepared.pair();
        let name = format!("exact {precision}");
        let contacts = Ok(rounded.classify(&tolerances).contacts);
        let trace = Some(rounded.trace(&tolerances));
        let mut here = EngineDecisions { name: name.clone(), contacts, trace, state: None, is_exact: true };
        part(format!("representation in {precision}: exact, {name}"), &said[1], &here, unit(precision), &given);
        let margins = |decisions: &[_]| rounded.margins(&tolerances, decisions);
        let mut others = Vec::new();
        for engine in all.iter().filter(|e| e.precision() == precision) {
            let prepared = catch_panic(|| engine.prepare(a, b));
            let (answer, trace) = match prepared {
                Ok(prepared) => (catch_panic(|| prepared.answer(&tolerances)), prepared.trace(&tolerances)),
                Err(failure) => (Err(failure), None),
            };
            let right = here.contacts.as_deref().unwrap_or(&[]);
            let answer = answer.map(|answer| answer.map_contacts(|contacts| completed(contacts, right)));
            let there = EngineDecisions::of(engine.name().to_owned(), answer, trace);
            let says_state = there.state.is_some();
            if says_state && here.state.is_none() {
                here.state = exact_state(&blocks);
            }
            part(format!("arithmetic: {name}, {}", there.name), &here, &there, unit(precision), &margins);
            others.push(there);
            if let Some((words, answers)) = changed_answers(case, &**engine, says_state) {
                others.extend(answers);
                changed = Some(words);
            }
        }
        said.push(here);
        said.extend(others);
    }
    CaseAnswers { said, partings, changed }
}

/// The same for programs.
fn document(
    case: &Case,
    CaseAnswers { said, partings, changed }: &CaseAnswers,
    recurrence: &Recurrence,
    is_expected: bool,
) -> Value {
    let about = &case.about;
    let answer = |one: &EngineDecisions| {
        let contacts = one.contacts.as_deref().ok().filter(|_| one.state.is_none() || one.is_exact);
        json!({
            "name": one.name,
            "contacts": contacts.map(|contacts| contacts.iter().map(contact_json).collect::<Vec<_>>()),
            "state": one.state,
            "failure": one.contacts.as_ref().err().map(ToString::to_string),
        })
    };
    let parting = |parting: &Divergence| {
        let decisions = parting.parted.iter().zip(&parting.margins).map(|(parted, margin)| {
            let [first, second] = parted.outcomes.map(|outcome| outcome.to_string());
            json!({
                "decision": parted.decision.to_string(), "first": first, "second": second, "margin": margin,
                "roundoffs": margin.map(|margin| margin / parting.roundoff),
            })
        });
        json!({ "between": parting.title, "decisions": decisions.collect::<Vec<_>>() })
    };
    let shown_instead: &[String] = match recurrence {
        Recurrence::Recurs(_) | Recurrence::Unsaid(_) => &[],
        Recurrence::Gone(others) => others,
    };
    let said_again: &[String] = match recurrence {
        Recurrence::Recurs(said) => said,
        Recurrence::Gone(_) | Recurrence::Unsaid(_) => &[],
    };
    let not_known = match recurrence {
        Recurrence::Unsaid(what) => Some(what),
        Recurrence::Recurs(_) | Recurrence::Gone(_) => None,
    };
    json!({
        "finding": {
            "cause": about.cause, "change": about.change, "engine": about.engine, "predicate": about.predicate,
            "features": about.features, "margin": about.margin, "roundoffs": about.margin_ulps, "origin": about.origin,
            "note": about.note, "check": about.check,
        },
        "recurs": recurrence.recurs(),
        "not_known": not_known,
        "said_again": said_again,
        "shown_instead": shown_instead,
        "exact_answer_as_recorded": is_expected,
        "changed_pair": changed,
        "answers": said.iter().map(answer).collect::<Vec<_>>(),
        "partings": partings.iter().map(parting).collect::<Vec<_>>(),
    })
}

fn show(out: &mut impl Write, case: &Case, CaseAnswers { said, partings, changed }: &CaseAnswers) -> io::Result<()> {
    let about = &case.about;
    // An engine from outside tells no decisions.
    let how = if about.cause == Cause::Engine.name() { "nearest tie" } else { "decided by" };
    let decided = match about.predicate.as_str() {
        "" => String::new(),
        predicate => format!(", {how} {predicate} {}", excerpt(&about.features, EXCERPT_LENGTH)),
    };
    writeln!(out, "{} {} by {}{decided}", about.cause, about.change, about.engine)?;
    if let Some(margin) = about.margin {
        let ulps = about.margin_ulps.map_or(String::new(), |u| format!(", {u:.3} roundoffs"));
        writeln!(out, "margin {margin:e}{ulps}")?;
    }
    writeln!(out, "from {}\n", excerpt(&about.origin, EXCERPT_LENGTH))?;
    if let (Some(words), Some(change)) = (changed, about.checked_change()) {
        writeln!(out, "{change}: \"…, {change}\" are answers to the same pair with {words}\n")?;
    }
    let keys: BTreeSet<_> = said.iter().flat_map(|s| s.contacts.iter().flatten()).map(|c| c.key).collect();
    let mut header = vec!["contact"];
    header.extend(said.iter().map(|s| s.name.as_str()));
    let cell = |answer: &EngineDecisions, key| match &answer.contacts {
        Err(failure) => failure.to_string(),
        Ok(contacts) => contacts.iter().find(|c| c.key == key).map_or("–".to_owned(), |c| {
            let gap = ["overlap", "touch", "apart"][(c.gap.as_i8() + 1) as usize];
            format!("{} {gap}", c.entrance)
        }),
    };
    let rows = keys.iter().map(|&key| {
        let mut row = vec![key.to_string()];
        row.extend(said.iter().map(|answer| cell(answer, key)));
        row
    });
    writeln!(out, "{}", table(&header, &[], rows))?;
    for lying in said {
        if let Some(state) = &lying.state {
            writeln!(out, "{}: {state}", lying.name)?;
        }
    }
    for failed in said {
        if let Err(failure) = &failed.contacts {
            writeln!(out, "{} gave no answer: {failure}", failed.name)?;
        }
    }
    for parting in partings {
        writeln!(out, "\n{}", parting.title)?;
        let rows = parting.parted.iter().zip(&parting.margins).map(|(p, margin)| {
            let margin_text = |scale: f64| margin.map_or("–".to_owned(), |m| format!("{:.3e}", m / scale));
            let shown = if *margin == Some(0.0) { "tie".to_owned() } else { margin_text(1.0) };
            let [before, after] = p.outcomes.map(|o| o.to_string());
            vec![p.decision.to_string(), before, after, shown, margin_text(parting.roundoff)]
        });
        writeln!(out, "{}", table(&["decision", "first", "second", "margin", "roundoffs"], &[1, 2, 3, 4], rows))?;
    }
    Ok(())
}
