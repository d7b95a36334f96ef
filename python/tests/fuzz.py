"""Hostile arguments to every public function and method: `python fuzz.py PLACE SEED COUNT`.

PLACE has the directories `run`, `study` and `table` of computations that are done, and is written to. Each call is told on standard output before it is made, so that
one which ends or stops the interpreter is known. Ends with 1 and what was wrong if a call raises what is no error of the package or of Python's own kind, takes too long,
or the process takes too much memory.
"""

from __future__ import annotations

import copy
import faulthandler
import os
import pickle
import random
import resource
import shutil
import sys
import threading
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from hostile import TEXTS, Own, array, damaged, mutated, numbers, value

import asperity

# Seconds of this thread's own time, and of the clock on a machine that does other things as well.
LONGEST, HANGS = 2.0, 60.0
# Most bytes above what the package needs.
MEMORY = 1 << 30

Call = Callable[[random.Random], object]

ALLOWED = (asperity.AsperityError, Own, TypeError, ValueError, LookupError, OSError, MemoryError)
# What belongs to matplotlib's and pandas' own objects, and to an attribute that is asked for.
ALLOWED_OF: dict[str, tuple[type[BaseException], ...]] = {
    "Table.attribute": (AttributeError,),
    "Run.plot_forces": (AttributeError,),
    "Run.plot_press": (AttributeError,),
    "Run.plot_pressure": (AttributeError,),
    "Fields.to_meshio": (AttributeError,),
    "Mesh.to_meshio": (AttributeError,),
    "Fields.to_pyvista": (AttributeError,),
    "Mesh.to_pyvista": (AttributeError,),
}


class Fuzz:
    """The calls, by the names of what they call."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.run = asperity.Run.load(place / "run")
        self.study = asperity.Study.load(place / "study")
        self.table = asperity.Law.load(place / "table/law.json")
        self.formulas, self.built_in = asperity.Law.wear_2014(), asperity.Law.built_in()
        self.case = self.run.case
        self.tables: dict[str, Any] = self.case.to_dict()
        self.fields = self.run.fields()
        self.mesh = self.run.mesh
        self.files = {name: (place / "run" / name).read_bytes() for name in ("case.toml", "history.csv", "summary.json")}
        self.files |= {str(file.relative_to(place / "run")): file.read_bytes() for file in sorted((place / "run").glob("*/step_*")) if file.suffix != ".svg"}
        self.law_text, self.study_text = (place / "table/law.json").read_bytes(), (place / "study/study.csv").read_bytes()
        self.study_file = (place / "study/study.toml").read_text()
        self.calls: dict[str, Call] = {
            **self.of_cases(), **self.of_runs(), **self.of_studies(), **self.of_laws(), **self.of_contacts(), **self.of_tables(), **self.of_errors(),
        }  # fmt: skip

    def path(self, dice: random.Random, good: Any) -> Any:
        return dice.choice([good, str(good), os.fsencode(good), value(dice), self.place, self.place / "nowhere/x", self.place / "mine/thesis.tex"])

    def unusable(self, dice: random.Random) -> Any:
        """A place where nothing can be computed into."""
        bad = ["", "\0", "/dev/null", "/dev/null/x", self.place / "run/case.toml", b"a\0b", 7, object(), [], "\ud800", self.place / "mine", np.zeros(3), False]
        return dice.choice(bad)

    def a_case(self, dice: random.Random) -> Any:
        choices: list[Callable[[], Any]] = [
            lambda: self.case, lambda: mutated(dice, self.tables), lambda: value(dice), lambda: mutated(dice, self.case.to_toml()), lambda: self.path(dice, self.place / "run/case.toml"),
            lambda: damaged(dice, self.files["case.toml"]).decode(errors="surrogateescape"),
        ]  # fmt: skip
        return dice.choice(choices)()

    def settings(self, dice: random.Random) -> Any:
        keys = ["contact.friction", "path.0.indentation", "path", "path.9", "mesh.elements_per_contact_radius", "sphere", "output.plots", *TEXTS]
        table = {dice.choice(keys): value(dice) for _ in range(dice.randrange(1, 4))}
        return dice.choice([table, table, table, value(dice)])

    def some(self, dice: random.Random, **good: Any) -> dict[str, Any]:
        """Keywords of which one or two are hostile."""
        for name in dice.sample(list(good), dice.choice([1, 1, 2])):
            good[name] = value(dice)
        return good

    def never(self, dice: random.Random, wrong: tuple[Any, ...]) -> Any:
        """A hostile value that does not begin a long computation."""
        while True:
            found = value(dice)
            if not isinstance(found, (bool, int, np.integer, np.bool_)) or found not in wrong:
                return found

    def of_cases(self) -> dict[str, Call]:
        case, Case = self.case, asperity.Case
        return {
            "Case": lambda dice: Case(**mutated(dice, self.tables)),
            "Case.from_dict": lambda dice: Case.from_dict(mutated(dice, self.tables)),
            "Case.parse": lambda dice: Case.parse(**self.some(dice, text=case.to_toml(), set={}, name="case")),
            "Case.load": lambda dice: Case.load(self.path(dice, self.place / "run/case.toml"), dice.choice([None, self.settings(dice)])),
            "Case.replace": lambda dice: case.replace(self.settings(dice)),
            "Case.to_dict": lambda dice: Case.from_dict(mutated(dice, self.tables)).to_dict(),
            "Case.to_toml": lambda dice: case.replace(self.settings(dice)).to_toml(),
            "Case.notes": lambda dice: Case.from_dict(mutated(dice, self.tables)).notes(),
            "Case.__getitem__": lambda dice: case[
                dice.choice([value(dice), "path.0.indentation", "path.-1", "path.0.0.0", "sphere", "sphere.radius.x", "path.99999999999999999999"])
            ],
            "Case.__eq__": lambda dice: isinstance(case == value(dice), bool),
        }

    def of_runs(self) -> dict[str, Call]:
        run, out = self.run, self.place / "run"

        def again(dice: random.Random) -> object:
            # Done already: only what is refused, or the result that there is.
            good = {"device": "cpu", "threads": 1, "progress": False, "precision": "auto", "resume": True}
            words = self.some(dice, **good) | {"out": dice.choice([out, out, out, self.unusable(dice)])}
            words["force"] = dice.choice([False, False, self.never(dice, (True,))])
            return asperity.run(dice.choice([self.case, self.case, self.a_case(dice)]), **words)

        def hurt(dice: random.Random) -> object:
            """A result of which a file is damaged."""
            place, (name, content) = self.place / "hurt", dice.choice(list(self.files.items()))
            if not place.exists():
                shutil.copytree(out, place)
            (place / name).write_bytes(damaged(dice, content))
            try:
                hurt = asperity.Run.load(place)
                ask = [lambda: hurt.history, lambda: hurt.summary, lambda: hurt.contact(), lambda: hurt.fields(), lambda: hurt.mesh, lambda: repr(hurt)]
                return [asked() for asked in (ask if name == "case.toml" else dice.sample(ask, 3))]
            finally:
                (place / name).write_bytes(content)

        return {
            "run": again,
            "Run": hurt,
            "Run.load": lambda dice: asperity.Run.load(self.path(dice, out)),
            "Run.contact": lambda dice: run.contact(value(dice)),
            "Run.fields": lambda dice: run.fields(value(dice)),
            "Run.plot": lambda dice: run.plot(**self.some(dice, name="forces", law=None, width="85mm", title=False)),
            "Picture": lambda dice: asperity.Picture(value(dice)),
            "Picture.save": lambda dice: run.plot().save(self.path(dice, self.place / "picture.svg")),
            "Run.plot_forces": lambda dice: run.plot_forces(value(dice)),
            "Run.plot_press": lambda dice: run.plot_press(value(dice)),
            "Run.plot_pressure": lambda dice: run.plot_pressure(**self.some(dice, step=None, ax=object())),
        }

    def of_studies(self) -> dict[str, Call]:
        out = self.place / "study"

        def again(dice: random.Random) -> object:
            good = {"device": "cpu", "threads": 1, "progress": False, "precision": "auto", "shard": None, "resume": True, "retry": False}
            words = self.some(dice, **good) | {"out": dice.choice([out, out, out, self.unusable(dice)])}
            words["force"] = dice.choice([False, False, self.never(dice, (True,))])
            grid = dice.choice([None, self.settings(dice), {"contact.friction": value(dice)}, {value(dice, 2) if dice.random() < 0.1 else "x": [0.1]}])
            text = damaged(dice, self.study_file.encode()).decode(errors="surrogateescape")
            base = dice.choice([self.study_file, self.study_file, text, out / "study.toml"]) if grid is None else self.a_case(dice)
            return asperity.study(base, grid, **words)

        def hurt(dice: random.Random) -> object:
            place = self.place / "hurt-study"
            place.mkdir(exist_ok=True)
            (place / "study.csv").write_bytes(damaged(dice, self.study_text))
            study = asperity.Study.load(place)
            return [study.table, repr(study), [study[row] for row in range(len(study))]]

        return {
            "study": again,
            "Study": hurt,
            "Study.load": lambda dice: asperity.Study.load(self.path(dice, out)),
            "Study.__getitem__": lambda dice: self.study[value(dice)],
        }

    def of_laws(self) -> dict[str, Call]:
        Law, laws = asperity.Law, (self.table, self.formulas, self.built_in)

        def law(dice: random.Random) -> asperity.Law:
            return dice.choice([self.table, self.table, self.formulas, self.formulas, self.built_in])

        def hurt(dice: random.Random) -> object:
            file = self.place / "hurt-law.json"
            file.write_bytes(damaged(dice, self.law_text))
            return Law.load(dice.choice([file, file, self.path(dice, file)])).predict(self.case)

        def tabulate(dice: random.Random) -> object:
            words = self.some(dice, device="cpu", threads=1, progress=False, precision="auto", resume=True)
            words |= {"elements": self.never(dice, tuple(range(4, 17))), "force": False, "out": self.unusable(dice)}
            if dice.random() < 0.5:
                words["elements"], words["out"] = 4, self.unusable(dice)
            return Law.tabulate(self.a_case(dice), **words)

        def export(dice: random.Random) -> object:
            words = self.some(dice, format=dice.choice(["c", "python"]), out=dice.choice([None, self.place / "export"]), case=self.a_case(dice))
            return law(dice).export(**words)

        def fit(dice: random.Random) -> object:
            words = self.some(dice, prior="none", interpolate=dice.random() < 0.5, reversal=dice.choice([None, *laws]))
            return Law.fit(dice.choice([self.study, self.path(dice, self.place / "study")]), **words)

        return {
            "Law": lambda dice: Law(value(dice)),
            "Law.fit": fit,
            "Law.tabulate": tabulate,
            "Law.load": hurt,
            "Law.built_in": lambda dice: Law.built_in(),
            "Law.wear_2014": lambda dice: Law.wear_2014(),
            "Law.save": lambda dice: law(dice).save(self.path(dice, self.place / "saved.json")),
            "Law.to_dict": lambda dice: law(dice).to_dict(),
            "Law.table": lambda dice: law(dice).table(self.a_case(dice)),
            "Law.formulas": lambda dice: law(dice).formulas(),
            "Law.predict": lambda dice: law(dice).predict(self.a_case(dice), dice.choice([False, False, self.never(dice, (True,))])),
            "Law.plot": lambda dice: law(dice).plot(self.a_case(dice), **self.some(dice, name="forces", width="85mm", title=False)),
            "Law.export": export,
            "Law.check": lambda dice: law(dice).check(self.a_case(dice), self.never(dice, tuple(range(4, 17)))),
            "Law.contacts": lambda dice: law(dice).contacts(self.a_case(dice), dice.choice([1, 2, 1000, value(dice)])),
            "Law.update": self.update,
        }

    def update(self, dice: random.Random) -> object:
        """A number of moves, of which any may be hostile; what is kept stays finite, and so is the answer, or it is none at all."""
        law = dice.choice([self.table, self.formulas])
        count = dice.choice([0, 1, 2, 3, 300])
        state = law.contacts(self.case, count)
        for _ in range(dice.randrange(1, 5)):
            before = state.array
            h: Any = dice.choice([0.01, numbers(dice, (count,), ())])
            delta: Any = dice.choice([(0.0, 1e-4), numbers(dice, (count, 2), (2,))])
            if dice.random() < 0.2:
                h, delta = dice.choice([(value(dice, count), delta), (h, array(dice, count)), (array(dice, count), delta)])
            try:
                answer = law.update(dice.choice([state] * 20 + [value(dice)]), h, delta)
            except BaseException:
                assert np.array_equal(state.array, before), "a refused update has moved contacts"
                raise
            assert np.isfinite(state.array).all(), f"a state that is not finite after h = {h!r}, delta = {delta!r}"
            h, delta = (np.broadcast_to(np.asarray(given, dtype=float), shape) for given, shape in ((h, (count,)), (delta, (count, 2))))
            forces = np.column_stack([answer["F_N"], answer["F_T"], answer["a"]])
            none = np.isnan(forces).all(axis=1)
            assert (none | np.isfinite(forces).all(axis=1)).all(), f"half an answer to h = {h}, delta = {delta}"
            assert np.array_equal(state.array[none], before[none]), "a contact without an answer has moved"
            # A sphere of radius 1: nothing overflows here.
            small = (np.abs(h) < 1e100) & (np.abs(delta) < 1e100).all(axis=1)
            assert not none[small].any(), f"no answer to h = {h}, delta = {delta}"
        return state

    def of_contacts(self) -> dict[str, Call]:
        def contacts(dice: random.Random) -> asperity.Contacts:
            state = dice.choice([self.table, self.formulas]).contacts(self.case, 3)
            self.table.update(state, 0.01, (1e-4, 0.0))
            return state

        def remember(dice: random.Random) -> object:
            state = contacts(dice)
            memory = state.array
            memory[:, dice.randrange(memory.shape[1])] = dice.choice([-1.0, 1.0]) * 10.0 ** dice.uniform(-300, 300)
            state.array = dice.choice(
                [memory, memory, numbers(dice, memory.shape), value(dice, memory.shape[0]), memory.tolist(), memory.astype(">f8"), memory[::-1]]
            )
            return self.table.update(state, numbers(dice, (3,)), numbers(dice, (2,), (3, 2)))

        def thread(dice: random.Random) -> object:
            """Moved by two threads at once: the second one is refused."""
            state, raised = self.formulas.contacts(self.case, 3000), []

            def move() -> None:
                try:
                    self.formulas.update(state, 0.01, (1e-4, 0.0))
                except asperity.AsperityError as error:
                    raised.append(error)

            threads = [threading.Thread(target=move) for _ in range(2)]
            [one.start() for one in threads]
            [one.join() for one in threads]
            assert len(raised) < 2
            return state

        return {
            "Contacts": lambda dice: asperity.Contacts(value(dice)),
            "Contacts.array": remember,
            "Contacts.rotate": lambda dice: contacts(dice).rotate(dice.choice([numbers(dice, (3,), ()), array(dice, 3), value(dice)])),
            "Contacts.copy": lambda dice: contacts(dice).copy(),
            "Contacts.__len__": thread,
        }

    def of_tables(self) -> dict[str, Call]:
        history, fields, mesh = self.run.history, self.fields, self.mesh

        def anything(dice: random.Random) -> dict[str, Any]:
            return {dice.choice(["a", "b", "_columns", 7, None]): value(dice) for _ in range(dice.randrange(3))}

        return {
            "Table": lambda dice: repr(asperity.Table(dice.choice([value(dice), anything(dice)]))),
            "Table.attribute": lambda dice: getattr(history, dice.choice([text for text in TEXTS if isinstance(text, str)])),
            "Table.__getitem__": lambda dice: history[value(dice)],
            "Table.rows": lambda dice: asperity.Table(anything(dice)).rows,
            "Table.to_pandas": lambda dice: asperity.Table(anything(dice)).to_pandas(),
            "Table.to_arrow": lambda dice: asperity.Table(anything(dice)).to_arrow(),
            "Fields": lambda dice: repr(asperity.Fields(value(dice), value(dice), value(dice), value(dice))),
            "Fields.__getitem__": lambda dice: fields[value(dice)],
            "Fields.to_pyvista": lambda dice: fields.to_pyvista(),
            "Fields.to_meshio": lambda dice: asperity.Fields(fields.points, dice.choice([fields.cells, value(dice)]), {}, anything(dice)).to_meshio(),
            "Mesh": lambda dice: repr(asperity.Mesh(value(dice), value(dice))),
            "Mesh.to_pyvista": lambda dice: mesh.to_pyvista(),
            "Mesh.to_meshio": lambda dice: asperity.Mesh(dice.choice([mesh.points, value(dice)]), value(dice)).to_meshio(),
            "Check": lambda dice: repr(asperity.Check(dice.choice([value(dice), [anything(dice)], [{"path": value(dice), "columns": anything(dice)}]]))),
        }

    def of_errors(self) -> dict[str, Call]:
        kinds = ["AsperityError", "CaseError", "MissingPackage"]
        calls: dict[str, Call] = {kind: lambda dice, kind=kind: getattr(asperity, kind)(value(dice)) for kind in kinds}  # type: ignore[misc]
        calls["NotConverged"] = lambda dice: asperity.NotConverged(value(dice), value(dice))  # type: ignore[arg-type]
        calls["Interrupted"] = lambda dice: asperity.Interrupted(value(dice), run=value(dice), study=value(dice))  # type: ignore[arg-type]
        return calls


def kept(answer: object, dice: random.Random) -> None:
    """A result of ours, pickled and copied."""
    if isinstance(answer, (asperity.Case, asperity.Contacts, asperity.Table)) or (isinstance(answer, asperity.Law) and dice.random() < 0.02):
        again = pickle.loads(pickle.dumps(answer, dice.randrange(pickle.HIGHEST_PROTOCOL + 1)))
        if isinstance(answer, asperity.Case):
            assert again == answer and copy.deepcopy(answer) == answer and again.to_toml() == answer.to_toml()
        if isinstance(answer, asperity.Contacts):
            assert np.array_equal(again.array, answer.array)


def one(name: str, call: Call, seed: str) -> str | None:
    """What is wrong with a call, if anything."""
    dice = random.Random(seed)
    spent = time.thread_time()
    try:
        kept(call(dice), dice)
    except ALLOWED_OF.get(name, ()) + ALLOWED as error:
        if "panicked" in str(error):
            return f"{type(error).__name__}: {error}"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"
    spent = time.thread_time() - spent
    return f"took {spent:.1f} s" if spent > LONGEST else None


def main() -> int:
    place, first, count = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    only = sys.argv[4:]
    warnings.simplefilter("ignore")
    fuzz = Fuzz(place)
    (place / "mine").mkdir(exist_ok=True)
    (place / "mine/thesis.tex").write_text("mine")
    (place / "scratch").mkdir(exist_ok=True)
    os.chdir(place / "scratch")
    names = only or list(fuzz.calls)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10
    wrong = 0
    for i in range(first, first + count):
        name = names[i % len(names)]
        print(f"{name} {i}", flush=True)
        faulthandler.dump_traceback_later(HANGS, exit=True)
        problem = one(name, fuzz.calls[name], f"{name} {i}")
        faulthandler.cancel_dump_traceback_later()
        if problem is not None:
            wrong += 1
            print(f"WRONG {name} {i}: {problem[:600]}", flush=True)
        if i % 500 == 0:
            if "matplotlib.pyplot" in sys.modules:
                sys.modules["matplotlib.pyplot"].close("all")
    more = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10) - before
    if more > MEMORY:
        print(f"WRONG memory: {more >> 20} MiB more than before", flush=True)
        wrong += 1
    if fuzz.run.summary != asperity.Run.load(place / "run").summary or fuzz.case != asperity.Run.load(place / "run").case:
        print("WRONG the run that was asked about has changed", flush=True)
        wrong += 1
    for device in ["/dev/null", "/dev/full", "/dev/zero"]:
        if Path(device).exists() and not Path(device).is_char_device():
            print(f"WRONG {device} has been replaced", flush=True)
            wrong += 1
    print(f"{count} calls, {wrong} wrong, {more >> 20} MiB", flush=True)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
