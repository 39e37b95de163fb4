//! The factorisations of faer, on one thread, with workspaces that are kept.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::prelude::default;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut, Par, Side};

use crate::contact::BlockMatrix;
use crate::measure::Factorisation;

/// A matrix in compressed columns, every entry of every block kept: which of them vanish changes from one iteration of
/// Newton's method to the next, while one analysis serves for all.
pub struct Columns {
    size: usize,
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl Columns {
    /// The entries of a matrix of blocks.
    pub fn new(matrix: &BlockMatrix) -> Self {
        Self::of(matrix, |_, _| true)
    }

    /// Those on the diagonal and below it.
    pub fn lower(matrix: &BlockMatrix) -> Self {
        Self::of(matrix, |row, column| row >= column)
    }

    fn of(matrix: &BlockMatrix, kept: impl Fn(usize, usize) -> bool) -> Self {
        let mut columns = vec![Vec::new(); matrix.rows()];
        for (i, &row) in matrix.offsets().iter().enumerate().take(matrix.contacts()) {
            for (j, block) in matrix.row(i) {
                for (k, value) in block.iter().enumerate() {
                    let (column, row) =
                        (matrix.offsets()[j] + k % matrix.size(j), row + k / matrix.size(j));
                    if kept(row, column) {
                        columns[column].push((row, *value));
                    }
                }
            }
        }
        let mut starts = vec![0];
        for column in &columns {
            starts.push(starts[starts.len() - 1] + column.len());
        }
        let (rows, values) = columns.into_iter().flatten().unzip();
        Self { size: matrix.rows(), starts, rows, values }
    }

    fn symbolic(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.size, self.size, &self.starts, None, &self.rows)
    }
}

/// Sparse LU with COLAMD and exchanges of all rows.
pub struct Theirs<'a> {
    matrix: &'a Columns,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    workspace: MemBuffer,
}

impl<'a> Theirs<'a> {
    /// The analysis of the pattern.
    pub fn new(matrix: &'a Columns, threshold: SupernodalThreshold) -> Self {
        let parameters =
            LuSymbolicParams { supernodal_flop_ratio_threshold: threshold, ..default() };
        let symbolic = factorize_symbolic_lu(matrix.symbolic(), parameters).expect("analysis");
        let workspace = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let workspace = MemBuffer::new(workspace);
        Self { matrix, symbolic, numeric: NumericLu::new(), workspace }
    }
}

impl Factorisation for Theirs<'_> {
    fn factor(&mut self) -> bool {
        let matrix = SparseColMatRef::new(self.matrix.symbolic(), &self.matrix.values);
        let workspace = MemStack::new(&mut self.workspace);
        self.symbolic
            .factorize_numeric_lu(&mut self.numeric, matrix, Par::Seq, workspace, default())
            .is_ok()
    }

    fn solve(&mut self, x: &mut [f64]) {
        let factors = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        let right = MatMut::from_column_major_slice_mut(x, self.matrix.size, 1);
        let workspace = MemStack::new(&mut self.workspace);
        factors.solve_in_place_with_conj(Conj::No, right, Par::Seq, workspace);
    }
}

/// Which of faer's factorisations of a definite matrix is meant.
#[derive(Clone, Copy)]
pub enum Factors {
    /// `LLᵀ`.
    Cholesky,
    /// `LDLᵀ`.
    WithDiagonal,
}

/// A factorisation of a definite matrix with AMD.
pub struct TheirsDefinite<'a> {
    lower: &'a Columns,
    kind: Factors,
    symbolic: SymbolicCholesky<usize>,
    factors: Vec<f64>,
    workspace: MemBuffer,
}

impl<'a> TheirsDefinite<'a> {
    /// The analysis of the pattern of a lower triangle, with room for the factors.
    pub fn new(lower: &'a Columns, kind: Factors, threshold: SupernodalThreshold) -> Self {
        let parameters =
            CholeskySymbolicParams { supernodal_flop_ratio_threshold: threshold, ..default() };
        let (pattern, order) = (lower.symbolic(), SymmetricOrdering::Amd);
        let symbolic =
            factorize_symbolic_cholesky(pattern, Side::Lower, order, parameters).expect("analysis");
        let factorisation = match kind {
            Factors::Cholesky => symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, default()),
            Factors::WithDiagonal => {
                symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, default())
            }
        };
        let solution = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let workspace = MemBuffer::new(factorisation.or(solution));
        let factors = vec![0.0; symbolic.len_val()];
        Self { lower, kind, symbolic, factors, workspace }
    }
}

impl Factorisation for TheirsDefinite<'_> {
    fn factor(&mut self) -> bool {
        let Self { lower, kind, symbolic, factors, workspace } = self;
        let matrix = SparseColMatRef::new(lower.symbolic(), &lower.values);
        let (side, workspace) = (Side::Lower, MemStack::new(workspace));
        match kind {
            Factors::Cholesky => {
                let unregularised = LltRegularization::default();
                let done = symbolic.factorize_numeric_llt(
                    factors,
                    matrix,
                    side,
                    unregularised,
                    Par::Seq,
                    workspace,
                    default(),
                );
                done.is_ok()
            }
            Factors::WithDiagonal => {
                let unregularised = LdltRegularization::default();
                let done = symbolic.factorize_numeric_ldlt(
                    factors,
                    matrix,
                    side,
                    unregularised,
                    Par::Seq,
                    workspace,
                    default(),
                );
                done.is_ok()
            }
        }
    }

    fn solve(&mut self, x: &mut [f64]) {
        let Self { lower, kind, symbolic, factors, workspace } = self;
        let right = MatMut::from_column_major_slice_mut(x, lower.size, 1);
        let workspace = MemStack::new(workspace);
        match kind {
            Factors::Cholesky => LltRef::new(symbolic, factors).solve_in_place_with_conj(
                Conj::No,
                right,
                Par::Seq,
                workspace,
            ),
            Factors::WithDiagonal => LdltRef::new(symbolic, factors).solve_in_place_with_conj(
                Conj::No,
                right,
                Par::Seq,
                workspace,
            ),
        }
    }
}

/// Dense LU with partial pivoting.
pub struct TheirsDense<'a> {
    entries: &'a [f64],
    factors: Mat<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    workspace: MemBuffer,
}

impl<'a> TheirsDense<'a> {
    /// Of a matrix whose entries are given column by column.
    pub fn new(entries: &'a [f64], size: usize) -> Self {
        let workspace = factor::lu_in_place_scratch::<usize, f64>(size, size, Par::Seq, default());
        let workspace =
            workspace.or(solve::solve_in_place_scratch::<usize, f64>(size, 1, Par::Seq));
        Self {
            entries,
            factors: Mat::zeros(size, size),
            forward: vec![0; size],
            inverse: vec![0; size],
            workspace: MemBuffer::new(workspace),
        }
    }
}

impl Factorisation for TheirsDense<'_> {
    fn factor(&mut self) -> bool {
        let size = self.forward.len();
        for (j, column) in self.entries.chunks_exact(size).enumerate() {
            for (i, value) in column.iter().enumerate() {
                self.factors[(i, j)] = *value;
            }
        }
        let workspace = MemStack::new(&mut self.workspace);
        let (forward, inverse) = (&mut self.forward, &mut self.inverse);
        factor::lu_in_place(
            self.factors.as_mut(),
            forward,
            inverse,
            Par::Seq,
            workspace,
            default(),
        );
        true
    }

    fn solve(&mut self, x: &mut [f64]) {
        let size = self.forward.len();
        let exchanges = PermRef::new_checked(&self.forward, &self.inverse, size);
        let right = MatMut::from_column_major_slice_mut(x, size, 1);
        let workspace = MemStack::new(&mut self.workspace);
        let factors = self.factors.as_ref();
        solve::solve_in_place(factors, factors, exchanges, right, Par::Seq, workspace);
    }
}
