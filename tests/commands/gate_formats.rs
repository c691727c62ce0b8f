//! What the gate writes is what its readers take, also where names and messages hold what means something in the format: JUnit XML by
//! the elements and attributes that its schema (Jenkins' junit-10.xsd, and `skipped` of all suites, as most tools write it) allows, GitHub's commands by a reader that does what the runner does, the
//! summary by a Markdown parser.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use rockproof_gate::junit::{Diagnosed, annotations, is_ours, junit, markdown};
use rockproof_gate::{Check, CheckStatus};
use std::collections::BTreeMap;

const NASTY: &str = "50%: a,b::c | d_e_f *g* `h` <i> & \"j\" [k](l) \\ m%0An";

fn check(group: &'static str, name: &str, message: &str, status: CheckStatus) -> Check {
    let place = (format!("a,b:c%/{name}.toml"), 3);
    let replay = (name == "b").then(|| "rockproof replay reports/gate/fixed/cases/b.toml".to_owned());
    Check {
        group,
        name: name.to_owned(),
        message: message.to_owned(),
        status,
        place,
        rows: Vec::new(),
        seconds: 0.25,
        replay,
    }
}

fn checks() -> Vec<Check> {
    vec![
        check("limit", NASTY, "first line\nsecond line", CheckStatus::Fail),
        check("limit", "plain", "fine", CheckStatus::Pass),
        check("baseline", "b", NASTY, CheckStatus::Fail),
        check("corpus", "skipped | case", "an engine takes no part", CheckStatus::Skip),
        check("corpus", "passed", "", CheckStatus::Pass),
        check("corpus", "stderr", "\u{1b}[31mred\u{0}\u{7}", CheckStatus::Fail),
    ]
}

/// Elements with their attributes (a `!` means required) and children, from that schema.
const SCHEMA: [(&str, &[&str], &[&str]); 7] = [
    (
        "testsuites",
        &["name", "time", "tests", "failures", "disabled", "errors", "skipped", "timestamp"],
        &["testsuite"],
    ),
    (
        "testsuite",
        &[
            "name!",
            "tests",
            "failures",
            "errors",
            "time",
            "disabled",
            "skipped",
            "timestamp",
            "hostname",
            "id",
            "package",
            "file",
            "log",
            "url",
            "version",
            "group",
        ],
        &["properties", "testcase", "system-out", "system-err"],
    ),
    (
        "testcase",
        &["name!", "classname", "time", "assertions", "status", "class", "file", "line", "group", "url", "timestamp"],
        &["skipped", "error", "failure", "system-out", "system-err", "properties"],
    ),
    ("failure", &["type", "message"], &[]),
    ("error", &["type", "message"], &[]),
    ("skipped", &["type", "message"], &[]),
    ("system-out", &[], &[]),
];

fn valid(node: roxmltree::Node<'_, '_>) {
    let name = node.tag_name().name();
    let (_, attributes, children) = SCHEMA.iter().find(|(element, ..)| *element == name).expect(name);
    for attribute in node.attributes() {
        let known = attributes.iter().any(|known| known.trim_end_matches('!') == attribute.name());
        assert!(known, "{name} may not have {}", attribute.name());
    }
    for required in attributes.iter().filter_map(|attribute| attribute.strip_suffix('!')) {
        assert!(node.has_attribute(required), "{name} needs {required}");
    }
    for child in node.children().filter(roxmltree::Node::is_element) {
        assert!(children.contains(&child.tag_name().name()), "{name} may not hold {}", child.tag_name().name());
        valid(child);
    }
}

#[test]
fn junit_is_what_its_schema_allows() {
    let text = junit(&checks(), &[]).expect("XML");
    assert!(is_ours(&text) && !is_ours(&text.replacen("rockproof gate", "unit tests", 1)), "{text}");
    let xml = roxmltree::Document::parse(&text).expect("XML");
    assert_eq!(xml.root_element().tag_name().name(), "testsuites");
    valid(xml.root_element());
    let suites: Vec<_> = xml.root_element().children().filter(|node| node.has_tag_name("testsuite")).collect();
    let counts: Vec<_> =
        ["tests", "failures"].map(|key| suites.iter().map(|s| s.attribute(key).expect(key)).collect::<Vec<_>>()).into();
    assert_eq!(counts, [["2", "1", "3"], ["1", "1", "1"]]);
    let cases: Vec<_> = xml.descendants().filter(|node| node.has_tag_name("testcase")).collect();
    assert_eq!(cases[0].attribute("name"), Some(NASTY));
    let status = |at: usize| cases[at].children().find(roxmltree::Node::is_element);
    assert_eq!(status(2).and_then(|failure| failure.attribute("message")), Some(NASTY));
    assert_eq!(status(3).map(|node| node.tag_name().name()), Some("skipped"));
    assert_eq!(
        status(1).map(|node| node.tag_name().name()),
        Some("system-out"),
        "what was found of a limit that passes"
    );
    assert!(status(4).is_none());
    assert_eq!(xml.root_element().attribute("time"), Some("1.500"));
    assert_eq!(
        suites.iter().map(|suite| suite.attribute("time")).collect::<Vec<_>>(),
        [Some("0.500"), Some("0.250"), Some("0.750")]
    );
    assert!(cases.iter().all(|case| case.attribute("time") == Some("0.250")));
    let said = |at: usize| status(at).and_then(|failure| failure.text());
    assert_eq!([said(0), said(2)], [None, Some("rockproof replay reports/gate/fixed/cases/b.toml")]);
    let red = status(5).and_then(|failure| failure.attribute("message")).expect("a message");
    assert!(red.contains("red") && !red.contains(char::is_control), "{red:?}");
}

#[test]
fn no_line_of_junit_is_a_command_to_a_runner_that_prints_it() {
    let text =
        junit(&[check("corpus", "a\n::error::b\u{1b}[31m", "c\r\n::error::d", CheckStatus::Fail)], &[]).expect("XML");
    assert!(text.lines().all(|line| !line.trim_start().starts_with("::")), "{text}");
    assert!(text.contains("a\\n::error::b\\u{1b}[31m") && text.contains("c\\r\\n::error::d"), "{text}");
}

/// One of GitHub's commands, `::name key=value,key=value::message`, taken apart as the runner does.
fn command(line: &str) -> Option<(String, BTreeMap<String, String>, String)> {
    let (head, message) = line.strip_prefix("::")?.split_once("::")?;
    let (name, properties) = head.split_once(' ').unwrap_or((head, ""));
    let plain = |text: &str| {
        text.replace("%0D", "\r").replace("%0A", "\n").replace("%3A", ":").replace("%2C", ",").replace("%25", "%")
    };
    let message = message.replace("%0D", "\r").replace("%0A", "\n").replace("%25", "%");
    let pairs = properties.split(',').filter_map(|pair| pair.split_once('='));
    Some((name.to_owned(), pairs.map(|(key, value)| (key.to_owned(), plain(value))).collect(), message))
}

#[test]
fn annotations_come_apart_as_they_were_put_together() {
    let text = annotations(&checks());
    let lines: Vec<_> = text.lines().map(|line| command(line).expect(line)).collect();
    let failed: Vec<Check> = checks().into_iter().filter(|check| check.status == CheckStatus::Fail).collect();
    assert_eq!(lines.len(), failed.len());
    for ((name, properties, message), check) in lines.iter().zip(&failed) {
        assert_eq!(name, "error");
        assert_eq!(properties.keys().collect::<Vec<_>>(), ["file", "line", "title"]);
        assert_eq!((properties["file"].as_str(), properties["line"].as_str()), (check.place.0.as_str(), "3"));
        assert_eq!(properties["title"], format!("rockproof {}", check.group));
        let shown = check.message.replace('\u{1b}', "\\u{1b}").replace('\0', "\\0").replace('\u{7}', "\\u{7}");
        assert_eq!(*message, format!("{}: {shown}", check.name));
    }
    assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    assert_eq!(annotations(&[check("limit", "plain", "fine", CheckStatus::Pass)]), "");
}

/// The cells of the only table in a Markdown text, as a reader sees them.
fn cells(text: &str) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut cell: Option<String> = None;
    for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::TableHead | Tag::TableRow) => rows.push(Vec::new()),
            Event::Start(Tag::TableCell) => cell = Some(String::new()),
            Event::End(TagEnd::TableCell) => {
                let row: &mut Vec<String> = rows.last_mut().expect("a row");
                row.push(cell.take().expect("a cell"));
            }
            Event::Text(text) => {
                if let Some(cell) = &mut cell {
                    cell.push_str(&text);
                }
            }
            other => assert!(cell.is_none(), "a cell holds {other:?}"),
        }
    }
    rows
}

#[test]
fn the_summary_shows_what_was_found() {
    let text = markdown(&checks(), &[]);
    assert!(text.starts_with("## Rockproof gate: failed\n"), "{text}");
    let rows = cells(&text);
    assert_eq!(rows[0], ["verdict", "check", "found"]);
    assert_eq!(rows.len(), 6, "all but the corpus' pass: {rows:?}");
    assert_eq!(rows[1], ["FAIL", NASTY, "first line second line"]);
    assert_eq!(rows[3], ["FAIL", "b", NASTY]);
    assert_eq!(rows[4][..2], ["skip", "skipped | case"]);
    assert!(text.contains("2 passed, 1 skipped, 3 failed; 1 case of the corpus passed."), "{text}");
}

#[test]
fn what_is_wrong_with_an_engine_stands_with_the_first_failure_of_its_campaign() {
    let checks = [
        check("limit", "fixed: a", "fine", CheckStatus::Pass),
        check("limit", "rotating: b", "wrong", CheckStatus::Fail),
        check("limit", "fixed: c", "wrong", CheckStatus::Fail),
        check("baseline", "fixed: d", "wrong", CheckStatus::Fail),
    ];
    let of =
        |campaign: &str, sentence: &str| Diagnosed { campaign: campaign.to_owned(), sentence: sentence.to_owned() };
    let diagnosed = [of("fixed", NASTY), of("fixed", "and\n::error::more"), of("rotating", "another")];
    let text = junit(&checks, &diagnosed).expect("XML");
    assert!(text.lines().all(|line| !line.trim_start().starts_with("::")), "{text}");
    let xml = roxmltree::Document::parse(&text).expect("XML");
    valid(xml.root_element());
    let cases = xml.descendants().filter(|node| node.has_tag_name("testcase"));
    let said: Vec<_> = cases
        .map(|case| case.children().find(|node| node.has_tag_name("system-out")).and_then(|out| out.text()))
        .collect();
    let fixed = format!("fixed campaign: {NASTY}\nfixed campaign: and\\n::error::more");
    assert_eq!(said, [Some("fine"), Some("rotating campaign: another"), Some(&*fixed), None]);
    let summary = markdown(&checks, &diagnosed);
    let items = Parser::new(&summary).filter(|event| matches!(event, Event::Start(Tag::Item))).count();
    assert!(items == 3 && summary.contains("- rotating campaign: another\n"), "{summary}");
    assert_eq!(cells(&summary).len(), 5, "{summary}");
}

#[cfg(unix)]
#[test]
fn a_gate_tells_readers_of_its_files_what_is_wrong_with_an_engine() {
    let dir = crate::place::folder();
    let dir = dir.path();
    std::fs::create_dir(dir.join("cases")).expect("a folder");
    for name in ["f-v-arithmetic-vertex-face-depth.toml", "v-v-arithmetic-swap.toml"] {
        std::fs::copy(
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/regressions").join(name),
            dir.join("cases").join(name),
        )
        .expect("a case");
    }
    let limit = "[[limit]]\nengine = \"mine\"\ncount = 0\n";
    let settings =
        crate::gates::around(&[&crate::engines::client(), "sign"], limit).replace("pairs = 256", "pairs = 32");
    let settings = settings
        .replace("corpus = []", "corpus = [\"cases\"]")
        .replace("engines = []", "engines = [\"stepper-f32\", \"stepper-f64\"]");
    let ran = crate::gates::gate(dir, &settings, &[], true);
    let told = "are exact with the sign of every gap turned";
    assert!(ran.code == 1 && ran.out.contains("2 cases passed"), "{}{}", ran.out, ran.err);
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for text in [
        ran.out,
        std::fs::read_to_string(dir.join("junit.xml")).expect("JUnit"),
        std::fs::read_to_string(dir.join("summary.md")).expect("a summary"),
    ] {
        assert!(words(&text).contains(told), "{text}");
    }
}
