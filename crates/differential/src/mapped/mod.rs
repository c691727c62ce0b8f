//! Engines that do not classify contacts but say how two blocks lie to one another, as collision codes do: apart, touching
//! or overlapping, by how much, and which way out. Compared with the exact answer for convex pairs.

pub mod separation;

use super::compare::Change;
use super::engine::{Answer, Engine, guarded};
use super::transform::Transform;
use rockproof_model::{Block, Number, Point, Precision, ToleranceSet};
use separation::{Separation, normal_serves};
use std::fmt;

/// How two blocks lie to one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum State {
    /// There is room between them.
    Apart,
    /// They have points in common, but none inside both.
    Touching,
    /// They have points inside both.
    Overlapping,
}

impl State {
    /// All states.
    pub const ALL: [State; 3] = [State::Apart, State::Touching, State::Overlapping];

    /// `apart`, `touching` or `overlapping`.
    pub fn name(self) -> &'static str {
        match self {
            State::Apart => "apart",
            State::Touching => "touching",
            State::Overlapping => "overlapping",
        }
    }

    /// The state written `name`, if there is one.
    pub fn from_name(name: &str) -> Option<State> {
        Self::ALL.into_iter().find(|state| state.name() == name)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// What an engine says about a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Said {
    /// How the blocks lie.
    pub state: State,
    /// The distance, or minus the depth (m), if the engine tells.
    pub gap_m: Option<f64>,
    /// The direction in which A leaves B, of any length, if the engine tells.
    pub normal: Option<[f64; 3]>,
}

/// What an engine said, beside what is so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapped {
    /// How the blocks lie.
    pub exact: State,
    /// The distance, or minus the depth, to the nearest f64 (m).
    pub exact_gap_m: f64,
    /// What the engine said.
    pub said: Said,
    /// The exact gap over the largest coordinate: how near to touching. **0 is a tie.**
    pub margin: f64,
    /// The margin in units of the engine's roundoff.
    pub margin_ulps: f64,
}

impl fmt::Display for Mapped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?} m, said {}", self.exact, self.exact_gap_m, self.said)
    }
}

impl fmt::Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.state)?;
        if let Some(gap) = self.gap_m {
            write!(f, " {gap:?} m")?;
        }
        if let Some([x, y, z]) = self.normal {
            write!(f, " along ({x:?}, {y:?}, {z:?})")?;
        }
        Ok(())
    }
}

/// The pair an engine answered about.
#[derive(Clone, Copy)]
pub struct Asked<'x> {
    /// The blocks as the engine saw them.
    pub blocks: &'x [Block; 2],
    /// The engine's precision.
    pub precision: Precision,
    /// How far its gap and normal may be off: so many times eps times the largest coordinate.
    pub accuracy: u64,
}

impl Asked<'_> {
    /// The largest coordinate of the pair (m).
    fn reach(&self) -> f64 {
        self.blocks.iter().flat_map(Block::coordinates).map(|c| c.approximate().abs()).fold(0.0, f64::max)
    }

    /// What is wrong with an answer, and the comparison; `None` where the exact side has no answer: a block is concave.
    pub fn compare(&self, said: Said) -> Option<(Option<Change>, Mapped)> {
        let [a, b] = self.blocks;
        let exact = Separation::of(a, b)?;
        let (reach, epsilon) = (self.reach(), self.precision.epsilon());
        let gap = exact.gap_m();
        let margin = if reach > 0.0 { gap / reach } else { 0.0 };
        let slack = self.accuracy as f64 * epsilon * reach;
        let mapped =
            Mapped { exact: exact.state, exact_gap_m: gap, said, margin, margin_ulps: margin / (epsilon / 2.0) };
        let wrong = if said.state != exact.state {
            Some(Change::State)
        } else if said.gap_m.is_some_and(|found| (found - gap).abs() > slack) {
            Some(Change::Gap)
        } else if said.normal.is_some_and(|normal| !normal_serves(a, b, normal, gap, slack)) {
            Some(Change::Normal)
        } else {
            None
        };
        Some((wrong, mapped))
    }
}

/// An engine's answer about a pair, to be judged.
pub struct Judged<'x> {
    /// The engine.
    pub engine: &'x dyn Engine,
    /// The pair, exact.
    pub exact: [&'x Block; 2],
    /// The pair as the engine sees it.
    pub blocks: &'x [Block; 2],
    /// The tolerances as the engine sees them.
    pub tolerances: &'x ToleranceSet,
    /// Whether to make the metamorphic checks too.
    pub metamorphic: bool,
}

/// What is wrong with an answer.
#[derive(Debug, Default)]
pub struct Judgement {
    /// What the engine said about the pair itself and what is so; `None` where the exact side has no answer.
    pub mapped: Option<Mapped>,
    /// What is wrong, and how it is.
    pub wrong: Vec<(Change, Mapped)>,
    /// Metamorphic checks made.
    pub made: u64,
}

impl Judged<'_> {
    /// Compares an answer with the exact one and, where asked for, with the engine's own for the same pair exchanged, numbered
    /// otherwise, moved, scaled, and for a block far away: the state may not change, and what is far is apart.
    pub fn judge(&self, said: Said) -> Judgement {
        let asked = Asked { blocks: self.blocks, precision: self.engine.precision(), accuracy: self.engine.accuracy() };
        let mut judgement = Judgement::default();
        let Some((wrong, mapped)) = asked.compare(said) else {
            self.engine.not_compared();
            return judgement;
        };
        judgement.mapped = Some(mapped);
        judgement.wrong.extend(wrong.map(|change| (change, mapped)));
        if !self.metamorphic {
            return judgement;
        }
        for transform in Transform::ALL {
            if let Some(other) = transform.apply(&self.exact, self.blocks, asked.precision) {
                judgement.made += 1;
                let again = self.ask(&other.blocks, &other.tolerances(self.tolerances));
                if let Some(again) = again.filter(|again| again.state != said.state) {
                    judgement.wrong.push((transform.change(), Mapped { said: again, ..mapped }));
                }
            }
        }
        if let Some(far) = far_away(&asked) {
            judgement.made += 1;
            let again = self.ask(&[self.blocks[0].clone(), far], self.tolerances);
            if let Some(again) = again.filter(|again| again.state != State::Apart) {
                judgement.wrong.push((Change::FarBlock, Mapped { exact: State::Apart, said: again, ..mapped }));
            }
        }
        judgement
    }

    /// The engine's answer about another pair; `None` where it fails, which is a finding where it fails on the pair itself.
    fn ask(&self, [a, b]: &[Block; 2], tolerances: &ToleranceSet) -> Option<Said> {
        match guarded(|| self.engine.prepare(a, b)?.answer(tolerances)) {
            Ok(Answer::State(said)) => Some(said),
            _ => None,
        }
    }
}

/// B moved along x by eight times the largest coordinate or more, where that keeps its features.
fn far_away(asked: &Asked<'_>) -> Option<Block> {
    let exponent = (8.0 * asked.reach()).log2().ceil();
    if !exponent.is_finite() {
        return None;
    }
    let step = Number::from_f64(exponent.exp2()).ok()?;
    let moved = asked.blocks[1].translated(&Point::new(step, Number::ZERO, Number::ZERO)).rounded(asked.precision)?;
    super::collapse::collapsed_feature(&moved).is_none().then_some(moved)
}
