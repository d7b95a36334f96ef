//! Nodes in the middle of the edges, for bricks of twenty nodes.

use std::collections::BTreeMap;

use asperity::internals::mesh::Mesh;

/// Edges of a brick in the order in which CalculiX wants the nodes 9 to 20 (its manual, "C3D20").
const EDGES: [[usize; 2]; 12] = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
/// A node lies on a sphere within this, over R.
const ON_SPHERE: f64 = 1e-9;

/// The nodes in the middle of the edges, which follow those of the mesh; none for linear bricks.
#[derive(Default)]
pub struct Middles {
    /// Their positions, in the coordinates of the mesh.
    pub nodes: Vec<[f64; 3]>,
    /// Whether they belong to the sphere, not to the opponent.
    pub above: Vec<bool>,
    /// The middle of an edge, its ends in rising order.
    of: BTreeMap<[u32; 2], u32>,
}

impl Middles {
    /// The middles of all edges of `elements`, laid on the surface where both ends are on a sphere
    /// of one of the `radii` that touches the plane z = 0.
    pub fn new(mesh: &Mesh, elements: &[[u32; 8]], radii: &[f64]) -> Self {
        let first_below = mesh.couple.as_deref().map_or(mesh.nodes.len(), |couple| couple.node);
        let mut all = Self::default();
        for ends in elements.iter().flat_map(edges) {
            if all.of.contains_key(&ends) {
                continue;
            }
            all.of.insert(ends, (mesh.nodes.len() + all.nodes.len()) as u32);
            all.nodes.push(middle(ends.map(|n| mesh.nodes[n as usize]), radii));
            all.above.push((ends[0] as usize) < first_below);
        }
        all
    }

    /// The nodes 9 to 20 of an element.
    pub fn of(&self, element: &[u32; 8]) -> impl Iterator<Item = u32> {
        edges(element).filter_map(|ends| self.of.get(&ends).copied())
    }

    /// A set of nodes with the middles of the edges between them.
    pub fn with(&self, set: &[u32]) -> Vec<u32> {
        let inside: std::collections::BTreeSet<u32> = set.iter().copied().collect();
        let between = self.of.iter().filter(|(ends, _)| ends.iter().all(|n| inside.contains(n))).map(|(_, middle)| *middle);
        set.iter().copied().chain(between).collect()
    }
}

fn edges(element: &[u32; 8]) -> impl Iterator<Item = [u32; 2]> {
    let element = *element;
    EDGES.into_iter().map(move |[a, b]| [element[a].min(element[b]), element[a].max(element[b])])
}

fn middle([a, b]: [[f64; 3]; 2], radii: &[f64]) -> [f64; 3] {
    let straight = [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
    let distance = |x: [f64; 3], r: f64| (x[0] * x[0] + x[1] * x[1] + (x[2] - r) * (x[2] - r)).sqrt();
    for &r in radii {
        if [a, b].iter().all(|&x| (distance(x, r) - r).abs() < ON_SPHERE) {
            let out = r / distance(straight, r);
            return [straight[0] * out, straight[1] * out, r + (straight[2] - r) * out];
        }
    }
    straight
}
