//! Territories under `classic` and `revised`, where they answer differently. Dips and near parallels are in `measures`.

use super::super::shapes::{classic, revised, slab, spike};
use super::{Case, Row};
use rockproof_model::Block;

pub(super) fn cases() -> Vec<Case> {
    let over_face_near_edge = || [spike(["397/100", "0", "1/25"]), slab()];
    let over_face_near_corner = || [spike(["397/100", "397/100", "1/25"]), slab()];
    vec![
        under_classic(
            "edge_territory_classic",
            "The tip is over face 1 at (−3/100, 4/100) from edge 10: distance 1/20 ≤ s, the classic radius: v-e. Face 1 gives \
             1/25, e-e with (4, 0, 3)/5 gives 0.",
            over_face_near_edge(),
            vec![("v-e", 0, 10, "v-f", 0, 1, "+1/625")],
        ),
        under_revised(
            "edge_territory_revised",
            "The same tip is beyond r = 1/50 of the edge: v-f.",
            over_face_near_edge(),
            vec![("v-f", 0, 1, "v-f", 0, 1, "+1/625")],
        ),
        under_classic(
            "vertex_territory_classic",
            "The tip is at (−3, −3, 4)/100 from corner 6: 0.058 ≤ s. Face 1 gives 1/25, A's faces 2 and 3 and the e-e \
             candidates give 0.",
            over_face_near_corner(),
            vec![("v-v", 0, 6, "v-f", 0, 1, "+1/625")],
        ),
        under_revised(
            "vertex_territory_revised",
            "The same tip is 1/20 from both edges and further from the corner, all beyond r: v-f.",
            over_face_near_corner(),
            vec![("v-f", 0, 1, "v-f", 0, 1, "+1/625")],
        ),
    ]
}

fn under_classic(name: &'static str, derivation: &'static str, [a, b]: [Block; 2], expected: Vec<Row>) -> Case {
    Case { name, derivation, a, b, tolerances: classic(&[]), kept: Vec::new(), expected }
}

fn under_revised(name: &'static str, derivation: &'static str, [a, b]: [Block; 2], expected: Vec<Row>) -> Case {
    Case { name, derivation, a, b, tolerances: revised(&[]), kept: Vec::new(), expected }
}
