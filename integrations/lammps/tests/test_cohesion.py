"""Cohesion (cohesion W [range Z]): pull-off, energy, restarts, neighbours, walls, what is refused. Run by run.sh: test_cohesion.py PLUGIN METAL ELASTIC"""

import math
import sys
import tempfile

from host import E, ELASTIC_PAIR, ELASTIC_WALL, HEAD, PAIR, WALL, dump, expect, failures, quiet, refuses, told

W, REDUCED = 1e-3, 0.25    # work of adhesion; R* of two spheres of the diameter 1
JKR = 1.5 * math.pi * W
# Where an elastic pair lets go: a^3 = pi w R*^2/(8 E*), h = -3 a^2/R*.
GAP = 3.0 * (math.pi * W * REDUCED**2 / 8.0 / (0.5 * E / 0.91)) ** (2.0 / 3.0) / REDUCED
STEP = 1e-3
ACCOUNT = "compute speeds all ke\ncompute spins all erotate/sphere\ncompute pairs all pair asperity\nthermo_style custom step pe c_speeds c_spins c_pairs[1]\nthermo_modify norm no\n"


def box(words, table=ELASTIC_PAIR, skin="0.3"):
    return (f"boundary f f f\nregion box block -10 10 -10 10 -10 10\ncreate_box 1 box\npair_style asperity\npair_coeff 1 1 {table} {E} {words}\n"
            f"timestep {STEP}\nneighbor {skin} bin\nneigh_modify every 1 delay 0 check no\n")


def spheres(distance):
    return f"create_atoms 1 single 0 0 0 units box\ncreate_atoms 1 single {distance:.17g} 0 0 units box\nset group all diameter 1 density 1\n"


def pulled(words, table=ELASTIC_PAIR, depth=0.0, skin="0.3"):
    """Two spheres pressed to a depth and drawn apart: the greatest pull, the gap at which they let go, the force at the depth, what cohesion lost."""
    lmp, speed, least, gap = quiet(), GAP / 200 / STEP, 0.0, 0.0
    lmp.commands_string(HEAD + box(words, table, skin) + ACCOUNT + spheres(1.0 - depth + 2e-5) + "fix move all nve/noforce\n")
    lmp.commands_string("velocity all set 0 0 0\ngroup right id 2\n" f"velocity right set {-speed} 0 0\nrun {math.ceil(2e-5 / (speed * STEP)) + 1} post no\n")
    force = lmp.numpy.extract_atom("f")[1][0]
    lmp.command(f"velocity right set {speed} 0 0")
    for _ in range(2000):
        lmp.command("run 1 pre no post no")
        now = lmp.numpy.extract_atom("f")[1][0]
        least = min(least, now)
        distance = lmp.numpy.extract_atom("x")[1][0] - lmp.numpy.extract_atom("x")[0][0]
        if now < 0.0:
            gap = distance - 1.0
        elif distance > 1.0 + 2.0 * GAP:
            break
    lost = lmp.numpy.extract_compute("pairs", 0, 1)[4]
    lmp.close()
    return -least, gap, force, lost


def pulls_off():
    pull, gap, _, lost = pulled(f"cohesion {W}")
    expect(abs(pull / (JKR * REDUCED) - 1.0) < 0.05, "two elastic spheres drawn apart: pull over 1.5 pi w R*", f"{pull / (JKR * REDUCED):.4f}")
    expect(abs(gap / GAP - 1.0) < 0.02 and lost > 0.0, "    gap at which they let go over that of Johnson, Kendall and Roberts", f"{gap / GAP:.4f}")
    same = pulled(f"cohesion {W}", skin="0.0")
    expect(same[:2] == (pull, gap) and abs(same[3] / lost - 1.0) < 1e-9, "    the same where the neighbour list has no skin", "yes" if same[:2] == (pull, gap) else f"{same} {pull} {gap} {lost}")
    reach = 0.5 * GAP
    far, gap, _, lost = pulled(f"cohesion {W} range {reach}")
    expect(abs(far / (2.0 * math.pi * W * REDUCED) - 1.0) < 0.05, "    with a range: pull over 2 pi w R*", f"{far / (2.0 * math.pi * W * REDUCED):.4f}")
    expect(abs(gap / reach - 1.0) < 0.02, "    gap at which it ends over the range", f"{gap / reach:.4f}")
    flat, _, pressed, _ = pulled(f"cohesion {W}", PAIR, 0.002)
    alone = pulled("", PAIR, 0.002)
    expect(flat > 1.2 * pull and abs(pressed / alone[2] - 1.0) < 1e-9, "two metal spheres, pressed: pull over that of elastic ones; force of the press",
           f"{flat / pull:.2f}, as without cohesion")
    expect(pulled("cohesion 0", PAIR, 0.002) == alone and alone[0] == 0.0, "cohesion 0 is none, to the last bit", "yes")


def on_a_wall():
    """A sphere that hangs from a wall: its weight is borne up to 1.5 pi w R."""
    for share, holds in (0.9, True), (1.1, False):
        lmp, radius = quiet(), 0.5
        weight = share * JKR * radius
        mass = 4.0 / 3.0 * math.pi * radius**3
        lmp.commands_string(HEAD + box(f"cohesion {W}") + ACCOUNT + f"create_atoms 1 single 0 0 -0.49999 units box\nset group all diameter 1 density 1\n"
                            f"fix lid all wall/asperity 0 0 0 0 0 -1 type 1 {ELASTIC_WALL} {E} cohesion {W}\nfix move all nve/sphere\nfix drag all viscous 5\n"
                            f"fix pull all addforce 0 0 v_weight\nvariable weight equal -{weight}*((step<8000)*step/8000+(step>=8000))\nrun 12000 post no\n")
        told = lmp.extract_fix("lid", 0, 1, 2)
        stays = told < -0.5 * weight
        expect(stays == holds and (not holds or abs(told / -weight - 1.0) < 0.02), f"a sphere of {share} times the pull-off under a wall",
               f"{'hangs' if stays else 'falls'}, force on the wall over its weight {-told / weight:.3f}")
        lost = lmp.extract_fix("lid", 0, 1, 19)
        expect(lost > 0.0 if not holds else math.isfinite(lost), "    work that cohesion has dissipated at the wall", f"{lost:.1e}")
        lmp.close()


CATCH = "set atom 2 vx {speed}\nset atom 2 vy 0.0001\nfix move all nve/sphere\n"


def energy():
    """Two spheres meet slowly, and stay; what they had is in the account."""
    for words, table, name, apart, speed in ((f"cohesion {W}", ELASTIC_PAIR, "elastic", 1e-5, 5e-4), (f"cohesion {W}", PAIR, "metal", 1e-5, 4e-3),
                                             (f"cohesion {W} range {GAP}", PAIR, "with a range", 1.5 * GAP, 4e-3)):
        lmp, worst = quiet(), 0.0
        lmp.commands_string(HEAD + box(words + " restitution 0.8", table) + ACCOUNT + spheres(1.0 + apart) + "timestep 2e-4\n" + CATCH.format(speed=-speed) + "run 0 post no\n")

        def account():
            kept = sum(lmp.numpy.extract_compute("pairs", 0, 1)[k] for k in (0, 1, 2, 4))
            return lmp.extract_compute("speeds", 0, 0) + lmp.extract_compute("spins", 0, 0) + lmp.get_thermo("pe") + kept

        start = account()
        for _ in range(60):
            lmp.command("run 100 post no")
            worst = max(worst, abs(account() - start))
        x = lmp.numpy.extract_atom("x")
        lost, stored = lmp.numpy.extract_compute("pairs", 0, 1)[4], lmp.get_thermo("pe")
        stays = x[1][0] - x[0][0] < 1.0 + GAP and stored < 0.0
        expect(stays and worst < 0.01 * (abs(lost) + abs(stored) + start), f"two spheres meet and stay ({name}): energy balance over what there was", f"{worst / (abs(lost) + abs(stored) + start):.1e}")
        lmp.close()


def restarts():
    """To the last bit, of spheres that hold each other over a gap; with other cohesion refused."""
    with tempfile.TemporaryDirectory() as name:
        rows, file = [], f"{name}/half.restart"
        setup = box(f"cohesion {W}") + spheres(1.0 - 1e-6)
        move = f"group right id 2\nvelocity right set {GAP / 400 / STEP} 0 0\nfix move all nve/noforce\n"
        again = f"read_restart {file}\ncomm_modify vel yes\npair_style asperity\npair_coeff 1 1 {ELASTIC_PAIR} {E} cohesion {W}\ntimestep {STEP}\nfix move all nve/noforce\n"
        for commands in setup + move + f"run 250\nwrite_restart {file}\nrun 50\n", again + "run 50\n":
            lmp = quiet()
            lmp.commands_string(HEAD + commands)
            rows.append([lmp.numpy.extract_atom(what)[:2].copy() for what in ("x", "v", "f")])
            lmp.close()
        gap = rows[0][0][1][0] - rows[0][0][0][0] - 1.0
        same = all((a == b).all() for a, b in zip(*rows)) and rows[0][2][1][0] < 0.0 < gap
        expect(same, "a restart of spheres that hold each other over a gap, to the last bit", "yes" if same else f"{rows}")
        refuses(again.replace(f"cohesion {W}", f"cohesion {2 * W}") + "run 0\n", "and the restart file was written with")
        refuses(again.replace(f"cohesion {W}", "") + "run 0\n", "and the restart file was written with")


def ranks():
    """A heap of spheres that hold each other, on two ranks as on one."""
    script = (box(f"cohesion {W} restitution 0.8", PAIR) + "lattice sc 0.999\nregion in block -1.5 1.5 -1.5 1.5 -1.5 1.5 units box\ncreate_atoms 1 region in\n"
              "set group all diameter 0.999 density 1\nvelocity all create 1e-6 87287 loop geom\nfix move all nve/sphere\nrun 400\n" + dump("end"))
    one, two = (told(script, count)[1]["end.dump"] for count in (1, 2))
    size = max(abs(v) for row in one for v in row[4:7])
    worst = max(abs(a - b) for p, q in zip(one, two) for a, b in zip(p[4:7], q[4:7])) / size
    expect(len(one) > 20 and size > 0.0 and worst < 1e-9, f"{len(one)} spheres that hold each other, on 2 ranks and on 1: forces", f"{worst:.1e}")


def refused():
    make = spheres(2.0) + "fix move all nve/sphere\nrun 0\n"
    refuses(box("cohesion -1") + make, "a cohesion of -1 is not 0 or more")
    refuses(box("range 1") + make, "say cohesion W before it")
    refuses(box("cohesion 1 range -1") + make, "a range of -1 is not 0 or more")
    wall = f"fix lid all wall/asperity 0 0 0 0 0 -1 type 1 {WALL} {E} cohesion"
    refuses(box("") + spheres(2.0) + wall + "\n", "unknown word cohesion")
    refuses(box("") + spheres(2.0) + wall + " nothing\n", "nothing")


if __name__ == "__main__":
    pulls_off()
    on_a_wall()
    energy()
    restarts()
    ranks()
    refused()
    sys.exit(f"{len(failures)} failed: {failures}" if failures else 0)
