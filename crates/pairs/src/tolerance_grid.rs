//! Tolerance sets on a grid around a preset: what does each tolerance do?

use super::tolerance_sets::SetSource;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Criteria, Number, ToleranceSet};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A preset with some tolerances multiplied, each by each of some factors: one set for every combination.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToleranceGrid {
    /// The preset.
    pub base: String,
    /// The criteria; empty for the preset's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub criteria: Vec<String>,
    /// Factors of `search`; empty to leave it alone, and so on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub search: Vec<Number>,
    /// Factors of `territory`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub territory: Vec<Number>,
    /// Factors of `penetration`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub penetration: Vec<Number>,
    /// Factors of the sine of the overlap angle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub overlap_sine: Vec<Number>,
    /// Factors of the sine of the parallel angle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parallel_sine: Vec<Number>,
    /// Factors of `equal`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub equal: Vec<Number>,
}

/// Why a grid names no sets.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ToleranceGridError {
    /// A preset that does not exist.
    #[error("grid: base \"{}\" is no tolerance set; there are {}", excerpt(.found, EXCERPT_LENGTH), super::tolerance_sets::NAMES.join(", "))]
    Base {
        /// What was found.
        found: String,
    },
    /// Criteria that do not exist.
    #[error("grid: criteria \"{}\" do not exist; there are classic, revised", excerpt(.0, EXCERPT_LENGTH))]
    Criteria(String),
    /// A factor below zero.
    #[error("grid: {0} has the factor {1}; factors are 0 or more")]
    Negative(&'static str, String),
    /// A factor given twice.
    #[error("grid: {0} has the factor {1} twice")]
    Twice(&'static str, String),
    /// More sets than a campaign can examine sensibly.
    #[error("grid: {0} sets; at most {MAX_SETS} make sense, for each needs pairs of its own")]
    TooMany(usize),
}

/// How many sets a grid may have.
pub const MAX_SETS: usize = 256;

type Field = fn(&mut ToleranceSet) -> &mut Number;

impl ToleranceGrid {
    fn axes(&self) -> [(&'static str, &[Number], Field); 6] {
        [
            ("search", &self.search, |t| &mut t.search),
            ("territory", &self.territory, |t| &mut t.territory),
            ("penetration", &self.penetration, |t| &mut t.penetration),
            ("overlap_sine", &self.overlap_sine, |t| &mut t.overlap_sine),
            ("parallel_sine", &self.parallel_sine, |t| &mut t.parallel_sine),
            ("equal", &self.equal, |t| &mut t.equal),
        ]
    }

    /// Where the sets come from, in the order of their factors as given, the last tolerance changing fastest.
    ///
    /// # Errors
    /// When the grid names what does not exist, or too many sets.
    pub fn sources(&self) -> Result<Vec<SetSource>, ToleranceGridError> {
        let base = SetSource::named(&self.base).ok_or_else(|| ToleranceGridError::Base { found: self.base.clone() })?;
        let mut points = vec![GridPoint { name: self.base.clone(), criteria: None, changes: Vec::new() }];
        if !self.criteria.is_empty() {
            points = self
                .criteria
                .iter()
                .map(|name| {
                    let criteria = [Criteria::Classic, Criteria::Revised].into_iter().find(|c| c.name() == name);
                    let criteria = criteria.ok_or_else(|| ToleranceGridError::Criteria(name.clone()))?;
                    Ok(GridPoint {
                        name: format!("{} {name}", self.base),
                        criteria: Some(criteria),
                        changes: Vec::new(),
                    })
                })
                .collect::<Result<_, ToleranceGridError>>()?;
        }
        for (axis, factors, field) in self.axes() {
            let mut known = BTreeSet::new();
            for factor in factors {
                if factor.is_negative() {
                    return Err(ToleranceGridError::Negative(axis, text(factor)));
                }
                if !known.insert(text(factor)) {
                    return Err(ToleranceGridError::Twice(axis, text(factor)));
                }
            }
            if !factors.is_empty() {
                let with = |point: &GridPoint, factor: &Number| {
                    let mut point = point.clone();
                    point.name += &format!(" {axis}*{}", text(factor));
                    point.changes.push((field, factor.clone()));
                    point
                };
                points = points.iter().flat_map(|p| factors.iter().map(move |f| with(p, f))).collect();
            }
            if points.len() > MAX_SETS {
                return Err(ToleranceGridError::TooMany(points.len()));
            }
        }
        Ok(points.into_iter().map(|point| point.source(base.clone())).collect())
    }
}

/// A point of a grid.
#[derive(Clone)]
struct GridPoint {
    name: String,
    criteria: Option<Criteria>,
    changes: Vec<(Field, Number)>,
}

impl GridPoint {
    fn source(self, base: SetSource) -> SetSource {
        let GridPoint { name, criteria, changes } = self;
        SetSource::new(name, move |a, b, precision| {
            let mut set = base.derive(a, b)?.of(precision).clone();
            set.criteria = criteria.unwrap_or(set.criteria);
            for (field, factor) in &changes {
                let value = field(&mut set);
                // Rounded to f64 and from then on exact, as the presets' values are.
                *value = Number::from_f64(value.times(factor).approximate()).ok()?;
            }
            for sine in [&mut set.overlap_sine, &mut set.parallel_sine] {
                *sine = sine.clone().min(Number::from_integer(1));
            }
            Some(set)
        })
    }
}

fn text(factor: &Number) -> String {
    factor.as_f64().map_or_else(|| factor.to_string(), |value| value.to_string())
}

/// The axes and factors in a set's name, in order; `criteria` is an axis too. `None` for a set of no grid.
pub fn axes_of(set: &str) -> Option<Vec<(&str, &str)>> {
    let mut words = set.split(' ');
    words.next()?;
    let axes: Vec<(&str, &str)> = words
        .map(|word| match word {
            "classic" | "revised" => Some(("criteria", word)),
            _ => word.split_once('*'),
        })
        .collect::<Option<_>>()?;
    (!axes.is_empty()).then_some(axes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Block;

    fn grid(text: &str) -> ToleranceGrid {
        toml::from_str(text).expect("a grid")
    }

    #[test]
    fn one_set_for_every_combination() {
        let grid = grid("base = 'auto'\ncriteria = ['classic', 'revised']\nterritory = [0, 1, '1/2']\nsearch = [2]");
        let names: Vec<String> = grid.sources().expect("sets").iter().map(|s| s.name().to_owned()).collect();
        assert_eq!(names.len(), 6);
        assert_eq!(names[0], "auto classic search*2 territory*0");
        assert_eq!(names[5], "auto revised search*2 territory*0.5");
        assert_eq!(axes_of(&names[5]), Some(vec![("criteria", "revised"), ("search", "2"), ("territory", "0.5")]));
        assert_eq!([axes_of("auto"), axes_of("auto:search"), axes_of("auto (ladders)")], [None, None, None]);
    }

    #[test]
    fn the_tolerances_are_multiplied() {
        let point = |x: i32| {
            rockproof_model::Point::new(Number::from_integer(x), Number::from_integer(x), Number::from_integer(x))
        };
        let cube = Block::cuboid(&point(0), &point(1)).expect("a box");
        let sets = grid("base = 'auto'\nsearch = [2]\noverlap_sine = [100]").sources().expect("sets");
        let base = SetSource::named("auto").and_then(|s| s.derive(&cube, &cube)).expect("a set");
        let set = sets[0].derive(&cube, &cube).expect("a set");
        assert_eq!(set.f64.search, base.f64.search.times(&Number::from_integer(2)));
        assert_eq!(set.f64.overlap_sine, Number::from_integer(1), "no sine is above 1");
        assert_eq!(set.f64.territory, base.f64.territory);
        assert_ne!(set.f32.equal, set.f64.equal, "as the preset for each precision");
    }

    #[test]
    fn mistakes_are_named() {
        let fault = |text: &str| grid(text).sources().expect_err("a mistake").to_string();
        assert!(fault("base = 'otto'").contains("otto") && fault("base = 'otto'").contains("auto"));
        assert!(fault("base = 'auto'\nsearch = [-1]").contains("search has the factor -1"));
        assert!(fault("base = 'auto'\nsearch = [1, 1]").contains("twice"));
        assert!(fault("base = 'auto'\ncriteria = ['new']").contains("\"new\""));
        let many = (0..7).map(|n| n.to_string()).collect::<Vec<_>>().join(",");
        assert!(
            fault(&format!("base = 'auto'\nsearch = [{many}]\nequal = [{many}]\nterritory = [{many}]")).contains("343")
        );
    }
}
