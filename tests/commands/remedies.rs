//! What errors about meshes say is true of the file and can be followed.
//!
//! Caught: advice that the file had followed already, or that led to another error, and errors without any.

use crate::place::Place;

/// The faces of a box by the numbers of its corners, from 1: first the lower four, then those above them.
const FACES: [[usize; 4]; 6] = [[1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];

/// The corners of a box.
fn corners([low, high]: [[f64; 3]; 2]) -> Vec<[f64; 3]> {
    let ring = |z: f64| [[low[0], low[1], z], [high[0], low[1], z], [high[0], high[1], z], [low[0], high[1], z]];
    [ring(low[2]), ring(high[2])].concat()
}

/// Boxes as OBJ, each turned inside out or not.
fn obj(boxes: &[([[f64; 3]; 2], bool)]) -> String {
    obj_behind(0, boxes)
}

/// The same behind so many vertices.
fn obj_behind(first: usize, boxes: &[([[f64; 3]; 2], bool)]) -> String {
    let vertices = boxes.iter().flat_map(|(ends, _)| corners(*ends)).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = boxes.iter().enumerate().flat_map(|(number, (_, is_turned))| {
        FACES.iter().map(move |face| {
            let [a, b, c, d] = face.map(|corner| first + corner + 8 * number);
            if *is_turned { format!("f {d} {c} {b} {a}\n") } else { format!("f {a} {b} {c} {d}\n") }
        })
    });
    vertices.chain(faces).collect()
}

const UNIT: [[f64; 3]; 2] = [[0.0; 3], [1.0; 3]];
const LARGE: [[f64; 3]; 2] = [[-1.0; 3], [2.0; 3]];

/// Exit code and stderr of `check`.
fn checked(name: &str, contents: &str) -> (i32, String) {
    let place = Place::new();
    place.file(name, contents);
    let (code, _, err) = place.run(&["check", name]);
    (code, err)
}

#[test]
fn a_cavity_is_called_so_and_a_block_inside_out_beside_another_is_not() {
    for boxes in [[(LARGE, false), (UNIT, true)], [(UNIT, true), (LARGE, false)]] {
        let (code, err) = checked("void.obj", &obj(&boxes));
        assert!(
            code == 2 && err.contains("its faces run clockwise seen from outside, and it lies within \"block_"),
            "{err}"
        );
        assert!(err.contains("a cavity, which no block can have; split \"block_"), "{err}");
        assert!(!err.contains("must be above zero"), "{err}");
    }
    // Beside it, around it, and in the notch of a block that goes round it on three sides.
    let beside = [[3.0; 3], [4.0; 3]];
    let mut notched = String::new();
    let outline = [[-2, -2], [3, -2], [3, 3], [2, 3], [2, -1], [-1, -1], [-1, 3], [-2, 3]];
    for z in [-1, 2] {
        outline.iter().for_each(|[x, y]| notched += &format!("v {x} {y} {z}\n"));
    }
    let numbers = |numbers: Vec<usize>| numbers.iter().map(|n| format!(" {n}")).collect::<String>();
    notched += &format!("f{}\nf{}\n", numbers((1..=8).rev().collect()), numbers((9..=16).collect()));
    (0..8).for_each(|k| {
        let next = (k + 1) % 8;
        notched += &format!("f {} {} {} {}\n", k + 1, next + 1, next + 9, k + 9);
    });
    for text in [
        obj(&[(LARGE, false), (beside, true)]),
        obj(&[(LARGE, true), (UNIT, false)]),
        notched + &obj_behind(16, &[(UNIT, true)]),
    ] {
        let (code, err) = checked("turned.obj", &text);
        assert!(code == 2 && err.contains("it must be above zero, with every face counter-clockwise"), "{err}");
        assert!(!err.contains("cavity"), "{err}");
    }
}

/// A box with a smaller one pressed into its top: the four quadrangles around the pocket are one face.
#[test]
fn a_face_around_a_pocket_asks_for_several_blocks() {
    let text = obj(&[([[0.0; 3], [3.0; 3]], false), ([[1.0, 1.0, 2.0], [2.0, 2.0, 3.0]], true)]);
    let without_tops = text.replace("f 5 6 7 8\n", "").replace("f 16 15 14 13\n", "");
    let ring = "f 5 6 14 13\nf 6 7 15 14\nf 7 8 16 15\nf 8 5 13 16\n";
    let (code, err) = checked("pocket.obj", &(without_tops + ring));
    assert!(code == 2 && err.contains("gives a face with a hole, which one loop cannot describe; split the"), "{err}");
}

#[test]
fn corners_of_a_box_that_are_exchanged_or_flat_are_named() {
    let scene = |min: &str, max: &str| format!("[[block]]\nbox = {{ min = {min}, max = {max} }}\n");
    let said = |min, max| checked("box.toml", &scene(min, max));
    let (code, err) = said("[2, 2, 2]", "[1, 1, 1]");
    assert_eq!(code, 2);
    assert!(
        err.contains("box.toml:2: x of `min` of `box` is 2; allowed is below x of `max`, 1: min and max are"),
        "{err}"
    );
    let (_, err) = said("[0, 0, \"1/3\"]", "[1, 1, \"1/3\"]");
    assert!(
        err.contains("z of `min` of `box` is 1/3; allowed is below z of `max`, 1/3: the box would be flat"),
        "{err}"
    );
    assert_eq!(said("[0, 0, 0]", "[1, 1, \"1/3\"]").0, 0);
}

#[test]
fn a_file_with_the_name_of_another_format_is_told_what_it_looks_like() {
    let text = obj(&[(UNIT, false)]);
    for command in ["check", "classify"] {
        let place = Place::new();
        place.file("box.stl", &text);
        let (code, _, err) = place.run(&[command, "box.stl"]);
        assert_eq!(code, 2);
        assert!(err.contains("box.stl is read as stl and begins as obj does: --input-format obj"), "{err}");
        assert_eq!(place.run(&[command, "box.stl", "--input-format", "obj"]).0, 0);
    }
    // A binary STL without triangles.
    let place = Place::new();
    std::fs::write(place.path("binary.obj"), [0u8; 84]).expect("written");
    let (_, _, err) = place.run(&["check", "binary.obj"]);
    assert!(err.contains("not text") && err.contains("begins as stl does: --input-format stl"), "{err}");
    let (_, err) = checked("broken.obj", &text.replace("f 1 4 3 2", "f 1 4 3 99"));
    assert!(!err.contains("--input-format"), "{err}");
    // Letters of two bytes look like those of another format.
    let wide: Vec<u8> = "\u{feff}<a b=\"\">".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for name in ["wide.vtu", "wide.stl", "wide.ply"] {
        std::fs::write(place.path(name), &wide).expect("written");
        let (code, _, err) = place.run(&["check", name]);
        assert!(code == 2 && err.starts_with(&format!("error: {name}: this is a text in UTF-16; ")), "{err}");
        assert!(!err.contains("--input-format"), "{err}");
    }
}

#[test]
fn an_overlap_deeper_than_territory_is_told_the_territory_that_sees_it() {
    let place = Place::new();
    let boxes = |depth: f64| {
        let [low, high] = [[[0.0; 3], [4.0, 4.0, 1.0]], [[0.0, 0.0, 1.0 - depth], [4.0, 4.0, 2.0]]];
        obj(&[(low, false), (high, false)])
    };
    place.file("flush.obj", &boxes(0.018));
    let (code, out, err) = place.run(&["check", "flush.obj"]);
    assert!(code == 1 && out.contains("(0 seen, 0 shallow, 1 unseen)"), "{out}{err}");
    let told = "1 pair overlaps deeper than territory (0.0125 m), and at boundaries contacts do not see that; they do with --set ";
    let remedy = out.split(told).nth(1).and_then(|rest| rest.lines().next()).expect("a remedy");
    let (code, out, err) = place.run(&["check", "flush.obj", "--set", remedy]);
    assert!(code == 0 && out.contains("(1 seen, 0 shallow)"), "{remedy}: {out}{err}");
    // Not where penetration is what it is deeper than, nor where it is seen.
    for depth in [0.03, 0.004] {
        place.file("other.obj", &boxes(depth));
        assert!(!place.run(&["check", "other.obj"]).1.contains("deeper than territory"), "{depth}");
    }
}

#[test]
fn a_territory_of_zero_is_not_told_to_move_the_blocks_into_the_origin() {
    let place = Place::new();
    place.file("box.obj", &obj(&[(LARGE, false)]));
    let (code, out, _) = place.run(&["check", "box.obj", "--set", "territory=0"]);
    assert!(code == 1 && out.contains("territory ≥ ") && !out.contains("all coordinates"), "{out}");
    // Unless that is all that helps: no territory is above the roundings there and within a quarter of the shortest edge.
    place.file("far.obj", &obj(&[([[1e6, 0.0, 0.0], [1_000_001.0, 1.0, 1.0]], false)]));
    let (code, out, _) = place.run(&["check", "far.obj", "--precision", "f32", "--set", "territory=0"]);
    let told = "    satisfied  by territory ≥ 2⁸·eps·(largest coordinate) and all coordinates ≤ 8191.9";
    assert!(code == 1 && out.contains(told), "{out}");
    let (_, out, _) = place.run(&["check", "box.obj", "--set", "territory=1e-30"]);
    assert!(out.contains(" or all coordinates ≤ "), "{out}");
}

#[test]
fn a_name_that_begins_with_a_hyphen_is_no_option_in_the_next_command() {
    let place = Place::new();
    let boxes = [(LARGE, false), ([[-1.0, -1.0, 2.0], [2.0, 2.0, 3.0]], false)];
    place.file("-x.obj", &obj(&boxes));
    let (_, out, err) = place.run(&["examine", "--no-tune", "--out", "r", "--", "-x.obj"]);
    let next = out
        .lines()
        .find_map(|line| line.trim().strip_prefix("next: rockproof "))
        .unwrap_or_else(|| panic!("{out}{err}"));
    assert!(next.contains(" ./-x.obj"), "{next}");
    let words: Vec<&str> = next.split(' ').collect();
    assert_ne!(place.run(&words).0, 2, "{next}");
}

const DDA: &str = include_str!("../../cases/real/smallAngle.dda");

#[test]
fn a_count_of_points_that_is_wrong_is_told_at_its_line() {
    for (count, said) in [("13", "is 13; allowed is 12"), ("11", "is 11; allowed is 12")] {
        let (code, err) = checked("a.dda", &DDA.replace("POINTS 12", &format!("POINTS {count}")));
        let told = format!("a.dda:6: the number of points {said}, as many as follow up to line 18");
        assert!(code == 2 && err.contains(&told), "{err}");
    }
}

#[test]
fn numbers_of_fortran_are_read_in_dda() {
    let place = Place::new();
    place.file("e.dda", DDA);
    place.file("d.dda", &DDA.replace("0 3.0 0\n", "0 0.3D+1 0\n").replace("-4.0", "-4.0d0"));
    assert_ne!(DDA, DDA.replace("0 3.0 0\n", ""));
    let said = |name: &str| {
        let (code, out, err) = place.run(&["check", name]);
        (code, out.replace(name, ""), err)
    };
    assert_eq!(said("d.dda"), said("e.dda"));
    let (code, err) = checked("a.dda", &DDA.replace("0 3.0 0\n", "0 3.0DD0 0\n"));
    assert!(code == 2 && err.contains("found \"3.0DD0\""), "{err}");
    // What stands in the file is told, not what was made of it.
    let (code, err) = checked("a.dda", &DDA.replace("0 3.0 0\n", "0 3.0D400 0\n"));
    assert!(code == 2 && err.contains("3.0D400") && !err.contains("3.0e400"), "{err}");
}

#[test]
fn lines_and_points_of_obj_are_skipped_with_their_vertices() {
    let text = obj(&[(UNIT, false)]);
    let (code, err) = checked("loose.obj", &format!("{text}v 9 9 9\nv 9 9 8\nl 9 10\np -1\n"));
    assert_eq!(code, 0, "{err}");
    let (code, err) = checked("loose.obj", &format!("{text}v 9 9 9\nv 9 9 8\nl 9 11\n"));
    assert!(code == 2 && err.contains("a vertex number of a line is 11; allowed is 1 to 10"), "{err}");
    let (code, err) = checked("loose.obj", &format!("{text}p 9\n"));
    assert!(code == 2 && err.contains("a vertex number of a point is 9; allowed is 1 to 8"), "{err}");
    let (code, err) = checked("loose.obj", &format!("{text}l 1 x\n"));
    assert!(code == 2 && err.contains("a vertex of a line: i, "), "{err}");
    let (code, err) = checked("loose.obj", &format!("{text}f 1 2 9\n"));
    assert!(code == 2 && err.contains("a vertex number of a face is 9"), "{err}");
    let (code, err) = checked("loose.obj", &format!("{text}v 9 9 9\n"));
    assert!(code == 2 && err.contains("vertex 9 of the file is in no face"), "{err}");
}

#[test]
fn cells_of_legacy_vtk_are_read() {
    let points: String = corners(UNIT).iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let grid = |cell: &str, kind: u32| {
        let size = cell.split(' ').count();
        format!(
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n{points}CELLS 1 {size}\n{cell}\nCELL_TYPES 1\n{kind}\n"
        )
    };
    // Also with the upper side first, which makes a cell of the other hand; a voxel has its corners in another order.
    for (cell, kind) in [("8 0 1 2 3 4 5 6 7", 12), ("8 4 5 6 7 0 1 2 3", 12), ("8 0 1 3 2 4 5 7 6", 11)] {
        let place = Place::new();
        place.file("hex.vtk", &grid(cell, kind));
        let (code, out, err) = place.run(&["check", "hex.vtk"]);
        assert!(code == 0 && out.contains("1.000000 m³") && out.contains("faces                6"), "{out}{err}");
    }
    for (cell, kind, said) in [
        ("7 0 1 2 3 4 5 6", 12, "the number of points of cell 0, a hexahedron, is 7; allowed is 8"),
        ("8 0 1 2 3 4 5 6 8", 12, "a point number of a cell is 8; allowed is 0 to 7"),
        // In the order of a voxel: loops that cross themselves and go round as much one way as the other.
        ("8 0 1 3 2 4 5 7 6", 12, "encloses nothing; its vertices must follow one another round the face"),
        ("8 0 1 2 3 4 5 6 7", 25, "cell 0 of type 25 cannot be read; types that can are 10 (tetrahedron)"),
        ("4 0 1 2 4", 10, "point 3 is in no cell"),
    ] {
        let (code, err) = checked("hex.vtk", &grid(cell, kind));
        assert!(code == 2 && err.contains(said), "{err}");
    }
}

#[test]
fn faces_without_area_open_edges_and_bent_faces_have_a_remedy() {
    // A corner in the middle of an edge of one face alone; with a face without area beside it the surface is closed.
    let text = obj(&[(UNIT, false)]).replace("f 1 4 3 2", "v 0.5 0 0\nf 1 4 3 2 9");
    let (_, err) = checked("t.obj", &text);
    assert!(
        err.contains(
            "add the face that is missing there, or give the one that is there the same vertices (a T-junction)"
        ),
        "{err}"
    );
    let (_, err) = checked("t.obj", &format!("{text}f 1 9 2\n"));
    assert!(err.contains("face 6 has no area") && err.contains("leave it out, and give the faces beside it"), "{err}");
    // Followed.
    assert_eq!(checked("t.obj", &text.replace("f 1 2 6 5", "f 1 9 2 6 5")).0, 0);
    let bent = obj(&[(UNIT, false)]).replace("v 1 1 1\n", "v 1.01 1.02 1.03\n");
    let (code, err) = checked("bent.obj", &bent);
    let told = "cut them into triangles, or take them for planar with --planarity ";
    let planarity = err.split(told).nth(1).and_then(|rest| rest.split(',').next()).expect("a planarity");
    assert_eq!(code, 2);
    let place = Place::new();
    place.file("bent.obj", &bent);
    assert_eq!(place.run(&["check", "bent.obj", "--planarity", planarity]).0, 0);
}

#[test]
fn two_fixed_blocks_are_not_said_to_pass_through_one_another() {
    let place = Place::new();
    let fixed = "[[block]]\nfixed = true\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n[[block]]\nfixed = true\nbox = { min = [0.5, 0, 0], max = [1.5, 1, 1] }\n";
    let free = "[[block]]\nbox = { min = [0, 0, 1], max = [0.4, 1, 2] }\n";
    place.file("fixed.toml", &format!("{fixed}{free}"));
    let (code, out, err) = place.run(&["classify", "fixed.toml"]);
    assert!(code == 0 && !out.contains("pass through"), "{out}{err}");
    assert!(out.contains("(1 pair of fixed blocks, which never move, left out of the overlaps)\n"), "{out}");
    place.file("free.toml", &format!("{}{free}", fixed.replacen("fixed = true\n", "", 1)));
    let (_, out, _) = place.run(&["classify", "free.toml"]);
    assert!(out.contains("will pass through one another") && !out.contains("never move"), "{out}");
}
