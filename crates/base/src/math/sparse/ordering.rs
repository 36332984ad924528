//! Fill-reducing elimination order: approximate minimum degree on the quotient graph.
//!
//! Elimination of a variable connects all its neighbours. The quotient graph stores such a clique as one *element*, a
//! list of variables, instead of its edges. An element that is contained in another is removed, and variables with the
//! same neighbours are merged into one with their total weight. The variable with the smallest bound on its degree is
//! eliminated next (Amestoy, Davis and Duff 1996, SIAM J. Matrix Anal. Appl. 17, 886; Davis 2006, *Direct Methods for
//! Sparse Linear Systems*, section 7.1). Ties are resolved by index, so that the order of a graph is unique.

/// Index that means "none".
const NONE: u32 = u32::MAX;

/// Undirected graph, each vertex of which represents one or more unknowns.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    /// Start of the neighbours of each vertex, followed by the number of all neighbours.
    pub(super) first: Vec<usize>,
    /// Neighbours of all vertices.
    pub(super) near: Vec<u32>,
    /// Number of unknowns of each vertex.
    pub(super) weight: Vec<u32>,
}

impl Graph {
    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.weight.len()
    }

    /// Neighbours of vertex `i`.
    pub(super) fn of(&self, i: usize) -> &[u32] {
        &self.near[self.first[i]..self.first[i + 1]]
    }
}

/// Vertices in their order of elimination.
pub(super) fn minimum_degree(graph: &Graph) -> Vec<u32> {
    let mut quotient = Quotient::of(graph);
    let mut pivots = Vec::new();
    while let Some(pivot) = quotient.next_pivot() {
        quotient.eliminate(pivot);
        pivots.push(pivot);
    }
    // a pivot is followed by the variables merged into it, and by those merged into these
    let (mut order, mut open) = (Vec::with_capacity(graph.len()), Vec::new());
    for pivot in pivots {
        open.push(pivot);
        while let Some(i) = open.pop() {
            order.push(i as u32);
            open.extend(quotient.joined[i].iter().rev().map(|j| *j as usize));
        }
    }
    order
}

/// State of a graph during the elimination.
struct Quotient {
    /// Number of unknowns of each variable; zero for eliminated or merged variables.
    weight: Vec<u32>,
    /// Neighbours of each variable by edges that belong to no element.
    edges: Vec<Vec<u32>>,
    /// Elements of each variable.
    elements: Vec<Vec<u32>>,
    /// Variables of each element; elements have the index of their pivot.
    variables: Vec<Vec<u32>>,
    /// Number of unknowns of each element; zero for removed elements.
    size: Vec<u32>,
    /// Upper bound on the degree of each variable, in unknowns.
    degree: Vec<u32>,
    /// Variables that were merged into each one.
    joined: Vec<Vec<u32>>,
    /// Number of unknowns not yet eliminated.
    left: u32,
    /// Variables of each degree, as doubly linked lists.
    head: Vec<u32>,
    links: Vec<[u32; 2]>,
    smallest: usize,
    /// Marks of variables and, for elements, of their unknowns outside the new element.
    mark: Vec<u32>,
    stamp: u32,
    outside: Vec<(u32, u32)>,
}

impl Quotient {
    fn of(graph: &Graph) -> Self {
        let n = graph.len();
        let left: u32 = graph.weight.iter().sum();
        let degree = |i: usize| graph.of(i).iter().map(|j| graph.weight[*j as usize]).sum();
        let mut quotient = Self {
            weight: graph.weight.clone(),
            edges: (0..n).map(|i| graph.of(i).to_vec()).collect(),
            elements: vec![Vec::new(); n],
            variables: vec![Vec::new(); n],
            size: vec![0; n],
            degree: (0..n).map(degree).collect(),
            joined: vec![Vec::new(); n],
            left,
            head: vec![NONE; left as usize + 1],
            links: vec![[NONE; 2]; n],
            smallest: 0,
            mark: vec![0; n],
            stamp: 0,
            outside: vec![(0, 0); n],
        };
        (0..n).rev().for_each(|i| quotient.enter(i));
        quotient
    }

    /// Inserts variable `i` at the head of the list of its degree.
    fn enter(&mut self, i: usize) {
        let degree = self.degree[i] as usize;
        let next = std::mem::replace(&mut self.head[degree], i as u32);
        self.links[i] = [NONE, next];
        if next != NONE {
            self.links[next as usize][0] = i as u32;
        }
        self.smallest = self.smallest.min(degree);
    }

    /// Removes variable `i` from its list.
    fn leave(&mut self, i: usize) {
        let [before, next] = self.links[i];
        match before {
            NONE => self.head[self.degree[i] as usize] = next,
            before => self.links[before as usize][1] = next,
        }
        if next != NONE {
            self.links[next as usize][0] = before;
        }
    }

    /// Removes a variable of smallest degree from its list and returns it.
    fn next_pivot(&mut self) -> Option<usize> {
        while self.smallest < self.head.len() {
            match self.head[self.smallest] {
                NONE => self.smallest += 1,
                pivot => {
                    self.leave(pivot as usize);
                    return Some(pivot as usize);
                }
            }
        }
        None
    }

    /// Makes an element of the neighbours of `pivot`, and updates the adjacent variables and elements.
    fn eliminate(&mut self, pivot: usize) {
        let mut members = self.members(pivot);
        let size: u32 = members.iter().map(|i| self.weight[*i as usize]).sum();
        self.measure_overlaps(&members);
        let mut hashes = Vec::with_capacity(members.len());
        for i in &members {
            let i = *i as usize;
            self.leave(i);
            match self.update(i, pivot, size) {
                Some(hash) => hashes.push((hash, i as u32)),
                None => self.join(i, pivot),
            }
        }
        self.join_alike(&mut hashes);
        members.retain(|i| self.weight[*i as usize] > 0);
        for i in &members {
            self.enter(*i as usize);
        }
        self.left -= std::mem::take(&mut self.weight[pivot]);
        self.size[pivot] = members.iter().map(|i| self.weight[*i as usize]).sum();
        self.variables[pivot] = members;
    }

    /// Neighbours of `pivot`, marked; the elements that contain it are removed.
    fn members(&mut self, pivot: usize) -> Vec<u32> {
        self.stamp += 1;
        self.mark[pivot] = self.stamp;
        let mut members = Vec::new();
        let mut all = vec![std::mem::take(&mut self.edges[pivot])];
        for e in std::mem::take(&mut self.elements[pivot]) {
            self.size[e as usize] = 0;
            all.push(std::mem::take(&mut self.variables[e as usize]));
        }
        for i in all.into_iter().flatten() {
            if self.weight[i as usize] > 0 && self.mark[i as usize] != self.stamp {
                self.mark[i as usize] = self.stamp;
                members.push(i);
            }
        }
        members
    }

    /// Counts the unknowns of each adjacent element that are outside of `members`.
    fn measure_overlaps(&mut self, members: &[u32]) {
        for i in members {
            for e in &self.elements[*i as usize] {
                let (e, weight) = (*e as usize, self.weight[*i as usize]);
                if self.size[e] > 0 {
                    let (stamp, outside) = self.outside[e];
                    let before = if stamp == self.stamp { outside } else { self.size[e] };
                    self.outside[e] = (self.stamp, before - weight);
                }
            }
        }
    }

    /// Updates lists and degree of variable `i` in the new element of `pivot`, whose variables have `size` unknowns.
    /// Returns a hash that is equal for variables with the same neighbours; `None` if all neighbours are in the
    /// element.
    fn update(&mut self, i: usize, pivot: usize, size: u32) -> Option<u64> {
        let (mut degree, mut hash) = (0, 0u64);
        let Self { elements, edges, outside, size: sizes, weight, mark, stamp, .. } = self;
        elements[i].retain(|e| {
            let beyond = outside[*e as usize].1;
            let keep = sizes[*e as usize] > 0 && beyond > 0;
            if keep {
                degree += beyond;
                hash = hash.wrapping_add(u64::from(*e));
            }
            keep
        });
        edges[i].retain(|j| {
            let keep = weight[*j as usize] > 0 && mark[*j as usize] != *stamp;
            if keep {
                degree += weight[*j as usize];
                hash = hash.wrapping_add(u64::from(*j));
            }
            keep
        });
        if degree == 0 {
            return None;
        }
        elements[i].push(pivot as u32);
        let others = size - weight[i];
        self.degree[i] = (degree.min(self.degree[i]) + others).min(self.left - self.weight[pivot] - self.weight[i]);
        Some(hash)
    }

    /// Merges variable `j` into `i`.
    fn join(&mut self, j: usize, i: usize) {
        self.weight[i] += std::mem::take(&mut self.weight[j]);
        self.joined[i].push(j as u32);
        self.edges[j] = Vec::new();
        self.elements[j] = Vec::new();
    }

    /// Merges variables of one element that have the same neighbours.
    fn join_alike(&mut self, hashes: &mut [(u64, u32)]) {
        hashes.sort_unstable();
        for same in hashes.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            for (k, (_, i)) in same.iter().enumerate() {
                let i = *i as usize;
                if self.weight[i] == 0 {
                    continue;
                }
                self.stamp += 1;
                let stamp = self.stamp;
                // element indices are indices of pivots, which are no longer variables
                self.edges[i].iter().chain(&self.elements[i]).for_each(|j| self.mark[*j as usize] = stamp);
                for (_, j) in &same[k + 1..] {
                    let j = *j as usize;
                    let alike = self.weight[j] > 0
                        && self.edges[i].len() == self.edges[j].len()
                        && self.elements[i].len() == self.elements[j].len()
                        && self.edges[j].iter().chain(&self.elements[j]).all(|e| self.mark[*e as usize] == stamp);
                    if alike {
                        self.degree[i] = self.degree[i].saturating_sub(self.weight[j]);
                        self.join(j, i);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Graph of a lattice of `n` × `n` vertices.
    fn lattice(n: usize) -> Graph {
        let mut graph = Graph { first: vec![0], near: Vec::new(), weight: vec![1; n * n] };
        for i in 0..n * n {
            let (x, y) = (i % n, i / n);
            let sides =
                [(x > 0, i.wrapping_sub(1)), (x + 1 < n, i + 1), (y > 0, i.wrapping_sub(n)), (y + 1 < n, i + n)];
            graph.near.extend(sides.iter().filter(|s| s.0).map(|s| s.1 as u32));
            graph.first.push(graph.near.len());
        }
        graph
    }

    #[test]
    fn every_vertex_is_eliminated_once_and_a_star_keeps_its_centre_to_the_end() {
        let mut order = minimum_degree(&lattice(20));
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(k, i)| k == *i as usize) && order.len() == 400);
        let star =
            Graph { first: vec![0, 5, 6, 7, 8, 9, 10], near: vec![1, 2, 3, 4, 5, 0, 0, 0, 0, 0], weight: vec![1; 6] };
        assert!(minimum_degree(&star).iter().position(|i| *i == 0).unwrap() >= 4);
    }
}
