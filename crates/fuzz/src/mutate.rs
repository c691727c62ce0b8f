//! Good files made bad, or different, by a few changes.

use crate::dice::Dice;

/// What stands in the way of readers: numbers at the ends of types, signs, words, characters of more than one byte.
const WORDS: [&str; 44] = [
    "0",
    "-1",
    "1e308",
    "-1e309",
    "1e-400",
    "5e-324",
    "3.4028235e38",
    "nan",
    "inf",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "18446744073709551616",
    "-9223372036854775808",
    "-0",
    "1/0",
    "1/3",
    "0x10",
    "0x1p-1074",
    "1e999999999",
    "",
    " ",
    "\n",
    "\r\n",
    "\t",
    "é",
    "\u{feff}",
    "\u{0}",
    "\u{1b}[31m",
    "\"",
    "\\",
    "[[",
    "]]",
    "{",
    "}",
    "=",
    "#",
    ",",
    "f",
    "v",
    "true",
    "null",
    "[blocks]",
    "9999999999999999999999999",
];

/// The longest input that is made; what doubles itself stays below it.
const LONGEST: usize = 1 << 16;

/// What ends a token: white space, or also what separates values in TOML and JSON.
fn ends(byte: u8, loosely: bool) -> bool {
    byte.is_ascii_whitespace() || (!loosely && b",=:[]{}()\"".contains(&byte))
}

fn token(bytes: &[u8], from: usize, loosely: bool) -> usize {
    bytes[from..].iter().position(|b| ends(*b, loosely)).map_or(bytes.len(), |length| from + length)
}

/// `good` with one to three changes, now and then more; `other` is where pieces come from that do not belong.
pub fn mutated(good: &[u8], other: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = good.to_vec();
    let changes = if dice.once_in(16) { 4 + dice.below(12) } else { 1 + dice.below(3) };
    for _ in 0..changes {
        change(&mut bytes, other, dice);
        bytes.truncate(LONGEST);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    let at = dice.below(bytes.len());
    let end = if bytes.is_empty() { 0 } else { token(bytes, at, dice.once_in(2)) };
    let word = || -> fn(&mut Dice) -> &'static [u8] { |dice| dice.one_of(&WORDS).as_bytes() };
    match dice.below(14) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => drop(bytes.splice(at..end, word()(dice).iter().copied())),
        3 => drop(bytes.splice(at..at, word()(dice).iter().copied())),
        4 => {
            let copy = bytes[at..end].to_vec();
            let to = dice.below(bytes.len());
            drop(bytes.splice(to..to, copy));
        }
        5 if !bytes.is_empty() => bytes[at] = 32 + dice.below(95) as u8,
        6 if !bytes.is_empty() => drop(bytes.remove(at)),
        7 if !bytes.is_empty() => bytes[at] ^= 1 << dice.below(8),
        8 => {
            // The rest is another file's.
            bytes.truncate(at);
            bytes.extend_from_slice(&other[dice.below(other.len() + 1).min(other.len())..]);
        }
        9 | 10 => digit(bytes, at, dice),
        11 => {
            // One token in the place of another.
            let from = dice.below(bytes.len());
            let copy = if bytes.is_empty() { Vec::new() } else { bytes[from..token(bytes, from, true)].to_vec() };
            drop(bytes.splice(at..end, copy));
        }
        _ => lines(bytes, dice),
    }
}

/// Changes the next digit, or puts an exponent behind it.
fn digit(bytes: &mut Vec<u8>, from: usize, dice: &mut Dice) {
    let Some(at) = (from..bytes.len()).find(|k| bytes[*k].is_ascii_digit()) else { return };
    match dice.below(3) {
        0 => {
            let exponent = format!("e{}", dice.below(700) as i64 - 350);
            drop(bytes.splice(at + 1..at + 1, exponent.into_bytes()));
        }
        _ => bytes[at] = b'0' + dice.below(10) as u8,
    }
}

/// Takes a line away, writes it twice, or exchanges it with another.
fn lines(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    if lines.is_empty() {
        return;
    }
    let (one, other) = (dice.below(lines.len()), dice.below(lines.len()));
    match dice.below(3) {
        0 => drop(lines.remove(one)),
        1 => lines.insert(other, lines[one].clone()),
        _ => lines.swap(one, other),
    }
    *bytes = lines.concat();
}
