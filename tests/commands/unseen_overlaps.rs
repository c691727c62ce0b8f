//! Overlaps that no contact sees, as `check` and `simulate` tell them: which are passages and which are rounding.

use crate::place::Place;

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
#[test]
fn a_turned_stack_whose_springs_yield_is_sound() {
    let place = Place::new();
    let mut scene = "[simulation]\ngravity = [0, 0, -10]\ntime_step = 0.01\n".to_owned();
    scene += &format!("\n[[block]]\nfixed = true\n{}", turned_box([[-1.0, -1.0, -1.0], [3.0, 3.0, 0.0]], 13.0));
    for k in 0..8 {
        let low = [k % 2, k / 2 % 2, k / 4].map(f64::from);
        scene += &format!("\n[[block]]\nmotion = \"rigid\"\n{}", turned_box([low, low.map(|c| c + 1.0)], 13.0));
    }
    place.file("stack.toml", &scene);
    let (code, out, err) = place.run(&["simulate", "stack.toml", "--audit", "--steps", "20", "--out", "run"]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("no unseen overlap and no passage in 20 steps"), "{out}");
}

/// Two knives that stand on a floor under weights, edge at edge, the edges leaning against one another by so little that no contact is made of them; loads push them
/// slowly through one another, while weights press them far deeper into the floor.
#[test]
fn knives_that_pass_through_one_another_are_told_though_a_floor_yields_more() {
    let knife = |side: f64, faces: &str| {
        let y = -side * 0.00436;
        format!(
            "\n[[block]]\nmotion = \"rigid\"\nvertices = [[{side}, -0.5, 0], [{side}, 0.5, 0], [0, {}, 0], [{side}, -0.5, 1], [{side}, 0.5, 1], [0, {y}, 1]]\nfaces = {faces}\n",
            -y
        )
    };
    let weight = |x: [f64; 2]| {
        format!("\n[[block]]\nmotion = \"rigid\"\n{}", turned_box([[x[0], -0.4, 1.0], [x[1], 0.4, 2.0]], 0.0))
    };
    let load = |block: usize, at: f64| {
        format!("\n[[load]]\nblock = {block}\nat = [{at}, 0, 0.5]\nforce = [{}, 0, 0]\n", -50.0 * at)
    };
    let scene = [
        "[simulation]\ngravity = [0, 0, -10]\ntime_step = 0.004\n\n[tolerances]\npreset = \"auto\"\ncriteria = \"classic\"\nparallel_angle = 5\n\n[[joint]]\nfriction = 0\nnormal_stiffness = 1e6\n".to_owned(),
        "\n[[block]]\nfixed = true\nbox = { min = [-5, -5, -1], max = [5, 5, 0] }\n".to_owned(),
        knife(-1.0, "[[0, 1, 2], [5, 4, 3], [0, 3, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]]"),
        knife(1.0, "[[2, 1, 0], [3, 4, 5], [1, 4, 3, 0], [5, 4, 1], [2, 5, 1], [3, 5, 2], [0, 3, 2]]"),
        weight([-1.0, -0.3]),
        weight([0.3, 1.0]),
        load(1, -1.0),
        load(2, 1.0),
    ];
    let place = Place::new();
    place.file("knives.toml", &scene.concat());
    let (code, out, err) =
        place.run(&["simulate", "knives.toml", "--audit", "--force", "--steps", "40", "--out", "run"]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(out.contains("blocks pass through one another: 1 pair overlaps unseen"), "{out}");
    // At once, since the floor presses on none of them against the other one.
    let unseen: Vec<bool> = place.rows("run/steps.csv").iter().map(|row| row["unseen_pairs"] != "0").collect();
    assert_eq!(unseen, [true; 40]);
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
