//! What a step has left behind, summed up: contacts by kind and mode, the deepest overlap, energies.

use crate::dynamics::attempt::IterationResult;
use crate::dynamics::contact::StepContact;
use crate::dynamics::report::{Retry, StepReport};
use crate::dynamics::solve::Solve;
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    /// What the step just accepted has left: counts, overlaps, energies.
    pub(super) fn report(
        &self,
        contacts: &[StepContact<R>],
        step: i64,
        time_step: f64,
        (ended, retries): (&IterationResult<R>, Vec<Retry>),
        max_displacement: f64,
    ) -> StepReport {
        let mut counts = [[0; 3]; 6];
        let (mut deepest, mut springs) = (0.0f64, 0.0);
        let half = R::from_f64(0.5);
        for (contact, state) in contacts.iter().zip(&self.state.contacts) {
            counts[contact.contact.kind() as usize][contact.iterate.mode as usize] += 1;
            deepest = deepest.max(-contact.iterate.gap.to_f64());
            if contact.is_closed() {
                let ([a, b], normal) = (state.anchors, state.normal);
                let across = (a - b) - normal * normal.dot(a - b);
                let squared = contact.iterate.gap * contact.iterate.gap * contact.joint.normal
                    + across.dot(across) * contact.joint.shear;
                springs += (half * squared).to_f64();
            }
        }
        for (held, &at) in self.setup.held.iter().zip(&self.state.fixed_points) {
            springs += (half * held.stiffness * (at - held.at).dot(at - held.at)).to_f64();
        }
        let (mut kinetic, mut gravitational, mut elastic) = (0.0, 0.0, 0.0);
        for (block, state) in self.state.blocks.iter().enumerate().filter(|&(block, _)| !self.is_fixed(block)) {
            let (body, moments) = (&self.setup.bodies[block], &self.moments[block]);
            let mass = body.elastic.density * moments.volume;
            gravitational -= (mass * self.setup.gravity.dot(moments.centroid)).to_f64();
            if body.motion.unknowns() == 12 {
                elastic += (moments.volume * body.elastic.energy(&state.stress)).to_f64();
            }
            for (row, &rate) in moments.inertia().iter().zip(&state.velocity) {
                let momentum = row.iter().zip(&state.velocity).fold(R::ZERO, |sum, (&m, &v)| sum + m * v);
                kinetic += (half * body.elastic.density * momentum * rate).to_f64();
            }
        }
        StepReport {
            step,
            time: self.state.time.to_f64(),
            time_step,
            iterations: ended.iterations,
            converged: ended.converged,
            friction_left: ended.friction_left,
            retries,
            contacts: counts,
            max_penetration: deepest,
            max_displacement,
            kinetic,
            gravitational,
            elastic,
            springs,
        }
    }
}
