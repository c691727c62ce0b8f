//! Ladders across a tolerance: its critical value for one decision of a pair as it stands, and the values a few steps
//! of the number format, or some percent, to either side.

mod dip;
mod exits;
mod search;

use crate::directed::exact::IntegerRoot;
use crate::directed::f64_view::quantum;
use crate::directed::{DirectedPair, Rung};
use crate::families::PairSampler;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_model::decision::Decision;
use rockproof_model::number::round_rational;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Number, Precision, Sign, ToleranceSet};

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

/// Chooses a decision of the pair that `tolerance`, one of its set's, settles, of one kind (below [`KINDS`]), and finds the critical value.
/// Decisions that do not depend on where B is may ask for B to be moved to where they are asked. `None` where the pair has no such decision, or
/// the value is out of all proportion.
pub(crate) fn critical(
    sampler: &mut PairSampler<'_>,
    pair: &DirectedPair<'_>,
    (tolerance, kind): (&'static str, u64),
) -> Option<Critical> {
    let set = pair.set;
    let (decision, squared, offset) = search::found(sampler, pair, (tolerance, kind))?;
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
