//! Which faces are planar: found out when a sign first needs it, and then known to all pairs that a block is in.

use std::sync::atomic::{AtomicU8, Ordering};

/// Whether all corners of a face lie in its plane, exactly. Whoever finds it out writes the same.
#[derive(Debug)]
pub(crate) struct Planar(AtomicU8);

impl Planar {
    const UNKNOWN: u8 = 2;

    /// Known of triangles.
    pub(crate) fn of_corners(count: usize) -> Planar {
        Planar(AtomicU8::new(if count == 3 { 1 } else { Planar::UNKNOWN }))
    }

    /// What is known.
    #[inline]
    pub(crate) fn get(&self) -> Option<bool> {
        let known = self.0.load(Ordering::Relaxed);
        (known != Planar::UNKNOWN).then_some(known == 1)
    }

    pub(crate) fn set(&self, planar: bool) {
        self.0.store(u8::from(planar), Ordering::Relaxed);
    }
}

impl Clone for Planar {
    fn clone(&self) -> Planar {
        Planar(AtomicU8::new(self.0.load(Ordering::Relaxed)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_found_out_is_known_to_copies_made_later() {
        assert_eq!(Planar::of_corners(3).get(), Some(true));
        let planar = Planar::of_corners(4);
        assert_eq!((planar.get(), planar.clone().get()), (None, None));
        for known in [false, true] {
            planar.set(known);
            assert_eq!((planar.get(), planar.clone().get()), (Some(known), Some(known)));
        }
    }
}
