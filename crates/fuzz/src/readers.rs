//! Every reader of a file that a user names: whatever its bytes are, it is read, or refused with an error that names the file.

use crate::reach::Reach;
use crate::scratch::scratch;
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::source;
use rockproof_differential::case_file::Case;
use rockproof_differential::external::EngineSpec;
use rockproof_differential::lockstep::StepCase;
use rockproof_gate::config::GateConfig;
use rockproof_gate::known_findings::KnownFindings;
use rockproof_model::files::read_text;
use rockproof_model::scene::SceneProblem;
use rockproof_model::{Block, BlockError, Number, Point, Precision, Scene, ToleranceSpec};
use std::fmt::{Debug, Display};
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

/// The longest message about a file, in bytes.
pub(crate) const LONGEST_MESSAGE: usize = 4_000;

/// What a reader made of a file: nothing more, or its error's kind and message.
type Read = Result<(), (String, String)>;

/// An error as its kind and what is said of it.
fn refused<E: Display>(kind: &impl Debug, error: &E) -> (String, String) {
    (Reach::variant(kind), error.to_string())
}

/// Reads bytes as the file `name`.
fn read_as(name: &str, bytes: &[u8], reach: &mut Reach, read: impl FnOnce(&Path) -> Read) {
    let path = scratch().join(name);
    fs::write(&path, bytes).expect("a file for the reader");
    match read(&path) {
        Ok(()) => reach.count("read"),
        Err((kind, message)) => {
            assert!(message.contains(name), "the message does not name the file: {message}");
            assert!(message.len() < LONGEST_MESSAGE, "a message of {} bytes: {message}", message.len());
            // Of a kind of several sorts, both are counted.
            if let Some((kind, _)) = kind.split_once('-') {
                reach.count(kind);
            }
            reach.count(kind);
        }
    }
}

/// The kind of a scene's error; of a block or tolerances that are none, also which of their errors.
fn kind_of(problem: &SceneProblem) -> String {
    match problem {
        SceneProblem::Block { error: BlockError::Topology(error), .. } => format!("Block-{}", Reach::variant(error)),
        SceneProblem::Block { error, .. } => format!("Block-{}", Reach::variant(error)),
        SceneProblem::Tolerances(error) => format!("Tolerances-{}", Reach::variant(error)),
        other => Reach::variant(other),
    }
}

fn scene_as(name: &str, bytes: &[u8], reach: &mut Reach) {
    read_as(name, bytes, reach, |path| {
        let scene = Scene::load(path).map_err(|error| {
            let lines = bytes.split(|b| *b == b'\n').count();
            assert!(error.line.is_none_or(|line| (1..=lines + 1).contains(&line)), "of {lines} lines: {error}");
            (kind_of(&error.problem), error.to_string())
        })?;
        assert!(!scene.blocks.is_empty(), "a scene without a block");
        Ok(())
    });
}

/// Scenes of the project.
pub(crate) fn scene(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.toml", bytes, reach);
}

/// Files of UnBlocks-gen.
pub(crate) fn dda(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.dda", bytes, reach);
}

/// Wavefront files.
pub(crate) fn obj(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.obj", bytes, reach);
}

/// Legacy VTK files.
pub(crate) fn vtk(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.vtk", bytes, reach);
}

/// STL files, of text or binary.
pub(crate) fn stl(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.stl", bytes, reach);
}

/// PLY files.
pub(crate) fn ply(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.ply", bytes, reach);
}

/// Meshes of Gmsh.
pub(crate) fn msh(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.msh", bytes, reach);
}

/// VTK's XML files of cells.
pub(crate) fn vtu(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.vtu", bytes, reach);
}

/// Files of voro++.
pub(crate) fn voro(bytes: &[u8], reach: &mut Reach) {
    scene_as("input.voro", bytes, reach);
}

/// A cube of which presets are derived, and one that is too large for them.
fn cubes() -> &'static [Block; 2] {
    static CUBES: OnceLock<[Block; 2]> = OnceLock::new();
    let cube = |half: f64| {
        let corner = |n| Number::from_f64(n).map(|n| Point::new(n.clone(), n.clone(), n)).expect("a finite number");
        Block::cuboid(&corner(-half), &corner(half)).expect("a cube")
    };
    CUBES.get_or_init(|| [1.0, 1e308].map(cube))
}

/// Files of tolerances. What is read is made a set for a block, or an error says why it is none.
pub(crate) fn tolerances(bytes: &[u8], reach: &mut Reach) {
    let mut spec = None;
    read_as("input.toml", bytes, reach, |path| {
        let read = ToleranceSpec::load(path).map_err(|error| (kind_of(&error.problem), error.to_string()))?;
        spec = Some(read);
        Ok(())
    });
    for (spec, cube) in spec.iter().flat_map(|spec| cubes().iter().map(move |cube| (spec, cube))) {
        match spec.resolve(&[cube], Precision::F64) {
            Ok(set) => {
                let given = |name: &str| spec.numbers().iter().find(|(n, _)| *n == name).map(|(_, number)| number);
                let kept = |(name, number): &(&str, &Number)| given(name).is_none_or(|given| given == *number);
                assert!(set.numbers().iter().all(kept), "a tolerance that is not what was given: {spec:?}, {set:?}");
                reach.count("resolved");
            }
            Err(error) => {
                assert!(error.to_string().len() < LONGEST_MESSAGE, "too long a message: {error}");
                reach.count(format!("unresolved-{}", Reach::variant(&error)));
            }
        }
    }
}

/// What `--set` is given.
pub(crate) fn assignment(bytes: &[u8], reach: &mut Reach) {
    let Ok(text) = std::str::from_utf8(bytes) else { return reach.count("not-text") };
    let mut spec = ToleranceSpec::empty();
    match spec.assign(text) {
        Ok(()) => {
            assert_ne!(spec, ToleranceSpec::empty(), "{text:?} sets nothing");
            reach.count("read");
        }
        Err(error) => {
            assert!(error.to_string().len() < LONGEST_MESSAGE, "too long a message: {error}");
            reach.count(Reach::variant(&error));
        }
    }
}

/// Cases of pairs. What is read is written, and reads back the same.
pub(crate) fn case(bytes: &[u8], reach: &mut Reach) {
    read_as("input.toml", bytes, reach, |path| {
        let case = Case::load(path).map_err(|error| refused(&error, &error))?;
        let text = case.to_toml().expect("a case can be written");
        let again = Case::from_toml(&text, "again".to_owned()).expect("what was written can be read");
        assert_eq!(again, case, "a case that is written and read");
        Ok(())
    });
}

/// State files: cases of steps.
pub(crate) fn state(bytes: &[u8], reach: &mut Reach) {
    read_as("input.json", bytes, reach, |path| {
        // The command says which file it is.
        let named = |error| (Reach::variant(&error), format!("{}: {error}", path.display()));
        let case = StepCase::load(path).map_err(named)?;
        let text = case.text().expect("a state file can be written");
        let again: StepCase = serde_json::from_slice(&text).expect("what was written can be read");
        assert_eq!(again, case, "a state file that is written and read");
        Ok(())
    });
}

/// What a command says of a file that it cannot read: the file and why.
fn text_of(path: &Path) -> Result<String, (String, String)> {
    read_text(path).map_err(|error| ("Io".to_owned(), format!("{}: {error}", path.display())))
}

/// What is wrong with the engines, families and tolerance sets that a configuration names.
fn check_names(config: &CampaignConfig) -> Result<(), (&'static str, String)> {
    let mut names = CampaignConfig { real: Vec::new(), ..config.clone() };
    names.settle_engines();
    Engines::of(&names).map_err(|error| ("Engines", error.to_string()))?;
    source::of(&names).map(drop).map_err(|error| ("Source", error.to_string()))
}

/// Files of settings of a campaign.
pub(crate) fn campaign(bytes: &[u8], reach: &mut Reach) {
    read_as("input.toml", bytes, reach, |path| {
        let named = |kind: &str, what: String| (kind.to_owned(), format!("{}: {what}", path.display()));
        let config = CampaignConfig::from_toml(&text_of(path)?).map_err(|error| named("Toml", error.to_string()))?;
        check_names(&config).map_err(|(kind, what)| named(kind, what))
    });
}

/// Gate files.
pub(crate) fn gate(bytes: &[u8], reach: &mut Reach) {
    read_as("input.toml", bytes, reach, |path| {
        let (text, file) = (text_of(path)?, path.display().to_string());
        let gate = GateConfig::from_toml(&text, &file).map_err(|what| {
            let kind = if text.parse::<toml::Table>().is_err() { "Toml" } else { "Value" };
            (kind.to_owned(), what)
        })?;
        check_names(&gate.campaign).map_err(|(kind, what)| (kind.to_owned(), format!("{file}: {what}")))
    });
}

/// Baselines of a gate.
pub(crate) fn baseline(bytes: &[u8], reach: &mut Reach) {
    read_as("input.toml", bytes, reach, |path| {
        let known = toml::from_str::<KnownFindings>(&text_of(path)?)
            .map_err(|error| ("Toml".to_owned(), format!("{}: {error}", path.display())))?;
        let again: KnownFindings = toml::from_str(&known.to_toml()).expect("what was written can be read");
        assert_eq!(again, known, "a baseline that is written and read");
        Ok(())
    });
}

/// What `--engine-command` names.
pub(crate) fn engine_spec(bytes: &[u8], reach: &mut Reach) {
    let Ok(text) = std::str::from_utf8(bytes) else { return reach.count("not-text") };
    match EngineSpec::parse(text).and_then(|spec| EngineSpec::check_all(std::slice::from_ref(&spec)).map(|()| spec)) {
        Ok(spec) => {
            assert!(!spec.name.is_empty() && !spec.command.is_empty(), "{spec:?}");
            reach.count("read");
        }
        Err(error) => reach.count(Reach::variant(&error)),
    }
}

/// Numbers as users write them. What is read is written exactly.
pub(crate) fn number(bytes: &[u8], reach: &mut Reach) {
    let Ok(text) = std::str::from_utf8(bytes) else { return reach.count("not-text") };
    match Number::parse(text) {
        Ok(number) => {
            let written = number.to_string();
            // A number within the limits may have a text beyond them.
            match Number::parse(&written) {
                Ok(again) => {
                    assert_eq!(again, number, "{text:?} is written as {written:?}");
                    reach.count("read");
                }
                Err(error) => reach.count(format!("written-{}", Reach::variant(&error))),
            }
        }
        Err(error) => reach.count(Reach::variant(&error)),
    }
}
