//! A few jobs of the adversary in `examples/attack`: nothing that is certified may be contradicted by measurement.

#[path = "../examples/attack/jobs.rs"]
mod jobs;
#[path = "../examples/attack/measure.rs"]
mod measure;
#[path = "../examples/attack/mutation.rs"]
mod mutation;
#[path = "../examples/attack/random.rs"]
mod random;
#[path = "../examples/attack/specimen.rs"]
mod specimen;

#[test]
fn nothing_certified_is_contradicted_by_measurement() {
    let (mut rows, mut random) = (jobs::Rows::new(), random::Random::new(3));
    for _ in 0..30 {
        // Specimens without a panel are no jobs.
        let _ = jobs::job(&mut random, &mut rows);
    }
    let mut total = jobs::Row::default();
    rows.values().for_each(|r| total.add(r));
    assert_eq!(total.violations, 0);
    assert!(total.certified > 3 && total.certified < total.tried && total.refuted > 0);
    assert!(total.nearest > 0.8 && total.nearest <= 1.0 + 1e-4, "{}", total.nearest);
}
