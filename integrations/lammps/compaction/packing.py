"""A random packing of frictionless spheres in a die, from which every law of the compaction starts."""

import numpy as np
from lammps import lammps

SPACING = 2.2  # of the lattice from which the spheres are shaken
RADII = (0.9, 1.0, 1.05)
E, NU, DENSITY = 1.0, 0.3, 1.0  # the wave's speed is 1
STEP = 0.1
WALLS = {"left": (0, 1), "right": (0, -1), "front": (1, 1), "back": (1, -1), "bottom": (2, 1)}


def packing(across, up):
    """Centres (N, 3), radii and types (N) of spheres none of which touches another or a wall, and width and height of the die.

    A lattice would not do: with friction its columns are pressed into each other end on.
    """
    width, height = SPACING * across, SPACING * up
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])

    def model(restitution):
        return f"hertz/material {E} {restitution} {NU} tangential mindlin NULL 0.0 0.0 damping coeff_restitution"

    lmp.commands_string(f"""
units lj
atom_style sphere
atom_modify map array
comm_modify vel yes
newton off
boundary f f f
region box block -1 {width + 1} -1 {width + 1} -1 {height + 1} units box
create_box 3 box
lattice sc {1 / SPACING**3} origin 0.5 0.5 0.5
region fill block 0 {width} 0 {width} 0 {height} units box
create_atoms 1 region fill
set type 1 type/fraction 2 0.33 1812
set type 1 type/fraction 3 0.5 1813
set type 1 diameter {2 * RADII[0]}
set type 2 diameter {2 * RADII[1]}
set type 3 diameter {2 * RADII[2]}
set group all density {DENSITY}
velocity all create {0.02**2 * 4.19} 4928 loop geom
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {STEP}
pair_style granular
pair_coeff * * {model(0.99)}
variable shift equal 0.0
region lid plane 0 0 {height} 0 0 -1 side in units box move NULL NULL v_shift
""")
    for name, (axis, sign) in WALLS.items():
        place = [0.0, 0.0, 0.0]
        place[axis] = width if sign < 0 else 0.0
        normal = [0, 0, 0]
        normal[axis] = sign
        lmp.command(f"region {name} plane {' '.join(map(str, place + normal))} side in units box")
        lmp.command(f"fix {name} all wall/gran/region granular {model(0.99)} region {name}")
    lmp.command(f"fix lid all wall/gran/region granular {model(0.99)} region lid contacts")
    lmp.command("compute lid all reduce sum f_lid[4]")
    lmp.command("fix move all nve/sphere")
    # A gas of 0.44 forgets the lattice within some tens of radii of way.
    lmp.command("run 20000 post no")
    for name in WALLS:
        lmp.command(f"unfix {name}")
        lmp.command(f"fix {name} all wall/gran/region granular {model(0.3)} region {name}")
    lmp.command(f"pair_coeff * * {model(0.3)}")
    lmp.command("thermo_style custom step c_lid")
    lmp.command("run 10000 post no")
    # Slow enough that momentum presses with a small part of the pressure at which they count as jammed.
    speed, jammed, now, z, pressed = 0.0015, 3e-5 * E * width * width, 30000, height, 0
    while pressed < 5:
        lmp.command(f"variable shift equal {z - height}-{speed}*(step-{now})*{STEP}")
        lmp.command("run 200 post no")
        z, now = z - 200 * speed * STEP, now + 200
        pressed = pressed + 1 if -lmp.extract_compute("lid", 0, 0) > jammed else 0
        if z < 0.5 * height:
            raise RuntimeError("the spheres did not jam")
    lmp.command(f"variable shift equal {z - height}")
    lmp.command("run 10000 post no")
    count = lmp.get_natoms()
    order = np.argsort(np.array(lmp.numpy.extract_atom("id")[:count]))
    x = np.array(lmp.numpy.extract_atom("x")[:count])[order]
    radius = np.array(lmp.numpy.extract_atom("radius")[:count])[order]
    kind = np.array(lmp.numpy.extract_atom("type")[:count])[order]
    lmp.close()
    # Spread until nothing touches.
    distance = np.linalg.norm(x[:, None] - x[None], axis=2) + 10 * np.eye(count)
    stretch = float(((radius[:, None] + radius[None]) / distance).max())
    sides = np.array([width, width, z])
    stretch = max(stretch, float((radius[:, None] / x).max()), float((radius[:, None] / (sides - x)).max())) * (1 + 1e-9)
    return x * stretch, radius, kind, width * stretch, z * stretch

