use super::*;
use crate::wide::{Wide, count_unsettled};
use rayon::ThreadPoolBuilder;
use rockproof_model::{Block, Motion, Number, Precision, SceneBlock, ToleranceSpec, Vec3};

fn number(value: f64) -> Number {
    Number::from_f64(value).expect("finite")
}

/// A fixed floor, a cube that strikes it aslant, and another on that.
fn falling() -> (Scene, ToleranceSet) {
    let cuboid = |low: [f64; 3], high: [f64; 3]| {
        let at = |[x, y, z]: [f64; 3]| Vec3::new(number(x), number(y), number(z));
        SceneBlock::new("block", Block::cuboid(&at(low), &at(high)).expect("a block"))
    };
    let blocks = vec![
        cuboid([-2.0, -2.0, -1.0], [4.0, 4.0, 0.0]),
        cuboid([0.0, 0.0, 0.0], [1.0, 1.0, 1.0]),
        cuboid([0.25, 0.25, 1.0], [1.25, 1.25, 2.0]),
    ];
    let mut scene = Scene { blocks, ..Scene::default() };
    scene.blocks[0].body.motion = Motion::Fixed;
    scene.blocks[1].body.motion = Motion::Rigid;
    scene.blocks[2].body.motion = Motion::Deformable;
    for block in &mut scene.blocks[1..] {
        block.body.velocity = Vec3::new(number(2.0), number(1.0), number(-1.0));
    }
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("tolerances");
    let set = ToleranceSet { max_displacement: number(1e6), ..set }.rounded(Precision::F64).expect("numbers of f64");
    scene.derive_stiffness(&set);
    (scene, set)
}

#[test]
fn what_two_f64_decide_is_what_512_bits_do() {
    // What is unsettled counts where it is found.
    let alone = ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    // Pairs are asked in two f64 first, or at once in 512 bits, together or one by one.
    for (waiting, at_once) in [(&[][..], PAIRS_AT_ONCE), (&[[0, 1], [1, 2]], PAIRS_AT_ONCE), (&[[0, 1], [1, 2]], 1)] {
        alone.install(|| compare_steps(waiting, at_once));
    }
}

fn compare_steps(waiting: &[[u32; 2]], pairs_at_once: usize) {
    let (scene, set) = falling();
    let mut in_double = DoubleSteps::begin(&scene, &set).expect("nothing is left open");
    in_double.pairs_at_once = pairs_at_once;
    let mut in_f64 = Dynamics::<f64>::new(&scene, &set).expect("a scene");
    let mut wide = Dynamics::<Wide>::new(&scene, &set).expect("a scene");
    let (mut made, mut with_contacts) = (0, 0);
    for step in 0..6 {
        let state = in_f64.state().clone();
        in_double.waits.extend(waiting.iter().map(|&pair| (pair, Wait { steps: 1, left: 1 })));
        let found = in_double.decide(&state, &set).expect("its blocks are known");
        assert!(waiting.iter().all(|pair| in_double.waits[pair].left == 0), "step {step}");
        wide.restore(state.in_scalar()).expect("the same scene");
        let (contacts, unsettled) = wide.filtered_contacts(&set).expect("a state of f64");
        assert_eq!(found.contacts.as_ref(), (unsettled == 0).then_some(&contacts), "step {step}");
        let (decided, besides) = count_unsettled(|| wide.decide_prescribed(&contacts));
        if let Some(of_double) = found.decided {
            assert_eq!((of_double, besides), (decided.expect("it can be made"), 0), "step {step}");
            assert_eq!(in_double.modes(), wide.modes(), "step {step}");
            made += 1;
        }
        with_contacts += usize::from(!contacts.is_empty());
        in_f64.step().expect("it can be made");
    }
    assert!(made >= 5 && with_contacts == 6, "{made} steps in two f64, {with_contacts} with contacts");
}

#[test]
fn a_pair_that_was_unsettled_before_is_asked_first_and_changes_nothing() {
    ThreadPoolBuilder::new().num_threads(1).build().expect("a pool").install(|| {
        let (scene, set) = falling();
        let mut in_f64 = Dynamics::<f64>::new(&scene, &set).expect("a scene");
        in_f64.step().expect("it can be made");
        let state = in_f64.state().clone();
        let decided = |unsettled: &[[u32; 2]]| {
            let mut in_double = DoubleSteps::begin(&scene, &set).expect("nothing is left open");
            in_double.unsettled = unsettled.to_vec();
            let found = in_double.decide(&state, &set).expect("its blocks are known");
            assert!(in_double.unsettled.is_empty(), "512 bits settle all");
            found
        };
        let first = decided(&[]);
        assert!(first.contacts.as_ref().is_some_and(|contacts| !contacts.is_empty()) && first.decided.is_some());
        // Pairs that are settled now, and one that is none of neighbours.
        let again = decided(&[[0, 1], [1, 2], [0, 9]]);
        assert_eq!((again.contacts, again.decided), (first.contacts, first.decided));
    });
}

#[test]
fn a_pair_that_stays_open_is_asked_ever_more_seldom() {
    let (scene, set) = falling();
    let mut in_double = DoubleSteps::begin(&scene, &set).expect("nothing is left open");
    let pair = [1, 2];
    let mut wait = None;
    for steps in [1, 2, 4, 8, 16, 16] {
        wait = Some(Wait::after(wait));
        assert!(matches!(wait, Some(Wait { steps: found, left }) if found == steps && left == steps));
    }
    in_double.waits.insert(pair, Wait { steps: 2, left: 2 });
    for left in [1, 0] {
        assert!(in_double.contacts_of_pair(pair).expect("a block").is_none());
        assert_eq!(in_double.waits[&pair].left, left);
    }
    let asked = in_double.contacts_of_pair(pair).expect("a block");
    // Found, it is asked at once in the next step; open, it waits for twice as many.
    match asked {
        Some(contacts) => assert!(!contacts.is_empty() && !in_double.waits.contains_key(&pair)),
        None => assert_eq!(in_double.waits[&pair].left, 4),
    }
}
