//! Pins that the motions of a campaign reach the rules of a step that are new in version 2: contacts kept though deeper
//! than g, slips that turn, a seventh solve without a change, a Δt that grows by half. A rule is reached where the step
//! without it ends elsewhere.

use rayon::prelude::*;
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::source;
use rockproof_differential::collapse::collapsed_feature;
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{PairSource, Subject};
use rockproof_stepper::Real;
use rockproof_stepper::contact::{ContactRules, SpecRules};
use rockproof_stepper::dynamics::{Dynamics, Mode, StepRules};

/// Nothing is kept.
struct NothingKept;

/// A slip that turned goes on sliding.
struct TurnsSlide;

/// Solves in which no mode changes go on.
struct NoSeventh;

/// Δt begins full each time.
struct FullAtOnce;

impl ContactRules for NothingKept {}
impl ContactRules for TurnsSlide {}
impl ContactRules for NoSeventh {}
impl ContactRules for FullAtOnce {}

impl StepRules for NothingKept {
    fn leaves_kept(_: Mode) -> bool {
        false
    }
}

impl StepRules for TurnsSlide {
    fn slip_turned<R: Real>(_: R) -> bool {
        false
    }
}

impl StepRules for NoSeventh {
    fn unchanging_solves() -> u32 {
        50
    }
}

impl StepRules for FullAtOnce {
    fn first_time_step<R: Real>(full: R, _: R) -> R {
        full
    }
}

/// The vertices after each step, as far as steps can be made.
fn trajectory<M: StepRules>(subject: &Subject, motion: &PairMotion) -> Vec<Vec<[f64; 3]>> {
    let set = &subject.sets[0].f64;
    let scene = motion.scene(&subject.a, &subject.b, set);
    let Ok(mut dynamics) = Dynamics::<f64, M>::with_rules(&scene, set) else { return Vec::new() };
    let mut all = Vec::new();
    for _ in 0..motion.steps {
        if dynamics.step().is_err() {
            break;
        }
        let blocks = dynamics.state().blocks.iter();
        all.push(blocks.flat_map(|block| block.vertices.iter().map(|v| [v.x, v.y, v.z])).collect());
    }
    all
}

#[test]
fn motions_reach_the_new_rules() {
    let config = CampaignConfig { steps_every: 2, steps: 4, ..CampaignConfig::default() };
    let source = source::of(&config).unwrap();
    let moving = |subject: Subject| {
        let motion = source.motion(&subject)?;
        let is_collapsed = [&subject.a, &subject.b].into_iter().any(|block| collapsed_feature(block).is_some());
        (!is_collapsed).then_some((subject, motion))
    };
    // For each pair the step of each rule in which it is reached.
    let reached = |(subject, motion): (Subject, PairMotion)| -> [Option<usize>; 4] {
        let right = trajectory::<SpecRules>(&subject, &motion);
        let others = [
            trajectory::<NothingKept>(&subject, &motion),
            trajectory::<TurnsSlide>(&subject, &motion),
            trajectory::<NoSeventh>(&subject, &motion),
            trajectory::<FullAtOnce>(&subject, &motion),
        ];
        others.map(|other| {
            let same = right.iter().zip(&other).take_while(|(right, other)| right == other).count();
            (same < right.len().max(other.len())).then_some(same)
        })
    };
    let batch = |number: u64| source.batch(number).into_iter().filter_map(moving).map(reached).collect::<Vec<_>>();
    let mut counts = [[0; 4]; 4];
    let are_reached = |counts: &[[i32; 4]; 4]| counts.iter().all(|counts| counts.iter().sum::<i32>() >= 3);
    let mut looked_at = 0;
    // One batch of each family at a time, until each rule is reached as often as is asked.
    for first in (0..126u64).step_by(14) {
        let pairs: Vec<_> = (first..first + 14).into_par_iter().flat_map_iter(batch).collect();
        looked_at += pairs.len();
        for steps in &pairs {
            for (of_rule, step) in counts.iter_mut().zip(steps) {
                if let Some(step) = step {
                    of_rule[*step] += 1;
                }
            }
        }
        if are_reached(&counts) {
            break;
        }
    }
    println!("of {looked_at} pairs, by the step in which the rule is first reached:");
    for (name, counts) in ["kept contacts", "turned slips", "seventh solve", "growth of Δt"].iter().zip(counts) {
        println!("{name:16} {counts:?}");
    }
    assert!(are_reached(&counts), "{counts:?}");
}
