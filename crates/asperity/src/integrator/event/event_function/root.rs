//! Zeros of functions of the time.
//!
//! Every value costs a step of the integration and may not be found, and the last one has to be that of the result. The
//! zeros of the sets' boundaries (`asperity-set`) know neither.

/// The zero of `f` between `low`, where it is not positive, and `high`, where it is, by Illinois' method with
/// bisections. The last argument of `f` is the result. Arguments whose bracket is `width` wide count as found.
pub(crate) fn zero<E>(
    (mut low, mut f_low): (f64, f64),
    (mut high, mut f_high): (f64, f64),
    width: f64,
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let mut at = high;
    let mut side = 0;
    for iteration in 0..100 {
        if f_low == 0.0 {
            f(low)?;
            return Ok(low);
        }
        let secant = low + (high - low) * (-f_low / (f_high - f_low));
        // Every fourth time, lest one end stays where it is.
        let next =
            if iteration % 4 == 3 || !secant.is_finite() { 0.5 * (low + high) } else { secant };
        if (next - at).abs() <= width || high - low <= width {
            f(next)?;
            return Ok(next);
        }
        at = next;
        let value = f(at)?;
        if value > 0.0 {
            (high, f_high) = (at, value);
            if side == 1 {
                f_low *= 0.5;
            }
            side = 1;
        } else {
            (low, f_low) = (at, value);
            if side == -1 {
                f_high *= 0.5;
            }
            side = -1;
        }
    }
    Ok(at)
}
