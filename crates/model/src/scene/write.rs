//! Writing scenes. TOML keeps everything exactly; the other formats hold decimals or f64, so only f64 coordinates can be exact there.

mod mesh;
mod simulation;

use crate::block::{Block, BlockOptions, Point};
use crate::number::Number;
use crate::scene::{Scene, SceneBlock, SceneFormat};
use crate::simulation::{Body, Simulation};
use crate::text::noun;
use crate::tolerance_spec::ToleranceSpec;
use crate::topology::VertexId;
use std::fmt::Write;

/// Why a scene does not fit a format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// A coordinate that the format cannot hold exactly.
    #[error(
        "block {block} \"{name}\", vertex {vertex}: {found} is not an f64, and {format} is written in these; --precision f64 rounds the coordinates"
    )]
    NotRepresentable {
        /// Number of the block.
        block: usize,
        /// Name of the block.
        name: String,
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        found: String,
        /// The format.
        format: &'static str,
    },
    /// A format that is only read.
    #[error("cannot write this format; known are {}", SceneFormat::listed(SceneFormat::is_written))]
    ReadOnly,
    /// What the writer of XML says.
    #[error("{message}")]
    Failed {
        /// Its words.
        message: String,
    },
}

/// The scene as a file of a format.
///
/// # Errors
/// When the format is only read, or cannot hold a coordinate.
pub fn write(scene: &Scene, format: SceneFormat) -> Result<Vec<u8>, FormatError> {
    match format {
        SceneFormat::Toml => Ok(write_toml(scene).into_bytes()),
        SceneFormat::Obj => write_obj(scene).map(String::into_bytes),
        SceneFormat::Stl => mesh::stl(scene).map(String::into_bytes),
        SceneFormat::Vtk => write_vtk(scene).map(String::into_bytes),
        SceneFormat::Vtu => mesh::vtu(scene),
        SceneFormat::Ply => mesh::ply(scene).map(String::into_bytes),
        SceneFormat::Msh => mesh::msh(scene).map(String::into_bytes),
        SceneFormat::Dda | SceneFormat::Voro => Err(FormatError::ReadOnly),
    }
}

/// What of the scene a format does not keep, in sentences for its user.
pub fn losses(scene: &Scene, format: SceneFormat) -> Vec<String> {
    let mut lost = Vec::new();
    if format == SceneFormat::Toml {
        return lost;
    }
    let fixed = scene.blocks.iter().filter(|b| b.body.is_fixed()).count();
    if fixed > 0 {
        let are = noun(fixed, "is", "are");
        lost.push(format!("this format does not keep which blocks are fixed ({fixed} {are})"));
    }
    if scene.tolerances.is_some() {
        lost.push("this format does not keep tolerances".to_owned());
    }
    let at_rest = |block: &SceneBlock| Body { motion: block.body.motion, ..Body::default() } == block.body;
    if scene.simulation != Simulation::default() || !scene.blocks.iter().all(at_rest) {
        lost.push("this format does not keep what makes blocks move: materials, joints, velocities, loads".to_owned());
    }
    let is_named = |(number, block): (usize, &SceneBlock)| block.name != format!("block_{number}");
    if matches!(format, SceneFormat::Vtk | SceneFormat::Vtu | SceneFormat::Ply)
        && scene.blocks.iter().enumerate().any(is_named)
    {
        lost.push("this format does not keep the names of blocks".to_owned());
    }
    if format == SceneFormat::Msh && scene.blocks.iter().any(|block| mesh::msh_name(&block.name) != block.name) {
        lost.push("names of blocks are written without quotes and with single spaces, as MSH can hold them".to_owned());
    }
    if let Some(planarity) = planarity_needed(scene) {
        let format = format.name().to_uppercase();
        lost.push(format!("{format} does not keep the planarity; read it with --planarity {planarity}"));
    }
    if format == SceneFormat::Stl {
        lost.push(
            "STL holds triangles that share no vertices; they are written with all digits of an f64, and most programs read them as f32"
                .to_owned(),
        );
    }
    lost
}

/// The planarity that a file without one has to be read with: the largest of those of blocks that are none with the default.
fn planarity_needed(scene: &Scene) -> Option<String> {
    let default = BlockOptions::default();
    let read_back = |block: &Block| Block::new(block.vertices().to_vec(), block.topology().faces().to_vec(), &default);
    let needs_its_own = |block: &&SceneBlock| block.planarity > default.planarity && read_back(&block.block).is_err();
    let needed = scene.blocks.iter().filter(needs_its_own).map(|block| &block.planarity).max()?;
    let decimal = format!("{:e}", needed.approximate());
    let is_enough = Number::parse(&decimal).is_ok_and(|decimal| decimal >= *needed);
    Some(if is_enough { decimal } else { needed.to_string() })
}

/// The scene as TOML: read back, it is the same scene, exactly. Where a block was read from is not part of that.
pub fn write_toml(scene: &Scene) -> String {
    let mut out = String::new();
    if let Some(tolerances) = &scene.tolerances {
        out.push_str(&write_tolerances(tolerances));
        out.push('\n');
    }
    let is_moved = scene.simulation != Simulation::default();
    if is_moved {
        simulation::write_simulation(&mut out, &scene.simulation);
    }
    for (i, block) in scene.blocks.iter().enumerate() {
        if i > 0 {
            out.push('\n');
        }
        toml_block(&mut out, block, &scene.simulation);
    }
    if is_moved {
        simulation::attached(&mut out, &scene.simulation);
    }
    out
}

fn toml_block(out: &mut String, block: &SceneBlock, scene: &Simulation) {
    out.push_str("[[block]]\n");
    push(out, format_args!("name = {}\n", toml::Value::from(block.name.as_str())));
    simulation::body(out, &block.body, scene);
    if block.planarity != BlockOptions::default().planarity {
        push(out, format_args!("planarity = {}\n", toml_number(&block.planarity)));
    }
    out.push_str("vertices = [\n");
    for v in block.block.vertices() {
        push(out, format_args!("  [{}, {}, {}],\n", toml_number(&v.x), toml_number(&v.y), toml_number(&v.z)));
    }
    out.push_str("]\nfaces = [\n");
    for face in block.block.topology().faces() {
        let indices: Vec<String> = face.iter().map(VertexId::to_string).collect();
        push(out, format_args!("  [{}],\n", indices.join(", ")));
    }
    out.push_str("]\n");
}

/// Tolerances as the table `[tolerances]`.
pub fn write_tolerances(tolerances: &ToleranceSpec) -> String {
    let mut out = String::from("[tolerances]\n");
    if let Some(preset) = tolerances.preset() {
        push(&mut out, format_args!("preset = \"{preset}\"\n"));
    }
    for (name, number) in tolerances.numbers() {
        push(&mut out, format_args!("{name} = {}\n", toml_number(number)));
    }
    if let Some(criteria) = tolerances.criteria() {
        push(&mut out, format_args!("criteria = \"{}\"\n", criteria.name()));
    }
    out
}

/// An f64 as a TOML float, anything else as an exact string.
fn toml_number(number: &Number) -> String {
    match number.as_f64() {
        Some(value) => format!("{value:?}"),
        None => format!("\"{number}\""),
    }
}

/// The scene as Wavefront OBJ, one object a block. What is fixed, and tolerances, are lost.
///
/// # Errors
/// When a coordinate is no f64.
fn write_obj(scene: &Scene) -> Result<String, FormatError> {
    let mut out = String::new();
    let mut first = 1;
    for (number, block) in scene.blocks.iter().enumerate() {
        push(&mut out, format_args!("o {}\n", block.name));
        for vertex in 0..block.block.vertices().len() {
            let [x, y, z] = decimals(block, (number, vertex), "OBJ")?;
            push(&mut out, format_args!("v {x:?} {y:?} {z:?}\n"));
        }
        for face in block.block.topology().faces() {
            let indices: Vec<String> = face.iter().map(|&v| (first + v.index()).to_string()).collect();
            push(&mut out, format_args!("f {}\n", indices.join(" ")));
        }
        first += block.block.vertices().len();
    }
    Ok(out)
}

/// The scene as a legacy VTK file of polyhedra (version 3.0, ASCII). Names, what is fixed, and tolerances are lost.
///
/// # Errors
/// When a coordinate is no f64.
fn write_vtk(scene: &Scene) -> Result<String, FormatError> {
    let points: usize = scene.blocks.iter().map(|b| b.block.vertices().len()).sum();
    let mut out = String::from("# vtk DataFile Version 3.0\nblocks\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    push(&mut out, format_args!("POINTS {points} double\n"));
    for (number, block) in scene.blocks.iter().enumerate() {
        for vertex in 0..block.block.vertices().len() {
            let [x, y, z] = decimals(block, (number, vertex), "VTK")?;
            push(&mut out, format_args!("{x:?} {y:?} {z:?}\n"));
        }
    }
    let streams: Vec<Vec<usize>> = streams(scene);
    let size: usize = streams.iter().map(|s| s.len() + 1).sum();
    push(&mut out, format_args!("CELLS {} {size}\n", streams.len()));
    for stream in &streams {
        let entries: Vec<String> = stream.iter().map(usize::to_string).collect();
        push(&mut out, format_args!("{} {}\n", stream.len(), entries.join(" ")));
    }
    push(&mut out, format_args!("CELL_TYPES {}\n", streams.len()));
    for _ in &streams {
        out.push_str("42\n");
    }
    Ok(out)
}

/// The face stream of every block.
fn streams(scene: &Scene) -> Vec<Vec<usize>> {
    let mut first = 0;
    let mut streams = Vec::with_capacity(scene.blocks.len());
    for block in &scene.blocks {
        let faces = block.block.topology().faces();
        let mut stream = vec![faces.len()];
        for face in faces {
            stream.push(face.len());
            stream.extend(face.iter().map(|&v| first + v.index()));
        }
        first += block.block.vertices().len();
        streams.push(stream);
    }
    streams
}

fn decimals(
    block: &SceneBlock,
    (number, vertex): (usize, usize),
    format: &'static str,
) -> Result<[f64; 3], FormatError> {
    let point: &Point = &block.block.vertices()[vertex];
    let [x, y, z] = point.components().map(|c| {
        c.as_f64().ok_or_else(|| FormatError::NotRepresentable {
            block: number,
            name: block.name.clone(),
            vertex,
            found: crate::number_text::shown(&c.to_string()),
            format,
        })
    });
    Ok([x?, y?, z?])
}

fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = out.write_fmt(text);
}
