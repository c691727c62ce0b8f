//! What is wrong with external engines, by hypotheses.

use super::{Section, SectionPart};
use crate::load::CampaignRun;
use crate::table::{Table, TableCell};
use rockproof_differential::diagnosis::{DIAGNOSIS_COLUMNS, DiagnosisRow, diagnosis_lines};

/// The section; `None` where no external engine differs.
pub(super) fn section(campaigns: &[CampaignRun]) -> Option<Section> {
    if campaigns.iter().all(|campaign| campaign.diagnosis.is_empty()) {
        return None;
    }
    let mut section = Section::new(
        "diagnosis",
        "What is wrong with the external engines?",
        "Answers that differ, beside those that an exact engine with one mistake would give. A hypothesis explains as many of them as the \
         table says, and counts only where no right answer speaks against it. A sample of both was asked for again.",
    );
    for campaign in campaigns {
        for line in diagnosis_lines(&campaign.diagnosis) {
            let name = if campaigns.len() > 1 { format!("{}: ", campaign.name) } else { String::new() };
            section.parts.push(SectionPart::Text(format!("{name}{line}")));
        }
    }
    section.parts.push(SectionPart::Table(table(campaigns), 24));
    Some(section)
}

fn table(campaigns: &[CampaignRun]) -> Table {
    let columns: Vec<&str> = std::iter::once("run").chain(DIAGNOSIS_COLUMNS).collect();
    let mut table = Table::new(
        "diagnosis",
        "Hypotheses by the differing answers that they explain, and right answers that speak against them",
        &columns,
    );
    for campaign in campaigns {
        for row in &campaign.diagnosis {
            let DiagnosisRow { answers, differing, all_differing, contradicted, agreeing, .. } = *row;
            let mut cells: Vec<TableCell> = vec![campaign.name.as_str().into(), row.engine.as_str().into()];
            cells.extend([row.verdict.name(), &row.hypothesis, &row.sentence].map(TableCell::from));
            cells.extend([answers, differing, all_differing, contradicted, agreeing].map(TableCell::Count));
            cells.push(row.example.as_str().into());
            table.push(cells);
        }
    }
    table
}
