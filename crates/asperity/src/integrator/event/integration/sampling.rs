//! What is kept of the motion.

use crate::integrator::event::collocation::dense_output::PLACES;
use crate::integrator::event::dynamics::contact_variables::FieldError;
use crate::integrator::event::integration::detection::Lost;
use crate::integrator::event::integration::time_loop::Runner;

/// Samples between two looks at the clock.
const RARELY: usize = 256;

impl Runner<'_> {
    /// Keeps the present state.
    pub(crate) fn record(&mut self) -> Result<(), FieldError> {
        self.motion.record(&self.field, &self.state);
        Ok(())
    }

    /// Samples from the present state up to `t`, the end of the attempt or a time inside; whether there were
    /// any.
    pub(crate) fn sample(&mut self, t: f64, attempt: bool) -> Result<bool, FieldError> {
        let Some(dt) = self.options.sample else { return Ok(false) };
        // The end of the run is a sample of its own.
        let due = |k: usize| k as f64 * dt < t || (k as f64 * dt == t && attempt);
        if !due(self.samples) {
            return Ok(false);
        }
        let h = if attempt { self.step.h } else { t - self.state.t };
        self.interpolate(h, attempt)?;
        while due(self.samples) && !self.poll.stopped() {
            self.dense.at(self.samples as f64 * dt, &mut self.sampled);
            let sampled = std::mem::take(&mut self.sampled);
            self.evaluate((sampled.t, &sampled.q, &sampled.u), false)?;
            self.motion.record(&self.field, &sampled);
            self.sampled = sampled;
            self.samples += 1;
            if self.samples.is_multiple_of(RARELY) {
                self.poll.stops(self.state.t);
            }
        }
        Ok(true)
    }

    /// The motion over the first `h` of the attempt, its end included.
    fn interpolate(&mut self, h: f64, attempt: bool) -> Result<(), FieldError> {
        self.dense.begin(&self.state, h, &self.a0);
        for k in 1..PLACES {
            if attempt && k + 1 == PLACES {
                let (state, step) = (&self.state, &self.step);
                self.dense.set(k, |i| step.way(state, i), step.end(&step.u), step.end(&step.a));
                break;
            }
            match self.look(h * k as f64 / (PLACES - 1) as f64) {
                Ok(()) => {}
                // The polynomial of the attempt is what is left.
                Err(Lost::Diverged | Lost::Early(_)) => {
                    self.probe.guess_from(h * k as f64 / (PLACES - 1) as f64, &self.step, 0.0);
                    self.probe.stages(&self.state);
                }
                Err(Lost::Error(error)) => return Err(error),
            }
            let (state, probe) = (&self.state, &self.probe);
            self.dense.set(k, |i| probe.way(state, i), probe.end(&probe.u), probe.end(&probe.a));
        }
        self.dense.finish();
        Ok(())
    }
}
