//! Deliberate mistakes in the stepper's iteration, step control and update, one at a time: each is found by making steps in 512 bits
//! beside the oracle, from states of short runs. The rules without a mistake differ nowhere.

use rockproof::lockstep::answer::{Answer, compare};
use rockproof::lockstep::errors::{anchor_error, velocity_error};
use rockproof::lockstep::run::KEEP;
use rockproof::lockstep::scene::ExactScene;
use rockproof::lockstep::state::exact_state;
use rockproof::lockstep::wide::WideStepper;
use rockproof::model::scene::Format;
use rockproof::model::simulation::derive_stiffness;
use rockproof::model::{Precision, Scene};
use rockproof::oracle::step::StepAnswer;
use rockproof::stepper::Real;
use rockproof::stepper::contact::{Rules, Spec};
use rockproof::stepper::dynamics::{Dynamics, Mode, State, StepRules};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Blocks that fall on a floor, askew and one on the other: they hit, slide, stick and part.
const FALL: &str = r#"
[simulation]
gravity = [1, 0, -10]
time_step = 0.005

[[joint]]
friction = 0.5
normal_stiffness = 2e8

[[block]]
name = "floor"
fixed = true
box = { min = [-9, -9, -1], max = [9, 9, 0] }

[[block]]
name = "low"
box = { min = [0, 0, 0.002], max = [1, 1, 1] }
spin = [0.3, 0.1, 0]

[[block]]
name = "high"
box = { min = [0.3, 0.2, 1.004], max = [1.3, 1.2, 2] }
velocity = [0.5, 0, -1]
"#;

/// A block that turns and flies too fast for its Δt.
const FAST: &str = r#"
[simulation]
gravity = [0, 0, 0]
time_step = 0.05

[[block]]
name = "flying"
box = { min = [0, 0, 0], max = [1, 1, 1] }
velocity = [3, 0, 0]

[[block]]
name = "turning"
box = { min = [9, 0, 0], max = [9.25, 0.25, 0.25] }
spin = [0, 0, 9]
"#;

/// A block so fast that no Δt is small enough for it, and a little less fast.
const TOO_FAST: &str = r#"
[simulation]
gravity = [0, 0, 0]
time_step = 1

[[block]]
name = "shot"
box = { min = [0, 0, 0], max = [1, 1, 1] }
velocity = [20, 0, 0]
"#;

/// Scenes, tolerances set over those of `auto`, and steps.
const BANK: [(&str, &str, &str, usize); 6] = [
    ("fall", FALL, "", 40),
    ("fall by large tolerances", FALL, "open = 1e-4\nclose = 1e-4\n", 40),
    ("fall with Eq. (1)", FALL, "equal = 0.5\n", 30),
    ("fall in large steps", FALL, "time_step = 0.02\n", 12),
    ("fast", FAST, "", 2),
    ("too fast", TOO_FAST, "", 1),
];

macro_rules! mistakes {
    ($($name:ident $text:literal,)*) => {
        /// What can be wrong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum Mistake { Nothing, $($name),* }

        const ALL: &[(Mistake, &str)] = &[$((Mistake::$name, $text)),*];
    };
}

mistakes! {
    BeginsOpen "a new contact that overlaps is open",
    IgnoresEquality "Eq. (1) is not asked",
    EqualityOfLarger "Eq. (1) with the gap after the solve",
    ClosesAtOnce "closes without epsilon_c",
    OpensAtOnce "opens without epsilon_o",
    NeverOpens "a closed contact never opens",
    PressesOutside "the outer distance presses, not the overlap",
    NoFriction "strength without friction",
    DoubleFriction "strength with twice the friction",
    BecomesLockedEasily "becoming locked ignores the stiffness ratio, staying locked does not",
    ConvergesWhileSliding "changes between sliding and locked do not count for convergence",
    TwoIterations "two solves, not six",
    CutsByHalf "a half of the time step after no convergence",
    NoFarthest "the displacement limit is not asked",
    NoTurning "the rotation limit is not asked",
    SmallestTenth "the smallest time step is a tenth of the full one",
    NoDrag "a sliding contact's anchor is not dragged",
    NoTransfer "contacts forget their mode",
    MeanRate "the velocity after a step is its mean",
}

static PLANTED: AtomicUsize = AtomicUsize::new(0);

fn planted(mistake: Mistake) -> bool {
    PLANTED.load(Ordering::SeqCst) == mistake as usize
}

/// The rules of SPEC with the mistake that is planted.
#[derive(Clone, Debug)]
struct Mistaken;

impl Rules for Mistaken {}

impl StepRules for Mistaken {
    fn begins<R: Real>(gap: R) -> Mode {
        if planted(Mistake::BeginsOpen) { Mode::Open } else { Spec::begins(gap) }
    }
    fn keeps_mode<R: Real>(gap: R, gap_before: R, equal: R) -> bool {
        match () {
            () if planted(Mistake::IgnoresEquality) => false,
            () if planted(Mistake::EqualityOfLarger) => gap.abs() <= equal * gap.abs().larger(gap_before.abs()),
            () => Spec::keeps_mode(gap, gap_before, equal),
        }
    }
    fn closes<R: Real>(gap: R, close: R) -> bool {
        Spec::closes(gap, if planted(Mistake::ClosesAtOnce) { R::ZERO } else { close })
    }
    fn opens<R: Real>(gap: R, open: R, tensile_gap: R) -> bool {
        !planted(Mistake::NeverOpens)
            && Spec::opens(gap, if planted(Mistake::OpensAtOnce) { R::ZERO } else { open }, tensile_gap)
    }
    fn pressing<R: Real>(gap: R) -> R {
        Spec::pressing(if planted(Mistake::PressesOutside) { -gap } else { gap })
    }
    fn strength<R: Real>(friction: R, normal_force: R, cohesive_force: R) -> R {
        match () {
            () if planted(Mistake::NoFriction) => cohesive_force,
            () if planted(Mistake::DoubleFriction) => Spec::strength(friction + friction, normal_force, cohesive_force),
            () => Spec::strength(friction, normal_force, cohesive_force),
        }
    }
    fn locks<R: Real>(before: Mode, force_squared: R, strength_squared: R) -> bool {
        let easily = planted(Mistake::BecomesLockedEasily) && before != Mode::Locked;
        let scale = R::from_f64(if easily { 0.16 } else { 1.0 });
        Spec::locks(before, force_squared * scale, strength_squared)
    }
    fn counts_as_change(before: Mode, after: Mode) -> bool {
        let both_closed = before.is_closed() && after.is_closed();
        before != after && !(planted(Mistake::ConvergesWhileSliding) && both_closed)
    }
    fn iterations() -> u32 {
        if planted(Mistake::TwoIterations) { 2 } else { Spec::iterations() }
    }
    fn cut<R: Real>(time_step: R) -> R {
        if planted(Mistake::CutsByHalf) { time_step / R::from_f64(2.0) } else { Spec::cut(time_step) }
    }
    fn smallest<R: Real>(time_step: R) -> R {
        if planted(Mistake::SmallestTenth) { time_step / R::from_f64(10.0) } else { Spec::smallest(time_step) }
    }
    fn too_far<R: Real>(distance_squared: R, limit_squared: R) -> bool {
        !planted(Mistake::NoFarthest) && Spec::too_far(distance_squared, limit_squared)
    }
    fn turned_too_far<R: Real>(angle_squared: R, limit_squared: R) -> bool {
        !planted(Mistake::NoTurning) && Spec::turned_too_far(angle_squared, limit_squared)
    }
    fn drags_anchor() -> bool {
        !planted(Mistake::NoDrag)
    }
    fn transfers() -> bool {
        !planted(Mistake::NoTransfer)
    }
    fn rate<R: Real>(dynamic: R, twice_mean: R, before: R) -> R {
        if planted(Mistake::MeanRate) { twice_mean / R::from_f64(2.0) } else { Spec::rate(dynamic, twice_mean, before) }
    }
}

/// A scene with states, and what the oracle makes of each.
struct Known {
    name: &'static str,
    scene: ExactScene,
    states: Vec<(State<f64>, Option<StepAnswer>)>,
}

fn known(&(name, text, over, steps): &(&'static str, &str, &str, usize)) -> Known {
    let text = match over.split_once("time_step = ") {
        Some((_, step)) => text.replacen("time_step = 0.005", &format!("time_step = {}", step.trim()), 1),
        None => format!("{text}\n[tolerances]\npreset = \"auto\"\n{over}"),
    };
    let mut scene = Scene::parse(&text, Format::Toml, Path::new(name)).unwrap();
    let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).unwrap();
    let bodies: Vec<_> = scene.blocks.iter().map(|block| (&block.block, &block.body)).collect();
    derive_stiffness(&mut scene.simulation, &bodies, &set);
    let scene = ExactScene::new(&scene, &set).rounded(Precision::F64).unwrap();
    let mut dynamics = Dynamics::<f64>::new(scene.scene(), scene.tolerances()).unwrap();
    let mut states = Vec::new();
    for _ in 0..steps {
        let state = dynamics.state().clone();
        states.push((state.clone(), scene.step(&exact_state(&state).unwrap(), KEEP).ok()));
        if dynamics.step().is_err() {
            break;
        }
    }
    Known { name, scene, states }
}

/// The first state at which the planted mistake shows: what differs there. An unsettled comparison excuses a difference.
fn found_in(known: &Known) -> Option<String> {
    let mut wide = WideStepper::<Mistaken>::new(&known.scene).unwrap();
    let shapes = known.scene.scene().shapes();
    known.states.iter().enumerate().find_map(|(k, (state, exact))| {
        let step = wide.step(state).unwrap();
        if step.unsettled > 0 {
            return None;
        }
        let said = match (exact, step.outcome) {
            (None, Err(_)) => return None,
            (Some(exact), Ok((answer, after))) => {
                let after = exact_state(&after).unwrap();
                let off = [
                    velocity_error(&after, &exact.state)
                        .filter(|error| *error > 1e-9)
                        .map(|e| format!("velocity {e:e}")),
                    anchor_error(&after, &exact.state)
                        .filter(|error| *error > 1e-12)
                        .map(|e| format!("anchor {e:e} m")),
                ];
                let names = compare(&Answer::of_oracle(exact), &answer, &shapes)
                    .into_iter()
                    .map(|d| d.change.name().to_owned());
                let all: Vec<String> = names.chain(off.into_iter().flatten()).collect();
                if all.is_empty() {
                    return None;
                }
                all.join(", ")
            }
            (exact, stepped) => format!("stopped: oracle {}, stepper {}", exact.is_none(), stepped.is_err()),
        };
        Some(format!("{}, state {k}: {said}", known.name))
    })
}

#[test]
fn every_mistake_in_a_step_is_found() {
    let bank: Vec<Known> = BANK.iter().map(known).collect();
    let solves = bank.iter().flat_map(|known| &known.states).filter_map(|(_, exact)| exact.as_ref());
    println!("{} solves at most", solves.map(|exact| exact.iterations).max().unwrap_or(0));
    assert_eq!(bank.iter().find_map(found_in), None, "no mistake is planted");
    let mut missed = Vec::new();
    for &(mistake, text) in ALL {
        PLANTED.store(mistake as usize, Ordering::SeqCst);
        match bank.iter().find_map(found_in) {
            Some(found) => println!("{text}: {found}"),
            None => missed.push(text),
        }
    }
    assert!(missed.is_empty(), "not found: {missed:#?}");
}
