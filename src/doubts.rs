//! What of the tolerances and options given can hardly be meant: told beside the answer, which stays as it is.

use crate::exit::print_note;
use rockproof_examine::short;
use rockproof_model::{Block, Number, Scene, ToleranceSet};

/// The lengths of a tolerance set.
const LENGTHS: [&str; 6] = ["search", "territory", "penetration", "open", "close", "max_displacement"];

/// A larger share of a block's size takes any polygon for planar.
const LOOSEST_PLANARITY: f64 = 0.1;

/// Tells which tolerances are longer than the whole model.
pub(crate) fn tell_of_tolerances(blocks: &[&Block], set: &ToleranceSet) {
    if let Some(doubt) = beyond_the_model(blocks, set) {
        print_note(&doubt);
    }
}

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

/// Tells of blocks whose faces may be anything.
pub(crate) fn tell_of_planarity(scene: &Scene) {
    let loosest = scene.blocks.iter().map(|block| &block.planarity).max();
    if let Some(doubt) = loosest.and_then(loose) {
        print_note(&doubt);
    }
}

fn loose(planarity: &Number) -> Option<String> {
    let share = planarity.approximate();
    (share > LOOSEST_PLANARITY).then(|| {
        format!(
            "planarity is {}, a share of a block's size and no length: with more than {LOOSEST_PLANARITY} any polygon counts as planar, and faces that are not in one plane become one; 1e-3 is enough for what rounding bends",
            short(share)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Vec3;

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
