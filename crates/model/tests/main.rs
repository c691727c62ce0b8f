//! What the model reads and writes, in one program.

mod meshes;
mod places;
mod readers;
mod simulation_scene;
mod tolerances;
