//! The figures of the tables in `docs/validation.md`: every case keeps its bound in f64, f32 is as near as the page says, orders of
//! convergence are what they should be, and every scene of a case is a file that says what to expect.

use rockproof_validation::convergence::studies;
use rockproof_validation::regimes::points;
use rockproof_validation::{report, stepped_scene, table};

/// Cases that f32 cannot hold: they rest on overlaps below the last bits of its coordinates.
const LOST_IN_F32: [&str; 3] = ["inclined block, 12 points", "arch, t/R", "patch test, joint of slope 1/2"];

#[test]
fn every_case_keeps_its_bound() {
    let lines = report::measure(table());
    assert!(lines.len() >= 36, "{}", lines.len());
    let missed: Vec<_> = lines.iter().filter(|line| !line.holds()).map(|line| (&line.case.name, &line.f64)).collect();
    assert!(missed.is_empty(), "{missed:#?}");
    let mut names: Vec<&String> = lines.iter().map(|line| &line.case.name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), lines.len(), "two cases of one name");
    for line in lines.iter().filter(|line| line.case.bound.is_some_and(|bound| bound <= 1e-3)) {
        let name = &line.case.name;
        let f32 = line.f32.as_ref().unwrap_or_else(|failure| panic!("{name}: {failure}")).error;
        let lost = LOST_IN_F32.iter().any(|lost| name.starts_with(lost));
        assert!(lost || f32 <= 0.02, "{name}: {f32} in f32");
    }
}

#[test]
fn errors_fall_with_the_time_step_in_the_known_order() {
    let mut known = 0;
    for study in studies() {
        let Some(order) = study.order else { continue };
        let curve = study.measure().unwrap();
        assert!((curve.order - order).abs() < 0.02, "{}: {}", study.name, curve.order);
        known += 1;
    }
    assert_eq!(known, 4);
}

/// Four of the points are files as well; they say the same.
#[test]
fn points_on_the_incline_are_those_of_the_files() {
    let files =
        [(1, "inclined_rests"), (4, "inclined_slides"), (6, "inclined_topples"), (9, "inclined_slides_and_topples")];
    for (place, name) in files {
        let (made, file) = (points()[place].scene().unwrap(), stepped_scene::scene(name).unwrap());
        assert_eq!(made.blocks[1].block, file.blocks[1].block, "{name}");
        let numbers = |scene: &rockproof_model::Scene| {
            let simulation = &scene.simulation;
            let joint = &simulation.joints.other;
            let pull = simulation.gravity.components().map(rockproof_model::Number::approximate);
            (pull.map(|x| x as f32), joint.friction.approximate(), joint.normal_stiffness.clone())
        };
        assert_eq!(numbers(&made), numbers(&file), "{name}");
    }
}

/// The tables of the page are written by the program, not by hand: every case has its line there.
#[test]
fn the_page_holds_every_case() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/validation.md")).unwrap();
    for case in table() {
        assert!(page.contains(&format!("| {} |", case.name)), "{}; run the program again", case.name);
    }
    for study in studies() {
        let plot = format!("{}/../../docs/images/validation/{}.svg", env!("CARGO_MANIFEST_DIR"), study.name);
        assert!(
            page.contains(&format!("{}.svg", study.name)) && std::path::Path::new(&plot).exists(),
            "{}",
            study.name
        );
    }
}
