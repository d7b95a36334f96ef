//! The skin: cells at the surface, over the fine zone, split in eight, once or several times.
//!
//! Level k is the lattice of the blocks with every cell halved k times in all directions; the body
//! has the cells of level 0 but where they are split. Level k + 1 takes two layers of cells of
//! level k, out to a ring beyond the fine zone. Each level ends a cell further in than the one
//! before: neighbours are then of one level or of successive ones (2:1), and what a corner that
//! hangs is the mean of does not hang itself. Nodes of level 0 have the numbers that they have
//! without a skin; those that a level adds follow.

use super::butterfly::{BOTTOM, Butterfly, CORE, SIDE};
use super::geometry::Geometry;
use super::layout::Layout;
use crate::mesh::Prolongation;
use crate::mesh::connectivity::Measures;
use crate::mesh::hanging::Hanging;
use crate::mesh::hierarchy::{Blocks, Site};

#[cfg(test)]
mod tests;

/// Layers of a level's cells that the next one splits. Half and twice of it: `benches/constants`.
const LAYERS: usize = 2;
/// The local nodes of an element's face on the surface, counter-clockwise seen from outside.
const OUTER_FACE: [usize; 4] = [0, 3, 2, 1];

/// A cell that is not split.
struct Leaf {
    level: usize,
    block: usize,
    /// Indices of the cell in the lattice of its level.
    cell: [usize; 3],
    /// Which of the eight of its parent it is.
    octant: usize,
}

/// From a corner's number in an element to its steps along the block's indices.
fn steps(block: usize, corner: usize) -> [usize; 3] {
    let [a, b] = Butterfly::turn(block)[corner % 4];
    [a, b, corner / 4]
}

/// The cells, nodes and levels of a body with a skin.
pub struct Skin<'a> {
    layout: &'a Layout,
    levels: usize,
    /// The lattice of the finest level.
    finest: Butterfly,
    leaves: Vec<Leaf>,
    /// Of a node of the finest lattice: its number in the mesh, if it is a node there.
    number: Vec<Option<u32>>,
    /// Of a node of the mesh: its site in the finest lattice.
    sites: Vec<Site>,
    /// Nodes of the mesh up to each level.
    up_to: Vec<usize>,
    /// Of a node of the finest lattice: it hangs.
    hangs: Vec<bool>,
}

/// Whether the cell of a level is split, with the number of rings that the skin of `levels` levels
/// covers on level 0.
fn is_split(layout: &Layout, level: usize, block: usize, cell: [usize; 3]) -> bool {
    // On level 0 a ring beyond the fine zone, on level k the end of the zone and one cell.
    let rings = (layout.fine_rings << level) + 1;
    level < layout.skin && block != CORE && cell[2] < LAYERS && (block == BOTTOM || cell[1] < rings)
}

/// Number of elements of a body with a skin, without making them.
pub fn element_count(layout: &Layout) -> usize {
    let blocks = &layout.blocks;
    let mut count = blocks.element_count();
    for level in 0..layout.skin {
        let [nx, ny, around] = [blocks.nx, blocks.ny, blocks.perimeter_cells()].map(|cells| cells << level);
        count += 7 * LAYERS.min(blocks.nd << level) * (nx * ny + around * ((layout.fine_rings << level) + 1));
    }
    count
}

impl<'a> Skin<'a> {
    /// The skin of a layout.
    pub fn new(layout: &'a Layout) -> Self {
        let (levels, blocks) = (layout.skin, layout.blocks);
        let finest = blocks.halved(levels);
        let mut skin = Self {
            layout,
            levels,
            finest,
            leaves: Vec::new(),
            number: vec![None; finest.node_count()],
            sites: Vec::new(),
            up_to: Vec::new(),
            hangs: vec![false; finest.node_count()],
        };
        for (block, [na, nb, nc]) in blocks.cells_of_blocks() {
            for c in 0..nc {
                for b in 0..nb {
                    (0..na).for_each(|a| skin.cut(Leaf { level: 0, block, cell: [a, b, c], octant: 0 }));
                }
            }
        }
        skin.mark_hanging();
        skin.count_nodes();
        skin
    }

    /// Takes a cell, or what it is split into.
    fn cut(&mut self, cell: Leaf) {
        let Leaf { level, block, cell: at, .. } = cell;
        if !is_split(self.layout, level, block, at) {
            self.leaves.push(cell);
            return;
        }
        for octant in 0..8 {
            let step = steps(block, octant);
            self.cut(Leaf { level: level + 1, block, cell: [0, 1, 2].map(|k| 2 * at[k] + step[k]), octant });
        }
    }

    /// Number in the finest lattice of a site given in the lattice of a level.
    fn at(&self, level: usize, block: usize, at: [usize; 3]) -> usize {
        self.finest.number(Site { block, at: at.map(|i| i << (self.levels - level)) }) as usize
    }

    /// The middles of the edges and faces of cells that are not split: a corner there hangs.
    fn mark_hanging(&mut self) {
        for leaf in self.leaves.iter().filter(|leaf| leaf.level < self.levels) {
            for a in 0..3 {
                for b in 0..3 {
                    for c in 0..3 {
                        // In halves of a cell; 1 is the middle.
                        let half = [a, b, c];
                        if (1..=2).contains(&half.iter().filter(|h| **h == 1).count()) {
                            let at = [0, 1, 2].map(|k| 2 * leaf.cell[k] + half[k]);
                            let node = self.at(leaf.level + 1, leaf.block, at);
                            self.hangs[node] = true;
                        }
                    }
                }
            }
        }
    }

    /// Numbers the corners that do not hang, level by level.
    fn count_nodes(&mut self) {
        let mut is_node = vec![false; self.number.len()];
        for leaf in &self.leaves {
            for corner in 0..8 {
                is_node[self.at(leaf.level, leaf.block, self.corner_at(leaf, corner))] = true;
            }
        }
        let mut sites = self.layout.blocks.sites();
        sites.iter_mut().for_each(|site| site.at = site.at.map(|i| i << self.levels));
        let mut up_to = vec![sites.len()];
        let all = self.finest.sites();
        for level in 1..=self.levels {
            // What a level adds is off the lattice of the one before.
            let (own, before) = (self.levels - level, self.levels - level + 1);
            let lies_on = |site: &Site, by: usize| site.at.iter().all(|i| i % (1 << by) == 0);
            let added = all
                .iter()
                .zip(&is_node)
                .zip(&self.hangs)
                .filter(|((site, is_node), hangs)| **is_node && !**hangs && lies_on(site, own) && !lies_on(site, before));
            sites.extend(added.map(|((site, _), _)| *site));
            up_to.push(sites.len());
        }
        for (n, &site) in (0u32..).zip(&sites) {
            self.number[self.finest.number(site) as usize] = Some(n);
        }
        (self.sites, self.up_to) = (sites, up_to);
    }

    fn corner_at(&self, leaf: &Leaf, corner: usize) -> [usize; 3] {
        let step = steps(leaf.block, corner);
        [0, 1, 2].map(|k| leaf.cell[k] + step[k])
    }

    /// What a cell names at its corners, and which of these hang.
    fn element(&self, leaf: &Leaf) -> ([u32; 8], Hanging) {
        let own = std::array::from_fn::<_, 8, _>(|a| self.at(leaf.level, leaf.block, self.corner_at(leaf, a)));
        let hanging = Hanging::new(leaf.octant, |a| self.hangs[own[a]]);
        let named = std::array::from_fn(|a| {
            let node = if hanging.hangs(a) {
                let step = steps(leaf.block, a);
                self.at(leaf.level - 1, leaf.block, [0, 1, 2].map(|k| leaf.cell[k] / 2 + step[k]))
            } else {
                own[a]
            };
            // Levels are nested with a cell between their ends: what is named is a node.
            self.number[node].unwrap_or(u32::MAX)
        });
        (named, hanging)
    }

    /// Positions of the nodes.
    pub fn positions(&self, geometry: &Geometry<'_>) -> Vec<[f64; 3]> {
        self.sites.iter().map(|&site| geometry.position(site)).collect()
    }

    /// The sites of the nodes in the lattice of the finest level.
    pub fn sites(&self) -> &[Site] {
        &self.sites
    }

    /// Elements and their corners that hang.
    pub fn elements(&self) -> (Vec<[u32; 8]>, Vec<Hanging>) {
        self.leaves.iter().map(|leaf| self.element(leaf)).unzip()
    }

    /// The faces on the sphere's surface over the first `rings` rings of level 0, of a skin those
    /// of the finest level without a corner that hangs, so that they are one surface without a
    /// gap; and all nodes of faces there, in increasing order.
    pub fn contact(&self, rings: usize) -> (Vec<[u32; 4]>, Vec<u32>) {
        let is_near = |leaf: &&Leaf| leaf.block == BOTTOM || leaf.block == SIDE && leaf.cell[1] >> leaf.level < rings;
        let (mut faces, mut nodes) = (Vec::new(), Vec::new());
        for leaf in self.outer().filter(is_near) {
            let (named, hanging) = self.element(leaf);
            nodes.extend(OUTER_FACE.map(|a| named[a]));
            if leaf.level == self.levels && !OUTER_FACE.iter().any(|&a| hanging.hangs(a)) {
                faces.push(OUTER_FACE.map(|a| named[a]));
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        (faces, nodes)
    }

    /// Tributary areas and sizes from all faces on the sphere's surface.
    pub fn measures(&self, nodes: &[[f64; 3]]) -> Measures {
        let mut measures = Measures::new(nodes.len());
        for (named, hanging) in self.outer().map(|leaf| self.element(leaf)) {
            let mut corners = named.map(|n| nodes[n as usize]);
            hanging.to_corners(&mut corners);
            let shares = hanging.shares::<f64>();
            let of_named = |a: usize| OUTER_FACE.map(|b| shares[a][b]);
            measures.add(OUTER_FACE.map(|a| corners[a]), OUTER_FACE.map(|a| named[a]), OUTER_FACE.map(of_named));
        }
        measures
    }

    /// Cells on the sphere's surface.
    fn outer(&self) -> impl Iterator<Item = &Leaf> {
        self.leaves.iter().filter(|leaf| leaf.block != CORE && leaf.cell[2] == 0)
    }

    /// Interpolations from level to level, finest first: what a level adds lies in the middle of
    /// two, four or eight nodes of the one before.
    pub fn prolongations(&self) -> Vec<Prolongation> {
        (1..=self.levels).rev().map(|level| self.prolongation(level)).collect()
    }

    fn prolongation(&self, level: usize) -> Prolongation {
        let (before, own) = (self.up_to[level - 1], self.up_to[level]);
        let mut p = Prolongation { coarse_nodes: before, row_start: vec![0], column: Vec::new(), weight: Vec::new() };
        for (n, site) in self.sites[..own].iter().enumerate() {
            let mut from: Vec<u32> = Vec::with_capacity(8);
            if n < before {
                from.push(n as u32);
            } else {
                let at = site.at.map(|i| i >> (self.levels - level));
                for corner in 0..8 {
                    let around = [0, 1, 2].map(|k| (at[k] + (corner >> k & 1)) / 2);
                    from.extend(self.number[self.at(level - 1, site.block, around)]);
                }
            }
            from.sort_unstable();
            from.dedup();
            p.weight.extend(from.iter().map(|_| 1.0 / from.len() as f64));
            p.column.append(&mut from);
            p.row_start.push(p.column.len() as u32);
        }
        p
    }

    /// The half at x >= 0: its nodes, and the interpolations from level to level between them.
    pub fn half(&self) -> (Vec<u32>, Vec<Prolongation>) {
        let half = self.layout.blocks.right_half();
        let mut nodes: Vec<u32> = half.sites().into_iter().map(|site| self.layout.blocks.number_of_half(site)).collect();
        let mut up_to = vec![nodes.len()];
        for level in 1..=self.levels {
            let added = self.up_to[level - 1]..self.up_to[level];
            nodes.extend(added.filter(|&n| !self.finest.is_left(self.sites[n])).map(|n| n as u32));
            up_to.push(nodes.len());
        }
        let mut in_half = vec![u32::MAX; self.sites.len()];
        (0u32..).zip(&nodes).for_each(|(i, &n)| in_half[n as usize] = i);
        let part = |level: usize| {
            let whole = self.prolongation(level);
            let mut p =
                Prolongation { coarse_nodes: up_to[level - 1], row_start: vec![0], column: Vec::new(), weight: Vec::new() };
            for &n in &nodes[..up_to[level]] {
                let range = whole.row_start[n as usize] as usize..whole.row_start[n as usize + 1] as usize;
                let mut row: Vec<(u32, f64)> = range.map(|e| (in_half[whole.column[e] as usize], whole.weight[e])).collect();
                row.sort_unstable_by_key(|entry| entry.0);
                p.column.extend(row.iter().map(|entry| entry.0));
                p.weight.extend(row.iter().map(|entry| entry.1));
                p.row_start.push(p.column.len() as u32);
            }
            p
        };
        let levels = (1..=self.levels).rev().map(part).collect();
        (nodes, levels)
    }
}
