//! What of the tolerances and options given can hardly be meant: told beside the answer, which stays as it is.

use crate::exit::{print_note, shows_notes};
use rockproof_examine::{BareEdge, Overlaps, StoredEnergy, bare_edges, short, unexplained_energy};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt, noun};
use rockproof_model::{Block, Number, Scene, ToleranceSet, Vec3, tolerance_rules};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::atomic::AtomicBool;

/// The lengths of a tolerance set.
const LENGTHS: [&str; 6] = ["search", "territory", "penetration", "open", "close", "max_displacement"];

/// A larger share of a block's size takes for planar what nobody would.
const LOOSEST_PLANARITY: f64 = 0.1;

/// Tells which tolerances are longer than the whole model.
pub(crate) fn tell_of_tolerances(blocks: &[&Block], set: &ToleranceSet) {
    if let Some(doubt) = beyond_the_model(blocks, set) {
        print_note(&doubt);
    }
}

/// Tells what `check` warns of in a model that steps begin with: that of the steps which follow from it, they do not tell.
pub(crate) fn tell_of_warnings(scene: &Scene, set: &ToleranceSet, overlaps: &Overlaps, check: &str) {
    if !shows_notes() {
        return;
    }
    let mut titles: Vec<&str> = Vec::new();
    titles.extend(tolerance_rules::thin(set, &scene.shapes()).map(|_| THIN));
    titles.extend(tolerance_rules::warnings(set, scene).iter().map(|warning| warning.kind.title()));
    titles.extend((!unexplained_energy(scene, set, overlaps).is_empty()).then_some(StoredEnergy::TITLE));
    titles.extend((!bare_edges(scene, set, overlaps, &AtomicBool::new(false)).is_empty()).then_some(BareEdge::TITLE));
    if !titles.is_empty() {
        print_note(&format!("`{check}` warns of this model, whatever the steps show: {}", titles.join("; ")));
    }
}

/// What `check` warns of where a block is no thicker than twice `penetration`.
pub(crate) const THIN: &str = "a block may be passed through, or lie within another, and count as held";

fn beyond_the_model(blocks: &[&Block], set: &ToleranceSet) -> Option<String> {
    let reach = |axis: usize| {
        let ends = blocks.iter().map(|block| {
            let bounds = block.bounds();
            [bounds.min.components()[axis].approximate(), bounds.max.components()[axis].approximate()]
        });
        let whole = ends
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [least, most]| [low.min(least), high.max(most)]);
        whole[1] - whole[0]
    };
    let diagonal = (0..3).map(reach).fold(0.0, f64::hypot);
    let lengths = set.numbers().into_iter().filter(|(name, _)| LENGTHS.contains(name));
    let beyond: Vec<(&str, f64)> =
        lengths.map(|(name, length)| (name, length.approximate())).filter(|(_, length)| *length > diagonal).collect();
    let (_, longest) = beyond.iter().copied().max_by(|one, other| one.1.total_cmp(&other.1))?;
    let named: Vec<String> = beyond.iter().map(|(name, length)| format!("{name} is {} m", short(*length))).collect();
    Some(format!(
        "{}, longer than the whole model, which is {} m from corner to corner; tolerances are in metres: {} mm are {}",
        named.join(", "),
        short(diagonal),
        short(longest),
        short(longest / 1000.0),
    ))
}

/// Tells of a scene that was read: faces that may be far from planar, blocks given twice.
pub(crate) fn tell_of_scene(scene: &Scene) {
    tell_of_planarity(scene);
    if shows_notes()
        && let Some(doubt) = twins(scene)
    {
        print_note(&doubt);
    }
}

/// Blocks with the corners of an earlier one, in whatever order.
fn twins(scene: &Scene) -> Option<String> {
    let mut first: BTreeMap<Vec<[&Number; 3]>, usize> = BTreeMap::new();
    let mut again: Vec<[usize; 2]> = Vec::new();
    for (number, block) in scene.blocks.iter().enumerate() {
        let mut corners: Vec<[&Number; 3]> = block.block.vertices().iter().map(Vec3::components).collect();
        corners.sort_unstable();
        match first.entry(corners) {
            Entry::Vacant(place) => drop(place.insert(number)),
            Entry::Occupied(place) => again.push([number, *place.get()]),
        }
    }
    let named = |number: usize| format!("block {number} \"{}\"", excerpt(&scene.blocks[number].name, EXCERPT_LENGTH));
    let [other, one] = again.first()?.map(named);
    let more = match again.len() - 1 {
        0 => String::new(),
        more => format!(", and so {} {more} more", noun(more, "has", "have")),
    };
    Some(format!(
        "{other} has the corners of {one}{more}: a block that is given twice lies within itself, and contacts cannot hold that"
    ))
}

/// Tells of blocks whose faces may be far from planar.
fn tell_of_planarity(scene: &Scene) {
    tell_of_share(scene.blocks.iter().map(|block| &block.planarity).max());
}

/// The same of a planarity that is given for all block files.
pub(crate) fn tell_of_share(planarity: Option<&Number>) {
    if let Some(doubt) = planarity.and_then(loose) {
        print_note(&doubt);
    }
}

fn loose(planarity: &Number) -> Option<String> {
    let share = planarity.approximate();
    (share > LOOSEST_PLANARITY).then(|| {
        format!(
            "planarity is {}, a share of a block's size and no length: with more than {LOOSEST_PLANARITY} faces count as planar that are far from it, and neighbours that are not in one plane become one; 1e-3 is enough for what rounding bends",
            short(share)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Block {
        let corner = |c| Vec3::new(Number::from_integer(c), Number::from_integer(c), Number::from_integer(c));
        Block::cuboid(&corner(0), &corner(1)).expect("a cube")
    }

    #[test]
    fn what_is_as_long_as_the_model_is_not_doubted_and_what_is_longer_is() {
        let cube = cube();
        let with = |search: f64, open: f64| {
            let [search, open] = [search, open].map(|length| Number::from_f64(length).expect("a length"));
            beyond_the_model(&[&cube], &ToleranceSet { search, open, ..ToleranceSet::ZERO })
        };
        assert_eq!(with(1.73, 0.1), None);
        let doubt = with(1.74, 0.1).expect("a doubt");
        assert!(doubt.starts_with("search is 1.74 m, longer than the whole model, which is 1.732 m"), "{doubt}");
        let both = with(2.0, 3.0).expect("a doubt");
        assert!(both.starts_with("search is 2 m, open is 3 m, longer") && both.ends_with(": 3 mm are 0.003"), "{both}");
    }

    #[test]
    fn a_tenth_of_a_block_is_the_loosest_planarity_that_is_not_doubted() {
        let doubt = |share: &str| loose(&Number::parse(share).expect("a number"));
        assert_eq!(doubt("0.1"), None);
        assert!(doubt("0.11").is_some_and(|text| text.starts_with("planarity is 0.11, a share")));
    }
}
