//! Hypotheses about the input: rounded, shortened as text, exchanged; and about the arithmetic that the whole is done in.

use super::hypothesis::Hypothesis;
use super::question::{PreparedBlocks, PreparedQuestion};
use crate::separation_state::ReportedState;
use crate::transform::{ExactBlocks, Transform};
use rockproof_model::{Block, Contact, Number, Precision, ToleranceSet, Vec3};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::{Classifier, Stepper};

/// What became of the input, or of the calculation.
#[derive(Clone, Copy, Debug)]
enum Input {
    /// Coordinates and tolerances rounded to f32.
    Single,
    /// Coordinates alone rounded to f32.
    SingleCoordinates,
    /// Coordinates cut off to f32.
    SingleCutOff,
    /// So many significant digits.
    Digits(usize),
    /// So many digits after the point.
    Decimals(usize),
    /// A and B exchanged, and the contacts not exchanged back.
    Exchanged,
    /// A and B exchanged, and the contacts exchanged back: what comes first among equals is another.
    ExchangedTwice,
    /// Features numbered the other way round, likewise.
    Renumbered,
    /// All calculated in f32.
    InSingle,
    /// All calculated in f64, as the built-in stepper does.
    InDouble,
    /// The same with the axes in another order, which adds up products in another order.
    OtherOrder,
}

/// The hypotheses about the input.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let all = [
        Input::Single,
        Input::SingleCoordinates,
        Input::SingleCutOff,
        Input::Digits(6),
        Input::Decimals(6),
        Input::Exchanged,
        Input::ExchangedTwice,
        Input::Renumbered,
        Input::InSingle,
        Input::InDouble,
        Input::OtherOrder,
    ];
    all.into_iter().map(|input| Box::new(input) as Box<dyn Hypothesis>)
}

impl Hypothesis for Input {
    fn name(&self) -> String {
        match self {
            Input::Single => "input-in-f32".to_owned(),
            Input::SingleCoordinates => "coordinates-in-f32".to_owned(),
            Input::SingleCutOff => "coordinates-cut-off-to-f32".to_owned(),
            Input::Digits(digits) => format!("{digits}-significant-digits"),
            Input::Decimals(digits) => format!("{digits}-decimals"),
            Input::Exchanged => "exchanged".to_owned(),
            Input::ExchangedTwice => "order-of-blocks".to_owned(),
            Input::Renumbered => "order-of-features".to_owned(),
            Input::InSingle => "calculated-in-f32".to_owned(),
            Input::InDouble => "calculated-in-f64".to_owned(),
            Input::OtherOrder => "sums-in-another-order".to_owned(),
        }
    }

    fn sentence(&self) -> String {
        match self {
            Input::Single => "for input rounded to f32".to_owned(),
            Input::SingleCoordinates => "for coordinates rounded to f32, and tolerances as given".to_owned(),
            Input::SingleCutOff => "for coordinates cut off to f32 instead of rounded".to_owned(),
            Input::Digits(digits) => format!("for input read with {digits} significant digits"),
            Input::Decimals(digits) => format!("for input read with {digits} digits after the point"),
            Input::Exchanged => "for A and B exchanged".to_owned(),
            Input::ExchangedTwice => "but for what comes first among equals: B's features before A's".to_owned(),
            Input::Renumbered => "but for what comes first among equals: the last feature before the first".to_owned(),
            Input::InSingle => "but for calculating in f32, as the built-in stepper does".to_owned(),
            Input::InDouble => "but for rounding in f64, the same as the built-in stepper's".to_owned(),
            Input::OtherOrder => {
                "but for rounding in f64, the same as the built-in stepper's with sums in another order".to_owned()
            }
        }
    }

    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        let (blocks, tolerances) = (&asked.question.blocks, &asked.question.tolerances);
        let [a, b] = blocks;
        match self {
            Input::Exchanged => Some(exact(&[b.clone(), a.clone()], tolerances)),
            Input::ExchangedTwice => {
                let mut contacts = exact(&[b.clone(), a.clone()], tolerances);
                contacts.iter_mut().for_each(|contact| *contact = contact.swapped());
                contacts.sort_unstable();
                Some(contacts)
            }
            Input::Renumbered => {
                let exact_blocks = ExactBlocks::new([a, b]);
                let other = Transform::Renumber.apply(&exact_blocks, blocks, tolerances, asked.question.precision)?;
                Some(other.to_original(&exact(&other.blocks, tolerances)))
            }
            Input::InSingle => {
                let [a, b] = self.changed(blocks)?;
                Stepper::<SpecRules>::new().f32(&a, &b, &self.rounded_tolerances(tolerances)?).ok()
            }
            Input::InDouble => Stepper::<SpecRules>::new().f64(a, b, tolerances).ok(),
            Input::OtherOrder => {
                let [a, b] = blocks.clone().map(|block| turned(&block));
                Stepper::<SpecRules>::new().f64(&a, &b, tolerances).ok()
            }
            _ => Some(exact(&self.changed(blocks)?, &self.rounded_tolerances(tolerances)?)),
        }
    }

    fn says_state(&self, asked: &PreparedQuestion<'_>, said: ReportedState) -> Option<bool> {
        match self {
            Input::Single | Input::SingleCutOff | Input::Digits(_) | Input::Decimals(_) => {
                asked.state_is_right_for(&self.changed(&asked.question.blocks)?, said)
            }
            // Tolerances have no part in how blocks lie, and to exchange blocks is to turn the normal.
            Input::SingleCoordinates
            | Input::Exchanged
            | Input::ExchangedTwice
            | Input::Renumbered
            | Input::InSingle
            | Input::InDouble
            | Input::OtherOrder => None,
        }
    }

    fn is_rounding(&self) -> bool {
        matches!(self, Input::InDouble | Input::OtherOrder)
    }
}

impl Input {
    /// The blocks as they are then; `None` where a coordinate overflows.
    fn changed(self, [a, b]: &[Block; 2]) -> Option<[Block; 2]> {
        let every = |f: &dyn Fn(&Number) -> Option<Number>| Some([changed(a, f)?, changed(b, f)?]);
        match self {
            Input::Single | Input::SingleCoordinates | Input::InSingle => {
                Some([a.rounded(Precision::F32)?, b.rounded(Precision::F32)?])
            }
            Input::SingleCutOff => every(&cut_off),
            Input::Digits(_) | Input::Decimals(_) => every(&|number| self.shortened(number)),
            _ => None,
        }
    }

    fn rounded_tolerances(self, given: &ToleranceSet) -> Option<ToleranceSet> {
        let mut set = given.clone();
        for (_, number) in set.numbers_mut() {
            *number = match self {
                Input::Single | Input::InSingle => Number::from_f64(number.rounded(Precision::F32)?).ok()?,
                Input::Digits(_) | Input::Decimals(_) => self.shortened(number)?,
                _ => continue,
            };
        }
        Some(set)
    }

    /// The number that a shorter text of it says.
    fn shortened(self, number: &Number) -> Option<Number> {
        let near = number.approximate();
        let text = match self {
            Input::Digits(digits) => format!("{near:.*e}", digits - 1),
            Input::Decimals(digits) => format!("{near:.digits$}"),
            _ => return None,
        };
        Number::from_f64(text.parse().ok()?).ok()
    }
}

fn exact([a, b]: &[Block; 2], tolerances: &ToleranceSet) -> Vec<Contact> {
    let prepared = PreparedBlocks::of(&[a.clone(), b.clone()]);
    prepared.pair().classify(tolerances).contacts
}

fn changed(block: &Block, number: impl Fn(&Number) -> Option<Number>) -> Option<Block> {
    let points = block.vertices().iter();
    let points = points.map(|v| Some(Vec3::new(number(&v.x)?, number(&v.y)?, number(&v.z)?))).collect::<Option<_>>()?;
    Some(block.with_vertices(points))
}

/// The f32 next to a number on the side of 0.
fn cut_off(number: &Number) -> Option<Number> {
    let (exact, near) = (number.approximate(), number.rounded(Precision::F32)? as f32);
    let beyond = f64::from(near).abs() > exact.abs();
    Number::from_f64(f64::from(if beyond { f32::from_bits(near.to_bits() - 1) } else { near })).ok()
}

/// The block with x, y, z for y, z, x: turned, and every sum of three products begins with another one.
fn turned(block: &Block) -> Block {
    block.with_vertices(block.vertices().iter().map(|v| Vec3::new(v.y.clone(), v.z.clone(), v.x.clone())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_cut_off_towards_zero_and_shortened_as_text() {
        let number = |value: f64| Number::from_f64(value).expect("finite");
        let tenth = 0.1_f64;
        // The nearest f32 to 0.1 is above it.
        assert!(f64::from(tenth as f32) > tenth);
        for sign in [1.0, -1.0] {
            let cut = cut_off(&number(sign * tenth)).expect("in range").approximate();
            assert!(cut.abs() < tenth && (sign * cut) > tenth - 1e-8, "{cut}");
        }
        assert_eq!(cut_off(&number(0.25)), Some(number(0.25)));
        assert_eq!(Input::Digits(6).shortened(&number(1234.5678)), Some(number(1234.57)));
        assert_eq!(Input::Decimals(6).shortened(&number(0.012_345_678_9)), Some(number(0.012_346)));
    }
}
