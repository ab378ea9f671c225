# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checkpoints: damaged ones, which have to be noticed, and forged ones, whose
checksums are right: those may change the answer, but must not end in a crash,
a hang or numbers that are not finite."""

import struct
import zlib
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


def rewrite_manifest(checkpoint, files, extra=lambda text: text):
    """Sizes and checksums of what is there, as the program would write them."""
    text = (checkpoint / "manifest.txt").read_bytes()
    lines = []
    for line in extra(text).split(b"\n"):
        if line.startswith(b"checksum "):
            continue
        if line.startswith(b"file ") and len(line.split()) > 1:
            file = checkpoint / line.split()[1].decode("latin-1")
            if file in files and file.is_file():
                data, name = file.read_bytes(), file.name.encode()
                line = b"file %s %d %d" % (name, len(data), zlib.crc32(data))
        lines.append(line)
    text = b"\n".join(lines).rstrip(b"\n") + b"\n"
    (checkpoint / "manifest.txt").write_bytes(
        text + b"checksum %d\n" % zlib.crc32(text)
    )


def mangle_words(random, data):
    """Binary numbers exchanged for others at the edges of their types."""
    data = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8))):
        reals = 0.0, -1.0, 1e300, float("nan"), float("inf")
        values = (
            struct.pack("<d", random.choice(reals)),
            struct.pack("<Q", random.choice((0, 1, 2**32, 2**63, 2**64 - 1, 2**40))),
            struct.pack("<I", random.choice((0, 1, 2, 30, 2**31, 2**32 - 1))),
            bytes([random.choice((0, 1, 2, 255))]),
        )
        value = random.choice(values)
        if len(data) >= len(value):
            i = random.randrange(len(data) - len(value) + 1)
            i -= i % len(value) if random.random() < 0.5 else 0
            data[i : i + len(value)] = value
    return bytes(data)


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


def forge(random, directory):
    """Change files and make sizes and checksums right again."""
    checkpoints = sorted(directory.glob("step_*"))
    checkpoint = checkpoints[-1]
    files = sorted(checkpoint.glob("*.bin"))
    action = random.randrange(6)
    if action < 3:
        file = random.choice(files)
        change = random.choice((mangle, mangle_words, mangle_words))
        file.write_bytes(change(random, file.read_bytes()))
        rewrite_manifest(checkpoint, files)
    elif action == 3:
        a, b = random.choice(files), random.choice(files)
        data = a.read_bytes()
        a.write_bytes(b.read_bytes())
        b.write_bytes(data)
        rewrite_manifest(checkpoint, files)
    elif action == 4:
        # the files of another step
        for file in files:
            if random.random() < 0.5:
                file.write_bytes((checkpoints[0] / file.name).read_bytes())
        rewrite_manifest(checkpoint, files)
    else:
        key = random.choice(b"version dimension ranks step time file".split())
        value = random.choice(
            b"-1 0 1 2 3 4294967295 4294967296 nan 1e999 x".split()
            + [b"", b"../../x 1 1", b"run.bin 99999999999999999999 0", b"9" * 5000]
        )

        def edit(text):
            lines = text.split(b"\n")
            for i, line in enumerate(lines):
                if line.startswith(key + b" "):
                    lines[i] = key + b" " + value
                    break
            return b"\n".join(lines)

        rewrite_manifest(checkpoint, [], edit)


def case(random, context):
    name = random.choice(NAMES)
    action = random.choice("damage damage forge forge forge none other".split())
    ranks = random.choice((1, 1, 1, 2)) if context.mpi else 1
    place, expected = context.originals.of(name, ranks)
    arguments = ["--restart", "scene.prm"]
    result = Case({}, arguments, base=str(place), told=[f"{name} of {ranks}: {action}"])

    def prepare(work):
        checkpoints = work / "results" / "checkpoint"
        if action == "damage":
            damage(random, checkpoints)
        elif action == "forge":
            forge(random, checkpoints)
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
