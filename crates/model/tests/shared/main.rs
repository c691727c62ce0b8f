//! What the oracle and the stepper share is never compared between them. Here it is worked out a second time, from the words of docs/spec.md and
//! not from the code: rounding, sines and tangents, blocks and what is none, convexity and the numbers of edges, also of bent faces, merging, volumes
//! and centroids, orders, presets, `ideal`, rules, stiffness, and what files and scenes say.

mod bent;
mod block_rules;
mod blocks;
mod cells;
mod formats;
mod gmsh;
mod moments;
mod names;
mod presets;
mod rounding;
mod rule_places;
mod scenes;
mod sines;
mod tolerance_rules;
