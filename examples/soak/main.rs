//! Attacks the built program for so many minutes, and says what was tried:
//!
//! ```text
//! cargo run --release --example soak -- --minutes 2
//! cargo run --release --example soak -- --minutes 40 --seed 7
//! cargo run --release --example soak -- --seed 7 --step 123      one step again
//! ```
//!
//! Each step is an attack that seed and number choose: campaigns, parts with their merge, simulations and searches are killed, interrupted, run out of
//! room, find their directory read-only, run under other time zones, languages and clocks, find their files damaged; engines misbehave; input is
//! mutated. Afterwards the work goes on, and every file must hold the bytes of a run that was never disturbed. Nothing may panic, take more
//! than [`program::MAX_SECONDS`] of processor time or [`program::MAX_MEMORY`] of memory. The last line counts what was done; exit 1 when
//! anything was wrong. The moment of a kill depends on the clock, so a failure that a step has once may need the step repeated.
//!
//! The program is the one that the variable ROCKPROOF names, or is built. Needs Linux and a C compiler; full disks need root.

#[cfg(target_os = "linux")]
mod attacks;
#[cfg(target_os = "linux")]
mod clock;
#[cfg(target_os = "linux")]
mod counts;
#[cfg(target_os = "linux")]
mod engines;
#[cfg(target_os = "linux")]
mod inputs;
#[cfg(target_os = "linux")]
mod jobs;
#[cfg(target_os = "linux")]
mod program;
#[cfg(target_os = "linux")]
mod run;
#[cfg(target_os = "linux")]
mod tmpfs;

#[cfg(target_os = "linux")]
fn main() -> std::process::ExitCode {
    run::main()
}

#[cfg(not(target_os = "linux"))]
fn main() -> std::process::ExitCode {
    eprintln!("error: the soak needs Linux: it limits and watches processes as Linux does");
    std::process::ExitCode::from(2)
}
