#!/usr/bin/env python3
"""What a contact does that is twisted and rolled: stiffnesses, limits and losses, as a table.

    python3 benches/turning/measure.py OUT [--elements 8] [--program target/release/asperity]

An elastic contact, one that has just yielded and two deep ones are pressed onto a plane, with three
coefficients of friction, and then
  - twisted, with F_N held, until the moment rises no more: stiffness over 16/3 G a^3 and limit over that
    of Hertz's pressure, 3 pi/16 mu F_N a (uniform pressure: 1.13);
  - sheared by 1.5 of Cattaneo's slip displacements and twisted from there, and twisted first and sheared then: what is
    left of F_T, and of M_twist;
  - rolled by three contact radii and back, with F_N held: M_roll and F_T at the end of the way forth,
    the work that is lost over the way, and how much deeper the sphere lies.
Moments are over F_N a, forces over F_N. What is there already is not computed again.
"""

import math

from runs import HELD, E, arguments, case, parsed, rows, segment

NU = 0.3
G = E / (2 * (1 + NU))
CONTACTS = [  # name, hardening, h
    ("elastic", 'law = "elastic"', 0.002),
    ("just yielding", 'law = "ideal"\nyield_stress = 2000.0', 0.002),
    ("deep", 'law = "ideal"\nyield_stress = 400.0', 0.01),
    ("deep, hardening", 'law = "linear"\nyield_stress = 400.0\nmodulus = 4000.0', 0.01),
]
FRICTIONS = [0.1, 0.3, 0.6]


def contact(args, number, name, hardening, h, friction):
    """One line of the table."""
    label = f"c{number}-{friction}"
    mesh = f"elements_per_contact_radius = {args.elements}"
    make = lambda kind, path: rows(args, f"{label}-{kind}", case(hardening, friction, mesh, path))
    press = [f"indentation = {h}"]
    pressed = segment(make("press", [press]), 0)[-1]
    a, f_n = pressed["a"], pressed["F_N"]
    # Angles at which all slips: a few times Lubkin's scale mu F_N/(G a^2).
    angle = 12 * friction * f_n / (G * a * a)
    twist = segment(make("twist", [press, [f"twist = {angle}", HELD]]), 1)
    stiffness = twist[1]["M_twist"] / twist[1]["twist"] / (16 / 3 * G * a**3)
    limit = max(row["M_twist"] / (3 * math.pi / 16 * friction * row["F_N"] * row["a"]) for row in twist)
    slip = 3 * friction * f_n * (2 - NU) / (16 * G * a)
    both = make("both", [press, [f"shear = {1.5 * slip}", HELD], [f"twist = {angle}", HELD]])
    before, after = segment(both, 1)[-1], segment(both, 2)[-1]
    kept = after["F_T"] / before["F_T"]
    other = make("other", [press, [f"twist = {angle}", HELD], [f"shear = {4 * slip}", HELD]])
    lost = segment(other, 2)[-1]["M_twist"] / segment(other, 2)[0]["M_twist"]
    way = 3 * a
    roll = make("roll", [press, [f"roll = {way}", HELD], ["roll = 0.0", HELD]])
    forth, back = segment(roll, 1), segment(roll, 2)
    work = forth[-1]["work_plastic"] + forth[-1]["work_friction"] - forth[0]["work_plastic"] - forth[0]["work_friction"]
    again = back[-1]["work_plastic"] + back[-1]["work_friction"] - back[0]["work_plastic"] - back[0]["work_friction"]
    end = forth[-1]
    return [
        name,
        f"{friction}",
        f"{a:.4f}",
        f"{stiffness:.2f}",
        f"{limit:.2f}",
        f"{kept:.2f}",
        f"{lost:.2f}",
        f"{end['M_roll_y'] / (end['F_N'] * end['a']):.3f}",
        f"{end['F_T'] / end['F_N']:.3f}",
        f"{work / (f_n * way):.4f}",
        f"{again / (f_n * way):.4f}",
        f"{(end['h'] - pressed['h']) / pressed['h']:+.2f}",
    ]


def main():
    parser = arguments(__doc__, out="needed")
    parser.add_argument("--elements", type=int, default=8)
    args = parsed(parser)
    head = "contact,mu,a/R,k_twist,M_twist limit,F_T kept,M_twist kept,M_roll,F_T,loss forth,loss back,deeper"
    print("| " + " | ".join(head.split(",")) + " |\n" + "|---" * 12 + "|")
    for number, (name, hardening, h) in enumerate(CONTACTS):
        for friction in FRICTIONS:
            print("| " + " | ".join(contact(args, number, name, hardening, h, friction)) + " |", flush=True)


if __name__ == "__main__":
    main()
