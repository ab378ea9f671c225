# SPDX-License-Identifier: LGPL-2.1-or-later
"""The estimated error by its causes over time, above what it depends on."""

from . import history
from .results import NoPicture

PANELS = (
    history.ERROR,
    history.QUANTITY,
    history.CELLS,
    history.STEP_SIZE,
    history.AREA,
)


def draw(results, options):
    statistics = history.window(results.statistics, options)
    panels = history.those_with_something(PANELS, statistics)
    if not any(panel in (history.ERROR, history.QUANTITY) for panel, _ in panels):
        raise NoPicture("statistics.csv has no error estimate to draw")
    return history.draw_panels(
        results, panels, statistics, "estimated error by its causes over time", options
    )
