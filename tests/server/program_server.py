# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs of the program without its start, half a second of linking libraries.

The server (server.cc) has started once, and forks for each run.
"""

import subprocess


class Server:
    """A process of server.cc: its executable, the limits of a run (seconds of
    processor time and of the clock, bytes of memory or 0) and its environment.
    """

    def __init__(self, executable, cpu, clock, memory, environment):
        self.process = subprocess.Popen(
            [executable, str(cpu), str(clock), str(memory)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment,
            text=True,
        )

    def run(self, work, arguments):
        """The exit code, or minus the signal, of a run in the directory work,
        where its words are in the files stdout and stderr."""
        words = [str(work), *map(str, arguments)]
        # what is strange is in files
        assert all(word and not set(word) & set(" \t\n") for word in words), words
        self.process.stdin.write(" ".join(words) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise SystemExit("the server of the program has ended")
        return int(answer)

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
