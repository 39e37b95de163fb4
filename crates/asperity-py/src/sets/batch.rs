//! Questions to a set, answered for many points, and answers on their way to Python.

use std::ops::Range;
use std::time::{Duration, Instant};

use asperity::set::{Convex, Star, Vector, Verdict};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::convert::{Points, chunks, coordinates, rows};
use crate::errors::{Failure, parameter};
use crate::interrupt::POLL;

/// The convex set inside, or the error that names the missing property.
pub fn convex<const P: usize>(set: &Star<P>) -> PyResult<&Convex<P>> {
    set.as_convex().ok_or_else(|| parameter("set", "must be convex for this, is star-shaped only"))
}

/// The numbers that `answer` appends for every point and its place, `width` of them for each.
pub fn each_point<const P: usize, E: Into<Failure>>(
    py: Python<'_>,
    x: &Points<'_>,
    argument: &str,
    width: usize,
    answer: impl Fn(&Vector<P>, usize, &mut Vec<f64>) -> Result<(), E> + Sync,
) -> Result<Vec<f64>, Failure> {
    let x = coordinates::<P>(x, argument)?;
    let count = x.len() / P;
    let mut out = Vec::with_capacity(width * count);
    in_blocks(py, count, |block| {
        let start = block.start;
        for (i, x) in chunks::<P>(&x[P * start..P * block.end]).enumerate() {
            answer(&x, start + i, &mut out).map_err(Into::into)?;
        }
        Ok(())
    })?;
    Ok(out)
}

/// Work that ends within this time keeps the interpreter: giving it back and waiting for it costs more.
const SHORT: Duration = Duration::from_millis(1);
/// Time between two looks at the clock.
const LOOK: Duration = Duration::from_micros(100);

/// Works on `0..count` in blocks. Long work releases the interpreter and ends at Ctrl-C.
fn in_blocks(
    py: Python<'_>,
    count: usize,
    mut work: impl FnMut(Range<usize>) -> Result<(), Failure> + Send,
) -> Result<(), Failure> {
    let mut walk = Walk { next: 0, count, width: 64 };
    if walk.ends_within(SHORT, &mut work)? {
        return Ok(());
    }
    py.detach(|| {
        while !walk.ends_within(POLL, &mut work)? {
            Python::attach(|py| py.check_signals())?;
        }
        Ok(())
    })
}

/// Blocks whose width follows from the time they take.
struct Walk {
    next: usize,
    count: usize,
    width: usize,
}

impl Walk {
    /// Works until the end or for about that long; whether the end is reached.
    fn ends_within(
        &mut self,
        time: Duration,
        work: &mut impl FnMut(Range<usize>) -> Result<(), Failure>,
    ) -> Result<bool, Failure> {
        let start = Instant::now();
        let mut before = Duration::ZERO;
        while self.next < self.count {
            let end = self.count.min(self.next + self.width);
            work(self.next..end)?;
            self.next = end;
            let now = start.elapsed();
            match now - before {
                took if took < LOOK => self.width *= 2,
                took if took > 4 * LOOK => self.width = 1.max(self.width / 2),
                _ => {}
            }
            before = now;
            if now >= time {
                break;
            }
        }
        Ok(self.next == self.count)
    }
}

/// A verdict as `(holds, exact, tolerance, defect, witness)`.
pub type Answer<'py> = (bool, bool, f64, f64, Option<Bound<'py, PyArray2<f64>>>);

/// See [`Answer`].
pub fn answer<'py, const P: usize>(py: Python<'py>, verdict: &Verdict<P>) -> PyResult<Answer<'py>> {
    let points: Vec<f64> = verdict.witness.iter().flat_map(|x| x.as_slice().to_vec()).collect();
    let witness = if points.is_empty() { None } else { Some(rows(py, points, P)?) };
    Ok((verdict.holds, verdict.exact, verdict.tolerance, verdict.defect, witness))
}

/// Numbers of some vectors, one after another.
pub fn flat<const P: usize>(vectors: &[Vector<P>]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.as_slice().to_vec()).collect()
}

/// A ratio and the direction that has it, for Python.
pub fn touching<const P: usize>((ratio, at): (f64, Vector<P>)) -> (f64, Vec<f64>) {
    (ratio, at.as_slice().to_vec())
}
