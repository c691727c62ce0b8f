//! How blocks press on one another along a direction, such as gravity or that of a load: of each block before another one the share of its plan that is over that one.

use super::shape::{Shape, largest, minus};
use super::stiffness::{blocks_by_joint, nearby_softest};
use crate::block::Block;
use crate::number::Number;
use crate::scene::Scene;
use crate::simulation::{Body, derive_stiffness_of, moving_blocks, smallest_face};
use crate::tolerance::ToleranceSet;
use std::cell::OnceCell;
use std::collections::BTreeMap;

/// A block as others press on it along a direction: its box along two directions across that one and against it, what it weighs and what it rests on.
pub(super) struct Column {
    /// Which block.
    pub(super) block: usize,
    low: [f64; 3],
    high: [f64; 3],
    /// The area of its plan (m²); of a block that is not convex no less.
    pub(super) area: f64,
    /// Along the direction (N); `None` of a fixed block, which bears what is above it.
    pub(super) weight: Option<f64>,
    /// What loads press it along the direction with (N), where they are counted; along gravity negative lifts it.
    pub(super) pushed: f64,
    /// The softest normal stiffness it can meet times the corners of its smallest face (N/m).
    pub(super) contacts: f64,
    /// The stiffness of its fixed points (N/m), if these hold it wherever it is pressed: if three of them are not in line.
    pub(super) held: f64,
}

impl Column {
    /// Its box along two directions across the direction and against that.
    pub(super) fn sides(&self) -> [[f64; 3]; 2] {
        [self.low, self.high]
    }

    pub(super) fn middle(&self) -> f64 {
        f64::midpoint(self.low[2], self.high[2])
    }

    /// The area in which the plans of two boxes overlap (m²).
    pub(super) fn shared(&self, other: &Column) -> f64 {
        let side = |axis: usize| (self.high[axis].min(other.high[axis]) - self.low[axis].max(other.low[axis])).max(0.0);
        side(0) * side(1)
    }

    /// What resists where it is pushed along the direction (N/m): springs beside one another.
    pub(super) fn resistance(&self) -> f64 {
        self.contacts + self.held
    }
}

/// What of a scene is the same along all directions.
pub(super) struct ColumnSource<'s> {
    scene: &'s Scene,
    /// Of each block its mass (kg), `None` of a fixed one.
    pub(super) masses: Vec<Option<f64>>,
    /// As in [`Column`].
    pub(super) contacts: Vec<f64>,
    /// The stiffness of its fixed points (N/m).
    pub(super) held: Vec<f64>,
    /// Whether three of its fixed points are not in line.
    is_clamped: Vec<bool>,
    shapes: OnceCell<Vec<Shape<'s>>>,
}

impl<'s> ColumnSource<'s> {
    pub(super) fn of(set: &ToleranceSet, scene: &'s Scene) -> ColumnSource<'s> {
        let mut simulation = scene.simulation.clone();
        let bodies: Vec<(&Block, &Body)> = scene.blocks.iter().map(|b| (&b.block, &b.body)).collect();
        let moving = moving_blocks(&bodies);
        derive_stiffness_of(&mut simulation, &moving, set);
        let joints = blocks_by_joint(&simulation, &scene.blocks);
        let softest = nearby_softest(&simulation, &joints);
        let mut masses = vec![None; scene.blocks.len()];
        for one in &moving {
            masses[one.number] = Some(simulation.materials[one.body.material].density.approximate() * one.volume);
        }
        let contacts = bodies.iter().map(|(block, body)| softest(body.joint) * smallest_face(block) as f64).collect();
        let stiffest = simulation.joints.all().filter_map(|joint| joint.normal_stiffness.as_ref()).max();
        let mut held = vec![0.0; scene.blocks.len()];
        for point in &simulation.fixed_points {
            held[point.block] += point.stiffness.as_ref().or(stiffest).map_or(0.0, Number::approximate);
        }
        let mut points: BTreeMap<usize, Vec<[f64; 3]>> = BTreeMap::new();
        for fixed in &simulation.fixed_points {
            points.entry(fixed.block).or_default().push(point(&fixed.at));
        }
        let is_clamped = (0..scene.blocks.len()).map(|block| points.get(&block).is_some_and(|all| !in_line(all)));
        ColumnSource { scene, masses, contacts, held, is_clamped: is_clamped.collect(), shapes: OnceCell::new() }
    }

    /// The blocks in f64.
    pub(super) fn shapes(&self) -> &[Shape<'s>] {
        self.shapes.get_or_init(|| self.scene.blocks.iter().map(|one| Shape::of(&one.block)).collect())
    }

    /// A block along a direction (a unit vector), without loads; `pull` (m/s²) is what weights pull along it with.
    pub(super) fn column(&self, block: usize, down: [f64; 3], pull: f64) -> Column {
        let shape = &self.shapes()[block];
        let [low, high] = box_along(shape.points.iter().copied(), across_and_against(down));
        // Only of a block that is not convex the faces may be seen to be more than the box.
        let area = shape.plan(down).min((high[0] - low[0]) * (high[1] - low[1]));
        let held = if self.is_clamped[block] { self.held[block] } else { 0.0 };
        let weight = self.masses[block].map(|mass| mass * pull);
        Column { block, low, high, area, weight, pushed: 0.0, contacts: self.contacts[block], held }
    }

    /// All blocks along gravity, without loads; `None` without gravity.
    pub(super) fn along_gravity(&self) -> Option<Vec<Column>> {
        let (down, pull) = gravity(self.scene)?;
        Some((0..self.masses.len()).map(|block| self.column(block, down, pull)).collect())
    }
}

/// Whether points are all in one line, but for rounding.
fn in_line(points: &[[f64; 3]]) -> bool {
    let arms = || points.iter().map(|at| minus(*at, points[0]));
    let Some((longest, square)) = largest(arms().map(|arm| (arm, dot(arm, arm)))) else { return true };
    let across = |arm: [f64; 3]| dot(arm, arm) - dot(arm, longest).powi(2) / square;
    // Nearer to the line than a ten-thousandth of its length is on it.
    !arms().any(|arm| across(arm) > 1e-8 * square)
}

/// The direction of gravity, and how much it is (m/s²); `None` without.
pub(super) fn gravity(scene: &Scene) -> Option<([f64; 3], f64)> {
    let gravity = scene.simulation.gravity.components().map(Number::approximate);
    let pull = dot(gravity, gravity).sqrt();
    (pull > 0.0 && pull.is_finite()).then(|| (gravity.map(|g| g / pull), pull))
}

/// All that blocks weigh and loads press along the direction (N).
pub(super) fn total(columns: &[Column]) -> f64 {
    columns.iter().filter_map(|one| Some(one.weight?.max(0.0) + one.pushed.max(0.0))).sum()
}

/// What a block bears with its own weight and its own loads (N).
pub(super) fn borne(columns: &[Column], plans: &Plans, one: &Column) -> f64 {
    carried(columns, plans, one) + one.pushed
}

/// A vertex in f64.
pub(super) fn point(vertex: &crate::block::Point) -> [f64; 3] {
    vertex.components().map(Number::approximate)
}

/// The box of points along three directions.
pub(super) fn box_along(points: impl Iterator<Item = [f64; 3]>, axes: [[f64; 3]; 3]) -> [[f64; 3]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for at in points {
        for (axis, direction) in axes.into_iter().enumerate() {
            let along = dot(at, direction);
            low[axis] = low[axis].min(along);
            high[axis] = high[axis].max(along);
        }
    }
    [low, high]
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Two directions across a unit vector, and the one against it.
pub(super) fn across_and_against(down: [f64; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = down;
    // The axis that it lies along least.
    let least = (0..3).min_by(|&i, &j| down[i].abs().total_cmp(&down[j].abs())).unwrap_or(0);
    let mut first = down.map(|d| -d * down[least]);
    first[least] += 1.0;
    let length = dot(first, first).sqrt();
    let [a, b, c] = first.map(|f| f / length);
    [[a, b, c], [y * c - z * b, z * a - x * c, x * b - y * a], [-x, -y, -z]]
}

/// The blocks by the squares of a grid across gravity that their plans meet.
pub(super) struct Plans {
    /// The side of a square (m): half of the blocks are no longer.
    side: f64,
    squares: BTreeMap<[i64; 2], Vec<usize>>,
    /// Blocks that meet more squares than are worth a list.
    pub(super) wide: Vec<usize>,
}

/// Squares that a plan may meet before it is in a list of its own.
const SQUARES: i64 = 64;

impl Plans {
    pub(super) fn of(columns: &[Column]) -> Plans {
        let mut sides: Vec<f64> =
            columns.iter().map(|one| (0..2).map(|k| one.high[k] - one.low[k]).fold(0.0, f64::max)).collect();
        sides.sort_by(f64::total_cmp);
        let side = sides.get(sides.len() / 2).copied().unwrap_or(1.0);
        let mut plans = Plans { side, squares: BTreeMap::new(), wide: Vec::new() };
        for (block, one) in columns.iter().enumerate() {
            match plans.squares_of(one) {
                None => plans.wide.push(block),
                Some(squares) => squares.for_each(|at| plans.squares.entry(at).or_default().push(block)),
            }
        }
        plans
    }

    /// `None` where there are too many.
    fn squares_of(&self, one: &Column) -> Option<impl Iterator<Item = [i64; 2]> + use<>> {
        let [[x, to_x], [y, to_y]] =
            [0, 1].map(|k| [one.low[k], one.high[k]].map(|at| (at / self.side).floor() as i64));
        let count = to_x.saturating_sub(x).saturating_add(1).saturating_mul(to_y.saturating_sub(y).saturating_add(1));
        (count <= SQUARES).then(|| (x..=to_x).flat_map(move |i| (y..=to_y).map(move |j| [i, j])))
    }

    /// The blocks whose plans may overlap that of a block, each once.
    pub(super) fn near(&self, one: &Column) -> Vec<usize> {
        let listed = |at| self.squares.get(&at).into_iter().flatten();
        let mut near: Vec<usize> = match self.squares_of(one) {
            Some(squares) => squares.flat_map(listed).copied().collect(),
            None => self.squares.values().flatten().copied().collect(),
        };
        near.extend(&self.wide);
        near.sort_unstable();
        near.dedup();
        near
    }
}

/// The weight of a block and of what stands above it with what that is pressed down with (N).
pub(super) fn carried(columns: &[Column], plans: &Plans, one: &Column) -> f64 {
    let above = |other: &&Column| other.middle() > one.middle() && other.shared(one) > 0.0;
    let over: Vec<&Column> = plans.near(one).into_iter().map(|k| &columns[k]).filter(above).collect();
    let fixed: Vec<&Column> = over.iter().copied().filter(|other| other.weight.is_none()).collect();
    let is_borne = |other: &Column| fixed.iter().any(|f| f.middle() < other.middle() && f.shared(other) > 0.0);
    let loads = over
        .iter()
        .filter(|other| !is_borne(other))
        .filter_map(|other| Some((other.weight? + other.pushed).max(0.0) * other.shared(one) / other.shared(other)));
    one.weight.unwrap_or(0.0) + loads.sum::<f64>()
}
