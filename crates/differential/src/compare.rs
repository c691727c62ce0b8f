//! What changed between two answers for the same pair (SPEC section 6).

use rockproof_model::decision::{Feature, Side};
use rockproof_model::{Contact, ContactKey, Topology, VertexId};

rockproof_model::named_enum! {
    /// How an answer changed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum AnswerChange: from_name, Display {
        /// A contact is no longer found.
        Missing = "missing",
        /// A contact is found that was not there.
        Extra = "extra",
        /// The same place touches, as another kind: one feature lies in the closure of the other, in both blocks.
        Kind = "kind",
        /// The same contact enters through another plane.
        Entrance = "entrance",
        /// The same contact through the same plane has a gap of another sign.
        GapSign = "gap-sign",
        /// Rounding the input destroyed a feature, so that there is no answer.
        Collapsed = "collapsed",
        /// A built-in engine panicked, or the input or the tolerances overflow in the engine's format.
        Failure = "failure",
        /// The engine's program ended instead of answering.
        Crash = "crash",
        /// The engine's program did not answer in time.
        Timeout = "timeout",
        /// The engine's answer made no sense.
        Malformed = "malformed",
        /// The engine says that it cannot do this pair.
        Unsupported = "unsupported",
        /// Asked twice about the same pair, the engine answered differently.
        Unstable = "unstable",
        /// Apart, touching or overlapping: not as the blocks lie.
        State = "state",
        /// The distance or depth is off by more than the engine's accuracy.
        Gap = "gap",
        /// The normal does not separate the blocks as it should.
        Normal = "normal",
        /// The answer changed when A and B were exchanged.
        Swap = "swap",
        /// The answer changed when vertices and faces were numbered otherwise.
        Renumber = "renumber",
        /// The answer changed when both blocks were moved by an exactly representable amount.
        Translate = "translate",
        /// The answer changed when all lengths were multiplied by a power of two.
        Scale = "scale",
        /// A block far away was found to touch.
        FarBlock = "far-block",
    }
}

impl AnswerChange {
    /// Whether it is about what an engine answered, not about a question that it left without an answer or answered in two ways.
    pub fn is_of_answers(self) -> bool {
        !matches!(
            self,
            AnswerChange::Collapsed
                | AnswerChange::Failure
                | AnswerChange::Crash
                | AnswerChange::Timeout
                | AnswerChange::Malformed
                | AnswerChange::Unsupported
                | AnswerChange::Unstable
        )
    }

    /// Whether it is about a contact that was found or not, or found otherwise.
    pub fn is_of_contacts(self) -> bool {
        matches!(
            self,
            AnswerChange::Missing
                | AnswerChange::Extra
                | AnswerChange::Kind
                | AnswerChange::Entrance
                | AnswerChange::GapSign
        )
    }

    /// Whether it is about how blocks lie, as engines say that name no contacts.
    pub fn is_of_states(self) -> bool {
        matches!(self, AnswerChange::State | AnswerChange::Gap | AnswerChange::Normal)
    }

    /// Whether an engine gave no answer that can be used, or two: however near the pair is to a tie, rounding is no reason for that.
    pub fn is_unusable(self) -> bool {
        matches!(
            self,
            AnswerChange::Failure
                | AnswerChange::Crash
                | AnswerChange::Timeout
                | AnswerChange::Malformed
                | AnswerChange::Unstable
        )
    }

    /// Whether rounding is no reason for it, however near the pair is to a tie: an external engine gave no usable answer, found a block to touch that is
    /// far away, or answered otherwise once all lengths were multiplied by a power of two, which changes no digit of any number.
    pub fn is_never_rounding(self) -> bool {
        self.is_unusable() || matches!(self, AnswerChange::FarBlock | AnswerChange::Scale)
    }

    /// Whether this is a violated metamorphic check rather than a difference from the oracle.
    pub fn is_metamorphic(self) -> bool {
        matches!(
            self,
            AnswerChange::Swap
                | AnswerChange::Renumber
                | AnswerChange::Translate
                | AnswerChange::Scale
                | AnswerChange::FarBlock
        )
    }
}

/// One difference between two answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Difference {
    /// What changed.
    pub change: AnswerChange,
    /// The contact in the first answer, unless it is extra.
    pub before: Option<Contact>,
    /// The contact in the second answer, unless it is missing.
    pub after: Option<Contact>,
}

impl Difference {
    /// The contact the difference is about: the first answer's, or else the second's.
    pub fn contact(&self) -> Option<Contact> {
        self.before.or(self.after)
    }

    /// The features of the contacts that it is about.
    pub(crate) fn keys(&self) -> impl Iterator<Item = ContactKey> + use<> {
        [self.before, self.after].into_iter().flatten().map(|contact| contact.key)
    }

    /// The kind of that contact, or `v-v to v-e` where the kind is what changed; empty where it is about no contact.
    pub fn kinds(&self) -> String {
        match (self.before, self.after) {
            (Some(before), Some(after)) if before.kind() != after.kind() => {
                format!("{} to {}", before.kind(), after.kind())
            }
            _ => self.contact().map_or(String::new(), |contact| contact.kind().to_string()),
        }
    }
}

/// The features of a pair of blocks.
#[derive(Clone, Copy, Debug)]
pub struct Features<'p> {
    /// Of the first block.
    pub a: &'p Topology,
    /// Of the second block.
    pub b: &'p Topology,
}

impl Features<'_> {
    /// The vertices in the closure of a feature; none for a feature that does not exist.
    pub fn vertices(&self, feature: Feature) -> Vec<VertexId> {
        let of = |side: Side| match side {
            Side::A => self.a,
            Side::B => self.b,
        };
        match feature {
            Feature::Vertex(_, v) => vec![v],
            Feature::Edge(side, e) => of(side).edges().get(e.index()).map_or(Vec::new(), |e| vec![e.p, e.q]),
            Feature::Face(side, f) => of(side).faces().get(f.index()).cloned().unwrap_or_default(),
        }
    }

    /// Whether some vertex in the closure of a feature is such a one.
    pub(super) fn any_vertex(&self, feature: Feature, is: impl Fn(VertexId) -> bool) -> bool {
        let of = |side: Side| match side {
            Side::A => self.a,
            Side::B => self.b,
        };
        match feature {
            Feature::Vertex(_, v) => is(v),
            Feature::Edge(side, e) => of(side).edges().get(e.index()).is_some_and(|e| is(e.p) || is(e.q)),
            Feature::Face(side, f) => of(side).faces().get(f.index()).is_some_and(|face| face.iter().any(|&v| is(v))),
        }
    }

    /// Whether one feature lies in the closure of the other. Both must belong to the same block.
    fn nested(&self, one: Feature, other: Feature) -> bool {
        let (one, other) = (self.vertices(one), self.vertices(other));
        let (small, large) = if one.len() <= other.len() { (&one, &other) } else { (&other, &one) };
        !small.is_empty() && small.iter().all(|v| large.contains(v))
    }

    fn same_place(&self, one: &Contact, other: &Contact) -> bool {
        let ([a1, b1], [a2, b2]) = (one.key.features(), other.key.features());
        self.nested(a1, a2) && self.nested(b1, b2)
    }
}

/// The differences between two sorted answers, in the order of the contacts they are about.
///
/// Contacts with the same kind and features are the same contact. Of those found on one side only, a missing and an
/// extra one of another kind at the same place count as one difference, [`AnswerChange::Kind`]; each is used once, in order.
pub fn differences(before: &[Contact], after: &[Contact], features: Features<'_>) -> Vec<Difference> {
    if before == after {
        return Vec::new();
    }
    let key = |c: &Contact| c.key;
    let mut found = Vec::new();
    let (mut missing, mut extra) = (Vec::new(), Vec::new());
    let (mut i, mut j) = (0, 0);
    while i < before.len() || j < after.len() {
        match (before.get(i), after.get(j)) {
            (Some(x), Some(y)) if key(x) == key(y) => {
                let change = if x.entrance != y.entrance { AnswerChange::Entrance } else { AnswerChange::GapSign };
                if x != y {
                    found.push(Difference { change, before: Some(*x), after: Some(*y) });
                }
                i += 1;
                j += 1;
            }
            (Some(x), y) if y.is_none_or(|y| key(x) < key(y)) => {
                missing.push(*x);
                i += 1;
            }
            (_, Some(y)) => {
                extra.push(*y);
                j += 1;
            }
            (_, None) => break,
        }
    }
    for lost in missing {
        let place = extra.iter().position(|new| new.kind() != lost.kind() && features.same_place(&lost, new));
        found.push(match place {
            Some(at) => Difference { change: AnswerChange::Kind, before: Some(lost), after: Some(extra.remove(at)) },
            None => Difference { change: AnswerChange::Missing, before: Some(lost), after: None },
        });
    }
    found.extend(extra.into_iter().map(|new| Difference {
        change: AnswerChange::Extra,
        before: None,
        after: Some(new),
    }));
    found.sort_by_key(|d| (d.contact(), d.after));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{ContactKey, ContactKind, Entrance, FaceId, Sign};

    fn cube() -> Topology {
        let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        Topology::new(8, faces.map(|f| f.to_vec()).to_vec()).expect("a cube")
    }

    fn contact(kind: ContactKind, a: u32, b: u32) -> Contact {
        let entrance = Entrance::VertexFace(VertexId(0), FaceId(0));
        Contact { key: ContactKey::of_kind(kind, [a, b]), entrance, gap: Sign::Positive }
    }

    fn changes(before: &[Contact], after: &[Contact]) -> Vec<AnswerChange> {
        let cube = cube();
        differences(before, after, Features { a: &cube, b: &cube }).iter().map(|d| d.change).collect()
    }

    #[test]
    fn names_every_change_of_a_contact() {
        let vf = contact(ContactKind::VertexFace, 0, 1);
        let turned = Contact { entrance: Entrance::VertexFace(VertexId(0), FaceId(3)), gap: Sign::Zero, ..vf };
        let touching = Contact { gap: Sign::Zero, ..vf };
        assert_eq!(changes(&[vf], &[vf]), []);
        assert_eq!(changes(&[vf], &[]), [AnswerChange::Missing]);
        assert_eq!(changes(&[], &[vf]), [AnswerChange::Extra]);
        assert_eq!(changes(&[vf], &[turned]), [AnswerChange::Entrance]);
        assert_eq!(changes(&[vf], &[touching]), [AnswerChange::GapSign]);
    }

    #[test]
    fn another_kind_counts_only_at_the_same_place() {
        // Vertex 4 is a corner of face 1 (4 5 6 7); vertex 0 is not.
        let vf = contact(ContactKind::VertexFace, 2, 1);
        assert_eq!(changes(&[vf], &[contact(ContactKind::VertexVertex, 2, 4)]), [AnswerChange::Kind]);
        assert_eq!(changes(&[contact(ContactKind::VertexVertex, 2, 4)], &[vf]), [AnswerChange::Kind]);
        assert_eq!(
            changes(&[contact(ContactKind::VertexVertex, 2, 0)], &[vf]),
            [AnswerChange::Missing, AnswerChange::Extra]
        );
        let other_face = contact(ContactKind::VertexFace, 2, 3);
        assert_eq!(
            changes(&[vf], &[other_face]),
            [AnswerChange::Missing, AnswerChange::Extra],
            "the same kind is another contact"
        );
    }

    #[test]
    fn each_contact_is_part_of_one_difference() {
        let vf = contact(ContactKind::VertexFace, 2, 1);
        let corner = |b| contact(ContactKind::VertexVertex, 2, b);
        assert_eq!(changes(&[corner(4), corner(5)], &[vf]), [AnswerChange::Kind, AnswerChange::Missing]);
        assert_eq!(changes(&[vf], &[corner(4), corner(5)]), [AnswerChange::Extra, AnswerChange::Kind]);
    }

    #[test]
    fn every_change_has_a_name_of_its_own() {
        for change in AnswerChange::ALL {
            assert_eq!(AnswerChange::from_name(change.name()), Some(change));
        }
        assert_eq!(AnswerChange::from_name("nothing"), None);
    }
}
