#!/usr/bin/env python3
"""How much F_N(h) of a press ripples as points of the surface come into contact one after another.

    cargo build --release && python3 benches/limits/ripple.py OUT [--meshes 5/10,10/20] [--program PATH]
    python3 benches/constants/constants.py SPREAD && python3 benches/limits/ripple.py OUT --spreads 0.25,0.5,1

Three contacts (ideal, linear, power law) are pressed on each mesh, 8/16 with 16 elements at the surface and 8 inside. A row has,
for each mesh, mean and greatest of the three: F_N over its own parabola in ln h through the last twelve steps, greatest less least,
in per cent. With `--spreads` the rows are of other values of `Layout::spread` (crates/kernels/src/mesh/sphere/layout.rs), by the
program that constants.py makes and that reads it from a variable. What was computed before is taken from OUT. Standard library
only.
"""

import argparse
import statistics
import sys
from pathlib import Path

from judge import LAW, peak_to_peak
from measure import H, MU, ROOT, mesh, run

sys.path.append(str(ROOT / "benches/constants"))
from constants import PLACE, called  # noqa: E402

CONTACTS = [
    [],
    [LAW + '{law="linear",yield_stress=400.0,modulus=2000.0}', f"{H}=0.013"],
    [LAW + '{law="power",yield_stress=300.0,coefficient=1000.0,exponent=0.4}', f"{MU}=0.15", f"{H}=0.033"],
]
MESHES = "4,4/8,5/10,6,6/12,8,7/14,8/16,9/18,10/20,12,12/24"
# The program that reads the spread from a variable.
VARIABLE = PLACE / "build/release/constants"
# A shear has to be there for the case; the least of one.
SHORT = ["solver.error_estimate=false", "path.1.shear=1e-6"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--meshes", default=MESHES)
    parser.add_argument("--spreads", help="values of Layout::spread")
    parser.add_argument("--program", default=ROOT / "target/release/asperity")
    options = parser.parse_args()
    if options.spreads and not VARIABLE.exists():
        raise SystemExit(f"{VARIABLE} is not there: the first command above makes it")
    meshes = options.meshes.split(",")
    print(f"| spread | {' | '.join(meshes)} |\n{'|---' * (len(meshes) + 1)}|")
    for spread in options.spreads.split(",") if options.spreads else ["as it is"]:
        cells = []
        for name in meshes:
            found = []
            for i, contact in enumerate(CONTACTS):
                out = options.out / spread.replace(" ", "-") / f"{i}-{name.replace('/', '-')}"
                if not options.spreads:
                    rows, _ = run(options.program, out, [*contact, *SHORT, *mesh(name)])
                else:
                    rows = with_spread(spread, out, [*contact, *SHORT, *mesh(name)])
                found.append(peak_to_peak(rows))
            cells.append(f"{statistics.fmean(found):.2f} / {max(found):.2f}")
        print(f"| {spread} | {' | '.join(cells)} |", flush=True)


def with_spread(spread, out, settings):
    """The rows of a run with another spread; computed unless they are there."""
    if not (out / "summary.json").exists():
        ended = called(VARIABLE, "run", out, [*settings, "output.plots=false", "output.fields=none"], {"SPREAD": spread})
        if ended.returncode:
            raise SystemExit(f"{out}: {ended.stderr}")
    return run(None, out, [])[0]


if __name__ == "__main__":
    main()
