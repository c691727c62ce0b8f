//! Contacts kept from the step before: depth alone does not end them, anything else does.

use super::super::shapes::{Prism, WEDGE, classic, cuboid, leaning_spike, point, revised, slab, spike, step, turn};
use super::{Case, Row};
use rockproof_model::{Block, ContactKey, ContactKind, Vec3};

pub(super) fn cases() -> Vec<Case> {
    let tip_at = |z| [spike(["0", "0", z]), slab()];
    let ridges = |h| [WEDGE.along_x().translated(&point(["0", "0", h])), WEDGE.upside_down_along_y()];
    let deep_corner = || [spike(["4", "4", "-1/100"]), slab()];
    let deep_edge = || [spike(["4", "0", "-1/100"]), slab()];
    let in_step = |x, z| [leaning_spike([x, "0", z]), step()];
    let small_g = [("penetration", "59/10000")];
    vec![
        case(
            "kept_vf",
            "vf_beyond_penetration, the contact kept: h = −51/1000 stays.",
            tip_at("-51/1000"),
            (&[], &[("v-f", 0, 1)]),
            vec![("v-f", 0, 1, "v-f", 0, 1, "-2601/1000000")],
        ),
        case(
            "kept_fv",
            "The same with the blocks exchanged.",
            [slab(), spike(["0", "0", "-51/1000"])],
            (&[], &[("f-v", 1, 0)]),
            vec![("f-v", 1, 0, "f-v", 1, 0, "-2601/1000000")],
        ),
        case(
            "kept_vf_of_another_face",
            "The contact kept is with face 0: (0, 1) is too deep.",
            tip_at("-51/1000"),
            (&[], &[("v-f", 0, 0), ("f-v", 0, 1), ("v-v", 0, 1)]),
            vec![],
        ),
        case(
            "kept_vf_beyond_the_other_block",
            "The tip has gone through a plate 1/25 thick and is 1 below its top: the v-f kept stays, h = −1. It is out of reach \
             of the plate's box.",
            [spike(["0", "0", "-1"]), cuboid(["-4", "-4", "-1/25"], ["4", "4", "0"])],
            (&[], &[("v-f", 0, 1)]),
            vec![("v-f", 0, 1, "v-f", 0, 1, "-1")],
        ),
        case(
            "kept_fv_beyond_the_other_block",
            "The same with the blocks exchanged; the contact is named twice.",
            [cuboid(["-4", "-4", "-1/25"], ["4", "4", "0"]), spike(["0", "0", "-1"])],
            (&[], &[("f-v", 1, 0), ("f-v", 1, 0)]),
            vec![("f-v", 1, 0, "f-v", 1, 0, "-1")],
        ),
        case(
            "kept_ee",
            "ee_beyond_penetration, the contact kept.",
            ridges("-51/1000"),
            (&[], &[("e-e", 0, 0)]),
            vec![("e-e", 0, 0, "e-e", 0, 0, "-2601/1000000")],
        ),
        case(
            "kept_ee_out_of_reach",
            "Ridges that have passed one another by 1: beyond the reach of each other.",
            ridges("-1"),
            (&[], &[("e-e", 0, 0)]),
            vec![("e-e", 0, 0, "e-e", 0, 0, "-1")],
        ),
        case(
            "kept_ee_slanted",
            "kept_ee_out_of_reach with both blocks turned about x: what is between the ridges is along no axis, and the boxes of the edges meet.",
            ridges("-1").map(|block| turned_about_x(&block)),
            (&[], &[("e-e", 0, 0)]),
            vec![("e-e", 0, 0, "e-e", 0, 0, "-1")],
        ),
        case(
            "kept_ee_beyond_the_other_block",
            "The lower ridge's roof is only 1/25 high, and the upper ridge 1 below it, under the whole block; named twice.",
            [
                WEDGE.along_x().translated(&point(["0", "0", "-1"])),
                Prism { p: ["3", "1/25"], q: ["-3", "1/25"], ..WEDGE }.upside_down_along_y(),
            ],
            (&[], &[("e-e", 0, 0), ("e-e", 0, 0)]),
            vec![("e-e", 0, 0, "e-e", 0, 0, "-1")],
        ),
        case(
            "kept_vv",
            "entrance_beyond_penetration, the contact kept: its entrance may be deeper than g.",
            deep_corner(),
            (&small_g, &[("v-v", 0, 6)]),
            vec![("v-v", 0, 6, "f-v", 2, 6, "-9/250000")],
        ),
        case(
            "kept_ve",
            "ve_overlapping with g = 59/10000 < 3/500, the contact kept.",
            deep_edge(),
            (&small_g, &[("v-e", 0, 10)]),
            vec![("v-e", 0, 10, "e-e", 1, 10, "-9/250000")],
        ),
        case(
            "not_kept_ve",
            "The same with the e-v of these numbers kept instead: too deep, and in edge 10's territory there is nothing else.",
            deep_edge(),
            (&small_g, &[("e-v", 10, 0), ("e-e", 1, 10)]),
            vec![],
        ),
        case(
            "kept_ev",
            "kept_ve with the blocks exchanged.",
            [slab(), spike(["4", "0", "-1/100"])],
            (&small_g, &[("e-v", 10, 0)]),
            vec![("e-v", 10, 0, "e-e", 10, 1, "-9/250000")],
        ),
        case(
            "kept_too_far_apart",
            "slope_beyond_search: a contact kept still needs h ≤ s.",
            [spike(["0", "-79/50", "-96/50"]), WEDGE.upside_down_along_x()],
            (&[], &[("v-f", 0, 1), ("e-e", 0, 0), ("e-e", 1, 0)]),
            vec![],
        ),
        case(
            "kept_boxes_apart",
            "boxes_beyond_search: only neighbours have contacts.",
            tip_at("101/1000"),
            (&[], &[("v-f", 0, 1)]),
            vec![],
        ),
        case(
            "kept_takes_part_in_the_shortest_exit",
            "The tip is 4/100 below the step's floor (face 4) and 7/100 behind face 3. Both v-f are in one group, the floor's \
             gap is the larger: (0, 3) goes although it is kept.",
            in_step("393/100", "49/25"),
            (&[], &[("v-f", 0, 3)]),
            vec![("v-f", 0, 4, "v-f", 0, 4, "-1/625")],
        ),
        case(
            "kept_wins_the_shortest_exit",
            "6/100 below the floor and 7/100 behind face 3, both too deep and both kept: the floor's gap is the larger.",
            in_step("393/100", "97/50"),
            (&[], &[("v-f", 0, 3), ("v-f", 0, 4)]),
            vec![("v-f", 0, 4, "v-f", 0, 4, "-9/2500")],
        ),
        case(
            "kept_alone_in_the_shortest_exit",
            "The same with only (0, 3) kept: (0, 4) is too deep, so (0, 3) is the only one.",
            in_step("393/100", "97/50"),
            (&[], &[("v-f", 0, 3)]),
            vec![("v-f", 0, 3, "v-f", 0, 3, "-49/10000")],
        ),
        case(
            "kept_and_one_exit",
            "exit_through_the_top with 3/50 in x, beyond g: the contacts through the side are kept, but leave another way than \
             n* = z and go.",
            [cuboid(["197/50", "-1", "-1/50"], ["8", "1", "3"]), slab()],
            (&[], &[("v-f", 0, 3), ("v-f", 3, 3), ("e-e", 2, 10), ("e-e", 7, 10)]),
            vec![
                ("v-f", 0, 1, "v-f", 0, 1, "-1/2500"),
                ("v-f", 3, 1, "v-f", 3, 1, "-1/2500"),
                ("e-e", 0, 10, "e-e", 0, 10, "-1/2500"),
                ("e-e", 5, 10, "e-e", 5, 10, "-1/2500"),
            ],
        ),
        case(
            "kept_is_the_one_exit",
            "The box is 1/10 behind the side and 3/50 below the top, all too deep. Only (0, 1) and (0, 3) are kept: h* = −3/50, \
             n* = z, and (0, 3) goes.",
            [cuboid(["39/10", "-1", "-3/50"], ["8", "1", "3"]), slab()],
            (&[], &[("v-f", 0, 1), ("v-f", 0, 3)]),
            vec![("v-f", 0, 1, "v-f", 0, 1, "-9/2500")],
        ),
        Case {
            tolerances: classic(&[("overlap_sine", "1")]),
            ..case(
                "kept_ee_of_a_reflex_edge",
                "ridge_across_a_reflex_edge under classic with so = 1, so that every wedge would pass, and the e-e with the reflex edge \
                 8 kept: a reflex edge has no e-e all the same.",
                [WEDGE.along_x().translated(&point(["1", "0", "101/50"])), step()],
                (&[], &[("e-e", 0, 8)]),
                vec![("v-f", 1, 4, "v-f", 1, 4, "+1/2500")],
            )
        },
    ]
}

/// The block turned about x by the angle of cosine 4/5.
fn turned_about_x(block: &Block) -> Block {
    let vertices = block.vertices().iter().map(|v| {
        let (y, z) = turn(&v.y, &v.z, ["4/5", "3/5"]);
        Vec3::new(v.x.clone(), y, z)
    });
    block.with_vertices(vertices.collect())
}

/// Tolerances changed by name, and the contacts kept.
type Given<'t> = (&'t [(&'t str, &'t str)], &'t [(&'t str, u32, u32)]);

fn case(
    name: &'static str,
    derivation: &'static str,
    [a, b]: [Block; 2],
    (changes, kept): Given<'_>,
    expected: Vec<Row>,
) -> Case {
    let kept = kept.iter().map(|&(kind, a, b)| ContactKey::of_kind(ContactKind::from_name(kind).unwrap(), [a, b]));
    Case { name, derivation, a, b, tolerances: revised(changes), kept: kept.collect(), expected }
}
