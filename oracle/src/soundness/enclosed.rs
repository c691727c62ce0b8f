//! Integers of as few bits as the enclosure of a value says, against those of any length.

use super::{bits_of, in_integers, value_in_integers};
use crate::number::{Ball, Bits, Int128};
use crate::pair::{Int256, Int512, Int1024, Pair};
use crate::predicate::Polynomial;
use crate::sign_ladder::{Classification, Unobserved};
use crate::view::{BallView, LazyScales, Scales};
use num_bigint::BigInt;
use rockproof_model::{Sign, ToleranceSet};
use std::cell::OnceCell;
use std::ops::AddAssign;

/// What was seen of enclosures.
#[derive(Clone, Copy, Default)]
pub(super) struct Seen {
    /// Values told by integers that do not hold what comes on the way.
    wrapped: u64,
    /// Values of just as many bits as their enclosure says.
    at_the_edge: u64,
    /// Values that an integer cannot hold, and those of them whose sign it then gets wrong.
    too_long: u64,
    wrong: u64,
    /// Gaps proved equal by their planes, and those that are equal and not proved.
    equal: u64,
    not_proved: u64,
    /// Margins that balls tell, near ties among them, and those that they do not.
    margins: u64,
    near_ties: u64,
    margins_of_integers: u64,
}

impl AddAssign for Seen {
    fn add_assign(&mut self, other: Seen) {
        self.wrapped += other.wrapped;
        self.at_the_edge += other.at_the_edge;
        self.too_long += other.too_long;
        self.wrong += other.wrong;
        self.equal += other.equal;
        self.not_proved += other.not_proved;
        self.margins += other.margins;
        self.near_ties += other.near_ties;
        self.margins_of_integers += other.margins_of_integers;
    }
}

impl Seen {
    pub(super) fn check(&self) {
        let Seen { wrapped, at_the_edge, too_long, wrong, equal, not_proved, .. } = *self;
        let Seen { margins, near_ties, margins_of_integers, .. } = *self;
        assert!(wrapped > 1_000 && at_the_edge > 100, "{wrapped} wrapped, {at_the_edge} as long as they may be");
        // An integer too short is noticed: no sign is right by itself.
        assert!(wrong > 100 && wrong < too_long, "{wrong} wrong of {too_long}");
        assert!(equal > 20 && not_proved > 0, "{equal} equal gaps proved, {not_proved} not");
        let told = margins > 1_000 && near_ties > 50 && margins_of_integers > 50;
        assert!(told, "{margins} margins told by balls, {near_ties} near ties, {margins_of_integers} not told");
    }
}

/// Holds what the ladder concludes from the enclosure of a polynomial's value against the value.
pub(super) fn check<P: Polynomial>(run: &Classification<'_, '_, Unobserved>, p: &P, exact: Sign, about: &str) -> Seen {
    let (pair, t) = (run.pair, run.tolerances);
    let slot = P::FIRST_SLOT + p.variant();
    let made: OnceCell<Scales<Ball>> = OnceCell::new();
    let balls = BallView { floats: run.float_view(), scales: LazyScales { made: &made, make: &|| Scales::balls(t) } };
    let value = value_in_integers::<P, BigInt>(pair, t, p);
    let on_the_way = bits_of(pair, t, p);
    let mut seen = Seen::default();
    for enclosed in [run.bits_of_ball::<P>(p.value(&balls)), run.bits_of_double::<P>(&run.double_ball(p))] {
        let Some(enclosed) = enclosed else { continue };
        assert!(value.bits() <= u64::from(enclosed.0), "{value} in {enclosed:?}, slot {slot}, {about}");
        seen.at_the_edge += u64::from(value.bits() == u64::from(enclosed.0));
        for (width, sign) in [
            (128, in_integers::<P, Int128> as fn(&Pair<'_>, &ToleranceSet, &P) -> Sign),
            (256, in_integers::<P, Int256>),
            (512, in_integers::<P, Int512>),
            (1024, in_integers::<P, Int1024>),
        ] {
            if enclosed < Bits(width) {
                assert_eq!(sign(pair, t, p), exact, "{width}-bit integers, slot {slot}, {about}");
                seen.wrapped += u64::from(on_the_way >= Bits(width));
            } else if value.bits() >= u64::from(width) {
                seen.too_long += 1;
                seen.wrong += u64::from(sign(pair, t, p) != exact);
            }
        }
    }
    let margin = run.margins().of_integers(p);
    match run.margins().of_balls(p) {
        Some(told) => {
            assert_eq!((told.0, told.1.to_bits()), (margin.0, margin.1.to_bits()), "margin, slot {slot}, {about}");
            seen.margins += 1;
            seen.near_ties += u64::from(told.1 > 0.0 && told.1 < 1e-6);
        }
        None => seen.margins_of_integers += 1,
    }
    if let Some(gaps) = p.ties_with(t) {
        if run.are_equal(&gaps, &balls) {
            assert!(exact.is_zero(), "gaps called equal, slot {slot}, {about}");
            seen.equal += 1;
        } else {
            seen.not_proved += u64::from(exact.is_zero());
        }
    }
    seen
}
