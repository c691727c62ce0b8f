//! Presets keep their formulas and rules; rules have one answer at ties; remedies remedy.

use rockproof_model::{
    Block, Criteria, Number, Precision, Preset, Rule, SpecError, ToleranceSet, ToleranceSpec, Vec3, preset,
    tolerance_rules,
};

fn number(text: &str) -> Number {
    Number::parse(text).unwrap()
}

fn cuboid(min: [&str; 3], max: [&str; 3]) -> Block {
    let point = |[x, y, z]: [&str; 3]| Vec3::new(number(x), number(y), number(z));
    Block::cuboid(&point(min), &point(max)).unwrap()
}

/// Two boxes: edges from 1 to 8, the model 8 × 4 × 4, coordinates up to 8.
fn pair() -> [Block; 2] {
    [cuboid(["0", "0", "0"], ["8", "4", "2"]), cuboid(["0", "0", "2"], ["1", "4", "4"])]
}

/// A set that meets every rule for `pair` in both precisions, under both criteria.
fn fair() -> ToleranceSet {
    let mut spec = ToleranceSpec::empty();
    for assignment in [
        "search=1/8",
        "territory=1/8",
        "penetration=1/16",
        "overlap_sine=1/256",
        "parallel_sine=1/128",
        "equal=0",
        "open=0",
        "close=0",
        "max_displacement=1/16",
        "max_rotation=1/16",
        "criteria=classic",
    ] {
        spec.assign(assignment).unwrap();
    }
    spec.resolve(&[], Precision::F32).unwrap()
}

fn violated(set: &ToleranceSet, precision: Precision) -> Vec<Rule> {
    let [a, b] = pair();
    tolerance_rules::check(set, &[&a, &b], precision).iter().map(|v| v.rule).collect()
}

/// The set with one tolerance changed.
fn with(name: &str, value: &str) -> ToleranceSet {
    let mut set = fair();
    for (n, slot) in set.numbers_mut() {
        if n == name {
            *slot = number(value);
        }
    }
    set
}

#[test]
fn every_rule_has_one_answer_at_its_tie() {
    assert_eq!(violated(&fair(), Precision::F32), []);
    let tiny = "1/1000000000000000000000";
    let above = |base: &str| number(base).plus(&number(tiny)).to_string();
    let below = |base: &str| number(base).plus(&number(tiny).negated()).to_string();

    // search = 2·max_displacement in the fair set.
    assert_eq!(violated(&with("search", &below("1/8")), Precision::F32), [Rule::Search, Rule::TerritoryInSearch]);
    assert_eq!(violated(&with("penetration", &below("1/16")), Precision::F32), [Rule::Penetration]);
    assert_eq!(violated(&with("territory", &above("1/8")), Precision::F32), [Rule::TerritoryInSearch]);

    // The shortest edge is 1: a quarter of it.
    let mut set = with("territory", "1/4");
    set.search = number("1");
    assert_eq!(violated(&set, Precision::F32), []);
    set.territory = number(&above("1/4"));
    assert_eq!(violated(&set, Precision::F32), [Rule::TerritoryOnEdge]);
    let mut set = with("max_displacement", "1/4");
    set.search = number("1");
    set.penetration = number("1/4");
    assert_eq!(violated(&set, Precision::F32), []);
    set.max_displacement = number(&above("1/4"));
    assert_eq!(violated(&set, Precision::F32), [Rule::Penetration, Rule::Displacement]);

    // 2⁸·2⁻²³·8 = 2⁻¹²; the classic rule on parallel edges gives way.
    let mut set = with("territory", "1/4096");
    set.criteria = Criteria::Revised;
    assert_eq!(violated(&set, Precision::F32), []);
    set.territory = number(&below("1/4096"));
    assert_eq!(violated(&set, Precision::F32), [Rule::TerritoryResolved]);
    assert_eq!(violated(&set, Precision::F64), []);

    // sines: the longest edge is 8.
    assert_eq!(violated(&with("parallel_sine", "1/64"), Precision::F32), []);
    assert_eq!(violated(&with("parallel_sine", &above("1/64")), Precision::F32), [Rule::ParallelEdges]);
    assert_eq!(violated(&with("overlap_sine", "1/128"), Precision::F32), []);
    assert_eq!(violated(&with("overlap_sine", &above("1/128")), Precision::F32), [Rule::Overlap]);
    let mut set = with("overlap_sine", "1");
    set.criteria = Criteria::Revised;
    assert_eq!(violated(&set, Precision::F32), []);
}

#[test]
fn the_rotation_rule_is_exact_where_the_radius_is_irrational() {
    // A box of 2 × 2 × 2 has R = √3; ω²·√3 ≤ 2g holds for ω² = 2g/√3 rounded down, not up.
    let block = cuboid(["0", "0", "0"], ["2", "2", "2"]);
    let check = |rotation: f64| {
        let mut set = fair();
        set.max_rotation = Number::from_f64(rotation).unwrap();
        tolerance_rules::check(&set, &[&block], Precision::F64).iter().any(|v| v.rule == Rule::Rotation)
    };
    let limit = (2.0 / 16.0 / 3.0_f64.sqrt()).sqrt();
    assert!(!check(limit * (1.0 - 1e-15)));
    assert!(check(limit * (1.0 + 1e-15)));
    // R = 3 exactly for 2 × 4 × 4: ω² = 2g/3 is met by ω = 1/4 when g = 3/32.
    let block = cuboid(["-1", "-2", "0"], ["1", "2", "4"]);
    let mut set = fair();
    (set.max_rotation, set.penetration) = (number("1/4"), number("3/32"));
    assert!(tolerance_rules::check(&set, &[&block], Precision::F64).is_empty());
    set.penetration = number("9374999999999999/100000000000000000");
    let violations = tolerance_rules::check(&set, &[&block], Precision::F64);
    assert_eq!(violations.iter().map(|v| v.rule).collect::<Vec<_>>(), [Rule::Rotation]);
}

#[test]
fn what_a_remedy_says_satisfies_the_rule() {
    let [a, b] = pair();
    let mut set = fair();
    for (name, value) in set.numbers_mut() {
        *value = number(match name {
            "search" => "1/3",
            "territory" => "3/7",
            "penetration" => "1/9",
            "max_displacement" => "2/7",
            "overlap_sine" | "parallel_sine" => "1/3",
            _ => "9/7",
        });
    }
    let violations = tolerance_rules::check(&set, &[&a, &b], Precision::F32);
    assert_eq!(violations.len(), 8, "{violations:?}");
    for violation in violations {
        for remedy in violation.remedy.split(" or ") {
            let mut words = remedy.split(' ');
            let (name, value) = (words.next().unwrap(), words.nth(1).unwrap());
            let mut better = set.clone();
            for (n, slot) in better.numbers_mut() {
                if n == name {
                    *slot = number(value);
                }
            }
            assert_ne!(better, set, "{remedy}");
            let left = tolerance_rules::check(&better, &[&a, &b], Precision::F32);
            assert!(left.iter().all(|v| v.rule != violation.rule), "{remedy}: {left:?}");
        }
    }
}

#[test]
fn auto_follows_its_formulas() {
    let [a, b] = pair();
    let set = preset::derive_checked(Preset::Auto, &[&a, &b], Precision::F64).unwrap();
    let value = |n: &Number| n.as_f64().unwrap();
    // ℓ = 1, H = 4: u = min(1/16, 4/100).
    assert_eq!(value(&set.max_displacement), 0.04);
    assert_eq!(value(&set.search), 0.1);
    assert_eq!(value(&set.penetration), 0.04);
    assert_eq!(value(&set.territory), 0.025);
    assert_eq!(value(&set.equal), 1024.0 * f64::EPSILON);
    assert_eq!(value(&set.open), 4096.0 * f64::EPSILON);
    assert_eq!(set.open, set.close);
    assert_eq!(value(&set.overlap_sine), 0.052335956242943835);
    assert_eq!(set.criteria, Criteria::Revised);
    // R = √(16 + 4 + 1).
    let limit = (0.08 / 21.0_f64.sqrt()).sqrt();
    assert!(value(&set.max_rotation) < limit && value(&set.max_rotation) > limit * (1.0 - 1e-5));
}

#[test]
fn shi_and_zero_follow_their_formulas() {
    let [a, b] = pair();
    let shi = preset::derive(Preset::Shi, &[&a, &b], Precision::F64).unwrap();
    let value = |n: &Number| n.as_f64().unwrap();
    // w0 = 2.
    assert_eq!(value(&shi.max_displacement), 0.02);
    assert_eq!((value(&shi.search), value(&shi.territory)), (0.05, 0.05));
    assert_eq!(value(&shi.penetration), 0.3 * 0.05);
    assert_eq!((value(&shi.close), value(&shi.open)), (4e-4, 4e-7));
    assert!(shi.equal.is_zero());
    assert_eq!(shi.criteria, Criteria::Classic);
    let zero = preset::derive(Preset::Zero, &[&a, &b], Precision::F64).unwrap();
    let auto = preset::derive(Preset::Auto, &[&a, &b], Precision::F64).unwrap();
    assert_eq!(zero, auto.ideal());
}

#[test]
fn auto_fails_where_a_rule_cannot_be_met() {
    let far = cuboid(["1e6", "0", "0"], ["1000001", "1", "1"]);
    assert!(preset::derive_checked(Preset::Auto, &[&far], Precision::F64).is_ok());
    let error = preset::derive_checked(Preset::Auto, &[&far], Precision::F32).unwrap_err();
    assert!(error.to_string().contains("territory ≥ 2⁸·eps·(largest coordinate)"), "{error}");
    assert!(preset::derive(Preset::Auto, &[&far], Precision::F32).is_ok());
    assert!(ToleranceSpec::default().resolve(&[&far], Precision::F32).is_err());
    assert!(preset::derive(Preset::Shi, &[], Precision::F64).is_err());
}

#[test]
fn lengths_survive_cancellation() {
    // Thirds a hair apart, far from the origin: f64 sees no length at all.
    let block = cuboid(
        ["1000000000/3", "0", "0"],
        ["1000000000000000000000000001/3000000000000000000", "1/1000000000000000000", "1/1000000000000000000"],
    );
    let set = preset::derive(Preset::Auto, &[&block], Precision::F64).unwrap();
    let displacement = set.max_displacement.as_f64().unwrap();
    assert!((displacement - 5e-21).abs() < 1e-26, "{displacement:e}");
    // A sliver whose volume cancels in f64 has its radius from the exact centroid.
    let violations = tolerance_rules::check(&set, &[&block], Precision::F64);
    assert!(violations.iter().all(|v| v.rule == Rule::TerritoryResolved), "{violations:?}");
}

#[test]
fn specs_say_what_is_wrong() {
    let assign = |text: &str| ToleranceSpec::empty().assign(text).unwrap_err().to_string();
    for (text, part) in [
        ("search", "NAME=VALUE"),
        ("serach=1", "unknown tolerance `serach`; known are preset, search"),
        ("search=", "\"\" is not a number"),
        ("search=1e9999", "exponent"),
        ("search=1e400", "overflows"),
        ("search=-1", "allowed is 0 or more"),
        ("overlap_sine=2", "allowed is 0 to 1"),
        ("parallel_angle=91", "0 to 90 degrees"),
        ("criteria=new", "\"classic\" or \"revised\""),
        ("preset=best", "\"auto\", \"shi\" or \"zero\""),
    ] {
        assert!(assign(text).contains(part), "{text}: {}", assign(text));
    }
    let mut spec = ToleranceSpec::empty();
    spec.assign("search=1").unwrap();
    match spec.resolve(&[], Precision::F64).unwrap_err() {
        SpecError::Missing { missing } => assert_eq!(missing.len(), 10),
        other => panic!("{other}"),
    }
}

#[test]
fn later_values_replace_earlier_ones_and_angles_are_sines() {
    let [a, b] = pair();
    let mut spec = ToleranceSpec::from(Preset::Auto);
    for text in ["overlap_angle=3", "overlap_sine=1/20", "parallel_sine=1/20", "parallel_angle=90", "search = 0.1"] {
        spec.assign(text).unwrap();
    }
    let set = spec.resolve(&[&a, &b], Precision::F64).unwrap();
    assert_eq!(set.overlap_sine, number("1/20"));
    assert_eq!(set.parallel_sine, number("1"));
    assert_eq!(set.search, number("1/10"));
    assert_ne!(set.search, Number::from_f64(0.1).unwrap());
    assert_eq!(ToleranceSpec::from(set.clone()).resolve(&[], Precision::F64).unwrap(), set);
}
