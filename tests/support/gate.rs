//! Runs the command `gate` for tests.

use assert_cmd::Command;
use std::fs;
use std::path::Path;

/// What a gate said.
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// Runs a gate in a folder of its own.
pub(crate) fn gate(dir: &Path, text: &str, more: &[&str], github: bool) -> Ran {
    fs::write(dir.join("gate.toml"), text).expect("write");
    let mut command = Command::cargo_bin("rockproof").expect("the program");
    command.current_dir(dir).env_remove("GITHUB_ACTIONS").env_remove("GITHUB_STEP_SUMMARY");
    if github {
        command.env("GITHUB_ACTIONS", "true").env("GITHUB_STEP_SUMMARY", dir.join("summary.md"));
    }
    let output = command.args(["gate", "gate.toml", "--junit", "junit.xml"]).args(more).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    Ran { code: output.status.code().expect("a code"), out: text(output.stdout), err: text(output.stderr) }
}

/// A gate around one external engine, `mine`; two families of which one, with ties, the stepper always gets right. Its cases stay as they were found:
/// to make them smaller would take most of the time.
pub(crate) fn around(command: &[&str], rest: &str) -> String {
    let words: Vec<String> = command.iter().map(|word| toml::Value::from(*word).to_string()).collect();
    format!(
        "corpus = []\n[campaign]\npairs = 256\nengines = []\nfamilies = [\"face_stack\", \"edge_cross\"]\nshrink_evaluations = 0\n\
         [[campaign.external]]\nname = \"mine\"\ncommand = [{}]\ntimeout_ms = 500\n{rest}",
        words.join(", ")
    )
}
