//! Concave blocks: reflex edges and vertices, and the shortest exit.

use super::super::shapes::{
    WEDGE, classic, cuboid, extruded, leaning_spike, point, revised, spike, step, step_between,
};
use super::{Case, Row};
use rockproof_model::{Block, ToleranceSet};

pub(super) fn cases() -> Vec<Case> {
    // The leaning spike's edges (2, ±1/2, 1) and (1, ±1/2, 1) rise from the floor and lead away from the wall.
    let in_step = |x, z| leaning_spike([x, "0", z]);
    let plain = |name, derivation, blocks, expected| case(name, derivation, blocks, revised(&[]), expected);
    vec![
        plain(
            "step_floor",
            "The tip is 1/20 over the middle of the step's floor (face 4).",
            [in_step("3", "41/20"), step()],
            vec![("v-f", 0, 4, "v-f", 0, 4, "+1/400")],
        ),
        plain(
            "notch_by_the_reflex_edge",
            "The tip is 1/100 from floor and wall and 0.014 < r from the reflex edge 8. A reflex edge has no territory and no \
             v-e, so both v-f stay; they do not overlap, so the shortest exit has no say.",
            [in_step("201/100", "201/100"), step()],
            vec![("v-f", 0, 4, "v-f", 0, 4, "+1/10000"), ("v-f", 0, 5, "v-f", 0, 5, "+1/10000")],
        ),
        plain(
            "notch_at_the_reflex_vertex",
            "The same tip moved to the front plane, beside the reflex vertex 3: no v-v, nor has vertex 3 a territory. Its \
             convex edges 5 (floor and front) and 7 (wall and front) are each 1/100 away, the feet strictly inside: two v-e. \
             Entrance of (0, 5): the floor with 1/100 (the front fails for edges towards −y); edges × x with \
             n = (0, −2, 1)/√5 less. Of (0, 7): the wall, likewise. The foot of vertex 3 lies outside A's faces.",
            [leaning_spike(["201/100", "-4", "201/100"]), step()],
            vec![("v-e", 0, 5, "v-f", 0, 4, "+1/10000"), ("v-e", 0, 7, "v-f", 0, 5, "+1/10000")],
        ),
        plain(
            "reflex_vertex_on_a_face",
            "The step's front faces a box's face 4 (N = +y) 1/20 away: all six front vertices are v-f, the reflex vertex 3 \
             among them, for its edges +x, +y, +z do not descend either.",
            [step(), cuboid(["-2", "-8", "-2"], ["6", "-81/20", "6"])],
            (0..6).map(|v| ("v-f", v, 4, "v-f", v, 4, "+1/400")).collect(),
        ),
        plain(
            "ridge_across_a_reflex_edge",
            "A ridge along x from −1 to 3, 1/50 above the floor's height, passes 1/50 over the reflex edge 8 with feet inside \
             both; a reflex edge has no e-e. Its end (vertex 1) is 1/50 over the floor: v-f. (The blocks overlap by much \
             elsewhere, beyond g.)",
            [WEDGE.along_x().translated(&point(["1", "0", "101/50"])), step()],
            vec![("v-f", 1, 4, "v-f", 1, 4, "+1/2500")],
        ),
        plain(
            "shortest_exit",
            "The tip is 4/100 below the floor (face 4) and 3/100 behind face 3, 1/20 from the convex edge 6 between them. \
             Both v-f pass; the larger gap, −3/100 to face 3, stays. Edges × edge 6 have n = (1, 0, −1), (1, 0, −2): one \
             of B's inward directions −x, −z fails.",
            [in_step("397/100", "49/25"), step()],
            vec![("v-f", 0, 3, "v-f", 0, 3, "-9/10000")],
        ),
        plain(
            "shortest_exit_of_b",
            "shortest_exit with the blocks exchanged.",
            [step(), in_step("397/100", "49/25")],
            vec![("f-v", 3, 0, "f-v", 3, 0, "-9/10000")],
        ),
        plain(
            "shortest_exit_upwards",
            "3/100 below the floor and 4/100 behind face 3: the floor stays.",
            [in_step("99/25", "197/100"), step()],
            vec![("v-f", 0, 4, "v-f", 0, 4, "-9/10000")],
        ),
        plain(
            "shortest_exit_tie",
            "3/100 from both: the lower face stays.",
            [in_step("397/100", "197/100"), step()],
            vec![("v-f", 0, 3, "v-f", 0, 3, "-9/10000")],
        ),
        case(
            "shortest_exit_equal",
            "shortest_exit_upwards with ε = 1/3: −4/100 = −3/100·(1 + 1/3) equals the best by Eq. (1): the lower face.",
            [in_step("99/25", "197/100"), step()],
            revised(&[("equal", "1/3")]),
            vec![("v-f", 0, 3, "v-f", 0, 3, "-1/625")],
        ),
        case(
            "shortest_exit_not_quite_equal",
            "The same with ε = 333/1000: the floor.",
            [in_step("99/25", "197/100"), step()],
            revised(&[("equal", "333/1000")]),
            vec![("v-f", 0, 4, "v-f", 0, 4, "-9/10000")],
        ),
        case(
            "two_groups",
            "The step is a plate 1/25 thick; the tip is in its middle plane, far from all its edges: 1/50 behind the front and \
             1/50 behind the back, which no convex edge joins. Each is a group of its own and stays. Under classic so = 1 lets \
             every cone pass.",
            [spike(["1", "0", "1"]), step_between("-1/50", "1/50")],
            classic(&[("overlap_sine", "1")]),
            vec![("v-f", 0, 0, "v-f", 0, 0, "-1/2500"), ("v-f", 0, 1, "v-f", 0, 1, "-1/2500")],
        ),
        case(
            "two_groups_of_three",
            "The tip is in the middle of a plate 1/25 thick: 1/50 behind its bottom (face 2), below the right half of its roof \
             (face 6, N = (1, 0, 250)) by 5/√62501 and below the left half (face 7, (−1, 0, 400)) by 8/√160001, which is more. The \
             ridge (edge 12) joins the halves alone: of these the right one stays, and the bottom, a group of its own, stays as \
             well. A wall at x = 5 makes the plate no convex block. Under classic so = 1 lets every cone and wedge pass. Edges 0 to 3 × \
             12 are (3/50)/5 from each other. σ follows the sums of the inward directions, B's (−384, 0, −128/25): A's are (±96, ∓96, 144) \
             and the like, so n is (4, 0, 3) for edges 1 and 2, overlapping, and (4, 0, −3) for 0 and 3, apart by more than s.",
            [
                spike(["0", "0", "0"]),
                extruded(
                    &[["-8", "-1/50"], ["6", "-1/50"], ["6", "2"], ["5", "2"], ["5", "0"], ["0", "1/50"], ["-8", "0"]],
                    "-4",
                    "4",
                ),
            ],
            classic(&[("overlap_sine", "1"), ("search", "1/100")]),
            vec![
                ("v-f", 0, 2, "v-f", 0, 2, "-1/2500"),
                ("v-f", 0, 6, "v-f", 0, 6, "-25/62501"),
                ("e-e", 1, 12, "e-e", 1, 12, "-9/62500"),
                ("e-e", 2, 12, "e-e", 2, 12, "-9/62500"),
            ],
        ),
        plain(
            "box_over_a_convex_edge_of_a_step",
            "A box overlaps the convex edge 6 by 1/25 in x and 1/50 in z. Vertices 0 and 3 (at y = ∓1): floor −1/50, face 3 −1/25; \
             the floor stays for each. A's edges 0 and 5 (along x) cross edge 6 with n = z, h = −1/50; 2 and 7 (along z) with \
             n = x, h = −1/25. The step is not convex, so there is no one exit: all four stay.",
            [cuboid(["99/25", "-1", "99/50"], ["8", "1", "5"]), step()],
            vec![
                ("v-f", 0, 4, "v-f", 0, 4, "-1/2500"),
                ("v-f", 3, 4, "v-f", 3, 4, "-1/2500"),
                ("e-e", 0, 6, "e-e", 0, 6, "-1/2500"),
                ("e-e", 2, 6, "e-e", 2, 6, "-1/625"),
                ("e-e", 5, 6, "e-e", 5, 6, "-1/2500"),
                ("e-e", 7, 6, "e-e", 7, 6, "-1/625"),
            ],
        ),
    ]
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
