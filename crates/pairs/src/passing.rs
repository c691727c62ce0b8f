//! The family of pairs that make steps and nothing else: thin and small blocks fast enough to pass through another, or past its
//! corner, within one step, and others that just do not. Their blocks are not classified, so that no other pair of a seed
//! depends on them.

use crate::families::sampler::{apply, scaled};
use crate::families::{CoordinateStyle, PairSampler};
use crate::perturbation;
use crate::shapes::lattice_solid::{Units, number_of};
use crate::shapes::{LatticeSolid, RationalRotation};
use crate::tolerance_sets::{SetSource, binary_below, number, size};
use crate::{directed, motion};
use rand_chacha::ChaCha8Rng;
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::Subject;
use rockproof_model::simulation::Simulation;
use rockproof_model::{Block, Body, Motion, Number, Vec3};

/// The name of the family.
pub const PASSAGE: &str = "passage";

/// The sets of its pairs, where none are asked for: u so small that Δt is cut; u of eight times the shortest edge, which a step may pass
/// through, with s ≥ 2u, without, and with territories of that size.
pub const SETS: [&str; 4] = [
    "auto",
    "auto@max_displacement*128@search*128",
    "auto@max_displacement*128",
    "auto@max_displacement*128@search*128@criteria=classic",
];

/// What a pair is made to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// A thin plate, edge first, through another.
    Blade,
    /// A needle lengthwise through a plate, or across another needle.
    Needle,
    /// A small block through a slab.
    Pebble,
    /// An edge of a block past an edge of another.
    Corner,
}

impl Form {
    const ALL: [Form; 4] = [Form::Blade, Form::Needle, Form::Pebble, Form::Corner];

    fn name(self) -> &'static str {
        match self {
            Form::Blade => "blade",
            Form::Needle => "needle",
            Form::Pebble => "pebble",
            Form::Corner => "corner",
        }
    }
}

/// The pair of one index, if it is among the one in `every` that the family has there; a function of seed and index alone.
pub fn pair(seed: u64, index: u64, every: u64, steps: u32, sets: &[SetSource]) -> Option<(Subject, PairMotion)> {
    let mut rng = motion::keyed(*b"rockproof passage, version 1....", seed, index);
    if !motion::moves(&mut rng, every) {
        return None;
    }
    let Thrown { form, a, b, motion } = thrown(&mut rng, steps);
    let sets = sets.iter().filter_map(|set| set.derive(&a, &b)).collect();
    Some((Subject { index, family: PASSAGE.into(), form: form.name().into(), a, b, sets }, motion))
}

/// Two blocks and how they move.
struct Thrown {
    form: Form,
    a: Block,
    b: Block,
    motion: PairMotion,
}

/// Two solids on one lattice, and the way of B against A within the step, in lattice units.
struct Aimed {
    a: LatticeSolid,
    b: LatticeSolid,
    way: Units,
}

fn thrown(rng: &mut ChaCha8Rng, steps: u32) -> Thrown {
    let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
    let style = *sampler.pick(&[CoordinateStyle::Grid, CoordinateStyle::Grid, CoordinateStyle::Rounded]);
    let mut sampler = PairSampler::with_style(rng, style);
    let form = *sampler.pick(&Form::ALL);
    let aimed = aimed(&mut sampler, form);
    let aimed = turned(&mut sampler, aimed);
    let denominator = aimed.a.denominator();
    let (a, b) = (aimed.a.block(0), aimed.b.block(0));
    let b = if sampler.chance(50) { perturbation::perturbed(&mut sampler, &b, directed::magnitude(&a, &b)) } else { b };
    let motion = thrown_at(&mut sampler, [&a, &b], aimed.way.map(|c| number_of(c, denominator, 0)), steps);
    Thrown { form, a, b, motion }
}

/// The pair near the origin, B above A or beside it.
///
/// Lengths are multiples of the shortest edge e, g is e/16 by [`SETS`], and a way is 8e at most.
fn aimed(sampler: &mut PairSampler<'_>, form: Form) -> Aimed {
    let e = sampler.length(1, 4);
    let wide = e * sampler.between(14, 24);
    let needle = if sampler.chance(30) { e } else { wide };
    let mut times = |low, high| e * sampler.between(low, high);
    let (a, b) = match form {
        Form::Blade => ([wide, wide, e], [times(3, 12), e, times(2, 4)]),
        Form::Needle => ([wide, needle, e], [e, times(1, 8), times(1, 4)]),
        Form::Pebble => ([wide, wide, times(1, 3)], [times(1, 2), e, times(1, 2)]),
        Form::Corner => ([wide, wide, times(4, 8)], [times(1, 3), e, times(1, 3)]),
    };
    let (a, b) = (sampler.shape("cuboid", a), sampler.shape("cuboid", b));
    let b = if sampler.chance(15) { sampler.tipped(&b) } else { b };
    let (a, b) = LatticeSolid::on_one_lattice(&a, &b);
    let unit = a.denominator() / sampler.denominator();
    let setup = PassageSetup { a: &a, b: &b, unit, g: e / 16 * unit, e: e * unit };
    let (offset, way) = if form == Form::Corner { setup.past(sampler) } else { setup.through(sampler) };
    let b = b.moved(offset);
    Aimed { a, b, way }
}

/// Where B is put, and where it goes; in lattice units.
struct PassageSetup<'s> {
    a: &'s LatticeSolid,
    b: &'s LatticeSolid,
    /// Lattice units in one of the kit's.
    unit: i128,
    g: i128,
    e: i128,
}

impl PassageSetup<'_> {
    /// Down through A, B from above it: beyond A, just or well; into it; or not as far. B's side may miss A by as much, so that B just
    /// slips by.
    fn through(&self, sampler: &mut PairSampler<'_>) -> (Units, Units) {
        let PassageSetup { a, b, unit, g, e } = *self;
        let (top, bottom) = (a.extent(2).1, a.extent(2).0);
        let (low, high) = b.extent(2);
        let gap = *sampler.pick(&[0, g / 2, g, 4 * g, e]);
        let fall = match sampler.below(8) {
            0 => gap + *sampler.pick(&[-unit, 0, unit, g, g + unit]),
            1 => gap + (top - bottom) / 2,
            2 => gap + (top - bottom) + (high - low) + *sampler.pick(&[-g - unit, -g, -g + unit, 0]),
            _ => gap + (top - bottom) + (high - low) + *sampler.pick(&[g, 4 * g, e / 2]),
        };
        let across = |sampler: &mut PairSampler<'_>, axis: usize| {
            let ((near, far), (from, to)) = (a.extent(axis), b.extent(axis));
            match sampler.below(4) {
                // Beside A, or over it by about g.
                0 => far - from - *sampler.pick(&[-unit, 0, unit, g - unit, g, g + unit, 2 * g]),
                _ => (near + far) / 2 - (from + to) / 2 + unit * sampler.between(-e / unit, e / unit),
            }
        };
        let offset = [across(sampler, 0), across(sampler, 1), top + gap - low];
        let along = if sampler.chance(25) { e / 2 * sampler.sign() } else { 0 };
        (offset, [along, 0, -fall])
    }

    /// Past the edge of A where its faces +x and +z meet: half way B's own edge is by some depth below both.
    fn past(&self, sampler: &mut PairSampler<'_>) -> (Units, Units) {
        let PassageSetup { a, b, unit, g, e } = *self;
        let depth = *sampler.pick(&[-unit, 0, unit, g - unit, g, g + unit, 2 * g, 3 * g]);
        let half = *sampler.pick(&[4 * g, e / 2, e, 2 * e]);
        let (near, far) = a.extent(1);
        let along = near - b.extent(1).0 + unit * sampler.between(0, (far - near) / unit);
        let to = |axis: usize, by: i128| a.extent(axis).1 - b.extent(axis).0 + by;
        ([to(0, -half - depth), along, to(2, half - depth)], [2 * half, 0, -2 * half])
    }
}

/// Turns the whole pair, and moves it.
fn turned(sampler: &mut PairSampler<'_>, Aimed { a, b, way }: Aimed) -> Aimed {
    let cube = crate::shapes::rotation::cube_turn(sampler.below(24) as u32);
    let (mut a, mut b, mut way) = (a.mapped(&cube, 1), b.mapped(&cube, 1), apply(&cube, way));
    if sampler.chance(25) {
        let (q, r) = (sampler.between(-2, 2) as i64, sampler.between(-2, 2) as i64);
        let turn = RationalRotation::from_quaternion([2, q, r, 1]);
        (a, b, way) = (sampler.turned_by(&a, turn), sampler.turned_by(&b, turn), apply(&turn.matrix, way));
    }
    if sampler.chance(50) {
        let offset = scaled(sampler.lengths(-64, 64), a.denominator() / sampler.denominator());
        (a, b) = (a.moved(offset), b.moved(offset));
    }
    Aimed { a, b, way }
}

/// The motion that takes B that way (m) against A in one full Δt: B alone, or both half of it.
fn thrown_at(sampler: &mut PairSampler<'_>, blocks: [&Block; 2], way: [Number; 3], steps: u32) -> PairMotion {
    let rate = 1i32 << sampler.between(4, 8);
    let mut simulation = Simulation::default();
    let still = || Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO);
    simulation.control.time_step = number(1.0 / f64::from(rate));
    simulation.gravity = still();
    let times = |factor: f64| {
        let [x, y, z] = way.each_ref().map(|c| c.times(&number(factor * f64::from(rate))));
        Vec3::new(x, y, z)
    };
    let mut bodies = [Body::default(), Body::default()];
    bodies.iter_mut().for_each(|body| body.motion = Motion::Rigid);
    match sampler.below(4) {
        0 => (bodies[0].velocity, bodies[1].velocity) = (times(-0.5), times(0.5)),
        1 => bodies[1].velocity = times(1.0),
        _ => (bodies[0].motion, bodies[1].velocity) = (Motion::Fixed, times(1.0)),
    }
    if sampler.chance(20) {
        bodies[1].motion = Motion::Deformable;
    }
    if sampler.chance(20) {
        let small = size(blocks[1]).0 / 64.0 * f64::from(rate) * f64::from(rate);
        simulation.gravity.z = number(-binary_below(small));
    }
    let material = &mut simulation.materials[0];
    (material.density, material.young, material.poisson) = (number(2048.0), number(1e10), number(0.25));
    let mass = 2048.0 * Number::from_rational(blocks[1].volume()).approximate();
    let inertia = binary_below(2.0 * mass * f64::from(rate) * f64::from(rate));
    let joint = &mut simulation.joints.other;
    joint.normal_stiffness = Some(number(inertia * *sampler.pick(&[0.015625, 64.0, 4096.0, 65536.0])));
    joint.shear_ratio = number(0.5);
    joint.friction = number(*sampler.pick(&[0.0, 0.5]));
    PairMotion { bodies, simulation, steps }
}
