//! The contacts that a step left closed, as whoever looks at the blocks after it asks for them.

use crate::dynamics::state::State;
use crate::real::Real;
use rockproof_model::Contact;

/// The contacts that a step left closed, sorted by their pairs.
pub struct ClosedContacts(Vec<([usize; 2], Contact)>);

impl ClosedContacts {
    /// Those of a state.
    pub fn of<R: Real>(state: &State<R>) -> ClosedContacts {
        let closed = state.contacts.iter().filter(|contact| contact.mode.is_closed());
        let mut closed: Vec<_> = closed.map(|c| (c.blocks.map(|block| block as usize), c.contact)).collect();
        closed.sort_by_key(|(blocks, _)| *blocks);
        ClosedContacts(closed)
    }

    /// Those of a pair of blocks, the lower number first, each with its pair.
    pub fn between(&self, pair: [usize; 2]) -> &[([usize; 2], Contact)] {
        let start = self.0.partition_point(|(blocks, _)| *blocks < pair);
        let count = self.0[start..].partition_point(|(blocks, _)| *blocks == pair);
        &self.0[start..start + count]
    }
}
