//! `convert`: from any format that can be read to any that can be written.

use crate::exit::{ExitStatus, Outcome, print, print_note};
use crate::input::{ReadArgs, model_help, precision};
use crate::input_file::InputFile;
use crate::output_file::OverwriteArgs;
use anyhow::Context;
use rockproof_examine::{point_in_decimals, refuse_too_large, short};
use rockproof_model::block::Point;
use rockproof_model::scene::{FormatError, SceneFormat, losses, write};
use rockproof_model::{Block, BlockOptions, Number, Precision, Scene, Vec3};
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
    after_help = "Example:\n  rockproof convert cells.txt cells.toml --planarity 1e-4\n  rockproof convert scan.stl blocks.toml --weld 1e-6 --planarity 1e-5\n  rockproof convert site.toml site-local.toml --origin local"
)]
pub(crate) struct Convert {
    #[arg(help = model_help(), value_hint = clap::ValueHint::FilePath)]
    input: InputFile,

    #[arg(help = format!("Where to write them: {}", SceneFormat::listed(SceneFormat::is_written)))]
    output: PathBuf,

    #[command(flatten)]
    read: ReadArgs,

    /// Give all points relative to this one, in metres: exact, and before anything is rounded; `local` for one near the lowest corner where coordinates are
    /// far larger than the model
    #[arg(long, value_name = "X,Y,Z|local", value_parser = origin, allow_hyphen_values = true)]
    origin: Option<Origin>,

    /// Round every coordinate to f32 or f64
    #[arg(long, value_parser = precision)]
    precision: Option<Precision>,

    #[command(flatten)]
    overwrite: OverwriteArgs,
}

/// What `--origin` names.
#[derive(Clone, Debug)]
enum Origin {
    /// A point that the scene has near its lowest corner.
    Local,
    /// This point (m).
    At(Point),
}

/// `local`, or three numbers.
fn origin(text: &str) -> Result<Origin, String> {
    if text == "local" {
        return Ok(Origin::Local);
    }
    let numbers: Result<Vec<Number>, String> = text
        .split(',')
        .map(|part| Number::parse(part.trim()).map_err(|error| format!("\"{}\": {error}", part.trim())))
        .collect();
    match <[Number; 3]>::try_from(numbers?) {
        Ok([x, y, z]) => Ok(Origin::At(Vec3::new(x, y, z))),
        Err(found) => Err(format!("{} numbers; allowed are three, X,Y,Z in metres, and `local`", found.len())),
    }
}

impl Convert {
    pub(crate) fn run(&self) -> Outcome {
        let format = SceneFormat::of_path(&self.output)
            .filter(|format| format.is_written())
            .ok_or(FormatError::ReadOnly)
            .with_context(|| self.output.display().to_string())?;
        let mut scene = self.read.scene(&self.input)?;
        self.move_origin(&mut scene)?;
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

    /// Gives all points relative to the origin asked for.
    fn move_origin(&self, scene: &mut Scene) -> anyhow::Result<()> {
        let origin = match &self.origin {
            None => return Ok(()),
            Some(Origin::At(origin)) => origin.clone(),
            Some(Origin::Local) => match scene.local_origin() {
                Some(origin) => origin,
                None => {
                    print_note("the origin stays: coordinates are no more than 16 times as large as the model");
                    return Ok(());
                }
            },
        };
        scene.move_origin_to(&origin);
        refuse_too_large(scene).with_context(|| format!("{}: --origin", self.input.path().display()))?;
        print_note(&format!("the origin is now where ({}) was", point_in_decimals(&origin)));
        Ok(())
    }

    /// Rounds every coordinate, and says how far that moves vertices; what is no block then is an error.
    fn round(&self, scene: &mut Scene, precision: Precision) -> anyhow::Result<()> {
        let (mut vertices, mut moved, mut furthest) = (0_u64, 0_u64, 0.0_f64);
        for (number, block) in scene.blocks.iter_mut().enumerate() {
            let place = || {
                format!("{}: block {number} \"{}\", rounded to {precision}", self.input.path().display(), block.name)
            };
            let rounded = block.block.rounded(precision).with_context(|| format!("{}: overflows", place()))?;
            for (from, to) in block.block.vertices().iter().zip(rounded.vertices()) {
                let way = [(&from.x, &to.x), (&from.y, &to.y), (&from.z, &to.z)]
                    .map(|(from, to)| to.plus(&from.negated()).approximate().powi(2));
                vertices += 1;
                moved += u64::from(from != to);
                furthest = furthest.max(way.iter().sum::<f64>().sqrt());
            }
            let options = BlockOptions { planarity: block.planarity.clone() };
            let faces = rounded.topology().faces().to_vec();
            block.block = Block::new(rounded.vertices().to_vec(), faces, &options).with_context(place)?;
        }
        if moved > 0 {
            let furthest = short(furthest);
            print_note(&format!("{precision} moved {moved} of {vertices} vertices, by at most {furthest} m"));
        }
        Ok(())
    }
}
