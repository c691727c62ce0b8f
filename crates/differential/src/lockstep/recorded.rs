//! What state files say that differed, in words: those of pairs in a campaign leave the blocks out, those of runs name them.

use crate::lockstep::explain::AttributedDifference;
use crate::lockstep::intrusion::CausedIntrusion;

/// A difference as a case of a campaign has it.
pub fn pair_difference(attributed: &AttributedDifference) -> String {
    let difference = &attributed.difference;
    let contact = difference.contact.map_or(String::new(), |(_, contact)| format!(" {}", contact.kind()));
    let (change, before, after) = (difference.change.name(), &difference.before, &difference.after);
    format!("{} {change}{contact}: {before} → {after}", attributed.cause)
}

/// A difference as a state file of a run has it.
pub fn run_difference(attributed: &AttributedDifference) -> String {
    let difference = &attributed.difference;
    let place = difference.contact.map_or(String::new(), |([a, b], _)| format!(" blocks {a}-{b}"));
    let solve = difference.solve.map_or(String::new(), |solve| format!(" solve {solve}"));
    let (change, before, after) = (difference.change.name(), &difference.before, &difference.after);
    format!("{} {change}{place}{solve}: {before} → {after}", attributed.cause)
}

/// A passage or an unseen overlap as a case of a campaign has it.
pub fn pair_intrusion(attributed: &CausedIntrusion) -> String {
    let [before, after] = attributed.words();
    format!("{} {}: {before} → {after}", attributed.cause, attributed.kind.name())
}

/// A passage or an unseen overlap as a case of a run has it.
pub fn run_intrusion(attributed: &CausedIntrusion) -> String {
    let ([a, b], [before, after]) = (attributed.blocks, attributed.words());
    format!("{} {} blocks {a}-{b}: {before} → {after}", attributed.cause, attributed.kind.name())
}
