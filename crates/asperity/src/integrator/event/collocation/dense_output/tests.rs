//! The dense output against a polynomial of its degree.

use super::*;

#[test]
fn polynomials_of_degree_eleven_are_kept() {
    let p = |t: f64, k: i32| {
        [t.powi(k), f64::from(k) * t.powi(k - 1), f64::from(k * (k - 1)) * t.powi(k - 2)]
    };
    for k in 2..=11 {
        let mut dense = DenseOutput::new(1);
        let [q0, u0, a0] = p(0.5, k).map(|v| [v]);
        let start = State { t: 0.5, q: q0.to_vec(), u: u0.to_vec() };
        dense.begin(&start, 0.75, &a0);
        for i in 1..PLACES {
            let [q, u, a] = p(0.5 + 0.75 * place(3 * i), k).map(|v| [v]);
            dense.set_conditions(i, |_| q[0] - q0[0], &u, &a);
        }
        dense.finish();
        let mut state = State { t: 0.0, q: vec![0.0], u: vec![0.0] };
        for t in [0.5, 0.6, 0.9, 1.2, 1.25] {
            dense.at(t, &mut state);
            let [q, u, _] = p(t, k);
            assert!((state.q[0] - q).abs() < 1e-12 * q.max(1.0), "{k} {t}");
            assert!((state.u[0] - u).abs() < 1e-11 * u.max(1.0), "{k} {t}");
        }
    }
}
