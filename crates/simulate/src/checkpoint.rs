//! A state as text, from which a resumed run is bit-identical.

use crate::exact_float::ExactFloat;
use rockproof_model::{Contact, ContactKey, ContactKind, Entrance, EntranceKind, Sign};
use rockproof_stepper::dynamics::{BlockState, ContactState, Mode, State};
use rockproof_stepper::{Real, Vector};
use serde::{Deserialize, Serialize};

/// A state in f64, which holds f32 and f64 exactly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedState {
    /// Steps done, settling not counted.
    pub step: u64,
    /// In s.
    pub time: ExactFloat,
    /// Static steps still to do.
    pub settling: u32,
    /// Δt of the last step, the full one before the first (s).
    pub last_time_step: ExactFloat,
    blocks: Vec<SavedBlock>,
    load_points: Vec<Triple>,
    fixed_points: Vec<Triple>,
    measured_points: Vec<Triple>,
    contacts: Vec<SavedContact>,
}

type Triple = [ExactFloat; 3];

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedBlock {
    vertices: Vec<Triple>,
    velocity: [ExactFloat; 12],
    stress: [ExactFloat; 6],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedContact {
    blocks: [u32; 2],
    kind: String,
    features: [u32; 2],
    entrance: String,
    entrance_features: [u32; 2],
    gap_sign: i8,
    mode: String,
    anchors: [Triple; 2],
    gap: ExactFloat,
    normal: Triple,
    points: [Triple; 2],
    force: Triple,
}

/// What in a saved state is no state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidState {
    /// A number that the engine's precision does not hold.
    #[error("a number is not one of the engine's precision")]
    Number,
    /// A word that names no kind, entrance, sign or mode.
    #[error("a contact has no such kind, entrance, gap sign or mode")]
    Word,
}

impl SavedState {
    /// The state as it is.
    pub fn of<R: Real>(state: &State<R>) -> SavedState {
        let State {
            step,
            time,
            settling,
            last_time_step,
            blocks,
            load_points,
            fixed_points,
            measured_points,
            contacts,
        } = state;
        let triples = |points: &[Vector<R>]| points.iter().map(|p| triple(*p)).collect();
        let block = |BlockState { vertices, velocity, stress }: &BlockState<R>| SavedBlock {
            vertices: triples(vertices),
            velocity: velocity.map(save),
            stress: stress.map(save),
        };
        SavedState {
            step: *step,
            time: save(*time),
            settling: *settling,
            last_time_step: save(*last_time_step),
            blocks: blocks.iter().map(block).collect(),
            load_points: triples(load_points),
            fixed_points: triples(fixed_points),
            measured_points: triples(measured_points),
            contacts: contacts.iter().map(SavedContact::of).collect(),
        }
    }

    /// The state that was saved.
    ///
    /// # Errors
    /// When the text was not made by [`SavedState::of`] in this precision.
    pub fn state<R: Real>(&self) -> Result<State<R>, InvalidState> {
        let vectors = |points: &[Triple]| points.iter().map(vector).collect::<Result<Vec<Vector<R>>, InvalidState>>();
        let block = |block: &SavedBlock| {
            let (velocity, stress) = (numbers(&block.velocity)?, numbers(&block.stress)?);
            Ok(BlockState { vertices: vectors(&block.vertices)?, velocity, stress })
        };
        Ok(State {
            step: self.step,
            time: number(self.time)?,
            settling: self.settling,
            last_time_step: number(self.last_time_step)?,
            blocks: self.blocks.iter().map(block).collect::<Result<_, InvalidState>>()?,
            load_points: vectors(&self.load_points)?,
            fixed_points: vectors(&self.fixed_points)?,
            measured_points: vectors(&self.measured_points)?,
            contacts: self.contacts.iter().map(SavedContact::state).collect::<Result<_, InvalidState>>()?,
        })
    }
}

impl SavedContact {
    fn of<R: Real>(state: &ContactState<R>) -> SavedContact {
        let ContactState { blocks, contact, mode, anchors, gap, normal, points, force } = state;
        SavedContact {
            blocks: *blocks,
            kind: contact.kind().name().to_owned(),
            features: contact.key.numbers(),
            entrance: contact.entrance.kind().name().to_owned(),
            entrance_features: contact.entrance.numbers(),
            gap_sign: contact.gap.as_i8(),
            mode: mode.name().to_owned(),
            anchors: anchors.map(triple),
            gap: save(*gap),
            normal: triple(*normal),
            points: points.map(triple),
            force: triple(*force),
        }
    }

    fn state<R: Real>(&self) -> Result<ContactState<R>, InvalidState> {
        let sign = [Sign::Negative, Sign::Zero, Sign::Positive].into_iter().find(|s| s.as_i8() == self.gap_sign);
        let kind = ContactKind::from_name(&self.kind).ok_or(InvalidState::Word)?;
        let entrance = EntranceKind::from_name(&self.entrance).ok_or(InvalidState::Word)?;
        let mode = Mode::from_name(&self.mode).ok_or(InvalidState::Word)?;
        let two = |points: &[Triple; 2]| Ok([vector(&points[0])?, vector(&points[1])?]);
        Ok(ContactState {
            blocks: self.blocks,
            contact: Contact {
                key: ContactKey::of_kind(kind, self.features),
                entrance: Entrance::of_kind(entrance, self.entrance_features),
                gap: sign.ok_or(InvalidState::Word)?,
            },
            mode,
            anchors: two(&self.anchors)?,
            gap: number(self.gap)?,
            normal: vector(&self.normal)?,
            points: two(&self.points)?,
            force: vector(&self.force)?,
        })
    }
}

fn save<R: Real>(value: R) -> ExactFloat {
    ExactFloat(value.to_f64())
}

fn triple<R: Real>(v: Vector<R>) -> Triple {
    v.components().map(save)
}

/// The number of the engine's precision that was saved; another one is no number of a state.
fn number<R: Real>(saved: ExactFloat) -> Result<R, InvalidState> {
    let value = R::from_f64(saved.0);
    let same = value.to_f64().to_bits() == saved.0.to_bits() || saved.0.is_nan();
    if same { Ok(value) } else { Err(InvalidState::Number) }
}

fn numbers<R: Real, const N: usize>(saved: &[ExactFloat; N]) -> Result<[R; N], InvalidState> {
    let mut values = [R::ZERO; N];
    for (value, saved) in values.iter_mut().zip(saved) {
        *value = number(*saved)?;
    }
    Ok(values)
}

fn vector<R: Real>(saved: &Triple) -> Result<Vector<R>, InvalidState> {
    let [x, y, z] = numbers(saved)?;
    Ok(Vector::new(x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A state with a number of its own in every place.
    fn awkward<R: Real>() -> State<R> {
        let mut next = 0.1;
        let mut number = || {
            next = -next * 1.37;
            R::from_f64(next)
        };
        let mut v = || Vector::new(number(), number(), number());
        let blocks =
            (0..3).map(|_| BlockState { vertices: vec![v(), v()], velocity: [R::ZERO; 12], stress: [R::ZERO; 6] });
        let mut blocks: Vec<BlockState<R>> = blocks.collect();
        let contact = |kind, mode, v: &mut dyn FnMut() -> Vector<R>| ContactState {
            blocks: [0, 2],
            contact: Contact {
                key: ContactKey::of_kind(kind, [3, 4]),
                entrance: Entrance::of_kind(EntranceKind::FaceVertex, [5, 6]),
                gap: Sign::Negative,
            },
            mode,
            anchors: [v(), v()],
            gap: R::from_f64(-0.0),
            normal: v(),
            points: [v(), v()],
            force: v(),
        };
        let contacts = ContactKind::ALL.iter().zip(Mode::ALL.iter().cycle());
        let contacts = contacts.map(|(kind, mode)| contact(*kind, *mode, &mut v)).collect();
        let (load_points, fixed_points, measured_points) = (vec![v()], vec![v(), v()], vec![v()]);
        for block in &mut blocks {
            for (k, value) in block.velocity.iter_mut().chain(&mut block.stress).enumerate() {
                *value = R::from_f64(1.0 / (k as f64 + 3.0));
            }
        }
        let (time, last_time_step) = (R::from_f64(0.1), R::from_f64(0.003));
        State {
            step: 7,
            time,
            settling: 3,
            last_time_step,
            blocks,
            load_points,
            fixed_points,
            measured_points,
            contacts,
        }
    }

    fn comes_back<R: Real>() {
        let state = awkward::<R>();
        let text = serde_json::to_string(&SavedState::of(&state)).expect("JSON");
        let saved: SavedState = serde_json::from_str(&text).expect("a saved state");
        let back = saved.state::<R>().expect("a state");
        assert_eq!(back, state);
        assert!(back.contacts[0].gap.to_f64().is_sign_negative(), "minus zero stays");
        assert_eq!(serde_json::to_string(&SavedState::of(&back)).expect("JSON"), text);
    }

    #[test]
    fn a_state_comes_back_from_its_text() {
        comes_back::<f64>();
        comes_back::<f32>();
    }

    #[test]
    fn what_is_no_state_is_refused() {
        let saved = SavedState::of(&awkward::<f64>());
        assert_eq!(saved.state::<f32>(), Err(InvalidState::Number));
        for (good, bad) in [("\"v-e\"", "\"v-g\""), ("\"sliding\"", "\"slid\""), ("\"f-v\"", "\"e-v\"")] {
            let text = serde_json::to_string(&saved).expect("JSON").replace(good, bad);
            let changed: SavedState = serde_json::from_str(&text).expect("JSON of the same form");
            assert_eq!(changed.state::<f64>(), Err(InvalidState::Word), "{bad}");
        }
    }
}
