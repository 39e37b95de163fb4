//! Moreau's midpoint scheme (\[WL19\] §2.3).
//!
//! `q_M = q_B + ½Δt u_B`; the contacts closed at the midpoint form the contact problem
//! `M(u_E − u_B) − hΔt = W_N P_N + W P` with the laws in `u_E` (19); `q_E = q_M + ½Δt u_E`. Where directions change along
//! the way, the laws of contacts that stay closed hold from midpoint to midpoint ([`Turning::chord`](crate::system::Turning::chord)).
//!
//! | file | concept |
//! |---|---|
//! | `stepper.rs`, `step.rs` | the scheme with its state; one step |
//! | `assembly.rs`, `coupling.rs` | from a system at the midpoint to the contact problem, and back |
//! | `closed.rs` | the contacts that are closed, and what they remember |
//! | `longest_step.rs`, `reversals.rs` | steps that are too long for forces, which act explicitly |
//! | `rated.rs`, `linear_solve.rs` | friction that depends on the speed |
//! | `state.rs` | what a run hands over |
//! | `outcome.rs`, `outputs.rs` | what comes of a step; what is kept of its contacts |

mod assembly;
mod closed;
mod coupling;
mod linear_solve;
mod longest_step;
mod outcome;
mod outputs;
mod products;
mod rated;
mod reversals;
mod state;
mod step;
mod stepper;

pub use outcome::{ContactOutput, StepError};
pub use state::{ContactMemory, State};
pub use stepper::Stepper;
