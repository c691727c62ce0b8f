//! Messages between the ranks of a campaign, read as whoever gets them reads them: for fuzz targets.

use super::message::{CampaignOrder, CampaignReport, UnitResult};
use super::ranks::{Order, Report, encoded, introduced, taken};
use super::remote::{decoded, row};
use crate::run::RunError;
use crate::steps::StepFindingRow;
use rockproof_differential::row::FindingRow;

/// From whom a message is, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageKind {
    /// From a worker that begins.
    Introduction,
    /// From rank 0 to a worker.
    Order,
    /// From a worker to rank 0.
    Report,
}

/// A message that was read.
#[derive(Debug)]
pub struct DecodedMessage {
    /// What it is, such as `unit-report`.
    pub what: &'static str,
    /// The message, written again.
    pub message: Vec<u8>,
}

/// Reads a message, with the rows in it, as the rank that gets it from rank `rank`, and writes it again.
///
/// # Errors
/// When it cannot be read.
pub fn reread(kind: MessageKind, rank: usize, bytes: &[u8]) -> Result<DecodedMessage, RunError> {
    match kind {
        MessageKind::Introduction => {
            let introduction = introduced(rank, bytes)?;
            let message = serde_json::to_vec(&introduction)?;
            Ok(DecodedMessage { what: "introduction", message })
        }
        MessageKind::Order => {
            let (order, _): (Order<CampaignOrder>, &[u8]) = taken(rank, bytes)?;
            let what = match &order {
                Order::End => "end",
                Order::Job(CampaignOrder::Cases(_)) => "cases",
                Order::Job(CampaignOrder::Unit { .. }) => "unit",
                Order::Job(CampaignOrder::Case { task, .. }) => {
                    match task.about_step {
                        false => drop(row::<FindingRow>(&task.row)?),
                        true => drop(row::<StepFindingRow>(&task.row)?),
                    }
                    "case"
                }
            };
            Ok(DecodedMessage { what, message: encoded(&order)? })
        }
        MessageKind::Report => {
            let (report, rest): (Report<CampaignReport>, &[u8]) = taken(rank, bytes)?;
            let what = match report {
                Report::Ended => "ended",
                Report::Stopped => "stopped",
                Report::Job(CampaignReport::Case { .. }) => "case-report",
                Report::Job(report @ CampaignReport::Unit { .. }) => {
                    let result = UnitResult::read(rank, rest)?;
                    decoded::<FindingRow>(&result.findings, false)?;
                    decoded::<StepFindingRow>(&result.steps, true)?;
                    return Ok(DecodedMessage { what: "unit-report", message: result.message(report)? });
                }
            };
            Ok(DecodedMessage { what, message: encoded(&report)? })
        }
    }
}
