//! The file of a case: its reader and its writer.

use super::{Case, CaseDescription};
use crate::compare::AnswerChange;
use crate::external::protocol::UNNAMED;
use crate::external::spec::is_name;
use crate::finding::Cause;
use crate::separation_state::ReportedState;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::files::read_text;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{
    Block, BlockError, BlockOptions, Contact, ContactKind, Number, Point, SpecError, ToleranceSet, ToleranceSpec,
    VertexId,
};
use serde::{Deserialize, Serialize};
use std::path::Path;
use toml::de::DeTable;

/// The file as it is parsed.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseFile {
    case: CaseDescription,
    tolerances: ToleranceSet,
    block: Vec<CaseBlock>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseBlock {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    vertices: Vec<[Number; 3]>,
    faces: Vec<Vec<VertexId>>,
}

/// Why a file is not a case.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The file cannot be read.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// Not TOML, or not the keys of a case.
    #[error("{file}: {source}")]
    Toml {
        /// The file.
        file: String,
        /// What, with line and column.
        source: Box<toml::de::Error>,
    },
    /// A value that is not one of those allowed.
    #[error("{file}: {key} is \"{found}\"; allowed are {allowed}")]
    Value {
        /// The file.
        file: String,
        /// The key.
        key: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// A tolerance that is none.
    #[error("{file}: [tolerances]: {source}")]
    Tolerance {
        /// The file.
        file: String,
        /// What is wrong.
        source: SpecError,
    },
    /// A case has two blocks.
    #[error("{file}: {found} [[block]] tables; a case has 2")]
    Blocks {
        /// The file.
        file: String,
        /// How many there are.
        found: usize,
    },
    /// A block that is none.
    #[error("{file}: block {block}: {source}")]
    Block {
        /// The file.
        file: String,
        /// Its number.
        block: usize,
        /// What is wrong.
        source: BlockError,
    },
}

impl Case {
    /// The case as TOML.
    ///
    /// # Errors
    /// Those of the TOML writer.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        let block = |block: &Block| CaseBlock {
            name: None,
            vertices: block.vertices().iter().map(|v| [v.x.clone(), v.y.clone(), v.z.clone()]).collect(),
            faces: block.topology().faces().to_vec(),
        };
        let file = CaseFile {
            case: self.about.clone(),
            tolerances: self.tolerances.clone(),
            block: vec![block(&self.a), block(&self.b)],
        };
        toml::to_string(&file)
    }

    /// The case in a file.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn load(path: &Path) -> Result<Case, CaseError> {
        let file = path.display().to_string();
        let text = read_text(path).map_err(|source| CaseError::Io { file: file.clone(), source })?;
        Case::from_toml(&text, file)
    }

    /// The case in a text; `file` is its name in messages.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn from_toml(text: &str, file: String) -> Result<Case, CaseError> {
        let parsed: CaseFile =
            toml::from_str(text).map_err(|source| CaseError::Toml { file: file.clone(), source: Box::new(source) })?;
        let about = parsed.case;
        let at = |key, place| match line_in_case(text, key, place) {
            Some(line) => format!("{file}:{line}"),
            None => file.clone(),
        };
        let known = |key, found: &str, allowed: &[&str]| {
            if allowed.contains(&found) {
                return Ok(());
            }
            let (file, found, allowed) = (at(key, None), excerpt(found, EXCERPT_LENGTH), allowed.join(", "));
            Err(CaseError::Value { file, key, found, allowed })
        };
        if !["any", "f32", "f64"].contains(&about.engine.as_str()) && !is_name(&about.engine) {
            let allowed = "any, f32, f64, and names of letters, digits, '-', '_' and '.'".to_owned();
            return Err(CaseError::Value {
                file: at("engine", None),
                key: "engine",
                found: excerpt(&about.engine, EXCERPT_LENGTH),
                allowed,
            });
        }
        for (key, margin) in [("margin", about.margin), ("margin_ulps", about.margin_ulps)] {
            if let Some(found) = margin.filter(|margin| !margin.is_finite()) {
                let allowed = "finite numbers".to_owned();
                return Err(CaseError::Value { file: at(key, None), key, found: found.to_string(), allowed });
            }
        }
        known("cause", &about.cause, &Cause::ALL.map(Cause::name))?;
        known("change", &about.change, &AnswerChange::ALL.map(AnswerChange::name))?;
        if let Some(check) = &about.check {
            let checks = AnswerChange::ALL.into_iter().filter(|change| change.is_metamorphic());
            known("check", check, &checks.map(AnswerChange::name).collect::<Vec<_>>())?;
            let unusable = AnswerChange::ALL.into_iter().filter(|change| change.is_unusable());
            known("change", &about.change, &unusable.map(AnswerChange::name).collect::<Vec<_>>())?;
        }
        if about.kind.split(" to ").any(|kind| !kind.is_empty() && ContactKind::from_name(kind).is_none()) {
            known("kind", &about.kind, &ContactKind::ALL.map(ContactKind::name))?;
        }
        if !about.predicate.is_empty() {
            known("predicate", &about.predicate, &Predicate::ALL.map(Predicate::name))?;
        }
        if let Some(said) = &about.found_state {
            let allowed = match ReportedState::from_text(said) {
                Some(_) if about.can_have_found_state() => None,
                Some(_) => Some(
                    "none without states and a change of the pair (swap, renumber, translate, scale, far-block), or a check",
                ),
                None => {
                    Some("apart, touching and overlapping, each alone or as in \"apart 0.5 m along (1.0, 0.0, 0.0)\"")
                }
            };
            if let Some(allowed) = allowed {
                let (found, allowed) = (excerpt(said, EXCERPT_LENGTH), allowed.to_owned());
                let file = at("found_state", None);
                return Err(CaseError::Value { file, key: "found_state", found, allowed });
            }
        }
        for (list, place, row) in about.rows() {
            if row.contact().is_none() {
                let file = at(list, Some(place));
                let allowed = "kinds v-v v-e e-v v-f f-v e-e, entrances v-f f-v e-e, gap signs -1 0 1".to_owned();
                let found = excerpt(&row.to_string(), EXCERPT_LENGTH);
                return Err(CaseError::Value { file, key: "a contact of expected, found or changed", found, allowed });
            }
        }
        let found = parsed.block.len();
        let [a, b] =
            <[CaseBlock; 2]>::try_from(parsed.block).map_err(|_| CaseError::Blocks { file: file.clone(), found })?;
        let block = |number, block: CaseBlock| {
            let vertices = block.vertices.into_iter().map(|[x, y, z]| Point::new(x, y, z)).collect();
            // Real blocks are kept as they were loaded, with faces as far from planar as their file had them.
            let options = BlockOptions { planarity: Number::from_integer(1) };
            Block::new(vertices, block.faces, &options).map_err(|source| CaseError::Block {
                file: file.clone(),
                block: number,
                source,
            })
        };
        let [a, b] = [block(0, a)?, block(1, b)?];
        for (list, place, row) in about.rows() {
            if let Some(contact) = row.contact().filter(|contact| !has_features([&a, &b], contact)) {
                let file = at(list, Some(place));
                let allowed = "the vertices, edges and faces of the two blocks".to_owned();
                let found = format!("{} by {}", contact.key, contact.entrance);
                return Err(CaseError::Value { file, key: "a contact of expected, found or changed", found, allowed });
            }
        }
        let tolerances = parsed.tolerances;
        let mut spec = ToleranceSpec::empty();
        for (name, number) in tolerances.numbers() {
            spec.set_number(name, number.clone())
                .map_err(|source| CaseError::Tolerance { file: file.clone(), source })?;
        }
        Ok(Case { about, a, b, tolerances })
    }
}

/// The line of a key of `[case]`, or of the contact at a place of a list of them.
fn line_in_case(text: &str, key: &str, place: Option<usize>) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let value = root.get_ref().get("case")?.get_ref().as_table()?.get(key)?;
    let value = match place {
        Some(place) => value.get_ref().as_array()?.get(place)?,
        None => value,
    };
    Some(1 + text.bytes().take(value.span().start).filter(|byte| *byte == b'\n').count())
}

/// Whether blocks have the features that a contact and its entrance name; an entrance that an engine did not name is none.
fn has_features(blocks: [&Block; 2], contact: &Contact) -> bool {
    let has = |feature: Feature| feature.is_in(blocks[usize::from(feature.side() == Side::B)].topology());
    let named = (contact.entrance != UNNAMED).then(|| contact.entrance.features());
    contact.key.features().into_iter().chain(named.into_iter().flatten()).all(has)
}
