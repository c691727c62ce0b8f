//! The audit of steps, which leaves most pairs to f64, against a plain one: every neighbouring pair classified exactly and measured exactly after
//! every step.

use num_rational::BigRational;
use rockproof_examine::AuditedRun;
use rockproof_model::{Block, ContactKey, Number, Precision, Scene, ToleranceSet, Vec3};
use rockproof_oracle::audit::{Auditor, rounding_depth};
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_simulate::{AuditScope, PairDepth, StepAudit, Stepping};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Dynamics, Solve, State};
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

/// What SPEC section 7 says of a state, pair by pair; where `closed_see`, contacts that the step left closed and that have h < 0 see an overlap too.
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
        let yields = depth.depth_m
            < limit_of_yielding(set, state, (pair, [a.block(), b.block()]), overlap.penetration.way_out());
        if overlap.is_unseen(&rounding) && !is_pressed {
            if yields { found.explained.push(depth) } else { found.unseen.push(depth) }
        }
        if overlap.depth_squared() > floor_squared && overlap.depth_squared() > most {
            (most, found.deepest) = (overlap.depth_squared(), Some(depth));
        }
    }
    found.is_deep = most > set.penetration.times(&set.penetration).to_rational();
    found
}

/// Less deep is an unseen overlap of convex blocks that springs yield: a tenth of what both are pressed into others, a thousandth of g and of half of what neither is
/// thinner than, where each has a contact with another block, no further open, that pushes it out; else nothing.
fn limit_of_yielding<R: Solve>(
    set: &ToleranceSet,
    state: &State<R>,
    ([a, b], shapes): ([usize; 2], [&Block; 2]),
    way_out: [f64; 3],
) -> f64 {
    if shapes.iter().any(|block| !block.is_convex()) {
        return 0.0;
    }
    let thickness = shapes.map(|block| {
        let sides = [0, 1, 2].map(|axis: usize| {
            let along = || block.vertices().iter().map(|v| v.components()[axis].approximate());
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        });
        Number::from_rational(block.volume()).approximate() / sides.iter().map(|side| side * side).sum::<f64>()
    });
    let size = thickness.into_iter().fold(f64::INFINITY, f64::min) / 2.0;
    let way = |scale: f64| Vec3::new(way_out[0] * scale, way_out[1] * scale, way_out[2] * scale);
    let others = |block: usize, partner: usize| {
        state.contacts.iter().filter(move |contact| {
            let blocks = contact.blocks.map(|block| block as usize);
            blocks.contains(&block) && !blocks.contains(&partner)
        })
    };
    let pressed = |block, partner| {
        let closed = others(block, partner).filter(|contact| contact.mode.is_closed());
        closed.map(|contact| -contact.gap.to_f64()).fold(0.0, f64::max)
    };
    let limit = (pressed(a, b) / 10.0).min(pressed(b, a) / 10.0).min(set.penetration.approximate().min(size) / 1000.0);
    let is_held = |block: usize, partner: usize, way: Vec3<f64>| {
        others(block, partner).filter(|contact| contact.gap.to_f64() < limit).any(|contact| {
            let sign = if contact.blocks[0] as usize == block { 1.0 } else { -1.0 };
            let [x, y, z] = contact.normal.components().map(R::to_f64);
            let length = (way.x * way.x + way.y * way.y + way.z * way.z).sqrt();
            sign * (x * way.x + y * way.y + z * way.z) >= length / 2.0
        })
    };
    if is_held(a, b, way(1.0)) && is_held(b, a, way(-1.0)) { limit } else { 0.0 }
}

/// Steps with an overlap, and with an unseen one, of a scene; the audit of each is the plain one.
fn compared<R: Solve>(file: &str, about: (Precision, AuditScope), steps: usize) -> [usize; 2] {
    compared_with::<R>(file, about, steps, |_| {})
}

/// The same with other tolerances.
fn compared_with<R: Solve>(
    file: &str,
    (precision, scope): (Precision, AuditScope),
    steps: usize,
    change: impl Fn(&mut ToleranceSet),
) -> [usize; 2] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(file);
    let mut scene = Scene::load(path.to_str().expect("text")).expect("a scene");
    let mut set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), precision).expect("a set");
    change(&mut set);
    scene.derive_stiffness(&set);
    let dynamics = Dynamics::<R, SpecRules>::new(&scene, &set).expect("a beginning");
    let mut run = AuditedRun::new(Box::new(dynamics), &scene, &set, (precision, scope)).expect("a run");
    let mut reached = [0; 2];
    for step in 0..steps {
        run.step().expect("a step");
        let audit = StepAudit { passages: None, ..run.audit().expect("an audit") };
        let closed_see = scope == AuditScope::Overlaps;
        assert_eq!(audit, plainly(&scene, &set, (precision, closed_see), run.state()), "{file}, step {step}");
        reached[0] += usize::from(audit.deepest.is_some());
        reached[1] += usize::from(!audit.unseen.is_empty());
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
        let [overlapping, unseen] = compared::<f64>(file, (Precision::F64, AuditScope::Overlaps), steps);
        assert!(overlapping > 0, "{file}: nothing overlaps");
        reached = [reached[0] + overlapping, reached[1] + unseen];
    }
    let [overlapping, unseen] =
        compared::<f32>("handmade/slope_failure.toml", (Precision::F32, AuditScope::Overlaps), 40);
    assert!(overlapping > 0 && reached[0] > 80 && reached[1] + unseen > 0, "{reached:?} {overlapping} {unseen}");
}

/// With passages the classification alone says what contacts see: in this scene it loses a contact for a step that a closed one hides. Others hold both blocks, so
/// that this is no more than springs yield, but under a `penetration` of which it is more than a thousandth.
#[test]
fn the_full_audit_asks_the_classification_alone() {
    let unseen = |scope, penetration: f64| {
        let change = |set: &mut ToleranceSet| set.penetration = Number::from_f64(penetration).expect("a number");
        compared_with::<f64>("handmade/slope_failure.toml", (Precision::F64, scope), 24, change)[1]
    };
    assert_eq!(unseen(AuditScope::Overlaps, 2e-4), 0);
    assert!(unseen(AuditScope::OverlapsAndPassages, 2e-4) > 0);
    assert_eq!(unseen(AuditScope::OverlapsAndPassages, 2e-3), 0);
}
