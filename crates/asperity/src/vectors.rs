//! Operations on vectors that are slices.

/// Work with slices of a length `n`, of which that up to three is compiled for each of them: for so few a loop, and a
/// look at the end of every slice, cost more than the work. Slices are cut to `..n` in it.
macro_rules! unrolled {
    ($n:ident = $len:expr => $work:expr) => {{
        let $n: usize = $len;
        match $n {
            1 => {
                let $n = 1;
                $work
            }
            2 => {
                let $n = 2;
                $work
            }
            3 => {
                let $n = 3;
                $work
            }
            _ => $work,
        }
    }};
}
pub(crate) use unrolled;

/// Prefetches the values `ahead` of the first one of a long list that is read once: the processor itself begins too late.
#[inline(always)]
pub(crate) fn prefetch(values: &[f64], ahead: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(sse) = pulp::core_arch::x86::Sse::try_new() {
        use std::arch::x86_64::_MM_HINT_T0;
        sse._mm_prefetch::<_MM_HINT_T0>(values.as_ptr().wrapping_add(ahead).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, ahead);
}

/// The sum of terms of two long vectors, in eight partial sums that processors add side by side.
#[inline(always)]
pub(crate) fn sum_in_lanes(a: &[f64], b: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    const LANES: usize = 8;
    let ((a, a_left), (b, b_left)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += term(*a, *b);
        }
    }
    let rest: f64 = a_left.iter().zip(b_left).map(|(a, b)| term(*a, *b)).sum();
    sums.iter().sum::<f64>() + rest
}

/// `to ← from`, both of the same length.
#[inline(always)]
pub(crate) fn copy(from: &[f64], to: &mut [f64]) {
    unrolled!(n = from.len() => to[..n].copy_from_slice(&from[..n]));
}

/// `out ← x + factor y`, with as many components as `y` has.
#[inline(always)]
pub(crate) fn combine(x: &[f64], factor: f64, y: &[f64], out: &mut [f64]) {
    let n = y.len();
    let (x, out) = (&x[..n], &mut out[..n]);
    for i in 0..n {
        out[i] = x[i] + factor * y[i];
    }
}

/// Whether all are numbers and none is infinite: zero times anything else is not a number.
#[inline(always)]
pub(crate) fn are_finite(values: &[f64]) -> bool {
    unrolled!(n = values.len() => values[..n].iter().fold(0.0, |sum, v| sum + 0.0 * v) == 0.0)
}

/// The square of the length of a vector.
#[inline(always)]
pub(crate) fn square(values: &[f64]) -> f64 {
    unrolled!(n = values.len() => values[..n].iter().fold(0.0, |sum, v| sum + v * v))
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
