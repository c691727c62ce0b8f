//! One model in every format that is read: a concave block and a tetrahedron, with the corners, loops, names and exact coordinates that a table
//! by hand says (docs/formats.md, and for `.dda` and voro++ cases/real/README.md).

use rockproof_model::scene::SceneFormat;
use rockproof_model::{Block, LoadOptions, Number, Scene};
use std::path::Path;

/// An L that stands on its outline, then a tetrahedron. 1.1 is no f64; all other coordinates are f32.
pub(super) const CORNERS: [&str; 16] = [
    "-0.75 -1.25 0.125",
    "1.5 -1.25 0.125",
    "1.5 0.5 0.125",
    "0.25 0.5 0.125",
    "0.25 2 0.125",
    "-0.75 2 0.125",
    "-0.75 -1.25 1.1",
    "1.5 -1.25 1.1",
    "1.5 0.5 1.1",
    "0.25 0.5 1.1",
    "0.25 2 1.1",
    "-0.75 2 1.1",
    "4 0 0",
    "5 0.5 0",
    "4 2 0",
    "4.25 0.25 3",
];

/// Faces counter-clockwise from outside: eight of the L, four of the tetrahedron.
pub(super) const FACES: [&[u32]; 12] = [
    &[0, 5, 4, 3, 2, 1],
    &[6, 7, 8, 9, 10, 11],
    &[0, 1, 7, 6],
    &[1, 2, 8, 7],
    &[2, 3, 9, 8],
    &[3, 4, 10, 9],
    &[4, 5, 11, 10],
    &[5, 0, 6, 11],
    &[12, 14, 13],
    &[12, 13, 15],
    &[13, 14, 15],
    &[14, 12, 15],
];

/// The faces cut into triangles, in the same order; the L's caps so that none leaves them.
pub(super) const TRIANGLES: [[u32; 3]; 24] = [
    [0, 3, 1],
    [1, 3, 2],
    [0, 5, 3],
    [3, 5, 4],
    [6, 7, 9],
    [7, 8, 9],
    [6, 9, 11],
    [9, 10, 11],
    [0, 1, 7],
    [0, 7, 6],
    [1, 2, 8],
    [1, 8, 7],
    [2, 3, 9],
    [2, 9, 8],
    [3, 4, 10],
    [3, 10, 9],
    [4, 5, 11],
    [4, 11, 10],
    [5, 0, 6],
    [5, 6, 11],
    [12, 14, 13],
    [12, 13, 15],
    [13, 14, 15],
    [14, 12, 15],
];

/// How a format holds numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Held {
    Decimal,
    F64,
    F32,
}

impl Held {
    pub(super) fn number(self, text: &str) -> Number {
        match self {
            Held::Decimal => Number::parse(text).expect("a number"),
            Held::F64 => Number::from_f64(text.parse().expect("an f64")).expect("finite"),
            Held::F32 => Number::from_f64(f64::from(text.parse::<f32>().expect("an f32"))).expect("finite"),
        }
    }
}

pub(super) fn read(bytes: &[u8], format: SceneFormat, options: &LoadOptions) -> Result<Scene, String> {
    Scene::parse_bytes(bytes, format, Path::new("model"), options).map_err(|error| error.to_string())
}

/// A block as corners, and loops that begin with their least corner.
type Plain = (Vec<[Number; 3]>, Vec<Vec<u32>>);

fn plain(block: &Block) -> Plain {
    let corners = block.vertices().iter().map(|v| [v.x.clone(), v.y.clone(), v.z.clone()]).collect();
    let face = |face: &Vec<_>| face.iter().map(|v: &rockproof_model::VertexId| v.0).collect();
    (corners, block.topology().faces().iter().map(face).map(from_least).collect())
}

fn from_least(mut face: Vec<u32>) -> Vec<u32> {
    let least = (0..face.len()).min_by_key(|&k| face[k]).expect("a corner");
    face.rotate_left(least);
    face
}

/// The two blocks of the model with their corners in this order, numbered as in the file.
fn expected(order: &[u32; 16], held: Held) -> [Plain; 2] {
    let block = |of: &dyn Fn(u32) -> bool| {
        let own: Vec<u32> = order.iter().copied().filter(|v| of(*v)).collect();
        let corner = |v: &u32| {
            let mut parts = CORNERS[*v as usize].split(' ').map(|c| held.number(c));
            std::array::from_fn(|_| parts.next().expect("three coordinates"))
        };
        let place = |v: &u32| own.iter().position(|w| w == v).expect("a corner of the block") as u32;
        let faces = FACES.iter().filter(|face| of(face[0])).map(|face| from_least(face.iter().map(place).collect()));
        (own.iter().map(corner).collect(), faces.collect())
    };
    [block(&|v| v < 12), block(&|v| v >= 12)]
}

/// The order of the table.
pub(super) const AS_LISTED: [u32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// What is read is the model, by these names.
pub(super) fn assert_model(what: &str, scene: &Scene, names: [&str; 2], order: &[u32; 16], held: Held) {
    let found: Vec<&str> = scene.blocks.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(found, names, "{what}");
    for (k, (block, wanted)) in scene.blocks.iter().zip(expected(order, held)).enumerate() {
        assert_eq!(plain(&block.block), wanted, "{what}, block {k}");
        assert!(!block.body.is_fixed(), "{what}");
        assert_eq!(block.block.is_convex(), k == 1, "{what}");
    }
}

const UNNAMED: [&str; 2] = ["block_0", "block_1"];

fn assert_reads(what: &str, bytes: &[u8], format: SceneFormat, names: [&str; 2], held: Held) {
    let scene = read(bytes, format, &LoadOptions::default()).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_model(what, &scene, names, &AS_LISTED, held);
}

/// Lines of a text, one for each.
pub(super) fn lines<T>(all: impl IntoIterator<Item = T>, line: impl Fn(T) -> String) -> String {
    all.into_iter().map(|each| line(each) + "\n").collect()
}

/// Numbers of corners as words, counted from another first one.
fn words(face: &[u32], from: u32) -> String {
    face.iter().map(|v| (v + from).to_string()).collect::<Vec<_>>().join(" ")
}

#[test]
fn toml_holds_the_model_exactly() {
    let row = |v: &str| format!("[\"{}\"]", v.replace(' ', "\", \""));
    let block = |name: &str, corners: &[&str], faces: &[&[u32]], first: u32| {
        let faces = faces.iter().map(|f| f.iter().map(|v| v - first).collect::<Vec<_>>()).collect::<Vec<_>>();
        let corners = corners.iter().map(|v| row(v)).collect::<Vec<_>>().join(", ");
        format!("[[block]]\nname = \"{name}\"\nvertices = [{corners}]\nfaces = {faces:?}\n")
    };
    let text = block("ell", &CORNERS[..12], &FACES[..8], 0) + &block("tet", &CORNERS[12..], &FACES[8..], 12);
    assert_reads("exact", text.as_bytes(), SceneFormat::Toml, ["ell", "tet"], Held::Decimal);
    // Without quotes a number is the f64 it parses to.
    let bare = text.replace("[\"", "[").replace("\", \"", ", ").replace("\"]", "]");
    assert_reads("f64", bare.as_bytes(), SceneFormat::Toml, ["ell", "tet"], Held::F64);
}

/// How numbers may be written, and the fraction that each is.
const WRITTEN: [(&str, &str); 9] = [
    ("2", "2"),
    ("-7", "-7"),
    ("\"0.1\"", "1/10"),
    ("\"1/3\"", "1/3"),
    ("\"-22/7\"", "-22/7"),
    ("\"0x1.8p-3\"", "3/16"),
    ("\"1e-3\"", "1/1000"),
    ("2.5e-1", "1/4"),
    // The f64 nearest to 0.1, by hand: 7205759403792794 / 2⁵⁶.
    ("0.1", "7205759403792794/72057594037927936"),
];

#[test]
fn numbers_of_a_scene_are_what_they_say() {
    for (written, fraction) in WRITTEN {
        let text = format!("[[block]]\nbox = {{ min = [-50, -50, -50], max = [50, 50, {written}] }}\n");
        let scene = read(text.as_bytes(), SceneFormat::Toml, &LoadOptions::default()).expect(written);
        let found = scene.blocks[0].block.bounds().max.z.to_rational();
        assert_eq!(found, fraction.parse().expect("a fraction"), "{written}");
    }
    // A box has its corners counter-clockwise below, then above, and its faces below, above, and round from the one between the first two.
    let text = "[[block]]\nbox = { min = [1, 2, 3], max = [4, 6, 8] }\n";
    let scene = read(text.as_bytes(), SceneFormat::Toml, &LoadOptions::default()).expect("a box");
    let (corners, faces) = plain(&scene.blocks[0].block);
    let wanted = ["1 2 3", "4 2 3", "4 6 3", "1 6 3", "1 2 8", "4 2 8", "4 6 8", "1 6 8"];
    assert_eq!(corners.iter().map(|c| format!("{} {} {}", c[0], c[1], c[2])).collect::<Vec<_>>(), wanted);
    let wanted = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [0, 4, 7, 3]];
    assert_eq!(faces, wanted.map(Vec::from));
}

#[test]
fn obj_has_an_object_for_each_block() {
    let text = "# two blocks\no ell\n".to_string()
        + &lines(&CORNERS[..12], |v| format!("v {v}"))
        + &lines(&FACES[..8], |f| format!("f {}", words(f, 1)))
        + "o tet\n"
        + &lines(&CORNERS[12..], |v| format!("v {v}"));
    let plain = text.clone() + &lines(&FACES[8..], |f| format!("f {}", words(f, 1)));
    assert_reads("numbers", plain.as_bytes(), SceneFormat::Obj, ["ell", "tet"], Held::F64);
    // Counted from the last vertex, and with numbers of textures and normals, as Wavefront has it.
    let other = text + "vt 0 0\nvn 0 0 1\nf -4 -2 -3\nf 13/1 14/1 16/1\nf 14//1 15//1 16//1\nf 15/1/1 13/1/1 16/1/1\n";
    assert_reads("other numbers", other.as_bytes(), SceneFormat::Obj, ["ell", "tet"], Held::F64);
    let triangles = "o ell\n".to_string()
        + &lines(&CORNERS, |v| format!("v {v}"))
        + &lines(&TRIANGLES[..20], |f| format!("f {}", words(f, 1)))
        + "o tet\n"
        + &lines(&TRIANGLES[20..], |f| format!("f {}", words(f, 1)));
    assert_reads("triangles", triangles.as_bytes(), SceneFormat::Obj, ["ell", "tet"], Held::F64);
    let inside_out = plain.replace("f 13 15 14", "f 14 15 13");
    assert!(read(inside_out.as_bytes(), SceneFormat::Obj, &LoadOptions::default()).is_err());
}

/// The corners in the order in which triangles first have them.
fn first_met() -> [u32; 16] {
    let mut order = Vec::new();
    for v in TRIANGLES.into_iter().flatten() {
        if !order.contains(&v) {
            order.push(v);
        }
    }
    order.try_into().expect("every corner")
}

#[test]
fn stl_joins_corners_at_one_place() {
    let solid = |name: &str, triangles: &[[u32; 3]]| {
        let corner = |v: u32| format!("vertex {}\n", CORNERS[v as usize]);
        let facet = |t: &[u32; 3]| {
            let corners: String = t.iter().map(|v| corner(*v)).collect();
            format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet")
        };
        format!("solid {name}\n{}endsolid {name}\n", lines(triangles, facet))
    };
    let text = solid("ell", &TRIANGLES[..20]) + &solid("tet", &TRIANGLES[20..]);
    let scene = read(text.as_bytes(), SceneFormat::Stl, &LoadOptions::default()).expect("a text");
    assert_model("text", &scene, ["ell", "tet"], &first_met(), Held::F64);
    let mut bytes = vec![b' '; 80];
    bytes.extend(24_u32.to_le_bytes());
    for triangle in TRIANGLES {
        bytes.extend([0; 12]);
        let coordinates = triangle.iter().flat_map(|v| CORNERS[*v as usize].split(' '));
        bytes.extend(coordinates.flat_map(|c| c.parse::<f32>().expect("an f32").to_le_bytes()));
        bytes.extend([0; 2]);
    }
    let scene = read(&bytes, SceneFormat::Stl, &LoadOptions::default()).expect("binary");
    assert_model("binary", &scene, UNNAMED, &first_met(), Held::F32);
}

#[test]
fn ply_has_a_block_for_each_set_of_faces_joined() {
    for (kind, held) in [("double", Held::F64), ("float", Held::F32)] {
        let header = |form: &str, list: &str| {
            format!(
                "ply\nformat {form} 1.0\nelement vertex 16\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\n\
                 element face 12\nproperty list uchar int {list}\nend_header\n"
            )
        };
        let face = |f: &&[u32]| format!("{} {}", f.len(), words(f, 0));
        let text = header("ascii", "vertex_indices") + &lines(CORNERS, str::to_string) + &lines(&FACES, face);
        assert_reads(kind, text.as_bytes(), SceneFormat::Ply, UNNAMED, held);
        for big in [false, true] {
            let form = if big { "binary_big_endian" } else { "binary_little_endian" };
            let ordered = |mut bytes: Vec<u8>| {
                if big {
                    bytes.reverse();
                }
                bytes
            };
            let mut bytes = header(form, "vertex_index").into_bytes();
            for c in CORNERS.iter().flat_map(|v| v.split(' ')) {
                bytes.extend(ordered(match kind {
                    "float" => c.parse::<f32>().expect("an f32").to_le_bytes().to_vec(),
                    _ => c.parse::<f64>().expect("an f64").to_le_bytes().to_vec(),
                }));
            }
            for face in FACES {
                bytes.push(face.len() as u8);
                face.iter().for_each(|v| bytes.extend(ordered(v.to_le_bytes().to_vec())));
            }
            assert_reads(form, &bytes, SceneFormat::Ply, UNNAMED, held);
        }
    }
}

#[test]
fn vtk_has_polyhedra_in_both_layouts() {
    let stream = |faces: &[&[u32]]| {
        let faces: Vec<String> = faces.iter().map(|f| format!("{} {}", f.len(), words(f, 0))).collect();
        format!("{} {}", faces.len(), faces.join(" "))
    };
    let (ell, tet) = (stream(&FACES[..8]), stream(&FACES[8..]));
    let [m, n] = [&ell, &tet].map(|s| s.split(' ').count());
    let head = |version: &str| {
        let corners = lines(CORNERS, str::to_string);
        format!(
            "# vtk DataFile Version {version}\nmodel\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 16 double\n{corners}"
        )
    };
    let old = head("3.0") + &format!("CELLS 2 {}\n{m} {ell}\n{n} {tet}\nCELL_TYPES 2\n42\n42\n", m + n + 2);
    assert_reads("version 3", old.as_bytes(), SceneFormat::Vtk, UNNAMED, Held::F64);
    let (all, types) = (m + n, "CELL_TYPES 2\n42\n42\n");
    let new =
        format!("CELLS 3 {all}\nOFFSETS vtktypeint64\n0 {m} {all}\nCONNECTIVITY vtktypeint64\n{ell}\n{tet}\n{types}");
    let new = head("5.1") + &new;
    assert_reads("version 5", new.as_bytes(), SceneFormat::Vtk, UNNAMED, Held::F64);
    let inside_out = old.replace("3 12 14 13", "3 12 13 14");
    assert!(read(inside_out.as_bytes(), SceneFormat::Vtk, &LoadOptions::default()).is_err());
}

#[test]
fn dda_says_which_blocks_are_fixed() {
    let local = |face: &&[u32]| face.iter().map(|v| (v % 12).to_string()).collect::<Vec<_>>().join(" ");
    let mut start = 0;
    let slices: Vec<String> = FACES
        .iter()
        .map(|face| {
            start += face.len();
            format!("{} {}", start - face.len(), face.len())
        })
        .collect();
    let nodes = FACES.iter().map(local).collect::<Vec<_>>().join(" ");
    let text = |flags: &str| {
        format!(
            "#_DDA_DataFile_Version_1.0\nPOINTS_START_LENGTH 2\n0 12\n12 4\n\nPOINTS 16 double\n{}\nFACES_NODELIST {start}\n{nodes}\n\n\
             FACES 12\n{}\n\nBLOCK_FACES 2\n0 8\n8 4\n\nEDGES 1\n0 1\nEDGES 2\n0 1\n1 0\n\nSCALARS aspectRatio float\n3\n3\n\n\
             SCALARS fixedFlag int\n{flags}\nSCALARS volume float\n3\n3\n",
            CORNERS.join("\n"),
            slices.join("\n")
        )
    };
    assert_reads("free", text("0\n0").as_bytes(), SceneFormat::Dda, UNNAMED, Held::F64);
    let scene = read(text("0\n1").as_bytes(), SceneFormat::Dda, &LoadOptions::default()).expect("a file");
    assert_eq!(scene.blocks.iter().map(|b| b.body.is_fixed()).collect::<Vec<_>>(), [false, true]);
}

#[test]
fn voro_runs_round_the_other_way() {
    let cell = |id: u32, corners: &[&str], faces: &[&[u32]], first: u32, turn: bool| {
        let places = corners.iter().map(|v| format!("({})", v.replace(' ', ","))).collect::<Vec<_>>().join(" ");
        let face = |f: &&[u32]| {
            let mut f: Vec<String> = f.iter().map(|v| (v - first).to_string()).collect();
            if turn {
                f.reverse();
            }
            format!("({})", f.join(","))
        };
        let all = faces.iter().map(face).collect::<Vec<_>>().join(" ");
        format!("{id} {} {places} {} {all}\n", corners.len(), faces.len())
    };
    let text = |turn| cell(7, &CORNERS[..12], &FACES[..8], 0, turn) + &cell(4, &CORNERS[12..], &FACES[8..], 12, turn);
    assert_reads("cells", text(true).as_bytes(), SceneFormat::Voro, ["cell_7", "cell_4"], Held::F64);
    // A cell that runs round counter-clockwise throughout is the same; one that runs round both ways is none.
    assert_reads("turned", text(false).as_bytes(), SceneFormat::Voro, ["cell_7", "cell_4"], Held::F64);
    let first = |text: String| text.lines().next().map(str::to_owned).expect("a line");
    let [clockwise, other] = [true, false].map(|turn| first(text(turn)));
    let last_face = |line: &str| line.rsplit(' ').next().map(str::to_owned).expect("a face");
    let mixed = clockwise.replace(&last_face(&clockwise), &last_face(&other));
    assert!(mixed != clockwise && read(mixed.as_bytes(), SceneFormat::Voro, &LoadOptions::default()).is_err());
}
