// pair_style asperity: two spheres. Under the GNU General Public License, version 2.
#ifndef PAIR_ASPERITY_H
#define PAIR_ASPERITY_H

#include "fix_asperity_history.h"

namespace LAMMPS_NS {

class PairAsperity : public Pair {
  static constexpr const char *HISTORY = "ASPERITY_HISTORY";
  static constexpr const char *COEFF =
      "pair_coeff I J TABLE E [restitution e] [tangential f] [cohesion W [range Z]] [plane-for-pair] [changed]";
  std::vector<std::vector<std::shared_ptr<Law>>> laws;
  FixAsperityHistory *history = nullptr;
  Masses masses;
  bool turning = false;           // whether contacts twist and roll
  bool cohesive = false, ranged = false;    // whether some have cohesion, and such as reaches over a gap
  double largest = 0.0;           // greatest radius that the user promises
  std::vector<double> radii;      // greatest radius of each type that the cutoffs are made for

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

  // The forces of i and j from a memory; particles in the order of their IDs, so that no exchange ever turns the memory round.
  // Whether i is the first of the two.
  bool forces(int i, int j, double dt, const asperity_contact &before, asperity_contact &after, asperity_turning &turned,
              asperity_cohesion &joined, asperity_forces &out)
  {
    asperity_body a, b;
    const bool first = atom->tag[i] < atom->tag[j];
    fill(a, atom, masses, first ? i : j);
    fill(b, atom, masses, first ? j : i);
    asperity_turning *memory = turning ? &turned : nullptr;
    const Law &law = *laws[atom->type[i]][atom->type[j]];
    if (law.coheres())
      asperity_spheres_cohesive(&law.law, &a, &b, dt, &before, &after, memory, memory, &joined, &joined, &out);
    else
      asperity_spheres_turning(&law.law, &a, &b, dt, &before, &after, memory, memory, &out);
    if (out.flags & ASPERITY_NO_NUMBER)
      error->one(FLERR, "pair_style asperity: there is no force between spheres {} and {}: their centres coincide, or a place, "
                        "a velocity or the memory of the contact is no number", atom->tag[i], atom->tag[j]);
    return first;
  }

  // A sphere that is larger than any that was known when the cutoffs were made would have contacts which nobody looks for.
  void require_known(int i)
  {
    if (atom->radius[i] > radii[atom->type[i]] * (1.0 + 1e-9))
      error->one(FLERR, "pair_style asperity: sphere {} of type {} has the radius {}, and the greatest one known when the run "
                        "began was {}. Say so first: pair_style asperity largest R",
                 atom->tag[i], atom->type[i], atom->radius[i], radii[atom->type[i]]);
  }

  // What one contact adds to forces, memory and sums.
  void contact(int i, int j, Record *record, double dt, bool advance, double &outside)
  {
    double **x = atom->x, **f = atom->f, **torque = atom->torque;
    const tagint *tag = atom->tag;
    const int nlocal = atom->nlocal;
    asperity_contact after, before = {};
    asperity_turning turned = {};
    asperity_cohesion joined = {};
    asperity_forces out;
    if (record) before = record->contact;
    if (record && turning && !record->turning.empty()) turned = record->turning[0];
    if (record && !record->cohesion.empty()) joined = record->cohesion[0];
    const bool first = forces(i, j, dt, before, after, turned, joined, out);
    const double *fi = first ? out.force_i : out.force_j, *ti = first ? out.torque_i : out.torque_j;
    const double *tj = first ? out.torque_j : out.torque_i;
    for (int k = 0; k < 3; k++) {
      f[i][k] += fi[k];
      torque[i][k] += ti[k];
      if (j < nlocal) {
        f[j][k] -= fi[k];
        torque[j][k] += tj[k];
      }
    }
    if (out.flags & ASPERITY_OUT_OF_RANGE) outside += j < nlocal ? 1.0 : 0.5;
    if (advance) {
      const double lost[4] = {after.plastic - before.plastic, after.slip - before.slip, out.damped, out.parted};
      const asperity_cohesion *held = laws[atom->type[i]][atom->type[j]]->coheres() ? &joined : nullptr;
      history->add_heat(i, j, lost);
      if (asperity_may_forget_cohesive(&after, &joined)) {
        history->drop(i, tag[j]);
        if (j < nlocal) history->drop(j, tag[i]);
      } else {
        history->put(i, tag[j], after, turning ? &turned : nullptr, held);
        if (j < nlocal) history->put(j, tag[i], after, turning ? &turned : nullptr, held);
      }
    } else if (record && j < nlocal) {
      if (Record *other = history->find(j, tag[i])) other->seen = true;
    }
    if (evflag)
      ev_tally_xyz(i, j, nlocal, 0, out.stored, 0.0, fi[0], fi[1], fi[2],
                   x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]);
  }

 public:
  PairAsperity(LAMMPS *lmp) : Pair(lmp), masses(lmp)
  {
    single_enable = 1;
    single_extra = 11;
    svector = new double[single_extra];
    restartinfo = 0;
    no_virial_fdotr_compute = 1;    // ghosts get no force here
    finitecutflag = 1;
    centroidstressflag = CENTROID_NOTAVAIL;
    comm_forward = 1;
    nextra = 5;
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

  void settings(int narg, char **arg) override
  {
    bool turns = false;
    for (int k = 0; k < narg; k += 2) {
      if (k + 1 < narg && strcmp(arg[k], "largest") == 0) {
        largest = utils::numeric(FLERR, arg[k + 1], false, lmp);
        if (!(largest > 0.0)) error->all(FLERR, "pair_style asperity: the largest radius {} is not positive", arg[k + 1]);
      } else if (k + 1 < narg && strcmp(arg[k], "turning") == 0) {
        turns = yes_or_no(lmp, "pair_style asperity turning", arg[k + 1]);
      } else {
        error->all(FLERR, "pair_style asperity [largest R] [turning yes|no]; {}", COEFF);
      }
    }
    if (history && turns != turning)
      error->all(FLERR, "pair_style asperity: turning stays as it was said first: contacts have their memory by it");
    turning = turns;
    require_spheres(lmp, "pair_style asperity");
    if (!history) {
      // Made at once, so that what a restart file has of it is taken up.
      modify->add_fix(std::string(HISTORY) + " all asperity/history" + (turning ? " turning" : ""));
      history = dynamic_cast<FixAsperityHistory *>(modify->get_fix_by_id(HISTORY));
    }
  }

  void coeff(int narg, char **arg) override
  {
    if (narg < 4) error->all(FLERR, COEFF);
    if (!allocated) allocate();
    int ilo, ihi, jlo, jhi;
    utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
    utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);
    auto law = make_law(lmp, arg[2], arg[3]);
    bool stands_in = false;
    for (int k = 4; k < narg;) {
      if (strcmp(arg[k], "plane-for-pair") == 0) {
        stands_in = true;
        k++;
      } else if (const int taken = law_word(lmp, *law, narg - k, arg + k)) {
        k += taken;
      } else {
        error->all(FLERR, "pair_coeff of asperity: unknown word {}", arg[k]);
      }
    }
    if (law->table.plane && !stands_in)
      error->all(FLERR,
                 "asperity: {} is the table of a sphere on a plane, and types {} and {} need that of two spheres. Make one, or "
                 "say plane-for-pair to let it stand in",
                 arg[2], arg[0], arg[1]);
    if (!law->table.plane && stands_in)
      error->all(FLERR, "asperity: {} is the table of a pair; leave plane-for-pair out", arg[2]);
    if (stands_in) {
      if (comm->me == 0)
        error->warning(FLERR,
                       "asperity: {} of a sphere on a plane stands in for spheres of types {} and {}: F_N some 3 % low, F_T the "
                       "same, elastic shear softer",
                       arg[2], arg[0], arg[1]);
      asperity_stand_in(&law->table);
    }
    set_cohesion(lmp, *law);
    for (int i = ilo; i <= ihi; i++)
      for (int j = jlo; j <= jhi; j++) {
        laws[i][j] = laws[j][i] = law;
        setflag[std::min(i, j)][std::max(i, j)] = 1;
      }
  }

  void init_style() override
  {
    require_spheres(lmp, "pair_style asperity");
    // LAMMPS' own models of twisting and rolling would count what the law has a second time.
    if (turning && force->pair_match("^gran", 0))
      error->all(FLERR, "pair_style asperity turning yes: beside a granular pair style twist and roll would count twice");
    if (!comm->ghost_velocity) error->all(FLERR, "pair_style asperity needs: comm_modify vel yes");
    cohesive = ranged = false;
    for (int i = 1; i <= atom->ntypes; i++)
      for (int j = i; j <= atom->ntypes; j++) {
        if (!setflag[i][j]) continue;
        cohesive = cohesive || laws[i][j]->coheres();
        ranged = ranged || laws[i][j]->range > 0.0;
      }
    // Both owners of a pair across a boundary compute it, from their own copies of the memory, whatever `newton` is.
    // Lists by size end at the sum of the radii; surfaces that hold each other may be further apart, and
    // the cutoffs of init_one() count.
    neighbor->add_request(this, cohesive ? NeighConst::REQ_NEWTON_OFF : NeighConst::REQ_SIZE | NeighConst::REQ_NEWTON_OFF);
    masses.init();
    radii = greatest_radii(lmp);
    for (double &radius : radii) radius = std::max(radius, largest);
    history->laws.clear();
    for (int i = 1; i <= atom->ntypes; i++)
      for (int j = i; j <= atom->ntypes; j++) {
        if (!setflag[i][j]) continue;
        history->laws[{i, j}] = Identity(*laws[i][j]);
        const auto before = history->restarted.find({i, j});
        if (before != history->restarted.end())
          before->second.hold(lmp, *laws[i][j], "for spheres of types " + std::to_string(i) + " and " + std::to_string(j));
      }
  }

  double init_one(int i, int j) override
  {
    if (!setflag[std::min(i, j)][std::max(i, j)])
      error->all(FLERR, "asperity: there is no table for spheres of types {} and {}: pair_coeff {} {} TABLE E", i, j, i, j);
    const Law &law = *laws[i][j];
    const bool holds = law.coheres() && radii[i] > 0.0 && radii[j] > 0.0;
    return radii[i] + radii[j] + (holds ? 1.05 * asperity_holding_gap(&law.law, radii[i], radii[j]) : 0.0);
  }

  int pack_forward_comm(int n, int *list, double *buf, int, int *) override
  {
    for (int k = 0; k < n; k++) buf[k] = masses.instead[list[k]];
    return n;
  }
  void unpack_forward_comm(int n, int first, double *buf) override { std::copy(buf, buf + n, masses.instead.begin() + first); }

  void compute(int eflag, int vflag) override
  {
    ev_init(eflag, vflag);
    const bool advance = !update->setupflag, rebuilt = neighbor->ago == 0;
    const double dt = advance ? update->dt : 0.0;
    double **x = atom->x;
    const double *radius = atom->radius;
    const int nlocal = atom->nlocal;
    double outside = 0.0;
    if (rebuilt && masses.any()) {
      masses.look();
      comm->forward_comm(this);
    }
    for (int i = 0; i < nlocal; i++) {
      require_known(i);
      history->know(i);
      if (rebuilt)
        for (auto &record : history->rows[i]) record.seen = false;
    }
    for (int ii = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      const int *neighbours = list->firstneigh[i];
      const bool has = !history->rows[i].empty();
      for (int jj = 0; jj < list->numneigh[i]; jj++) {
        const int j = neighbours[jj] & NEIGHMASK;
        const double dx = x[i][0] - x[j][0], dy = x[i][1] - x[j][1], dz = x[i][2] - x[j][2];
        double sum = radius[i] + radius[j];
        if (ranged) sum += laws[atom->type[i]][atom->type[j]]->range;
        const bool apart = dx * dx + dy * dy + dz * dz >= sum * sum;
        if (apart && !has && history->rows[i].empty()) continue;
        Record *record = history->find(i, atom->tag[j]);
        if (record) record->seen = true;
        if (apart && !record) continue;
        contact(i, j, record, dt, advance, outside);
      }
    }
    // What left the neighbour list is gone for good.
    if (rebuilt)
      for (int i = 0; i < nlocal; i++) history->drop_unseen(i);
    for (int k = 0; k < 3; k++) pvector[k] = history->total[k];
    pvector[3] = outside;
    pvector[4] = history->total[3];
  }

  // compute pair/local: p1 F_N, p2 F_T, p3 overlap, p4 elastic energy, p5 and p6 work dissipated by plastic flow and by slip,
  // p7 out of range, p8 to p10 force on the first, p11 whether cohesion holds it.
  double single(int i, int j, int, int, double rsq, double, double, double &fforce) override
  {
    for (int k = 0; k < single_extra; k++) svector[k] = 0.0;
    fforce = 0.0;
    const double sum = atom->radius[i] + atom->radius[j] + laws[atom->type[i]][atom->type[j]]->range;
    Record *record = i < atom->nlocal ? history->find(i, atom->tag[j]) : history->find(j, atom->tag[i]);
    if (!record && rsq >= sum * sum) return 0.0;
    asperity_contact after, before = {};
    asperity_turning turned = {};
    asperity_cohesion joined = {};
    asperity_forces out;
    if (record) before = record->contact;
    if (record && turning && !record->turning.empty()) turned = record->turning[0];
    if (record && !record->cohesion.empty()) joined = record->cohesion[0];
    const bool first = forces(i, j, 0.0, before, after, turned, joined, out);
    svector[0] = out.f_n;
    svector[1] = out.f_t;
    svector[2] = out.overlap;
    svector[3] = out.stored;
    svector[4] = after.plastic;
    svector[5] = after.slip;
    svector[6] = (out.flags & ASPERITY_OUT_OF_RANGE) ? 1.0 : 0.0;
    for (int k = 0; k < 3; k++) svector[7 + k] = first ? out.force_i[k] : out.force_j[k];
    svector[10] = (out.flags & ASPERITY_HOLDS) ? 1.0 : 0.0;
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

}    // namespace LAMMPS_NS

#endif
