//! Operations on vectors that are slices.

/// Calls `each` with the numbers of all components, up to three without a loop: for so few a loop costs more than the
/// work in it.
#[inline(always)]
pub(crate) fn for_each(components: usize, mut each: impl FnMut(usize)) {
    if components > 3 {
        return (0..components).for_each(each);
    }
    for i in 0..3 {
        if i < components {
            each(i);
        }
    }
}

/// `to ← from`, both of the same length.
#[inline(always)]
pub(crate) fn copy(from: &[f64], to: &mut [f64]) {
    if from.len() > 3 {
        return to.copy_from_slice(from);
    }
    let to = &mut to[..from.len()];
    for_each(from.len(), |i| to[i] = from[i]);
}

/// `out ← x + factor y` as far as all of them go.
#[inline(always)]
pub(crate) fn combine(x: &[f64], factor: f64, y: &[f64], out: &mut [f64]) {
    let n = out.len().min(x.len()).min(y.len());
    let (x, y, out) = (&x[..n], &y[..n], &mut out[..n]);
    for_each(n, |i| out[i] = x[i] + factor * y[i]);
}

/// The largest size of a component.
#[inline]
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// `target += factor values`.
#[inline]
pub(crate) fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    for (t, v) in target.iter_mut().zip(values) {
        *t += factor * v;
    }
}

/// The scalar product.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The length of a vector.
pub(crate) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
