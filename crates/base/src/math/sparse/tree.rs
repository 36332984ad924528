//! Supernode tree: the columns that are eliminated together, and the rows of their factors.
//!
//! Unknowns with the same neighbours are combined first, and the graph of these groups is ordered. The rows of a factor
//! column are those of the matrix column and of its children, which are the columns whose first row it is. Columns with
//! the same rows form one *supernode*, a dense panel. Small supernodes are merged with their parent if that adds few
//! zeros (Davis, Rajamanickam and Sid-Lakhdar 2016, Acta Numerica 25, 383, sections 4 and 9; limits as in CHOLMOD: Chen
//! et al. 2008, ACM TOMS 35, 22).
use std::ops::Range;

use super::ordering::{Graph, minimum_degree};

/// Index that means "none".
const NONE: u32 = u32::MAX;
/// Maximum number of columns of a merged node, with the fraction of zeros that its panel may have.
const ALLOWED_ZEROS: [(usize, f64); 4] = [(4, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// Nodes of the tree, children before parents, and the elimination order of the unknowns.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    /// Unknown at each position of the order.
    pub(super) order: Vec<u32>,
    /// First column of each node, followed by the number of columns.
    first: Vec<u32>,
    /// Start of the rows of each node, followed by the number of all rows.
    start: Vec<usize>,
    /// Rows of each node below its own columns, ascending.
    rows: Vec<u32>,
    /// Parent of each node.
    parent: Vec<u32>,
    /// Children of each node, ascending.
    pub(super) children: Vec<Vec<u32>>,
}

impl Tree {
    /// Supernode tree of the symmetric matrix whose lower triangle has these columns.
    pub(super) fn of(first: &[usize], row: &[usize]) -> Self {
        let (members, graph) = compressed(first, row);
        let mut nodes = supernodes(&graph, &minimum_degree(&graph));
        join_small(&mut nodes);
        numbered(&nodes, &members)
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.parent.len()
    }

    /// True if node `s` has no parent.
    pub(super) fn is_root(&self, s: usize) -> bool {
        self.parent[s] == NONE
    }

    /// Columns of node `s`.
    pub(super) fn columns(&self, s: usize) -> Range<usize> {
        self.first[s] as usize..self.first[s + 1] as usize
    }

    /// Rows of node `s` below its own columns.
    pub(super) fn rows(&self, s: usize) -> &[u32] {
        &self.rows[self.start[s]..self.start[s + 1]]
    }

    /// Number of multiplications to eliminate the columns of node `s`.
    pub(super) fn work(&self, s: usize) -> f64 {
        let (k, r) = (self.columns(s).len() as f64, self.rows(s).len() as f64);
        k * (r * r + k * r + k * k / 3.0)
    }
}

/// Groups of unknowns with the same neighbours, and the graph of these groups.
fn compressed(first: &[usize], row: &[usize]) -> (Vec<Vec<u32>>, Graph) {
    let n = first.len().saturating_sub(1);
    // sums of hashes of the neighbours: two unknowns with equal sums by coincidence get the neighbours of both
    let mix = |i: usize| {
        (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
    };
    let mut sums: Vec<(u64, u32)> = (0..n).map(|i| (mix(i), i as u32)).collect();
    for c in 0..n {
        for r in row[first[c]..first[c + 1]].iter().copied().filter(|r| *r != c) {
            sums[c].0 = sums[c].0.wrapping_add(mix(r));
            sums[r].0 = sums[r].0.wrapping_add(mix(c));
        }
    }
    sums.sort_unstable();
    let mut members: Vec<Vec<u32>> =
        sums.chunk_by(|a, b| a.0 == b.0).map(|same| same.iter().map(|s| s.1).collect()).collect();
    members.sort_unstable_by_key(|m| m[0]);
    let mut group = vec![0u32; n];
    for (g, all) in members.iter().enumerate() {
        all.iter().for_each(|i| group[*i as usize] = g as u32);
    }
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); members.len()];
    let mut seen = vec![NONE; members.len()];
    for (g, all) in members.iter().enumerate() {
        seen[g] = g as u32;
        for c in all.iter().map(|c| *c as usize) {
            for r in &row[first[c]..first[c + 1]] {
                let h = group[*r] as usize;
                if seen[h] != g as u32 {
                    seen[h] = g as u32;
                    lists[g].push(h as u32);
                    lists[h].push(g as u32);
                }
            }
        }
    }
    let mut graph =
        Graph { first: vec![0], near: Vec::new(), weight: members.iter().map(|m| m.len() as u32).collect() };
    for mut list in lists {
        list.sort_unstable();
        list.dedup();
        graph.near.extend(list);
        graph.first.push(graph.near.len());
    }
    (members, graph)
}

/// Columns that are eliminated together, as groups of unknowns.
#[derive(Clone, Debug, Default)]
struct Node {
    /// Groups of the columns, in their order.
    columns: Vec<u32>,
    /// Groups of the rows below the columns.
    rows: Vec<u32>,
    parent: u32,
    children: Vec<u32>,
    /// Number of unknowns of the columns, and of the rows below.
    width: usize,
    below: usize,
    /// Number of zeros stored in the panel.
    zeros: f64,
    joined: bool,
}

/// Nodes of columns with the same rows; a parent follows its children in the order of the last columns.
fn supernodes(graph: &Graph, order: &[u32]) -> Vec<Node> {
    let mut place = vec![0u32; order.len()];
    order.iter().enumerate().for_each(|(k, g)| place[*g as usize] = k as u32);
    let weight = |g: &u32| graph.weight[*g as usize] as usize;
    let mut nodes: Vec<Node> = Vec::new();
    // nodes whose first row below their columns is the given column
    let mut under: Vec<Vec<u32>> = vec![Vec::new(); order.len()];
    let mut seen = vec![NONE; order.len()];
    for (k, g) in order.iter().enumerate() {
        seen[*g as usize] = k as u32;
        let mut rows = Vec::new();
        let mut add = |list: &[u32]| {
            for h in list {
                if place[*h as usize] > k as u32 && seen[*h as usize] != k as u32 {
                    seen[*h as usize] = k as u32;
                    rows.push(*h);
                }
            }
        };
        add(graph.of(*g as usize));
        let mut children = std::mem::take(&mut under[k]);
        children.iter().for_each(|c| add(&nodes[*c as usize].rows));
        let same = children.iter().position(|c| nodes[*c as usize].rows.len() == rows.len() + 1);
        let s = match same {
            Some(at) => children.remove(at),
            None => {
                nodes.push(Node { parent: NONE, ..Node::default() });
                nodes.len() as u32 - 1
            }
        };
        children.iter().for_each(|c| nodes[*c as usize].parent = s);
        let node = &mut nodes[s as usize];
        node.children.extend(children);
        node.columns.push(*g);
        node.width += weight(g);
        node.below = rows.iter().map(weight).sum();
        if let Some(next) = rows.iter().map(|h| place[*h as usize]).min() {
            under[next as usize].push(s);
        }
        node.rows = rows;
    }
    nodes
}

/// Nodes in an order from the leaves up: children before parents.
fn from_below(nodes: &[Node]) -> Vec<u32> {
    let mut open: Vec<u32> =
        (0..nodes.len() as u32).filter(|s| nodes[*s as usize].parent == NONE && !nodes[*s as usize].joined).collect();
    let mut order = Vec::with_capacity(nodes.len());
    while let Some(s) = open.pop() {
        order.push(s);
        open.extend(nodes[s as usize].children.iter().filter(|c| !nodes[**c as usize].joined));
    }
    order.reverse();
    order
}

/// Merges nodes with their parents if the panel then has few additional zeros.
fn join_small(nodes: &mut [Node]) {
    for s in from_below(nodes) {
        let p = nodes[s as usize].parent;
        if p == NONE {
            continue;
        }
        let (node, parent) = (&nodes[s as usize], &nodes[p as usize]);
        let width = node.width + parent.width;
        let zeros = node.zeros + parent.zeros + (node.width * (parent.width + parent.below - node.below)) as f64;
        let entries = 0.5 * (width * (width + 1)) as f64 + (width * parent.below) as f64;
        let most = ALLOWED_ZEROS.iter().find(|most| width <= most.0).map_or(0.0, |most| most.1);
        if zeros > most * entries {
            continue;
        }
        let node = std::mem::replace(&mut nodes[s as usize], Node { joined: true, ..Node::default() });
        node.children.iter().for_each(|c| nodes[*c as usize].parent = p);
        let parent = &mut nodes[p as usize];
        parent.children.extend(node.children);
        parent.columns.splice(0..0, node.columns);
        (parent.width, parent.zeros) = (width, zeros);
    }
}

/// The tree in terms of unknowns instead of groups.
fn numbered(nodes: &[Node], members: &[Vec<u32>]) -> Tree {
    let order = from_below(nodes);
    let mut tree = Tree { first: vec![0], start: vec![0], ..Tree::default() };
    let mut number = vec![NONE; nodes.len()];
    let mut places = vec![0u32; members.len()];
    for (k, s) in order.iter().enumerate() {
        number[*s as usize] = k as u32;
        for g in &nodes[*s as usize].columns {
            places[*g as usize] = tree.order.len() as u32;
            tree.order.extend(&members[*g as usize]);
        }
        tree.first.push(tree.order.len() as u32);
    }
    tree.children = vec![Vec::new(); order.len()];
    for (k, s) in order.iter().enumerate() {
        let node = &nodes[*s as usize];
        let from = tree.rows.len();
        tree.rows.extend(node.rows.iter().flat_map(|g| {
            let start = places[*g as usize];
            start..start + members[*g as usize].len() as u32
        }));
        tree.rows[from..].sort_unstable();
        tree.start.push(tree.rows.len());
        let parent = if node.parent == NONE { NONE } else { number[node.parent as usize] };
        tree.parent.push(parent);
        if parent != NONE {
            tree.children[parent as usize].push(k as u32);
        }
    }
    tree
}
