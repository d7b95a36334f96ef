// A wall of triangles: where a sphere touches it. Under the GNU General Public License, version 2, as the files that include it.
//
// A contact is a local minimum of the distance between the sphere's centre and the surface. As triangles are convex, a point is
// one if and only if it is the nearest point of every triangle that it belongs to. It follows that a flat patch has one contact,
// of however many triangles, edges and corners it is made; that an edge or a corner counts where the surface falls off from it
// on all sides, and once; and that a groove has one contact on each side. Of minima in nearly one direction the deepest counts
// alone.
#ifndef ASPERITY_MESH_H
#define ASPERITY_MESH_H

#include "asperity_shapes.h"
#include "asperity_stl.h"

namespace LAMMPS_NS {

class Mesh : public Shape {
  struct Triangle {
    double corner[3][3], normal[3], out[3][3];    // out: in its plane, across edge k (from corner k to the next) and away from it
  };
  struct Node {
    double lo[3], hi[3];
    int first, count;    // of a leaf: its triangles; else count = 0, and the children are at index + 1 and `first`
  };
  struct Nearest {
    const Triangle *triangle;
    double point[3], distance;
    bool face;
  };
  static constexpr int LEAF = 4;
  static constexpr size_t MOST = 100000000;
  // Triangles whose corners are this near, over the sphere's radius, belong together.
  static constexpr double JOINED = 1e-6;

  std::vector<Corners> given;    // in the frame of the wall
  std::vector<Triangle> triangles;
  std::vector<Node> nodes;
  // Angles of a binary file, which has seven digits: 24 faces of a tube lie 15 degrees apart, to this.
  static constexpr double ROUNDED = 1e-5;
  double merge;                  // cosine of the angle within which minima are one contact
  double low[3] = {}, period[3] = {};    // of the box in the frame of the wall; 0: not periodic

  static Triangle make(const Corners &corners, const double shift[3])
  {
    Triangle t;
    double e[3][3];
    for (int k = 0; k < 3; k++)
      for (int d = 0; d < 3; d++) {
        t.corner[k][d] = corners[k][d] + shift[d];
        e[k][d] = corners[(k + 1) % 3][d] - corners[k][d];
      }
    asperity_cross(e[0], e[1], t.normal);
    unit(t.normal);
    for (int k = 0; k < 3; k++) {
      asperity_cross(e[k], t.normal, t.out[k]);
      unit(t.out[k]);
    }
    return t;
  }

  static Nearest nearest(const Triangle &t, const double c[3])
  {
    Nearest found;
    found.triangle = &t;
    double from[3];
    for (int d = 0; d < 3; d++) from[d] = c[d] - t.corner[0][d];
    const double height = asperity_dot(from, t.normal);
    found.face = true;
    for (int k = 0; k < 3; k++) {
      for (int d = 0; d < 3; d++) from[d] = c[d] - t.corner[k][d];
      if (asperity_dot(from, t.out[k]) > 0.0) found.face = false;
    }
    if (found.face) {
      for (int d = 0; d < 3; d++) found.point[d] = c[d] - height * t.normal[d];
      found.distance = std::abs(height);
      return found;
    }
    found.distance = INFINITY;
    for (int k = 0; k < 3; k++) {
      double edge[3], point[3], gap[3];
      for (int d = 0; d < 3; d++) {
        edge[d] = t.corner[(k + 1) % 3][d] - t.corner[k][d];
        from[d] = c[d] - t.corner[k][d];
      }
      const double s = std::min(std::max(asperity_dot(from, edge) / asperity_dot(edge, edge), 0.0), 1.0);
      for (int d = 0; d < 3; d++) {
        point[d] = t.corner[k][d] + s * edge[d];
        gap[d] = c[d] - point[d];
      }
      const double distance = sqrt(asperity_dot(gap, gap));
      if (distance < found.distance) {
        found.distance = distance;
        std::copy(point, point + 3, found.point);
      }
    }
    return found;
  }

  void bounds(int first, int count, double lo[3], double hi[3]) const
  {
    for (int d = 0; d < 3; d++) {
      lo[d] = INFINITY;
      hi[d] = -INFINITY;
    }
    for (int n = first; n < first + count; n++)
      for (const auto &corner : triangles[n].corner)
        for (int d = 0; d < 3; d++) {
          lo[d] = std::min(lo[d], corner[d]);
          hi[d] = std::max(hi[d], corner[d]);
        }
  }

  // A tree of boxes over the triangles, halved by number across the longest side.
  void build(int first, int count)
  {
    const size_t here = nodes.size();
    nodes.emplace_back();
    bounds(first, count, nodes[here].lo, nodes[here].hi);
    nodes[here].first = first;
    nodes[here].count = count;
    if (count <= LEAF) return;
    int side = 0;
    for (int d = 1; d < 3; d++)
      if (nodes[here].hi[d] - nodes[here].lo[d] > nodes[here].hi[side] - nodes[here].lo[side]) side = d;
    const auto middle = [side](const Triangle &t) { return t.corner[0][side] + t.corner[1][side] + t.corner[2][side]; };
    const auto begin = triangles.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](const Triangle &a, const Triangle &b) { return middle(a) < middle(b); });
    build(first, count / 2);
    nodes[here].count = 0;
    nodes[here].first = static_cast<int>(nodes.size());
    build(first + count / 2, count - count / 2);
  }

  // Nearest points, of all triangles within `reach`.
  void near(const double c[3], double reach, std::vector<Nearest> &out) const
  {
    int open[128], depth = 0;
    open[depth++] = 0;
    while (depth > 0) {
      const int index = open[--depth];
      const Node &node = nodes[index];
      double gap = 0.0;
      for (int d = 0; d < 3; d++) {
        const double away = std::max(std::max(node.lo[d] - c[d], c[d] - node.hi[d]), 0.0);
        gap += away * away;
      }
      if (gap >= reach * reach) continue;
      if (node.count == 0) {
        open[depth++] = node.first;
        open[depth++] = index + 1;
        continue;
      }
      for (int n = node.first; n < node.first + node.count; n++) {
        const Nearest found = nearest(triangles[n], c);
        if (found.distance < reach) out.push_back(found);
      }
    }
  }

  // Whether no triangle that the point of all[index] belongs to has a nearer one. They are sorted by distance, and one that has
  // is more often a neighbour than not: they are asked from the farthest on.
  static bool is_minimum(size_t index, const std::vector<Nearest> &all, double joined)
  {
    const Nearest &candidate = all[index];
    if (candidate.face) return true;
    while (index-- > 0) {
      const Nearest &other = all[index];
      if (other.distance < candidate.distance - 2.0 * joined && nearest(*other.triangle, candidate.point).distance <= joined)
        return false;
    }
    return true;
  }

 public:
  // Coordinates are those of the file times `scale`, plus `shift`.
  Mesh(const std::string &file, double scale, const double shift[3], double merge_degrees) :
      given(Stl::read(file, scale)), merge(cos(merge_degrees * M_PI / 180.0 + ROUNDED))
  {
    for (auto &corners : given)
      for (auto &corner : corners)
        for (int d = 0; d < 3; d++) corner[d] += shift[d];
    const double none[3] = {0.0, 0.0, 0.0};
    span(none, none, 0.0);
  }

  // Makes the triangles, with their images across periodic boundaries: of a box from `lo` on, `lengths` long (0: not periodic
  // there), in the frame of the wall, and `margin` around it.
  void span(const double lo[3], const double lengths[3], double margin)
  {
    std::copy(lo, lo + 3, low);
    std::copy(lengths, lengths + 3, period);
    triangles.clear();
    nodes.clear();
    for (const auto &corners : given) {
      int begin[3], end[3];
      for (int d = 0; d < 3; d++) {
        const double least = std::min({corners[0][d], corners[1][d], corners[2][d]});
        const double most = std::max({corners[0][d], corners[1][d], corners[2][d]});
        const double first = period[d] > 0.0 ? ceil((low[d] - margin - most) / period[d]) : 0.0;
        const double last = period[d] > 0.0 ? floor((low[d] + period[d] + margin - least) / period[d]) : 0.0;
        if (last - first > 1000.0) throw std::runtime_error("its facets are more than 1000 times as long as the periodic box");
        begin[d] = static_cast<int>(first);
        end[d] = static_cast<int>(last);
      }
      for (int i = begin[0]; i <= end[0]; i++)
        for (int j = begin[1]; j <= end[1]; j++)
          for (int k = begin[2]; k <= end[2]; k++) {
            const double shift[3] = {i * period[0], j * period[1], k * period[2]};
            triangles.push_back(make(corners, shift));
            if (triangles.size() > MOST)
              throw std::runtime_error("it has more than 100 million facets with their periodic images");
          }
    }
    if (!triangles.empty()) build(0, static_cast<int>(triangles.size()));
  }

  void touches(const double centre[3], double radius, double reach, std::vector<Touch> &out) const override
  {
    if (nodes.empty()) return;
    double c[3];
    for (int d = 0; d < 3; d++) {
      c[d] = centre[d];
      if (period[d] > 0.0) c[d] -= period[d] * floor((c[d] - low[d]) / period[d]);
    }
    std::vector<Nearest> all;
    near(c, reach, all);
    if (all.empty()) return;
    // Equal depths, and with them which one of several is kept, in an order that does not depend on that of the tree.
    std::sort(all.begin(), all.end(), [](const Nearest &a, const Nearest &b) {
      if (a.distance != b.distance) return a.distance < b.distance;
      return std::lexicographical_compare(a.point, a.point + 3, b.point, b.point + 3);
    });
    for (size_t index = 0; index < all.size(); index++) {
      const Nearest &candidate = all[index];
      Touch touch;
      touch.distance = candidate.distance;
      const double *point = candidate.face ? candidate.triangle->corner[0] : candidate.point;
      for (int d = 0; d < 3; d++) touch.from[d] = c[d] - point[d];
      if (candidate.face) {
        const double side = asperity_dot(touch.from, candidate.triangle->normal) < 0.0 ? -1.0 : 1.0;
        for (int d = 0; d < 3; d++) touch.normal[d] = side * candidate.triangle->normal[d];
      } else {
        if (!(candidate.distance > 0.0)) throw std::runtime_error("has its centre on an edge of the wall");
        for (int d = 0; d < 3; d++) touch.normal[d] = touch.from[d] / candidate.distance;
      }
      touch.set_distance();
      bool seen = false;
      for (const Touch &deeper : out) seen = seen || asperity_dot(deeper.normal, touch.normal) >= merge;
      if (!seen && is_minimum(index, all, JOINED * radius)) out.push_back(touch);
    }
  }

  uint64_t fingerprint() const override
  {
    uint64_t hash = 4;
    for (const auto &corners : given) hash = hash_numbers(hash, corners[0].data(), 9);
    return hash_numbers(hash, &merge, 1);
  }
};

}    // namespace LAMMPS_NS

#endif
