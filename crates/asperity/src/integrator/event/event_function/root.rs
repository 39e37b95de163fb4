//! Zeros of functions of the time.
//!
//! Every value costs a step of the integration and may not be found, and the last one has to be that of the result. The
//! zeros of the sets' boundaries (`asperity-set`) know neither.

/// A value of a function.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Value {
    pub(crate) at: f64,
    pub(crate) value: f64,
}

/// The zero of `f` between `low`, where it is not positive, and `high`, where it is, by Illinois' method with
/// bisections. The last argument of `f` is the result. Arguments whose bracket is `width` wide count as found.
pub(crate) fn zero<E>(
    mut low: Value,
    mut high: Value,
    width: f64,
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let mut at = high.at;
    let mut side = 0;
    for iteration in 0..100 {
        if low.value == 0.0 {
            f(low.at)?;
            return Ok(low.at);
        }
        let bracket = high.at - low.at;
        let secant = low.at + bracket * (-low.value / (high.value - low.value));
        // Every fourth time, lest one end stays where it is.
        let bisects = iteration % 4 == 3 || !secant.is_finite();
        let next = if bisects { 0.5 * (low.at + high.at) } else { secant };
        if (next - at).abs() <= width || bracket <= width {
            f(next)?;
            return Ok(next);
        }
        at = next;
        let value = f(at)?;
        if value > 0.0 {
            high = Value { at, value };
            if side == 1 {
                low.value *= 0.5;
            }
            side = 1;
        } else {
            low = Value { at, value };
            if side == -1 {
                high.value *= 0.5;
            }
            side = -1;
        }
    }
    Ok(at)
}
