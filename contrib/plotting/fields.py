# SPDX-License-Identifier: LGPL-2.1-or-later
"""A field on the deformed body."""

import matplotlib.pyplot as plt
import numpy as np

from . import style
from .body import Body2D, Body3D, Scale, make_body


def scale(results, indices, options, name):
    return Scale(results, indices, name, options.magnification)


def draw(results, index, options, scale):
    body = make_body(results, index, scale)
    heading = style.title(results.name, results.solution[index][0], body.magnification)
    if isinstance(body, Body2D):
        height = float(np.clip(6.2 * body.aspect(), 2.0, 7.5))
        figure = plt.figure(figsize=(8.5, height + 1.5), layout="constrained")
        axes = figure.add_subplot()
        body.draw(axes)
        body.colour_bar(figure, cax=style.beside(axes))
    else:
        height = body.panel_height(6.4, options.view)
        figure = plt.figure(figsize=(8.0, height + 0.5), layout="constrained")
        axes = figure.add_subplot(projection="3d", computed_zorder=False)
        body.colour_bar(
            figure, ax=axes, location="left", shrink=0.75, pad=0.02, aspect=28
        )
        body.draw(axes, options.view)
    figure.suptitle(heading, fontsize="large")
    if isinstance(body, Body3D):
        body.fill_panel(axes, options.view)
    return figure
