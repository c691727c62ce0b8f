//! `gate`: does this change let contact classification get worse?

use crate::doubts::tell_of_share;
use crate::exit::{ExitStatus, Outcome, print_as_it_is, print_note};
use crate::input::FormatArgs;
use crate::output_file::{allow_ours, remove_ours, step_summary};
use crate::stop::end_on_ctrl_c;
use crate::table::{prose, table};
use crate::terminal::threads;
use crate::{gate_baseline, gate_diagnosis, gate_settings};
use anyhow::Context;
use rockproof_campaign::config::{CampaignConfig, SettingPlace};
use rockproof_campaign::engines::Engines;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::run::Campaign;
use rockproof_campaign::shrink::Shrinker;
use rockproof_campaign::source::{self, FamilySource};
use rockproof_campaign::steps::{self, StepFinding, StepFindingRow};
use rockproof_differential::agreement::EngineAnswers;
use rockproof_differential::attribution::examine_pair;
use rockproof_differential::case_file::Case;
use rockproof_differential::external::spec::replay_command;
use rockproof_differential::finding::Finding;
use rockproof_differential::subject::PairSource;
use rockproof_gate::answers;
use rockproof_gate::config::{GateConfig, line_of};
use rockproof_gate::junit::Diagnosed;
use rockproof_gate::known_findings::KnownFindings;
use rockproof_gate::setting_line::place_of;
use rockproof_gate::tally::CampaignTally;
use rockproof_gate::tally_row::TallyRow;
use rockproof_gate::{self, Check, corpus, junit, limit_scope, summary};
use rockproof_model::files::read_text;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_report::load::Results;
use rockproof_report::step_verdict::step_line;
use rockproof_report::verdict::VerdictLine;
use rockproof_results::{Claim, Directory, Owner, Start, write_atomically};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Findings of failed checks that are shrunk and written as case files, over all checks.
const CASES: usize = 20;

/// The directories of the two campaigns within that of the results.
const FIXED: &str = "fixed";
const ROTATING: &str = "rotating";

/// Run the campaign, cases and limits of a gate file: for continuous integration
///
/// Writes the campaigns, and each failed check's first finding as a case to replay, to the directory of the results.
#[derive(clap::Args)]
#[command(after_help = "Example:
  rockproof gate gate.toml --junit gate.xml --rotating-seed 1234

On GitHub (GITHUB_ACTIONS, GITHUB_STEP_SUMMARY) it annotates and writes the step summary. docs/gate.md shows a gate file.

Exit status: 0 passed, 1 failed, 2 usage or input error, 130 interrupted.")]
pub(crate) struct Gate {
    /// The gate file
    file: PathBuf,
    /// Write the baseline anew from what is found now
    #[arg(long)]
    update_baseline: bool,
    /// Directory of the results; what a gate wrote there before is discarded
    #[arg(long, default_value = "reports/gate")]
    out: PathBuf,
    /// Write JUnit XML; a report of an earlier gate is replaced, any other file is not
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Seed of the rotating campaign [default: the number of today, counted from 1970]
    #[arg(long, value_name = "SEED")]
    rotating_seed: Option<u64>,
    /// Worker threads; 0, the default, is one per core; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
    threads: usize,
    #[command(flatten)]
    format: FormatArgs,
}

/// What all campaigns of a gate share.
struct Gating<'g> {
    gate: &'g Gate,
    config: GateConfig,
    engines: Engines,
    text: String,
    written: usize,
    /// What the steps of each campaign that makes some came to, by the campaign's name.
    steps: Vec<(String, VerdictLine)>,
    /// What else is to be known of what passed: that there were few pairs.
    remarks: Vec<String>,
    /// The external engines that cases of the corpus are about.
    in_corpus: BTreeSet<String>,
    /// What external engines answered in all campaigns.
    answers: BTreeMap<String, EngineAnswers>,
    /// What is wrong with external engines, where a check of a campaign fails.
    wrong: Vec<Diagnosed>,
}

impl Gate {
    pub(crate) fn run(&self) -> Outcome {
        if let Some(junit) = &self.junit {
            // Whatever comes of this gate, a report that is left of an earlier one would be taken for its own.
            remove_ours(junit, "JUnit report of a gate", junit::is_ours)?;
        }
        // Whether it can be written is seen before the work, not after it.
        step_summary()?;
        let file = self.file.display().to_string();
        let text = read_text(&self.file).with_context(|| file.clone())?;
        let config = GateConfig::from_toml(&text, &file).map_err(anyhow::Error::msg)?;
        let place = |setting: Option<SettingPlace<'_>>| place_of(&file, &text, Some("campaign"), setting);
        let engines =
            Engines::of(&config.campaign).map_err(|error| anyhow::anyhow!("{}: {error}", place(error.setting())))?;
        let source =
            source::of(&config.campaign).map_err(|error| anyhow::anyhow!("{}: {error}", place(error.setting())))?;
        self.check_names(&config, &engines, &text)?;
        limit_scope::check(&config, &source, (&file, &text)).map_err(anyhow::Error::msg)?;
        anyhow::ensure!(
            !config.limit.is_empty() || config.baseline.is_some() || !corpus::files(&config.corpus)?.is_empty(),
            "{file}: there is nothing to check: it has no [[limit]] and no [baseline], and its corpus holds no case"
        );
        let known = match &config.baseline {
            Some(baseline) if !self.update_baseline => Some(gate_baseline::load(baseline)?),
            Some(baseline) => {
                gate_baseline::is_baseline(baseline)?;
                None
            }
            None => None,
        };
        self.refuse_inputs(&config)?;
        tell_of_share(config.campaign.planarity.as_ref());
        end_on_ctrl_c()?;
        engines.probe().map_err(|error| anyhow::anyhow!("{}: {error}", place(error.setting())))?;
        // The campaigns have directories of their own in it; this says to other commands whose it is.
        let claim = Claim { dir: &self.out, owner: Owner::Gate, start: Start::Overwrite, files: &[] };
        let claimed = Directory::claim(claim)?;
        let mut checks = match corpus::checks(&config.corpus, &engines) {
            Ok(checks) => checks,
            Err(error) => {
                claimed.give_up();
                return Err(error.into());
            }
        };
        let in_corpus = corpus::engines_of(&config.corpus)?;
        let rotating = self.rotating(&config)?;
        let (steps, remarks, answers, wrong) = (Vec::new(), Vec::new(), BTreeMap::new(), Vec::new());
        let mut gating =
            Gating { gate: self, config, engines, text, written: 0, steps, remarks, in_corpus, answers, wrong };
        checks.extend(gating.campaign(FIXED, gating.config.campaign.clone(), known.as_ref())?);
        if let Some(campaign) = rotating {
            print_note(&format!("the rotating seed is {}", campaign.seed));
            checks.extend(gating.campaign(ROTATING, campaign, known.as_ref())?);
        }
        // Writing a baseline is not checking one.
        if !self.update_baseline {
            checks.extend(rockproof_gate::nothing_checked(&checks, &file));
        }
        self.report_checks(&checks, &gating)
    }

    fn check_names(&self, config: &GateConfig, engines: &Engines, text: &str) -> anyhow::Result<()> {
        let names = engines.names();
        let allowed: Vec<&str> = ["any", "f32", "f64"].into_iter().chain(names.iter().map(String::as_str)).collect();
        for limit in &config.limit {
            let (file, line) = (self.file.display(), line_of(text, limit.span().start));
            let limit = limit.get_ref();
            if let Some(found) = limit.engine.as_ref().filter(|name| !allowed.contains(&name.as_str())) {
                let found = excerpt(found, EXCERPT_LENGTH);
                anyhow::bail!("{file} line {line}: engine is \"{found}\"; allowed are {}", allowed.join(", "));
            }
            let names = |list: &Option<String>| list.iter().cloned().collect::<Vec<_>>();
            // A set from a file is called by the file's stem.
            let own = source::set_names(&config.campaign)?;
            let set = limit.tolerances.clone().filter(|name| !own.contains(name));
            let narrowed =
                CampaignConfig { families: names(&limit.family), tolerances: names(&set), ..CampaignConfig::default() };
            source::of(&narrowed).with_context(|| format!("{file} line {line}"))?;
        }
        Ok(())
    }

    /// Refuses to discard a result of an earlier run that is an input of this one, such as a case that the corpus names and the user changed.
    fn refuse_inputs(&self, config: &GateConfig) -> anyhow::Result<()> {
        let corpus = corpus::files(&config.corpus)?;
        let files = corpus.iter().chain(&config.campaign.real).chain([&self.file]);
        let files: Vec<&Path> = files.chain(config.baseline.iter().map(|b| &b.file)).map(PathBuf::as_path).collect();
        let sets = || config.campaign.tolerances.iter().map(Path::new);
        let rotating = (config.rotating_pairs > 0).then_some(ROTATING);
        for name in [FIXED].into_iter().chain(rotating) {
            Start::Overwrite.refuse_inputs(&self.out.join(name), files.iter().copied().chain(sets()))?;
        }
        Ok(())
    }

    fn rotating(&self, config: &GateConfig) -> anyhow::Result<Option<CampaignConfig>> {
        if config.rotating_pairs == 0 {
            return Ok(None);
        }
        let seed = match self.rotating_seed {
            Some(seed) => seed,
            None => {
                SystemTime::now().duration_since(UNIX_EPOCH).context("the clock is before 1970")?.as_secs() / 86_400
            }
        };
        Ok(Some(CampaignConfig { pairs: config.rotating_pairs, seed, ..config.campaign.clone() }))
    }

    fn report_checks(&self, checks: &[Check], gating: &Gating<'_>) -> Outcome {
        let steps = &gating.steps;
        let failed = checks.iter().filter(|c| c.status == rockproof_gate::CheckStatus::Fail).count();
        let text = || {
            let verdict = if failed == 0 { "passed" } else { "failed" };
            let head = table(&["verdict", "check", "found"], &[], gate_diagnosis::rows(checks));
            let steps = steps.iter().map(|(name, line)| prose(&format!("{name} campaign: {}\n", line.text)));
            let steps: String = steps.collect();
            let answers = gating.answers.iter().map(|(name, answers)| format!("; {name} {}", answers.words()));
            let answers: String = answers.collect();
            let wrong: String = gating.wrong.iter().map(|one| prose(&format!("{}\n", one.line()))).collect();
            let remarks: String = gating.remarks.iter().map(|line| prose(&format!("{line}\n"))).collect();
            format!("{head}\n\n{steps}{remarks}{wrong}gate {verdict}: {}{answers}\n", summary(checks))
        };
        self.format.print(text, || {
            let check = |c: &Check| json!({ "verdict": c.status.name(), "group": c.group, "check": c.name, "found": c.message });
            let all: Vec<Value> = checks.iter().map(check).collect();
            let line = |(name, line): &(String, VerdictLine)| json!({ "campaign": name, "severity": line.severity, "text": line.text });
            let steps: Vec<Value> = steps.iter().map(line).collect();
            let skipped = checks.iter().filter(|c| c.status == rockproof_gate::CheckStatus::Skip).count();
            json!({ "passed": failed == 0, "failed": failed, "skipped": skipped, "checks": all, "steps": steps, "remarks": gating.remarks, "diagnosis": gating.wrong.iter().map(Diagnosed::line).collect::<Vec<_>>() })
        })?;
        if let Some(path) = &self.junit {
            // A file of this gate itself may be there by now.
            allow_ours(path, "JUnit report of a gate", junit::is_ours)?;
            write_atomically(path, junit::junit(checks, &gating.wrong)?).with_context(|| path.display().to_string())?;
        }
        // The runner reads annotations on stdout, where a document stands alone.
        if !self.format.is_json() && std::env::var_os("GITHUB_ACTIONS").is_some_and(|on| on == "true") {
            print_as_it_is(&junit::annotations(checks))?;
        }
        if let Some((path, mut summary)) = step_summary()? {
            summary
                .write_all(junit::markdown(checks, &gating.wrong).as_bytes())
                .with_context(|| path.display().to_string())?;
        }
        Ok(if failed == 0 { ExitStatus::Passed } else { ExitStatus::CheckFailed })
    }
}

/// A case file.
struct CaseFile {
    name: String,
    bytes: Vec<u8>,
    /// The name of the engine that it is about.
    engine: String,
}

impl Gating<'_> {
    fn campaign(
        &mut self,
        name: &str,
        config: CampaignConfig,
        known: Option<&KnownFindings>,
    ) -> anyhow::Result<Vec<Check>> {
        // Cases are made afterwards, of what fails.
        let config = CampaignConfig { cases_per_cause: 0, ..config };
        let dir = self.gate.out.join(name);
        let begun = Instant::now();
        let source = source::of(&config)?;
        let identity = source::identity(&config)?;
        let mut journal = Journal::open_for(Owner::Gate, &dir, identity.clone(), Start::Overwrite)?;
        let (panel, engines) = (self.engines.panel(), &self.engines);
        let narrow = |finding: &Finding| engines.panel_for(finding);
        let names = engines.names();
        let steppers = steps::engines(names.iter().map(String::as_str));
        let campaign = Campaign {
            config: &config,
            source: &source,
            panel: &panel,
            narrow: &narrow,
            steppers: &steppers,
            threads: self.gate.threads,
        };
        campaign.run(&mut journal, &AtomicBool::new(false), &mut |_| {})?;
        let tally = CampaignTally::read(&dir)?;
        if !journal.progress().steps.is_empty() {
            let line = step_line(&Results::read(std::slice::from_ref(&dir))?.campaigns);
            self.steps.extend(line.map(|line| (name.to_owned(), line)));
        }
        let file = self.gate.file.display().to_string();
        let mut checks = rockproof_gate::limits(&self.config, (&file, &self.text), name, &tally);
        let answers = answers::checks(&self.config, (&file, name), &tally, &checks, &self.in_corpus);
        checks.extend(answers);
        for spec in &self.config.campaign.external {
            let (sum, of) = (self.answers.entry(spec.name.clone()).or_default(), tally.answers(&spec.name));
            sum.add(of);
        }
        if let Some(baseline) = self.config.baseline.as_ref() {
            if let Some(known) = known {
                checks.extend(known.check(name, &tally, baseline, &gate_settings::of(identity)));
            } else if self.gate.update_baseline && name == FIXED {
                let text = KnownFindings::of(&tally, baseline, gate_settings::of(identity)).to_toml();
                write_atomically(&baseline.file, text).with_context(|| baseline.file.display().to_string())?;
                print_note(&format!("written: {}", baseline.file.display()));
            }
        }
        let few = gate_diagnosis::few_pairs_note(journal.progress().pairs_done, &checks);
        self.remarks.extend(few.map(|few| format!("{name} campaign: {few}")));
        let wrong = gate_diagnosis::lines(&campaign, &mut journal, &checks).unwrap_or_else(|error| {
            // The verdict stands without it.
            print_note(&format!("{name} campaign: nothing is known of what is wrong: {error:#}"));
            Vec::new()
        });
        self.wrong.extend(wrong.into_iter().map(|sentence| Diagnosed { campaign: name.to_owned(), sentence }));
        let share = begun.elapsed().as_secs_f64() / checks.len().max(1) as f64;
        for check in &mut checks {
            check.seconds = share;
            if let Some(&row) = check.rows.first() {
                let case = self.case_of(&source, &config, &tally.rows[row])?;
                // Else what the engines were asked for the case is worth nothing.
                self.engines.check_shortage()?;
                check.replay = case.map(|case| self.write(&mut journal, case)).transpose()?;
            }
        }
        Ok(checks)
    }

    /// The shrunk case of a row; none where there are enough already, or the finding has none.
    fn case_of(
        &self,
        source: &FamilySource,
        config: &CampaignConfig,
        row: &TallyRow,
    ) -> anyhow::Result<Option<CaseFile>> {
        if self.written >= CASES {
            return Ok(None);
        }
        let panel = self.engines.panel();
        let row = match row {
            TallyRow::Pair(row) => row,
            TallyRow::Step(row) => return self.case_of_step(source, config, row),
        };
        let subjects = source.batch(row.index / source.batch_len());
        let Some(subject) = subjects.iter().find(|s| s.index == row.index) else { return Ok(None) };
        let same = |finding: &Finding| finding.row(row.case.clone()) == *row;
        let Some(finding) = examine_pair(subject, &panel).findings.into_iter().find(same) else { return Ok(None) };
        let panel = self.engines.panel_for(&finding);
        let Some(case) = Case::of(&finding, subject, config.seed, &panel) else { return Ok(None) };
        let case = Shrinker::new(&panel, config.shrink_evaluations).shrink(case);
        let stem = finding.fingerprint().file_stem(&finding.set, finding.index);
        let bytes = case.to_toml()?.into_bytes();
        Ok(Some(CaseFile { name: format!("{stem}.toml"), bytes, engine: case.about.engine }))
    }

    /// The case of a row about a step.
    fn case_of_step(
        &self,
        source: &FamilySource,
        config: &CampaignConfig,
        row: &StepFindingRow,
    ) -> anyhow::Result<Option<CaseFile>> {
        let names = self.engines.names();
        let steppers = steps::engines(names.iter().map(String::as_str));
        let Some((subject, motion)) = source.moving(row.index, &row.family) else { return Ok(None) };
        let found = steps::examine_all(&[(&subject, motion.clone())], &steppers).findings;
        let same = |finding: &StepFinding| finding.row(row.case.clone()) == *row;
        let Some(finding) = found.into_iter().find(same) else { return Ok(None) };
        let Some(case) = steps::case::of(&finding, &subject, &motion, &steppers, config.shrink_evaluations) else {
            return Ok(None);
        };
        Ok(Some(CaseFile { name: row.file_name(), bytes: case.text()?, engine: case.engine }))
    }

    /// Writes a case, and tells the command that replays it.
    fn write(&mut self, journal: &mut Journal, case: CaseFile) -> anyhow::Result<String> {
        let file = journal.dir().join("cases").join(&case.name);
        let replay = replay_command(&file, self.engines.spec(&case.engine));
        print_note(&format!("to replay: {replay}"));
        journal.write_cases(vec![(case.name, case.bytes)])?;
        self.written += 1;
        Ok(replay)
    }
}
