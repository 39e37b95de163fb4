//! How long sweeps are worth going on with, and when their defect is measured, which takes half as long as a sweep and more:
//! from time to time, when the rate is judged, and where the rate says that the end is.

/// Sweeps before the first judgement of their rate, and most sweeps at all.
pub(crate) const TRIAL_SWEEPS: usize = 20;
pub(super) const MOST_SWEEPS: usize = 400;
/// Part of the sweeps that are worth waiting for after which their rate is judged for the first time, and the least number
/// of sweeps by then: where they cost little beside what would follow, a judgement may wait until it is a safe one.
const TRIAL_PART: f64 = 0.1;
pub(super) const LEAST_SWEEPS: usize = 3;

/// The rate at which sweeps converge, judged from time to time.
#[derive(Debug)]
pub(crate) struct Rate {
    /// Further sweeps that are worth waiting for.
    worthwhile: f64,
    /// The defect at the last judgement, and the sweeps by then and by the next one.
    last: f64,
    last_at: usize,
    next: usize,
    /// Sweeps after which the defect is measured next: then, or before where the end is expected.
    look: usize,
}

impl Default for Rate {
    fn default() -> Self {
        Self::new(Self::WORTHWHILE)
    }
}

impl Rate {
    /// Further sweeps that are worth waiting for at most.
    pub(crate) const WORTHWHILE: f64 = 250.0;

    /// Of sweeps in place of something that takes as long as so many sweeps.
    pub(crate) fn new(instead: f64) -> Self {
        let worthwhile = instead.min(Self::WORTHWHILE);
        Self { worthwhile, last: f64::INFINITY, last_at: 0, next: 1, look: 1 }
    }

    /// The same sweeps in place of something else.
    pub(crate) fn instead_of(&mut self, instead: f64) {
        self.worthwhile = instead.min(Self::WORTHWHILE);
    }

    /// The defect is not due before so many sweeps.
    pub(crate) fn wait(&mut self, sweeps: usize) {
        self.look = sweeps;
    }

    /// Whether the defect is measured after `k` sweeps.
    pub(crate) fn is_due(&self, k: usize) -> bool {
        k >= self.look
    }

    /// Whether a defect of `grade` after `k` sweeps promises that further ones lead to the tolerance. Between judgements only
    /// the end is looked for.
    pub(crate) fn promises(&mut self, k: usize, grade: f64, tolerance: f64) -> bool {
        let trial = ((TRIAL_PART * self.worthwhile) as usize).clamp(LEAST_SWEEPS, TRIAL_SWEEPS);
        let rate = (grade / self.last).ln() / (k - self.last_at) as f64;
        let left = (0.5 * tolerance / grade).ln() / rate;
        // The comparison also turns away NaN.
        let falls = rate < 0.0;
        let known = self.last.is_finite();
        if k >= self.next {
            if k >= trial && !(falls && left <= self.worthwhile) {
                return false;
            }
            (self.last, self.last_at) = (grade, k);
            let more = match k {
                0..5 => 1,
                5..20 => 5,
                _ => k * 3 / 10,
            };
            self.next = MOST_SWEEPS.min(k + more);
        }
        let end =
            if known && falls { k.saturating_add(1.max(left.ceil() as usize)) } else { usize::MAX };
        self.look = self.next.min(end);
        k < MOST_SWEEPS
    }
}
