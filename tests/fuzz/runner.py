# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the program on the files of a case, under limits of time and memory.

Starting it costs a hundred times what it does on these files: libraries are
linked, MPI starts.  The server (server.cc) has done that once and forks for
each case.  A case that seems to be a defect is run again by the program
itself, which has the last word.
"""

import os
import resource
import signal
import subprocess

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
    """A process of server.cc."""

    def __init__(self, executable, limits):
        self.limits = limits
        memory = limits.memory or 0
        self.process = subprocess.Popen(
            [executable, str(limits.cpu), str(limits.clock), str(memory)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment(),
            text=True,
        )

    def run(self, work, arguments):
        # arguments hold no blanks: what is strange is in files
        self.process.stdin.write(" ".join([str(work), *arguments]) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise SystemExit("the server of the fuzzer has ended")
        return int(answer), *words(work)

    def close(self):
        self.process.stdin.close()
        self.process.wait()
