"""Draws docs/spheres.svg: two equal spheres sheared over each other, simulated, by the law, and by Mindlin.

    python3 docs/spheres.py HISTORY.csv SUMMARY.json LAW.csv OUT.svg      (docs/pictures.sh does it)
"""

import csv
import json
import sys

BLUE, RED, GREY, BLACK = "#0072B2", "#D55E00", "#888888", "#222222"
LEFT, RIGHT, TOP, BOTTOM = 62, 738, 66, 372
SLIP_AT, MU, NU, G = 0.006, 0.3, 0.3, 200e3 / 2.6



def symbol(index):
    """F with an index."""
    return f'<tspan font-style="italic">F</tspan><tspan dy="3" font-size="9">{index}</tspan>'


def shear(path):
    """Rows of the shear, its start included: delta_T, F_N, F_T."""
    with open(path) as file:
        rows = [[float(row[name]) for name in ("segment", "delta_T", "F_N", "F_T")] for row in csv.DictReader(file)]
    first = next(index for index, row in enumerate(rows) if row[0] == 1)
    return [row[1:] for row in rows[first - 1 :]]


def main(history, summary, law, out):
    simulated, predicted = shear(history), shear(law)
    with open(summary) as file:
        start = json.load(file)
    f_n, a = start["F_N0"], start["a0"]
    slip = 3 * MU * f_n * (2 - NU) / (8 * G * a)  # of both spheres together
    grid = [index * SLIP_AT / 200 for index in range(201)]
    mindlin = [(delta, MU * f_n * (1 - max(1 - delta / slip, 0) ** 1.5)) for delta in grid]

    top = 180.0
    x = lambda delta: LEFT + (RIGHT - LEFT) * delta / SLIP_AT
    y = lambda force: BOTTOM - (BOTTOM - TOP) * force / top
    inside = lambda points: [point for point in points if point[0] <= SLIP_AT]
    parts = []
    text = lambda at_x, at_y, words, anchor="start", more="": parts.append(
        f'<text x="{at_x:.1f}" y="{at_y:.1f}" dy="0.35em" text-anchor="{anchor}" font-family="sans-serif" font-size="12" fill="{BLACK}"{more}>{words}</text>'
    )
    line = lambda points, colour, dash="": parts.append(
        f'<polyline fill="none" stroke="{colour}" stroke-width="2"{dash} points="'
        + " ".join(f"{x(delta):.2f},{y(force):.2f}" for delta, force in points)
        + '"/>'
    )
    dot = lambda at_x, at_y, colour: parts.append(f'<circle cx="{at_x:.2f}" cy="{at_y:.2f}" r="3" fill="{colour}"/>')
    for force in range(0, 181, 60):
        parts.append(f'<path d="M{LEFT},{y(force):.1f}H{RIGHT}" stroke="#dddddd"/>')
        text(LEFT - 8, y(force), force, "end")
    for index in range(0, 7, 2):
        text(x(index / 1000), BOTTOM + 16, index, "middle")
    parts.append(f'<rect x="{LEFT}" y="{TOP}" width="{RIGHT - LEFT}" height="{BOTTOM - TOP}" fill="none" stroke="{BLACK}"/>')
    dashed = ' stroke-dasharray="6,4"'
    line([(0, f_n), (SLIP_AT, f_n)], GREY, dashed)
    line(mindlin, GREY, dashed)
    line(inside([(row[0], row[1]) for row in predicted]), BLUE)
    line(inside([(row[0], row[2]) for row in predicted]), RED)
    for delta, normal, tangential in inside(simulated):
        dot(x(delta), y(normal), BLUE)
        dot(x(delta), y(tangential), RED)
    text(x(0.0055), y(f_n) - 12, symbol("N"), "middle")
    text(x(0.0055), y(MU * f_n) - 12, symbol("T"), "middle")
    text(400, BOTTOM + 38, "tangential displacement of the centres, 10⁻³ R", "middle")
    text(16, 0.5 * (TOP + BOTTOM), "force (E = 200,000, R = 1)", "middle", f' transform="rotate(270, 16, {0.5 * (TOP + BOTTOM)})"')
    for at, colour in ((62, BLUE), (74, RED)):
        dot(at, 40, colour)
    text(86, 40, "simulation")
    for at, colour in ((200, BLUE), (226, RED)):
        parts.append(f'<path d="M{at},40h20" stroke="{colour}" stroke-width="2"/>')
    text(254, 40, "built-in law")
    parts.append(f'<path d="M380,40h40" stroke="{GREY}" stroke-width="2"{dashed}/>')
    text(428, 40, f"Mindlin, with the simulated {symbol('N')}<tspan dy=\"-3\"> and </tspan><tspan font-style=\"italic\">a</tspan> of the press")
    head = '<svg width="760" height="424" viewBox="0 0 760 424" xmlns="http://www.w3.org/2000/svg">'
    about = "<desc>Forces between two equal spheres over the tangential displacement: simulation, law and Mindlin</desc>"
    background = '<rect width="760" height="424" fill="#FFFFFF"/>'
    with open(out, "w") as file:
        file.write("\n".join([head, about, background, *parts, "</svg>", ""]))


if __name__ == "__main__":
    main(*sys.argv[1:])
