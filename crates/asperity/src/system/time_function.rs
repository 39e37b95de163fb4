//! Values that may depend on time: constant, a signal, or a function of the user.

use std::fmt;
use std::sync::Arc;

use super::signal::{Break, Derivative, Moment, Signal};
use crate::argument::{ArgumentError, finite, refuse};

/// A function of the time in s.
pub type Function<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;
/// A function of the time in s that returns its value and its rate.
pub type FunctionWithRate<const D: usize> = Arc<dyn Fn(f64) -> [[f64; D]; 2] + Send + Sync>;

/// Zero, and three times per factor of ten up to `t_end`.
pub(crate) fn sample_times(t_end: f64) -> impl Iterator<Item = f64> {
    let later = (0..100).rev().map(move |k| t_end * 10f64.powf(-f64::from(k) / 3.0));
    std::iter::once(0.0).chain(later)
}

/// How large a function of time becomes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Extent {
    /// Its largest part.
    pub(super) size: f64,
    /// A time at which it has reached at least half of this size, and what it was then.
    since: f64,
    half: f64,
}

impl Extent {
    /// Takes a sample into account; samples ascend in time.
    pub(super) fn include(&mut self, t: f64, value: f64) {
        if !(value.is_finite() && value.abs() > self.size) {
            return;
        }
        if value.abs() > 2.0 * self.half {
            (self.since, self.half) = (t, value.abs());
        }
        self.size = value.abs();
    }

    /// What its integral is at most up to the time at which it has reached half of its size.
    pub(super) fn reach(&self) -> f64 {
        self.since * self.size
    }
}

/// `D` numbers as a function of time. Functions of the user are taken for smooth.
#[derive(Clone)]
#[non_exhaustive]
pub enum TimeFunction<const D: usize> {
    /// The same at all times.
    Constant([f64; D]),
    /// A signal of `D` components.
    Signal(Arc<Signal>),
    /// A function of the user.
    Custom(Function<D>),
    /// A function of the user that knows its rate.
    WithRate(FunctionWithRate<D>),
}

impl<const D: usize> From<[f64; D]> for TimeFunction<D> {
    fn from(value: [f64; D]) -> Self {
        Self::Constant(value)
    }
}

impl From<f64> for TimeFunction<1> {
    fn from(value: f64) -> Self {
        Self::Constant([value])
    }
}

impl<const D: usize> From<Signal> for TimeFunction<D> {
    fn from(signal: Signal) -> Self {
        Self::Signal(Arc::new(signal))
    }
}

impl<const D: usize> fmt::Debug for TimeFunction<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(value) => f.debug_tuple("Constant").field(value).finish(),
            Self::Signal(signal) => f.debug_tuple("Signal").field(signal).finish(),
            Self::Custom(_) => f.write_str("Custom(..)"),
            Self::WithRate(_) => f.write_str("WithRate(..)"),
        }
    }
}

impl<const D: usize> PartialEq for TimeFunction<D> {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (Self::Signal(a), Self::Signal(b)) => a == b,
            (Self::Custom(a), Self::Custom(b)) => Arc::ptr_eq(a, b),
            (Self::WithRate(a), Self::WithRate(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl<const D: usize> TimeFunction<D> {
    /// The constant zero.
    pub const ZERO: Self = Self::Constant([0.0; D]);

    /// Its value where it is constant.
    pub fn constant(&self) -> Option<[f64; D]> {
        match self {
            Self::Constant(value) => Some(*value),
            _ => None,
        }
    }

    /// Its value.
    #[inline]
    pub fn value(&self, at: Moment) -> [f64; D] {
        match self {
            Self::Constant(value) => *value,
            Self::Signal(signal) => {
                std::array::from_fn(|k| signal.component(at, k, Derivative::Value))
            }
            Self::Custom(function) => function(at.t),
            Self::WithRate(function) => function(at.t)[0],
        }
    }

    /// Its integral from one time to another one: of a function of the user by Simpson's rule, for short times.
    pub(super) fn integral(&self, from: f64, to: f64) -> [f64; D] {
        match self {
            Self::Constant(value) => value.map(|value| value * (to - from)),
            Self::Signal(signal) => std::array::from_fn(|k| signal.integral(from, to, k)),
            Self::Custom(_) | Self::WithRate(_) => {
                let middle = 0.5 * (from + to);
                let [a, b, c] = [from, middle, to].map(|t| self.value(Moment::new(t)));
                std::array::from_fn(|k| (to - from) / 6.0 * (a[k] + 4.0 * b[k] + c[k]))
            }
        }
    }

    /// Its value and its rate; the latter is not a number where it is not known.
    pub fn value_and_rate(&self, at: Moment) -> [[f64; D]; 2] {
        match self {
            Self::Constant(value) => [*value, [0.0; D]],
            Self::Signal(signal) => {
                let rate = std::array::from_fn(|k| signal.component(at, k, Derivative::First));
                [self.value(at), rate]
            }
            Self::Custom(function) => [function(at.t), [f64::NAN; D]],
            Self::WithRate(function) => function(at.t),
        }
    }

    /// The next time at which it is not smooth.
    pub fn next_break(&self, t: f64) -> Option<Break> {
        match self {
            Self::Signal(signal) => signal.next_break(t),
            _ => None,
        }
    }

    /// Sizes of its components, or with [`Derivative::First`] of their rates, between zero and `t_end`: of a signal the largest
    /// terms, of a function of the user the largest samples. Constants do not depend on time.
    pub(super) fn extents(&self, derivative: Derivative, t_end: f64) -> [Extent; D] {
        let mut extents = [Extent::default(); D];
        let mut include = |t: f64, values: [f64; D]| {
            extents.iter_mut().zip(values).for_each(|(extent, value)| extent.include(t, value));
        };
        match (self, derivative) {
            (Self::Constant(_), _) => {}
            (Self::Signal(signal), _) => {
                include(0.0, std::array::from_fn(|k| signal.size(k, derivative, t_end)));
            }
            (Self::WithRate(function), Derivative::First) => {
                sample_times(t_end).for_each(|t| include(t, function(t)[1]));
            }
            (_, Derivative::Value) => {
                sample_times(t_end).for_each(|t| include(t, self.value(Moment::new(t))));
            }
            _ => {}
        }
        extents
    }

    /// Refuses constants that are not finite and signals of another number of components.
    pub(super) fn check(&self, argument: &'static str) -> Result<(), ArgumentError> {
        match self {
            Self::Constant(value) => finite(argument, value),
            Self::Signal(signal) if signal.components() != D => {
                let message =
                    format!("must be a signal of {D} components, has {}", signal.components());
                refuse(argument, message)
            }
            _ => Ok(()),
        }
    }

    /// Whether a component is zero at all times, as far as that can be known.
    pub(super) fn may_vanish(&self, component: usize) -> bool {
        match self {
            Self::Constant(value) => value[component] == 0.0,
            Self::Signal(signal) => signal.vanishes(component),
            Self::Custom(_) | Self::WithRate(_) => true,
        }
    }

    /// The same numbers at other places among `E`, beside zeros.
    ///
    /// # Panics
    ///
    /// If a place is not below `E`.
    pub fn spread<const E: usize>(&self, places: [usize; D]) -> TimeFunction<E> {
        let spread = move |value: [f64; D]| {
            let mut wide = [0.0; E];
            for (place, value) in places.into_iter().zip(value) {
                wide[place] = value;
            }
            wide
        };
        match self {
            Self::Constant(value) => TimeFunction::Constant(spread(*value)),
            Self::Signal(signal) => {
                let components: [_; E] =
                    std::array::from_fn(|wide| places.iter().position(|place| *place == wide));
                TimeFunction::Signal(Arc::new(signal.spread(&components)))
            }
            Self::Custom(function) => {
                let function = Arc::clone(function);
                TimeFunction::Custom(Arc::new(move |t| spread(function(t))))
            }
            Self::WithRate(function) => {
                let function = Arc::clone(function);
                TimeFunction::WithRate(Arc::new(move |t| function(t).map(spread)))
            }
        }
    }
}
