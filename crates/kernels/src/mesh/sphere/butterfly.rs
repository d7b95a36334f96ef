//! The logical blocks of the sphere's mesh: a butterfly (O-grid) in three dimensions.
//!
//! A half disc is a centre block (x by y cells) and a ring block (perimeter s by r cells) around
//! its three outer sides:
//!
//! ```text
//!        s = 3m . . . s = m          the centre block, y >= 0, its perimeter s counted counter-clockwise from (x = 2m, y = 0),
//!         +---------+                the rings r = 0 (the perimeter itself) .. nr around it
//!         | centre  |
//!  s = 4m +----+----+ s = 0
//! ```
//!
//! The shell is this disc times the depth d, from the sphere's surface (d = 0) to the core's
//! surface (d = nd); the core is the centre block times r: its floor r = 0 lies on the shell's
//! centre, its walls on the shell's rings, its lid r = nr on the equator plane.
//!
//! Of a body whose state is even or odd in x the part at x >= 0 is enough: there the centre block
//! begins at x = 0, and the perimeter ends there, at s = 2m.

use crate::mesh::hierarchy::{Between, Blocks, ClassMap, Site};

/// The centre of the shell, indices (x, y, d).
pub const BOTTOM: usize = 0;
/// The rings of the shell, indices (s, r, d).
pub const SIDE: usize = 1;
/// The core, indices (x, y, r).
pub const CORE: usize = 2;

/// Cells along the index classes of the butterfly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Butterfly {
    /// Across the centre block, along x.
    pub nx: usize,
    /// Across the centre block, along y.
    pub ny: usize,
    /// Rings outside the centre block.
    pub nr: usize,
    /// Layers of the shell.
    pub nd: usize,
    /// Only the part at x >= 0 is there: `nx` cells from the plane x = 0 outwards.
    pub half: bool,
}

impl Butterfly {
    /// Cells around the perimeter of the centre block.
    pub fn perimeter_cells(&self) -> usize {
        if self.half { self.ny + self.nx } else { 2 * self.ny + self.nx }
    }

    /// The part at x >= 0 of whole blocks with an even `nx`.
    pub fn right_half(&self) -> Self {
        Self { nx: self.nx / 2, half: true, ..*self }
    }

    /// The same blocks with every cell halved so many times in all directions.
    pub fn halved(&self, times: usize) -> Self {
        let [nx, ny, nr, nd] = [self.nx, self.ny, self.nr, self.nd].map(|cells| cells << times);
        Self { nx, ny, nr, nd, half: self.half }
    }

    /// The cells of each block along its indices.
    pub fn cells_of_blocks(&self) -> [(usize, [usize; 3]); 3] {
        [
            (BOTTOM, [self.nx, self.ny, self.nd]),
            (SIDE, [self.perimeter_cells(), self.nr, self.nd]),
            (CORE, [self.nx, self.ny, self.nr]),
        ]
    }

    /// The steps along a block's first two indices to an element's nodes 0 to 3, and 4 to 7.
    pub fn turn(block: usize) -> [[usize; 2]; 4] {
        // The sides' (s, r, d) is left-handed, (r, s, d) right-handed: its two first edges are
        // swapped.
        if block == SIDE { [[0, 0], [0, 1], [1, 1], [1, 0]] } else { [[0, 0], [1, 0], [1, 1], [0, 1]] }
    }

    /// Of a site of [`Butterfly::right_half`], the node in these blocks.
    pub fn number_of_half(&self, site: Site) -> u32 {
        let [a, b, c] = site.at;
        self.number(Site { block: site.block, at: [if site.block == SIDE { a } else { a + self.nx / 2 }, b, c] })
    }

    /// First index along x inside the core: at x = 0 a half has no wall.
    fn first_in_core(&self) -> usize {
        usize::from(!self.half)
    }

    /// Nodes of the core in a row along x.
    fn core_row(&self) -> usize {
        self.nx - self.first_in_core()
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.nx * self.ny * (self.nd + self.nr) + self.perimeter_cells() * self.nr * self.nd
    }

    /// The centre block's indices at perimeter index `s`.
    pub fn on_perimeter(&self, s: usize) -> (usize, usize) {
        let (nx, ny) = (self.nx, self.ny);
        if s <= ny {
            (nx, s)
        } else if s <= ny + nx {
            (nx + ny - s, ny)
        } else {
            (0, 2 * ny + nx - s)
        }
    }

    /// The perimeter index of the centre block's indices (i, j), if they are on the perimeter.
    pub fn perimeter_of(&self, i: usize, j: usize) -> Option<usize> {
        let (nx, ny) = (self.nx, self.ny);
        if i == nx {
            Some(j)
        } else if j == ny {
            Some(ny + nx - i)
        } else if i == 0 && !self.half {
            Some(2 * ny + nx - j)
        } else {
            None
        }
    }

    /// Nodes of the half disc.
    fn disc_nodes(&self) -> usize {
        (self.nx + 1) * (self.ny + 1) + self.nr * (self.perimeter_cells() + 1)
    }

    fn disc_number(&self, s: usize, r: usize) -> usize {
        if r == 0 {
            let (i, j) = self.on_perimeter(s);
            i + (self.nx + 1) * j
        } else {
            (self.nx + 1) * (self.ny + 1) + (r - 1) * (self.perimeter_cells() + 1) + s
        }
    }

    /// The site opposite in x, in whole blocks.
    pub fn mirrored(&self, site: Site) -> Site {
        let [a, b, c] = site.at;
        let cells = if site.block == SIDE { self.perimeter_cells() } else { self.nx };
        Site { block: site.block, at: [cells - a, b, c] }
    }

    /// Whether a site of whole blocks lies at x < 0 (for an even `nx`).
    pub fn is_left(&self, site: Site) -> bool {
        let cells = if site.block == SIDE { self.perimeter_cells() } else { self.nx };
        if site.block == SIDE { 2 * site.at[0] > cells } else { 2 * site.at[0] < cells }
    }

    /// The ring of a site of the whole blocks' shell, counted from the axis (in the centre block by
    /// the squares around it), and its steps along the ring from the nearer of the axes x and y:
    /// alike for two sites that are images in the diagonal.
    pub fn on_ring(&self, site: Site) -> [usize; 2] {
        let [a, b, _] = site.at;
        let m = self.ny;
        if site.block == SIDE {
            let right = a.min(4 * m - a);
            [m + b, right.min(2 * m - right)]
        } else {
            let right = a.abs_diff(m);
            [right.max(b), right.min(b)]
        }
    }

    /// Faces on the sphere's surface over the centre block and the first `rings` rings,
    /// counter-clockwise seen from outside.
    pub fn surface_faces(&self, rings: usize) -> Vec<[u32; 4]> {
        let mut faces = Vec::with_capacity(self.nx * self.ny + rings * self.perimeter_cells());
        let mut push = |block, a, b, turn: [[usize; 2]; 4]| {
            faces.push(turn.map(|[da, db]| self.number(Site { block, at: [a + da, b + db, 0] })));
        };
        for j in 0..self.ny {
            for i in 0..self.nx {
                push(BOTTOM, i, j, [[0, 0], [0, 1], [1, 1], [1, 0]]);
            }
        }
        for r in 0..rings {
            for s in 0..self.perimeter_cells() {
                push(SIDE, s, r, [[0, 0], [1, 0], [1, 1], [0, 1]]);
            }
        }
        faces
    }
}

impl Blocks for Butterfly {
    fn cells(&self) -> Vec<usize> {
        vec![self.nx, self.ny, self.nr, self.nd]
    }

    fn with_cells(&self, cells: &[usize]) -> Self {
        Butterfly { nx: cells[0], ny: cells[1], nr: cells[2], nd: cells[3], half: self.half }
    }

    fn sites(&self) -> Vec<Site> {
        let mut sites = Vec::with_capacity(self.node_count());
        for d in 0..=self.nd {
            for j in 0..=self.ny {
                sites.extend((0..=self.nx).map(|i| Site { block: BOTTOM, at: [i, j, d] }));
            }
            for r in 1..=self.nr {
                sites.extend((0..=self.perimeter_cells()).map(|s| Site { block: SIDE, at: [s, r, d] }));
            }
        }
        for r in 1..=self.nr {
            for j in 0..self.ny {
                sites.extend((self.first_in_core()..self.nx).map(|i| Site { block: CORE, at: [i, j, r] }));
            }
        }
        sites
    }

    fn node_count(&self) -> usize {
        self.disc_nodes() * (self.nd + 1) + self.nr * self.core_row() * self.ny
    }

    fn number(&self, site: Site) -> u32 {
        let [a, b, c] = site.at;
        let in_shell = |disc: usize, d: usize| disc + d * self.disc_nodes();
        let n = match site.block {
            BOTTOM => in_shell(a + (self.nx + 1) * b, c),
            SIDE => in_shell(self.disc_number(a, b), c),
            _ if c == 0 => in_shell(a + (self.nx + 1) * b, self.nd),
            _ => match self.perimeter_of(a, b) {
                Some(s) => in_shell(self.disc_number(s, c), self.nd),
                None => in_shell(0, self.nd + 1) + ((c - 1) * self.ny + b) * self.core_row() + a - self.first_in_core(),
            },
        };
        n as u32
    }

    fn between(&self, coarse: &Self, site: Site, axis: usize, maps: &[ClassMap]) -> Between {
        let [x, y, r, d] = [0, 1, 2, 3].map(|class| &maps[class]);
        let index = site.at[axis];
        match (site.block, axis) {
            (SIDE, 0) => {
                // The perimeter runs along y, then x, then y again: each side follows the class it
                // touches.
                let (i, j) = self.on_perimeter(index);
                let on_top = (self.ny + 1..=self.ny + self.nx).contains(&index);
                let along = if on_top { x[i] } else { y[j] };
                let to_s = |k: usize| match index {
                    _ if on_top => coarse.ny + coarse.nx - k,
                    s if s <= self.ny => k,
                    _ => coarse.perimeter_cells() - k,
                };
                Between { low: to_s(along.low), high: to_s(along.high), toward_high: along.toward_high }
            }
            (SIDE, 1) | (CORE, 2) => r[index],
            (_, 0) => x[index],
            (_, 1) => y[index],
            _ => d[index],
        }
    }
}
