//! Pins what a run leaves on disk, with steps that a small stand-in makes: a run killed after any step, taken up again,
//! gives the bytes of one that was not; the pictures are what VTK's format asks for; a run that cannot go on keeps its last
//! good state; a checkpoint of another run, or a damaged one, is refused.

// Longer than 400 lines: the life of one directory, from its first step to a damaged file, in order.

use base64::Engine;
use rockproof_model::{
    Block, Contact, ContactKey, ContactKind, Entrance, FaceId, Number, Scene, SceneBlock, Sign, ToleranceSpec, Vec3,
    VertexId,
};
use rockproof_results::{ResultsError, Start};
use rockproof_simulate::identity::identity;
use rockproof_simulate::run::{Ending, Run, Stepping, headers};
use rockproof_simulate::{Plan, RunRecord};
use rockproof_stepper::Vector;
use rockproof_stepper::dynamics::{
    BlockState, ContactState, Mode, ModeChange, Retry, RetryReason, State, StepError, StepReport,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

fn point(x: i32, y: i32, z: i32) -> Vec3<Number> {
    Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z))
}

/// Two boxes, the upper one measured at a corner.
fn scene() -> Scene {
    let boxes = [("floor", point(0, 0, 0), point(4, 4, 1)), ("block", point(1, 1, 1), point(2, 3, 2))];
    let block = |(name, min, max): (&str, _, _)| SceneBlock::new(name, Block::cuboid(&min, &max).expect("a box"));
    let mut scene = Scene { blocks: boxes.into_iter().map(block).collect(), ..Scene::default() };
    let corner =
        rockproof_model::simulation::MeasuredPoint { name: "corner, top".into(), block: 1, at: point(2, 3, 2) };
    scene.simulation.measured_points.push(corner);
    scene
}

fn begin(scene: &Scene, settling: u32) -> State<f64> {
    let vector = |v: &Vec3<Number>| {
        let [x, y, z] = v.components().map(Number::approximate);
        Vector::new(x, y, z)
    };
    let block = |block: &SceneBlock| BlockState {
        vertices: block.block.vertices().iter().map(vector).collect(),
        velocity: [0.0; 12],
        stress: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
    };
    State {
        step: 0,
        time: 0.0,
        settling,
        last_time_step: scene.simulation.control.time_step.approximate(),
        blocks: scene.blocks.iter().map(block).collect(),
        load_points: Vec::new(),
        fixed_points: Vec::new(),
        measured_points: scene.simulation.measured_points.iter().map(|p| vector(&p.at)).collect(),
        contacts: Vec::new(),
    }
}

/// Moves block 1 along by amounts that have no short decimals; cannot make step `wall`.
struct StandIn {
    state: State<f64>,
    wall: i64,
}

impl Stepping<f64> for StandIn {
    fn step(&mut self) -> Result<StepReport, StepError> {
        let settling = self.state.settling > 0;
        let step = if settling { 1 - i64::from(self.state.settling) } else { self.state.step as i64 + 1 };
        if step == self.wall {
            let concerned = ModeChange {
                blocks: [0, 1],
                contact: ContactKey::VertexFace(VertexId(7), FaceId(3)),
                from: Mode::Sliding,
                to: Mode::Open,
            };
            return Err(StepError::NotConverged { step, time_step: 1e-5, contacts: vec![concerned] });
        }
        let k = step as f64;
        let moved = Vector::new(0.1 / (k.abs() + 3.0), 1e-3 / 3.0 * (k + 9.0), (k * 0.7).abs().sqrt());
        let vertices = self.state.blocks[1].vertices.iter_mut();
        vertices.chain(&mut self.state.measured_points).for_each(|p| *p = *p + moved);
        self.state.blocks[1].velocity[0] += 1.0 / 3.0;
        if settling {
            self.state.settling -= 1;
        } else {
            self.state.step += 1;
            self.state.time += 0.01;
        }
        let entrance = Entrance::FaceVertex(FaceId(1), VertexId(2));
        let contact = ContactState {
            blocks: [0, 1],
            contact: Contact { key: ContactKey::FaceVertex(FaceId(1), VertexId(2)), entrance, gap: Sign::Negative },
            mode: if step % 2 == 0 { Mode::Locked } else { Mode::Sliding },
            anchors: [moved, moved],
            gap: -1e-9 / 3.0,
            normal: Vector::new(0.0, 0.0, -1.0),
            points: [moved, moved],
            force: Vector::new(0.1, -0.0, 2.0 / 3.0),
        };
        self.state.contacts = vec![contact; (step.unsigned_abs() % 3) as usize];
        let mut contacts = [[0; 3]; 6];
        contacts[ContactKind::FaceVertex as usize][1] = self.state.contacts.len() as u32;
        let retries = [Retry { time_step: 0.01, why: RetryReason::NotConverged }];
        Ok(StepReport {
            step,
            time: self.state.time,
            time_step: 0.01,
            iterations: 2,
            converged: step != 5,
            friction_left: 0.0,
            retries: retries.repeat((step % 4 == 3) as usize),
            contacts,
            max_penetration: 1e-9 / 3.0,
            max_displacement: moved.length(),
            kinetic: k * k,
            gravitational: 0.1 * k,
            elastic: 0.2,
            springs: 0.3,
        })
    }

    fn state(&self) -> &State<f64> {
        &self.state
    }
}

const NOWHERE: i64 = i64::MAX;

/// What a run is asked to do.
#[derive(Clone, Copy)]
struct Job {
    steps: u64,
    settling: u32,
    wall: i64,
    start: Start,
}

const JOB: Job = Job { steps: 13, settling: 4, wall: NOWHERE, start: Start::Fresh };

fn run(dir: &Path, job: Job, stop: &AtomicBool, watch: &mut dyn FnMut(i64)) -> Result<Ending, ResultsError> {
    let scene = scene();
    let plan = Plan { steps: Some(job.steps), time: None, smallest_step: 1e-5, every: 4, contacts: true };
    let set = ToleranceSpec::default().derive(&scene.shapes(), rockproof_model::Precision::F64).expect("a set");
    let identity = identity(&scene, &set, "f64", &plan);
    let (mut record, saved) = RunRecord::open(dir, identity, headers(&plan).expect("headers"), job.start)?;
    let begin = begin(&scene, job.settling);
    let state = saved.map_or(begin.clone(), |saved| saved.state().expect("a state"));
    let mut stepping = StandIn { state, wall: job.wall };
    let run = Run {
        scene: &scene,
        begin: &begin,
        precision: rockproof_model::Precision::F64,
        plan,
        about: Default::default(),
    };
    let ending = run.run(&mut stepping, &mut record, stop, &mut |report, _| watch(report.step));
    Ok(ending.expect("a run"))
}

fn simply(dir: &Path, job: Job) -> Result<Ending, ResultsError> {
    run(dir, job, &AtomicBool::new(false), &mut |_| {})
}

/// All files with their bytes, but those that tell of seconds.
fn files(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in [dir.to_owned(), dir.join("frames")] {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.strip_prefix(dir).expect("inside").to_string_lossy().into_owned();
            if path.is_file() && !["run.json", "checkpoint.jsonl"].contains(&name.as_str()) {
                found.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    found
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to.join("frames")).expect("folders");
    for folder in ["", "frames"] {
        for entry in fs::read_dir(from.join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_file() {
                fs::copy(&path, to.join(folder).join(path.file_name().expect("a name"))).expect("a copy");
            }
        }
    }
}

fn json(file: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(file).expect("a file")).expect("JSON")
}

#[test]
fn a_run_killed_after_any_step_goes_on_to_the_same_bytes() {
    let dir = crate::place::folder();
    let whole = dir.path().join("whole");
    let mut killed = Vec::new();
    let kill = &mut |step: i64| {
        // What a kill right after this step would leave, and half a row and half a picture more.
        let copied = dir.path().join(format!("killed{step}"));
        copy(&whole, &copied);
        let steps = copied.join("steps.csv");
        let text = [fs::read(&steps).expect("steps"), b"9,0.".to_vec()].concat();
        fs::write(&steps, text).expect("write");
        fs::write(copied.join(".checkpoint.jsonl.7.1.tmp"), "{").expect("write");
        killed.push(copied);
    };
    assert_eq!(run(&whole, JOB, &AtomicBool::new(false), kill).expect("a run"), Ending::Finished);
    assert_eq!(killed.len(), 17, "after each of 4 + 13 steps");
    let expected = files(&whole);
    assert_eq!(expected["steps.csv"].iter().filter(|b| **b == b'\n').count(), 18);
    for copied in killed {
        assert_ne!(files(&copied), expected);
        assert_eq!(simply(&copied, Job { start: Start::Resume, ..JOB }).expect("resumed"), Ending::Finished);
        assert_eq!(files(&copied), expected, "{}", copied.display());
        assert_eq!(json(&copied.join("run.json"))["resumed"], 1);
    }
}

#[test]
fn a_run_asked_to_stop_goes_on_to_the_same_bytes() {
    let dir = crate::place::folder();
    let [whole, parts] = ["whole", "parts"].map(|name| dir.path().join(name));
    simply(&whole, JOB).expect("a run");
    // Stopped after every single step.
    let mut sessions = 0;
    loop {
        let stop = AtomicBool::new(false);
        let job = Job { start: Start::Resume, ..JOB };
        let ending = run(&parts, job, &stop, &mut |_| stop.store(true, Ordering::Relaxed)).expect("a run");
        sessions += 1;
        assert_eq!(json(&parts.join("run.json"))["resumed"], sessions - 1);
        if ending == Ending::Finished {
            break;
        }
        assert_eq!(ending, Ending::Interrupted);
    }
    assert_eq!(sessions, 17);
    assert_eq!(files(&parts), files(&whole));
    assert_eq!(json(&parts.join("run.json"))["totals"], json(&whole.join("run.json"))["totals"]);
}

#[test]
fn a_run_can_be_made_longer() {
    let dir = crate::place::folder();
    let [whole, longer] = ["whole", "longer"].map(|name| dir.path().join(name));
    simply(&whole, JOB).expect("a run");
    simply(&longer, Job { steps: 6, ..JOB }).expect("a run");
    assert!(longer.join("frames/blocks_000006.vtu").exists(), "the end has a frame");
    simply(&longer, Job { start: Start::Resume, ..JOB }).expect("a run");
    assert_eq!(files(&longer), files(&whole));
    // Nothing left to do is no error and changes nothing.
    simply(&longer, Job { start: Start::Resume, ..JOB }).expect("a run");
    assert_eq!(files(&longer), files(&whole));
}

#[test]
fn a_run_that_cannot_go_on_keeps_its_last_good_state() {
    let dir = crate::place::folder();
    let out = dir.path().join("out");
    let Ending::Stopped(stopped) = simply(&out, Job { wall: 7, ..JOB }).expect("a run") else { panic!("it went on") };
    assert!(
        stopped.to_string().contains("step 7") && stopped.to_string().contains("v-f 7,3 of blocks 0,1"),
        "{stopped}"
    );
    let run = json(&out.join("run.json"));
    assert_eq!((&run["ending"], &run["step"]), (&"stopped".into(), &6.into()));
    let contact = serde_json::json!({
        "blocks": [0, 1], "kind": "v-f", "features": [7, 3], "from": "sliding", "to": "open"
    });
    assert_eq!((&run["stopped"]["step"], &run["stopped"]["contacts"]), (&7.into(), &serde_json::json!([contact])));
    let pvd = fs::read_to_string(out.join("blocks.pvd")).expect("a list");
    assert!(out.join("frames/blocks_000006.vtu").exists() && pvd.contains("blocks_000006.vtu"), "{pvd}");
    // Without the wall it goes on from there as if nothing had been.
    simply(&out, Job { start: Start::Resume, ..JOB }).expect("a run");
    let whole = dir.path().join("whole");
    simply(&whole, JOB).expect("a run");
    assert_eq!(files(&out), files(&whole));
}

#[test]
fn other_runs_and_damaged_ones_are_refused() {
    let dir = crate::place::folder();
    let out = dir.path().join("out");
    simply(&out, JOB).expect("a run");
    assert!(matches!(simply(&out, JOB), Err(ResultsError::Occupied { .. })));
    let resume = Job { start: Start::Resume, ..JOB };
    let checkpoint = out.join("checkpoint.jsonl");
    let good = fs::read_to_string(&checkpoint).expect("a checkpoint");
    let refused = |text: &str, told: &str| {
        fs::write(&checkpoint, text).expect("write");
        let error = simply(&out, resume).expect_err("refused").to_string();
        assert!(error.contains(told) && error.contains("--overwrite"), "{error}");
    };
    let half = good.len() / 2;
    refused(&good[..half], "no seal");
    refused("", "no seal");
    refused(&good.replacen("\"step\":13", "\"step\":12", 1), "not as it was written");
    let reseal = |line: &str| {
        let sha256 = rockproof_results::digest(line.as_bytes());
        format!("{line},\"sha256\":\"{sha256}\"}}\n")
    };
    let (_, last) = good.rsplit_once(",\"sha256\":\"").expect("a seal");
    let first = &good[..good.len() - last.len() - ",\"sha256\":\"".len()];
    assert_eq!(reseal(first), good);
    refused(&reseal(&first.replacen("\"engine\":\"f64\"", "\"engine\":\"f32\"", 1)), "engine: the run has \"f32\"");
    refused(&reseal(&first.replacen("\"search\":\"", "\"search\":\"1", 1)), "search: the run has \"1");
    refused(&reseal(&first.replacen("\"frames\"", "\"frame\"", 1)), "unknown field `frame`");
    fs::write(&checkpoint, &good).expect("write");
    let steps = out.join("steps.csv");
    let rows = fs::read(&steps).expect("rows");
    fs::write(&steps, &rows[..100]).expect("write");
    refused(&good, "100 bytes long");
    // A fresh start leaves what is not its own.
    fs::write(out.join("notes.txt"), "mine").expect("write");
    simply(&out, Job { start: Start::Overwrite, ..JOB }).expect("a run");
    assert_eq!(fs::read(&steps).expect("rows"), rows);
    assert!(out.join("notes.txt").exists());
}

/// The numbers of one array of a VTK file, eight bytes each.
fn values<T>(file: &roxmltree::Document, place: &str, name: &str, read: fn([u8; 8]) -> T) -> Vec<T> {
    let inside = file.descendants().find(|n| n.has_tag_name(place)).unwrap_or_else(|| panic!("no {place}"));
    let array = inside.children().find(|n| n.attribute("Name") == Some(name)).unwrap_or_else(|| panic!("no {name}"));
    let text = array.text().expect("data");
    let bytes = base64::engine::general_purpose::STANDARD.decode(text.trim()).expect("base64");
    let length = u64::from_le_bytes(bytes[..8].try_into().expect("8 bytes"));
    assert_eq!(length as usize, bytes.len() - 8, "{name}");
    bytes[8..].chunks_exact(8).map(|eight| read(eight.try_into().expect("8 bytes"))).collect()
}

#[test]
fn the_pictures_are_what_the_format_asks_for() {
    let dir = crate::place::folder();
    let out = dir.path().join("out");
    simply(&out, JOB).expect("a run");
    let text = fs::read_to_string(out.join("blocks.pvd")).expect("a list");
    let list = roxmltree::Document::parse(&text).expect("XML");
    let sets: Vec<_> = list.descendants().filter(|n| n.has_tag_name("DataSet")).collect();
    let listed: Vec<_> = sets.iter().map(|n| n.attribute("file").expect("a file")).collect();
    assert_eq!(listed, [0, 4, 8, 12, 13].map(|step| format!("frames/blocks_{step:06}.vtu")));
    assert_eq!(sets[1].attribute("timestep"), Some("0.04"));

    let text = fs::read_to_string(out.join(listed[1])).expect("a picture");
    let file = roxmltree::Document::parse(&text).expect("XML");
    let root = file.root_element();
    assert_eq!((root.attribute("type"), root.attribute("header_type")), (Some("UnstructuredGrid"), Some("UInt64")));
    let piece = file.descendants().find(|n| n.has_tag_name("Piece")).expect("a piece");
    assert_eq!((piece.attribute("NumberOfPoints"), piece.attribute("NumberOfCells")), (Some("16"), Some("2")));
    let [float, integer] = [f64::from_le_bytes, |b| i64::from_le_bytes(b) as f64];
    assert_eq!(values(&file, "Cells", "offsets", integer), [8.0, 16.0]);
    assert_eq!(values(&file, "Cells", "connectivity", integer), (0..16).map(f64::from).collect::<Vec<_>>());
    let faces = values(&file, "Cells", "faces", integer);
    assert_eq!(values(&file, "Cells", "faceoffsets", integer), [31.0, 62.0]);
    // Each cell: six faces of four points, which are its own and each in three faces.
    for (cell, stream) in faces.chunks_exact(31).enumerate() {
        assert_eq!(stream[0], 6.0);
        let corners: Vec<f64> = stream[1..].chunks_exact(5).flat_map(|face| face[1..].to_vec()).collect();
        for point in 8 * cell..8 * cell + 8 {
            assert_eq!(corners.iter().filter(|c| **c == point as f64).count(), 3);
        }
    }
    let points = values(&file, "Points", "Points", float);
    let displacement = values(&file, "PointData", "displacement", float);
    assert!(displacement[..24].iter().all(|d| *d == 0.0) && displacement[24..].iter().all(|d| *d != 0.0));
    let first = [1.0, 1.0, 1.0];
    assert!((0..3).all(|k| (points[24 + k] - displacement[24 + k] - first[k]).abs() < 1e-12), "{points:?}");
    assert_eq!(
        values(&file, "PointData", "velocity", float)[24..27],
        [(0..8).fold(0.0, |v, _| v + 1.0 / 3.0), 0.0, 0.0]
    );
    assert_eq!(values(&file, "CellData", "block", integer), [0.0, 1.0]);
    assert_eq!(values(&file, "CellData", "volume", float)[0], 16.0);
    // (σx, σy, σz, τyz, τzx, τxy) = 1 … 6 in VTK's order xx, yy, zz, xy, yz, xz.
    assert_eq!(values(&file, "CellData", "stress", float)[..6], [1.0, 2.0, 3.0, 6.0, 4.0, 5.0]);

    let text = fs::read_to_string(out.join("frames/contacts_000008.vtu")).expect("a picture");
    let file = roxmltree::Document::parse(&text).expect("XML");
    assert_eq!(values(&file, "PointData", "mode", integer), [2.0, 2.0]);
    assert_eq!(values(&file, "PointData", "force", float)[..3], [0.1, -0.0, 2.0 / 3.0]);
    assert_eq!(values(&file, "Cells", "connectivity", integer), [0.0, 1.0]);
}

#[test]
fn the_tables_say_what_happened() {
    let dir = crate::place::folder();
    let out = dir.path().join("out");
    simply(&out, JOB).expect("a run");
    let rows = |name: &str| -> Vec<BTreeMap<String, String>> {
        csv::Reader::from_path(out.join(name)).expect("a table").deserialize().map(|row| row.expect("a row")).collect()
    };
    let steps = rows("steps.csv");
    let column = |name: &str| steps.iter().map(|row| row[name].as_str()).collect::<Vec<_>>();
    assert_eq!(column("step")[..6], ["-3", "-2", "-1", "0", "1", "2"]);
    assert_eq!(column("converged")[8], "false");
    assert_eq!((column("retries")[6], column("retries")[7]), ("not-converged@0.01", ""));
    assert_eq!((column("f-v_sliding")[5], column("contacts")[5], column("v-v_open")[5]), ("2", "2", "0"));
    assert_eq!(column("potential_J")[6], format!("{:?}", 0.1 * 3.0 + 0.2 + 0.3));
    let measured = rows("measured.csv");
    assert_eq!((measured.len(), measured[16]["point"].as_str()), (17, "corner, top"));
    let number = |row: &BTreeMap<String, String>, name: &str| row[name].parse::<f64>().expect("a number");
    assert_eq!(number(&measured[16], "x_m") - 2.0, number(&measured[16], "dx_m"));
    let contacts = rows("contacts.csv");
    let of_step = contacts.iter().filter(|row| row["step"] == "2").collect::<Vec<_>>();
    assert_eq!((of_step.len(), of_step[0]["mode"].as_str(), of_step[0]["force_y_N"].as_str()), (2, "locked", "-0.0"));
}
