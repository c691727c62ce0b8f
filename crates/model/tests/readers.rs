//! Files load as what they are, and come back from being written as what they were.

use num_rational::BigRational;
use proptest::prelude::*;
use rockproof_model::scene::{SceneFormat, losses, write, write_toml};
use rockproof_model::{
    Block, Criteria, EdgeId, LoadOptions, Merged, Motion, Number, Precision, Scene, SceneBlock, Vec3, VertexId,
};
use std::path::{Path, PathBuf};

fn real(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../cases/real").join(name)
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/fixtures").join(name)
}

fn number(text: &str) -> Number {
    Number::parse(text).unwrap()
}

fn with_planarity(share: &str) -> LoadOptions {
    LoadOptions { planarity: Some(number(share)), ..LoadOptions::default() }
}

fn voronoi() -> Scene {
    Scene::load_with(real("voronoi_120.txt"), &with_planarity("1e-4")).unwrap()
}

fn volume(scene: &Scene) -> f64 {
    let total: BigRational = scene.blocks.iter().map(|b| b.block.volume()).sum();
    Number::from_rational(total).approximate()
}

#[test]
fn files_of_generators_load() {
    for (name, blocks, vertices, fixed) in [
        ("slope_joints.dda", 16, 128, 0),
        ("openpit_rock.dda", 270, 2032, 0),
        ("smallAngle.dda", 2, 12, 1),
        ("smallEdge.dda", 2, 16, 1),
    ] {
        let scene = Scene::load(real(name)).unwrap();
        assert_eq!(scene.blocks.len(), blocks, "{name}");
        assert_eq!(scene.shapes().iter().map(|b| b.vertices().len()).sum::<usize>(), vertices, "{name}");
        assert_eq!(scene.blocks.iter().filter(|b| b.body.is_fixed()).count(), fixed, "{name}");
        assert!(scene.blocks.iter().all(|b| b.block.is_convex() && b.merged == Merged::default()), "{name}");
    }
    let cells = voronoi();
    assert_eq!(cells.blocks.len(), 120);
    assert_eq!((cells.blocks[0].name.as_str(), cells.blocks[1].origin.line), ("cell_22", Some(2)));
    // The cells fill a cube of 4 m, but for the rounding of their vertices.
    assert!((volume(&cells) - 64.0).abs() < 1e-4);
}

/// Every scalar but that one is skipped, so blocks meant to be fixed fell.
#[test]
fn a_misspelt_fixed_flag_is_refused() {
    let text = std::fs::read_to_string(real("smallEdge.dda")).unwrap();
    let read = |text: &str| Scene::parse(text, SceneFormat::Dda, Path::new("small.dda"));
    for name in ["fixdFlag", "FixedFlag", "fixed", "flag"] {
        let error = read(&text.replace("fixedFlag", name)).unwrap_err().to_string();
        assert!(error.contains(&format!("a scalar is {name}; allowed is fixedFlag, in these letters")), "{error}");
    }
    assert!(read(&text.replace("aspectRatio", "shape")).is_ok());
}

/// Of STL a number of triangles was said, of PLY that it is none.
#[test]
fn a_text_in_utf_16_is_called_so_in_every_format() {
    for (format, mark) in SceneFormat::ALL.into_iter().flat_map(|format| [(format, ""), (format, "\u{feff}")]) {
        for order in [u16::to_le_bytes, u16::to_be_bytes] {
            let text = format!("{mark}solid a\n").repeat(20);
            let bytes: Vec<u8> = text.encode_utf16().flat_map(order).collect();
            let read = Scene::parse_bytes(&bytes, format, Path::new("file"), &LoadOptions::default());
            let error = read.unwrap_err().to_string();
            assert!(error.starts_with("file: this is a text in UTF-16; "), "{format:?}: {error}");
        }
    }
}

/// As early Macintosh ends lines; the file was "without a block".
#[test]
fn lines_that_end_in_a_carriage_return_alone_are_lines() {
    let text = std::fs::read_to_string(fixture("two_cubes.obj")).unwrap();
    let read = |text: &str| Scene::parse(text, SceneFormat::Obj, Path::new("two.obj"));
    let [plain, returns] = [text.clone(), text.replace('\n', "\r")].map(|text| read(&text).unwrap());
    let kept = |scene: &Scene| -> Vec<_> {
        scene.blocks.iter().map(|b| (b.name.clone(), b.block.clone(), b.origin.line)).collect()
    };
    assert_eq!(kept(&returns), kept(&plain));
}

#[test]
fn voronoi_cells_need_the_planarity_they_have() {
    let error = Scene::load(real("voronoi_120.txt")).unwrap_err().to_string();
    for part in [
        "voronoi_120.txt:1:",
        "block 0 \"cell_22\"",
        "face 0 is not planar",
        "vertex 2",
        "allowed is a planarity of 1e-9",
    ] {
        assert!(error.contains(part), "{error}");
    }
    let (scene, problems) = Scene::survey(real("voronoi_120.txt"), &LoadOptions::default()).unwrap();
    assert_eq!(scene.blocks.len() + problems.len(), 120);
    assert!(problems.windows(2).all(|p| p[0].line < p[1].line));
}

#[test]
fn a_scene_says_what_it_says() {
    let scene = Scene::load(fixture("scene.toml")).unwrap();
    let names: Vec<&str> = scene.blocks.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["base", "block_1", "pile_0", "pile_1", "block_4", "block_5"]);
    let fixed: Vec<bool> = scene.blocks.iter().map(|b| b.body.is_fixed()).collect();
    assert_eq!(fixed, [true, false, true, true, true, false]);
    assert_eq!(scene.blocks[0].block.vertices()[0].z, number("1/3"));
    assert_eq!(scene.blocks[1].block.volume(), BigRational::new(4.into(), 9.into()));
    assert!(scene.blocks[2].origin.file.ends_with("two_cubes.obj"));
    let set = scene.tolerances.as_ref().unwrap().resolve(&scene.shapes(), Precision::F64).unwrap();
    assert_eq!(set.search, number("1/10"));
    assert_eq!(set.parallel_sine, number("3/64"));
    assert_eq!(set.overlap_sine.as_f64(), Some(0.052335956242943835));
    assert_eq!(set.criteria, Criteria::Revised);
}

#[test]
fn triangles_of_a_cube_become_its_faces() {
    let scene = Scene::load(fixture("cube_triangles.obj")).unwrap();
    let cube = &scene.blocks[0];
    assert_eq!((scene.blocks.len(), cube.name.as_str()), (1, "cube"));
    assert_eq!(cube.merged, Merged { faces: 6, vertices: 0 });
    assert_eq!((cube.block.topology().faces().len(), cube.block.topology().edges().len()), (6, 12));
    assert!(cube.block.is_convex());
}

#[test]
fn triangles_near_one_plane_merge_within_the_planarity_asked_for() {
    let path = fixture("cube_triangles_turned.obj");
    let apart = Scene::load(&path).unwrap();
    assert_eq!(apart.blocks[0].block.topology().faces().len(), 9);
    let merged = Scene::load_with(&path, &with_planarity("1e-5")).unwrap();
    assert_eq!(merged.blocks[0].block.topology().faces().len(), 6);
    assert!(merged.blocks[0].block.is_convex());
}

#[test]
fn triangles_of_a_concave_block_become_its_faces() {
    let scene = Scene::load(fixture("l_block_triangles.obj")).unwrap();
    let block = &scene.blocks[0].block;
    assert_eq!((block.topology().faces().len(), block.topology().edges().len()), (8, 18));
    let reflex = (0..18).filter(|&e| !block.edge_is_convex(EdgeId(e))).count();
    assert_eq!(reflex, 1);
    assert_eq!(volume(&scene), 4.0);
}

#[test]
fn one_pile_of_cubes_in_three_files() {
    let obj = Scene::load(fixture("two_cubes.obj")).unwrap();
    let old = Scene::load(fixture("two_cubes.vtk")).unwrap();
    let new = Scene::load(fixture("two_cubes_version_5.vtk")).unwrap();
    assert_eq!(obj.blocks.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["pile_0", "pile_1"]);
    assert_eq!(obj.shapes(), old.shapes());
    for (a, b) in old.shapes().iter().zip(new.shapes()) {
        let (a_box, b_box) = (a.bounds(), b.bounds());
        assert_eq!((a_box.min, a_box.max), (b_box.min, b_box.max));
        assert_eq!(a.volume(), b.volume());
    }
}

/// Everything but where it was read from and what was merged on the way.
fn facts(scene: &Scene) -> Vec<(&str, bool, &Number, &Block)> {
    scene.blocks.iter().map(|b| (b.name.as_str(), b.body.is_fixed(), &b.planarity, &b.block)).collect()
}

#[test]
fn toml_keeps_everything() {
    let all = [Scene::load(fixture("scene.toml")).unwrap(), Scene::load(real("openpit_rock.dda")).unwrap(), voronoi()];
    for scene in all {
        let again = Scene::parse(&write_toml(&scene), SceneFormat::Toml, Path::new("again.toml")).unwrap();
        assert_eq!(facts(&again), facts(&scene));
        assert_eq!(again.tolerances, scene.tolerances);
    }
}

#[test]
fn meshes_keep_shapes() {
    let mut scene = Scene::load(real("openpit_rock.dda")).unwrap();
    scene.blocks.extend(Scene::load(fixture("l_block_triangles.obj")).unwrap().blocks);
    for format in [SceneFormat::Obj, SceneFormat::Vtk, SceneFormat::Vtu] {
        let again = again(&scene, format);
        assert_eq!(again.shapes(), scene.shapes(), "{format:?}");
        let named = again.blocks.iter().zip(&scene.blocks).all(|(a, b)| a.name == b.name);
        assert_eq!(named, format == SceneFormat::Obj, "{format:?}");
    }
}

/// A scene written and read.
fn again(scene: &Scene, format: SceneFormat) -> Scene {
    Scene::parse_bytes(&write(scene, format).unwrap(), format, Path::new("again"), &LoadOptions::default()).unwrap()
}

/// The corners of a block's faces, each face from its least corner on, in order: what is left where vertices and faces are renumbered.
fn polygons(block: &Block) -> Vec<Vec<[Number; 3]>> {
    let polygon = |face: &Vec<VertexId>| {
        let corner = |&v: &VertexId| block.vertices()[v.index()].map(Number::clone);
        let corners: Vec<[Number; 3]> = face.iter().map(corner).map(|v| [v.x, v.y, v.z]).collect();
        let least = (0..corners.len()).min_by_key(|&k| &corners[k]).unwrap();
        [&corners[least..], &corners[..least]].concat()
    };
    let mut all: Vec<_> = block.topology().faces().iter().map(polygon).collect();
    all.sort();
    all
}

#[test]
fn stl_keeps_every_bit_of_shapes_and_their_names() {
    let mut scene = Scene::load(real("slope_joints.dda")).unwrap();
    scene.blocks.extend(Scene::load(fixture("l_block_triangles.obj")).unwrap().blocks);
    for format in [SceneFormat::Stl, SceneFormat::Msh] {
        let again = again(&scene, format);
        assert_eq!(again.blocks.len(), scene.blocks.len());
        for (a, b) in again.blocks.iter().zip(&scene.blocks) {
            assert_eq!((a.name.as_str(), polygons(&a.block)), (b.name.as_str(), polygons(&b.block)), "{format:?}");
        }
    }
}

#[test]
fn ply_keeps_every_bit_of_shapes() {
    let mut scene = Scene::load(real("openpit_rock.dda")).unwrap();
    scene.blocks.extend(Scene::load(fixture("l_block_triangles.obj")).unwrap().blocks);
    let again = again(&scene, SceneFormat::Ply);
    assert_eq!(again.blocks.len(), scene.blocks.len());
    for (a, b) in again.blocks.iter().zip(&scene.blocks) {
        assert_eq!(polygons(&a.block), polygons(&b.block), "{}", b.name);
    }
}

#[test]
fn names_that_gmsh_cannot_hold_are_changed_and_told() {
    let mut scene = Scene::load(real("smallEdge.dda")).unwrap();
    assert!(losses(&scene, SceneFormat::Msh).iter().all(|lost| !lost.contains("quotes")));
    "the \"big\"  one\n".clone_into(&mut scene.blocks[0].name);
    assert!(losses(&scene, SceneFormat::Msh).iter().any(|lost| lost.contains("quotes")));
    assert_eq!(again(&scene, SceneFormat::Msh).blocks[0].name, "the 'big' one");
}

#[test]
fn contents_tell_the_format() {
    let all = [
        (SceneFormat::Dda, real("smallAngle.dda")),
        (SceneFormat::Voro, real("voronoi_120.txt")),
        (SceneFormat::Obj, fixture("two_cubes.obj")),
        (SceneFormat::Vtk, fixture("two_cubes.vtk")),
        (SceneFormat::Vtu, fixture("cells.vtu")),
        (SceneFormat::Stl, fixture("two_wedges.stl")),
        (SceneFormat::Ply, fixture("box.ply")),
        (SceneFormat::Msh, fixture("cells.msh")),
        (SceneFormat::Toml, fixture("scene.toml")),
    ];
    assert_eq!(all.len(), SceneFormat::ALL.len());
    for (format, path) in all {
        assert_eq!(SceneFormat::of_contents(&std::fs::read(&path).unwrap()), Some(format), "{path:?}");
        assert_eq!(SceneFormat::from_name(format.name()), Some(format));
    }
    for (text, format) in [
        ("# a comment\n\ns = 1\n", Some(SceneFormat::Toml)),
        ("# a comment\n\ns 1\n", Some(SceneFormat::Obj)),
        ("# a comment\n", None),
        ("# vtk DataFile Version 3.0", Some(SceneFormat::Vtk)),
        ("v", None),
        ("plywood", None),
    ] {
        assert_eq!(SceneFormat::of_contents(text.as_bytes()), format, "{text}");
    }
}

#[test]
fn decimals_refuse_what_they_cannot_hold() {
    let scene = Scene::load(fixture("scene.toml")).unwrap();
    for format in SceneFormat::ALL.into_iter().filter(|format| format.is_written() && *format != SceneFormat::Toml) {
        let error = write(&scene, format).unwrap_err().to_string();
        assert!(error.contains("block 0 \"base\", vertex 0: 1/3 is not an f64"), "{error}");
    }
}

fn any_number() -> impl Strategy<Value = Number> {
    prop_oneof![
        any::<f64>().prop_filter_map("finite, of a size with room", |v| {
            (v == 0.0 || (1e-200..1e200).contains(&v.abs())).then(|| Number::from_f64(v).ok()).flatten()
        }),
        (any::<i64>(), 1..i64::MAX).prop_map(|(n, d)| Number::from_rational(BigRational::new(n.into(), d.into()))),
    ]
}

proptest! {
    #[test]
    fn any_box_survives_toml(a in prop::array::uniform3(any_number()), b in prop::array::uniform3(any_number()), fixed: bool) {
        let corner = |pick: fn(&Number, &Number) -> Number| {
            let [x, y, z] = std::array::from_fn(|i| pick(&a[i], &b[i]));
            Vec3::new(x, y, z)
        };
        let (min, max) = (corner(|a, b| a.min(b).clone()), corner(|a, b| a.max(b).clone()));
        if let Ok(block) = Block::cuboid(&min, &max) {
            let mut block = SceneBlock::new("a \"quoted\" \\ name é", block);
            if fixed {
                block.body.motion = Motion::Fixed;
            }
            let scene = Scene { blocks: vec![block], ..Scene::default() };
            let again = Scene::parse(&write_toml(&scene), SceneFormat::Toml, Path::new("again.toml")).unwrap();
            prop_assert_eq!(facts(&again), facts(&scene));
        }
    }

    #[test]
    fn no_reader_panics_on_any_text(text in "\\PC{0,200}") {
        read_by_all(&text);
    }
}

fn read_by_all(text: &str) {
    for format in SceneFormat::ALL {
        // Either answer is fine.
        let _ = Scene::parse(text, format, Path::new("any"));
    }
}

/// Good files with a few bytes changed, cut or doubled come closer to the readers' depths than random text.
fn damaged() -> impl Strategy<Value = (SceneFormat, String)> {
    let file = |name: PathBuf| std::fs::read_to_string(name).unwrap();
    let good = vec![
        (SceneFormat::Dda, file(real("smallAngle.dda"))),
        (SceneFormat::Voro, file(real("voronoi_120.txt")).lines().take(2).collect::<Vec<_>>().join("\n")),
        (SceneFormat::Obj, file(fixture("two_cubes.obj"))),
        (SceneFormat::Vtk, file(fixture("two_cubes.vtk"))),
        (SceneFormat::Vtk, file(fixture("two_cubes_version_5.vtk"))),
        (
            SceneFormat::Toml,
            file(fixture("scene.toml")).split("[[block]]\nname = \"pile\"").next().unwrap().to_string(),
        ),
    ];
    let edit =
        (any::<prop::sample::Index>(), 0_usize..4, prop::sample::select(b"0123456789-.eE/(),[] \n\"xn".to_vec()));
    (prop::sample::select(good), prop::collection::vec(edit, 1..6)).prop_map(|((format, text), edits)| {
        let mut bytes = text.into_bytes();
        for (place, kind, byte) in edits {
            let at = place.index(bytes.len().max(1));
            match kind {
                0 if at < bytes.len() => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 => bytes.truncate(at),
                _ => {
                    let end = (at + 40).min(bytes.len());
                    bytes.extend_from_within(at..end);
                }
            }
        }
        (format, String::from_utf8_lossy(&bytes).into_owned())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn no_reader_panics_on_damage((format, text) in damaged()) {
        let _ = Scene::parse(&text, format, Path::new("any"));
    }
}

#[test]
fn no_reader_panics_on_bytes() {
    let directory = tempfile::tempdir().unwrap();
    for (seed, extension) in SceneFormat::ALL.into_iter().flat_map(SceneFormat::extensions).enumerate() {
        // A linear congruential generator is random enough to be nonsense.
        let mut state = seed as u64 + 1;
        let bytes: Vec<u8> = (0..5000)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 33) as u8
            })
            .collect();
        let path = directory.path().join(format!("noise.{extension}"));
        std::fs::write(&path, bytes).unwrap();
        let error = Scene::load(&path).unwrap_err().to_string();
        let says = match *extension {
            "stl" => "the number of bytes of the file",
            "ply" => "what is no PLY",
            _ => "which is not text",
        };
        assert!(error.contains(says), "{error}");
    }
}
