//! How commands that are told name the model, what it is read and looked at with, and the results.

use rockproof_differential::external::spec::quoted;
use rockproof_model::{LoadOptions, ToleranceSpec};
use std::path::{Path, PathBuf};

/// The parts of a command about a model, each as it stands on a command line.
#[derive(Clone, Debug)]
pub struct Naming {
    /// The model's file.
    pub file: String,
    /// The options that it is read with ([`reading`]).
    pub read: String,
    /// The options that say its tolerances ([`setting`]).
    pub tolerances: String,
    /// Whether whoever reads the file says that its lengths are metres, by the factor 1, so that the unit is in no doubt. Another factor may be the wrong one.
    pub units_are_meant: bool,
    /// The directory of the results; without one no next command is told, since that may be about a file in it.
    pub dir: Option<PathBuf>,
    /// Whether that is where results of the model are without being told, so that commands need not name it.
    pub is_usual_dir: bool,
}

impl Naming {
    /// The file and how it is read.
    pub(crate) fn shown(&self) -> String {
        format!("{}{}", self.file, self.read)
    }

    /// The command that shows a pair of blocks.
    pub(crate) fn show(&self, [a, b]: [usize; 2]) -> String {
        format!("rockproof classify {}{} --pair {a},{b}", self.shown(), self.tolerances)
    }

    /// The command that shows the model.
    pub(crate) fn show_all(&self) -> String {
        format!("rockproof check {}{}", self.shown(), self.tolerances)
    }

    /// The place of one of the results, for people; where there is no directory what stands for it.
    pub(crate) fn place_of(&self, name: &str, otherwise: &str) -> String {
        self.dir.as_ref().map_or_else(|| otherwise.to_owned(), |dir| dir.join(name).display().to_string())
    }
}

/// How a file is read, as options on a command line, each after a space; nothing where none is given.
pub fn reading(options: &LoadOptions) -> String {
    let texts = [("planarity", &options.planarity), ("weld", &options.weld), ("scale", &options.scale)]
        .map(|(name, value)| value.as_ref().map(|value| format!(" --{name} {value}")));
    texts.into_iter().flatten().collect()
}

/// Tolerances as options on a command line, exactly, each after a space.
pub fn setting(spec: &ToleranceSpec) -> String {
    let preset = spec.preset().map(|preset| format!(" --tolerances {}", preset.name()));
    let numbers = spec.numbers().iter().map(|(name, value)| format!("{name}={value}"));
    let criteria = spec.criteria().map(|criteria| format!("criteria={}", criteria.name()));
    let set = numbers.chain(criteria).map(|changed| format!(" --set {}", quoted(&changed)));
    preset.into_iter().chain(set).collect()
}

/// The name of a file without its folders.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A path as a word of a command.
pub(crate) fn quoted_path(path: &Path) -> String {
    quoted(&path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::{reading, setting};
    use rockproof_model::{LoadOptions, Number, ToleranceSpec};

    #[test]
    fn options_mean_what_they_were_made_of() {
        let mut spec = ToleranceSpec::default();
        for assignment in ["search=1/3", "open=0.1", "overlap_angle=3", "criteria=classic"] {
            spec.assign(assignment).expect("an assignment");
        }
        let text = setting(&spec);
        let mut again = ToleranceSpec::empty();
        let mut words = text.split_whitespace();
        while let (Some(option), Some(value)) = (words.next(), words.next()) {
            match option {
                "--tolerances" => again.set_text("preset", value).expect("a preset"),
                "--set" => again.assign(value.trim_matches('\'')).expect("an assignment"),
                other => panic!("{other}"),
            }
        }
        assert_eq!(again, spec, "{text}");
        let [planarity, scale] = ["1e-4", "1/1000"].map(|text| Some(Number::parse(text).expect("a number")));
        let options = LoadOptions { planarity, scale, ..LoadOptions::default() };
        assert_eq!(reading(&options), " --planarity 1/10000 --scale 1/1000");
    }
}
