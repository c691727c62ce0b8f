//! Pins what is said of what a scene gives and steps never use: rows of load tables between the ends of two steps, stress of blocks that have none.
//!
//! Caught: nothing was said of either.

use crate::place::Place;

#[test]
fn rows_of_load_tables_that_steps_pass_by_are_named() {
    let place = Place::new();
    let note = |table: &str, more: &str| {
        let text = format!(
            "[simulation]\ngravity = [0, 0, 0]\ntime_step = \"1/100\"\nsteps = 1\n{more}\
             [[block]]\nmotion = \"rigid\"\nbox = {{ min = [0, 0, 0], max = [1, 1, 1] }}\n\
             [[load]]\nblock = 0\nat = [0, 0, 0]\ntable = [{table}]\n"
        );
        place.file("load.toml", &text);
        let (code, out, err) = place.run(&["simulate", "load.toml", "--out", "run", "--overwrite"]);
        assert_eq!(code, 0, "{out}{err}");
        let begin = "note: steps of 0.01 s may pass by rows of load tables, since each takes the force at its end (";
        err.lines()
            .find_map(|line| Some(line.strip_prefix(begin)?.strip_suffix("): use a shorter time_step")?.to_owned()))
    };
    let pulse = "[0.501, 0, 0, 0], [0.505, 650000, 0, 0], [0.509, 0, 0, 0]";
    assert_eq!(note(pulse, "").as_deref(), Some("row 2 of block 0, 0.505 s, between 0.501 and 0.509 s"));
    let square = "[\"0.1\", 0, 0, 0], [\"0.102\", 0, 0, 5], [\"0.108\", 0, 0, 5], [\"0.11\", 0, 0, 0]";
    let rows =
        "row 2 of block 0, 0.102 s, between 0.1 and 0.108 s; row 3 of block 0, 0.108 s, between 0.102 and 0.11 s";
    assert_eq!(note(square, "").as_deref(), Some(rows), "a pulse as long as a step");
    // A force that begins with time and ends within the first step; settling takes it.
    let blow = "[0, 0, 7, 0], [0.005, 0, 0, 0]";
    assert_eq!(note(blow, "").as_deref(), Some("row 1 of block 0, 0 s, before 0.005 s"));
    assert_eq!(note(blow, "settle = 1\n"), None);
    for seen in [
        "[0, 0, 0, 0], [0.001, 5, 0, 0]",
        "[0, 0, 0, 0], [0.3, 0, 0, 0], [0.301, 5, 0, 0], [0.4, 5, 0, 0]",
        "[\"0.1\", 0, 0, 0], [\"0.105\", 0, 0, 5], [\"0.1101\", 0, 0, 0]",
        "[\"0.1\", 0, 0, 0], [\"0.102\", 0, 0, 1], [\"0.104\", 0, 0, 2], [1, 0, 0, 2]",
    ] {
        assert_eq!(note(seen, ""), None, "{seen}");
    }
}

#[test]
fn stress_of_blocks_that_have_none_is_told() {
    let place = Place::new();
    let cube = |x: u8, motion: &str| {
        format!(
            "[[block]]\n{motion}\nbox = {{ min = [{x}, 0, 0], max = [{}, 1, 1] }}\nstress = [-1e5, 0, 0, 0, 0, 0]\n",
            x + 1
        )
    };
    let all = [
        cube(0, "fixed = true"),
        cube(2, "motion = \"rigid\""),
        cube(4, "motion = \"deformable\""),
        cube(6, "motion = \"rigid\""),
    ]
    .concat();
    place.file("stressed.toml", &format!("[simulation]\ngravity = [0, 0, 0]\n{all}"));
    for args in [&["check", "stressed.toml"][..], &["simulate", "stressed.toml", "--steps", "1"]] {
        let (code, out, err) = place.run(args);
        let told = [
            "ignored, since fixed blocks never move: stress of block 0\n",
            "ignored, since rigid blocks have no strain: stress of blocks 1, 3\n",
        ];
        assert!(code == 0 && told.iter().all(|told| err.contains(told)), "{out}{err}");
    }
}
