//! What is found of a limit, and whether it is more than chance.

use statrs::function::beta::checked_beta_reg;

/// What is found of a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitCount {
    /// Findings.
    pub findings: u64,
    /// Pairs with such a finding.
    pub pairs: u64,
    /// Pairs examined; of passages and unseen overlaps those whose steps were looked through.
    pub examined: u64,
    /// How much less than independent pairs they tell: 1 for independent ones.
    pub design_effect: f64,
}

impl LimitCount {
    /// The share of pairs with such a finding.
    pub fn rate(&self) -> f64 {
        if self.examined == 0 { 0.0 } else { self.pairs as f64 / self.examined as f64 }
    }

    /// Whether the share is above `rate`, and that is no chance.
    pub fn exceeds(&self, rate: f64, confidence: f64) -> bool {
        self.rate() > rate && self.chance(rate) < 1.0 - confidence
    }

    /// How many of these pairs at least must have such a finding before their share [exceeds](LimitCount::exceeds) `rate`, where they hang together as
    /// those found do; `None` where not even all of them would be enough.
    pub fn fails_from(&self, rate: f64, confidence: f64) -> Option<u64> {
        let fails = |pairs: u64| LimitCount { pairs, ..*self }.exceeds(rate, confidence);
        if !fails(self.examined) {
            return None;
        }
        let (mut passing, mut failing) = (0, self.examined);
        while failing - passing > 1 {
            let between = passing + (failing - passing) / 2;
            if fails(between) { failing = between } else { passing = between }
        }
        Some(failing)
    }

    /// How likely it is to find as many or more by chance where the true share is `rate`: the exact binomial tail (Clopper
    /// and Pearson 1934). The sixteen pairs of a batch share a base and are not independent, so pairs found and examined are
    /// first divided by the design effect (Korn and Graubard 1998), which for rare findings is Σx²/Σx over the batches.
    pub fn chance(&self, rate: f64) -> f64 {
        let (found, examined) = (self.pairs as f64 / self.design_effect, self.examined as f64 / self.design_effect);
        if self.pairs == 0 || rate >= 1.0 {
            return 1.0;
        }
        if rate <= 0.0 {
            return 0.0;
        }
        checked_beta_reg(found, (examined - found + 1.0).max(1.0), rate).unwrap_or(1.0)
    }
}
