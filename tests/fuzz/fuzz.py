#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bad input by the thousand: damaged parameter files, expressions, meshes and
checkpoints go into the program, also scenes that make sense, and each answer
is judged (judge.py, answers.py).

A case is made again by its kind, seed and number:

    fuzz.py --seed 7 --only 1234 meshes

Cases that end in a defect stay in --keep, each with its files and a script
`again` that runs the program on them.
"""

import argparse
import collections
import concurrent.futures
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import checkpoints
import drawn_scenes
import expressions
import meshes
import parameter_files
from case import generator
from judge import Outcome, judge
from runner import MPIRUN, Limits, Server, environment, run_program

SOURCE = Path(__file__).resolve().parents[2]
KINDS = {
    "parameters": parameter_files.case,
    "expressions": expressions.case,
    "meshes": meshes.case,
    "checkpoints": checkpoints.case,
    "scenes": drawn_scenes.case,
}
# Of what makes sense, so much has to be accepted at least: a grammar that only
# draws refusals tests nothing.
ACCEPTED = {"scenes": 0.5}

# One case in so many is run by the program itself, from its start to its end.
WHOLE = 25


class Context:
    """What the makers of cases may ask for."""

    def __init__(self, executable, scratch):
        description = subprocess.run(
            [executable, "--describe"],
            env=environment(),
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        self.entries = entries_of(description)
        self.mpi = shutil.which("mpirun") is not None
        self.executable = executable
        self.lock = threading.Lock()
        self.originals = checkpoints.Originals(scratch / "originals", self.run)

    def run(self, place, arguments, ranks):
        launcher = [*MPIRUN, "-n", str(ranks)] if ranks > 1 else []
        # a single process goes without what several need to talk
        settings = environment() if ranks == 1 else os.environ
        subprocess.run(
            [*launcher, self.executable, *arguments],
            cwd=place,
            env={**settings, "OMP_NUM_THREADS": "1", "ASAN_OPTIONS": "detect_leaks=0"},
            check=True,
            capture_output=True,
        )


def entries_of(description):
    """All entries that the program declares, as `Section/Entry'."""
    sections, entries = [], []
    for line in description.splitlines():
        words = line.strip()
        if words.startswith("subsection "):
            sections.append(words[11:])
        elif words == "end":
            sections.pop()
        elif words.startswith("set "):
            entries.append("/".join([*sections, words[4:].split("=")[0].strip()]))
    # The path of a device or of another run is no mistake, but no test either;
    # studies have a program of their own.
    left_out = ("Output/Directory", "Checkpoint/Directory", "Exact solution/Reference")
    return [e for e in entries if not e.startswith((*left_out, "Study/"))]


class Fuzzer:
    def __init__(self, options, scratch):
        self.options = options
        self.scratch = scratch
        self.context = Context(options.executable, scratch)
        self.limits = Limits(options.seconds, options.sanitized)
        self.local = threading.local()
        self.servers = []
        self.shapes = collections.Counter()
        self.examples = {}

    def server(self):
        if not self.options.server:
            return None
        if not hasattr(self.local, "server"):
            self.local.server = Server(self.options.server, self.limits)
            self.servers.append(self.local.server)
        return self.local.server

    def draw(self, kind, number):
        random = generator(kind, self.options.seed, number)
        with self.context.lock:
            return KINDS[kind](random, self.context)

    def lay_out(self, case, work):
        """The files of a case, in a fresh directory."""
        shutil.rmtree(work, ignore_errors=True)
        if case.base:
            shutil.copytree(case.base, work)
        else:
            work.mkdir(parents=True)
        for name, data in case.files.items():
            (work / name).write_bytes(data)
        if case.prepare:
            case.prepare(work)

    def answer(self, case, work, server=None):
        """Of the server or, without one, of the program itself."""
        self.lay_out(case, work)

        def run(arguments, ranks=1, directory=work):
            if server and ranks == 1:
                return server.run(directory, arguments)
            program = self.options.executable
            return run_program(program, directory, arguments, self.limits, ranks)

        result = run(case.arguments)
        outcome = judge(case, work, *result)
        if outcome.kind != "defect":
            reason = case.examine(work, outcome, result[1], run)
            if reason:
                outcome = Outcome("defect", reason)
        return outcome

    def run(self, kind, number):
        work = self.scratch / "cases" / f"{kind}_{number}"
        case = self.draw(kind, number)
        server = self.server()
        answer = None
        if server and number % WHOLE != 0:
            answer = self.answer(case, work, server)
        if answer is None or answer.kind == "defect":
            answer = self.answer(case, work)
        if answer.kind == "defect" and not self.options.as_drawn:
            case = self.simplest(case, answer, work)
        if answer.kind == "defect" or self.options.only is not None:
            self.keep(kind, number, case, answer)
        shutil.rmtree(work, ignore_errors=True)
        return answer

    def simplest(self, case, answer, work):
        """What is left of a case when all is dropped that its defect does not
        need."""
        found = True
        while found:
            found = False
            for simpler in case.simpler():
                other = self.answer(simpler, work, self.server())
                if other.kind == "defect" and shape(other.reason) == shape(answer.reason):
                    case, found = simpler, True
                    break
        return case

    def keep(self, kind, number, case, answer):
        place = Path(self.options.keep) / f"{kind}_{self.options.seed}_{number}"
        self.lay_out(case, place)
        program = str(Path(self.options.executable).resolve())
        command = shlex.join([program, *case.arguments])
        (place / "again").write_text(
            f'#!/bin/sh\ncd "$(dirname "$0")" && exec {command}\n'
        )
        (place / "again").chmod(0o755)
        (place / "reason").write_text(f"{answer.kind}: {answer.reason}\n{case.told}\n")


def shape(sentence):
    """A sentence without its names and numbers, to count its like."""
    sentence = re.sub(r"'[^']*('s [^']*)?'", "'...'", sentence)
    return re.sub(r"[-+]?\d[\d.e+-]*", "0", sentence)[:160]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", help=f"of {', '.join(KINDS)} (default: all)")
    parser.add_argument("--count", type=int, default=250, help="cases of each kind")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--only", type=int, help="number of the only case, which is kept")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument(
        "--seconds", type=float, default=20, help="of processor time a case"
    )
    parser.add_argument(
        "--executable",
        default=os.environ.get(
            "VISCOPLASTIC_CONTACT", str(SOURCE / "build" / "viscoplastic_contact")
        ),
    )
    parser.add_argument(
        "--server",
        default=os.environ.get("VISCOPLASTIC_CONTACT_SERVER", ""),
        help="viscoplastic_contact_server, which saves starting the program",
    )
    parser.add_argument("--keep", default="fuzz_defects", help="directory for defects")
    parser.add_argument(
        "--as-drawn", action="store_true", help="leave defects as large as they are"
    )
    parser.add_argument("--messages", action="store_true", help="list the refusals")
    options = parser.parse_args()
    for kind in options.kinds:
        if kind not in KINDS:
            parser.error(f"there is no kind {kind}; there are {', '.join(KINDS)}")
    options.executable = shutil.which(options.executable) or options.executable
    with open(options.executable, "rb") as program:
        options.sanitized = b"__asan_init" in program.read()

    begin = options.first if options.only is None else options.only
    end = begin + (options.count if options.only is None else 1)
    n_defects, too_few = 0, []
    with tempfile.TemporaryDirectory(prefix="fuzz_") as scratch:
        fuzzer = Fuzzer(options, Path(scratch))
        for kind in options.kinds or KINDS:
            start, counts = time.monotonic(), collections.Counter()
            with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
                answers = pool.map(lambda n: (n, fuzzer.run(kind, n)), range(begin, end))
                for number, answer in answers:
                    counts[answer.kind] += 1
                    if answer.kind == "refused":
                        fuzzer.shapes[shape(answer.reason)] += 1
                        fuzzer.examples[shape(answer.reason)] = f"{kind} {number}"
                    if answer.kind == "defect" or options.only is not None:
                        verdict = f"{answer.kind}: {answer.reason}"
                        print(f"{kind} {number}: {verdict}", flush=True)
            n_defects += counts["defect"]
            accepted = counts["ok"] / sum(counts.values())
            if options.only is None and accepted < ACCEPTED.get(kind, 0):
                too_few.append(kind)
                print(f"{kind}: only {100 * accepted:.0f} % were accepted")
            print(
                f"{kind}: {sum(counts.values())} cases, {counts['ok']} ok, "
                f"{counts['refused']} refused, {counts['defect']} defects "
                f"({time.monotonic() - start:.0f} s)",
                flush=True,
            )
        for server in fuzzer.servers:
            server.close()
    if options.messages:
        for text, n in fuzzer.shapes.most_common():
            print(f"{n:6} {text} ({fuzzer.examples[text]})")
    return 1 if n_defects or too_few else 0


if __name__ == "__main__":
    sys.exit(main())
