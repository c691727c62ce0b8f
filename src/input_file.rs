//! The file that a command looks at: a path, or `-` for stdin.

use crate::doubts::tell_of_scene;
use crate::exit::print_note;
use crate::input::{ReadArgs, format_names};
use crate::reading::weld_that_undoes;
use anyhow::Context;
use rockproof_differential::external::spec::quoted;
use rockproof_differential::lockstep::StepCase;
use rockproof_model::files::{read_limited, read_stream, text_of};
use rockproof_model::scene::{SceneFormat, SceneProblem};
use rockproof_model::{LoadOptions, Scene, SceneError};
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

/// What messages call stdin.
const STDIN: &str = "<stdin>";

/// An argument that names a file.
#[derive(Clone, Debug)]
pub(crate) enum InputFile {
    /// `-`
    Stdin,
    /// Any other name.
    Named(PathBuf),
}

impl From<OsString> for InputFile {
    fn from(argument: OsString) -> InputFile {
        if argument == "-" { InputFile::Stdin } else { InputFile::Named(argument.into()) }
    }
}

impl InputFile {
    /// What messages call it. Files that a scene on stdin names are looked for in the current directory.
    pub(crate) fn path(&self) -> &Path {
        match self {
            InputFile::Stdin => Path::new(STDIN),
            InputFile::Named(path) => path,
        }
    }

    /// What results are called that are made of it: the file's name without its extension.
    pub(crate) fn stem(&self) -> String {
        match self {
            InputFile::Stdin => "stdin".to_owned(),
            InputFile::Named(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }

    /// The argument as it stands in a command to go on with, where a name that begins with a hyphen would be an option. What came from stdin is
    /// not there again.
    pub(crate) fn shown(&self) -> String {
        match self {
            InputFile::Stdin => "FILE".to_owned(),
            InputFile::Named(path) => {
                let name = path.display().to_string();
                quoted(&if name.starts_with('-') { format!("./{name}") } else { name })
            }
        }
    }

    /// Its bytes, at most as many as of any file. Of stdin they are there once.
    fn bytes(&self) -> io::Result<Vec<u8>> {
        match self {
            InputFile::Stdin => read_stream(io::stdin().lock()),
            InputFile::Named(path) => read_limited(path),
        }
    }

    /// Its text.
    ///
    /// # Errors
    /// With its name: when it cannot be read, is too long, or no UTF-8.
    pub(crate) fn text(&self) -> anyhow::Result<String> {
        self.bytes().and_then(text_of).with_context(|| self.path().display().to_string())
    }

    /// The text of a case.
    ///
    /// # Errors
    /// As [`InputFile::text`], and when it is a scene or a file of blocks.
    pub(crate) fn case_text(&self) -> anyhow::Result<String> {
        let refuse = |what| anyhow::anyhow!("{}: this is {what}, not a case", self.path().display());
        if let InputFile::Named(path) = self
            && SceneFormat::of_path(path).is_some_and(|format| format != SceneFormat::Toml)
        {
            return Err(refuse("a block file"));
        }
        let text = self.text()?;
        let has = |table: &str| text.lines().any(|line| line.trim() == table);
        if !self.is_step(&text) && has("[[block]]") && !has("[case]") {
            return Err(refuse("a scene"));
        }
        Ok(text)
    }

    /// Whether it is a state file, by its name; on stdin by its text.
    pub(crate) fn is_step(&self, text: &str) -> bool {
        match self {
            InputFile::Named(path) => StepCase::is_named(path),
            // No TOML begins so.
            InputFile::Stdin => text.trim_start().starts_with('{'),
        }
    }
}

/// The bytes of a file of blocks and how they are read. They are kept, since `check` reads them again to see what other options do.
pub(crate) struct ModelFile {
    name: PathBuf,
    format: SceneFormat,
    bytes: Vec<u8>,
    options: LoadOptions,
}

impl ModelFile {
    /// Reads the bytes.
    ///
    /// # Errors
    /// When the file cannot be read, or nothing tells its format.
    pub(crate) fn read(file: &InputFile, args: &ReadArgs) -> anyhow::Result<ModelFile> {
        let name = file.path().to_path_buf();
        let refuse = |problem| SceneError { file: name.clone(), line: None, problem };
        // What is no file, or an empty one, has no format to ask about.
        let bytes = file.bytes().map_err(|error| refuse(SceneProblem::Io(error)))?;
        let told = match file {
            InputFile::Stdin => args.format(),
            InputFile::Named(path) => args.format().or_else(|| SceneFormat::of_path(path)),
        };
        if bytes.is_empty() && told.is_none() {
            anyhow::bail!("{}: it is empty", name.display());
        }
        if told.is_none() && !matches!(file, InputFile::Stdin) {
            return Err(refuse(SceneProblem::UnknownFormat).into());
        }
        let Some(format) = told.or_else(|| SceneFormat::of_contents(&bytes)) else {
            let known = format_names();
            anyhow::bail!("{STDIN}: it begins as no format does; --input-format says which it is: {known}");
        };
        let options = args.options();
        if format == SceneFormat::Toml && options.weld.is_some() {
            print_note(
                "--weld joins vertices of the files that a scene names; those of its own blocks stay as they are",
            );
        }
        Ok(ModelFile { name, format, bytes, options })
    }

    /// What messages call it.
    pub(crate) fn name(&self) -> &Path {
        &self.name
    }

    /// The format it is read as.
    pub(crate) fn format(&self) -> SceneFormat {
        self.format
    }

    /// Whether its coordinates are f32 ([`SceneFormat::holds_f32`]).
    pub(crate) fn holds_f32(&self) -> bool {
        self.format.holds_f32(&self.bytes)
    }

    /// The number of bytes.
    pub(crate) fn length(&self) -> usize {
        self.bytes.len()
    }

    /// The scene; the first thing wrong with the file is an error.
    pub(crate) fn scene(&self) -> Result<Scene, SceneError> {
        let scene = Scene::parse_bytes(&self.bytes, self.format, &self.name, &self.options);
        match &scene {
            Ok(scene) => tell_of_scene(scene),
            Err(error) => {
                self.note_other_format(error);
                self.note_weld();
            }
        }
        scene
    }

    /// Says so where a file that cannot be read begins as those of another format do.
    fn note_other_format(&self, error: &SceneError) {
        // Letters of UTF-16 seem to be other ones.
        let is_of_block =
            matches!(error.problem, SceneProblem::Block { .. } | SceneProblem::Tolerances(_) | SceneProblem::Utf16);
        let looks = SceneFormat::of_contents(&self.bytes).filter(|looks| *looks != self.format);
        if let (false, true, Some(looks)) = (is_of_block, error.file == self.name, looks) {
            let (file, looks, format) = (self.name.display(), looks.name(), self.format.name());
            print_note(&format!("{file} is read as {format} and begins as {looks} does: --input-format {looks}"));
        }
    }

    /// Says so where vertices were joined, and more blocks can be used without that.
    fn note_weld(&self) {
        if let Some(note) = weld_that_undoes(self) {
            print_note(&note);
        }
    }

    /// The blocks that can be used, and what is wrong with the others.
    pub(crate) fn survey(&self) -> Result<(Scene, Vec<SceneError>), SceneError> {
        let survey = self.survey_with(&self.options);
        match &survey {
            Ok((scene, problems)) if problems.is_empty() => tell_of_scene(scene),
            Ok(_) => self.note_weld(),
            Err(error) => {
                self.note_other_format(error);
                self.note_weld();
            }
        }
        survey
    }

    /// The same with other options than those given, which [`ModelFile::options`] are.
    pub(crate) fn survey_with(&self, options: &LoadOptions) -> Result<(Scene, Vec<SceneError>), SceneError> {
        Scene::survey_bytes(&self.bytes, self.format, &self.name, options)
    }

    /// The options it is read with.
    pub(crate) fn options(&self) -> &LoadOptions {
        &self.options
    }
}
