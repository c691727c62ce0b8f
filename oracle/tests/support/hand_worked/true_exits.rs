//! True exits: planes below which nothing dips by more than r/10 come before others, whatever their gaps.
//!
//! so = 1/20 and g = 1/20 let the small dips of these blocks pass.

use super::super::shapes::{
    PYRAMID_FACES, Prism, WEDGE, block, classic, just_below, point, revised, slab, tetrahedron,
};
use super::{Case, Row};
use rockproof_model::{Block, ToleranceSet};

pub(super) fn cases() -> Vec<Case> {
    let below = just_below("1/50");
    let (at_tie, beyond) = ([("overlap_sine", "1/20")], [("overlap_sine", "1/20"), ("territory", below.as_str())]);
    let no_territory = [("overlap_sine", "1/20"), ("territory", "0")];
    vec![
        case(
            "cone_exactly_true_exit",
            "The tip is 1/200 behind face 3 (N = x) and 1/100 below face 1 of the slab, in the territory of edge 10 (0.0112 ≤ r): \
             v-e. Its edges (−D, 0, 2), D = 1/500, and (3, ±3, 4) rise from face 1. The first dips behind face 3 by D, with \
             sine 0.001 ≤ so: it passes, and D = r/10 makes it a true exit. Edge 0 × 10 has n = (2, 0, D) up to length: no \
             dips; h² = ((1 + D)/100)²/(4 + D²), a little deeper than 1/200. Edges 1 and 2 × 10, n = (4, 0, −3)/5 either way \
             round, fail for B's slab. The largest of the true exits is face 3. In edge 10's territory there is no v-f or e-e.",
            tip_behind_the_side(),
            revised(&at_tie),
            vec![("v-e", 0, 10, "v-f", 0, 3, "-1/40000")],
        ),
        case(
            "cone_just_beyond_true_exit",
            "r a little less: face 3 has the largest gap, but is no true exit. Of those that are, face 1 has −1/100 and edges \
             0 × 10 h² = (501/500)²/100²/(1000001/250000).",
            tip_behind_the_side(),
            revised(&beyond),
            vec![("v-e", 0, 10, "e-e", 0, 10, "-251001/10000010000")],
        ),
        case(
            "cone_true_exit_classic",
            "Under classic what passes is a true exit, though r = 0: face 3.",
            tip_behind_the_side(),
            classic(&no_territory),
            vec![("v-e", 0, 10, "v-f", 0, 3, "-1/40000")],
        ),
        case(
            "wedge_exactly_true_exit",
            "A's ridge ends 1/100 straight above B's ridge, in its territory: v-e. Edges 0 × 0 have n = z, h = 1/100; A's face to p \
             drops by w·sine = 1/500 = r/10: a true exit, the largest. B's face 2, N = (−4, 0, 3)/5, has h = 3/500; the edge \
             to p dips by 3/5·1/500. Face 1 fails for A's ridge, edges 3 and 4 × 0 (n = ±x) for B's slopes. Vertex 2 at p's end \
             is 1/125 above B's ridge, nothing dips there: edges 5 × 0, h = 1/125. A's long edges end above B's ridge, so their \
             feet are not strictly inside: no e-e.",
            ridge_end(),
            revised(&at_tie),
            vec![("v-e", 1, 0, "e-e", 0, 0, "+1/10000"), ("v-e", 2, 0, "e-e", 5, 0, "+1/15625")],
        ),
        case(
            "wedge_just_beyond_true_exit",
            "r a little less: edges 0 × 0 are no true exit; face 2 is, with a smaller gap.",
            ridge_end(),
            revised(&beyond),
            vec![("v-e", 1, 0, "v-f", 1, 2, "+9/250000"), ("v-e", 2, 0, "e-e", 5, 0, "+1/15625")],
        ),
        case(
            "wedge_true_exit_classic",
            "Under classic what passes is a true exit, though r = 0: edges 0 × 0.",
            ridge_end(),
            classic(&no_territory),
            vec![("v-e", 1, 0, "e-e", 0, 0, "+1/10000"), ("v-e", 2, 0, "e-e", 5, 0, "+1/15625")],
        ),
        case(
            "one_exit_prefers_true_exits",
            "Edge 0 of A runs beside edge 10, from vertex 0, 1/100 behind face 3 and 1/200 below face 1, to vertex 1, 1/50 \
             behind and 3/100 below. Vertex 0 is in edge 10's territory: v-e. Its edge dips behind face 3 by 1/100 and below \
             face 1 by 1/40, so both pass (so = 1/20) and neither is a true exit; edges × 10 all fail for B's slab. If none is, \
             all count: face 1, −1/200. Vertex 1, 0.036 from edge 10, has v-f with face 1 (−3/100) and face 3 (−1/50), both true \
             exits. One exit: h* is the largest of these two, −1/50, not −1/200: n* = x, and the two with n = z go.",
            beside_the_edge(
                ["399/100", "0", "-1/200"],
                ["199/50", "2", "-3/100"],
                [["499/100", "-1", "799/200"], ["799/100", "-1", "199/200"]],
            ),
            revised(&at_tie),
            vec![("v-f", 1, 3, "v-f", 1, 3, "-1/2500")],
        ),
        case(
            "one_exit_prefers_true_exits_classic",
            "Under classic vertex 1 too is in edge 10's territory: v-e, entrance face 3 with −1/50. What passes is a true exit: \
             h* = −1/200, n* = z, and vertex 1's goes.",
            beside_the_edge(
                ["399/100", "0", "-1/200"],
                ["199/50", "2", "-3/100"],
                [["499/100", "-1", "799/200"], ["799/100", "-1", "199/200"]],
            ),
            classic(&at_tie),
            vec![("v-e", 0, 10, "v-f", 0, 1, "-1/40000")],
        ),
        case(
            "one_exit_at_exactly_true_exit",
            "Edge 0 beside edge 10 once more, both ends beyond its territory (0.036, 0.031): vertex 0 is 13/500 behind face 3 and 1/40 \
             below face 1, vertex 1 2/125 and 27/1000. Seen from face 1 vertex 0's edge dips by 1/500 = r/10: (0, 1) is a true \
             exit, so is (1, 1); seen from face 3 vertex 1's edge dips by 1/100: (1, 3) is none, (0, 3) is. Of −1/40 (0, 1), \
             −27/1000 (1, 1) and −13/500 (0, 3) the first is the largest: n* = z.",
            falling_slowly(),
            revised(&at_tie),
            vec![("v-f", 0, 1, "v-f", 0, 1, "-1/1600"), ("v-f", 1, 1, "v-f", 1, 1, "-729/1000000")],
        ),
        case(
            "one_exit_just_beyond_true_exit",
            "r a little less: (0, 1) is no true exit, and of the two left −13/500 is the largest: n* = x.",
            falling_slowly(),
            revised(&beyond),
            vec![("v-f", 0, 3, "v-f", 0, 3, "-169/250000"), ("v-f", 1, 3, "v-f", 1, 3, "-4/15625")],
        ),
        case(
            "one_exit_without_true_exit",
            "The tip is 1/50 below the middle of face 1; its edge to vertex 1 dips by 9/200 ≤ g with sine 0.0225 ≤ so: a v-f, and \
             no true exit. Vertex 1, 13/200 below, is too deep. If there is no true exit, all count: the tip's own.",
            [tetrahedron([["0", "0", "-1/50"], ["2", "0", "-13/200"], ["-3", "3", "4"], ["-3", "-3", "4"]]), slab()],
            revised(&at_tie),
            vec![("v-f", 0, 1, "v-f", 0, 1, "-1/2500")],
        ),
        case(
            "one_exit_where_every_edge_of_a_cone_dips",
            "The tip of a low roof is 1/200 below face 1, and all four edges fall from it, by 1/40 and 1/25: they pass, but by more than \
             r/10, so (0, 1) is no true exit, nor is another contact through the top. Tip and near eaves are 39/2000 and 1/50 \
             behind face 3, and from there nothing but the eaves dips, by 1/2000: of these the tip's gap is the larger, n* = x, \
             and all with n = z goes.",
            [
                block(
                    [
                        ["39805/10000", "0", "-1/200"],
                        ["199/50", "-1", "-3/100"],
                        ["199/50", "1", "-3/100"],
                        ["8", "1", "-9/200"],
                        ["8", "-1", "-9/200"],
                    ]
                    .map(point)
                    .to_vec(),
                    &PYRAMID_FACES,
                ),
                slab(),
            ],
            revised(&at_tie),
            vec![
                ("v-f", 0, 3, "v-f", 0, 3, "-1521/4000000"),
                ("v-f", 1, 3, "v-f", 1, 3, "-1/2500"),
                ("v-f", 2, 3, "v-f", 2, 3, "-1/2500"),
            ],
        ),
    ]
}

/// A tip at (4 − 1/200, 0, −1/100) with edges (−1/500, 0, 2), (3, −3, 4), (3, 3, 4).
fn tip_behind_the_side() -> [Block; 2] {
    let tip = ["799/200", "0", "-1/100"];
    let [along, right, left] =
        [["3993/1000", "0", "199/100"], ["1399/200", "-3", "399/100"], ["1399/200", "3", "399/100"]];
    [tetrahedron([tip, along, right, left]), slab()]
}

/// A ridge along x that ends above a ridge along y, with a face to p that drops by 1/500.
fn ridge_end() -> [Block; 2] {
    let prism = Prism { p: ["1", "-1/500"], q: ["0", "5"], ..WEDGE };
    [prism.along_x().translated(&point(["-2", "0", "1/100"])), WEDGE.upside_down_along_y()]
}

/// A tetrahedron with an edge beside edge 10 of the slab; the others rise from its vertex 0 with (1, −1, 4), (4, −1, 1).
fn beside_the_edge(vertex: [&str; 3], next: [&str; 3], [upper, outer]: [[&str; 3]; 2]) -> [Block; 2] {
    [tetrahedron([vertex, next, upper, outer]), slab()]
}

fn falling_slowly() -> [Block; 2] {
    beside_the_edge(
        ["1987/500", "0", "-1/40"],
        ["498/125", "2", "-27/1000"],
        [["2487/500", "-1", "159/40"], ["3987/500", "-1", "39/40"]],
    )
}

fn case(
    name: &'static str,
    derivation: &'static str,
    [a, b]: [Block; 2],
    tolerances: ToleranceSet,
    expected: Vec<Row>,
) -> Case {
    Case { name, derivation, a, b, tolerances, kept: Vec::new(), expected }
}
