//! Sets from forces over directions: what is read from the curve at its samples.

use super::*;

/// Heights of the hull of places around the origin are those of the farthest place along every normal, whatever
/// places are dented, repeat each other or come first.
#[test]
fn heights_are_those_of_the_farthest_places() {
    let mut seed = 3_u64;
    let mut unit = || 0.5 * (crate::random::random(&mut seed) + 1.0);
    for count in [3, 5, 8, 40, 300] {
        for dent in [0.0, 1e-9, 1e-3, 0.3] {
            let turn = TAU * unit();
            let mut places: Vec<Vector<2>> = Vec::new();
            for k in 0..count {
                let (sine, cosine) = (turn + TAU * f64::from(k) / f64::from(count)).sin_cos();
                let place = Vector::<2>::new(3.0 * cosine, sine) * (1.0 - dent * unit());
                places.extend(std::iter::repeat_n(place, 1 + usize::from(k % 4 == 1)));
            }
            let normals: Vec<Vector<2>> = (0..97)
                .map(|k| TAU * (f64::from(k) + 0.5 * unit()) / 97.0)
                .map(|angle| Vector::<2>::new(angle.cos(), angle.sin()))
                .collect();
            for (normal, height) in normals.iter().zip(hull_heights(&normals, &places)) {
                let farthest = places.iter().map(|x| normal.dot(x)).fold(0.0, f64::max);
                assert!((height - farthest).abs() < 1e-13, "{count} {dent}: {height} {farthest}");
            }
        }
    }
}
