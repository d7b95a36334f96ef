// The memory of the contacts between spheres. Each owned atom has that of all its contacts, so that it moves, is written and read
// with the atom, whoever owns the partner. Under the GNU General Public License, version 2.
#ifndef FIX_ASPERITY_HISTORY_H
#define FIX_ASPERITY_HISTORY_H

#include "asperity_common.h"

namespace LAMMPS_NS {

// A contact as its atom holds it.
struct Record {
  tagint partner;
  bool seen;
  asperity_contact contact;
  std::vector<asperity_turning> turning;    // its twist and roll, or none
  std::vector<asperity_cohesion> cohesion;    // or none
};

class FixAsperityHistory : public Fix {
 public:
  std::vector<std::vector<Record>> rows;
  double total[4] = {};    // this process's share of the work dissipated by plastic flow, slip, damping, cohesion
  double **heat = nullptr;              // the same of each sphere, which takes half of what its contacts dissipate
  bool turning = false;                 // whether contacts twist and roll
  std::map<std::pair<int, int>, Identity> laws, restarted;    // by types: those of now, those of the restart file

  FixAsperityHistory(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
  {
    turning = narg > 3 && strcmp(arg[3], "turning") == 0;
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
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, numbers(i));
    maxexchange = most;
  }

  // How many numbers a sphere has with its contacts: of each the partner, its own, and whether those
  // of cohesion follow.
  int numbers(int i) const
  {
    int sum = HEAD;
    for (const Record &record : rows[i])
      sum += 2 + NUMBERS + (turning ? TURNING : 0) + COHESION * static_cast<int>(record.cohesion.size());
    return sum;
  }

  // A sphere that was made in this run is known from now on by the ID that it has.
  void know(int i)
  {
    if (known_as[i] == 0) known_as[i] = atom->tag[i];
  }

  Record *find(int i, tagint partner)
  {
    for (auto &record : rows[i])
      if (record.partner == partner) return &record;
    return nullptr;
  }

  // `turned` is NULL of contacts that do not twist and roll, `joined` of those without cohesion.
  void put(int i, tagint partner, const asperity_contact &contact, const asperity_turning *turned,
           const asperity_cohesion *joined)
  {
    Record *record = find(i, partner);
    if (!record) {
      rows[i].push_back({partner, true, contact, {}, {}});
      record = &rows[i].back();
    }
    record->contact = contact;
    record->seen = true;
    if (turned) record->turning.assign(1, *turned);
    if (joined) record->cohesion.assign(1, *joined);
    else record->cohesion.clear();
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

  // Forgets the contacts that left the neighbour list.
  void drop_unseen(int i)
  {
    auto &row = rows[i];
    row.erase(std::remove_if(row.begin(), row.end(), [](const Record &record) { return !record.seen; }), row.end());
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
    rows[j] = rows[i];
    known_as[j] = known_as[i];
    std::copy(heat[i], heat[i] + 4, heat[j]);
  }
  void set_arrays(int i) override
  {
    rows[i].clear();
    known_as[i] = 0;
    std::fill(heat[i], heat[i] + 4, 0.0);
  }

  int pack_exchange(int i, double *buf) override
  {
    const int m = pack(i, buf);
    rows[i].clear();
    return m;
  }
  int unpack_exchange(int i, double *buf) override { return unpack(i, buf); }
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
    const int m = 1 + pack(i, buf + 1);
    buf[0] = m;
    return m;
  }
  void unpack_restart(int i, int nth) override
  {
    double *extra = atom->extra[i];
    int m = 0;
    for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
    if (unpack(i, extra + m + 1) != static_cast<int>(extra[m]) - 1)
      error->one(FLERR, "pair_style asperity: the contacts of sphere {} in the restart file are damaged", atom->tag[i]);
  }

  void write_restart(FILE *fp) override
  {
    double sum[4];
    MPI_Allreduce(total, sum, 4, MPI_DOUBLE, MPI_SUM, world);
    if (comm->me != 0) return;
    std::vector<double> buf;
    begin_layout(buf, turning);
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
    require_layout(lmp, buf, "pair_style asperity", turning);
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
  std::vector<tagint> known_as;    // the ID by which the contacts of others know an owned sphere; 0 of a new one
  bigint spheres = -1;             // how many there were when the IDs were last looked at

  int pack(int i, double *buf)
  {
    int m = 0;
    buf[m++] = static_cast<double>(rows[i].size());
    buf[m++] = ubuf(known_as[i]).d;
    for (int k = 0; k < 4; k++) buf[m++] = heat[i][k];
    for (const auto &record : rows[i]) {
      buf[m++] = ubuf(record.partner).d;
      memcpy(buf + m, &record.contact, sizeof record.contact);
      m += NUMBERS;
      if (turning) {
        asperity_turning turned = {};
        if (!record.turning.empty()) turned = record.turning[0];
        memcpy(buf + m, &turned, sizeof turned);
        m += TURNING;
      }
      buf[m++] = static_cast<double>(record.cohesion.size());
      for (const asperity_cohesion &joined : record.cohesion) {
        memcpy(buf + m, &joined, sizeof joined);
        m += COHESION;
      }
    }
    return m;
  }
  int unpack(int i, const double *buf)
  {
    int m = 0;
    const int count = static_cast<int>(buf[m++]);
    known_as[i] = static_cast<tagint>(ubuf(buf[m++]).i);
    for (int k = 0; k < 4; k++) heat[i][k] = buf[m++];
    rows[i].clear();
    for (int k = 0; k < count; k++) {
      Record record;
      record.partner = static_cast<tagint>(ubuf(buf[m++]).i);
      record.seen = true;
      memcpy(&record.contact, buf + m, sizeof record.contact);
      m += NUMBERS;
      if (turning) {
        record.turning.resize(1);
        memcpy(record.turning.data(), buf + m, sizeof(asperity_turning));
        m += TURNING;
      }
      record.cohesion.resize(buf[m++] > 0.0 ? 1 : 0);
      for (asperity_cohesion &joined : record.cohesion) {
        memcpy(&joined, buf + m, sizeof joined);
        m += COHESION;
      }
      rows[i].push_back(record);
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
    for (int i = 0; i < atom->nlocal; i++) {
      auto &row = rows[i];
      for (size_t k = 0; k < row.size();) {
        Record &record = row[k];
        const auto at = std::lower_bound(names.begin(), names.end(), std::make_pair(record.partner, static_cast<tagint>(0)));
        if (at == names.end() || at->first != record.partner) {
          row[k] = row.back();
          row.pop_back();
          continue;
        }
        // The memory is of the two in the order of their IDs.
        const bool was_first = known_as[i] < record.partner, is_first = atom->tag[i] < at->second;
        if (was_first != is_first) {
          asperity_exchange(&record.contact);
          for (asperity_turning &turned : record.turning) asperity_exchange_turning(&turned);
          for (asperity_cohesion &joined : record.cohesion) asperity_exchange_cohesion(&joined);
        }
        record.partner = at->second;
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
