//! A source file with all its mutants in it: each is a branch that is taken where its number was chosen.
//!
//! Text is only inserted around what is there, never written twice: an operand may hold mutants of its own. So `l < r` becomes
//! `({ let l_ = &(l); let r_ = &(r); if chosen(7) { *l_ == *r_ } else { *l_ < *r_ } })`, and `l && r`, which may not look at `r`,
//! `({ let l_ = (l); if l_ != chosen(8) { r } else { l_ } })`, which is `l || r` for the one and `l && r` for all others.

mod edit;
#[cfg(test)]
mod tests;

use self::edit::{Edit, Inserted, apply};
use crate::list::{Genre, Mutant};
use anyhow::{Result, anyhow};
use proc_macro2::LineColumn;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Block, Expr};

/// How a source file asks whether a mutant is chosen.
const CHOSEN: &str = "::rockproof_model::mutation::chosen";

pub use self::edit::Region;

/// The number of a mutant: its place in the list, from 1. 0 chooses none.
pub type Id = usize;

/// A file with its mutants.
pub struct Rewritten {
    pub text: String,
    /// Which bytes of the text belong to which mutants, for errors of the compiler. A region of one alternative lies in that of its operator.
    pub regions: Vec<Region>,
    /// Mutants that no branch can hold: in constants, in `const fn`, in chains of `let`, of fields.
    pub left_out: Vec<Id>,
}

/// Puts mutants into a file.
pub fn rewrite(source: &str, mutants: &[(Id, &Mutant)]) -> Result<Rewritten> {
    let file = syn::parse_file(source).map_err(|error| anyhow!("{error}"))?;
    let mut finder = Finder {
        lines: Lines::of(source),
        source,
        wanted: BTreeMap::new(),
        edits: Vec::new(),
        used: BTreeSet::new(),
        constant: 0,
    };
    for (id, mutant) in mutants {
        let start = finder.lines.byte_of(mutant.span.start.line, mutant.span.start.column - 1);
        finder.wanted.entry(start).or_default().push((*id, (*mutant).clone()));
    }
    finder.visit_file(&file);
    let left_out = mutants.iter().map(|(id, _)| *id).filter(|id| !finder.used.contains(id)).collect();
    let (text, regions) = apply(source, finder.edits);
    Ok(Rewritten { text, regions, left_out })
}

/// Where lines begin.
struct Lines<'s> {
    source: &'s str,
    starts: Vec<usize>,
}

impl<'s> Lines<'s> {
    fn of(source: &'s str) -> Lines<'s> {
        let starts = std::iter::once(0).chain(source.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Lines { source, starts }
    }

    /// The byte at a line, from 1, and a column of characters, from 0.
    fn byte_of(&self, line: usize, column: usize) -> usize {
        let start = self.starts[line - 1];
        self.source[start..].char_indices().nth(column).map_or(self.source.len(), |(at, _)| start + at)
    }

    fn byte(&self, at: LineColumn) -> usize {
        self.byte_of(at.line, at.column)
    }

    fn bytes(&self, what: &impl Spanned) -> Range<usize> {
        let span = what.span();
        self.byte(span.start())..self.byte(span.end())
    }
}

struct Finder<'s> {
    lines: Lines<'s>,
    source: &'s str,
    /// Mutants by the byte at which what they take out begins.
    wanted: BTreeMap<usize, Vec<(Id, Mutant)>>,
    edits: Vec<Edit>,
    used: BTreeSet<Id>,
    /// How many constant contexts are around.
    constant: usize,
}

impl Finder<'_> {
    fn wanted(&self, start: usize, genre: Genre) -> Vec<(Id, Mutant)> {
        if self.constant > 0 {
            return Vec::new();
        }
        let here = self.wanted.get(&start).into_iter().flatten();
        here.filter(|(_, mutant)| mutant.genre == genre).cloned().collect()
    }

    fn push(&mut self, edit: Edit) {
        self.used.extend(&edit.mutants);
        self.edits.push(edit);
    }

    fn body(&mut self, block: &Block, signature: &syn::Signature) {
        let is_const = signature.constness.is_some();
        // One type is behind `impl Iterator`, and a constant has another.
        let is_opaque = self.source[self.lines.bytes(&signature.output)].contains("impl ");
        if !is_const && !is_opaque {
            self.values(block);
        }
        if is_const {
            self.in_constant(|finder| visit::visit_block(finder, block));
        } else {
            visit::visit_block(self, block);
        }
    }

    /// Visits what can hold no branch.
    fn in_constant(&mut self, visit: impl FnOnce(&mut Self)) {
        self.constant += 1;
        visit(self);
        self.constant -= 1;
    }

    /// Constants in the place of a body.
    fn values(&mut self, block: &Block) {
        let Some(first) = block.stmts.first() else { return };
        let found = self.wanted(self.lines.bytes(first).start, Genre::FnValue);
        if found.is_empty() {
            return;
        }
        let brace = self.lines.byte(block.brace_token.span.open().end());
        let mut text = Inserted::default();
        for (id, mutant) in &found {
            text.text.push_str(" if ");
            text.text.push_str(&format!("{CHOSEN}({id}) {{ return "));
            let begin = text.text.len();
            text.text.push_str(&mutant.replacement);
            text.alternatives.push((begin..text.text.len(), *id));
            text.text.push_str("; }");
        }
        self.push(Edit {
            whole: brace..brace,
            prefix: text,
            replaced: Vec::new(),
            suffix: Inserted::default(),
            mutants: ids(&found),
        });
    }

    fn binary(&mut self, expression: &syn::ExprBinary) {
        let operator = self.lines.bytes(&expression.op);
        let found = self.wanted(operator.start, Genre::BinaryOperator);
        if found.is_empty() || holds_let(&expression.left) || holds_let(&expression.right) {
            return;
        }
        let whole = self.lines.bytes(expression);
        let own = &self.source[operator.clone()];
        let simple = |prefix: &str, between: &str, suffix: Inserted| Edit {
            whole: whole.clone(),
            prefix: Inserted::plain(prefix),
            replaced: vec![(operator.clone(), Inserted::plain(between))],
            suffix,
            mutants: ids(&found),
        };
        let edit = match expression.op {
            BinOp::And(_) | BinOp::Or(_) => {
                let (id, mutant) = &found[0];
                let other = if own == "&&" { "||" } else { "&&" };
                if found.len() > 1 || mutant.replacement != other {
                    return;
                }
                let sign = if own == "&&" { "!=" } else { "==" };
                let between = format!("); if l_ {sign} {CHOSEN}({id}) {{ ");
                simple("({ let l_ = (", &between, Inserted::plain(" } else { l_ } })"))
            }
            BinOp::Eq(_) | BinOp::Ne(_) | BinOp::Lt(_) | BinOp::Le(_) | BinOp::Gt(_) | BinOp::Ge(_) => {
                let choice = choice(&found, own, |operator| format!("*l_ {operator} *r_"));
                simple("({ let l_ = &(", "); let r_ = &(", wrapped("); ", choice, " })"))
            }
            _ if own.ends_with('=') => {
                let left = self.lines.bytes(&*expression.left);
                let place = &self.source[left.clone()];
                let choice = choice(&found, own, |operator| format!("{place} {operator} r_"));
                Edit {
                    whole: whole.clone(),
                    prefix: Inserted::plain("{ let r_ = ("),
                    replaced: vec![(left.start..operator.end, Inserted::default())],
                    suffix: wrapped("); ", choice, " }"),
                    mutants: ids(&found),
                }
            }
            _ => {
                let choice = choice(&found, own, |operator| format!("l_ {operator} r_"));
                simple("({ let l_ = (", "); let r_ = (", wrapped("); ", choice, " })"))
            }
        };
        self.push(edit);
    }

    fn unary(&mut self, expression: &syn::ExprUnary) {
        let whole = self.lines.bytes(expression);
        let operator = self.lines.bytes(&expression.op);
        let found = self.wanted(operator.start, Genre::UnaryOperator);
        if found.is_empty() {
            return;
        }
        let own = &self.source[operator.clone()];
        let mut suffix = Inserted::plain("); ");
        for (id, mutant) in &found {
            suffix.alternative(*id, &format!("{}v_", mutant.replacement));
        }
        suffix.text.push_str(&format!("{{ {own}v_ }} }})"));
        let replaced = vec![(operator, Inserted::default())];
        self.push(Edit { whole, prefix: Inserted::plain("({ let v_ = ("), replaced, suffix, mutants: ids(&found) });
    }

    fn arm(&mut self, arm: &syn::Arm) {
        let whole = self.lines.bytes(arm);
        let dropped = self.wanted(whole.start, Genre::MatchArm);
        let guard = arm.guard.as_ref().map(|(_, guard)| &**guard);
        if guard.is_some_and(holds_let) {
            return;
        }
        let mut conditions: String = dropped.iter().map(|(id, _)| format!("!{CHOSEN}({id}) && ")).collect();
        let Some(guard) = guard else {
            if !dropped.is_empty() {
                let end = self.lines.bytes(&arm.pat).end;
                let text = Inserted::plain(format!(" if {}true ", conditions));
                let suffix = Inserted::default();
                self.push(Edit { whole: end..end, prefix: text, replaced: Vec::new(), suffix, mutants: ids(&dropped) });
            }
            return;
        };
        let place = self.lines.bytes(guard);
        let mut found = self.wanted(place.start, Genre::MatchArmGuard);
        conditions.push('(');
        // `true` first: `&&` binds tighter than `||`.
        found.sort_by_key(|(_, mutant)| mutant.replacement != "true");
        for (id, mutant) in &found {
            match mutant.replacement.as_str() {
                "true" => conditions.push_str(&format!("{CHOSEN}({id}) || ")),
                _ => conditions.push_str(&format!("!{CHOSEN}({id}) && ")),
            }
        }
        conditions.push('(');
        found.extend(dropped);
        if !found.is_empty() {
            let suffix = Inserted::plain("))");
            let prefix = Inserted::plain(conditions);
            self.push(Edit { whole: place, prefix, replaced: Vec::new(), suffix, mutants: ids(&found) });
        }
    }
}

fn ids(found: &[(Id, Mutant)]) -> Vec<Id> {
    found.iter().map(|(id, _)| *id).collect()
}

fn wrapped(before: &str, choice: Inserted, after: &str) -> Inserted {
    let shift = before.len();
    let alternatives = choice.alternatives.into_iter().map(|(r, id)| (r.start + shift..r.end + shift, id)).collect();
    Inserted { text: format!("{before}{}{after}", choice.text), alternatives }
}

fn choice(found: &[(Id, Mutant)], own: &str, with: impl Fn(&str) -> String) -> Inserted {
    let mut text = Inserted::default();
    for (id, mutant) in found {
        text.alternative(*id, &with(&mutant.replacement));
    }
    text.text.push_str(&format!("{{ {} }}", with(own)));
    text
}

/// Whether the expression is or holds a `let` of a chain.
fn holds_let(expression: &Expr) -> bool {
    match expression {
        Expr::Let(_) => true,
        Expr::Binary(inner) if matches!(inner.op, BinOp::And(_)) => holds_let(&inner.left) || holds_let(&inner.right),
        _ => false,
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.body(&item.block, &item.sig);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.body(&item.block, &item.sig);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.body(block, &item.sig);
        }
    }

    fn visit_expr_binary(&mut self, expression: &'ast syn::ExprBinary) {
        self.binary(expression);
        visit::visit_expr_binary(self, expression);
    }

    fn visit_expr_unary(&mut self, expression: &'ast syn::ExprUnary) {
        self.unary(expression);
        visit::visit_expr_unary(self, expression);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        self.arm(arm);
        visit::visit_arm(self, arm);
    }

    // No branch may stand in any of these.
    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        self.in_constant(|finder| visit::visit_item_const(finder, item));
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.in_constant(|finder| visit::visit_impl_item_const(finder, item));
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        self.in_constant(|finder| visit::visit_item_static(finder, item));
    }

    fn visit_expr_const(&mut self, item: &'ast syn::ExprConst) {
        self.in_constant(|finder| visit::visit_expr_const(finder, item));
    }

    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}

    fn visit_expr_repeat(&mut self, item: &'ast syn::ExprRepeat) {
        self.visit_expr(&item.expr);
    }
}
