//! A directory of results: whose it is, which files in it are ours, and whether what a run goes on from is as it was written.
//!
//! A command claims a [`Directory`] before it writes there. The claim takes a lock, so that two processes never mix their files, and reads
//! the manifest: `rockproof.manifest.json` names the command and lists every file that it wrote. Only what the manifest lists is ever
//! replaced or deleted; a file is listed before it is first written, so a kill leaves nothing of ours that is not listed. Files are
//! written beside their final name and renamed ([`write_atomically`]), tables that grow carry a [`Seal`]. A [`View`] reads what others wrote.

mod atomic;
mod bounded_read;
mod claim;
mod directory;
mod error;
mod file_stem;
mod identity;
mod lock;
mod manifest;
mod seal;
mod table;
mod unprotected;
mod view;

pub use atomic::write_atomically;
pub use claim::{Claim, Start};
pub use directory::Directory;
pub use error::ResultsError;
pub use file_stem::bounded;
pub use identity::{identity_differences, setting_text};
pub use manifest::{FileKind, MANIFEST, Owner, is_inside, owner_without};
pub use seal::{Seal, digest};
pub use table::AppendedTable;
pub use unprotected::on_unprotected;
pub use view::View;
