//! Small-strain elasticity on a graded brick: the test problems of this room, shared with its benchmark.

use super::{BlockMatrix, Pattern, Prolongation};

/// What is in contact at the patch z = 0, x^2 + y^2 < 0.04 (the brick is a unit cube).
#[derive(Clone, Copy, PartialEq)]
pub enum Patch {
    /// Nothing.
    Open,
    /// All three components held.
    Stick,
    /// The normal component held; tangential rows are A K + B with Coulomb's coupling.
    Slip,
    /// Inner half of the radius sticks, the rest slips.
    Mixed,
}

/// A brick's material and boundary.
#[derive(Clone, Copy)]
pub struct Brick {
    /// Elements in each direction.
    pub cells: [usize; 3],
    /// Largest over smallest element length in each direction (the small ones are at the origin).
    pub grading: f64,
    /// Bulk modulus; the shear modulus is 1.
    pub bulk: f64,
    /// Factor on the shear modulus within 0.3 of the origin.
    pub soft: f64,
    /// Mean dilatation in each element.
    pub mean_dilatation: bool,
    /// Contact.
    pub patch: Patch,
}

/// A linear system with its hierarchy.
pub struct Problem {
    pub matrix: BlockMatrix<f64>,
    pub fixed: Vec<bool>,
    pub rhs: Vec<f64>,
    pub prolongations: Vec<Prolongation>,
}

impl Brick {
    pub fn elastic(n: usize) -> Self {
        Self { cells: [n; 3], grading: 10.0, bulk: 2.17, soft: 1.0, mean_dilatation: true, patch: Patch::Stick }
    }

    pub fn plastic(n: usize) -> Self {
        Self { soft: 0.02, ..Self::elastic(n) }
    }

    pub fn slipping(n: usize) -> Self {
        Self { soft: 0.02, patch: Patch::Mixed, ..Self::elastic(n) }
    }

    pub fn problem(&self) -> Problem {
        let [nx, ny, nz] = self.cells;
        let count = self.cells.map(|n| n + 1);
        let index = |i: usize, j: usize, k: usize| (i + count[0] * (j + count[1] * k)) as u32;
        let line = |n: usize| -> Vec<f64> {
            let lengths: Vec<f64> = (0..n).map(|i| self.grading.powf(i as f64 / (n as f64 - 1.0).max(1.0))).collect();
            let total: f64 = lengths.iter().sum();
            let mut at = vec![0.0];
            at.extend(lengths.iter().scan(0.0, |sum, h| {
                *sum += h / total;
                Some(*sum)
            }));
            at
        };
        let [xs, ys, zs] = [line(nx), line(ny), line(nz)];
        let mut elements = Vec::new();
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    elements.push([
                        index(i, j, k),
                        index(i + 1, j, k),
                        index(i + 1, j + 1, k),
                        index(i, j + 1, k),
                        index(i, j, k + 1),
                        index(i + 1, j, k + 1),
                        index(i + 1, j + 1, k + 1),
                        index(i, j + 1, k + 1),
                    ]);
                }
            }
        }
        let nodes = count[0] * count[1] * count[2];
        let mut matrix = BlockMatrix::zeros(Pattern::from_elements(nodes, &elements));
        for (e, element) in elements.iter().enumerate() {
            let (i, j, k) = (e % nx, e / nx % ny, e / (nx * ny));
            let h = [xs[i + 1] - xs[i], ys[j + 1] - ys[j], zs[k + 1] - zs[k]];
            let center = [xs[i] + h[0] / 2.0, ys[j] + h[1] / 2.0, zs[k] + h[2] / 2.0];
            let shear = if center.iter().map(|x| x * x).sum::<f64>() < 0.09 { self.soft } else { 1.0 };
            let stiffness = brick_stiffness(h, shear, self.bulk, self.mean_dilatation);
            for a in 0..8 {
                for b in 0..8 {
                    if let Some(block) = matrix.block_mut(element[a] as usize, element[b] as usize) {
                        for m in 0..9 {
                            block[m] += stiffness[3 * a + m / 3][3 * b + m % 3];
                        }
                    }
                }
            }
        }
        let mut fixed = vec![false; 3 * nodes];
        let mut rhs = vec![0.0; 3 * nodes];
        for k in 0..count[2] {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let node = index(i, j, k) as usize;
                    // A little load everywhere, without structure.
                    for c in 0..3 {
                        rhs[3 * node + c] = 1e-5 * (((3 * node + c) as f64 * 0.618_033_988_749_894_9).fract() - 0.5);
                    }
                    if k == nz {
                        fixed[3 * node..3 * node + 3].fill(true);
                        rhs[3 * node..3 * node + 3].copy_from_slice(&[0.001, 0.0, -0.002]);
                    }
                    if j == 0 {
                        fixed[3 * node + 1] = true;
                        rhs[3 * node + 1] = 0.0;
                    }
                    let radius = xs[i].hypot(ys[j]);
                    if k == 0 && radius < 0.2 && self.patch != Patch::Open {
                        fixed[3 * node + 2] = true;
                        rhs[3 * node + 2] = 1e-4 * radius;
                        let slips = self.patch == Patch::Slip || self.patch == Patch::Mixed && radius > 0.1;
                        if slips {
                            slip_rows(&mut matrix, node, radius);
                        } else {
                            fixed[3 * node..3 * node + 3].fill(true);
                        }
                    }
                }
            }
        }
        for (unknown, _) in fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
            matrix.set_identity_row(unknown / 3, unknown % 3);
        }
        Problem { matrix, fixed, rhs, prolongations: prolongations(count) }
    }
}

/// Rows x and y of a slipping node: K_t + mu t K_n, and a spring across the direction t of slip.
fn slip_rows(matrix: &mut BlockMatrix<f64>, node: usize, radius: f64) {
    let (mu, angle) = (0.3, 0.4 + 3.0 * radius);
    let t = [angle.cos(), angle.sin()];
    let diagonal = matrix.pattern.diagonal[node] as usize;
    let spring = 0.1 * matrix.blocks[diagonal][0];
    for at in matrix.pattern.row(node) {
        let block = &mut matrix.blocks[at];
        for r in 0..2 {
            for c in 0..3 {
                block[3 * r + c] += mu * t[r] * block[6 + c];
            }
        }
    }
    for r in 0..2 {
        for c in 0..2 {
            matrix.blocks[diagonal][3 * r + c] += spring * (f64::from(r == c) - t[r] * t[c]);
        }
    }
}

/// Stiffness of a box-shaped hex8 with edges `h`, 2x2x2 Gauss points.
fn brick_stiffness(h: [f64; 3], shear: f64, bulk: f64, mean_dilatation: bool) -> [[f64; 24]; 24] {
    const CORNER: [[f64; 3]; 8] = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, 1.0],
    ];
    let weight = h[0] * h[1] * h[2] / 8.0;
    let gradients: Vec<[[f64; 3]; 8]> = CORNER
        .iter()
        .map(|g| {
            let g = g.map(|g| g / 3.0_f64.sqrt());
            CORNER.map(|c| {
                let f: [f64; 3] = std::array::from_fn(|d| 1.0 + c[d] * g[d]);
                [c[0] * f[1] * f[2] / (4.0 * h[0]), c[1] * f[0] * f[2] / (4.0 * h[1]), c[2] * f[0] * f[1] / (4.0 * h[2])]
            })
        })
        .collect();
    let mean: [[f64; 3]; 8] =
        std::array::from_fn(|a| std::array::from_fn(|c| gradients.iter().map(|g| g[a][c]).sum::<f64>() / 8.0));
    let mut k = [[0.0; 24]; 24];
    for g in &gradients {
        let div = if mean_dilatation { &mean } else { g };
        for a in 0..8 {
            for b in 0..8 {
                let dot: f64 = (0..3).map(|c| g[a][c] * g[b][c]).sum();
                for r in 0..3 {
                    for c in 0..3 {
                        let deviatoric = if r == c { dot } else { 0.0 } + g[a][c] * g[b][r] - 2.0 / 3.0 * g[a][r] * g[b][c];
                        k[3 * a + r][3 * b + c] += weight * (shear * deviatoric + bulk * div[a][r] * div[b][c]);
                    }
                }
            }
        }
    }
    k
}

/// Every second index and the last in each direction, linear in the index between them, down to 3 nodes in a direction.
fn prolongations(mut count: [usize; 3]) -> Vec<Prolongation> {
    let mut chain = Vec::new();
    while count.iter().any(|&n| n > 4) {
        let lines = count.map(|n| {
            let mut kept: Vec<usize> = (0..n).step_by(2).collect();
            if n % 2 == 0 {
                kept.push(n - 1);
            }
            let rows: Vec<Vec<(usize, f64)>> = (0..n)
                .map(|i| match kept.binary_search(&i) {
                    Ok(at) => vec![(at, 1.0)],
                    Err(at) => vec![(at - 1, 0.5), (at, 0.5)],
                })
                .collect();
            (kept.len(), rows)
        });
        let coarse = [lines[0].0, lines[1].0, lines[2].0];
        let mut p = Prolongation { coarse_nodes: coarse.iter().product(), row_start: vec![0], column: vec![], weight: vec![] };
        for z in &lines[2].1 {
            for y in &lines[1].1 {
                for x in &lines[0].1 {
                    for (k, wz) in z {
                        for (j, wy) in y {
                            for (i, wx) in x {
                                p.column.push((i + coarse[0] * (j + coarse[1] * k)) as u32);
                                p.weight.push(wx * wy * wz);
                            }
                        }
                    }
                    p.row_start.push(p.column.len() as u32);
                }
            }
        }
        chain.push(p);
        count = coarse;
    }
    chain
}
