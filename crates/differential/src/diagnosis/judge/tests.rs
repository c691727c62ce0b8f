mod constants;
mod lag;

use super::*;
use crate::separation_state::{ReportedState, SeparationState};
use rockproof_model::preset::{self, Preset};
use rockproof_model::{BlockOptions, Number, Point, Precision, Sign};

/// A box of edge 1 that begins at x.
fn box_at(x: f64) -> Block {
    let number = |value: f64| Number::from_f64(value).expect("finite");
    let corner = |n: u32| {
        let [x, y, z] = [x + f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2)].map(number);
        Point::new(x, y, z)
    };
    let faces = [[0, 2, 3, 1], [0, 1, 5, 4], [0, 4, 6, 2], [1, 3, 7, 5], [2, 6, 7, 3], [4, 5, 7, 6]];
    let faces = faces.map(|face| face.to_vec()).to_vec();
    Block::new((0..8).map(corner).collect(), faces, &BlockOptions::default()).expect("a box")
}

/// A question about two boxes along x with a gap, and an answer to it.
fn question(gap: f64, said: ReportedState) -> Question {
    let blocks = [box_at(0.0), box_at(1.0 + gap)];
    let tolerances = preset::derive(Preset::Auto, &[&blocks[0], &blocks[1]], Precision::F64).expect("a set");
    let (precision, label) = (Precision::F64, format!("gap {gap}"));
    Question { blocks, tolerances, precision, accuracy: 1024, reply: Reply::State(said), label }
}

/// What a collision code says of a gap, right but for what `wrong` does.
fn said(gap: f64, wrong: impl Fn(&mut ReportedState)) -> ReportedState {
    let state = if gap > 0.0 { SeparationState::Apart } else { SeparationState::Overlapping };
    // A leaves B towards smaller x.
    let mut said = ReportedState { state, gap_m: Some(gap), normal: Some([-1.0, 0.0, 0.0]) };
    wrong(&mut said);
    said
}

fn first(wrong: impl Fn(&mut ReportedState)) -> Vec<(DiagnosisVerdict, String, u64)> {
    let differing = [0.5, 0.25, -0.25, -0.125].map(|gap| question(gap, said(gap, &wrong))).to_vec();
    // Answers that claim no gap and no normal are right whatever is wrong with these.
    let bare = |said: &mut ReportedState| (said.gap_m, said.normal) = (None, None);
    let agreeing = [0.5, -0.25].map(|gap| question(gap, said(gap, bare))).to_vec();
    let sample = Sample { differing, agreeing, all_differing: 4 };
    let rows = diagnose("mine", &sample, &|_, _| Reply::Nothing(crate::compare::AnswerChange::Crash), &|_| None);
    rows.into_iter().map(|row| (row.verdict, row.hypothesis, row.answers)).collect()
}

#[test]
fn collision_codes_are_told_what_is_wrong() {
    use DiagnosisVerdict::{Explains, NotRepeated, Unexplained};
    let told = |verdict, name: &str| vec![(verdict, name.to_owned(), 4)];
    assert_eq!(first(|said| said.normal = Some([1.0, 0.0, 0.0])), told(Explains, "normal-turned"));
    assert_eq!(first(|said| said.gap_m = said.gap_m.map(|gap| -gap)), told(Explains, "gap-sign-turned"));
    assert_eq!(first(|said| said.gap_m = said.gap_m.map(|gap| 1000.0 * gap)), told(Explains, "gap-in-millimetres"));
    assert_eq!(first(|said| said.gap_m = said.gap_m.map(|gap| gap + 0.3)), told(Unexplained, ""));
    assert_eq!(first(|_| {}), told(NotRepeated, ""));
}

#[test]
fn a_code_that_never_says_overlapping_is_told() {
    for called in [SeparationState::Touching, SeparationState::Apart] {
        let never = |gap| question(gap, ReportedState { state: called, gap_m: None, normal: None });
        // Not always the same: apart where they are, and touching where they do.
        let right = |gap| {
            let touching = ReportedState { state: SeparationState::Touching, gap_m: Some(0.0), normal: None };
            question(gap, if gap == 0.0 { touching } else { said(gap, |_| {}) })
        };
        let sample = Sample {
            differing: [-0.5, -0.25, -0.125].map(never).to_vec(),
            agreeing: [0.5, 0.0].map(right).to_vec(),
            all_differing: 3,
        };
        let diagnosed = |sample: &Sample| {
            let crash = Reply::Nothing(crate::compare::AnswerChange::Crash);
            let rows = diagnose("mine", sample, &|_, _| crash.clone(), &|_| None);
            let explains = rows.into_iter().filter(|row| row.verdict == DiagnosisVerdict::Explains);
            explains.map(|row| (row.hypothesis, row.answers)).collect::<Vec<_>>()
        };
        let name = format!("overlapping-is-{called}");
        assert_eq!(diagnosed(&sample), [(name.clone(), 3)]);
        // One that says it of some pairs is another.
        let sample = Sample { agreeing: [0.5, -0.375].map(right).to_vec(), ..sample };
        assert!(diagnosed(&sample).iter().all(|(explains, _)| *explains != name));
    }
}

/// Four pairs with contacts, each with the same answer, and a pair without contacts that is answered so.
fn of_replies(reply: &Reply) -> Vec<DiagnosisRow> {
    let with = |gap: f64, reply: Reply| Question { reply, ..question(gap, said(gap, |_| {})) };
    let differing = [0.0, 0.5, 1.0, 2.0].map(|gap| with(gap / 1048576.0, reply.clone())).to_vec();
    assert!(differing.iter().all(Question::has_contacts));
    let sample = Sample { differing, agreeing: vec![with(4.0, Reply::Contacts(Vec::new()))], all_differing: 4 };
    diagnose("mine", &sample, &|_, _| reply.clone(), &|_| None)
}

#[test]
fn an_engine_that_reports_no_contacts_is_told_just_that() {
    let rows = of_replies(&Reply::Contacts(Vec::new()));
    let told: Vec<_> = rows.iter().map(|row| (row.verdict, row.hypothesis.as_str(), row.answers)).collect();
    assert_eq!(told[0], (DiagnosisVerdict::Explains, "no-contacts", 4), "{rows:#?}");
    let words = rows[0].words().expect("words");
    assert!(words.contains("4 of 4 differing answers are exact but that no contact at all is reported"), "{words}");
}

#[test]
fn what_is_no_answer_is_not_diagnosed() {
    use crate::compare::AnswerChange::{Crash, Malformed, Timeout, Unstable, Unsupported};
    for change in [Malformed, Unsupported, Timeout, Unstable, Crash] {
        let rows = of_replies(&Reply::Nothing(change));
        assert!(rows.is_empty(), "{change}: {rows:#?}");
    }
}

#[test]
fn too_few_answers_show_nothing() {
    let turned = |said: &mut ReportedState| said.normal = Some([1.0, 0.0, 0.0]);
    let differing = [0.5, -0.25].map(|gap| question(gap, said(gap, turned))).to_vec();
    let sample = Sample { differing, agreeing: Vec::new(), all_differing: 2 };
    let rows = diagnose("mine", &sample, &|_, _| Reply::Nothing(crate::compare::AnswerChange::Crash), &|_| None);
    let told: Vec<_> = rows.iter().map(|row| (row.verdict, row.answers, row.example.as_str())).collect();
    assert_eq!(told, [(DiagnosisVerdict::Unexplained, 2, "gap 0.5")]);
}

/// What an exact engine finds that multiplies its search distance by ten.
fn found(blocks: &[Block; 2], tolerances: &ToleranceSet, factor: i32) -> Vec<Contact> {
    let mut tolerances = tolerances.clone();
    tolerances.search = tolerances.search.times(&Number::from_integer(factor));
    PreparedBlocks::of(blocks).pair().classify(&tolerances).contacts
}

/// The diagnosis of such an engine from boxes of which four are found beside the right ones, and others that are not, at so many search distances.
fn of_factor_ten(beyond: &[f64], answers_more: bool) -> Vec<DiagnosisRow> {
    let search = question(1.0, said(1.0, |_| {})).tolerances.search.approximate();
    let at = |gap: &f64| {
        let asked = question(gap * search, said(1.0, |_| {}));
        Question { reply: Reply::Contacts(found(&asked.blocks, &asked.tolerances, 10)), ..asked }
    };
    let differing = [2.5, 4.0, 5.0, 6.0].each_ref().map(at).to_vec();
    let sample = Sample { differing, agreeing: beyond.iter().map(at).collect(), all_differing: 4 };
    let asking = |blocks: &[Block; 2], tolerances: &ToleranceSet| {
        if answers_more {
            Reply::Contacts(found(blocks, tolerances, 10))
        } else {
            Reply::Nothing(crate::compare::AnswerChange::Crash)
        }
    };
    diagnose("mine", &sample, &asking, &|_| None)
}

#[test]
fn the_factor_that_explains_all_is_told_and_a_range_where_none_is_known() {
    let names = |rows: &[DiagnosisRow]| -> Vec<String> {
        let told =
            rows.iter().filter(|row| matches!(row.verdict, DiagnosisVerdict::Explains | DiagnosisVerdict::AsWell));
        told.map(|row| format!("{} {}", row.hypothesis, row.answers)).collect()
    };
    let rows = of_factor_ten(&[20.0], true);
    assert_eq!(names(&rows)[0], "search-times-10 4", "{rows:#?}");
    assert!(names(&rows).iter().all(|name| !name.contains("-more") && !name.contains(" to ")), "{rows:#?}");
    let rows = of_factor_ten(&[], false);
    assert!(names(&rows).contains(&"search-times-10-or-more 4".to_owned()), "{rows:#?}");
    assert!(rows.iter().all(|row| !row.hypothesis.contains("times-2")), "{rows:#?}");
}

#[test]
fn right_answers_that_a_hypothesis_would_change_are_looked_for() {
    let exact = |blocks: &[Block; 2], tolerances: &ToleranceSet| {
        Reply::Contacts(PreparedBlocks::of(blocks).pair().classify(tolerances).contacts)
    };
    let touching = || question(0.0, said(0.0, |_| {}));
    let wrong = || {
        let asked = touching();
        let Reply::Contacts(mut contacts) = exact(&asked.blocks, &asked.tolerances) else { panic!("contacts") };
        contacts
            .iter_mut()
            .filter(|contact| contact.gap == Sign::Zero)
            .for_each(|contact| contact.gap = Sign::Positive);
        Question { reply: Reply::Contacts(contacts), ..asked }
    };
    // Its one right answer has no contacts, which speaks against nothing.
    let agreeing = vec![Question { reply: Reply::Contacts(Vec::new()), ..question(4.0, said(4.0, |_| {})) }];
    let sample = Sample { differing: (0..4).map(|_| wrong()).collect(), agreeing, all_differing: 4 };
    let told = |others: OtherQuestions<'_>| {
        let rows = diagnose("mine", &sample, &exact, others);
        let of = rows.iter().find(|row| row.hypothesis == "gap-of-0-positive").expect("it explains all");
        (of.verdict, of.contradicted, of.agreeing)
    };
    assert_eq!(told(&|_| None), (DiagnosisVerdict::Explains, 0, 1));
    let (verdict, against, agreeing) =
        told(&|part| (part < 3).then(|| if part == 0 { Vec::new() } else { vec![touching()] }));
    assert_eq!((verdict, against), (DiagnosisVerdict::Contradicted, 1));
    assert!(agreeing > 1, "{agreeing}");
}

/// What is told of a collision code that answers like that about some gaps, and is right about others: explanations, with how many answers.
fn of_states(wrong: &dyn Fn(f64) -> ReportedState, differing: &[f64], agreeing: &[f64]) -> Vec<String> {
    let ask = |gap: &f64| question(*gap, wrong(question_gap(*gap)));
    let sample = Sample {
        differing: differing.iter().map(ask).collect(),
        agreeing: agreeing.iter().map(ask).collect(),
        all_differing: differing.len() as u64,
    };
    assert!(sample.differing.iter().all(|asked| asked.is_right() == Some(false)));
    assert!(sample.agreeing.iter().all(|asked| asked.is_right() == Some(true)));
    explanations(&diagnose("mine", &sample, &|_, _| Reply::Nothing(crate::compare::AnswerChange::Crash), &|_| None))
}

/// The gap between the boxes of a [`question`], whose coordinates are rounded.
fn question_gap(gap: f64) -> f64 {
    (1.0 + gap) - 1.0
}

fn explanations(rows: &[DiagnosisRow]) -> Vec<String> {
    let told = rows.iter().filter(|row| matches!(row.verdict, DiagnosisVerdict::Explains | DiagnosisVerdict::AsWell));
    told.map(|row| format!("{} {}", row.hypothesis, row.answers)).collect()
}

#[test]
fn gaps_in_another_unit_or_in_few_digits_are_told() {
    let gaps = [0.123_456_789, 0.031_415_926_5, -0.271_828_18, -0.077_777_777];
    let with = |change: fn(f64) -> f64| move |gap: f64| said(gap, |said| said.gap_m = said.gap_m.map(change));
    let told = |change: fn(f64) -> f64| of_states(&with(change), &gaps, &[]);
    let text = |text: String| text.parse::<f64>().expect("a number");
    assert_eq!(told(|gap| gap * 100.0), ["gap-in-centimetres 4"]);
    assert_eq!(told(|gap| gap * 1000.0), ["gap-in-millimetres 4"]);
    let digits = move |gap: f64| said(gap, |said| said.gap_m = Some(text(format!("{gap:.5e}"))));
    assert_eq!(of_states(&digits, &gaps, &[0.5]), ["gap-in-6-digits 4"]);
    let decimals = move |gap: f64| said(gap, |said| said.gap_m = Some(text(format!("{gap:.3}"))));
    assert_eq!(of_states(&decimals, &gaps, &[0.125]), ["gap-in-3-decimals 4"]);
    let no_normal = |gap: f64| said(gap, |said| said.normal = Some([0.0; 3]));
    assert_eq!(of_states(&no_normal, &gaps, &[]), ["normal-zero 4"]);
    // A constant added is none of these.
    assert_eq!(told(|gap| gap + 0.1), [""; 0]);
}

#[test]
fn a_tolerance_of_states_is_told_with_the_range_that_answers_leave_open() {
    use SeparationState::{Apart, Overlapping, Touching};
    let near = |limit: f64, is: SeparationState, called: SeparationState| {
        move |gap: f64| {
            let mut answer = said(gap, |_| {});
            if gap.abs() <= limit && answer.state == is {
                answer = ReportedState { state: called, gap_m: None, normal: None };
            }
            answer
        }
    };
    let gaps = [1e-8, 3e-8, 5e-7, 9e-7];
    let told = |limit, agreeing: &[f64]| of_states(&near(limit, Apart, Touching), &gaps, agreeing);
    assert_eq!(told(1e-6, &[2e-6, -1e-7, 0.5]), ["apart-by-1e-6-is-touching 4"]);
    // Nothing between a micrometre and a millimetre was asked.
    assert_eq!(told(1e-4, &[2e-3, -1e-7, 0.5]), ["apart-by-1e-6-to-1e-3-is-touching 4"]);
    let overlaps = gaps.map(|gap| -gap);
    let told = of_states(&near(1e-6, Overlapping, Touching), &overlaps, &[-2e-6, 1e-7]);
    assert_eq!(told, ["overlapping-by-1e-6-is-touching 4"]);
    let told = of_states(&near(1e-6, Apart, Overlapping), &gaps, &[2e-6, -1e-7]);
    assert_eq!(told, ["apart-by-1e-6-is-overlapping 4"]);
}

/// Two roofs of 4 m, ridge against ridge at a small distance, one turned by an angle in degrees.
fn ridges(degrees: f64, shift: f64) -> [Block; 2] {
    let number = |value: f64| Number::from_f64(value).expect("finite");
    let (sin, cos) = degrees.to_radians().sin_cos();
    let roof = |place: &dyn Fn([f64; 3]) -> [f64; 3], turned: bool| {
        let corners = [-2.0, 2.0].into_iter().flat_map(|x| [[x, -1.0, -1.0], [x, 1.0, -1.0], [x, 0.0, 0.0]]);
        let corners = corners.map(|at| {
            let [x, y, z] = place(at).map(number);
            Point::new(x, y, z)
        });
        let faces = [vec![0, 2, 1], vec![3, 4, 5], vec![0, 1, 4, 3], vec![1, 2, 5, 4], vec![2, 0, 3, 5]];
        let faces = faces.map(|mut face| {
            if turned {
                face.reverse();
            }
            face
        });
        Block::new(corners.collect(), faces.to_vec(), &BlockOptions::default()).expect("a roof")
    };
    let above = |[x, y, z]: [f64; 3]| [cos * x - sin * y + shift, sin * x + cos * y, 2f64.powi(-20) - z];
    [roof(&|at| at, false), roof(&above, true)]
}

/// What is told of an engine that classifies like that, from pairs of which it answers some otherwise than exactly.
fn of_contacts(
    pairs: &[[Block; 2]],
    engine: &(dyn Fn(&[Block; 2], &ToleranceSet) -> Vec<Contact> + Sync),
) -> Vec<String> {
    let asked = |blocks: &[Block; 2]| {
        let tolerances = preset::derive(Preset::Auto, &[&blocks[0], &blocks[1]], Precision::F64).expect("a set");
        let reply = Reply::Contacts(engine(blocks, &tolerances));
        let (precision, blocks) = (Precision::F64, blocks.clone());
        Question { blocks, tolerances, precision, accuracy: 1024, reply, label: String::new() }
    };
    let (agreeing, differing): (Vec<Question>, Vec<Question>) =
        pairs.iter().map(asked).partition(|question| question.is_right() == Some(true));
    let sample = Sample { all_differing: differing.len() as u64, differing, agreeing };
    let asking = |blocks: &[Block; 2], tolerances: &ToleranceSet| Reply::Contacts(engine(blocks, tolerances));
    explanations(&diagnose("mine", &sample, &asking, &|_| None))
}

fn exactly(blocks: &[Block; 2], tolerances: &ToleranceSet) -> Vec<Contact> {
    PreparedBlocks::of(blocks).pair().classify(tolerances).contacts
}

#[test]
fn edges_near_parallel_that_are_left_out_are_told() {
    let angles = [4.0_f64, 5.0, 6.0, 7.5, 12.0, 20.0, 60.0, 90.0];
    let pairs = angles.map(|angle| ridges(angle, 0.0));
    // The angle of its ridges is all that it knows of a pair.
    let engine = |blocks: &[Block; 2], tolerances: &ToleranceSet| {
        let angle = angles.into_iter().find(|&angle| ridges(angle, 0.0) == *blocks).expect("one of them");
        let mut contacts = exactly(blocks, tolerances);
        contacts.retain(|contact| contact.kind() != rockproof_model::ContactKind::EdgeEdge || angle > 9.0);
        contacts
    };
    assert_eq!(of_contacts(&pairs, &engine), ["e-e-within-8-to-10-degrees-left-out 4"]);
    assert_eq!(of_contacts(&pairs, &exactly), [""; 0]);
}

#[test]
fn numbers_from_1_are_told_and_of_which_features() {
    use rockproof_model::decision::Feature;
    use rockproof_model::{ContactKey, Entrance};
    let pairs: Vec<[Block; 2]> = (0..6)
        .map(|k| [box_at(0.0), box_at(1.0 + f64::from(k) / 1048576.0)])
        .chain([30.0, 45.0, 60.0, 75.0].map(|angle| ridges(angle, 0.25)))
        .collect();
    let engine = |is_counted: fn(Feature) -> bool| {
        move |blocks: &[Block; 2], tolerances: &ToleranceSet| {
            let next = |features: [Feature; 2], numbers: [u32; 2]| {
                [0, 1].map(|k| numbers[k] + u32::from(is_counted(features[k])))
            };
            let mut contacts = exactly(blocks, tolerances);
            for contact in &mut contacts {
                let (key, plane) = (contact.key, contact.entrance);
                contact.key = ContactKey::of_kind(key.kind(), next(key.features(), key.numbers()));
                contact.entrance = Entrance::of_kind(plane.kind(), next(plane.features(), plane.numbers()));
            }
            contacts
        }
    };
    assert_eq!(of_contacts(&pairs, &engine(|_| true)), ["numbered-from-1 10"]);
    let vertices = engine(|feature| matches!(feature, Feature::Vertex(..)));
    assert!(of_contacts(&pairs, &vertices)[0].starts_with("vertices-numbered-from-1 "));
    let edges = engine(|feature| matches!(feature, Feature::Edge(..)));
    assert!(of_contacts(&pairs, &edges)[0].starts_with("edges-numbered-from-1 "));
}

#[test]
fn the_smallest_gap_taken_for_the_entrance_is_told() {
    let number = |value: f64| Number::from_f64(value).expect("finite");
    let at = |[x, y, z]: [f64; 3]| box_at(0.0).translated(&rockproof_model::Vec3::new(number(x), number(y), number(z)));
    // Corner to corner: three planes of faces, with three gaps.
    let offsets = [[1, 2, 3], [3, 1, 2], [2, 5, 4], [5, 3, 1], [4, 2, 7], [6, 5, 2]];
    let pairs = offsets.map(|by| [at([0.0; 3]), at(by.map(|part| 1.0 + f64::from(part) / 1024.0))]);
    let engine = |blocks: &[Block; 2], tolerances: &ToleranceSet| {
        let mut contacts = exactly(blocks, tolerances);
        for contact in &mut contacts {
            // Every plane of a face that the corner may enter through has its coordinate for a gap. Of equal gaps that with a face of B comes first.
            let low = |side: usize, k: usize| blocks[side].bounds().min.components()[k].approximate();
            let gaps = [0, 1, 2].map(|k| low(1, k) - low(0, k));
            let least = (0..3).min_by(|&i, &j| gaps[i].total_cmp(&gaps[j])).expect("three");
            let is_low = |v: &rockproof_model::VertexId| {
                blocks[1].vertices()[v.index()].components()[least].approximate() == low(1, least)
            };
            let face = blocks[1].topology().faces().iter().position(|face| face.iter().all(is_low));
            let corner = rockproof_model::VertexId(contact.key.numbers()[0]);
            contact.entrance =
                rockproof_model::Entrance::VertexFace(corner, rockproof_model::FaceId(face.expect("a face") as u32));
        }
        contacts
    };
    assert_eq!(of_contacts(&pairs, &engine)[0], "smallest-gap-for-entrance 6");
}
