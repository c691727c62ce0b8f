//! The table of docs/validation.md: lockstep over the first 200 steps of every scene of cases/handmade, in f64 and f32.
//!
//!     RENEW=1 cargo test --release --test differential lockstep_table -- --ignored --nocapture

use rockproof_differential::lockstep::table::CAUSES;
use rockproof_differential::lockstep::{ComparedLinks, ComparedStep, Lockstep};
use rockproof_model::{Precision, Scene};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::Solve;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const BEGIN: &str = "<!-- lockstep table: renewed by tests/differential/lockstep_table.rs -->\n";
const END: &str = "<!-- end of lockstep table -->\n";

/// What a run in lockstep comes to.
#[derive(Default)]
struct Sum {
    steps: usize,
    differing: usize,
    causes: [usize; 4],
    effects: [usize; 4],
    undecided: u64,
    displacement: f64,
    depths: [f64; 2],
    took: [f64; 2],
    failure: String,
}

const EFFECTS: [&str; 4] = ["none", "classification", "iteration", "arithmetic"];

impl Sum {
    fn add(&mut self, step: &ComparedStep) {
        self.steps += 1;
        self.differing += usize::from(step.differs());
        for (sum, cause) in self.causes.iter_mut().zip(CAUSES) {
            *sum += step.count(cause);
        }
        if let Some(depths) = &step.depths {
            let name = depths.effect().name();
            self.effects.iter_mut().zip(EFFECTS).filter(|(_, effect)| *effect == name).for_each(|(sum, _)| *sum += 1);
        }
        self.undecided += step.undecided;
        self.displacement = self.displacement.max(step.displacement.map_or(0.0, |(error, _)| error));
        for (deepest, depth) in self.depths.iter_mut().zip(step.penetration) {
            *deepest = deepest.max(depth.unwrap_or(0.0));
        }
        for (sum, took) in self.took.iter_mut().zip(step.took) {
            *sum += took.as_secs_f64();
        }
        self.failure.clone_from(&step.failure);
    }

    fn row(&self, scene: &str, engine: &str) -> String {
        let causes = self.causes.map(|count| count.to_string()).join(" | ");
        let [stepper, exact] = self.depths;
        format!(
            "| {scene} | {engine} | {} | {causes} | {:.1e} | {stepper:.6e} | {exact:.6e} |\n",
            self.steps, self.displacement
        )
    }

    /// What the table does not hold.
    fn beside(&self) -> String {
        let effects: Vec<String> =
            self.effects.iter().zip(EFFECTS).map(|(count, name)| format!("{count} {name}")).collect();
        let ratio = self.took[1] / self.took[0].max(1e-9);
        format!(
            "{} steps differ, {} undecided, effects {}; the oracle took {ratio:.1} times the stepper's time {}",
            self.differing,
            self.undecided,
            effects.join(", "),
            self.failure
        )
    }
}

fn run<R: Solve>(path: &Path, precision: Precision) -> Sum {
    let mut scene = Scene::load(path).unwrap();
    let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), precision).unwrap();
    scene.derive_stiffness(&set);
    let mut lockstep = Lockstep::<R, SpecRules>::new(&scene, &set, precision, ComparedLinks::All).unwrap();
    let mut sum = Sum::default();
    for _ in 0..STEPS {
        let (made, compared) = lockstep.step();
        sum.add(&compared);
        if made.is_err() || compared.unproved.is_some() {
            break;
        }
    }
    sum
}

/// How many steps of each scene.
const STEPS: usize = 200;

#[test]
#[ignore = "minutes; the command is at the head of this file"]
fn the_table_of_lockstep_is_what_runs_give() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(root.join("cases/handmade")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut table =
        "| scene | engine | steps | tolerance | representation | arithmetic | defect | displacement error | \
                     deepest, stepper (m) | deepest, exact (m) |\n| --- | --- |"
            .to_owned();
    table.push_str(&" ---: |".repeat(8));
    table.push('\n');
    let mut defects = Vec::new();
    for path in &files {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let both = [("f64", run::<f64>(path, Precision::F64)), ("f32", run::<f32>(path, Precision::F32))];
        for (engine, sum) in both {
            write!(table, "{}", sum.row(&name, engine)).unwrap();
            println!("{name} {engine}: {}", sum.beside());
            if sum.causes[3] > 0 || !sum.failure.is_empty() {
                defects.push(format!("{name} {engine}: {} defects, {}", sum.causes[3], sum.failure));
            }
        }
    }
    println!("{table}");
    assert!(defects.is_empty(), "{defects:?}");
    let page = root.join("docs/validation.md");
    let text = std::fs::read_to_string(&page).unwrap();
    let (before, rest) = text.split_once(BEGIN).expect("the table's beginning");
    let (old, after) = rest.split_once(END).expect("the table's end");
    if std::env::var_os("RENEW").is_some() {
        std::fs::write(&page, format!("{before}{BEGIN}{table}{END}{after}")).unwrap();
    } else {
        assert_eq!(old, table, "docs/validation.md is not what runs give; RENEW=1 renews it");
    }
}
