//! How two blocks lie to one another, exactly.

use crate::block::Block;
use crate::boundary::text;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_differential::collision::separation::Separation;
use rockproof_differential::separation_state::SeparationState;
use rockproof_oracle::penetration;
use rockproof_oracle::rational::Rational;
use std::ffi::CString;

/// A length with a sign that is known exactly: positive apart, negative for an overlap. It never changes, so threads may share it.
pub struct Distance {
    /// 1, 0 or −1.
    pub(crate) sign: i32,
    /// The nearest f64 (m).
    pub(crate) nearest: f64,
    /// The length as a fraction, where it is one.
    pub(crate) exact: Option<CString>,
    /// Its square as a fraction.
    pub(crate) squared: CString,
}

impl Distance {
    pub(crate) fn new(sign: i32, squared: &BigRational) -> Distance {
        let size = squared.sqrt_rounded().unwrap_or(f64::INFINITY);
        let signed = |root: BigRational| if sign < 0 { -root } else { root };
        Distance {
            sign,
            nearest: if sign < 0 { -size } else { size },
            exact: root(squared).map(|root| text(&signed(root).to_string())),
            squared: text(&squared.to_string()),
        }
    }

    /// Of two convex blocks: the distance, or minus the shortest translation that parts them.
    pub(crate) fn separation(a: &Block, b: &Block) -> Result<Distance, String> {
        for (name, block) in [("a", a), ("b", b)] {
            if !block.block.is_convex() {
                return Err(format!(
                    "block {name} is concave; the separation is worked out for convex blocks, the penetration for all"
                ));
            }
        }
        let found = Separation::of(&a.block, &b.block).ok_or_else(|| {
            let [a, b] = [a, b].map(|block| block.vertices.len());
            format!("the separation of blocks of {a} and {b} vertices is not worked out; allowed are 48")
        })?;
        let sign = match found.state {
            SeparationState::Apart => 1,
            SeparationState::Touching => 0,
            SeparationState::Overlapping => -1,
        };
        Ok(Distance::new(sign, &found.squared))
    }

    /// Minus the depth of an overlap, or 0.
    pub(crate) fn penetration(a: &Block, b: &Block) -> Result<Distance, String> {
        let found = penetration::penetration(&a.block, &b.block)
            .ok_or("a block has no face with an area, so there is no depth")?;
        Ok(match found.gap.sign.is_negative() {
            true => Distance::new(-1, &found.gap.squared),
            false => Distance::new(0, &BigRational::from_integer(BigInt::ZERO)),
        })
    }
}

/// The square root of a fraction, where it is a fraction.
fn root(square: &BigRational) -> Option<BigRational> {
    let root = |n: &BigInt| Some(n.sqrt()).filter(|root| root * root == *n);
    if square.is_negative() { None } else { Some(BigRational::new(root(square.numer())?, root(square.denom())?)) }
}
