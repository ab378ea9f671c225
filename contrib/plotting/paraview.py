# SPDX-License-Identifier: LGPL-2.1-or-later
"""A state for ParaView beside the results."""

from pathlib import Path

from .results import NoPicture

SCRIPT = Path(__file__).resolve().parent.parent / "paraview" / "open_results.py"


def write_state(results):
    """view.py: the script that opens results, and where these are."""
    if not results.solution:
        raise NoPicture(f"{results.directory} has no solution.pvd for ParaView to open")
    path = results.directory / "view.py"
    text = SCRIPT.read_text(encoding="utf-8")
    text = text.replace("RESULTS = None", f"RESULTS = {str(results.directory)!r}", 1)
    path.write_text(text, encoding="utf-8")
    return path
