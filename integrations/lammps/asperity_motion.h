// How a wall moves: with a speed and a spin that are given, or along a line under a load.
// Under the GNU General Public License, version 2, as the files that include it.
#ifndef ASPERITY_MOTION_H
#define ASPERITY_MOTION_H

#include "asperity_shapes.h"

namespace LAMMPS_NS {

struct Motion {
  double place[3] = {}, velocity[3] = {}, spin[3] = {};
  double turn[4] = {1.0, 0.0, 0.0, 0.0};    // the quaternion from the frame of the wall to that of the box
  // A wall under a load moves freely along `direction`, as mass dv/dt = load + force of the spheres - damping v.
  bool loaded = false;
  double direction[3] = {}, load = 0.0, mass = 0.0, damping = 0.0;

  bool turned() const { return turn[1] != 0.0 || turn[2] != 0.0 || turn[3] != 0.0; }
  bool spins() const { return spin[0] != 0.0 || spin[1] != 0.0 || spin[2] != 0.0; }

  void set_load(const double numbers[4])
  {
    std::copy(numbers, numbers + 3, direction);
    if (!(unit(direction) > 0.0) || !std::isfinite(numbers[0] + numbers[1] + numbers[2] + numbers[3]))
      throw std::runtime_error("the direction of the load is zero, or the load is no number");
    load = numbers[3];
    loaded = true;
  }

  // Leapfrog, as LAMMPS moves spheres: the force is that at the beginning of the step, places are of its end.
  void advance(double dt, const double force[3])
  {
    if (loaded) {
      const double v = asperity_dot(velocity, direction), half = 0.5 * damping * dt / mass;
      const double push = (load + asperity_dot(force, direction)) * dt / mass;
      const double faster = (v * (1.0 - half) + push) / (1.0 + half) - v;
      for (int k = 0; k < 3; k++) velocity[k] += faster * direction[k];
    }
    for (int k = 0; k < 3; k++) place[k] += velocity[k] * dt;
    if (spins()) rotate(dt);
  }

  // From the frame of the box to that of the wall, and back.
  void into(const double v[3], double out[3]) const { rotated(v, -1.0, out); }
  void back(double v[3]) const
  {
    double out[3];
    rotated(v, 1.0, out);
    std::copy(out, out + 3, v);
  }

 private:
  void rotate(double dt)
  {
    const double w = sqrt(asperity_dot(spin, spin)), s = sin(0.5 * w * dt) / w, c = cos(0.5 * w * dt);
    const double p[4] = {c, s * spin[0], s * spin[1], s * spin[2]}, *q = turn;
    double r[4] = {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
                   p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
    const double size = sqrt(r[0] * r[0] + asperity_dot(r + 1, r + 1));
    for (int k = 0; k < 4; k++) turn[k] = r[k] / size;
  }
  void rotated(const double v[3], double sense, double out[3]) const
  {
    const double u[3] = {sense * turn[1], sense * turn[2], sense * turn[3]};
    double once[3], twice[3];
    asperity_cross(u, v, once);
    asperity_cross(u, once, twice);
    for (int k = 0; k < 3; k++) out[k] = v[k] + 2.0 * (turn[0] * once[k] + twice[k]);
  }
};

}    // namespace LAMMPS_NS

#endif
