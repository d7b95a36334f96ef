//! Nested dissection: an elimination order in which a mesh falls apart into halves, quarters, ...
//! (George, SIAM J. Numer. Anal. 10, 1973), from the graph alone.

use std::ops::Range;

use super::Pattern;

/// Parts of at most this many nodes are not cut further.
const LEAF: usize = 48;

/// A separator or a leaf of the dissection. Nodes are numbered by elimination.
#[derive(Clone, Debug)]
pub(super) struct Separator {
    /// Its nodes.
    pub own: Range<usize>,
    /// Later nodes coupled with its subtree, increasing.
    pub boundary: Vec<u32>,
    /// The parts it was made to separate; they come just before it, each with its subtree.
    pub children: Vec<usize>,
    /// The first part of its subtree.
    pub first: usize,
}

/// An elimination order and its tree, children before parents.
#[derive(Clone, Debug)]
pub(super) struct Dissection {
    /// Node eliminated at each place.
    pub order: Vec<u32>,
    /// Place of each node.
    pub rank: Vec<u32>,
    pub parts: Vec<Separator>,
}

/// Distance of nodes that a search has not reached.
const FAR: u32 = u32::MAX;

struct Cutter {
    neighbours: Vec<Vec<u32>>,
    /// Number of the set that a node is in at present.
    set: Vec<u32>,
    sets: u32,
    distance: [Vec<u32>; 2],
    order: Vec<u32>,
    parts: Vec<Separator>,
}

impl Dissection {
    /// Dissects the graph of a pattern (taken as undirected).
    pub fn new(pattern: &Pattern) -> Self {
        let rows = pattern.rows();
        let mut neighbours: Vec<Vec<u32>> = (0..rows).map(|i| pattern.column[pattern.row(i)].to_vec()).collect();
        for i in 0..rows {
            for &j in &pattern.column[pattern.row(i)] {
                if pattern.position(j as usize, i).is_none() {
                    neighbours[j as usize].push(i as u32);
                }
            }
        }
        let mut cutter = Cutter {
            neighbours,
            set: vec![0; rows],
            sets: 0,
            distance: [vec![FAR; rows], vec![FAR; rows]],
            order: Vec::with_capacity(rows),
            parts: Vec::new(),
        };
        cutter.cut((0..rows as u32).collect());
        let Cutter { neighbours, order, mut parts, .. } = cutter;
        let mut rank = vec![0u32; rows];
        for (place, &node) in order.iter().enumerate() {
            rank[node as usize] = place as u32;
        }
        for p in 0..parts.len() {
            let end = parts[p].own.end as u32;
            let mut boundary: Vec<u32> = order[parts[p].own.clone()]
                .iter()
                .flat_map(|&node| neighbours[node as usize].iter().map(|&j| rank[j as usize]))
                .chain(parts[p].children.iter().flat_map(|&c| parts[c].boundary.iter().copied()))
                .filter(|&place| place >= end)
                .collect();
            boundary.sort_unstable();
            boundary.dedup();
            parts[p].boundary = boundary;
        }
        Self { order, rank, parts }
    }
}

impl Cutter {
    /// Cuts a set of nodes; returns its part.
    fn cut(&mut self, nodes: Vec<u32>) -> usize {
        let first = self.parts.len();
        let (mut children, mut own) = (Vec::new(), nodes);
        if own.len() > LEAF
            && let Some((low, high, separator)) = self.halves(&own)
        {
            children.push(self.cut(low));
            children.push(self.cut(high));
            own = separator;
        }
        let start = self.order.len();
        self.order.append(&mut own);
        self.parts.push(Separator { own: start..self.order.len(), boundary: Vec::new(), children, first });
        self.parts.len() - 1
    }

    /// Breadth-first distances from a node within its set; returns the nodes reached, nearest
    /// first.
    fn search(&mut self, from: u32, slot: usize) -> Vec<u32> {
        let set = self.set[from as usize];
        let mut reached = vec![from];
        self.distance[slot][from as usize] = 0;
        let mut at = 0;
        while at < reached.len() {
            let node = reached[at] as usize;
            at += 1;
            for &j in &self.neighbours[node] {
                if self.set[j as usize] == set && self.distance[slot][j as usize] == FAR {
                    self.distance[slot][j as usize] = self.distance[slot][node] + 1;
                    reached.push(j);
                }
            }
        }
        reached
    }

    /// Deals the connected components of a set, of which one is known, to two sides.
    fn components(&mut self, nodes: &[u32], mut low: Vec<u32>) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
        let mut high = Vec::new();
        for &node in nodes {
            if self.distance[0][node as usize] == FAR {
                let mut reached = self.search(node, 0);
                if low.len() <= high.len() { low.append(&mut reached) } else { high.append(&mut reached) }
            }
        }
        (low, high, Vec::new())
    }

    /// Two sides and the separator between them; none if the set does not fall apart into smaller
    /// ones.
    fn halves(&mut self, nodes: &[u32]) -> Option<(Vec<u32>, Vec<u32>, Vec<u32>)> {
        self.sets += 1;
        for &node in nodes {
            self.set[node as usize] = self.sets;
        }
        // Two ends, far apart; the cut runs half-way between them.
        let mut end = nodes[0];
        for _ in 0..3 {
            nodes.iter().for_each(|&node| self.distance[0][node as usize] = FAR);
            let reached = self.search(end, 0);
            if reached.len() < nodes.len() {
                return Some(self.components(nodes, reached));
            }
            self.distance.swap(0, 1);
            end = *reached.last()?;
        }
        nodes.iter().for_each(|&node| self.distance[0][node as usize] = FAR);
        self.search(end, 0);
        let key = |node: u32| self.distance[0][node as usize] as i64 - self.distance[1][node as usize] as i64;
        let mut keys: Vec<i64> = nodes.iter().map(|&node| key(node)).collect();
        keys.sort_unstable();
        let n = keys.len();
        let mut cuts = keys[n / 3..n - n / 3].to_vec();
        cuts.dedup();
        let inside = |j: u32| self.set[j as usize] == self.sets;
        let on_cut =
            |node: u32, cut: i64| key(node) < cut && self.neighbours[node as usize].iter().any(|&j| inside(j) && key(j) >= cut);
        let size = |cut: i64| nodes.iter().filter(|&&node| on_cut(node, cut)).count();
        let best = cuts.into_iter().min_by_key(|&cut| size(cut))?;
        let (mut low, mut high, mut separator) = (Vec::new(), Vec::new(), Vec::new());
        for &node in nodes {
            if key(node) >= best {
                high.push(node);
            } else if on_cut(node, best) {
                separator.push(node);
            } else {
                low.push(node);
            }
        }
        (!high.is_empty() && high.len() < nodes.len()).then_some((low, high, separator))
    }
}
