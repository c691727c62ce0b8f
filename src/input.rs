//! Arguments that several commands share.

use crate::exit::{print, print_json};
use crate::input_file::{InputFile, ModelFile};
use crate::reading::factor;
use crate::stop::end_on_ctrl_c;
use anyhow::Context;
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::Engines;
use rockproof_differential::builtin::{ENGINES, full_name};
use rockproof_differential::case_file::Case;
use rockproof_differential::external::EngineSpec;
use rockproof_differential::external::spec::quoted;
use rockproof_examine::{reading, refuse_too_large};
use rockproof_model::scene::SceneFormat;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{LoadOptions, Number, Precision, Preset, Scene, ToleranceSpec};
use serde_json::Value;
use std::path::Path;

/// How blocks are read.
#[derive(clap::Args)]
pub(crate) struct ReadArgs {
    /// How far a face may be from planar, as a share of its block's size [default: what the file says, or 1e-9]
    #[arg(long, value_name = "SHARE", value_parser = at_least_zero, allow_negative_numbers = true)]
    planarity: Option<Number>,
    /// Join vertices no further apart than this, in the file's unit of length [default: join only identical ones, and these only in STL]
    #[arg(long, value_name = "DISTANCE", value_parser = at_least_zero, allow_negative_numbers = true)]
    weld: Option<Number>,
    /// Multiply every length first: 1/1000 for a file in millimetres; 1 says that metres are meant
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_negative_numbers = true)]
    scale: Option<Number>,
    #[arg(long, value_name = "FORMAT", value_parser = scene_format, help = format_help())]
    input_format: Option<SceneFormat>,
}

impl ReadArgs {
    pub(crate) fn options(&self) -> LoadOptions {
        LoadOptions { planarity: self.planarity.clone(), weld: self.weld.clone(), scale: self.scale.clone() }
    }

    /// The format that is named, whatever the file is called.
    pub(crate) fn format(&self) -> Option<SceneFormat> {
        self.input_format
    }

    /// Reads a scene, which must be sound.
    ///
    /// # Errors
    /// When the file cannot be read, or the first thing that is wrong in it.
    pub(crate) fn scene(&self, file: &InputFile) -> anyhow::Result<Scene> {
        let scene = ModelFile::read(file, self)?.scene()?;
        refuse_too_large(&scene).with_context(|| file.path().display().to_string())?;
        Ok(scene)
    }

    /// The options as they stand on a command line, after a space; nothing where none is given.
    pub(crate) fn shown(&self) -> String {
        let format = self.input_format.map_or(String::new(), |format| format!(" --input-format {}", format.name()));
        reading(&self.options()) + &format
    }
}

fn scene_format(text: &str) -> Result<SceneFormat, String> {
    SceneFormat::from_name(text).ok_or_else(|| format!("known are {}", format_names()))
}

/// The names of all formats, for messages.
pub(crate) fn format_names() -> String {
    SceneFormat::ALL.map(SceneFormat::name).join(", ")
}

fn format_help() -> String {
    format!("Format of the file: {} [default: what its name says, or on stdin what it begins with]", format_names())
}

/// How a command says what it found.
#[derive(clap::Args)]
pub(crate) struct FormatArgs {
    /// What to print on stdout; json is one document (docs/formats.md), and messages go to stderr
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum OutputFormat {
    /// For people
    Text,
    /// For programs
    Json,
}

impl FormatArgs {
    /// Whether a document is asked for.
    pub(crate) fn is_json(&self) -> bool {
        self.format == OutputFormat::Json
    }

    /// Prints one of both; neither is made that is not asked for.
    pub(crate) fn print(&self, text: impl FnOnce() -> String, document: impl FnOnce() -> Value) -> anyhow::Result<()> {
        match self.format {
            OutputFormat::Text => print(&text()),
            OutputFormat::Json => print_json(&document()),
        }
    }
}

/// Engines that are programs of their own.
#[derive(clap::Args)]
pub(crate) struct EngineArgs {
    /// Another engine, a program that is asked over stdin and stdout (docs/engines.md); may be repeated. Its input is
    /// rounded to f64, or to f32 as NAME:f32=COMMAND says
    #[arg(long, value_name = "NAME=COMMAND")]
    engine_command: Vec<String>,
    /// How long such a program may take for one answer, in seconds [default: 10, or what the configuration says]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    engine_timeout: Option<u64>,
    /// Ask such programs everything twice, of two processes: whose answers differ is `unstable`
    #[arg(long)]
    ask_twice: bool,
}

impl EngineArgs {
    /// Whether no engine is named here.
    pub(crate) fn names_none(&self) -> bool {
        self.engine_command.is_empty()
    }

    /// Adds them to those of a configuration.
    pub(crate) fn add_to(&self, config: &mut CampaignConfig) -> anyhow::Result<()> {
        for text in &self.engine_command {
            config.external.push(EngineSpec::parse(text).context("--engine-command")?);
        }
        if let Some(timeout_ms) = self.engine_timeout {
            config.external.iter_mut().for_each(|spec| spec.timeout_ms = timeout_ms);
        }
        config.ask_twice |= self.ask_twice;
        Ok(())
    }

    /// The built-in engines and these, for a case; Ctrl-C ends the program and them.
    ///
    /// # Errors
    /// When the engine that the case is about is none of them.
    pub(crate) fn engines_of(&self, case: &Case, file: &Path) -> anyhow::Result<Engines> {
        let engines = self.engines()?;
        if engines.panel_of(case).is_none() {
            let (file, known) = (file.display(), engines.names().join(", "));
            let engine = &case.about.engine;
            anyhow::bail!(
                "{file}: engine is \"{engine}\"; known are any, f32, f64, {known}, and what --engine-command names"
            );
        }
        end_on_ctrl_c()?;
        Ok(engines)
    }

    /// The built-in engines and these.
    fn engines(&self) -> anyhow::Result<Engines> {
        let mut config = CampaignConfig::default();
        self.add_to(&mut config)?;
        Ok(Engines::of(&config)?)
    }
}

/// Seconds, as milliseconds.
fn seconds(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.001..=86_400.0).contains(&seconds) => Ok((seconds * 1000.0).round() as u64),
        _ => Err("allowed are 0.001 to 86400".to_string()),
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
    /// What messages about the tolerances of a scene's file name: that file, and the one of --tolerances.
    pub(crate) fn place(&self, scene: &Path) -> String {
        match self.file() {
            None => scene.display().to_string(),
            Some(file) => format!("{}: --tolerances {}", scene.display(), file.display()),
        }
    }

    /// The file of --tolerances, where it names one.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.tolerances.as_deref().filter(|text| Preset::from_name(text).is_none()).map(Path::new)
    }

    /// The options as they stand on a command line, each after a space; nothing where none is given.
    pub(crate) fn shown(&self) -> String {
        let named = self.tolerances.iter().map(|name| format!(" --tolerances {}", quoted(name)));
        named.chain(self.set.iter().map(|changed| format!(" --set {}", quoted(changed)))).collect()
    }

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
        let mut given: Vec<(String, &str)> = Vec::new();
        for assignment in &self.set {
            let name = assignment.split('=').next().unwrap_or_default().trim();
            // An angle is set by its sine too.
            let name = name.replace("_angle", "_sine");
            if let Some((_, first)) = given.iter().find(|(known, _)| *known == name) {
                let [first, again] = [*first, assignment].map(|text| excerpt(text, EXCERPT_LENGTH));
                anyhow::bail!("--set {first} and --set {again} are both given; a tolerance has one value");
            }
            given.push((name, assignment));
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

/// The precision of a stepper, by its name or in short.
pub(crate) fn stepper(text: &str) -> Result<Precision, String> {
    let name = full_name(text).ok_or_else(|| format!("known are {}, in short f32 and f64", ENGINES.join(" and ")))?;
    precision(name.trim_start_matches("stepper-"))
}

/// What a command says of the argument that is a model.
pub(crate) fn model_help() -> String {
    format!("Blocks: {} (the last two for voro++), or - for stdin", SceneFormat::listed(|_| true))
}

/// A number that is not negative.
pub(crate) fn at_least_zero(text: &str) -> Result<Number, String> {
    match Number::parse(text) {
        Ok(number) if number.is_negative() => Err("must be 0 or more".to_string()),
        Ok(number) => Ok(number),
        Err(error) => Err(error.to_string()),
    }
}
