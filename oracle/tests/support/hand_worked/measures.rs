//! Dips and near parallels are measured twice under `revised`, by angle and by length, and both must hold; under `classic` the
//! angle alone counts. Each measure exactly met while the other has room, both exactly met, and each missed by 2⁻⁴⁰ of it.
//!
//! Version 1 of SPEC was read as either: there a short face passed at any angle, and a small angle at any length.

use super::super::shapes::{Prism, WEDGE, classic, just_below, revised, slab, tetrahedron};
use super::{Case, Row};
use rockproof_model::{Block, ToleranceSet};

pub(super) fn cases() -> Vec<Case> {
    [cones(), wedges(), parallels()].into_iter().flatten().collect()
}

/// Two tolerances by name; those not given are as in all cases.
type Two<'t> = [(&'t str, &'t str); 2];

fn case(
    (name, derivation): (&'static str, &'static str),
    [a, b]: [Block; 2],
    tolerances: ToleranceSet,
    expected: Vec<Row>,
) -> Case {
    Case { name, derivation, a, b, tolerances, kept: Vec::new(), expected }
}

/// The tip is 1/20 above the middle of the slab's top. Its edge to vertex 1 is 1/20 long with direction (4, 0, −3)/5: it dips
/// with sine 3/5 and by 3/100. Vertex 1, 1/50 above the top, has rising edges only.
fn cones() -> Vec<Case> {
    let blocks = || {
        [tetrahedron([["0", "0", "1/20"], ["1/25", "0", "1/50"], ["-3", "3", "81/20"], ["-3", "-3", "81/20"]]), slab()]
    };
    let both = || vec![("v-f", 0, 1, "v-f", 0, 1, "+1/400"), ("v-f", 1, 1, "v-f", 1, 1, "+1/2500")];
    let lower = || vec![("v-f", 1, 1, "v-f", 1, 1, "+1/2500")];
    let set = |so, g| -> Two<'_> { [("overlap_sine", so), ("penetration", g)] };
    let (below_angle, below_length) = (just_below("3/5"), just_below("3/100"));
    vec![
        case(
            (
                "cone_exactly_overlap_angle",
                "so = 3/5 is the sine of the dip, g = 1/20 more than its length: it passes.",
            ),
            blocks(),
            revised(&set("3/5", "1/20")),
            both(),
        ),
        case(
            ("cone_beyond_overlap_angle", "so a little less: the angle fails, though the length has room."),
            blocks(),
            revised(&set(&below_angle, "1/20")),
            lower(),
        ),
        case(
            ("cone_exactly_penetration_length", "so = 7/10 leaves room, g = 3/100 is the dip: it passes."),
            blocks(),
            revised(&set("7/10", "3/100")),
            both(),
        ),
        case(
            ("cone_beyond_penetration_length", "g a little less: the length fails, though the angle has room."),
            blocks(),
            revised(&set("7/10", &below_length)),
            lower(),
        ),
        case(
            ("cone_exactly_both", "so = 3/5 and g = 3/100, both exactly met: it passes."),
            blocks(),
            revised(&set("3/5", "3/100")),
            both(),
        ),
        case(
            ("cone_angle_classic", "Under classic the angle is enough, though g = 0."),
            blocks(),
            classic(&set("3/5", "0")),
            both(),
        ),
        case(
            ("cone_length_classic", "Under classic the length is of no use."),
            blocks(),
            classic(&set(&below_angle, "1/20")),
            lower(),
        ),
    ]
}

/// A ridge along x, 7/100 over a ridge along y. Its face to p, w = 1/12 wide, descends by 3 in 5, so n = z (the other face
/// rises and is larger), the dip has sine 3/5 and is w·3/5 = 1/20 long. p's edge (5) is 2/100 over B's ridge; both of its
/// faces rise.
fn wedges() -> Vec<Case> {
    let blocks = || {
        let prism = Prism { half: "2", p: ["1/15", "-1/20"], q: ["0", "5"], offset: ["0", "0", "7/100"] };
        [prism.along_x(), WEDGE.upside_down_along_y()]
    };
    let both = || vec![("e-e", 0, 0, "e-e", 0, 0, "+49/10000"), ("e-e", 5, 0, "e-e", 5, 0, "+1/2500")];
    let lower = || vec![("e-e", 5, 0, "e-e", 5, 0, "+1/2500")];
    let set = |so, g| -> Two<'_> { [("overlap_sine", so), ("penetration", g)] };
    let (below_angle, below_length) = (just_below("3/5"), just_below("1/20"));
    vec![
        case(
            (
                "wedge_exactly_overlap_angle",
                "so = 3/5 is the sine of the dip, g = 1/16 more than its length: it passes.",
            ),
            blocks(),
            revised(&set("3/5", "1/16")),
            both(),
        ),
        case(
            ("wedge_beyond_overlap_angle", "so a little less: the angle fails, though the length has room."),
            blocks(),
            revised(&set(&below_angle, "1/16")),
            lower(),
        ),
        case(
            ("wedge_exactly_penetration_length", "so = 7/10 leaves room, g = 1/20 is the dip: it passes."),
            blocks(),
            revised(&set("7/10", "1/20")),
            both(),
        ),
        case(
            ("wedge_beyond_penetration_length", "g a little less: the length fails, though the angle has room."),
            blocks(),
            revised(&set("7/10", &below_length)),
            lower(),
        ),
        case(
            ("wedge_exactly_both", "so = 3/5 and g = 1/20, both exactly met: it passes."),
            blocks(),
            revised(&set("3/5", "1/20")),
            both(),
        ),
        case(
            ("wedge_angle_classic", "Under classic the angle is enough, though g = 0."),
            blocks(),
            classic(&set("3/5", "0")),
            both(),
        ),
        case(
            ("wedge_length_classic", "Under classic the length is of no use."),
            blocks(),
            classic(&set(&below_angle, "1/20")),
            lower(),
        ),
    ]
}

/// Ridges 40 and 6 long, 1/20 apart, at an angle of sine 3/5: |d1 × d2| = 144 = r·40 with r = 18/5. The territories stay small,
/// λ·5 for vertices and edges, and the nearest end is 9/5 from the other ridge: they decide nothing here. Either the ridges
/// cross, or they are nearly parallel and there is no contact.
fn parallels() -> Vec<Case> {
    let blocks = || {
        let long = Prism { half: "20", offset: ["0", "0", "1/20"], ..WEDGE };
        [long.turned(), Prism { half: "3", ..WEDGE }.upside_down_along_x()]
    };
    let crossing = || vec![("e-e", 0, 0, "e-e", 0, 0, "+1/400")];
    let set = |sp, r| -> Two<'_> { [("parallel_sine", sp), ("territory", r)] };
    let (below_angle, below_length) = (just_below("3/5"), just_below("18/5"));
    vec![
        case(
            ("exactly_parallel_angle", "sp = 3/5 is the sine of the angle, r = 4 has room: nearly parallel."),
            blocks(),
            revised(&set("3/5", "4")),
            vec![],
        ),
        case(
            ("just_beyond_parallel_angle", "sp a little less: crossing, though r = 4 has room."),
            blocks(),
            revised(&set(&below_angle, "4")),
            crossing(),
        ),
        case(
            ("exactly_parallel_length", "sp = 7/10 has room, r = 18/5 is exactly met: nearly parallel."),
            blocks(),
            revised(&set("7/10", "18/5")),
            vec![],
        ),
        case(
            ("just_beyond_parallel_length", "r a little less: crossing, though sp has room."),
            blocks(),
            revised(&set("7/10", &below_length)),
            crossing(),
        ),
        case(
            ("exactly_parallel_both", "sp = 3/5 and r = 18/5, both exactly met: nearly parallel."),
            blocks(),
            revised(&set("3/5", "18/5")),
            vec![],
        ),
        case(
            ("parallel_angle_classic", "Under classic the angle is enough, though r = 0."),
            blocks(),
            classic(&set("3/5", "0")),
            vec![],
        ),
        case(
            ("parallel_length_classic", "Under classic the length is of no use."),
            blocks(),
            classic(&set(&below_angle, "4")),
            crossing(),
        ),
    ]
}
