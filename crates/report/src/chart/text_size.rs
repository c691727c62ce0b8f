//! How wide a text is in a sans-serif font, without one at hand.

/// How much wider than Helvetica.
const STRETCH: f64 = 1.16;

/// The width of a text in a font of this size, both in pixels: an estimate for the wide ones among those that stand behind
/// `sans-serif`, DejaVu Sans for one, so that it fits in narrow ones too: widths of Helvetica, stretched.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(of_char).sum::<f64>() * size * STRETCH
}

/// In parts of the font's size.
fn of_char(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' | '|' => 0.24,
        ' ' | '!' | ',' | '.' | '/' | ':' | ';' | 'I' | 'f' | 't' | '[' | ']' | '\\' => 0.29,
        '(' | ')' | '-' | 'r' | '`' | '"' => 0.35,
        '¹' | '²' | '³' | '⁰' | '⁴'..='⁹' | '⁻' => 0.36,
        '*' | '^' | 'c' | 'k' | 's' | 'v' | 'x' | 'y' | 'z' | 'J' => 0.5,
        'F' | 'L' | 'T' | 'Z' => 0.61,
        '+' | '<' | '=' | '>' | '~' | '×' | '±' => 0.6,
        'A' | 'B' | 'E' | 'K' | 'P' | 'S' | 'V' | 'X' | 'Y' | '&' => 0.67,
        'C' | 'D' | 'H' | 'N' | 'R' | 'U' | 'w' => 0.73,
        'G' | 'O' | 'Q' => 0.78,
        'M' | 'm' => 0.84,
        '%' | 'W' | '@' => 0.95,
        c if c.is_ascii() => 0.56,
        // Scripts whose letters fill a square, and whatever else is unknown.
        c if u32::from(c) >= 0x1100 => 1.0,
        _ => 0.6,
    }
}
