//! A scalar that calculates in f64 with a bound on its error, and in [`Wide`] only what a comparison needs.
//!
//! Whether all comparisons of a classification are settled in 512 bits most comparisons tell in f64 already. So each operation works out a ball
//! in f64 and notes what it was of; where the balls of two numbers meet and a comparison asks, both are made in [`Wide`] from the notes,
//! operation by operation as `Wide` would have made them, each once: in 128 bits, which are cheap, and in 512 where these do not settle it. What is
//! answered, and whether it is settled, is what `Wide` answers: a ball that settles a comparison holds the same number.
//!
//! The notes are those of one thread, and of one piece of work: see [`noted`].

mod ball;
mod notes;
#[cfg(test)]
mod tests;

use self::ball::Ball;
use self::notes::{FEWER_BITS, Note, Notes, Operand};
use crate::contact::asked;
use crate::real::Real;
use crate::wide::{Wide, in_bits};
use rockproof_model::{ContactKey, Number};
use std::cell::RefCell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number in f64, and how to make it in [`Wide`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct LazyWide {
    ball: Ball,
    /// Its note; means nothing where the ball is exact.
    note: u32,
    /// Whether it is the negative of what was noted.
    negated: bool,
}

thread_local! {
    static NOTES: RefCell<Notes> = const { RefCell::new(Notes::new()) };
}

/// What `work` gives, which may calculate in [`LazyWide`]; `None` where it was too much to note, and what came out means nothing. Whatever is
/// calculated there must not be used outside, and no such work begins within another.
pub(crate) fn noted<T>(work: impl FnOnce() -> T) -> Option<T> {
    NOTES.with_borrow_mut(Notes::begin);
    let result = work();
    (!is_full()).then_some(result)
}

/// Whether there was too much to note.
fn is_full() -> bool {
    NOTES.with_borrow(|notes| notes.is_full)
}

impl LazyWide {
    fn exact(value: f64) -> LazyWide {
        LazyWide { ball: Ball::exact(value), note: 0, negated: false }
    }

    /// A number of this ball, with what to note of it unless it is exact.
    fn new(ball: Ball, note: impl FnOnce() -> Note) -> LazyWide {
        if ball.is_exact() {
            return LazyWide { ball, note: 0, negated: false };
        }
        let note = NOTES.with_borrow_mut(|notes| notes.add(note()));
        LazyWide { ball, note, negated: false }
    }

    /// A number that is made in [`Wide`] at once.
    fn known(ball: Ball, value: Wide) -> LazyWide {
        LazyWide { ball, note: NOTES.with_borrow_mut(|notes| notes.add_given(value)), negated: false }
    }

    fn operand(self) -> Operand {
        if self.ball.is_exact() {
            Operand::Exact(self.ball.middle)
        } else {
            Operand::Noted { note: self.note, negated: self.negated }
        }
    }

    /// The number in [`Wide`]; any, where nothing that comes of it is of use.
    #[cold]
    fn wide(self) -> Wide {
        let is_of_use = !crate::wide::is_given_up();
        NOTES.with_borrow_mut(|notes| {
            if is_of_use && !notes.is_full { notes.in_all_bits(self.operand()) } else { Wide::of_f64(f64::NAN) }
        })
    }

    /// The order of two numbers whose balls meet, where fewer bits settle it.
    #[cold]
    fn order_in_fewer_bits(self, other: LazyWide) -> Option<Ordering> {
        if crate::wide::is_given_up() {
            return None;
        }
        let operands = [self.operand(), other.operand()];
        let [one, two] = NOTES.with_borrow_mut(|notes| (!notes.is_full).then(|| notes.in_fewer_bits(operands)))?;
        in_bits(FEWER_BITS, || one.settled_order(two))
    }

    /// The order where f64 or fewer bits settle it.
    fn order(self, other: LazyWide) -> Option<Ordering> {
        self.ball.order(other.ball).or_else(|| self.order_in_fewer_bits(other))
    }
}

impl Neg for LazyWide {
    type Output = LazyWide;
    fn neg(self) -> LazyWide {
        LazyWide { ball: -self.ball, negated: !self.negated, ..self }
    }
}

impl Add for LazyWide {
    type Output = LazyWide;
    fn add(self, other: LazyWide) -> LazyWide {
        LazyWide::new(self.ball + other.ball, || Note::Sum([self.operand(), other.operand()]))
    }
}

impl Sub for LazyWide {
    type Output = LazyWide;
    fn sub(self, other: LazyWide) -> LazyWide {
        self + -other
    }
}

impl Mul for LazyWide {
    type Output = LazyWide;
    fn mul(self, other: LazyWide) -> LazyWide {
        LazyWide::new(self.ball * other.ball, || Note::Product([self.operand(), other.operand()]))
    }
}

impl Div for LazyWide {
    type Output = LazyWide;
    fn div(self, other: LazyWide) -> LazyWide {
        LazyWide::new(self.ball / other.ball, || Note::Quotient([self.operand(), other.operand()]))
    }
}

impl PartialOrd for LazyWide {
    /// As [`Wide`] has it, and counted as there.
    fn partial_cmp(&self, other: &LazyWide) -> Option<Ordering> {
        self.order(*other).or_else(|| self.wide().partial_cmp(&other.wide()))
    }
}

impl PartialEq for LazyWide {
    fn eq(&self, other: &LazyWide) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl Real for LazyWide {
    const ZERO: Self = LazyWide { ball: Ball { middle: 0.0, radius: 0.0 }, note: 0, negated: false };

    fn from_f64(value: f64) -> Self {
        if value.is_finite() { LazyWide::exact(value) } else { LazyWide::known(Ball::UNKNOWN, Wide::of_f64(value)) }
    }
    fn from_number(number: &Number) -> Option<Self> {
        Some(match number.as_f64() {
            Some(value) => LazyWide::exact(value),
            None => LazyWide::known(Ball::nearest(number.approximate()), Wide::of_number(number)),
        })
    }
    fn to_number(self) -> Option<Number> {
        self.wide().middle()
    }
    fn to_f64(self) -> f64 {
        self.wide().nearest_f64()
    }
    fn sqrt(self) -> Self {
        LazyWide::new(self.ball.root(), || Note::Root(self.operand()))
    }
    fn abs(self) -> Self {
        match self.ball.order(Ball::exact(0.0)) {
            Some(Ordering::Less) => -self,
            Some(_) => self,
            None => LazyWide::new(self.ball.magnitude(), || Note::Magnitude(self.operand())),
        }
    }
    fn smaller(self, other: Self) -> Self {
        -(-self).larger(-other)
    }
    fn larger(self, other: Self) -> Self {
        match self.ball.order(other.ball) {
            Some(Ordering::Less) => other,
            Some(_) => self,
            None => LazyWide::new(self.ball.covering(other.ball), || Note::Larger([self.operand(), other.operand()])),
        }
    }
    fn below(self, other: Self) -> bool {
        let order = self.order(other).map(|order| order == Ordering::Less);
        order.unwrap_or_else(|| self.wide().middle_below(other.wide()))
    }
    fn surely_below(self, other: Self) -> bool {
        let order = self.order(other).map(|order| order == Ordering::Less);
        order.unwrap_or_else(|| self.wide().surely_below(other.wide()))
    }
    fn is_finite(self) -> bool {
        self.ball.is_bounded() || self.wide().is_known()
    }
    fn is_same(self, _: Self) -> bool {
        false
    }
    fn is_given_up() -> bool {
        crate::wide::is_given_up() || is_full()
    }
    fn leaves_out(contact: ContactKey) -> bool {
        asked::leaves_out(contact)
    }
    fn leaves_exits_out() -> bool {
        asked::leaves_exits_out()
    }
}
