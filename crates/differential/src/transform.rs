//! Changes of a pair that may not change its contacts, and the way back from the changed pair's contacts.

use super::compare::{AnswerChange, Difference};
use rockproof_model::decision::{Feature, Side};
use rockproof_model::lattice::Lattice;
use rockproof_model::{
    Block, BlockOptions, Contact, ContactKey, EdgeId, Entrance, FaceId, Number, Point, Precision, ToleranceSet,
    Topology, VertexId,
};
use std::cell::OnceCell;

/// A change of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transform {
    /// A and B are exchanged.
    Swap,
    /// Vertices and faces get other numbers, and face loops start elsewhere.
    Renumber,
    /// Both blocks are moved by an amount that leaves every coordinate representable.
    Translate,
    /// All lengths are multiplied by a power of two.
    Scale,
}

/// The blocks before rounding, renumbered once for all engines.
#[derive(Debug)]
pub struct ExactBlocks<'x> {
    blocks: [&'x Block; 2],
    renumbered: OnceCell<Option<[(Block, Numbering); 2]>>,
}

impl<'x> ExactBlocks<'x> {
    /// Of a pair.
    pub fn new(blocks: [&'x Block; 2]) -> ExactBlocks<'x> {
        ExactBlocks { blocks, renumbered: OnceCell::new() }
    }

    fn renumbered(&self) -> Option<&[(Block, Numbering); 2]> {
        let [a, b] = self.blocks;
        self.renumbered.get_or_init(|| Some([Numbering::of(a)?, Numbering::of(b)?])).as_ref()
    }
}

/// The changed pair.
#[derive(Clone, Debug)]
pub struct Transformed {
    /// The changed blocks, in the order to classify them in.
    pub blocks: [Block; 2],
    swapped: bool,
    numbering: Option<[Numbering; 2]>,
    scale: Number,
}

impl Transform {
    /// All changes.
    pub const ALL: [Transform; 4] = [Transform::Swap, Transform::Renumber, Transform::Translate, Transform::Scale];

    /// What a violation of it is called.
    pub fn change(self) -> AnswerChange {
        match self {
            Transform::Swap => AnswerChange::Swap,
            Transform::Renumber => AnswerChange::Renumber,
            Transform::Translate => AnswerChange::Translate,
            Transform::Scale => AnswerChange::Scale,
        }
    }

    /// The changed pair, or `None` where the change cannot be made exactly. `exact` are the blocks before rounding,
    /// which a new numbering needs to keep the convexity flags, `rounded` the same as the engine sees them, as are `tolerances`.
    pub fn apply(
        self,
        exact: &ExactBlocks<'_>,
        rounded: &[Block; 2],
        tolerances: &ToleranceSet,
        precision: Precision,
    ) -> Option<Transformed> {
        let [a, b] = rounded;
        let unchanged = Transformed::unchanged(rounded.clone());
        match self {
            Transform::Swap => Some(unchanged.exchanged()),
            Transform::Renumber => {
                let [(a, of_a), (b, of_b)] = exact.renumbered()?;
                let blocks = [a.rounded(precision)?, b.rounded(precision)?];
                Some(Transformed { blocks, numbering: Some([of_a.clone(), of_b.clone()]), ..unchanged })
            }
            Transform::Translate => {
                let offset = exact_offset(rounded, precision)?;
                Some(Transformed { blocks: [a.translated(&offset), b.translated(&offset)], ..unchanged })
            }
            Transform::Scale => {
                // A power away from 1 that is far from the ends of either range for ordinary coordinates.
                let scale = Number::from_f64(2f64.powi(-7)).ok()?;
                let scaled = |block: &Block| {
                    block.with_vertices(block.vertices().iter().map(|p| p.map(|c| c.times(&scale))).collect())
                };
                let pair = Transformed { blocks: [scaled(a), scaled(b)], scale, ..unchanged };
                pair.is_normal_in(tolerances, precision).then_some(pair)
            }
        }
    }
}

impl Transformed {
    /// Blocks numbered and scaled as those of the pair.
    pub(super) fn unchanged(blocks: [Block; 2]) -> Transformed {
        Transformed { blocks, swapped: false, numbering: None, scale: Number::from_integer(1) }
    }

    /// The same with A and B exchanged.
    pub(super) fn exchanged(self) -> Transformed {
        let [a, b] = self.blocks;
        Transformed { blocks: [b, a], swapped: !self.swapped, ..self }
    }

    /// Whether every number of the changed pair that is not zero keeps all its digits: it must not be below the normal range of the precision.
    fn is_normal_in(&self, tolerances: &ToleranceSet, precision: Precision) -> bool {
        let least = match precision {
            Precision::F32 => f64::from(f32::MIN_POSITIVE),
            Precision::F64 => f64::MIN_POSITIVE,
        };
        let is_normal = |number: &Number| number.is_zero() || number.approximate().abs() >= least;
        self.blocks.iter().all(|block| block.is_exact_in(precision) && block.coordinates().all(is_normal))
            && self.tolerances(tolerances).numbers().into_iter().all(|(_, number)| is_normal(number))
    }

    /// The tolerance set for the changed pair: lengths are scaled with it.
    pub fn tolerances(&self, tolerances: &ToleranceSet) -> ToleranceSet {
        let mut scaled = tolerances.clone();
        for length in [
            &mut scaled.search,
            &mut scaled.territory,
            &mut scaled.penetration,
            &mut scaled.open,
            &mut scaled.close,
            &mut scaled.max_displacement,
        ] {
            *length = length.times(&self.scale);
        }
        scaled
    }

    /// Contacts of the changed pair in the numbering of the pair itself, sorted.
    pub fn to_original(&self, contacts: &[Contact]) -> Vec<Contact> {
        let mut back: Vec<Contact> = contacts
            .iter()
            .map(|&contact| {
                let contact = if self.swapped { contact.swapped() } else { contact };
                self.numbering.as_ref().map_or(contact, |[a, b]| renumbered(contact, &a.back, &b.back))
            })
            .collect();
        back.sort_unstable();
        back
    }

    /// A difference of the pair itself in the numbering of the changed one.
    pub fn to_transformed(&self, difference: &Difference) -> Difference {
        let forth = |contact: Contact| {
            let contact = self.numbering.as_ref().map_or(contact, |[a, b]| renumbered(contact, &a.forth, &b.forth));
            if self.swapped { contact.swapped() } else { contact }
        };
        Difference {
            change: difference.change,
            before: difference.before.map(forth),
            after: difference.after.map(forth),
        }
    }
}

/// New numbers of one block's features, both ways.
#[derive(Clone, Debug)]
struct Numbering {
    back: IndexMap,
    forth: IndexMap,
}

/// A number for each vertex, edge and face.
#[derive(Clone, Debug)]
struct IndexMap {
    vertices: Vec<VertexId>,
    edges: Vec<EdgeId>,
    faces: Vec<FaceId>,
}

impl Numbering {
    /// A block with its vertices and faces in reverse order and every loop started one vertex later.
    fn of(block: &Block) -> Option<(Block, Numbering)> {
        let old = block.topology();
        let vertex_numbers: Vec<VertexId> = old.vertex_ids().rev().collect();
        let face_numbers: Vec<FaceId> = old.face_ids().rev().collect();
        let points: Vec<Point> = block.vertices().iter().rev().cloned().collect();
        let turn = |face: &Vec<VertexId>| {
            let mut face: Vec<VertexId> = face.iter().map(|&v| vertex_numbers[v.index()]).collect();
            face.rotate_left(1);
            face
        };
        let loops = old.faces().iter().rev().map(turn).collect();
        // The block is known to be good; how planar its faces are was decided when it was loaded.
        let options = BlockOptions { planarity: Number::from_integer(1) };
        let renumbered = Block::new(points, loops, &options).ok()?;
        let new = renumbered.topology();
        if new.vertex_count() != old.vertex_count() || new.faces().len() != old.faces().len() {
            return None;
        }
        let edges = |from: &Topology, to: &Topology| {
            let number = |v: VertexId| vertex_numbers[v.index()];
            from.edges().iter().map(|e| to.edge_between(number(e.p), number(e.q))).collect::<Option<Vec<_>>>()
        };
        // Reversing twice is no change, so vertices and faces have the same map both ways.
        let map = |edges| IndexMap { vertices: vertex_numbers.clone(), edges, faces: face_numbers.clone() };
        let numbering = Numbering { back: map(edges(new, old)?), forth: map(edges(old, new)?) };
        Some((renumbered, numbering))
    }
}

fn renumbered(contact: Contact, a: &IndexMap, b: &IndexMap) -> Contact {
    // An engine's answer is not to be trusted: the feature may not exist.
    let number = |feature: Feature| {
        let map = if feature.side() == Side::A { a } else { b };
        let new = match feature {
            Feature::Vertex(_, vertex) => map.vertices.get(vertex.index()).map(|v| v.0),
            Feature::Edge(_, edge) => map.edges.get(edge.index()).map(|e| e.0),
            Feature::Face(_, face) => map.faces.get(face.index()).map(|f| f.0),
        };
        new.unwrap_or(u32::MAX)
    };
    let Contact { key, entrance, gap } = contact;
    Contact {
        key: ContactKey::of_kind(key.kind(), key.features().map(number)),
        entrance: Entrance::of_kind(entrance.kind(), entrance.features().map(number)),
        gap,
    }
}

/// The largest offset along all axes, a power of two from four times the pair's size downwards, that leaves every
/// coordinate representable.
fn exact_offset(blocks: &[Block; 2], precision: Precision) -> Option<Point> {
    let coordinates = || blocks.iter().flat_map(Block::coordinates);
    let reach = coordinates().map(|c| c.approximate().abs()).fold(0.0, f64::max);
    if reach == 0.0 {
        return None;
    }
    let (numerator, denominator) = Lattice::covering(coordinates()).units_per_metre();
    let grid = denominator.bits() as i32 - numerator.bits() as i32;
    let top = reach.log2().ceil() as i32 + 2;
    (grid.max(top - precision.digits() as i32 - 4)..=top).rev().find_map(|exponent| {
        let step = Number::from_f64(2f64.powi(exponent)).ok()?;
        let exact = coordinates().all(|c| c.plus(&step).is_exact_in(precision));
        exact.then(|| Point::new(step.clone(), step.clone(), step))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{ContactKind, Sign, Vec3};

    fn box_between(min: [f64; 3], max: [f64; 3]) -> Block {
        let number = |c: f64| Number::from_f64(c).expect("finite");
        let corner = |x: usize, y: usize, z: usize| {
            let c = [min, max];
            Vec3::new(number(c[x][0]), number(c[y][1]), number(c[z][2]))
        };
        let corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)];
        let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let options = BlockOptions { planarity: Number::ZERO };
        let points = corners.map(|(x, y, z)| corner(x, y, z)).to_vec();
        Block::new(points, faces.map(|f| f.to_vec()).to_vec(), &options).expect("a box")
    }

    fn pair() -> [Block; 2] {
        [box_between([0.0, 0.0, 1.0], [1.0, 1.5, 2.0]), box_between([-0.25, -0.5, 0.0], [3.0, 2.0, 1.0])]
    }

    fn every_contact(pair: &[Block; 2]) -> Vec<Contact> {
        let counts =
            |b: &Block| [b.vertices().len(), b.topology().edges().len(), b.topology().faces().len()].map(|n| n as u32);
        let ([va, ea, fa], [vb, eb, fb]) = (counts(&pair[0]), counts(&pair[1]));
        let sizes = [(va, vb), (va, eb), (ea, vb), (va, fb), (fa, vb), (ea, eb)];
        let mut all = Vec::new();
        for (kind, (na, nb)) in ContactKind::ALL.into_iter().zip(sizes) {
            for (a, b) in (0..na).flat_map(|a| (0..nb).map(move |b| (a, b))) {
                let entrance = Entrance::FaceVertex(FaceId(a % fa), VertexId(b % vb));
                all.push(Contact { key: ContactKey::of_kind(kind, [a, b]), entrance, gap: Sign::Zero });
            }
        }
        all
    }

    fn apply(transform: Transform, pair: &[Block; 2]) -> Transformed {
        apply_under(transform, pair, &ToleranceSet::ZERO).expect("an exact change")
    }

    fn apply_under(transform: Transform, pair: &[Block; 2], tolerances: &ToleranceSet) -> Option<Transformed> {
        transform.apply(&ExactBlocks::new([&pair[0], &pair[1]]), pair, tolerances, Precision::F32)
    }

    #[test]
    fn back_undoes_forth_for_every_change() {
        let pair = pair();
        let all = every_contact(&pair);
        for transform in Transform::ALL {
            let changed = apply(transform, &pair);
            let forth = |c: &Contact| {
                let difference = Difference { change: AnswerChange::Extra, before: None, after: Some(*c) };
                changed.to_transformed(&difference).after.expect("a contact")
            };
            let there: Vec<Contact> = all.iter().map(forth).collect();
            assert_eq!(changed.to_original(&there), all, "{transform:?}");
            if matches!(transform, Transform::Swap | Transform::Renumber) {
                assert_ne!(there, all, "{transform:?} changes something");
            }
        }
    }

    #[test]
    fn swapping_or_renumbering_twice_is_no_change() {
        let pair = pair();
        for transform in [Transform::Swap, Transform::Renumber] {
            let twice = apply(transform, &apply(transform, &pair).blocks);
            assert_eq!(twice.blocks[0].vertices(), pair[0].vertices());
            assert_eq!(twice.blocks[1].topology().edges(), pair[1].topology().edges());
        }
    }

    #[test]
    fn renumbered_features_have_the_same_corners() {
        let pair = pair();
        let changed = apply(Transform::Renumber, &pair);
        let Some([numbering, _]) = &changed.numbering else { panic!("a numbering") };
        let (old, new) = (&pair[0], &changed.blocks[0]);
        for (at, edge) in old.topology().edges().iter().enumerate() {
            let moved = new.topology().edges()[numbering.forth.edges[at].index()];
            let ends = |b: &Block, e: rockproof_model::topology::Edge| {
                let mut ends = [e.p, e.q].map(|v| format!("{:?}", b.vertices()[v.index()]));
                ends.sort();
                ends
            };
            assert_eq!(ends(old, *edge), ends(new, moved));
        }
        assert_eq!(numbering.back.edges[numbering.forth.edges[3].index()], EdgeId(3));
    }

    #[test]
    fn moves_and_scales_only_where_it_is_exact() {
        let pair = pair();
        let moved = apply(Transform::Translate, &pair);
        assert!(moved.blocks.iter().all(|b| b.is_exact_in(Precision::F32)));
        assert_ne!(moved.blocks[0].vertices(), pair[0].vertices());
        let scaled = apply(Transform::Scale, &pair);
        assert_eq!(scaled.blocks[1].vertices()[1].x.as_f64(), Some(3.0 / 128.0));
        // 2⁻¹²⁶ is the smallest normal f32; below it the next operation may lose digits. The smallest of all, 2⁻¹⁴⁹, cannot be divided.
        let is_scaled = |exponent: i32| {
            let (edge, tolerance) = (2f64.powi(exponent), Number::from_f64(2f64.powi(exponent)).expect("finite"));
            let least = [pair[0].clone(), box_between([0.0, 0.0, 0.0], [edge, edge, edge])];
            let set = ToleranceSet { territory: tolerance, ..ToleranceSet::ZERO };
            [(&least, &ToleranceSet::ZERO), (&pair, &set)]
                .map(|(pair, set)| apply_under(Transform::Scale, pair, set).is_some())
        };
        assert_eq!([-119, -120, -149].map(is_scaled), [[true; 2], [false; 2], [false; 2]]);
    }
}
