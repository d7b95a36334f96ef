// The memory of the contacts between spheres. Each owned atom knows that of all its contacts, so that it moves, is written and
// read with the atom, whoever owns the partner. Memories stand in the order of the neighbour list, each once if both spheres are
// owned, and the list's entries know their places. Under the GNU General Public License, version 2.
#ifndef FIX_ASPERITY_HISTORY_H
#define FIX_ASPERITY_HISTORY_H

#include "asperity_memory.h"

#include "domain.h"

namespace LAMMPS_NS {

class FixAsperityHistory : public Fix {
 public:
  std::vector<std::vector<Known>> rows;    // of each owned sphere
  Memories memories;
  std::vector<int> slots;    // of each entry of the neighbour list in its order; -1 of one without a contact
  bool matched = false;      // whether `slots` is of the spheres as they stand
  double total[4] = {};    // this process's share of the work dissipated by plastic flow, slip, damping, cohesion
  double **heat = nullptr;              // the same of each sphere, which takes half of what its contacts dissipate
  std::map<std::pair<int, int>, Identity> laws, restarted;    // by types: those of now, those of the restart file

  FixAsperityHistory(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
  {
    memories.turns = narg > 3 && strcmp(arg[3], "turning") == 0;
    restart_peratom = 1;
    restart_global = 1;
    create_attribute = 1;
    maxexchange_dynamic = 1;
    maxexchange = HEAD;
    peratom_flag = 1;
    size_peratom_cols = 4;
    peratom_freq = 1;
    FixAsperityHistory::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; i++) FixAsperityHistory::set_arrays(i);
  }

  ~FixAsperityHistory() override
  {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
    memory->destroy(heat);
  }

  int setmask() override { return FixConst::PRE_EXCHANGE; }

  // Every command that moves or writes atoms begins with this.
  void init() override
  {
    follow_ids();
    pre_exchange();
  }
  void setup_pre_exchange() override { pre_exchange(); }
  void pre_exchange() override
  {
    int most = HEAD;
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, numbers(i) + WAY * static_cast<int>(rows[i].size()));
    maxexchange = most;
  }

  // How many numbers a sphere has with its contacts: of each the partner, its own, and whether those
  // of cohesion follow.
  int numbers(int i) const
  {
    int sum = HEAD;
    for (const Known &known : rows[i])
      sum += 2 + NUMBERS + (memories.turns ? TURNING : 0) + (memories.holds && memories.coheres[known.slot] ? COHESION : 0);
    return sum;
  }

  // A sphere that was made in this run is known from now on by the ID that it has.
  void know(int i)
  {
    if (known_as[i] == 0) known_as[i] = atom->tag[i];
  }

  // The memory of an owned sphere's contact with j, or -1.
  int find(int i, int j) const
  {
    int best = -1;
    double least = INFINITY;
    for (const Known &known : rows[i]) {
      if (known.partner != atom->tag[j]) continue;
      const double off = between(memories.way[known.slot], way(i, j));
      if (best < 0 || off < least) {
        best = known.slot;
        least = off;
      }
    }
    return best;
  }

  // A contact that begins, of an entry of the list.
  int add(int entry, int i, int j)
  {
    const int slot = slots[entry] = memories.add();
    memories.way[slot] = way(i, j);
    rows[i].push_back({atom->tag[j], slot});
    if (j < atom->nlocal) rows[j].push_back({atom->tag[i], slot});
    return slot;
  }

  // One that ends.
  void drop(int entry, int i, int j)
  {
    const int slot = slots[entry];
    forget(i, slot);
    if (j < atom->nlocal) forget(j, slot);
    memories.drop(slot);
    slots[entry] = -1;
  }

  // After the list was made: which memory each of its entries has. They are brought into its order, and those that it has not
  // are gone for good.
  void match(const NeighList *list)
  {
    size_t count = 0;
    for (int ii = 0; ii < list->inum; ii++) count += list->numneigh[list->ilist[ii]];
    slots.assign(count, -1);
    find_ways(list);
    int *mine = slots.data();
    for (int ii = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      match_row(i, list->firstneigh[i], list->numneigh[i], mine);
      mine += list->numneigh[i];
    }
    for (int i = 0; i < atom->nlocal; i++) {
      know(i);
      rows[i].clear();
    }
    spare.clear_like(memories);
    int *entry = slots.data();
    for (int ii = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      for (int jj = 0; jj < list->numneigh[i]; jj++, entry++) {
        if (*entry < 0) continue;
        const int j = list->firstneigh[i][jj] & NEIGHMASK;
        *entry = spare.take(memories, *entry, way(i, j));
        rows[i].push_back({atom->tag[j], *entry});
        if (j < atom->nlocal) rows[j].push_back({atom->tag[i], *entry});
      }
    }
    std::swap(memories, spare);
    matched = true;
  }

  // What a contact of spheres i and j has dissipated by plastic flow, slip, damping and cohesion in a
  // step: half of it is of each. Of a ghost its owner has it too.
  void add_heat(int i, int j, const double lost[4])
  {
    const double weight = j < atom->nlocal ? 1.0 : 0.5;
    for (int k = 0; k < 4; k++) {
      total[k] += weight * lost[k];
      heat[i][k] += 0.5 * lost[k];
      if (j < atom->nlocal) heat[j][k] += 0.5 * lost[k];
    }
  }

  double bytes() const
  {
    double sum = memories.bytes() + spare.bytes() + static_cast<double>(slots.capacity() * sizeof(int));
    for (const auto &row : rows) sum += static_cast<double>(row.capacity() * sizeof(Known));
    return sum;
  }

  void grow_arrays(int nmax) override
  {
    memory->grow(heat, nmax, 4, "asperity:heat");
    array_atom = heat;
    if (rows.size() >= static_cast<size_t>(nmax)) return;
    rows.resize(nmax);
    known_as.resize(nmax, 0);
  }
  void copy_arrays(int i, int j, int) override
  {
    matched = false;
    rows[j] = rows[i];
    known_as[j] = known_as[i];
    std::copy(heat[i], heat[i] + 4, heat[j]);
  }
  void set_arrays(int i) override
  {
    matched = false;
    rows[i].clear();
    known_as[i] = 0;
    std::fill(heat[i], heat[i] + 4, 0.0);
  }

  int pack_exchange(int i, double *buf) override
  {
    const int m = pack(i, rows[i], buf, true);
    matched = false;
    rows[i].clear();
    return m;
  }
  int unpack_exchange(int i, double *buf) override { return unpack(i, buf, true); }
  int size_restart(int i) override { return 1 + numbers(i); }
  int maxsize_restart() override
  {
    int most = 0, all;
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, size_restart(i));
    MPI_Allreduce(&most, &all, 1, MPI_INT, MPI_MAX, world);
    return all;
  }
  int pack_restart(int i, double *buf) override
  {
    // Of several contacts with one sphere's images the deepest comes first: so they find their images again.
    std::vector<Known> row = rows[i];
    const auto deeper = [this](const Known &one, const Known &other) {
      return memories.contact[one.slot].state.h > memories.contact[other.slot].state.h;
    };
    std::stable_sort(row.begin(), row.end(), deeper);
    const int m = 1 + pack(i, row, buf + 1, false);
    buf[0] = m;
    return m;
  }
  void unpack_restart(int i, int nth) override
  {
    double *extra = atom->extra[i];
    int m = 0;
    for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
    if (unpack(i, extra + m + 1, false) != static_cast<int>(extra[m]) - 1)
      error->one(FLERR, "pair_style asperity: the contacts of sphere {} in the restart file are damaged", atom->tag[i]);
  }

  void write_restart(FILE *fp) override
  {
    double sum[4];
    MPI_Allreduce(total, sum, 4, MPI_DOUBLE, MPI_SUM, world);
    if (comm->me != 0) return;
    std::vector<double> buf;
    begin_layout(buf, memories.turns);
    buf.insert(buf.end(), sum, sum + 4);
    buf.push_back(static_cast<double>(laws.size()));
    for (const auto &[types, law] : laws) {
      double packed[Identity::SIZE];
      law.pack(packed);
      for (const int type : {types.first, types.second}) buf.push_back(static_cast<double>(type));
      buf.insert(buf.end(), packed, packed + Identity::SIZE);
    }
    write_buffer(fp, buf);
  }
  void restart(char *buf) override
  {
    require_layout(lmp, buf, "pair_style asperity", memories.turns);
    double head[8];
    memcpy(head, buf, sizeof head);
    if (comm->me == 0) std::copy(head + 3, head + 7, total);
    for (int k = 0; k < static_cast<int>(head[7]); k++) {
      double numbers[2 + Identity::SIZE];
      memcpy(numbers, buf + sizeof head + k * sizeof numbers, sizeof numbers);
      restarted[{static_cast<int>(numbers[0]), static_cast<int>(numbers[1])}].unpack(numbers + 2);
    }
  }

 private:
  static constexpr int HEAD = 6;    // numbers of a sphere before those of its contacts
  static constexpr int WAY = 3;     // and those of a contact that travels, besides what a restart file has
  std::vector<tagint> known_as;    // the ID by which the contacts of others know an owned sphere; 0 of a new one
  bigint spheres = -1;             // how many there were when the IDs were last looked at
  Memories spare;                  // where the next order comes to be

  // From the one of the lower ID to the other; of a sphere and its own image from i to j.
  Way way(int i, int j) const
  {
    double **x = atom->x;
    const double sign = atom->tag[i] <= atom->tag[j] ? 1.0 : -1.0;
    return {sign * (x[j][0] - x[i][0]), sign * (x[j][1] - x[i][1]), sign * (x[j][2] - x[i][2])};
  }

  // By how much, squared, a contact may have moved since the list was made before: less than to the next image.
  double most_off() const
  {
    double shortest = INFINITY;
    for (int k = 0; k < domain->dimension; k++)
      if (domain->periodicity[k]) shortest = std::min(shortest, domain->prd[k]);
    return 0.25 * shortest * shortest;
  }

  // Contacts from a restart file, the deepest first, are those with the nearest images.
  void find_ways(const NeighList *list)
  {
    bool wanted = false;
    for (int i = 0; i < atom->nlocal; i++)
      for (const Known &known : rows[i]) wanted = wanted || memories.way[known.slot] == Way{};
    if (!wanted) return;
    std::vector<std::vector<std::pair<tagint, Way>>> around(atom->nlocal);
    for (int ii = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      for (int jj = 0; jj < list->numneigh[i]; jj++) {
        const int j = list->firstneigh[i][jj] & NEIGHMASK;
        around[i].emplace_back(atom->tag[j], way(i, j));
        if (j < atom->nlocal) around[j].emplace_back(atom->tag[i], way(i, j));
      }
    }
    const auto nearer = [](const auto &one, const auto &other) { return between(one.second, {}) < between(other.second, {}); };
    for (int i = 0; i < atom->nlocal; i++) {
      if (rows[i].empty()) continue;
      std::stable_sort(around[i].begin(), around[i].end(), nearer);
      for (const Known &known : rows[i])
        for (auto &[partner, there] : around[i]) {
          if (memories.way[known.slot] != Way{} || partner != known.partner) continue;
          std::swap(memories.way[known.slot], there);
          partner = 0;    // taken
        }
    }
  }

  void match_row(int i, const int *neighbours, int count, int *mine) const
  {
    const double most = most_off();
    for (const Known &known : rows[i]) {
      double least = most;
      int best = -1;
      for (int jj = 0; jj < count; jj++) {
        const int j = neighbours[jj] & NEIGHMASK;
        if (atom->tag[j] != known.partner || mine[jj] >= 0) continue;
        const double off = between(memories.way[known.slot], way(i, j));
        if (off >= least) continue;
        least = off;
        best = jj;
      }
      if (best >= 0) mine[best] = known.slot;
    }
  }

  void forget(int i, int slot)
  {
    auto &row = rows[i];
    for (Known &known : row)
      if (known.slot == slot) {
        known = row.back();
        row.pop_back();
        return;
      }
  }

  int pack(int i, const std::vector<Known> &row, double *buf, bool travels)
  {
    int m = 0;
    buf[m++] = static_cast<double>(row.size());
    buf[m++] = ubuf(known_as[i]).d;
    for (int k = 0; k < 4; k++) buf[m++] = heat[i][k];
    for (const Known &known : row) {
      const int slot = known.slot;
      buf[m++] = ubuf(known.partner).d;
      memcpy(buf + m, &memories.contact[slot], sizeof(asperity_contact));
      m += NUMBERS;
      if (memories.turns) {
        memcpy(buf + m, &memories.turning[slot], sizeof(asperity_turning));
        m += TURNING;
      }
      const bool joins = memories.holds && memories.coheres[slot];
      buf[m++] = joins ? 1.0 : 0.0;
      if (joins) {
        memcpy(buf + m, &memories.cohesion[slot], sizeof(asperity_cohesion));
        m += COHESION;
      }
      if (travels)
        for (const double along : memories.way[slot]) buf[m++] = along;
    }
    return m;
  }
  int unpack(int i, const double *buf, bool travels)
  {
    int m = 0;
    const int count = static_cast<int>(buf[m++]);
    matched = false;
    known_as[i] = static_cast<tagint>(ubuf(buf[m++]).i);
    for (int k = 0; k < 4; k++) heat[i][k] = buf[m++];
    rows[i].clear();
    for (int k = 0; k < count; k++) {
      const int slot = memories.add();
      rows[i].push_back({static_cast<tagint>(ubuf(buf[m++]).i), slot});
      memcpy(&memories.contact[slot], buf + m, sizeof(asperity_contact));
      m += NUMBERS;
      if (memories.turns) {
        memcpy(&memories.turning[slot], buf + m, sizeof(asperity_turning));
        m += TURNING;
      }
      if (buf[m++] > 0.0) {
        if (!memories.holds) memories.allow_cohesion();
        memories.coheres[slot] = 1;
        memcpy(&memories.cohesion[slot], buf + m, sizeof(asperity_cohesion));
        m += COHESION;
      }
      if (travels)
        for (double &along : memories.way[slot]) along = buf[m++];
    }
    return m;
  }

  // IDs are LAMMPS' own: delete_atoms and reset_atoms give new ones. A sphere carries the ID by which others know it, and where
  // that is not the one that it has, all contacts are told the new ones. Those with spheres that are gone go too.
  void follow_ids()
  {
    bigint mine[2] = {atom->nlocal, 0}, all[2];
    for (int i = 0; i < atom->nlocal; i++) mine[1] += known_as[i] != atom->tag[i];
    MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, world);
    if (all[1] == 0 && all[0] == spheres) return;
    spheres = all[0];

    const std::vector<std::pair<tagint, tagint>> names = all_names();
    // Two owned spheres know of one memory, which turns round once.
    std::vector<char> turned(memories.contact.size(), 0);
    for (int i = 0; i < atom->nlocal; i++) {
      auto &row = rows[i];
      for (size_t k = 0; k < row.size();) {
        Known &known = row[k];
        const auto at = std::lower_bound(names.begin(), names.end(), std::make_pair(known.partner, static_cast<tagint>(0)));
        if (at == names.end() || at->first != known.partner) {
          row[k] = row.back();
          row.pop_back();
          continue;
        }
        // The memory is of the two in the order of their IDs.
        const bool was_first = known_as[i] < known.partner, is_first = atom->tag[i] < at->second;
        if (was_first != is_first && !turned[known.slot]) {
          memories.exchange(known.slot);
          turned[known.slot] = 1;
        }
        known.partner = at->second;
        k++;
      }
    }
    for (int i = 0; i < atom->nlocal; i++) known_as[i] = atom->tag[i];
  }

  // Of every sphere of all processes the ID by which others know it and the one that it has, in the order of the first.
  std::vector<std::pair<tagint, tagint>> all_names()
  {
    std::vector<tagint> mine;
    for (int i = 0; i < atom->nlocal; i++)
      if (known_as[i] != 0) {
        mine.push_back(known_as[i]);
        mine.push_back(atom->tag[i]);
      }
    int count = static_cast<int>(mine.size());
    std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
    MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
    for (int p = 1; p < comm->nprocs; p++) starts[p] = starts[p - 1] + counts[p - 1];
    std::vector<tagint> all(starts.back() + counts.back() + 1);
    MPI_Allgatherv(mine.data(), count, MPI_LMP_TAGINT, all.data(), counts.data(), starts.data(), MPI_LMP_TAGINT, world);
    std::vector<std::pair<tagint, tagint>> names;
    for (size_t k = 0; k + 1 < all.size(); k += 2) names.emplace_back(all[k], all[k + 1]);
    std::sort(names.begin(), names.end());
    return names;
  }
};

}    // namespace LAMMPS_NS

#endif
