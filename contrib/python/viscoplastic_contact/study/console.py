# SPDX-License-Identifier: LGPL-2.1-or-later
"""Messages of studies: on the standard output and in a log file."""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

# So long without a line in what is no terminal may look like an end.
LONGEST_SILENCE = 15.0


class Console:
    """Quiet ones print nothing; the log has all but what a terminal shows while a
    run is under way."""

    def __init__(self, quiet=True, log=None):
        self.quiet = quiet
        self.log = Path(log) if log else None
        if self.log:
            self.log.write_text("", encoding="utf-8")
        self.has_status = not quiet and sys.stdout.isatty()
        self.shown = ""
        self.last = time.monotonic()
        self.said = []

    def say(self, text, end="\n"):
        self.clear()
        self.said.append(text + end)
        if not self.quiet:
            print(text, end=end, flush=True)
            self.last = time.monotonic()
        if self.log:
            with open(self.log, "a", encoding="utf-8") as file:
                file.write(text + end)

    def status(self, text):
        """What a run under way is, for those who watch."""
        self.clear()
        if self.has_status:
            self.shown = text
            print(text, end="\r", flush=True)
        elif not self.quiet and time.monotonic() > self.last + LONGEST_SILENCE:
            print(text, flush=True)
            self.last = time.monotonic()

    def clear(self):
        if self.shown:
            print(" " * len(self.shown), end="\r", flush=True)
            self.shown = ""

    def follow(self, launch):
        """Let launch(options, output) run the program, whose messages go to the standard
        output and to the log."""
        output = subprocess.DEVNULL if self.quiet else None  # the same as ours
        if not self.log:
            return launch([], output)
        with tempfile.NamedTemporaryFile(mode="r", suffix=".txt") as log:
            result = launch(["--log", log.name], output)
            with open(self.log, "a", encoding="utf-8") as file:
                file.write(log.read())
        return result
