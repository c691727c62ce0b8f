//! Implementations against each other in steps of small scenes.

use crate::input::SceneInput;
use crate::reach::Reach;
use num_rational::BigRational;
use rockproof_differential::lockstep::wide::WideStepper;
use rockproof_differential::lockstep::{ExactScene, StepDecisions, compare};
use rockproof_model::{Block, Contact, Number, Precision};
use rockproof_oracle::plain;
use rockproof_oracle::step::{EnclosedStep, KeptPrecision, State, StepAnswer, StepFailure};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::Dynamics;

/// Of a state whose coordinates have longer fractions, in bits, no further step is made: one took minutes in fractions, where most take a tenth of a
/// second.
const LONGEST_FRACTION: u64 = 1_000;

/// The certified step against the step in fractions, the plain classification and the stepper in 512 bits.
pub(crate) fn step(bytes: &[u8], reach: &mut Reach) {
    let Some(input) = SceneInput::of(bytes) else { return reach.count("no-scene") };
    let Ok(scene) = ExactScene::new(&input.scene, &input.tolerances).rounded(Precision::F64) else {
        return reach.count("overflow");
    };
    let mut state = scene.begin();
    for number in 0..input.steps {
        if number > 0 && longest_fraction(&state) > LONGEST_FRACTION {
            return reach.count("long-fractions");
        }
        let (certified, exact) = (scene.enclose(&state), scene.step(&state, KeptPrecision::Exact));
        if number == 0 {
            in_512_bits(&scene, &exact, reach);
        }
        let (certified, exact) = match (certified, exact) {
            (Ok(certified), Ok(exact)) => (certified, exact),
            (_, Err(StepFailure::NotKept { .. })) => return reach.count("not-kept"),
            (Err(one), Err(other)) => {
                assert_eq!(one, other, "certified (left), in fractions (right): {input:?}");
                return reach.count(format!("failure-{}", Reach::variant(&one)));
            }
            (one, other) => panic!("certified {:?}, in fractions {:?}: {input:?}", one.err(), other.err()),
        };
        let shapes = scene.scene().shapes();
        let differences =
            compare(&StepDecisions::of_oracle(&exact), &StepDecisions::of_certified(&certified.decided), &shapes);
        assert!(differences.is_empty(), "{differences:?}: {input:?}");
        if state.contacts.is_empty() {
            assert_eq!(exact.contacts, plain_contacts(&scene, &state), "the step (left), plain (right): {input:?}");
        }
        enclosed(&certified, &state, &exact, &scene, reach);
        reach.count("step");
        reach.add("contacts", exact.contacts.len() as u64);
        reach.add("cuts", exact.retries.len() as u64);
        reach.add("solves", u64::from(exact.iterations));
        exact.modes.iter().flatten().for_each(|mode| reach.count(format!("mode-{mode:?}").to_lowercase()));
        let levels = exact.levels;
        let settled = [("float", levels.float), ("double", levels.double), ("exact", levels.exact)];
        settled.into_iter().for_each(|(level, count)| reach.add(format!("level-{level}"), count));
        reach.add("level-wide", levels.wide.iter().sum());
        state = exact.state;
    }
}

/// The bits of the longest fraction among the coordinates of a state, above and below its line.
fn longest_fraction(state: &State) -> u64 {
    let vertices = state.blocks.iter().flat_map(|block| &block.vertices);
    let bits = |number: &Number| {
        let fraction = number.to_rational();
        fraction.numer().bits() + fraction.denom().bits()
    };
    vertices.flat_map(|vertex| vertex.components()).map(bits).max().unwrap_or(0)
}

/// The contacts of all pairs, in fractions.
fn plain_contacts(scene: &ExactScene, state: &State) -> Vec<([usize; 2], Contact)> {
    let blocks = scene.blocks_at(state);
    let is_fixed = |block: usize| scene.scene().blocks[block].body.is_fixed();
    let pairs = (0..blocks.len()).flat_map(|a| (a + 1..blocks.len()).map(move |b| [a, b]));
    let pairs = pairs.filter(|[a, b]| !is_fixed(*a) || !is_fixed(*b));
    let of_pair = |[a, b]: [usize; 2]| {
        let found = plain::classify::<BigRational>(&blocks[a], &blocks[b], scene.tolerances());
        found.into_iter().map(move |found| ([a, b], found.contact)).collect::<Vec<_>>()
    };
    pairs.flat_map(of_pair).collect()
}

/// The mean of a block's vertices, exactly.
fn mean(vertices: &[rockproof_model::Point]) -> [BigRational; 3] {
    let count = BigRational::from_integer((vertices.len() as u64).into());
    let sum = |axis: usize| vertices.iter().map(|v| v.components()[axis].to_rational()).sum::<BigRational>();
    [0, 1, 2].map(|axis| sum(axis) / &count)
}

/// The displacements that a certified step encloses hold those of the step in fractions. The mean of the vertices of a tetrahedron or a cuboid is its
/// centroid, which moves by the first three unknowns.
fn enclosed(certified: &EnclosedStep, before: &State, exact: &StepAnswer, scene: &ExactScene, reach: &mut Reach) {
    let Some(displacements) = &certified.displacements else { return reach.count("no-displacements") };
    for (number, block) in scene.scene().blocks.iter().enumerate() {
        if block.body.is_fixed() || !is_centred(&block.block) {
            continue;
        }
        let [from, to] = [before, &exact.state].map(|state| mean(&state.blocks[number].vertices));
        for axis in 0..3 {
            let [middle, radius] = displacements[number][axis].map(|value| {
                Number::from_f64(value).map_or_else(|_| panic!("an enclosure of {value}"), |n| n.to_rational())
            });
            let off = &to[axis] - &from[axis] - middle;
            assert!(off <= radius && -off <= radius, "block {number}, axis {axis} is not in its enclosure");
        }
        reach.count("enclosed");
    }
}

/// Whether the mean of the vertices is the centroid: of a tetrahedron, and of what is its own mirror image in a point.
fn is_centred(block: &Block) -> bool {
    let middle = mean(block.vertices());
    let two = BigRational::from_integer(2.into());
    let coordinates = |v: &rockproof_model::Point| v.components().map(Number::to_rational);
    let all: Vec<[BigRational; 3]> = block.vertices().iter().map(coordinates).collect();
    let mirrored = |v: &[BigRational; 3]| [0, 1, 2].map(|axis| &middle[axis] * &two - &v[axis]);
    block.vertices().len() == 4 || block.is_convex() && all.iter().all(|v| all.contains(&mirrored(v)))
}

/// The stepper in 512 bits, where no comparison is left unsettled.
fn in_512_bits(scene: &ExactScene, exact: &Result<StepAnswer, StepFailure>, reach: &mut Reach) {
    let Ok(begin) = Dynamics::<f64>::new(scene.scene(), scene.tolerances()) else { return reach.count("wide-setup") };
    let begin = begin.state().clone();
    let Ok(mut wide) = WideStepper::<SpecRules>::new(scene) else { return reach.count("wide-setup") };
    let made = wide.step(&begin).expect("the state is of the scene");
    if made.unsettled > 0 {
        return reach.count("wide-unsettled");
    }
    match (exact, made.outcome) {
        (Ok(exact), Ok((wide, _))) => {
            let shapes = scene.scene().shapes();
            let differences = compare(&StepDecisions::of_oracle(exact), &wide, &shapes);
            assert!(differences.is_empty(), "oracle, 512 bits: {differences:?}: {scene:?}");
            reach.count("wide-settled");
        }
        (Err(StepFailure::NotKept { .. }), _) => reach.count("wide-not-kept"),
        (Err(_), Err(_)) => reach.count("wide-failure"),
        (one, other) => panic!("oracle {:?}, 512 bits {:?}: {scene:?}", one.as_ref().err(), other.err()),
    }
}
