# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes that make sense, drawn from the grammar: whether they are refused
cannot be known, but an answer can be judged by what holds in any scene
(answers.py).  Some of them are run again: from a checkpoint, in other units, on
several ranks, from the parameters that the run has written."""

import random as random_numbers
import re
import shutil
from dataclasses import dataclass, replace

import answers
from case import Case
from grammar import Scene, Units
from judge import table_without_clocks
from scenes import as_prm

# Powers of four: a scene in these units has the same bits but for exponents.
OTHER_UNITS = Units(length=4.0**-5, stress=4.0**9, time=4.0**4)
# A scene whose numbers are meters, megapascals and days, and say so.
NAMED_UNITS = Units(1e3, 1e3, 24, ("m", "MPa", "day"), ("mm", "kPa", "h"))


@dataclass
class Drawn(Case):
    """entries  of the scene
    other    the same in the units of other_units
    again    what is run after the scene: "", or a name of AGAIN
    promise  what is known of the answer: "", or a name of answers.PROMISES
    """

    entries: dict = None
    other: dict = None
    other_units: Units = OTHER_UNITS
    promise: str = ""
    again: str = ""
    ranks: int = 2

    def __post_init__(self):
        self.files = {"scene.prm": as_prm(self.entries).encode()}
        self.told = [self.again]

    def simpler(self):
        """Without a section, an entry, or what is run again."""
        if self.again:
            yield self.without([], again="")
        if self.promise:
            return  # which holds for the whole scene
        paths = [path for path in self.entries if path != "Output/Directory"]
        parts = {path.rsplit("/", n)[0] for path in paths for n in (0, 1, 2)}
        # the large ones first
        below = lambda part: [p for p in paths if f"{p}/".startswith(f"{part}/")]
        gone = map(below, parts)
        for paths in sorted(gone, key=lambda paths: (-len(paths), paths)):
            yield self.without(paths)

    def without(self, paths, **changes):
        drop = lambda entries: {k: v for k, v in entries.items() if k not in paths}
        return replace(
            self, entries=drop(self.entries), other=drop(self.other), **changes
        )

    def examine(self, work, outcome, stdout, run):
        """What is wrong with an answer that looks like one.  run(arguments,
        ranks, directory) runs the program."""
        if outcome.kind == "refused":
            return (
                answers.of_promise(self.promise, outcome.reason)
                or self.compare_with_check(work, outcome, run)
                or (self.again == "with the other solver" and self.solved(work, run))
                or ""
            )
        return (
            answers.of_run(work, stdout, self.entries)
            or self.compare_with_check(work, outcome, run)
            or (AGAIN[self.again](self, work, run) if self.again else "")
        )

    def compare_with_check(self, work, outcome, run):
        code, _, stderr = run(["--check", "scene.prm"])
        if code not in (0, 1):
            return f"check: exit code {code}"
        if code == 1 and outcome.kind == "ok":
            return f"check: refused what runs: {stderr.strip()[:300]}"
        # the coarser run of a comparison may be the first to notice
        sentence = stderr.strip().split("viscoplastic_contact: ")[-1]
        # with numbers of its own mesh
        form = lambda text: re.sub(r"[-+]?\d[\d.e+-]*", "0", text)
        if code == 1 and "run with twice the mesh width" in outcome.reason:
            return ""  # which may stumble over another mistake first
        if "lost in rounding" in outcome.reason:
            return ""  # of matrices, which --check does not make
        if code == 1 and not form(outcome.reason).endswith(form(sentence)):
            return f"check: another sentence, {stderr.strip()[:300]}"
        if code == 0 and outcome.kind == "refused":
            # to be told apart where the refusals are listed
            outcome.reason += " (by the run, not by --check)"
        return ""

    # Runs after the first one

    def from_checkpoint(self, work, run):
        """A run that goes on from the middle ends with the same bits."""
        steps = sorted((work / "results" / "checkpoint").glob("step_*"))
        if len(steps) < 2:
            return ""
        whole = (work / "results" / "statistics.csv").read_bytes()
        for later in steps[(len(steps) + 1) // 2 :]:
            shutil.rmtree(later)
        code, _, stderr = run(["--restart", "scene.prm"])
        if code != 0:
            return f"restart: exit code {code}, {stderr[:300]}"
        return self.compare_tables("restart", work, whole)

    def from_record(self, work, run):
        """parameters.prm is a scene that repeats the run."""
        whole = (work / "results" / "statistics.csv").read_bytes()
        shutil.copy(work / "results" / "parameters.prm", work / "again.prm")
        code, _, stderr = run(["again.prm"])
        if code != 0:
            return f"record: exit code {code}, {stderr[:300]}"
        return self.compare_tables("record", work, whole)

    def compare_tables(self, what, work, whole):
        now = (work / "results" / "statistics.csv").read_bytes()
        if table_without_clocks(now) != table_without_clocks(whole):
            return f"{what}: the answer is not that of the first run"
        return ""

    def in_other_units(self, work, run):
        other = work / "other"
        other.mkdir()
        (other / "scene.prm").write_text(as_prm(self.other))
        code, _, stderr = run(["scene.prm"], directory=other)
        if code != 0:
            return f"units: exit code {code}, {stderr[:300]}"
        return answers.of_other_units(
            answers.results(work),
            answers.results(other),
            int(self.entries.get("Dimension", 2)),
            self.other_units,
            self.entries,
        )

    def by_other_solver(self, work, run):
        """The exit code of the same scene with the other linear solver, and its
        directory."""
        other = work / "other"
        other.mkdir()
        entry = "Solver/Linear solver"
        is_direct = self.entries.get(entry) == "direct"
        solver = {entry: "multigrid" if is_direct else "direct"}
        (other / "scene.prm").write_text(as_prm({**self.entries, **solver}))
        code, _, stderr = run(["scene.prm"], directory=other)
        return code, stderr.strip()[:300], other

    def solved(self, work, run):
        """What one solver refuses the other must not solve."""
        code, _, _ = self.by_other_solver(work, run)
        return "solver: refused, but solved by the other one" if code == 0 else ""

    def with_other_solver(self, work, run):
        code, stderr, other = self.by_other_solver(work, run)
        if code != 0:
            return f"solver: solved, but refused by the other one, {stderr}"
        return answers.of_other_iterations(
            "solvers",
            answers.results(work).statistics,
            answers.results(other).statistics,
            self.entries,
        )

    def on_ranks(self, work, run):
        """The same scene on several ranks."""
        one = answers.results(work).statistics
        code, stdout, stderr = run(["scene.prm"], ranks=self.ranks)
        if code != 0:
            return f"ranks: exit code {code}, {stderr[:300]}"
        reason = answers.of_run(work, stdout, self.entries)
        if reason:
            return f"ranks: {reason}"
        several = answers.results(work).statistics
        return answers.of_other_iterations("ranks", one, several, self.entries)


AGAIN = {
    "from a checkpoint": Drawn.from_checkpoint,
    "from its record": Drawn.from_record,
    "in other units": Drawn.in_other_units,
    "with the other solver": Drawn.with_other_solver,
    "on several ranks": Drawn.on_ranks,
}


def case(random, context):
    seed = random.random()
    draw = lambda units: Scene(random_numbers.Random(seed), units)
    power = lambda least, most: 10.0 ** random.randint(least, most)
    other_units = random.choice((OTHER_UNITS, NAMED_UNITS))
    if random.random() < 0.3:
        units = Units(power(-6, 6), power(-3, 12), power(-9, 12))
        again = ""
    else:
        units = Units()
        again = random.choice(
            ("", "", "in other units", "from its record", "with the other solver")
        )
    scene = draw(units)
    entries = scene.entries
    if "Output/Fields interval" in entries or any(
        re.search(r"if\(t <", str(value)) for value in entries.values()
    ):
        # Of a jump at the time of a step rounding chooses the side that is seen.
        other_units = OTHER_UNITS
    if "Checkpoint/Every n steps" in entries and random.random() < 0.6:
        again = "from a checkpoint"
    elif context.mpi and random.random() < 0.06:
        again = "on several ranks"
        entries["Solver/Linear solver"] = "multigrid"
    return Drawn(
        {},
        ["scene.prm"],
        entries=entries,
        other=draw(other_units).entries,
        other_units=other_units,
        again=again,
        ranks=random.choice((2, 3)),
        promise=scene.promise,
    )
