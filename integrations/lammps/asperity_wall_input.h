// The words of fix wall/asperity. Under the GNU General Public License, version 2.
#ifndef ASPERITY_WALL_INPUT_H
#define ASPERITY_WALL_INPUT_H

#include "asperity_common.h"
#include "asperity_mesh.h"
#include "asperity_motion.h"

namespace LAMMPS_NS {

// What is wrong with a shape, a file or a motion is thrown, as std::runtime_error.
class WallInput {
  static constexpr const char *USAGE =
      "fix ID group wall/asperity SHAPE type T TABLE E [restitution e] [tangential f] [cohesion W [range Z]] [changed] "
      "[type ...] [velocity vx vy vz] [turning yes|no] [spin wx wy wz] [load dx dy dz F mass M [damping C]], SHAPE: "
      "x y z nx ny nz | "
      "cylinder x y z ax ay az R inside or outside | cone x1 y1 z1 R1 x2 y2 z2 R2 | "
      "stl FILE [scale s] [shift x y z] [at x y z] [merge DEGREES]";
  static constexpr double MERGE = 15.0, FOLLOWS = 30.0;    // degrees

  LAMMPS *lmp;
  std::vector<std::shared_ptr<Law>> &laws;
  Motion &motion;
  std::string file;
  double scale = 1.0, merge = MERGE, shift[3] = {}, at[3] = {};
  bool stl = false, placed = false;

  double number(const char *word) { return utils::numeric(FLERR, word, false, lmp); }
  void numbers(char **arg, int count, double *out)
  {
    for (int k = 0; k < count; k++) out[k] = number(arg[k]);
  }

  // The wall's place and shape; the number of the word behind.
  int read_shape(int narg, char **arg)
  {
    if (narg < 5) lmp->error->all(FLERR, USAGE);
    if (strcmp(arg[3], "stl") == 0) {
      stl = true;
      file = arg[4];
      return 5;
    }
    double v[8];
    if (strcmp(arg[3], "cylinder") == 0) {
      const bool inside = narg > 11 && strcmp(arg[11], "inside") == 0;
      if (narg < 12 || (!inside && strcmp(arg[11], "outside") != 0)) lmp->error->all(FLERR, USAGE);
      numbers(arg + 4, 7, v);
      std::copy(v, v + 3, motion.place);
      shape.reset(new Cylinder(v + 3, v[6], inside));
      return 12;
    }
    if (strcmp(arg[3], "cone") == 0) {
      if (narg < 12) lmp->error->all(FLERR, USAGE);
      numbers(arg + 4, 8, v);
      std::copy(v, v + 3, motion.place);
      for (int k = 0; k < 3; k++) v[4 + k] -= v[k];
      shape.reset(new Cone(v + 4, v[3], v[7]));
      least_cosine = cos(FOLLOWS * M_PI / 180.0);
      return 12;
    }
    if (narg < 9) lmp->error->all(FLERR, USAGE);
    numbers(arg + 3, 6, v);
    std::copy(v, v + 3, motion.place);
    shape.reset(new Plane(v + 3));
    return 9;
  }

  // What stands behind the shape.
  void read_words(int k, int narg, char **arg)
  {
    std::shared_ptr<Law> last;
    while (k < narg) {
      const int left = narg - k;
      if (strcmp(arg[k], "type") == 0 && left > 3) {
        last = read_law(arg + k);
        k += 4;
      } else if (strcmp(arg[k], "turning") == 0 && left > 1) {
        turning = yes_or_no(lmp, "fix wall/asperity: turning", arg[k + 1]);
        k += 2;
      } else if (const int taken = read_motion(left, arg + k)) {
        k += taken;
      } else if (const int taken = stl ? read_mesh_word(left, arg + k) : 0) {
        k += taken;
      } else if (const int taken = last ? law_word(lmp, *last, left, arg + k) : 0) {
        k += taken;
      } else {
        lmp->error->all(FLERR, "fix wall/asperity: unknown word {}", arg[k]);
      }
    }
  }

  std::shared_ptr<Law> read_law(char **arg)
  {
    int lo, hi;
    utils::bounds(FLERR, arg[1], 1, lmp->atom->ntypes, lo, hi, lmp->error);
    auto law = make_law(lmp, arg[2], arg[3]);
    if (!law->table.plane)
      lmp->error->all(FLERR, "fix wall/asperity: {} is the table of two spheres, and a wall needs that of a sphere on a plane",
                      arg[2]);
    for (int type = lo; type <= hi; type++) laws[type] = law;
    return law;
  }

  void read_mesh()
  {
    const double *place = placed ? at : shift;
    double offset[3];
    for (int k = 0; k < 3; k++) {
      motion.place[k] = place[k];
      offset[k] = shift[k] - place[k];
    }
    try {
      shape.reset(new Mesh(file, scale, offset, merge));
    } catch (const std::runtime_error &problem) {
      throw std::runtime_error("the file " + file + " " + problem.what());
    }
    least_cosine = cos(std::max(FOLLOWS, merge) * M_PI / 180.0);
  }

  int read_mesh_word(int left, char **arg)
  {
    if (strcmp(arg[0], "scale") == 0 && left > 1) {
      scale = number(arg[1]);
      if (!(scale > 0.0) || !std::isfinite(scale)) throw std::runtime_error("the scale is not positive");
      return 2;
    }
    if (strcmp(arg[0], "at") == 0 && left > 3) {
      numbers(arg + 1, 3, at);
      placed = true;
      return 4;
    }
    if (strcmp(arg[0], "shift") == 0 && left > 3) {
      numbers(arg + 1, 3, shift);
      return 4;
    }
    if (strcmp(arg[0], "merge") == 0 && left > 1) {
      merge = number(arg[1]);
      if (!(merge >= 1.0 && merge <= 60.0)) throw std::runtime_error("merge is not from 1 to 60 degrees");
      return 2;
    }
    return 0;
  }

 public:
  std::unique_ptr<Shape> shape;
  double least_cosine = -1.0;    // of the old and the new normal of a contact
  bool turning = false;          // whether contacts twist and roll

  WallInput(LAMMPS *lmp, std::vector<std::shared_ptr<Law>> &laws, Motion &motion) : lmp(lmp), laws(laws), motion(motion) {}

  // velocity, spin, load, unloaded, mass, damping: how many words were taken.
  int read_motion(int left, char **arg)
  {
    if (strcmp(arg[0], "velocity") == 0 && left > 3) {
      numbers(arg + 1, 3, motion.velocity);
      return 4;
    }
    if (strcmp(arg[0], "spin") == 0 && left > 3) {
      numbers(arg + 1, 3, motion.spin);
      return 4;
    }
    if (strcmp(arg[0], "load") == 0 && left > 4) {
      double v[4];
      numbers(arg + 1, 4, v);
      motion.set_load(v);
      return 5;
    }
    if (strcmp(arg[0], "unloaded") == 0) {
      motion.loaded = false;
      return 1;
    }
    if (strcmp(arg[0], "mass") == 0 && left > 1) {
      motion.mass = number(arg[1]);
      if (!(motion.mass > 0.0) || !std::isfinite(motion.mass)) throw std::runtime_error("the mass of the wall is not positive");
      return 2;
    }
    if (strcmp(arg[0], "damping") == 0 && left > 1) {
      motion.damping = number(arg[1]);
      if (!(motion.damping >= 0.0) || !std::isfinite(motion.damping))
        throw std::runtime_error("the wall's damping is not 0 or more");
      return 2;
    }
    return 0;
  }

  void read(int narg, char **arg)
  {
    read_words(read_shape(narg, arg), narg, arg);
    for (const auto &law : laws)
      if (law) set_cohesion(lmp, *law);
    if (stl) read_mesh();
  }
};

}    // namespace LAMMPS_NS

#endif
