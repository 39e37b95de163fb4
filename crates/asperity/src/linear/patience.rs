//! Whether somebody still waits for a factorisation.

/// Operations between two questions: some milliseconds.
const BETWEEN: f64 = 1e7;

/// Asks now and then whether a factorisation is to be given up.
pub(super) struct Patience<'a> {
    given_up: &'a dyn Fn() -> bool,
    operations: f64,
}

impl<'a> Patience<'a> {
    pub(super) fn new(given_up: &'a dyn Fn() -> bool) -> Self {
        Self { given_up, operations: 0.0 }
    }

    /// Whether nobody waits any longer, after so many more operations.
    #[inline]
    pub(super) fn is_over(&mut self, operations: usize) -> bool {
        self.operations += operations as f64;
        if self.operations < BETWEEN {
            return false;
        }
        self.operations = 0.0;
        (self.given_up)()
    }
}
