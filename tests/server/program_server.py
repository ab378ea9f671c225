# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs of the program without its start, half a second of linking libraries
on each rank.

The server (server.cc) has started once, and forks for each run or runs one after
the other on several ranks.
"""

import subprocess
from pathlib import Path

# Looks like the program, or with --serve like the server.
CLIENT = str(Path(__file__).with_name("client"))


class Server:
    """A process of server.cc: the command that starts it, perhaps on several ranks,
    the limits of a run (seconds of processor time and of the clock, bytes of memory
    or 0) and its environment.
    """

    def __init__(self, command, cpu, clock, memory, environment):
        self.process = subprocess.Popen(
            [*command, str(cpu), str(clock), str(memory)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment,
            text=True,
        )

    def run(self, work, arguments):
        """The exit code, or minus the signal, of a run in the directory work,
        where its words are in the files stdout and stderr. A failed run on
        several ranks ends the server."""
        words = [str(work), *map(str, arguments)]
        # what is strange is in files
        assert all(word and not set(word) & set(" \t\n") for word in words), words
        for name in "stdout", "stderr":
            (work / name).write_bytes(b"")
        self.process.stdin.write(" ".join(words) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        return int(answer) if answer else self.process.wait()

    def has_ended(self):
        return self.process.poll() is not None

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
