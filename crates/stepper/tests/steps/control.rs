//! Step control at its edges: limits that are just met, retries, the smallest Δt, and what is left when a run stops.

use crate::support::{begin, cube, floor, n, scene, tolerances, v, weightless};
use rockproof_model::scene::SceneBlock;
use rockproof_model::simulation::Unconverged;
use rockproof_model::{Block, BlockOptions, ContactKey, ContactKind, FaceId, Motion, Scene, ToleranceSet, VertexId};
use rockproof_stepper::Real;
use rockproof_stepper::contact::ContactRules;
use rockproof_stepper::dynamics::{
    ContactState, Dynamics, Mode, RetryReason, SetupError, StepError, StepReport, StepRules,
};

/// A cube that flies at this speed, with Δt = 1/128 s, so that a limit of 1/16 m is 8 m/s. Everything is a power of two, and exact.
fn flying(speed: &str) -> Scene {
    let mut scene = weightless(vec![cube()]);
    scene.simulation.materials[0].density = n("2048");
    scene.simulation.control.time_step = n("1/128");
    scene.blocks[0].body.velocity = v(speed, "0", "0");
    scene
}

fn first_step(scene: &Scene, set: &ToleranceSet) -> StepReport {
    Dynamics::<f64>::new(scene, set).unwrap().step().unwrap()
}

fn given_up(report: &StepReport) -> Vec<(RetryReason, f64)> {
    report.retries.iter().map(|retry| (retry.why, retry.time_step)).collect()
}

#[test]
fn a_displacement_of_just_the_limit_is_allowed() {
    let report = first_step(&flying("8"), &tolerances());
    assert_eq!((report.max_displacement, report.time_step), (0.0625, 1.0 / 128.0));
    assert!(report.retries.is_empty());
    let report = first_step(&flying("0x1.0000000000001p3"), &tolerances());
    assert_eq!(given_up(&report), [(RetryReason::Displacement, 1.0 / 128.0)]);
    assert_eq!(report.time_step, 1.0 / 256.0);
}

#[test]
fn a_step_is_halved_until_it_fits_and_the_next_begins_with_half_as_much_again() {
    // 60 m/s in 1/1024 s are 0.0586 m. 3/2048 s are too long, 3/4096 s not; 9/8192 s are too long, 9/16384 s not; 27/32768 s are not.
    let mut dynamics = begin::<f64>(&flying("60"));
    let full = 1.0 / 128.0;
    let expected: [(&[f64], f64); 4] = [
        (&[full, full / 2.0, full / 4.0], 1.0 / 1024.0),
        (&[3.0 / 2048.0], 3.0 / 4096.0),
        (&[9.0 / 8192.0], 9.0 / 16384.0),
        (&[], 27.0 / 32768.0),
    ];
    let mut time = 0.0;
    for (halved, accepted) in expected {
        let report = dynamics.step().unwrap();
        let halves: Vec<_> = halved.iter().map(|&time_step| (RetryReason::Displacement, time_step)).collect();
        assert_eq!((given_up(&report), report.time_step), (halves, accepted));
        time += accepted;
        assert_eq!((report.time, dynamics.state().last_time_step), (time, accepted));
    }
}

#[test]
fn time_steps_grow_back_to_the_full_one_and_no_further() {
    let mut dynamics = begin::<f64>(&flying("1"));
    let full = 1.0 / 128.0;
    assert_eq!(dynamics.state().last_time_step, full);
    let mut state = dynamics.state().clone();
    state.last_time_step = full / 4.0;
    dynamics.restore(state).unwrap();
    for part in [3.0 / 8.0, 9.0 / 16.0, 27.0 / 32.0, 1.0, 1.0] {
        assert_eq!(dynamics.step().unwrap().time_step, part * full);
    }
}

#[test]
fn settling_steps_hand_their_time_step_on() {
    // Static steps are gΔt²/2 long, with g = 8192 m/s²: 1/4 m, and 1/16 m when halved, which is allowed. Then 9/64 m with half as much again,
    // and half of that 9/256 m. Time begins with half as much again.
    let mut scene = flying("0");
    scene.simulation.gravity = v("0", "0", "-8192");
    scene.simulation.control.settle = 2;
    let mut dynamics = begin::<f64>(&scene);
    for (step, halved, accepted) in [(-1, 1.0 / 128.0, 1.0 / 256.0), (0, 3.0 / 512.0, 3.0 / 1024.0)] {
        let report = dynamics.step().unwrap();
        assert_eq!((report.step, report.time_step), (step, accepted));
        assert_eq!(given_up(&report), [(RetryReason::Displacement, halved)]);
    }
    assert_eq!(dynamics.step().unwrap().retries[0].time_step, 9.0 / 2048.0);
}

#[test]
fn a_rotation_of_just_the_limit_is_allowed() {
    // ω = 1/8 in 1/128 s is 16 rad/s. Vertices on a circle of 1/√2 m would move too far: the limit on displacement is lifted.
    let set = ToleranceSet { max_displacement: n("1"), ..tolerances() };
    let mut scene = flying("0");
    scene.blocks[0].body.spin = v("0", "0", "16");
    assert!(first_step(&scene, &set).retries.is_empty());
    scene.blocks[0].body.spin = v("0", "0", "20");
    assert_eq!(given_up(&first_step(&scene, &set)), [(RetryReason::Rotation, 1.0 / 128.0)]);
}

#[test]
fn below_the_smallest_step_the_run_stops_and_its_state_is_the_last_good_one() {
    let mut dynamics = begin::<f64>(&flying("100000"));
    let before = dynamics.state().clone();
    // A thousandth of Δt lies between its 512th and its 1024th part.
    let stopped =
        StepError::TooFast { step: 1, time_step: 1.0 / 128.0 / 512.0, block: 0, why: RetryReason::Displacement };
    assert_eq!(dynamics.step(), Err(stopped.clone()));
    assert_eq!(dynamics.state(), &before);
    // It stops there again.
    assert_eq!(dynamics.step(), Err(stopped));
    assert_eq!(dynamics.state(), &before);
}

/// One solve only.
#[derive(Clone, Copy, Debug)]
struct Hasty;

impl ContactRules for Hasty {}

impl StepRules for Hasty {
    fn changing_solves() -> u32 {
        1
    }
}

/// Friction never settles.
#[derive(Clone, Copy, Debug)]
struct Restless;

impl ContactRules for Restless {}

impl StepRules for Restless {
    fn settled<R: Real>(_: R, _: R) -> bool {
        false
    }
}

#[test]
fn the_seventh_solve_in_which_no_mode_changes_ends_the_iteration() {
    // A cube at rest on the floor stays locked; friction is what keeps the iteration from ending with the first solve.
    let mut dynamics: Dynamics<f64, Restless> =
        Dynamics::with_rules(&scene(vec![floor(), cube()]), &tolerances()).unwrap();
    let report = dynamics.step().unwrap();
    assert_eq!((report.iterations, report.converged), (7, true));
    assert!(report.retries.is_empty());
    // Up from the floor: in the first solve the contacts open, seven more change nothing.
    let mut flying = weightless(vec![floor(), cube()]);
    flying.blocks[1].body.velocity = v("0", "0", "1");
    let mut dynamics: Dynamics<f64, Restless> = Dynamics::with_rules(&flying, &tolerances()).unwrap();
    let report = dynamics.step().unwrap();
    assert_eq!((report.iterations, report.converged), (8, true));
}

/// Contacts that only lock or slide end an attempt as others do.
#[derive(Clone, Copy, Debug)]
struct AllChangesAlike;

impl ContactRules for AllChangesAlike {}

impl StepRules for AllChangesAlike {
    fn slipping_solves() -> u32 {
        Self::changing_solves()
    }
}

#[test]
fn contacts_that_only_lock_or_slide_have_twelve_solves() {
    let (_, scene, set) = crate::planted::locking_and_sliding();
    let solves = |dynamics: &[Vec<Vec<Mode>>]| dynamics.iter().map(Vec::len).collect::<Vec<_>>();
    let mut dynamics = Dynamics::<f64>::new(&scene, &set).unwrap();
    assert!(dynamics.step().unwrap().converged);
    assert_eq!(solves(dynamics.modes()), [9, 1]);
    let mut alike: Dynamics<f64, AllChangesAlike> = Dynamics::with_rules(&scene, &set).unwrap();
    alike.step().unwrap();
    assert!(solves(alike.modes())[0] < 9);
}

/// A cube that touches the floor and flies up: the contact begins locked, and the first solve opens it, whatever Δt.
fn leaving(unconverged: Unconverged) -> Dynamics<f64, Hasty> {
    let mut scene = weightless(vec![floor(), cube()]);
    scene.blocks[1].body.velocity = v("0", "0", "1");
    scene.simulation.control.unconverged = unconverged;
    Dynamics::with_rules(&scene, &tolerances()).unwrap()
}

/// Δt after this many cuts.
fn cut(times: usize) -> f64 {
    (0..times).fold(0.01, |time_step, _| time_step * 3.0 / 10.0)
}

#[test]
fn what_does_not_converge_is_cut_five_times_and_stops() {
    let mut dynamics = leaving(Unconverged::Stop);
    let before = dynamics.state().clone();
    let Err(StepError::NotConverged { step, time_step, contacts }) = dynamics.step() else { panic!("it went on") };
    // 0.3⁵ is 0.00243, 0.3⁶ is less than a thousandth.
    assert_eq!((step, time_step), (1, cut(5)));
    assert_eq!(contacts.len(), 4);
    assert!(contacts.iter().all(|c| (c.blocks, c.from, c.to) == ([0, 1], Mode::Locked, Mode::Open)), "{contacts:?}");
    assert_eq!(dynamics.state(), &before);
    let attempts: Vec<usize> = dynamics.modes().iter().map(Vec::len).collect();
    assert_eq!(attempts, [1; 6]);
}

#[test]
fn what_does_not_converge_can_be_accepted_and_is_marked() {
    let report = leaving(Unconverged::Accept).step().unwrap();
    assert!(!report.converged);
    let expected: Vec<_> = (0..5).map(|k| (RetryReason::NotConverged, cut(k))).collect();
    assert_eq!(given_up(&report), expected);
    assert_eq!(report.time_step, cut(5));
}

#[test]
fn what_is_accepted_unconverged_is_not_held_to_the_limits() {
    // Up at 6000 m/s: one solve never converges, so Δt falls to 0.0000243 s and the cube moves 0.146 m, more than u. SPEC asks for the limits
    // after convergence only.
    let mut scene = weightless(vec![floor(), cube()]);
    scene.simulation.control.unconverged = Unconverged::Accept;
    scene.blocks[1].body.velocity = v("0", "0", "6000");
    let limit = tolerances().max_displacement.approximate();
    let mut dynamics: Dynamics<f64, Hasty> = Dynamics::with_rules(&scene, &tolerances()).unwrap();
    let report = dynamics.step().unwrap();
    assert!(!report.converged && report.max_displacement > limit, "{report:?}");
    let expected: Vec<_> = (0..5).map(|k| (RetryReason::NotConverged, cut(k))).collect();
    assert_eq!(given_up(&report), expected);
}

#[test]
fn a_block_that_turns_inside_out_stops_the_run() {
    // A stress of a thousand times Young's modulus lets go: the strain of one step is beyond -1. Limits are lifted to let it happen.
    let set = ToleranceSet { max_displacement: n("1e6"), ..tolerances() };
    let mut scene = weightless(vec![cube()]);
    scene.blocks[0].body.motion = rockproof_model::Motion::Deformable;
    scene.simulation.materials[0].poisson = n("0");
    scene.blocks[0].body.stress = ["1e13", "0", "0", "0", "0", "0"].map(n);
    let mut dynamics: Dynamics<f64> = Dynamics::new(&scene, &set).unwrap();
    let before = dynamics.state().clone();
    let stopped = dynamics.step();
    assert!(matches!(stopped, Err(StepError::Inverted { step: 1, block: 0, volume }) if volume < 0.0), "{stopped:?}");
    assert_eq!(dynamics.state(), &before);
}

#[test]
fn settling_counts_up_to_zero_and_takes_no_time() {
    let mut scene = scene(vec![floor(), cube()]);
    scene.simulation.control.settle = 3;
    scene.blocks[1].body.velocity = v("1/2", "0", "0");
    let mut dynamics = begin::<f64>(&scene);
    let steps: Vec<(i64, f64)> = (0..5).map(|_| dynamics.step().unwrap()).map(|r| (r.step, r.time)).collect();
    assert_eq!(steps, [(-2, 0.0), (-1, 0.0), (0, 0.0), (1, 0.01), (2, 0.02)]);
}

/// A rigid block on its tip, which slides forward and sinks: its centroid stands before the tip and above it, so that friction at the tip
/// turns the block forward and lifts the tip.
fn tipped(friction: &str) -> Scene {
    let vertices = vec![v("0", "0", "1/1024"), v("1/4", "-1/2", "1"), v("3/2", "0", "1"), v("1/4", "1/2", "1")];
    let faces = vec![vec![0, 2, 1], vec![0, 3, 2], vec![0, 1, 3], vec![1, 2, 3]];
    let block = Block::new(vertices, faces, &BlockOptions::default()).unwrap();
    let mut tip = SceneBlock::new("tip", block);
    tip.body.motion = Motion::Rigid;
    tip.body.velocity = v("1", "0", "-1/2");
    let mut scene = weightless(vec![floor(), tip]);
    scene.simulation.control.time_step = n("1/128");
    scene.simulation.joints.other.friction = n(friction);
    scene
}

#[test]
fn friction_of_the_solve_before_makes_an_impact_open_and_close_for_ever() {
    // By hand (docs/step.md): moving freely the tip overlaps by 1/256 − 1/1024 m and slips 1/128 m, so it closes and slides. The friction
    // of that overlap lifts it, so it opens; and then it moves freely again.
    let mut dynamics = begin::<f64>(&tipped("3/5"));
    let report = dynamics.step().unwrap();
    assert_eq!(given_up(&report)[0], (RetryReason::NotConverged, 1.0 / 128.0));
    let modes: Vec<Mode> = dynamics.modes()[0].iter().map(|all| all[0]).collect();
    use Mode::{Open, Sliding};
    assert_eq!(modes, [Sliding, Open, Sliding, Open, Sliding, Open]);
    // Without friction the overlap that is left keeps it closed.
    let mut dynamics = begin::<f64>(&tipped("0"));
    let report = dynamics.step().unwrap();
    assert!(report.retries.is_empty() && report.iterations == 2, "{report:?}");
    assert_eq!(dynamics.state().contacts[0].mode, Sliding);
}

#[test]
fn a_state_with_a_contact_that_the_scene_cannot_have_is_refused() {
    let mut dynamics = begin::<f64>(&scene(vec![floor(), cube()]));
    dynamics.step().unwrap();
    let good = dynamics.state().clone();
    assert_eq!(good.contacts[3].contact.kind(), ContactKind::FaceVertex);
    let wrong: [fn(&mut ContactState<f64>); 4] = [
        |contact| contact.blocks = [0, 2],
        |contact| contact.blocks = [1, 0],
        |contact| contact.contact.key = ContactKey::FaceVertex(FaceId(6), VertexId(0)),
        |contact| contact.contact.key = ContactKey::FaceVertex(FaceId(0), VertexId(8)),
    ];
    for change in wrong {
        let mut state = good.clone();
        change(&mut state.contacts[3]);
        assert_eq!(dynamics.restore(state), Err(SetupError::NoSuchContact { contact: 3 }));
    }
    assert_eq!(dynamics.restore(good), Ok(()));
}
