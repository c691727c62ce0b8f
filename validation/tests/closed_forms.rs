//! The figures of the table in `docs/validation.md`: every case keeps its bound in f64 and runs to its end in f32.

use rockproof_validation::{report, table};

#[test]
fn every_case_keeps_its_bound() {
    let lines = report::measure(table());
    let missed: Vec<_> = lines.iter().filter(|line| !line.holds()).map(|line| (&line.case.name, &line.f64)).collect();
    assert!(missed.is_empty(), "{missed:#?}");
    let lost: Vec<_> = lines.iter().filter(|line| line.f32.is_err()).map(|line| (&line.case.name, &line.f32)).collect();
    assert!(lost.is_empty(), "{lost:#?}");
    let mut names: Vec<&String> = lines.iter().map(|line| &line.case.name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), lines.len(), "two cases of one name");
}
