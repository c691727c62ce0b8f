//! The few SVG elements the pictures are made of.
//!
//! Colours are fixed and the background is painted, so that a picture reads the same on a light and on a dark page.
//! Coordinates are written with one decimal: what is left of rounding cannot show, and the same text comes out
//! on every machine.

use std::fmt::Write;

/// Ink for lines and text.
pub(super) const INK: &str = "#23211f";
/// Ink for what stands back.
pub(super) const GREY: &str = "#6f6a64";
/// Block A.
pub(super) const BLOCK_A: [u8; 3] = [222, 170, 96];
/// Block B.
pub(super) const BLOCK_B: [u8; 3] = [121, 155, 186];
/// What a picture is about.
pub(super) const ACCENT: &str = "#c2185b";

const PAPER: &str = "#fbfaf7";

/// A point on the page, in pixels.
pub(super) type At = (f64, f64);

/// A picture under way.
pub(super) struct Svg {
    body: String,
    size: At,
}

impl Svg {
    /// An empty page with a title for readers that cannot see it.
    pub(super) fn new(width: f64, height: f64, title: &str) -> Svg {
        let mut svg = Svg { body: String::new(), size: (width, height) };
        svg.add(format_args!("<title>{}</title>", escaped(title)));
        svg.add(format_args!("<rect width=\"{width:.1}\" height=\"{height:.1}\" rx=\"8\" fill=\"{PAPER}\"/>"));
        svg
    }

    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.body, "{element}");
    }

    /// A closed polygon.
    pub(super) fn polygon(&mut self, points: &[At], fill: &str, stroke: &str) {
        let points = list(points);
        self.add(format_args!(
            "<polygon points=\"{points}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"1.2\" stroke-linejoin=\"round\"/>"
        ));
    }

    /// The outline of a polygon.
    pub(super) fn outline(&mut self, points: &[At], colour: &str, width: f64) {
        let points = list(points);
        self.add(format_args!(
            "<polygon points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width:.1}\" stroke-linejoin=\"round\"/>"
        ));
    }

    /// A closed polygon that lets what is behind it show.
    pub(super) fn glass(&mut self, points: &[At], colour: &str, opacity: f64) {
        let points = list(points);
        self.add(format_args!(
            "<polygon points=\"{points}\" fill=\"{colour}\" fill-opacity=\"{opacity:.2}\" stroke=\"{colour}\" stroke-width=\"1.2\" stroke-linejoin=\"round\"/>"
        ));
    }

    /// A rectangle without outline.
    pub(super) fn rectangle(&mut self, corner: At, size: At, fill: &str) {
        self.add(format_args!(
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{fill}\"/>",
            corner.0, corner.1, size.0, size.1
        ));
    }

    /// A straight line; dashed where `dashes` says how.
    pub(super) fn line(&mut self, from: At, to: At, colour: &str, width: f64, dashes: Option<&str>) {
        let dashes = dashes.map(|d| format!(" stroke-dasharray=\"{d}\"")).unwrap_or_default();
        self.add(format_args!(
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{colour}\" stroke-width=\"{width:.1}\" stroke-linecap=\"round\"{dashes}/>",
            from.0, from.1, to.0, to.1
        ));
    }

    /// A filled circle.
    pub(super) fn dot(&mut self, centre: At, radius: f64, colour: &str) {
        self.add(format_args!(
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" fill=\"{colour}\" stroke=\"{PAPER}\" stroke-width=\"1.5\"/>",
            centre.0, centre.1
        ));
    }

    /// The outline of a circle.
    pub(super) fn ring(&mut self, centre: At, radius: f64, colour: &str) {
        self.add(format_args!(
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\"/>",
            centre.0, centre.1
        ));
    }

    /// A line of text, from its left end.
    pub(super) fn text(&mut self, at: At, style: Text, text: &str) {
        let Text { size, bold, colour } = style;
        let weight = if bold { " font-weight=\"600\"" } else { "" };
        self.add(format_args!(
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{size}\"{weight} fill=\"{colour}\">{}</text>",
            at.0,
            at.1,
            escaped(text)
        ));
    }

    /// The finished file.
    pub(super) fn finish(self) -> String {
        let (width, height) = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" \
             font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\">\n{}</svg>\n",
            self.body
        )
    }
}

/// How text looks.
#[derive(Clone, Copy)]
pub(super) struct Text {
    /// Font size in pixels.
    pub(super) size: u32,
    /// Heavier than usual.
    pub(super) bold: bool,
    /// Colour.
    pub(super) colour: &'static str,
}

/// A heading.
pub(super) const HEADING: Text = Text { size: 16, bold: true, colour: INK };
/// Ordinary text.
pub(super) const PLAIN: Text = Text { size: 13, bold: false, colour: INK };
/// Remarks.
pub(super) const SMALL: Text = Text { size: 12, bold: false, colour: GREY };

/// A colour made darker: `light` from 0 (black) to 1 (the colour itself).
pub(super) fn shaded(colour: [u8; 3], light: f64) -> String {
    let [r, g, b] = colour.map(|c| (f64::from(c) * light.clamp(0.0, 1.0)).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn list(points: &[At]) -> String {
    points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
