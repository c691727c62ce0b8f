// Longer than 400 lines: four formats and every way in which their numbers are written, with the helpers that write them.
//! STL, PLY, Gmsh and VTK's XML: every way in which numbers are written, surfaces that are taken apart and joined, and what is refused.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rockproof_model::scene::SceneFormat;
use rockproof_model::{LoadOptions, Merged, Number, Scene, VertexId};
use std::path::{Path, PathBuf};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/fixtures").join(name)
}

fn with_weld(distance: &str) -> LoadOptions {
    LoadOptions { weld: Number::parse(distance).ok(), ..LoadOptions::default() }
}

fn read(bytes: &[u8], format: SceneFormat) -> Result<Scene, String> {
    read_with(bytes, format, &LoadOptions::default())
}

fn read_with(bytes: &[u8], format: SceneFormat, options: &LoadOptions) -> Result<Scene, String> {
    Scene::parse_bytes(bytes, format, Path::new("mesh"), options).map_err(|error| error.to_string())
}

fn volumes(scene: &Scene) -> Vec<f64> {
    scene.shapes().iter().map(|block| Number::from_rational(block.volume()).approximate()).collect()
}

/// The triangles of a wedge of half a cubic metre, moved.
fn wedge([x, y, z]: [f32; 3]) -> Vec<[[f32; 3]; 3]> {
    let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 1.], [0., 1., 1.]];
    let faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]];
    faces.map(|face| face.map(|v: usize| [corners[v][0] + x, corners[v][1] + y, corners[v][2] + z])).to_vec()
}

fn binary_stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    // The header begins as a text does, as some programs have it.
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        triangle.iter().flatten().for_each(|c| bytes.extend(c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn solids_of_a_text_are_blocks() {
    let scene = Scene::load(fixture("two_wedges.stl")).unwrap();
    assert_eq!(scene.blocks.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["lower wedge", "block_1"]);
    assert_eq!(volumes(&scene), [0.5, 0.0625]);
    // Eight triangles are five faces; the line is that of the first facet.
    assert!(scene.blocks.iter().all(|block| block.merged == Merged { faces: 3, vertices: 0 }));
    assert_eq!(scene.blocks[1].origin.line, Some(60));
}

#[test]
fn a_binary_file_is_taken_apart_where_its_blocks_touch() {
    // The second stands on the first, and the third has an edge in common with the first.
    let triangles = [wedge([0.0; 3]), wedge([0.0, 0.0, 1.0]), wedge([0.0, -1.0, 0.0])].concat();
    let scene = read(&binary_stl(&triangles), SceneFormat::Stl).unwrap();
    assert_eq!(volumes(&scene), [0.5, 0.5, 0.5]);
    assert!(scene.blocks.iter().all(|block| block.origin.line.is_none() && block.block.vertices().len() == 6));
}

#[test]
fn coordinates_of_a_binary_file_are_exactly_its_f32() {
    let scene = read(&binary_stl(&wedge([0.1, 0.0, 0.0])), SceneFormat::Stl).unwrap();
    let x = scene.blocks[0].block.bounds().min.x.clone();
    assert_eq!(x.as_f64(), Some(f64::from(0.1f32)));
}

#[test]
fn corners_nearly_at_one_place_are_joined_within_the_distance_given() {
    let mut triangles = wedge([0.0; 3]);
    triangles[3][0][0] += 2f32.powi(-20);
    let bytes = binary_stl(&triangles);
    let error = read(&bytes, SceneFormat::Stl).unwrap_err();
    assert!(error.contains("block 0: ") && error.contains("the surface is open at edge"), "{error}");
    assert_eq!(volumes(&read_with(&bytes, SceneFormat::Stl, &with_weld("1e-6")).unwrap()), [0.5]);
    assert!(read_with(&bytes, SceneFormat::Stl, &with_weld("9e-7")).is_err());
}

#[test]
fn triangles_that_collapse_are_dropped_and_those_without_area_refused() {
    let mut triangles = wedge([0.0; 3]);
    triangles.push([[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(volumes(&read(&binary_stl(&triangles), SceneFormat::Stl).unwrap()), [0.5]);
    let mut triangles = wedge([0.0; 3]);
    // An edge of the base with a corner in its middle: the base in two, and a triangle without area beside them.
    triangles[0] = [[0., 0., 0.], [0., 1., 0.], [0.5, 0., 0.]];
    triangles.push([[0.5, 0., 0.], [0., 1., 0.], [1., 0., 0.]]);
    triangles.push([[0., 0., 0.], [0.5, 0., 0.], [1., 0., 0.]]);
    let error = read(&binary_stl(&triangles), SceneFormat::Stl).unwrap_err();
    assert!(error.contains("has no area"), "{error}");
}

#[test]
fn a_surface_inside_out_is_refused() {
    let inside_out: Vec<_> = wedge([0.0; 3]).into_iter().map(|[a, b, c]| [a, c, b]).collect();
    let error = read(&binary_stl(&inside_out), SceneFormat::Stl).unwrap_err();
    assert!(error.contains("the volume is -5.000000e-1"), "{error}");
}

#[test]
fn broken_stl_says_where() {
    let text = std::fs::read_to_string(fixture("two_wedges.stl")).unwrap();
    let binary = binary_stl(&wedge([0.0; 3]));
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1).into_bytes()
    };
    let mut no_number = binary.clone();
    no_number[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    for (bytes, parts) in [
        (with("facet normal", "facette normal"), &["mesh:2:", "found \"facette\" where \"facet\" should stand"][..]),
        (with("outer loop", "inner loop"), &["mesh:3:", "\"outer\""]),
        (with("vertex 0 0 0", "vertex 0 0"), &["mesh:5:", "found \"vertex\"", "a coordinate of a vertex"]),
        (with("vertex 0 0 0", "vertex 0 0 1e999"), &["mesh:4:", "1e999 is not a finite number"]),
        (with("endloop", "vertex 1 2 3"), &["mesh:7:", "\"endloop\""]),
        (with("endsolid lower wedge", ""), &["mesh:59:", "found \"solid\" where \"facet\""]),
        (text.as_bytes()[..text.find("loop").unwrap()].to_vec(), &["mesh:3:", "the file ends where \"loop\""]),
        (b"solid nothing\nendsolid nothing\n".to_vec(), &["mesh:", "there is no block in it"]),
        (b"solid a\xff\n".to_vec(), &["mesh:1:", "byte 7 of the file is 0xff"]),
        (Vec::new(), &["is 0; allowed is 84 or more"]),
        (binary[..200].to_vec(), &["is 200; allowed is 484 for the 8 triangles"]),
        ([&binary[..], b"tail"].concat(), &["is 488; allowed is 484"]),
        (no_number, &["a coordinate of corner 0 of triangle 1, at byte 146 of the file"]),
    ] {
        let error = read(&bytes, SceneFormat::Stl).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
    }
}

#[test]
fn cells_of_every_kind_are_blocks_whichever_way_they_run_round() {
    let scene = Scene::load(fixture("cells.vtu")).unwrap();
    assert_eq!(volumes(&scene), [1.0, 1.0 / 6.0, 0.5, 1.0 / 3.0, 1.0, 1.0]);
    let faces: Vec<usize> = scene.shapes().iter().map(|block| block.topology().faces().len()).collect();
    assert_eq!(faces, [6, 4, 5, 5, 6, 6]);
}

/// How a file writes its numbers.
#[derive(Clone, Copy)]
struct Form {
    appended: bool,
    base64: bool,
    compressed: bool,
    big_endian: bool,
    long_lengths: bool,
    /// Coordinates in f32 and integers of 32 bits.
    narrow: bool,
    /// Polyhedra as lists of faces, as VTK 9.4 has it.
    face_lists: bool,
}

/// A tetrahedron and a cube beside it, as polyhedra.
fn grid(form: Form) -> Vec<u8> {
    let points: [[f64; 3]; 12] = [
        [2., 0., 0.],
        [3., 0., 0.],
        [2., 1., 0.],
        [2., 0., 1.],
        [0., 0., 0.],
        [1., 0., 0.],
        [1., 1., 0.],
        [0., 1., 0.],
        [0., 0., 1.],
        [1., 0., 1.],
        [1., 1., 1.],
        [0., 1., 1.],
    ];
    let cells: [&[&[i64]]; 2] = [
        &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
        &[&[4, 7, 6, 5], &[8, 9, 10, 11], &[4, 5, 9, 8], &[5, 6, 10, 9], &[6, 7, 11, 10], &[7, 4, 8, 11]],
    ];
    let mut data = Vec::new();
    let mut array = |kind: &str, name: &str, content: Vec<u8>| written(form, &mut data, kind, name, &content);
    let numbers = |values: Vec<i64>| -> Vec<u8> {
        let bytes = |v: i64| {
            let mut bytes = if form.narrow { (v as i32).to_le_bytes().to_vec() } else { v.to_le_bytes().to_vec() };
            if form.big_endian {
                bytes.reverse();
            }
            bytes
        };
        values.into_iter().flat_map(bytes).collect()
    };
    let coordinates = points.iter().flatten().flat_map(|&c| {
        let mut bytes = if form.narrow { (c as f32).to_le_bytes().to_vec() } else { c.to_le_bytes().to_vec() };
        if form.big_endian {
            bytes.reverse();
        }
        bytes
    });
    let (float, integer) = if form.narrow { ("Float32", "Int32") } else { ("Float64", "Int64") };
    let points = array(float, "Points", coordinates.collect());
    let mut rest = array(integer, "connectivity", numbers((0..12).collect()));
    rest += &array(integer, "offsets", numbers(vec![4, 12]));
    rest += &array("UInt8", "types", vec![42, 42]);
    if form.face_lists {
        let corners: Vec<i64> = cells.iter().flat_map(|cell| cell.concat()).collect();
        let ends = cells.iter().flat_map(|cell| cell.iter()).scan(0, |end, face| {
            *end += face.len() as i64;
            Some(*end)
        });
        rest += &array(integer, "face_offsets", numbers(ends.collect()));
        rest += &array(integer, "face_connectivity", numbers(corners));
        rest += &array(integer, "polyhedron_to_faces", numbers((0..10).collect()));
        rest += &array(integer, "polyhedron_offsets", numbers(vec![4, 10]));
    } else {
        let stream = |cell: &&[&[i64]]| {
            let faces = cell.iter().flat_map(|face| [&[face.len() as i64], *face].concat());
            std::iter::once(cell.len() as i64).chain(faces).collect::<Vec<_>>()
        };
        let streams: Vec<Vec<i64>> = cells.iter().map(stream).collect();
        let ends = vec![streams[0].len() as i64, (streams[0].len() + streams[1].len()) as i64];
        rest += &array(integer, "faces", numbers(streams.concat()));
        rest += &array(integer, "faceoffsets", numbers(ends));
    }
    let order = if form.big_endian { "BigEndian" } else { "LittleEndian" };
    let lengths = if form.long_lengths { " header_type=\"UInt64\"" } else { "" };
    let compressor = if form.compressed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let mut file = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"{order}\"{lengths}{compressor}>\n<UnstructuredGrid><Piece NumberOfPoints=\"12\" NumberOfCells=\"2\">\n<Points>{points}</Points>\n<Cells>\n{rest}</Cells></Piece></UnstructuredGrid>\n"
    )
    .into_bytes();
    if form.appended {
        file.extend(
            format!("<AppendedData encoding=\"{}\">\n_", if form.base64 { "base64" } else { "raw" }).into_bytes(),
        );
        file.extend(&data);
        file.extend(b"\n</AppendedData>\n");
    }
    file.extend(b"</VTKFile>\n");
    file
}

/// An array in line, or its tag, the content being appended to `data`.
fn written(form: Form, data: &mut Vec<u8>, kind: &str, name: &str, content: &[u8]) -> String {
    let length = |value: usize| -> Vec<u8> {
        let mut bytes = if form.long_lengths {
            (value as u64).to_le_bytes().to_vec()
        } else {
            (value as u32).to_le_bytes().to_vec()
        };
        if form.big_endian {
            bytes.reverse();
        }
        bytes
    };
    let encode = |bytes: &[u8]| if form.base64 { STANDARD.encode(bytes).into_bytes() } else { bytes.to_vec() };
    let bytes = if form.compressed {
        // Blocks of 64 bytes, so that there are several and the last is shorter.
        let blocks: Vec<&[u8]> = content.chunks(64).collect();
        let packed: Vec<Vec<u8>> =
            blocks.iter().map(|block| miniz_oxide::deflate::compress_to_vec_zlib(block, 6)).collect();
        let last = content.len() % 64;
        let head = [blocks.len(), 64, last].into_iter().chain(packed.iter().map(Vec::len)).flat_map(length);
        [encode(&head.collect::<Vec<_>>()), encode(&packed.concat())].concat()
    } else {
        encode(&[length(content.len()), content.to_vec()].concat())
    };
    let tag = format!("<DataArray type=\"{kind}\" Name=\"{name}\"");
    if form.appended {
        let offset = data.len();
        data.extend(bytes);
        format!("{tag} format=\"appended\" offset=\"{offset}\"/>\n")
    } else {
        format!("{tag} format=\"binary\">\n  {}\n</DataArray>\n", String::from_utf8(bytes).unwrap())
    }
}

/// Every form that can be: what is in line is base64.
fn forms() -> Vec<Form> {
    let bits = |k: u32| -> [bool; 7] { std::array::from_fn(|bit| k >> bit & 1 == 1) };
    let form = |[appended, base64, compressed, big_endian, long_lengths, narrow, face_lists]: [bool; 7]| Form {
        appended,
        base64,
        compressed,
        big_endian,
        long_lengths,
        narrow,
        face_lists,
    };
    (0..128).map(bits).map(form).filter(|form| form.appended || form.base64).collect()
}

#[test]
fn numbers_are_read_however_they_are_written() {
    let all = forms();
    assert_eq!(all.len(), 96);
    for (number, form) in all.into_iter().enumerate() {
        let scene = read(&grid(form), SceneFormat::Vtu).unwrap_or_else(|error| panic!("form {number}: {error}"));
        assert_eq!(volumes(&scene), [1.0 / 6.0, 1.0], "form {number}");
    }
}

#[test]
fn pieces_follow_one_another() {
    let text = std::fs::read_to_string(fixture("cells.vtu")).unwrap();
    let (from, to) = (text.find("    <Piece").unwrap(), text.find("  </UnstructuredGrid>").unwrap());
    let twice = [&text[..to], &text[from..]].concat();
    assert_eq!(read(twice.as_bytes(), SceneFormat::Vtu).unwrap().blocks.len(), 12);
    let broken = twice.replace(
        "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">12 10",
        "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">12 3",
    );
    let broken = [&twice[..to], &broken[to..]].concat();
    let error = read(broken.as_bytes(), SceneFormat::Vtu).unwrap_err();
    assert!(error.contains("cell 1 of piece 1 of type 3 cannot be read"), "{error}");
}

#[test]
fn a_decimal_of_an_array_of_f32_is_an_f32() {
    let text = std::fs::read_to_string(fixture("cells.vtu")).unwrap();
    let text = text.replacen("Float64", "Float32", 1).replacen("          2 0 1\n", "          2 0 1.1\n", 1);
    let scene = read(text.as_bytes(), SceneFormat::Vtu).unwrap();
    assert_eq!(scene.blocks[1].block.bounds().max.z.as_f64(), Some(f64::from(1.1f32)));
}

#[test]
fn broken_vtu_says_where() {
    let text = std::fs::read_to_string(fixture("cells.vtu")).unwrap();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1).into_bytes()
    };
    let plain = Form {
        appended: false,
        base64: true,
        compressed: false,
        big_endian: false,
        long_lengths: false,
        narrow: false,
        face_lists: false,
    };
    let packed = String::from_utf8(grid(Form { compressed: true, ..plain })).unwrap();
    let inline = String::from_utf8(grid(plain)).unwrap();
    let appended = String::from_utf8(grid(Form { appended: true, ..plain })).unwrap();
    for (bytes, parts) in [
        (Vec::new(), &["the file ends where <VTKFile"][..]),
        (
            with("type=\"UnstructuredGrid\"", "type=\"PolyData\""),
            &["mesh:2:", "a VTKFile of type \"PolyData\" cannot be read"],
        ),
        (with("</Points>", "</Point>"), &["what is no XML"]),
        (with("LittleEndian", "MiddleEndian"), &["mesh:2:", "\"MiddleEndian\"; allowed is LittleEndian and BigEndian"]),
        (
            with("UInt64\">", "UInt64\" compressor=\"vtkLZ4DataCompressor\">"),
            &["the compressor vtkLZ4DataCompressor cannot be read"],
        ),
        (
            with("NumberOfPoints=\"39\"", "NumberOfPoints=\"40\""),
            &["the number of values of \"Points\" is 117; allowed is 120"],
        ),
        (with("NumberOfCells=\"6\"", "NumberOfCells=\"-6\""), &["mesh:4:", "`NumberOfCells` of Piece is \"-6\""]),
        (
            with("Name=\"types\"", "Name=\"kinds\""),
            &["mesh:4:", "the file ends where the array \"types\" should stand"],
        ),
        (with("12 10 13", "12 5 13"), &["cell 1 of type 5 cannot be read", "10 (tetrahedron)"]),
        (with("12 10 13", "12 14 13"), &["the number of points of cell 1, a pyramid, is 4; allowed is 5"]),
        (with("8 12 18", "8 7 18"), &["offset 1 into \"connectivity\" is 7; allowed is 8 to 39"]),
        (with("8 12 18", "8 12 1e1"), &["mesh:", "found \"1e1\"", "a whole number"]),
        (with("ascii\">0 1 2", "ascii\">0 1 39"), &["a point number of cell 0 is 39; allowed is 0 to 38"]),
        (with("          0 0 0\n", "          0 nan 0\n"), &["mesh:11:", "nan is not a finite number"]),
        (with("ascii\">6 4", "ascii\">7 4"), &["the next entry of the face stream of cell 4"]),
        (with("ascii\">6 4", "ascii\">5 4"), &["the length of the face stream of cell 4"]),
        (with("-1 -1 -1 -1 31", "-1 -1 -1 -1 32"), &["offset 4 into \"faceoffsets\" is 32; allowed is 0 to 31"]),
        (with("format=\"ascii\"", "format=\"asciii\"").to_vec(), &[]),
        (inline.replacen("AAAA", "AA*A", 1).into_bytes(), &["in base64"]),
        (
            inline.replacen("  IAEAAAAA", "  IAEAQAAA", 1).into_bytes(),
            &["mesh:4:", "the file ends where more of the data of the array \"Points\""],
        ),
        (
            packed.replacen("eJ", "eK", 1).into_bytes(),
            &["mesh:4:", "block 0 that does not decompress", "compressed by zlib"],
        ),
        (
            appended.replacen("offset=\"0\"", "offset=\"99999\"", 1).into_bytes(),
            &["mesh:4:", "`offset` of the array \"Points\" is \"99999\""],
        ),
        (
            appended.replacen("encoding=\"base64\"", "encoding=\"hex\"", 1).into_bytes(),
            &["`encoding` of AppendedData is \"hex\""],
        ),
        (appended.replacen("<AppendedData", "<OtherData", 1).into_bytes(), &[]),
    ] {
        match read(&bytes, SceneFormat::Vtu) {
            Err(error) => assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}"),
            // Data on cells are skipped, whatever they are.
            Ok(_) => assert!(parts.is_empty(), "{parts:?}"),
        }
    }
}

#[test]
fn a_length_that_nothing_can_hold_is_refused_at_once() {
    let form = Form {
        appended: true,
        base64: false,
        compressed: true,
        big_endian: false,
        long_lengths: true,
        narrow: false,
        face_lists: false,
    };
    let good = grid(form);
    let at = good.windows(2).position(|two| two == b"\n_").unwrap() + 2;
    for (place, says) in
        [(0, "the file ends"), (8, "allowed is at most 1073741824"), (16, "allowed is at most 1073741824")]
    {
        let mut bytes = good.clone();
        bytes[at + place..at + place + 8].copy_from_slice(&(u64::MAX / 3).to_le_bytes());
        let error = read(&bytes, SceneFormat::Vtu).unwrap_err();
        assert!(error.contains(says) || error.contains("allowed is at most 1073741824"), "{place}: {error}");
    }
}

/// A box as PLY; of `little` or `big` endian. Faces are lists of u32 behind a count of 16 bits, with a number beside them.
fn binary_ply(big_endian: bool) -> Vec<u8> {
    let order = if big_endian { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\nproperty uchar flags\nproperty list ushort uint vertex_index\nend_header\n"
    )
    .into_bytes();
    let mut push = |mut number: Vec<u8>| {
        if big_endian {
            number.reverse();
        }
        bytes.extend(number);
    };
    for corner in 0..8u8 {
        let [x, y] = [[0, 0], [1, 0], [1, 1], [0, 1]][usize::from(corner % 4)];
        for c in [x as f32, y as f32 * 0.1, f32::from(corner / 4)] {
            push(c.to_le_bytes().to_vec());
        }
    }
    for face in [[0u32, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]] {
        push(vec![7]);
        push(4u16.to_le_bytes().to_vec());
        face.iter().for_each(|v| push(v.to_le_bytes().to_vec()));
    }
    bytes
}

#[test]
fn ply_is_read_as_text_and_in_either_byte_order() {
    let scene = Scene::load(fixture("box.ply")).unwrap();
    assert_eq!(volumes(&scene), [1.0]);
    assert_eq!(scene.blocks[0].origin.line, Some(23));
    for big_endian in [false, true] {
        let scene = read(&binary_ply(big_endian), SceneFormat::Ply).unwrap();
        // Of a float the f32, exactly.
        assert_eq!(volumes(&scene), [f64::from(0.1f32)]);
        assert_eq!(scene.blocks[0].block.topology().faces()[0], [0, 3, 2, 1].map(VertexId));
    }
}

#[test]
fn doubled_vertices_of_ply_are_joined_where_it_is_asked_for() {
    let text = std::fs::read_to_string(fixture("box.ply")).unwrap();
    let text = text
        .replace("vertex 8", "vertex 9")
        .replace("0 1 1 255\n", "0 1 1 255\n0 0 0 255\n")
        .replace("4 0 3 2 1", "4 8 3 2 1");
    let error = read(text.as_bytes(), SceneFormat::Ply).unwrap_err();
    assert!(error.contains("vertices 0 and 8 are the same point"), "{error}");
    assert_eq!(volumes(&read_with(text.as_bytes(), SceneFormat::Ply, &with_weld("0")).unwrap()), [1.0]);
}

#[test]
fn broken_ply_says_where() {
    let text = std::fs::read_to_string(fixture("box.ply")).unwrap();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1).into_bytes()
    };
    let binary = binary_ply(false);
    for (bytes, parts) in [
        (Vec::new(), &["the file ends where a line of a PLY header"][..]),
        (with("ply\n", "pty\n"), &["mesh:1: found \"pty\" where a line of a PLY header"]),
        (with("format ascii", "format utf8"), &["mesh:2: found \"format utf8 1.0\" where a line of a PLY header"]),
        (with("ascii 1.0", "ascii 2.0"), &["mesh:2: the version of the format is 2.0; allowed is 1.0"]),
        (
            with("property double z", "property double w"),
            &["mesh:4:", "element \"vertex\" without a number \"z\" among its properties cannot be read"],
        ),
        (
            with("uchar int vertex_indices", "uchar float vertex_indices"),
            &["a list of whole numbers \"vertex_indices\""],
        ),
        (with("element vertex 8", "element vertex 4000000000"), &["is 4000000000; allowed is at most"]),
        (with("element vertex 8", "element nothing 5\nelement vertex 8"), &["is 5; allowed is 0"]),
        (
            with("1 0 0 255", "1 0 x 255"),
            &["mesh:16: found \"x\" where coordinate z of vertex 1, a number as 1, -0.5 or 2e-3 should stand"],
        ),
        (with("1 0 0 255", "1 0,0 0 255"), &["mesh:16: found \"0,0\" where coordinate y of vertex 1, a number as"]),
        (with("1 0 0 255", "NaN 0 0 255"), &["mesh:16: coordinate x of vertex 1: NaN is not a finite number"]),
        (with("1 0 0 255", "1 1e400 0 255"), &["mesh:16: coordinate y of vertex 1: 1e400 is not a finite number"]),
        (with("1 0 0 255", "1 0"), &["mesh:16: found the end of the line where coordinate z of vertex 1"]),
        (
            with("1 0 0 255", "1 0 0 256"),
            &["mesh:16: found \"256\" where `red` of element 1 of \"vertex\", a whole number"],
        ),
        (
            with("4 0 3 2 1", "4 0 3 2"),
            &["mesh:23: found the end of the line where a number of `vertex_indices` of face 0"],
        ),
        (with("4 0 3 2 1", "4 0 3,2 1 1"), &["mesh:23: found \"3,2\" where a number of `vertex_indices` of face 0"]),
        (with("4 0 3 2 1", "four 0 3 2 1"), &["mesh:23: found \"four\" where a number of `vertex_indices` of face 0"]),
        (with("1 0 0 255", "1 0 1e999 255"), &["mesh:16:", "coordinate z of vertex 1"]),
        (with("4 0 3 2 1", "4 0 3 2 8"), &["mesh:23:", "a vertex number of face 0 is 8; allowed is 0 to 7"]),
        (with("4 0 3 2 1", "4 0 3 2 -1"), &["mesh:23:", "is -1; allowed is 0 to 7"]),
        (with("4 0 3 2 1", "2 0 3"), &["mesh:23:", "face 0 of 2 vertices"]),
        (with("vertex 8", "vertex 9"), &["mesh:29: the file ends where the last of 1 elements \"edge\" should stand"]),
        (with("edge 1", "edge 0"), &["mesh:29: found \"0 1\" where the end of the file"]),
        (with("edge 1", "edge 2"), &["mesh:29: the file ends where the last of 2 elements \"edge\" should stand"]),
        ([&binary[..], b"\0"].concat(), &["mesh: found 1 more bytes where the end of the file"]),
        (
            text.replace("vertex 8", "vertex 9").replace("0 1 1 255\n", "0 1 1 255\n5 5 5 255\n").into_bytes(),
            &["mesh:23:", "vertex 8 of the file is in no face"],
        ),
        (
            binary[..binary.len() - 3].to_vec(),
            &["mesh: the file ends where the last of 6 elements \"face\" should stand"],
        ),
    ] {
        let error = read(&bytes, SceneFormat::Ply).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
    }
}

#[test]
fn elements_of_gmsh_are_blocks() {
    let scene = Scene::load(fixture("cells.msh")).unwrap();
    assert_eq!(volumes(&scene), [1.0, 1.0 / 3.0, 0.5]);
    assert_eq!(scene.blocks[1].origin.line, Some(31));
}

#[test]
fn surfaces_of_gmsh_are_blocks_by_physical_group() {
    let scene = Scene::load(fixture("surfaces.msh")).unwrap();
    assert_eq!(volumes(&scene), [1.0, 1.0]);
    assert_eq!(scene.blocks.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["left block", "right"]);
    assert!(scene.shapes().iter().all(|block| block.topology().faces().len() == 6));
}

/// A surface that bounds no cells is a body of its own, and was left out without a word.
#[test]
fn a_closed_surface_beside_cells_is_a_block() {
    let nodes = |from: usize, z: usize| -> String {
        let at = |k: usize| format!("{} {} {} {}\n", from + k, k & 1, k >> 1 & 1, (k >> 2) + z);
        (0..8).map(at).collect()
    };
    let surface = |from: usize, element: usize| -> String {
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let face = |(k, face): (usize, [usize; 4])| {
            let [a, b, c, d] = face.map(|corner| from + corner);
            format!("{} 3 2 1 1 {a} {b} {c} {d}\n", element + k)
        };
        faces.into_iter().enumerate().map(face).collect()
    };
    let mesh = |elements: usize, rest: &str| {
        let head =
            format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n16\n{}{}$EndNodes\n", nodes(1, 0), nodes(9, 1));
        format!("{head}$Elements\n{elements}\n1 5 2 2 2 1 2 4 3 5 6 8 7\n{rest}$EndElements\n")
    };
    // Of the cell's own boundary no block is made.
    let of_cell = read(mesh(7, &surface(1, 2)).as_bytes(), SceneFormat::Msh).unwrap();
    assert_eq!(volumes(&of_cell), [1.0]);
    for rest in [surface(9, 2), surface(1, 2) + &surface(9, 8)] {
        let both = read(mesh(1 + rest.lines().count(), &rest).as_bytes(), SceneFormat::Msh).unwrap();
        assert_eq!(volumes(&both), [1.0, 1.0]);
    }
    let open = surface(9, 2).lines().skip(1).map(|line| format!("{line}\n")).collect::<String>();
    let error = read(mesh(6, &open).as_bytes(), SceneFormat::Msh).unwrap_err();
    assert!(error.contains("the surface is open"), "{error}");
}

/// A mesh in ASCII as Gmsh writes it in binary; `width` is that of a count of version 4.
fn binary_msh(text: &str, big_endian: bool, width: usize) -> Vec<u8> {
    let ordered =
        |bytes: &[u8]| -> Vec<u8> { if big_endian { bytes.iter().rev().copied().collect() } else { bytes.to_vec() } };
    let integer = |word: &str| ordered(&word.parse::<i32>().unwrap().to_le_bytes());
    let number = |word: &str| ordered(&word.parse::<f64>().unwrap().to_le_bytes());
    let count = |word: &str| ordered(&word.parse::<u64>().unwrap().to_le_bytes()[..width]);
    let is_version_4 = text.contains("\n4.1 ");
    let mut out = Vec::new();
    let mut lines = text.lines();
    while let Some(heading) = lines.next() {
        let body: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("$End")).collect();
        out.extend(format!("{heading}\n").bytes());
        let mut words = body.iter().flat_map(|line| line.split_ascii_whitespace());
        let mut next = || words.next().unwrap();
        match (heading, is_version_4) {
            ("$MeshFormat", _) => {
                out.extend(format!("{} 1 {}\n", next(), if is_version_4 { width } else { 8 }).bytes());
                out.extend(integer("1"));
            }
            ("$Nodes", false) => {
                out.extend(format!("{}\n", next()).bytes());
                body[1..].iter().for_each(|_| {
                    out.extend(integer(next()));
                    (0..3).for_each(|_| out.extend(number(next())));
                });
            }
            ("$Elements", false) => {
                out.extend(format!("{}\n", next()).bytes());
                for line in &body[1..] {
                    let words: Vec<&str> = line.split(' ').collect();
                    // Lists of one element each; the tag stands behind the number of tags there.
                    [words[1], "1", words[2], words[0]].into_iter().for_each(|word| out.extend(integer(word)));
                    words[3..].iter().for_each(|word| out.extend(integer(word)));
                }
            }
            ("$Entities", true) => {
                let counts = [(); 4].map(|()| next());
                counts.iter().for_each(|word| out.extend(count(word)));
                for (dimension, entities) in counts.into_iter().enumerate() {
                    for _ in 0..entities.parse().unwrap() {
                        out.extend(integer(next()));
                        (0..if dimension == 0 { 3 } else { 6 }).for_each(|_| out.extend(number(next())));
                        for _ in 0..if dimension == 0 { 1 } else { 2 } {
                            let tags = next();
                            out.extend(count(tags));
                            (0..tags.parse().unwrap()).for_each(|_| out.extend(integer(next())));
                        }
                    }
                }
            }
            ("$Nodes" | "$Elements", true) => {
                let entities: usize = body[0].split(' ').next().unwrap().parse().unwrap();
                (0..4).for_each(|_| out.extend(count(next())));
                for _ in 0..entities {
                    let [dimension, entity, kind] = [(); 3].map(|()| next());
                    [dimension, entity, kind].into_iter().for_each(|word| out.extend(integer(word)));
                    // Of nodes, whether they have parameters, as many as the entity has dimensions.
                    let numbers = 3 + if kind == "1" { dimension.parse::<usize>().unwrap() } else { 0 };
                    let many = next();
                    out.extend(count(many));
                    let many: usize = many.parse().unwrap();
                    if heading == "$Nodes" {
                        (0..many).for_each(|_| out.extend(count(next())));
                        (0..numbers * many).for_each(|_| out.extend(number(next())));
                    } else {
                        // The number of each, and its nodes.
                        let words = 1 + match kind {
                            "15" => 1,
                            "2" => 3,
                            "3" => 4,
                            kind => panic!("type {kind}"),
                        };
                        (0..words * many).for_each(|_| out.extend(count(next())));
                    }
                }
            }
            _ => out.extend(body.iter().flat_map(|line| format!("{line}\n").into_bytes())),
        }
        out.extend(format!("\n{}\n", heading.replace('$', "$End")).bytes());
    }
    out
}

#[test]
fn binary_meshes_of_gmsh_are_those_in_ascii() {
    let named = |scene: Scene| -> Vec<_> { scene.blocks.into_iter().map(|block| (block.name, block.block)).collect() };
    for (name, widths) in [("cells.msh", &[8][..]), ("surfaces.msh", &[8, 4])] {
        let text = std::fs::read_to_string(fixture(name)).unwrap();
        let plain = named(read(text.as_bytes(), SceneFormat::Msh).unwrap());
        for (&width, big_endian) in widths.iter().flat_map(|width| [(width, false), (width, true)]) {
            let bytes = binary_msh(&text, big_endian, width);
            let scene = read(&bytes, SceneFormat::Msh).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(named(scene), plain, "{name}, {width}, {big_endian}");
            assert_eq!(SceneFormat::of_contents(&bytes), Some(SceneFormat::Msh));
        }
    }
}

#[test]
fn broken_binary_msh_says_where() {
    let text = std::fs::read_to_string(fixture("cells.msh")).unwrap();
    let good = binary_msh(&text, false, 8);
    let at = |mark: &str| good.windows(mark.len()).position(|window| window == mark.as_bytes()).unwrap() + mark.len();
    let (nodes, elements) = (at("$Nodes\n11\n"), at("$Elements\n5\n"));
    let changed = |at: usize, bytes: &[u8]| [&good[..at], bytes, &good[at + bytes.len()..]].concat();
    for (bytes, parts) in [
        (changed(nodes + 4, &f64::NAN.to_le_bytes()), vec![format!("a coordinate of a node, at byte {}", nodes + 4)]),
        (
            changed(nodes + 28, &1i32.to_le_bytes()),
            vec![format!("node 1, at byte {} of the file, is there twice", nodes + 28)],
        ),
        (changed(elements, &99i32.to_le_bytes()), vec![format!("element 1 of type 99, at byte {elements}")]),
        (
            changed(elements + 4, &6i32.to_le_bytes()),
            vec!["the number of elements of a list".to_owned(), "0 to 5".to_owned()],
        ),
        (
            changed(elements + 4, &0i32.to_le_bytes()),
            vec!["the number of elements of a list".to_owned(), "1 to 5".to_owned()],
        ),
        (
            changed(elements + 24, &77i32.to_le_bytes()),
            vec![format!("a node of element 1, at byte {}", elements + 24), "is 77".to_owned()],
        ),
        (good[..nodes + 40].to_vec(), vec!["the file ends where a coordinate of a node".to_owned()]),
        (good[..elements].to_vec(), vec!["the file ends where the type of elements".to_owned()]),
        (changed(at("$EndNodes") - 9, b"$EndNot"), vec!["where \"$EndNodes\"".to_owned(), "at byte".to_owned()]),
    ] {
        let error = read(&bytes, SceneFormat::Msh).unwrap_err();
        assert!(error.starts_with("mesh: ") && parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
    }
}

#[test]
fn broken_msh_says_where() {
    let two = std::fs::read_to_string(fixture("cells.msh")).unwrap();
    let four = std::fs::read_to_string(fixture("surfaces.msh")).unwrap();
    for (text, from, to, parts) in [
        (&two, "$MeshFormat\n2.2", "$MeshFormat\n3.0", &["mesh:2:", "version 3.0 cannot be read"][..]),
        (&two, "2.2 0 8", "2.2 2 8", &["mesh:2:", "a file of kind 2 cannot be read"]),
        (&two, "2.2 0 8", "2.2 1 8", &["mesh: the number that shows the order of bytes, at byte 20 of the file,"]),
        (&two, "$EndNodes", "", &["mesh:26:", "found \"$Elements\" where \"$EndNodes\""]),
        (&two, "2 1 0 0\n", "1 1 0 0\n", &["mesh:15:", "node 1 is there twice"]),
        (
            &two,
            "4 7 2 2 1 5",
            "4 11 2 2 1 5",
            &["mesh:31:", "element 4 of type 11 cannot be read", "Mesh.ElementOrder"],
        ),
        (&two, "5 6 7 8 20", "5 6 7 8 21", &["mesh:31:", "a node of element 4 is 21"]),
        (&two, "5 6 7 8 20", "5 6 7 8 8", &["mesh:31:", "block 1"]),
        (&two, "\"the ground\"", "\"the ground", &["mesh:9:", "a name in quotes"]),
        (&two, "20 0.5 0.5 2", "20 0.5 0.5 1e999", &["mesh:22:", "1e999 is not a finite number"]),
        (&four, "2 8 1 8\n", "2 8 2 8\n", &["mesh:35:", "whether nodes have parameters is 2"]),
        (&four, "3 25 1 25", "4000000000 25 1 25", &["mesh:", "$EndElements"]),
    ] {
        assert!(text.contains(from), "{from}");
        let error = read(text.replacen(from, to, 1).as_bytes(), SceneFormat::Msh).unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
    }
}

#[test]
fn no_mutated_file_of_bytes_makes_a_reader_panic() {
    const MUTANTS: u64 = if cfg!(debug_assertions) { 1_000 } else { 10_000 };
    let stl = binary_stl(&[wedge([0.0; 3]), wedge([0.0, 0.0, 1.0])].concat());
    let seeds: Vec<(SceneFormat, Vec<u8>)> =
        [(SceneFormat::Stl, stl), (SceneFormat::Ply, binary_ply(false)), (SceneFormat::Ply, binary_ply(true))]
            .into_iter()
            .chain(["cells.msh", "surfaces.msh"].map(|name| {
                let text = std::fs::read_to_string(fixture(name)).unwrap();
                (SceneFormat::Msh, binary_msh(&text, false, 8))
            }))
            .chain(forms().into_iter().map(|form| (SceneFormat::Vtu, grid(form))))
            .collect();
    let mut state = 1u64;
    let mut below = |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n.max(1)
    };
    let (mut good, mut refused) = (0, 0);
    for _ in 0..MUTANTS {
        let (format, bytes) = &seeds[below(seeds.len())];
        let mut bytes = bytes.clone();
        for _ in 0..1 + below(3) {
            let at = below(bytes.len());
            match below(4) {
                0 => bytes.truncate(at.max(1)),
                1 => bytes[at] = below(256) as u8,
                2 => bytes[at] ^= 1 << below(8),
                _ => bytes.insert(at, b"0 9<>\"=/-"[below(9)]),
            }
        }
        match read(&bytes, *format) {
            Ok(scene) => {
                assert!(!scene.blocks.is_empty());
                good += 1;
            }
            Err(error) => {
                assert!(error.starts_with("mesh:") && error.len() < 2000, "{error}");
                refused += 1;
            }
        }
    }
    assert!(good > MUTANTS / 50 && refused > MUTANTS / 4, "{good} read, {refused} refused");
}
