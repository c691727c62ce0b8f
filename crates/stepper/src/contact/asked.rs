//! A classification of which a few contacts are asked alone, before all others: then no other features are tested, and no exits are looked for.

use rockproof_model::ContactKey;
use std::cell::RefCell;

thread_local! {
    /// The contacts asked for; `None` where all are.
    static ASKED: RefCell<Option<Vec<ContactKey>>> = const { RefCell::new(None) };
}

/// Asks for all contacts again when dropped.
struct Asked;

impl Drop for Asked {
    fn drop(&mut self) {
        ASKED.set(None);
    }
}

/// What `work` gives where its classifications find these contacts alone, whether or not an exit would take them away. It must calculate in a
/// scalar that heeds it ([`crate::real::Real::leaves_out`]), on this thread.
pub(crate) fn asking<T>(contacts: Vec<ContactKey>, work: impl FnOnce() -> T) -> T {
    let _asked = Asked;
    ASKED.set(Some(contacts));
    work()
}

/// Whether a contact is not asked for.
pub(crate) fn leaves_out(contact: ContactKey) -> bool {
    ASKED.with_borrow(|asked| asked.as_ref().is_some_and(|asked| !asked.contains(&contact)))
}

/// Whether some contacts are asked alone.
pub(crate) fn leaves_exits_out() -> bool {
    ASKED.with_borrow(Option::is_some)
}
