//! Deliberate mistakes in the stepper's open–close iteration and step control, one at a time: each is found by comparing
//! its steps with the oracle's on a few scenes, and without a mistake no step differs.

#[path = "support/beside.rs"]
mod beside;

use Mistake::*;
use beside::first_difference;
use rockproof::model::scene::SceneBlock;
use rockproof::model::simulation::{PointLoad, Unconverged};
use rockproof::model::{Block, Criteria, Motion, Number, Scene, ToleranceSet, Vec3};
use rockproof::stepper::Real;
use rockproof::stepper::contact::Rules;
use rockproof::stepper::dynamics::{Mode, Slip, StepRules};
use std::sync::atomic::{AtomicUsize, Ordering};

macro_rules! mistakes {
    ($($name:ident $what:literal,)*) => {
        /// What can be wrong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum Mistake { $($name),* }

        const ALL: &[(Mistake, &str)] = &[$(($name, $what)),*];
    };
}

mistakes! {
    Nothing "none",
    SlidingLockedIgnored "convergence ignores changes between sliding and locked",
    RelockForgets "becoming locked ignores the stiffness ratio and cohesion, staying locked uses them",
    ThreeIterations "the iteration ends after 3 solves, whatever says that it failed",
    TwelveIterations "the iteration goes on for 12 solves",
    OuterDistance "contacts are recorded apart up to the penetration depth, overlapping up to the search distance",
    BeginsOpen "a contact that begins touching is open",
    BeginsLocked "every contact begins locked",
    ClosesAtOnce "an open contact closes at any overlap",
    OpensAtOnce "a closed contact opens at any gap",
    TensionForgotten "tensile strength is forgotten",
    CohesionForgotten "cohesion is forgotten",
    FrictionForgotten "friction is forgotten",
    PullPresses "a gap presses as an overlap does",
    EqualAbsolute "Eq. (1): absolute",
    EqualForgotten "Eq. (1) is forgotten",
    UnsquaredStrength "the squared force is compared with the strength itself",
    AnchorStays "the anchor of a sliding contact stays behind",
    MemoryLost "contacts forget mode and anchor",
    CutByHalf "an iteration that fails is cut by half",
    NoDisplacementLimit "the displacement limit is forgotten",
    NoRotationLimit "the rotation limit is forgotten",
    RateOnce "the rate after a step is (2/Δt)·d",
}

/// The mistake that is planted. The stepper classifies in threads, so no thread can hold it.
static PLANTED: AtomicUsize = AtomicUsize::new(0);

fn planted(mistake: Mistake) -> bool {
    PLANTED.load(Ordering::SeqCst) == mistake as usize
}

/// SPEC's rules but for the mistake that is planted.
struct Mistaken;

impl Rules for Mistaken {
    fn vertex_face_near<R: Real>(gap: R, search: R) -> bool {
        gap <= if planted(OuterDistance) { R::from_f64(PENETRATION) } else { search }
    }
    fn vertex_face_depth<R: Real>(gap: R, penetration: R) -> bool {
        gap >= -if planted(OuterDistance) { R::from_f64(SEARCH) } else { penetration }
    }
}

impl StepRules for Mistaken {
    fn begins<R: Real>(gap: R) -> Mode {
        let locked = (gap <= R::ZERO && !(planted(BeginsOpen) && gap >= R::ZERO)) || planted(BeginsLocked);
        if locked { Mode::Locked } else { Mode::Open }
    }
    fn keeps_mode<R: Real>(gap: R, gap_before: R, equal: R) -> bool {
        let limit = if planted(EqualAbsolute) { equal } else { equal * gap_before.abs() };
        gap.abs() <= limit && !planted(EqualForgotten)
    }
    fn closes<R: Real>(gap: R, close: R) -> bool {
        gap < if planted(ClosesAtOnce) { R::ZERO } else { -close }
    }
    fn opens<R: Real>(gap: R, open: R, tensile_gap: R) -> bool {
        let open = if planted(OpensAtOnce) { R::ZERO } else { open };
        gap > if planted(TensionForgotten) { open } else { open + tensile_gap }
    }
    fn pressing<R: Real>(gap: R) -> R {
        if planted(PullPresses) { gap.abs() } else { (-gap).larger(R::ZERO) }
    }
    fn strength<R: Real>(friction: R, normal_force: R, cohesive_force: R) -> R {
        let cohesive = if planted(CohesionForgotten) { R::ZERO } else { cohesive_force };
        if planted(FrictionForgotten) { cohesive } else { friction * normal_force + cohesive }
    }
    fn locks<R: Real>(force_squared: R, strength_squared: R) -> bool {
        force_squared <= if planted(UnsquaredStrength) { strength_squared.sqrt() } else { strength_squared }
    }
    fn holds<R: Real>(before: Mode, slip: &Slip<R>) -> bool {
        if planted(RelockForgets) && before != Mode::Locked {
            let force = slip.normal * slip.normal * slip.stretch_squared;
            return Self::locks(force, slip.friction * slip.friction);
        }
        Self::locks(slip.shear * slip.shear * slip.stretch_squared, slip.strength * slip.strength)
    }
    fn counts_as_change(before: Mode, after: Mode) -> bool {
        before != after && !(planted(SlidingLockedIgnored) && before.is_closed() && after.is_closed())
    }
    fn iterations() -> u32 {
        if planted(ThreeIterations) {
            3
        } else if planted(TwelveIterations) {
            12
        } else {
            6
        }
    }
    fn cut<R: Real>(time_step: R) -> R {
        time_step * R::from_f64(if planted(CutByHalf) { 0.5 } else { 0.3 })
    }
    fn too_far<R: Real>(distance_squared: R, limit_squared: R) -> bool {
        distance_squared > limit_squared && !planted(NoDisplacementLimit)
    }
    fn turned_too_far<R: Real>(angle_squared: R, limit_squared: R) -> bool {
        angle_squared > limit_squared && !planted(NoRotationLimit)
    }
    fn drags_anchor() -> bool {
        !planted(AnchorStays)
    }
    fn transfers() -> bool {
        !planted(MemoryLost)
    }
    fn rate<R: Real>(dynamic: R, twice_mean: R, before: R) -> R {
        if planted(RateOnce) { dynamic * twice_mean } else { dynamic * (twice_mean - before) }
    }
}

const SEARCH: f64 = 0.125;
const PENETRATION: f64 = 0.0625;

fn n(text: &str) -> Number {
    Number::parse(text).unwrap()
}

fn v([x, y, z]: [&str; 3]) -> Vec3<Number> {
    Vec3::new(n(x), n(y), n(z))
}

fn tolerances() -> ToleranceSet {
    ToleranceSet {
        search: n("1/8"),
        territory: n("1/64"),
        penetration: n("1/16"),
        overlap_sine: n("1/16"),
        parallel_sine: n("1/16"),
        equal: n("0"),
        open: n("0"),
        close: n("0"),
        max_displacement: n("1/16"),
        max_rotation: n("1/8"),
        criteria: Criteria::Revised,
    }
}

fn cuboid(min: [&str; 3], max: [&str; 3], motion: Motion) -> SceneBlock {
    let mut block = SceneBlock::new("block", Block::cuboid(&v(min), &v(max)).unwrap());
    block.body.motion = motion;
    block
}

/// A scene of f64 numbers throughout, so that the stepper has the same ones; after `equal` no number is rounded.
struct Case {
    name: &'static str,
    scene: Scene,
    set: ToleranceSet,
    steps: u32,
}

fn case(name: &'static str, blocks: Vec<SceneBlock>, gravity: [&str; 3], steps: u32) -> Case {
    let mut scene = Scene { blocks, ..Scene::default() };
    scene.simulation.gravity = v(gravity);
    scene.simulation.control.time_step = n("1/128");
    scene.simulation.control.unconverged = Unconverged::Accept;
    scene.simulation.materials[0].density = n("2048");
    let joint = &mut scene.simulation.joints.other;
    joint.normal_stiffness = Some(n("134217728"));
    joint.shear_ratio = n("1/2");
    joint.friction = n("1/2");
    Case { name, scene, set: tolerances(), steps }
}

fn floor() -> SceneBlock {
    cuboid(["-8", "-8", "-1"], ["8", "8", "0"], Motion::Fixed)
}

fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for friction in ["0", "1/4", "3/4", "1"] {
        // An incline of 3-4-5, gravity turned: slides, creeps or sticks. It begins overlapping a little.
        let mut incline = case(
            "incline",
            vec![floor(), cuboid(["0", "0", "-0.0001220703125"], ["1", "2", "1"], Motion::Rigid)],
            ["6", "0.5", "-8"],
            12,
        );
        incline.scene.simulation.joints.other.friction = n(friction);
        all.push(incline);
    }
    // A block falls on its corners, turning.
    let mut falls = case(
        "falls",
        vec![floor(), cuboid(["0", "0", "0.015625"], ["1", "1.5", "1"], Motion::Deformable)],
        ["1", "0", "-10"],
        24,
    );
    falls.scene.blocks[1].body.velocity = v(["0.5", "0.25", "-1"]);
    falls.scene.blocks[1].body.spin = v(["0.25", "-0.5", "0.125"]);
    all.push(falls);
    // The same with tolerances that are no zeros.
    let mut dull = case(
        "dull",
        vec![floor(), cuboid(["0", "0", "0.00390625"], ["1", "1.5", "1"], Motion::Rigid)],
        ["1", "0", "-10"],
        24,
    );
    dull.scene.blocks[1].body.velocity = v(["0.25", "0", "-0.25"]);
    dull.scene.blocks[1].body.spin = v(["0.125", "0.0625", "0"]);
    dull.set.open = n("1/1024");
    dull.set.close = n("1/1024");
    dull.set.equal = n("1/4");
    all.push(dull);
    // Glued to the floor and pulled: up off the middle, and along.
    for (force, cohesion, tension) in [
        (["0", "0", "65536"], "8192", "32768"),
        (["0", "0", "65536"], "8192", "131072"),
        (["32768", "4096", "-1024"], "16384", "8192"),
        (["131072", "4096", "1024"], "16384", "65536"),
    ] {
        let mut glued = case(
            "glued",
            vec![floor(), cuboid(["0", "0", "-0.0001220703125"], ["1", "1", "0.5"], Motion::Rigid)],
            ["0", "0", "-10"],
            8,
        );
        glued.scene.simulation.joints.other.cohesion = n(cohesion);
        glued.scene.simulation.joints.other.tension = n(tension);
        glued.scene.simulation.loads =
            vec![PointLoad { block: 1, at: v(["0.625", "0.5", "0.5"]), table: vec![(n("0"), v(force))] }];
        all.push(glued);
    }
    // Too fast, and turning too fast.
    let mut fast = case("fast", vec![cuboid(["0", "0", "0"], ["1", "1", "2"], Motion::Rigid)], ["0", "0", "-10"], 2);
    fast.scene.blocks[0].body.velocity = v(["0", "0", "-12"]);
    all.push(fast);
    let mut turning = case(
        "turning",
        vec![cuboid(["-0.25", "-0.25", "0"], ["0.25", "0.25", "0.25"], Motion::Rigid)],
        ["0", "0", "0"],
        2,
    );
    turning.scene.blocks[0].body.spin = v(["0", "0", "20"]);
    turning.set.max_displacement = n("1/4");
    all.push(turning);
    // Two blocks on one another, one thrown: many modes change, and not all attempts converge.
    for speed in ["1", "2", "3"] {
        let mut pile = case(
            "pile",
            vec![
                floor(),
                cuboid(["0", "0", "-0.000030517578125"], ["1", "1", "1"], Motion::Deformable),
                cuboid(["0.25", "0.125", "0.99993896484375"], ["1.25", "1.125", "1.5"], Motion::Rigid),
            ],
            ["0", "0", "-10"],
            16,
        );
        pile.scene.blocks[2].body.velocity = v([speed, "0.5", "-0.5"]);
        pile.scene.blocks[2].body.spin = v(["0.5", "1", "0.25"]);
        all.push(pile);
    }
    // Touching exactly, pressed together.
    all.push(case(
        "touches",
        vec![floor(), cuboid(["0", "0", "0"], ["1", "1", "1"], Motion::Rigid)],
        ["1", "0", "-10"],
        6,
    ));
    // Overlapping by more than `penetration`, and apart by more than it.
    all.push(case(
        "deep",
        vec![floor(), cuboid(["0", "0", "-0.09375"], ["1", "1", "1"], Motion::Rigid)],
        ["0", "0", "-10"],
        2,
    ));
    all.push(case(
        "near",
        vec![floor(), cuboid(["0", "0", "0.09375"], ["1", "1", "1"], Motion::Rigid)],
        ["0", "0", "-10"],
        2,
    ));
    all
}

#[test]
fn every_mistake_is_found_and_none_where_there_is_none() {
    let cases = cases();
    let mut lost = Vec::new();
    for &(mistake, what) in ALL {
        PLANTED.store(mistake as usize, Ordering::SeqCst);
        let found = cases
            .iter()
            .find_map(|case| Some((case.name, first_difference::<Mistaken>(&case.scene, &case.set, case.steps)?)));
        println!("{what}: {found:?}");
        if (mistake == Nothing) != found.is_none() {
            lost.push((what, found));
        }
    }
    assert!(lost.is_empty(), "{lost:?}");
    assert!(ALL.len() > 12);
}
