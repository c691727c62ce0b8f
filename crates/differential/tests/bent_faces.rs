//! The stepper in 512 bits beside the oracle over faces that are not planar, which only a loosened `planarity` lets in. Contacts with such a face
//! are with its plane, and that may stand out of its block's box: where either side leaves out what is far, it must allow for it.

use rockproof_model::{Block, BlockOptions, Contact, ContactKey, Number, ToleranceSet, Vec3, VertexId};
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::engine::settled_contacts;

/// A cube of 4 m below z = 0 whose top has its corner at (0, 4) lower by `low`. Twice the top's area vector is (−4 low, 4 low, 32) and the mean
/// of its corners (2, 2, −low/4): its plane is z = (x − y − 2)·low/8, low/4 above the cube at (4, 0).
fn bent(low: f64) -> Block {
    let corner = |k: usize| {
        let [x, y] = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]][k % 4];
        [x, y, if k < 4 { -4.0 } else { 0.0 } - if k == 7 { low } else { 0.0 }]
    };
    let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    block((0..8).map(corner), faces.map(Vec::from).to_vec())
}

fn block(corners: impl Iterator<Item = [f64; 3]>, faces: Vec<Vec<u32>>) -> Block {
    let vertices = corners.map(|corner| {
        let [x, y, z] = corner.map(number);
        Vec3::new(x, y, z)
    });
    Block::new(vertices.collect(), faces, &BlockOptions { planarity: number(0.25) }).unwrap()
}

fn number(value: f64) -> Number {
    Number::from_f64(value).unwrap()
}

#[test]
fn over_a_bent_face_both_sides_find_the_same_contacts() {
    let (s, sine) = (1.0 / 64.0, 3.0 / 64.0);
    let tolerances = ToleranceSet {
        search: number(s),
        penetration: number(s),
        overlap_sine: number(sine),
        parallel_sine: number(sine),
        ..ToleranceSet::ZERO
    };
    let (mut pairs, mut compared, mut above) = (0, 0, 0);
    for low in [0.5, 0.125, 1.0] {
        let bent = bent(low);
        for place in 1..8 {
            for steps in (-9..=9).step_by(2) {
                // Along the diagonal from the low corner to the one opposite, where the plane is highest. Of two tips one may be above the
                // box by more than s while the other is within it; their edge rises a little less than the plane, which is no tie.
                let (x, y) = (f64::from(place) / 2.0, 4.0 - f64::from(place) / 2.0);
                let z = (x - y - 2.0) * low / 8.0 + f64::from(steps) / 256.0;
                let second = [x - 1.0, y + 1.0, z - low / 4.0 + 1.0 / 1024.0];
                let corners = [[x, y, z], second, [x - 1.0, y, z + 1.0], [x, y + 1.0, z + 1.0]];
                let tips =
                    block(corners.into_iter(), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(Vec::from).to_vec());
                for [a, b] in [[&tips, &bent], [&bent, &tips]] {
                    let exact =
                        Pair::new(&PreparedBlock::new(a), &PreparedBlock::new(b)).classify(&tolerances).contacts;
                    pairs += 1;
                    let Some(settled) = settled_contacts::<SpecRules>(a, b, &tolerances).unwrap() else { continue };
                    assert_eq!(exact, settled, "low by {low}, at ({x}, {y}), {steps}/256 above the plane");
                    compared += 1;
                    let of_tip = |contact: &Contact| {
                        matches!(
                            contact.key,
                            ContactKey::VertexFace(VertexId(0), _) | ContactKey::FaceVertex(_, VertexId(0))
                        )
                    };
                    above += usize::from(z > 1.25 * s && exact.iter().any(of_tip));
                }
            }
        }
    }
    assert!(compared * 2 > pairs && above > 10, "{compared} of {pairs} pairs, {above} with a contact above the box");
}
