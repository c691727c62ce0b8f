//! A directory of results: what made it, and whether what is asked now would go on with it.

mod identity;

pub use identity::identity_differences;
