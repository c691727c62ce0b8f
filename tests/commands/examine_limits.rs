//! Pins where `examine` decides nothing, or goes on without a part of its answer: no contact tried, no set to look for, tolerances larger than
//! blocks, numbers beyond f64.

use crate::examine_command::{SOUND, document_of};
use crate::place::Place;

/// A fixed cube and a cube above it.
fn above(height: &str) -> String {
    format!(
        "[[block]]\nfixed = true\nbox = {{ min = [0, 0, 0], max = [1, 1, 1] }}\n\
         [[block]]\nbox = {{ min = [0, 0, {height}], max = [1, 1, \"2.2\"] }}\n"
    )
}

#[test]
fn where_no_contact_was_tried_nothing_is_decided() {
    let place = Place::new();
    let block =
        |more: &str, at: i32| format!("[[block]]\n{more}\nbox = {{ min = [{at}, 0, 0], max = [{}, 1, 1] }}\n", at + 1);
    place.file("gap.toml", &above("1.03"));
    place.file("apart.toml", &(block("", 0) + &block("", 10)));
    place.file("one.toml", &block("", 0));
    place.file("fast.toml", &block("velocity = [1e300, 0, 0]", 0));
    let apart = "not decided: no two blocks are near enough to touch (search is 0.";
    let alone = "not decided: one block alone touches nothing\n";
    for (name, said) in [("gap", apart), ("apart", apart), ("one", alone), ("fast", "not ")] {
        let (code, out, err) = place.run(&["examine", &format!("{name}.toml"), "--steps", "5", "--out", name]);
        assert!(code == 1 && out.starts_with(said), "{name}: {out}{err}");
        for about in ["overlaps", "f64", "f32", "tolerances", "steps"] {
            assert!(!out.contains(&format!("✓ {about}")), "{name}: nothing was tried: {out}");
        }
        assert_eq!(out.contains("--hold-lowest"), name == "apart", "one block that is held does not move: {out}");
        let document = document_of(&place, name);
        assert!(document["safe"] == false && document["given"]["safe_but_for_units"] == false, "{document}");
        let page = place.read(&format!("{name}/index.html"));
        assert!(!page.contains("<li class=\"good\">not "), "{name}");
    }
    assert!(place.read("gap/examine.md").starts_with("# gap.toml: not decided\n"));
    // Steps in which the blocks meet try contacts.
    let (code, out, err) = place.run(&["examine", "gap.toml", "--steps", "40", "--out", "fallen"]);
    assert!(code == 0 && out.starts_with("safe: nothing is wrong with 0 neighbouring pairs"), "{out}{err}");
}

#[test]
fn blocks_that_contacts_reach_but_no_search_are_examined_without_one() {
    let place = Place::new();
    place.file("gap.toml", &above("1.024"));
    let (code, out, err) = place.run(&["examine", "gap.toml"]);
    assert!(code == 0 && out.starts_with("safe: nothing is wrong with 1 neighbouring pair "), "{out}{err}");
    assert!(out.contains("i set        not looked for: no two blocks are near enough to make pairs of"), "{out}");
    assert!(place.path("reports/examine-gap/index.html").exists());
}

/// A plate of 2 cm between a fixed floor and a block.
const PLATE: &str = r#"
[[block]]
fixed = true
box = { min = [-2, -2, -1], max = [3, 3, 0] }
[[block]]
box = { min = [0, 0, 0], max = [1, 1, "1/50"] }
[[block]]
box = { min = ["-1/2", "-1/2", "1/50"], max = ["3/2", "3/2", "51/50"] }
"#;

/// A cube of 1 m within a fixed one of 4 m.
const INSIDE: &str = r#"
[[block]]
fixed = true
box = { min = [0, 0, 0], max = [4, 4, 4] }
[[block]]
box = { min = [1, 1, 1], max = [2, 2, 2] }
"#;

#[test]
fn a_penetration_beyond_half_the_thinnest_block_decides_nothing() {
    let place = Place::new();
    place.file("plate.toml", PLATE);
    place.file("inside.toml", INSIDE);
    for (file, penetration, block) in [("plate.toml", "1/2", "block 1, 0.02"), ("inside.toml", "10", "block 1, 1 m")] {
        let set = format!("penetration={penetration}");
        let (code, out, err) = place.run(&["check", file, "--set", &set]);
        assert!(
            code == 0 && out.contains("warning: a block may be passed through, or lie within another"),
            "{out}{err}"
        );
        let half = if file == "plate.toml" { "0.01" } else { "0.5" };
        assert!(out.contains(&format!("    satisfied  by penetration ≤ {half}\n")), "{out}");
        let (code, out, err) = place.run(&["examine", file, "--set", &set, "--no-tune", "--overwrite"]);
        assert!(code == 1 && out.starts_with("not ") && out.contains(block), "{out}{err}");
        assert!(out.contains(" i thickness  block 1 is"), "{out}");
        if file == "plate.toml" {
            assert!(out.starts_with("not decided: penetration, 0.5 m, is more than half of the thickness"), "{out}");
            assert!(out.ends_with("next: rockproof check plate.toml --set 'penetration=1/2'\n"), "{out}");
        }
        // What would satisfy does.
        let (_, out, err) = place.run(&["check", file, "--set", &format!("penetration={half}")]);
        assert!(!out.contains("warning: a block may be passed through"), "{out}{err}");
    }
    let (code, out, err) = place.run(&["examine", "plate.toml", "--no-tune", "--out", "auto"]);
    assert!(code == 0 && out.starts_with("safe: ") && !out.contains("thickness"), "{out}{err}");
}

#[test]
fn what_f64_does_not_hold_is_said_and_never_printed() {
    let place = Place::new();
    place.file(
        "huge.toml",
        "[[block]]\nbox = { min = [1e300, 0, 0], max = [2e300, 1e300, 1e300] }\n\
         [[block]]\nbox = { min = [2e300, 0, 0], max = [3e300, 1e300, 1e300] }\n",
    );
    let convert = ["convert", "huge.toml", "huge.vtu"];
    for arguments in [
        &["check", "huge.toml"][..],
        &["examine", "huge.toml"],
        &["classify", "huge.toml"],
        &["simulate", "huge.toml"],
        &["tune", "huge.toml"],
        &convert,
    ] {
        let (code, out, err) = place.run(arguments);
        assert!(
            code == 2 && out.is_empty() && err.starts_with("error: huge.toml: block 0 \"block_0\": "),
            "{out}{err}"
        );
        assert!(err.contains("a coordinate of 1e300 m; beyond 1e45 m ") && err.contains(" overflow f64"), "{err}");
    }
    place.file("sound.toml", SOUND);
    place.file("heavy.toml", &(SOUND.to_owned() + "[[material]]\nname = \"heavy\"\ndensity = 1e300\n"));
    for (file, set) in [("heavy.toml", "penetration=1/100"), ("sound.toml", "penetration=0")] {
        let (code, out, err) = place.run(&["check", file, "--set", set]);
        assert!(code != 2 && out.contains("beyond f64") || out.contains("none that f64 holds"), "{out}{err}");
        let mut words = out.split(|c: char| !c.is_ascii_alphabetic());
        assert!(!words.any(|word| word == "inf" || word == "NaN"), "{out}{err}");
    }
    // In f32 the area of such a face overflows: the model cannot be stepped, which is an answer.
    place.file(
        "large.toml",
        "[[block]]\nfixed = true\nbox = { min = [-1e10, -1e10, -1e10], max = [1e10, 1e10, 0] }\n\
         [[block]]\nbox = { min = [0, 0, 0], max = [1e10, 1e10, 1e10] }\n",
    );
    let (code, out, err) = place.run(&["examine", "large.toml", "--precision", "f32", "--no-tune", "--scale", "1"]);
    let (answer, why) = ("not safe: ", "✗ steps      0 made of 8, then block 0: the area of face 0 overflows");
    assert!(code == 1 && out.starts_with(answer) && out.contains(why), "{out}{err}");
}
