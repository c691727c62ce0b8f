//! Which findings there can be: the causes a change can have, and which changes are of a contact or have a margin. A limit on any other
//! would hold whatever is found.

use super::config::{FindingLimit, RECOVERED};
use rockproof_campaign::steps::StepChange;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::{DriftQuantity, Intrusion, StepAnswerChange, StepCause};
use rockproof_pairs::passing::PASSAGE;

/// Changes by what they say.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ChangeSort {
    /// A contact is another one.
    Contact,
    /// The mode of a contact is another one.
    Mode,
    /// An engine contradicts itself.
    Metamorphic,
    /// An external engine says wrongly how the blocks lie.
    State,
    /// An external engine gave no answer or two.
    Unusable,
    /// An external engine says that it cannot answer.
    Unsupported,
    /// A built-in engine failed, or the input overflows in a precision, or an external engine failed.
    Failure,
    /// Rounding made a block degenerate.
    Collapsed,
    /// A step came to another end.
    Iteration,
    /// The blocks overlap more or less deeply after a step.
    Depth,
    /// The state after a step, in 512 bits too.
    Drift,
    /// Blocks pass through one another, or overlap unseen.
    Intrusion,
}

const DRIFTS: [DriftQuantity; 3] = [DriftQuantity::Anchors, DriftQuantity::Velocity, DriftQuantity::Displacement];

fn sort_of(change: &str) -> Option<ChangeSort> {
    if let Some(change) = AnswerChange::from_name(change) {
        return Some(match change {
            AnswerChange::Collapsed => ChangeSort::Collapsed,
            AnswerChange::Failure => ChangeSort::Failure,
            AnswerChange::Unsupported => ChangeSort::Unsupported,
            change if change.is_of_states() => ChangeSort::State,
            change if change.is_metamorphic() => ChangeSort::Metamorphic,
            change if change.is_unusable() => ChangeSort::Unusable,
            _ => ChangeSort::Contact,
        });
    }
    let is_one_of = |names: &[&str]| names.contains(&change);
    if is_one_of(&Intrusion::ALL.map(Intrusion::name)) {
        Some(ChangeSort::Intrusion)
    } else if is_one_of(&DRIFTS.map(DriftQuantity::name)) {
        Some(ChangeSort::Drift)
    } else if is_one_of(&[StepChange::Deeper.name(), StepChange::Shallower.name()]) {
        Some(ChangeSort::Depth)
    } else if change == StepAnswerChange::Mode.name() {
        Some(ChangeSort::Mode)
    } else {
        StepChange::is_known(change).then_some(ChangeSort::Iteration)
    }
}

impl ChangeSort {
    /// The causes of such changes.
    fn causes(self) -> Vec<StepCause> {
        let links = |causes: &[Cause]| causes.iter().map(|cause| StepCause::Link(*cause)).collect();
        match self {
            ChangeSort::Contact => links(&Cause::ALL),
            ChangeSort::Metamorphic => links(&[Cause::Arithmetic, Cause::Defect, Cause::Engine]),
            ChangeSort::State | ChangeSort::Unusable | ChangeSort::Unsupported => links(&[Cause::Engine]),
            ChangeSort::Failure => links(&[Cause::Representation, Cause::Arithmetic, Cause::Defect, Cause::Engine]),
            ChangeSort::Collapsed => links(&[Cause::Representation]),
            ChangeSort::Mode | ChangeSort::Iteration => {
                links(&[Cause::Tolerance, Cause::Representation, Cause::Arithmetic, Cause::Defect])
            }
            ChangeSort::Depth => links(&[Cause::Arithmetic, Cause::Defect]),
            ChangeSort::Drift => links(&[Cause::Defect]),
            ChangeSort::Intrusion => {
                let mut causes: Vec<StepCause> =
                    links(&[Cause::Tolerance, Cause::Representation, Cause::Arithmetic, Cause::Defect]);
                causes.extend([StepCause::StepLength, StepCause::NotHeld]);
                causes
            }
        }
    }

    /// Whether such a change may be of a contact, whose kind is known.
    fn can_have_kind(self) -> bool {
        matches!(self, ChangeSort::Contact | ChangeSort::Mode | ChangeSort::Metamorphic)
    }

    /// Whether steps have such changes.
    fn is_of_steps(self) -> bool {
        use ChangeSort::{Contact, Depth, Drift, Intrusion, Iteration, Mode};
        matches!(self, Contact | Mode | Iteration | Depth | Drift | Intrusion)
    }

    /// Whether such a change may have a margin, or counts beyond any.
    fn can_have_margin(self) -> bool {
        matches!(
            self,
            ChangeSort::Contact
                | ChangeSort::Mode
                | ChangeSort::Metamorphic
                | ChangeSort::State
                | ChangeSort::Unusable
                | ChangeSort::Failure
        )
    }
}

/// Whether only external engines can have the change.
pub(crate) fn is_of_external_engines(change: &str) -> bool {
    matches!(sort_of(change), Some(ChangeSort::State | ChangeSort::Unusable | ChangeSort::Unsupported))
}

/// Whether the change is about one engine, not about all that are given the same numbers.
pub(crate) fn is_of_one_engine(change: &str) -> bool {
    use ChangeSort::{Depth, Drift, Metamorphic, State, Unsupported, Unusable};
    let one = [Metamorphic, State, Unusable, Unsupported, Depth, Drift];
    sort_of(change).is_some_and(|sort| one.contains(&sort))
}

/// Whether the change is about all engines that are given numbers of one precision.
pub(crate) fn is_of_one_precision(change: &str) -> bool {
    sort_of(change) == Some(ChangeSort::Collapsed)
}

/// Why there is no finding with the cause, change, kind and margin that a limit names, in any campaign.
pub(crate) fn contradiction(limit: &FindingLimit) -> Option<String> {
    let change = limit.change.as_deref().filter(|change| *change != RECOVERED);
    let of_change = change.and_then(sort_of);
    let cause = limit.cause.as_deref().and_then(StepCause::from_name);
    if let (Some(change), Some(sort), Some(cause)) = (change, of_change, cause) {
        let causes = sort.causes();
        if !causes.contains(&cause) {
            let causes: Vec<&str> = causes.iter().map(|cause| cause.name()).collect();
            return Some(format!(
                "no finding has the change \"{change}\" and the cause \"{}\"; allowed with this change: {}",
                cause.name(),
                causes.join(", ")
            ));
        }
    }
    if limit.family.as_deref() == Some(PASSAGE)
        && (cause == Some(Cause::Engine.into()) || of_change.is_some_and(|sort| !sort.is_of_steps()))
    {
        return Some(format!(
            "pairs of the family {PASSAGE} make steps alone, of which built-in engines have findings, and none of this sort"
        ));
    }
    let of_steps_alone = cause.is_some_and(|cause| matches!(cause, StepCause::StepLength | StepCause::NotHeld));
    let named = match (change, cause) {
        (Some(change), _) => format!("of the change \"{change}\""),
        (None, Some(cause)) => format!("of the cause \"{}\"", cause.name()),
        (None, None) => return None,
    };
    let can_have_kind = of_change.is_none_or(ChangeSort::can_have_kind) && !of_steps_alone;
    if limit.kind.is_some() && !can_have_kind {
        return Some(format!("kind is that of a contact, and findings {named} are about none"));
    }
    let can_have_margin = of_change.is_none_or(ChangeSort::can_have_margin) && !of_steps_alone;
    if limit.beyond_ulps.is_some() && cause == Some(Cause::Tolerance.into()) {
        return Some("beyond_ulps counts roundoffs, and findings of the cause \"tolerance\" have none".to_owned());
    }
    (limit.beyond_ulps.is_some() && !can_have_margin)
        .then(|| format!("beyond_ulps leaves out what has no margin, and findings {named} have none"))
}
