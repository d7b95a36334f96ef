#!/usr/bin/env python3
"""HINT_SHORT of src/contact_law/hint.rs: up to what length of a step Newton's method begins by the hint.

    python3 benches/law/fit_hint.py [PROGRAM]

Random paths of the built-in law of two spheres (fixtures/cases/equal.toml), in steps from a hundredth to several times the
displacement to full slip, are followed with several values of HINT_SHORT; 0 is without hints. For each size of the steps prints
how many evaluations a plastic step takes, and of 10,000 plastic steps how many have forces that are off by more than 1e-9 of F_N
from those without a hint from the same memory. The choice is the largest value that changes hardly any step but coarse ones.
PROGRAM: the `asperity` to ask, target/debug/asperity unless given. Needs gcc; a minute.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
LENGTHS = [0.0, 0.03, 0.06, 0.12, 0.24, 1e9]
SIZES = [1e-6, 1e-5, 5e-5, 2e-4]
BODY = """
#include "asperity_contact.h"
static unsigned seed = 11;
static double drawn(void) { seed = seed * 1664525u + 1013904223u; return (seed >> 8) / 16777216.0; }
int main(int argc, char **argv) {
    static asperity_table table;
    long steps = 0, tries = 0, off = 0;
    double size = atof(argv[2]);
    int contact, k;
    if (argc != 3 || asperity_read_table(argv[1], &table) != 0) return 2;
    for (contact = 0; contact < 200; contact++) {
        asperity_state state;
        double h = 0.002, x = 0.0, y = 0.0;
        memset(&state, 0, sizeof state);
        for (k = 0; k < 400; k++) {
            asperity_state next, bare = state, unused;
            asperity_response out, plain;
            asperity_real d[2];
            long before;
            if (k % 80 == 0) { x = 2.0 * (drawn() - 0.5); y = 2.0 * (drawn() - 0.5); }
            h += (drawn() - 0.2) * size;
            d[0] = x * size;
            d[1] = y * size;
            before = asperity_tries;
            asperity_update(&table, 1.0, 1.0, &state, h, d, &next, &out, NULL);
            if (next.hardened > state.hardened && k > 0) {
                steps++;
                tries += asperity_tries - before;
                memset(bare.hint, 0, sizeof bare.hint);
                asperity_update(&table, 1.0, 1.0, &bare, h, d, &unused, &plain, NULL);
                off += !(fabs(out.f_n - plain.f_n) + fabs(out.f_t[0] - plain.f_t[0]) + fabs(out.f_t[1] - plain.f_t[1]) < 1e-9 * plain.f_n);
            }
            state = next;
        }
    }
    printf("%.2f %.1f\\n", (double)tries / steps, 1e4 * off / steps);
    return 0;
}
"""
EVALUATE = "asperity_m asperity_evaluate(const asperity_step *p, asperity_v y, const asperity_v r[2], asperity_guess *ASPERITY_ALONE o) {\n"
DECLARED = "    asperity_m touches = asperity_yield("


def measured(folder, header, length):
    """Evaluations a plastic step and steps that differ, for each size."""
    header, count = re.subn(r"(#define ASPERITY_HINT_SHORT) \S+", rf"\1 {length}", header)
    assert count == 1
    assert header.count(EVALUATE + DECLARED) == 2, "asperity_evaluate has changed"
    header = header.replace(EVALUATE + DECLARED, EVALUATE + "    asperity_m touches = (asperity_tries++, 1) ? asperity_yield(", 1)
    header = re.sub(r"(asperity_tries\+\+, 1\) \? asperity_yield\(p, y, r, o\))", r"\1 : 0", header)
    (folder / "asperity_contact.h").write_text("static long asperity_tries;\n" + header)
    (folder / "hint.c").write_text("#include <stdlib.h>\n" + BODY)
    program = folder / "hint"
    subprocess.run(["gcc", "-std=c99", "-O2", "-march=native", f"-I{folder}", folder / "hint.c", "-o", program, "-lm"], check=True)
    table = folder / "equal.asperity"
    return [subprocess.run([program, table, str(size)], check=True, capture_output=True, text=True).stdout.split() for size in SIZES]


def main():
    asperity = sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/debug/asperity"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        case = ROOT / "fixtures/cases/equal.toml"
        subprocess.run([asperity, "law", "export", "built-in", case, "--for", "c", "--out", folder], check=True, capture_output=True)
        header = (folder / "asperity_contact.h").read_text()
        print("| HINT_SHORT | " + " | ".join(f"steps of {size:g} R: evaluations, off" for size in SIZES) + " |")
        print("|---" * (1 + len(SIZES)) + "|")
        for length in LENGTHS:
            print(f"| {length:g} | " + " | ".join(f"{tries}, {off}" for tries, off in measured(folder, header, length)) + " |")


if __name__ == "__main__":
    main()
