//! What steps do where nothing should happen: a block at rest for 10,000 steps, and stiff contacts above soft ones.

use super::scenes::{self, BLOCK_WEIGHT, StepsError};
use rockproof_differential::row::written;
use rockproof_model::{Motion, Number, Precision};
use rockproof_stepper::dynamics::{Dynamics, Solve};

/// One measurement against its closed form.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedFormCheck {
    /// `rest` or `contrast`.
    pub case: &'static str,
    /// `rigid` or `deformable`.
    pub motion: Motion,
    /// `stepper-f32` or `stepper-f64`.
    pub engine: &'static str,
    /// Steps after settling; for `contrast` the ratio of the stiffnesses.
    pub level: u64,
    /// How deep the block, or the upper block in the lower one, overlaps (m).
    pub overlap: f64,
    /// The same by the closed form: weight over the stiffness of four contacts (m).
    pub expected: f64,
    /// How far the centroid has wandered sideways (m).
    pub drift: f64,
    /// Steps accepted that did not converge.
    pub unconverged: u64,
    /// Why the run stopped, if it did.
    pub stopped: Option<String>,
}

impl ClosedFormCheck {
    /// The overlap's relative error.
    pub fn error(&self) -> f64 {
        (self.overlap - self.expected).abs() / self.expected
    }
}

/// The steps after which a block at rest is looked at.
pub const REST: [u64; 5] = [1, 10, 100, 1000, 10_000];

/// Exponents of the stiffness contrasts.
pub const CONTRASTS: [u32; 11] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10];

/// The columns of `steps.csv`.
pub const STEP_COLUMNS: [&str; 10] = [
    "case",
    "motion",
    "engine",
    "level",
    "overlap_m",
    "expected_m",
    "relative_error",
    "drift_m",
    "unconverged",
    "stopped",
];

/// Everything measured, in f32 and f64; `rest_steps` is the last of [`REST`] to go to.
///
/// # Errors
/// When a scene cannot be set up. A run that stops is a result.
pub fn measure(rest_steps: u64) -> Result<Vec<ClosedFormCheck>, StepsError> {
    let mut all = Vec::new();
    for motion in [Motion::Rigid, Motion::Deformable] {
        all.extend(rest::<f32>("stepper-f32", Precision::F32, motion, rest_steps)?);
        all.extend(rest::<f64>("stepper-f64", Precision::F64, motion, rest_steps)?);
    }
    for exponent in CONTRASTS {
        all.push(contrast::<f32>("stepper-f32", Precision::F32, exponent)?);
        all.push(contrast::<f64>("stepper-f64", Precision::F64, exponent)?);
    }
    Ok(all)
}

/// A block of 1 m at rest on a floor, contacts of 10⁸ N/m.
fn rest<R: Solve>(
    engine: &'static str,
    precision: Precision,
    motion: Motion,
    last: u64,
) -> Result<Vec<ClosedFormCheck>, StepsError> {
    let stiffness = 1e8;
    let scene = scenes::column(&[Number::from_f64(stiffness).unwrap_or(Number::ZERO)], motion)?;
    let mut dynamics = scenes::settled::<R>(&scene, precision)?;
    let begin = dynamics.centroid(1);
    let (mut found, mut unconverged, mut stopped) = (Vec::new(), 0, None);
    for at in REST.into_iter().filter(|at| *at <= last) {
        while dynamics.state().step < at && stopped.is_none() {
            match dynamics.step() {
                Ok(report) => unconverged += u64::from(!report.converged),
                Err(error) => stopped = Some(error.to_string()),
            }
        }
        let now = dynamics.centroid(1);
        let [x, y] = [(now.x, begin.x), (now.y, begin.y)].map(|(now, begin)| now.to_f64() - begin.to_f64());
        let (overlap, expected) = (-lowest(&dynamics, 1), BLOCK_WEIGHT / (4.0 * stiffness));
        let (drift, stopped) = (x.hypot(y), stopped.clone());
        found.push(ClosedFormCheck {
            case: "rest",
            motion,
            engine,
            level: at,
            overlap,
            expected,
            drift,
            unconverged,
            stopped,
        });
    }
    Ok(found)
}

/// Two rigid blocks: the lower one on contacts of 10⁸ N/m, the upper one on contacts `10^exponent` times as stiff.
fn contrast<R: Solve>(
    engine: &'static str,
    precision: Precision,
    exponent: u32,
) -> Result<ClosedFormCheck, StepsError> {
    let (soft, ratio) = (1e8, 10f64.powi(exponent as i32));
    let stiffness = [soft, soft * ratio].map(|p| Number::from_f64(p).unwrap_or(Number::ZERO));
    let scene = scenes::column(&stiffness, Motion::Rigid)?;
    let mut measured = ClosedFormCheck {
        case: "contrast",
        motion: Motion::Rigid,
        engine,
        level: 10u64.pow(exponent),
        overlap: f64::NAN,
        expected: BLOCK_WEIGHT / (4.0 * soft * ratio),
        drift: f64::NAN,
        unconverged: 0,
        stopped: None,
    };
    let mut dynamics = match scenes::settled::<R>(&scene, precision) {
        Ok(dynamics) => dynamics,
        Err(StepsError::Stopped(error)) => {
            return Ok(ClosedFormCheck { stopped: Some(error.to_string()), ..measured });
        }
        Err(error) => return Err(error),
    };
    let begin = dynamics.centroid(2);
    for _ in 0..10 {
        match dynamics.step() {
            Ok(report) => measured.unconverged += u64::from(!report.converged),
            Err(error) => {
                measured.stopped = Some(error.to_string());
                break;
            }
        }
    }
    let now = dynamics.centroid(2);
    measured.drift = (now.x.to_f64() - begin.x.to_f64()).hypot(now.y.to_f64() - begin.y.to_f64());
    measured.overlap = highest(&dynamics, 1) - lowest(&dynamics, 2);
    Ok(measured)
}

/// The lowest z of a block (m).
fn lowest<R: Solve>(dynamics: &Dynamics<R>, block: usize) -> f64 {
    dynamics.state().blocks[block].vertices.iter().map(|v| v.z.to_f64()).fold(f64::INFINITY, f64::min)
}

/// The highest z of a block (m).
fn highest<R: Solve>(dynamics: &Dynamics<R>, block: usize) -> f64 {
    dynamics.state().blocks[block].vertices.iter().map(|v| v.z.to_f64()).fold(f64::NEG_INFINITY, f64::max)
}

/// `steps.csv`.
///
/// # Errors
/// Those of the CSV writer.
pub fn to_csv(all: &[ClosedFormCheck]) -> Result<Vec<u8>, csv::Error> {
    let number = |value: f64| if value.is_finite() { format!("{value:.3e}") } else { String::new() };
    written(
        &STEP_COLUMNS,
        all.iter().map(|m| {
            [
                m.case.to_owned(),
                m.motion.name().to_owned(),
                m.engine.to_owned(),
                m.level.to_string(),
                number(m.overlap),
                number(m.expected),
                number(m.error()),
                number(m.drift),
                m.unconverged.to_string(),
                m.stopped.clone().unwrap_or_default(),
            ]
        }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_rests_where_the_closed_form_says() {
        let all = measure(100).expect("steps");
        let at = |engine, steps| {
            all.iter().find(|m| m.case == "rest" && m.engine == engine && m.level == steps).expect("a row")
        };
        assert!(at("stepper-f64", 100).error() < 1e-9, "{:?}", at("stepper-f64", 100));
        assert!(at("stepper-f32", 100).error() < 1e-2, "{:?}", at("stepper-f32", 100));
        let contrast = |engine, level| {
            all.iter().find(|m| m.case == "contrast" && m.engine == engine && m.level == level).expect("a row")
        };
        assert!(contrast("stepper-f64", 100).error() < 1e-6, "{:?}", contrast("stepper-f64", 100));
        // Floats cannot hold an overlap of 6.5e-15 m at coordinates of 1 m to a part in a thousand.
        assert!(contrast("stepper-f64", 10_000_000_000).error() > 1e-3);
    }
}
