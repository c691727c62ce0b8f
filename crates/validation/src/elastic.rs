//! Hooke's law in one block and through joints.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, length, minus, relative, worst};
use rockproof_stepper::dynamics::StepRules;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    let hooke = ("relative", Some(1e-10));
    let uniform = ("relative to the stress", Some(1e-9));
    vec![
        Compression { confined: false }.case::<M>(
            "uniaxial compression, not confined",
            "σz = −F/A, εx = εy = −ν εz",
            hooke,
        ),
        Compression { confined: true }.case::<M>(
            "uniaxial compression between walls",
            "E εx = (1 − ν) σx − ν σz, σx = −4pδ/A, δ = εx L/2",
            hooke,
        ),
        Release.case::<M>("initial stress release", "σ = 0, ε = −E⁻¹σ₀", uniform),
        Patch("patch_joint").case::<M>(
            "patch test, joint across",
            "σz = −F/A in both blocks, F/4 in each contact",
            uniform,
        ),
        Patch("patch_inclined_joint").case::<M>(
            "patch test, joint of slope 1/2, overlap 1e-8 of the block",
            "the same (linear theory)",
            ("relative to the stress", Some(1e-7)),
        ),
    ]
}

/// Young's modulus and Poisson's ratio of a block.
fn moduli<R: CasePrecision, M: StepRules>(lab: &SteppedScene<R, M>, block: usize) -> [f64; 2] {
    let material = &lab.scene.simulation.materials[lab.scene.blocks[block].body.material];
    [material.young.approximate(), material.poisson.approximate()]
}

/// ε = E⁻¹σ.
fn strains([young, poisson]: [f64; 2], stress: [f64; 6]) -> [f64; 6] {
    let trace: f64 = stress[..3].iter().sum();
    std::array::from_fn(|k| match k {
        0..3 => (stress[k] * (1.0 + poisson) - poisson * trace) / young,
        _ => stress[k] * 2.0 * (1.0 + poisson) / young,
    })
}

/// Three edges of a cuboid from its first vertex: along x, y and z.
fn edges<R: CasePrecision, M: StepRules>(lab: &SteppedScene<R, M>, block: usize) -> [[f64; 3]; 3] {
    let corner = lab.vertex(block, 0);
    [1, 3, 4].map(|k| minus(lab.vertex(block, k), corner))
}

/// Adds to the strains of a cuboid those of one step, that took its edges from `before` to `after`: of small strain without
/// turning, `after = (I + ε) before`. It is the strains of the steps that add up, not the lengths.
fn add_strains(total: &mut [f64; 6], before: [[f64; 3]; 3], after: [[f64; 3]; 3]) {
    // The rows of the inverse of the matrix with the edges as columns.
    let [a, b, c] = before;
    let cross =
        |u: [f64; 3], v: [f64; 3]| [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let volume: f64 = a.iter().zip(cross(b, c)).map(|(x, y)| x * y).sum();
    let rows = [cross(b, c), cross(c, a), cross(a, b)].map(|row| row.map(|x| x / volume));
    let change: [[f64; 3]; 3] = std::array::from_fn(|k| minus(after[k], before[k]));
    let gradient = |i: usize, j: usize| (0..3).map(|k| change[k][i] * rows[k][j]).sum::<f64>();
    for (k, (i, j)) in [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
        total[k] += if i == j { gradient(i, j) } else { gradient(i, j) + gradient(j, i) };
    }
}

/// Runs a scene, and adds up the strains of a cuboid.
fn run_straining<R: CasePrecision, M: StepRules>(
    lab: &mut SteppedScene<R, M>,
    block: usize,
) -> Result<[f64; 6], CaseFailure> {
    let (mut total, mut before) = ([0.0; 6], edges(lab, block));
    lab.run_watched(|lab| {
        let after = edges(lab, block);
        add_strains(&mut total, before, after);
        before = after;
    })?;
    Ok(total)
}

/// The force that presses from above.
fn load<R: CasePrecision, M: StepRules>(lab: &SteppedScene<R, M>) -> f64 {
    let down = |load: &rockproof_model::simulation::PointLoad| (-load.table[0].1.z.approximate()).max(0.0);
    lab.scene.simulation.loads.iter().map(down).sum()
}

/// The area of a cuboid that has formed, across x and across z.
fn areas([a, b, c]: [[f64; 3]; 3]) -> [f64; 2] {
    [length(b) * length(c), length(a) * length(b)]
}

/// The difference of two tensors over a size.
fn apart(found: [f64; 6], expected: [f64; 6], size: f64) -> f64 {
    worst(found.iter().zip(expected).map(|(found, expected)| ((found - expected) / size).abs()))
}

/// A cube pressed from above, by itself or between walls.
#[derive(Clone, Copy)]
struct Compression {
    confined: bool,
}

impl Measure for Compression {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open(if self.confined { "compression_confined" } else { "compression" })?;
        let rest = length(edges(&lab, 0)[0]);
        let strain = run_straining(&mut lab, 0)?;
        let [young, poisson] = moduli(&lab, 0);
        let [across_x, across_z] = areas(edges(&lab, 0));
        let down = -load(&lab) / across_z;
        let sideways = if self.confined {
            // -4 p δ/A with δ = εx L/2.
            let wall = 2.0 * lab.stiffness(0, 2)[0] * rest / across_x;
            -wall * (-poisson * down / (young + (1.0 - poisson) * wall))
        } else {
            0.0
        };
        let stress = [sideways, sideways, down, 0.0, 0.0, 0.0];
        let expected = strains([young, poisson], stress);
        let error = apart(lab.stress(0), stress, down).max(apart(strain, expected, expected[2]));
        let seen = format!("σz {:.6e} Pa, σx {:.6e} Pa, εz {:.6e}", lab.stress(0)[2], lab.stress(0)[0], strain[2]);
        Ok(CaseMeasurement::new(error, seen))
    }
}

/// A cube whose stress nothing holds.
#[derive(Clone, Copy)]
struct Release;

impl Measure for Release {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open("stress_release")?;
        let before = lab.stress(0);
        let size = worst(before.map(f64::abs));
        let strain = run_straining(&mut lab, 0)?;
        let expected = strains(moduli(&lab, 0), before.map(|stress| -stress));
        let left = apart(lab.stress(0), [0.0; 6], size);
        let error = left.max(apart(strain, expected, worst(expected.map(f64::abs))));
        Ok(CaseMeasurement::new(error, format!("{left:.1e} of the stress left")))
    }
}

/// Two blocks pressed against one another.
#[derive(Clone, Copy)]
struct Patch(&'static str);

impl Measure for Patch {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open(self.0)?;
        lab.run()?;
        let force = load(&lab);
        let mut errors = Vec::new();
        // The ends are level: the lower face of the lower block, the upper one of the other.
        for (block, [corner, x, y]) in [(0, [0, 1, 3]), (1, [4, 5, 7])] {
            let from = |other: usize| length(minus(lab.vertex(block, other), lab.vertex(block, corner)));
            let down = -force / (from(x) * from(y));
            errors.push(apart(lab.stress(block), [0.0, 0.0, down, 0.0, 0.0, 0.0], down));
        }
        let count = lab.contacts(0, 1).count();
        errors.extend(
            lab.contacts(0, 1).map(|contact| relative(length(contact.force.components().map(R::to_f64)), force / 4.0)),
        );
        let deepest = lab.last.as_ref().map_or(0.0, |last| last.max_penetration);
        Ok(CaseMeasurement::new(worst(errors.clone()), format!("{count} contacts, overlap {deepest:.1e} m")))
    }
}
