//! Energy that a run gains though nothing puts it in. Steps of DDA lose energy and gain none as long as springs stay where they are; a contact that begins deep in
//! another block, or one whose plane changes, brings energy along.

use crate::exact_float::ExactFloat;
use crate::f64_vector::{Point, cross, dot, minus, point};
use rockproof_model::simulation::PointLoad;
use rockproof_model::{Number, Precision, Scene, Topology};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{BlockState, State, StepReport};
use serde::{Deserialize, Serialize};

/// A gain up to this share of what motion, strain and springs held at most until then is not told.
const MIN_SHARE: f64 = 0.1;

/// The energy of a run since its settling, as far as a gain is looked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnergyBalance {
    /// What loads put in until now (J).
    pub work: ExactFloat,
    /// The least that the energy without this work has been (J), and the step.
    pub least: Option<(ExactFloat, i64)>,
    /// The most that motion, strain and springs held after a step (J).
    pub held: ExactFloat,
    /// The largest gain that is told.
    pub gain: Option<EnergyGain>,
}

/// Energy that a run gained.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnergyGain {
    /// How much (J), the work of loads taken off.
    pub energy: ExactFloat,
    /// What motion, strain and springs had held at most until then (J).
    pub held: ExactFloat,
    /// The step after which the energy was least.
    pub from: i64,
    /// The step after which it was so much more.
    pub to: i64,
}

impl EnergyBalance {
    /// Adds a step, settling left out: the energy of weight after it (J), the work of loads in it (J), and the gain that rounding may make (J), which is seldom
    /// asked for.
    pub fn add(&mut self, report: &StepReport, [weight, work]: [f64; 2], rounding: impl FnOnce() -> f64) {
        if report.step <= 0 {
            return;
        }
        self.work = ExactFloat(self.work.0 + work);
        let energy = report.kinetic + report.elastic + report.springs + weight - self.work.0;
        let held = report.kinetic + report.elastic + report.springs;
        self.held = ExactFloat(self.held.0.max(held));
        let Some((least, from)) = self.least.filter(|(least, _)| energy > least.0) else {
            self.least = Some((ExactFloat(energy), report.step));
            return;
        };
        let gained = energy - least.0;
        let is_much = gained > MIN_SHARE * self.held.0;
        if is_much && self.gain.is_none_or(|known| gained > known.energy.0) && gained > rounding() {
            self.gain = Some(EnergyGain { energy: ExactFloat(gained), held: self.held, from, to: report.step });
        }
    }
}

/// What weight and loads do in a run, and what rounding may do.
pub struct EnergyInput<'s> {
    loads: &'s [PointLoad],
    precision: Precision,
    gravity: Point,
    /// Of each block the share of its mass (kg) that each vertex stands for, as far as the centroid goes; none of fixed blocks.
    masses: Vec<Vec<f64>>,
    /// The sum of all weights (N).
    weight: f64,
    /// The stiffest normal spring of a contact (N/m).
    stiffness: f64,
}

impl<'s> EnergyInput<'s> {
    /// That of a scene whose stiffnesses are derived; `begin` is the state in which it begins.
    pub fn of<R: Real>(scene: &'s Scene, precision: Precision, begin: &State<R>) -> EnergyInput<'s> {
        let simulation = &scene.simulation;
        let gravity = simulation.gravity.components().map(Number::approximate);
        let masses = scene.blocks.iter().zip(&begin.blocks).map(|(block, state)| {
            let density = simulation.materials[block.body.material].density.approximate();
            let points: Vec<Point> = state.vertices.iter().map(|v| point(*v)).collect();
            if block.body.is_fixed() { Vec::new() } else { vertex_masses(block.block.topology(), &points, density) }
        });
        let masses: Vec<Vec<f64>> = masses.collect();
        let stiffness = simulation.joints.pairs.iter().map(|pair| &pair.properties).chain([&simulation.joints.other]);
        let stiffness = stiffness.filter_map(|joint| joint.normal_stiffness.as_ref()).map(Number::approximate);
        EnergyInput {
            loads: &simulation.loads,
            precision,
            gravity,
            weight: masses.iter().flatten().sum::<f64>() * dot(gravity, gravity).sqrt(),
            masses,
            stiffness: stiffness.fold(0.0, f64::max),
        }
    }

    /// The energy of weight in a state (J), of the masses that blocks began with. Steps let mass follow volume, so what `steps.csv` has as gravitational energy
    /// changes by as much as a block's strain times its weight times its distance from the origin, and nothing gains that.
    pub fn weight<R: Real>(&self, state: &State<R>) -> f64 {
        let of_block = |(masses, block): (&Vec<f64>, &BlockState<R>)| -> f64 {
            masses.iter().zip(&block.vertices).map(|(mass, v)| mass * dot(self.gravity, point(*v))).sum()
        };
        if self.weight > 0.0 { -self.masses.iter().zip(&state.blocks).map(of_block).sum::<f64>() } else { 0.0 }
    }

    /// The points of loads before a step, from which [`EnergyInput::work`] is calculated.
    pub fn load_points<R: Real>(&self, state: &State<R>) -> Vec<Point> {
        state.load_points.iter().map(|&load| point(load)).collect()
    }

    /// The work of all loads in a step (J): that of the force at its end, which is what steps take.
    pub fn work<R: Real>(&self, before: &[Point], state: &State<R>) -> f64 {
        let after = self.load_points(state);
        let now = Number::from_f64(state.time.to_f64()).unwrap_or(Number::ZERO);
        let of_load = |(load, (from, to)): (&PointLoad, (&Point, &Point))| -> f64 {
            let force = load.force_at(&now);
            (0..3).map(|k| force[k] * (to[k] - from[k])).sum()
        };
        self.loads.iter().zip(before.iter().zip(&after)).map(of_load).sum()
    }

    /// The energy (J) that rounding may make: all weights by the depth below which rounding decides, and that depth in the springs of all contacts.
    pub fn rounding<R: Real>(&self, state: &State<R>) -> f64 {
        let largest = state.blocks.iter().flat_map(|block| &block.vertices).flat_map(|v| v.components().map(R::to_f64));
        let depth = 256.0 * self.precision.epsilon() * largest.fold(0.0, |most: f64, c| most.max(c.abs()));
        let springs = self.stiffness * depth * depth * state.contacts.len() as f64;
        self.weight * depth + springs
    }
}

/// The mass of a block (kg) shared out among its vertices, so that their centroid is that of the block, wherever affine maps take both: each tetrahedron of the
/// first vertex and a triangle of the faces gives a quarter of its mass to each of its corners, and of its share of the volume affine maps change nothing.
fn vertex_masses(topology: &Topology, points: &[Point], density: f64) -> Vec<f64> {
    let mut masses = vec![0.0; points.len()];
    for face in topology.faces() {
        for k in 1..face.len() - 1 {
            let corners = [face[0], face[k], face[k + 1]].map(|v| v.index());
            let [a, b, c] = corners.map(|corner| minus(points[corner], points[0]));
            let share = density * dot(a, cross(b, c)) / 24.0;
            corners.into_iter().chain([0]).for_each(|corner| masses[corner] += share);
        }
    }
    masses
}

impl EnergyGain {
    /// The same in words; `is_linear` where blocks that turn grow by the rule that moves their vertices.
    pub fn sentence(&self, is_linear: bool) -> String {
        let EnergyGain { energy, held, from, to } = self;
        let why = if is_linear { ", or of turning by kinematics \"linear\"" } else { "" };
        format!(
            "{} J from step {from} to {to} that neither gravity nor loads put in, {:.0} % of the most that motion, strain and springs held until then: it comes of contacts that begin deep or turn, of strains that are not small{why}",
            short(energy.0),
            100.0 * energy.0 / held.0
        )
    }
}

/// Three significant digits.
fn short(value: f64) -> String {
    let near: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if (1e-4..1e6).contains(&near.abs()) { near.to_string() } else { format!("{near:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Vec3;

    fn report(step: i64, kinetic: f64, gravitational: f64, springs: f64) -> StepReport {
        StepReport {
            step,
            time: 0.0,
            time_step: 0.01,
            iterations: 1,
            converged: true,
            friction_left: 0.0,
            retries: Vec::new(),
            contacts: [[0; 3]; 6],
            max_penetration: 0.0,
            max_displacement: 0.0,
            kinetic,
            gravitational,
            elastic: 0.0,
            springs,
        }
    }

    fn gain(reports: &[StepReport], work: f64, rounding: f64) -> Option<EnergyGain> {
        let mut balance = EnergyBalance::default();
        reports.iter().for_each(|report| balance.add(report, [report.gravitational, work], || rounding));
        balance.gain
    }

    #[test]
    fn what_comes_from_nowhere_is_a_gain_and_what_falls_or_is_pushed_is_none() {
        // Settling is left out; it falls, is stopped by a spring, which loses a little, and then by another that begins deep.
        let steps = [
            report(0, 0.0, 0.0, 99.0),
            report(1, 1.0, 99.0, 0.0),
            report(2, 50.0, 50.0, 0.0),
            report(3, 30.0, 49.0, 20.0),
            report(4, 30.0, 49.0, 31.0),
            report(5, 40.0, 49.0, 10.0),
        ];
        assert_eq!(gain(&steps[..4], 0.0, 0.0), None);
        let [energy, held] = [11.0, 61.0].map(ExactFloat);
        let found = EnergyGain { energy, held, from: 3, to: 4 };
        assert_eq!(gain(&steps, 0.0, 0.0), Some(found));
        assert_eq!((gain(&steps, 0.0, 11.0), gain(&steps, 11.0, 0.0)), (None, None), "rounding, and loads");
        assert_eq!(
            found.sentence(false),
            "11 J from step 3 to 4 that neither gravity nor loads put in, 18 % of the most that motion, strain and springs held until then: it comes of contacts that begin deep or turn, of strains that are not small"
        );
        // A tenth of what was held is not told.
        assert_eq!(gain(&[report(1, 100.0, 0.0, 0.0), report(2, 110.0, 0.0, 0.0)], 0.0, 0.0), None);
    }

    #[test]
    fn masses_of_vertices_have_the_centroid_of_the_block_wherever_it_goes() {
        // A wedge: half of a box of 2 × 3 × 6 m.
        let corners =
            [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 6.0], [2.0, 0.0, 6.0], [0.0, 3.0, 6.0]];
        let faces: [&[usize]; 5] = [&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
        let faces = faces.map(|face| face.iter().map(|&v| rockproof_model::VertexId::at(v)).collect::<Vec<_>>());
        let topology = Topology::new(6, faces.to_vec()).expect("a wedge");
        let masses = vertex_masses(&topology, &corners, 0.5);
        let mean = |points: &[Point]| {
            let sum = |axis: usize| masses.iter().zip(points).map(|(mass, p)| mass * p[axis]).sum::<f64>();
            [0, 1, 2].map(|axis| sum(axis) / masses.iter().sum::<f64>())
        };
        let near = |found: Point, expected: Point| (0..3).all(|k| (found[k] - expected[k]).abs() < 1e-12);
        assert!((masses.iter().sum::<f64>() - 9.0).abs() < 1e-12 && near(mean(&corners), [2.0 / 3.0, 1.0, 3.0]));
        let sheared = corners.map(|[x, y, z]| [7.0 + x + 2.0 * z, y - x, 0.5 * z]);
        assert!(near(mean(&sheared), [7.0 + 2.0 / 3.0 + 6.0, 1.0 / 3.0, 1.5]), "{:?}", mean(&sheared));
    }

    #[test]
    fn a_load_works_with_its_force_at_the_end_of_the_step() {
        let number = |value: i32| Number::from_integer(value);
        let force = |x: i32| Vec3::new(x, 0, 0).map(|&c| number(c));
        let table = vec![(number(1), force(0)), (number(3), force(8)), (number(4), force(2))];
        let load = PointLoad { block: 0, at: force(0), table };
        let forces =
            [0.0, 1.0, 2.5, 3.0, 3.5, 9.0].map(|now| load.force_at(&Number::from_f64(now).expect("a time"))[0]);
        assert_eq!(forces, [0.0, 0.0, 6.0, 8.0, 5.0, 2.0]);
    }
}
