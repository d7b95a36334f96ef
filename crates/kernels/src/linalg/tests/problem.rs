//! Small-strain elasticity on a graded brick: the test problems of this room, shared with its
//! benchmark.

use super::{BlockMatrix, CORNERS, Mesh, Pattern, Prolongation};

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
        let (mut nodes, mut elements) = (Vec::new(), Vec::new());
        for k in 0..=nz {
            for j in 0..=ny {
                for i in 0..=nx {
                    nodes.push([xs[i], ys[j], zs[k]]);
                    if i < nx && j < ny && k < nz {
                        let face = |k| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
                        let [[a, b, c, d], [e, f, g, h]] = [face(k), face(k + 1)];
                        elements.push([a, b, c, d, e, f, g, h]);
                    }
                }
            }
        }
        let on = |axis: usize, at: usize| -> Vec<u32> {
            let plane = move |node: &u32| {
                [*node as usize % count[0], *node as usize / count[0] % count[1], *node as usize / (count[0] * count[1])][axis]
                    == at
            };
            (0..nodes.len() as u32).filter(plane).collect()
        };
        let (plate, symmetry, surface) = (on(2, nz), on(1, 0), on(2, 0));
        Body { nodes: &nodes, elements: &elements, plate: &plate, symmetry: &symmetry, surface: &surface, soft_radius: 0.3 }
            .problem(self, prolongations(count))
    }

    /// The same material and contact on the simulated body: half the lower half of a unit sphere.
    pub fn on(&self, mesh: &Mesh) -> Problem {
        Body {
            nodes: &mesh.nodes,
            elements: &mesh.elements,
            plate: &mesh.plate_nodes,
            symmetry: &mesh.symmetry_nodes,
            surface: &mesh.contact_nodes,
            soft_radius: 0.4,
        }
        .problem(self, mesh.hierarchy.clone())
    }
}

/// A meshed body over the plane z = 0.
struct Body<'a> {
    nodes: &'a [[f64; 3]],
    elements: &'a [[u32; 8]],
    /// Displaced as a whole.
    plate: &'a [u32],
    /// Held in y.
    symmetry: &'a [u32],
    /// Candidates for contact.
    surface: &'a [u32],
    /// Reach of the softened region.
    soft_radius: f64,
}

impl Body<'_> {
    fn problem(&self, brick: &Brick, prolongations: Vec<Prolongation>) -> Problem {
        let count = self.nodes.len();
        let mut matrix = BlockMatrix::zeros(Pattern::from_elements(count, self.elements));
        for element in self.elements {
            let corners = element.map(|node| self.nodes[node as usize]);
            let center: [f64; 3] = std::array::from_fn(|c| corners.iter().map(|x| x[c]).sum::<f64>() / 8.0);
            let soft = center.iter().map(|x| x * x).sum::<f64>().sqrt() < self.soft_radius;
            let stiffness = stiffness(&corners, if soft { brick.soft } else { 1.0 }, brick.bulk, brick.mean_dilatation);
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
        // A little load everywhere, without structure.
        let mut rhs: Vec<f64> = (0..3 * count).map(|k| 1e-5 * ((k as f64 * 0.618_033_988_749_894_9).fract() - 0.5)).collect();
        let mut fixed = vec![false; 3 * count];
        let mut hold = |node: u32, component: usize, value: f64| {
            fixed[3 * node as usize + component] = true;
            rhs[3 * node as usize + component] = value;
        };
        for &node in self.plate {
            [0.001, 0.0, -0.002].iter().enumerate().for_each(|(c, &value)| hold(node, c, value));
        }
        for &node in self.surface {
            let [x, y, _] = self.nodes[node as usize];
            let radius = x.hypot(y);
            if radius < 0.2 && brick.patch != Patch::Open {
                hold(node, 2, 1e-4 * radius);
                if brick.patch == Patch::Slip || brick.patch == Patch::Mixed && radius > 0.1 {
                    slip_rows(&mut matrix, node as usize, radius);
                } else {
                    (0..2).for_each(|c| hold(node, c, 0.0));
                }
            }
        }
        self.symmetry.iter().for_each(|&node| hold(node, 1, 0.0));
        for (unknown, _) in fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
            matrix.set_identity_row(unknown / 3, unknown % 3);
        }
        Problem { matrix, fixed, rhs, prolongations }
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

/// Stiffness of a hex8, 2x2x2 Gauss points.
fn stiffness(corners: &[[f64; 3]; 8], shear: f64, bulk: f64, mean_dilatation: bool) -> [[f64; 24]; 24] {
    let points: [(f64, [[f64; 3]; 8]); 8] = CORNERS.map(|at| {
        let at = at.map(|g| g / 3.0_f64.sqrt());
        let local = CORNERS.map(|s| {
            let f: [f64; 3] = std::array::from_fn(|d| 1.0 + s[d] * at[d]);
            [s[0] * f[1] * f[2] / 8.0, s[1] * f[0] * f[2] / 8.0, s[2] * f[0] * f[1] / 8.0]
        });
        let mut j = [[0.0; 3]; 3];
        for (x, n) in corners.iter().zip(&local) {
            for r in 0..3 {
                for c in 0..3 {
                    j[r][c] += x[r] * n[c];
                }
            }
        }
        let minor = |r: usize, c: usize| {
            let (p, q, u, v) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
            j[p][u] * j[q][v] - j[p][v] * j[q][u]
        };
        let determinant = (0..3).map(|c| j[0][c] * minor(0, c)).sum::<f64>();
        (determinant, local.map(|n| std::array::from_fn(|r| (0..3).map(|c| minor(r, c) * n[c]).sum::<f64>() / determinant)))
    });
    let volume: f64 = points.iter().map(|(w, _)| w).sum();
    let mean: [[f64; 3]; 8] =
        std::array::from_fn(|a| std::array::from_fn(|c| points.iter().map(|(w, g)| w * g[a][c]).sum::<f64>() / volume));
    let mut k = [[0.0; 24]; 24];
    for (weight, g) in &points {
        let div = if mean_dilatation { &mean } else { g };
        for a in 0..8 {
            for b in 0..8 {
                let dot: f64 = (0..3).map(|c| g[a][c] * g[b][c]).sum();
                for r in 0..3 {
                    for c in 0..3 {
                        let laplacian = if r == c { dot } else { 0.0 };
                        let deviatoric = laplacian + g[a][c] * g[b][r] - 2.0 / 3.0 * g[a][r] * g[b][c];
                        k[3 * a + r][3 * b + c] += weight * (shear * deviatoric + bulk * div[a][r] * div[b][c]);
                    }
                }
            }
        }
    }
    k
}

/// Every second index and the last in each direction, linear in the index between them, down to 3
/// nodes in a direction.
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
