//! What the answer says of the steps.

use crate::assess::{Assessment, plural};
use crate::extents::short;
use crate::steps::Steps;
use crate::verdict::{Line, line};
use rockproof_report::table::grouped;
use rockproof_report::verdict::Severity;

/// What is wrong with the steps, where something is.
pub(crate) fn step_fault(steps: &Steps) -> String {
    let Some(made) = steps.made() else { return String::new() };
    let passing = made.passages.len();
    let deepest = made.unseen.values().copied().fold(0.0, f64::max);
    let unseen = plural(made.unseen.len(), "pair overlaps", "pairs overlap");
    match (passing, made.unseen.len()) {
        (0, 0) if made.totals.steps_past_middle > 0 => {
            "blocks pass the middle of one another within a few steps".to_owned()
        }
        (0, 0) => "a step cannot be made".to_owned(),
        (0, _) => {
            format!("{unseen} where no contact holds them within a few steps (by at most {} m)", short(deepest))
        }
        (_, 0) => format!("{} through one another within a few steps", plural(passing, "pair passes", "pairs pass")),
        (_, _) => format!(
            "{} through one another within a few steps, and {unseen} where no contact holds them",
            plural(passing, "pair passes", "pairs pass")
        ),
    }
}

/// The line on them.
pub(crate) fn steps(given: &Assessment) -> Line {
    let made = match &given.steps {
        Steps::Skipped(why) => return line("steps", Severity::Fair, why.clone()),
        Steps::Made(made) => made,
    };
    let explained = made.totals.steps_explained;
    let is_settled = made.unconverged == 0 && made.unsettled == 0 && made.totals.false_entrances.is_none();
    let is_good = given.tries_contacts() && is_settled && explained == 0 && !given.steps.end_deep();
    let severity = match (given.steps.find_fault(), is_good) {
        (true, _) => Severity::Bad,
        (false, true) => Severity::Good,
        (false, false) => Severity::Fair,
    };
    let ended = made.stopped.as_ref().map_or(String::new(), |why| format!(" of {}, then {why}", made.asked));
    let unconverged = match made.unconverged {
        0 => String::new(),
        count => format!(", {count} of them taken though the iteration had not converged"),
    };
    let unsettled = match made.unsettled {
        0 => String::new(),
        count => format!(", friction not settled in {count} of them"),
    };
    let (held, totals) = (made.held.sentence(), made.totals.sentence());
    // The audit counts them too.
    let settling = match made.totals.steps.saturating_sub(made.made) {
        0 => String::new(),
        count => format!(" after {} of settling", grouped(count)),
    };
    let entrances = made.totals.false_entrances.sentence();
    let entrances = entrances.map_or(String::new(), |sentence| format!("; false entrances: {sentence}"));
    let text = format!("{} made{settling}{ended}{unconverged}{unsettled}, {held}: {totals}{entrances}", made.made);
    line("steps", severity, text)
}
