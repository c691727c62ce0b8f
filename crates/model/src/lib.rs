//! The words both halves of Rockproof share: exact numbers, blocks and their features, contacts, tolerance sets,
//! scenes, and the files they come from. Nothing here classifies a contact: the oracle and the stepper each do
//! that with arithmetic of their own.

pub mod block;
pub mod bounded_rows;
pub mod contact;
pub mod decision;
pub mod decision_index;
mod dyadic;
pub mod files;
pub mod fraction;
pub mod lattice;
mod named;
pub mod number;
pub mod number_text;
pub mod preset;
pub mod ring;
pub mod scene;
pub mod sign;
pub mod simulation;
pub mod text;
pub mod tolerance;
pub mod tolerance_rules;
pub mod tolerance_spec;
pub mod topology;
pub mod vector;
pub mod vtu_writer;

pub use block::{Block, BlockError, BlockOptions, Bounds, Merged, Merging, Point};
pub use contact::{Contact, ContactKey, ContactKind, Entrance, EntranceKind, ExpectedContact, unexpected_contacts};
pub use number::{Number, NumberError, Precision};
pub use preset::{Preset, PresetError};
pub use ring::Ring;
pub use scene::{LoadOptions, Scene, SceneBlock, SceneError};
pub use sign::Sign;
pub use simulation::{Body, Motion, Simulation};
pub use tolerance::{Criteria, ToleranceSet};
pub use tolerance_rules::{Rule, Violation};
pub use tolerance_spec::{SpecError, ToleranceSpec};
pub use topology::{EdgeId, FaceId, Topology, TopologyError, VertexId};
pub use vector::Vec3;
