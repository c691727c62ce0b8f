//! Overlaps that no contact sees, as `check` and `simulate` tell them: which are passages and which are rounding.

use crate::place::Place;
use serde_json::Value;

/// Two roofs, ridge on ridge and crossing at so small an angle that no contact is made of them, 9 mm in one another; the upper one's lid bent by 5 mm.
fn crossing_roofs(bent: bool) -> String {
    let [high, low] = if bent { ["0.996", "0.986"] } else { ["0.991"; 2] };
    format!(
        r#"
planarity = 1e-2

[simulation]
gravity = [0, 0, -10]
time_step = "1/400"

[tolerances]
preset = "auto"
criteria = "classic"

[[block]]
fixed = true
vertices = [[-1, -0.5, 0], [1, -0.5, 0], [1, 0.5, 0], [-1, 0.5, 0], [-1, 0, 0.5], [1, 0, 0.5]]
faces = [[0, 3, 2, 1], [0, 1, 5, 4], [2, 3, 4, 5], [0, 4, 3], [1, 2, 5]]

[[block]]
vertices = [[-1, -0.52, {high}], [1, -0.48, {low}], [1, 0.52, {high}], [-1, 0.48, {low}], [-1, -0.02, 0.491], [1, 0.02, 0.491]]
faces = [[1, 2, 3, 0], [4, 5, 1, 0], [5, 4, 3, 2], [3, 4, 0], [5, 2, 1]]
"#
    )
}

#[test]
fn a_bent_face_excuses_no_overlap_at_others() {
    for bent in [false, true] {
        let place = Place::new();
        place.file("roofs.toml", &crossing_roofs(bent));
        let (_, out, _) = place.run(&["check", "roofs.toml"]);
        assert!(
            out.contains("overlaps: 1 pair (worst 0–1, 0.0090 m) overlaps where no contact sees it"),
            "{bent} {out}"
        );
        let (code, out, err) =
            place.run(&["simulate", "roofs.toml", "--audit", "--steps", "1", "--force", "--out", "run"]);
        assert_eq!(code, 1, "{out}{err}");
        assert!(out.contains("1 pair overlaps unseen by contacts after 1 of 1 step"), "{bent} {out}");
    }
}

/// The corners of a box between two corners, turned about the vertical by an angle, as they stand in a scene.
fn turned_box([low, high]: [[f64; 3]; 2], degrees: f64) -> String {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let corners = [low[2], high[2]].into_iter().flat_map(|z| {
        let around = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        around.map(|[x, y]| format!("[{:?}, {:?}, {z:?}]", x * cosine - y * sine, x * sine + y * cosine))
    });
    let corners: Vec<String> = corners.collect();
    format!(
        "vertices = [{}]\nfaces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]\n",
        corners.join(", ")
    )
}

/// Eight rigid cubes face to face on a base, all turned: cubes that touch along edges alone overlap there by less than a nanometre, and no contact sees it.
fn turned_stack() -> String {
    let mut scene = "[simulation]\ngravity = [0, 0, -10]\ntime_step = 0.01\n".to_owned();
    scene += &format!("\n[[block]]\nfixed = true\n{}", turned_box([[-1.0, -1.0, -1.0], [3.0, 3.0, 0.0]], 13.0));
    for k in 0..8 {
        let low = [k % 2, k / 2 % 2, k / 4].map(f64::from);
        scene += &format!("\n[[block]]\nmotion = \"rigid\"\n{}", turned_box([low, low.map(|c| c + 1.0)], 13.0));
    }
    scene
}

/// The pairs that springs explain after each step of a run, as its `steps.csv` has them.
fn explained_pairs(place: &Place, run: &str) -> Vec<u64> {
    let rows = place.rows(&format!("{run}/steps.csv"));
    rows.iter().map(|row| row["explained_pairs"].parse().expect("a count")).collect()
}

/// What is said of so many steps, given what springs explain after each, and of the worst such pair.
fn explained_in_words(counts: &[u64], worst: &Value) -> String {
    let steps = counts.iter().filter(|count| **count > 0).count();
    let (most, all) = (counts.iter().max().expect("steps"), counts.len());
    let [a, b] = [0, 1].map(|k| &worst["blocks"][k]);
    let depth = worst["depth_m"].as_f64().expect("a depth");
    format!(
        "no unseen overlap but those that springs elsewhere explain (up to {most} pairs after {steps} of {all} steps, worst {a}–{b}, {depth:.3e} m, step {}) and no passage in {all} steps",
        worst["step"]
    )
}

#[test]
fn a_turned_stack_whose_springs_yield_is_sound_and_what_they_explain_is_told() {
    let place = Place::new();
    place.file("stack.toml", &turned_stack());
    let args = ["simulate", "stack.toml", "--audit", "--every", "3"];
    let (code, out, err) = place.run(&[&args[..], &["--steps", "20", "--format", "json", "--out", "whole"]].concat());
    assert_eq!(code, 0, "{out}{err}");
    let document: Value = serde_json::from_str(&out).expect("JSON");
    let (audit, counts) = (&document["audit"], explained_pairs(&place, "whole"));
    assert!(audit["objects"] == false && audit["steps_unseen"] == 0, "{audit}");
    let steps = counts.iter().filter(|count| **count > 0).count();
    let most = counts.iter().max().expect("steps");
    assert!(steps > 1 && *most > 1, "{counts:?}");
    assert_eq!((&audit["steps_explained"], &audit["most_explained_pairs"]), (&steps.into(), &(*most).into()));
    let worst = &audit["worst_explained"];
    let [depth, step] = ["depth_m", "step"].map(|key| worst[key].as_f64().expect("a number"));
    assert!(0.0 < depth && depth < 1e-8 && counts[step as usize - 1] > 0, "{worst}");
    // In two sessions as in one, in words too.
    let parts = ["--resume", "--out", "parts", "--steps"];
    assert_eq!(place.run(&[&args[..], &parts, &["4"]].concat()).0, 0);
    let (code, out, err) = place.run(&[&args[..], &parts, &["20"]].concat());
    let told = explained_in_words(&counts, worst);
    assert!(code == 0 && out.contains(&format!("\naudit            {told}\n")), "{told} {out}{err}");
    assert!(place.read("whole/steps.csv") == place.read("parts/steps.csv"));
}

#[test]
fn a_report_tells_what_springs_explain() {
    let place = Place::new();
    place.file("stack.toml", &turned_stack());
    for run in ["one", "two"] {
        let (code, out, err) = place.run(&["simulate", "stack.toml", "--audit", "--steps", "5", "--out", run]);
        assert_eq!(code, 0, "{out}{err}");
    }
    let (counts, run) = (explained_pairs(&place, "one"), serde_json::from_str::<Value>(&place.read("one/run.json")));
    let worst = &run.expect("JSON")["totals"]["audit"]["worst_explained"];
    // To know, as contacts did not see it.
    let (code, out, err) = place.run(&["report", "one", "--format", "markdown"]);
    let told = format!("- ℹ️ one: {};", explained_in_words(&counts, worst));
    assert!(code == 0 && out.contains(&told), "{told} {out}{err}");
    let (code, out, err) = place.run(&["report", "one", "two", "--format", "markdown"]);
    let steps = counts.iter().filter(|count| **count > 0).count();
    let told = format!(
        "- ℹ️ No passage and no unseen overlap but those that springs elsewhere explain (after {} of 10 steps; the deepest ",
        2 * steps
    );
    assert!(
        code == 0 && out.contains(&told) && out.contains(" m, in one) in 10 audited steps of 2 of 2 runs."),
        "{out}{err}"
    );
    assert_eq!(place.run(&["report", "one", "two", "--out", "page"]).0, 0);
    let cells = ["steps_explained", "most_explained_pairs", "worst_explained", "worst_explained_m"];
    let [a, b] = [0, 1].map(|k| &worst["blocks"][k]);
    let (most, depth) = (counts.iter().max().expect("steps"), worst["depth_m"].as_f64().expect("a depth"));
    for row in place.rows("page/tables/audit.csv") {
        let [counted, pairs, blocks, depth_m] = cells.map(|column| row[column].clone());
        assert_eq!([counted, pairs, blocks], [steps.to_string(), most.to_string(), format!("{a}-{b}")]);
        assert_eq!(depth_m.parse(), Ok(depth));
    }
}

/// `examine` makes the first steps of such a run.
#[test]
fn an_examination_tells_what_springs_explain() {
    let place = Place::new();
    place.file("stack.toml", &turned_stack());
    assert_eq!(place.run(&["simulate", "stack.toml", "--audit", "--steps", "8", "--out", "run"]).0, 0);
    let (counts, run) = (explained_pairs(&place, "run"), serde_json::from_str::<Value>(&place.read("run/run.json")));
    let worst = &run.expect("JSON")["totals"]["audit"]["worst_explained"];
    let (code, out, err) = place.run(&["examine", "stack.toml", "--no-tune", "--out", "examined"]);
    let told = explained_in_words(&counts, worst);
    assert!(
        code == 0 && out.contains(&format!("  i steps      8 made, what the scene fixes held: {told};")),
        "{told} {out}{err}"
    );
    let found: Value = serde_json::from_str(&place.read("examined/examine.json")).expect("JSON");
    let steps = &found["given"]["steps"];
    let is_worst = |pair: &Value| pair["blocks"] == worst["blocks"] && pair["depth_m"] == worst["depth_m"];
    assert!(steps["explained"].as_array().is_some_and(|pairs| pairs.iter().any(is_worst)), "{steps}");
    assert!(found["answer"] == "safe" && steps["unseen"] == Value::Array(Vec::new()), "{steps}");
}

/// The search steps the same blocks, looks for overlaps alone as `--audit` does of them, and tells the same.
#[test]
fn a_search_tells_what_springs_explain() {
    let place = Place::new();
    place.file("stack.toml", &turned_stack());
    let (_, out, err) = place.run(&["tune", "stack.toml", "--candidates", "1", "--steps", "10", "--out", "found"]);
    assert!(out.contains("Every rule is met"), "{out}{err}");
    let row = &place.rows("found/candidates.csv")[0];
    let [steps, pairs, depth] = ["steps_explained", "explained_pairs", "explained_m"].map(|column| &row[column]);
    let depth: f64 = depth.parse().expect("a depth");
    assert!(steps != "0" && pairs == "2" && row["steps_unseen"] == "0", "{row:?}");
    let told = format!(
        "Not counted are unseen overlaps that springs elsewhere explain: of up to 2 pairs after {steps} of 10 steps, {depth:.3e} m at most.\n"
    );
    assert!(out.contains(&told), "{told} {out}");
    assert!(
        out.contains(&format!("that springs elsewhere explain (pairs, depth) | {steps} (2, {depth:.3e} m) |\n")),
        "{out}"
    );
    let args = [
        "simulate",
        "stack.toml",
        "--audit",
        "--steps",
        "10",
        "--tolerances",
        "found/tolerances.toml",
        "--format",
        "json",
        "--out",
        "run",
    ];
    let document: Value = serde_json::from_str(&place.run(&args).1).expect("JSON");
    let audit = &document["audit"];
    assert_eq!(
        (audit["steps_explained"].to_string(), audit["most_explained_pairs"].to_string()),
        (steps.clone(), pairs.clone())
    );
    assert_eq!(audit["worst_explained"]["depth_m"], depth);
}

/// Two knives that stand on a floor under weights, edge at edge, the edges leaning against one another by so little that no contact is made of them; loads push them
/// slowly through one another, while weights press them far deeper into the floor. The second one has these faces and may be fixed, and what is on it too.
fn knives(faces_of_second: &str, of_second: &str) -> String {
    let moves = |x: f64| if x > 0.0 { of_second } else { "motion = \"rigid\"" };
    let knife = |side: f64, faces: &str| {
        let y = -side * 0.00436;
        format!(
            "\n[[block]]\n{}\nvertices = [[{side}, -0.5, 0], [{side}, 0.5, 0], [0, {}, 0], [{side}, -0.5, 1], [{side}, 0.5, 1], [0, {y}, 1]]\nfaces = {faces}\n",
            moves(side),
            -y
        )
    };
    let weight = |x: [f64; 2]| {
        format!("\n[[block]]\n{}\n{}", moves(x[0]), turned_box([[x[0], -0.4, 1.0], [x[1], 0.4, 2.0]], 0.0))
    };
    let load = |block: usize, at: f64| {
        format!("\n[[load]]\nblock = {block}\nat = [{at}, 0, 0.5]\nforce = [{}, 0, 0]\n", -50.0 * at)
    };
    [
        "[simulation]\ngravity = [0, 0, -10]\ntime_step = 0.004\n\n[tolerances]\npreset = \"auto\"\ncriteria = \"classic\"\nparallel_angle = 5\n\n[[joint]]\nfriction = 0\nnormal_stiffness = 1e6\n".to_owned(),
        "\n[[block]]\nfixed = true\nbox = { min = [-5, -5, -1], max = [5, 5, 0] }\n".to_owned(),
        knife(-1.0, "[[0, 1, 2], [5, 4, 3], [0, 3, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]]"),
        knife(1.0, faces_of_second),
        weight([-1.0, -0.3]),
        weight([0.3, 1.0]),
        load(1, -1.0),
        load(2, 1.0),
    ]
    .concat()
}

#[test]
fn knives_that_pass_through_one_another_are_told_though_a_floor_yields_more() {
    // Sides that are bent inwards, so that no rule for convex blocks applies, and outwards.
    let bent_in = "[[2, 1, 0], [3, 4, 5], [1, 4, 3, 0], [5, 4, 1], [2, 5, 1], [3, 5, 2], [0, 3, 2]]";
    let convex = "[[2, 1, 0], [3, 4, 5], [1, 4, 3, 0], [2, 5, 4], [2, 4, 1], [0, 3, 5], [0, 5, 2]]";
    let free = "motion = \"rigid\"";
    for (faces, of_second) in [(bent_in, free), (convex, free), (convex, "fixed = true")] {
        let place = Place::new();
        place.file("knives.toml", &knives(faces, of_second));
        let (code, out, err) =
            place.run(&["simulate", "knives.toml", "--audit", "--force", "--steps", "40", "--out", "run"]);
        assert_eq!(code, 1, "{of_second} {out}{err}");
        assert!(
            out.contains("blocks overlap where no contact holds them: 1 pair overlaps unseen"),
            "{of_second} {out}"
        );
        // At once, since the floor presses on none of them against the other one.
        let unseen: Vec<bool> = place.rows("run/steps.csv").iter().map(|row| row["unseen_pairs"] != "0").collect();
        assert_eq!(unseen, [true; 40], "{of_second}");
    }
}

/// A block on two fixed ones that meet in the plane x = `seam`, the second of them higher by so much.
fn on_two_fixed_blocks([seam, higher]: [f64; 2], settings: &str, block: &str) -> String {
    format!(
        r#"
{settings}

[[block]]
fixed = true
box = {{ min = [-3, -2, -1], max = [{seam}, 2, 0] }}

[[block]]
fixed = true
box = {{ min = [{seam}, -2, -1], max = [3, 2, {higher}] }}

[[block]]
{block}
"#
    )
}

/// What is said of so many steps of a scene with `--audit`, and whether it is sound.
fn audited(scene: &str, steps: &str) -> (bool, String) {
    let place = Place::new();
    place.file("scene.toml", scene);
    let (code, out, err) =
        place.run(&["simulate", "scene.toml", "--audit", "--force", "--steps", steps, "--out", "run"]);
    let said = out.lines().find_map(|line| line.strip_prefix("audit ")).unwrap_or_else(|| panic!("{out}{err}"));
    (code == 0, said.trim_start().to_owned())
}

/// Side by side with a floor of one height, into which a block sinks by 0.65 mm, it overlaps it by a nanometre at the seam; with one that is 1 cm higher by ten, and there it could go on.
#[test]
fn a_block_at_rest_over_a_seam_of_fixed_blocks_is_sound_and_one_in_a_step_is_told() {
    let settings = "[simulation]\ngravity = [0, 0, -10]\ntime_step = \"1/200\"\nsettle = 50\n\n[[joint]]\nfriction = 0.5\nnormal_stiffness = 1e7";
    let block = "box = { min = [-0.5, -0.5, 0], max = [0.5, 0.5, 1] }";
    let (is_sound, said) = audited(&on_two_fixed_blocks([0.499999, 0.0], settings, block), "125");
    assert!(is_sound && said.contains("but those that springs elsewhere explain (1 pair at a time"), "{said}");
    let (is_sound, said) = audited(&on_two_fixed_blocks([0.499999, 0.01], settings, block), "45");
    assert!(
        !is_sound && said.contains("1 pair overlaps unseen by contacts after 1 of 95 steps (worst 1–2, "),
        "{said}"
    );
}

/// A block that slides over a step down and tilts onto the lower block: the higher one still pushes it up, by far more than it is in the lower one, or by not ten times as much.
#[test]
fn a_block_that_slides_over_a_step_down_is_pushed_out_of_the_lower_one_by_the_higher() {
    let slides = |stiffness: &str, higher: f64| {
        let settings = format!(
            "[simulation]\ngravity = [0, 0, -10]\ntime_step = 0.001\nsettle = 20\n\n[tolerances]\npreset = \"auto\"\ncriteria = \"classic\"\n\n[[joint]]\nfriction = 0.2\nnormal_stiffness = {stiffness}"
        );
        let block = "motion = \"rigid\"\nvelocity = [2, 0, 0]\nbox = { min = [-0.5, -0.5, 0], max = [0.5, 0.5, 2] }";
        audited(&on_two_fixed_blocks([0.5, higher], &settings, block), "40")
    };
    let (is_sound, said) = slides("4e7", -0.0005);
    assert!(is_sound && said.contains("but those that springs elsewhere explain (1 pair at a time"), "{said}");
    let (is_sound, said) = slides("2e7", -0.001);
    assert!(
        !is_sound && said.contains("1 pair overlaps unseen by contacts after 1 of 60 steps (worst 1–2, "),
        "{said}"
    );
}

/// A fin that goes half a metre into a block along its reflex edge, a few micrometres deep by the depth of pairs that are not convex; beds beside it push it out on that
/// way and along it do not, and weights press both blocks far deeper into others.
#[test]
fn a_fin_that_cuts_into_a_block_is_told_though_others_hold_it() {
    let place = Place::new();
    place.file("fin.toml", include_str!("../fixtures/fin_along_beds.toml"));
    let (code, out, err) = place.run(&["simulate", "fin.toml", "--audit", "--force", "--steps", "4", "--out", "run"]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(out.contains("1 pair overlaps unseen by contacts after 3 of 4 steps"), "{out}");
}
