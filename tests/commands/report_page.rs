//! The pages of reports, comparisons and examinations in a real browser: no error, no request, every chart and view drawn, nothing wider than the screen or
//! the paper. With ROCKPROOF_REQUIRE_CHROMIUM=1, as in `.ci/run`, it is a failure that Chromium is not installed.

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
    squeezed: [...document.querySelectorAll("dd")].filter(d => d.offsetParent && d.clientWidth < 120).map(d => d.textContent),
    cut: [...document.querySelectorAll("table, .still")].filter(t => t.getClientRects().length > 0).filter(t => {
      const around = t.closest(".matrix, .finding, section").getBoundingClientRect();
      return t.getBoundingClientRect().right > Math.min(around.right, innerWidth) + 1;
    }).map(t => (t.alt || t.textContent).slice(0, 80)),
  });
  const wait = () => {
    const done = location.hash.slice(1) === "print" || document.documentElement.dataset.drawn === "all" || errors.length > 0;
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

/// The width between the margins of a sheet of A4, in CSS pixels.
const PAPER: u32 = 688;

/// What the page looks like on paper: its styles for print, between the margins.
fn inspect_print(browser: &Path, dir: &Path, page: &str) -> Value {
    for media in ["@media print {", "@media screen {"] {
        assert!(page.contains(media), "no {media}");
    }
    let printed = page.replace("@media print {", "@media all {").replace("@media screen {", "@media not all {");
    inspect(browser, dir, &printed, PAPER, "light", "print")
}

/// What the page looks like in a window of the given width.
fn inspect_page(browser: &Path, dir: &Path, page: &str, width: u32, theme: &str) -> Value {
    inspect(browser, dir, page, width, theme, "all")
}

fn inspect(browser: &Path, dir: &Path, page: &str, width: u32, theme: &str, hash: &str) -> Value {
    let probed = page.replacen("<head>", WATCH, 1);
    let (start, end) = probed.rsplit_once("</body>").expect("a body");
    let file = dir.join("probed.html");
    fs::write(&file, format!("{start}{PROBE}{end}")).expect("written");
    // Browser windows cannot be as narrow as a phone; a frame can.
    let outer = format!(
        r#"<!doctype html><meta name="color-scheme" content="{theme}"><body style="margin:0"><iframe src="probed.html#{hash}" style="border:0;width:{width}px;height:1200px"></iframe>
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

/// Something that has a page: its directory and file, lines of its verdict, least number of charts, and sections.
struct Paged<'p> {
    page: &'p str,
    verdict: u64,
    charts: usize,
    /// Whether it has views to turn.
    has_views: bool,
    sections: &'p [&'p str],
}

impl Paged<'_> {
    fn read(&self, dir: &Path) -> String {
        let page = fs::read_to_string(dir.join(self.page)).expect("a page");
        assert!(page.len() < 8 << 20, "the page has {} bytes", page.len());
        page
    }

    /// Everything is there and works in a window of this width.
    fn check(&self, browser: &Path, dir: &Path, width: u32, theme: &str) {
        let seen = inspect_page(browser, dir, &self.read(dir), width, theme);
        let place = format!("{} at {width} px, {theme}", self.page);
        let list = |name: &str| seen[name].as_array().unwrap_or_else(|| panic!("{place}: {name}: {seen}")).clone();
        for name in ["errors", "requests", "squeezed"] {
            assert_eq!(list(name), [] as [Value; 0], "{place}: {name}");
        }
        assert_eq!(seen["width"], width);
        assert!(seen["scroll"].as_u64() <= Some(u64::from(width)), "{place}: wider: {}", seen["scroll"]);
        assert_eq!(seen["theme"], theme, "{place}");
        assert_eq!(seen["verdict"], self.verdict, "{place}");
        assert!(list("charts").len() >= self.charts, "{place}");
        for chart in list("charts") {
            assert!(chart[1] == "yes" && chart[2].as_u64() > Some(0), "{place}: not drawn: {chart}");
            assert!(chart[3].as_u64() > Some(200), "{place}: the browser cannot draw the picture of {chart}");
        }
        assert_eq!(list("saved").len(), 2 * list("charts").len());
        for link in list("saved") {
            let kind =
                if link[0].as_str().is_some_and(|name| name.ends_with(".svg")) { "image/svg+xml" } else { "text/csv" };
            let whole = format!("data:{kind};base64,");
            assert!(whole.starts_with(&link[1].as_str().unwrap_or("none")[..whole.len().min(26)]), "{link}");
        }
        assert_eq!(!list("views").is_empty(), self.has_views, "{place}");
        for view in list("views") {
            // An empty scene makes a picture of some 3 kB.
            assert!(view[1] == "yes" && view[2].as_u64() > Some(10_000), "{place}: not drawn: {view}");
        }
        for section in self.sections {
            assert!(list("sections").contains(&(*section).into()), "{place}: no section {section}");
        }
    }

    /// Nothing is cut on paper.
    fn check_print(&self, browser: &Path, dir: &Path) {
        let seen = inspect_print(browser, dir, &self.read(dir));
        assert_eq!(seen["cut"], Value::Array(Vec::new()), "{} is cut on paper", self.page);
        assert!(
            seen["scroll"].as_u64() <= Some(u64::from(PAPER)),
            "{} is wider than paper: {}",
            self.page,
            seen["scroll"]
        );
    }
}

#[test]
#[ignore = "a minute; .ci/run runs it"]
fn the_page_works_in_a_browser() {
    let Some(browser) = chromium() else {
        assert!(
            std::env::var_os("ROCKPROOF_REQUIRE_CHROMIUM").is_none(),
            "there is no chromium in PATH; install it (apt-get install chromium)"
        );
        eprintln!("not tested: there is no chromium in PATH");
        return;
    };
    let dir = crate::place::folder();
    let dir = dir.path();
    let at = |name: &str| dir.join(name).display().to_string();
    rockproof(&["campaign", "--pairs", "192", "--seed", "3", "--tolerances", "auto,shi", "--out", &at("run")]);
    rockproof(&["report", &at("run")]);
    let sections = ["verdict", "agreement", "kinds", "causes", "margins", "worst", "runs", "words"];
    let page = "run/report/report.html";
    let report = Paged { page, verdict: 4, charts: 6, has_views: true, sections: &sections };
    for (width, theme) in [(360, "light"), (1600, "light"), (1600, "dark")] {
        report.check(&browser, dir, width, theme);
    }
    report.check_print(&browser, dir);

    // A third engine makes tables wider.
    let mine = format!("mine={} sign", crate::engines::client());
    let all = "stepper-f32,stepper-f64,mine";
    let own =
        ["campaign", "--pairs", "128", "--tolerances", "auto", "--engine-command", &mine, "--engine", all, "--out"];
    rockproof(&[&own[..], &[&at("own")]].concat());
    rockproof(&["report", &at("own")]);
    let own = Paged { page: "own/report/report.html", verdict: 5, charts: 6, has_views: true, sections: &sections };
    own.check(&browser, dir, 360, "dark");
    own.check_print(&browser, dir);

    rockproof(&["compare", &at("run"), &at("own"), "--out", &at("compared")]);
    let sections = ["verdict", "changed", "shares", "settings"];
    let page = "compared/report.html";
    let compared = Paged { page, verdict: 3, charts: 0, has_views: false, sections: &sections };
    compared.check(&browser, dir, 360, "dark");
    compared.check_print(&browser, dir);

    // Two cubes a kilometre from the origin, so that there is something to show.
    let model = "[[block]]\nfixed = true\nbox = { min = [999, -1, -1], max = [1003, 3, 0] }\n\
                 [[block]]\nbox = { min = [1000, 0, 0], max = [1001, 1, 1] }\n\
                 [[block]]\nbox = { min = [\"100100001/100000\", 0, 0], max = [1002, 1, 1] }\n";
    fs::write(dir.join("far.toml"), model).expect("written");
    rockproof(&["examine", &at("far.toml"), "--no-tune", "--out", &at("examined")]);
    let sections = ["verdict", "model", "pairs", "tolerances"];
    let page = "examined/index.html";
    let examined = Paged { page, verdict: 10, charts: 0, has_views: true, sections: &sections };
    examined.check(&browser, dir, 360, "light");
    examined.check(&browser, dir, 1600, "dark");
    examined.check_print(&browser, dir);
}
