//! Engines that always say the same of something.

use super::*;
use rockproof_model::{Entrance, EntranceKind};

/// Boxes side by side, shifted and not, and ridges that cross: their contacts have all three kinds of entrance and all three signs.
fn pairs() -> Vec<[Block; 2]> {
    let number = |value: f64| Number::from_f64(value).expect("finite");
    let beside = |k: i32, shift: f64| {
        let by = [1.0 + f64::from(k) / 1048576.0, shift, shift].map(number);
        [box_at(0.0), box_at(0.0).translated(&rockproof_model::Vec3::new(by[0].clone(), by[1].clone(), by[2].clone()))]
    };
    let shifts = [0.0, 0.25, 0.375, 0.5, 0.625];
    let boxes = [-1, 0, 1].into_iter().flat_map(|k| shifts.map(|shift| beside(k, shift)));
    boxes.chain([30.0, 45.0, 60.0, 75.0, 90.0].map(|angle| ridges(angle, 0.25))).collect()
}

/// Where an engine gives no entrance nothing is told of them, nor of signs of gaps, and it is said that there are none.
#[test]
fn answers_without_entrances_are_exact_as_far_as_they_go() {
    let told = |wrong: fn(&mut Contact)| {
        let reply = |blocks: &[Block; 2], tolerances: &ToleranceSet| {
            let mut contacts = exactly(blocks, tolerances);
            contacts.retain(|contact| contact.kind() != rockproof_model::ContactKind::FaceVertex);
            contacts.iter_mut().for_each(wrong);
            Reply::Contacts(contacts)
        };
        let asked = |blocks: [Block; 2]| {
            let tolerances = preset::derive(Preset::Auto, &[&blocks[0], &blocks[1]], Precision::F64).expect("a set");
            let (reply, precision, label) = (reply(&blocks, &tolerances), Precision::F64, String::new());
            Question { blocks, tolerances, precision, accuracy: 1024, reply, label }
        };
        let (agreeing, differing): (Vec<Question>, Vec<Question>) =
            pairs().into_iter().map(asked).partition(|question| question.is_right() == Some(true));
        let sample = Sample { all_differing: differing.len() as u64, differing, agreeing };
        let rows = diagnose("mine", &sample, &reply, &|_| None);
        (rows[0].hypothesis.clone(), rows[0].words().expect("words"))
    };
    let (hypothesis, words) = told(|contact| contact.entrance = crate::external::protocol::UNNAMED);
    let note = "which are left out, as far as they go (entrances and signs of gaps given for 0 of ";
    assert!(hypothesis == "f-v-left-out" && words.contains(note), "{hypothesis} {words}");
    let (hypothesis, words) = told(|_| {});
    assert!(hypothesis == "f-v-left-out" && !words.contains("as far as"), "{hypothesis} {words}");
}

/// What is told of an engine that is exact but for what `wrong` does to each contact.
fn of_wrong(wrong: impl Fn(&mut Contact) + Sync) -> Vec<String> {
    let engine = |blocks: &[Block; 2], tolerances: &ToleranceSet| {
        let mut contacts = exactly(blocks, tolerances);
        contacts.iter_mut().for_each(&wrong);
        contacts
    };
    of_contacts(&pairs(), &engine)
}

#[test]
fn the_pairs_have_contacts_of_every_kind_of_entrance_and_every_sign() {
    let tolerances = |[a, b]: &[Block; 2]| preset::derive(Preset::Auto, &[a, b], Precision::F64).expect("a set");
    let contacts: Vec<Contact> = pairs().iter().flat_map(|pair| exactly(pair, &tolerances(pair))).collect();
    let (mut kinds, mut signs) = (BTreeSet::new(), BTreeSet::new());
    for contact in &contacts {
        kinds.insert(contact.entrance.kind().name());
        signs.insert(contact.gap.as_i8());
    }
    assert_eq!((kinds.len(), signs.len()), (3, 3), "{contacts:?}");
}

#[test]
fn a_constant_sign_of_gaps_is_told() {
    for (sign, name) in [(Sign::Positive, "positive"), (Sign::Zero, "zero"), (Sign::Negative, "negative")] {
        let told = of_wrong(|contact| contact.gap = sign);
        assert!(told.len() == 1 && told[0].starts_with(&format!("gap-sign-always-{name} ")), "{told:?}");
    }
    // An engine with another mistake about signs is told that one.
    let told = of_wrong(|contact| contact.gap = contact.gap.reversed());
    assert!(told.len() == 1 && told[0].starts_with("gap-sign-turned "), "{told:?}");
    assert_eq!(of_wrong(|_| {}), [""; 0]);
}

#[test]
fn a_constant_kind_of_entrance_is_told() {
    for kind in [EntranceKind::VertexFace, EntranceKind::FaceVertex, EntranceKind::EdgeEdge] {
        // Of another kind it names any features, and the sign is as it comes.
        let told = of_wrong(|contact| {
            if contact.entrance.kind() != kind {
                (contact.entrance, contact.gap) = (Entrance::of_kind(kind, [0, 1]), Sign::Negative);
            }
        });
        assert!(told.len() == 1 && told[0].starts_with(&format!("entrance-always-{kind} ")), "{kind}: {told:?}");
    }
    // One that calls v-f f-v and the other way round has all kinds of entrance.
    let told = of_wrong(|contact| {
        contact.entrance = Entrance::of_kind(contact.entrance.swapped().kind(), contact.entrance.numbers());
    });
    assert!(told.len() == 1 && told[0].starts_with("entrance-renamed "), "{told:?}");
    // Entrances e-e called v-f, and those v-f called e-e.
    let told = of_wrong(|contact| {
        let kind = match contact.entrance.kind() {
            EntranceKind::EdgeEdge => EntranceKind::VertexFace,
            _ => EntranceKind::EdgeEdge,
        };
        contact.entrance = Entrance::of_kind(kind, [0, 1]);
    });
    assert_eq!(told, [""; 0]);
}

#[test]
fn a_constant_state_and_a_constant_gap_of_0_are_told() {
    let gaps = [0.5, 0.25, 0.125, 0.0625];
    let overlaps = gaps.map(|gap| -gap);
    let bare = |state| move |_: f64| ReportedState { state, gap_m: None, normal: None };
    let told = of_states(&bare(SeparationState::Apart), &overlaps, &gaps);
    assert_eq!(told, ["always-apart 4"]);
    let told = of_states(&bare(SeparationState::Overlapping), &gaps, &overlaps);
    assert_eq!(told, ["always-overlapping 4"]);
    let told = of_states(&bare(SeparationState::Touching), &[gaps, overlaps].concat(), &[]);
    assert_eq!(told, ["always-touching 8"]);
    let flat = |gap: f64| said(gap, |said| said.gap_m = Some(0.0));
    assert_eq!(of_states(&flat, &[gaps, overlaps].concat(), &[]), ["gap-always-0 8"]);
    // Called apart wrongly, but overlapping as well.
    let turned = |gap: f64| ReportedState { state: said(-gap, |_| {}).state, gap_m: None, normal: None };
    assert_eq!(of_states(&turned, &[gaps, overlaps].concat(), &[]), [""; 0]);
}
