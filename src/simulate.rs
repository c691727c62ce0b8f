//! `simulate`: a scene in motion, step by step.

// Longer than 400 lines: one command with all its options and ways to end.

use crate::doubts::{tell_of_tolerances, tell_of_warnings};
use crate::exit::{ExitStatus, Outcome, print_error, print_note, shows_progress};
use crate::input::{FormatArgs, ReadArgs, ToleranceArgs};
use crate::input_file::InputFile;
use crate::progress::overlaps;
use crate::simulate_causes::{causes_json, find_causes, write_causes};
use crate::simulate_exact::ExactRun;
use crate::stop::on_ctrl_c;
use crate::table::grouped;
use anyhow::Context;
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use rockproof_differential::lockstep::stepping::{STEPS_WITHOUT_CONTACTS, StateFileDescription, differences};
use rockproof_differential::lockstep::trajectory::default_grid;
use rockproof_differential::lockstep::{
    ComparedLinks, FreeStepping, Lockstep, LockstepStepping, Trajectory, free, table,
};
use rockproof_examine::{
    AuditedRun, IntrusionRecorder, ignored_of_fixed, ignored_of_rigid, passed_rows, unused_laws, violation_json,
    violations_text,
};
use rockproof_model::files::read_text;
use rockproof_model::scene::SceneFormat;
use rockproof_model::simulation::{Control, Kinematics, Skips, Solver, step_in_words};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Number, Precision, Scene, ToleranceSet, tolerance_rules};
use rockproof_oracle::step::KeptPrecision;
use rockproof_report::table::counted;
use rockproof_results::{Owner, ResultsError, Start, bounded};
use rockproof_simulate::audit::PairExtreme;
use rockproof_simulate::identity::{identity, with_tolerances};
use rockproof_simulate::record::{RunProgress, RunTable};
use rockproof_simulate::run::headers;
use rockproof_simulate::tables::lines;
use rockproof_simulate::totals::Extreme;
use rockproof_simulate::{
    AuditScope, AuditTotals, Ending, FalseEntranceSteps, FalseEntranceTotals, Plan, Run, RunRecord, Standstill,
    StandstillWatch, Stepping, Stretch, VolumeChange,
};
use rockproof_stepper::Real;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Dynamics, Solve, State, StepError, StepReport};
use rockproof_tune::hold_lowest;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Simulate a scene step by step
///
/// Writes tables (steps.csv, measured.csv), pictures for ParaView (blocks.pvd, contacts.pvd) and checkpoints. The rules that
/// `check` knows are checked first; where one is violated nothing is run, unless --force says so.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof simulate incline.toml --time 0.5
  rockproof simulate slope.toml --steps 2000 --every 50 --contacts --out reports/slope
  rockproof simulate slope.toml --steps 4000 --every 50 --contacts --out reports/slope --resume
  rockproof simulate incline.toml --engine stepper-f32 --steps 200 --lockstep
  rockproof simulate slope.toml --steps 200 --audit                     looks within the steps as well
  rockproof simulate blocks.stl --hold-lowest --steps 100 --audit       blocks alone, standing on the lowest

A run can be interrupted or killed at any moment; --resume continues from its last checkpoint; the files are byte-identical.

Exit status: 0 done, 1 rules violated, a run that cannot go on, blocks that overlap where no contact sees it, by more than springs elsewhere
explain, or, with --audit, pass through one another within a step, 2 usage or input error, 130 interrupted (go on with --resume).")]
pub(crate) struct Simulate {
    #[arg(help = format!("Blocks and what moves them: .toml; or blocks alone: {}; or - for stdin", SceneFormat::listed(|format| format != SceneFormat::Toml)), value_hint = clap::ValueHint::FilePath)]
    scene: InputFile,

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    tolerances: ToleranceArgs,

    /// What makes the steps: the stepper in a precision, or the oracle
    #[arg(long, value_enum, default_value = "stepper-f64")]
    engine: EngineChoice,

    /// Run until this step, settling not counted [default: what the scene says]
    #[arg(long, value_name = "N")]
    steps: Option<u64>,

    /// Run until this time in s [default: what the scene says]; with --steps, whichever comes first
    #[arg(long, value_name = "T", value_parser = seconds)]
    time: Option<f64>,

    /// Directory of the results [default: reports/simulate-SCENE]
    #[arg(long)]
    out: Option<PathBuf>,

    /// Steps between two checkpoints, and between two pictures
    #[arg(long, value_name = "K", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,

    /// Write every contact of every step to contacts.csv
    #[arg(long)]
    contacts: bool,

    /// Go on with the run in the directory, or begin if there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,

    /// Discard the run in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,

    /// What steps leave out where nothing can have changed: `all`, `none`, or names out of `blocks`, `pairs`, `islands`, `features` [default: what the
    /// scene says, else all]; no byte of any file depends on it
    #[arg(long, value_name = "NAMES", value_parser = skips)]
    skips: Option<Skips>,

    /// How systems of more than 96 unknowns are solved in f64: `auto`, `factor`, or `conjugate-gradients`, which takes far less memory and often
    /// more time [default: what the scene says, else auto]; last bits depend on it
    #[arg(long, value_name = "SOLVER", value_parser = solver)]
    solver: Option<Solver>,

    /// Fix the lowest blocks of a model that fixes none, as `examine` does; without it such a model falls as a whole
    #[arg(long)]
    hold_lowest: bool,

    /// Run although rules are violated
    #[arg(long)]
    force: bool,

    /// Look within every step as well: do blocks pass through one another? After every step it is looked at anyway how deep blocks overlap,
    /// exactly, and whether a contact sees it. Exits with 1 where blocks pass through one another, or overlap unseen
    /// by more than springs elsewhere explain
    #[arg(long)]
    audit: bool,

    /// Look at no step exactly: faster, but overlaps that no contact sees are not noticed
    #[arg(long, conflicts_with = "audit")]
    no_audit: bool,

    /// Make every step exactly as well and compare: lockstep.csv, differences.csv, states/
    #[arg(long)]
    lockstep: bool,

    /// End at the first step in which stepper and oracle differ
    #[arg(long, requires = "lockstep")]
    stop_at_first: bool,

    /// Run the exact trajectory beside the stepper's, each from its own state: free.csv
    #[arg(long, conflicts_with_all = ["lockstep", "resume"])]
    free: bool,

    /// Keep exact coordinates on a grid of 2^-N m, N from 64 to 4095 [default: 2^-256 of the model's size, or the next finer]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..=4095))]
    grid_exponent: Option<u32>,

    /// Keep exact coordinates as the fractions they are; they grow with every step
    #[arg(long, conflicts_with = "grid_exponent")]
    fractions: bool,

    /// Which causes to tell apart: all, or what the stepper's arithmetic alone does (faster)
    #[arg(long, value_enum, default_value = "all", requires = "lockstep")]
    links: LinksChoice,

    /// State files to write for each cause at most
    #[arg(long, value_name = "N", default_value_t = 20, requires = "lockstep")]
    states: u64,

    #[command(flatten)]
    format: FormatArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LinksChoice {
    /// Tolerance, representation, arithmetic
    All,
    /// Arithmetic
    Arithmetic,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EngineChoice {
    /// The stepper in double precision
    #[value(name = "stepper-f64", alias = "f64")]
    F64,
    /// The stepper in single precision
    #[value(name = "stepper-f32", alias = "f32")]
    F32,
    /// No rounding but that of --grid-exponent: the oracle steps by itself
    Exact,
}

fn seconds(text: &str) -> Result<f64, String> {
    match Number::parse(text).map(|time| time.approximate()) {
        Ok(time) if time.is_finite() && time > 0.0 => Ok(time),
        _ => Err("must be a number of seconds above 0, as 0.05 or 1/20".to_string()),
    }
}

/// `all`, `none`, or names between commas.
fn skips(text: &str) -> Result<Skips, String> {
    match text {
        "all" => Ok(Skips::ALL),
        "none" => Ok(Skips::NONE),
        names => names.split(',').try_fold(Skips::NONE, |skips, name| {
            let allowed = || format!("\"{name}\" is none of {}, all, none", Skips::NAMES.join(", "));
            skips.and(name).ok_or_else(allowed)
        }),
    }
}

/// A solver by its name.
pub(crate) fn solver(text: &str) -> Result<Solver, String> {
    Solver::from_name(text).ok_or_else(|| format!("must be one of {}", Solver::ALL.map(Solver::name).join(", ")))
}

/// What the end of a run tells of blocks beside what is recorded.
struct KnownOfBlocks {
    /// What the model overlaps before the first step, where that is more than contacts hold.
    overlaps: Option<String>,
    volume: Option<VolumeChange>,
    /// Deformable blocks that are strained by more than steps take strains for.
    stretch: Option<Stretch>,
    /// Blocks that stood still though they moved, and what the run calculated in.
    standstill: Option<(Standstill, Precision)>,
    /// Whether blocks that turn grow (`kinematics = "linear"`).
    is_linear: bool,
    /// The rules that it was run in spite of, as formulas.
    violated: Value,
}

/// What a run begins with.
struct PreparedRun {
    scene: Scene,
    set: ToleranceSet,
    plan: Plan,
    about: Map<String, Value>,
    /// What the model overlaps before the first step, where that is more than contacts hold.
    overlaps: Option<String>,
}

impl Simulate {
    pub(crate) fn run(&self) -> Outcome {
        if (self.fractions || self.grid_exponent.is_some()) && self.engine != EngineChoice::Exact && !self.free {
            anyhow::bail!(
                "--fractions and --grid-exponent say how exact coordinates are kept: they need --engine exact or --free"
            );
        }
        let mut scene = self.read.scene(&self.scene)?;
        let precision = if self.engine == EngineChoice::F32 { Precision::F32 } else { Precision::F64 };
        let shapes = scene.shapes();
        let spec = self.tolerances.spec(scene.tolerances.as_ref())?;
        let set = spec.derive(&shapes, precision).with_context(|| self.tolerances.place(self.scene.path()))?;
        tell_of_tolerances(&shapes, &set);
        let plan = self.plan(&scene.simulation.control)?;
        if let Some(skips) = self.skips {
            scene.simulation.control.skips = skips;
        }
        if let Some(solver) = self.solver {
            scene.simulation.control.solver = solver;
        }
        self.hold(&mut scene);
        let unused = unused_laws(&scene);
        scene.derive_stiffness(&set);
        let violations = tolerance_rules::check_scene(&set, &scene, precision);
        if !violations.is_empty() && !self.force {
            self.format.print(
                || violations_text(&violations),
                || json!({ "ending": "not run", "rules_violated": violations.iter().map(violation_json).collect::<Vec<_>>(), "overlaps": null }),
            )?;
            print_note("nothing was run; --force runs all the same");
            return Ok(ExitStatus::CheckFailed);
        }
        // Overlaps of a large model take long.
        Start::of(self.resume, self.overwrite).refuse_held(&self.directory(), Owner::Simulate)?;
        let overlaps = overlaps(&scene, &set, None);
        let lost = overlaps.sentence().filter(|_| overlaps.lost() > 0);
        if let Some(sentence) = &lost {
            if !self.force && !self.resume {
                self.format.print(
                    || overlaps.report(&scene).trim_start().to_owned(),
                    || json!({ "ending": "not run", "rules_violated": [], "overlaps": overlaps.json() }),
                )?;
                print_note("nothing was run; --force runs all the same");
                return Ok(ExitStatus::CheckFailed);
            }
            print_note(&format!("running with blocks that overlap: {sentence}"));
        }
        let violated: Vec<&str> = violations.iter().map(|violation| violation.rule.formula()).collect();
        if !violated.is_empty() {
            let rules = counted(violated.len() as u64, "rule", "rules");
            print_note(&format!("running with {rules} violated: {}", violated.join("; ")));
        }
        ignored_of_fixed(&scene)
            .into_iter()
            .chain(ignored_of_rigid(&scene))
            .chain(unused)
            .for_each(|note| print_note(&note));
        passed_rows(&scene).into_iter().for_each(|note| print_note(&note));
        tell_of_warnings(&scene, &set, &overlaps, &self.check(precision));
        if scene.fixed().into_iter().all(|is_fixed| is_fixed) {
            print_note("every block is fixed, so nothing will move");
        }
        if plan.steps == Some(0) && scene.simulation.control.settle == 0 && !self.resume {
            print_note("no step is asked for, so nothing will move: only the beginning is written");
        }
        let mut about = Map::new();
        about.insert("file".to_owned(), self.scene.path().display().to_string().into());
        about.insert("violated".to_owned(), violated.into());
        let ready = PreparedRun { scene, set, plan, about, overlaps: lost };
        match self.engine {
            EngineChoice::F64 => self.go::<f64>("f64", ready),
            EngineChoice::F32 => self.go::<f32>("f32", ready),
            EngineChoice::Exact => self.exact(&ready),
        }
    }

    /// The command that checks the same model.
    fn check(&self, precision: Precision) -> String {
        let options = self.read.shown() + &self.tolerances.shown();
        let precision = if precision == Precision::F32 { " --precision f32" } else { "" };
        format!("rockproof check {}{options}{precision}", self.scene.shown())
    }

    /// Fixes the lowest blocks of a model that fixes none, where that is asked for; else says that it will fall.
    fn hold(&self, scene: &mut Scene) {
        if self.hold_lowest && !has_fixed_block(scene) {
            print_note(&hold_lowest(scene).sentence());
        } else if is_loose(scene) {
            print_note("nothing is fixed, so the model falls as a whole; --hold-lowest fixes its lowest blocks");
        }
    }

    /// The oracle by itself.
    fn exact(&self, ready: &PreparedRun) -> Outcome {
        if self.lockstep || self.free || self.resume || self.contacts || self.audit {
            anyhow::bail!(
                "--lockstep, --free, --resume, --contacts and --audit are for the stepper, not for --engine exact"
            );
        }
        let points = &ready.scene.simulation.measured_points;
        let names = points.iter().map(|point| point.name.clone()).collect();
        let (file, dir) = (self.scene.path().to_path_buf(), self.directory());
        Start::of(false, self.overwrite).refuse_inputs(&dir, self.inputs())?;
        let run = ExactRun { file, dir, plan: ready.plan, overwrite: self.overwrite, names };
        run.run(&self.format, Trajectory::new(&ready.scene, &ready.set, self.keep(&ready.scene)))
    }

    fn keep(&self, scene: &Scene) -> KeptPrecision {
        match (self.fractions, self.grid_exponent) {
            (true, _) => KeptPrecision::Exact,
            (false, Some(exponent)) => KeptPrecision::Grid { exponent },
            (false, None) => default_grid(scene),
        }
    }

    fn plan(&self, control: &Control) -> anyhow::Result<Plan> {
        let time_step = control.time_step.approximate();
        let (steps, time) = match (self.steps, self.time) {
            (None, None) => (control.steps, control.duration.as_ref().map(|time| time.approximate())),
            asked => asked,
        };
        if steps.is_none() && time.is_none() {
            let file = self.scene.path().display();
            anyhow::bail!("{file} does not say how long to run; say it with --steps N or --time T");
        }
        let smallest_step = time_step / f64::from(Control::SMALLEST);
        Ok(Plan { steps, time, smallest_step, every: self.every, contacts: self.contacts })
    }

    /// The files that are read.
    fn inputs(&self) -> impl Iterator<Item = &Path> {
        [self.scene.path()].into_iter().chain(self.tolerances.file())
    }

    fn directory(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            PathBuf::from(format!("reports/{}", bounded(&format!("simulate-{}", self.scene.stem()))))
        })
    }

    fn go<R: Solve>(&self, engine: &str, ready: PreparedRun) -> Outcome {
        let PreparedRun { scene, set, plan, about, overlaps } = ready;
        let violated = about.get("violated").cloned().unwrap_or_default();
        // What can be wrong by now is a number that overflows where it is rounded, most often a tolerance.
        let file = || self.tolerances.place(self.scene.path());
        let mut dynamics = Dynamics::<R>::new(&scene, &set).with_context(file)?;
        let begin = dynamics.state().clone();
        let start = Start::of(self.resume, self.overwrite);
        let dir = self.directory();
        start.refuse_inputs(&dir, self.inputs())?;
        let mut identity = identity(&scene, &set, engine, &plan);
        let mut headers = headers(&plan)?;
        if let Some(scope) = self.audited() {
            identity.insert("audit".to_owned(), scope.name().into());
        }
        if self.lockstep {
            identity.extend(self.lockstep_identity());
            headers[RunTable::Lockstep as usize] = Some(lines([table::STEPS])?);
            headers[RunTable::Differences as usize] = Some(lines([table::DIFFERENCES])?);
        }
        if self.free {
            identity.insert("free".to_owned(), format!("{:?}", self.keep(&scene)).into());
            headers[RunTable::Free as usize] = Some(lines([free::COLUMNS])?);
        }
        let text = with_tolerances(&scene, &set)?;
        let opened = RunRecord::open(&dir, identity, headers, start);
        let (mut record, saved) = opened.map_err(|error| name_changed_line(error, &text))?;
        match saved {
            None => record.write("scene.toml", text.as_bytes())?,
            Some(saved) => saved
                .state()
                .map_err(anyhow::Error::from)
                .and_then(|state| Ok(dynamics.restore(state)?))
                .with_context(|| format!("{}: the checkpoint cannot be used", dir.display()))?,
        }
        if record.progress().resumed > 0 && plan.is_over(dynamics.state()) {
            print_note(&already_done(&dir, dynamics.state(), &plan));
        }
        let precision = if self.engine == EngineChoice::F32 { Precision::F32 } else { Precision::F64 };
        // In f64 no step is so short.
        let mut standstill =
            (precision == Precision::F32).then(|| StandstillWatch::new(&scene, precision.epsilon(), dynamics.state()));
        let mut stepping: Box<dyn Stepping<R>> = match self.lockstep {
            false if self.free => {
                Box::new(FreeStepping::new(dynamics, Trajectory::new(&scene, &set, self.keep(&scene))))
            }
            false => Box::new(dynamics),
            true => {
                let links = if self.links == LinksChoice::All { ComparedLinks::All } else { ComparedLinks::Arithmetic };
                let mut lockstep = Lockstep::<R, SpecRules>::new(&scene, &set, precision, links).with_context(file)?;
                lockstep.restore(dynamics.state().clone())?;
                let (engine, states, stop_at_first) = (engine.to_owned(), self.states, self.stop_at_first);
                let about = StateFileDescription { scene: text, engine, states, stop_at_first };
                Box::new(LockstepStepping::new(lockstep, about, &record.progress().beside))
            }
        };
        if let Some(scope) = self.audited() {
            let audited = AuditedRun::new(stepping, &scene, &set, (precision, scope)).with_context(file)?;
            let kept = &record.progress().intrusions;
            stepping = Box::new(IntrusionRecorder::new(Box::new(audited), &scene, &set, (precision, scope), kept));
        }
        let stop = on_ctrl_c()?;
        let mut display = Display::new();
        let run = Run { scene: &scene, begin: &begin, precision, plan, about };
        let ending = run.run(&mut *stepping, &mut record, &stop, &mut |report, state| {
            if let Some(watch) = &mut standstill {
                watch.look(report, state);
            }
            display.show(report, &plan, state);
        })?;
        display.end();
        if ending != Ending::Interrupted {
            find_causes::<R>(&mut record, &scene, &set, precision)?;
        }
        let volume = VolumeChange::of(&scene, &begin, stepping.state());
        let stretch = Stretch::of(&scene, &begin, stepping.state());
        let is_linear = scene.simulation.control.kinematics == Kinematics::Linear;
        let standstill = standstill.and_then(|watch| Some((watch.found()?, precision)));
        let known = KnownOfBlocks { overlaps, volume, stretch, standstill, is_linear, violated };
        self.format.print(
            || summary(&record, stepping.state(), &ending, &known),
            || document(&record, stepping.state(), &ending, &known),
        )?;
        let audit = &record.progress().totals.audit;
        Ok(match ending {
            Ending::Finished if audit.as_ref().is_some_and(AuditTotals::finds_fault) => ExitStatus::CheckFailed,
            Ending::Finished => ExitStatus::Passed,
            Ending::Interrupted => ExitStatus::Interrupted,
            Ending::Stopped(stopped) => {
                let why = match stopped {
                    StepError::NotConverged { .. } if is_loose(&scene) => {
                        "; perhaps since nothing is fixed: --hold-lowest fixes the lowest blocks"
                    }
                    StepError::Singular { .. } => {
                        "; look at time_step, normal_stiffness, the stiffness of fixed points, young and density: they differ by more than the precision holds"
                    }
                    _ => "",
                };
                print_error(&format!("{stopped}{why}"));
                ExitStatus::CheckFailed
            }
            Ending::Diverged => ExitStatus::CheckFailed,
            Ending::Unproved(why) => {
                print_error(&format!("the oracle cannot make the step: {why}"));
                ExitStatus::CheckFailed
            }
        })
    }

    /// What of each step is looked at exactly, if anything.
    fn audited(&self) -> Option<AuditScope> {
        match (self.audit, self.no_audit) {
            (true, _) => Some(AuditScope::OverlapsAndPassages),
            (false, false) => Some(AuditScope::Overlaps),
            (false, true) => None,
        }
    }

    /// What of lockstep must be the same for a run to go on.
    fn lockstep_identity(&self) -> Map<String, Value> {
        let links = if self.links == LinksChoice::All { "all" } else { "arithmetic" };
        let all = [("lockstep", links.into()), ("states", self.states.into())];
        all.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// Of a run with another scene the first line that differs, in place of two digests.
fn name_changed_line(error: ResultsError, asked: &str) -> ResultsError {
    let ResultsError::OtherIdentity { dir, owner, mut differences } = error else { return error };
    let run = read_text(dir.join("scene.toml")).unwrap_or_default();
    if let (Some(of_scene), Some(told)) =
        (differences.iter_mut().find(|difference| difference.starts_with("scene: ")), first_difference(&run, asked))
    {
        *of_scene = told;
    }
    ResultsError::OtherIdentity { dir, owner, differences }
}

/// The first line in which the scene of a run and another differ, tolerances aside, which have lines of their own; `None` where there is no scene, or they are alike.
fn first_difference(run: &str, asked: &str) -> Option<String> {
    fn without_tolerances(text: &str) -> impl Iterator<Item = (usize, &str)> {
        let mut is_inside = false;
        (1..).zip(text.lines()).filter(move |(_, line)| {
            is_inside = if line.starts_with('[') { *line == "[tolerances]" } else { is_inside };
            !is_inside && !line.trim().is_empty()
        })
    }
    if run.is_empty() {
        return None;
    }
    let (mut one, mut other) = (without_tolerances(run), without_tolerances(asked));
    let quoted = |line: Option<(usize, &str)>| {
        line.map_or("no more lines".to_owned(), |(_, line)| format!("`{}`", excerpt(line, EXCERPT_LENGTH)))
    };
    loop {
        let (was, is) = (one.next(), other.next());
        if was.is_none() && is.is_none() {
            return None;
        }
        if was.map(|(_, line)| line) != is.map(|(_, line)| line) {
            let place = was.map_or("its end".to_owned(), |(number, _)| format!("line {number}"));
            return Some(format!(
                "scene: {place} of scene.toml: the run has {}, asked for is {}",
                quoted(was),
                quoted(is)
            ));
        }
    }
}

/// That a run that goes on has all it was asked for.
fn already_done<R: Real>(dir: &Path, state: &State<R>, plan: &Plan) -> String {
    let asked: Vec<String> =
        [plan.steps.map(|steps| counted(steps, "step", "steps")), plan.time.map(|time| format!("{} s", short(time)))]
            .into_iter()
            .flatten()
            .collect();
    format!(
        "{} has {} and {} s already, and {} were asked for: no step was made; more --steps or --time goes on",
        dir.display(),
        counted(state.step, "step", "steps"),
        short(state.time.to_f64()),
        asked.join(" or ")
    )
}

fn has_fixed_block(scene: &Scene) -> bool {
    scene.blocks.iter().any(|block| block.body.is_fixed())
}

/// Whether a model of several blocks falls as a whole, since there is gravity and nothing is fixed.
fn is_loose(scene: &Scene) -> bool {
    let has_gravity = scene.simulation.gravity.components().into_iter().any(|part| *part != Number::ZERO);
    has_gravity && scene.blocks.len() > 1 && !has_fixed_block(scene) && scene.simulation.fixed_points.is_empty()
}

/// A bar on a terminal, a line now and then otherwise.
struct Display {
    bar: Option<ProgressBar>,
    last: Instant,
}

impl Display {
    /// Places of the bar.
    const LENGTH: f64 = 1000.0;

    fn new() -> Display {
        let bar = shows_progress().then(|| {
            let bar = ProgressBar::new(Self::LENGTH as u64);
            if let Ok(style) = ProgressStyle::with_template("{bar:30} {msg}, {eta} left") {
                bar.set_style(style);
            }
            bar
        });
        Display { bar, last: Instant::now() }
    }

    fn show<R: Real>(&mut self, report: &StepReport, plan: &Plan, state: &State<R>) {
        match &self.bar {
            Some(bar) => {
                bar.set_position((plan.done(state) * Self::LENGTH) as u64);
                bar.set_message(line(report));
            }
            None if self.last.elapsed() > Duration::from_secs(10) => {
                self.last = Instant::now();
                print_note(&format!("{:.0} % done: {}", 100.0 * plan.done(state), line(report)));
            }
            None => {}
        }
    }

    fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A step in one line.
fn line(report: &StepReport) -> String {
    let contacts: u32 = report.contacts.iter().flatten().sum();
    format!(
        "{}, {} s, Δt {} s, {}, {}, {} J kinetic, {} J potential",
        step_in_words(report.step),
        short(report.time),
        short(report.time_step),
        counted(contacts.into(), "contact", "contacts"),
        counted(report.iterations.into(), "iteration", "iterations"),
        short(report.kinetic),
        short(report.potential())
    )
}

/// Three significant digits.
fn short(value: f64) -> String {
    let near: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let plain = near == 0.0 || (1e-4..1e6).contains(&near.abs());
    if plain { near.to_string() } else { format!("{near:e}") }
}

/// The same as [`summary`] for programs.
fn document<R: Real>(record: &RunRecord, state: &State<R>, ending: &Ending, known: &KnownOfBlocks) -> Value {
    let RunProgress { totals, seconds, beside, .. } = record.progress();
    let reason = match ending {
        Ending::Stopped(stopped) => Some(stopped.to_string()),
        Ending::Unproved(why) => Some(why.clone()),
        Ending::Finished | Ending::Interrupted | Ending::Diverged => None,
    };
    let name = match ending {
        Ending::Finished => "finished",
        Ending::Interrupted => "interrupted",
        Ending::Stopped(_) => "stopped",
        Ending::Diverged => "first difference",
        Ending::Unproved(_) => "oracle cannot step",
    };
    let retries = totals.retries_by_reason().into_iter().map(|(why, count)| (why.replace('-', "_"), count.into()));
    let [open, sliding, locked] = totals.contacts;
    let extreme = |extreme: Extreme| {
        let is_any = extreme.value.0 > 0.0;
        json!({ "value": extreme.value.0, "step": is_any.then_some(extreme.step) })
    };
    let lockstep = beside.get("steps").map(|steps| {
        let count = |name: &str| beside.get(name).copied().unwrap_or(0);
        let by_cause = table::CAUSES.iter().map(|&cause| (cause.to_string(), differences(beside, cause).into()));
        json!({
            "steps": steps,
            "steps_differing": count("steps_differing"),
            STEPS_WITHOUT_CONTACTS: count(STEPS_WITHOUT_CONTACTS),
            "differences": by_cause.collect::<Map<String, Value>>(),
            "undecided": count("undecided"),
            "oracle_seconds": count("oracle_microseconds") as f64 / 1e6,
            "stepper_seconds": count("stepper_microseconds") as f64 / 1e6,
        })
    });
    let audit = totals.audit.as_ref().map(|audit| {
        let worst = |pair: Option<PairExtreme>| {
            pair.map(|pair| json!({ "blocks": pair.blocks, "depth_m": pair.depth_m.0, "step": pair.step }))
        };
        let entrances = |of: &FalseEntranceSteps| {
            of.first.map(|first| {
                json!({ "steps": of.steps, "blocks": first.blocks, "into": first.into, "share": first.share.0, "first_step": first.step, "most_share": of.most.0 })
            })
        };
        let FalseEntranceTotals { unmet, covered, .. } = &audit.false_entrances;
        json!({
            "objects": audit.finds_fault(),
            "steps": audit.steps,
            "steps_unseen": audit.steps_unseen,
            "most_unseen_pairs": audit.most_unseen,
            "worst_unseen": worst(audit.worst_unseen),
            "steps_explained": audit.steps_explained,
            "most_explained_pairs": audit.most_explained,
            "worst_explained": worst(audit.worst_explained),
            "deepest": worst(audit.deepest),
            "steps_deep": audit.steps_deep,
            "steps_past_middle": audit.steps_past_middle,
            "first_past_middle": worst(audit.first_past_middle),
            "false_entrances": { "unmet": entrances(unmet), "covered": entrances(covered) },
            "passages": audit.passages,
            "worst_passage": worst(audit.worst_passage),
            "undecided_passages": audit.undecided,
        })
    });
    json!({
        "ending": name,
        "reason": reason,
        "time_s": state.time.to_f64(),
        "steps": totals.steps,
        "settling_steps": totals.settling,
        "settled_displacement_m": totals.settled.map(|moved| moved.0),
        "smallest_time_step_s": totals.smallest_step.map(|step| step.0),
        "iterations": totals.iterations,
        "most_iterations": totals.most_iterations,
        "unconverged": totals.unconverged,
        "friction_not_settled": (totals.unsettled > 0).then(|| json!({ "steps": totals.unsettled, "worst_share": totals.friction_left.value.0, "worst_step": totals.friction_left.step })),
        "rules_violated": known.violated,
        "retries": retries.collect::<Map<String, Value>>(),
        "contacts": { "open": open, "sliding": sliding, "locked": locked },
        "deepest_contact_m": extreme(totals.deepest),
        "largest_displacement_m": extreme(totals.furthest),
        "kinetic_j": totals.kinetic.0,
        "potential_j": totals.potential.0,
        "energy_gained": totals.balance.gain.map(|gain| json!({ "energy_j": gain.energy.0, "held_j": gain.held.0, "from_step": gain.from, "to_step": gain.to })),
        "standing_still": known.standstill.map(|(of, _)| json!({ "block": of.worst, "axis": of.axis, "speed_m_s": of.speed, "since_step": of.since, "missing_m": of.missing, "blocks": of.blocks })),
        "volume_change": known.volume.map(|of| json!({ "block": of.worst, "factor": of.factor, "blocks": of.blocks })),
        "strained": known.stretch.map(|of| json!({ "block": of.worst, "shortest": of.least, "longest": of.most, "blocks": of.blocks })),
        "lockstep": lockstep,
        "audit": audit,
        "intrusions": totals.audit.as_ref().map(|_| causes_json(record.intrusions())),
        "overlaps_at_start": known.overlaps,
        "seconds": seconds,
        "directory": record.dir().display().to_string(),
        "files": record.names(),
    })
}

fn summary<R: Real>(record: &RunRecord, state: &State<R>, ending: &Ending, known: &KnownOfBlocks) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_summary(&mut out, record, state, ending, known);
    out
}

fn write_summary<R: Real>(
    out: &mut String,
    record: &RunRecord,
    state: &State<R>,
    ending: &Ending,
    known: &KnownOfBlocks,
) -> std::fmt::Result {
    let RunProgress { totals, seconds, .. } = record.progress();
    let overlaps = known.overlaps.as_deref();
    let audit = totals.audit.as_ref();
    // What makes all the rest worthless comes first.
    if let Some(audit) = audit.filter(|audit| audit.finds_fault()) {
        writeln!(out, "audit            {}\n", audit.verdict())?;
    }
    let all = totals.steps + totals.settling;
    let time = state.time.to_f64();
    writeln!(out, "time             {} s after {}", short(time), counted(totals.steps, "step", "steps"))?;
    if totals.settling > 0 {
        let moved = totals
            .settled
            .map_or(String::new(), |moved| format!("; in the last a vertex moved {} m at most", short(moved.0)));
        writeln!(out, "settling         {} before{moved}", counted(totals.settling, "step", "steps"))?;
    }
    if all == 0 {
        writeln!(out, "measured         nothing: no step was made")?;
        if let Some(sentence) = overlaps.filter(|_| audit.is_none()) {
            writeln!(out, "model            {sentence}")?;
        }
        return write_end(out, record, ending);
    }
    let smallest = totals.smallest_step.map_or("–".to_owned(), |s| short(s.0));
    // Iterations and retries are of all steps.
    let left_out = if totals.settling > 0 { ", settling left out" } else { "" };
    writeln!(out, "smallest Δt      {smallest} s{left_out}")?;
    let mean = totals.iterations as f64 / all.max(1) as f64;
    writeln!(out, "iterations       {mean:.2} a step, at most {}", totals.most_iterations)?;
    writeln!(out, "unconverged      {}", counted(totals.unconverged, "step", "steps"))?;
    if let Some(sentence) = totals.unsettled_in_words() {
        writeln!(out, "friction         {sentence}")?;
    }
    if let Some(sentence) = audit.and_then(|audit| audit.false_entrances.sentence()) {
        writeln!(out, "false entrances  {sentence}")?;
    }
    let retries: Vec<String> =
        totals.retries_by_reason().iter().map(|(why, count)| format!("{} {why}", grouped(*count))).collect();
    writeln!(out, "retries          {}", retries.join(", "))?;
    let [open, sliding, locked] = totals.contacts.map(grouped);
    writeln!(out, "contacts         {open} open, {sliding} sliding, {locked} locked")?;
    let at = |extreme: Extreme| {
        let step = if extreme.value.0 > 0.0 { format!(" in {}", step_in_words(extreme.step)) } else { String::new() };
        format!("{} m at most{step}", short(extreme.value.0))
    };
    match audit {
        Some(audit) => writeln!(out, "penetration      {}", audit.deepest_in_words())?,
        // The gaps of contacts say nothing of overlaps that no contact sees.
        None => {
            writeln!(out, "in contacts      overlap of {}, to first order; others are not known", at(totals.deepest))?
        }
    }
    writeln!(out, "displacement     {}", at(totals.furthest))?;
    writeln!(out, "energy           {} J kinetic, {} J potential", short(totals.kinetic.0), short(totals.potential.0))?;
    if let Some(gain) = totals.balance.gain {
        writeln!(out, "gained           {}", gain.sentence(known.is_linear))?;
    }
    if let Some((found, precision)) = &known.standstill {
        writeln!(out, "standing still   {}", found.sentence(precision.name()))?;
    }
    if let Some(volume) = &known.volume {
        writeln!(out, "volume           {}", volume.sentence())?;
    }
    if let Some(stretch) = &known.stretch {
        writeln!(out, "strain           {}", stretch.sentence())?;
    }
    write_lockstep(out, &record.progress().beside)?;
    match (audit, overlaps) {
        (Some(audit), _) if audit.finds_fault() => {}
        (Some(audit), _) => writeln!(out, "audit            {}", audit.verdict())?,
        (None, Some(sentence)) => writeln!(out, "model            {sentence}; without --no-audit they are followed")?,
        (None, None) => {}
    }
    write_causes(out, record.intrusions())?;
    let speed = all as f64 / seconds.max(1e-9);
    writeln!(out, "\n{} in {seconds:.1} s ({speed:.0} a second)", counted(all, "step", "steps"))?;
    write_end(out, record, ending)
}

/// How it ended, and where its files are.
fn write_end(out: &mut String, record: &RunRecord, ending: &Ending) -> std::fmt::Result {
    match ending {
        Ending::Finished => {}
        Ending::Interrupted if record.can_be_resumed() => writeln!(out, "interrupted; --resume goes on")?,
        Ending::Interrupted => writeln!(out, "interrupted; what was done is kept, but --free cannot be resumed")?,
        Ending::Stopped(_) => writeln!(out, "stopped; the last good state is kept")?,
        Ending::Diverged => writeln!(out, "ended at the first difference")?,
        Ending::Unproved(_) => writeln!(out, "ended: the oracle cannot make the step")?,
    }
    writeln!(out, "written to {}: {}", record.dir().display(), record.names().join(", "))
}

/// What lockstep found, where it was asked.
fn write_lockstep(out: &mut String, counts: &BTreeMap<String, u64>) -> std::fmt::Result {
    let Some(steps) = counts.get("steps") else { return Ok(()) };
    let count = |name: &str| counts.get(name).copied().unwrap_or(0);
    let by_cause: Vec<String> =
        table::CAUSES.iter().map(|&cause| format!("{} {cause}", grouped(differences(counts, cause)))).collect();
    let all = counted(*steps, "step differs", "steps differ");
    let nothing = if count(STEPS_WITHOUT_CONTACTS) == *steps { "; no blocks touched in any of them" } else { "" };
    writeln!(out, "lockstep         {} of {all}{nothing}", grouped(count("steps_differing")))?;
    writeln!(out, "differences      {}", by_cause.join(", "))?;
    writeln!(out, "undecided        {} of the oracle", counted(count("undecided"), "decision", "decisions"))?;
    let ratio = count("oracle_microseconds") as f64 / count("stepper_microseconds").max(1) as f64;
    writeln!(out, "cost             the oracle and comparing took {} times the stepper's time", short(ratio))
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn shows_three_digits() {
        let all = [0.0, 0.5, 0.009_999_999_776, -12.345, 1234.5, 6.76e-5, 1.3e6, -2e-300, f64::INFINITY];
        let shown = ["0", "0.5", "0.01", "-12.3", "1230", "6.76e-5", "1.3e6", "-2e-300", "inf"];
        assert_eq!(all.map(short), shown);
    }
}
