//! The rules between tolerances (docs/spec.md, section 3) in fractions, beside and on their boundaries, and that on weight and stiffness (D11).

use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use proptest::prelude::*;
use rockproof_model::scene::SceneFormat;
use rockproof_model::tolerance_rules::{check, check_scene};
use rockproof_model::{
    Block, BlockOptions, Criteria, Number, Precision, Rule, Scene, ToleranceSet, ToleranceSpec, Vec3,
};
use std::path::Path;

fn fraction(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

fn squared(x: &BigRational) -> BigRational {
    x * x
}

/// A solid of whole coordinates: a box, or a tetrahedron with its corner at the same place.
#[derive(Clone, Copy, Debug)]
struct Solid {
    begin: [i64; 3],
    sides: [i64; 3],
    is_box: bool,
}

impl Solid {
    fn corners(self) -> Vec<[i64; 3]> {
        let at = |steps: [i64; 3]| [0, 1, 2].map(|k| self.begin[k] + steps[k] * self.sides[k]);
        let floor = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
        let roof = floor.map(|[x, y, _]| [x, y, 1]);
        match self.is_box {
            true => floor.into_iter().chain(roof).map(at).collect(),
            false => [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(at).into(),
        }
    }

    /// Pairs of corners that an edge joins: of a box those that differ along one axis, of a tetrahedron all.
    fn squared_edges(self) -> Vec<i64> {
        let corners = self.corners();
        let pairs = corners.iter().flat_map(|p| corners.iter().map(move |q| [0, 1, 2].map(|k| p[k] - q[k])));
        let wanted = |d: &[i64; 3]| match d.iter().filter(|c| **c != 0).count() {
            0 => false,
            1 => true,
            _ => !self.is_box,
        };
        pairs.filter(wanted).map(|d| d.iter().map(|c| c * c).sum()).collect()
    }

    /// The square of the largest distance of a corner from the centroid, which is the mean of the corners of both kinds.
    fn squared_radius(self) -> BigRational {
        let corners = self.corners();
        let n = corners.len() as i64;
        let mean = [0, 1, 2].map(|k| fraction(corners.iter().map(|c| c[k]).sum(), n));
        let off = |c: &[i64; 3]| (0..3).map(|k| squared(&(fraction(c[k], 1) - &mean[k]))).sum::<BigRational>();
        corners.iter().map(off).max().expect("corners")
    }

    fn block(self) -> Block {
        let number = |n: i64| Number::from_rational(fraction(n, 1));
        let vertices = self.corners().into_iter().map(|[x, y, z]| Vec3::new(number(x), number(y), number(z))).collect();
        let faces: Vec<Vec<u32>> = match self.is_box {
            true => [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
                .map(Vec::from)
                .into(),
            false => [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(Vec::from).into(),
        };
        Block::new(vertices, faces, &BlockOptions::default()).expect("a block")
    }
}

fn solid() -> impl Strategy<Value = Solid> {
    let sides = prop::array::uniform3(1_i64..40);
    (prop::array::uniform3(-60_i64..60), sides, any::<bool>()).prop_map(|(begin, sides, is_box)| Solid {
        begin,
        sides,
        is_box,
    })
}

/// What the rules compare: u, s, r, g, ω, so and sp.
#[derive(Clone, Debug)]
struct Values {
    u: BigRational,
    s: BigRational,
    r: BigRational,
    g: BigRational,
    w: BigRational,
    so: BigRational,
    sp: BigRational,
}

impl Values {
    fn set(&self, criteria: Criteria) -> ToleranceSet {
        let number = |x: &BigRational| Number::from_rational(x.clone());
        ToleranceSet {
            search: number(&self.s),
            territory: number(&self.r),
            penetration: number(&self.g),
            overlap_sine: number(&self.so),
            parallel_sine: number(&self.sp),
            max_displacement: number(&self.u),
            max_rotation: number(&self.w),
            criteria,
            ..ToleranceSet::ZERO
        }
    }
}

/// The table of section 3, row by row, with both sides squared where one is a root.
fn broken(v: &Values, solids: &[Solid], precision: Precision, criteria: Criteria) -> Vec<Rule> {
    let edges: Vec<i64> = solids.iter().flat_map(|s| s.squared_edges()).collect();
    let shortest = fraction(*edges.iter().min().expect("an edge"), 1);
    let longest = fraction(*edges.iter().max().expect("an edge"), 1);
    let largest = solids.iter().flat_map(|s| s.corners()).flatten().map(i64::abs).max().expect("a corner");
    let radius = solids.iter().map(|s| s.squared_radius()).max().expect("a block");
    let eps = match precision {
        Precision::F32 => fraction(1, 1 << 23),
        Precision::F64 => fraction(1, 1 << 52),
    };
    let two = fraction(2, 1);
    let quarter_edge = |x: &BigRational| squared(x) * fraction(16, 1) <= shortest;
    let classic = criteria == Criteria::Classic;
    let rows = [
        (Rule::Search, v.s >= &v.u * &two),
        (Rule::Penetration, v.g >= v.u),
        (Rule::TerritoryInSearch, v.r <= v.s),
        (Rule::TerritoryOnEdge, quarter_edge(&v.r)),
        (Rule::Displacement, quarter_edge(&v.u)),
        (Rule::TerritoryResolved, v.r >= eps * fraction(256 * largest, 1)),
        (Rule::Rotation, squared(&squared(&v.w)) * radius <= squared(&(&v.g * &two))),
        (Rule::ParallelEdges, !classic || squared(&v.sp) * &longest <= squared(&v.r)),
        (Rule::Overlap, !classic || squared(&v.so) * &longest <= squared(&v.g)),
    ];
    let mut found: Vec<Rule> = rows.into_iter().filter(|(_, met)| !met).map(|(rule, _)| rule).collect();
    found.sort();
    found
}

/// A root, rounded to f64: exact where it can be, else beside the boundary, on either side of it.
fn root(x: &BigRational) -> BigRational {
    let near = Number::from_rational(x.clone()).approximate().sqrt();
    Number::from_f64(near).expect("a finite root").to_rational()
}

/// By how much a value is off its boundary: nothing, or a little to either side.
fn beside() -> impl Strategy<Value = BigRational> {
    prop::sample::select(vec![-2_i64, -1, 0, 0, 0, 1, 2]).prop_map(|k| BigRational::one() + fraction(k, 1 << 60))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 60 } else { 600 }))]

    /// Which rules are broken, where each is met exactly or missed by a little.
    #[test]
    fn the_rules_are_those_of_the_table(
        solids in prop::collection::vec(solid(), 1..4),
        off in prop::collection::vec(beside(), 7),
        choice in prop::array::uniform4(0_usize..3),
        single: bool, classic: bool,
    ) {
        let (precision, eps) = match single {
            true => (Precision::F32, fraction(1, 1 << 23)),
            false => (Precision::F64, fraction(1, 1 << 52)),
        };
        let criteria = if classic { Criteria::Classic } else { Criteria::Revised };
        let edges: Vec<i64> = solids.iter().flat_map(|s| s.squared_edges()).collect();
        let [shortest, longest] = [edges.iter().min(), edges.iter().max()].map(|e| root(&fraction(*e.expect("an edge"), 1)));
        let largest = solids.iter().flat_map(|s| s.corners()).flatten().map(i64::abs).max().expect("a corner");
        let quarter = &shortest / fraction(4, 1);
        let u = [quarter.clone(), fraction(1, 64), fraction(1, 3)][choice[0]].clone() * &off[0];
        let s = [&u * fraction(2, 1), fraction(5, 1), quarter.clone()][choice[1]].clone() * &off[1];
        let r = [s.clone(), quarter, eps * fraction(256 * largest, 1)][choice[2]].clone() * &off[2];
        let g = [u.clone(), u.clone(), fraction(3, 32)][choice[3]].clone() * &off[3];
        let radius = solids.iter().map(|s| s.squared_radius()).max().expect("a block");
        let w = root(&(&g * fraction(2, 1) / root(&radius))) * &off[4];
        let so = &g / &longest * &off[5];
        let sp = &r / &longest * &off[6];
        let values = Values { u, s, r, g, w, so, sp };
        let blocks: Vec<Block> = solids.iter().map(|s| s.block()).collect();
        let shapes: Vec<&Block> = blocks.iter().collect();
        let mut found: Vec<Rule> = check(&values.set(criteria), &shapes, precision).iter().map(|v| v.rule).collect();
        found.sort();
        prop_assert_eq!(found, broken(&values, &solids, precision, criteria), "{:?}", values);
    }
}

/// The block, and the ends of the edge, that a violation names, for a box of 4 × 5 × 6 beside one of 2 × 7 × 30 whose least edge is 2.
#[test]
fn a_violation_names_the_deciding_block_and_edge() {
    let solids = [
        Solid { begin: [0, 0, 0], sides: [4, 5, 6], is_box: true },
        Solid { begin: [10, 0, 0], sides: [2, 7, 30], is_box: true },
    ];
    let number = |n: i64, d: i64| fraction(n, d);
    // ℓ/4 is 1/2, L is 30.
    let values = Values {
        u: number(3, 5),
        s: number(2, 1),
        r: number(3, 5),
        g: number(3, 5),
        w: BigRational::one(),
        so: number(1, 10),
        sp: number(1, 10),
    };
    let blocks = solids.map(Solid::block);
    let found = check(&values.set(Criteria::Classic), &[&blocks[0], &blocks[1]], Precision::F64);
    let place = |rule: Rule| {
        let place = found.iter().find(|v| v.rule == rule).and_then(|v| v.place);
        place.map(|p| (p.block, p.edge.map(|(p, q)| [p.0, q.0])))
    };
    // The edges by the sorted pair of their ends: 0-1 is the first along x, 0-4 the first along z.
    assert_eq!(place(Rule::TerritoryOnEdge), Some((1, Some([0, 1]))));
    assert_eq!(place(Rule::Displacement), Some((1, Some([0, 1]))));
    assert_eq!(place(Rule::ParallelEdges), Some((1, Some([0, 4]))));
    assert_eq!(place(Rule::Overlap), Some((1, Some([0, 4]))));
    assert_eq!(place(Rule::Rotation).map(|(block, _)| block), Some(1));
    let sides = |rule: Rule| found.iter().find(|v| v.rule == rule).map(|v| (v.found, v.allowed));
    assert_eq!(sides(Rule::TerritoryOnEdge), Some((0.6, 0.5)));
    assert_eq!(sides(Rule::ParallelEdges), Some((3.0, 0.6)));
}

/// A prism on a right triangle with legs 3 and 4, of a height, over a fixed cube of another joint material; beside them, if asked for, a third block.
fn prism_on_a_cube(height: &str, more: &str) -> String {
    format!(
        "[simulation]\ngravity = [2, -3, \"-6\"]\n\
         [[material]]\nname = \"light\"\ndensity = 5\n[[material]]\nname = \"heavy\"\ndensity = 10\n\
         [[joint]]\nbetween = [\"rough\", \"smooth\"]\nnormal_stiffness = 700\n\
         [[joint]]\nbetween = [\"rough\", \"rough\"]\nnormal_stiffness = 70\n\
         [[joint]]\nnormal_stiffness = 7\n\
         [[block]]\nname = \"cube\"\nfixed = true\njoint = \"smooth\"\nbox = {{ min = [0, 0, -50], max = [50, 50, 0] }}\n\
         [[block]]\nname = \"prism\"\nmaterial = \"heavy\"\njoint = \"rough\"\n\
         vertices = [[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, \"{height}\"], [3, 0, \"{height}\"], [0, 4, \"{height}\"]]\n\
         faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]\n{more}"
    )
}

const FAR: &str = "[[block]]\nname = \"far\"\nmaterial = \"light\"\nbox = { min = [20, 20, 20], max = [22, 22, 22] }\n";

/// W/(p·n) by hand, with |g| = 7 m/s² and 10 kg/m³: the prism has 6 m² and 6h m³, so W = 420h. Its faces are two triangles of 6 m² and three
/// rectangles of 3h, 4h and 5h: the smallest one has 4 corners where h < 2, else 3; at h = 2 both are smallest, and the fewest count.
/// The joint materials are `rough` and `smooth`: p = 700 between them, and 7 with a second `rough` block where no table says otherwise.
const WEIGHTS: [(&str, &str, &str, &str); 7] = [
    ("h = 1: 420/(700·4)", "1", "", "3/20"),
    ("h = 2: 840/(700·3)", "2", "", "2/5"),
    ("h = 3: 1260/(700·3)", "3", "", "3/5"),
    // A second block of `rough`: 70 is the softest that the prism can meet. It weighs 280 N on 4 corners of 70, or 1 m; the prism 1.5 m.
    ("a rough cube beside it: 420/(70·4)", "1", "joint = \"rough\"\n", "3/2"),
    // The prism of h = 1/10 weighs 42 N: 42/(70·4) = 3/20 m, less than the cube's 280/(70·4) = 1 m.
    ("a heavier cube: 280/(70·4)", "1/10", "joint = \"rough\"\n", "1"),
    // A smooth cube meets the fixed cube too, and for smooth on smooth the table without names holds: 280/(7·4) = 10 m.
    ("smooth on smooth: 280/(7·4)", "1", "joint = \"smooth\"\n", "10"),
    // A fixed one does not sink, but can be met.
    ("a fixed rough cube: 420/(70·4)", "1", "joint = \"rough\"\nfixed = true\n", "3/2"),
];

#[test]
fn weight_over_stiffness_and_corners_must_not_exceed_penetration() {
    for (name, height, far, depth) in WEIGHTS {
        let far = if far.is_empty() { String::new() } else { format!("{FAR}{far}") };
        let scene = Scene::parse(&prism_on_a_cube(height, &far), SceneFormat::Toml, Path::new("a.toml")).expect(name);
        let mut set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("a set");
        let depth = Number::parse(depth).expect("a number").to_rational();
        for (off, met) in [(0, true), (1, true), (-1, false)] {
            let beside = &depth * (BigRational::one() + fraction(off, 1 << 62));
            assert!(beside.is_positive() && !depth.is_zero());
            set.penetration = Number::from_rational(beside);
            let all = check_scene(&set, &scene, Precision::F64);
            assert_eq!(all.iter().all(|v| v.rule != Rule::Stiffness), met, "{name}, off by {off}");
        }
    }
}

/// What weighs nothing, or has nothing to meet, breaks no rule; nor do joints without a stiffness, which get one that suffices.
#[test]
fn what_cannot_rest_on_anything_has_no_rule_on_weight() {
    let prism = prism_on_a_cube("3", "");
    let lone = format!(
        "[[joint]]\nnormal_stiffness = \"1e-30\"\n{}",
        "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n"
    );
    for (name, text, met) in [
        ("as it is", prism.clone(), false),
        ("no gravity", prism.replace("[2, -3, \"-6\"]", "[0, 0, 0]"), true),
        ("all fixed", prism.replace("name = \"prism\"", "fixed = true"), true),
        ("alone", lone.clone(), true),
        ("two", lone.replace("[[block]]", "[[block]]\nbox = { min = [5, 0, 0], max = [6, 1, 1] }\n[[block]]"), false),
        ("derived", prism.replace("normal_stiffness = ", "cohesion = "), true),
    ] {
        let scene = Scene::parse(&text, SceneFormat::Toml, Path::new("a.toml")).expect(name);
        let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("a set");
        let all = check_scene(&set, &scene, Precision::F64);
        assert_eq!(all.iter().all(|v| v.rule != Rule::Stiffness), met, "{name}");
    }
}
