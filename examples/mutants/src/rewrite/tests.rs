//! Small files, by the text that comes out.

use super::*;
use crate::list::{Place, Span};

fn mutant(source: &str, what: &str, genre: Genre, replacement: &str) -> Mutant {
    let at = source.find(what).unwrap();
    let place = |at: usize| Place {
        line: source[..at].matches('\n').count() + 1,
        column: at - source[..at].rfind('\n').map_or(0, |n| n + 1) + 1,
    };
    let span = Span { start: place(at), end: place(at + what.len()) };
    Mutant { name: what.into(), file: "f.rs".into(), genre, replacement: replacement.into(), span }
}

/// The source with the mutants, numbered from 1.
fn rewritten(source: &str, found: &[Mutant]) -> Rewritten {
    let numbered: Vec<(Id, &Mutant)> = found.iter().enumerate().map(|(k, m)| (k + 1, m)).collect();
    rewrite(source, &numbered).unwrap()
}

#[test]
fn operands_may_hold_mutants_of_their_own() {
    let source = "fn f(a: i32, b: i32) -> bool {\n    a + 1 < b && !(b == 2)\n}\n";
    let found = [
        mutant(source, "+", Genre::BinaryOperator, "-"),
        mutant(source, "<", Genre::BinaryOperator, "=="),
        mutant(source, "&&", Genre::BinaryOperator, "||"),
        mutant(source, "!", Genre::UnaryOperator, ""),
    ];
    let rewritten = rewritten(source, &found);
    assert!(rewritten.left_out.is_empty());
    let text = rewritten.text.replace(CHOSEN, "c");
    let sum = "({ let l_ = (a ); let r_ = ( 1); if c(1) { l_ - r_ } else { l_ + r_ } })";
    let less = format!("({{ let l_ = &({sum} ); let r_ = &( b); if c(2) {{ *l_ == *r_ }} else {{ *l_ < *r_ }} }})");
    let not = "({ let v_ = ((b == 2)); if c(4) { v_ } else { !v_ } })";
    let and = format!("({{ let l_ = ({less} ); if l_ != c(3) {{  {not} }} else {{ l_ }} }})");
    assert_eq!(text, format!("fn f(a: i32, b: i32) -> bool {{\n    {and}\n}}\n"));
    syn::parse_file(&rewritten.text).unwrap();
    for region in rewritten.regions.iter().filter(|region| region.is_alternative) {
        assert!(!rewritten.text[region.bytes.clone()].contains('+'));
    }
}

#[test]
fn constants_cannot_hold_a_branch() {
    let source = "const N: usize = 1 + 2;\nconst fn f() -> usize { 3 * N }\n";
    let found = [mutant(source, "+", Genre::BinaryOperator, "-"), mutant(source, "*", Genre::BinaryOperator, "+")];
    let rewritten = rewritten(source, &found);
    assert_eq!((rewritten.left_out, rewritten.text.as_str()), (vec![1, 2], source));
}

#[test]
fn arms_and_bodies_and_sums_in_place() {
    let source = "fn f(mut a: i32) -> i32 {\n    a += 2;\n    match a {\n        1 => 5,\n        2 if a > 0 => 6,\n        _ => 7,\n    }\n}\n";
    let found = [
        mutant(source, "a += 2;", Genre::FnValue, "9"),
        mutant(source, "+=", Genre::BinaryOperator, "-="),
        mutant(source, "1 => 5", Genre::MatchArm, ""),
        mutant(source, "a > 0", Genre::MatchArmGuard, "true"),
        mutant(source, "a > 0", Genre::MatchArmGuard, "false"),
    ];
    let rewritten = rewritten(source, &found);
    assert!(rewritten.left_out.is_empty(), "{:?}", rewritten.left_out);
    let text = rewritten.text.replace(CHOSEN, "c");
    for part in [
        "{ if c(1) { return 9; }\n",
        "{ let r_ = ( 2); if c(2) { a -= r_ } else { a += r_ } };",
        "1 if !c(3) && true  => 5",
        "2 if (c(4) || !c(5) && (a > 0)) => 6",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    syn::parse_file(&rewritten.text).unwrap();
}
