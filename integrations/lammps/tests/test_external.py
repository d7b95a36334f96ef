"""`fix external` in place of the plug-in: the same forces. Run by run.sh: test_external.py PLUGIN METAL ELASTIC LIBRARY"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "external"))

from asperity_external import External
from host import E, HEAD, PAIR, WALL, expect, failures, quiet

LIBRARY = str(Path(sys.argv[4]).resolve())
START = """units lj
atom_style sphere
comm_modify vel yes
newton {newton}
boundary p p p
region box block 0 3.92 0 3.92 0 3.92
create_box 2 box
lattice custom 1.0625 a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0.5 0.5 0.5
create_atoms 1 box
set group all diameter 1 density 1
set type 1 type/fraction 2 0.4 4711
set type 2 diameter 0.96
displace_atoms all random 0.01 0.01 0.01 8711
velocity all create 0.05 87287 loop geom
timestep 0.005
compute spins all erotate/sphere
"""


def table(lmp):
    """Of each sphere, by its ID: force, torque, velocity."""
    get = lmp.numpy.extract_atom
    order = get("id")[: lmp.extract_global("nlocal")].argsort()
    return [[*get("f")[k], *get("torque")[k], *get("v")[k]] for k in order]


def apart(one, two, columns):
    size = max(abs(row[c]) for row in one for c in columns)
    assert size > 0
    return max(abs(a[c] - b[c]) for a, b in zip(one, two) for c in columns) / size


def packing(newton):
    plug, free = quiet(), quiet()
    start = START.format(newton=newton)
    plug.commands_string(HEAD.split("\n")[0] + "\n" + start + f"pair_style asperity\npair_coeff 1 1 {PAIR} {E} restitution 0.8\npair_coeff 1 2 {PAIR} {0.9 * E}\n"
                         f"pair_coeff 2 2 {PAIR} {0.8 * E}\ncompute pairs all pair asperity\nfix move all nve/sphere\nthermo_style custom step pe c_pairs[1]\n")
    free.commands_string(start)
    contacts = External(free, LIBRARY, cutoff=1.0)
    contacts.law(1, 1, PAIR, E, 0.8)
    contacts.law(1, 2, PAIR, 0.9 * E)
    contacts.law(2, 2, PAIR, 0.8 * E)
    free.command("fix move all nve/sphere")
    worst = []
    for steps in (0, 1, 99, 400):
        for lmp in (plug, free):
            lmp.command(f"run {steps}")
        contacts.check()
        one, two = table(plug), table(free)
        worst.append(max(apart(one, two, range(3)), apart(one, two, range(6, 9)), apart(one, two, range(3, 6)) if steps else 0.0))
    pe = abs(free.get_thermo("pe") / plug.get_thermo("pe") - 1)
    lost = plug.numpy.extract_compute("pairs", 0, 1)[:3]
    work = max(abs(a / b - 1) for a, b in zip((contacts.plastic, contacts.slip, contacts.damped), lost))
    contacts.close()
    plug.close()
    free.close()
    expect(max(worst) < 1e-9, f"fix external, newton {newton}: forces, torques, velocities less the plug-in's after 0, 1, 100, 500 steps", " ".join(f"{w:.1e}" for w in worst))
    expect(pe < 1e-9 and work < 1e-9, "    elastic energy, work dissipated", f"{pe:.1e} {work:.1e}")


def refusals():
    lmp = quiet()
    lmp.commands_string(START.format(newton="on"))
    contacts, said = External(lmp, LIBRARY, cutoff=1.0), []
    for words in ((WALL, E), (PAIR, -1.0), (PAIR, E, 2.0), ("nothing.asperity", E), (__file__, E)):
        try:
            contacts.law(1, 1, *words)
        except ValueError as problem:
            said.append(str(problem))
    expect([any(word in line for line in said) for word in ("of a sphere on a plane", "is not positive", "not between", "cannot be opened", "is no contact table")] == [True] * 5,
           "refused: a wall's table, a modulus, a restitution, files", len(said))
    contacts.law(1, 1, PAIR, E)
    lmp.command("fix move all nve/sphere")
    try:
        lmp.command("run 100")
        contacts.check()
        said = "nothing"
    except Exception as problem:
        said = str(problem)
    expect("no law for a contact of sphere" in said and lmp.extract_global("ntimestep") < 100, "stopped: a pair of types without a law", said)
    contacts.close()
    lmp.close()


if __name__ == "__main__":
    for newton in ("on", "off"):
        packing(newton)
    refusals()
    sys.exit(1 if failures else 0)
