//! Messages between the ranks of a campaign on many processes.

use crate::reach::Reach;
use crate::readers::LONGEST_MESSAGE;
use rockproof_campaign::distribute::{MessageKind, reread};
use rockproof_campaign::run::RunError;

/// Who sends them.
const RANK: usize = 7;

/// A message after a byte that says which kind it is read as: it is written again as it was read, or refused with the rank that sent it.
pub(crate) fn message(bytes: &[u8], reach: &mut Reach) {
    let Some((kind, bytes)) = bytes.split_first() else { return reach.count("too-short") };
    let kinds = [MessageKind::Introduction, MessageKind::Order, MessageKind::Report];
    let kind = kinds[usize::from(*kind) % kinds.len()];
    match reread(kind, RANK, bytes) {
        Ok(read) => {
            let again = reread(kind, RANK, &read.message).expect("what was written can be read");
            assert_eq!((again.what, &again.message), (read.what, &read.message), "a message that is written and read");
            reach.count("read");
            reach.count(read.what);
        }
        Err(error) => {
            let message = error.to_string();
            let names_rank = message.contains(&format!("rank {RANK} "));
            // A row is read later than its message.
            assert!(names_rank || matches!(error, RunError::Csv(_)), "the message does not name the rank: {message}");
            assert!(message.len() < LONGEST_MESSAGE, "a message of {} bytes: {message}", message.len());
            reach.count(Reach::variant(&error));
        }
    }
}
