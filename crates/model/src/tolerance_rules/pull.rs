//! Whether closed contacts pull a block as much as it weighs before they open: an estimate.

use super::column::{ColumnSource, gravity};
use super::shape::largest;
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::scene::Scene;
use crate::tolerance::ToleranceSet;

/// The block whose contacts may pull it most for its weight, if they may pull no less than that. A closed contact opens where its gap is wider than `open`, and its normal spring pulls until then: by p·`open`,
/// and n of them, the corners of the block's smallest face, by n·p·`open`, p the softest normal stiffness that the block can meet. **A pull of exactly the weight is told.** Nothing is said without gravity, nor
/// where `open` is no more than 2⁻³⁰ of `search`, as `auto` has it in f64: what hung by so little would be a splinter beside the others.
pub(super) fn pull(set: &ToleranceSet, scene: &Scene, source: &ColumnSource<'_>) -> Option<Warning> {
    let (_, acceleration) = gravity(scene)?;
    let open = set.open.approximate();
    if open <= set.search.approximate() * 2f64.powi(-30) {
        return None;
    }
    let pulled = source.masses.iter().zip(&source.contacts).enumerate().filter_map(|(block, (mass, contacts))| {
        let (found, weight) = (contacts * open, (*mass)? * acceleration);
        (found >= weight).then_some(((block, found, weight), found / weight))
    });
    let ((block, found, allowed), _) = largest(pulled)?;
    let remedy = format!("open ≤ {}", six_digits(allowed / source.contacts[block], false, false));
    Some(Warning { kind: WarningKind::Pull, block: Some(block), found, allowed, remedy })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Number;
    use crate::{Block, Motion, SceneBlock, Vec3};

    fn at(c: [i32; 3]) -> Vec3<Number> {
        Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c))
    }

    /// Cubes with sides of 1 m and of 2 m under a fixed ceiling, of 25 kN and 200 kN where gravity is 10 m/s², with contacts of 1e8 N/m.
    fn cubes_under_ceiling(pull: i32) -> Scene {
        let cuboid = |low, high| Block::cuboid(&at(low), &at(high)).unwrap();
        let mut scene = Scene::on_fixed("ceiling", cuboid([-9, -9, 0], [9, 9, 1]));
        scene.blocks.push(SceneBlock::new("large", cuboid([0, 0, -2], [2, 2, 0])));
        scene.blocks.push(SceneBlock::new("small", cuboid([-2, 0, -1], [-1, 1, 0])));
        scene.simulation.gravity = at([0, 0, -pull]);
        scene.simulation.materials[0].density = Number::from_integer(2500);
        let stiffness = Number::from_integer(100_000_000);
        scene.simulation.joints.all_mut().for_each(|joint| joint.normal_stiffness = Some(stiffness.clone()));
        scene
    }

    fn warned(scene: &Scene, open: &str) -> Option<Warning> {
        let set = ToleranceSet { open: Number::parse(open).unwrap(), ..ToleranceSet::ZERO };
        pull(&set, scene, &ColumnSource::of(&set, scene))
    }

    #[test]
    fn contacts_that_pull_no_less_than_the_weight_are_warned_of() {
        let scene = cubes_under_ceiling(10);
        // 25 kN over four contacts are 6.25e-5 m, a power of five over one of two: both sides are exact.
        let found = warned(&scene, "6.25e-5").expect("the weight itself");
        assert_eq!((found.block, found.found, found.allowed), (Some(2), 25_000.0, 25_000.0));
        assert_eq!(found.remedy, "open ≤ 6.24999e-5");
        assert_eq!(warned(&scene, "6.24999e-5"), None);
        assert_eq!(warned(&scene, "0"), None);
        let found = warned(&scene, "1e-3").expect("both cubes");
        assert_eq!((found.block, found.found), (Some(2), 400_000.0), "the lighter one is pulled more for its weight");
    }

    #[test]
    fn what_weighs_nothing_or_cannot_move_is_not_pulled() {
        assert_eq!(warned(&cubes_under_ceiling(0), "1"), None);
        let mut scene = cubes_under_ceiling(10);
        scene.blocks[2].body.motion = Motion::Fixed;
        assert_eq!(warned(&scene, "1e-4"), None, "200 kN over four contacts are 5e-4 m");
        assert_eq!(warned(&scene, "5.1e-4").and_then(|found| found.block), Some(1));
    }
}
