fn main() {
    for case in rockproof_validation::cases::<rockproof::stepper::contact::Spec>() {
        let begun = std::time::Instant::now();
        let show = |m: &Result<rockproof_validation::Measured, _>| match m {
            Ok(m) => format!("{:.2e} [{}]", m.error, m.seen),
            Err::<_, rockproof_validation::Failure>(e) => format!("failed: {e}"),
        };
        let f64 = case.f64();
        let verdict = if f64.as_ref().is_ok_and(|m| case.holds(m)) { "ok" } else { "MISSED" };
        println!("{:<60} {:?} {} {verdict} | {} | {:.2} s", case.name, case.bound, show(&f64), show(&case.f32()), begun.elapsed().as_secs_f64());
    }
}
