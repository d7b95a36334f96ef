// Contact forces of all spheres of one process, for `fix external` of any LAMMPS: the exported header with a neighbour list and the
// memory of the contacts round it. It includes nothing of LAMMPS, which lends its arrays and a function. Under the licences of the
// repository (MIT or Apache-2.0).

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "asperity_contact3d.h"

namespace {

struct Law {
  asperity_table table;
  asperity_law3d law;
};

struct Engine {
  int types;
  std::vector<std::shared_ptr<Law>> laws;
  std::map<std::pair<int, int>, asperity_contact> contacts;    // by IDs, the lower one first

  std::shared_ptr<Law> &of(int a, int b) { return laws[(a - 1) * types + b - 1]; }
};

// lammps_neighlist_element_neighbors() of LAMMPS' library interface.
using Neighbours = void (*)(void *, int, int, int *, int *, int **);

}    // namespace

extern "C" {

// What LAMMPS lends; arrays are of owned spheres and, behind them, ghosts.
struct asperity_atoms {
  int count;    // owned
  const int *id, *type;
  double **x, **v, **omega;
  const double *radius, *mass;
  double **torque;
  void *lammps;
  Neighbours neighbours;
  int list, length;    // index and length of a full neighbour list
};

void *asperity_open(int types)
{
  auto *engine = new Engine;
  engine->types = types;
  engine->laws.resize(types * types);
  return engine;
}

void asperity_close(void *self) { delete static_cast<Engine *>(self); }

// The law of two types. 0, or: -1 to -3 of asperity_read_table() with its sign turned, else what asperity_pair_law() says.
int asperity_add_law(void *self, int a, int b, const char *file, double modulus, double restitution)
{
  auto *engine = static_cast<Engine *>(self);
  auto law = std::make_shared<Law>();
  if (const int code = asperity_read_table(file, &law->table)) return -code;
  if (const int code = asperity_pair_law(&law->law, &law->table, modulus, restitution)) return code;
  engine->of(a, b) = engine->of(b, a) = law;
  return 0;
}

// Adds forces to f (3 numbers a sphere) and torques to those of LAMMPS. With dt = 0 no contact moves on, as LAMMPS asks before a run.
// sums: elastic energy, work dissipated by plastic flow, by slip and by damping in this step. 0; else the ID of a sphere for whose
// contact there is no force or no law.
int asperity_forces_of_all(void *self, const asperity_atoms *atoms, double dt, double *f, double sums[4])
{
  auto *engine = static_cast<Engine *>(self);
  std::map<std::pair<int, int>, asperity_contact> next;
  const auto body = [&](int i) {
    asperity_body made;
    std::copy(atoms->x[i], atoms->x[i] + 3, made.position);
    std::copy(atoms->v[i], atoms->v[i] + 3, made.velocity);
    std::copy(atoms->omega[i], atoms->omega[i] + 3, made.spin);
    made.radius = atoms->radius[i];
    made.mass = atoms->mass[i];
    return made;
  };
  for (int k = 0; k < 4; k++) sums[k] = 0.0;
  for (int element = 0; element < atoms->length; element++) {
    int i, count, *others;
    atoms->neighbours(atoms->lammps, atoms->list, element, &i, &count, &others);
    for (int n = 0; n < count; n++) {
      const int j = others[n];
      // The list is full: of two owned spheres the one with the lower ID asks; a ghost is asked for by its owner's partner.
      if (j < atoms->count && atoms->id[i] > atoms->id[j]) continue;
      const bool first = atoms->id[i] < atoms->id[j];
      const int a = first ? i : j, b = first ? j : i;
      const std::pair<int, int> ids(atoms->id[a], atoms->id[b]);
      const auto known = engine->contacts.find(ids);
      const asperity_body one = body(a), other = body(b);
      double distance2 = 0.0;
      for (int k = 0; k < 3; k++) distance2 += (one.position[k] - other.position[k]) * (one.position[k] - other.position[k]);
      const double sum = one.radius + other.radius;
      if (known == engine->contacts.end() && distance2 >= sum * sum) continue;
      asperity_contact before = {}, after;
      if (known != engine->contacts.end()) before = known->second;
      const auto &law = engine->of(atoms->type[i], atoms->type[j]);
      asperity_forces out;
      if (!law) return atoms->id[i];
      asperity_spheres(&law->law, &one, &other, dt, &before, &after, &out);
      if (out.flags & (ASPERITY_NO_NUMBER | ASPERITY_WRONG_TABLE)) return atoms->id[i];
      const double share = j < atoms->count ? 1.0 : 0.5;    // the other half is its owner's
      for (const int sphere : {a, b}) {
        if (sphere >= atoms->count) continue;
        const double *force = sphere == a ? out.force_i : out.force_j, *torque = sphere == a ? out.torque_i : out.torque_j;
        for (int k = 0; k < 3; k++) {
          f[3 * sphere + k] += force[k];
          atoms->torque[sphere][k] += torque[k];
        }
      }
      sums[0] += share * out.stored;
      sums[1] += share * (after.plastic - before.plastic);
      sums[2] += share * (after.slip - before.slip);
      sums[3] += share * out.damped;
      if (!asperity_may_forget(&after)) next[ids] = after;
    }
  }
  // What is in no neighbour list any more is forgotten.
  if (dt > 0.0) engine->contacts.swap(next);
  return 0;
}
}
