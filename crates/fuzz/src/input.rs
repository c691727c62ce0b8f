//! Bytes as blocks, tolerances and scenes: coordinates on a grid, so that features tie; some of them off it by one last place; exponents up to the
//! ends of f64.

use arbitrary::{Result, Unstructured};
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_differential::hull::convex_hull;
use rockproof_model::block::face_normal;
use rockproof_model::simulation::{Kinematics, Unconverged};
use rockproof_model::topology::Edge;
use rockproof_model::{
    Block, BlockOptions, Body, Criteria, FaceId, Motion, Number, Point, Precision, Scene, SceneBlock, Simulation,
    ToleranceSet, ToleranceSpec, Vec3, VertexId,
};
use rockproof_pairs::shapes::catalogue;
use rockproof_pairs::shapes::rotation::cube_turn;

/// Grid lines a metre.
const GRID: i64 = 8;
/// Blocks of more vertices are left out: the comparison in fractions would take too long.
const MAX_VERTICES: usize = 12;
/// Exponents of the unit of length; the first is the usual one.
const EXPONENTS: [i32; 12] = [0, 0, 0, 0, 0, -3, 20, -20, 300, -300, 900, -1000];

/// Two blocks and the tolerances for them.
#[derive(Clone, Debug)]
pub struct PairInput {
    /// The first block.
    pub a: Block,
    /// The second block.
    pub b: Block,
    /// The tolerances.
    pub tolerances: ToleranceSet,
}

/// What makes numbers of whole units.
#[derive(Clone, Copy, Debug)]
struct Unit {
    exponent: i32,
    /// Thirds instead of eighths, which no float holds.
    thirds: bool,
}

impl Unit {
    fn any(u: &mut Unstructured<'_>) -> Result<Unit> {
        Ok(Unit { exponent: *u.choose(&EXPONENTS)?, thirds: u.ratio(1, 12)? })
    }

    fn number(self, units: i64) -> Number {
        let scaled = Number::from_f64(units as f64 * 2_f64.powi(self.exponent.max(-1000)) / GRID as f64);
        let number = scaled.unwrap_or(Number::ZERO);
        match self.thirds {
            true => number.times(&Number::parse("8/3").unwrap_or(Number::ZERO)),
            false => number,
        }
    }

    fn point(self, units: [i64; 3]) -> Point {
        let [x, y, z] = units.map(|n| self.number(n));
        Vec3::new(x, y, z)
    }
}

/// The f64 beside a number that is one.
fn beside(number: &Number, up: bool) -> Number {
    let near = number.as_f64().map(|value| if up { value.next_up() } else { value.next_down() });
    near.and_then(|value| Number::from_f64(value).ok()).unwrap_or_else(|| number.clone())
}

/// A block on the grid.
struct Shape {
    /// In whole units.
    vertices: Vec<[i64; 3]>,
    faces: Vec<Vec<VertexId>>,
}

/// A shape; `None` where the bytes say none.
fn shape(u: &mut Unstructured<'_>) -> Result<Option<Shape>> {
    let on_grid = |block: &Block| {
        let units = |n: &Number| n.approximate() as i64;
        let vertices = block.vertices().iter().map(|v| [units(&v.x), units(&v.y), units(&v.z)]).collect();
        Shape { vertices, faces: block.topology().faces().to_vec() }
    };
    let between = |u: &mut Unstructured<'_>, low: i32, high: i32| Ok(Number::from_integer(u.int_in_range(low..=high)?));
    let found = match u.int_in_range(0..=3)? {
        0 => {
            let mut points = Vec::new();
            for _ in 0..u.int_in_range(4..=6)? {
                points.push(Vec3::new(between(u, -8, 8)?, between(u, -8, 8)?, between(u, -8, 8)?));
            }
            convex_hull(&points).ok().map(|block| on_grid(&block))
        }
        1 => {
            let low = Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO);
            let high = Vec3::new(between(u, 1, 8)?, between(u, 1, 8)?, between(u, 1, 8)?);
            Block::cuboid(&low, &high).ok().map(|block| on_grid(&block))
        }
        2 => Some(on_grid(u.choose(catalogue::convex())?.solid.shape())),
        _ => Some(on_grid(u.choose(catalogue::concave())?.solid.shape())),
    };
    Ok(found.filter(|shape| shape.vertices.len() <= MAX_VERTICES))
}

/// A block turned onto the grid and moved; now and then one coordinate is one last place off.
fn block(u: &mut Unstructured<'_>, unit: Unit, most: i64) -> Result<Option<Block>> {
    let Some(Shape { vertices, faces }) = shape(u)? else { return Ok(None) };
    let turn = cube_turn(u.int_in_range(0..=23)?);
    let offset = [u.int_in_range(-most..=most)?, u.int_in_range(-most..=most)?, u.int_in_range(-most..=most)?];
    let moved = |v: &[i64; 3]| {
        let turned = turn.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
        unit.point([0, 1, 2].map(|axis| turned[axis] + offset[axis]))
    };
    let mut points: Vec<Point> = vertices.iter().map(moved).collect();
    if u.ratio(1, 4)? {
        let (vertex, axis, up) = (u.choose_index(points.len())?, u.int_in_range(0..=2)?, u.arbitrary()?);
        let point = &mut points[vertex];
        let place = [&mut point.x, &mut point.y, &mut point.z].into_iter().nth(axis);
        place.into_iter().for_each(|place| *place = beside(place, up));
    }
    Ok(Block::new(points, faces, &BlockOptions::default()).ok())
}

/// A tolerance on the grid, or one last place beside it.
fn length(u: &mut Unstructured<'_>, unit: Unit) -> Result<Number> {
    let number = unit.number(*u.choose(&[0, 0, 1, 2, 3, 4, 8, 16])?);
    Ok(if u.ratio(1, 6)? && !number.is_zero() { beside(&number, u.arbitrary()?) } else { number })
}

fn sine(u: &mut Unstructured<'_>) -> Result<Number> {
    let values = ["0", "0", "1/1024", "1/16", "3/5", "4/5", "1/2", "1"];
    Ok(Number::parse(u.choose(&values)?).unwrap_or(Number::ZERO))
}

fn tolerances(u: &mut Unstructured<'_>, unit: Unit) -> Result<ToleranceSet> {
    let criteria = if u.arbitrary()? { Criteria::Revised } else { Criteria::Classic };
    let equal = Number::parse(u.choose(&["0", "1e-12", "1/8"])?).unwrap_or(Number::ZERO);
    Ok(ToleranceSet {
        search: unit.number(*u.choose(&[8, 1, 2, 4, 16, 0])?),
        territory: length(u, unit)?,
        penetration: unit.number(*u.choose(&[16, 0, 1, 4, 8])?),
        overlap_sine: sine(u)?,
        parallel_sine: sine(u)?,
        equal,
        open: length(u, unit)?,
        close: length(u, unit)?,
        max_displacement: unit.number(8),
        max_rotation: Number::from_integer(1),
        criteria,
    })
}

impl PairInput {
    /// The pair that bytes say; `None` where they say none.
    pub fn of(bytes: &[u8]) -> Option<PairInput> {
        decode_pair(&mut Unstructured::new(bytes)).ok().flatten()
    }
}

fn decode_pair(u: &mut Unstructured<'_>) -> Result<Option<PairInput>> {
    let unit = Unit::any(u)?;
    let Some(a) = block(u, unit, 2)? else { return Ok(None) };
    let Some(b) = block(u, unit, 8)? else { return Ok(None) };
    let tolerances = tolerances(u, unit)?;
    // The last choice: it changes nothing of what comes before it, and where the bytes end it is 0.
    let b = if u.int_in_range(0..=TIP_ONCE_IN - 1)? == TIP_ONCE_IN - 1 { with_tip_below(u, unit, &a, b)? } else { b };
    Ok(Some(PairInput { a, b, tolerances }))
}

/// Once in so many pairs a tip of the second block is put below two faces of the first.
const TIP_ONCE_IN: u8 = 8;

/// The outward direction of a face that lies across an axis.
fn across_axis(block: &Block, face: FaceId) -> Option<[i64; 3]> {
    let points: Vec<Vec3<BigRational>> = block.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
    let sign = |n: BigRational| i64::from(n.is_positive()) - i64::from(n.is_negative());
    let Vec3 { x, y, z } = face_normal(&points, block.topology().face(face));
    let outward = [x, y, z].map(sign);
    (outward.iter().filter(|n| **n != 0).count() == 1).then_some(outward)
}

/// `b` moved so that the tip of it is equally deep below two faces of `a` that a convex edge joins: neither is the shorter exit.
fn with_tip_below(u: &mut Unstructured<'_>, unit: Unit, a: &Block, b: Block) -> Result<Block> {
    let inward = |edge: &Edge| {
        let (left, right) = (across_axis(a, edge.left)?, across_axis(a, edge.right)?);
        Some((edge.p, edge.q, [0, 1, 2].map(|axis| -left[axis] - right[axis])))
    };
    let convex = a.topology().edge_ids().filter(|edge| a.edge_is_convex(*edge));
    let edges: Vec<_> = convex.filter_map(|edge| inward(a.topology().edge(edge))).collect();
    if edges.is_empty() {
        return Ok(b);
    }
    let (p, q, inward) = u.choose(&edges)?;
    let depth = u.int_in_range(1..=4)?;
    let ahead = |v: &Point| (0..3).map(|axis| v.components()[axis].approximate() * inward[axis] as f64).sum::<f64>();
    let Some(tip) = b.vertices().iter().max_by(|v, w| ahead(v).total_cmp(&ahead(w))) else { return Ok(b) };
    let half = Number::from_f64(0.5).unwrap_or(Number::ZERO);
    let offset = |axis: usize| {
        let [p, q] = [p, q].map(|v| a.vertices()[v.index()].components()[axis]);
        let place = p.plus(q).times(&half).plus(&unit.number(depth * inward[axis]));
        place.plus(&tip.components()[axis].negated())
    };
    Ok(b.translated(&Vec3::new(offset(0), offset(1), offset(2))))
}

/// A scene of a fixed slab and one or two blocks on it.
#[derive(Clone, Debug)]
pub(crate) struct SceneInput {
    pub(crate) scene: Scene,
    pub(crate) tolerances: ToleranceSet,
    pub(crate) steps: usize,
}

/// A number among those that a text says.
fn one_of(u: &mut Unstructured<'_>, texts: &[&str]) -> Result<Number> {
    Ok(Number::parse(u.choose(texts)?).unwrap_or(Number::ZERO))
}

fn vector(u: &mut Unstructured<'_>, texts: &[&str]) -> Result<Vec3<Number>> {
    Ok(Vec3::new(one_of(u, texts)?, one_of(u, texts)?, one_of(u, texts)?))
}

/// A block whose lowest vertex is at a height, on the grid in x and y.
fn block_at(u: &mut Unstructured<'_>, height: &Number) -> Result<Option<(Block, Number)>> {
    let unit = Unit { exponent: 0, thirds: false };
    let Some(block) = block(u, unit, 4)? else { return Ok(None) };
    let all =
        |pick: fn(f64, f64) -> f64, start: f64| block.vertices().iter().map(|v| v.z.approximate()).fold(start, pick);
    let (low, high) = (all(f64::min, f64::INFINITY), all(f64::max, f64::NEG_INFINITY));
    let (Ok(low), Ok(high)) = (Number::from_f64(low), Number::from_f64(high)) else { return Ok(None) };
    let up = height.plus(&low.negated());
    let moved = block.translated(&Vec3::new(Number::ZERO, Number::ZERO, up.clone()));
    Ok(Some((moved, high.plus(&up))))
}

fn body(u: &mut Unstructured<'_>) -> Result<Body> {
    let rates = ["0", "0", "0", "1/8", "-1", "3"];
    Ok(Body {
        motion: *u.choose(&[Motion::Rigid, Motion::Deformable])?,
        velocity: vector(u, &rates)?,
        spin: vector(u, &["0", "0", "0", "1/4"])?,
        ..Body::default()
    })
}

fn simulation(u: &mut Unstructured<'_>) -> Result<Simulation> {
    let mut simulation = Simulation { gravity: vector(u, &["0", "0", "-10", "-10", "6"])?, ..Simulation::default() };
    let control = &mut simulation.control;
    control.time_step = one_of(u, &["1/64", "1/1024", "1/8"])?;
    control.dynamic = one_of(u, &["1", "1", "0", "1/2"])?;
    control.damping = one_of(u, &["0", "0", "1"])?;
    control.settle = u32::from(u.ratio(1, 8)?);
    control.kinematics = *u.choose(&[Kinematics::Cayley, Kinematics::Linear])?;
    control.unconverged = *u.choose(&[Unconverged::Accept, Unconverged::Stop])?;
    let joint = &mut simulation.joints.other;
    joint.friction = one_of(u, &["0", "1/4", "1", "3/10"])?;
    joint.cohesion = one_of(u, &["0", "0", "1000"])?;
    joint.tension = one_of(u, &["0", "0", "1000"])?;
    joint.normal_stiffness = Some(one_of(u, &["1e8", "1e6", "134217728"])?);
    Ok(simulation)
}

impl SceneInput {
    /// The scene that bytes say; `None` where they say none.
    pub(crate) fn of(bytes: &[u8]) -> Option<SceneInput> {
        decode_scene(&mut Unstructured::new(bytes)).ok().flatten()
    }
}

fn decode_scene(u: &mut Unstructured<'_>) -> Result<Option<SceneInput>> {
    let corner = |x: i32, y: i32, z: i32| Vec3::new(x, y, z).map(|n: &i32| Number::from_integer(*n));
    let Ok(slab) = Block::cuboid(&corner(-4, -4, -1), &corner(4, 4, 0)) else { return Ok(None) };
    let mut scene = Scene::on_fixed("slab", slab);
    let gaps = ["0", "0", "-1/1000000", "1/1000000", "-1/1024", "1/64"];
    let mut height = one_of(u, &gaps)?;
    for number in 0..u.int_in_range(1..=2)? {
        let Some((block, top)) = block_at(u, &height)? else { return Ok(None) };
        let mut block = SceneBlock::new(format!("block {number}"), block);
        block.body = body(u)?;
        scene.blocks.push(block);
        height = top.plus(&one_of(u, &gaps)?);
    }
    scene.simulation = simulation(u)?;
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64);
    let Ok(tolerances) = set else { return Ok(None) };
    let mut input = SceneInput { scene, tolerances, steps: u.int_in_range(1..=2)? };
    // The last choice, as of pairs.
    if let Some(spoil) = SPOILT.get(u.int_in_range(0..=SPOILT_ONCE_IN * SPOILT.len() - 1)?) {
        spoil(u, &mut input)?;
    }
    Ok(Some(input))
}

/// Once in so many scenes there is something that no step can be made of.
const SPOILT_ONCE_IN: usize = 4;

/// Makes a scene one whose step fails, mostly.
type Spoil = fn(&mut Unstructured<'_>, &mut SceneInput) -> Result<()>;

/// What lets steps fail. Where bytes have ended the first is chosen, so it changes nothing.
const SPOILT: [Spoil; 6] = [
    |_, _| Ok(()),
    // Too fast for any Δt.
    |u, input| {
        let [moved, spun] = [["0", "-1e9", "1e12"], ["0", "1e9", "0"]];
        for block in &mut input.scene.blocks[1..] {
            (block.body.velocity, block.body.spin) = (vector(u, &moved)?, vector(u, &spun)?);
        }
        Ok(())
    },
    // Strains beyond -1, and no limit that stops them.
    |u, input| {
        (input.tolerances.max_displacement, input.tolerances.max_rotation) =
            (one_of(u, &["1e9"])?, one_of(u, &["1e9"])?);
        for block in &mut input.scene.blocks[1..] {
            block.body.motion = Motion::Deformable;
            block.body.stress[u.choose_index(6)?] = one_of(u, &["1e13", "1e15", "1e18"])?;
        }
        Ok(())
    },
    // A material without elasticity.
    |u, input| {
        input.scene.simulation.materials[0].poisson = one_of(u, &["1/2", "-1"])?;
        Ok(())
    },
    // Joints that say nothing of their stiffness.
    |_, input| {
        input.scene.simulation.joints.other.normal_stiffness = None;
        Ok(())
    },
    // Hard contacts that open and close by turns, however small Δt is.
    |u, input| {
        let simulation = &mut input.scene.simulation;
        (simulation.control.unconverged, simulation.control.time_step) = (Unconverged::Stop, one_of(u, &["1/20"])?);
        let joint = &mut simulation.joints.other;
        (joint.friction, joint.shear_ratio) = (one_of(u, &["1"])?, one_of(u, &["1"])?);
        joint.normal_stiffness = Some(one_of(u, &["1e13", "1e15", "1e11"])?);
        for block in &mut input.scene.blocks[1..] {
            block.body.velocity = vector(u, &["1", "-1", "0", "3"])?;
        }
        Ok(())
    },
];
