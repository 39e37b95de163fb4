//! Python binding: converts arguments, releases the interpreter, maps errors. No formula, no default.

mod contact;
mod convert;
mod errors;
mod interrupt;
mod law;
mod runs;
mod sets;
mod systems;

use pyo3::prelude::*;

/// The compiled module `asperity._core`.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::contact::outcome::Outcome;
    #[pymodule_export]
    use crate::contact::problem::Problem;
    #[pymodule_export]
    use crate::contact::solver::Solver;
    #[pymodule_export]
    use crate::contact::stepper::{Step, Stepper};
    #[pymodule_export]
    use crate::contact::tree_stepper::{TreeStep, TreeStepper};
    #[pymodule_export]
    use crate::law::{Law, flow_law};
    #[pymodule_export]
    use crate::runs::event::integrate;
    #[pymodule_export]
    use crate::runs::many::{integrate_many, simulate_many};
    #[pymodule_export]
    use crate::runs::simulate::simulate;
    #[pymodule_export]
    use crate::sets::cones::{cone_polar, cone_projection, star_shape};
    #[pymodule_export]
    use crate::sets::set::Set;
    #[pymodule_export]
    use crate::systems::any_system::calls_python;
    #[pymodule_export]
    use crate::systems::callback::CallbackSystem;
    #[pymodule_export]
    use crate::systems::evaluate::{advance, constraint_forces, deepest_overlap, evaluate};
    #[pymodule_export]
    use crate::systems::linear::LinearSystem;
    #[pymodule_export]
    use crate::systems::rigid::{FrictionFactor, RigidBodies};
    #[pymodule_export]
    use crate::systems::time_function::Signal;
    #[pymodule_export]
    use crate::systems::variants::LinearVariants;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("build_profile", if cfg!(debug_assertions) { "debug" } else { "release" })
    }
}
