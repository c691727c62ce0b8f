//! Gmsh's files as surfaces of two physical groups, in both versions, in text and binary (docs/formats.md).

use super::cells::{coordinates, numbered};
use super::formats::{AS_LISTED, CORNERS, FACES, Held, TRIANGLES, assert_model, lines, read};
use rockproof_model::LoadOptions;
use rockproof_model::scene::SceneFormat;

/// The surface of the model as Gmsh has it: polygons of three and four corners, the L's in group 3, the tetrahedron's in group 8. Nodes are
/// numbered 10, 20, 30, …
struct Element {
    kind: i32,
    group: i32,
    nodes: Vec<u32>,
}

fn elements() -> Vec<Element> {
    let caps = TRIANGLES[..8].iter().map(|t| t.to_vec());
    let rest = FACES[2..].iter().map(|f| f.to_vec());
    let element = |face: Vec<u32>| Element {
        kind: if face.len() == 3 { 2 } else { 3 },
        group: if face[0] < 12 { 3 } else { 8 },
        nodes: face.iter().map(|v| 10 * (v + 1)).collect(),
    };
    caps.chain(rest).map(element).collect()
}

const GROUPS: &str = "$PhysicalNames\n2\n2 3 \"ell\"\n2 8 \"tet\"\n$EndPhysicalNames\n";

#[test]
fn gmsh_2_in_text_and_binary() {
    let nodes = lines(CORNERS.iter().enumerate(), |(k, v)| format!("{} {v}", 10 * (k + 1)));
    let element = |(k, e): (usize, Element)| format!("{} {} 2 {} 1 {}", k + 1, e.kind, e.group, numbered(&e.nodes));
    let all = elements();
    let count = all.len();
    let text =
        format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{GROUPS}$Nodes\n16\n{nodes}$EndNodes\n$Elements\n{count}\n")
            + &lines(all.into_iter().enumerate(), element)
            + "$EndElements\n";
    let scene = read(text.as_bytes(), SceneFormat::Msh, &LoadOptions::default()).expect("a text");
    assert_model("text", &scene, ["ell", "tet"], &AS_LISTED, Held::F64);

    let mut bytes = b"$MeshFormat\n2.2 1 8\n".to_vec();
    bytes.extend(1_i32.to_le_bytes());
    bytes.extend(format!("\n$EndMeshFormat\n{GROUPS}$Nodes\n16\n").bytes());
    let values: Vec<f64> = coordinates().collect();
    for (k, corner) in values.chunks(3).enumerate() {
        bytes.extend((10 * (k as i32 + 1)).to_le_bytes());
        corner.iter().for_each(|c| bytes.extend(c.to_le_bytes()));
    }
    bytes.extend(format!("\n$EndNodes\n$Elements\n{count}\n").bytes());
    for (k, e) in elements().into_iter().enumerate() {
        let head = [e.kind, 1, 2, k as i32 + 1, e.group, 1];
        let words = head.into_iter().chain(e.nodes.into_iter().map(|v| v as i32));
        words.for_each(|word| bytes.extend(word.to_le_bytes()));
    }
    bytes.extend(b"\n$EndElements\n");
    let scene = read(&bytes, SceneFormat::Msh, &LoadOptions::default()).expect("binary");
    assert_model("binary", &scene, ["ell", "tet"], &AS_LISTED, Held::F64);
}

/// Blocks of elements as version 4 has them: an entity, 1 of group 3 or 2 of group 8, and a kind for each.
fn entities() -> Vec<(i32, i32, Vec<Element>)> {
    let mut found: Vec<(i32, i32, Vec<Element>)> = Vec::new();
    for element in elements() {
        let entity = if element.group == 3 { 1 } else { 2 };
        match found.last_mut() {
            Some((last, kind, all)) if (*last, *kind) == (entity, element.kind) => all.push(element),
            _ => found.push((entity, element.kind, vec![element])),
        }
    }
    found
}

#[test]
fn gmsh_4_in_text_and_binary() {
    let tags: Vec<u64> = (1..=16).map(|k| 10 * k).collect();
    let blocks = entities();
    let count: usize = blocks.iter().map(|(_, _, all)| all.len()).sum();
    let mut element = 0;
    let mut block = |(entity, kind, all): &(i32, i32, Vec<Element>)| {
        let rows = lines(all, |e| format!("{} {}", 500 + e.nodes[0], numbered(&e.nodes)));
        element += all.len();
        format!("2 {entity} {kind} {}\n{rows}", all.len())
    };
    let rows: String = blocks.iter().map(&mut block).collect();
    assert_eq!(element, count);
    let text = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{GROUPS}$Entities\n0 0 2 0\n1 -1 -2 0 2 2 2 1 3 0\n2 4 0 0 5 2 3 1 8 0\n$EndEntities\n\
         $Nodes\n1 16 10 160\n2 1 0 16\n{}{}$EndNodes\n$Elements\n{} {count} 1 900\n{rows}$EndElements\n",
        lines(&tags, u64::to_string),
        lines(CORNERS, str::to_string),
        blocks.len()
    );
    let scene = read(text.as_bytes(), SceneFormat::Msh, &LoadOptions::default()).expect("a text");
    assert_model("text", &scene, ["ell", "tet"], &AS_LISTED, Held::F64);

    let mut bytes = b"$MeshFormat\n4.1 1 8\n".to_vec();
    bytes.extend(1_i32.to_le_bytes());
    bytes.extend(format!("\n$EndMeshFormat\n{GROUPS}$Entities\n").bytes());
    let long = |bytes: &mut Vec<u8>, all: &[u64]| all.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    let short = |bytes: &mut Vec<u8>, all: &[i32]| all.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    long(&mut bytes, &[0, 0, 2, 0]);
    for (tag, group) in [(1, 3), (2, 8)] {
        short(&mut bytes, &[tag]);
        [-1.0_f64, -2.0, 0.0, 5.0, 2.0, 3.0].iter().for_each(|c| bytes.extend(c.to_le_bytes()));
        long(&mut bytes, &[1]);
        short(&mut bytes, &[group]);
        long(&mut bytes, &[0]);
    }
    bytes.extend(b"\n$EndEntities\n$Nodes\n");
    long(&mut bytes, &[1, 16, 10, 160]);
    short(&mut bytes, &[2, 1, 0]);
    long(&mut bytes, &[16]);
    long(&mut bytes, &tags);
    coordinates().for_each(|c| bytes.extend(c.to_le_bytes()));
    bytes.extend(b"\n$EndNodes\n$Elements\n");
    long(&mut bytes, &[blocks.len() as u64, count as u64, 1, 900]);
    for (entity, kind, all) in blocks {
        short(&mut bytes, &[2, entity, kind]);
        long(&mut bytes, &[all.len() as u64]);
        for e in all {
            long(&mut bytes, &[500 + u64::from(e.nodes[0])]);
            e.nodes.iter().for_each(|v| bytes.extend(u64::from(*v).to_le_bytes()));
        }
    }
    bytes.extend(b"\n$EndElements\n");
    let scene = read(&bytes, SceneFormat::Msh, &LoadOptions::default()).expect("binary");
    assert_model("binary", &scene, ["ell", "tet"], &AS_LISTED, Held::F64);
}
