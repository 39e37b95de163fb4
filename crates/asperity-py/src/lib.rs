//! Python binding: converts arguments, releases the interpreter, maps errors. No formula, no default.

mod any_star;
mod batch;
mod cones;
mod convert;
mod delassus;
mod errors;
mod evaluate;
mod event;
mod law;
mod outcome;
mod problem;
mod rigid;
mod samples;
mod set;
mod simulate;
mod system;
mod time_function;

use pyo3::prelude::*;

/// The compiled module `asperity._core`.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::cones::{cone_polar, cone_projection, star_shape};
    #[pymodule_export]
    use crate::evaluate::{advance, evaluate};
    #[pymodule_export]
    use crate::event::integrate;
    #[pymodule_export]
    use crate::law::{Law, flow_law};
    #[pymodule_export]
    use crate::outcome::Outcome;
    #[pymodule_export]
    use crate::problem::{Problem, Solver};
    #[pymodule_export]
    use crate::rigid::RigidBodies;
    #[pymodule_export]
    use crate::set::Set;
    #[pymodule_export]
    use crate::simulate::simulate;
    #[pymodule_export]
    use crate::system::{CallbackSystem, LinearSystem};
    #[pymodule_export]
    use crate::time_function::Signal;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("build_profile", if cfg!(debug_assertions) { "debug" } else { "release" })
    }
}
