//! The page of a report in a real browser: no error, no request, every chart and view drawn, nothing wider than the screen. Runs where
//! Chromium is installed; with ROCKPROOF_REQUIRE_CHROMIUM=1, as in `.ci/run`, its absence is a failure.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Put at the end of the page: takes down what goes wrong, and tells the frame around it when all is drawn.
const PROBE: &str = r#"<script>
(() => {
  const errors = window.probed;
  const looked = () => ({
    width: innerWidth,
    scroll: document.documentElement.scrollWidth,
    errors,
    requests: performance.getEntriesByType("resource").map(e => e.name).filter(name => !/^(data|blob):/.test(name)),
    charts: [...document.querySelectorAll(".chart")].map(f => [f.id, f.dataset.drawn || "no", f.querySelectorAll(".main-svg .point, .main-svg .heatmaplayer image").length, f.querySelector(".still").naturalWidth]),
    saved: [...document.querySelectorAll(".save a")].map(a => [a.download, a.href.slice(0, 26)]),
    views: [...document.querySelectorAll(".finding[open]")].map(f => [f.id, f.dataset.drawn || "no", f.querySelector(".still").src.length]),
    closed: document.querySelectorAll(".finding:not([open])").length,
    theme: document.documentElement.dataset.theme,
    sections: [...document.querySelectorAll("section")].map(s => s.id),
    verdict: document.querySelectorAll(".verdict li").length,
  });
  const wait = () => {
    const done = document.documentElement.dataset.drawn === "all" || errors.length > 0;
    if (done) parent.postMessage(JSON.stringify(looked()), "*"); else setTimeout(wait, 100);
  };
  wait();
})();
</script></body>"#;

/// Put at the start of the page, before any script of it.
const WATCH: &str = r#"<head><script>
window.probed = [];
addEventListener("error", e => probed.push("error: " + e.message));
addEventListener("unhandledrejection", e => probed.push("rejected: " + e.reason));
addEventListener("securitypolicyviolation", e => probed.push("policy: " + e.violatedDirective + " " + e.blockedURI));
for (const level of ["error", "warn"]) { const old = console[level]; console[level] = (...a) => { probed.push(level + ": " + a.join(" ")); old(...a); }; }
</script>"#;

fn chromium() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&path).flat_map(|dir| names.map(|name| dir.join(name))).find(|file| file.is_file())
}

/// What the page looks like in a window of the given width.
fn inspect_page(browser: &Path, dir: &Path, page: &str, width: u32, theme: &str) -> Value {
    let probed = page.replacen("<head>", WATCH, 1);
    let (start, end) = probed.rsplit_once("</body>").expect("a body");
    let file = dir.join("probed.html");
    fs::write(&file, format!("{start}{PROBE}{end}")).expect("written");
    // Browser windows cannot be as narrow as a phone; a frame can.
    let outer = format!(
        r#"<!doctype html><meta name="color-scheme" content="{theme}"><body style="margin:0"><iframe src="probed.html#all" style="border:0;width:{width}px;height:1200px"></iframe>
<script>addEventListener("message", e => {{ const told = document.createElement("pre"); told.id = "told"; told.textContent = e.data; document.body.append(told); }});</script>"#
    );
    let frame = dir.join("frame.html");
    fs::write(&frame, outer).expect("written");
    let mut command = Command::new(browser);
    command
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
        ])
        // Software rendering: machines of a CI have no graphics card.
        .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        .args(["--virtual-time-budget=20000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", dir.join("profile").display()))
        .arg(format!("--window-size={},1300", width.max(500)))
        .arg(format!("file://{}", frame.display()))
        .stderr(Stdio::null());
    let output =
        assert_cmd::Command::from_std(command).timeout(Duration::from_secs(300)).output().expect("chromium runs");
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let told = dom.split_once("<pre id=\"told\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let (told, _) = told.unwrap_or_else(|| panic!("the page was not drawn at {width} px: {} bytes of DOM", dom.len()));
    let text = told.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    serde_json::from_str(&text).expect("what the probe tells")
}

fn rockproof(args: &[&str]) {
    let output = assert_cmd::Command::cargo_bin("rockproof").expect("built").args(args).output().expect("runs");
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_page_works_in_a_browser() {
    let Some(browser) = chromium() else {
        assert!(
            std::env::var_os("ROCKPROOF_REQUIRE_CHROMIUM").is_none(),
            "there is no chromium in PATH; install it (apt-get install chromium)"
        );
        eprintln!("not tested: there is no chromium in PATH");
        return;
    };
    let dir = tempfile::tempdir().expect("a directory");
    let run = dir.path().join("run");
    let run = run.to_str().expect("text");
    rockproof(&["campaign", "--pairs", "192", "--seed", "3", "--tolerances", "auto,shi", "--out", run]);
    rockproof(&["report", run]);
    let page = fs::read_to_string(Path::new(run).join("report/report.html")).expect("a page");
    assert!(page.len() < 8 << 20, "the page has {} bytes", page.len());
    for width in [360, 1600] {
        let seen = inspect_page(&browser, dir.path(), &page, width, "light");
        let list = |name: &str| seen[name].as_array().unwrap_or_else(|| panic!("{name}: {seen}")).clone();
        assert_eq!(list("errors"), [] as [Value; 0], "{width} px");
        assert_eq!(list("requests"), [] as [Value; 0], "{width} px");
        assert_eq!(seen["width"], width);
        assert!(seen["scroll"].as_u64() <= Some(u64::from(width)), "wider than {width} px: {}", seen["scroll"]);
        assert_eq!(seen["verdict"], 3);
        assert!(list("charts").len() >= 6);
        for chart in list("charts") {
            assert!(chart[1] == "yes" && chart[2].as_u64() > Some(0), "{width} px: not drawn: {chart}");
            assert!(chart[3].as_u64() > Some(200), "{width} px: the browser cannot draw the picture of {chart}");
        }
        assert_eq!(list("saved").len(), 2 * list("charts").len());
        for link in list("saved") {
            let kind =
                if link[0].as_str().is_some_and(|name| name.ends_with(".svg")) { "image/svg+xml" } else { "text/csv" };
            let whole = format!("data:{kind};base64,");
            assert!(whole.starts_with(&link[1].as_str().unwrap_or("none")[..whole.len().min(26)]), "{link}");
        }
        assert!(!list("views").is_empty());
        for view in list("views") {
            // An empty scene makes a picture of some 3 kB.
            assert!(view[1] == "yes" && view[2].as_u64() > Some(10_000), "{width} px: not drawn: {view}");
        }
        for section in ["verdict", "agreement", "kinds", "causes", "margins", "worst", "runs", "words"] {
            assert!(list("sections").contains(&section.into()), "no section {section}");
        }
    }
}
