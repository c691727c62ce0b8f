//! Two of the paper's scenes in steps: blocks that approach one another, and edges that are nearly parallel.

use rockproof_model::simulation::{Unconverged, derive_stiffness};
use rockproof_model::{
    Block, BlockOptions, Criteria, Motion, Number, Point, Precision, Scene, SceneBlock, ToleranceSet, ToleranceSpec,
    Vec3,
};
use rockproof_oracle::penetration::penetration;
use rockproof_stepper::dynamics::{Dynamics, Solve};

type Failure = Box<dyn std::error::Error>;

fn number(value: f64) -> Number {
    Number::from_f64(value).unwrap_or(Number::ZERO)
}

fn point(x: f64, y: f64, z: f64) -> Point {
    Vec3::new(number(x), number(y), number(z))
}

/// What a scene came to under a set.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    /// `stepper-f32` or `stepper-f64`.
    pub(crate) engine: &'static str,
    /// The deepest exact overlap after any step (m).
    pub(crate) depth: f64,
    /// Steps that found no contact although the blocks overlapped.
    pub(crate) blind: u64,
    /// Why it stopped, if it did.
    pub(crate) stopped: Option<String>,
}

/// Two blocks of 1 m, 0.1 to 0.126 m apart, approach one another at 4 m/s each, for 0.05 s.
#[derive(Clone, Debug)]
pub(crate) struct Approach {
    /// `max_displacement` over the shortest edge.
    pub(crate) step_limit: f64,
    /// `search` over `max_displacement`.
    pub(crate) search: f64,
    /// `penetration` over `max_displacement`.
    pub(crate) penetration: f64,
    /// What happened.
    pub(crate) run: Run,
}

/// A block with a keel on a ridge of 2 m, crossing in the middle at an angle, under its weight for 0.1 s.
#[derive(Clone, Debug)]
pub(crate) struct Crossing {
    /// The angle between the edges (degrees).
    pub(crate) angle: f64,
    /// `parallel_angle` (degrees).
    pub(crate) parallel: f64,
    /// Criteria.
    pub(crate) criteria: Criteria,
    /// Whether sp·(edge) ≤ r: the rule that SPEC asks of `classic` only.
    pub(crate) keeps_rule: bool,
    /// What happened.
    pub(crate) run: Run,
}

/// The crossing under `classic` with no parallel angle: where the keel is after 0.1 s.
#[derive(Clone, Debug)]
pub(crate) struct ClassicCrossing {
    /// `overlap_angle` (degrees).
    pub(crate) overlap: f64,
    /// Whether so·(longest edge) ≤ g: the rule that SPEC asks of `classic` only.
    pub(crate) keeps_rule: bool,
    /// How far the keel has risen at each of [`ANGLES`] (m); f64.
    pub(crate) risen: Vec<f64>,
}

/// Angles between the edges (degrees).
pub(crate) const ANGLES: [f64; 8] = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 6.0];

/// Gaps that an approach begins with: where a step ends within the gap is a matter of chance, so the worst of several is taken.
const GAPS: [f64; 8] = [0.1, 0.1037, 0.1074, 0.1111, 0.1148, 0.1185, 0.1222, 0.1259];

/// Every approach.
pub(crate) fn approaches() -> Result<Vec<Approach>, Failure> {
    let mut all = Vec::new();
    for step_limit in [1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0] {
        for search in [0.5, 1.0, 1.5, 2.0, 2.5, 4.0] {
            for penetration in [0.5, 1.0, 2.0] {
                let mut worst: Option<[Run; 2]> = None;
                for gap in GAPS {
                    let scene = approaching(gap)?;
                    let mut set = auto(&scene)?;
                    set.max_displacement = number(step_limit);
                    set.search = number(search * step_limit);
                    set.penetration = number(penetration * step_limit);
                    set.territory = number(step_limit.min(search * step_limit) / 8.0);
                    let now = runs(&scene, &set, 0.05)?;
                    worst = Some(match worst {
                        None => now,
                        Some([a, b]) => [a.or_worse(&now[0]), b.or_worse(&now[1])],
                    });
                }
                for run in worst.into_iter().flatten() {
                    all.push(Approach { step_limit, search, penetration, run });
                }
            }
        }
    }
    Ok(all)
}

impl Run {
    /// The deeper overlap, and the blind steps of both.
    fn or_worse(mut self, other: &Run) -> Run {
        self.depth = self.depth.max(other.depth);
        self.blind += other.blind;
        self.stopped = self.stopped.or_else(|| other.stopped.clone());
        self
    }
}

/// Every crossing.
pub(crate) fn crossings() -> Result<Vec<Crossing>, Failure> {
    let mut all = Vec::new();
    for criteria in [Criteria::Revised, Criteria::Classic] {
        for parallel in [0.0, 0.1, 1.0, 3.0, 8.0] {
            for angle in [0.05, 0.2, 0.5, 1.0, 2.0, 4.0, 6.0, 10.0] {
                let scene = crossing(angle)?;
                let mut spec = ToleranceSpec::default();
                spec.set_number("parallel_angle", number(parallel))?;
                spec.set_text("criteria", criteria.name())?;
                let set = spec.derive(&scene.shapes(), Precision::F64)?;
                let keeps_rule = set.parallel_sine.approximate() * 2.0 <= set.territory.approximate();
                for run in runs(&scene, &set, 0.1)? {
                    all.push(Crossing { angle, parallel, criteria, keeps_rule, run });
                }
            }
        }
    }
    Ok(all)
}

/// The crossing under `classic`, by overlap angle.
pub(crate) fn classic_crossings() -> Result<Vec<ClassicCrossing>, Failure> {
    let mut all = Vec::new();
    for overlap in [0.02, 0.1, 0.28, 1.0, 3.0] {
        let mut classic = ClassicCrossing { overlap, keeps_rule: true, risen: Vec::new() };
        for angle in ANGLES {
            let mut scene = crossing(angle)?;
            let mut spec = ToleranceSpec::default();
            spec.set_number("parallel_angle", number(0.0))?;
            spec.set_number("overlap_angle", number(overlap))?;
            spec.set_text("criteria", Criteria::Classic.name())?;
            let set = spec.derive(&scene.shapes(), Precision::F64)?;
            classic.keeps_rule &= set.overlap_sine.approximate() * 2.0 <= set.penetration.approximate();
            scene.simulation.control.unconverged = Unconverged::Accept;
            scene.derive_stiffness(&set);
            let mut dynamics = Dynamics::<f64>::new(&scene, &set)?;
            let height = |dynamics: &Dynamics<f64>| {
                let vertices = &dynamics.state().blocks[1].vertices;
                vertices.iter().map(|vertex| vertex.z).sum::<f64>() / vertices.len() as f64
            };
            let before = height(&dynamics);
            while dynamics.state().time < 0.1 {
                dynamics.step()?;
            }
            classic.risen.push(height(&dynamics) - before);
        }
        all.push(classic);
    }
    Ok(all)
}

fn auto(scene: &Scene) -> Result<ToleranceSet, Failure> {
    Ok(ToleranceSpec::default().derive(&scene.shapes(), Precision::F64)?)
}

fn approaching(gap: f64) -> Result<Scene, Failure> {
    let mut blocks = Vec::new();
    for (name, x, velocity) in [("left", 0.0, 4.0), ("right", 1.0 + gap, -4.0)] {
        // Off one another's edges, so that corners meet faces.
        let shift = if x == 0.0 { 0.0 } else { 0.3 };
        let mut block =
            SceneBlock::new(name, Block::cuboid(&point(x, shift, shift), &point(x + 1.0, shift + 1.0, shift + 1.0))?);
        block.body.motion = Motion::Rigid;
        block.body.velocity = point(velocity, 0.0, 0.0);
        blocks.push(block);
    }
    let mut scene = Scene { blocks, ..Scene::default() };
    scene.simulation.gravity = point(0.0, 0.0, 0.0);
    // A full step would carry each block by 0.4 m: the limit decides.
    scene.simulation.control.time_step = number(0.1);
    Ok(scene)
}

fn crossing(degrees: f64) -> Result<Scene, Failure> {
    // A rational rotation close to the angle, exact in coordinates rounded to 2⁻⁴⁰.
    let (sin, cos) = degrees.to_radians().sin_cos();
    let grid = |value: f64| (value * 2f64.powi(40)).round() / 2f64.powi(40);
    let prism = |up: f64, sin: f64, cos: f64| {
        let corner = |x: f64, y: f64, z: f64| point(grid(x * cos - y * sin), grid(x * sin + y * cos), z);
        let height = -0.5 * up;
        let vertices = [-1.0, 1.0]
            .into_iter()
            .flat_map(|x| [corner(x, -0.5, height), corner(x, 0.5, height), corner(x, 0.0, 0.0)]);
        let mut faces: Vec<Vec<u32>> =
            vec![vec![0, 2, 1], vec![3, 4, 5], vec![0, 1, 4, 3], vec![0, 3, 5, 2], vec![1, 2, 5, 4]];
        if up < 0.0 {
            faces.iter_mut().for_each(|face| face.reverse());
        }
        Block::new(vertices.collect(), faces, &BlockOptions { planarity: number(1e-9) })
    };
    let mut ridge = SceneBlock::new("ridge", prism(1.0, 0.0, 1.0)?);
    ridge.body.motion = Motion::Fixed;
    let mut keel = SceneBlock::new("keel", prism(-1.0, sin, cos)?);
    keel.body.motion = Motion::Rigid;
    let mut scene = Scene { blocks: vec![ridge, keel], ..Scene::default() };
    scene.simulation.gravity = point(0.0, 0.0, -10.0);
    Ok(scene)
}

fn runs(scene: &Scene, set: &ToleranceSet, duration: f64) -> Result<[Run; 2], Failure> {
    Ok([run::<f32>("stepper-f32", scene, set, duration)?, run::<f64>("stepper-f64", scene, set, duration)?])
}

fn run<R: Solve>(engine: &'static str, scene: &Scene, set: &ToleranceSet, duration: f64) -> Result<Run, Failure> {
    let mut scene = scene.clone();
    scene.simulation.control.unconverged = Unconverged::Accept;
    let bodies: Vec<_> = scene.blocks.iter().map(|block| (&block.block, &block.body)).collect();
    derive_stiffness(&mut scene.simulation, &bodies, set);
    let mut dynamics = Dynamics::<R>::new(&scene, set)?;
    let mut found = Run { engine, depth: 0.0, blind: 0, stopped: None };
    while dynamics.state().time.to_f64() < duration && found.stopped.is_none() {
        if let Err(error) = dynamics.step() {
            found.stopped = Some(error.to_string());
        }
        let placed = |number: usize| {
            let near = |value: R| Number::from_f64(value.to_f64()).unwrap_or(Number::ZERO);
            let points =
                dynamics.state().blocks[number].vertices.iter().map(|v| Vec3::new(near(v.x), near(v.y), near(v.z)));
            scene.blocks[number].block.with_vertices(points.collect())
        };
        let depth = penetration(&placed(0), &placed(1)).and_then(|found| found.depth_m()).unwrap_or(0.0);
        found.depth = found.depth.max(depth);
        found.blind += u64::from(depth > 0.0 && dynamics.state().contacts.is_empty());
    }
    Ok(found)
}
