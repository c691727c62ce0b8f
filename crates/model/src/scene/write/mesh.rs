//! Scenes as STL, PLY, Gmsh's meshes and VTK's XML.

use super::{FormatError, decimals, push};
use crate::scene::{Scene, SceneBlock};
use crate::vtu_writer::{Cells, Polyhedra, UnstructuredGrid};

/// The scene as text STL, one solid a block, faces cut into triangles. Coordinates have all digits of an f64.
pub(super) fn stl(scene: &Scene) -> Result<String, FormatError> {
    let mut out = String::new();
    for (number, block) in scene.blocks.iter().enumerate() {
        let points = points(block, number, "STL")?;
        push(&mut out, format_args!("solid {}\n", block.name));
        for triangle in block.block.triangles(&block.planarity) {
            let corners = triangle.map(|vertex| points[vertex.index()]);
            let [x, y, z] = unit_normal(corners);
            push(&mut out, format_args!("  facet normal {x:?} {y:?} {z:?}\n    outer loop\n"));
            for [x, y, z] in corners {
                push(&mut out, format_args!("      vertex {x:?} {y:?} {z:?}\n"));
            }
            out.push_str("    endloop\n  endfacet\n");
        }
        push(&mut out, format_args!("endsolid {}\n", block.name));
    }
    Ok(out)
}

/// The scene as text PLY: vertices and faces as they are, blocks apart by having no vertex in common.
pub(super) fn ply(scene: &Scene) -> Result<String, FormatError> {
    let topologies = || scene.blocks.iter().map(|block| block.block.topology());
    let vertices: usize = scene.blocks.iter().map(|block| block.block.vertices().len()).sum();
    let faces: usize = topologies().map(|topology| topology.faces().len()).sum();
    let longest = topologies().flat_map(|topology| topology.faces()).map(Vec::len).max().unwrap_or(0);
    // Most programs read lists with a length of one byte alone.
    let length = if longest <= usize::from(u8::MAX) { "uchar" } else { "uint" };
    let mut out = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {faces}\nproperty list {length} int vertex_indices\nend_header\n"
    );
    for (number, block) in scene.blocks.iter().enumerate() {
        for [x, y, z] in points(block, number, "PLY")? {
            push(&mut out, format_args!("{x:?} {y:?} {z:?}\n"));
        }
    }
    let mut first = 0;
    for block in &scene.blocks {
        for face in block.block.topology().faces() {
            push(&mut out, format_args!("{}", face.len()));
            face.iter().for_each(|&vertex| push(&mut out, format_args!(" {}", first + vertex.index())));
            out.push('\n');
        }
        first += block.block.vertices().len();
    }
    Ok(out)
}

/// The scene as a mesh of Gmsh in ASCII, version 2.2: triangles, each block a physical surface of its name.
pub(super) fn msh(scene: &Scene) -> Result<String, FormatError> {
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    push(&mut out, format_args!("{}\n", scene.blocks.len()));
    for (number, block) in scene.blocks.iter().enumerate() {
        push(&mut out, format_args!("2 {} \"{}\"\n", number + 1, msh_name(&block.name)));
    }
    let vertices: usize = scene.blocks.iter().map(|block| block.block.vertices().len()).sum();
    push(&mut out, format_args!("$EndPhysicalNames\n$Nodes\n{vertices}\n"));
    let mut node = 0;
    for (number, block) in scene.blocks.iter().enumerate() {
        for [x, y, z] in points(block, number, "MSH")? {
            node += 1;
            push(&mut out, format_args!("{node} {x:?} {y:?} {z:?}\n"));
        }
    }
    let triangles: Vec<_> = scene.blocks.iter().map(|block| block.block.triangles(&block.planarity)).collect();
    let count: usize = triangles.iter().map(Vec::len).sum();
    push(&mut out, format_args!("$EndNodes\n$Elements\n{count}\n"));
    let (mut element, mut first) = (0, 1);
    for (group, (block, triangles)) in (1..).zip(scene.blocks.iter().zip(&triangles)) {
        for corners in triangles {
            element += 1;
            let [a, b, c] = corners.map(|vertex| first + vertex.index());
            // Type 2 with two tags: the physical group and the surface, which is one for each block.
            push(&mut out, format_args!("{element} 2 2 {group} {group} {a} {b} {c}\n"));
        }
        first += block.block.vertices().len();
    }
    out.push_str("$EndElements\n");
    Ok(out)
}

/// A name as it may stand between quotes.
pub(super) fn msh_name(name: &str) -> String {
    let words: Vec<&str> = name.split_whitespace().collect();
    words.join(" ").replace('"', "'")
}

/// For programs that want one; readers go by the corners.
fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|end| [0, 1, 2].map(|axis: usize| end[axis] - a[axis]));
    let normal = [0, 1, 2].map(|axis: usize| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        u[next] * v[last] - u[last] * v[next]
    });
    let size = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
    // Zero stands for "not given", where the product is too small or too large for an f64.
    if size.is_normal() { normal.map(|c| c / size + 0.0) } else { [0.0; 3] }
}

/// The scene as an unstructured grid of polyhedra.
pub(super) fn vtu(scene: &Scene) -> Result<Vec<u8>, FormatError> {
    let mut grid = UnstructuredGrid::default();
    let mut cells = Polyhedra::default();
    for (number, block) in scene.blocks.iter().enumerate() {
        let points = points(block, number, "VTU")?;
        cells.push(grid.points.len(), points.len(), block.block.topology().faces());
        grid.points.extend(points);
    }
    grid.cells = Cells::Polyhedra(cells);
    crate::vtu_writer::vtu(&grid).map_err(|error| FormatError::Failed { message: error.to_string() })
}

fn points(block: &SceneBlock, number: usize, format: &'static str) -> Result<Vec<[f64; 3]>, FormatError> {
    (0..block.block.vertices().len()).map(|vertex| decimals(block, (number, vertex), format)).collect()
}
