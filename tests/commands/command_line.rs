//! What is wrong with a command line is told as other errors are, whatever stands in it.

use crate::place::rockproof;

#[test]
fn long_values_are_cut() {
    let long = "x".repeat(100_000);
    for arguments in [
        &["check", "a.obj", "--planarity", &long][..],
        &["campaign", "--pairs", &long],
        &["campaign", "--part", &long],
        &["bench", "--skips", &long],
        &["classify", "a.obj", "--pair", &long],
        &[&long],
    ] {
        let (code, out, err) = rockproof(arguments);
        assert!(code == 2 && out.is_empty(), "{arguments:.40?}: {code}");
        assert!(err.starts_with("error: ") && err.contains('…'), "{arguments:.40?}: {err:.2000}");
        assert!(err.len() < 4000, "{arguments:.40?}: {} bytes", err.len());
    }
}

#[test]
fn no_value_is_a_command_to_a_terminal_or_a_runner() {
    for value in ["1\n::error file=x::y", "\u{1b}[31m", "##[error]z"] {
        for option in [["campaign", "--pairs"], ["check", "--input-format"]] {
            let (code, _, err) = rockproof(&[option[0], "a.obj", option[1], value]);
            let harmless = !err.contains('\u{1b}') && !err.contains("##[") && !err.contains("\n::");
            assert!(code == 2 && harmless, "{value:?}: {err:?}");
        }
    }
}

#[test]
fn help_and_version_are_no_errors_and_whole() {
    let (code, out, err) = rockproof(&["campaign", "--help"]);
    assert!(code == 0 && err.is_empty() && out.lines().count() > 60, "{code}: {out}{err}");
    let (code, out, _) = rockproof(&["--version"]);
    assert!(code == 0 && out.starts_with("rockproof "), "{code}: {out}");
    // Without a command: how to use it, whole.
    let (code, out, err) = rockproof(&[]);
    assert!(code == 2 && out.is_empty() && err.contains("Usage:") && err.contains("simulate"), "{code}: {out}{err}");
}

/// The last one would count, without a word.
#[test]
fn a_tolerance_that_is_set_twice_is_refused() {
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/two_cubes.obj");
    for [first, again] in
        [["search=1/10", "search=1/5"], ["search=1/10", "search=1/10"], ["overlap_angle=3", "overlap_sine=1/10"]]
    {
        for options in [&["--set", first, "--set", again][..], &["--set", first, again]] {
            let (code, _, err) = rockproof(&[&["check", model], options].concat());
            let told = format!("error: --set {first} and --set {again} are both given; a tolerance has one value");
            assert!(code == 2 && err.contains(&told), "{options:?}: {err}");
        }
    }
    let (code, out, err) = rockproof(&["check", model, "--set", "overlap_angle=3", "--set", "parallel_angle=3"]);
    assert_ne!(code, 2, "{out}{err}");
}
