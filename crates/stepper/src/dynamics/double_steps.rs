//! The decisions of a step in 512 bits, by the rules of SPEC, made in two f64 where these settle every comparison ([`crate::double`]).

#[cfg(test)]
mod tests;

use crate::contact::{Collapsed, SpecRules, classify_with_kept};
use crate::double::Double;
use crate::dynamics::decided::DecidedStep;
use crate::dynamics::filtered_contacts::BlockContacts;
use crate::dynamics::state::{Mode, State};
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;
use crate::real::Real;
use crate::wide::settled;
use rockproof_model::{Contact, Scene, ToleranceSet};
use std::collections::HashMap;

/// The most steps for which a pair that two f64 leave open is not asked in them.
const LONGEST_WAIT: u32 = 16;

/// A scene in two f64 with a bound on their error. What is unsettled counts on the thread that finds it, so its work has to be done in a pool of one.
#[derive(Debug)]
pub struct DoubleSteps {
    dynamics: Dynamics<Double>,
    /// Of pairs that two f64 left open when last asked.
    waits: HashMap<[u32; 2], Wait>,
    /// Pairs of which 512 bits left a comparison unsettled in the last step, or one of them: in the next, in all likelihood, they do again.
    unsettled: Vec<[u32; 2]>,
    /// How many of the pairs that two f64 leave open are looked at together in 512 bits: [`PAIRS_AT_ONCE`], but in tests.
    pairs_at_once: usize,
}

/// For how many steps a pair is not asked in two f64: what they leave open they often leave open in the next step, too.
#[derive(Clone, Copy, Debug)]
struct Wait {
    steps: u32,
    left: u32,
}

impl Wait {
    /// After the pair was left open again: one step the first time, then twice as many as before.
    fn after(before: Option<Wait>) -> Wait {
        let steps = before.map_or(1, |before| (2 * before.steps).min(LONGEST_WAIT));
        Wait { steps, left: steps }
    }
}

/// Few, since the others of a part are looked at for nothing where one of them is unsettled.
const PAIRS_AT_ONCE: usize = 8;

/// What of a step is decided as in 512 bits.
#[derive(Clone, Debug)]
pub struct DoubleDecisions {
    /// The contacts that the step finds; `None` where 512 bits leave a comparison unsettled in finding them.
    pub contacts: Option<BlockContacts>,
    /// What is decided with them ([`DoubleSteps::modes`] has the modes), if all comparisons of that are settled in two f64 and nothing fails.
    pub decided: Option<DecidedStep>,
}

impl DoubleSteps {
    /// A scene, whose blocks are those of f64, with its tolerances; `None` where two f64 leave open how it begins.
    pub fn begin(scene: &Scene, set: &ToleranceSet) -> Option<DoubleSteps> {
        let dynamics = settled(|| Dynamics::new(scene, set))?.ok()?;
        Some(DoubleSteps { dynamics, waits: HashMap::new(), unsettled: Vec::new(), pairs_at_once: PAIRS_AT_ONCE })
    }

    /// What the next step from a state of floats decides in 512 bits, by the tolerances of the scene. `None` where two f64 leave open what its blocks are
    /// like, or where a pair that they leave open takes too much to note.
    pub fn decide<R: Real>(&mut self, state: &State<R>, set: &ToleranceSet) -> Option<DoubleDecisions> {
        settled(|| self.dynamics.restore(state.in_scalar()))?.ok()?;
        let contacts = self.contacts(set)?;
        let decide = |contacts: &BlockContacts| settled(|| SpecRules::decide_step(&mut self.dynamics, contacts));
        let decided = contacts.as_ref().and_then(decide).and_then(Result::ok);
        Some(DoubleDecisions { contacts, decided })
    }

    /// As [`Dynamics::modes`], of the last step that was decided.
    pub fn modes(&self) -> &[Vec<Vec<Mode>>] {
        self.dynamics.modes()
    }

    /// The contacts of the step, or `None` within where 512 bits leave a comparison unsettled in finding them. Pairs that two f64 leave open are looked at
    /// again.
    fn contacts(&mut self, set: &ToleranceSet) -> Option<Option<BlockContacts>> {
        let pairs = settled(|| self.dynamics.neighbouring_pairs())?;
        for pair in std::mem::take(&mut self.unsettled) {
            if pairs.binary_search(&pair).is_ok() && self.dynamics.contacts_in_wide(&[pair], set)?.1 > 0 {
                self.unsettled = vec![pair];
                return Some(None);
            }
        }
        let mut found = Vec::with_capacity(pairs.len());
        let mut open = Vec::new();
        for &pair in &pairs {
            let contacts = self.contacts_of_pair(pair).ok()?;
            if contacts.is_none() {
                open.push(pair);
            }
            found.push(contacts);
        }
        let mut in_wide = Vec::with_capacity(open.len());
        for part in open.chunks(self.pairs_at_once) {
            let (contacts, unsettled) = self.dynamics.contacts_in_wide(part, set)?;
            if unsettled > 0 {
                self.unsettled = part.to_vec();
                return Some(None);
            }
            in_wide.extend(contacts);
        }
        let mut in_wide = in_wide.into_iter();
        let mut all = Vec::with_capacity(self.dynamics.state.contacts.len());
        for (pair, contacts) in pairs.into_iter().zip(found) {
            let contacts = contacts.or_else(|| in_wide.next()).unwrap_or_default();
            all.extend(contacts.into_iter().map(|contact| (pair, contact)));
        }
        Some(Some(all))
    }

    /// The contacts of a pair, where two f64 find them and are asked.
    fn contacts_of_pair(&mut self, pair: [u32; 2]) -> Result<Option<Vec<Contact>>, Collapsed> {
        if let Some(wait) = self.waits.get_mut(&pair).filter(|wait| wait.left > 0) {
            wait.left -= 1;
            return Ok(None);
        }
        let found = settled(|| self.classify(pair));
        if found.is_some() {
            self.waits.remove(&pair);
            return Ok(found);
        }
        self.waits.insert(pair, Wait::after(self.waits.get(&pair).copied()));
        // What was worked out of its blocks when first asked may have come of a comparison that is unsettled.
        for block in pair.map(|block| block as usize) {
            let vertices = &self.dynamics.state.blocks[block].vertices;
            self.dynamics.prepared[block] = self.dynamics.prepared[block].clone().with_points(vertices)?;
        }
        Ok(None)
    }

    fn classify(&self, pair: [u32; 2]) -> Vec<Contact> {
        let [a, b] = pair.map(|block| &self.dynamics.prepared[block as usize]);
        let kept = self.dynamics.kept_contacts(pair);
        let found = classify_with_kept::<Double, SpecRules>(a, b, &self.dynamics.setup.tolerances, &kept);
        found.into_iter().map(|found| found.contact).collect()
    }
}
