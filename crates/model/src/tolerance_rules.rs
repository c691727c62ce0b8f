//! The rules a tolerance set must meet for the blocks it is used with (SPEC section 3), compared exactly.
//!
//! [`check`] knows blocks alone; [`check_scene`] also knows what they weigh and how stiff their joints are.

mod along_faces;
mod column;
mod extremes;
mod fall;
mod hanging;
mod largest;
mod load;
mod load_sums;
mod places;
mod pressing;
mod properties;
mod pull;
mod remedy;
mod shape;
mod speed;
mod stiffness;
mod strain;
mod thin;
mod warning;

use extremes::Extremes;
pub use fall::{Fall, fall};
pub use load::weights_borne;
pub use remedy::BEYOND_F64;
use remedy::{RequiredValue, six_digits};
pub use stiffness::{check_scene, stiffness_slack};
pub use thin::{Thin, thin};
pub use warning::{Warning, WarningKind, warnings};

use crate::block::Block;
use crate::number::{Number, Precision};
use crate::tolerance::{Criteria, LAMBDA_INVERSE, ToleranceSet};
use crate::topology::VertexId;
use num_rational::BigRational;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A rule of SPEC section 3. ℓ is the shortest and L the longest edge, R the largest block radius, M the largest
/// coordinate magnitude, eps the precision in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Rule {
    /// `search ≥ 2·max_displacement`
    Search,
    /// `penetration ≥ max_displacement`
    Penetration,
    /// `territory ≤ search`
    TerritoryInSearch,
    /// `territory ≤ ℓ/4`
    TerritoryOnEdge,
    /// `territory ≥ 2⁸·eps·M`
    TerritoryResolved,
    /// `max_displacement ≤ ℓ/4`
    Displacement,
    /// `max_rotation²·R ≤ 2·penetration`
    Rotation,
    /// `parallel_sine·L ≤ territory`, under the classic criteria
    ParallelEdges,
    /// `overlap_sine·L ≤ penetration`, under the classic criteria
    Overlap,
    /// `W/(p·n) ≤ penetration`: W a block's weight, n the corners of its smallest face, p the softest normal stiffness
    /// that its joint material can meet
    Stiffness,
}

impl Rule {
    /// All rules, in order.
    pub const ALL: [Rule; 10] = [
        Rule::Search,
        Rule::Penetration,
        Rule::TerritoryInSearch,
        Rule::TerritoryOnEdge,
        Rule::TerritoryResolved,
        Rule::Displacement,
        Rule::Rotation,
        Rule::ParallelEdges,
        Rule::Overlap,
        Rule::Stiffness,
    ];

    /// The rule in a formula.
    pub fn formula(self) -> &'static str {
        match self {
            Rule::Search => "search ≥ 2·max_displacement",
            Rule::Penetration => "penetration ≥ max_displacement",
            Rule::TerritoryInSearch => "territory ≤ search",
            Rule::TerritoryOnEdge => "territory ≤ (shortest edge)/4",
            Rule::TerritoryResolved => "territory ≥ 2⁸·eps·(largest coordinate)",
            Rule::Displacement => "max_displacement ≤ (shortest edge)/4",
            Rule::Rotation => "max_rotation²·(block radius) ≤ 2·penetration",
            Rule::ParallelEdges => "parallel_sine·(longest edge) ≤ territory",
            Rule::Overlap => "overlap_sine·(longest edge) ≤ penetration",
            Rule::Stiffness => "(block weight)/(normal_stiffness·corners of its smallest face) ≤ penetration",
        }
    }

    /// Why the rule exists.
    pub fn reason(self) -> &'static str {
        match self {
            Rule::Search => "two blocks may each move max_displacement towards the other in one step",
            Rule::Penetration => "an overlap of one step must still be seen as a contact",
            Rule::TerritoryInSearch => "a vertex in a territory must be near enough to be a contact",
            Rule::TerritoryOnEdge => "territories of an edge's two ends must leave most of it free",
            Rule::TerritoryResolved => "rounding of the coordinates must not decide what lies in a territory",
            Rule::Displacement => "a vertex must not jump over a feature in one step",
            Rule::Rotation => "first-order kinematics swells a block by max_rotation²·radius/2",
            Rule::ParallelEdges => "edges taken for parallel must stay within the territory of one another",
            Rule::Overlap => "a corner let through at an angle must not be deeper than a contact is followed",
            Rule::Stiffness => "a block at rest on its smallest face must not sink deeper than a contact is followed",
        }
    }
}

/// Where the length that decides a rule is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LengthLocation {
    /// Index among the blocks given.
    pub block: usize,
    /// The ends of an edge, when it is an edge.
    pub edge: Option<(VertexId, VertexId)>,
}

impl fmt::Display for LengthLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.edge {
            Some((p, q)) => write!(f, "edge {p}-{q} of block {}", self.block),
            None => write!(f, "block {}", self.block),
        }
    }
}

/// A rule that a tolerance set does not meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The rule.
    pub rule: Rule,
    /// The left side of its formula.
    pub found: f64,
    /// The right side of its formula.
    pub allowed: f64,
    /// Where the deciding length is.
    pub place: Option<LengthLocation>,
    /// What would satisfy the rule.
    pub remedy: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let relation = if self.found < self.allowed { "below" } else { "above" };
        write!(f, "{}: {:.6e} is {relation} {:.6e}", self.rule.formula(), self.found, self.allowed)?;
        if let Some(place) = self.place {
            write!(f, " ({place})")?;
        }
        write!(f, "; satisfied by {}", self.remedy)
    }
}

/// How far a tolerance set is from breaking a rule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RuleSlack {
    /// The rule.
    pub rule: Rule,
    /// The side of its formula that must be the larger one over the other: 1 where the rule is just met, below 1 where it is not,
    /// infinite where the smaller side is 0. Within some ulps of the exact ratio.
    pub factor: f64,
}

/// What the rules need to know of some blocks, measured once for many sets.
pub struct MeasuredModel(Option<Extremes>);

impl MeasuredModel {
    /// Measures the blocks.
    pub fn of(blocks: &[&Block]) -> MeasuredModel {
        MeasuredModel(Extremes::of(blocks))
    }

    /// As [`check`].
    pub fn check(&self, set: &ToleranceSet, precision: Precision) -> Vec<Violation> {
        self.compare(set, precision).found
    }

    /// How far the set is from breaking each rule of [`check`] that concerns it, in the order of [`Rule`].
    pub fn slacks(&self, set: &ToleranceSet, precision: Precision) -> Vec<RuleSlack> {
        let mut slacks = self.compare(set, precision).slacks;
        // Nothing is asked where both sides are 0.
        slacks.iter_mut().filter(|slack| slack.factor.is_nan()).for_each(|slack| slack.factor = f64::INFINITY);
        slacks.sort_by_key(|slack| slack.rule);
        slacks
    }

    fn compare(&self, set: &ToleranceSet, precision: Precision) -> Violations {
        let mut violations = between(set);
        if let Some(extremes) = &self.0 {
            extremes.check(set, precision, &mut violations);
        }
        violations.found.sort_by_key(|v| v.rule);
        violations
    }
}

/// Every rule that `set` does not meet for these blocks in this precision, in the order of [`Rule`]; all comparisons
/// are exact. Without blocks, only the rules between tolerances.
pub fn check(set: &ToleranceSet, blocks: &[&Block], precision: Precision) -> Vec<Violation> {
    MeasuredModel::of(blocks).check(set, precision)
}

/// The rules between tolerances.
fn between(set: &ToleranceSet) -> Violations {
    let two = BigRational::from_integer(2.into());
    let [search, territory, penetration, displacement] =
        [&set.search, &set.territory, &set.penetration, &set.max_displacement].map(Number::to_rational);
    let mut violations = Violations::default();

    violations.require(
        Rule::Search,
        (&search, Relation::NotBelow, &(&displacement * &two)),
        None,
        &[
            ("search", RequiredValue::OrMore(&displacement * &two)),
            ("max_displacement", RequiredValue::OrLess(&search / &two)),
        ],
    );
    violations.require(
        Rule::Penetration,
        (&penetration, Relation::NotBelow, &displacement),
        None,
        &[
            ("penetration", RequiredValue::OrMore(displacement.clone())),
            ("max_displacement", RequiredValue::OrLess(penetration.clone())),
        ],
    );
    violations.require(
        Rule::TerritoryInSearch,
        (&territory, Relation::NotAbove, &search),
        None,
        &[("territory", RequiredValue::OrLess(search.clone())), ("search", RequiredValue::OrMore(territory.clone()))],
    );
    violations
}

/// How the sides of a rule must lie.
#[derive(Clone, Copy)]
enum Relation {
    NotBelow,
    NotAbove,
    /// Of two squares.
    SquareNotAbove,
}

#[derive(Default)]
struct Violations {
    found: Vec<Violation>,
    slacks: Vec<RuleSlack>,
}

impl Violations {
    fn require(
        &mut self,
        rule: Rule,
        (left, relation, right): (&BigRational, Relation, &BigRational),
        place: Option<LengthLocation>,
        remedies: &[(&str, RequiredValue)],
    ) {
        let near = |value: &BigRational| match (Number::from_rational(value.clone()).approximate(), relation) {
            (square, Relation::SquareNotAbove) => square.sqrt(),
            (value, _) => value,
        };
        let (found, allowed) = (near(left), near(right));
        let (factor, broken) = match relation {
            Relation::NotBelow => (found / allowed, left < right),
            Relation::NotAbove | Relation::SquareNotAbove => (allowed / found, left > right),
        };
        self.slacks.push(RuleSlack { rule, factor });
        if broken {
            let remedy = remedies.iter().map(|(name, bound)| bound.text(name)).collect::<Vec<_>>().join(" or ");
            self.found.push(Violation { rule, found, allowed, place, remedy });
        }
    }
}

impl Extremes {
    fn check(&self, set: &ToleranceSet, precision: Precision, violations: &mut Violations) {
        let squared = |n: &Number| {
            let value = n.to_rational();
            &value * &value
        };
        let lambda_squared = BigRational::new(1.into(), (LAMBDA_INVERSE * LAMBDA_INVERSE).into());
        let quarter = &self.shortest_squared * lambda_squared;
        let territory = set.territory.to_rational();
        violations.require(
            Rule::TerritoryOnEdge,
            (&squared(&set.territory), Relation::SquareNotAbove, &quarter),
            Some(self.shortest),
            &[("territory", RequiredValue::RootOrLess(quarter.clone()))],
        );
        let eps = Number::from_f64(256.0 * precision.epsilon()).unwrap_or(Number::ZERO).to_rational();
        let resolved = &eps * &self.largest_coordinate;
        let remedies = [
            ("territory", RequiredValue::OrMore(resolved.clone())),
            ("all coordinates", RequiredValue::OrLess(&territory / &eps)),
            // No block has all of its coordinates 0, so a territory of 0 has to be changed with them.
            (
                "territory ≥ 2⁸·eps·(largest coordinate) and all coordinates",
                RequiredValue::RootOrLess(&quarter / (&eps * &eps)),
            ),
        ];
        // A territory that the shortest edge does not allow would break another rule.
        let is_too_coarse = &resolved * &resolved > quarter;
        let possible = match (set.territory.is_zero(), is_too_coarse) {
            (true, false) => &remedies[..1],
            (true, true) => &remedies[2..],
            (false, _) => &remedies[usize::from(is_too_coarse)..2],
        };
        violations.require(
            Rule::TerritoryResolved,
            (&territory, Relation::NotBelow, &resolved),
            Some(self.furthest),
            possible,
        );
        violations.require(
            Rule::Displacement,
            (&squared(&set.max_displacement), Relation::SquareNotAbove, &quarter),
            Some(self.shortest),
            &[("max_displacement", RequiredValue::RootOrLess(quarter.clone()))],
        );
        self.check_rotation(set, violations);
        if set.criteria == Criteria::Classic {
            let territory_squared = squared(&set.territory);
            let parallel = squared(&set.parallel_sine) * &self.longest_squared;
            violations.require(
                Rule::ParallelEdges,
                (&parallel, Relation::SquareNotAbove, &territory_squared),
                Some(self.longest),
                &[
                    ("parallel_sine", RequiredValue::RootOrLess(&territory_squared / &self.longest_squared)),
                    ("territory", RequiredValue::RootOrMore(parallel.clone())),
                ],
            );
            let penetration_squared = squared(&set.penetration);
            let overlap = squared(&set.overlap_sine) * &self.longest_squared;
            violations.require(
                Rule::Overlap,
                (&overlap, Relation::SquareNotAbove, &penetration_squared),
                Some(self.longest),
                &[
                    ("overlap_sine", RequiredValue::RootOrLess(&penetration_squared / &self.longest_squared)),
                    ("penetration", RequiredValue::RootOrMore(overlap.clone())),
                ],
            );
        }
    }

    /// ω²·R ≤ 2g as ω⁴·R² ≤ 4g².
    fn check_rotation(&self, set: &ToleranceSet, violations: &mut Violations) {
        let rotation = set.max_rotation.to_rational().pow(2);
        let twice = set.penetration.to_rational() * BigRational::from_integer(2.into());
        let swelling_squared = &rotation * &rotation * &self.radius_squared;
        let near = |value: &BigRational| Number::from_rational(value.clone()).approximate();
        let swelling = near(&swelling_squared).sqrt();
        violations.slacks.push(RuleSlack { rule: Rule::Rotation, factor: near(&twice) / swelling });
        if swelling_squared > &twice * &twice {
            // Six digits on the safe side leave room for the two roots taken here.
            let largest = (near(&twice) / near(&self.radius_squared).sqrt()).sqrt();
            let remedy = format!(
                "max_rotation ≤ {} or penetration ≥ {}",
                six_digits(largest, false, false),
                six_digits(swelling / 2.0, true, false)
            );
            let (found, allowed) = (swelling, near(&twice));
            violations.found.push(Violation { rule: Rule::Rotation, found, allowed, place: Some(self.widest), remedy });
        }
    }
}
