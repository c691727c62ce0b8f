//! VTK's XML, the kinds of cells that it and Gmsh have, and what joins, scales and takes surfaces apart (docs/formats.md).

use super::formats::{AS_LISTED, CORNERS, FACES, Held, TRIANGLES, assert_model, lines, read};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Block, LoadOptions, Number, Scene};

fn number(text: &str) -> Number {
    Number::parse(text).expect("a number")
}

pub(super) fn coordinates() -> impl Iterator<Item = f64> {
    CORNERS.iter().flat_map(|v| v.split(' ')).map(|c| c.parse().expect("an f64"))
}

pub(super) fn numbered<T: ToString>(all: &[T]) -> String {
    all.iter().map(T::to_string).collect::<Vec<_>>().join(" ")
}

/// A grid of one piece in text; arrays of numbers by name.
fn vtu(points: &str, count: usize, cells: &[(&str, &str, String)], number_of_cells: usize) -> String {
    let arrays = lines(cells, |(kind, name, content)| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{content}</DataArray>")
    });
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n\
         <UnstructuredGrid><Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{number_of_cells}\">\n\
         <Points>{points}</Points>\n<Cells>\n{arrays}</Cells>\n</Piece></UnstructuredGrid></VTKFile>\n"
    )
}

/// Polyhedra whose faces stand in the file, as VTK has them up to 9.3.
fn polyhedra() -> [(&'static str, &'static str, String); 5] {
    let stream = |faces: &[&[u32]]| {
        let faces = faces.iter().flat_map(|f| [&[f.len() as u32][..], f].concat());
        faces.collect::<Vec<u32>>()
    };
    let ell = [vec![8], stream(&FACES[..8])].concat();
    let tet = [vec![4], stream(&FACES[8..])].concat();
    [
        ("Int64", "connectivity", numbered(&AS_LISTED)),
        ("Int64", "offsets", "12 16".to_string()),
        ("UInt8", "types", "42 42".to_string()),
        ("Int64", "faceoffsets", numbered(&[ell.len(), ell.len() + tet.len()])),
        ("Int64", "faces", numbered(&[ell, tet].concat())),
    ]
}

fn assert_grid(what: &str, file: &[u8], held: Held) {
    let scene = read(file, SceneFormat::Vtu, &LoadOptions::default()).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_model(what, &scene, ["block_0", "block_1"], &AS_LISTED, held);
}

#[test]
fn vtu_holds_polyhedra() {
    for (kind, held) in [("Float64", Held::F64), ("Float32", Held::F32)] {
        let points = CORNERS.join("\n");
        let points =
            format!("<DataArray type=\"{kind}\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray>");
        assert_grid(kind, vtu(&points, 16, &polyhedra(), 2).as_bytes(), held);
    }
}

/// The coordinates as bytes: lengths of 32 or 64 bits before them, as they are or in packed blocks of 100 bytes, in either byte order.
fn vtu_bytes(big: bool, long: bool, packed: bool) -> [Vec<u8>; 2] {
    let ordered = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    let length =
        |n: usize| ordered(if long { (n as u64).to_le_bytes().to_vec() } else { (n as u32).to_le_bytes().to_vec() });
    let content: Vec<u8> = coordinates().flat_map(|c| ordered(c.to_le_bytes().to_vec())).collect();
    if !packed {
        return [Vec::new(), [length(content.len()), content].concat()];
    }
    let blocks: Vec<Vec<u8>> = content.chunks(100).map(|b| miniz_oxide::deflate::compress_to_vec_zlib(b, 6)).collect();
    let head = [blocks.len(), 100, content.len() % 100].into_iter().chain(blocks.iter().map(Vec::len));
    [head.flat_map(length).collect(), blocks.concat()]
}

#[test]
fn vtu_holds_bytes_in_every_layout() {
    for (case, place) in (0..8).flat_map(|case| ["inline", "base64", "raw"].map(|place| (case, place))) {
        let [big, long, packed] = [1, 2, 4].map(|bit| case & bit != 0);
        let [head, data] = vtu_bytes(big, long, packed);
        // What says how long the packed blocks are is a text of its own.
        let text = STANDARD.encode(&head) + &STANDARD.encode(&data);
        let array = |rest: &str| format!("<DataArray type=\"Float64\" NumberOfComponents=\"3\" {rest}</DataArray>");
        let points = match place {
            "inline" => array(&format!("format=\"binary\">{text}")),
            _ => array("format=\"appended\" offset=\"0\">"),
        };
        let mut grid = vtu(&points, 16, &polyhedra(), 2);
        if big {
            grid = grid.replace("LittleEndian", "BigEndian");
        }
        if long {
            grid = grid.replace("\"UInt32\"", "\"UInt64\"");
        }
        if packed {
            grid = grid.replace("<VTKFile ", "<VTKFile compressor=\"vtkZLibDataCompressor\" ");
        }
        let mut file = grid.into_bytes();
        if place != "inline" {
            file.truncate(file.len() - "</VTKFile>\n".len());
            file.extend(format!("<AppendedData encoding=\"{place}\">_").bytes());
            file.extend(if place == "raw" { [head, data].concat() } else { text.into_bytes() });
            file.extend(b"</AppendedData></VTKFile>\n");
        }
        assert_grid(&format!("{place}, case {case}"), &file, Held::F64);
    }
}

/// A kind of cell: its number in Gmsh (0: none) and in VTK, its corners in the order of both manuals, and its faces from outside.
type Kind = (u32, u32, &'static [[i32; 3]], &'static [&'static [u32]]);

/// Wedges of VTK have their first triangle seen from outside, prisms of Gmsh seen from inside; see `order`.
const KINDS: [Kind; 7] = [
    (4, 10, &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]]),
    (
        5,
        12,
        &[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
        &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
    ),
    (
        6,
        13,
        &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]],
        &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
    ),
    (
        7,
        14,
        &[[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 3]],
        &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
    ),
    // A voxel counts x first, then y, then z.
    (
        0,
        11,
        &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]],
        &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[1, 3, 7, 5], &[3, 2, 6, 7], &[2, 0, 4, 6]],
    ),
    (
        0,
        15,
        &[
            [0, 0, 0],
            [2, 0, 0],
            [3, 2, 0],
            [1, 3, 0],
            [-1, 2, 0],
            [0, 0, 1],
            [2, 0, 1],
            [3, 2, 1],
            [1, 3, 1],
            [-1, 2, 1],
        ],
        &[
            &[4, 3, 2, 1, 0],
            &[5, 6, 7, 8, 9],
            &[0, 1, 6, 5],
            &[1, 2, 7, 6],
            &[2, 3, 8, 7],
            &[3, 4, 9, 8],
            &[4, 0, 5, 9],
        ],
    ),
    (
        0,
        16,
        &[
            [0, 0, 0],
            [2, 0, 0],
            [3, 1, 0],
            [3, 3, 0],
            [1, 3, 0],
            [0, 2, 0],
            [0, 0, 1],
            [2, 0, 1],
            [3, 1, 1],
            [3, 3, 1],
            [1, 3, 1],
            [0, 2, 1],
        ],
        // The L is a prism over six corners.
        FACES.split_at(8).0,
    ),
];

/// Corners of a cell under a map that leaves no two edges alike, in eighths.
fn mapped(corners: &[[i32; 3]]) -> Vec<[i32; 3]> {
    corners.iter().map(|[x, y, z]| [16 * x + 2 * y, 8 * y + 4 * z, 24 * z + x]).collect()
}

/// Loops of corners, each from its least on, in order.
fn polygons(block: &Block) -> Vec<Vec<[i32; 3]>> {
    let eighths = |n: &Number| (8.0 * n.approximate()) as i32;
    let corner = |v: &rockproof_model::VertexId| block.vertices()[v.index()].components().map(eighths);
    sorted(block.topology().faces().iter().map(|face| face.iter().map(corner).collect()))
}

fn sorted(faces: impl Iterator<Item = Vec<[i32; 3]>>) -> Vec<Vec<[i32; 3]>> {
    let turned = |mut face: Vec<[i32; 3]>| {
        let least = (0..face.len()).min_by_key(|&k| face[k]).expect("a corner");
        face.rotate_left(least);
        face
    };
    let mut all: Vec<_> = faces.map(turned).collect();
    all.sort();
    all
}

/// What a file of one cell is read as, its corners in these places of the table.
fn cell(format: SceneFormat, number: u32, corners: &[[i32; 3]], order: &[usize]) -> Scene {
    let rows = |k: &usize| corners[*k].map(|n| (f64::from(n) / 8.0).to_string()).join(" ");
    let (count, all) = (order.len(), (0..order.len()).collect::<Vec<_>>());
    let text = match format {
        SceneFormat::Msh => {
            let nodes = lines(order.iter().enumerate(), |(k, place)| format!("{k} {}", rows(place)));
            let element = format!("1 {number} 2 1 1 {}", numbered(&all));
            format!(
                "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{count}\n{nodes}$EndNodes\n$Elements\n1\n{element}\n$EndElements\n"
            )
        }
        _ => {
            let points = lines(order, rows);
            let points =
                format!("<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray>");
            let cells = [
                ("Int64", "connectivity", numbered(&all)),
                ("Int64", "offsets", count.to_string()),
                ("UInt8", "types", number.to_string()),
            ];
            vtu(&points, count, &cells, 1)
        }
    };
    read(text.as_bytes(), format, &LoadOptions::default())
        .unwrap_or_else(|error| panic!("{format:?} {number}: {error}"))
}

#[test]
fn cells_have_the_faces_of_the_manuals() {
    for (gmsh, vtk, corners, faces) in KINDS {
        let corners = mapped(corners);
        let wanted = sorted(faces.iter().map(|face| face.iter().map(|&v| corners[v as usize]).collect()));
        let given: Vec<usize> = (0..corners.len()).collect();
        // A wedge as VTK's manual has it, and as most programs write it: both are read.
        let orders = if vtk == 13 { vec![given.clone(), vec![0, 2, 1, 3, 5, 4]] } else { vec![given.clone()] };
        for order in orders {
            let scene = cell(SceneFormat::Vtu, vtk, &corners, &order);
            assert_eq!(
                scene.blocks.iter().map(|b| polygons(&b.block)).collect::<Vec<_>>(),
                vec![wanted.clone()],
                "type {vtk}"
            );
        }
        if gmsh != 0 {
            let scene = cell(SceneFormat::Msh, gmsh, &corners, &given);
            assert_eq!(polygons(&scene.blocks[0].block), wanted, "element {gmsh}");
        }
    }
}

/// Two cubes that touch along an edge of whose corners they share, as one surface: faces of the first, then of the second.
#[test]
fn blocks_that_touch_along_an_edge_are_told_apart() {
    let corners = [
        "0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "1 1 1", "0 1 1", "2 1 0", "2 2 0", "1 2 0", "2 1 1",
        "2 2 1", "1 2 1",
    ];
    let faces = [
        "4 0 3 2 1",
        "4 4 5 6 7",
        "4 0 1 5 4",
        "4 1 2 6 5",
        "4 2 3 7 6",
        "4 3 0 4 7",
        "4 2 10 9 8",
        "4 6 11 12 13",
        "4 2 8 11 6",
        "4 8 9 12 11",
        "4 9 10 13 12",
        "4 10 2 6 13",
    ];
    let text = "ply\nformat ascii 1.0\nelement vertex 14\nproperty double x\nproperty double y\nproperty double z\nelement face 12\n\
                property list uchar int vertex_indices\nend_header\n"
        .to_string()
        + &lines(corners, str::to_string)
        + &lines(faces, str::to_string);
    let scene = read(text.as_bytes(), SceneFormat::Ply, &LoadOptions::default()).expect("two blocks");
    let bounds = scene
        .shapes()
        .iter()
        .map(|b| (b.bounds().min.x.approximate(), b.bounds().max.x.approximate()))
        .collect::<Vec<_>>();
    assert_eq!(bounds, [(0.0, 1.0), (1.0, 2.0)]);
    assert!(scene.shapes().iter().all(|block| block.vertices().len() == 8));
}

/// A triangle soup of the tetrahedron in OBJ, one of whose corners is off by 1/64 along x.
fn soup(off: &str) -> String {
    let corner = |v: u32, first: bool| match (v, first) {
        (15, false) => format!("v {off} 0.25 3"),
        _ => format!("v {}", CORNERS[v as usize]),
    };
    let triangle = |(k, t): (usize, &[u32; 3])| t.map(|v| corner(v, k == 1)).join("\n");
    lines(TRIANGLES[20..].iter().enumerate(), triangle) + "f 1 2 3\nf 4 5 6\nf 7 8 9\nf 10 11 12\n"
}

#[test]
fn corners_are_joined_within_a_distance_and_its_edge_and_then_scaled() {
    let with = |weld: Option<&str>, scale: Option<&str>| LoadOptions {
        weld: weld.map(number),
        scale: scale.map(number),
        ..LoadOptions::default()
    };
    // 17/4 + 1/64 is 4.265625.
    for (off, weld, is_block) in [
        ("4.25", None, false),
        ("4.25", Some("0"), true),
        ("4.265625", Some("1/64"), true),
        ("4.265625", Some("0.015624999999999999999999999999"), false),
        ("4.265625", Some("1/50"), true),
    ] {
        let found = read(soup(off).as_bytes(), SceneFormat::Obj, &with(weld, None));
        assert_eq!(found.is_ok(), is_block, "{off} {weld:?}");
        let Ok(scene) = found else { continue };
        // Each corner goes to the first: to that of the table.
        let scaled = read(soup(off).as_bytes(), SceneFormat::Obj, &with(weld, Some("1/1000"))).expect("a block");
        for (factor, scene) in [("1", scene), ("1/1000", scaled)] {
            let order = [0, 2, 1, 3].map(|k: usize| CORNERS[12 + k]);
            let wanted: Vec<[Number; 3]> = order
                .iter()
                .map(|v| {
                    v.split(' ')
                        .map(|c| number(c).times(&number(factor)))
                        .collect::<Vec<_>>()
                        .try_into()
                        .expect("three")
                })
                .collect();
            let found = scene.blocks[0].block.vertices().iter().map(|v| [v.x.clone(), v.y.clone(), v.z.clone()]);
            assert_eq!(found.collect::<Vec<_>>(), wanted, "{off} {weld:?} {factor}");
        }
    }
    let scene = b"[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    assert!(read(scene, SceneFormat::Toml, &with(None, Some("1"))).is_ok());
    assert!(read(scene, SceneFormat::Toml, &with(None, Some("1/1000"))).is_err());
}
