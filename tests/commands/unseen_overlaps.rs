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
