//! Whether engine and oracle answer a pair alike. A campaign asks why as well, and that costs many times more.

use rockproof_differential::collapse::collapsed_feature;
use rockproof_differential::compare::{Features, differences};
use rockproof_differential::engine::{Engine, catch_panic};
use rockproof_model::{Block, Precision, ToleranceSet};
use rockproof_oracle::{Pair, PreparedBlock};

/// A pair with everything prepared that no tolerance changes.
pub(super) struct PairChecker {
    /// The blocks as the engine has them; none where rounding destroys a feature.
    rounded: Option<[Block; 2]>,
    /// In the oracle as they are.
    exact: [PreparedBlock; 2],
    /// In the oracle as the engine has them, where that is not the same.
    rounded_exact: Option<[PreparedBlock; 2]>,
}

/// A set, as it is and as the engine has it.
pub(super) struct CheckedSet<'s> {
    given: &'s ToleranceSet,
    ideal: ToleranceSet,
    rounded: ToleranceSet,
}

impl<'s> CheckedSet<'s> {
    /// The set for an engine of a precision, or the name of the tolerance that overflows in it.
    pub(super) fn new(given: &'s ToleranceSet, precision: Precision) -> Result<CheckedSet<'s>, &'static str> {
        Ok(CheckedSet { given, ideal: given.ideal(), rounded: given.rounded(precision)? })
    }
}

/// What the check of a pair shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PairCheck {
    /// Whether rounding the input changes the exact contacts, or the engine misses those of the rounded input.
    pub(super) differs: bool,
    /// Contacts that the tolerances add, remove or change, compared with nearest features alone.
    pub(super) changed: u64,
}

impl PairChecker {
    /// Prepares a pair for an engine of a precision.
    pub(super) fn new(a: &Block, b: &Block, precision: Precision) -> PairChecker {
        let exact = [PreparedBlock::new(a), PreparedBlock::new(b)];
        if a.is_exact_in(precision) && b.is_exact_in(precision) {
            return PairChecker { rounded: Some([a.clone(), b.clone()]), exact, rounded_exact: None };
        }
        let whole = |block: &Block| block.rounded(precision).filter(|rounded| collapsed_feature(rounded).is_none());
        let rounded = whole(a).zip(whole(b)).map(|(a, b)| [a, b]);
        let rounded_exact = rounded.as_ref().map(|[a, b]| [PreparedBlock::new(a), PreparedBlock::new(b)]);
        PairChecker { rounded, exact, rounded_exact }
    }

    /// Looks at the pair under a set.
    pub(super) fn check(&self, sets: &CheckedSet<'_>, engine: &dyn Engine) -> PairCheck {
        let [a, b] = &self.exact;
        let pair = Pair::new(a, b);
        let exact = pair.classify(sets.given).contacts;
        let ideal = pair.classify(&sets.ideal).contacts;
        let features = Features { a: a.block().topology(), b: b.block().topology() };
        let changed = differences(&ideal, &exact, features).len() as u64;
        let Some([a, b]) = &self.rounded else { return PairCheck { differs: true, changed } };
        let rounded = match &self.rounded_exact {
            Some([a, b]) => Pair::new(a, b).classify(&sets.rounded).contacts,
            None if sets.rounded == *sets.given => exact.clone(),
            None => pair.classify(&sets.rounded).contacts,
        };
        let answer = catch_panic(|| engine.prepare(a, b)?.classify(&sets.rounded));
        PairCheck { differs: rounded != exact || answer.as_ref() != Ok(&rounded), changed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_differential::attribution::examine_pair;
    use rockproof_differential::builtin;
    use rockproof_differential::finding::Cause;
    use rockproof_differential::subject::{NamedSet, Subject};
    use rockproof_model::preset::{Preset, derive};
    use rockproof_pairs::families::{Family, RealNeighbours};

    #[test]
    fn a_look_counts_what_an_examination_finds() {
        let mut differing = 0;
        for (k, (a, b)) in RealNeighbours::bundled().pairs().iter().enumerate() {
            for (precision, name) in [(Precision::F32, builtin::ENGINES[0]), (Precision::F64, builtin::ENGINES[1])] {
                let set = derive(Preset::ALL[k % 3], &[a, b], precision).expect("a set");
                let panel = builtin::panel(&[name.to_owned()], 0).expect("an engine");
                let given = vec![NamedSet::same("set", &set)];
                let (family, form) = (RealNeighbours::bundled().name().into(), "standing".into());
                let subject = Subject { index: 0, family, form, a: a.clone(), b: b.clone(), sets: given };
                let found = examine_pair(&subject, &panel).findings;
                let changed = found.iter().filter(|finding| finding.cause == Cause::Tolerance).count();
                let sets = CheckedSet::new(&set, precision).expect("no overflow");
                let seen = PairChecker::new(a, b, precision).check(&sets, &*panel.engines[0]);
                let expected = PairCheck { differs: found.len() > changed, changed: changed as u64 };
                assert_eq!(seen, expected, "pair {k} in {precision}");
                differing += usize::from(seen.differs);
            }
        }
        assert!(differing > 0, "something differs");
    }
}
