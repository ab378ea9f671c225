# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the program on the files of a case, under limits of time and memory.

Starting it costs a hundred times what it does on these files, which a server
saves.  A case that seems to be a defect is run again by the program itself,
which has the last word.
"""

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "server"))

import program_server

MEGABYTE = 1024 * 1024
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none"]


class Limits:
    """seconds of processor time, and of the clock on a busy machine; memory
    only without AddressSanitizer, which reserves terabytes."""

    def __init__(self, seconds, sanitized):
        self.cpu = int(seconds * (5 if sanitized else 1))
        self.clock = 10 * self.cpu
        self.memory = None if sanitized else 4096 * MEGABYTE

    def apply(self):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (self.cpu, self.cpu))
        resource.setrlimit(resource.RLIMIT_FSIZE, (256 * MEGABYTE,) * 2)
        if self.memory:
            resource.setrlimit(resource.RLIMIT_AS, (self.memory, self.memory))


def environment():
    return {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        # A single process needs no daemon and no network.
        "OMPI_MCA_ess_singleton_isolated": "1",
        "OMPI_MCA_btl": "self",
        "OMPI_MCA_pml": "ob1",
        # Allocations beyond all measure are refused as they are elsewhere.
        "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1:"
        "max_allocation_size_mb=4096:exitcode=99",
        "UBSAN_OPTIONS": "print_stacktrace=1:exitcode=99",
    }


def run_program(executable, work, arguments, limits, ranks=1):
    """(exit code or minus the signal, stdout, stderr)"""
    launcher = [*MPIRUN, "-n", str(ranks)] if ranks > 1 else []
    # a single process goes without what several need to talk
    settings = environment() if ranks == 1 else {**os.environ, "OMP_NUM_THREADS": "1"}
    with open(work / "stdout", "wb") as out, open(work / "stderr", "wb") as err:
        process = subprocess.Popen(
            [*launcher, executable, *arguments],
            cwd=work,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
            # Open MPI's files here, where no other run cleans up
            env={**settings, "TMPDIR": str(work)},
            preexec_fn=limits.apply,
        )
        try:
            code = process.wait(limits.clock)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            code = -signal.SIGALRM
    return code, *words(work)


def words(work):
    files = work / "stdout", work / "stderr"
    return [file.read_bytes().decode("utf-8", "replace") for file in files]


class Server:
    """The program, started once, under these limits."""

    def __init__(self, executable, limits):
        self.server = program_server.Server(
            [executable],
            limits.cpu,
            limits.clock,
            limits.memory or 0,
            {**environment(), "LD_BIND_NOW": "1"},  # or each fork looks up what it calls
        )
        self.close = self.server.close

    def run(self, work, arguments):
        """(exit code or minus the signal, stdout, stderr)"""
        return self.server.run(work, arguments), *words(work)
