//! Lists and areas derived from the elements.

/// Local nodes of the six faces of a VTK_HEXAHEDRON, counter-clockwise seen from outside:
/// xi = -1, xi = 1, eta = -1, eta = 1, zeta = -1, zeta = 1.
pub const FACES: [[usize; 4]; 6] = [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];

/// For every node the elements around it, in increasing element order: the lists by which forces
/// and tangents are gathered.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeElements {
    /// Starts of the nodes' lists, one more than there are nodes.
    pub start: Vec<u32>,
    /// Entries `8 * element + local node`.
    pub entry: Vec<u32>,
}

impl NodeElements {
    /// Where the list of a node is among the entries.
    #[inline(always)]
    pub fn list(&self, node: usize) -> std::ops::Range<usize> {
        self.start[node] as usize..self.start[node + 1] as usize
    }
}

/// The elements around each of `node_count` nodes, in increasing order.
pub fn node_elements(node_count: usize, elements: &[[u32; 8]]) -> NodeElements {
    let mut start = vec![0u32; node_count + 1];
    for &node in elements.iter().flatten() {
        start[node as usize + 1] += 1;
    }
    for n in 0..node_count {
        start[n + 1] += start[n];
    }
    let mut next = start.clone();
    let mut entry = vec![0u32; 8 * elements.len()];
    for (e, element) in elements.iter().enumerate() {
        for (local, &node) in element.iter().enumerate() {
            let slot = &mut next[node as usize];
            entry[*slot as usize] = (8 * e + local) as u32;
            *slot += 1;
        }
    }
    NodeElements { start, entry }
}

/// The elements in an order in which neighbours are close: from one end of the body to the other,
/// each layer those that share a node with the layer before (Cuthill & McKee 1969, for elements);
/// bodies apart one after the other.
pub fn sweep_order(node_count: usize, elements: &[[u32; 8]]) -> Vec<u32> {
    let lists = node_elements(node_count, elements);
    // The last layer as seen from anywhere is one end.
    let end = layers(elements, &lists, 0).last().copied().unwrap_or(0);
    layers(elements, &lists, end)
}

/// All elements: `first`, those that share a node with it, those that share a node with these, and
/// so on.
fn layers(elements: &[[u32; 8]], lists: &NodeElements, first: u32) -> Vec<u32> {
    let mut order: Vec<u32> = Vec::with_capacity(elements.len());
    let mut seen = vec![false; elements.len()];
    let mut next = 0;
    for start in std::iter::once(first).chain(0..elements.len() as u32) {
        match seen.get_mut(start as usize) {
            Some(seen) if !*seen => *seen = true,
            _ => continue,
        }
        order.push(start);
        while let Some(&element) = order.get(next) {
            next += 1;
            for node in elements[element as usize].map(|node| node as usize) {
                for &entry in &lists.entry[lists.list(node)] {
                    let other = entry / 8;
                    if !std::mem::replace(&mut seen[other as usize], true) {
                        order.push(other);
                    }
                }
            }
        }
    }
    order
}

/// Faces that belong to one element only, in the order of the elements, counter-clockwise seen from
/// outside.
#[cfg(test)]
pub fn boundary_faces(elements: &[[u32; 8]]) -> Vec<[u32; 4]> {
    let mut faces: Vec<([u32; 4], usize)> = Vec::with_capacity(6 * elements.len());
    for (e, element) in elements.iter().enumerate() {
        for (f, local) in FACES.iter().enumerate() {
            let mut key = local.map(|l| element[l]);
            key.sort_unstable();
            faces.push((key, 6 * e + f));
        }
    }
    faces.sort_unstable();
    let mut single: Vec<usize> = faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| same[0].1).collect();
    single.sort_unstable();
    single.into_iter().map(|id| FACES[id % 6].map(|l| elements[id / 6][l])).collect()
}

/// Area of a bilinear face, shared among its four nodes by their shape functions (2 x 2 Gauss
/// points).
pub fn face_areas(corners: [[f64; 3]; 4]) -> [f64; 4] {
    const SIGN: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let g = 1.0 / 3f64.sqrt();
    let mut share = [0.0; 4];
    for point in SIGN {
        let (xi, eta) = (g * point[0], g * point[1]);
        let (mut t, mut s) = ([0.0; 3], [0.0; 3]);
        for (corner, sign) in corners.iter().zip(SIGN) {
            for k in 0..3 {
                t[k] += 0.25 * sign[0] * (1.0 + sign[1] * eta) * corner[k];
                s[k] += 0.25 * sign[1] * (1.0 + sign[0] * xi) * corner[k];
            }
        }
        let n = [t[1] * s[2] - t[2] * s[1], t[2] * s[0] - t[0] * s[2], t[0] * s[1] - t[1] * s[0]];
        let area = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        for (part, sign) in share.iter_mut().zip(SIGN) {
            *part += 0.25 * (1.0 + sign[0] * xi) * (1.0 + sign[1] * eta) * area;
        }
    }
    share
}

/// Tributary area and local element size at each of `contact_nodes`, from all surface `faces`
/// around them.
pub fn contact_measures(nodes: &[[f64; 3]], faces: &[[u32; 4]], contact_nodes: &[u32]) -> (Vec<f64>, Vec<f64>) {
    const OWN: [[f64; 4]; 4] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let mut measures = Measures::new(nodes.len());
    faces.iter().for_each(|&face| measures.add(face.map(|n| nodes[n as usize]), face, OWN));
    measures.at(contact_nodes)
}

/// What the faces of a surface leave at its nodes.
pub struct Measures {
    tributary: Vec<f64>,
    /// Sum of the areas of the faces around a node, and their number.
    around: Vec<(f64, usize)>,
}

impl Measures {
    /// Of no face yet.
    pub fn new(nodes: usize) -> Self {
        Self { tributary: vec![0.0; nodes], around: vec![(0.0, 0); nodes] }
    }

    /// Adds a face by the positions of its corners and the nodes that it names, with the share of
    /// each node in each corner.
    pub fn add(&mut self, corners: [[f64; 3]; 4], named: [u32; 4], shares: [[f64; 4]; 4]) {
        let areas = face_areas(corners);
        let total: f64 = areas.iter().sum();
        for (k, &node) in named.iter().enumerate() {
            let node = node as usize;
            // A product with one and sums with zero change no bits.
            self.tributary[node] += (0..4).filter(|&c| shares[c][k] != 0.0).map(|c| shares[c][k] * areas[c]).sum::<f64>();
            self.around[node].0 += total;
            self.around[node].1 += 1;
        }
    }

    /// Tributary area and local element size, the root of the mean area around, of nodes.
    pub fn at(&self, nodes: &[u32]) -> (Vec<f64>, Vec<f64>) {
        let of = |&n: &u32| {
            let (area, count) = self.around[n as usize];
            (self.tributary[n as usize], (area / count.max(1) as f64).sqrt())
        };
        nodes.iter().map(of).unzip()
    }
}
