//! Ladders across a tolerance: its critical value for one decision of a pair as it stands, and the values a few steps
//! of the number format, or some percent, to either side.

mod dip;
mod exits;
mod search;

use crate::directed::exact::IntegerRoot;
use crate::directed::f64_view::quantum;
use crate::directed::remembered::Remembered;
use crate::directed::{DirectedPair, Rung};
use crate::families::PairSampler;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_model::decision::{Decision, Side};
use rockproof_model::number::round_rational;
use rockproof_model::ring::ExactRing;
use rockproof_model::tolerance_spec::ToleranceSpec;
use rockproof_model::{Block, EdgeId, FaceId, Number, Precision, Sign, ToleranceSet};
use std::rc::Rc;

/// The tolerances that classification uses, as they are named in files.
pub const TOLERANCES: [&str; 6] = ["search", "territory", "penetration", "overlap_sine", "parallel_sine", "equal"];

/// The value of a tolerance at which one decision turns from no (below) to yes (at and above).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Critical {
    /// The decision.
    pub decision: Decision,
    /// Which tolerance it is compared with.
    pub tolerance: &'static str,
    /// The square of the critical value (m², or dimensionless).
    pub squared: BigRational,
    /// The critical value, rounded to f64 where it is irrational.
    pub value: Number,
    /// Whether `value` is the critical value itself.
    pub exact: bool,
    /// How far B is to be moved first (m), where the pair as it stands would not ask the decision.
    pub offset: Option<[Number; 3]>,
}

/// The root of a square of an integer; `None` of what is none.
fn exact_root(square: &BigInt) -> Option<BigInt> {
    let root = square.sqrt();
    (&root * &root == *square).then_some(root)
}

impl Critical {
    fn new(decision: Decision, tolerance: &'static str, squared: BigRational) -> Option<Critical> {
        if !squared.is_positive() {
            return None;
        }
        // In lowest terms, as the square is.
        let root =
            exact_root(squared.numer()).and_then(|root| Some(BigRational::new_raw(root, exact_root(squared.denom())?)));
        let exact = root.is_some();
        let value = if let Some(root) = root {
            Number::from_rational(root)
        } else {
            // √(n/d) = √(n·d)/d; rounded, lowest terms are of no use.
            let product = IntegerRoot::of(&(squared.numer() * squared.denom()));
            let near = BigRational::new_raw(product.root, squared.denom() << product.shift);
            Number::from_f64(round_rational(&near, Precision::F64)?).ok()?
        };
        Some(Critical { decision, tolerance, squared, value, exact, offset: None })
    }

    /// The tolerance's value at a rung, and the margin there: positive where the answer is yes with room to spare.
    /// `None` where the rung asks for an exact tie and the critical value is irrational, or where the tolerance may not
    /// have the value.
    pub fn at(&self, rung: Rung) -> Option<(Number, Sign)> {
        let value = match rung {
            Rung::Exact => return self.exact.then(|| (self.value.clone(), Sign::Zero)),
            Rung::Steps(precision, steps) => {
                let near = self.value.rounded(precision)?;
                near + steps as f64 * quantum(near, precision)
            }
            Rung::Permille(share) => self.value.approximate() * (1000.0 + f64::from(share)) / 1000.0,
        };
        let value = Number::from_f64(value).ok()?;
        ToleranceSpec::empty().set_number(self.tolerance, value.clone()).ok()?;
        let square = value.to_rational().pow(2);
        Some((value, (square - &self.squared).sign()))
    }

    /// `set` with the tolerance at `value`.
    pub fn applied(&self, set: &ToleranceSet, value: &Number) -> ToleranceSet {
        let mut set = set.clone();
        for (name, number) in set.numbers_mut() {
            if name == self.tolerance {
                *number = value.clone();
            }
        }
        set
    }
}

/// How many numbers name kinds of decision: each kind that a tolerance settles has its share of them.
pub const KINDS: u64 = 60;

/// The square of a critical value; `None` where features have none.
type CriticalSquare = Option<Rc<BigRational>>;

/// A pair, a tolerance of its set, and one kind of decision (below [`KINDS`]) that the tolerance settles. Draws come upon the same features again and
/// again; what does not depend on where B is, is kept of them.
pub(crate) struct LadderPair<'p> {
    directed: DirectedPair<'p>,
    tolerance: &'static str,
    kind: u64,
    /// Of an edge of A and one of B.
    by_edges: Remembered<CriticalSquare>,
    /// Of a vertex of each side and a face of the other, or of an edge and a face: a kind of decision asks the one or the other.
    by_face: [Remembered<CriticalSquare>; 2],
    /// Whether the areas of two faces of each side have a rational ratio.
    area_ratios: [Remembered<bool>; 2],
}

impl<'p> LadderPair<'p> {
    pub(crate) fn new(
        (a, b): (&'p Block, &'p Block),
        set: &'p ToleranceSet,
        (tolerance, kind): (&'static str, u64),
    ) -> LadderPair<'p> {
        let [(edges_a, faces_a), (edges_b, faces_b)] =
            [a, b].map(|block| (block.topology().edges().len(), block.topology().faces().len()));
        LadderPair {
            directed: DirectedPair::new(a, b, set),
            tolerance,
            kind,
            by_edges: Remembered::new(edges_a, edges_b),
            // By edges, which are more than the vertices whose numbers are used here as well.
            by_face: [Remembered::new(edges_a, faces_b), Remembered::new(edges_b, faces_a)],
            area_ratios: [faces_a, faces_b].map(|faces| Remembered::new(faces, faces)),
        }
    }

    /// Of an edge of A and one of B.
    fn of_edges(&self, (ea, eb): (EdgeId, EdgeId), make: impl FnOnce() -> Option<BigRational>) -> CriticalSquare {
        self.by_edges.get(ea.index(), eb.index(), || make().map(Rc::new))
    }

    /// Of a vertex or an edge of a side, by its number, and a face of the other.
    fn of_face(
        &self,
        (side, number): (Side, usize),
        face: FaceId,
        make: impl FnOnce() -> Option<BigRational>,
    ) -> CriticalSquare {
        self.by_face[side as usize].get(number, face.index(), || make().map(Rc::new))
    }
}

/// Chooses a decision of the pair, and finds the critical value. Decisions that do not depend on where B is may ask for B to be moved to where they are
/// asked. `None` where the pair has no such decision, or the value is out of all proportion.
pub(crate) fn critical(sampler: &mut PairSampler<'_>, pair: &LadderPair<'_>) -> Option<Critical> {
    let (set, tolerance) = (pair.directed.set, pair.tolerance);
    let (decision, squared, offset) = search::found(sampler, pair)?;
    let mut critical = Critical::new(decision, tolerance, squared)?;
    let moved = offset.iter().any(|c| *c != 0.0);
    critical.offset = moved.then(|| offset.map(|c| Number::from_f64(c).unwrap_or(Number::ZERO)));
    let value = critical.value.approximate();
    let fits = match tolerance {
        "search" => value <= 4.0 * set.search.approximate(),
        "territory" => value <= set.search.approximate(),
        "penetration" => value <= 4.0 * set.penetration.approximate(),
        "equal" => value <= 0.125,
        // Edges at right angles: their sine is 1 in every number format, so this tie survives wherever they lie.
        "parallel_sine" => value <= 1.0,
        _ => value <= 0.95,
    };
    fits.then_some(critical)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::{self, CoordinateStyle};
    use crate::tolerance_sets::SetSource;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rockproof_model::Criteria;

    /// Many tries with one pair, and as many each with a pair that knows nothing: the same values at the same places, and the same draws.
    #[test]
    fn what_is_kept_is_what_would_be_worked_out() {
        keeps_what_would_be_worked_out(4);
    }

    /// Edges at right angles have a sine of 1, the largest that there is.
    #[test]
    fn rungs_stay_within_what_a_tolerance_may_be() {
        let edges = Decision::about(rockproof_model::decision::Predicate::NearlyParallel, &[]);
        let one = BigRational::from_integer(1.into());
        let critical = |tolerance| Critical::new(edges, tolerance, one.clone()).expect("a value");
        for above in [Rung::Permille(1), Rung::Steps(Precision::F64, 1), Rung::Steps(Precision::F32, 1 << 14)] {
            assert_eq!(critical("parallel_sine").at(above), None, "{above:?}");
            assert!(critical("search").at(above).is_some(), "a length may be above 1 m");
            assert!(critical("parallel_sine").at(above.mirrored()).is_some(), "{above:?}");
        }
        assert_eq!(critical("search").at(Rung::Permille(-1001)), None, "no length is negative");
    }

    #[test]
    #[ignore = "four seconds; .ci/run runs it"]
    fn what_is_kept_is_what_would_be_worked_out_at_full_size() {
        keeps_what_would_be_worked_out(12);
    }

    /// Of each pair and what is sought, so many values one after another: the first works out what the others find kept.
    fn keeps_what_would_be_worked_out(values: u32) {
        let mut found = std::collections::BTreeMap::new();
        for (number, family) in families::all().into_iter().enumerate() {
            let mut rng = ChaCha8Rng::seed_from_u64(number as u64);
            let (a, b) = family.generate(&mut rng);
            for criteria in [Criteria::Revised, Criteria::Classic] {
                let Some(named) = SetSource::dyadic(criteria).derive(&a, &b) else { continue };
                let set =
                    if criteria == Criteria::Revised { crate::tolerance_sets::steep(&named, &a, &b) } else { named };
                // Kinds are counted modulo 4 and 6.
                for sought in TOLERANCES.into_iter().flat_map(|tolerance| (0..6).map(move |kind| (tolerance, kind))) {
                    let (mut one, mut other) = (rng.clone(), rng.clone());
                    let mut sampler = PairSampler::with_style(&mut one, CoordinateStyle::Grid);
                    let mut fresh = PairSampler::with_style(&mut other, CoordinateStyle::Grid);
                    let known = LadderPair::new((&a, &b), &set.f64, sought);
                    for _ in 0..values {
                        let critical = critical(&mut sampler, &known);
                        let again = super::critical(&mut fresh, &LadderPair::new((&a, &b), &set.f64, sought));
                        assert_eq!(critical, again, "{} {sought:?}", family.name());
                        *found.entry(sought.0).or_insert(0) += u32::from(critical.is_some());
                    }
                    assert_eq!(one.get_word_pos(), other.get_word_pos());
                }
            }
        }
        assert!(TOLERANCES.iter().all(|tolerance| found[tolerance] > 4 * values), "{found:?}");
    }
}
