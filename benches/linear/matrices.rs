//! Matrices of Newton's method and of what stands: of stored problems, and of walls where there are none.

use std::error::Error;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use nalgebra::{Matrix3, Vector3};

use crate::contact::{BlockMatrix, Csr};
use crate::linear::Symbolic;

/// Regularisation of the proximal method, in units of `1/ρ`.
const SHIFT: f64 = 1e-8;
/// Regularisation of bodies at rest in the library (`solver/method/least_norm.rs`), in the same units.
const REGULARIZED: f64 = 1e-11;
/// Most rows that the library factors densely (`solver/newton_matrix`).
const SMALL: usize = 30;
/// Velocities of a body.
const BODY: usize = 6;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A contact problem with a state of it: `G` in contact space, where bodies are known `M` and `W` too.
pub struct Problem {
    pub name: String,
    delassus: Csr,
    bodies: Option<(Csr, Csr)>,
    friction: Vec<f64>,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
}

/// The problems of a folder, each with its reference solution.
pub fn stored(folder: &Path) -> Result<Vec<Problem>> {
    let mut problems = Vec::new();
    for entry in fs::read_dir(folder.join("open"))? {
        let path = entry?.path();
        if path.extension().is_none_or(|extension| extension != "npz") {
            continue;
        }
        let mut file = Archive::open(&path)?;
        let bodies = match file.contains("M_data") {
            true => Some((file.matrix("M")?, file.matrix("H")?)),
            false => None,
        };
        let (delassus, friction) = (file.matrix("W")?, file.numbers("mu")?);
        let reference = path.file_name().map(|name| folder.join("reference").join(name));
        let mut reference = Archive::open(&reference.unwrap_or_default())?;
        problems.push(Problem {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            delassus,
            bodies,
            friction,
            percussion: reference.numbers("r")?,
            velocity: reference.numbers("u")?,
        });
    }
    problems.sort_by_key(|problem| problem.delassus.rows());
    Ok(problems)
}

/// Bricks that stand on two bricks each, with four contacts on each of them and random directions; a third of the
/// contacts each is open, sticks and slides.
pub fn wall(height: usize, width: usize) -> Problem {
    let mut seed = 1_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let mut contacts = Vec::new();
    for above in width..height * width {
        for side in 0..2 {
            let below = above - width + side;
            contacts.extend([[above, below.min(above / width * width - 1)]; 4]);
        }
    }
    let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
    for bodies in &contacts {
        let mut bodies = *bodies;
        bodies.sort_unstable();
        for _ in 0..3 {
            indices.extend(bodies.iter().flat_map(|body| BODY * body..BODY * (body + 1)));
            values.extend((0..2 * BODY).map(|_| random()));
            starts.push(indices.len());
        }
    }
    let (rows, dof) = (3 * contacts.len(), BODY * height * width);
    let directions = Csr::new(rows, dof, starts, indices, values).expect("a wall");
    let diagonal = (0..dof).collect();
    let mass = Csr::new(dof, dof, (0..=dof).collect(), diagonal, vec![1.0; dof]);
    let mut touching = vec![Vec::new(); dof];
    for row in 0..rows {
        let (columns, values) = directions.row(row);
        columns
            .iter()
            .zip(values)
            .for_each(|(&column, &value)| touching[column].push((row, value)));
    }
    let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
    let mut sums = vec![0.0; rows];
    for row in 0..rows {
        let (columns, own) = directions.row(row);
        let mut reached: Vec<usize> = columns
            .iter()
            .flat_map(|&column| touching[column].iter().map(|(row, _)| *row))
            .collect();
        reached.sort_unstable();
        reached.dedup();
        for (&column, own) in columns.iter().zip(own) {
            touching[column].iter().for_each(|(other, value)| sums[*other] += own * value);
        }
        for other in reached {
            indices.push(other);
            values.push(std::mem::take(&mut sums[other]));
        }
        starts.push(indices.len());
    }
    let delassus = Csr::new(rows, rows, starts, indices, values).expect("a wall");
    let phase = |i: usize| [(0.0, 1.0), (1.0, 0.0), (1.0, 0.5)][i % 3];
    Problem {
        name: format!("wall {height} x {width}"),
        delassus,
        bodies: Some((mass.expect("a wall"), directions)),
        friction: vec![0.5; contacts.len()],
        percussion: (0..contacts.len())
            .flat_map(|i| [phase(i).0, if i % 3 == 2 { 0.5 } else { 0.0 }, 0.0])
            .collect(),
        velocity: (0..contacts.len())
            .flat_map(|i| match i % 3 {
                0 => [phase(i).1, 0.0, 0.0],
                _ => [0.0, -phase(i).1, 0.0],
            })
            .collect(),
    }
}

impl Problem {
    /// `A + B G` of the natural map at the reference solution, in the space where the library eliminates: among the
    /// rows of contacts, or among the velocities of bodies where that takes fewer operations.
    pub fn matrix(&self) -> Result<(BlockMatrix, &'static str)> {
        let jacobians = self.jacobians();
        let contacts = self.in_contact_space(&jacobians)?;
        if let Some((mass, directions)) = &self.bodies
            && let Some(bodies) = in_body_space(mass, directions, &jacobians)
            && Symbolic::new(&bodies).operations < Symbolic::new(&contacts).operations
        {
            return Ok((bodies, "bodies"));
        }
        Ok((contacts, "contacts"))
    }

    /// `M + W Wᵀ/ε` of what stands, where all contacts stick: symmetric and positive definite. None where the library
    /// factors another matrix: densely or among the rows of contacts.
    pub fn standing(&self) -> Result<Option<BlockMatrix>> {
        let epsilon = REGULARIZED / self.rho();
        let stuck = (Matrix3::identity() * epsilon, Matrix3::identity());
        let jacobians = vec![stuck; self.friction.len()];
        let contacts = Symbolic::new(&self.in_contact_space(&jacobians)?).operations;
        let bodies = self.bodies.as_ref();
        Ok(bodies
            .and_then(|(mass, directions)| in_body_space(mass, directions, &jacobians))
            .filter(|matrix| {
                self.delassus.rows() > SMALL && Symbolic::new(matrix).operations < contacts
            }))
    }

    /// `ρ`, the inverse of the mean of the diagonal of `G`.
    fn rho(&self) -> f64 {
        let trace: f64 = (0..self.delassus.rows()).map(|row| entry(&self.delassus, row, row)).sum();
        self.delassus.rows() as f64 / trace
    }

    /// `A` and `B` of every contact: `ξ − prox(ξ)` with `prox(ξ)` onto the half line and onto the disk of radius
    /// `μ ξ_N`, `ξ = P − ρ u`, regularised as the proximal method does.
    fn jacobians(&self) -> Vec<(Matrix3<f64>, Matrix3<f64>)> {
        let rho = self.rho();
        let vector = |list: &[f64], i: usize| Vector3::from_column_slice(&list[3 * i..3 * i + 3]);
        let one = |(i, mu): (usize, &f64)| {
            let x = vector(&self.percussion, i) - rho * vector(&self.velocity, i);
            let mut prox = Matrix3::zeros();
            if x[0] > 0.0 {
                prox[(0, 0)] = 1.0;
                let tangential = x.yz();
                let (norm, radius) = (tangential.norm(), mu * x[0]);
                if norm <= radius {
                    (prox[(1, 1)], prox[(2, 2)]) = (1.0, 1.0);
                } else {
                    let n = tangential / norm;
                    for a in 0..2 {
                        prox[(a + 1, 0)] = mu * n[a];
                        for b in 0..2 {
                            let own = if a == b { 1.0 } else { 0.0 };
                            prox[(a + 1, b + 1)] = radius / norm * (own - n[a] * n[b]);
                        }
                    }
                }
            }
            let b = rho * prox;
            (Matrix3::identity() - prox + b * (SHIFT / rho), b)
        };
        self.friction.iter().enumerate().map(one).collect()
    }

    fn in_contact_space(&self, jacobians: &[(Matrix3<f64>, Matrix3<f64>)]) -> Result<BlockMatrix> {
        let sizes = vec![3; jacobians.len()];
        let g = BlockMatrix::from_csr(&self.delassus, &sizes)?;
        let mut neighbours: Vec<Vec<usize>> =
            (0..g.contacts()).map(|i| g.neighbours(i).to_vec()).collect();
        for i in 0..g.contacts() {
            g.neighbours(i).iter().for_each(|&j| neighbours[j].push(i));
        }
        neighbours.iter_mut().for_each(|list| {
            list.sort_unstable();
            list.dedup();
        });
        let mut matrix = BlockMatrix::with_pattern(&sizes, &neighbours);
        for (i, (a, b)) in jacobians.iter().enumerate() {
            for (j, block) in g.row(i) {
                let own = if i == j { *a } else { Matrix3::zeros() };
                add_block(&mut matrix, (i, j), &(own + b * Matrix3::from_row_slice(block)));
            }
        }
        Ok(matrix)
    }
}

/// `M + W D Wᵀ` with `D = A⁻¹B`; none where bodies have other than six velocities.
fn in_body_space(
    mass: &Csr,
    directions: &Csr,
    jacobians: &[(Matrix3<f64>, Matrix3<f64>)],
) -> Option<BlockMatrix> {
    // Files hold `W` with as many columns as contacts have rows, walls its transpose.
    let rows = 3 * jacobians.len();
    let mut of_contact = vec![Vec::new(); rows];
    for i in 0..directions.rows() {
        let (columns, values) = directions.row(i);
        for (&j, &value) in columns.iter().zip(values) {
            let (row, velocity) = if directions.rows() == rows { (i, j) } else { (j, i) };
            of_contact[row].push((velocity, value));
        }
    }
    let count = mass.rows() / BODY;
    if count * BODY != mass.rows() {
        return None;
    }
    let mut neighbours: Vec<Vec<usize>> = (0..count).map(|body| vec![body]).collect();
    for row in 0..mass.rows() {
        neighbours[row / BODY].extend(mass.row(row).0.iter().map(|column| column / BODY));
    }
    let touched = |rows: &[Vec<(usize, f64)>]| {
        let mut bodies: Vec<usize> =
            rows.iter().flatten().map(|(velocity, _)| velocity / BODY).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    };
    for rows in of_contact.chunks_exact(3) {
        let bodies = touched(rows);
        bodies.iter().for_each(|&body| neighbours[body].extend_from_slice(&bodies));
    }
    neighbours.iter_mut().for_each(|list| {
        list.sort_unstable();
        list.dedup();
    });
    let mut matrix = BlockMatrix::with_pattern(&vec![BODY; count], &neighbours);
    let mut add = |i: usize, j: usize, value: f64| {
        let k = neighbours[i / BODY].partition_point(|&other| other < j / BODY);
        matrix.block_mut(i / BODY, k).1[i % BODY * BODY + j % BODY] += value;
    };
    for i in 0..mass.rows() {
        let (columns, values) = mass.row(i);
        columns.iter().zip(values).for_each(|(&j, &value)| add(i, j, value));
    }
    for (rows, (a, b)) in of_contact.chunks_exact(3).zip(jacobians) {
        let d = a.try_inverse()? * b;
        for (r, left) in rows.iter().enumerate() {
            for (c, right) in rows.iter().enumerate() {
                for (i, x) in left {
                    right.iter().for_each(|(j, y)| add(*i, *j, x * d[(r, c)] * y));
                }
            }
        }
    }
    Some(matrix)
}

fn add_block(matrix: &mut BlockMatrix, (i, j): (usize, usize), block: &Matrix3<f64>) {
    let k = matrix.neighbours(i).partition_point(|&other| other < j);
    for (value, entry) in matrix.block_mut(i, k).1.iter_mut().zip(block.transpose().iter()) {
        *value += entry;
    }
}

fn entry(matrix: &Csr, row: usize, column: usize) -> f64 {
    let (columns, values) = matrix.row(row);
    columns.iter().position(|&c| c == column).map_or(0.0, |k| values[k])
}

/// Arrays of NumPy in a zip archive.
struct Archive(zip::ZipArchive<File>);

impl Archive {
    fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self(zip::ZipArchive::new(file)?))
    }

    fn contains(&self, name: &str) -> bool {
        self.0.index_for_name(&format!("{name}.npy")).is_some()
    }

    fn bytes(&mut self, name: &str) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.0.by_name(&format!("{name}.npy"))?.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    fn numbers(&mut self, name: &str) -> Result<Vec<f64>> {
        let bytes = self.bytes(name)?;
        let (header, values) = header_and_values(&bytes)?;
        match header.contains("'<f8'") {
            true => {
                Ok(values.as_chunks().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect())
            }
            false => Err(format!("{name} must be of type float64: {header}").into()),
        }
    }

    fn indices(&mut self, name: &str) -> Result<Vec<usize>> {
        let bytes = self.bytes(name)?;
        let (header, values) = header_and_values(&bytes)?;
        let list: Vec<i64> = if header.contains("'<i4'") {
            values.as_chunks().0.iter().map(|four| i32::from_le_bytes(*four).into()).collect()
        } else if header.contains("'<i8'") {
            values.as_chunks().0.iter().map(|eight| i64::from_le_bytes(*eight)).collect()
        } else {
            return Err(format!("{name} must be of type int32 or int64: {header}").into());
        };
        Ok(list.into_iter().map(usize::try_from).collect::<std::result::Result<_, _>>()?)
    }

    fn matrix(&mut self, name: &str) -> Result<Csr> {
        let shape = self.indices(&format!("{name}_shape"))?;
        let starts = self.indices(&format!("{name}_indptr"))?;
        let indices = self.indices(&format!("{name}_indices"))?;
        let values = self.numbers(&format!("{name}_data"))?;
        // Columns of a row ascend in none or all of the files; the library asks for it.
        let (mut sorted_indices, mut sorted_values) = (Vec::new(), Vec::new());
        for pair in starts.windows(2) {
            let mut row: Vec<(usize, f64)> =
                (pair[0]..pair[1]).map(|k| (indices[k], values[k])).collect();
            row.sort_by_key(|(column, _)| *column);
            sorted_indices.extend(row.iter().map(|(column, _)| *column));
            sorted_values.extend(row.iter().map(|(_, value)| *value));
        }
        let matrix = Csr::new(shape[0], shape[1], starts, sorted_indices, sorted_values);
        Ok(matrix?)
    }
}

/// The parts of an array in NumPy's format of version 1: six bytes of a name, two of the version, two of the length of
/// the header.
fn header_and_values(bytes: &[u8]) -> Result<(&str, &[u8])> {
    let length = match bytes {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _, low, high, ..] => {
            u16::from_le_bytes([*low, *high])
        }
        _ => return Err("must be an array of NumPy's format 1".into()),
    };
    let rest = &bytes[10..];
    let (header, values) = rest.split_at_checked(length.into()).ok_or("must have a header")?;
    Ok((std::str::from_utf8(header)?, values))
}
