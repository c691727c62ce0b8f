//! While blocks stay near where they are, the pairs of features found there give the contacts that all pairs give, bit for bit.

use crate::golden_contacts::{self, GoldenPair};
use crate::pairs;
use rockproof_model::{ContactKey, ToleranceSet};
use rockproof_stepper::contact::{ClassificationRequest, ContactRules, NearbyFeatures, SpecRules};
use rockproof_stepper::{PreparedBlock, Real, Tolerances, Vector, Wide};

/// The same numbers on every machine.
struct Random(u64);

impl Random {
    /// From −1 to 1, ends and middle often.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bits = self.0 >> 33;
        match bits % 5 {
            0 => -1.0,
            1 => 1.0,
            _ => (bits as f64 / f64::from(u32::MAX >> 1)) * 2.0 - 1.0,
        }
    }
}

/// A block with its vertices moved along each axis by at most `by`: as a whole, or each by itself.
fn moved<R: Real>(prepared: &PreparedBlock<R>, by: f64, rigid: bool, random: &mut Random) -> Option<PreparedBlock<R>> {
    let all: [f64; 3] = std::array::from_fn(|_| random.next());
    let points: Vec<Vector<R>> = prepared
        .vertices()
        .iter()
        .map(|vertex| {
            let share: [f64; 3] = if rigid { all } else { std::array::from_fn(|_| random.next()) };
            let [x, y, z] = vertex.at.components();
            // Rounding must not take it beyond.
            let to = |x: R, share: f64| R::from_f64(x.to_f64() + share * by * 0.999);
            Vector::new(to(x, share[0]), to(y, share[1]), to(z, share[2]))
        })
        .collect();
    prepared.clone().with_points(&points).ok()
}

fn contacts<R: Real>(request: ClassificationRequest<'_, R>) -> Vec<(String, u64)> {
    SpecRules::contacts(request).iter().map(|f| (format!("{:?}", f.contact), f.gap.to_f64().to_bits())).collect()
}

/// What was seen of pairs of blocks.
#[derive(Debug, Default)]
struct Seen {
    /// Blocks of which the pairs of features were found.
    found: usize,
    /// Contacts compared.
    contacts: usize,
    /// Pairs of features looked at for these.
    looked_at: usize,
    /// Places at which the contacts were others.
    others: usize,
}

/// Finds the pairs of features with `kept` contacts of the pair, then looks among them where the vertices have moved by at most `farther` times
/// the margin, keeping now some of what was found before and some of what was kept.
fn look<R: Real>(pair: &GoldenPair, share: f64, farther: f64, forget_kept: bool, random: &mut Random, seen: &mut Seen) {
    let (Ok(a), Ok(b)) = (PreparedBlock::<R>::new(&pair.a), PreparedBlock::<R>::new(&pair.b)) else { return };
    let times = |factor: f64| {
        let penetration = pair.tolerances.penetration.times(&pairs::n(factor));
        Tolerances::<R>::new(&ToleranceSet { penetration, ..pair.tolerances.clone() }).unwrap()
    };
    // So that some that are kept are too deep.
    let (t, deep) = (times(0.0625), times(16.0));
    let request = |tolerances| ClassificationRequest { a: &a, b: &b, tolerances, kept: &[], among: None };
    let keys = |t| -> Vec<ContactKey> { SpecRules::contacts(request(t)).iter().map(|f| f.contact.key).collect() };
    let mut kept = keys(&deep);
    kept.retain(|_| random.next() > -0.5);
    let margin = t.search.to_f64() * share;
    let known: &[ContactKey] = if forget_kept { &[] } else { &kept };
    let Some(nearby) = NearbyFeatures::of(ClassificationRequest { kept: known, ..request(&t) }, margin) else { return };
    seen.found += 1;
    for place in 0..4 {
        let by = if place == 0 { 0.0 } else { margin * farther };
        let (Some(a), Some(b)) = (moved(&a, by, place % 2 == 1, random), moved(&b, by, place % 2 == 1, random)) else {
            continue;
        };
        let all = ClassificationRequest { a: &a, b: &b, tolerances: &t, kept: &kept, among: None };
        let (all, among) = (contacts(all), contacts(ClassificationRequest { among: Some(&nearby), ..all }));
        seen.contacts += all.len();
        seen.looked_at += nearby.len();
        seen.others += usize::from(all != among);
        let all = ClassificationRequest { a: &a, b: &b, tolerances: &t, kept: &kept, among: None };
        let found = SpecRules::contacts(all);
        kept = found.iter().map(|f| f.contact.key).filter(|_| random.next() > -0.5).collect();
    }
}

fn look_at_all<R: Real>(share: f64, farther: f64, forget_kept: bool) -> Seen {
    let (mut random, mut seen) = (Random(7), Seen::default());
    for pair in golden_contacts::pairs() {
        look::<R>(&pair, share, farther, forget_kept, &mut random, &mut seen);
    }
    seen
}

#[test]
fn nothing_else_is_in_a_contact_within_the_margin() {
    for share in [1.0 / 4096.0, 1.0 / 512.0, 1.0 / 64.0, 0.125] {
        for seen in [look_at_all::<f64>(share, 1.0, false), look_at_all::<f32>(share, 1.0, false)] {
            assert_eq!(seen.others, 0, "{seen:?}");
            assert!(seen.found > 60 && seen.contacts > 400, "{seen:?}");
        }
    }
}

/// Deliberate mistakes: blocks farther away than the margin, and contacts that are kept but are not said to be.
#[test]
fn beyond_the_margin_and_without_what_is_kept_contacts_are_missing() {
    assert!(look_at_all::<f64>(1.0 / 512.0, 200.0, false).others > 0);
    assert!(look_at_all::<f64>(1.0 / 512.0, 1.0, true).others > 0);
}

#[test]
fn few_pairs_of_features_are_left() {
    let seen = look_at_all::<f64>(1.0 / 512.0, 0.0, false);
    assert!(seen.looked_at < 2 * seen.contacts, "{seen:?}");
}

#[test]
fn the_wide_scalar_looks_at_all() {
    assert_eq!(look_at_all::<Wide>(1.0 / 512.0, 1.0, false).found, 0);
}
