//! The list of mistakes.

use serde::Deserialize;

/// One mistake.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Mistake {
    /// Its place in the list, from 1.
    #[serde(skip)]
    pub(crate) number: usize,
    pub(crate) name: String,
    /// The source file, from the folder of the crate.
    pub(crate) file: String,
    /// A text that occurs once in it, where `old` alone does not.
    #[serde(default)]
    pub(crate) within: Option<String>,
    /// An expression that occurs once in that text, or in the file.
    pub(crate) old: String,
    /// The mistaken expression.
    pub(crate) new: String,
    /// The test that finds it: `lib` or the name of a test program, a space, and the test.
    pub(crate) found_by: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    mistake: Vec<Mistake>,
}

/// All mistakes, in the order of the files.
pub(crate) fn mistakes() -> Vec<Mistake> {
    let files = [
        ("audit", include_str!("audit.toml")),
        ("contacts", include_str!("contacts.toml")),
        ("numbers", include_str!("numbers.toml")),
        ("solves", include_str!("solves.toml")),
        ("steps", include_str!("steps.toml")),
    ];
    let of = |(name, text): (&str, &str)| -> Vec<Mistake> {
        toml::from_str::<File>(text).unwrap_or_else(|error| panic!("{name}.toml: {error}")).mistake
    };
    let mut all: Vec<Mistake> = files.into_iter().flat_map(of).collect();
    for (place, mistake) in all.iter_mut().enumerate() {
        mistake.number = place + 1;
        assert!(mistake.old != mistake.new, "{}: it changes nothing", mistake.name);
    }
    all
}
