//! The worst findings, each with a view to turn.

use super::{Section, SectionPart};
use crate::error::{ReportError, at};
use crate::load::{CampaignRun, RunFile};
use crate::table::{Table, TableCell, concerned, label, short, six_digits};
use crate::tally::{CHOICES, WORRYING, WorstFinding};
use crate::view;
use rockproof_differential::case_file::Case;
use rockproof_differential::external::EngineSpec;
use rockproof_differential::external::spec::quoted;
use rockproof_differential::finding::{Cause, FAR_FROM_TIE};
use rockproof_model::files::refuse_what_is_no_file;
use rockproof_model::text::escaped;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// How many findings of each cause the page shows.
const SHOWN: usize = 6;

/// A finding as the page shows it.
#[derive(Clone, Debug, Serialize)]
pub struct FindingView {
    /// Its name in the page.
    pub id: String,
    /// What it is, in one line.
    pub title: String,
    /// The cause.
    pub cause: &'static str,
    /// What each thing about it is.
    pub facts: Vec<(&'static str, String)>,
    /// The contacts.
    pub contacts: Vec<FindingContact>,
    /// The command that shows it decision by decision.
    pub replay: String,
    /// What plotly draws.
    pub traces: Vec<Value>,
}

/// A contact of it.
#[derive(Clone, Debug, Serialize)]
pub struct FindingContact {
    /// `true`, `seen` or `both`.
    pub who: &'static str,
    /// Kind, features and entrance.
    pub name: String,
    /// The gap (m).
    pub gap: String,
}

pub(super) fn section(campaigns: &[CampaignRun]) -> Result<Section, ReportError> {
    let mut section = Section::new(
        "worst",
        "The worst findings",
        "Of each cause the findings furthest from a tie, whichever side of it, which rounding excuses least; what is further than all found before it \
         has a case. A card describes the case, which is smaller than the pair it was found in; \"as found\" gives the figures of that pair, as in the table, where they differ. Open one to \
         see both blocks, or where one is much larger the surroundings of the smaller: drag to turn, scroll or pinch to come nearer. Green is \
         the true contact, orange the one that was seen.",
    );
    let mut table = Table::new(
        "worst",
        "The worst findings with a case",
        &[
            "run",
            "cause",
            "change",
            "engine",
            "kind_before",
            "kind_after",
            "predicate",
            "features",
            "magnitude",
            "margin",
            "margin_roundoffs",
            "family",
            "setting",
            "index",
            "case",
        ],
    );
    let mut views = Vec::new();
    for cause in WORRYING {
        for campaign in campaigns {
            let worst = campaign.tally.worst.get(&cause).map_or(&[][..], Vec::as_slice);
            for finding in worst {
                table.push(row(campaign, finding));
            }
            for finding in worst.iter().take(SHOWN) {
                let name = label(campaigns.len(), &campaign.name, finding.change.name());
                let mut view = match show(&campaign.dir, finding, name, views.len()) {
                    Ok(view) => view,
                    // One case that is none is no reason to show nothing of all the others.
                    Err(ReportError::Case(error)) => {
                        let text = format!("A case cannot be shown: {}", escaped(&error.to_string()));
                        section.parts.push(SectionPart::Unreadable(text));
                        continue;
                    }
                    Err(error) => return Err(error),
                };
                if let Some(spec) = specs(&campaign.run).iter().find(|spec| spec.name == finding.engine) {
                    view.replay += &format!(" --engine-command {}", spec.argument());
                }
                views.push(view);
            }
        }
    }
    if views.is_empty() && section.parts.is_empty() {
        section.parts.push(SectionPart::Text("No finding was kept as a case.".to_owned()));
    }
    section.parts.push(SectionPart::Findings(views));
    section.parts.push(SectionPart::Quiet(table));
    Ok(section)
}

/// The external engines of a run.
fn specs(run: &RunFile) -> Vec<EngineSpec> {
    let all = run.configuration.get("external").and_then(Value::as_array).into_iter().flatten();
    // What is no engine is not replayed with one.
    all.filter_map(|spec| EngineSpec::deserialize(spec).ok()).collect()
}

fn row(campaign: &CampaignRun, finding: &WorstFinding) -> Vec<TableCell> {
    let [before, after] = &finding.kinds;
    vec![
        campaign.name.as_str().into(),
        finding.cause.name().into(),
        finding.change.name().into(),
        TableCell::Scope(finding.engine.clone()),
        before.as_str().into(),
        after.as_str().into(),
        finding.predicate.as_str().into(),
        finding.features.as_str().into(),
        TableCell::number(Some(finding.magnitude()).filter(|size| size.is_finite())),
        TableCell::number(finding.margin),
        TableCell::number(finding.margin_ulps),
        finding.family.as_str().into(),
        finding.tolerances.as_str().into(),
        finding.index.into(),
        finding.case.as_str().into(),
    ]
}

fn show(dir: &Path, finding: &WorstFinding, name: String, number: usize) -> Result<FindingView, ReportError> {
    let path = dir.join(&finding.case);
    if !lies_in(dir, &path) {
        let found = "the case lies outside of the run, behind a link".to_owned();
        let other = "a report reads what is in the directory of the run".to_owned();
        return Err(ReportError::Contradiction { file: path, found, other });
    }
    refuse_what_is_no_file(&path).map_err(at(&path))?;
    let case = Case::load(&path)?;
    let about = ShownCase { cause: finding.cause, predicate: &finding.predicate, engine: &finding.engine, file: &path };
    let mut view = about.view(&case, &name, number);
    if let Some(found) = as_found(finding, &case) {
        view.facts.insert(view.facts.iter().take_while(|(what, _)| *what != "from").count(), ("as found", found));
    }
    Ok(view)
}

/// What decided the finding of the pair as it was found, and how far from a tie that was, where the case that was made small has other figures.
fn as_found(finding: &WorstFinding, case: &Case) -> Option<String> {
    let about = &case.about;
    let found = (finding.margin, finding.margin_ulps, &finding.predicate, &finding.features);
    if found == (about.margin, about.margin_ulps, &about.predicate, &about.features) {
        return None;
    }
    let decided = if finding.predicate.is_empty() {
        "no decision".to_owned()
    } else {
        format!("{} of {}", finding.predicate, finding.features)
    };
    let margin = match (finding.margin, finding.margin_ulps) {
        (_, Some(ulps)) => format!("{} roundoffs", short(ulps)),
        (Some(margin), None) => format!("margin {}", short(margin)),
        (None, None) => "no margin".to_owned(),
    };
    Some(format!("{decided}, {margin}"))
}

/// What of a finding the case itself says only in words.
#[derive(Clone, Copy, Debug)]
pub struct ShownCase<'f> {
    /// Its cause.
    pub cause: Cause,
    /// The deciding predicate by name, empty where there is none.
    pub predicate: &'f str,
    /// Whom it is about.
    pub engine: &'f str,
    /// The file of the case.
    pub file: &'f Path,
}

impl ShownCase<'_> {
    /// The case as the page shows it; `number` tells it from others on the page.
    pub fn view(&self, case: &Case, name: &str, number: usize) -> FindingView {
        let contacts = view::contacts(case);
        let (mut traces, centre) = view::traces(case, &contacts);
        view::round(&mut traces);
        let about = &case.about;
        let kinds = if about.kind.is_empty() { "the pair".to_owned() } else { about.kind.clone() };
        let mut facts = vec![("who", about.engine.clone())];
        if !about.predicate.is_empty() {
            let how = if self.cause == Cause::Engine { "nearest tie" } else { "decided by" };
            facts.push((how, format!("{} of {}", about.predicate, about.features)));
        }
        if let Some(margin) = about.margin {
            let size = if margin == 0.0 { "0, a tie".to_owned() } else { short(margin) };
            facts.push(("margin", size));
        }
        if let Some(ulps) = about.margin_ulps {
            facts.push(("in roundoffs", short(ulps)));
        }
        facts.extend(self.remark(about.margin_ulps.map(f64::abs)).map(|text| ("what that means", text.to_owned())));
        facts.push(("from", about.origin.clone()));
        for (what, text) in [("lying", &about.states), ("the engine said", &about.note)] {
            facts.extend(text.iter().map(|text| (what, text.clone())));
        }
        facts.push(("axes from", format!("({})", centre.map(six_digits).join(", "))));
        let row =
            |c: &view::ViewedContact| FindingContact { who: c.side_name(), name: c.name(), gap: nine_digits(c.gap_m) };
        FindingView {
            id: format!("finding-{number}"),
            title: format!("{name}: {kinds}, {}", concerned(self.engine)),
            cause: self.cause.name(),
            facts,
            contacts: contacts.iter().map(row).collect(),
            replay: format!("rockproof replay {}", escaped(&quoted(&self.file.display().to_string()))),
            traces,
        }
    }

    /// What a margin says about where to look.
    fn remark(&self, ulps: Option<f64>) -> Option<&'static str> {
        if ulps? <= FAR_FROM_TIE {
            return None;
        }
        match self.cause {
            Cause::Arithmetic if CHOICES.iter().any(|choice| choice.name() == self.predicate) => Some(
                "No rounding turns what is so clear: it follows from a choice, nearly tied, that was made before it and is no decision of its own. \
                 Replay lists all decisions that parted, in order.",
            ),
            Cause::Arithmetic => Some(
                "The rounding of a sound formula is not so large: a formula here cancels, and can be written better.",
            ),
            Cause::Engine => Some(
                "None of the oracle's decisions near the difference is so near to a tie that rounding could be the reason: almost surely a mistake.",
            ),
            _ => None,
        }
    }
}

/// Whether a file lies in a directory, links followed. Of one that is not there the reader tells.
fn lies_in(dir: &Path, file: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    real(dir).zip(real(file)).is_none_or(|(dir, file)| file.starts_with(dir))
}

/// A gap as a reader likes it; the command below gives it in full.
fn nine_digits(gap_m: f64) -> String {
    format!("{:?}", format!("{gap_m:.8e}").parse().unwrap_or(gap_m))
}
