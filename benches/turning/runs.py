"""Case files of the comparisons in this folder, and the histories that they leave. Standard library only."""

import argparse
import csv
import math
import pathlib
import subprocess

E = 200e3
HELD = 'hold = "normal-force"'


def arguments(text, out="optional"):
    """The arguments that all have: the folder of the runs, and the program."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path, nargs="?" if out == "optional" else None)
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--threads", type=int, help="of a run; results are the same with any number")
    return parser


def parsed(parser):
    """What was given; the folder is made."""
    args = parser.parse_args()
    if args.out is not None:
        args.out.mkdir(parents=True, exist_ok=True)
    return args


def case(hardening, friction, mesh, path, nu=0.3, opponent=""):
    """A case file: R = 1, `mesh` and `path` (a list for each segment) as lines of TOML."""
    segments = "".join("[[path]]\n" + "\n".join(segment) + "\n" for segment in path)
    return f"""[sphere]
radius = 1.0
[material]
youngs_modulus = {E}
poissons_ratio = {nu}
[material.hardening]
{hardening}
[contact]
friction = {friction}
{opponent}
[mesh]
{mesh}
[solver]
error_estimate = false
[output]
plots = false
fields = "none"
{segments}"""


def rows(args, name, text):
    """The history of a case, computed if it is not there."""
    out = args.out / name
    file = args.out / f"{name}.toml"
    is_there = file.exists() and file.read_text() == text and (out / "summary.json").exists()
    if not (is_there and '"status": "done"' in (out / "summary.json").read_text()):
        file.write_text(text)
        threads = ["--threads", str(args.threads)] if args.threads else []
        subprocess.run([args.program, "run", file, "--out", out, "--force", "--device", "cpu", "--quiet", *threads], check=True)
    with open(out / "history.csv", newline="") as table:
        return [{key: float(value) if value else math.nan for key, value in row.items()} for row in csv.DictReader(table)]


def segment(history, number):
    """The rows of a segment, with the one before it."""
    first = next(i for i, row in enumerate(history) if row["segment"] == number)
    return history[first - 1 : first] + [row for row in history if row["segment"] == number]
