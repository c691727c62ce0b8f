//! Which kind of contact was taken for which.

use super::{Section, SectionPart};
use crate::load::{CampaignRun, ConfusionCounts};
use crate::table::{Table, TableCell, grouped, label};
use rockproof_differential::agreement::{ChainSpan, NONE};
use rockproof_differential::separation_state::SeparationState;
use rockproof_model::ContactKind;
use serde::Serialize;

/// A confusion matrix as the page shows it.
#[derive(Clone, Debug, Serialize)]
pub struct Matrix {
    /// What was compared.
    pub title: String,
    /// How many are off the diagonal, of how many.
    pub note: String,
    /// Whether the page shows it at once.
    pub open: bool,
    /// The columns.
    pub kinds: Vec<&'static str>,
    /// The rows.
    pub rows: Vec<MatrixRow>,
}

/// A row of it.
#[derive(Clone, Debug, Serialize)]
pub struct MatrixRow {
    /// The true kind.
    pub kind: &'static str,
    /// The kinds seen.
    pub cells: Vec<MatrixCell>,
}

/// A cell of it.
#[derive(Clone, Debug, Serialize)]
pub struct MatrixCell {
    /// The count, or nothing for zero.
    pub count: String,
    /// The share of its row, in percent.
    pub share: f64,
    /// Whether both kinds are the same.
    pub right: bool,
}

/// How many settings of an engine have a matrix of their own.
const MAX_SETTINGS: usize = 16;

pub(super) fn section(campaigns: &[CampaignRun]) -> Section {
    let mut section = Section::new(
        "kinds",
        "Which kind is taken for which?",
        "Rows: what a contact truly is. Columns: what the engine saw. The diagonal is right; none in a row is a contact that the \
         engine invents, none in a column one that it misses. Shades are shares of the row.",
    );
    let mut table = Table::new(
        "confusion",
        "Kinds before and after each link",
        &["run", "setting", "engine", "compared", "true_kind", "seen_kind", "contacts"],
    );
    let mut matrices = Vec::new();
    let mut left_out = 0;
    for campaign in campaigns {
        for (compared, confusion) in &campaign.confusion {
            for ((before, after), count) in confusion {
                table.push(vec![
                    campaign.name.as_str().into(),
                    compared.tolerances.as_str().into(),
                    TableCell::Scope(compared.engine.clone()),
                    compared.span.name().into(),
                    before.as_str().into(),
                    after.as_str().into(),
                    (*count).into(),
                ]);
            }
        }
        for engine in campaign.engines() {
            let has = |span| campaign.confusion.keys().any(|c| c.span == span && c.engine == engine);
            let span = if has(ChainSpan::Whole) { ChainSpan::Whole } else { ChainSpan::Arithmetic };
            let of = || campaign.confusion.iter().filter(|(c, _)| c.span == span && c.engine == engine);
            let mut all = ConfusionCounts::new();
            for (became, count) in of().flat_map(|(_, confusion)| confusion) {
                *all.entry(became.clone()).or_default() += count;
            }
            let name = label(campaigns.len(), &campaign.name, &engine);
            matrices.push(Matrix { open: true, ..matrix(format!("{name}, all settings"), &all) });
            // Of many settings those with the largest share that is wrong.
            let wrong = |confusion: &ConfusionCounts| {
                let all: u64 = confusion.values().sum();
                let wrong: u64 = confusion.iter().filter(|((before, after), _)| before != after).map(|(_, n)| n).sum();
                wrong as f64 / all.max(1) as f64
            };
            let mut settings: Vec<_> = of().filter(|(compared, _)| campaign.shows(&compared.tolerances)).collect();
            if settings.len() > MAX_SETTINGS {
                settings.sort_by(|(_, a), (_, b)| wrong(b).total_cmp(&wrong(a)));
                left_out += settings.drain(MAX_SETTINGS..).count();
            }
            let shown = settings.into_iter();
            matrices.extend(shown.map(|(c, confusion)| matrix(format!("{name}, {}", c.tolerances), confusion)));
        }
    }
    section.parts.push(SectionPart::Matrices(matrices));
    if left_out > 0 {
        section.parts.push(SectionPart::Text(format!(
            "Setting by setting are the {MAX_SETTINGS} of each engine with the largest share of wrong kinds; {left_out} more in confusion.csv."
        )));
    }
    section.parts.push(SectionPart::Quiet(table));
    section
}

fn matrix(title: String, confusion: &ConfusionCounts) -> Matrix {
    let states = confusion.keys().any(|(before, _)| SeparationState::from_name(before).is_some());
    let kinds: Vec<&'static str> = match states {
        true => SeparationState::ALL.map(SeparationState::name).to_vec(),
        false => ContactKind::ALL.map(ContactKind::name).into_iter().chain([NONE]).collect(),
    };
    let count = |before: &str, after: &str| confusion.get(&(before.to_owned(), after.to_owned())).copied().unwrap_or(0);
    let all: u64 = confusion.values().sum();
    let wrong: u64 = confusion.iter().filter(|((before, after), _)| before != after).map(|(_, n)| n).sum();
    let rows = kinds
        .iter()
        .map(|before| {
            let sum: u64 = kinds.iter().map(|after| count(before, after)).sum();
            let cells = kinds.iter().map(|after| {
                let n = count(before, after);
                MatrixCell {
                    count: if n == 0 { String::new() } else { grouped(n) },
                    share: if sum == 0 { 0.0 } else { (n as f64 / sum as f64 * 100.0 * 10.0).round() / 10.0 },
                    right: before == after,
                }
            });
            MatrixRow { kind: before, cells: cells.collect() }
        })
        .collect();
    Matrix {
        title,
        note: format!("{} of {} not as they should be", grouped(wrong), grouped(all)),
        open: false,
        kinds,
        rows,
    }
}
