// A rigid plane: fix ID group wall/asperity x y z nx ny nz type T TABLE E [words] [type ...] [velocity vx vy vz]
// Under the GNU General Public License, version 2.
#ifndef FIX_WALL_ASPERITY_H
#define FIX_WALL_ASPERITY_H

#include "asperity_common.h"

namespace LAMMPS_NS {

class FixWallAsperity : public Fix {
  static constexpr const char *USAGE = "fix ID group wall/asperity x y z nx ny nz type T TABLE E [restitution e] [tangential f] "
                                       "[changed] [type ...] [velocity vx vy vz]";
  static constexpr int LENGTH = 13;
  std::vector<std::shared_ptr<Law>> laws;
  Masses masses;
  std::vector<asperity_contact> contacts;
  asperity_wall wall;
  // Sums of this process: force on the wall, work dissipated by plastic flow, slip and damping, elastic energy, contacts, those
  // out of range; and the work that the wall has done.
  double sum[9] = {}, all[9] = {}, done = 0.0, before_force[3] = {};
  int extensive[LENGTH];
  double **peratom = nullptr;
  bool known = false;

  void set_velocity(char **arg)
  {
    for (int k = 0; k < 3; k++) wall.velocity[k] = utils::numeric(FLERR, arg[k], false, lmp);
  }

 public:
  FixWallAsperity(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), laws(atom->ntypes + 1), masses(lmp), wall()
  {
    require_spheres(lmp, "fix wall/asperity");
    if (narg < 9) error->all(FLERR, USAGE);
    for (int k = 0; k < 3; k++) {
      wall.point[k] = utils::numeric(FLERR, arg[3 + k], false, lmp);
      wall.normal[k] = utils::numeric(FLERR, arg[6 + k], false, lmp);
    }
    const double size = sqrt(asperity_dot(wall.normal, wall.normal));
    if (!(size > 0.0)) error->all(FLERR, "fix wall/asperity: the normal is zero");
    for (int k = 0; k < 3; k++) wall.normal[k] /= size;
    read_words(narg, arg);
    set_flags();
    FixWallAsperity::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; i++) FixWallAsperity::set_arrays(i);
  }

  // What stands behind the normal.
  void read_words(int narg, char **arg)
  {
    std::shared_ptr<Law> last;
    for (int k = 9; k < narg;) {
      if (strcmp(arg[k], "type") == 0 && k + 3 < narg) {
        int lo, hi;
        utils::bounds(FLERR, arg[k + 1], 1, atom->ntypes, lo, hi, error);
        last = make_law(lmp, arg[k + 2], arg[k + 3]);
        if (!last->table.plane)
          error->all(FLERR, "fix wall/asperity: {} is the table of two spheres, and a wall needs that of a sphere on a plane",
                     arg[k + 2]);
        for (int type = lo; type <= hi; type++) laws[type] = last;
        k += 4;
      } else if (strcmp(arg[k], "velocity") == 0 && k + 3 < narg) {
        set_velocity(arg + k + 1);
        k += 4;
      } else if (const int taken = last ? law_word(lmp, *last, narg - k, arg + k) : 0) {
        k += taken;
      } else {
        error->all(FLERR, "fix wall/asperity: unknown word {}", arg[k]);
      }
    }
  }

  // What LAMMPS is to know of the fix.
  void set_flags()
  {
    restart_peratom = 1;
    restart_global = 1;
    create_attribute = 1;
    maxexchange = NUMBERS;
    vector_flag = 1;
    size_vector = LENGTH;
    global_freq = 1;
    // Sums are extensive, as those of LAMMPS' own walls: thermo output divides them by the number of atoms where it is told to
    // normalise (thermo_modify norm yes, the default of units lj). The wall's place is none.
    for (int k = 0; k < LENGTH; k++) extensive[k] = k < 3 || k >= 6;
    extvector = -1;
    extlist = extensive;
    peratom_flag = 1;
    size_peratom_cols = 6;
    peratom_freq = 1;
    energy_global_flag = 1;
    scalar_flag = 1;
    extscalar = 1;
    virial_global_flag = virial_peratom_flag = 1;
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
    masses.init();
    const int *type = atom->type, *mask = atom->mask;
    std::vector<int> mine(atom->ntypes + 1, 0), there(atom->ntypes + 1, 0);
    for (int i = 0; i < atom->nlocal; i++)
      if (mask[i] & groupbit) mine[type[i]] = 1;
    MPI_Allreduce(mine.data(), there.data(), atom->ntypes + 1, MPI_INT, MPI_MAX, world);
    for (int t = 1; t <= atom->ntypes; t++)
      if (there[t] && !laws[t])
        error->all(FLERR, "fix wall/asperity {}: there is no table for spheres of type {}: type {} TABLE E", id, t, t);
  }

  void setup(int vflag) override { post_force(vflag); }

  void post_force(int vflag) override
  {
    const bool advance = !update->setupflag;
    const double dt = advance ? update->dt : 0.0;
    double **x = atom->x, **f = atom->f, **torque = atom->torque;
    v_init(vflag);
    if (neighbor->ago == 0 && masses.any()) masses.look();
    for (int k = 0; k < 3; k++) wall.point[k] += wall.velocity[k] * dt;
    sum[0] = sum[1] = sum[2] = sum[6] = sum[7] = sum[8] = 0.0;
    for (int i = 0; i < atom->nlocal; i++) {
      for (int k = 0; k < size_peratom_cols; k++) peratom[i][k] = 0.0;
      if (!(atom->mask[i] & groupbit)) continue;
      double distance = 0.0;
      for (int k = 0; k < 3; k++) distance += (x[i][k] - wall.point[k]) * wall.normal[k];
      if (distance >= atom->radius[i] && !(contacts[i].state.h_max > 0.0)) continue;
      asperity_contact after;
      asperity_forces out;
      touch(i, dt, after, out);
      for (int k = 0; k < 3; k++) {
        f[i][k] += out.force_i[k];
        torque[i][k] += out.torque_i[k];
        sum[k] += out.force_j[k];
      }
      if (evflag) tally(i, distance, out.force_i);
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

  // The force of sphere i from its memory.
  void touch(int i, double dt, asperity_contact &after, asperity_forces &out)
  {
    const int type = atom->type[i];
    if (!laws[type])
      error->one(FLERR, "fix wall/asperity {}: sphere {} is of type {}, for which there is no table: type {} TABLE E", id,
                 atom->tag[i], type, type);
    asperity_body body;
    fill(body, atom, masses, i);
    asperity_sphere_wall(&laws[type]->law, &body, &wall, dt, &contacts[i], &after, &out);
    if (out.flags & ASPERITY_NO_NUMBER)
      error->one(FLERR, "fix wall/asperity {}: there is no force on sphere {}: its place, its velocity or the memory of the "
                        "contact is no number", id, atom->tag[i]);
  }

  void tally(int i, double distance, const double *force)
  {
    const double *n = wall.normal;
    double v[6] = {n[0] * force[0], n[1] * force[1], n[2] * force[2], n[0] * force[1], n[0] * force[2], n[1] * force[2]};
    for (double &stress : v) stress *= -distance;
    v_tally(1, &i, 1.0, v);
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

  // 1 to 3: force on the wall; 4 to 6: its place; 7, 8, 9: work dissipated by plastic flow, slip and damping; 10: elastic energy;
  // 11: contacts; 12: those out of range; 13: work that the wall has done
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
  // The wall's place, what its contacts have dissipated, and its laws; its velocity is that of the input.
  void write_restart(FILE *fp) override
  {
    double mine[4] = {sum[3], sum[4], sum[5], done}, total[4];
    MPI_Allreduce(mine, total, 4, MPI_DOUBLE, MPI_SUM, world);
    if (comm->me != 0) return;
    std::vector<double> buf;
    begin_layout(buf);
    buf.insert(buf.end(), wall.point, wall.point + 3);
    buf.insert(buf.end(), total, total + 4);
    for (int type = 1; type <= atom->ntypes; type++) {
      double packed[2];
      (laws[type] ? Identity(*laws[type]) : Identity()).pack(packed);
      buf.insert(buf.end(), packed, packed + 2);
    }
    write_buffer(fp, buf);
  }
  void restart(char *buf) override
  {
    const std::string who = std::string("fix wall/asperity ") + id;
    require_layout(lmp, buf, who.c_str());
    std::vector<double> kept(10 + 2 * atom->ntypes);
    memcpy(kept.data(), buf, kept.size() * sizeof(double));
    std::copy(kept.begin() + 3, kept.begin() + 6, wall.point);
    for (int type = 1; type <= atom->ntypes; type++) {
      Identity before;
      before.unpack(kept.data() + 8 + 2 * type);
      if (laws[type]) before.hold(lmp, *laws[type], "in " + who + " for type " + std::to_string(type));
    }
    if (comm->me != 0) return;
    std::copy(kept.begin() + 6, kept.begin() + 9, sum + 3);
    done = kept[9];
  }
};

}    // namespace LAMMPS_NS

#endif
