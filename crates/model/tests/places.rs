//! Where errors about blocks say that the mistake is: the line of the face or vertex, and the coordinates, in every format that has lines.

use rockproof_model::scene::{SceneFormat, losses, write};
use rockproof_model::{LoadOptions, Number, Scene};
use std::path::Path;

/// A cube with a corner pulled out along x, so that its face 3 alone is bent; a sound block before it.
const BENT: &str = "planarity = 0.5
[[block]]
box = { min = [-3, 0, 0], max = [-2, 1, 1] }
[[block]]
vertices = [
  [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1.25, 1, 1], [0, 1, 1],
]
faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
";
const DDA: &str = include_str!("../../../cases/real/smallAngle.dda");

fn bent() -> Scene {
    Scene::parse(BENT, SceneFormat::Toml, Path::new("bent")).unwrap()
}

fn written(scene: &Scene, format: SceneFormat) -> String {
    String::from_utf8(write(scene, format).unwrap()).unwrap()
}

fn error(text: &str, format: SceneFormat) -> String {
    Scene::parse(text, format, Path::new("file")).unwrap_err().to_string()
}

fn with_scale(scale: &str) -> LoadOptions {
    LoadOptions { scale: Number::parse(scale).ok(), ..LoadOptions::default() }
}

fn with_planarity(planarity: &str) -> LoadOptions {
    LoadOptions { planarity: Number::parse(planarity).ok(), ..LoadOptions::default() }
}

/// The number of the only line that is this one.
fn line_of(text: &str, wanted: &str) -> usize {
    let lines: Vec<usize> = (1..).zip(text.lines()).filter(|(_, line)| *line == wanted).map(|(i, _)| i).collect();
    assert_eq!(lines.len(), 1, "{wanted}: {lines:?}");
    lines[0]
}

fn change(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn a_bent_face_is_named_with_its_line_and_all_its_corners() {
    for (format, face, corner) in [
        (SceneFormat::Obj, "f 10 11 15 14", "v 1.25 1.0 1.0"),
        (SceneFormat::Ply, "4 9 10 14 13", "1.25 1.0 1.0"),
        (SceneFormat::Toml, "  [1, 2, 6, 5],", "  [1.25, 1.0, 1.0],"),
        (SceneFormat::Vtk, "", "1.25 1.0 1.0"),
    ] {
        let text = written(&bent(), format).replace("planarity = 0.5\n", "");
        // Of TOML the first block is written likewise.
        let text = if format == SceneFormat::Toml { text[text.rfind("[[block]]").unwrap()..].to_owned() } else { text };
        let error = error(&text, format);
        // A cell of VTK is one line.
        let face = if face.is_empty() { line_of(&text, corner) + 4 } else { line_of(&text, face) };
        assert!(error.starts_with(&format!("file:{face}: block ")), "{format:?}, line {face}: {error}");
        let said = "face 3 is not planar: its four corners are equally far from their common plane, ";
        assert!(
            error.contains(said) && error.contains("allowed is a planarity of 1e-9 (vertex 1 at (1, 0, 0) in"),
            "{error}"
        );
        let corner = line_of(&text, corner);
        assert!(error.contains(&format!(", vertex 6 at (1.25, 1, 1) in line {corner}, vertex 5 at")), "{error}");
    }
}

/// What else is wrong then, a face that crosses itself or an open edge, was all that was said.
#[test]
fn a_huge_coordinate_is_named_before_what_it_makes_of_the_block() {
    // The numbers of a VTU that is written are no text.
    let is_text = |format: &SceneFormat| format.is_written() && *format != SceneFormat::Vtu;
    for format in SceneFormat::ALL.into_iter().filter(is_text) {
        let text = written(&bent(), format).replace("planarity = 0.5\n", "");
        let corner = if format == SceneFormat::Toml { "1.25, 1.0, 1.0" } else { "1.25 1.0 1.0" };
        // The corner by itself, and in the file of triangles one of its places.
        let huge = |coordinate: &str| change(&text, corner, &corner.replace("1.25", coordinate));
        let found = error(&huge("-1e300"), format);
        assert!(
            found.contains(" has a coordinate of -1e300 m; beyond 1e45 m weights and energies overflow f64"),
            "{found}"
        );
        let line = 1 + huge("-1e300").lines().position(|line| line.contains("-1e300")).unwrap();
        let place = format!("at (-1e300, 1, 1) in line {line})");
        assert!(found.starts_with(&format!("file:{line}: block ")) && found.contains(&place), "{format:?}: {found}");
        let found = error(&huge("-1e44"), format);
        assert!(!found.contains("beyond"), "{format:?}: {found}");
    }
    let text = change(&written(&bent(), SceneFormat::Obj), "v 1.25 1.0 1.0", "v -1e47 1.0 1.0");
    for (scale, is_huge) in [("1", true), ("1/1000", false), ("1/10", true)] {
        let read = Scene::parse_bytes(text.as_bytes(), SceneFormat::Obj, Path::new("file"), &with_scale(scale));
        let error = read.unwrap_err().to_string();
        assert_eq!(error.contains("beyond 1e45 m"), is_huge, "{scale}: {error}");
    }
}

#[test]
fn an_open_edge_is_named_with_its_line_and_both_its_ends() {
    // The last triangle of the second block with another corner.
    for (format, from, to) in [
        (SceneFormat::Stl, "vertex 1.25 1.0 1.0", "vertex 1.25 1.0 2.0"),
        (SceneFormat::Msh, " 2 2 10 15 14\n", " 2 2 10 15 12\n"),
        (SceneFormat::Obj, "f 10 11 15 14\n", "f 10 11 15\n"),
    ] {
        let text = change(&written(&bent(), format), from, to);
        let error = error(&text, format);
        assert!(error.contains("the surface is open at edge"), "{format:?}: {error}");
        let lines: Vec<&str> = text.lines().collect();
        let number = |text: &str| text.chars().take_while(char::is_ascii_digit).collect::<String>().parse::<usize>();
        // Every vertex named is in the line named.
        let mut ends = Vec::new();
        for part in error.split(" at (").skip(1) {
            let (at, rest) = part.split_once(") in line ").expect("a line");
            let line = lines[number(rest).unwrap() - 1];
            let numbers: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
            let at: Vec<f64> = at.split(", ").map(|c| c.parse().unwrap()).collect();
            assert!(numbers.ends_with(&at), "{at:?} in {line}: {error}");
            ends.push(line);
        }
        assert_eq!(ends.len(), 2, "{error}");
        // And the face named has both.
        let at = number(error.strip_prefix("file:").unwrap()).unwrap() - 1;
        match format {
            SceneFormat::Stl => {
                assert!(lines[at].trim().starts_with("facet"), "{error}");
                let corners: Vec<&str> = lines[at + 2..at + 5].to_vec();
                assert!(ends.iter().all(|end| corners.contains(end)), "{error}");
            }
            _ => {
                let first = if format == SceneFormat::Msh { line_of(&text, "$Nodes") + 1 } else { 0 };
                let names = |end: &str| {
                    let line = lines.iter().position(|line| *line == end).unwrap();
                    let vertex = match format {
                        SceneFormat::Msh => line + 1 - first,
                        _ => lines[..=line].iter().filter(|line| line.starts_with("v ")).count(),
                    };
                    lines[at].split(' ').skip(1).any(|word| word == vertex.to_string())
                };
                assert!(ends.iter().all(|end| names(end)), "{}: {error}", lines[at]);
            }
        }
    }
}

#[test]
fn vertices_have_lines_too() {
    let text = change(&written(&bent(), SceneFormat::Obj), "v 1.25 1.0 1.0", "v 1.0 1.0 0.0");
    let error = error(&text, SceneFormat::Obj);
    let second = (1..).zip(text.lines()).filter(|(_, line)| *line == "v 1.0 1.0 0.0").map(|(i, _)| i).max().unwrap();
    assert!(
        error.starts_with(&format!("file:{second}: ")) && error.contains("vertices 2 and 6 are the same"),
        "{error}"
    );
}

#[test]
fn a_binary_mesh_has_coordinates_alone() {
    let mut bytes = [0; 84].to_vec();
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        bytes.extend([0; 12]);
        face.iter().flat_map(|&v: &usize| corners[v]).for_each(|c| bytes.extend(c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes[80] = 4;
    // The apex of the last triangle, pulled up.
    let last = bytes.len() - 6;
    bytes[last..last + 4].copy_from_slice(&2.5f32.to_le_bytes());
    let read = Scene::parse_bytes(&bytes, SceneFormat::Stl, Path::new("file"), &LoadOptions::default());
    let error = read.unwrap_err().to_string();
    assert!(
        error.starts_with("file: block 0: ") && error.contains(" at (0, 0, ") && !error.contains("line"),
        "{error}"
    );
}

#[test]
fn a_face_of_a_dda_file_has_the_line_of_its_first_vertex() {
    let nodes = change(DDA, "0 1 2 3 0 3 4 1 5 2 2 5 4 3 0 4 5 1", "0 1 2 3\n0 3 4\n1 5 2\n2 5 4 3\n0 4 5 9");
    let said = error(&nodes, SceneFormat::Dda);
    assert!(said.starts_with("file:25: block 0: face 4 names vertex 9"), "{said}");
    // A bent face of the second block, and its corner.
    let said = error(&change(DDA, "\n-1 2.0 0.03492076889557946", "\n-1 2.0 0.5"), SceneFormat::Dda);
    assert!(said.starts_with("file:22: block 1: face ") && said.contains(" at (-1, 2, 0.5) in line 14"), "{said}");
}

#[test]
fn a_line_of_coordinates_too_many_or_too_few_is_named() {
    for (to, words) in [("0 3.0 0 800\n", "4 words"), ("0 3.0\n", "2 words"), ("0\n", "1 word")] {
        let said = error(&change(DDA, "0 3.0 0\n", to), SceneFormat::Dda);
        let expected = format!("file:10: found a line of {words} where the 3 coordinates of a vertex should stand");
        assert_eq!(said, expected);
    }
    // Where lines mean nothing nothing is said of them.
    let (before, rest) = DDA.split_at(DDA.find("-4 3.0").unwrap());
    let (points, behind) = rest.split_at(rest.find("FACES_NODELIST").unwrap());
    let said = error(&format!("{before}{}800\n{behind}", points.replace('\n', " ")), SceneFormat::Dda);
    assert!(said.contains("found \"800\" where \"FACES_NODELIST\" should stand"), "{said}");
}

#[test]
fn a_volume_is_that_of_the_scaled_block() {
    let inside_out = change(&written(&bent(), SceneFormat::Obj), "o block_0", "o x");
    let inside_out: Vec<String> = inside_out
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(face) => format!("f {}", face.split(' ').rev().collect::<Vec<_>>().join(" ")),
            None => line.to_owned(),
        })
        .collect();
    let read = |scale| {
        let bytes = inside_out.join("\n").into_bytes();
        Scene::parse_bytes(&bytes, SceneFormat::Obj, Path::new("file"), &with_scale(scale)).unwrap_err().to_string()
    };
    assert!(read("1").contains("the volume is -1.000000e0 m³"), "{}", read("1"));
    assert!(read("1/1000").contains("the volume is -1.000000e-9 m³"), "{}", read("1/1000"));
}

#[test]
fn the_planarity_that_a_format_does_not_keep_is_told() {
    let told = |scene: &Scene, format| losses(scene, format).into_iter().find(|lost| lost.contains("planarity"));
    let scene = bent();
    assert_eq!(told(&scene, SceneFormat::Toml), None);
    for format in [SceneFormat::Obj, SceneFormat::Stl, SceneFormat::Ply, SceneFormat::Msh, SceneFormat::Vtu] {
        let lost = told(&scene, format).expect("a note");
        let name = format.name().to_uppercase();
        assert_eq!(lost, format!("{name} does not keep the planarity; read it with --planarity 5e-1"));
        let bytes = write(&scene, format).unwrap();
        let again = Scene::parse_bytes(&bytes, format, Path::new("file"), &with_planarity("5e-1")).unwrap();
        assert_eq!(again.blocks.len(), 2);
    }
    // Nothing is lost with a block that is planar, whatever it was read with.
    let planar = Scene { blocks: scene.blocks[..1].to_vec(), ..Scene::default() };
    assert_eq!(told(&planar, SceneFormat::Obj), None);
}
