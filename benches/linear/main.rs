//! The sparse factorisations of the library beside faer's: LU of matrices of Newton's method, and LDLᵀ of what stands
//! beside faer's LLᵀ or LDLᵀ, whichever is faster, and beside LU of the same matrix.
//!
//! `cargo run --release --locked -- FOLDER` takes the problems that are stored in a folder, or in the one that
//! `ASPERITY_CONTACT_PROBLEMS` names, at their reference solutions; without either it builds walls. Seconds are the
//! least of several rounds in which all factorisations take turns, on one thread. Of faer, the faster one counts of
//! what it chooses itself and of its supernodal factorisation; bringing blocks into its columns is not counted, while
//! the times of the library contain it.

mod matrices;
mod measure;
mod ours;
mod theirs;

// Files of the library, of which only a part is measured: what else stands in them has no caller here.
#[allow(dead_code)]
#[path = "../../crates/asperity/src/argument.rs"]
mod argument;
#[allow(dead_code)]
mod contact;
#[allow(dead_code, unused_imports)]
#[path = "../../crates/asperity/src/linear/mod.rs"]
mod linear;
#[allow(dead_code)]
#[path = "../../crates/asperity/src/threads.rs"]
mod threads;
#[allow(dead_code, unused_imports)]
#[path = "../../crates/asperity/src/vectors.rs"]
mod vectors;

use std::env;
use std::error::Error;
use std::path::PathBuf;

use contact::BlockMatrix;
use faer::sparse::linalg::SupernodalThreshold;
use linear::Kind;
use measure::{Cost, compare};
use ours::{Ours, OursDense};
use theirs::{Columns, Factors, Theirs, TheirsDefinite, TheirsDense};

/// Matrices up to this size are factored densely as well.
const SMALL: usize = 60;
/// Rows from which on matrices are counted together.
const CLASSES: [usize; 4] = [0, 100, 1000, usize::MAX];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args_os().nth(1).or_else(|| env::var_os("ASPERITY_CONTACT_PROBLEMS"));
    let problems = match folder {
        Some(folder) => matrices::stored(&PathBuf::from(folder))?,
        None => {
            println!("ASPERITY_CONTACT_PROBLEMS names no folder of stored problems: walls instead");
            let sizes = [(2, 2), (3, 4), (5, 6), (8, 10), (16, 20), (30, 40)];
            sizes.map(|(height, width)| matrices::wall(height, width)).into()
        }
    };
    println!("microseconds of the library and of faer, and the backward error of each");
    println!(
        "{:41} {:>6} {:>8} {:>20} {:>20} {:>20} {:>15}",
        "matrix", "rows", "kind", "analysis", "factorisation", "solution", "error"
    );
    let (mut sparse, mut dense) = (Vec::new(), Vec::new());
    let (mut definite, mut against_lu) = (Vec::new(), Vec::new());
    for problem in problems {
        let (matrix, space) = problem.matrix()?;
        let columns = Columns::new(&matrix);
        let [own, chosen, supernodal] = compare(
            &matrix,
            [
                &|| Box::new(Ours::new(&matrix, Kind::General)),
                &|| Box::new(Theirs::new(&columns, SupernodalThreshold::AUTO)),
                &|| Box::new(Theirs::new(&columns, SupernodalThreshold::FORCE_SUPERNODAL)),
            ],
        );
        let faer = faster(chosen, supernodal);
        print(&problem.name, matrix.rows(), space, own, faer);
        sparse.push((matrix.rows(), own, faer));
        if matrix.rows() <= SMALL {
            let (own, faer) = densely(&matrix);
            print(&problem.name, matrix.rows(), "densely", own, faer);
            dense.push((matrix.rows(), own, faer));
        }
        if let Some(matrix) = problem.standing()? {
            let (own, lu, faer) = standing(&matrix);
            print(&problem.name, matrix.rows(), "standing", own, faer);
            print(&problem.name, matrix.rows(), "by LU", lu, faer);
            definite.push((matrix.rows(), own, faer));
            against_lu.push((matrix.rows(), own, lu));
        }
    }
    println!("\nfaer's time over the library's: geometric mean (least, largest)");
    summarise_by_size(&sparse);
    summarise("densely", &dense);
    println!("\nfaer's time for LLᵀ or LDLᵀ over the library's for LDLᵀ, of what stands");
    summarise_by_size(&definite);
    println!("\nthe library's time for LU over that for LDLᵀ of the same matrices");
    summarise_by_size(&against_lu);
    Ok(())
}

/// LDLᵀ and LU of the library, and the fastest of faer's factorisations of definite matrices.
fn standing(matrix: &BlockMatrix) -> (Cost, Cost, Cost) {
    use Factors::{Cholesky, WithDiagonal};
    let lower = Columns::lower(matrix);
    let (auto, forced) = (SupernodalThreshold::AUTO, SupernodalThreshold::FORCE_SUPERNODAL);
    let [own, lu, a, b, c, d] = compare(
        matrix,
        [
            &|| Box::new(Ours::new(matrix, Kind::Definite)),
            &|| Box::new(Ours::new(matrix, Kind::General)),
            &|| Box::new(TheirsDefinite::new(&lower, Cholesky, auto)),
            &|| Box::new(TheirsDefinite::new(&lower, Cholesky, forced)),
            &|| Box::new(TheirsDefinite::new(&lower, WithDiagonal, auto)),
            &|| Box::new(TheirsDefinite::new(&lower, WithDiagonal, forced)),
        ],
    );
    (own, lu, [b, c, d].into_iter().fold(a, faster))
}

/// The one whose factorisation takes less time.
fn faster(one: Cost, other: Cost) -> Cost {
    if one.factor < other.factor { one } else { other }
}

fn densely(matrix: &BlockMatrix) -> (Cost, Cost) {
    let n = matrix.rows();
    let (mut by_rows, mut by_columns) = (vec![0.0; n * n], vec![0.0; n * n]);
    for i in 0..matrix.contacts() {
        for (j, block) in matrix.row(i) {
            for (k, value) in block.iter().enumerate() {
                let row = matrix.offsets()[i] + k / matrix.size(j);
                let column = matrix.offsets()[j] + k % matrix.size(j);
                by_rows[row * n + column] = *value;
                by_columns[column * n + row] = *value;
            }
        }
    }
    let [own, faer] = compare(
        matrix,
        [&|| Box::new(OursDense::new(&by_rows, n)), &|| Box::new(TheirsDense::new(&by_columns, n))],
    );
    (own, faer)
}

fn print(name: &str, rows: usize, space: &str, own: Cost, faer: Cost) {
    let pair =
        |part: fn(&Cost) -> f64| format!("{:9.1} {:10.1}", 1e6 * part(&own), 1e6 * part(&faer));
    println!(
        "{name:41} {rows:6} {space:>8} {} {} {} {:7.0e} {:7.0e}",
        pair(|cost| cost.analysis),
        pair(|cost| cost.factor),
        pair(|cost| cost.solve),
        own.error,
        faer.error
    );
}

fn summarise_by_size(costs: &[(usize, Cost, Cost)]) {
    for bounds in CLASSES.windows(2) {
        let within = |(rows, ..): &&(usize, Cost, Cost)| (bounds[0]..bounds[1]).contains(rows);
        let class: Vec<_> = costs.iter().filter(within).copied().collect();
        let name = match bounds[1] {
            usize::MAX => format!("{} rows or more", bounds[0]),
            end => format!("{} to {} rows", bounds[0].max(1), end - 1),
        };
        summarise(&name, &class);
    }
    summarise("all", costs);
}

fn summarise(name: &str, class: &[(usize, Cost, Cost)]) {
    let regular =
        |(_, own, other): &&(usize, Cost, Cost)| own.factor.is_finite() && other.factor.is_finite();
    let counted: Vec<_> = class.iter().filter(regular).collect();
    if counted.len() < class.len() {
        println!("{name:20} {:3} matrices were not factored", class.len() - counted.len());
    }
    if counted.is_empty() {
        return;
    }
    let ratios = |part: fn(&Cost) -> f64| {
        let ratios: Vec<f64> =
            counted.iter().map(|(_, own, other)| part(other) / part(own)).collect();
        let mean = (ratios.iter().map(|r| r.ln()).sum::<f64>() / ratios.len() as f64).exp();
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = ratios.iter().copied().fold(0.0, f64::max);
        format!("{mean:6.1} ({least:.1}, {largest:.1})")
    };
    println!(
        "{name:20} {:3} matrices: analysis {}, factorisation {}, solution {}",
        counted.len(),
        ratios(|cost| cost.analysis),
        ratios(|cost| cost.factor),
        ratios(|cost| cost.solve)
    );
}
