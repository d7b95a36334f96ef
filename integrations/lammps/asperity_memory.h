// The memories of the contacts between spheres, one beside the other. Under the GNU General Public License, version 2.
#ifndef ASPERITY_MEMORY_H
#define ASPERITY_MEMORY_H

#include "asperity_common.h"

#include <array>

namespace LAMMPS_NS {

// What a sphere knows of a contact: with which ID, and where its memory stands.
struct Known {
  tagint partner;
  int slot;
};

using Way = std::array<double, 3>;

inline double between(const Way &one, const Way &other)
{
  double sum = 0.0;
  for (int k = 0; k < 3; k++) sum += (one[k] - other[k]) * (one[k] - other[k]);
  return sum;
}

// A slot has the memory of one contact, of which both spheres know if both are owned.
struct Memories {
  bool turns = false, holds = false;          // whether contacts twist and roll, and whether some have cohesion
  std::vector<asperity_contact> contact;
  std::vector<asperity_turning> turning;      // empty if none twists and rolls
  std::vector<asperity_cohesion> cohesion;    // empty if none has any
  std::vector<char> coheres;                  // whether this one has; as long as `cohesion`
  // From the sphere of the lower ID to the other when the list was made; it tells images of one sphere
  // from each other. Zero of a contact from a restart file.
  std::vector<Way> way;
  std::vector<int> unused;

  // A new contact that remembers nothing.
  int add()
  {
    if (unused.empty()) return append(asperity_contact{}, asperity_turning{}, asperity_cohesion{}, 0, Way{});
    const int slot = unused.back();
    unused.pop_back();
    contact[slot] = {};
    way[slot] = {};
    if (turns) turning[slot] = {};
    if (holds) cohesion[slot] = {};
    if (holds) coheres[slot] = 0;
    return slot;
  }

  int append(const asperity_contact &one, const asperity_turning &turned, const asperity_cohesion &joined, char joins,
             const Way &at)
  {
    contact.push_back(one);
    way.push_back(at);
    if (turns) turning.push_back(turned);
    if (holds) cohesion.push_back(joined);
    if (holds) coheres.push_back(joins);
    return static_cast<int>(contact.size()) - 1;
  }

  // Takes over a contact of another set.
  int take(const Memories &from, int slot, const Way &now)
  {
    static const asperity_turning straight = {};
    static const asperity_cohesion apart = {};
    return append(from.contact[slot], from.turns ? from.turning[slot] : straight, from.holds ? from.cohesion[slot] : apart,
                  from.holds ? from.coheres[slot] : 0, now);
  }

  void drop(int slot) { unused.push_back(slot); }

  // Says that a contact is wanted soon: its numbers come from far.
  void fetch(int slot) const
  {
    if (static_cast<size_t>(slot) >= contact.size()) return;
    const char *at = reinterpret_cast<const char *>(&contact[slot]);
    for (size_t k = 0; k < sizeof(asperity_contact); k += 64) __builtin_prefetch(at + k, 1);
  }

  // From now on some have cohesion.
  void allow_cohesion()
  {
    holds = true;
    cohesion.resize(contact.size());
    coheres.resize(contact.size(), 0);
  }

  void clear_like(const Memories &other)
  {
    turns = other.turns;
    holds = other.holds;
    contact.clear();
    turning.clear();
    cohesion.clear();
    coheres.clear();
    way.clear();
    unused.clear();
  }

  // The contact as it is once the IDs of the two have changed their order.
  void exchange(int slot)
  {
    asperity_exchange(&contact[slot]);
    if (turns) asperity_exchange_turning(&turning[slot]);
    if (holds) asperity_exchange_cohesion(&cohesion[slot]);
    for (double &along : way[slot]) along = -along;
  }

  double bytes() const
  {
    return static_cast<double>(contact.capacity() * sizeof(asperity_contact) + turning.capacity() * sizeof(asperity_turning) +
                               cohesion.capacity() * (1 + sizeof(asperity_cohesion)) + way.capacity() * sizeof(Way));
  }
};

}    // namespace LAMMPS_NS

#endif
