//! `convert`: from any format that can be read to any that can be written.

use crate::exit::{ExitStatus, Outcome, print, print_note};
use crate::input::{ReadArgs, model_help, precision};
use crate::input_file::InputFile;
use crate::output_file::OverwriteArgs;
use anyhow::Context;
use rockproof_model::scene::{FormatError, SceneFormat, losses, write};
use rockproof_model::{Block, BlockOptions, Precision, Scene};
use rockproof_report::table::counted;
use rockproof_results::write_atomically;
use std::path::PathBuf;

/// Convert blocks to another format
///
/// The file extensions name the formats. Coordinates are kept exactly; formats other than TOML hold decimals or f64, so a coordinate
/// that is no f64 (1/3) needs `--precision` to say how it is rounded. A note names what else the format does not keep. A file that is there
/// already is replaced with `--overwrite` alone.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  rockproof convert cells.txt cells.toml --planarity 1e-4\n  rockproof convert scan.stl blocks.toml --weld 1e-6 --planarity 1e-5"
)]
pub(crate) struct Convert {
    #[arg(help = model_help(), value_hint = clap::ValueHint::FilePath)]
    input: InputFile,

    #[arg(help = format!("Where to write them: {}", SceneFormat::listed(SceneFormat::is_written)))]
    output: PathBuf,

    #[command(flatten)]
    read: ReadArgs,

    /// Round every coordinate to f32 or f64
    #[arg(long, value_parser = precision)]
    precision: Option<Precision>,

    #[command(flatten)]
    overwrite: OverwriteArgs,
}

impl Convert {
    pub(crate) fn run(&self) -> Outcome {
        let format = SceneFormat::of_path(&self.output)
            .filter(|format| format.is_written())
            .ok_or(FormatError::ReadOnly)
            .with_context(|| self.output.display().to_string())?;
        let mut scene = self.read.scene(&self.input)?;
        if let Some(precision) = self.precision {
            self.round(&mut scene, precision)?;
        }
        let place = || self.output.display().to_string();
        self.overwrite.allow(&self.output)?;
        let bytes = write(&scene, format).with_context(place)?;
        write_atomically(&self.output, bytes).with_context(place)?;
        for lost in losses(&scene, format) {
            print_note(&lost);
        }
        print(&format!("{}: {}\n", self.output.display(), counted(scene.blocks.len() as u64, "block", "blocks")))?;
        Ok(ExitStatus::Passed)
    }

    /// Rounds every coordinate; what is no block then is an error.
    fn round(&self, scene: &mut Scene, precision: Precision) -> anyhow::Result<()> {
        for (number, block) in scene.blocks.iter_mut().enumerate() {
            let place = || {
                format!("{}: block {number} \"{}\", rounded to {precision}", self.input.path().display(), block.name)
            };
            let rounded = block.block.rounded(precision).with_context(|| format!("{}: overflows", place()))?;
            let options = BlockOptions { planarity: block.planarity.clone() };
            let faces = rounded.topology().faces().to_vec();
            block.block = Block::new(rounded.vertices().to_vec(), faces, &options).with_context(place)?;
        }
        Ok(())
    }
}
