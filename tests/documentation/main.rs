//! What the documents say, held against the program: commands on the pages, links, pictures, the rules of ARCHITECTURE.md.

#[path = "../../examples/pictures/drawings/mod.rs"]
mod drawings;
#[cfg(unix)]
#[path = "../support/place.rs"]
mod place;

mod architecture;
mod book;
mod left_out;
mod mutants;
mod pictures;
#[cfg(unix)]
mod readme;
mod shared_builds;
