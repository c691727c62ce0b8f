//! Shares with their uncertainty.

/// The 97.5 % point of the normal distribution: a 95 % interval.
const Z: f64 = 1.959_963_984_540_054;

/// A share of something counted, with Wilson's 95 % interval (E. B. Wilson, Probable inference, the law of succession, and
/// statistical inference, 1927).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proportion {
    /// The share, 0 to 1.
    pub value: f64,
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Proportion {
    /// `hits` of `trials`, where so many trials tell as much as `effective` independent ones. `None` without trials.
    pub fn of(hits: u64, trials: u64, effective: f64) -> Option<Proportion> {
        if trials == 0 || hits > trials {
            return None;
        }
        let (value, n) = (hits as f64 / trials as f64, effective.clamp(1.0, trials as f64));
        let scale = 1.0 + Z * Z / n;
        let middle = (value + Z * Z / (2.0 * n)) / scale;
        let half = Z * (value * (1.0 - value) / n + Z * Z / (4.0 * n * n)).sqrt() / scale;
        // The ends are exact where nothing or everything hit; rounding must not move them past the share.
        let low = if hits == 0 { 0.0 } else { (middle - half).clamp(0.0, value) };
        let high = if hits == trials { 1.0 } else { (middle + half).clamp(value, 1.0) };
        Some(Proportion { value, low, high })
    }
}

/// The ends of [`Proportion`]'s interval for `hits` of as many independent `trials`; 0 and 1 without trials.
pub fn wilson(hits: u64, trials: u64) -> [f64; 2] {
    Proportion::of(hits, trials, trials as f64).map_or([0.0, 1.0], |share| [share.low, share.high])
}

/// The chance of a share that is not above a limit to be taken for one that is, on one side of a 95 % interval.
const ONE_SIDED: f64 = 0.025;

/// Whether `hits` of as many independent `trials` prove a share above `limit`: so many or more come by chance in at most 2.5 % of all cases where the
/// share is the limit itself (the binomial tail, exactly).
pub fn is_above(hits: u64, trials: u64, limit: f64) -> bool {
    if hits as f64 <= limit * trials as f64 {
        return false;
    }
    // Terms as logarithms, since the first may be below what f64 holds.
    let (mut term, odds) = (trials as f64 * (-limit).ln_1p(), limit.ln() - (-limit).ln_1p());
    let mut fewer = 0.0;
    for k in 0..hits {
        fewer += term.exp();
        term += ((trials - k) as f64 / (k + 1) as f64).ln() + odds;
    }
    1.0 - fewer <= ONE_SIDED
}

/// How many independent trials would tell a share from `limit` if it stays `hits` of `trials`: for a smaller one Wilson's upper end comes down to the limit
/// with z²·l·(1 − l)/(p − l)² of them, a larger one is proven ([`is_above`]) by a multiple of the trials or by so many. `None` where the two are so near
/// that a billion are not enough.
pub fn trials_to_tell(hits: u64, trials: u64, limit: f64) -> Option<u64> {
    let share = hits as f64 / trials.max(1) as f64;
    let needed = Z * Z * limit * (1.0 - limit) / (share - limit).powi(2);
    if !needed.is_finite() || needed >= 1e9 {
        return None;
    }
    let needed = needed.ceil() as u64;
    if share < limit {
        return Some(needed);
    }
    // The exact tail asks for a little more than the interval does: a hundredth where there are ten thousand hits.
    let first = (needed / trials).max(1);
    if first.saturating_mul(hits) > 10_000 {
        return Some(needed);
    }
    (first..).find(|k| is_above(k * hits, k * trials, limit)).map(|k| k * trials)
}

/// Sums over batches of trials that hang together: a hits among n trials of each batch.
#[derive(Clone, Copy, Debug)]
pub struct ClusterSums {
    /// Σ a².
    pub hits_squared: u64,
    /// Σ a·n.
    pub hits_times_trials: u64,
    /// Σ n².
    pub trials_squared: u64,
}

impl ClusterSums {
    /// How many independent trials tell as much: trials over the design effect, which is the variance of the share
    /// between batches over that of independent trials (L. Kish, Survey sampling, 1965, section 8.2).
    pub fn effective(&self, hits: u64, trials: u64) -> f64 {
        let n = trials as f64;
        let p = hits as f64 / n.max(1.0);
        let between =
            self.hits_squared as f64 - 2.0 * p * self.hits_times_trials as f64 + p * p * self.trials_squared as f64;
        let alone = p * (1.0 - p) * n;
        if alone > 0.0 { n / (between / alone).max(1.0) } else { n }
    }
}

#[cfg(test)]
mod tests {
    use super::{ClusterSums, Proportion, is_above, trials_to_tell, wilson};

    #[test]
    fn wilson_as_in_the_literature() {
        // R. G. Newcombe, Two-sided confidence intervals for the single proportion, 1998, table I.
        for (hits, trials, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let share = Proportion::of(hits, trials, trials as f64).expect("trials");
            assert!((share.low - low).abs() < 5e-5 && (share.high - high).abs() < 5e-5, "{share:?}");
        }
        assert_eq!(Proportion::of(0, 0, 0.0), None);
        let all = Proportion::of(7, 7, 7.0).expect("trials");
        assert_eq!((all.value, all.high), (1.0, 1.0));
    }

    #[test]
    fn ends_are_those_of_the_textbook() {
        // A. Agresti and B. A. Coull (1998), and the closed form z²/(n + z²) for none.
        let [low, high] = wilson(0, 1024);
        assert!(low == 0.0 && (high - 0.003_737_4).abs() < 1e-6, "{high}");
        let [low, high] = wilson(1, 10);
        assert!((low - 0.017_876).abs() < 1e-5 && (high - 0.404_150).abs() < 1e-5, "{low} {high}");
        assert_eq!(wilson(0, 0), [0.0, 1.0]);
        assert_eq!(wilson(7, 7)[1], 1.0);
    }

    #[test]
    fn so_many_trials_tell_and_one_less_does_not() {
        let none = trials_to_tell(0, 16, 0.01).expect("a count");
        assert_eq!(none, 381);
        assert!(wilson(0, none)[1] <= 0.01 && wilson(0, none - 1)[1] > 0.01);
        // A share of 1/20, which is above the limit: the lower end passes it.
        let some = trials_to_tell(1, 20, 0.01).expect("a count");
        assert!(is_above(some / 20, some, 0.01) && !is_above(some / 20 - 1, some - 20, 0.01), "{some}");
        // One a little above it, which takes many: the exact tail asks for a twentieth more than the interval.
        let many = trials_to_tell(1, 90, 0.01).expect("a count");
        assert!(is_above(many / 90, many, 0.01) && !is_above(many / 90 - 1, many - 90, 0.01), "{many}");
        assert!((30_000..36_000).contains(&many), "{many}");
        assert_eq!(trials_to_tell(1, 100, 0.01), None);
    }

    #[test]
    fn a_share_is_above_a_limit_where_chance_hardly_makes_it() {
        // 1 − 0.99¹⁶ is 14.9 %, and less 16·0.01·0.99¹⁵ it is 1.1 %.
        assert!(!is_above(1, 16, 0.01) && is_above(2, 16, 0.01));
        // 0.01¹ itself, and 1 of 2.
        assert!(is_above(1, 1, 0.01) && is_above(1, 2, 0.01) && !is_above(1, 3, 0.01));
        assert!(!is_above(0, 0, 0.01) && !is_above(1_000, 100_000, 0.01) && is_above(1_100, 100_000, 0.01));
        assert!(is_above(100_000, 100_000, 0.01));
    }

    #[test]
    fn pairs_that_differ_together_count_as_one() {
        // Ten batches of four, all or nothing: as much as ten trials.
        let clusters = ClusterSums { hits_squared: 5 * 16, hits_times_trials: 5 * 16, trials_squared: 10 * 16 };
        assert!((clusters.effective(20, 40) - 10.0).abs() < 1e-12);
        // Batches of one are independent.
        let single = ClusterSums { hits_squared: 5, hits_times_trials: 5, trials_squared: 10 };
        assert!((single.effective(5, 10) - 10.0).abs() < 1e-12);
    }
}
