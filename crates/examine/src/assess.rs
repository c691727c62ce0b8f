//! The work: a model under one set of tolerances, a search for another one, and the model under that.

use crate::bare_edges::{BareEdge, bare_edges};
use crate::checked::CheckedModel;
use crate::error::ExamineError;
use crate::extents::short;
use crate::local_origin::LocalOrigin;
use crate::naming::file_name;
use crate::overlaps::{MeasuredOverlaps, OverlapScope, Overlaps, overlaps};
use crate::pairs::{self, ExaminedPair, PRECISIONS};
use crate::pressed_springs::at_start;
use crate::progress::{Stage, WorkProgress};
use crate::recommend::{Recommendation, better};
use crate::steps::{self, Steps};
use crate::stored_energy::{self, StoredEnergy};
use rockproof_differential::subject::NamedSet;
use rockproof_model::tolerance_rules::{self, Thin, Violation, Warning};
use rockproof_model::{Precision, ToleranceSet, ToleranceSpec};
use rockproof_report::table::counted;
use rockproof_tune::report::markdown;
use rockproof_tune::{Evaluator, Search, TuneError};
use std::sync::atomic::{AtomicBool, Ordering};

/// Blocks of a model that is stepped without being asked to.
const MAX_STEPPED: usize = 2000;
/// Steps of such a model, and of the search for a set, for each candidate: what a step of the search finds wrong with the set given, those of the model find as well.
const STEPS: u64 = 8;
/// Seed of the search for a set.
const SEED: u64 = 1;

/// How much is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Steps to make and audit after settling, whatever the size of the model; `None` for 8 where it has at most 2000 blocks.
    pub steps: Option<u64>,
    /// Tolerance sets to try, the one given among them; 0 for no search.
    pub candidates: u32,
    /// Worker threads, 0 for one a core; the results do not depend on it.
    pub threads: usize,
}

/// How a model does with one tolerance set.
#[derive(Clone, Debug)]
pub struct Assessment {
    /// The set.
    pub set: ToleranceSet,
    /// The rules that it violates.
    pub violations: Vec<Violation>,
    /// A block that `penetration` is more than half as thick as.
    pub thin: Option<Thin>,
    /// What violates no rule and yet lets blocks pass through one another.
    pub warnings: Vec<Warning>,
    /// The pairs whose springs store more at the start than weights and loads explain, the one furthest beyond it first.
    pub stored: Vec<StoredEnergy>,
    /// Reflex edges on which another block lies where no contact is.
    pub bare_edges: Vec<BareEdge>,
    /// The blocks that overlap.
    pub overlaps: Overlaps,
    /// Whether a block of a pair that touches can move: between fixed blocks nothing can go wrong.
    pub has_moving_pair: bool,
    /// All neighbouring pairs, in ascending order.
    pub pairs: Vec<ExaminedPair>,
    /// The steps.
    pub steps: Steps,
}

/// Everything that was found.
#[derive(Clone, Debug)]
pub struct Examination {
    /// The model and its tolerances.
    pub model: CheckedModel,
    /// The name of the set that was given.
    pub name: String,
    /// How the model does with it.
    pub given: Assessment,
    /// How it does relative to a local origin, where that is better.
    pub local_origin: Option<LocalOrigin>,
    /// Another set.
    pub other: Recommendation,
}

impl Assessment {
    /// Pairs that differ in a precision, and those of them that are broken.
    pub fn differing(&self, precision: Precision) -> [usize; 2] {
        let count = |is_meant: &dyn Fn(&ExaminedPair) -> bool| self.pairs.iter().filter(|pair| is_meant(pair)).count();
        [
            count(&|pair| pair.in_precision(precision).total() > 0),
            count(&|pair| pair.in_precision(precision).broken > 0),
        ]
    }

    /// Whether nothing is wrong with the model under this set, something was tried, and what is wrong could have been seen.
    pub fn is_safe(&self, precision: Precision) -> bool {
        let steps = &self.steps;
        let are_right = !steps.end_deep() && !steps.lose_friction() && !steps.have_decisive_false_entrances();
        self.fault_counts(precision) == [0; 5] && self.tries_contacts() && self.may_see_all() && are_right
    }

    /// Whether nothing in the tolerances keeps what is wrong from being seen in a few steps, or at all.
    pub(crate) fn may_see_all(&self) -> bool {
        self.thin.is_none() && self.warnings.is_empty() && self.stored.is_empty() && self.bare_edges.is_empty()
    }

    /// Whether there were contacts to be wrong: blocks near one another at the start, or in the steps.
    pub(crate) fn tries_contacts(&self) -> bool {
        self.has_moving_pair || self.steps.made().is_some_and(|made| made.touched)
    }

    /// What is wrong, each zero where nothing is: rules violated, overlaps not held, pairs broken, pairs that pass through one another, steps that cannot be made.
    pub(crate) fn fault_counts(&self, precision: Precision) -> [u64; 5] {
        let [_, broken] = self.differing(precision);
        let passing = self.steps.made().map_or(0, |made| made.passages.len() + made.unseen.len());
        let not_made = self.steps.find_fault() && passing == 0;
        [self.violations.len(), self.overlaps.lost(), broken, passing, usize::from(not_made)].map(|count| count as u64)
    }
}

impl Examination {
    /// The assessment under the set that is recommended, if another one is.
    pub fn recommended(&self) -> Option<&Assessment> {
        match &self.other {
            Recommendation::Other(other) => Some(&other.assessed),
            _ => None,
        }
    }
}

/// Examines a model; what is being done is told to `seen`. `None` where `stop` is set before the end: it is looked at between two pairs, steps and sets.
///
/// # Errors
/// When tolerances cannot be derived, or the model cannot be stepped.
pub fn examine(
    model: CheckedModel,
    settings: &Settings,
    seen: &WorkProgress,
    stop: &AtomicBool,
) -> Result<Option<Examination>, ExamineError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build()?;
    pool.install(|| Work { settings, seen, stop }.examine(model))
}

/// What the parts of the work share.
struct Work<'w> {
    settings: &'w Settings,
    seen: &'w WorkProgress,
    stop: &'w AtomicBool,
}

impl Work<'_> {
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Does everything; `None` where it was stopped.
    fn examine(&self, model: CheckedModel) -> Result<Option<Examination>, ExamineError> {
        let name = name_of(&model.spec);
        let shapes = model.scene.shapes();
        let [f32, f64] = PRECISIONS.map(|precision| model.spec.derive(&shapes, precision));
        let sets = NamedSet { name: name.as_str().into(), f32: f32?, f64: f64? };
        let Some(given) = self.assess(&model, &sets)? else { return Ok(None) };
        let local_origin = LocalOrigin::of(&model, &given, &name, (self.seen, self.stop))?;
        let Some(other) = self.recommend(&model, &given)? else { return Ok(None) };
        Ok(Some(Examination { model, name, given, local_origin, other }))
    }

    /// How the model does with a set; `None` where it was stopped meanwhile.
    fn assess(&self, model: &CheckedModel, sets: &NamedSet) -> Result<Option<Assessment>, ExamineError> {
        let shapes = model.scene.shapes();
        let set = sets.of(model.precision).clone();
        let violations = tolerance_rules::check_scene(&set, &model.scene, model.precision);
        let thin = tolerance_rules::thin(&set, &shapes);
        let warnings = tolerance_rules::warnings(&set, &model.scene);
        let fixed = model.scene.fixed();
        let scope = OverlapScope { only: None, measured: MeasuredOverlaps::All, fixed: &fixed };
        let overlaps = overlaps(&shapes, &set, scope, self.seen, self.stop);
        let all = overlaps.neighbours();
        self.seen.begin(Stage::Pairs, all.len());
        let pairs = pairs::examine_all(&shapes, all, sets, (self.seen, self.stop));
        let Some(pairs) = pairs.filter(|_| !self.is_stopped()) else { return Ok(None) };
        let steps = match self.why_no_steps(model, &overlaps) {
            Some(why) => Steps::Skipped(why),
            None => {
                let count = self.settings.steps.unwrap_or(STEPS);
                let settling = u64::from(model.scene.simulation.control.settle);
                self.seen.begin(Stage::Steps, usize::try_from(count.saturating_add(settling)).unwrap_or(usize::MAX));
                match steps::make(&model.scene, &set, model.precision, count, (self.seen, self.stop))? {
                    None => return Ok(None),
                    Some(made) => Steps::Made(Box::new(made)),
                }
            }
        };
        let has_moving_pair = any_moves(&pairs, &fixed);
        let stored = unexplained(model, &set, &overlaps, &steps);
        let bare_edges = bare_edges(&model.scene, &set, &overlaps, self.stop);
        if self.is_stopped() {
            return Ok(None);
        }
        Ok(Some(Assessment {
            set,
            violations,
            thin,
            warnings,
            stored,
            bare_edges,
            overlaps,
            has_moving_pair,
            pairs,
            steps,
        }))
    }

    fn why_no_steps(&self, model: &CheckedModel, overlaps: &Overlaps) -> Option<String> {
        let blocks = model.scene.blocks.len();
        match self.settings.steps {
            Some(0) => Some("none were asked for".to_owned()),
            _ if overlaps.lost() > 0 => {
                let pairs = plural(overlaps.lost(), "pair overlaps", "pairs overlap");
                Some(format!("not made: {pairs} at the start so that contacts cannot hold them"))
            }
            None if blocks > MAX_STEPPED => Some(format!(
                "not made: {blocks} blocks are more than {MAX_STEPPED}; --steps N makes them all the same"
            )),
            _ => None,
        }
    }

    /// Looks for a better set; `None` where it was stopped meanwhile.
    fn recommend(&self, model: &CheckedModel, given: &Assessment) -> Result<Option<Recommendation>, ExamineError> {
        if let Some(why) = self.why_no_search(model, given) {
            return Ok(Some(Recommendation::Skipped(why)));
        }
        let most = self.settings.candidates as usize;
        self.seen.begin(Stage::Sets, most);
        let evaluator = match Evaluator::new(&model.scene, model.precision, SEED, Some(STEPS), 0) {
            // Contacts reach further than pairs are made of: no reason to keep back what was found.
            Err(TuneError::NoNeighbours) => {
                let why = "not looked for: no two blocks are near enough to make pairs of, that moved tell sets apart";
                return Ok(Some(Recommendation::Skipped(why.to_owned())));
            }
            evaluator => evaluator?,
        };
        let mut search = Search::new(&evaluator, &model.spec, SEED)?;
        while search.tried().len() < most {
            if self.is_stopped() {
                return Ok(None);
            }
            match search.step() {
                // A block that rounding makes degenerate: the model is wrong, as the steps say, not the command.
                Err(TuneError::Setup(error)) => {
                    return Ok(Some(Recommendation::Skipped(format!("not looked for: {error}"))));
                }
                made => made?,
            };
            self.seen.advance();
        }
        let file = file_name(&model.file);
        let text = || markdown(&file, &evaluator, &search);
        better(&search, given, model.precision, text, |set| {
            let sets = NamedSet::same("recommended", set);
            self.assess(model, &sets)
        })
    }

    fn why_no_search(&self, model: &CheckedModel, given: &Assessment) -> Option<String> {
        if self.settings.candidates == 0 {
            return Some("not looked for (--no-tune)".to_owned());
        }
        if given.overlaps.neighbours().is_empty() {
            return Some("not looked for: no two blocks are near one another".to_owned());
        }
        let (shortest, _) = model.extents.shortest();
        let deepest = given.overlaps.worst_lost().and_then(|worst| worst.penetration.depth_m()).unwrap_or(0.0);
        // A tolerance as long as an edge of the model is none.
        (deepest > shortest).then(|| {
            let [deepest, shortest] = [deepest, shortest].map(short);
            format!("not looked for: the deepest overlap, {deepest} m, is longer than the shortest edge, {shortest} m, and no set is meant to hold that")
        })
    }
}

/// Whether a block of some pair can move.
fn any_moves(pairs: &[ExaminedPair], fixed: &[bool]) -> bool {
    pairs.iter().any(|pair| pair.touches && pair.blocks.iter().any(|&block| !fixed[block]))
}

/// The pairs whose springs store more when time begins than weights and loads explain: as the blocks stand, or after settling. Nothing is known of it where
/// blocks settle and no step is made.
fn unexplained(model: &CheckedModel, set: &ToleranceSet, overlaps: &Overlaps, steps: &Steps) -> Vec<StoredEnergy> {
    let scene = stored_energy::as_stepped(&model.scene, set);
    let springs = match (scene.simulation.control.settle, steps.made()) {
        (0, _) => at_start(&scene, set, overlaps),
        (_, made) => made.map(|made| made.settled.clone()).unwrap_or_default(),
    };
    // A larger `penetration` than the one given allows deeper overlaps, and explains no more.
    let penetration = (&set.penetration).min(&model.set.penetration);
    stored_energy::unexplained(&scene, &ToleranceSet { penetration: penetration.clone(), ..set.clone() }, &springs)
}

/// What a set is called: by the preset it is, with a mark where it was changed, or by its file.
fn name_of(spec: &ToleranceSpec) -> String {
    let is_preset = spec.numbers().is_empty() && spec.criteria().is_none();
    let changed = if is_preset { "" } else { ", changed" };
    spec.preset().map_or("the set given".to_owned(), |preset| format!("{}{changed}", preset.name()))
}

/// A count with its noun.
pub(crate) fn plural(count: usize, one: &str, many: &str) -> String {
    counted(count as u64, one, many)
}
