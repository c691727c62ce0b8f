//! Ladders across a tolerance: its critical value for one decision of a pair as it stands, and the values a few steps
//! of the number format, or some percent, to either side.

mod dip;
mod exits;
mod search;

use crate::directed::exact::IntegerRoot;
use crate::directed::f64_view::quantum;
use crate::directed::{DirectedPair, Rung};
use crate::families::PairSampler;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_model::decision::Decision;
use rockproof_model::number::round_rational;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Number, Precision, Sign, ToleranceSet};

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

impl Critical {
    fn new(decision: Decision, tolerance: &'static str, squared: BigRational) -> Option<Critical> {
        if !squared.is_positive() {
            return None;
        }
        let (numerator, denominator) = (IntegerRoot::of(squared.numer()), IntegerRoot::of(squared.denom()));
        let exact = numerator.is_exact() && denominator.is_exact();
        let value = if exact {
            Number::from_rational(BigRational::new(numerator.root, denominator.root))
        } else {
            // √(n/d) = √(n·d)/d
            let product = IntegerRoot::of(&(squared.numer() * squared.denom()));
            let near = BigRational::new(product.root, squared.denom() << product.shift);
            Number::from_f64(round_rational(&near, Precision::F64)?).ok()?
        };
        Some(Critical { decision, tolerance, squared, value, exact, offset: None })
    }

    /// The tolerance's value at a rung, and the margin there: positive where the answer is yes with room to spare.
    /// `None` where the rung asks for an exact tie and the critical value is irrational, or where the value would be
    /// negative or overflow.
    pub fn at(&self, rung: Rung) -> Option<(Number, Sign)> {
        let value = match rung {
            Rung::Exact => return self.exact.then(|| (self.value.clone(), Sign::Zero)),
            Rung::Steps(precision, steps) => {
                let near = self.value.rounded(precision)?;
                near + steps as f64 * quantum(near, precision)
            }
            Rung::Permille(share) => self.value.approximate() * (1000.0 + f64::from(share)) / 1000.0,
        };
        if value < 0.0 {
            return None;
        }
        let value = Number::from_f64(value).ok()?;
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

/// Chooses a decision of the pair that `tolerance` settles, of one kind (below [`KINDS`]), and finds the critical value. Decisions that do not depend
/// on where B is may ask for B to be moved to where they are asked. `None` where the pair has no such decision, or the
/// value is out of all proportion.
pub fn critical(
    sampler: &mut PairSampler<'_>,
    (a, b): (&Block, &Block),
    set: &ToleranceSet,
    (tolerance, kind): (&'static str, u64),
) -> Option<Critical> {
    let pair = DirectedPair::new(a, b, set);
    let (decision, squared, offset) = search::found(sampler, &pair, (tolerance, kind))?;
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
