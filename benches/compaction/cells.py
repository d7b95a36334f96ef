"""Cubic packings by finite elements: runs the program made of cells.c and thins what it prints to cells.csv.

cells.py PROGRAM OUT.csv [--elements N] [--speed V] [--packings ...] [--materials ...]
"""

import argparse
import csv
import io
import subprocess
import sys

# E/sigma_Y of the materials of press.py.
RATIOS = {"metal": 500, "soft": 20}
WIDTH = 0.004  # of h/R, over which the steps are averaged that single nodes make as they come into contact


def thinned(text, packing):
    rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(io.StringIO(text)) if None not in row.values()]
    h, out = 0.005, []
    while rows and h <= rows[-1]["h"]:
        near = [row for row in rows if abs(row["h"] - h) <= min(WIDTH, rows[-1]["h"] - h + 1e-3)]
        if near:
            mean = {key: sum(row[key] for row in near) / len(near) for key in ("h", "density", "pressure")}
            out.append((f"{mean['h']:.5f}", f"{mean['density']:.5f}", f"{mean['pressure']:.4f}"))
        h += 0.0025
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--elements", type=int, default=12, help="along an edge of each of the four blocks of an eighth of the sphere")
    parser.add_argument("--speed", type=float, default=0.002, help="of the planes, over the wave's")
    parser.add_argument("--packings", nargs="*", default=["sc", "bcc", "fcc"])
    parser.add_argument("--materials", nargs="*", default=list(RATIOS))
    args = parser.parse_args()
    with open(args.out, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["material", "packing", "h", "density", "pressure"])
        for material in args.materials:
            for packing in args.packings:
                words = [args.program, packing, str(args.elements), str(1 / RATIOS[material]), str(args.speed), "0.85" if packing == "pair" else "0.96"]
                done = subprocess.run(words, capture_output=True, text=True)
                # A mesh that gives way at the end leaves what came before.
                print(material, done.stderr.strip(), file=sys.stderr, flush=True)
                writer.writerows((material, packing, *row) for row in thinned(done.stdout, packing))
                file.flush()


if __name__ == "__main__":
    main()
