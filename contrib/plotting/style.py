# SPDX-License-Identifier: LGPL-2.1-or-later
"""Colors, labels and numbers, the same in all pictures.

Colors are those of Okabe and Ito, which readers with any color vision can
tell apart; maps are viridis, whose dark end is next to zero, grays, and a red-blue one for
signed fields.
"""

import math
import re

import matplotlib
import matplotlib.patheffects
import numpy as np
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.scale import LinearScale, register_scale
from matplotlib.ticker import FixedLocator, NullFormatter

from .quantities import plain
from .results import UserError
from .units import Numbers

SLIP = "#d55e00"
STICK = "#ffffff"
FRICTIONLESS = "#b3b3b3"
OPEN = "#a6d5ee"
OUTLINE = "#555555"
SERIES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
COMPONENT = {"x": SERIES[0], "y": SERIES[4], "z": SERIES[2]}
DASHES = {"x": "-", "y": "--", "z": "-."}

SLIPPING, STICKING, NO_FRICTION, NO_CONTACT = 1, 0, -1, -2
STATE_COLORS = {
    SLIPPING: SLIP,
    STICKING: STICK,
    NO_FRICTION: FRICTIONLESS,
    NO_CONTACT: OPEN,
}
STATE_NAMES = {
    SLIPPING: "slip",
    STICKING: "stick",
    NO_FRICTION: "no friction",
    NO_CONTACT: "no contact",
}

class Linear(LinearScale):
    """The linear scale of matplotlib without detached powers of ten."""

    def set_default_locators_and_formatters(self, axis):
        super().set_default_locators_and_formatters(axis)
        axis.set_major_formatter(Numbers())


def set_up():
    register_scale(Linear)
    matplotlib.rcParams.update(
        {
            "font.size": 10.5,
            "axes.titlesize": "medium",
            "axes.formatter.limits": (-3, 4),
            "axes.formatter.use_mathtext": True,
            "legend.fontsize": "small",
            "lines.linewidth": 1.6,
            "savefig.facecolor": "white",
            "pdf.fonttype": 42,  # text stays text
            "svg.fonttype": "none",
        }
    )


def short(value, digits=4):
    """A number for a caption."""
    text = f"{value:.{digits}g}"
    match = re.fullmatch(r"(-?[\d.]+)e([+-])0*(\d+)", text)
    if not match:
        return text
    sign = "-" if match.group(2) == "-" else ""
    exponent = f"10^{{{sign}{match.group(3)}}}"
    if match.group(1) == "1":
        return f"${exponent}$"
    return rf"${match.group(1)}\times{exponent}$"


class Shade:
    """How values become colors, the same for all frames of an animation.

    Corner singularities must not darken the rest of the body, so the colors
    end where a `share` of the values does if a few lie far beyond.  Fields of
    both signs get a map whose white is zero.

    weights  of the values, such as how long they last
    """

    def __init__(self, values, what, share=0.995, weights=None, beyond=1.15):
        values = np.asarray(values, dtype=float)
        if not np.isfinite(values).all():
            raise UserError(f"{what} contains values that are not finite")
        low, high = values.min(), values.max()
        size = max(abs(low), abs(high))
        if min(-low, high) > 0.02 * size:
            limit, is_beyond = robust(np.abs(values), share, weights, beyond)
            low, high = -limit, limit
            self.map = matplotlib.colormaps["RdBu_r"]
            above, below = values.max() > limit, values.min() < -limit
        else:
            # Dark is the end next to zero, and zero itself where it is near.
            negative = high <= 0.0 and low < 0.0
            self.map = matplotlib.colormaps["viridis_r" if negative else "viridis"]
            above = below = False
            if negative:
                limit, below = robust(-values, share, weights, beyond)
                low = -limit
                high = 0.0 if high > NEAR_ZERO * low else high
            else:
                high, above = robust(values, share, weights, beyond)
                low = 0.0 if 0.0 < low < NEAR_ZERO * high else low
            is_beyond = above or below
        if high - low <= 1e-9 * max(abs(low), abs(high), 1e-300):
            middle = 0.5 * (low + high)
            low, high = middle - 0.5 * (size or 1.0), middle + 0.5 * (size or 1.0)
        self.extend = {
            (False, False): "neither",
            (True, False): "max",
            (False, True): "min",
            (True, True): "both",
        }[(bool(above and is_beyond), bool(below and is_beyond))]
        self.norm = Normalize(low, high)

    def ends(self):
        return self.norm.vmin, self.norm.vmax

    def mappable(self):
        return matplotlib.cm.ScalarMappable(self.norm, self.map)

    def colors(self, values):
        return self.map(self.norm(values))


NEAR_ZERO = 0.3  # of the largest value: colors then begin with zero
# Where a corner has a node in thirty, and lies far beyond.
FEW = {"share": 0.98, "beyond": 1.5}


def robust(values, share, weights=None, beyond=1.15):
    """An upper end for colors or axes, and whether some values lie above it: that
    `share` of what is not zero is below it, if the largest is so much `beyond`. One
    or none of a few values says nothing."""
    there = values > 0.0
    ordered = np.argsort(values[there])
    largest = values.max()
    if len(ordered) < 20:
        return largest, False
    below = np.cumsum((np.ones_like(values) if weights is None else weights)[there][ordered])
    place = np.searchsorted(below, share * below[-1])
    # The largest alone may have more than the rest of the share.
    quantile = values[there][ordered[min(place, len(ordered) - 2)]]
    return (largest, False) if largest < beyond * quantile else (quantile, True)


def range_label(shade, label, values, unit, separator=" "):
    """The label of a color bar with how far `values` go beyond its ends."""
    low, high = (short(end / unit.size, 3) for end in (values.min(), values.max()))
    if values.size and values.max() != 0.0 and np.ptp(values) <= 1e-9 * abs(values.max()):
        return f"{unit.label(label)}{separator}({high} throughout)"
    beyond = {
        "neither": "",
        "max": f"{separator}(at most {high})",
        "min": f"{separator}(at least {low})",
        "both": f"{separator}({low} to {high})",
    }
    return unit.label(label) + beyond[shade.extend]


def rounded_magnification(largest, size):
    """1 where the deformation shows, otherwise 1, 2 or 5 times 10^k."""
    if largest <= 1e-200 * size or not math.isfinite(largest):
        return 1.0
    if largest > 0.02 * size:
        return 1.0
    wanted = 0.07 * size / largest
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(m for m in (1, 2, 5) if m * power <= wanted)


def next_smaller(magnification):
    """The next of the numbers 1, 2 or 5 times 10^k."""
    power = 10.0 ** math.floor(math.log10(magnification * 1.0001))
    leading = round(magnification / power)
    return power * {1: 0.5, 2: 1.0, 5: 2.0}[leading]


def title(name, what, time=None, magnification=None):
    """What a picture shows: of which run, and when."""
    text = f"{plain(name)}: {what}"
    if time is not None:
        text += f" at $t$ = {time}"
    if magnification == 1.0:
        return text + ", true displacement"
    if magnification is not None:
        return text + f", displacement × {short(magnification)}"
    return text


def state_legend(states):
    """Keys of the states that occur.  White sticks need an edge on paper."""
    return [
        Line2D(
            [],
            [],
            color=STATE_COLORS[state],
            lw=4,
            label=STATE_NAMES[state],
            path_effects=[
                matplotlib.patheffects.Stroke(linewidth=6, foreground="black"),
                matplotlib.patheffects.Normal(),
            ],
        )
        for state in STATE_NAMES
        if (np.asarray(states) == state).any()
    ]


# Words on a picture of a body.
LABEL = {
    "fontsize": "small",
    "ha": "center",
    "va": "center",
    "bbox": {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.75},
}


def visible_anywhere(width=2.6):
    """A white border, for lines on dark and on light colors."""
    return [
        matplotlib.patheffects.Stroke(linewidth=width, foreground="white", alpha=0.8),
        matplotlib.patheffects.Normal(),
    ]


def legend_above(axes, handles, most=6):
    """Keys above a panel, at most so many in a row."""
    if handles:
        rows = -(-len(handles) // most)
        axes.legend(
            handles=handles,
            loc="lower center",
            bbox_to_anchor=(0.5, 1.02),
            ncol=-(-len(handles) // rows),
            frameon=False,
            columnspacing=1.4,
            handlelength=1.8,
        )


def numbers_on_logarithmic_axis(axis, factor=1.0):
    """Enough numbers on an axis of any span, with its limits as they are now.

    factor  between the values and the numbers, 100 for percent
    """
    low, high = (factor * end for end in sorted(axis.get_view_interval()))
    decades = math.log10(high / low)
    steps = (1, 2, 5) if decades < 2.2 else (1, 3) if decades < 3.2 else (1,)
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    numbers = [step * 10.0**power for power in powers for step in steps]
    axis.set_major_locator(FixedLocator([n / factor for n in numbers if low <= n <= high]))
    if decades < 5.0:
        axis.set_major_formatter(lambda value, _: short(value * factor))
    else:
        axis.set_major_formatter(
            lambda value, _: f"$10^{{{round(math.log10(value * factor))}}}$"
        )
    axis.set_minor_formatter(NullFormatter())
