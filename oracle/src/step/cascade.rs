//! Asks each decision of the cheapest number type that proves it.

use super::approximate::{Approximate, Layout};
use super::attempt::Attempt;
use super::attempt_values::AttemptValues;
use super::decisions::StepDecision;
use super::state::Mode;
use super::system::{StepNumber, StepSupport, StiffnessBound, stiffness};
use crate::field::{DoubleBall, WideBall};
use crate::number::Ball;
use num_rational::BigRational;
use std::rc::Rc;

/// Bits of the wide levels; fractions stand between the second and the third.
const WIDE_BITS: [u32; 4] = [128, 256, 512, 1024];
/// The most unknowns of an island that is solved in fractions though its contacts bear forces.
pub(crate) const EXACT_UNKNOWNS: usize = 48;

/// Steps of more unknowns than this are asked no further than [`WIDE_BITS`]' second level: where 256 bits leave a sign open, it is a
/// tie in all likelihood, and four times the bits cost minutes.
const LARGE: usize = 96;

/// How many decisions of a step each level settled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepLevelCounts {
    /// Balls of f64.
    pub float: u64,
    /// Balls of two f64, some 100 bits.
    pub double: u64,
    /// Balls of 128, 256, 512 and 1,024 bits.
    pub wide: [u64; 4],
    /// Fractions.
    pub exact: u64,
    /// None: the mode stayed, the limit counted as kept.
    pub undecided: u64,
}

/// The solves of an attempt so far, and what f64 knows of each.
struct History {
    /// The modes of each solve.
    modes: Vec<Vec<Mode>>,
    /// The factor of each; `None` where f64 has none.
    factors: Vec<Option<Rc<Approximate>>>,
    /// `None` where f64 proves nothing, even of numbers that a wider type has calculated.
    bound: Option<StiffnessBound>,
}

impl History {
    fn support(&self, solve: usize) -> Option<StepSupport<'_>> {
        Some(StepSupport { bound: self.bound.as_ref()?, factor: self.factors[solve].as_deref()? })
    }
}

/// How much of the geometry a level calculates before its first solve.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Geometry {
    /// All: a type that cannot calculate some of it answers nothing.
    Whole,
    /// What solves and questions ask for.
    Asked,
}

/// One number type of the cascade, made when first asked.
enum Level<'a, S> {
    Unused,
    Ready(Box<AttemptValues<'a, S>>),
    /// It failed, and will again.
    Failed,
}

impl<'a, S: StepNumber> Level<'a, S> {
    fn begin(&mut self, attempt: &'a Attempt<'a>, bits: u32, geometry: Geometry) -> Option<&mut AttemptValues<'a, S>> {
        if matches!(self, Level::Unused) {
            let values = AttemptValues::new(attempt, bits);
            let values = if geometry == Geometry::Whole { values.complete() } else { Some(values) };
            *self = values.map_or(Level::Failed, |values| Level::Ready(Box::new(values)));
        }
        match self {
            Level::Ready(values) => Some(values),
            _ => None,
        }
    }

    /// The values with all solves up to now, if this type can make them; `start` has what a cheaper type found in a solve.
    fn caught_up(
        &mut self,
        attempt: &'a Attempt<'a>,
        bits: u32,
        geometry: Geometry,
        history: &History,
        start: impl Fn(usize) -> Option<Vec<S>>,
    ) -> Option<&AttemptValues<'a, S>> {
        let mut failed = false;
        if let Some(values) = self.begin(attempt, bits, geometry) {
            while values.solves.len() < history.modes.len() && !failed {
                let next = values.solves.len();
                failed = values.advance(&history.modes[next], history.support(next).as_ref(), start(next)).is_none();
            }
        }
        if failed {
            *self = Level::Failed;
        }
        self.ready()
    }

    fn ready(&self) -> Option<&AttemptValues<'a, S>> {
        match self {
            Level::Ready(values) => Some(values),
            _ => None,
        }
    }

    /// What it found in a solve, in another type.
    fn found<T>(&self, solve: usize, convert: impl Fn(&S) -> Option<T>) -> Option<Vec<T>> {
        let solve = self.ready()?.solves.get(solve)?;
        solve.solution().map(convert).collect()
    }
}

/// Which blocks are in islands whose contacts may bear no force.
#[derive(Default)]
struct ForcelessBlocks {
    /// The number of solves after which this is known.
    solves: usize,
    /// By block.
    may_be: Vec<bool>,
}

/// All number types over one attempt.
pub(crate) struct Cascade<'a> {
    attempt: &'a Attempt<'a>,
    layout: &'a Layout,
    history: History,
    float: Level<'a, Ball>,
    double: Level<'a, DoubleBall>,
    wide: [Level<'a, WideBall>; 4],
    exact: Level<'a, BigRational>,
    forceless: ForcelessBlocks,
    pub(crate) levels: StepLevelCounts,
}

impl<'a> Cascade<'a> {
    pub(crate) fn new(attempt: &'a Attempt<'a>, layout: &'a Layout, levels: StepLevelCounts) -> Cascade<'a> {
        let mut cascade = Cascade {
            attempt,
            layout,
            history: History { modes: Vec::new(), factors: Vec::new(), bound: None },
            float: Level::Unused,
            double: Level::Unused,
            wide: std::array::from_fn(|_| Level::Unused),
            exact: Level::Unused,
            forceless: ForcelessBlocks::default(),
            levels,
        };
        cascade.history.bound = cascade.first(StiffnessBound::new, StiffnessBound::new, StiffnessBound::new);
        cascade
    }

    /// What the cheapest type says that can calculate the geometry: f64 cannot where a plane is nearly none, as that of edges all
    /// but parallel.
    fn first<T>(
        &mut self,
        float: impl FnOnce(&AttemptValues<'a, Ball>) -> Option<T>,
        double: impl FnOnce(&AttemptValues<'a, DoubleBall>) -> Option<T>,
        wide: impl FnOnce(&AttemptValues<'a, WideBall>) -> Option<T>,
    ) -> Option<T> {
        if let Some(values) = self.float.begin(self.attempt, 53, Geometry::Whole) {
            return float(values);
        }
        if let Some(values) = self.double.begin(self.attempt, 106, Geometry::Whole) {
            return double(values);
        }
        let [least, ..] = WIDE_BITS;
        self.wide[0].begin(self.attempt, least, Geometry::Whole).and_then(|values| wide(values))
    }

    /// The modes of each solve so far.
    pub(crate) fn modes(&self) -> &[Vec<Mode>] {
        &self.history.modes
    }

    /// Adds a solve with these modes; each level makes it when it is asked.
    pub(crate) fn solve(&mut self, modes: Vec<Mode>) {
        // The spring across a slip is that of the solve before: only without sliding contacts equal modes have equal stiffnesses.
        let slides = modes.contains(&Mode::Sliding);
        let known = self.history.modes.iter().position(|earlier| !slides && *earlier == modes);
        let factor = match known {
            Some(solve) => self.history.factors[solve].clone(),
            None if slides && !self.history.modes.is_empty() => self.sliding_factor(&modes),
            None => {
                let layout = self.layout;
                let factor = self.first(
                    |values| stiffness(values, &modes, layout)?.factor(),
                    |values| stiffness(values, &modes, layout)?.factor(),
                    |values| stiffness(values, &modes, layout)?.factor(),
                );
                factor.map(Rc::new)
            }
        };
        self.history.factors.push(factor);
        self.history.modes.push(modes);
    }

    /// The factor of a solve in which contacts slide as the solve before left them, from the cheapest type that knows how.
    fn sliding_factor(&mut self, modes: &[Mode]) -> Option<Rc<Approximate>> {
        let layout = self.layout;
        let float = self.float().and_then(|values| stiffness(values, modes, layout));
        let double = float.or_else(|| self.double().and_then(|values| stiffness(values, modes, layout)));
        let wide = |cascade: &mut Self, k| cascade.wide(k).and_then(|values| stiffness(values, modes, layout));
        double.or_else(|| wide(self, 0)).or_else(|| wide(self, 1))?.factor().map(Rc::new)
    }

    /// The answer of the cheapest level that has one; `None` is undecided, and counted.
    pub(crate) fn ask<Q: StepDecision>(&mut self, question: &Q) -> Option<Q::Answer> {
        if let Some(answer) = self.float().and_then(|values| question.ask(values)) {
            self.levels.float += 1;
            return Some(answer);
        }
        if let Some(answer) = self.double().and_then(|values| question.ask(values)) {
            self.levels.double += 1;
            return Some(answer);
        }
        let wide_levels = if self.attempt.sizes.iter().sum::<usize>() > LARGE { 2 } else { WIDE_BITS.len() };
        for k in 0..=wide_levels {
            let exact = match question.contact() {
                // Before their turn where it is a tie of blocks that fall together, in all likelihood: fractions prove it, and balls would not.
                Some(contact) if k < 2 => self.exact_of_free(contact),
                Some(_) if k == 2 => self.exact(),
                None if k == 2 => self.exact_of_all(),
                _ => None,
            };
            if let Some(answer) = exact.and_then(|values| question.ask(values)) {
                self.levels.exact += 1;
                return Some(answer);
            }
            if k < wide_levels
                && let Some(answer) = self.wide(k).and_then(|values| question.ask(values))
            {
                self.levels.wide[k] += 1;
                return Some(answer);
            }
        }
        self.levels.undecided += 1;
        None
    }

    /// Whether balls see no force, after the last solve, in any contact of the islands in which the blocks of a contact are: those of two f64, or of
    /// 128 bits where these know the solve and those do not.
    fn may_move_freely(&mut self, k: usize) -> bool {
        let (attempt, solves) = (self.attempt, self.history.modes.len());
        if self.history.bound.is_none() {
            return false;
        }
        if self.forceless.solves != solves {
            let of_double = self.double.ready().map(AttemptValues::blocks_without_force);
            let of_wide = || self.wide[0].ready().filter(|values| values.solves.len() == solves);
            let Some(may_be) = of_double.or_else(|| of_wide().map(AttemptValues::blocks_without_force)) else {
                return false;
            };
            self.forceless = ForcelessBlocks { solves, may_be: may_be.unwrap_or_default() };
        }
        attempt.started[k]
            .blocks
            .iter()
            .all(|&block| attempt.rows[block].is_none() || self.forceless.may_be.get(block) == Some(&true))
    }

    /// The values in f64 balls.
    pub(crate) fn float(&mut self) -> Option<&AttemptValues<'a, Ball>> {
        self.float.caught_up(self.attempt, 53, Geometry::Whole, &self.history, |_| None)
    }

    /// The values in balls of two f64.
    pub(crate) fn double(&mut self) -> Option<&AttemptValues<'a, DoubleBall>> {
        let float = &self.float;
        let near = |x: &Ball| x.middle.is_finite().then_some(DoubleBall { high: x.middle, low: 0.0, radius: 0.0 });
        let start = |solve| float.found(solve, near);
        self.double.caught_up(self.attempt, 106, Geometry::Whole, &self.history, start)
    }

    /// The values in balls of [`WIDE_BITS`]`[k]`.
    fn wide(&mut self, k: usize) -> Option<&AttemptValues<'a, WideBall>> {
        let level = std::mem::replace(&mut self.wide[k], Level::Unused);
        self.wide[k] = self.wider(level, WIDE_BITS[k]);
        self.wide[k].ready()
    }

    /// A level caught up, beginning each solve with what the widest type below it has found.
    fn wider(&self, mut level: Level<'a, WideBall>, bits: u32) -> Level<'a, WideBall> {
        let below = WIDE_BITS.iter().filter(|&&known| known < bits).count();
        let near = |x: &DoubleBall| Some(WideBall::of_parts(x, bits)?.without_radius());
        let start = |solve| {
            let mut wide = self.wide[..below].iter().rev();
            let found = wide.find_map(|level| level.found(solve, |x| Some(x.with_bits(bits))));
            found.or_else(|| self.double.found(solve, near))
        };
        level.caught_up(self.attempt, bits, Geometry::Whole, &self.history, start);
        level
    }

    /// The values in fractions where no contact bears a force of the islands in which the blocks of a contact are.
    fn exact_of_free(&mut self, contact: usize) -> Option<&AttemptValues<'a, BigRational>> {
        if !self.may_move_freely(contact) {
            return None;
        }
        self.exact().filter(|values| values.moves_freely(contact))
    }

    /// The values in fractions where they are asked for all blocks: not where that is known to be in vain.
    pub(crate) fn exact_of_all(&mut self) -> Option<&AttemptValues<'a, BigRational>> {
        self.exact().filter(|values| values.large_islands_are_solved())
    }

    /// The values in fractions. An island has none where a force is irrational, or where it is too large and bears forces.
    pub(crate) fn exact(&mut self) -> Option<&AttemptValues<'a, BigRational>> {
        // Where balls have calculated all geometry there is all of it: then fractions calculate what they are asked for.
        let geometry = if self.history.bound.is_some() { Geometry::Asked } else { Geometry::Whole };
        if let Some(values) = self.exact.begin(self.attempt, 0, geometry) {
            values.is_definite = self.history.bound.is_some();
        }
        self.exact.caught_up(self.attempt, 0, geometry, &self.history, |_| None)
    }

    /// The values in so many bits.
    pub(crate) fn with_bits(&mut self, bits: u32) -> Option<Box<AttemptValues<'a, WideBall>>> {
        let known = WIDE_BITS.iter().position(|&known| known == bits);
        let level = known.map_or(Level::Unused, |k| std::mem::replace(&mut self.wide[k], Level::Unused));
        match self.wider(level, bits) {
            Level::Ready(values) => Some(values),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
