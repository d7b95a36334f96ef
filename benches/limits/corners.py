#!/usr/bin/env python3
"""By how much the pressure of single points is off that of the others at their radius.

    asperity run fixtures/cases/ideal.toml --out out && python3 benches/limits/corners.py out/contact/step_0025.csv

Each point's pressure against a straight line in the radius through the points within half a spacing at the surface on either
side, moved to their median. Points nearer to the axis than two spacings, or to the edge than one, are left out. Prints the
worst and the root mean square, in per cent. Standard library only.
"""

import csv
import math
import statistics
import sys

SURFACE = 20  # elements at the surface along the contact radius


def main():
    with open(sys.argv[1], newline="") as table:
        rows = [row for row in csv.DictReader(table) if float(row["pressure"]) > 0]
    places = [(float(row["X"]), float(row["Y"]), float(row["pressure"])) for row in rows]
    points = [(math.hypot(x, y), math.atan2(y, x), pressure) for x, y, pressure in places]
    edge = max(r for r, _, _ in points)
    spacing = edge / SURFACE
    off = []
    for r, angle, pressure in points:
        if not 2 * spacing < r < edge - spacing:
            continue
        near = [(other - r, p) for other, _, p in points if abs(other - r) < spacing / 2]
        middle, mean = (statistics.fmean(column) for column in zip(*near))
        square = sum((x - middle) ** 2 for x, _ in near)
        slope = sum((x - middle) * (p - mean) for x, p in near) / square if square > 0 else 0.0
        line = mean - slope * middle
        median = statistics.median(p - line - slope * x for x, p in near)
        off.append((100 * (pressure / (line + median) - 1), r / edge, math.degrees(angle)))
    for error, r, angle in sorted(off, key=lambda one: -abs(one[0]))[:12]:
        print(f"{error:6.1f} % at {r:.3f} of the radius, {angle:6.1f} degrees")
    print(f"root mean square of {len(off)}: {math.sqrt(statistics.fmean(error * error for error, _, _ in off)):.2f} %")


if __name__ == "__main__":
    main()
