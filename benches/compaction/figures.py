"""Picture and tables of the compactions: figures.py OUT [CELLS.csv]. Reads OUT/press.json; writes OUT/dense.svg and prints the tables of README.md."""

import csv
import json
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "dense"
import matplotlib.pyplot as plt
import numpy as np

HERE = Path(__file__).resolve().parent
NAMES = {"asperity": "this law", "mdr": "MDR, psi_b = 0.5", "mdr-0.1": "MDR, psi_b = 0.1"}
COLOURS = {"asperity": "C0", "mdr": "C3", "mdr-0.1": "C1"}
TOLD = ("0.70", "0.75", "0.80", "0.85", "0.90", "0.95")
# Neighbours, and volume of the cell over the cube of half the distance of neighbours.
CELLS = {"sc": (6, 8.0), "bcc": (8, 32 / (3 * math.sqrt(3))), "fcc": (12, 4 * math.sqrt(2))}
LOOSE = 0.64  # relative density of a random dense packing, from which the analytical curve starts


def isolated(density, first=LOOSE):
    """Pressure over sigma_Y of a random packing of ideally plastic spheres whose contacts do not know of each other.

    Helle, Easterling & Ashby, Acta Metall. 33 (1985) 2163, after Arzt, Acta Metall. 30 (1982) 1883: 12 D contacts a sphere, each of the area
    pi R^2 (D - D0)/(3 (1 - D0)) under 3 sigma_Y, and p = D Z F/(4 pi R^2).
    """
    return 3 * density**2 * (density - first) / (1 - first)


def voids(density):
    """The same of what is left of the pores, each a hollow sphere of ideally plastic material: Helle, Easterling & Ashby's second stage."""
    return 2 / 3 * np.log(1 / (1 - density))


def fe_cells(file):
    cells = {}
    for row in csv.DictReader(open(file)):
        cells.setdefault((row["material"], row["packing"]), []).append((float(row["density"]), float(row["pressure"]), float(row["h"])))
    return {key: np.array(rows) for key, rows in cells.items()}


def conserving(law, packing, density):
    """Pressure of the pairwise law if each sphere grew by the volume that its neighbours cut off, as MDR's do; and that radius.

    `law`: rows of the simple cubic packing, of which the force of one contact is read: F = 4 d^2 p.
    """
    neighbours, cell = CELLS[packing]
    d = (4 * math.pi / 3 / (cell * density)) ** (1 / 3)
    low, high = d, d / (1 - 2 / neighbours)  # beyond, growth is cut off faster than it adds
    for _ in range(60):
        r = 0.5 * (low + high)
        kept = 4 * math.pi / 3 * r**3 - neighbours * math.pi / 3 * (r - d) ** 2 * (2 * r + d)
        low, high = (r, high) if kept < 4 * math.pi / 3 else (low, r)
    distance = (4 * math.pi / 3 / (8 * law[:, 0])) ** (1 / 3)
    force = np.interp((r - d) / r, 1 - distance, 4 * distance**2 * law[:, 1])
    return neighbours * force * r**2 * d / (3 * cell * d**3), r


def picture(results, cells, file):
    figure, (a, b) = plt.subplots(1, 2, figsize=(10, 4.6))
    packed = [entry for entry in results if entry["material"] == "metal" and entry["shape"] in ("triaxial", "die")]
    for entry in packed:
        rows, die = np.array(entry["rows"]), entry["shape"] == "die"
        a.plot(rows[:, 0], rows[:, 1], "--" if die else "-", color=COLOURS[entry["law"]], linewidth=1.2,
                   label=f"{NAMES[entry['law']]}, {'die' if die else 'six walls'}")
    d = np.linspace(LOOSE, 0.95, 100)
    a.plot(d, isolated(d), color="0.4", linewidth=1, label="Helle, Easterling & Ashby 1985: isolated contacts")
    a.plot(d[d > 0.9], voids(d[d > 0.9]), ":", color="0.4", linewidth=1.4, label="the same: isolated pores")
    a.axvline(0.8, color="0.8", linewidth=1, zorder=0)
    a.text(0.806, 0.05, "limit of pairwise DEM after\nHarthong et al. 2009", fontsize=7, color="0.4")
    a.set_title(f"{packed[0]['spheres'] if packed else 0} spheres, mu = 0.1", fontsize=10)
    shades = {"sc": "C2", "bcc": "C4", "fcc": "C5"}
    for packing, shade in shades.items():
        fe = cells.get(("metal", packing))
        if fe is not None:
            b.plot(fe[:, 0], fe[:, 1], "o", color=shade, markersize=3, label=f"{packing}, finite elements")
        for entry in results:
            if entry["material"] == "metal" and entry["shape"] == packing:
                rows = np.array(entry["rows"])
                b.plot(rows[:, 0], rows[:, 1], {"asperity": "-", "mdr": ":", "mdr-0.1": "--"}[entry["law"]], color=shade, linewidth=1.2,
                       label=f"{packing}, {NAMES[entry['law']]}")
    b.set_title("cubic packings under all-round pressure, no friction", fontsize=10)
    for axes in (a, b):
        axes.set_xlim(0.52, 0.96)
        axes.set_ylim(0, 2.5)
        axes.set_xlabel("relative density")
        axes.set_ylabel("pressure over sigma_Y")
        axes.legend(fontsize=6.5, frameon=False, loc="upper left")
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def table(head, rows):
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def main():
    out = Path(sys.argv[1])
    results = json.loads((out / "press.json").read_text())
    cells = fe_cells(sys.argv[2] if len(sys.argv) > 2 else HERE / "cells.csv")
    picture(results, cells, out / "dense.svg")
    packed = [entry for entry in results if entry["shape"] in ("triaxial", "die")]
    print("Pressure over sigma_Y\n")
    table(["material", "shape", "law", *TOLD, "stopped at", "energy", "CPU s"],
          [[e["material"], e["shape"], NAMES[e["law"]], *(f"{e['pressure'][d]:.2f}" if d in e["pressure"] else "" for d in TOLD),
            f"{e['last']:.2f}" if e["failed"] else "", f"{e['energy']:.0e}" if e["energy"] else "", f"{e['seconds']:.0f}"] for e in packed])
    print("Contacts of this law\n")
    rows = []
    for e in packed:
        if e["law"] != "asperity":
            continue
        for name, key, form in (("contacts a sphere", "per_sphere", "{:.1f}"), ("mean h/R", "mean", "{:.3f}"), ("deepest h/R", "worst", "{:.2f}"),
                                ("beyond h/R = 0.15", "beyond", "{:.0%}"), ("through a third sphere", "obstructed", "{:.1%}"), ("volume counted twice", "cut_off", "{:.1%}")):
            rows.append([e["material"], e["shape"], name, *(form.format(e["contacts"][d][key]) if d in e["contacts"] else "" for d in TOLD)])
    table(["material", "shape", "", *TOLD], rows)
    print("Cubic packings: pressure of the finite elements over sigma_Y, errors of the laws in per cent\n")
    rows, fails = [], []
    for (material, packing), fe in cells.items():
        laws = {e["law"]: np.array(e["rows"]) for e in results if e["material"] == material and e["shape"] == packing}
        simple = next((np.array(e["rows"]) for e in results if e["material"] == material and e["shape"] == "sc" and e["law"] == "asperity"), None)
        if packing not in CELLS or simple is None or not set(NAMES) <= set(laws):
            continue
        marks = [d for d in (0.60, 0.65, 0.70, 0.75, 0.80, 0.85, 0.90, 0.95) if fe[0, 0] + 0.01 < d <= fe[-1, 0]]
        for d in marks:
            truth = float(np.interp(d, fe[:, 0], fe[:, 1]))
            error = lambda value: f"{100 * (value / truth - 1):+.0f}"
            rows.append([material, packing, f"{d:.2f}", f"{np.interp(d, fe[:, 0], fe[:, 2]):.3f}", f"{truth:.2f}",
                         *(error(np.interp(d, laws[law][:, 0], laws[law][:, 1])) for law in NAMES), error(conserving(simple, packing, d)[0])])
        law = laws["asperity"]
        gap = np.interp(fe[:, 0], law[:, 0], law[:, 1]) / fe[:, 1] - 1
        for limit in (0.1, 0.2, 0.3):
            # From where on it stays that far below: single nodes make the curve uneven.
            within = np.where(gap > -limit)[0]
            k = within[-1] + 1 if len(within) else 0
            if k < len(fe):
                fails.append([material, packing, f"{limit:.0%}", f"{fe[k, 0]:.3f}", f"{fe[k, 2]:.3f}", f"{fe[k, 1]:.2f}"])
    table(["material", "packing", "D", "h/R", "finite elements", *NAMES.values(), "this law, grown spheres"], rows)
    print("From where on the pairwise law stays too low\n")
    table(["material", "packing", "by", "D", "h/R", "pressure over sigma_Y"], fails)


if __name__ == "__main__":
    main()
