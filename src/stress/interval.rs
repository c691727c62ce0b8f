//! How well a share is known.

/// The 95 % interval of a share by the score method (E. B. Wilson, 1927): `found` of `of`. The whole range for none.
pub fn wilson(found: u64, of: u64) -> [f64; 2] {
    if of == 0 {
        return [0.0, 1.0];
    }
    const Z: f64 = 1.959_963_984_540_054;
    let (n, p) = (of as f64, found as f64 / of as f64);
    let (centre, by) = (p + Z * Z / (2.0 * n), 1.0 + Z * Z / n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    // None and all have bounds of their own, which rounding may miss.
    let low = if found == 0 { 0.0 } else { (centre - half) / by };
    let high = if found >= of { 1.0 } else { (centre + half) / by };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::wilson;

    #[test]
    fn is_that_of_the_textbook() {
        // A. Agresti and B. A. Coull (1998), and the closed form z²/(n + z²) for none.
        let [low, high] = wilson(0, 1024);
        assert!(low == 0.0 && (high - 0.003_737_4).abs() < 1e-6, "{high}");
        let [low, high] = wilson(1, 10);
        assert!((low - 0.017_876).abs() < 1e-5 && (high - 0.404_150).abs() < 1e-5, "{low} {high}");
        assert_eq!(wilson(0, 0), [0.0, 1.0]);
        assert_eq!(wilson(7, 7)[1], 1.0);
    }
}
