# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sizes of panels and places of color bars.

What surrounds a panel, its labels, legends and color bars, has a size in
inches that only matplotlib knows.  Figures are therefore laid out once, and
then get the height that their panels need.
"""
from .units import Numbers, Ticks

FLAT = 0.45  # height over width of panels with the color bar underneath


def is_flat(aspect):
    """Whether the label of a color bar beside the panel would stick out."""
    return aspect < FLAT


def add_color_bar(axes, mappable, label, unit, flat, **options):
    """A color bar beside the panel, as high as it, or under a flat one."""
    figure = axes.figure
    if flat:
        axes.set_anchor("S")  # no gap between panel and bar
        bar = figure.colorbar(
            mappable, ax=axes, location="bottom", shrink=0.8, aspect=34, **options
        )
    else:
        width = 0.18 / axes.get_position().width / figure.get_figwidth()
        cax = axes.inset_axes((1.0 + 1.2 * width, 0.0, width, 1.0))
        bar = figure.colorbar(mappable, cax=cax, **options)
    number_bar(bar, label, unit)
    return bar


def number_bar(bar, label, unit):
    """Label a color bar and number it in a unit."""
    bar.set_ticks(Ticks(unit.size))
    bar.formatter = Numbers(unit.size)
    bar.update_ticks()
    bar.set_label(label)


def cell(axes):
    """Width and height in inches of the cell of the layout that axes are in."""
    box = axes.get_position(original=True)
    return axes.figure.get_size_inches() * (box.width, box.height)


def fit_rows(grid, axes, needed):
    """Give a figure the height with which the first row of its grid fits.

    axes    in that row
    needed  its height in inches, a function of the size of their cell

    The heights of the other rows are their height ratios in inches.
    """
    figure = axes.figure
    # The layout takes what a fixed aspect leaves empty for room for labels.
    fixed = [(other, other.get_aspect()) for other in figure.axes]
    for other, _ in fixed:
        other.set_aspect("auto")
    for _ in range(2):  # a width may change with a height, by a tick label
        figure.draw_without_rendering()
        size = cell(axes)
        heights = grid.get_height_ratios()
        around = figure.get_figheight() - size[1] * sum(heights) / heights[0]
        heights = [needed(size), *heights[1:]]
        grid.set_height_ratios(heights)
        figure.set_figheight(around + sum(heights))
    for other, aspect in fixed:
        other.set_aspect(aspect)
