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
