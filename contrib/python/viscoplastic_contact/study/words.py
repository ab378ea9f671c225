# SPDX-License-Identifier: LGPL-2.1-or-later
"""Numbers, tables and messages for people."""

import subprocess
import sys
import tempfile
import time
from math import isfinite
from pathlib import Path

# So long without a line in what is no terminal may look like an end.
LONGEST_SILENCE = 15.0


def digits(value, n=3):
    """A number with n significant digits, as in 0.0123 or 1.2e-05; large ones with
    all digits before the point."""
    # 1.2e+05 is for programs.
    if 10.0**n - 0.5 <= abs(value) < 1e9:
        return str(round(value))
    return f"{value:.{n}g}"


def number_or_dash(value, n=3):
    return digits(value, n) if isfinite(value) else "-"


def seconds_in_words(seconds):
    """Small ones with two digits."""
    if seconds < 100.0:
        return digits(seconds, 2) + " s"
    if seconds < 6000.0:
        return f"{seconds / 60.0:.0f} min"
    if seconds < 172800.0:
        return f"{seconds / 3600.0:.1f} h"
    return f"{seconds / 86400.0:.1f} d"


def exact(value):
    """A number as a text that gives the same number."""
    return f"{value:.17g}"


def table(head, rows):
    """In Markdown; the head is a list, or a text with commas."""
    head = head.split(",") if isinstance(head, str) else list(head)
    rows = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(map(str, row)) + " |\n" for row in rows)


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
