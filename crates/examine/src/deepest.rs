//! The deepest of many overlaps whose depths are bounded, measured exactly only where it may be the deepest.

use rayon::prelude::*;
use rockproof_oracle::audit::BoundedOverlap;
use rockproof_oracle::penetration::Penetration;
use std::cmp::Ordering;

/// The deepest overlap and its penetration, of several equally deep the first; `None` where none of them is an overlap. `measure`
/// gives the exact penetration of a pair, `None` where its blocks do not overlap.
pub(crate) fn deepest(
    mut bounded: Vec<BoundedOverlap>,
    measure: impl Fn([usize; 2]) -> Option<Penetration> + Sync,
) -> Option<([usize; 2], Penetration)> {
    // Those of which most is possible first, until no other can be as deep.
    bounded.sort_by(|one, two| two.most_m.total_cmp(&one.most_m).then(one.blocks.cmp(&two.blocks)));
    let mut deepest: Option<([usize; 2], Penetration)> = None;
    let mut rest = &bounded[..];
    let mut together = 1;
    while !rest.is_empty() {
        // Rounded to nearest, so one float less is certainly not more than the depth.
        let least = |(_, depth): &([usize; 2], Penetration)| depth.depth_m().unwrap_or(f64::INFINITY).next_down();
        let limit = deepest.as_ref().map_or(0.0, least);
        let possible = rest.partition_point(|overlap| overlap.most_m >= limit);
        let (next, later) = rest[..possible].split_at(together.min(possible));
        if next.is_empty() {
            break;
        }
        let measured = next.par_iter().filter_map(|overlap| Some((overlap.blocks, measure(overlap.blocks)?)));
        for (blocks, depth) in measured.collect::<Vec<_>>() {
            let is_deeper =
                |(first, most): &([usize; 2], Penetration)| match depth.depth_squared().cmp(&most.depth_squared()) {
                    Ordering::Greater => true,
                    Ordering::Equal => blocks < *first,
                    Ordering::Less => false,
                };
            if deepest.as_ref().is_none_or(is_deeper) {
                deepest = Some((blocks, depth));
            }
        }
        rest = later;
        together = rayon::current_num_threads();
    }
    deepest
}
