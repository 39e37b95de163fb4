//! Solvers.

use asperity::solver::{self, ProxStep, Steps};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{Failure, parameter};

/// A solver and its options.
#[pyclass(frozen, module = "asperity._core")]
pub struct Solver(pub solver::Solver);

fn step(r: Option<f64>) -> Result<ProxStep, Failure> {
    match r {
        None => Ok(ProxStep::Adaptive),
        Some(r) if r.is_finite() && r > 0.0 => Ok(ProxStep::Constant(r)),
        Some(r) => Err(parameter("r", &format!("must be finite and positive, got {r}")).into()),
    }
}

/// The steps of [`solver::Solver::Auto`] without those of these names.
fn steps(without: Vec<String>) -> Result<Steps, Failure> {
    let mut steps = Steps::ALL;
    for name in without {
        let others = steps.without(&name);
        steps = others.ok_or_else(|| {
            parameter("without", &format!("must name steps of {:?}, got {name:?}", Steps::NAMES))
        })?;
    }
    Ok(steps)
}

#[pymethods]
impl Solver {
    /// Names of the steps of the default solver.
    #[staticmethod]
    fn steps() -> [&'static str; Steps::NAMES.len()] {
        Steps::NAMES
    }

    /// The solver of a name, with all the options that it has.
    #[new]
    #[pyo3(signature = (name, **options))]
    fn new(name: &str, options: Option<&Bound<'_, PyDict>>) -> Result<Self, Failure> {
        use solver::Solver::{
            Admm, Auto, Exact, InteriorPoint, ProxGaussSeidel, ProxJacobi, ProximalPoint,
            SemismoothNewton,
        };
        let option = |name: &str| -> PyResult<Bound<'_, PyAny>> {
            let value = options.map(|options| options.get_item(name)).transpose()?.flatten();
            value.ok_or_else(|| parameter(name, "must be given"))
        };
        let count = |name: &str| option(name)?.extract::<usize>();
        let r = || step(option("r")?.extract()?);
        Ok(Self(match name {
            "auto" => {
                Auto { steps: steps(option("without")?.extract()?)?, threads: count("threads")? }
            }
            "exact" => Exact { max_sweeps: count("max_sweeps")? },
            "newton" => SemismoothNewton { max_iterations: count("max_iterations")? },
            "proximal_point" => ProximalPoint { max_iterations: count("max_iterations")? },
            "interior_point" => InteriorPoint { max_iterations: count("max_iterations")? },
            "admm" => Admm { max_iterations: count("max_iterations")? },
            "prox_jacobi" => ProxJacobi { step: r()?, max_iterations: count("max_iterations")? },
            "prox_gauss_seidel" => {
                ProxGaussSeidel { step: r()?, max_iterations: count("max_iterations")? }
            }
            _ => return Err(parameter("name", "must be that of a solver").into()),
        }))
    }
}
