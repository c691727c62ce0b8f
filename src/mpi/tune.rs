//! `tune --mpi`: every rank measures candidates, rank 0 keeps the record (`crates/tune/src/distribute/`).

use super::{Job, PANICKED, Ranks, introduction, on_all_ranks};
use crate::exit::{Outcome, Verdict};
use crate::stop::{on_ctrl_c, on_ctrl_c_silently};
use crate::tune::{Prepared, Tune};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::part::Machine;
use rockproof_campaign::source;
use rockproof_tune::TuneError;
use rockproof_tune::distribute::{Crew, SearchTask, serve};
use serde_json::{Map, Value};

/// Searches on all ranks.
pub(crate) fn run(command: &Tune) -> Outcome {
    on_all_ranks(command)
}

impl Job for Tune {
    fn alone(&self) -> Outcome {
        self.run_here()
    }

    fn lead(&self, ranks: &mut Ranks) -> Outcome {
        let outcome = led(self, ranks);
        Crew::dismiss(ranks)?;
        outcome
    }

    fn work(&self, ranks: &mut Ranks) -> Outcome {
        let stop = on_ctrl_c_silently()?;
        let pool = self.pool()?;
        let prepared = self.prepared().and_then(|prepared| {
            let work = work_of(&prepared)?;
            Ok((prepared, work))
        });
        let served = match prepared {
            Ok((Prepared { evaluator, author, .. }, work)) => {
                let task = SearchTask { evaluator, author: &author, seed: self.seed(), pool: &pool };
                serve(Some(task), ranks, &introduction(self.threads(), Ok(work)), &stop)
            }
            Err(error) => serve(None, ranks, &introduction(1, Err(error)), &stop),
        };
        match served {
            Ok(()) => Ok(Verdict::Passed),
            Err(error @ TuneError::Panic(_)) => ranks.end_all(&error.to_string(), PANICKED),
            Err(error) => ranks.end_all(&error.to_string(), 2),
        }
    }
}

fn led(command: &Tune, ranks: &mut Ranks) -> Outcome {
    let pool = command.pool()?;
    let prepared = command.prepared()?;
    let stop = on_ctrl_c()?;
    let own = introduction(command.threads(), Ok(work_of(&prepared)?));
    let Some(mut crew) = Crew::gather(ranks, &own, &pool, &stop)? else { return Ok(Verdict::Interrupted) };
    let Prepared { evaluator, author, identity, dir } = prepared;
    let Some(evaluator) = crew.audited(evaluator, &stop)? else { return Ok(Verdict::Interrupted) };
    command.searched((&evaluator, &author), (&identity, &dir), &stop, |search, enough, commit| {
        crew.search(search, enough, &stop, commit)
    })
}

/// What is to be searched, and how the first pairs of a campaign are answered here.
fn work_of(prepared: &Prepared) -> anyhow::Result<(Map<String, Value>, Machine)> {
    let source = source::of(&CampaignConfig::default())?;
    Ok((prepared.identity.clone(), Machine::here(&source)?))
}
