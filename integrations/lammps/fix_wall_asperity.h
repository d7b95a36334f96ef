// A rigid wall: a plane, a cylinder, a cone or the triangles of an STL file, moved or under a load. Under the GNU General Public
// License, version 2.
#ifndef FIX_WALL_ASPERITY_H
#define FIX_WALL_ASPERITY_H

#include "asperity_common.h"
#include "asperity_wall_input.h"

#include "domain.h"

namespace LAMMPS_NS {

class FixWallAsperity : public Fix {
  static constexpr int LENGTH = 20, SUMS = 12, COLUMNS = 10, HEAT = 6, LOST = 4;

  // A contact as its sphere holds it.
  struct Record {
    double normal[3];    // in the frame of the wall: by it the memory finds its contact again
    double stored;       // elastic energy
    asperity_contact contact;
    asperity_turning turning;    // its twist and roll; zero where they are left out
    asperity_cohesion cohesion;    // zero without it
  };
  static constexpr int RECORD = sizeof(Record) / sizeof(double);
  std::vector<std::shared_ptr<Law>> laws;
  Masses masses;
  std::unique_ptr<Shape> shape;
  Mesh *mesh = nullptr;
  Motion motion;
  std::vector<std::vector<Record>> kept;
  // Sums of this process: force on the wall, work dissipated by plastic flow, slip and damping, elastic energy, contacts, those
  // out of range, torque; and the work that the wall has done.
  double sum[SUMS] = {}, all[SUMS] = {}, done = 0.0, before[6] = {};
  double parted = 0.0;    // work that cohesion has dissipated
  double margin = 0.0, home[3] = {}, spanned[7] = {};
  double least_cosine = -1.0;    // of the old and the new normal of a contact
  int extensive[LENGTH];
  // From HEAT on: work dissipated in a sphere by plastic flow, slip, damping and cohesion at this wall.
  double **peratom = nullptr;
  // Of each type: over what gap cohesion may hold it, and the radius for which that is.
  std::vector<double> gaps, radii;
  bool known = false, turning = false;    // turning: whether contacts twist and roll
  // Of the sphere in hand: where it touches, which of its records that has, and its new ones.
  std::vector<Touch> found;
  std::vector<int> owner;
  std::vector<Record> after;

 public:
  FixWallAsperity(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), laws(atom->ntypes + 1), masses(lmp)
  {
    require_spheres(lmp, "fix wall/asperity");
    try {
      WallInput input(lmp, laws, motion);
      input.read(narg, arg);
      shape = std::move(input.shape);
      mesh = dynamic_cast<Mesh *>(shape.get());
      least_cosine = input.least_cosine;
      turning = input.turning;
      std::copy(motion.place, motion.place + 3, home);
    } catch (const std::runtime_error &problem) {
      error->all(FLERR, "fix wall/asperity {}: {}", id, problem.what());
    } catch (const std::bad_alloc &) {
      error->all(FLERR, "fix wall/asperity {}: there is no memory for its facets", id);
    }
    set_flags();
    FixWallAsperity::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; i++) FixWallAsperity::set_arrays(i);
  }

  // What LAMMPS is to know of the fix.
  void set_flags()
  {
    restart_peratom = 1;
    restart_global = 1;
    create_attribute = 1;
    maxexchange_dynamic = 1;
    maxexchange = 1 + LOST;
    vector_flag = 1;
    size_vector = LENGTH;
    global_freq = 1;
    // Sums are extensive, as those of LAMMPS' own walls: thermo output divides them by the number of atoms where it is told to
    // normalise (thermo_modify norm yes, the default of units lj). The wall's place and velocity are none.
    for (int k = 0; k < LENGTH; k++) extensive[k] = k < 3 || (k >= 6 && k < 16) || k == 19;
    extvector = -1;
    extlist = extensive;
    peratom_flag = 1;
    size_peratom_cols = COLUMNS;
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

  int setmask() override { return FixConst::POST_FORCE | FixConst::PRE_EXCHANGE; }

  void init() override
  {
    masses.init();
    pre_exchange();
    if (motion.loaded && !(motion.mass > 0.0))
      error->all(FLERR, "fix wall/asperity {}: a wall under a load needs a mass: load dx dy dz F mass M", id);
    const int *type = atom->type, *mask = atom->mask;
    std::vector<int> mine(atom->ntypes + 1, 0), there(atom->ntypes + 1, 0);
    for (int i = 0; i < atom->nlocal; i++)
      if (mask[i] & groupbit) mine[type[i]] = 1;
    MPI_Allreduce(mine.data(), there.data(), atom->ntypes + 1, MPI_INT, MPI_MAX, world);
    for (int t = 1; t <= atom->ntypes; t++)
      if (there[t] && !laws[t])
        error->all(FLERR, "fix wall/asperity {}: there is no table for spheres of type {}: type {} TABLE E", id, t, t);
    radii = greatest_radii(lmp);
    gaps.assign(atom->ntypes + 1, 0.0);
    for (int t = 1; t <= atom->ntypes; t++)
      if (laws[t] && laws[t]->coheres() && radii[t] > 0.0) gaps[t] = 1.05 * asperity_holding_gap(&laws[t]->law, radii[t], 0.0);
    if (!shape->is_plane()) fit_box();
  }

  // Every command that moves or writes atoms begins with this.
  void setup_pre_exchange() override { pre_exchange(); }
  void pre_exchange() override
  {
    size_t most = 0;
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, kept[i].size());
    maxexchange = 1 + LOST + RECORD * static_cast<int>(most);
  }

  // Whether the wall makes sense in a box that is periodic, and its images there.
  void fit_box()
  {
    const int *periodic = domain->periodicity;
    if (!(periodic[0] || periodic[1] || periodic[2])) return;
    if (domain->triclinic) error->all(FLERR, "fix wall/asperity {}: in a periodic box that is tilted walls are planes", id);
    for (int k = 0; k < 3; k++) {
      if (!periodic[k]) continue;
      double e[3] = {}, turned[3];
      e[k] = 1.0;
      std::copy(e, e + 3, turned);
      motion.back(turned);
      const double w = sqrt(asperity_dot(motion.spin, motion.spin));
      if (mesh && (!(turned[k] > 1.0 - 1e-12) || std::abs(motion.spin[k]) < (1.0 - 1e-12) * w))
        error->all(FLERR, "fix wall/asperity {}: facets cannot turn in a box that is periodic, but about its only periodic "
                          "direction", id);
      if (!shape->axis()) continue;
      std::copy(shape->axis(), shape->axis() + 3, turned);
      motion.back(turned);
      const double along = std::abs(turned[k]);
      if ((along > 1e-12 && along < 1.0 - 1e-12) || std::abs(asperity_dot(motion.spin, turned)) < (1.0 - 1e-12) * w)
        error->all(FLERR, "fix wall/asperity {}: in a periodic direction the axis of a cylinder lies along it or across, and "
                          "stays", id);
    }
    if (mesh) span_mesh();
  }

  void span_mesh()
  {
    if (domain->box_change_size || domain->box_change_shape)
      error->all(FLERR, "fix wall/asperity {}: facets need a box that keeps its size where it is periodic", id);
    const std::vector<double> radii = greatest_radii(lmp);
    double now[7];
    now[6] = margin = std::max(margin, 2.0 * *std::max_element(radii.begin(), radii.end()));
    for (int k = 0; k < 3; k++) {
      now[k] = domain->boxlo[k] - home[k];
      now[3 + k] = domain->periodicity[k] ? domain->prd[k] : 0.0;
    }
    if (std::equal(now, now + 7, spanned)) return;
    std::copy(now, now + 7, spanned);
    try {
      mesh->span(now, now + 3, margin);
    } catch (const std::runtime_error &problem) {
      error->all(FLERR, "fix wall/asperity {}: {}", id, problem.what());
    } catch (const std::bad_alloc &) {
      error->all(FLERR, "fix wall/asperity {}: there is no memory for the images of its facets", id);
    }
  }

  void setup(int vflag) override { post_force(vflag); }

  void post_force(int vflag) override
  {
    const bool advance = !update->setupflag;
    const double dt = advance ? update->dt : 0.0;
    v_init(vflag);
    if (neighbor->ago == 0 && masses.any()) masses.look();
    if (advance) {
      double force[3] = {};
      if (motion.loaded) {
        // From one process to all, so that the wall is at one place.
        MPI_Reduce(before, force, 3, MPI_DOUBLE, MPI_SUM, 0, world);
        MPI_Bcast(force, 3, MPI_DOUBLE, 0, world);
      }
      motion.advance(dt, force);
    }
    std::fill(sum, sum + 3, 0.0);
    std::fill(sum + 6, sum + SUMS, 0.0);
    for (int i = 0; i < atom->nlocal; i++) {
      for (int k = 0; k < HEAT; k++) peratom[i][k] = 0.0;
      if (atom->mask[i] & groupbit) sphere(i, dt, advance);
    }
    // What the wall has done on the spheres, by the mean of its forces before and after.
    if (advance)
      for (int k = 0; k < 3; k++)
        done -= 0.5 * ((before[k] + sum[k]) * motion.velocity[k] + (before[3 + k] + sum[9 + k]) * motion.spin[k]) * dt;
    std::copy(sum, sum + 3, before);
    std::copy(sum + 9, sum + 12, before + 3);
    known = false;
  }

  // Most spheres are far from most planes, which does not take long to see.
  bool is_far(int i, double radius) const
  {
    if (motion.turned()) return false;
    double place[3];
    for (int k = 0; k < 3; k++) place[k] = atom->x[i][k] - motion.place[k];
    return shape->is_far(place, radius);
  }

  // Where sphere i touches, into `found` (in the frame of the box); `place` is its centre less the wall's place.
  void look(int i, double place[3], double reach)
  {
    for (int k = 0; k < 3; k++) place[k] = atom->x[i][k] - motion.place[k];
    found.clear();
    const bool turned = motion.turned();
    try {
      if (!mesh && !shape->is_plane()) wrap(place);
      double c[3] = {place[0], place[1], place[2]};
      if (turned) motion.into(place, c);
      shape->touches(c, atom->radius[i], reach, found);
    } catch (const std::runtime_error &problem) {
      error->one(FLERR, "fix wall/asperity {}: sphere {} {}", id, atom->tag[i], problem.what());
    }
  }

  // The image nearest to the wall.
  void wrap(double place[3])
  {
    double middle[3], axis[3] = {};
    shape->middle(middle);
    motion.back(middle);
    if (shape->axis()) {
      std::copy(shape->axis(), shape->axis() + 3, axis);
      motion.back(axis);
    }
    for (int k = 0; k < 3; k++)
      if (domain->periodicity[k] && std::abs(axis[k]) < 0.5)
        place[k] -= domain->prd[k] * floor((place[k] - middle[k]) / domain->prd[k] + 0.5);
  }

  // Gives each contact the memory whose normal is nearest to its own: owner[contact] is that of the record, or -1.
  void match(const std::vector<Record> &records)
  {
    owner.assign(found.size(), -1);
    for (size_t turn = 0; turn < records.size(); turn++) {
      int best_touch = -1, best_record = -1;
      double best = least_cosine;
      for (size_t r = 0; r < records.size(); r++) {
        if (std::find(owner.begin(), owner.end(), static_cast<int>(r)) != owner.end()) continue;
        for (size_t t = 0; t < found.size(); t++) {
          const double cosine = asperity_dot(found[t].normal, records[r].normal);
          if (owner[t] >= 0 || cosine < best) continue;
          best = cosine;
          best_touch = static_cast<int>(t);
          best_record = static_cast<int>(r);
        }
      }
      if (best_touch < 0) return;
      owner[best_touch] = best_record;
    }
  }

  // Over what distance sphere i is attracted before it touches, and over what gap it may be held,
  // which grows by less than the radius.
  double range(int i) const
  {
    const auto &law = laws[atom->type[i]];
    return law ? law->range : 0.0;
  }
  double gap(int i) const
  {
    const int type = atom->type[i];
    const double known = radii[type] > 0.0 ? radii[type] : atom->radius[i];
    if (!(gaps[type] > 0.0)) return range(i);
    return gaps[type] * std::max(1.0, atom->radius[i] / known);
  }

  void sphere(int i, double dt, bool advance)
  {
    std::vector<Record> &mine = kept[i];
    const double radius = atom->radius[i], meets = radius + range(i);
    if (mine.empty() && is_far(i, meets)) return;
    double deepest = 0.0, place[3];
    for (const Record &record : mine) deepest = std::max(deepest, record.contact.state.h_max);
    const double reach = std::max(radius * (1.0 + deepest), radius + gap(i));
    if (mesh && margin > 0.0 && reach > margin)
      error->one(FLERR, "fix wall/asperity {}: sphere {} has the radius {}, and none as large was known when the run began", id,
                 atom->tag[i], radius);
    look(i, place, reach);
    if (found.empty() && mine.empty()) return;
    match(mine);
    after.clear();
    for (size_t t = 0; t < found.size(); t++) {
      Record record = {};
      if (owner[t] >= 0) record = mine[owner[t]];
      else if (found[t].distance >= meets) continue;
      // Memory goes by the direction in the frame of the wall, forces by that of the box.
      std::copy(found[t].normal, found[t].normal + 3, record.normal);
      contact(i, place, found[t], dt, advance, record);
      if (!asperity_may_forget_cohesive(&record.contact, &record.cohesion)) after.push_back(record);
    }
    if (!advance) return;
    for (size_t r = 0; r < mine.size(); r++)
      if (std::find(owner.begin(), owner.end(), static_cast<int>(r)) == owner.end()) lose(i, mine[r]);
    mine = after;
  }

  // A contact that is none any more, as the sphere has gone off its edge or on to the next facet: what it had stored is lost.
  void lose(int i, const Record &record)
  {
    for (const Record &other : after)
      if (record.contact.state.h > 0.0 && asperity_dot(record.normal, other.normal) < -0.9)
        error->one(FLERR, "fix wall/asperity {}: sphere {} has gone through the wall", id, atom->tag[i]);
    if (record.cohesion.joined > 0.0) {
      peratom[i][HEAT + 3] += record.stored;
      parted += record.stored;
      return;
    }
    peratom[i][HEAT + 2] += record.stored;
    sum[5] += record.stored;
  }

  // The forces of one contact, and what they add to the sums.
  void contact(int i, const double place[3], Touch touch, double dt, bool advance, Record &record)
  {
    const int type = atom->type[i];
    if (!laws[type])
      error->one(FLERR, "fix wall/asperity {}: sphere {} is of type {}, for which there is no table: type {} TABLE E", id,
                 atom->tag[i], type, type);
    if (motion.turned()) {
      motion.back(touch.from);
      motion.back(touch.normal);
    }
    // The tangent plane, with the origin in that of its points from which `from` leads to the centre.
    asperity_body body;
    asperity_wall wall = {};
    asperity_contact after;
    asperity_forces out;
    double lever[3], turning[3], torque[3];
    fill(body, atom, masses, i);
    for (int k = 0; k < 3; k++) {
      body.position[k] = touch.from[k];
      wall.normal[k] = touch.normal[k];
      wall.spin[k] = motion.spin[k];
      lever[k] = place[k] - touch.from[k];
    }
    asperity_cross(motion.spin, lever, turning);
    for (int k = 0; k < 3; k++) wall.velocity[k] = motion.velocity[k] + turning[k];
    asperity_turning turned = record.turning;
    asperity_turning *memory = this->turning ? &turned : nullptr;
    // After a restart without cohesion nothing of it is left.
    asperity_cohesion joined = laws[type]->coheres() ? record.cohesion : asperity_cohesion{};
    const asperity_law3d *law = &laws[type]->law;
    if (laws[type]->coheres())
      asperity_sphere_wall_cohesive(law, &body, &wall, dt, &record.contact, &after, memory, memory, &joined, &joined, &out);
    else
      asperity_sphere_wall_turning(law, &body, &wall, dt, &record.contact, &after, memory, memory, &out);
    if (out.flags & ASPERITY_NO_NUMBER)
      error->one(FLERR, "fix wall/asperity {}: there is no force on sphere {}: its place, its velocity or the memory of the "
                        "contact is no number", id, atom->tag[i]);
    const double arm = std::min(touch.distance, body.radius);
    for (int k = 0; k < 3; k++) lever[k] = place[k] - arm * touch.normal[k];
    asperity_cross(lever, out.force_j, torque);
    for (int k = 0; k < 3; k++) {
      atom->f[i][k] += out.force_i[k];
      atom->torque[i][k] += out.torque_i[k];
      sum[k] += out.force_j[k];
      sum[9 + k] += torque[k] + out.torque_j[k];
    }
    if (evflag) tally(i, touch, out.force_i);
    add_up(i, record, after, out, advance);
    record.contact = after;
    record.turning = turned;
    record.cohesion = joined;
    record.stored = out.stored;
  }

  void add_up(int i, const Record &record, const asperity_contact &after, const asperity_forces &out, bool advance)
  {
    const double outside = (out.flags & ASPERITY_OUT_OF_RANGE) ? 1.0 : 0.0;
    sum[6] += out.stored;
    sum[7] += (out.flags & ASPERITY_TOUCHES) ? 1.0 : 0.0;
    sum[8] += outside;
    if (advance) {
      const asperity_contact &was = record.contact;
      const double lost[LOST] = {after.plastic - was.plastic, after.slip - was.slip, out.damped, out.parted};
      for (int k = 0; k < LOST; k++) peratom[i][HEAT + k] += lost[k];
      for (int k = 0; k < 3; k++) sum[3 + k] += lost[k];
      parted += lost[3];
    }
    double *row = peratom[i];
    row[0] += out.f_n;
    row[1] += out.f_t;
    row[2] = row[2] == 0.0 ? out.overlap : std::max(row[2], out.overlap);
    row[3] += after.plastic;
    row[4] += after.slip;
    row[5] = std::max(row[5], outside);
  }

  void tally(int i, const Touch &touch, const double *force)
  {
    const double *n = touch.normal;
    double v[6] = {n[0] * force[0], n[1] * force[1], n[2] * force[2], n[0] * force[1], n[0] * force[2], n[1] * force[2]};
    for (double &stress : v) stress *= -touch.distance;
    v_tally(1, &i, 1.0, v);
  }

  // Elastic energy of its contacts.
  double compute_scalar() override { return value(6); }

  double value(int k)
  {
    if (!known) {
      MPI_Allreduce(sum, all, SUMS, MPI_DOUBLE, MPI_SUM, world);
      known = true;
    }
    return all[k];
  }

  // 1 to 3: force on the wall; 4 to 6: its place; 7, 8, 9: work dissipated by plastic flow, slip and damping; 10: elastic energy;
  // 11: contacts; 12: those out of range; 13: work that the wall has done; 14 to 16: torque on the wall about its place; 17 to
  // 19: its velocity; 20: work dissipated by cohesion
  double compute_vector(int k) override
  {
    if (k < 3) return value(k);
    if (k < 6) return motion.place[k - 3];
    if (k < 12) return value(k - 3);
    if (k >= 16 && k < 19) return motion.velocity[k - 16];
    if (k >= 13 && k < 16) return value(k - 4);
    double total;
    MPI_Allreduce(k == 19 ? &parted : &done, &total, 1, MPI_DOUBLE, MPI_SUM, world);
    return total;
  }

  // fix_modify ID velocity vx vy vz, spin wx wy wz, load dx dy dz F, unloaded, mass M, damping C
  int modify_param(int narg, char **arg) override
  {
    try {
      return WallInput(lmp, laws, motion).read_motion(narg, arg);
    } catch (const std::runtime_error &problem) {
      error->all(FLERR, "fix wall/asperity {}: {}", id, problem.what());
    }
    return 0;
  }

  void grow_arrays(int nmax) override
  {
    if (kept.size() < static_cast<size_t>(nmax)) kept.resize(nmax);
    memory->grow(peratom, nmax, size_peratom_cols, "wall/asperity:peratom");
    array_atom = peratom;
  }
  void copy_arrays(int i, int j, int) override
  {
    kept[j] = kept[i];
    for (int k = 0; k < size_peratom_cols; k++) peratom[j][k] = peratom[i][k];
  }
  void set_arrays(int i) override
  {
    kept[i].clear();
    for (int k = 0; k < size_peratom_cols; k++) peratom[i][k] = 0.0;
  }
  int pack_exchange(int i, double *buf) override
  {
    const auto &records = kept[i];
    buf[0] = static_cast<double>(records.size());
    std::copy(peratom[i] + HEAT, peratom[i] + HEAT + LOST, buf + 1);
    if (!records.empty()) memcpy(buf + 1 + LOST, records.data(), records.size() * sizeof(Record));
    return 1 + LOST + RECORD * static_cast<int>(records.size());
  }
  int unpack_exchange(int i, double *buf) override
  {
    set_arrays(i);
    const auto count = static_cast<size_t>(buf[0]);
    std::copy(buf + 1, buf + 1 + LOST, peratom[i] + HEAT);
    kept[i].resize(count);
    if (count > 0) memcpy(kept[i].data(), buf + 1 + LOST, count * sizeof(Record));
    return 1 + LOST + RECORD * static_cast<int>(count);
  }
  int size_restart(int i) override { return 2 + LOST + RECORD * static_cast<int>(kept[i].size()); }
  int maxsize_restart() override
  {
    int most = 2 + LOST, all_most;
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, size_restart(i));
    MPI_Allreduce(&most, &all_most, 1, MPI_INT, MPI_MAX, world);
    return all_most;
  }
  int pack_restart(int i, double *buf) override
  {
    const int m = 1 + pack_exchange(i, buf + 1);
    buf[0] = m;
    return m;
  }
  void unpack_restart(int i, int nth) override
  {
    double *extra = atom->extra[i];
    int m = 0;
    for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
    if (unpack_exchange(i, extra + m + 1) != static_cast<int>(extra[m]) - 1)
      error->one(FLERR, "fix wall/asperity {}: the contacts of sphere {} in the restart file are damaged", id, atom->tag[i]);
  }

  // The wall's place, what its contacts have dissipated, its turn, velocity and shape, and its laws.
  void write_restart(FILE *fp) override
  {
    double mine[5] = {sum[3], sum[4], sum[5], done, parted}, total[5], hash;
    MPI_Allreduce(mine, total, 5, MPI_DOUBLE, MPI_SUM, world);
    if (comm->me != 0) return;
    std::vector<double> buf;
    begin_layout(buf, turning);
    buf.insert(buf.end(), motion.place, motion.place + 3);
    buf.insert(buf.end(), total, total + 5);
    buf.insert(buf.end(), motion.turn, motion.turn + 4);
    buf.insert(buf.end(), motion.velocity, motion.velocity + 3);
    const uint64_t fingerprint = shape->fingerprint();
    memcpy(&hash, &fingerprint, sizeof hash);
    buf.push_back(hash);
    for (int type = 1; type <= atom->ntypes; type++) {
      double packed[Identity::SIZE];
      (laws[type] ? Identity(*laws[type]) : Identity()).pack(packed);
      buf.insert(buf.end(), packed, packed + Identity::SIZE);
    }
    write_buffer(fp, buf);
  }
  // A wall under a load goes on with its velocity; that of another is the input's.
  void restart(char *buf) override
  {
    constexpr int LAWS = 19;
    const std::string who = std::string("fix wall/asperity ") + id;
    require_layout(lmp, buf, who.c_str(), turning);
    std::vector<double> file(LAWS + Identity::SIZE * atom->ntypes);
    memcpy(file.data(), buf, file.size() * sizeof(double));
    bool changed = false;
    for (int type = 1; type <= atom->ntypes; type++) {
      Identity earlier;
      earlier.unpack(file.data() + LAWS + Identity::SIZE * (type - 1));
      if (!laws[type]) continue;
      earlier.hold(lmp, *laws[type], "in " + who + " for type " + std::to_string(type));
      changed = changed || laws[type]->changed;
    }
    const uint64_t fingerprint = shape->fingerprint();
    if (memcmp(&fingerprint, &file[18], sizeof fingerprint) != 0 && !changed)
      error->all(FLERR, "{}: the wall has another shape than when the restart file was written. Give that one, or say `changed`",
                 who);
    std::copy(file.begin() + 3, file.begin() + 6, motion.place);
    std::copy(file.begin() + 11, file.begin() + 15, motion.turn);
    if (motion.loaded) std::copy(file.begin() + 15, file.begin() + 18, motion.velocity);
    if (comm->me != 0) return;
    std::copy(file.begin() + 6, file.begin() + 9, sum + 3);
    done = file[9];
    parted = file[10];
  }
};

}    // namespace LAMMPS_NS

#endif
