"""Twist and roll of contacts (turning yes): energy, torques, restarts, what is refused. Run by run.sh: test_turning.py PLUGIN METAL ELASTIC"""

import sys
import tempfile

from host import E, HEAD, PAIR, expect, failures, quiet, refuses
from test_presses import ACCOUNT, account
from test_walls import EMPTY, LAW, STEP

TURNING = EMPTY.replace("pair_style asperity", "pair_style asperity turning yes")
SPIN = 0.2


def squeezed(turning):
    """A sphere that spins between two walls, which hold it: its spin over that at the start, what its energy balance lacks, and that slip took."""
    lmp = quiet()
    lmp.commands_string(HEAD + EMPTY + ACCOUNT + "create_atoms 1 single 0 0 0.4975 units box\nset group all diameter 1 density 1\n"
                        f"set group all omega 0 0 {SPIN}\nfix floor all wall/asperity 0 0 0 0 0 1 {LAW} turning {turning}\n"
                        f"fix lid all wall/asperity 0 0 0.995 0 0 -1 {LAW} turning {turning}\nfix move all nve/sphere\nrun 0 post no\nrun 1 post no\n")
    start, worst = account(lmp, ["floor", "lid"]), 0.0
    for _ in range(40):
        lmp.command("run 50 post no")
        worst = max(worst, abs(account(lmp, ["floor", "lid"]) - start))
    left, lost = lmp.numpy.extract_atom("omega")[0][2] / SPIN, lmp.extract_fix("floor", 0, 1, 7)
    energy = 0.5 * 0.4 * 0.25 * lmp.numpy.extract_atom("rmass")[0] * SPIN**2
    lmp.close()
    return left, worst / energy, lost


def spinning():
    left, lacks, lost = squeezed("yes")
    expect(left < 0.8 and lost > 0.0, "a sphere that spins between two walls: spin that is left, work of slip", f"{left:.3f} {lost:.1e}")
    expect(lacks < 0.01, "    its energy balance, over the energy of its spin", f"{lacks:.1e}")
    left, _, lost = squeezed("no")
    expect(left == 1.0 and lost == 0.0, "    and with turning no: spin that is left, work of slip", f"{left:.3f} {lost:.1e}")


COLLIDE = ("create_atoms 1 single -0.5005 0 0 units box\ncreate_atoms 1 single 0.5005 0 0 units box\nset group all diameter 1 density 1\n"
           "set atom 1 omega 0.3 0 0.1\nset atom 2 omega -0.1 0 0.1\nset atom 1 vx 0.05\nset atom 2 vx -0.05\nfix move all nve/sphere\n")


def colliding():
    """Two spheres that hit with spin about the line of their centres: what one loses the other gains, and energy closes."""
    found = {}
    for style, box in ("yes", TURNING), ("no", EMPTY):
        lmp = quiet()
        lmp.commands_string(HEAD + box + ACCOUNT + COLLIDE + "run 0 post no\n")
        start = account(lmp, [])
        lmp.command("run 400 post no")
        spins = lmp.numpy.extract_atom("omega")
        found[style] = [float(spins[k][0]) for k in range(2)], (account(lmp, []) - start) / start
        lmp.close()
    (one, other), lacks = found["yes"]
    expect(abs(one + other - 0.2) < 1e-6 and one - other < 0.395, "two spheres hit with spin about their line: both spins", f"{one:.4f} {other:.4f}")
    expect(abs(lacks) < 2e-3, "    energy balance", f"{lacks:.1e}")
    expect(max(abs(a - b) for a, b in zip(found["no"][0], (0.3, -0.1))) < 1e-6, "    and with turning no", f"{found['no'][0]}")


def restarts():
    """To the last bit, with twist and roll; and not with the other choice."""
    with tempfile.TemporaryDirectory() as name:
        rows, file = [], f"{name}/half.restart"
        again = f"read_restart {file}\ncomm_modify vel yes\npair_style asperity turning yes\npair_coeff 1 1 {PAIR} {E}\ntimestep {STEP}\nfix move all nve/sphere\n"
        for commands in TURNING + COLLIDE + f"run 30\nwrite_restart {file}\nrun 20\n", again + "run 20\n":
            lmp = quiet()
            lmp.commands_string(HEAD + commands)
            rows.append([lmp.numpy.extract_atom(what)[:2].copy() for what in ("x", "v", "omega", "torque")])
            lmp.close()
        same = all((a == b).all() for a, b in zip(*rows)) and abs(rows[0][3]).max() > 0.0
        expect(same, "a restart within the contact, to the last bit", "yes" if same else f"{rows}")
        refuses(again.replace("turning yes", "turning no"), "was written with turning yes")


def refused():
    granular = EMPTY.replace("pair_style asperity\n", "pair_style hybrid/overlay asperity turning yes granular\n")
    granular = granular.replace("pair_coeff 1 1 ", "pair_coeff 1 1 granular hooke 1000.0 50.0 tangential linear_nohistory 1.0 0.4\npair_coeff 1 1 asperity ")
    refuses(granular + "create_atoms 1 single 0 0 0 units box\nset group all diameter 1 density 1\nfix move all nve/sphere\nrun 0\n", "would count twice")
    refuses(EMPTY.replace("asperity\n", "asperity turning maybe\n"), "not maybe")


if __name__ == "__main__":
    spinning()
    colliding()
    restarts()
    refused()
    sys.exit(f"{len(failures)} failed: {failures}" if failures else 0)
