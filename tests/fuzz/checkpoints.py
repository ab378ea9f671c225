# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checkpoints: damaged ones, which have to be noticed."""

from pathlib import Path

from case import Case, mangle
from scenes import SCENES, as_prm

NAMES = ("maxwell", "adaptive", "solid", "layers")


class Originals:
    """A finished run of each scene, with its last two checkpoints, made when
    first asked for."""

    def __init__(self, directory, run):
        self.directory = Path(directory)
        self.run = run  # runs the program in a directory on some ranks
        self.made = {}

    def of(self, name, ranks=1):
        key = f"{name}_{ranks}"
        if key not in self.made:
            place = self.directory / key
            place.mkdir(parents=True)
            entries = {**SCENES[name], "Checkpoint/Every n steps": "1"}
            interrupted = "0.1: 1, 0.2: 1, 0.3: 1"
            entries["Time/Phases"] = f"{interrupted}, 0.4: 1"
            (place / "scene.prm").write_text(as_prm(entries))
            self.run(place, ["--quiet", "scene.prm"], ranks)
            # what an interruption in the third step leaves
            results = place / "results"
            expected = (results / "statistics.csv").read_bytes()
            again = ["--set", f"Time/Phases={interrupted}"]
            self.run(place, ["--quiet", "scene.prm", *again], ranks)
            self.made[key] = place, expected
        return self.made[key]


def damage(random, directory):
    """Change a file of the last checkpoint or of each."""
    checkpoints = sorted(directory.glob("step_*"))
    chosen = random.choice((checkpoints[-1:], checkpoints[-1:], checkpoints))
    for checkpoint in chosen:
        files = sorted(checkpoint.iterdir())
        file = random.choice(files)
        data = file.read_bytes()
        action = random.randrange(7)
        if action == 0:
            file.write_bytes(mangle(random, data))
        elif action == 1:
            file.write_bytes(data[: random.randrange(max(1, len(data)))])
        elif action == 2:
            file.write_bytes(b"")
        elif action == 3:
            file.unlink()
        elif action == 4:
            other = random.choice(files).read_bytes()
            file.write_bytes(other)
        elif action == 5:
            file.unlink()
            file.mkdir()
        else:
            file.write_bytes(data + random.randbytes(random.choice((1, 8, 1000))))


def case(random, context):
    name = random.choice(NAMES)
    action = random.choice("damage damage damage none other".split())
    ranks = random.choice((1, 1, 1, 2)) if context.mpi else 1
    place, expected = context.originals.of(name, ranks)
    arguments = ["--restart", "scene.prm"]
    result = Case({}, arguments, base=str(place), told=[f"{name} of {ranks}: {action}"])

    def prepare(work):
        checkpoints = work / "results" / "checkpoint"
        if action == "damage":
            damage(random, checkpoints)
        elif action == "other":
            other = random.choice([n for n in NAMES if n != name])
            (work / "scene.prm").write_text(as_prm(SCENES[other]))

    result.prepare = prepare
    # Only the same number of ranks gives the same bits.
    if action in ("damage", "none") and ranks == 1:
        result.expected = expected
    if action == "none":
        result.sense = "an undamaged checkpoint"
    if action == "other":
        result.nonsense = "the checkpoint of another scene"
    return result
