"use strict";
(() => {
  const root = document.documentElement;
  const libraries = {};

  // Theme: the system's, or the reader's choice, kept where the browser allows. Set before anything is drawn.
  const button = document.getElementById("theme");
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const store = {
    get() { try { return localStorage.getItem("rockproof-theme"); } catch { return null; } },
    set(value) { try { localStorage.setItem("rockproof-theme", value); } catch { /* not kept */ } },
  };
  let choice = store.get() || "system";
  function theme() {
    root.dataset.theme = choice === "system" ? (dark.matches ? "dark" : "light") : choice;
    button.textContent = "Theme: " + choice;
  }
  theme();

  // The libraries stand in the page as text and are run when first needed: a phone need not read 3 MB before the verdict shows.
  function library(name) {
    if (!(name in libraries)) {
      const text = document.getElementById("library-" + name);
      const script = document.createElement("script");
      script.textContent = text.textContent;
      document.body.append(script);
      libraries[name] = window.Plotly;
      text.remove();
    }
    return libraries[name];
  }

  // Colours: names like $series0 stand for the theme's.
  const colorsOf = element => name => getComputedStyle(element).getPropertyValue("--" + name).trim();
  const color = colorsOf(root);
  const onPaper = colorsOf(document.getElementById("paper"));
  function painted(value, color) {
    if (value === "$scale") return [[0, color("scale0")], [.5, color("scale1")], [1, color("scale2")]];
    if (typeof value === "string" && value[0] === "$") return color(value.slice(1));
    if (Array.isArray(value)) return typeof value[0] === "object" ? value.map(part => painted(part, color)) : value;
    if (value && typeof value === "object") return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, painted(v, color)]));
    return value;
  }

  const config = { responsive: true, displaylogo: false, displayModeBar: false };

  function layoutOf(layout, narrow) {
    const axis = given => ({
      automargin: true, gridcolor: color("line"), zerolinecolor: color("line"), linecolor: color("line"), fixedrange: true, ...given,
    });
    const full = {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 10, r: 12, t: 10, b: 10 },
      font: { color: color("text"), size: narrow ? 11 : 12, family: "system-ui, sans-serif" },
      hoverlabel: { bgcolor: color("card"), font: { color: color("text") } }, ...layout,
    };
    for (const key of ["xaxis", "yaxis"]) full[key] = axis(full[key]);
    delete full.wide;
    return full;
  }

  async function drawChart(figure) {
    const plot = figure.querySelector(".plot");
    const { data, layout } = JSON.parse(figure.querySelector("script").textContent);
    if (layout.wide) plot.style.minWidth = layout.wide + "px";
    const narrow = plot.clientWidth < 500;
    await library("cartesian").react(plot, painted(data, color), painted(layoutOf(layout, narrow), color), config);
    figure.dataset.drawn = "yes";
  }

  // Browsers keep some 8 to 16 views at a time; the ones opened longest ago give way.
  const views = [];
  const most = 6;

  // What a view shows: both blocks, or the surroundings of the smaller one where the other is much larger. True proportions, and never flat.
  function stage(traces) {
    const boxes = traces.filter(t => t.type === "mesh3d").map(t => ["x", "y", "z"].map(k => t[k].reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity])));
    const size = box => Math.max(...box.map(([low, high]) => high - low));
    boxes.sort((a, b) => size(a) - size(b));
    const small = boxes[0];
    const near = size(boxes[boxes.length - 1]) > 8 * size(small);
    const shown = [0, 1, 2].map(k => {
      const of = near ? [small] : boxes;
      return [Math.min(...of.map(b => b[k][0])), Math.max(...of.map(b => b[k][1]))];
    });
    const longest = size(shown) || 1;
    const half = shown.map(([low, high]) => near ? 1.5 * longest : Math.max(0.54 * (high - low), 0.2 * longest));
    const most = Math.max(...half);
    return {
      range: shown.map(([low, high], k) => [(low + high) / 2 - half[k], (low + high) / 2 + half[k]]),
      ratio: { x: half[0] / most, y: half[1] / most, z: half[2] / most },
    };
  }

  async function drawView(finding) {
    const plot = finding.querySelector(".plot");
    const traces = JSON.parse(finding.querySelector("script").textContent);
    const { range, ratio } = stage(traces);
    const camera = plot.layout?.scene?.camera;
    const layout = color => {
      const axis = (title, k) => ({ title: { text: title }, range: range[k], gridcolor: color("line"), color: color("muted"), showbackground: false, exponentformat: "power" });
      return {
        paper_bgcolor: "rgba(0,0,0,0)", margin: { l: 0, r: 0, t: 0, b: 0 }, font: { color: color("text"), size: 11 },
        scene: { aspectmode: "manual", aspectratio: ratio, xaxis: axis("x, m", 0), yaxis: axis("y, m", 1), zaxis: axis("z, m", 2), ...(camera ? { camera } : {}) },
        legend: { orientation: "h", y: 0, yanchor: "top" }, hoverlabel: { bgcolor: color("card"), font: { color: color("text") } },
      };
    };
    const plotly = library("gl3d");
    await plotly.react(plot, painted(traces, color), layout(color), config);
    const at = views.indexOf(finding);
    if (at >= 0) views.splice(at, 1);
    views.push(finding);
    while (views.length > most) {
      const old = views.shift();
      old.open = false;
      plotly.purge(old.querySelector(".plot"));
      delete old.dataset.drawn;
    }
    // Paper cannot be turned, and is white: it gets a picture in the colours of the light theme.
    const still = finding.querySelector(".still");
    still.src = await plotly.toImage({ data: painted(traces, onPaper), layout: layout(onPaper) }, { format: "png", width: 900, height: 560 });
    finding.dataset.drawn = "yes";
  }

  const draw = element => (element.matches(".chart") ? drawChart(element) : drawView(element)).catch(error => {
    element.querySelector(".plot").textContent = "This view cannot be drawn here: " + error.message;
    element.dataset.drawn = "failed";
  });

  // The picture that is printed is the one to save, also where the page has been moved away from its files.
  for (const link of document.querySelectorAll(".save .picture")) link.href = link.closest(".chart").querySelector(".still").src;

  // Draw what comes into sight.
  const pending = new Map();
  const once = element => {
    if (!pending.has(element)) pending.set(element, draw(element));
    return pending.get(element);
  };
  const seen = new IntersectionObserver(entries => {
    for (const entry of entries) if (entry.isIntersecting) { seen.unobserve(entry.target); once(entry.target); }
  }, { rootMargin: "400px" });
  for (const chart of document.querySelectorAll(".chart")) seen.observe(chart);
  for (const finding of document.querySelectorAll(".finding")) {
    if (finding.open) seen.observe(finding);
    finding.addEventListener("toggle", () => {
      if (finding.open && finding.dataset.drawn !== "yes") { pending.delete(finding); once(finding); }
    });
  }
  const drawAll = () => Promise.all([...document.querySelectorAll(".chart, .finding[open]")].map(once));
  // For printing, and for whoever wants everything at once: report.html#all
  addEventListener("beforeprint", () => {
    for (const table of document.querySelectorAll("details.table")) table.open = true;
    drawAll();
  });
  if (location.hash === "#all") drawAll().then(() => { root.dataset.drawn = "all"; });

  function repaint() {
    theme();
    for (const element of document.querySelectorAll("[data-drawn=yes]")) draw(element);
  }
  button.addEventListener("click", () => {
    choice = { system: "dark", dark: "light", light: "system" }[choice] || "system";
    store.set(choice);
    repaint();
  });
  dark.addEventListener("change", repaint);

  for (const copy of document.querySelectorAll(".copy")) {
    copy.addEventListener("click", async () => {
      try { await navigator.clipboard.writeText(copy.previousElementSibling.textContent); copy.textContent = "Copied"; } catch { copy.textContent = "Select it and copy"; }
    });
  }
})();
