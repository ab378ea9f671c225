# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs contrib/plot and its like as a user does: arguments in, an exit code, two streams and
files out.

Most of the time of a small picture and nearly all of that of a refusal is the
start of Python and of matplotlib.  A process that is forked has both already;
all that the script itself does is done anew.
"""

import runpy
import subprocess
import sys

from harness import SOURCE, forked

PLOT = SOURCE / "contrib" / "plot"
sys.path.insert(0, str(SOURCE / "contrib"))

import plotting.command  # what a forked process finds loaded


def plot_afresh(*arguments):
    """In a Python of its own, which has to find everything."""
    return subprocess.run(
        [sys.executable, PLOT, *map(str, arguments)], capture_output=True, text=True
    )


def plot(*arguments):
    """The same in a fork of this process."""
    return run_script(PLOT, *arguments)


def run_script(script, *arguments):
    return forked(
        [script, *arguments], lambda: runpy.run_path(str(script), run_name="__main__")
    )
