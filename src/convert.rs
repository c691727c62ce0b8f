//! `convert`: from any format that can be read to any that can be written.

use crate::exit::{Outcome, Verdict, print, print_note};
use crate::extents::{factor, scale};
use crate::input::{ReadArgs, precision};
use anyhow::Context;
use rockproof_model::scene::{SceneFormat, write_obj, write_toml, write_vtk};
use rockproof_model::{Block, BlockOptions, Number, Precision, Scene};
use rockproof_results::write_atomically;
use std::path::PathBuf;

/// Convert blocks to another format
///
/// The formats are told by the extensions. Coordinates are kept exactly; OBJ and VTK hold decimals, so a coordinate
/// that is no f64 (1/3) needs `--precision` to say how it is rounded.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  rockproof convert cells.txt cells.toml --planarity 1e-4")]
pub(crate) struct Convert {
    /// Blocks: .toml, .dda, .obj, .vtk, or .txt and .voro for voro++
    input: PathBuf,

    /// Where to write them: .toml, .obj or .vtk
    output: PathBuf,

    #[command(flatten)]
    read: ReadArgs,

    /// Multiply every length first: 1/1000 for a file in millimetres
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_negative_numbers = true)]
    scale: Option<Number>,

    /// Round every coordinate to f32 or f64
    #[arg(long, value_parser = precision)]
    precision: Option<Precision>,
}

impl Convert {
    pub(crate) fn run(&self) -> Outcome {
        let format = SceneFormat::of_path(&self.output)
            .filter(|f| matches!(f, SceneFormat::Toml | SceneFormat::Obj | SceneFormat::Vtk));
        let format = format.with_context(|| {
            format!("{}: cannot write this format; known are .toml, .obj and .vtk", self.output.display())
        })?;
        let mut scene = Scene::load_with(&self.input, &self.read.options())?;
        if let Some(factor) = &self.scale {
            scale(&mut scene, &self.input, factor)?;
        }
        if let Some(precision) = self.precision {
            self.round(&mut scene, precision)?;
        }
        let place = || self.output.display().to_string();
        let text = match format {
            SceneFormat::Obj => write_obj(&scene).with_context(place)?,
            SceneFormat::Vtk => write_vtk(&scene).with_context(place)?,
            _ => write_toml(&scene),
        };
        write_atomically(&self.output, text).with_context(place)?;
        if format != SceneFormat::Toml {
            note_losses(&scene);
        }
        print(&format!("{}: {} blocks\n", self.output.display(), scene.blocks.len()))?;
        Ok(Verdict::Passed)
    }

    /// Rounds every coordinate; what is no block then is an error.
    fn round(&self, scene: &mut Scene, precision: Precision) -> anyhow::Result<()> {
        for (number, block) in scene.blocks.iter_mut().enumerate() {
            let place =
                || format!("{}: block {number} \"{}\", rounded to {precision}", self.input.display(), block.name);
            let rounded = block.block.rounded(precision).with_context(|| format!("{}: overflows", place()))?;
            let options = BlockOptions { planarity: block.planarity.clone() };
            let faces = rounded.topology().faces().to_vec();
            block.block = Block::new(rounded.vertices().to_vec(), faces, &options).with_context(place)?;
        }
        Ok(())
    }
}

fn note_losses(scene: &Scene) {
    let fixed = scene.blocks.iter().filter(|b| b.body.is_fixed()).count();
    if fixed > 0 {
        print_note(&format!("this format does not keep which blocks are fixed ({fixed} are)"));
    }
    if scene.tolerances.is_some() {
        print_note("this format does not keep tolerances");
    }
}
