//! What a contact with an ill-conditioned block may cost.

/// Values of the natural map that the search for a solution of one contact may take. An evaluation takes between
/// half a microsecond and half a millisecond, a search that succeeds some tens to some hundreds of them, one that fails all.
/// Of 12,000 drilling contacts made as in `tests/test_contact.py`, 500 of each sort, and of 12,000 made as `single/cells.rs`
/// says, 5 and 25 are not solved with a quarter, none and 2 with half of it, none with all.
const ALONE: usize = 12_000;
/// The same in sweeps, which come back to the contact with other loads: of one search, and of all searches of one
/// contact that fail in one solve.
const ONE_OF_MANY: usize = 300;
const ALL_OF_ONE: usize = 600;
/// Values that Newton's method from one slip velocity may take, and all attempts of one contact that fail in one solve: sweeps
/// that help a solver out of a problem without a solution come to a contact tens of thousands of times in vain. The
/// slowest inputs that fuzzing has found, 27 of steps and of many contacts, take 80 s so and 206 s without the second limit,
/// the worst 8 s and 50 s.
const ATTEMPT: usize = 100;
const ALL_ATTEMPTS: usize = 10_000;
/// Gauges that searches for stick percussions of one contact whose block has not full rank may take in the sweeps of one
/// solve that take the first solution found, where they find none: one takes up to some hundred for each rank, besides
/// those that follow where it finds some. A problem that the fuzzer found (`many_contacts/dear_sums_1` of its corpus), whose
/// sets are sums with dear gauges, takes 93 s in the build of the fuzzers without this limit and 2.4 s with it.
const ALL_STICKS: usize = 20_000;
/// Walks along the whole boundary in the sweeps of one solve.
const WALKS: usize = 20;

/// What is left of the work on one contact, in a solve or in a sweep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    evaluations: usize,
    each: usize,
    attempts: usize,
    sticks: usize,
    walks: usize,
}

impl Effort {
    /// For a contact that is solved once.
    pub(crate) fn alone() -> Self {
        Self { evaluations: ALONE, each: ALONE, sticks: usize::MAX, ..Self::in_sweeps() }
    }

    /// For a contact in all sweeps of a solve.
    pub(crate) fn in_sweeps() -> Self {
        Self {
            evaluations: ALL_OF_ONE,
            each: ONE_OF_MANY,
            attempts: ALL_ATTEMPTS,
            sticks: ALL_STICKS,
            walks: WALKS,
        }
    }

    /// Whether the boundary may be walked along once more.
    pub(crate) fn walk(&mut self) -> bool {
        let may = self.walks > 0;
        self.walks = self.walks.saturating_sub(1);
        may
    }

    /// Gauges that the next search for stick may take.
    pub(crate) fn stick(&self) -> Evaluations {
        Evaluations(self.sticks)
    }

    /// One that has failed is paid for.
    pub(crate) fn failed_stick(&mut self, left: Evaluations) {
        self.sticks = left.0;
    }

    /// Evaluations that the next search may take.
    pub(crate) fn search(&self) -> Evaluations {
        Evaluations(self.evaluations.min(self.each))
    }

    /// A search that has failed is paid for.
    pub(crate) fn failed(&mut self, left: Evaluations) {
        self.evaluations -= self.search().0 - left.0;
    }

    /// Evaluations that Newton's method from the next slip velocity may take.
    pub(crate) fn attempt(&self) -> Evaluations {
        Evaluations(self.attempts.min(ATTEMPT))
    }

    /// One that has failed is paid for.
    pub(crate) fn failed_attempt(&mut self, left: Evaluations) {
        self.attempts -= self.attempt().0 - left.0;
    }
}

/// Values of the natural map, or of the gauge, that may still be asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Evaluations(usize);

impl Evaluations {
    /// Takes one; false if there are none left.
    pub(crate) fn take(&mut self) -> bool {
        let may = self.0 > 0;
        self.0 = self.0.saturating_sub(1);
        may
    }

    /// Whether there are so many.
    pub(crate) fn allow(&self, count: usize) -> bool {
        self.0 >= count
    }

    /// Whether there are any.
    pub(crate) fn are_left(&self) -> bool {
        self.0 > 0
    }
}
