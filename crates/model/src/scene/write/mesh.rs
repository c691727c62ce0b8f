//! Scenes as STL and as VTK's XML.

use super::{FormatError, decimals, push};
use crate::scene::{Scene, SceneBlock};
use crate::vtu::{Cells, Polyhedra, UnstructuredGrid};

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
    crate::vtu::vtu(&grid).map_err(|error| FormatError::Failed { message: error.to_string() })
}

fn points(block: &SceneBlock, number: usize, format: &'static str) -> Result<Vec<[f64; 3]>, FormatError> {
    (0..block.block.vertices().len()).map(|vertex| decimals(block, (number, vertex), format)).collect()
}
