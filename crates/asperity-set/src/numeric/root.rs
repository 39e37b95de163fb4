//! Zeros of functions of one variable.

/// A function value, where it was taken and what came with it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample<T> {
    pub(crate) at: f64,
    pub(crate) value: f64,
    pub(crate) data: T,
}

/// Two samples with different signs, and the sample with the smallest value seen so far.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bracket<T> {
    pub(crate) a: Sample<T>,
    pub(crate) b: Sample<T>,
    pub(crate) best: Sample<T>,
}

impl<T: Copy> Bracket<T> {
    pub(crate) fn new(a: Sample<T>, b: Sample<T>) -> Self {
        Self { a, b, best: if a.value.abs() <= b.value.abs() { a } else { b } }
    }

    /// Chandrupatla's method (inverse quadratic interpolation, bisection where that is not safe) until
    /// `|f| ≤ tolerance` or the bracket is `width` wide.
    pub(crate) fn refine(
        &mut self,
        tolerance: f64,
        width: f64,
        mut f: impl FnMut(f64) -> (f64, T),
    ) {
        let mut weight = 0.5;
        while f64::abs(self.b.at - self.a.at) > width && self.best.value.abs() > tolerance {
            let (a, b) = (self.a, self.b);
            let at = a.at + weight * (b.at - a.at);
            let (value, data) = f(at);
            let new = Sample { at, value, data };
            let last = if (value > 0.0) == (a.value > 0.0) {
                a
            } else {
                self.b = a;
                b
            };
            self.a = new;
            if value.abs() < self.best.value.abs() {
                self.best = new;
            }
            weight = next_weight(&self.a, &self.b, &last);
        }
    }
}

/// Where to look next between `a`, the newest sample, and `b`, of the other sign; `c` is the one before.
fn next_weight<T>(a: &Sample<T>, b: &Sample<T>, c: &Sample<T>) -> f64 {
    let (fa, fb, fc) = (a.value, b.value, c.value);
    let (xi, phi) = ((a.at - b.at) / (c.at - b.at), (fa - fb) / (fc - fb));
    let margin = f64::min(0.5, 0.5 * f64::EPSILON / f64::abs(b.at - a.at));
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        let quadratic = fa / (fb - fa) * (fc / (fb - fc))
            + (c.at - a.at) / (b.at - a.at) * (fa / (fc - fa)) * (fb / (fc - fb));
        quadratic.clamp(margin, 1.0 - margin)
    } else {
        0.5
    }
}
