//! Each of the six kinds apart, touching and overlapping, and the textbook stacks.

use super::super::shapes::{WEDGE, cuboid, point, revised, slab, spike};
use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let tip_over_face = |h| spike(["0", "0", h]);
    let tip_over_edge = |h| spike(["4", "0", h]);
    let tip_over_corner = |h| spike(["4", "4", h]);
    let ridge = |h| WEDGE.along_x().translated(&point(["0", "0", h]));
    let case = |name, derivation, a, b, expected| Case {
        name,
        derivation,
        a,
        b,
        tolerances: revised(&[]),
        kept: Vec::new(),
        expected,
    };
    vec![
        case(
            "vf_apart",
            "The tip is 1/20 above the middle of the top (face 1, N = +z); all its edges rise. Nothing else is near.",
            tip_over_face("1/20"),
            slab(),
            vec![("v-f", 0, 1, "v-f", 0, 1, "+1/400")],
        ),
        case(
            "vf_touching",
            "As vf_apart with h = 0, which is within [−g, s].",
            tip_over_face("0"),
            slab(),
            vec![("v-f", 0, 1, "v-f", 0, 1, "0")],
        ),
        case(
            "vf_overlapping",
            "As vf_apart with h = −1/40 ≥ −g.",
            tip_over_face("-1/40"),
            slab(),
            vec![("v-f", 0, 1, "v-f", 0, 1, "-1/1600")],
        ),
        case(
            "fv_apart",
            "vf_apart with the blocks exchanged.",
            slab(),
            tip_over_face("1/20"),
            vec![("f-v", 1, 0, "f-v", 1, 0, "+1/400")],
        ),
        case(
            "fv_touching",
            "vf_touching with the blocks exchanged.",
            slab(),
            tip_over_face("0"),
            vec![("f-v", 1, 0, "f-v", 1, 0, "0")],
        ),
        case(
            "fv_overlapping",
            "vf_overlapping with the blocks exchanged.",
            slab(),
            tip_over_face("-1/40"),
            vec![("f-v", 1, 0, "f-v", 1, 0, "-1/1600")],
        ),
        case(
            "ve_apart",
            "The tip is 1/20 straight above edge 10 (x = 4), outside its territory (1/20 > r) and in its region: \
             (a−p)·m is 0 for the top's inward −x and −1/20 for the side's −z; the foot is straight below the tip, in \
             its region. Over the boundary of the top, so no v-f. Candidates: face 1 with h = 1/20; face 3 (N = +x) fails \
             for the edges towards −x; A's edges 1 and 2, directions (−3, ±3, 4), × y give n = (4, 0, 3)/5 and \
             h = 3/5·1/20, edges 0 and 3 point over the slab and fail. The largest is face 1.",
            tip_over_edge("1/20"),
            slab(),
            vec![("v-e", 0, 10, "v-f", 0, 1, "+1/400")],
        ),
        case(
            "ve_touching",
            "As ve_apart with h = 0: in the edge's territory. All candidates have gap 0; v-f is first in order.",
            tip_over_edge("0"),
            slab(),
            vec![("v-e", 0, 10, "v-f", 0, 1, "0")],
        ),
        case(
            "ve_overlapping",
            "As ve_apart with the tip 1/100 below the edge: in its territory (1/100 ≤ r). Face 1 has −1/100, the e-e \
             candidates −3/500, which is larger: the shortest exit is sideways. Edges 1 and 2 tie; 1 is first. No v-f \
             with face 3, no e-e contact: the tip is in the territory of edge 10.",
            tip_over_edge("-1/100"),
            slab(),
            vec![("v-e", 0, 10, "e-e", 1, 10, "-9/250000")],
        ),
        case(
            "ev_apart",
            "ve_apart with the blocks exchanged.",
            slab(),
            tip_over_edge("1/20"),
            vec![("e-v", 10, 0, "f-v", 1, 0, "+1/400")],
        ),
        case(
            "ev_touching",
            "ve_touching with the blocks exchanged; there is no v-f candidate, f-v is first in order.",
            slab(),
            tip_over_edge("0"),
            vec![("e-v", 10, 0, "f-v", 1, 0, "0")],
        ),
        case(
            "ev_overlapping",
            "ve_overlapping with the blocks exchanged: edges 10 × 1 and 10 × 2 tie, 10 × 1 is first.",
            slab(),
            tip_over_edge("-1/100"),
            vec![("e-v", 10, 0, "e-e", 10, 1, "-9/250000")],
        ),
        case(
            "vv_apart",
            "The tip is 1/20 straight above corner 6, beyond r; (a−b)·e is 0, 0, −1/20·4 for the corner's edges towards \
             −x, −y, −z and (b−a)·e < 0 for the tip's, which all rise: each lies in the other's region. Candidates: face 1 with \
             h = 1/20 (faces 3 and 4 fail for edges towards −x, −y); A's faces 2 and 3 with N = (−24, 0, −18)/30 and \
             (0, −24, −18)/30, h = 3/5·1/20 (1 and 4 fail); e-e with normals (4, 0, 3)/5 and (0, 4, 3)/5, same h. The \
             largest is face 1. No v-e: the feet lie at the ends of the corner's edges, not strictly inside.",
            tip_over_corner("1/20"),
            slab(),
            vec![("v-v", 0, 6, "v-f", 0, 1, "+1/400")],
        ),
        case(
            "vv_touching",
            "As vv_apart with h = 0: every candidate has gap 0, v-f is first.",
            tip_over_corner("0"),
            slab(),
            vec![("v-v", 0, 6, "v-f", 0, 1, "0")],
        ),
        case(
            "vv_overlapping",
            "As vv_apart with the tip 1/100 below the corner, in its territory. Face 1 has −1/100; A's faces 2 and 3 and the \
             e-e candidates −3/500, the largest. f-v comes before e-e, face 2 before 3. The territory keeps everything else \
             away: f-v of the corner (its foot is inside face 2), v-e with edge 6, e-e.",
            tip_over_corner("-1/100"),
            slab(),
            vec![("v-v", 0, 6, "f-v", 2, 6, "-9/250000")],
        ),
        case(
            "ee_apart",
            "Ridge along x at 1/20 over a ridge along y, crossing in their middles: d1 × d2 = 16 z, A's inward \
             directions rise, B's descend; h = 1/20. All vertices are far from the other block.",
            ridge("1/20"),
            WEDGE.upside_down_along_y(),
            vec![("e-e", 0, 0, "e-e", 0, 0, "+1/400")],
        ),
        case(
            "ee_touching",
            "As ee_apart with h = 0.",
            ridge("0"),
            WEDGE.upside_down_along_y(),
            vec![("e-e", 0, 0, "e-e", 0, 0, "0")],
        ),
        case(
            "ee_overlapping",
            "As ee_apart with h = −1/40.",
            ridge("-1/40"),
            WEDGE.upside_down_along_y(),
            vec![("e-e", 0, 0, "e-e", 0, 0, "-1/1600")],
        ),
        case(
            "box_inside_a_larger_top",
            "A box 1/100 over a larger one: its four lower vertices over the inside of face 1; its edges there are \
             horizontal (e·N = 0) or rise. The boxes' edges are 1 apart.",
            cuboid(["1", "1", "1/100"], ["2", "2", "2"]),
            cuboid(["0", "0", "-2"], ["3", "3", "0"]),
            vec![
                ("v-f", 0, 1, "v-f", 0, 1, "+1/10000"),
                ("v-f", 1, 1, "v-f", 1, 1, "+1/10000"),
                ("v-f", 2, 1, "v-f", 2, 1, "+1/10000"),
                ("v-f", 3, 1, "v-f", 3, 1, "+1/10000"),
            ],
        ),
        case(
            "equal_boxes_stacked",
            "Equal boxes 1/100 apart: each lower vertex of A over the upper one of B, in its territory. Horizontal planes \
             are the only ones that pass (a vertical face of the one has the other's edges on both sides): face 1, A's \
             face 0 and the crossing horizontal edges, all with h = 1/100; v-f is first. All feet on edges lie at ends.",
            cuboid(["0", "0", "1/100"], ["2", "2", "2"]),
            cuboid(["0", "0", "-2"], ["2", "2", "0"]),
            vec![
                ("v-v", 0, 4, "v-f", 0, 1, "+1/10000"),
                ("v-v", 1, 5, "v-f", 1, 1, "+1/10000"),
                ("v-v", 2, 6, "v-f", 2, 1, "+1/10000"),
                ("v-v", 3, 7, "v-f", 3, 1, "+1/10000"),
            ],
        ),
        case(
            "crossed_bars",
            "A bar along x (1 < y < 2) 1/100 over a bar along y (1 < x < 2): A's lower edges 0 and 5 cross B's upper \
             edges 9 (x = 1) and 10 (x = 2), all vertices 1 away from them.",
            cuboid(["0", "1", "1/100"], ["4", "2", "2"]),
            cuboid(["1", "0", "-2"], ["2", "4", "0"]),
            vec![
                ("e-e", 0, 9, "e-e", 0, 9, "+1/10000"),
                ("e-e", 0, 10, "e-e", 0, 10, "+1/10000"),
                ("e-e", 5, 9, "e-e", 5, 9, "+1/10000"),
                ("e-e", 5, 10, "e-e", 5, 10, "+1/10000"),
            ],
        ),
        case(
            "beside_a_corner",
            "The tip is 1/20 beside corner 6, at its height. The corner's region holds it, but (b−a)·e = 3/20 > 0 for the \
             tip's edges towards −x: no v-v. The corner lies before A's face 2: h = (−24, 0, −18)·(−1/20, 0, 0)/30 = 1/25, its \
             foot 3/100 up the face's middle, 0.043 > r from the edges; the corner's cone passes. Edge 2, (−3, −3, 4), \
             passes edge 10 at y = 4 − 9/500, n = (4, 0, 3)/5, h = 1/25; edge 1 misses it at y = 4 + 9/500.",
            spike(["81/20", "4", "0"]),
            slab(),
            vec![("f-v", 2, 6, "f-v", 2, 6, "+1/625"), ("e-e", 2, 10, "e-e", 2, 10, "+1/625")],
        ),
        case(
            "beside_an_edge",
            "The tip is 1/20 beside the middle of edge 10, at its height: beyond r, and though the edge's region holds it, its \
             foot f is not in the tip's: (f−a)·e = 3/20 > 0 for the edges towards −x. No v-e; those edges, 1 and 2, cross \
             edge 10 at y = ±9/500 with n = (4, 0, 3)/5, h = 1/25.",
            spike(["81/20", "0", "0"]),
            slab(),
            vec![("e-e", 1, 10, "e-e", 1, 10, "+1/625"), ("e-e", 2, 10, "e-e", 2, 10, "+1/625")],
        ),
        case(
            "ve_through_edges",
            "Ridge along x that ends 1/20 straight above a ridge along y: the foot of the common perpendicular is at the \
             ridge's end, not inside, so vertex 1 meets edge 0. Candidates: B's face 2, N = (−4, 0, 3)/5, with \
             h = 3/5·1/20 (face 1, N = (4, 0, 3)/5, fails for the ridge towards −x); edges 0 × 0 with n = z, h = 1/20; the \
             end's edges 3 and 4, directions (0, ±3, 4), × y give n = ±x, which fails for one of B's slopes. The largest \
             is 0 × 0.",
            WEDGE.along_x().translated(&point(["-2", "0", "1/20"])),
            WEDGE.upside_down_along_y(),
            vec![("v-e", 1, 0, "e-e", 0, 0, "+1/400")],
        ),
    ]
}
