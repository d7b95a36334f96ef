// Where a sphere touches a wall: planes, cylinders and cones. All in the frame of the wall, whose origin is its place.
// Under the GNU General Public License, version 2, as the files that include it.
#ifndef ASPERITY_SHAPES_H
#define ASPERITY_SHAPES_H

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "asperity_contact3d.h"

namespace LAMMPS_NS {

// A place where a sphere touches, or nearly so: the plane tangent to the wall there.
struct Touch {
  double from[3];      // the sphere's centre less a point of the plane
  double normal[3];    // of the plane, of length 1; to the sphere
  double distance;     // of the centre from the plane

  void set_distance() { distance = asperity_dot(from, normal); }
};

// FNV-1a over numbers: what tells one shape from another in a restart file.
inline uint64_t hash_numbers(uint64_t hash, const double *numbers, size_t count)
{
  const auto *bytes = reinterpret_cast<const unsigned char *>(numbers);
  for (size_t k = 0; k < count * sizeof(double); k++) hash = (hash ^ bytes[k]) * 1099511628211ULL;
  return hash;
}

inline double unit(double v[3])
{
  const double size = sqrt(asperity_dot(v, v));
  for (int k = 0; k < 3; k++) v[k] /= size;
  return size;
}

class Shape {
 public:
  virtual ~Shape() = default;

  // The places where a sphere touches, its centre at `c`, nearest first. Those beyond `reach` of the centre need not be told.
  // Throws std::runtime_error, with what is wrong, where a sphere cannot be.
  virtual void touches(const double c[3], double radius, double reach, std::vector<Touch> &out) const = 0;
  virtual uint64_t fingerprint() const = 0;
  // The point about which images across periodic boundaries are taken, and the axis along which there are none; see wrap().
  virtual void middle(double point[3]) const { point[0] = point[1] = point[2] = 0.0; }
  virtual const double *axis() const { return nullptr; }
  virtual bool is_plane() const { return false; }
  // Whether a sphere there does not touch; false where that is not seen at once.
  virtual bool is_far(const double[3], double) const { return false; }
};

class Plane : public Shape {
  double normal[3];

 public:
  explicit Plane(const double n[3])
  {
    std::copy(n, n + 3, normal);
    const double size = unit(normal);
    if (!(size > 0.0) || !std::isfinite(size)) throw std::runtime_error("the normal is zero, or no direction");
  }
  void touches(const double c[3], double, double, std::vector<Touch> &out) const override
  {
    Touch touch;
    std::copy(c, c + 3, touch.from);
    std::copy(normal, normal + 3, touch.normal);
    touch.set_distance();
    out.push_back(touch);
  }
  uint64_t fingerprint() const override { return hash_numbers(1, normal, 3); }
  bool is_plane() const override { return true; }
  bool is_far(const double c[3], double radius) const override { return asperity_dot(c, normal) >= radius; }
};

// A circular cylinder without ends, its axis through the origin.
class Cylinder : public Shape {
  double along[3], radius;
  bool inside;

 public:
  Cylinder(const double axis[3], double radius, bool inside) : radius(radius), inside(inside)
  {
    std::copy(axis, axis + 3, along);
    if (!(unit(along) > 0.0)) throw std::runtime_error("the axis is zero");
    if (!(radius > 0.0) || !std::isfinite(radius)) throw std::runtime_error("the radius of the cylinder is not positive");
  }
  void touches(const double c[3], double sphere, double reach, std::vector<Touch> &out) const override
  {
    if (inside && !(sphere < radius))
      throw std::runtime_error("with the radius " + std::to_string(sphere) +
                               " is not smaller than the cylinder that it is to be in");
    double across[3];
    const double z = asperity_dot(c, along);
    for (int k = 0; k < 3; k++) across[k] = c[k] - z * along[k];
    const double r = sqrt(asperity_dot(across, across)), gap = inside ? radius - r : r - radius;
    if (gap >= reach) return;
    if (!(r > 0.0)) throw std::runtime_error("has its centre on the axis of the cylinder");
    Touch touch;
    for (int k = 0; k < 3; k++) {
      const double outward = across[k] / r;
      touch.normal[k] = inside ? -outward : outward;
      touch.from[k] = (r - radius) * outward;
    }
    touch.distance = gap;
    out.push_back(touch);
  }
  uint64_t fingerprint() const override
  {
    const double numbers[5] = {along[0], along[1], along[2], radius, inside ? 1.0 : 0.0};
    return hash_numbers(2, numbers, 5);
  }
  const double *axis() const override { return along; }
};

// The mantle of a truncated cone, a thin shell with two sides and two rims: from the origin with the radius r1 to the other end
// with the radius r2. With equal radii it is a tube.
class Cone : public Shape {
  double along[3], length, r1, r2;

  // The nearest point (rn, zn) of the shell's trace to (r, z); whether it is within, not on a rim.
  bool nearest(double r, double z, double &rn, double &zn) const
  {
    const double dr = r2 - r1, t = ((r - r1) * dr + z * length) / (dr * dr + length * length);
    const double s = std::min(std::max(t, 0.0), 1.0);
    rn = r1 + s * dr;
    zn = s * length;
    return s > 0.0 && s < 1.0;
  }

 public:
  Cone(const double other[3], double r1, double r2) : r1(r1), r2(r2)
  {
    std::copy(other, other + 3, along);
    length = unit(along);
    if (!(length > 0.0)) throw std::runtime_error("both ends of the cone are the same");
    if (!(r1 >= 0.0 && r2 >= 0.0 && r1 + r2 > 0.0) || !std::isfinite(r1 + r2))
      throw std::runtime_error("the radii of the cone are not 0 or more, and one of them positive");
  }
  void touches(const double c[3], double sphere, double reach, std::vector<Touch> &out) const override
  {
    double across[3], rn, zn;
    const double z = asperity_dot(c, along);
    for (int k = 0; k < 3; k++) across[k] = c[k] - z * along[k];
    const double r = sqrt(asperity_dot(across, across));
    const bool face = nearest(r, z, rn, zn);
    if (hypot(r - rn, z - zn) >= reach) return;
    const double slant = hypot(r2 - r1, length);
    // Within the shell the other side may be as near: then the sphere plugs it, and touches all round.
    if (r < rn) {
      double ro, zo;
      nearest(-r, z, ro, zo);
      if (hypot(r + ro, z - zo) < sphere)
        throw std::runtime_error("plugs the cone: it touches all round, and a contact is a spot");
    }
    Touch touch;
    // Both parts of the normal: across the axis and along it. On the axis itself there is no direction across.
    double nr, nz;
    if (face) {
      const double side = (r - rn) * length - (z - zn) * (r2 - r1) < 0.0 ? -1.0 : 1.0;
      nr = side * length / slant;
      nz = -side * (r2 - r1) / slant;
    } else {
      nr = r - rn;
      nz = z - zn;
      const double size = hypot(nr, nz);
      if (!(size > 0.0)) throw std::runtime_error("has its centre on the rim of the cone");
      nr /= size;
      nz /= size;
    }
    if (!(r > 0.0) && nr != 0.0)
      throw std::runtime_error("is on the axis of the cone: it touches all round, and a contact is a spot");
    for (int k = 0; k < 3; k++) {
      const double outward = r > 0.0 ? across[k] / r : 0.0;
      touch.normal[k] = nr * outward + nz * along[k];
      touch.from[k] = (r - rn) * outward + (z - zn) * along[k];
    }
    touch.set_distance();
    out.push_back(touch);
  }
  uint64_t fingerprint() const override
  {
    const double numbers[6] = {along[0], along[1], along[2], length, r1, r2};
    return hash_numbers(3, numbers, 6);
  }
  void middle(double point[3]) const override
  {
    for (int k = 0; k < 3; k++) point[k] = 0.5 * length * along[k];
  }
};

}    // namespace LAMMPS_NS

#endif
