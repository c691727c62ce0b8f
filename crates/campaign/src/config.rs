//! What a campaign is asked to do.

use rockproof_differential::builtin;
use rockproof_differential::external::EngineSpec;
use rockproof_model::Number;
use rockproof_pairs::tolerance_grid::ToleranceGrid;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::PathBuf;

/// The most pairs of a chunk: what is found in them waits in memory until the chunk ends.
pub const LARGEST_CHUNK: u64 = 1 << 16;

/// The configuration of a campaign, as read from a file and changed by the command line. Together with the program's
/// version it determines every byte of `findings.csv` and `summary.csv`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CampaignConfig {
    /// How many pairs.
    pub pairs: u64,
    /// The seed of all pairs.
    pub seed: u64,
    /// The engines by name. Where external ones are named here, these and no others of `external` take part.
    pub engines: Vec<String>,
    /// The external engines, which take part beside the built-in ones unless `engines` names some of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub external: Vec<EngineSpec>,
    /// Whether external engines are asked everything twice, of two processes.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub ask_twice: bool,
    /// The tolerance sets: names, or TOML files of tolerances; empty for all that have names, or for none beside a grid.
    pub tolerances: Vec<String>,
    /// Tolerance sets on a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<ToleranceGrid>,
    /// The families; empty for all.
    pub families: Vec<String>,
    /// Whether the pairs are those of the stress set ([`crate::stress`]) instead of the families'.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub stress: bool,
    /// Whether all pairs are made of bases as their families make them, on coarse grids, instead of some 8 in 100: that is where decisions are exact ties, and
    /// perturbed bases have none.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub exact_ties: bool,
    /// Block files for the family `real`; empty for the ones that come with the program.
    pub real: Vec<PathBuf>,
    /// How far a face in those files may be from planar, as a share of its block's size; what the file says by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub planarity: Option<Number>,
    /// Vertices of those files no further apart than this, in the file's unit, become one; see [`rockproof_model::LoadOptions`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weld: Option<Number>,
    /// What every length of those files is multiplied by; see [`rockproof_model::LoadOptions`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<Number>,
    /// Pairs between two states of the journal: what an interruption can lose. At most [`LARGEST_CHUNK`].
    pub chunk: u64,
    /// One pair in this many goes through the metamorphic checks; 0 for none.
    pub metamorphic_every: u64,
    /// One pair in this many makes steps; 0 for none.
    pub steps_every: u64,
    /// How many steps such a pair makes.
    pub steps: u32,
    /// Findings of each fingerprint that are shrunk and written as case files.
    pub cases_per_fingerprint: u64,
    /// Case files of each cause at most.
    pub cases_per_cause: u64,
    /// Pairs a shrinker may examine for one case.
    pub shrink_evaluations: u64,
}

/// What of a configuration an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SettingPlace<'s> {
    /// The external engine whose key it is; none of the campaign's own keys.
    pub engine: Option<&'s str>,
    /// The key.
    pub key: &'static str,
    /// The value in the key's list, where it has one.
    pub value: Option<&'s str>,
}

impl Default for CampaignConfig {
    fn default() -> Self {
        CampaignConfig {
            pairs: 100_000,
            seed: 1,
            engines: vec!["stepper-f32".to_owned(), "stepper-f64".to_owned()],
            external: Vec::new(),
            ask_twice: false,
            tolerances: Vec::new(),
            grid: None,
            families: Vec::new(),
            stress: false,
            exact_ties: false,
            real: Vec::new(),
            planarity: None,
            weld: None,
            scale: None,
            chunk: 4096,
            metamorphic_every: 16,
            steps_every: 64,
            steps: 1,
            cases_per_fingerprint: 1,
            cases_per_cause: 50,
            shrink_evaluations: 300,
        }
    }
}

impl CampaignConfig {
    /// The configuration in a TOML text.
    ///
    /// # Errors
    /// What is wrong, with line and column.
    pub fn from_toml(text: &str) -> Result<CampaignConfig, toml::de::Error> {
        toml::from_str(text)
    }

    /// Leaves built-in engines alone in `engines`, by the names that tables have, and in `external` those that take part: what means the same
    /// then is the same configuration, however it was asked for. Where a name is nobody's, all external ones stay, to be told of.
    pub fn settle_engines(&mut self) {
        for name in &mut self.engines {
            if let Some(full) = builtin::full_name(name) {
                full.clone_into(name);
            }
        }
        let (outside, builtin): (Vec<String>, Vec<String>) =
            self.engines.drain(..).partition(|name| self.external.iter().any(|spec| spec.name == *name));
        self.engines = builtin;
        if !outside.is_empty() && self.engines.iter().all(|name| builtin::engine(name).is_some()) {
            self.external.retain(|spec| outside.contains(&spec.name));
        }
    }

    /// What must be the same for a run to go on, key by key.
    ///
    /// # Errors
    /// When a path is not Unicode.
    pub fn identity(&self) -> Result<Map<String, Value>, serde_json::Error> {
        match serde_json::to_value(self)? {
            Value::Object(mut map) => {
                map.insert("version".to_owned(), env!("CARGO_PKG_VERSION").into());
                Ok(map)
            }
            _ => Ok(Map::new()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_file_is_the_default() {
        assert_eq!(CampaignConfig::from_toml("").ok(), Some(CampaignConfig::default()));
    }

    #[test]
    fn unknown_keys_and_wrong_types_are_named_with_their_line() {
        let error = CampaignConfig::from_toml("seed = 3\npears = 5\n").expect_err("unknown key").to_string();
        assert!(error.contains("line 2") && error.contains("pears") && error.contains("pairs"), "{error}");
        let error = CampaignConfig::from_toml("seed = \"x\"").expect_err("wrong type").to_string();
        assert!(error.contains("line 1") && error.contains("u64"), "{error}");
    }

    #[test]
    fn engines_from_outside_are_named_like_others() {
        let external =
            "[[external]]\nname = \"mine\"\ncommand = \"x\"\n[[external]]\nname = \"other\"\ncommand = \"y\"\n";
        let settled = |engines: &str| {
            let mut config = CampaignConfig::from_toml(&format!("{engines}{external}")).expect("good");
            config.settle_engines();
            let external: Vec<String> = config.external.into_iter().map(|spec| spec.name).collect();
            (config.engines.join(" "), external.join(" "))
        };
        let text = |one: &str, other: &str| (one.to_owned(), other.to_owned());
        assert_eq!(settled("engines = [\"mine\"]\n"), text("", "mine"));
        assert_eq!(settled("engines = [\"mine\", \"f32\"]\n"), text("stepper-f32", "mine"));
        assert_eq!(settled("engines = [\"stepper-f64\"]\n"), text("stepper-f64", "mine other"));
        assert_eq!(settled(""), text("stepper-f32 stepper-f64", "mine other"));
        // A name that nobody has stays, to be refused.
        assert_eq!(settled("engines = [\"nobody\"]\n"), text("nobody", "mine other"));
        assert_eq!(settled("engines = [\"mine\", \"nobody\"]\n"), text("nobody", "mine other"));
    }

    #[test]
    fn says_what_differs() {
        use rockproof_results::identity_differences;
        let one = CampaignConfig::default();
        let other = CampaignConfig { seed: 2, ..one.clone() };
        let differences = identity_differences(&one.identity().expect("a map"), &other.identity().expect("a map"));
        assert_eq!(differences, ["seed: the run has 1, asked for is 2"]);
        let other = CampaignConfig { families: vec!["sliver".to_owned()], ..one.clone() };
        let differences = identity_differences(&one.identity().expect("a map"), &other.identity().expect("a map"));
        assert_eq!(differences, [r#"families: the run has none named, asked for is ["sliver"]"#]);
    }
}
