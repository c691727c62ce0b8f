//! The program as its users call it: what each command prints, writes and answers to mistakes.

#[path = "../support/campaigns.rs"]
mod campaigns;
#[path = "../support/engines.rs"]
mod engines;
#[path = "../support/gate.rs"]
mod gates;
#[path = "../support/mistaken_engine.rs"]
mod mistaken_engine;
#[path = "../../crates/stepper/tests/support/mistakes.rs"]
mod mistakes;
#[path = "../support/place.rs"]
mod place;
#[path = "../support/processes.rs"]
mod processes;

mod bad_input;
mod bench_command;
mod campaign_cli;
mod campaign_default;
mod campaign_end;
mod check_command;
mod command_line;
mod compare_command;
mod diagnosis;
#[cfg(unix)]
mod engine_answers;
mod engine_processes;
mod examine_command;
mod examine_limits;
mod external_engines;
mod false_entrances;
mod gate_command;
mod gate_contradictions;
mod gate_evidence;
mod gate_formats;
mod gate_given;
mod gate_leftovers;
mod gate_limits;
#[cfg(unix)]
mod gate_regressions;
mod gate_unsaid;
mod gate_verdicts;
mod input_without_effect;
mod json_output;
mod kept_results;
#[cfg(target_os = "linux")]
mod large_files;
mod latex;
mod local_origin;
mod lockstep_cli;
mod merge_command;
mod model_doubts;
mod model_warnings;
mod numbers_in_settings;
mod output_files;
mod passages;
mod remedies;
mod report_command;
mod report_page;
mod report_runs;
mod results;
mod run_end;
mod scene_doubts;
mod second_signal;
mod self_comparison;
mod simulate_audit;
mod simulate_cli;
mod simulate_record;
mod soak;
mod stdin;
mod stress_command;
mod tune_command;
mod unseen_overlaps;
mod untrusted_input;
mod untrusted_names;
mod untrusted_results;
mod weld;
