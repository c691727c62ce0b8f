//! The model and its worst pairs in three dimensions, for the page.

use crate::assess::{Examination, plural};
use crate::cases::KeptCase;
use crate::naming::{Naming, file_name};
use crate::results::PairFacts;
use rockproof_model::Block;
use rockproof_oracle::audit::OverlapSeverity;
use rockproof_report::model_view::{BlockGroup, traces};
use rockproof_report::sections::{FindingView, ShownCase};
use rockproof_report::table::six_digits;
use std::path::Path;

/// Blocks that a browser is asked to draw; of more only those with something to say.
const MAX_DRAWN: usize = 20_000;
/// Overlapping pairs that are shown by themselves.
const MAX_OVERLAPS: usize = 3;

/// What is worst about a block, the gravest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum BlockStatus {
    /// It overlaps another so that contacts cannot hold them.
    Lost,
    /// It passed through another within the steps, or overlapped it unseen after one.
    Passed,
    /// Its contacts are wrong by more than a tie.
    Broken,
    /// It overlaps another and is held.
    Held,
    /// Its contacts differ where rounding decides a tie.
    Differs,
    /// Nothing.
    Sound,
}

impl BlockStatus {
    const ALL: [BlockStatus; 6] = [
        BlockStatus::Lost,
        BlockStatus::Passed,
        BlockStatus::Broken,
        BlockStatus::Held,
        BlockStatus::Differs,
        BlockStatus::Sound,
    ];

    /// Name, colour of the page's theme, opacity.
    fn shown(self) -> (&'static str, &'static str, f64) {
        match self {
            BlockStatus::Lost => ("overlap that contacts cannot hold", "$bad", 0.6),
            BlockStatus::Passed => ("passes through another", "$cause1", 0.6),
            BlockStatus::Broken => ("contacts broken", "$seen", 0.6),
            BlockStatus::Held => ("overlap that contacts hold", "$fair", 0.45),
            BlockStatus::Differs => ("contacts differ at a tie", "$a", 0.3),
            BlockStatus::Sound => ("nothing found", "$both", 0.15),
        }
    }

    /// The standing that a pair gives its blocks.
    pub(crate) fn of(pair: &PairFacts<'_>) -> BlockStatus {
        let in_asked = pair.asked();
        match pair.overlap.map(|(_, severity)| severity) {
            Some(OverlapSeverity::Lost) => BlockStatus::Lost,
            _ if pair.passage_m.is_some() || pair.unseen_m.is_some() => BlockStatus::Passed,
            _ if in_asked.broken > 0 => BlockStatus::Broken,
            Some(OverlapSeverity::Held) => BlockStatus::Held,
            _ if in_asked.total() > 0 => BlockStatus::Differs,
            _ => BlockStatus::Sound,
        }
    }
}

/// The worst standing of each block, and what is said of it.
pub(crate) fn block_statuses(found: &Examination, pairs: &[PairFacts<'_>]) -> Vec<(BlockStatus, String)> {
    let mut all: Vec<(BlockStatus, String)> = (found.model.scene.blocks.iter().enumerate())
        .map(|(number, block)| (BlockStatus::Sound, format!("block {number} {}", block.name)))
        .collect();
    for pair in pairs {
        let standing = BlockStatus::of(pair);
        let [a, b] = pair.blocks;
        for (block, other) in [(a, b), (b, a)] {
            if standing < all[block].0 {
                let name = &found.model.scene.blocks[block].name;
                let depth = pair.depth_m().map_or(String::new(), |depth| format!(", {depth:.3e} m deep"));
                all[block] = (standing, format!("block {block} {name}: {} (block {other}{depth})", standing.shown().0));
            }
        }
    }
    all
}

/// The views of the page: the whole model, the deepest overlaps, the worst differences.
pub(crate) fn views(
    (found, naming): (&Examination, &Naming),
    (pairs, block_statuses): (&[PairFacts<'_>], &[(BlockStatus, String)]),
    (cases, dir): (&[KeptCase], &Path),
) -> Vec<FindingView> {
    let shapes = found.model.scene.shapes();
    let mut views = vec![whole(found, naming, &shapes, block_statuses)];
    let mut lost: Vec<&PairFacts<'_>> =
        pairs.iter().filter(|pair| BlockStatus::of(pair) == BlockStatus::Lost).collect();
    lost.sort_by(|one, two| two.depth_m().unwrap_or(0.0).total_cmp(&one.depth_m().unwrap_or(0.0)));
    views.extend(lost.into_iter().take(MAX_OVERLAPS).map(|pair| overlap(found, naming, &shapes, pair)));
    for (number, kept) in cases.iter().enumerate() {
        let predicate = kept.finding.predicate().map_or(String::new(), |predicate| predicate.to_string());
        let (engine, file) = (kept.finding.scope.to_string(), dir.join(&kept.file));
        let shown = ShownCase { cause: kept.finding.cause, predicate: &predicate, engine: &engine, file: &file };
        let [a, b] = kept.blocks;
        let name = format!("blocks {a} (A) and {b} (B), {}", kept.finding.difference.change.name());
        views.push(shown.view(&kept.case, &name, number));
    }
    views
}

fn whole(
    found: &Examination,
    naming: &Naming,
    shapes: &[&Block],
    block_statuses: &[(BlockStatus, String)],
) -> FindingView {
    let is_drawn = |standing: BlockStatus| shapes.len() <= MAX_DRAWN || standing != BlockStatus::Sound;
    let groups: Vec<BlockGroup> = BlockStatus::ALL
        .into_iter()
        .filter(|standing| is_drawn(*standing))
        .map(|standing| {
            let (name, color, opacity) = standing.shown();
            let of = block_statuses.iter().enumerate().filter(|(_, (found, _))| *found == standing);
            let blocks = of.map(|(number, (_, text))| (number, text.clone())).take(MAX_DRAWN).collect();
            BlockGroup { name: name.to_owned(), color, opacity, blocks }
        })
        .collect();
    let count = |standing: BlockStatus| block_statuses.iter().filter(|(found, _)| *found == standing).count();
    let mut facts: Vec<(&'static str, String)> = BlockStatus::ALL
        .into_iter()
        .map(|standing| (standing.shown().0, plural(count(standing), "block", "blocks")))
        .collect();
    if shapes.len() > MAX_DRAWN {
        facts.push(("not drawn", format!("blocks without a finding: {} are more than {MAX_DRAWN}", shapes.len())));
    }
    let (traces, centre) = traces(shapes, &groups);
    facts.push(("axes from", format!("({})", centre.map(six_digits).join(", "))));
    FindingView {
        id: "whole-model".to_owned(),
        title: format!("{}: each block by the worst that was found of it", file_name(&found.model.file)),
        cause: "model",
        facts,
        contacts: Vec::new(),
        replay: naming.show_all(),
        traces,
    }
}

fn overlap(found: &Examination, naming: &Naming, shapes: &[&Block], pair: &PairFacts<'_>) -> FindingView {
    let [a, b] = pair.blocks;
    let name = |block: usize| format!("block {block} {}", found.model.scene.blocks[block].name);
    let group = |number: usize, block: usize, color: &'static str| BlockGroup {
        name: name(block),
        color,
        opacity: 0.35,
        blocks: vec![(number, name(block))],
    };
    let (traces, centre) = traces(&[shapes[a], shapes[b]], &[group(0, a, "$a"), group(1, b, "$b")]);
    let mut facts = vec![("penetration", format!("{:?} m", pair.depth_m().unwrap_or(0.0)))];
    if let Some((overlap, _)) = pair.overlap {
        facts.push(("by contacts", overlap.sight.name().to_owned()));
    }
    facts.push(("axes from", format!("({})", centre.map(six_digits).join(", "))));
    FindingView {
        id: format!("overlap-{a}-{b}"),
        title: format!("blocks {a} and {b} overlap"),
        cause: "overlap",
        facts,
        contacts: Vec::new(),
        replay: naming.show(pair.blocks),
        traces,
    }
}
