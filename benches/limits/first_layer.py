#!/usr/bin/env python3
"""The thickness of the first layer of elements: the reference case against the limit of 16 and 32 elements throughout.

    cargo build --release && python3 benches/limits/first_layer.py OUT [--meshes 10/20,5/10] [--layers 1,0.85,0.8,0.7,0.5] [--program PATH]

The limit is the table in `tests/references.rs`, to delta_T = 0.003 R. Errors are in per cent of the greatest F_N and F_T, root mean
square / largest; the seconds include the companion. It is what `HALVED_FIRST_LAYER` of `src/case/mod.rs` was chosen by. What was
computed before is taken from OUT. Two minutes of processor time. Standard library only.
"""

import argparse
import json
import math
import re
from pathlib import Path

from measure import ROOT, at, mesh, run

COLUMNS = (("F_N", 2), ("F_T", 1), ("F_T_limit", 1))
# Of the reference case, as in tests/references.rs.
GREATEST = {"F_N": 149.9, "F_T": 30.2, "F_T_limit": 30.2}


def limit():
    """Rows of delta_T, F_T and F_N."""
    table = (ROOT / "tests/references.rs").read_text().split("const LIMIT", 1)[1].split("= [", 1)[1].split("\n    ];", 1)[0]
    return [[float(word) for word in row.split(",")] for row in re.findall(r"\[([\d., ]+)\]", table)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--meshes", default="10/20,5/10")
    parser.add_argument("--layers", default="1,0.85,0.8,0.7,0.5")
    parser.add_argument("--program", default=ROOT / "target/release/asperity")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print("| elements inside / at the surface | first layer | F_N | F_T | F_T_limit | unknowns | Newton iterations | CPU s |")
    print("|---|---|---|---|---|---|---|---|")
    for name in options.meshes.split(","):
        for layer in options.layers.split(","):
            place = options.out / f"{name.replace('/', '-')}-{layer}"
            rows, seconds = run(options.program, place, [*mesh(name), f"mesh.first_layer_thickness={float(layer)}"])
            shear = [row for row in rows if row["segment"] == 1.0]
            cells = []
            for key, column in COLUMNS:
                points = [(row["delta_T"], row[key]) for row in shear if row[key] is not None]
                off = [100.0 * (at(points, row[0]) - row[column]) / GREATEST[key] for row in limit()]
                cells.append(f"{math.sqrt(sum(x * x for x in off) / len(off)):.2f} / {max(map(abs, off)):.2f}")
            found = json.loads((place / "summary.json").read_text())
            print(f"| {name} | {layer} | {' | '.join(cells)} | {found['unknowns']:,} | {found['newton_iterations']} | {seconds:.1f} |",
                  flush=True)


if __name__ == "__main__":
    main()
