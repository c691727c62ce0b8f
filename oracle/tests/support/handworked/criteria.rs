//! The same pair under `classic` and `revised`, where they answer differently.

use super::super::shapes::{Prism, WEDGE, classic, revised, slab, spike, tetrahedron};
use super::{Case, Row};
use rockproof_model::Block;

pub(super) fn cases() -> Vec<Case> {
    let over_face_near_edge = || [spike(["397/100", "0", "1/25"]), slab()];
    let over_face_near_corner = || [spike(["397/100", "397/100", "1/25"]), slab()];
    // The edge from the tip to vertex 1 dips by exactly 1/20 = g.
    let shallow =
        |z1| [tetrahedron([["0", "0", "7/100"], ["2", "0", z1], ["-3", "3", "4"], ["-3", "-3", "4"]]), slab()];
    // The face from the ridge to p is 1/12 wide and dips by exactly 1/20 = g.
    let narrow = || {
        let prism = Prism { half: "2", p: ["1/15", "-1/20"], q: ["0", "5"], offset: ["0", "0", "7/100"] };
        [prism.along_x(), WEDGE.upside_down_along_y()]
    };
    let long_turned = || {
        let long = Prism { half: "20", offset: ["0", "0", "1/20"], ..WEDGE };
        [long.turned(), Prism { half: "3", ..WEDGE }.upside_down_along_x()]
    };
    vec![
        under_classic(
            "edge_territory_classic",
            "The tip is over face 1 at (−3/100, 4/100) from edge 10: distance 1/20 ≤ s, the classic radius: v-e. Face 1 gives \
             1/25, e-e with (4, 0, 3)/5 gives 0.",
            over_face_near_edge(),
            &[],
            vec![("v-e", 0, 10, "v-f", 0, 1, "+1/625")],
        ),
        under_revised(
            "edge_territory_revised",
            "The same tip is beyond r = 1/50 of the edge: v-f.",
            over_face_near_edge(),
            &[],
            vec![("v-f", 0, 1, "v-f", 0, 1, "+1/625")],
        ),
        under_classic(
            "vertex_territory_classic",
            "The tip is at (−3, −3, 4)/100 from corner 6: 0.058 ≤ s. Face 1 gives 1/25, A's faces 2 and 3 and the e-e \
             candidates give 0.",
            over_face_near_corner(),
            &[],
            vec![("v-v", 0, 6, "v-f", 0, 1, "+1/625")],
        ),
        under_revised(
            "vertex_territory_revised",
            "The same tip is 1/20 from both edges and further from the corner, all beyond r: v-f.",
            over_face_near_corner(),
            &[],
            vec![("v-f", 0, 1, "v-f", 0, 1, "+1/625")],
        ),
        under_revised(
            "cone_exactly_penetration_length",
            "The tip is 7/100 over face 1, vertex 1 2/100: the edge between them dips by 1/20 = g, allowed under revised. \
             Vertex 1 has only rising edges.",
            shallow("1/50"),
            &[],
            vec![("v-f", 0, 1, "v-f", 0, 1, "+49/10000"), ("v-f", 1, 1, "v-f", 1, 1, "+1/2500")],
        ),
        under_revised(
            "cone_beyond_penetration_length",
            "As before with vertex 1 at 19/1000: the dip of 51/1000 exceeds g.",
            shallow("19/1000"),
            &[],
            vec![("v-f", 1, 1, "v-f", 1, 1, "+361/1000000")],
        ),
        under_classic(
            "cone_penetration_length_classic",
            "Under classic only the angle counts, and so = 0.",
            shallow("1/50"),
            &[],
            vec![("v-f", 1, 1, "v-f", 1, 1, "+1/2500")],
        ),
        under_revised(
            "wedge_exactly_penetration_length",
            "The ridge is 7/100 over B's ridge, p's edge (5) 2/100, at y = 1/15. The face between them is w = 1/12 wide and dips \
             with sine 3/5: w·3/5 = 1/20 = g, allowed under revised. At p's edge both faces rise.",
            narrow(),
            &[],
            vec![("e-e", 0, 0, "e-e", 0, 0, "+49/10000"), ("e-e", 5, 0, "e-e", 5, 0, "+1/2500")],
        ),
        under_revised(
            "wedge_beyond_penetration_length",
            "As before with g = 49/1000.",
            narrow(),
            &[("penetration", "49/1000")],
            vec![("e-e", 5, 0, "e-e", 5, 0, "+1/2500")],
        ),
        under_classic(
            "wedge_penetration_length_classic",
            "Under classic only the angle counts, and so = 0.",
            narrow(),
            &[],
            vec![("e-e", 5, 0, "e-e", 5, 0, "+1/2500")],
        ),
        under_classic(
            "parallel_length_classic",
            "exactly_parallel_length under classic: r plays no part, the ridges cross.",
            long_turned(),
            &[("territory", "18/5")],
            vec![("e-e", 0, 0, "e-e", 0, 0, "+1/400")],
        ),
    ]
}

fn under_classic(
    name: &'static str,
    derivation: &'static str,
    [a, b]: [Block; 2],
    changes: &[(&str, &str)],
    expected: Vec<Row>,
) -> Case {
    Case { name, derivation, a, b, tolerances: classic(changes), expected }
}

fn under_revised(
    name: &'static str,
    derivation: &'static str,
    [a, b]: [Block; 2],
    changes: &[(&str, &str)],
    expected: Vec<Row>,
) -> Case {
    Case { name, derivation, a, b, tolerances: revised(changes), expected }
}
