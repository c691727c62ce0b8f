//! Arguments that several commands share.

use anyhow::Context;
use rockproof::model::{LoadOptions, Number, Precision, Preset, ToleranceSpec};
use std::path::Path;

/// How blocks are read.
#[derive(clap::Args)]
pub(crate) struct ReadArgs {
    /// How far a face may be from planar, as a share of its block's size [default: what the file says, or 1e-9]
    #[arg(long, value_name = "SHARE", value_parser = planarity, allow_negative_numbers = true)]
    planarity: Option<Number>,
}

impl ReadArgs {
    pub(crate) fn options(&self) -> LoadOptions {
        LoadOptions { planarity: self.planarity.clone() }
    }
}

/// Which tolerances apply.
#[derive(clap::Args)]
pub(crate) struct ToleranceArgs {
    /// auto, shi, zero, or a TOML file of tolerances [default: what the scene says, or auto]
    #[arg(long, value_name = "PRESET|FILE")]
    tolerances: Option<String>,

    /// Set a tolerance, exactly: search=1/10, overlap_angle=3, criteria=classic, …
    #[arg(long, value_name = "NAME=VALUE", num_args = 1..)]
    set: Vec<String>,
}

impl ToleranceArgs {
    /// The tolerances asked for, over those of a scene.
    pub(crate) fn spec(&self, scene: Option<&ToleranceSpec>) -> anyhow::Result<ToleranceSpec> {
        let mut spec = match &self.tolerances {
            None => scene.cloned().unwrap_or_default(),
            Some(text) => match Preset::from_name(text) {
                Some(preset) => preset.into(),
                None if Path::new(text).exists() => ToleranceSpec::load(text)?,
                None => anyhow::bail!("--tolerances {text}: neither a preset (auto, shi, zero) nor a file"),
            },
        };
        for assignment in &self.set {
            spec.assign(assignment).with_context(|| format!("--set {assignment}"))?;
        }
        Ok(spec)
    }
}

/// `f32` or `f64`.
pub(crate) fn precision(text: &str) -> Result<Precision, String> {
    match text {
        "f32" => Ok(Precision::F32),
        "f64" => Ok(Precision::F64),
        _ => Err("known are f32 and f64".to_string()),
    }
}

fn planarity(text: &str) -> Result<Number, String> {
    match Number::parse(text) {
        Ok(number) if number.is_negative() => Err("must be 0 or more".to_string()),
        Ok(number) => Ok(number),
        Err(error) => Err(error.to_string()),
    }
}
