# SPDX-License-Identifier: LGPL-2.1-or-later
"""A field on the deformed body."""

import matplotlib.pyplot as plt

from .body import Body2D, make_body
from .body_base import Scale
from .layout import fit_rows


def scale(results, indices, options, name):
    return Scale(results, indices, name, options)


def draw(results, index, options, scale):
    body = make_body(results, index, scale)
    figure = plt.figure(figsize=(8.5, 6.0), layout="constrained")
    grid = figure.add_gridspec(1, 1)
    figure.suptitle(body.heading(), fontsize="large")
    if isinstance(body, Body2D):
        axes = figure.add_subplot(grid[0])
        body.draw(axes)
        fit_rows(grid, axes, lambda size: body.panel_height(size[0]))
    else:
        panel = body.add_panel(figure, grid[0], options.view)
        fit_rows(grid, panel, lambda size: body.panel_height(size[0], options.view))
        body.fill_panel(panel, options.view)
    return figure
