//! A gate passes only where something was checked and could have failed: external engines that answer, limits that concern what takes part.

use crate::campaigns::WITHOUT_CASES;
use crate::engines::client;
use crate::gates::{Ran, around, gate};
use crate::place::Place;
use std::path::Path;

/// An engine that says the same to every question.
fn always(answer: &str) -> Vec<String> {
    let edit = format!(r#"s/^{{"id":\([0-9]*\),.*/{{"id":\1,{answer}}}/"#);
    vec!["sed".to_owned(), "-u".to_owned(), edit]
}

fn around_engine(command: &[String], rest: &str) -> String {
    around(&command.iter().map(String::as_str).collect::<Vec<_>>(), rest).replace("pairs = 256", "pairs = 32")
}

const DEFECT: &str = "[[limit]]\ncause = \"defect\"\ncount = 0\n";
const OF_MINE: &str = "[[limit]]\nengine = \"mine\"\ntolerances = \"auto\"\nbeyond_ulps = 1000\nrate = 0.001\n";

#[cfg(unix)]
#[test]
fn an_engine_that_answers_nothing_fails() {
    let dir = crate::place::folder();
    let dir = dir.path();
    for (answer, told) in [(r#""unsupported":"not today""#, "unsupported "), (r#""contact":[]"#, "malformed ")] {
        let engine = always(answer);
        let ran = gate(dir, &around_engine(&engine, &format!("{DEFECT}{OF_MINE}")), &[], false);
        if ran.code == 2 {
            assert!(ran.err.contains("does not answer a first question"), "{}", ran.err);
            continue;
        }
        assert!(ran.code == 1 && ran.out.contains("FAIL"), "{}{}", ran.out, ran.err);
        let row = ran.out.lines().find(|line| line.contains("fixed: engine mine answers")).expect("a row");
        assert!(row.contains("FAIL") && row.contains("answered none of ") && row.contains(told), "{row}");
        assert!(ran.out.contains("; mine answered 0 of "), "{}", ran.out);
    }
    // One that answers all but some passes, and it is said how many.
    let limit = "[[limit]]\nengine = \"mine\"\nrate = 0.5\n";
    let ran = gate(dir, &around(&[&client(), "crash"], limit), &[], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let told = ran.out.rsplit_once("; mine answered ").expect("a summary").1;
    let counts: Vec<u64> = told.split(' ').filter_map(|word| word.parse().ok()).collect();
    assert!(matches!(counts[..], [answered, asked] if 0 < answered && answered < asked), "{told}");
    let junit = std::fs::read_to_string(dir.join("junit.xml")).expect("JUnit");
    assert!(junit.contains("rockproof.engine"), "{junit}");
}

#[cfg(unix)]
#[test]
fn an_engine_that_no_limit_concerns_fails_and_a_limit_that_concerns_none_is_skipped() {
    let dir = crate::place::folder();
    let empty = always(r#""contacts":[]"#);
    let ran = gate(dir.path(), &around_engine(&empty, DEFECT), &[], false);
    assert!(
        ran.code == 1 && ran.out.contains("no case is about what it answers, so whatever it answers would pass"),
        "{}",
        ran.out
    );
    let row = ran.out.lines().find(|line| line.contains("fixed: cause defect")).expect("a row");
    assert!(row.contains("skip") && row.contains("no built-in engine takes part"), "{row}");
    assert!(ran.out.contains("gate failed: 0 passed, 1 skipped, 1 failed; mine answered "), "{}", ran.out);
    // Beside a built-in engine the limit holds, and of the other it says nothing.
    let both = around_engine(&empty, DEFECT).replace("engines = []", "engines = [\"stepper-f64\", \"mine\"]");
    let ran = gate(dir.path(), &both, &[], false);
    assert!(ran.code == 1 && ran.out.contains("gate failed: 1 passed, 0 skipped, 1 failed"), "{}", ran.out);
    for limit in ["cause = \"engine\"\n", "engine = \"mine\"\n", "change = \"missing\"\n", ""] {
        let ran = gate(dir.path(), &around_engine(&empty, &format!("[[limit]]\n{limit}count = 0\n")), &[], false);
        assert!(ran.code == 1 && !ran.out.contains("would pass"), "{limit}: {}", ran.out);
        let row = ran.out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
        assert!(row.contains("pass"), "{limit}: {row}");
    }
    // None of these can be broken by an answer, so they say nothing of what it answers; nor does one that is skipped.
    for limit in [
        "change = \"recovered\"\ncount = 0\n",
        "engine = \"mine\"\nchange = \"crash\"\ncount = 0\n",
        "change = \"timeout\"\ncount = 0\n",
        "engine = \"mine\"\nrate = 0.999\n",
    ] {
        let ran = gate(dir.path(), &around_engine(&empty, &format!("[[limit]]\n{limit}")), &[], false);
        let row = ran.out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
        assert!(ran.code == 1 && row.contains("FAIL"), "{limit}: {}", ran.out);
    }
    for (limit, why) in [
        ("engine = \"mine\"\ncause = \"defect\"\n", "have the cause engine"),
        ("engine = \"mine\"\ncause = \"tolerance\"\n", "not about mine"),
    ] {
        let text = around_engine(&empty, &format!("[[limit]]\n{limit}count = 0\n"));
        let ran = gate(dir.path(), &text, &[], false);
        let row = ran.out.lines().find(|line| line.contains("fixed: engine mine, cause")).expect("a row");
        assert!(ran.code == 1 && row.contains("skip") && row.contains(why), "{limit}: {}", ran.out);
    }
}

/// Pairs of the family `passage` make steps alone, which external engines do not make: neither a gate nor `--deny` passes where one was asked nothing.
#[cfg(unix)]
#[test]
fn an_engine_that_is_asked_nothing_fails() {
    let place = Place::new();
    place.file("mine.sh", "exec sed -u 's/^{\"id\":\\([0-9]*\\),.*/{\"id\":\\1,\"contacts\":[]}/'\n");
    let steps = "pairs = 32\nsteps_every = 1\nfamilies = [\"passage\"]\nengines = [\"stepper-f64\", \"mine\"]\ntolerances = [\"auto\"]\n\
                 cases_per_cause = 0\nshrink_evaluations = 0\n";
    let mine = "[[EXTERNAL]]\nname = \"mine\"\ncommand = \"sh mine.sh\"\n";
    let limits = "[[limit]]\nengine = \"mine\"\ncount = 0\n[[limit]]\nchange = \"passage\"\ncount = 999\n";
    place.file(
        "gate.toml",
        &format!("corpus = []\n[campaign]\n{steps}{}{limits}", mine.replace("EXTERNAL", "campaign.external")),
    );
    let (code, out, err) = place.run(&["gate", "gate.toml"]);
    let row = out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
    assert!(code == 1 && row.contains("FAIL") && row.contains("was asked about no pair"), "{out}{err}");
    // Cases of a corpus ask it without any pair of a campaign.
    let case = include_str!("../../cases/regressions/f-v-arithmetic-vertex-face-depth.toml");
    let engine = case.lines().find(|line| line.starts_with("engine = ")).expect("an engine");
    place.file("case.toml", &case.replace(engine, "engine = \"mine\""));
    let of_corpus =
        format!("corpus = [\"case.toml\"]\n[campaign]\npairs = 0\n{}", mine.replace("EXTERNAL", "campaign.external"));
    place.file("gate.toml", &of_corpus);
    let (code, out, err) = place.run(&["gate", "gate.toml"]);
    assert!(code == 0 && out.contains("cases of the corpus ask it"), "{out}{err}");
    // A limit on that family is about nothing that such an engine answers.
    let both = steps.replace("\"passage\"]", "\"passage\", \"sliver\"]");
    let limit = "[[limit]]\nengine = \"mine\"\nfamily = \"passage\"\ncount = 0\n";
    place.file(
        "gate.toml",
        &format!("corpus = []\n[campaign]\n{both}{}{limit}", mine.replace("EXTERNAL", "campaign.external")),
    );
    let (code, out, err) = place.run(&["gate", "gate.toml"]);
    assert!(code == 1 && out.contains("built-in engines alone make steps") && out.contains("would pass"), "{out}{err}");
    place.file("settings.toml", &format!("{steps}{}", mine.replace("EXTERNAL", "external")));
    let (code, out, err) = place.run(&["campaign", "settings.toml", "--out", "run", "--deny", "engine"]);
    assert!(
        code == 1 && err.contains("denied: mine was asked about no pair, since they make steps alone"),
        "{out}{err}"
    );
}

fn own(dir: &Path, campaign: &str, rest: &str) -> (i32, String) {
    let ran = gate(dir, &format!("corpus = []\n[campaign]\n{campaign}{rest}"), &[], false);
    (ran.code, ran.out + &ran.err)
}

#[test]
fn a_gate_with_nothing_to_check_is_refused() {
    let dir = crate::place::folder();
    // What is deeper is not looked at.
    std::fs::create_dir_all(dir.path().join("empty/deep")).expect("folders");
    std::fs::write(dir.path().join("empty/deep/case.toml"), "").expect("written");
    for (corpus, why) in
        [("[]", "gate.toml: there is nothing to check"), ("[\"empty\"]", "the folder empty holds no case")]
    {
        let ran = gate(dir.path(), &format!("corpus = {corpus}\n[campaign]\npairs = 16\n"), &[], false);
        assert!(ran.code == 2 && ran.err.contains(why), "{}{}", ran.out, ran.err);
    }
    // Pairs of families would be examined in place of those asked for.
    let limit = "[[limit]]\ncause = \"defect\"\ncount = 0\n";
    let ran = gate(dir.path(), &format!("corpus = []\n[campaign]\npairs = 16\nstress = true\n{limit}"), &[], false);
    assert!(ran.code == 2 && ran.err.contains("gate.toml line 4: campaign.stress is true"), "{}{}", ran.out, ran.err);
    assert!(!dir.path().join("reports").exists(), "it is said before the work begins");
}

#[test]
fn a_limit_that_nothing_can_break_is_refused_or_skipped() {
    let dir = crate::place::folder();
    let sliver = "pairs = 16\nfamilies = [\"sliver\"]\ntolerances = [\"auto\"]\nengines = [\"stepper-f64\"]\n";
    for (limit, why) in [
        ("change = \"passage\"", "no pair makes steps (campaign.steps_every is 0)"),
        ("change = \"iterations\"", "no pair makes steps"),
        ("cause = \"not-held\"", "no pair makes steps"),
        ("family = \"passage\"", "no pair makes steps"),
        ("family = \"face_stack\"", "family face_stack is none of its families, which are sliver"),
        ("tolerances = \"shi\"", "tolerances shi are none of its sets, which are auto"),
        ("engine = \"f32\"", "no engine that is given f32 takes part"),
        ("change = \"swap\"", "(campaign.metamorphic_every is 0)"),
        ("change = \"unstable\"", "(campaign.ask_twice is false)"),
        ("beyond_ulps = 1e17", "in f64 nothing is 2^55 roundoffs from a tie"),
    ] {
        let sliver = format!("{sliver}metamorphic_every = 0\n");
        let (code, said) = own(dir.path(), &sliver, &format!("[[limit]]\n{limit}\ncount = 0\n"));
        assert!(code == 2 && said.contains("gate.toml line 8: the limit ") && said.contains(why), "{limit}: {said}");
    }
    // No campaign has such findings.
    for (limit, why) in [
        ("change = \"passage\"\nkind = \"v-v\"", "kind is that of a contact"),
        ("change = \"passage\"\nbeyond_ulps = 10", "beyond_ulps leaves out what has no margin"),
        ("cause = \"not-held\"\nbeyond_ulps = 10", "beyond_ulps leaves out what has no margin"),
        ("cause = \"tolerance\"\nbeyond_ulps = 0", "beyond_ulps counts roundoffs"),
        ("cause = \"tolerance\"\nchange = \"collapsed\"", "allowed with this change: representation"),
        ("cause = \"representation\"\nchange = \"swap\"", "allowed with this change: arithmetic, defect, engine"),
        ("change = \"collapsed\"\nkind = \"v-v\"", "kind is that of a contact"),
        ("change = \"mode\"\ncause = \"engine\"", "allowed with this change: tolerance, representation"),
        ("change = \"unsupported\"\nbeyond_ulps = 4", "beyond_ulps leaves out what has no margin"),
        ("family = \"passage\"\nchange = \"swap\"", "make steps alone"),
        ("family = \"passage\"\ncause = \"engine\"", "make steps alone"),
    ] {
        let (code, said) = own(dir.path(), sliver, &format!("[[limit]]\n{limit}\ncount = 0\n"));
        assert!(code == 2 && said.contains("gate.toml line 7: ") && said.contains(why), "{limit}: {said}");
    }
    // Nor has this one, in which no external engine takes part.
    for (limit, why) in [
        ("engine = \"f64\"\ncause = \"defect\"", "about one engine, by its name, not about f64"),
        ("engine = \"any\"\ncause = \"arithmetic\"", "about one engine, by its name, not about any"),
        ("change = \"crash\"", "only external engines have this change, and none takes part"),
        ("change = \"unsupported\"", "only external engines have this change, and none takes part"),
        ("engine = \"stepper-f64\"\nchange = \"collapsed\"", "about f32 or f64, not about stepper-f64"),
        ("engine = \"any\"\ncause = \"representation\"", "about f32 or f64, not about any"),
        ("change = \"state\"", "only external engines have this change, and none takes part"),
    ] {
        let (code, said) = own(dir.path(), sliver, &format!("[[limit]]\n{limit}\ncount = 0\n"));
        assert!(code == 1 && said.contains("skip") && said.contains(why), "{limit}: {said}");
    }
    let of_engines = format!("corpus = []\n[campaign]\n{sliver}[[limit]]\ncause = \"engine\"\ncount = 0\n");
    let Ran { code, out, err } = gate(dir.path(), &of_engines, &[], true);
    assert!(code == 1 && out.contains("only findings about external engines have this cause"), "{out}{err}");
    let why = "every check was skipped, for the reasons given, so nothing was checked";
    assert!(out.contains("gate failed: 0 passed, 1 skipped, 1 failed"), "{out}");
    let annotated = |line: &str| line.starts_with("::error file=gate.toml,line=1,") && line.contains(why);
    assert!(out.lines().any(annotated), "an annotation says so: {out}");
    for file in ["junit.xml", "summary.md"] {
        let text = std::fs::read_to_string(dir.path().join(file)).expect(file);
        assert!(text.contains("the gate checks something") && text.contains(why), "{file}: {text}");
    }
    // One batch is of one family.
    let few = "pairs = 16\nfamilies = [\"sliver\", \"face_stack\"]\n";
    let limits = "[[limit]]\nfamily = \"sliver\"\ncount = 0\n[[limit]]\ncause = \"defect\"\ncount = 0\n";
    let (code, said) = own(dir.path(), few, limits);
    assert!(code == 0 && said.contains("skip") && said.contains("no pair with family sliver was examined"), "{said}");
}

/// An engine that says only how blocks lie can break no limit on contacts, and one that names contacts none on how they lie.
#[cfg(unix)]
#[test]
fn a_limit_on_what_an_engine_does_not_say_is_none_on_its_answers() {
    let dir = crate::place::folder();
    let apart = always(r#""state":"apart","gap":1"#);
    let contacts = always(r#""contacts":[]"#);
    for (engine, limit, passes) in [
        (&apart, "change = \"missing\"", false),
        (&apart, "kind = \"v-v\"", false),
        (&apart, "change = \"state\"", true),
        (&apart, "", true),
        (&contacts, "change = \"state\"", false),
        (&contacts, "change = \"missing\"", true),
        (&contacts, "change = \"entrance\"", false),
    ] {
        let limit = format!("[[limit]]\nengine = \"mine\"\n{limit}\ncount = 9999\n");
        let ran = gate(dir.path(), &around_engine(engine, &limit), &[], false);
        let row = ran.out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
        let told = (ran.code == 0, row.contains(" pass "), row.contains("whatever it answers would pass"));
        assert_eq!(told, (passes, passes, !passes), "{limit}: {}{}", ran.out, ran.err);
    }
}

#[test]
fn a_rate_says_from_where_on_it_fails_and_is_skipped_where_it_cannot() {
    let dir = crate::place::folder();
    let sliver = "pairs = 16\nfamilies = [\"sliver\"]\ntolerances = [\"auto\"]\nengines = [\"stepper-f64\"]\n";
    let (code, said) = own(dir.path(), sliver, "[[limit]]\ncause = \"defect\"\nrate = 0.001\n");
    // 1 − 0.999¹⁶ is 1.6 %; two of sixteen come by chance with 1.2e-4.
    assert!(code == 0 && said.contains("0 of 16 pairs") && said.contains(", fails from 2 on;"), "{said}");
    assert!(said.contains("gate passed: 1 passed, 0 skipped, 0 failed\n"), "{said}");
    // 0.9¹⁶ is 18 %.
    let (code, said) = own(dir.path(), sliver, "[[limit]]\ncause = \"defect\"\nrate = 0.9\n");
    assert!(code == 1 && said.contains("so few pairs can never fail") && said.contains("skip"), "{said}");
    assert!(said.contains("gate failed: 0 passed, 1 skipped, 1 failed\n"), "{said}");
}

#[cfg(unix)]
#[test]
fn deny_says_which_causes_do_not_concern_external_engines() {
    let dir = crate::place::folder();
    let engine = format!("mine={} none", client());
    let run = |more: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("rockproof").expect("the program");
        command.current_dir(dir.path()).args([
            "campaign",
            WITHOUT_CASES,
            "--pairs",
            "32",
            "--family",
            "face_stack",
            "--overwrite",
        ]);
        let output = command.args(["--engine-command", &engine, "--out", "run"]).args(more).output().expect("runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let told =
        "--deny defect does not concern mine: findings about external engines have the cause engine (--deny engine)";
    let (code, err) = run(&["--deny", "defect"]);
    assert!(code == Some(0) && err.contains(told), "{err}");
    let (code, err) = run(&["--deny", "defect", "--deny", "engine"]);
    assert!(code == Some(1) && !err.contains("does not concern"), "{err}");
}

#[cfg(unix)]
#[test]
fn what_is_no_answer_is_no_rounding() {
    let dir = crate::place::folder();
    let beyond = "[[limit]]\nengine = \"mine\"\nbeyond_ulps = 1000\ncount = 0\n";
    // Of two of three pairs the answers are right. For more lines after a malformed one it is waited, so of it the pairs are fewer.
    let around_trick = |trick: &str, rest: &str| {
        let pairs = if trick == "malformed" { "pairs = 96" } else { "pairs = 256" };
        around(&[&client(), trick], rest).replace("pairs = 256", pairs)
    };
    let fails = |trick: &str| {
        let dir = crate::place::folder();
        let ran = gate(dir.path(), &around_trick(trick, beyond), &[], false);
        let row = ran.out.lines().find(|line| line.contains("beyond 1000 roundoffs")).expect("a row");
        assert!(ran.code == 1 && row.contains("FAIL"), "{trick}: {}{}", ran.out, ran.err);
    };
    // It is about no contact.
    let passes = |trick: &str| {
        let dir = crate::place::folder();
        let of_kind = format!("{beyond}kind = \"v-f\"\n");
        let ran = gate(dir.path(), &around_trick(trick, &of_kind), &[], false);
        assert_eq!(ran.code, 0, "{trick}: {}{}", ran.out, ran.err);
    };
    // All at a time, since they wait most of theirs.
    std::thread::scope(|scope| {
        for trick in ["crash", "malformed", "unasked"] {
            scope.spawn(move || fails(trick));
            scope.spawn(move || passes(trick));
        }
    });
    // One that says so of some pairs does no wrong; one that says so of most was not checked.
    let ran = gate(dir.path(), &around(&[&client(), "unsupported"], beyond), &[], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let first =
        r#"1s/^{"id":\([0-9]*\),.*/{"id":\1,"contacts":[]}/;1!s/^{"id":\([0-9]*\),.*/{"id":\1,"unsupported":"no"}/"#;
    let lazy = ["sed", "-u", first].map(str::to_owned);
    let ran = gate(dir.path(), &around_engine(&lazy, &beyond.replace("count = 0", "count = 999")), &[], false);
    let row = ran.out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
    let told = row.contains("FAIL") && row.contains(", less than half: unsupported ");
    assert!(ran.code == 1 && told, "{}{}", ran.out, ran.err);
}

/// Where nothing was compared nothing can be found: that passed any `--deny`.
#[cfg(unix)]
#[test]
fn a_campaign_that_compared_nothing_is_denied() {
    let place = crate::place::Place::new();
    let words = |answer: &str| {
        let words: Vec<String> =
            always(answer).iter().map(|word| toml::Value::from(word.as_str()).to_string()).collect();
        format!(
            "pairs = 32\nengines = [\"mine\"]\ncases_per_cause = 0\n[[external]]\nname = \"mine\"\ncommand = [{}]\n",
            words.join(", ")
        )
    };
    place.file("none.toml", &words(r#""unsupported":"not today""#));
    for deny in ["defect", "crash", "extra,recovered", "any"] {
        let (code, _, err) = place.run(&["campaign", "none.toml", "--deny", deny, "--out", "none", "--overwrite"]);
        assert_eq!(code, 1, "{deny}: {err}");
        assert!(err.contains("denied: mine answered none of ") && err.contains("so nothing was compared"), "{err}");
    }
    // The first questions alone have an answer, so that something is compared.
    let [_, _, edit] = &always(r#""unsupported":"not today""#)[..] else { panic!("three words") };
    let command = format!(
        "[\"sed\", \"-u\", {}]",
        toml::Value::from(format!("1,3s/^{{\"id\":\\([0-9]*\\),.*/{{\"id\":\\1,\"contacts\":[]}}/;t;{edit}"))
    );
    let few = words("")
        .lines()
        .filter(|line| !line.starts_with("command"))
        .map(|line| format!("{line}\n"))
        .collect::<String>();
    place.file("few.toml", &format!("{few}command = {command}\n"));
    let (code, _, err) = place.run(&["campaign", "few.toml", "--deny", "defect", "--threads", "1", "--out", "few"]);
    assert!(code == 1 && err.contains(", less than half, so next to nothing was compared"), "{err}");
    let (code, _, err) = place.run(&["campaign", "none.toml", "--out", "none", "--overwrite"]);
    assert!(code == 0 && !err.contains("denied"), "without --deny nothing is: {err}");
    place.file("some.toml", &words(r#""contacts":[]"#));
    let (code, _, err) = place.run(&["campaign", "some.toml", "--deny", "crash", "--out", "some"]);
    assert!(code == 0 && !err.contains("denied"), "{err}");
}

/// A mistake shows as very many sorts of finding that the baseline does not know: what it is is told.
#[test]
fn a_gate_that_fails_says_what_is_wrong_with_an_engine() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let baseline = "[baseline]\nfile = \"known.toml\"\ncauses = [\"engine\"]\n";
    let ran = gate(dir, &around(&[&client(), ""], baseline), &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let ran = gate(dir, &around(&[&client(), ""], baseline), &[], false);
    assert!(ran.code == 0 && !ran.out.contains("fixed campaign: mine"), "{}{}", ran.out, ran.err);
    let ran = gate(dir, &around(&[&client(), "sign"], baseline), &[], false);
    let told = "differing answers are exact with the sign of every gap turned";
    let unfolded = ran.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(ran.code == 1 && unfolded.contains("fixed campaign: mine: ") && unfolded.contains(told), "{}", ran.out);
    let new = ran.out.lines().filter(|line| line.contains("new: ")).count();
    assert!(new <= 20, "{new} rows");
}
