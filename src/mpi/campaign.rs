//! `campaign --mpi`: rank 0 keeps the journal, the others examine pairs (`crates/campaign/src/distribute/`).

use super::{Job, Ranks, introduction};
use crate::campaign::{Campaign, Prepared, diagnosed};
use crate::exit::{ExitStatus, Outcome, print_note};
use crate::progress::shown_while;
use crate::stop::{on_ctrl_c, on_ctrl_c_silently};
use rockproof_campaign::distribute::{Crew, serve};
use rockproof_campaign::journal::Journal;
use rockproof_campaign::part::Machine;
use rockproof_campaign::run::{Ending, RunError};
use rockproof_report::table::counted;
use serde_json::{Map, Value};

impl Job for Campaign {
    fn alone(&self) -> Outcome {
        self.run_here()
    }

    fn lead(&self, ranks: &mut Ranks) -> Outcome {
        let prepared = self.prepared()?;
        let stop = on_ctrl_c()?;
        if !self.probed(&prepared.engines, &stop)? {
            return Ok(ExitStatus::Interrupted);
        }
        let own = introduction(self.threads(), Ok(work_of(&prepared)?));
        let Some(mut crew) = Crew::gather(ranks, &own, &stop)? else { return Ok(ExitStatus::Interrupted) };
        let mut journal = self.journal(&prepared)?;
        let mut led = |journal: &mut Journal| {
            prepared.with_campaign(self.threads(), |campaign| {
                shown_while(prepared.config.pairs, journal.seen(), || campaign.run_on(&mut crew, journal, &stop))
            })
        };
        let distributed = led(&mut journal)?;
        if distributed.unseen > 0 {
            print_note(&format!(
                "{} no case file, because an engine does not answer twice alike",
                counted(distributed.unseen, "finding has", "findings have")
            ));
        }
        let ending = match distributed.ending {
            Ending::Finished => {
                prepared.with_campaign(self.threads(), |campaign| diagnosed(campaign, &mut journal, &stop))?
            }
            ending @ Ending::Stopped => ending,
        };
        self.end(&prepared, &mut journal, ending)
    }

    fn work(&self, ranks: &mut Ranks) -> Outcome {
        let stop = on_ctrl_c_silently()?;
        let prepared = self.prepared().and_then(|prepared| {
            self.probed(&prepared.engines, &stop)?;
            let work = work_of(&prepared)?;
            Ok((prepared, work))
        });
        let served = match prepared {
            Ok((prepared, work)) => {
                let introduction = introduction(self.threads(), Ok(work));
                prepared.with_campaign(self.threads(), |campaign| serve(Some(campaign), ranks, &introduction, &stop))
            }
            Err(error) => serve(None, ranks, &introduction(1, Err(error)), &stop),
        };
        ranks.served(served, |error| matches!(error, RunError::Panic(_)))
    }
}

/// What is to be done, and how it is answered here.
fn work_of(prepared: &Prepared) -> anyhow::Result<(Map<String, Value>, Machine)> {
    Ok((prepared.identity.clone(), Machine::current(&*prepared.source)?))
}
