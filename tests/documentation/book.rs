//! The pages in docs/ are a book: the table of contents has each of them once, every link leads to a file and a heading that is
//! there, and pages link only to pages and pictures of the book, so that `mdbook build` shows what the repository shows.
//!
//! mdBook itself is run by `.ci/run`, where it can be had.

use pulldown_cmark::{CodeBlockKind, Event, HeadingLevel, Options, Parser, Tag, TagEnd};
use rockproof_campaign::config::CampaignConfig;
use rockproof_gate::config::GateConfig;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What a page has.
#[derive(Default)]
struct Page {
    title: String,
    headings: BTreeSet<String>,
    links: Vec<String>,
}

/// The name under which mdBook, like GitHub, finds a heading: letters and digits, `-` for spaces.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    kept.chars().filter(|c| c.is_alphanumeric() || "-_ ".contains(*c)).map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn page(text: &str) -> Page {
    let mut page = Page::default();
    let mut heading: Option<(HeadingLevel, String)> = None;
    for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Heading { level, .. }) => heading = Some((level, String::new())),
            Event::End(TagEnd::Heading(_)) => {
                if let Some((level, text)) = heading.take() {
                    page.headings.insert(anchor(&text));
                    if level == HeadingLevel::H1 && page.title.is_empty() {
                        page.title = text;
                    }
                }
            }
            Event::Text(text) | Event::Code(text) => {
                if let Some((_, heading)) = &mut heading {
                    heading.push_str(&text);
                }
            }
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                page.links.push(dest_url.into_string());
            }
            _ => {}
        }
    }
    page
}

/// Markdown files in a folder by their names.
fn pages(folder: &Path) -> BTreeMap<PathBuf, Page> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path());
    let files = entries.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    files.map(|path| (path.clone(), page(&fs::read_to_string(&path).expect("text")))).collect()
}

/// What is wrong with the links of a page; those of the book stay in its folder.
fn broken(path: &Path, page: &Page, all: &BTreeMap<PathBuf, Page>, book: Option<&Path>) -> Vec<String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let wrong = |link: &String| {
        if link.starts_with("https://") || link.starts_with("http://") {
            return None;
        }
        let (file, heading) = link.split_once('#').map_or((link.as_str(), None), |(file, name)| (file, Some(name)));
        let target = if file.is_empty() { path.to_owned() } else { folder.join(file) };
        let told = |what: &str| Some(format!("{}: {link}: {what}", path.display()));
        if !target.exists() {
            return told("there is no such file");
        }
        let inside = |book: &Path| {
            let (target, book) =
                (target.canonicalize().expect("it is there"), book.canonicalize().expect("it is there"));
            target.starts_with(book)
        };
        if book.is_some_and(|book| !inside(book)) {
            return told("this is not in the book");
        }
        match (heading, all.get(&target)) {
            (Some(heading), Some(page)) if !page.headings.contains(heading) => told("there is no such heading"),
            (Some(_), None) => told("headings are checked in the book's pages only"),
            _ => None,
        }
    };
    page.links.iter().filter_map(wrong).collect()
}

#[test]
fn the_table_of_contents_has_every_page_once() {
    let docs = root().join("docs");
    let mut all = pages(&docs);
    let contents = all.remove(&docs.join("SUMMARY.md")).expect("docs/SUMMARY.md");
    let named: Vec<PathBuf> = contents.links.iter().map(|link| docs.join(link)).collect();
    let once: BTreeSet<&PathBuf> = named.iter().collect();
    assert_eq!(once.len(), named.len(), "a page is there twice");
    let missing: Vec<_> = all.keys().filter(|path| !once.contains(path)).collect();
    assert!(missing.is_empty(), "docs/SUMMARY.md does not name {missing:?}");
    let gone: Vec<_> = once.iter().filter(|path| !all.contains_key(**path)).collect();
    assert!(gone.is_empty(), "docs/SUMMARY.md names {gone:?}, which are not there");
    for (path, page) in &all {
        assert!(!page.title.is_empty(), "{} has no title", path.display());
    }
    let settings = fs::read_to_string(root().join("book.toml")).expect("book.toml");
    let settings: toml::Table = toml::from_str(&settings).expect("TOML");
    assert_eq!(settings["book"]["src"].as_str(), Some("docs"));
}

#[test]
fn links_lead_somewhere() {
    let docs = root().join("docs");
    let book = pages(&docs);
    let outside = pages(root());
    let mut all = pages(&docs);
    all.extend(pages(root()));
    let mut wrong: Vec<String> = book.iter().flat_map(|(path, page)| broken(path, page, &all, Some(&docs))).collect();
    wrong.extend(outside.iter().flat_map(|(path, page)| broken(path, page, &all, None)));
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(all.values().map(|page| page.links.len()).sum::<usize>() > 60);
}

/// The code blocks of a page in a language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join(page)).expect(page);
    let mut found: Vec<String> = Vec::new();
    let mut inside = false;
    for event in Parser::new_ext(&text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))) if *info == *language => {
                inside = true;
                found.push(String::new());
            }
            Event::End(TagEnd::CodeBlock) => inside = false,
            Event::Text(text) if inside => found.last_mut().expect("a block").push_str(&text),
            _ => {}
        }
    }
    found
}

#[test]
fn settings_on_the_pages_are_read() {
    for path in pages(&root().join("docs")).into_keys() {
        let page = format!("docs/{}", path.file_name().expect("a name").display());
        for block in blocks(&page, "toml") {
            let read: Result<toml::Table, _> = toml::from_str(&block);
            assert!(read.is_ok(), "{page}: {}", read.unwrap_err());
        }
        for block in blocks(&page, "yaml") {
            assert!(yaml_rust2::YamlLoader::load_from_str(&block).is_ok(), "{page}: {block}");
        }
    }
    let gates = blocks("docs/gate.md", "toml");
    assert!(!gates.is_empty() && gates.iter().all(|gate| GateConfig::from_toml(gate, "docs/gate.md").is_ok()));
    let settings = blocks("docs/formats.md", "toml").into_iter().filter(|block| block.starts_with("pairs"));
    let settings: Vec<CampaignConfig> = settings.map(|text| CampaignConfig::from_toml(&text).expect("good")).collect();
    let [settings] = &settings[..] else { panic!("one block of settings") };
    // What the page calls defaults is.
    let defaults = CampaignConfig::default();
    let listed = CampaignConfig {
        tolerances: Vec::new(),
        families: Vec::new(),
        real: Vec::new(),
        planarity: None,
        weld: None,
        scale: None,
        external: Vec::new(),
        ..settings.clone()
    };
    assert_eq!(listed, defaults);
    // The job on GitLab asks the gate for what there is.
    let jobs = blocks("docs/gitlab.md", "yaml");
    let help = std::process::Command::new(env!("CARGO_BIN_EXE_rockproof")).args(["gate", "--help"]).output();
    let help = String::from_utf8(help.expect("runs").stdout).expect("text");
    for flag in ["--junit", "--rotating-seed", "--update-baseline"] {
        assert!(jobs.iter().any(|job| job.contains(flag)) && help.contains(flag), "{flag}");
    }
    let job = &yaml_rust2::YamlLoader::load_from_str(&jobs[0]).expect("YAML")[0]["contacts"];
    assert_eq!(job["artifacts"]["reports"]["junit"].as_str(), Some("junit.xml"));
    assert!(job["script"].as_vec().is_some_and(|lines| lines.iter().all(|line| line.as_str().is_some())));
}

/// A tag of somebody else's action may be moved to other code, a commit not.
#[test]
fn workflows_name_the_actions_of_others_by_commit() {
    let mut found = 0;
    for path in pages(&root().join("docs")).into_keys() {
        let page = format!("docs/{}", path.file_name().expect("a name").display());
        for block in blocks(&page, "yaml") {
            for used in block.lines().filter_map(|line| line.trim_start_matches([' ', '-']).strip_prefix("uses:")) {
                let name = used.split('#').next().unwrap_or_default().trim();
                let commit = name.split_once('@').map_or("", |(_, commit)| commit);
                let is_pinned = commit.len() == 40 && commit.chars().all(|c| c.is_ascii_hexdigit());
                assert!(is_pinned || name.starts_with("./"), "{page}: {name}");
                found += 1;
            }
        }
    }
    assert!(found >= 5, "workflows on the pages use {found} actions");
}

#[test]
fn broken_links_are_seen() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.md");
    let text = "# A `b`, c!\n[1](#a-b-c) [2](#a-b) [3](none.md) [4](https://example.org) [5](b.md#d) [6](../out.md)\n";
    fs::write(&path, text).expect("written");
    fs::write(folder.path().join("b.md"), "text\n\n## D\n").expect("written");
    let all = pages(folder.path());
    let wrong = broken(&path, &all[&path], &all, Some(folder.path()));
    assert_eq!(wrong.len(), 3, "{wrong:?}");
    assert_eq!(all[&path].title, "A b, c!");
    // A file outside the book is a broken link of the book only.
    let inner = folder.path().join("book");
    fs::create_dir(&inner).expect("made");
    fs::write(inner.join("c.md"), "[out](../a.md)\n").expect("written");
    let all = pages(&inner);
    let [only] = &all.keys().collect::<Vec<_>>()[..] else { panic!("one page") };
    assert_eq!(broken(only, &all[*only], &all, Some(&inner)).len(), 1);
    assert_eq!(broken(only, &all[*only], &all, None).len(), 0);
}
