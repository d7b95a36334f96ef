"""What the tests of the plug-in share.

Their first words: PLUGIN METAL ELASTIC, the second and third what `asperity law export ... --for lammps` wrote for equal.toml and for elastic.toml.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from lammps import lammps

PLUGIN, METAL, ELASTIC = (Path(word).resolve() for word in sys.argv[1:4])
PAIR, WALL = METAL / "equal.asperity", METAL / "equal-wall.asperity"
ELASTIC_PAIR, ELASTIC_WALL = ELASTIC / "elastic.asperity", ELASTIC / "elastic-wall.asperity"
E = 1000.0
failures = []

HEAD = f"""plugin load {PLUGIN}
units lj
atom_style sphere
comm_modify vel yes
"""


def expect(good, what, value):
    if not good:
        failures.append(what)
    print(f"{what:<78} {value}{'' if good else '   FAILED'}", flush=True)


def quiet():
    return lammps(cmdargs=["-screen", "none", "-log", "none"])


def refuses(commands, words):
    lmp = quiet()
    try:
        lmp.commands_string(HEAD + commands)
        said = "nothing"
    except Exception as error:  # the wheel raises its own class
        said = str(error)
    lmp.close()
    expect(words in said, f"refused: {words[:68]}", "yes" if words in said else said)


def told(script, ranks=1):
    """Runs an input in a process of its own, or in several; its output."""
    with tempfile.TemporaryDirectory() as name:
        Path(name, "in").write_text(HEAD + script)
        command = [str(Path(sys.prefix, "bin", "lmp")), "-in", "in", "-log", "none"]
        if ranks > 1:
            command = [str(Path(sys.prefix, "bin", "mpiexec")), "-n", str(ranks), *command]
        run = subprocess.run(command, cwd=name, capture_output=True, text=True, timeout=600)
        assert run.returncode == 0, run.stdout[-3000:] + run.stderr[-1000:]
        dumps = {path.name: [[float(word) for word in line.split()] for line in path.read_text().split("ITEM: ATOMS")[1].splitlines()[1:]]
                 for path in Path(name).glob("*.dump")}
    return run.stdout, dumps


def dump(name, sort=True):
    """Writes places and forces with all digits."""
    return (f"write_dump all custom {name}.dump id x y z fx fy fz vx vy vz modify {'sort id' if sort else 'sort off'} format float %.17g\n")
