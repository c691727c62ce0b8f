//! Tables for a paper, in LaTeX with `booktabs`.

use super::table::{Table, TableCell};
use std::ops::RangeInclusive;

/// How many rows at most are printed of a table that the page does not show.
pub const MAX_ROWS: usize = 60;

/// The table as a `tabular`, at most `most` rows of it, for `\input` inside of a float of the paper's own. What it shows, and which rows are left
/// out, stands in comments.
pub fn latex(table: &Table, most: usize) -> String {
    let needed = table.needed();
    let alignment: String = needed.clone().map(|column| if table.is_number(column) { 'r' } else { 'l' }).collect();
    let head: Vec<String> = table.columns[needed.clone()].iter().map(|name| escaped(&name.replace('_', " "))).collect();
    let mut text = format!(
        "% {}\n% \\usepackage{{booktabs}}\n\\begin{{tabular}}{{{alignment}}}\n\\toprule\n{} \\\\\n\\midrule\n",
        table.caption.replace(['\n', '\r'], " "),
        head.join(" & ")
    );
    for row in table.rows.iter().take(most) {
        let cells: Vec<String> = row[needed.clone()].iter().map(cell).collect();
        text += &format!("{} \\\\\n", cells.join(" & "));
    }
    text += "\\bottomrule\n\\end{tabular}\n";
    if table.rows.len() > most {
        text += &format!("% {} more rows in {}.csv\n", table.rows.len() - most, table.name);
    }
    text
}

/// A cell: numbers as formulas, so that they have minus signs and powers of ten.
fn cell(cell: &TableCell) -> String {
    let shown = cell.shown();
    match cell {
        TableCell::Number(number) | TableCell::Setting(number) if number.is_finite() => match shown.split_once('e') {
            Some((digits, exponent)) => format!("${digits}\\times10^{{{exponent}}}$"),
            None => format!("${shown}$"),
        },
        _ => escaped(&shown),
    }
}

/// A text that LaTeX shows as it is.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut raised = String::new();
    for (at, c) in text.char_indices() {
        if let Some(digit) = lowered(c) {
            raised.push(digit);
            continue;
        }
        raise(&mut out, &mut raised);
        match c {
            // Behind a line break of a row a bracket would be an option of it.
            '[' if at == 0 => out.push_str("{[}"),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                out.push('\\');
                out.push(c);
            }
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '*' if at == 0 => out.push_str("{*}"),
            '<' => out.push_str("\\textless{}"),
            '>' => out.push_str("\\textgreater{}"),
            '|' => out.push_str("\\textbar{}"),
            // The usual font encoding has no straight double quote.
            '"' => out.push_str("''"),
            '`' => out.push_str("\\textasciigrave{}"),
            // A ligature would make one dash of two.
            '-' if text[..at].ends_with('-') => out.push_str("{-}"),
            '–' => out.push_str("\\textendash{}"),
            '\u{a0}' | '\u{202f}' => out.push_str("\\,"),
            'Δ' => out.push_str("$\\Delta$"),
            'ε' => out.push_str("$\\varepsilon$"),
            '×' => out.push_str("$\\times$"),
            '·' => out.push_str("$\\cdot$"),
            '≤' => out.push_str("$\\le$"),
            '≥' => out.push_str("$\\ge$"),
            '→' => out.push_str("$\\to$"),
            '√' => out.push_str("$\\surd$"),
            'µ' | 'μ' => out.push_str("$\\mu$"),
            'θ' => out.push_str("$\\theta$"),
            'φ' => out.push_str("$\\varphi$"),
            '°' => out.push_str("$^\\circ$"),
            '±' => out.push_str("$\\pm$"),
            '−' => out.push_str("$-$"),
            '…' => out.push_str("\\ldots{}"),
            c if c.is_control() => out.push(' '),
            c if c.is_ascii() || ACCENTED.contains(&c) && !NOT_IN_OT1.contains(&c) => out.push(c),
            // pdfLaTeX stops at a character that it does not know.
            c => out.push_str(&format!("U+{:04X}", u32::from(c))),
        }
    }
    raise(&mut out, &mut raised);
    out
}

/// Letters with accents that pdfLaTeX knows in any font encoding.
const ACCENTED: RangeInclusive<char> = 'À'..='ÿ';
/// Those among them that it does not, and two signs.
const NOT_IN_OT1: [char; 6] = ['Ð', 'ð', 'Þ', 'þ', '×', '÷'];

/// The digit or sign that a raised one stands for.
fn lowered(c: char) -> Option<char> {
    Some(match c {
        '⁻' => '-',
        '⁺' => '+',
        '⁰' => '0',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁴'..='⁹' => char::from_digit(u32::from(c) - u32::from('⁰'), 10)?,
        _ => return None,
    })
}

/// Writes the exponent that has been gathered.
fn raise(out: &mut String, raised: &mut String) {
    if !raised.is_empty() {
        out.push_str(&format!("$^{{{raised}}}$"));
        raised.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::{escaped, latex};
    use crate::table::{Table, TableCell};

    #[test]
    fn a_table_for_a_paper() {
        let mut table = Table::new("t", "what it\nshows", &["run", "engine_name", "share", "size_m"]);
        let row = |name: &str, share, size| {
            vec!["one run".into(), name.into(), TableCell::Share(share), TableCell::Number(size)]
        };
        table.push(row("a_b & 5 %", 0.5, -1.25e-9));
        table.push(row("[x]", 1e-9, 12_345.6));
        table.push(row("f", 1.0, f64::NAN));
        assert_eq!(
            latex(&table, 2),
            "% what it shows\n% \\usepackage{booktabs}\n\\begin{tabular}{lrr}\n\\toprule\nengine name & share & size m \\\\\n\\midrule\n\
             a\\_b \\& 5 \\% & 50.00 \\% & $-1.25\\times10^{-9}$ \\\\\n\
             {[}x] & \\textless{} 0.01 \\% & $1.23\\times10^{4}$ \\\\\n\
             \\bottomrule\n\\end{tabular}\n% 1 more rows in t.csv\n"
        );
        assert!(latex(&table, 3).contains("f & 100 \\% & NaN \\\\\n\\bottomrule"));
    }

    #[test]
    fn no_text_is_a_command() {
        let nasty = "\\input{x} #1 ~ ^ {a}_$y$ | <b> \"c\" -- \u{7}é Δ≥1\u{202f}000 10⁻¹²m² 3° 岩þ";
        assert_eq!(
            escaped(nasty),
            "\\textbackslash{}input\\{x\\} \\#1 \\textasciitilde{} \\textasciicircum{} \\{a\\}\\_\\$y\\$ \\textbar{} \\textless{}b\\textgreater{} \
             ''c'' -{-}  é $\\Delta$$\\ge$1\\,000 10$^{-12}$m$^{2}$ 3$^\\circ$ U+5CA9U+00FE"
        );
    }
}
