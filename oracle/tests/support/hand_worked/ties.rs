//! Each tolerance exactly met, and missed by a little; those of dips and near parallels are in `measures`.

use super::super::shapes::{Prism, WEDGE, classic, cuboid, flat_corner, point, revised, slab, spike};
use super::Case;
use rockproof_model::{Block, ToleranceSet};

pub(super) fn cases() -> Vec<Case> {
    [search(), penetration(), territory(), sides(), equality()].into_iter().flatten().collect()
}

fn case(
    name: &'static str,
    derivation: &'static str,
    [a, b]: [Block; 2],
    tolerances: ToleranceSet,
    expected: Vec<super::Row>,
) -> Case {
    Case { name, derivation, a, b, tolerances, kept: Vec::new(), expected }
}

/// A tip at distance h above the middle of a slope with N = (0, −4, 3)/5: its edges 0 and 1 run along the slope.
fn tip_over_slope(y: &str, z: &str) -> [Block; 2] {
    [spike(["0", y, z]), WEDGE.upside_down_along_x()]
}

fn search() -> Vec<Case> {
    let set = || revised(&[]);
    let ridges = |h| [WEDGE.along_x().translated(&point(["0", "0", h])), WEDGE.upside_down_along_y()];
    vec![
        case(
            "vf_exactly_search",
            "h = 1/10 = s, and the grown box just touches: both ties count.",
            [spike(["0", "0", "1/10"]), slab()],
            set(),
            vec![("v-f", 0, 1, "v-f", 0, 1, "+1/100")],
        ),
        case(
            "boxes_beyond_search",
            "h = 101/1000 > s: A's box grown by s ends 1/1000 above B's.",
            [spike(["0", "0", "101/1000"]), slab()],
            set(),
            vec![],
        ),
        case(
            "slope_exactly_search",
            "The tip is at (0, −3/2, −2) + 1/10·(0, −4, 3)/5, over the middle of face 1. Its edges (±3, 3, 4) have e·N = 0, \
             the other two rise. Along those two A's face 1 is parallel to the slope, and they pass the ridge (edge 0) half \
             way, at x = ±3/2, inside its ±2: e-e with n = (0, −4, 3)/5 and the same h; the inward directions in the parallel \
             faces have n·m = 0. The ridge's ends lie outside A's face 1, which spans ±3/2 there. All h = s.",
            tip_over_slope("-79/50", "-97/50"),
            set(),
            vec![
                ("v-f", 0, 1, "v-f", 0, 1, "+1/100"),
                ("e-e", 0, 0, "e-e", 0, 0, "+1/100"),
                ("e-e", 1, 0, "e-e", 1, 0, "+1/100"),
            ],
        ),
        case(
            "slope_beyond_search",
            "As slope_exactly_search, a little higher: h > s for all three, though the boxes overlap.",
            tip_over_slope("-79/50", "-96/50"),
            set(),
            vec![],
        ),
        case(
            "ee_exactly_search",
            "Crossing ridges with h = 1/10 = s.",
            ridges("1/10"),
            set(),
            vec![("e-e", 0, 0, "e-e", 0, 0, "+1/100")],
        ),
        case(
            "ve_exactly_search",
            "The tip is at (6/100, 8/100) from edge 10 in (x, z): distance 1/10 = s, in its region, and the foot in the \
             tip's: (−6, 0, −8)·(−3, ±3, 4) = −14 < 0. Face 1 gives h = 8/100; edges 1 and 2 × 10 with n = (4, 0, 3)/5 give \
             48/500 = 12/125, larger; edge 1 is first. No e-e contact: the perpendicular meets A's edges before the tip.",
            [spike(["203/50", "0", "2/25"]), slab()],
            set(),
            vec![("v-e", 0, 10, "e-e", 1, 10, "+144/15625")],
        ),
        case(
            "ve_beyond_search",
            "As ve_exactly_search with the tip 1/1000 higher: the distance to the line exceeds s; the boxes still meet.",
            [spike(["203/50", "0", "81/1000"]), slab()],
            set(),
            vec![],
        ),
        case(
            "vv_exactly_search",
            "The same offset (6/100, 0, 8/100) from corner 6: |a−b| = s, each in the other's region. Face 1 gives 8/100; A's \
             face 2 (144 + 144)/30/100 = 12/125, face 3 6/125; e-e with (4, 0, 3)/5 12/125. The largest: f-v before e-e.",
            [spike(["203/50", "4", "2/25"]), slab()],
            set(),
            vec![("v-v", 0, 6, "f-v", 2, 6, "+144/15625")],
        ),
        case(
            "vv_beyond_search",
            "As vv_exactly_search with the tip 1/1000 higher: no v-v; all feet on the corner's edges at or past their ends; \
             the corner's foot on A's faces lies below the tip.",
            [spike(["203/50", "4", "81/1000"]), slab()],
            set(),
            vec![],
        ),
    ]
}

fn penetration() -> Vec<Case> {
    let ridges = |h| [WEDGE.along_x().translated(&point(["0", "0", h])), WEDGE.upside_down_along_y()];
    let deep_corner = || [spike(["4", "4", "-1/100"]), slab()];
    vec![
        case(
            "vf_exactly_penetration",
            "h = −1/20 = −g: still recorded.",
            [spike(["0", "0", "-1/20"]), slab()],
            revised(&[]),
            vec![("v-f", 0, 1, "v-f", 0, 1, "-1/400")],
        ),
        case(
            "vf_beyond_penetration",
            "h = −51/1000 < −g: too deep for v-f, and nothing else is near.",
            [spike(["0", "0", "-51/1000"]), slab()],
            revised(&[]),
            vec![],
        ),
        case(
            "ee_exactly_penetration",
            "Crossing ridges with h = −1/20 = −g.",
            ridges("-1/20"),
            revised(&[]),
            vec![("e-e", 0, 0, "e-e", 0, 0, "-1/400")],
        ),
        case(
            "ee_beyond_penetration",
            "Crossing ridges with h = −51/1000 < −g.",
            ridges("-51/1000"),
            revised(&[]),
            vec![],
        ),
        case(
            "entrance_exactly_penetration",
            "vv_overlapping with g = 3/500: the chosen entrance has h = −3/500 = −g, which confirms it.",
            deep_corner(),
            revised(&[("penetration", "3/500")]),
            vec![("v-v", 0, 6, "f-v", 2, 6, "-9/250000")],
        ),
        case(
            "entrance_beyond_penetration",
            "vv_overlapping with g = 59/10000 < 3/500: not confirmed, and the territory keeps every other contact away.",
            deep_corner(),
            revised(&[("penetration", "59/10000")]),
            vec![],
        ),
    ]
}

fn territory() -> Vec<Case> {
    let thin = || cuboid(["-4", "-4", "-1/25"], ["4", "4", "0"]);
    let small_g = || revised(&[("penetration", "1/100")]);
    vec![
        case(
            "ve_exactly_territory",
            "The tip is over face 1, at (−3/250, 4/250) from edge 10: distance 1/50 = r, so it belongs to the edge. Face 1 \
             gives h = 2/125, e-e with (4, 0, 3)/5 gives 0.",
            [spike(["997/250", "0", "2/125"]), slab()],
            revised(&[]),
            vec![("v-e", 0, 10, "v-f", 0, 1, "+4/15625")],
        ),
        case(
            "vf_just_outside_territory",
            "As ve_exactly_territory, 1/1000 further in: beyond r and not in the edge's region (it is over the face).",
            [spike(["3987/1000", "0", "2/125"]), slab()],
            revised(&[]),
            vec![("v-f", 0, 1, "v-f", 0, 1, "+4/15625")],
        ),
        case(
            "vv_exactly_territory",
            "The tip is at (−3/250, 0, 4/250) from corner 6: distance 1/50 = r, so it belongs to the corner, though it is \
             in edge 11's territory too. Face 1 gives 2/125; A's face 2 and e-e with (4, 0, 3)/5 give 0.",
            [spike(["997/250", "4", "2/125"]), slab()],
            revised(&[]),
            vec![("v-v", 0, 6, "v-f", 0, 1, "+4/15625")],
        ),
        case(
            "ve_just_outside_corner_territory",
            "As vv_exactly_territory, 1/1000 further along edge 11 (y = 4), 2/125 ≤ r straight above it. Face 1 gives \
             2/125, e-e with (0, 4, 3)/5 less.",
            [spike(["3987/1000", "4", "2/125"]), slab()],
            revised(&[]),
            vec![("v-e", 0, 11, "v-f", 0, 1, "+4/15625")],
        ),
        case(
            "sliver_exactly_territory",
            "The slab is 1/25 thick: r_e of edge 10 is λ·1/25 = 1/100 < r. The tip is at (−3/500, 4/500): distance 1/100 = r_e. \
             Face 1 gives 1/125, e-e 0. g = 1/100 keeps the lower side out of it.",
            [spike(["1997/500", "0", "1/125"]), thin()],
            small_g(),
            vec![("v-e", 0, 10, "v-f", 0, 1, "+1/15625")],
        ),
        case(
            "thin_corner_exactly_territory",
            "The thin slab again: the shortest edge at its corner 6 is 1/25, r_b = 1/100, less than the tip's 1/50. The tip is at \
             (−3/500, 0, 4/500) from it: distance 1/100. Face 1 gives 1/125, A's face 3 and e-e with (0, 4, 3)/5 give 3/625, \
             A's face 2 and e-e with (4, 0, 3)/5 give 0.",
            [spike(["1997/500", "4", "1/125"]), thin()],
            small_g(),
            vec![("v-v", 0, 6, "v-f", 0, 1, "+1/15625")],
        ),
        case(
            "thin_corner_just_outside_territory",
            "As thin_corner_exactly_territory, 1/1000 further along edge 11: beyond the smaller of the two radii, in the \
             territory of that edge (1/125 ≤ λ·1/25).",
            [spike(["3993/1000", "4", "1/125"]), thin()],
            small_g(),
            vec![("v-e", 0, 11, "v-f", 0, 1, "+1/15625")],
        ),
        case(
            "corner_territory_beyond_edge_territory",
            "The tip is at (1, 1, 1)/100 from vertex 0 of a flat corner: 0.0173 ≤ r, in the vertex's territory, while it is \
             0.0141 from its edges 0 and 1, whose territory is λ·1/25 = 1/100. So v-v and not v-f, though it is over the inside of \
             face 1 (N = +z, h = 1/100). Of the other candidates, A's faces 1 and 4 and edges 1 and 2 with x, 0 and 1 with y have \
             sideways normals like (0, −4, 3)/5 and h < 1/100.",
            [spike(["1/100", "1/100", "1/100"]), flat_corner()],
            revised(&[]),
            vec![("v-v", 0, 0, "v-f", 0, 1, "+1/10000")],
        ),
        case(
            "sliver_just_outside_territory",
            "As sliver_exactly_territory, 1/1000 further in: beyond r_e although within r.",
            [spike(["3993/1000", "0", "1/125"]), thin()],
            small_g(),
            vec![("v-f", 0, 1, "v-f", 0, 1, "+1/15625")],
        ),
    ]
}

fn sides() -> Vec<Case> {
    // A blade along x towards y+, 1/20 over a blade along y towards x+, each opening by 3 in 5 to either side.
    let blades = || {
        let blade = |half, offset| Prism { half, p: ["4", "-3"], q: ["4", "3"], offset };
        [blade("3", ["0", "0", "1/20"]).along_x(), blade("2", ["0", "0", "0"]).upside_down_along_y()]
    };
    vec![
        case(
            "wedges_on_no_side",
            "Two blades lying flat, their sections symmetrical about the horizontal: n·(m_L + m_R) is 0 for both, so σ counts as \
             +: n = d1 × d2 = 24 z, h = 1/20 (with − it would be −1/20). All four inward directions have sine ±3/5 along n, the \
             two on the wrong side just within so, which is enough under classic. The blades' other edges are more than s \
             from each other's.",
            blades(),
            classic(&[("overlap_sine", "3/5")]),
            vec![("e-e", 0, 0, "e-e", 0, 0, "+1/400")],
        ),
        case(
            "parallel_ridges",
            "Exactly parallel ridges, 1/20 apart, of one length, one shifted by 1 along them: |d1 × d2| = 0 is nearly parallel \
             even with sp = r = 0. Vertex 1 of A is over B's ridge (−2 to 2), B's vertex 0, turned over with y, z but not x, \
             at x = −2, is under A's (−3 to 1). Each belongs to the other edge's region. Entrance of v-e (1, 0): B's face \
             planes have the end's edges (0, ±3, 4) on or above, and the ridge along them: both pass with h = 3/5·1/20; \
             edges 3 and 4 × x: n = (0, 4, −3)/5 up to sign, for which A's slope passes and B's has sine 0 and the other \
             descends: also 3/5·1/20, e-e, later in order. Face 1 is first. e-v alike.",
            [WEDGE.along_x().translated(&point(["-1", "0", "1/20"])), WEDGE.upside_down_along_x()],
            revised(&[("territory", "0")]),
            vec![("v-e", 1, 0, "v-f", 1, 1, "+9/10000"), ("e-v", 0, 0, "f-v", 1, 0, "+9/10000")],
        ),
    ]
}

fn equality() -> Vec<Case> {
    let deep_corner = || [spike(["4", "4", "-1/100"]), slab()];
    vec![
        case(
            "exactly_equal",
            "vv_overlapping with ε = 2/3: −1/100 = −3/500·(1 + 2/3), so face 1 equals the best by Eq. (1) and is first.",
            deep_corner(),
            revised(&[("equal", "2/3")]),
            vec![("v-v", 0, 6, "v-f", 0, 1, "-1/10000")],
        ),
        case(
            "not_quite_equal",
            "vv_overlapping with ε = 333/500 < 2/3: only the candidates at −3/500 tie.",
            deep_corner(),
            revised(&[("equal", "333/500")]),
            vec![("v-v", 0, 6, "f-v", 2, 6, "-9/250000")],
        ),
        case(
            "exactly_equal_apart",
            "vv_apart with ε = 2/5: best 1/20, threshold 3/100 = 3/5·1/20, so all tie; v-f is first and was the best.",
            [spike(["4", "4", "1/20"]), slab()],
            revised(&[("equal", "2/5")]),
            vec![("v-v", 0, 6, "v-f", 0, 1, "+1/400")],
        ),
        case(
            "exactly_equal_apart_sideways",
            "ve_exactly_search with ε = 1/6: best 12/125 = 96/1000, threshold 80/1000, which face 1 meets; v-f is first.",
            [spike(["203/50", "0", "2/25"]), slab()],
            revised(&[("equal", "1/6")]),
            vec![("v-e", 0, 10, "v-f", 0, 1, "+4/625")],
        ),
    ]
}
