//! The audit of steps, which leaves most pairs to f64, against a plain one: every neighbouring pair classified exactly and measured exactly after
//! every step. And which unseen overlaps it takes to be explained by springs, against limits worked out by hand.

use num_rational::BigRational;
use rockproof_examine::AuditedRun;
use rockproof_model::scene::SceneFormat;
use rockproof_model::{
    Block, Contact, ContactKey, ContactKind, Entrance, EntranceKind, Number, Precision, Scene, Sign, ToleranceSet, Vec3,
};
use rockproof_oracle::audit::{Auditor, rounding_depth};
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_simulate::{AuditScope, PairDepth, StepAudit, Stepping};
use rockproof_stepper::Vector;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{ContactState, Dynamics, Mode, Solve, State, StepError, StepReport};
use std::path::Path;

/// The blocks where a state has them.
fn blocks<R: Solve>(scene: &Scene, state: &State<R>) -> Vec<Block> {
    let number = |value: R| Number::from_f64(value.to_f64()).expect("finite");
    let placed = scene.blocks.iter().zip(&state.blocks).map(|(shape, now)| {
        let vertices = now.vertices.iter().map(|v| Vec3::new(number(v.x), number(v.y), number(v.z)));
        shape.block.with_vertices(vertices.collect())
    });
    placed.collect()
}

/// What SPEC section 7 says of a state, pair by pair, whatever springs explain; where `closed_see`, contacts that the step left closed and that have h < 0 see an overlap too.
fn plainly<R: Solve>(
    scene: &Scene,
    set: &ToleranceSet,
    (precision, closed_see): (Precision, bool),
    state: &State<R>,
) -> StepAudit {
    let blocks = blocks(scene, state);
    let shapes: Vec<&Block> = blocks.iter().collect();
    let [rounding, floor] = [precision, Precision::F64].map(|precision| rounding_depth(&shapes, precision));
    let floor_squared = floor.times(&floor).to_rational();
    let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
    let auditor = Auditor::new(&prepared, set);
    let (mut found, mut most) = (StepAudit::default(), BigRational::default());
    for pair in auditor.neighbours() {
        if pair.iter().all(|&block| scene.blocks[block].body.is_fixed()) {
            continue;
        }
        let closed = state.contacts.iter().filter(|c| c.blocks.map(|b| b as usize) == pair && c.mode.is_closed());
        let closed: Vec<_> = closed.collect();
        let kept: Vec<ContactKey> = closed.iter().map(|contact| contact.key()).collect();
        let Some(overlap) = auditor.pair_with_kept(pair, &kept).overlap else { continue };
        let depth = PairDepth { blocks: pair, depth_m: overlap.penetration.depth_m().expect("a depth") };
        let [a, b] = pair.map(|block| &prepared[block]);
        let is_pressed =
            closed_see && closed.iter().any(|contact| Pair::new(a, b).gap(&contact.entrance()).sign.is_negative());
        if overlap.is_unseen(&rounding) && !is_pressed {
            found.unseen.push(depth);
        }
        if overlap.depth_squared() > floor_squared && overlap.depth_squared() > most {
            (most, found.deepest) = (overlap.depth_squared(), Some(depth));
        }
    }
    found.is_deep = most > set.penetration.times(&set.penetration).to_rational();
    found
}

/// Steps with an overlap, with an unseen one that is objected to, and with one that springs explain, of a scene; the audit of each is the plain one.
fn compared<R: Solve>(file: &str, about: (Precision, AuditScope), steps: usize) -> [usize; 3] {
    compared_with::<R>(file, about, steps, |_| {})
}

/// The same with other tolerances.
fn compared_with<R: Solve>(
    file: &str,
    (precision, scope): (Precision, AuditScope),
    steps: usize,
    change: impl Fn(&mut ToleranceSet),
) -> [usize; 3] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(file);
    let mut scene = Scene::load(path.to_str().expect("text")).expect("a scene");
    let mut set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), precision).expect("a set");
    change(&mut set);
    scene.derive_stiffness(&set);
    let dynamics = Dynamics::<R, SpecRules>::new(&scene, &set).expect("a beginning");
    let mut run = AuditedRun::new(Box::new(dynamics), &scene, &set, (precision, scope)).expect("a run");
    let mut reached = [0; 3];
    for step in 0..steps {
        run.step().expect("a step");
        let audit = run.audit().expect("an audit");
        reached[0] += usize::from(audit.deepest.is_some());
        reached[1] += usize::from(!audit.unseen.is_empty());
        reached[2] += usize::from(!audit.explained.is_empty());
        let mut unseen = [audit.unseen, audit.explained].concat();
        unseen.sort_by_key(|pair| pair.blocks);
        // False entrances are no matter of overlaps: tests/commands/false_entrances.rs.
        let audit = StepAudit { unseen, explained: Vec::new(), false_entrances: Vec::new(), passages: None, ..audit };
        let closed_see = scope == AuditScope::Overlaps;
        assert_eq!(audit, plainly(&scene, &set, (precision, closed_see), run.state()), "{file}, step {step}");
    }
    reached
}

#[test]
fn what_f64_leaves_out_changes_no_audit() {
    let mut reached = [0; 2];
    for (file, steps) in [
        ("handmade/slope_failure.toml", 60),
        ("handmade/bricks_in_a_bin.toml", 90),
        ("handmade/brick_in_a_notch.toml", 60),
        ("handmade/stack_of_10.toml", 20),
        ("real/slope_joints.dda", 2),
    ] {
        let [overlapping, unseen, _] = compared::<f64>(file, (Precision::F64, AuditScope::Overlaps), steps);
        assert!(overlapping > 0, "{file}: nothing overlaps");
        reached = [reached[0] + overlapping, reached[1] + unseen];
    }
    let [overlapping, unseen, _] =
        compared::<f32>("handmade/slope_failure.toml", (Precision::F32, AuditScope::Overlaps), 40);
    assert!(overlapping > 0 && reached[0] > 80 && reached[1] + unseen > 0, "{reached:?} {overlapping} {unseen}");
}

/// With passages the classification alone says what contacts see: in this scene it loses a contact for a step that a closed one hides. Others hold both blocks, so
/// that this is no more than springs yield, but under a `penetration` of which it is more than a thousandth.
#[test]
fn the_full_audit_asks_the_classification_alone() {
    let told = |scope, penetration: f64| {
        let change = |set: &mut ToleranceSet| set.penetration = Number::from_f64(penetration).expect("a number");
        let [_, unseen, explained] =
            compared_with::<f64>("handmade/slope_failure.toml", (Precision::F64, scope), 24, change);
        [unseen, explained].map(|steps| steps > 0)
    };
    assert_eq!(told(AuditScope::Overlaps, 2e-4), [false, false]);
    assert_eq!(told(AuditScope::OverlapsAndPassages, 2e-4), [true, false]);
    assert_eq!(told(AuditScope::OverlapsAndPassages, 2e-3), [false, true]);
}

/// States one after the other, whatever a stepper would make of them.
struct Given {
    states: Vec<State<f64>>,
    now: usize,
}

impl Stepping<f64> for Given {
    fn step(&mut self) -> Result<StepReport, StepError> {
        self.now += 1;
        Ok(StepReport {
            step: self.now as i64,
            time: 0.01,
            time_step: 0.01,
            iterations: 1,
            converged: true,
            friction_left: 0.0,
            retries: Vec::new(),
            contacts: [[0; 3]; 6],
            max_penetration: 0.0,
            max_displacement: 0.0,
            kinetic: 0.0,
            gravitational: 0.0,
            elastic: 0.0,
            springs: 0.0,
        })
    }

    fn state(&self) -> &State<f64> {
        &self.states[self.now]
    }
}

/// A roof (1), ridge up, under one (2) with its ridge down, the ridges crossing at so small an angle that no contact is made of them, and blocks beside (0) and above (3)
/// both that touch neither.
const ROOFS: &str = r#"
[simulation]
gravity = [0, 0, -10]
time_step = "1/400"

[tolerances]
preset = "auto"
criteria = "classic"

[[block]]
box = { min = [-5, -1, -1], max = [-4, 1, 1] }

[[block]]
vertices = [[-1, -0.5, 0], [1, -0.5, 0], [1, 0.5, 0], [-1, 0.5, 0], [-1, 0, 0.5], [1, 0, 0.5]]
faces = [[0, 3, 2, 1], [0, 1, 5, 4], [2, 3, 4, 5], [0, 4, 3], [1, 2, 5]]

[[block]]
vertices = [[-1, -0.52, 2], [1, -0.48, 2], [1, 0.52, 2], [-1, 0.48, 2], [-1, -0.02, 0.5], [1, 0.02, 0.5]]
faces = [[1, 2, 3, 0], [4, 5, 1, 0], [5, 4, 3, 2], [3, 4, 0], [5, 2, 1]]

[[block]]
box = { min = [-1, -1, 4], max = [1, 1, 5] }
"#;

/// A contact of two blocks with a gap in µm, closed where it is negative, that pushes the first along a normal.
fn contact(blocks: [u32; 2], [x, y, z]: [f64; 3], micrometres: f64) -> ContactState<f64> {
    let zero = Vector::new(0.0, 0.0, 0.0);
    ContactState {
        blocks,
        contact: Contact {
            key: ContactKey::of_kind(ContactKind::VertexFace, [0, 0]),
            entrance: Entrance::of_kind(EntranceKind::VertexFace, [0, 0]),
            gap: Sign::of_ordering(micrometres.total_cmp(&0.0)),
        },
        mode: if micrometres < 0.0 { Mode::Locked } else { Mode::Open },
        anchors: [zero; 2],
        gap: micrometres * 1e-6,
        normal: Vector::new(x, y, z),
        points: [zero; 2],
        force: zero,
    }
}

/// The roofs with a `penetration` (m), and where they touch.
fn roofs(penetration: f64) -> (Scene, ToleranceSet, State<f64>) {
    let mut scene = Scene::parse(ROOFS, SceneFormat::Toml, Path::new("roofs.toml")).expect("a scene");
    let tolerances = scene.tolerances.clone().expect("tolerances");
    let mut set = tolerances.derive(&scene.shapes(), Precision::F64).expect("a set");
    set.penetration = Number::from_f64(penetration).expect("a number");
    scene.derive_stiffness(&set);
    let state = Dynamics::<f64, SpecRules>::new(&scene, &set).expect("a beginning").state().clone();
    (scene, set, state)
}

/// The roofs so deep in one another (µm), with other contacts.
fn so_deep(touching: &State<f64>, deep: f64, contacts: &[ContactState<f64>]) -> State<f64> {
    let mut state = State { contacts: contacts.to_vec(), ..touching.clone() };
    state.blocks[2].vertices.iter_mut().for_each(|v| v.z -= deep * 1e-6);
    state
}

const SCOPE: AuditScope = AuditScope::OverlapsAndPassages;

/// Whether springs explain that the roofs are so deep in one another (µm), under a `penetration` (m) and with other contacts.
fn is_explained(deep: f64, penetration: f64, contacts: &[ContactState<f64>]) -> bool {
    let (scene, set, touching) = roofs(penetration);
    let states = vec![so_deep(&touching, deep, contacts); 2];
    let mut run =
        AuditedRun::new(Box::new(Given { states, now: 0 }), &scene, &set, (Precision::F64, SCOPE)).expect("a run");
    run.step().expect("a step");
    let StepAudit { unseen, explained, .. } = run.audit().expect("an audit");
    let (told, is_explained) = if explained.is_empty() { (unseen, false) } else { (explained, unseen.is_empty()) };
    assert!(told.len() == 1 && told[0].blocks == [1, 2], "{deep} µm: {told:?}");
    // The ridges are horizontal, so the way out is vertical and as long as they are deep.
    assert!((told[0].depth_m - deep * 1e-6).abs() < 1e-15, "{deep} µm: {told:?}");
    is_explained
}

/// What the roofs touch beside one another: the lower one is pressed into the block beside it, the upper one into the block above it (µm), and others push them out, down and up, by
/// contacts with these normals (from the roof's side) and gaps (µm).
fn held(pressed: [f64; 2], [(low, low_gap), (high, high_gap)]: [([f64; 3], f64); 2]) -> [ContactState<f64>; 4] {
    let [low_pressed, high_pressed] = pressed.map(|micrometres| -micrometres);
    [
        contact([0, 1], [0.0, 0.0, -1.0], low_pressed),
        contact([2, 3], [0.0, 0.0, -1.0], high_pressed),
        contact([1, 3], low, low_gap),
        // The upper roof is the second block here, so that it is pushed against the normal.
        contact([0, 2], high.map(|c| -c), high_gap),
    ]
}

const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// The limits by hand. The lower roof is 2 m long, 1 m wide, 0.5 m high: its volume is ½·1·0.5·2 = 0.5 m³, the square of its box's diagonal 4 + 1 + 0.25 = 5.25 m²; nowhere is it
/// thinner than 0.5/5.25 = 0.095238 m, and a thousandth of half of that is 47.619 µm. Of the upper one it is 1.5/(2·1000·(4 + 1.0816 + 2.25)) m = 102.3 µm.
#[test]
fn springs_explain_no_more_than_the_least_of_their_limits() {
    let pushed = [(DOWN, 10.0), (UP, 10.0)];
    for (pressed, penetration, below, above) in [
        // A tenth of 200 µm, of the lower roof or of the upper one; penetration allows 1 mm, the thickness 47.6 µm.
        ([200.0, 300.0], 1.0, 19.9, 20.1),
        ([300.0, 200.0], 1.0, 19.9, 20.1),
        // A thousandth of 3 cm; what they are pressed allows 100 µm.
        ([1000.0, 1000.0], 0.03, 29.9, 30.1),
        // The thickness of the lower roof.
        ([1000.0, 1000.0], 1.0, 47.61, 47.63),
    ] {
        let contacts = held(pressed, pushed);
        assert!(is_explained(below, penetration, &contacts), "{pressed:?} {penetration} {below}");
        assert!(!is_explained(above, penetration, &contacts), "{pressed:?} {penetration} {above}");
    }
    for pressed in [[0.0, 300.0], [300.0, 0.0], [-300.0, 300.0], [300.0, -300.0]] {
        assert!(!is_explained(0.01, 1.0, &held(pressed, pushed)), "{pressed:?}");
    }
    // The deepest contact of a block counts, if it is closed, and none of the two with one another.
    let with = |pressed: [f64; 2], blocks: [u32; 2], mode: Mode, first: bool| {
        let other = ContactState { mode, ..contact(blocks, DOWN, -200.0) };
        let held = held(pressed, pushed);
        if first { [&[other][..], &held].concat() } else { [&held[..], &[other]].concat() }
    };
    for first in [false, true] {
        assert!(is_explained(19.9, 1.0, &with([100.0, 200.0], [0, 1], Mode::Sliding, first)));
        assert!(!is_explained(20.1, 1.0, &with([100.0, 200.0], [0, 1], Mode::Sliding, first)));
        assert!(!is_explained(10.1, 1.0, &with([100.0, 200.0], [0, 1], Mode::Open, first)));
        assert!(!is_explained(10.1, 1.0, &with([100.0, 200.0], [1, 2], Mode::Open, first)));
        assert!(!is_explained(10.1, 1.0, &with([100.0, 200.0], [1, 2], Mode::Locked, first)));
    }
}

/// Both roofs are pressed by 200 µm, so that 20 µm are the limit.
#[test]
fn springs_explain_nothing_unless_others_push_both_blocks_out() {
    let is_explained = |low, high| is_explained(10.0, 1.0, &held([200.0, 200.0], [low, high]));
    // No further open than the limit; the cosine of 60° is 0.5, those of these normals are 33/65 = 0.508 and 8/17 = 0.471.
    let steep = [56.0 / 65.0, 0.0, 33.0 / 65.0];
    let flat = [15.0 / 17.0, 0.0, 8.0 / 17.0];
    let down = |[x, y, z]: [f64; 3]| [x, y, -z];
    for (normal, gap, expected) in [(UP, 19.9, true), (UP, 20.1, false), (steep, 10.0, true), (flat, 10.0, false)] {
        assert_eq!(is_explained((down(normal), gap), (UP, 10.0)), expected, "lower: {normal:?} {gap}");
        assert_eq!(is_explained((DOWN, 10.0), (normal, gap)), expected, "upper: {normal:?} {gap}");
    }
    // Pushed the other way, deeper into one another.
    assert!(!is_explained((UP, 10.0), (UP, 10.0)) && !is_explained((DOWN, 10.0), (DOWN, 10.0)));
}
