//! A chart as a picture of its own, for papers and for print: SVG on white ground, in the colours of the page's light theme, with fonts named by
//! their kind alone, and without scripts, styles or anything beside it. It is no larger than what A4 leaves between margins.
//!
//! Not by plotters, which places points on whole pixels, makes a line of its own of each dash, and measures texts only with fonts at hand.

mod content;
mod drawing;
mod frame;

use super::{Chart, ChartContent};
use content::{bars, curves, heat_map, key};
use drawing::{Drawing, coordinate, light_color, printable};
use frame::Frame;
use quick_xml::Writer;
use quick_xml::events::BytesText;
use std::io;

/// The width of most charts, in pixels of 1/96 inch: 180 mm.
const WIDTH: f64 = 680.0;
/// The greatest height on paper: 260 mm.
const MAX_HEIGHT: f64 = 980.0;
/// The size of texts (px), 8.25 points.
const FONT: f64 = 11.0;
/// From line to line of a text (px).
const LINE: f64 = 14.0;

/// The chart as the text of an SVG file.
///
/// # Errors
/// When the XML writer fails.
pub fn svg(chart: &Chart) -> io::Result<String> {
    let frame = Frame::of(chart);
    let scale = (WIDTH / frame.width).min(MAX_HEIGHT / frame.height).min(1.0);
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 1);
    writer
        .create_element("svg")
        .with_attributes([
            ("xmlns", "http://www.w3.org/2000/svg"),
            ("width", &*coordinate(frame.width * scale)),
            ("height", &*coordinate(frame.height * scale)),
            ("viewBox", &*format!("0 0 {} {}", coordinate(frame.width), coordinate(frame.height))),
            ("font-family", "sans-serif"),
            ("font-size", &*coordinate(FONT)),
            ("fill", light_color("text")),
            ("role", "img"),
        ])
        .write_inner_content(|writer| {
            writer.create_element("title").write_text_content(BytesText::new(&printable(&chart.caption)))?;
            let mut drawing = Drawing { writer };
            drawing.rectangle([0.0, 0.0, frame.width, frame.height], "#ffffff")?;
            frame.draw(&mut drawing, chart)?;
            match &chart.content {
                ChartContent::Curves(all, limit) => curves(&mut drawing, &frame, all, *limit),
                ChartContent::Bars(series) => bars(&mut drawing, &frame, series),
                ChartContent::Map(map) => heat_map(&mut drawing, &frame, map),
            }?;
            key(&mut drawing, &frame, &chart.content)
        })?;
    let mut text = String::from_utf8(writer.into_inner()).map_err(io::Error::other)?;
    text.push('\n');
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::super::values::csv;
    use super::super::{
        BarSeries, Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve, HeatMap, LineStyle, LogScale,
        PointLook,
    };
    use super::{MAX_HEIGHT, WIDTH, svg};

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    fn curve(name: &str, number: usize, points: Vec<ChartPoint>) -> Curve {
        let line = [Some(LineStyle::Solid), Some(LineStyle::DashedSteps), Some(LineStyle::Dotted), None][number % 4];
        Curve { name: name.to_owned(), color: ChartColor::Series(number), line, marker: Some(number), points }
    }

    /// One of each kind, with what is nasty.
    fn charts() -> Vec<Chart> {
        let nasty = "<b>&\u{7}=1 with a name that is long, and long";
        let interval = |x, y, low, high| ChartPoint { interval: Some([low, high]), ..ChartPoint::new(x, y) };
        let shares = (0..9).map(|n| curve(&format!("engine {n}"), n, vec![interval(50.0, 0.0, 40.0, 60.0)]));
        let by_name = Chart::new(
            "chart-shares",
            nasty,
            300,
            [ChartAxis::linear("shares, %", [0.0, 101.0]), ChartAxis::names("", names(&[nasty, "b"]))],
            ChartContent::Curves(shares.collect(), None),
        );
        let ringed = ChartPoint { look: PointLook::Ringed("f64, Δt 0.1 s".to_owned()), ..ChartPoint::new(1e-3, 0.0) };
        let open = ChartPoint { look: PointLook::Open, note: "a note".to_owned(), ..interval(1e7, 1e-3, 0.0, 1e-2) };
        let gap = ChartPoint::new(1.0, f64::NAN);
        let log = LogScale { decades: Some([-6.0, 0.0]), zero: Some(1e-5), ticks: vec![(1e-5, "0".to_owned())] };
        let by_number = Chart::new(
            "chart-errors",
            "errors",
            340,
            [ChartAxis::log("time, µs", LogScale::default()), ChartAxis::log("error", log)],
            ChartContent::Curves(vec![curve("one", 0, vec![ringed, gap, open.clone(), open])], Some(0.1)),
        );
        let counts = |counts: &[u64]| counts.to_vec();
        let bars = vec![
            BarSeries { name: "a".to_owned(), color: ChartColor::Series(0), counts: counts(&[3, 0]) },
            BarSeries { name: "b".to_owned(), color: ChartColor::Series(1), counts: counts(&[1, 5]) },
        ];
        let axes = [ChartAxis::names("which", names(&["x", "y"])), ChartAxis::from_zero("findings")];
        let stacked = Chart::new("chart-bars", "bars", 380, axes.clone(), ChartContent::Bars(bars.clone()));
        let [x, y] = axes;
        let lying = Chart::new("chart-lying", "bars", 380, [y, x], ChartContent::Bars(bars));
        let wide: Vec<String> = (0..40).map(|n| format!("campaign-{n}: stepper-f32")).collect();
        let map = HeatMap {
            percent: vec![vec![Some(50.0); 40], vec![None; 40]],
            colors_from_to: [0.0, 100.0],
            names_above: true,
        };
        let axes = [ChartAxis::names("", wide), ChartAxis::names("", names(&["family", "another"]))];
        let map = Chart::new("chart-map", "map", 200, axes, ChartContent::Map(map));
        let many: Vec<String> = (0..200).map(|n| format!("setting {n}")).collect();
        let bars = vec![BarSeries { name: "a".to_owned(), color: ChartColor::Muted, counts: vec![1; 200] }];
        let axes = [ChartAxis::from_zero("findings"), ChartAxis::names("", many)];
        let tall = Chart::new("chart-tall", "tall", 200, axes, ChartContent::Bars(bars));
        let empty = [ChartAxis::from_zero("x"), ChartAxis::log("y", LogScale::default())];
        let empty = Chart::new("chart-empty", "empty", 0, empty, ChartContent::Curves(Vec::new(), None));
        vec![by_name, by_number, stacked, lying, map, tall, empty]
    }

    /// The numbers of an attribute.
    fn numbers(text: &str) -> Vec<f64> {
        text.split([' ', ',']).map(|number| number.parse().expect("a number")).collect()
    }

    #[test]
    fn pictures_need_nothing_and_fit_on_paper() {
        for chart in charts() {
            let text = svg(&chart).expect("drawn");
            let document = roxmltree::Document::parse(&text).expect("XML");
            let root = document.root_element();
            let of = |name: &str| root.attribute(name).and_then(|n| n.parse::<f64>().ok()).expect("a length");
            assert!(of("width") <= WIDTH && of("height") <= MAX_HEIGHT && of("height") > 50.0, "{}", chart.id);
            assert_eq!(root.attribute("font-family"), Some("sans-serif"));
            let known = ["svg", "title", "rect", "polyline", "path", "text"];
            let size = numbers(root.attribute("viewBox").expect("a box"));
            let ground = document.descendants().find(|node| node.has_tag_name("rect")).expect("a ground");
            assert_eq!([ground.attribute("fill"), ground.attribute("x")], [Some("#ffffff"), Some("0")]);
            for node in document.descendants().filter(roxmltree::Node::is_element) {
                assert!(known.contains(&node.tag_name().name()), "{:?}", node.tag_name());
                assert!(node.attributes().all(|a| !a.name().contains("href") && !a.value().contains("url(")));
                let inside = |x: f64, y: f64| x >= 0.0 && y >= 0.0 && x <= size[2] + 0.1 && y <= size[3] + 0.1;
                for pair in node.attribute("points").map(numbers).unwrap_or_default().chunks(2) {
                    assert!(inside(pair[0], pair[1]), "{}: {pair:?} outside of {size:?}", chart.id);
                }
                if let (true, Some(words)) = (node.has_tag_name("text"), node.text()) {
                    let at = |name| numbers(node.attribute(name).expect("a place"))[0];
                    let width = super::super::text_size::width(words, 11.0);
                    let (x, turned) = (at("x"), node.attribute("transform").is_some());
                    let (left, right) = match node.attribute("text-anchor") {
                        Some("end") => (x - width, x),
                        Some("middle") => (x - width / 2.0, x + width / 2.0),
                        _ => (x, x + width),
                    };
                    assert!(turned || inside(left, at("y")) && inside(right, at("y")), "{}: {words}", chart.id);
                }
            }
        }
    }

    #[test]
    fn what_is_drawn_is_what_there_is() {
        let all = charts();
        let of = |id: &str| all.iter().find(|chart| chart.id == id).expect(id);
        let count = |id: &str, tag: &str| {
            let text = svg(of(id)).expect("drawn");
            let document = roxmltree::Document::parse(&text).expect("XML");
            document.descendants().filter(|node| node.has_tag_name(tag)).count()
        };
        // The ground, a mark in the legend for each series, and a bar for each count but 0.
        assert_eq!([count("chart-bars", "rect"), count("chart-lying", "rect")], [6, 6]);
        assert_eq!(count("chart-map", "rect"), 41);
        // Marks of points that have a place and in the legend.
        assert_eq!([count("chart-shares", "path"), count("chart-errors", "path")], [18, 4]);
        let errors = svg(of("chart-errors")).expect("drawn");
        assert!(errors.contains(">1 f64, Δt 0.1 s</text>"), "{errors}");
    }

    #[test]
    fn names_below_do_not_overlap() {
        for count in [2, 20, 80, 300] {
            let decades: Vec<String> = (0..count).map(|n| format!("1e-{n}")).collect();
            let bars = vec![BarSeries { name: "a".to_owned(), color: ChartColor::Muted, counts: vec![1; count] }];
            let axes = [ChartAxis::names("margin", decades), ChartAxis::from_zero("findings")];
            let text =
                svg(&Chart::new("chart-decades", "decades", 380, axes, ChartContent::Bars(bars))).expect("drawn");
            let document = roxmltree::Document::parse(&text).expect("XML");
            let words = document.descendants().filter(|node| node.has_tag_name("text"));
            let names = words.filter(|node| node.text().is_some_and(|text| text.starts_with("1e-")));
            let places: Vec<f64> = names.map(|node| numbers(node.attribute("x").expect("a place"))[0]).collect();
            let least = places.windows(2).map(|two| two[1] - two[0]).fold(f64::INFINITY, f64::min);
            assert!(places.len() >= count.min(20) && least > 14.0, "{count} names: {} {least} px apart", places.len());
        }
    }

    #[test]
    fn values_are_those_that_are_shown() {
        let values = |id: &str| {
            let all = charts();
            let chart = all.iter().find(|chart| chart.id == id).expect(id);
            String::from_utf8(csv(chart).expect("csv")).expect("text")
        };
        assert_eq!(
            values("chart-errors"),
            "series,x,y,low,high,note\none,0.001,0.0,,,\none,1.0,,,,\none,10000000.0,0.001,0.0,0.01,a note\none,10000000.0,0.001,0.0,0.01,a note\n"
        );
        assert_eq!(values("chart-bars"), "series,x,y\na,x,3\na,y,0\nb,x,1\nb,y,5\n");
        assert_eq!(values("chart-lying"), "series,x,y\na,3,x\na,0,y\nb,1,x\nb,5,y\n");
        assert!(values("chart-map").starts_with("x,y,percent\ncampaign-0: stepper-f32,family,50.0\n"));
        assert!(values("chart-map").ends_with("campaign-39: stepper-f32,another,\n"));
        assert!(values("chart-shares").starts_with("series,x,y,low,high\nengine 0,50.0,\"<b>&"));
    }
}
