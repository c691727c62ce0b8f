use super::*;
use crate::dynamics::prescribed::PrescribedStep;
use crate::vector::Vector;
use crate::wide::{count_unsettled, in_bits};
use rockproof_model::{Block, Motion, Number, Precision, Scene, SceneBlock, ToleranceSet, ToleranceSpec, Vec3};

fn number(value: f64) -> Number {
    Number::from_f64(value).expect("finite")
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Block {
    let at = |[x, y, z]: [f64; 3]| Vec3::new(number(x), number(y), number(z));
    Block::cuboid(&at(low), &at(high)).expect("a block")
}

/// A fixed floor, a rigid cube that strikes it aslant, so that it slides, and a deformable one on that.
fn falling() -> Scene {
    let blocks = [
        cuboid([-2.0, -2.0, -1.0], [4.0, 4.0, 0.0]),
        cuboid([0.0, 0.0, 0.0], [1.0, 1.0, 1.0]),
        cuboid([0.25, 0.25, 1.0], [1.25, 1.25, 2.0]),
    ];
    let mut scene = Scene { blocks: blocks.map(|b| SceneBlock::new("block", b)).to_vec(), ..Scene::default() };
    scene.blocks[0].body.motion = Motion::Fixed;
    scene.blocks[1].body.motion = Motion::Rigid;
    scene.blocks[2].body.motion = Motion::Deformable;
    for block in &mut scene.blocks[1..] {
        block.body.velocity = Vec3::new(number(2.0), number(1.0), number(-1.0));
    }
    scene
}

/// The same with so much stress in the upper cube that it turns inside out in one step.
fn inverting() -> Scene {
    let mut scene = falling();
    scene.simulation.materials[0].poisson = Number::ZERO;
    scene.blocks[2].body.stress[0] = number(1e13);
    scene
}

/// Both sides from the same state, some steps long: what was decided, asked and refused is the same. Says whether the last step could be made.
fn agree(mut scene: Scene, steps: usize, bits: u32) -> bool {
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("tolerances");
    let set = ToleranceSet { max_displacement: number(1e6), ..set }.rounded(Precision::F64).expect("numbers of f64");
    scene.derive_stiffness(&set);
    let mut stepping = Dynamics::<Wide>::new(&scene, &set).expect("a scene");
    for step in 0..steps {
        let mut deciding = stepping.clone();
        let contacts: Vec<_> = stepping.state().contacts.iter().map(|c| (c.blocks, c.contact)).collect();
        let contacts = stepping.clone().filtered_contacts(&set).map_or(contacts, |(found, _)| found);
        let decided = count_unsettled(|| in_bits(bits, || deciding.decide_prescribed(&contacts)));
        let prescribed = PrescribedStep { contacts: &contacts, attempt: None };
        let stepped = count_unsettled(|| in_bits(bits, || stepping.step_prescribed(&prescribed)));
        assert_eq!(decided.1, stepped.1, "unsettled comparisons of step {step} in {bits} bits");
        assert_eq!(deciding.modes(), stepping.modes());
        match (decided.0, stepped.0) {
            (Ok(decided), Ok(report)) => {
                let of_report =
                    DecidedStep { converged: report.converged, retries: report.retries, time_step: report.time_step };
                assert_eq!(decided, of_report, "step {step} in {bits} bits");
            }
            (Err(decided), Err(stepped)) => {
                assert_eq!(decided.to_string(), stepped.to_string());
                return false;
            }
            (decided, stepped) => panic!("step {step} in {bits} bits: {decided:?}, {stepped:?}"),
        }
    }
    true
}

#[test]
fn what_is_decided_is_what_the_step_does() {
    for bits in [128, 512] {
        assert!(agree(falling(), 3, bits));
        assert!(!agree(inverting(), 1, bits), "nothing turned inside out");
    }
}

/// A prepared block, and unknowns that move it by 1 mm without turning it.
fn resting(high: [f64; 3]) -> (PreparedBlock<Wide>, BlockVector<Wide>) {
    let mut d = [Wide::EXACT_ZERO; 12];
    d[0] = Wide::of_f64(0.001);
    (PreparedBlock::new(&cuboid([0.0; 3], high)).expect("a block"), d)
}

#[test]
fn what_moves_little_and_is_known_well_stays_whole() {
    let (cube, d) = resting([1.0; 3]);
    assert!(stays_whole(&cube, &d));
    for (k, value) in [(0, 5.0), (3, 0.015), (8, -0.015)] {
        let mut moved = d;
        moved[k] = Wide::of_f64(value);
        assert!(stays_whole(&cube, &moved), "unknown {k} of {value}");
    }
    for (k, value) in [(3, 0.016), (5, -0.016), (6, 0.016), (11, -0.016)] {
        let mut turned = d;
        turned[k] = Wide::of_f64(value);
        assert!(!stays_whole(&cube, &turned), "unknown {k} of {value}");
    }
    // Thirds of 128 bits, of which a sum leaves nothing but doubt.
    let doubted = |size: f64| {
        let third = Wide::of_f64(1.0) / Wide::of_f64(3.0);
        (third + third + third - Wide::of_f64(1.0)) * Wide::of_f64(size)
    };
    for k in [0, 2, 4, 9] {
        for (exponent, is_known) in [(60, true), (90, false)] {
            let mut unknown = d;
            unknown[k] = in_bits(128, || doubted(2f64.powi(exponent)));
            assert_eq!(stays_whole(&cube, &unknown), is_known, "unknown {k}, doubted by about 2^{}", exponent - 128);
        }
    }
}

#[test]
fn what_is_all_but_flat_may_not_stay_whole() {
    for (thickness, stays) in [(1.0, true), (2f64.powi(-38), true), (2f64.powi(-41), false)] {
        let (plate, d) = resting([1.0, 1.0, thickness]);
        assert_eq!(stays_whole(&plate, &d), stays, "{thickness} m thick");
    }
}

#[test]
fn an_edge_far_out_of_the_plane_of_its_face_may_not_stay_whole() {
    // The top of a prism whose fourth corner is bent up: its normal is inclined to its edges.
    let points = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
    let bent = |up: f64| {
        let mut prepared = PreparedBlock::<Wide>::new(&cuboid([0.0; 3], [1.0; 3])).expect("a block");
        let low = points.map(|[x, y, _]| [x, y, 0.0]);
        let high = points.map(|[x, y, z]| [x, y, if x + y == 2.0 { z + up } else { z }]);
        let exact = prepared.block().vertices().to_vec();
        let near = |p: &[f64; 3]| Vector::new(Wide::of_f64(p[0]), Wide::of_f64(p[1]), Wide::of_f64(p[2]));
        let moved = |v: &rockproof_model::Point| {
            let at = [v.x.approximate(), v.y.approximate(), v.z.approximate()];
            let all = low.iter().chain(&high);
            let same = |p: &&[f64; 3]| p[0] == at[0] && p[1] == at[1] && (p[2] > 0.5) == (at[2] > 0.5);
            all.into_iter().find(same).map(near).expect("a corner")
        };
        let points: Vec<_> = exact.iter().map(moved).collect();
        prepared = prepared.with_points(&points).expect("a block");
        stays_whole(&prepared, &[Wide::EXACT_ZERO; 12])
    };
    assert!(bent(0.125));
    assert!(!bent(1.0));
}
