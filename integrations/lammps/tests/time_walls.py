"""Processor time of 512 spheres in a box of planes and of ever finer triangles, 1,000 steps: time_walls.py PLUGIN METAL ELASTIC (by hand; run.sh leaves it out)"""

import tempfile
import time

from host import E, HEAD, PAIR, quiet
from meshes import binary_stl, quad
from test_walls import LAW

FACES = (((0, 0, 0), (8, 0, 0), (0, 8, 0)), ((0, 0, 0), (8, 0, 0), (0, 0, 10)), ((0, 8, 0), (8, 0, 0), (0, 0, 10)), ((0, 0, 0), (0, 8, 0), (0, 0, 10)), ((8, 0, 0), (0, 8, 0), (0, 0, 10)))
PLANES = ((0, 0, 0, 0, 0, 1), (0, 0, 0, 1, 0, 0), (8, 0, 0, -1, 0, 0), (0, 0, 0, 0, 1, 0), (0, 8, 0, 0, -1, 0))


def squares(count):
    """The faces of the box, each of count x count squares."""
    place = lambda face, i, j: tuple(face[0][d] + face[1][d] * i / count + face[2][d] * j / count for d in range(3))
    return [facet for face in FACES for i in range(count) for j in range(count) for facet in quad(place(face, i, j), place(face, i + 1, j), place(face, i + 1, j + 1), place(face, i, j + 1))]


with tempfile.TemporaryDirectory() as name:
    for count in (0, 1, 10, 100):
        walls = "".join(f"fix w{k} all wall/asperity {' '.join(map(str, face))} {LAW}\n" for k, face in enumerate(PLANES))
        if count:
            walls = f"fix box all wall/asperity stl {binary_stl(f'{name}/box.stl', squares(count))} {LAW}\n"
        lmp = quiet()
        lmp.commands_string(HEAD + "boundary f f f\nregion box block -1 9 -1 9 -1 12\ncreate_box 1 box\npair_style asperity\n" + f"pair_coeff 1 1 {PAIR} {E}\ntimestep 0.001\n"
                            "lattice sc 1.0 origin 0.5 0.5 0.5\nregion bed block 0 8 0 8 0 8 units box\ncreate_atoms 1 region bed\nset group all diameter 1.0 density 1.0\n"
                            f"velocity all create 0.02 87287 loop geom\n{walls}fix lid all wall/asperity 0 0 8 0 0 -1 {LAW} velocity 0 0 -0.5\nfix move all nve/sphere\nneighbor 0.2 bin\nrun 0\n")
        start = time.process_time()
        lmp.command("run 1000")
        print(f"{10 * count * count or 'no':>7} facets: {time.process_time() - start:.2f} s", flush=True)
        lmp.close()
