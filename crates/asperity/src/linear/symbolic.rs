//! What of a factorisation depends on the pattern only.

use super::order::{Graph, NONE};
use crate::contact::BlockMatrix;

/// A block of the matrix and where it goes in its front.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placement {
    /// Block row, and number of the block within it.
    pub(super) block: usize,
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// A set of consecutive columns with the same pattern, eliminated together in a dense front.
#[derive(Debug, Clone, Default)]
pub(super) struct Front {
    /// Columns eliminated here, the first of them in the permuted order.
    pub(super) pivots: usize,
    pub(super) first: usize,
    /// Number of rows of the front, pivots included.
    pub(super) size: usize,
    /// Permuted rows beyond the pivots.
    pub(super) rows: Vec<usize>,
    /// Where the rows beyond the pivots go in the parent's front.
    pub(super) into_parent: Vec<usize>,
    /// Children; their contributions are the last ones on the stack when this front comes.
    pub(super) children: Vec<usize>,
    pub(super) placements: Vec<Placement>,
}

/// Ordering, fronts and sizes for all matrices with one block pattern.
#[derive(Debug, Clone, Default)]
pub(crate) struct Symbolic {
    pub(super) fronts: Vec<Front>,
    /// Permuted position of every row.
    pub(super) position: Vec<usize>,
    /// Largest front, and entries of all contribution blocks that wait at one time.
    pub(super) largest: usize,
    pub(super) waiting: usize,
    /// Floating-point operations of a factorisation.
    pub(crate) operations: f64,
}

/// Consecutive columns of different patterns are joined while at most a tenth of the entries are added zeros, and up to
/// so many columns in any case: smaller fronts would not fill the tiles of `dense.rs`.
const NARROW: usize = 12;

impl Symbolic {
    /// For a matrix whose block pattern is symmetric.
    pub(crate) fn new(matrix: &BlockMatrix) -> Self {
        let n = matrix.contacts();
        let (starts, neighbours) = matrix.pattern();
        let graph = Graph { starts, neighbours };
        let order = graph.order();
        let width: Vec<usize> = order.node.iter().map(|&node| matrix.size(node)).collect();
        let mut first = vec![0];
        for w in &width {
            first.push(first[first.len() - 1] + w);
        }
        // Rows of every column, by the paths of its row's nonzeros up the tree.
        let mut count = width.clone();
        let mut mark = vec![NONE; n];
        for k in 0..n {
            mark[k] = k;
            for &neighbour in graph.of(order.node[k]) {
                let mut i = order.position[neighbour];
                while i < k && mark[i] != k {
                    count[i] += width[k];
                    mark[i] = k;
                    i = order.parent[i];
                }
            }
        }
        let bounds = groups(&order.parent, &width, &mut count);
        let mut symbolic = Self::default();
        let mut front_of = vec![0; n];
        for (s, pair) in bounds.windows(2).enumerate() {
            front_of[pair[0]..pair[1]].fill(s);
        }
        let mut beyond: Vec<Vec<usize>> = Vec::with_capacity(bounds.len());
        mark.fill(NONE);
        for (s, pair) in bounds.windows(2).enumerate() {
            let mut rows = Vec::new();
            let mut add = |i: usize, rows: &mut Vec<usize>| {
                if i >= pair[1] && mark[i] != s {
                    mark[i] = s;
                    rows.push(i);
                }
            };
            for k in pair[0]..pair[1] {
                for &neighbour in graph.of(order.node[k]) {
                    add(order.position[neighbour], &mut rows);
                }
            }
            let children = symbolic.fronts.get(s).map_or(&[][..], |f: &Front| &f.children[..]);
            for &child in children {
                for &i in &beyond[child] {
                    add(i, &mut rows);
                }
            }
            rows.sort_unstable();
            let pivots = first[pair[1]] - first[pair[0]];
            let scalars: Vec<usize> = rows.iter().flat_map(|&i| first[i]..first[i + 1]).collect();
            if symbolic.fronts.len() <= s {
                symbolic.fronts.resize_with(bounds.len() - 1, Front::default);
            }
            if let Some(&parent) = rows.first() {
                symbolic.fronts[front_of[parent]].children.push(s);
            }
            let front = &mut symbolic.fronts[s];
            (front.pivots, front.first) = (pivots, first[pair[0]]);
            front.size = pivots + scalars.len();
            front.rows = scalars;
            beyond.push(rows);
        }
        symbolic.position = vec![0; matrix.rows()];
        for (k, &node) in order.node.iter().enumerate() {
            let offset = matrix.offsets()[node];
            for a in 0..width[k] {
                symbolic.position[offset + a] = first[k] + a;
            }
        }
        symbolic.place(matrix, &order.position, &first, &front_of);
        symbolic.relate();
        symbolic.measure();
        symbolic
    }

    /// Where the blocks of the matrix go.
    fn place(&mut self, matrix: &BlockMatrix, position: &[usize], first: &[usize], of: &[usize]) {
        let mut block = 0;
        for i in 0..matrix.contacts() {
            for &j in matrix.neighbours(i) {
                let (row, column) = (position[i], position[j]);
                let front = &mut self.fronts[of[row.min(column)]];
                let local = |scalar: usize| match scalar - front.first {
                    at if at < front.pivots => at,
                    _ => front.pivots + front.rows.partition_point(|&r| r < scalar),
                };
                let (row, column) = (local(first[row]), local(first[column]));
                let (rows, columns) = (matrix.size(i), matrix.size(j));
                front.placements.push(Placement { block, row, column, rows, columns });
                block += 1;
            }
        }
    }

    /// Where the rows of every front go in its parent's.
    fn relate(&mut self) {
        for s in 0..self.fronts.len() {
            for child in self.fronts[s].children.clone() {
                let parent = &self.fronts[s];
                let local = |&scalar: &usize| match scalar - parent.first {
                    at if at < parent.pivots => at,
                    _ => parent.pivots + parent.rows.partition_point(|&r| r < scalar),
                };
                self.fronts[child].into_parent =
                    self.fronts[child].rows.iter().map(local).collect();
            }
        }
    }

    /// Sizes of buffers and cost.
    fn measure(&mut self) {
        let mut waiting = 0_usize;
        for s in 0..self.fronts.len() {
            let Front { pivots, size, children, .. } = &self.fronts[s];
            let taken: usize = children
                .iter()
                .map(|&c| self.fronts[c].rows.len() * self.fronts[c].rows.len())
                .sum();
            let rest = size - pivots;
            waiting = waiting - taken + rest * rest;
            self.waiting = self.waiting.max(waiting);
            self.largest = self.largest.max(*size);
            let (k, r) = (*pivots as f64, rest as f64);
            self.operations += 2.0 / 3.0 * k * k * k + 2.0 * k * k * r + 2.0 * k * r * r;
        }
    }
}

/// Bounds of the groups of consecutive columns that are eliminated together.
fn groups(parent: &[usize], width: &[usize], count: &mut [usize]) -> Vec<usize> {
    let n = parent.len();
    let mut children = vec![0; n];
    for &p in parent.iter().filter(|&&p| p != NONE) {
        children[p] += 1;
    }
    let same = |k: usize, count: &[usize]| {
        parent[k - 1] == k && count[k - 1] == count[k] + width[k - 1] && children[k] == 1
    };
    let mut starts: Vec<usize> = (0..n).filter(|&k| k == 0 || !same(k, count)).collect();
    starts.push(n);
    let mut bounds: Vec<usize> = Vec::with_capacity(starts.len());
    let (mut columns, mut zeros) = (0, 0);
    for pair in starts.windows(2) {
        let own: usize = width[pair[0]..pair[1]].iter().sum();
        if let Some(&group) = bounds.last()
            && parent[pair[0] - 1] == pair[0]
        {
            let joined = columns + count[pair[0]];
            // Those of all groups that were joined: along a path of the tree each of many would add a few.
            let all = zeros + columns * (joined - count[group]);
            let few = all as f64 <= 0.1 * ((columns + own) * joined) as f64;
            if few || columns + own <= NARROW {
                count[group] = joined;
                columns += own;
                zeros = all;
                continue;
            }
        }
        bounds.push(pair[0]);
        (columns, zeros) = (own, 0);
    }
    bounds.push(n);
    bounds
}
