//! Certified solution of symmetric positive definite systems: enclosures as narrow as asked for, and exact solutions.
//!
//! `docs/certified_solve.md` proves the bound. In short: one Cholesky factor in f64 serves every precision. It proves a
//! lower bound of the smallest eigenvalue (`factor`) and corrects an approximate solution, whose residual is taken in
//! as many bits as wanted (`refine`); residual over eigenvalue bounds the error. Where f64 cannot prove the matrix
//! definite, elimination in balls takes over (`eliminate`), and the exact solution comes from elimination without
//! fractions (`fraction_free`).

mod block_sparse;
mod eliminate;
mod factor;
mod fraction_free;
mod refine;
mod system;

pub(crate) use block_sparse::BlockSparseSystem;
pub(crate) use eliminate::eliminate;
pub(crate) use factor::Factor;
pub(crate) use fraction_free::solve as fraction_free_solve;
pub(crate) use fraction_free::solve_by_parts as fraction_free_solve_by_parts;
#[cfg(test)]
pub(crate) use refine::Correctable;
pub(crate) use refine::{Residual, Solvable, Support, refine};
pub use system::{Enclosed, SolveError, SpdSystem};
