//! `tune --mpi`: every rank measures candidates, rank 0 keeps the record (`crates/tune/src/distribute/`).

use super::{Job, Ranks, introduction};
use crate::exit::{ExitStatus, Outcome, print_note};
use crate::stop::on_ctrl_c_silently;
use crate::tune::{MEASURING, Prepared, Tune, on_ctrl_c_while_measuring};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::part::Machine;
use rockproof_campaign::source;
use rockproof_tune::TuneError;
use rockproof_tune::distribute::{Crew, SearchTask, serve};
use serde_json::{Map, Value};

impl Job for Tune {
    fn alone(&self) -> Outcome {
        self.run_here()
    }

    fn lead(&self, ranks: &mut Ranks) -> Outcome {
        let stop = on_ctrl_c_while_measuring()?;
        let pool = self.pool()?;
        let prepared = self.prepared(&pool)?;
        let stop = stop.begin();
        let interrupted = || {
            print_note(MEASURING);
            Ok(ExitStatus::Interrupted)
        };
        let own = introduction(self.threads(), Ok(work_of(&prepared)?));
        let Some(mut crew) = Crew::gather(ranks, &own, &pool, &stop)? else { return interrupted() };
        let Prepared { evaluator, author, identity, dir } = prepared;
        let Some(evaluator) = crew.audited(evaluator, &stop)? else { return interrupted() };
        self.searched((&evaluator, &author), (&identity, &dir), &stop, |search, enough, commit| {
            crew.search(search, enough, &stop, commit)
        })
    }

    fn work(&self, ranks: &mut Ranks) -> Outcome {
        let stop = on_ctrl_c_silently()?;
        let pool = self.pool()?;
        let prepared = self.prepared(&pool).and_then(|prepared| {
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
        ranks.served(served, |error| matches!(error, TuneError::Panic(_)))
    }
}

/// What is to be searched, and how the first pairs of a campaign are answered here.
fn work_of(prepared: &Prepared) -> anyhow::Result<(Map<String, Value>, Machine)> {
    let source = source::of(&CampaignConfig::default())?;
    Ok((prepared.identity.clone(), Machine::current(&source)?))
}
