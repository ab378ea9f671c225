# SPDX-License-Identifier: LGPL-2.1-or-later
"""Colours, labels and numbers, the same in all pictures.

Colours are those of Okabe and Ito, which readers with any colour vision can
tell apart; maps are viridis, cividis and a red-blue one for signed fields.
Results carry no units: labels name quantities by their symbols, the numbers
are in the units of the scene.
"""

import math
import re

import matplotlib
import matplotlib.patheffects
import numpy as np
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.scale import LinearScale, register_scale
from matplotlib.ticker import FixedLocator, NullFormatter, ScalarFormatter

from .results import UserError

SLIP = "#d55e00"
STICK = "#ffffff"
FRICTIONLESS = "#b3b3b3"
OUTLINE = "#555555"
SERIES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
COMPONENT = {"x": SERIES[0], "y": SERIES[4], "z": SERIES[2]}
DASHES = {"x": "-", "y": "--", "z": "-."}

SLIPPING, STICKING, NO_FRICTION = 1, 0, -1
STATE_COLOURS = {SLIPPING: SLIP, STICKING: STICK, NO_FRICTION: FRICTIONLESS}
STATE_NAMES = {SLIPPING: "slip", STICKING: "stick", NO_FRICTION: "no friction"}

SCALARS = {
    "von_mises": r"von Mises stress $\sigma_\mathrm{vM}$",
    "creep_strain": r"equivalent creep strain $\varepsilon_\mathrm{c}$",
    "creep_rate": r"equivalent creep rate $\dot\varepsilon_\mathrm{c}$",
    "pressure": r"pressure $-\mathrm{tr}\,\sigma/3$",
    "estimator": r"error estimator $\eta_K$",
    "error_energy": r"true error $\Vert u-u_h\Vert_{a,K}$",
    "recovery": "error by recovered strain",
    "subdomain": "MPI rank",
}
VECTORS = {
    "displacement": ("displacement", "u"),
    "velocity": ("velocity", r"\dot{u}"),
}
TENSORS = {
    "stress": ("stress", r"\sigma"),
    "irreversible_stress": ("irreversible stress", "z"),
    "strain": ("strain", r"\varepsilon"),
    "irreversible_strain": ("irreversible strain", r"\varepsilon^\mathrm{i}"),
    "principal_stress": ("principal stress", r"\sigma"),
}


class PlainNumbers(ScalarFormatter):
    """Tick labels as text, which matplotlib would parse as mathematics, each of
    them: half of the time of a picture.  Their power of ten stays mathematics."""

    def __call__(self, x, pos=None):
        label = super().__call__(x, pos)
        return label.removeprefix(r"$\mathdefault{").removesuffix("}$")


class Linear(LinearScale):
    """The linear scale of matplotlib with these labels."""

    def set_default_locators_and_formatters(self, axis):
        super().set_default_locators_and_formatters(axis)
        axis.set_major_formatter(PlainNumbers())


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


def plain(text):
    """A name as it is, not as mathematics."""
    return text.replace("$", r"\$")


def field_label(name):
    if name in SCALARS:
        return SCALARS[name]
    if name in VECTORS:
        word, symbol = VECTORS[name]
        return f"{word} $|{symbol}|$"
    stem, _, component = name.rpartition("_")
    if stem in VECTORS:
        word, symbol = VECTORS[stem]
        return f"{word} ${symbol}_{component}$"
    if stem in TENSORS:
        word, symbol = TENSORS[stem]
        return f"{word} ${symbol}_{{{component}}}$"
    return plain(name)


def short(value):
    """A number for a caption."""
    text = f"{value:.4g}"
    match = re.fullmatch(r"(-?[\d.]+)e([+-])0*(\d+)", text)
    if not match:
        return text
    sign = "-" if match.group(2) == "-" else ""
    exponent = f"10^{{{sign}{match.group(3)}}}"
    if match.group(1) == "1":
        return f"${exponent}$"
    return rf"${match.group(1)}\times{exponent}$"


class Shade:
    """How values become colours, the same for all frames of an animation.

    Corner singularities must not darken the rest of the body, so the colours
    end at the 99.5 % quantile where a few values lie far beyond.  Fields of
    both signs get a map whose white is zero.
    """

    def __init__(self, values, what):
        values = np.asarray(values, dtype=float)
        if not np.isfinite(values).all():
            raise UserError(f"{what} contains values that are not finite")
        low, high = values.min(), values.max()
        size = max(abs(low), abs(high))
        if min(-low, high) > 0.02 * size:
            limit, beyond = robust(np.abs(values))
            low, high = -limit, limit
            self.map = matplotlib.colormaps["RdBu_r"]
            above, below = values.max() > limit, values.min() < -limit
        else:
            self.map = matplotlib.colormaps["viridis"]
            above = below = False
            if high <= 0.0 and low < 0.0:
                limit, below = robust(-values)
                low = -limit
            else:
                high, above = robust(values)
            beyond = above or below
        if high - low <= 1e-9 * max(abs(low), abs(high), 1e-300):
            middle = 0.5 * (low + high)
            low, high = middle - 0.5 * (size or 1.0), middle + 0.5 * (size or 1.0)
        self.extend = {
            (False, False): "neither",
            (True, False): "max",
            (False, True): "min",
            (True, True): "both",
        }[(bool(above and beyond), bool(below and beyond))]
        self.norm = Normalize(low, high)

    def mappable(self):
        return matplotlib.cm.ScalarMappable(self.norm, self.map)

    def colours(self, values):
        return self.map(self.norm(values))


def robust(values):
    """An upper end for colours, and whether some values lie above it."""
    quantile, largest = np.quantile(values, 0.995), values.max()
    if quantile <= 0.0 or largest < 1.15 * quantile:
        return largest, False
    return quantile, True


def range_label(shade, label, values, separator=" "):
    """The label of a colour bar with how far `values` go beyond its ends."""
    low, high = short(values.min()), short(values.max())
    beyond = {
        "neither": "",
        "max": f"{separator}(at most {high})",
        "min": f"{separator}(at least {low})",
        "both": f"{separator}({low} to {high})",
    }
    return label + beyond[shade.extend]


def rounded_magnification(largest, size):
    """1 where the deformation shows, otherwise 1, 2 or 5 times 10^k."""
    if largest <= 1e-200 * size or not math.isfinite(largest):
        return 1.0
    if largest > 0.02 * size:
        return 1.0
    wanted = 0.07 * size / largest
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(m for m in (1, 2, 5) if m * power <= wanted)


def title(name, time, magnification=None):
    text = f"{plain(name)}   t = {short(time)}"
    if magnification == 1.0:
        return text + "   (true displacement)"
    if magnification is not None:
        return text + f"   (displacement × {short(magnification)})"
    return text


def state_legend(states):
    """Keys of the states that occur.  White sticks need an edge on paper."""
    return [
        Line2D(
            [],
            [],
            color=STATE_COLOURS[state],
            lw=4,
            label=STATE_NAMES[state],
            path_effects=[
                matplotlib.patheffects.Stroke(linewidth=6, foreground="black"),
                matplotlib.patheffects.Normal(),
            ],
        )
        for state in (SLIPPING, STICKING, NO_FRICTION)
        if (np.asarray(states) == state).any()
    ]


def legend_above(axes, handles, columns=None):
    if handles:
        axes.legend(
            handles=handles,
            loc="lower center",
            bbox_to_anchor=(0.5, 1.02),
            ncol=columns or len(handles),
            frameon=False,
        )


def numbers_on_logarithmic_axis(axis, factor=1.0):
    """Enough numbers on an axis of any span, with its limits as they are now.

    factor  between the values and the numbers, 100 for percent
    """
    low, high = sorted(axis.get_view_interval())
    decades = math.log10(high / low)
    steps = (1, 2, 5) if decades < 2.2 else (1, 3) if decades < 3.2 else (1,)
    first, last = math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1
    ticks = [
        step * 10.0**power / factor
        for power in range(first + round(math.log10(factor)), last + 4)
        for step in steps
    ]
    axis.set_major_locator(FixedLocator([t for t in ticks if low <= t <= high]))
    axis.set_major_formatter(lambda value, _: short(value * factor))
    axis.set_minor_formatter(NullFormatter())
