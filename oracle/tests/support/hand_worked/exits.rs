//! One exit: two convex blocks overlap in one place and leave it by one way.

use super::super::shapes::{cuboid, gable, leaning_spike, revised, slab, spike, tetrahedron};
use super::{Case, Row};
use rockproof_model::Block;

pub(super) fn cases() -> Vec<Case> {
    // A box over the slab's edge 10 (x = 4): vertices 0 and 3 overlap face 1 by z and face 3 by x; A's edges 0 and 5
    // (along x) cross edge 10 with n = z, its edges 2 and 7 (along z) with n = x. Both are far enough from the edge.
    let box_at = |x, z| [cuboid([x, "-1", z], ["8", "1", "3"]), slab()];
    let through_the_top = |gap: &'static str| -> Vec<Row> {
        vec![
            ("v-f", 0, 1, "v-f", 0, 1, gap),
            ("v-f", 3, 1, "v-f", 3, 1, gap),
            ("e-e", 0, 10, "e-e", 0, 10, gap),
            ("e-e", 5, 10, "e-e", 5, 10, gap),
        ]
    };
    let through_the_side = |gap: &'static str| -> Vec<Row> {
        vec![
            ("v-f", 0, 3, "v-f", 0, 3, gap),
            ("v-f", 3, 3, "v-f", 3, 3, gap),
            ("e-e", 2, 10, "e-e", 2, 10, gap),
            ("e-e", 7, 10, "e-e", 7, 10, gap),
        ]
    };
    let gabled = || [spike(["-1/50", "0", "-3/100"]), gable()];
    vec![
        case(
            "exit_through_the_top",
            "Overlap 1/25 in x, 1/50 in z: h* = −1/50, n* = z (first in order: v-f (0, 1)). The four contacts with \
             h = −1/25 have n = x, perpendicular to n*, and go.",
            box_at("99/25", "-1/50"),
            &[],
            through_the_top("-1/2500"),
        ),
        case(
            "exit_perpendicular",
            "The same with so = 1: no angle stops a cone or wedge, but those that go on through the slab dip by far more than g, so \
             nothing is added; and |n × n*|² ≤ so²·|n|²·|n*|² holds for n = x with equality; but n·n* = 0 is not > 0, so these go.",
            box_at("99/25", "-1/50"),
            &[("overlap_sine", "1")],
            through_the_top("-1/2500"),
        ),
        case(
            "exit_through_the_side",
            "Overlap 1/50 in x, 1/25 in z: h* = −1/50, n* = x.",
            box_at("199/50", "-1/25"),
            &[],
            through_the_side("-1/2500"),
        ),
        case(
            "exit_tie",
            "Overlap 3/100 in both: all h equal; the first in sorted order is v-f (0, 1), n* = z.",
            box_at("397/100", "-3/100"),
            &[],
            through_the_top("-9/10000"),
        ),
        case(
            "exit_equal",
            "Overlap 3/100 in x, 4/100 in z with ε = 1/3: −4/100 = −3/100·(1 + 1/3) equals the best by Eq. (1); the first in \
             order is v-f (0, 1).",
            box_at("397/100", "-1/25"),
            &[("equal", "1/3")],
            through_the_top("-1/625"),
        ),
        case(
            "exit_not_quite_equal",
            "The same with ε = 333/1000: the side.",
            box_at("397/100", "-1/25"),
            &[("equal", "333/1000")],
            through_the_side("-9/10000"),
        ),
        case(
            "exit_exactly_overlap_angle",
            "The tip is 3/100 below the gable's top (face 5) and (3·(−2) + 4·(−3))/500 = −9/250 from its slope (face 4, \
             N = (3, 0, 4)/5), over the inside of both, 0.036 > r from edge 8. h* = −3/100, n* = z; the slope's normal is at \
             sine 3/5 = so from it and stays. Edges 1 and 2 × edge 8 have n = (4, 0, 3)/5: B's slope is at sine 7/25 < so of it, but 5 wide, \
             so that it dips by 7/5 > g.",
            gabled(),
            &[("overlap_sine", "3/5")],
            vec![("v-f", 0, 4, "v-f", 0, 4, "-81/62500"), ("v-f", 0, 5, "v-f", 0, 5, "-9/10000")],
        ),
        case(
            "exit_within_overlap_angle",
            "The same with so = 7/10: the slope's contact stays without a tie.",
            gabled(),
            &[("overlap_sine", "7/10")],
            vec![("v-f", 0, 4, "v-f", 0, 4, "-81/62500"), ("v-f", 0, 5, "v-f", 0, 5, "-9/10000")],
        ),
        case(
            "exit_beyond_overlap_angle",
            "The same with so = 599/1000: the slope's contact goes.",
            gabled(),
            &[("overlap_sine", "599/1000")],
            vec![("v-f", 0, 5, "v-f", 0, 5, "-9/10000")],
        ),
        case(
            "exit_of_one_vertex",
            "The tip of shortest_exit over the corner of a box instead of a step: two convex blocks, so one exit decides, with \
             the same answer: face 3 (−3/100), not the top (−4/100).",
            [leaning_spike(["397/100", "0", "-1/25"]), slab()],
            &[],
            vec![("v-f", 0, 3, "v-f", 0, 3, "-9/10000")],
        ),
        case(
            "exit_beside_a_contact_apart",
            "Vertex 0 is 1/100 below face 1 and 1/40 behind face 3, vertex 1 as deep and 1/100 before face 3; the edge between them \
             passes under edge 10 with n = z. Seen from face 3 it dips by 7/200, with sine 0.07 ≤ so: a contact, and no true exit. \
             So n* = z; the one with n = x does not overlap and stays, whatever its normal.",
            [
                tetrahedron([
                    ["3975/1000", "0", "-1/100"],
                    ["401/100", "1/2", "-1/100"],
                    ["5", "1", "2"],
                    ["5", "-1", "2"],
                ]),
                slab(),
            ],
            &[("overlap_sine", "1/10"), ("territory", "1/200")],
            vec![
                ("v-f", 0, 1, "v-f", 0, 1, "-1/10000"),
                ("v-f", 1, 3, "v-f", 1, 3, "+1/10000"),
                ("e-e", 0, 10, "e-e", 0, 10, "-1/10000"),
            ],
        ),
    ]
}

fn case(
    name: &'static str,
    derivation: &'static str,
    [a, b]: [Block; 2],
    changes: &[(&str, &str)],
    expected: Vec<Row>,
) -> Case {
    Case { name, derivation, a, b, tolerances: revised(changes), kept: Vec::new(), expected }
}
