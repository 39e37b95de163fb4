//! The form in which benches report ratios to `benches/performance.py`, which writes docs/performance.md.

/// Print a ratio: of what, to what, and what a user learns from it.
pub fn ratio(case: &str, value: f64, beside: &str, meaning: &str) {
    println!("ratio\t{case}\t{value:.3}\t{beside}\t{meaning}");
}
