//! Long answers without the interpreter, which Ctrl-C ends.

use std::cell::{Cell, OnceCell};
use std::time::{Duration, Instant};

use asperity::set::Cancelled;
use pyo3::prelude::*;

/// Time between two looks for Ctrl-C.
pub const POLL: Duration = Duration::from_millis(50);

/// Answers a question without the interpreter. The question asks again and again whether it is given up, as it is by
/// Ctrl-C; its answer does not matter then.
pub fn asked<T: Send>(
    py: Python<'_>,
    question: impl FnOnce(Cancelled<'_>) -> T + Send,
) -> PyResult<T> {
    py.detach(|| {
        let (last, interrupt) = (Cell::new(Instant::now()), OnceCell::new());
        let cancelled = || {
            if interrupt.get().is_none() && last.get().elapsed() >= POLL {
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    let _ = interrupt.set(error);
                }
                last.set(Instant::now());
            }
            interrupt.get().is_some()
        };
        let answer = question(&cancelled);
        interrupt.into_inner().map_or(Ok(answer), Err)
    })
}
