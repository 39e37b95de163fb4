//! Solvers of contact problems.
//!
//! | solver | file | method |
//! |---|---|---|
//! | [`Solver::Auto`] | `cascade.rs` | sweeps, Newton, conic methods, proximal point: what it takes |
//! | [`Solver::Exact`] | `gauss_seidel/` | block Gauss–Seidel, every contact solved exactly (`one_contact/`) |
//! | [`Solver::ProxJacobi`] | `method/prox.rs` | the iteration of \[WL19\] (20)–(22), (69), (70) |
//! | [`Solver::ProxGaussSeidel`] | `method/prox.rs` | the same, contact after contact |
//! | [`Solver::SemismoothNewton`] | `method/newton.rs` | semismooth Newton on the natural map |
//! | [`Solver::ProximalPoint`] | `method/proximal.rs` | Newton within a proximal point iteration |
//! | [`Solver::InteriorPoint`] | `method/interior.rs` | primal-dual, elliptic laws |
//! | [`Solver::Admm`] | `method/admm.rs` | few factorisations, elliptic laws |
//!
//! A problem is a list of islands, contacts that influence each other and no others; `list.rs` solves them one by one, each
//! as a problem of its own. `incumbent.rs` keeps the best percussions of an island. The measures in `measure/` belong to no
//! solver and grade them all; `infeasible/` proves that there is no solution.

mod cascade;
mod equal_compliance;
mod findings;
mod gauss_seidel;
mod incumbent;
mod infeasible;
mod island;
mod list;
mod measure;
mod method;
mod newton_matrix;
mod one_contact;
mod report;
mod settings;
mod solution;
mod solve;

pub(crate) use equal_compliance::{DEPENDENT, Given, LIGHT, RANK, SINGULAR, Shares};
pub use infeasible::{Case, Infeasibility, InfeasibilityKind, Unsolvable};
pub use island::{Island, Islands};
pub use measure::certificate::Certificate;
pub use measure::natural_map::natural_map;
pub use measure::natural_residual::{Residual, natural_residual};
pub use measure::stop::{Measure, Stop};
pub use method::ProxStep;
pub use one_contact::solutions::{ContactSolution, solutions};
pub(crate) use one_contact::{ImplicitRate, Uniqueness};
pub use report::{Method, SolveReport, Stage, Status};
pub use settings::{Solver, Steps};
pub use solution::{Solution, SolvedContact};
pub use solve::Workspace;
pub(crate) use solve::{grade, solve_implicit};

#[cfg(test)]
mod tests;
