// pair_style asperity: two spheres. Under the GNU General Public License, version 2.
#ifndef PAIR_ASPERITY_H
#define PAIR_ASPERITY_H

#include "fix_asperity_history.h"

namespace LAMMPS_NS {

class PairAsperity : public Pair {
  static constexpr const char *HISTORY = "ASPERITY_HISTORY";
  static constexpr const char *COEFF =
      "pair_coeff I J TABLE E [restitution e] [tangential f] [cohesion W [range Z]] [plane-for-pair] [changed]";
  static constexpr int BATCH = ASPERITY_BLOCKS * ASPERITY_TOGETHER;    // contacts that go through the law together

  // A contact of the batch: its spheres, its entry in the list, and what it had dissipated.
  struct Entry {
    int i, j, entry, slot;
    bool first, begins;    // whether i is the first of the two, and whether a memory begins
    const Law *law;
    double plastic, slip;
  };

  std::vector<std::vector<std::shared_ptr<Law>>> laws;
  FixAsperityHistory *history = nullptr;
  Masses masses;
  bool turning = false;           // whether contacts twist and roll
  bool cohesive = false, ranged = false;    // whether some have cohesion, and such as reaches over a gap
  double largest = 0.0;           // greatest radius that the user promises
  std::vector<double> radii;      // greatest radius of each type that the cutoffs are made for
  std::vector<asperity_body> bodies;    // owned and ghosts
  Entry batch[BATCH];
  int filled = 0, place[BATCH];         // place: of a contact of the batch among the pairs, which stand law by law
  asperity_pair pairs[BATCH];
  asperity_contact fresh[BATCH];        // memories of contacts that begin, and those that a set-up does not keep
  asperity_turning fresh_turning[BATCH];
  asperity_cohesion fresh_cohesion[BATCH];

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

  [[noreturn]] void no_answer(int i, int j)
  {
    error->one(FLERR, "pair_style asperity: there is no force between spheres {} and {}: their centres coincide, or a place, "
                      "a velocity or the memory of the contact is no number", atom->tag[i], atom->tag[j]);
  }

  // A sphere that is larger than any that was known when the cutoffs were made would have contacts which nobody looks for.
  void require_known(int i)
  {
    if (atom->radius[i] > radii[atom->type[i]] * (1.0 + 1e-9))
      error->one(FLERR, "pair_style asperity: sphere {} of type {} has the radius {}, and the greatest one known when the run "
                        "began was {}. Say so first: pair_style asperity largest R",
                 atom->tag[i], atom->type[i], atom->radius[i], radii[atom->type[i]]);
  }

  // Whether two spheres touch, or attract each other over a gap.
  bool near(const asperity_body &one, const asperity_body &other, int i, int j) const
  {
    const double *p = one.position, *q = other.position;
    const double dx = p[0] - q[0], dy = p[1] - q[1], dz = p[2] - q[2];
    double sum = one.radius + other.radius;
    if (ranged) sum += laws[atom->type[i]][atom->type[j]]->range;
    return dx * dx + dy * dy + dz * dz < sum * sum;
  }

  // A contact comes to the batch; spheres in the order of their IDs, so that no exchange ever turns
  // the memory round.
  void gather(int i, int j, int entry)
  {
    const int *type = atom->type, slot = history->slots[entry];
    if (slot >= 0) history->memories.fetch(slot + BATCH);
    batch[filled++] = {i, j, entry, slot, atom->tag[i] < atom->tag[j], false, laws[type[i]][type[j]].get(), 0.0, 0.0};
  }

  // The pairs of the batch that have the same law as one of them, from `start` on; where they end.
  int line_up(int one, int start)
  {
    const Law *law = batch[one].law;
    for (int k = one; k < filled; k++)
      if (batch[k].law == law) place[k] = start++;
    return start;
  }

  // Where the law finds and leaves the memory: in its slot, and if it is not to be kept, or not yet, here.
  void prepare(int k, bool advance)
  {
    Entry &one = batch[k];
    asperity_pair &pair = pairs[place[k]];
    Memories &memories = history->memories;
    const int slot = one.slot;
    const bool in_place = slot >= 0 && advance;
    pair.i = &bodies[one.first ? one.i : one.j];
    pair.j = &bodies[one.first ? one.j : one.i];
    if (slot < 0) fresh[k] = {};
    pair.before = slot < 0 ? &fresh[k] : &memories.contact[slot];
    pair.after = in_place ? &memories.contact[slot] : &fresh[k];
    pair.turning = nullptr;
    pair.cohesion = nullptr;
    if (turning) {
      if (!in_place) fresh_turning[k] = slot < 0 ? asperity_turning{} : memories.turning[slot];
      pair.turning = in_place ? &memories.turning[slot] : &fresh_turning[k];
    }
    if (one.law->coheres()) {
      if (!in_place) fresh_cohesion[k] = slot < 0 ? asperity_cohesion{} : memories.cohesion[slot];
      pair.cohesion = in_place ? &memories.cohesion[slot] : &fresh_cohesion[k];
    }
    if (in_place && memories.holds) memories.coheres[slot] = one.law->coheres();
    one.plastic = pair.before->plastic;
    one.slip = pair.before->slip;
  }

  // The contacts of the batch: memories, and forces and sums in the order of the list, whatever laws they have.
  void settle(double dt, bool advance, double &outside)
  {
    std::fill(place, place + filled, -1);
    for (int k = 0, end = 0; k < filled; k++)
      if (place[k] < 0) end = line_up(k, end);
    for (int k = 0; k < filled; k++) prepare(k, advance);
    for (int k = 0, end = 0; k < filled; k++) {
      if (place[k] != end) continue;    // not the first of its law
      const Law *law = batch[k].law;
      int count = 0;
      for (int other = k; other < filled; other++) count += batch[other].law == law;
      asperity_spheres_many(&law->law, dt, count, pairs + end);
      end += count;
    }
    for (int k = 0; k < filled; k++) {
      const asperity_pair &pair = pairs[place[k]];
      if (pair.out.flags & ASPERITY_NO_NUMBER) no_answer(batch[k].i, batch[k].j);
      add_up(batch[k], pair.out, outside);
      if (advance) keep(batch[k], pair);
    }
    // Only now, as memories move when there are more of them.
    for (int k = 0; advance && k < filled; k++)
      if (batch[k].begins) begin(batch[k], pairs[place[k]]);
    filled = 0;
  }

  // What a contact adds to the forces.
  void add_up(const Entry &one, const asperity_forces &out, double &outside)
  {
    double **x = atom->x, **f = atom->f, **torque = atom->torque;
    const int i = one.i, j = one.j, nlocal = atom->nlocal;
    const double *fi = one.first ? out.force_i : out.force_j, *ti = one.first ? out.torque_i : out.torque_j;
    const double *tj = one.first ? out.torque_j : out.torque_i;
    for (int k = 0; k < 3; k++) {
      f[i][k] += fi[k];
      torque[i][k] += ti[k];
    }
    if (j < nlocal)
      for (int k = 0; k < 3; k++) {
        f[j][k] -= fi[k];
        torque[j][k] += tj[k];
      }
    if (out.flags & ASPERITY_OUT_OF_RANGE) outside += j < nlocal ? 1.0 : 0.5;
    if (evflag)
      ev_tally_xyz(i, j, nlocal, 0, out.stored, 0.0, fi[0], fi[1], fi[2],
                   x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]);
  }

  // What it dissipated, and whether its memory is kept.
  void keep(Entry &one, const asperity_pair &pair)
  {
    static const asperity_cohesion none = {};
    const asperity_contact &after = *pair.after;
    const double lost[4] = {after.plastic - one.plastic, after.slip - one.slip, pair.out.damped, pair.out.parted};
    history->add_heat(one.i, one.j, lost);
    const bool forgets = asperity_may_forget_cohesive(&after, pair.cohesion ? pair.cohesion : &none);
    one.begins = one.slot < 0 && !forgets;
    if (one.slot >= 0 && forgets) history->drop(one.entry, one.i, one.j);
  }

  void begin(const Entry &one, const asperity_pair &pair)
  {
    Memories &memories = history->memories;
    const int slot = history->add(one.entry, one.i, one.j);
    memories.contact[slot] = *pair.after;
    if (turning) memories.turning[slot] = *pair.turning;
    if (pair.cohesion) memories.cohesion[slot] = *pair.cohesion;
    if (pair.cohesion) memories.coheres[slot] = 1;
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
    if (cohesive && !history->memories.holds) history->memories.allow_cohesion();
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
    const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
    double outside = 0.0;
    filled = 0;    // an error may have left some
    if (rebuilt && masses.any()) {
      masses.look();
      comm->forward_comm(this);
    }
    for (int i = 0; i < nlocal; i++) require_known(i);
    if (rebuilt || !history->matched) history->match(list);
    bodies.resize(nall);
    for (int i = 0; i < nall; i++) fill(bodies[i], atom, masses, i);
    for (int ii = 0, entry = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii], *neighbours = list->firstneigh[i];
      const asperity_body &one = bodies[i];
      for (int jj = 0; jj < list->numneigh[i]; jj++, entry++) {
        const int j = neighbours[jj] & NEIGHMASK;
        if (history->slots[entry] < 0 && !near(one, bodies[j], i, j)) continue;
        gather(i, j, entry);
        if (filled == BATCH) settle(dt, advance, outside);
      }
    }
    settle(dt, advance, outside);
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
    const int slot = i < atom->nlocal ? history->find(i, j) : history->find(j, i);
    if (slot < 0 && rsq >= sum * sum) return 0.0;
    const Memories &memories = history->memories;
    const Law &law = *laws[atom->type[i]][atom->type[j]];
    asperity_body a, b;
    asperity_contact after, before = {};
    asperity_turning turned = {};
    asperity_cohesion joined = {};
    if (slot >= 0) before = memories.contact[slot];
    if (slot >= 0 && turning) turned = memories.turning[slot];
    if (slot >= 0 && memories.holds) joined = memories.cohesion[slot];
    const bool first = atom->tag[i] < atom->tag[j];
    asperity_turning *turning_too = turning ? &turned : nullptr;
    asperity_cohesion *cohesion_too = law.coheres() ? &joined : nullptr;
    fill(a, atom, masses, first ? i : j);
    fill(b, atom, masses, first ? j : i);
    asperity_pair pair = {&a, &b, &before, &after, turning_too, cohesion_too, {}};
    asperity_spheres_many(&law.law, 0.0, 1, &pair);    // as in compute(), to the bit
    const asperity_forces &out = pair.out;
    if (out.flags & ASPERITY_NO_NUMBER) no_answer(i, j);
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
    return history ? history->bytes() : 0.0;
  }
};

}    // namespace LAMMPS_NS

#endif
