//! Which candidate comes next, and which is the best.

use super::TuneError;
use super::candidate::{Knobs, Model};
use super::measure::{Measurement, Workbench};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof_campaign::families::{Kit, Style};
use rockproof_model::rules::Rule;
use rockproof_model::{Preset, ToleranceSet, ToleranceSpec};

/// Draws before a candidate is taken although it breaks a rule or was there before.
const TRIES: usize = 200;

/// Candidates that are put to the lockstep although as many as a quarter of all have been.
const LOCKED: usize = 4;

/// Where a candidate comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// What the author uses now.
    Author,
    /// What the author uses, with as little changed as the rules ask for.
    Mended,
    /// The same with what docs/rules_of_thumb.md proposes.
    Thumb,
    /// A preset.
    Preset(Preset),
    /// Drawn at random.
    Drawn,
    /// The best so far with some knobs turned.
    Turned,
}

impl Origin {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Origin::Author => "author",
            Origin::Mended => "mended",
            Origin::Thumb => "thumb",
            Origin::Preset(preset) => preset.name(),
            Origin::Drawn => "drawn",
            Origin::Turned => "turned",
        }
    }
}

/// A candidate and what was measured of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Where it comes from.
    pub origin: Origin,
    /// The set.
    pub set: ToleranceSet,
    /// Its place on the scales of the search; none for sets from outside.
    pub knobs: Option<Knobs>,
    /// What was measured.
    pub measurement: Measurement,
}

/// A search over tolerance sets.
pub struct Search<'w> {
    bench: &'w Workbench,
    model: Model,
    seed: u64,
    first: Vec<(Origin, ToleranceSet)>,
    tried: Vec<Tried>,
}

/// A candidate that is still to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Next {
    /// Where it comes from.
    pub origin: Origin,
    /// The set.
    pub set: ToleranceSet,
    /// Its place on the scales.
    pub knobs: Option<Knobs>,
}

impl<'w> Search<'w> {
    /// A search that begins with the author's set, what becomes of it by the rules and by thumb, and the presets; none of them twice.
    ///
    /// # Errors
    /// When the author's set cannot be derived.
    pub fn new(bench: &'w Workbench, author: &ToleranceSpec, seed: u64) -> Result<Search<'w>, TuneError> {
        let shapes = bench.scene().shapes();
        let precision = bench.precision();
        let model = Model::of(&shapes, precision).map_err(rockproof_model::SpecError::from)?;
        let author = author.derive(&shapes, precision)?;
        let mended = if bench.broken(&author).is_empty() { author.clone() } else { model.mended(&author) };
        let thumbs = [false, true].map(|territory| (Origin::Thumb, model.by_thumb(&mended, territory)));
        // A preset that cannot be derived is no candidate.
        let preset = |preset: Preset| {
            let set = ToleranceSpec::from(preset).derive(&shapes, precision);
            set.ok().map(|set| (Origin::Preset(preset), set))
        };
        let mut first = vec![(Origin::Author, author), (Origin::Mended, mended)];
        first.extend(thumbs);
        first.extend(Preset::ALL.into_iter().filter_map(preset));
        let all = std::mem::take(&mut first);
        for (origin, set) in all {
            if first.iter().all(|(_, known)| *known != set) {
                first.push((origin, set));
            }
        }
        Ok(Search { bench, model, seed, first, tried: Vec::new() })
    }

    /// Candidates that are tried before any is drawn.
    pub fn given(&self) -> usize {
        self.first.len()
    }

    /// The next candidate: a function of the seed and of what was measured so far.
    pub fn candidate(&self) -> Next {
        let number = self.tried.len();
        if let Some((origin, set)) = self.first.get(number) {
            return Next { origin: *origin, set: set.clone(), knobs: None };
        }
        let mut key = *b"rockproof tuner, version 1......";
        key[24..].copy_from_slice(&self.seed.to_le_bytes());
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(number as u64);
        let mut kit = Kit::with_style(&mut rng, Style::Grid);
        let best = self.best().map(|best| &self.tried[best]);
        let best = best.map(|best| best.knobs.unwrap_or_else(|| Knobs::nearest(&best.set, &self.model)));
        // One in three looks elsewhere.
        let origin = if best.is_none() || number.is_multiple_of(3) { Origin::Drawn } else { Origin::Turned };
        let mut draw = || match best {
            Some(best) if origin == Origin::Turned => best.turned(&mut kit),
            _ => Knobs::drawn(&mut kit),
        };
        let mut knobs = draw();
        for _ in 0..TRIES {
            let known = self.tried.iter().any(|tried| tried.knobs == Some(knobs));
            if !known && self.bench.broken(&knobs.set(&self.model)).is_empty() {
                break;
            }
            knobs = draw();
        }
        Next { origin, set: knobs.set(&self.model), knobs: Some(knobs) }
    }

    /// Takes in what was measured of the next candidate.
    pub fn add(&mut self, next: Next, measurement: Measurement) {
        let Next { origin, set, knobs } = next;
        self.tried.push(Tried { origin, set, knobs, measurement });
    }

    /// Measures the next candidate and takes it in.
    ///
    /// # Errors
    /// When it cannot be measured.
    pub fn step(&mut self) -> Result<&Tried, TuneError> {
        let next = self.candidate();
        let mut measurement = self.bench.measure(&next.set)?;
        if self.may_be_best(&measurement) {
            measurement.locked = Some(self.bench.lock(&next.set)?);
        }
        self.add(next, measurement);
        Ok(&self.tried[self.tried.len() - 1])
    }

    /// Whether the oracle is asked about the steps of the next candidate, which takes much longer than all else: always for the first; later if it is better
    /// than the best so far in what is cheap, or no worse in pairs and rules where the steps of the best differ from the oracle's; and no more often than
    /// for a quarter of all candidates, but for the first that loses no pair of the model: a set that does is never the best beside it.
    fn may_be_best(&self, measurement: &Measurement) -> bool {
        let Some(best) = self.best().map(|best| &self.tried[best].measurement) else { return true };
        if measurement.lost_pairs == 0 && best.lost_pairs > 0 {
            return true;
        }
        let locked = self.tried.iter().filter(|tried| tried.measurement.locked.is_some()).count();
        if locked >= LOCKED + self.tried.len() / 4 {
            return false;
        }
        let (new, old) = (measurement.screened(), best.screened());
        let faulty = best.locked.as_ref().is_some_and(|locked| locked.failed + locked.differ > 0);
        new < old || (faulty && (new.0, new.1, new.2, new.3) <= (old.0, old.1, old.2, old.3))
    }

    /// All candidates measured, in order.
    pub fn tried(&self) -> &[Tried] {
        &self.tried
    }

    /// The number of the best candidate of those whose steps the oracle was asked about, the first of equals; `None` before the first.
    pub fn best(&self) -> Option<usize> {
        let locked = (0..self.tried.len()).filter(|&k| self.tried[k].measurement.locked.is_some());
        locked.min_by_key(|&k| self.tried[k].measurement.merit())
    }

    /// The best candidate, then those that no other beats in all of: pairs that differ, sinking, slack to the nearest rule, length of a step, contacts
    /// changed by tolerances; by pairs that differ, then sinking. All keep every rule, and lose no pair of the model if the best loses none.
    pub fn front(&self) -> Vec<usize> {
        let may_lose = self.best().is_some_and(|best| self.tried[best].measurement.lost_pairs > 0);
        let fine: Vec<usize> = (0..self.tried.len())
            .filter(|&k| {
                let m = &self.tried[k].measurement;
                m.violated.is_empty() && m.stepped.stopped.is_none() && (may_lose || m.lost_pairs == 0)
            })
            .collect();
        let costs = |k: usize| {
            let m = &self.tried[k].measurement;
            let d = &m.differences;
            let step_limit = self.tried[k].set.max_displacement.approximate();
            [d.avoidable() as f64, m.stepped.overlaps.sunk, -m.tightest.factor, d.changed as f64, -step_limit]
        };
        let beaten = |k: usize| {
            fine.iter().any(|&other| {
                let (one, by) = (costs(k), costs(other));
                let no_worse = one.iter().zip(&by).all(|(a, b)| b <= a);
                no_worse && (one != by || other < k)
            })
        };
        let is_best = |k: usize| self.best() == Some(k);
        let mut front: Vec<usize> = fine.iter().copied().filter(|&k| is_best(k) || !beaten(k)).collect();
        front.sort_by(|&a, &b| {
            let (one, other) = (costs(a), costs(b));
            let first = is_best(b).cmp(&is_best(a));
            first.then(one[0].total_cmp(&other[0])).then(one[1].total_cmp(&other[1])).then(a.cmp(&b))
        });
        front
    }
}

/// The rules as a list of their formulas.
pub(super) fn formulas(rules: &[Rule]) -> String {
    rules.iter().map(|rule| rule.formula()).collect::<Vec<_>>().join("; ")
}
