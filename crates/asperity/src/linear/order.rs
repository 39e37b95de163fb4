//! Orderings and elimination trees of symmetric patterns.

/// The neighbours of every node, itself included: `neighbours[starts[i]..starts[i + 1]]`, symmetric.
pub(super) struct Graph<'a> {
    pub(super) starts: &'a [usize],
    pub(super) neighbours: &'a [usize],
}

/// A fill-reducing order whose elimination tree is numbered in postorder.
pub(super) struct Order {
    /// Node at every position.
    pub(super) node: Vec<usize>,
    /// Position of every node.
    pub(super) position: Vec<usize>,
    /// Parent of every position in the elimination tree, `NONE` for roots.
    pub(super) parent: Vec<usize>,
}

pub(super) const NONE: usize = usize::MAX;

impl Graph<'_> {
    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn of(&self, node: usize) -> &[usize] {
        &self.neighbours[self.starts[node]..self.starts[node + 1]]
    }

    /// Approximate minimum degree (\[AmestoyDavisDuff1996\]), then a postorder of the tree. Nested dissection does not save
    /// operations on the matrices of contact problems.
    pub(super) fn order(&self) -> Order {
        let n = self.len();
        let control = amd::Control::default();
        let natural = || (0..n).collect::<Vec<usize>>();
        let found = amd::order(n, self.starts, self.neighbours, &control);
        let node = found.map_or_else(|_| natural(), |(order, _, _)| order);
        let position = inverse(&node);
        let parent = self.elimination_tree(&node, &position);
        let node: Vec<usize> = postorder(&parent).into_iter().map(|k| node[k]).collect();
        let position = inverse(&node);
        let parent = self.elimination_tree(&node, &position);
        Order { node, position, parent }
    }

    /// Liu's algorithm with path compression.
    fn elimination_tree(&self, node: &[usize], position: &[usize]) -> Vec<usize> {
        let n = self.len();
        let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
        for (k, &own) in node.iter().enumerate() {
            for &neighbour in self.of(own) {
                let mut i = position[neighbour];
                while i < k {
                    let next = ancestor[i];
                    ancestor[i] = k;
                    if next == NONE {
                        parent[i] = k;
                        break;
                    }
                    i = next;
                }
            }
        }
        parent
    }
}

fn inverse(order: &[usize]) -> Vec<usize> {
    let mut position = vec![0; order.len()];
    for (k, &node) in order.iter().enumerate() {
        position[node] = k;
    }
    position
}

/// The positions with every child before its parent and subtrees contiguous.
fn postorder(parent: &[usize]) -> Vec<usize> {
    let n = parent.len();
    let (mut head, mut next) = (vec![NONE; n], vec![NONE; n]);
    for k in (0..n).rev() {
        if parent[k] != NONE {
            next[k] = head[parent[k]];
            head[parent[k]] = k;
        }
    }
    let (mut order, mut stack) = (Vec::with_capacity(n), Vec::new());
    for root in (0..n).filter(|&k| parent[k] == NONE) {
        stack.push(root);
        while let Some(&k) = stack.last() {
            let child = head[k];
            if child == NONE {
                order.push(k);
                stack.pop();
            } else {
                head[k] = next[child];
                stack.push(child);
            }
        }
    }
    order
}
