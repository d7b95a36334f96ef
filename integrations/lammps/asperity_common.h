// What the styles of the plug-in share: laws and what tells them apart, and conventions of LAMMPS (masses, radii to come).
// Under the GNU General Public License, version 2 (LICENSE beside it), as the file that includes it.
#ifndef ASPERITY_COMMON_H
#define ASPERITY_COMMON_H

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "lammps.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "asperity_contact3d.h"

namespace LAMMPS_NS {

constexpr int NUMBERS = sizeof(asperity_contact) / sizeof(double);
static_assert(NUMBERS == 39, "a contact has 39 numbers");
constexpr int TURNING = sizeof(asperity_turning) / sizeof(double);
static_assert(TURNING == 61, "a contact that twists and rolls has 61 numbers more");
constexpr int COHESION = sizeof(asperity_cohesion) / sizeof(double);
static_assert(COHESION == 7, "a contact with cohesion has 7 numbers more");

// Version of what the plug-in writes to restart files; raised whenever that changes, or what the numbers of a contact mean.
constexpr double LAYOUT = 6.0;
constexpr char MARK[9] = "ASPERITY";

// A law, and what tells it from others.
struct Law {
  asperity_table table;
  asperity_law3d law;
  std::string file;
  bool changed;    // the user says that a restart file has another
  double cohesion = 0.0, range = 0.0;    // work of adhesion, and over what distance

  bool coheres() const { return cohesion > 0.0; }
  uint64_t fingerprint() const { return asperity_fingerprint(&table); }
};

// What a restart file has of a law: fingerprint, Young's modulus and cohesion; 0 of none.
struct Identity {
  static constexpr int SIZE = 4;
  uint64_t fingerprint = 0;
  double modulus = 0.0, cohesion = 0.0, range = 0.0;

  Identity() = default;
  explicit Identity(const Law &law)
      : fingerprint(law.fingerprint()), modulus(law.law.modulus), cohesion(law.cohesion), range(law.range)
  {
  }
  void pack(double *buf) const
  {
    memcpy(buf, &fingerprint, sizeof fingerprint);
    buf[1] = modulus;
    buf[2] = cohesion;
    buf[3] = range;
  }
  void unpack(const double *buf)
  {
    memcpy(&fingerprint, buf, sizeof fingerprint);
    modulus = buf[1];
    cohesion = buf[2];
    range = buf[3];
  }
  // Stops if `law` is another one than this, which a restart file has; `what` says of which spheres.
  void hold(LAMMPS *lmp, const Law &law, const std::string &what) const
  {
    if (fingerprint == 0 || law.changed) return;
    if (law.fingerprint() != fingerprint)
      lmp->error->all(FLERR, "asperity: {} is another table than the one with which the restart file was written, {}. "
                             "Give that one, or say `changed`", law.file, what);
    if (std::abs(law.law.modulus / modulus - 1.0) > 1e-9)
      lmp->error->all(FLERR, "asperity: Young's modulus is {}, and the restart file was written with {}, {}. "
                             "Give that one, or say `changed`", law.law.modulus, modulus, what);
    if (std::abs(law.cohesion - cohesion) > 1e-9 * cohesion || std::abs(law.range - range) > 1e-9 * range)
      lmp->error->all(FLERR, "asperity: the cohesion is {} over a range of {}, and the restart file was written with {} over {}, "
                             "{}. Give that one, or say `changed`", law.cohesion, law.range, cohesion, range, what);
  }
};

// Whether a word is `yes` or `no`.
inline bool yes_or_no(LAMMPS *lmp, const std::string &what, const char *word)
{
  const bool yes = strcmp(word, "yes") == 0;
  if (!yes && strcmp(word, "no") != 0) lmp->error->all(FLERR, "{} yes or {} no, not {}", what, what, word);
  return yes;
}

// Whether a buffer of a restart file is of this layout, its contacts with their twist and roll or without.
inline void require_layout(LAMMPS *lmp, const char *buf, const char *who, bool turning)
{
  double head[3];
  memcpy(head, buf, sizeof head);
  const bool ours = memcmp(buf, MARK, sizeof head[0]) == 0 && head[1] == LAYOUT;
  if (ours && head[2] == NUMBERS + (turning ? TURNING : 0)) return;
  if (ours && head[2] == NUMBERS + (turning ? 0 : TURNING))
    lmp->error->all(FLERR, "{}: the restart file was written with turning {}. Go on with that", who, turning ? "no" : "yes");
  lmp->error->all(FLERR, "{}: the restart file's contacts are of another version of the plug-in. Go on with that version, "
                         "or start anew", who);
}

// The head of what goes into a restart file.
inline void begin_layout(std::vector<double> &buf, bool turning)
{
  buf.assign(3, 0.0);
  memcpy(buf.data(), MARK, sizeof(double));
  buf[1] = LAYOUT;
  buf[2] = NUMBERS + (turning ? TURNING : 0);
}

inline void write_buffer(FILE *fp, const std::vector<double> &buf)
{
  const int size = static_cast<int>(buf.size() * sizeof(double));
  fwrite(&size, sizeof size, 1, fp);
  fwrite(buf.data(), sizeof(double), buf.size(), fp);
}

// Reads a table, every process by itself; what its maker has to say of its range becomes a warning.
inline void read_table(LAMMPS *lmp, const char *file, asperity_table *table)
{
  const int code = asperity_read_table(file, table);
  if (code != 0) {
    const char *problem = code == 1 ? "cannot be opened" : code == 2 ? "is no contact table of this version" : "is damaged";
    lmp->error->all(FLERR, "asperity: table {} {}", file, problem);
  }
  if (lmp->comm->me != 0) return;
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);)
    if (line.rfind("# warning: ", 0) == 0) lmp->error->warning(FLERR, "asperity: table {}: {}", file, line.substr(11));
}

// Takes the words that a law may have behind its table and E: restitution e, tangential f,
// cohesion W, range Z, changed. Returns how many it took.
inline int law_word(LAMMPS *lmp, Law &law, int narg, char **arg)
{
  const bool has_value = narg > 1;
  if (strcmp(arg[0], "restitution") == 0 && has_value) {
    const double e = utils::numeric(FLERR, arg[1], false, lmp), tangential = law.law.tangential;
    if (asperity_make_law(&law.law, &law.table, law.law.modulus, e) == ASPERITY_LAW_RESTITUTION)
      lmp->error->all(FLERR, "asperity: a restitution coefficient of {} is not between 0.1 and 1", e);
    law.law.tangential = tangential;
    return 2;
  }
  if (strcmp(arg[0], "tangential") == 0 && has_value) {
    law.law.tangential = utils::numeric(FLERR, arg[1], false, lmp);
    if (!(law.law.tangential >= 0.0 && std::isfinite(law.law.tangential)))
      lmp->error->all(FLERR, "asperity: a tangential damping of {} times the normal one is not 0 or more", arg[1]);
    return 2;
  }
  if (strcmp(arg[0], "cohesion") == 0 && has_value) {
    law.cohesion = utils::numeric(FLERR, arg[1], false, lmp);
    if (!(law.cohesion >= 0.0 && std::isfinite(law.cohesion)))
      lmp->error->all(FLERR, "asperity: a cohesion of {} is not 0 or more. It is the work of adhesion, energy over area", arg[1]);
    return 2;
  }
  if (strcmp(arg[0], "range") == 0 && has_value) {
    law.range = utils::numeric(FLERR, arg[1], false, lmp);
    if (!(law.range >= 0.0 && std::isfinite(law.range)))
      lmp->error->all(FLERR, "asperity: a range of {} is not 0 or more. It is the distance over which surfaces attract each "
                             "other", arg[1]);
    return 2;
  }
  if (strcmp(arg[0], "changed") == 0) {
    law.changed = true;
    return 1;
  }
  return 0;
}

// Gives a law the cohesion of its words, once all of them are read.
inline void set_cohesion(LAMMPS *lmp, Law &law)
{
  if (law.range > 0.0 && !law.coheres())
    lmp->error->all(FLERR, "asperity: a range of {} is of cohesion: say cohesion W before it", law.range);
  asperity_law_cohesion(&law.law, law.cohesion, law.range);
}

// A law from its table and E.
inline std::shared_ptr<Law> make_law(LAMMPS *lmp, const char *file, const char *modulus)
{
  auto law = std::make_shared<Law>();
  read_table(lmp, file, &law->table);
  law->file = file;
  law->changed = false;
  if (asperity_make_law(&law->law, &law->table, utils::numeric(FLERR, modulus, false, lmp), 1.0) == ASPERITY_LAW_MODULUS)
    lmp->error->all(FLERR, "asperity: Young's modulus {} is not positive", modulus);
  return law;
}

inline void require_spheres(LAMMPS *lmp, const char *who)
{
  Atom *atom = lmp->atom;
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    lmp->error->all(FLERR, "{} needs atom_style sphere", who);
  if (!atom->tag_enable) lmp->error->all(FLERR, "{} needs atom IDs", who);
}

// The greatest radius of each type: of the spheres that are there, and of those that fixes will insert (pour, deposit), which say
// so by extract("radius"), as for LAMMPS' own granular styles.
inline std::vector<double> greatest_radii(LAMMPS *lmp)
{
  Atom *atom = lmp->atom;
  std::vector<double> mine(atom->ntypes + 1, 0.0), all(atom->ntypes + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) mine[atom->type[i]] = std::max(mine[atom->type[i]], atom->radius[i]);
  for (Fix *fix : lmp->modify->get_fix_list())
    for (int type = 1; type <= atom->ntypes; type++) {
      int dimension = type;    // in: the type; out: that it is a single number
      const auto *radius = static_cast<double *>(fix->extract("radius", dimension));
      if (radius && dimension == 0) mine[type] = std::max(mine[type], *radius);
    }
  MPI_Allreduce(mine.data(), all.data(), atom->ntypes + 1, MPI_DOUBLE, MPI_MAX, lmp->world);
  return all;
}

// Masses that are not those of the spheres themselves: of a rigid body, that of the body; of a frozen sphere it is infinite.
class Masses {
  LAMMPS *lmp;
  std::vector<Fix *> rigid;
  int frozen = 0;

 public:
  std::vector<double> instead;    // owned and ghosts; 0: the sphere's own

  explicit Masses(LAMMPS *lmp) : lmp(lmp) {}

  void init()
  {
    rigid.clear();
    frozen = 0;
    for (Fix *fix : lmp->modify->get_fix_list()) {
      if (fix->rigid_flag) rigid.push_back(fix);
      if (utils::strmatch(fix->style, "^freeze")) frozen |= fix->groupbit;
    }
    instead.clear();
  }

  bool any() const { return frozen != 0 || !rigid.empty(); }

  // Looks at the owned spheres again, after atoms have moved to other places.
  void look()
  {
    Atom *atom = lmp->atom;
    instead.assign(std::max(atom->nmax, atom->nlocal + atom->nghost), 0.0);
    for (Fix *fix : rigid) {
      int dimension;
      const int *body = static_cast<int *>(fix->extract("body", dimension));
      const double *mass = static_cast<double *>(fix->extract("masstotal", dimension));
      if (!body || !mass) continue;    // before its set-up
      for (int i = 0; i < atom->nlocal; i++)
        if (body[i] >= 0) instead[i] = mass[body[i]];
    }
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & frozen) instead[i] = INFINITY;
  }

  double of(int i) const
  {
    return static_cast<size_t>(i) < instead.size() && instead[i] > 0.0 ? instead[i] : lmp->atom->rmass[i];
  }
};

inline void fill(asperity_body &body, Atom *atom, const Masses &masses, int i)
{
  for (int k = 0; k < 3; k++) {
    body.position[k] = atom->x[i][k];
    body.velocity[k] = atom->v[i][k];
    body.spin[k] = atom->omega[i][k];
  }
  body.radius = atom->radius[i];
  body.mass = masses.of(i);
}

}    // namespace LAMMPS_NS

#endif
