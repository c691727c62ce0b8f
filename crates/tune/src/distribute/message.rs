//! What ranks of a search tell one another, after their introductions.

use crate::evaluator::{Evaluator, Measurement};
use crate::given_overlaps::{GivenOverlap, Share};
use crate::search::SetRecipe;
use crate::steps::LockstepMeasures;
use rockproof_campaign::distribute::DistributeError;
use rockproof_model::ToleranceSet;
use serde::{Deserialize, Serialize};

/// What is to be done with a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Work {
    /// All that is measured but for what the oracle says of steps.
    Measure,
    /// That.
    Lockstep,
}

/// Work with a set, numbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Job {
    pub(super) number: u64,
    pub(super) work: Work,
    pub(super) set: SetRecipe,
}

/// What rank 0 orders.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum SearchOrder {
    /// Find the overlaps of a share of the pairs.
    Audit(Share),
    /// All overlaps of the model; jobs follow.
    Overlaps(Vec<SentOverlap>),
    Job(Job),
}

/// What a worker reports.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum SearchReport {
    /// The answer to [`SearchOrder::Audit`].
    Audited(Vec<SentOverlap>),
    /// The answer to [`SearchOrder::Job`].
    Done { number: u64, result: Box<JobResult> },
}

/// What came of a job; why there is nothing, otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "there are as many as processes, each in a box while it travels")]
pub(super) enum JobResult {
    Measured(Result<Measurement, String>),
    Lockstep(Result<LockstepMeasures, String>),
}

impl JobResult {
    /// Does the work.
    pub(super) fn of(evaluator: &Evaluator, work: Work, set: &ToleranceSet) -> JobResult {
        match work {
            Work::Measure => JobResult::Measured(evaluator.measure(set).map_err(|e| e.to_string())),
            Work::Lockstep => JobResult::Lockstep(evaluator.lockstep(set).map_err(|e| e.to_string())),
        }
    }
}

/// An overlap, its exact number as text.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SentOverlap {
    blocks: [usize; 2],
    depth_squared: String,
    is_rounding: bool,
}

impl SentOverlap {
    pub(super) fn of(overlap: &GivenOverlap) -> SentOverlap {
        let GivenOverlap { blocks, ref depth_squared, is_rounding } = *overlap;
        SentOverlap { blocks, depth_squared: depth_squared.to_string(), is_rounding }
    }

    /// The overlap in a model of so many blocks, as a rank told it.
    pub(super) fn read(&self, rank: usize, count: usize) -> Result<GivenOverlap, DistributeError> {
        let bad = |what: &str| unreadable(rank, what);
        let SentOverlap { blocks, ref depth_squared, is_rounding } = *self;
        if blocks.iter().any(|block| *block >= count) {
            return Err(bad("an overlap of a block that there is not"));
        }
        let depth_squared = depth_squared.parse().map_err(|_| bad("the depth of an overlap is no number"))?;
        Ok(GivenOverlap { blocks, depth_squared, is_rounding })
    }
}

pub(super) fn unreadable(rank: usize, what: &str) -> DistributeError {
    DistributeError::Message { rank, what: what.to_owned() }
}

/// A message that nobody asked for.
pub(super) fn unexpected_message(rank: usize) -> DistributeError {
    unreadable(rank, "nobody asked for it")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::SetParameters;
    use crate::probes::Differences;
    use crate::steps::StepMeasures;
    use rockproof_campaign::distribute::ranks::{encoded, taken};
    use rockproof_model::tolerance_rules::{Rule, RuleSlack};

    #[test]
    fn a_result_comes_as_it_went_and_a_rule_that_there_is_not_is_refused() {
        let measurement = Measurement {
            violated: vec![Rule::ALL[0], Rule::ALL[Rule::ALL.len() - 1]],
            tightest: RuleSlack { rule: Rule::ALL[1], factor: f64::INFINITY },
            lost_pairs: 19,
            differences: Differences { near: [24, 3], changed: 7, ..Differences::default() },
            steps_measured: StepMeasures { stopped: Some("no \"end\"".to_owned()), ..StepMeasures::default() },
            lockstep: None,
        };
        let result = JobResult::Measured(Ok(measurement));
        let mut bytes = encoded(&result).expect("a message");
        assert!(matches!(taken::<JobResult>(3, &bytes), Ok((sent, [])) if sent == result));
        // Behind the variant, `Ok` and the two rules violated.
        assert_eq!(std::mem::replace(&mut bytes[5], Rule::ALL.len() as u8), Rule::ALL[1] as u8);
        let error = taken::<JobResult>(3, &bytes).expect_err("no rule").to_string();
        assert!(error.starts_with("rank 3 sent a message that cannot be read"), "{error}");
    }

    #[test]
    fn places_off_their_scales_are_refused() {
        let places = [0, 0, 0, 24, 10, 10, 7, 8, 1];
        let parameters = SetParameters::try_from(places).expect("on their scales");
        let bytes = encoded(&SetRecipe::Drawn(parameters)).expect("a message");
        assert_eq!(taken::<SetRecipe>(0, &bytes).expect("a recipe").0, SetRecipe::Drawn(parameters));
        // The angles have eleven places, and an overlap angle of 0 is none of them.
        for (scale, place) in [(4, 11), (4, 0), (6, 8), (0, -1), (8, i32::MAX)] {
            let mut wrong = places;
            wrong[scale] = place;
            let told = SetParameters::try_from(wrong).expect_err("off its scale").to_string();
            assert_eq!(told, format!("place {place} is not on scale {scale} of a tolerance set"));
            let mut bytes = encoded(&SetRecipe::Given(0)).expect("a message");
            bytes[0] = 1;
            bytes.splice(1.., encoded(&wrong).expect("a message"));
            assert!(taken::<SetRecipe>(0, &bytes).is_err());
        }
    }
}
