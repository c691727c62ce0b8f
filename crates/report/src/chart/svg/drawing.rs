//! What pictures are made of.

use super::FONT;
use quick_xml::Writer;
use quick_xml::events::BytesText;
use std::io;

/// The styles of the page, whose colours pictures have too.
const STYLE: &str = include_str!("../../page/style.css");

/// A colour of the page's light theme: the first of that name in its style sheet.
pub(super) fn light_color(name: &str) -> &'static str {
    let found = STYLE.split_once(&format!("--{name}: ")).and_then(|(_, rest)| rest.split_once(';'));
    found.map_or("#000000", |(color, _)| color)
}

/// A colour between three of a scale, at a share from 0 to 1, as `#rrggbb`.
pub(super) fn between(share: f64) -> String {
    let channels = |name: &str| {
        let color = light_color(name);
        [1, 3, 5].map(|at| color.get(at..at + 2).and_then(|two| u8::from_str_radix(two, 16).ok()).unwrap_or(0))
    };
    let share = share.clamp(0.0, 1.0) * 2.0;
    let (from, to, part) = if share < 1.0 { ("scale0", "scale1", share) } else { ("scale1", "scale2", share - 1.0) };
    let (from, to) = (channels(from), channels(to));
    let mixed: [u8; 3] =
        std::array::from_fn(|k| (f64::from(from[k]) + part * (f64::from(to[k]) - f64::from(from[k]))).round() as u8);
    format!("#{:02x}{:02x}{:02x}", mixed[0], mixed[1], mixed[2])
}

/// A length to a tenth of a pixel.
pub(super) fn coordinate(value: f64) -> String {
    let rounded = (value * 10.0).round() / 10.0;
    // There is no minus zero in a picture.
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// A text without characters that XML does not hold.
pub(super) fn printable(text: &str) -> String {
    let allowed = |c: char| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { '\u{fffd}' } else { c };
    text.chars().map(allowed).collect()
}

/// Where a text stands at its point.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    /// Begins there.
    Start,
    /// Has its middle there.
    Middle,
    /// Ends there.
    End,
}

/// A text in a chart.
pub(super) struct Label<'t> {
    pub(super) text: &'t str,
    /// The middle of its height at its anchor.
    pub(super) at: [f64; 2],
    pub(super) anchor: Anchor,
    /// Turned by so many degrees, clockwise.
    pub(super) turned: f64,
    pub(super) color: &'static str,
    pub(super) size: f64,
}

impl<'t> Label<'t> {
    pub(super) fn new(text: &'t str, at: [f64; 2], anchor: Anchor) -> Label<'t> {
        Label { text, at, anchor, turned: 0.0, color: light_color("text"), size: FONT }
    }
}

/// How a line is drawn.
pub(super) struct Stroke<'c> {
    pub(super) color: &'c str,
    pub(super) width: f64,
    /// Lengths of dashes and gaps; empty for a whole line.
    pub(super) dashes: &'static str,
}

/// The picture while it is drawn.
pub(super) struct Drawing<'w> {
    pub(super) writer: &'w mut Writer<Vec<u8>>,
}

impl Drawing<'_> {
    fn shape(&mut self, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
        self.writer.create_element(name).with_attributes(attributes.iter().copied()).write_empty()?;
        Ok(())
    }

    /// A filled rectangle: left, top, width, height.
    pub(super) fn rectangle(&mut self, [x, y, width, height]: [f64; 4], fill: &str) -> io::Result<()> {
        let [x, y, width, height] = [x, y, width, height].map(coordinate);
        self.shape("rect", &[("x", &x), ("y", &y), ("width", &width), ("height", &height), ("fill", fill)])
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: &[[f64; 2]], stroke: &Stroke<'_>) -> io::Result<()> {
        let at = points.iter().map(|[x, y]| format!("{},{}", coordinate(*x), coordinate(*y))).collect::<Vec<_>>();
        let (at, width) = (at.join(" "), coordinate(stroke.width));
        let mut attributes =
            vec![("points", &*at), ("fill", "none"), ("stroke", stroke.color), ("stroke-width", &*width)];
        if !stroke.dashes.is_empty() {
            attributes.push(("stroke-dasharray", stroke.dashes));
        }
        self.shape("polyline", &attributes)
    }

    /// A path with its fill and the colour and width of its edge.
    pub(super) fn path(&mut self, path: &str, fill: &str, edge: &str, width: f64) -> io::Result<()> {
        let width = coordinate(width);
        self.shape("path", &[("d", path), ("fill", fill), ("stroke", edge), ("stroke-width", &width)])
    }

    /// A text.
    pub(super) fn words(&mut self, words: &Label<'_>) -> io::Result<()> {
        let anchor = match words.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        // Half the height of capitals: not all programs know a baseline in the middle.
        let [x, y] = words.at.map(coordinate);
        let (down, size) = (coordinate(0.36 * words.size), coordinate(words.size));
        let turned = format!("rotate({} {x} {y})", words.turned);
        let mut attributes = vec![("x", &*x), ("y", &*y), ("dy", &*down), ("text-anchor", anchor)];
        if words.turned != 0.0 {
            attributes.push(("transform", &*turned));
        }
        if words.color != light_color("text") {
            attributes.push(("fill", words.color));
        }
        if words.size != FONT {
            attributes.push(("font-size", &*size));
        }
        let text = printable(words.text);
        self.writer.create_element("text").with_attributes(attributes).write_text_content(BytesText::new(&text))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{between, coordinate, light_color, printable};

    #[test]
    fn colours_are_those_of_the_light_theme() {
        assert_eq!(
            [light_color("series0"), light_color("text"), light_color("scale2")],
            ["#1f6fb4", "#1b2126", "#bfe3cd"]
        );
        assert_eq!([between(-1.0), between(0.5), between(1.0)], ["#f7d7cf", "#fbf3dc", "#bfe3cd"]);
        assert_eq!(between(0.75), "#ddebd5");
    }

    #[test]
    fn what_is_written_is_xml() {
        assert_eq!([-0.04, 0.06, 12.0].map(coordinate), ["0", "0.1", "12"]);
        assert_eq!(printable("a\u{7}b\nc<é"), "a\u{fffd}b\u{fffd}c<é");
    }
}
