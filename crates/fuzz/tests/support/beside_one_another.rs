//! Many pieces of work on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};

/// What comes of each, on as many threads as the machine has cores. Not on those of rayon: a target makes a campaign once, on threads of rayon, and one of
/// these that waits for it might begin with another target, which waits for the same campaign.
pub(crate) fn of_each<T: Sync, R: Send>(all: &[T], make: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let work = || -> Vec<(usize, R)> {
        let mine = std::iter::from_fn(|| Some(next.fetch_add(1, Ordering::Relaxed)));
        mine.map_while(|at| Some((at, make(all.get(at)?)))).collect()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut found: Vec<(usize, R)> = std::thread::scope(|scope| {
        let begun: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        begun.into_iter().flat_map(|thread| thread.join().expect("no input that is not borne")).collect()
    });
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, result)| result).collect()
}
