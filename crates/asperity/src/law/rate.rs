//! Friction that depends on the speed of sliding.

use asperity_set::SetError;

/// How the rest of the friction falls from its value at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fall {
    /// `s(x) = e^−x`.
    Exponential,
    /// `s(x) = 1/(1 + x)`.
    Hyperbolic,
}

/// Stribeck characteristic: a factor of the friction force,
/// `f(v) = ratio + (1 − ratio) s((v/speed)^exponent) + viscous·v`, one at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stribeck {
    fall: Fall,
    speed: f64,
    ratio: f64,
    exponent: f64,
    viscous: f64,
}

impl Stribeck {
    /// The characteristic with `speed > 0` in m/s, `ratio ≥ 0`, `exponent > 0` and `viscous ≥ 0` in s/m.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if a number is out of its range or not finite.
    pub fn new(
        fall: Fall,
        speed: f64,
        ratio: f64,
        exponent: f64,
        viscous: f64,
    ) -> Result<Self, SetError> {
        let check = |argument, value: f64, positive: bool| {
            if value.is_finite() && (value > 0.0 || !positive && value == 0.0) {
                return Ok(());
            }
            let allowed = if positive { "finite and positive" } else { "finite and not negative" };
            Err(SetError::Parameter { argument, allowed, value })
        };
        check("speed", speed, true)?;
        check("ratio", ratio, false)?;
        check("exponent", exponent, true)?;
        check("viscous", viscous, false)?;
        Ok(Self { fall, speed, ratio, exponent, viscous })
    }

    /// How the rest of the friction falls.
    pub fn fall(&self) -> Fall {
        self.fall
    }

    /// Friction at high speed over that at rest, without the viscous part.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Exponent of the speed.
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Viscous part in s/m.
    pub fn viscous(&self) -> f64 {
        self.viscous
    }

    /// Speed in m/s over which the friction falls.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// `f(v)` at the speed `v ≥ 0` in m/s.
    pub fn factor(&self, v: f64) -> f64 {
        self.dry(v) + self.viscous * v
    }

    /// `f(v)` without the viscous part.
    fn dry(&self, v: f64) -> f64 {
        let x = (v / self.speed).powf(self.exponent);
        let rest = match self.fall {
            Fall::Exponential => (-x).exp(),
            Fall::Hyperbolic => 1.0 / (1.0 + x),
        };
        self.ratio + (1.0 - self.ratio) * rest
    }

    /// Whether `f` has a part that rises with the speed.
    pub fn rises(&self) -> bool {
        self.viscous > 0.0 || self.ratio > 1.0
    }

    /// The part of `f` that never rises: `f(v)` is its sum with [`rising`](Self::rising).
    pub fn falling(&self, v: f64) -> f64 {
        if self.ratio > 1.0 { 1.0 } else { self.dry(v) }
    }

    /// The part of `f` that never falls, zero at rest.
    pub fn rising(&self, v: f64) -> f64 {
        let dry = if self.ratio > 1.0 { self.dry(v) - 1.0 } else { 0.0 };
        dry + self.viscous * v
    }

    /// The slope of the part that never falls, at `v > 0`.
    pub fn rising_slope(&self, v: f64) -> f64 {
        if self.ratio > 1.0 { self.slope(v) } else { self.viscous }
    }

    /// `f′(v)` at `v > 0`.
    pub fn slope(&self, v: f64) -> f64 {
        let x = (v / self.speed).powf(self.exponent);
        // x s′(x), which vanishes for very large x.
        let steepness = match self.fall {
            Fall::Exponential if x > 1e3 => 0.0,
            Fall::Exponential => -x * (-x).exp(),
            Fall::Hyperbolic => {
                let rest = 1.0 / (1.0 + x);
                -rest * (1.0 - rest)
            }
        };
        (1.0 - self.ratio) * steepness * self.exponent / v + self.viscous
    }
}
