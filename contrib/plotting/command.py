# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of contrib/plot."""

import argparse
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # draws to files, also without a display

import matplotlib.pyplot as plt

from . import (
    animation,
    contact,
    derived,
    effects,
    efficiency,
    errors,
    fields,
    history,
    hysteresis,
    lines,
    overview,
    quantities,
    stick_slip,
)
from . import study_pictures, style
from .body_3d import VIEW
from .body_base import available_fields
from .paraview import write_state
from .results import NoPicture, Results, UserError, number
from .study_pictures import is_study

DESCRIPTION = """\
Draw a directory of results.

pictures:
  overview    body, contact face and friction force (what is drawn if no
              picture is named; goes to RESULTS/<its name>.png)
  <field>     a field on the deformed body, by its name: von_mises,
              displacement, displacement_x, stress_xy, estimator, ...
              (--list names those of RESULTS)
  fields      all of them
  contact     the contact face: traction, slip, where it sticks
  history     the main columns of statistics.csv over time, or --columns
  errors      the estimated error by its causes over time, with cells and
              time steps
  efficiency  estimated over true errors of the cells of one output, where the
              scene has an exact solution
  hysteresis  force over displacement, with the area of the loop
  lines       fields along the lines of 'Output/Lines' at some times, or
              --columns
  stick-slip  map of stick and slip over arc length and time (2D)
All but the overview go to RESULTS/pictures/.  Axes show the units that the
scene declares, in handy multiples, or --units.

pictures of a study (a directory with study.csv), which go to RESULTS/:
  convergence     the error over mesh width and time step, with orders
  work-precision  the error over seconds, with the efficient frontier
  cost            seconds of each run by phase
Without a name all three; --error chooses another error.  Of many ways to compute
they show the best of each strategy; --all draws the others, too, four at a time.

The directory of a study of effects (with effects.json) has one picture, what
each effect changes and costs.
"""

EXAMPLES = """\
examples:
  contrib/plot output/block
  contrib/plot output/block von_mises displacement_x --time 1
  contrib/plot output/block contact history --format pdf
  contrib/plot output/block hysteresis --force friction_force_x \\
      --displacement point0_x
  contrib/plot output/block von_mises contact --animate
  contrib/plot output/block --all
  contrib/plot output/block --paraview
  contrib/plot output/study convergence --error error_stress,slip_area
doc/pictures.md shows what they look like.
"""

AT_A_TIME = {"overview": overview, "contact": contact}  # and fields
OVER_TIME = {
    "history": history,
    "errors": errors,
    "efficiency": efficiency,
    "hysteresis": hysteresis,
    "lines": lines,
    "stick-slip": stick_slip,
}
PICTURES = ("overview", "fields", "contact", *OVER_TIME)
STILL, MOVING = ("png", "pdf", "svg"), ("gif", "mp4")


def finite(text):
    """A number that is one, for argparse."""
    value = float(text)
    if not math.isfinite(value):
        raise ValueError
    return value


def positive(text):
    """A positive whole number, for argparse."""
    value = int(text)
    if value <= 0:
        raise ValueError
    return value


def names(text):
    return [name.strip() for name in text.split(",") if name.strip()]


def columns(text):
    """Names and expressions."""
    return derived.split(text, ",")


def units(text):
    """Length, time and stress, a dash for one without a unit, for argparse."""
    parts = names(text)
    if len(parts) != 3:
        raise ValueError
    given = zip(("length", "time", "stress"), parts)
    return {name: unit for name, unit in given if unit != "-"}


def named_place(text):
    """(coordinates, words) of X,Y=TEXT or X,Y,Z=TEXT."""
    place, _, words = text.partition("=")
    coordinates = [finite(part) for part in place.split(",")]
    if len(coordinates) not in (2, 3) or not words:
        raise ValueError
    return coordinates, words


def view(text):
    elevation, azimuth = (finite(part) for part in text.split(","))
    return elevation, azimuth


def window(text):
    """Lower left and upper right corner."""
    parts = [finite(part) for part in text.split(",")]
    low, high = parts[:2], parts[2:]
    if len(parts) != 4 or low[0] >= high[0] or low[1] >= high[1]:
        raise ValueError
    return low, high


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="contrib/plot",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "results", type=Path, metavar="RESULTS", help="directory of results"
    )
    parser.add_argument(
        "pictures", nargs="*", metavar="PICTURE", help="see above (default: overview)"
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help="every picture that these results have, to RESULTS/pictures/",
    )
    parser.add_argument(
        "--list",
        action="store_true",
        help="name the outputs, fields, forces, displacements and columns there are",
    )
    parser.add_argument(
        "--paraview",
        action="store_true",
        help="write a state for ParaView; paraview --state=RESULTS/view.py opens it",
    )
    time = parser.add_argument_group("which time").add_mutually_exclusive_group()
    time.add_argument(
        "--step", type=int, metavar="N", help="output number N (default: the last)"
    )
    time.add_argument(
        "--time", type=finite, metavar="T", help="the output nearest to T"
    )
    span = parser.add_argument_group("which times")
    span.add_argument(
        "--from",
        dest="begin",
        type=finite,
        metavar="T",
        help="history, hysteresis and stick-slip from T on",
    )
    span.add_argument("--until", type=finite, metavar="T", help="and until T")
    span.add_argument(
        "--log-time",
        action="store_true",
        help="history and errors over a logarithmic axis of time",
    )
    span.add_argument(
        "--animate",
        action="store_true",
        help="overview, contact and fields over all outputs, as a GIF",
    )
    what = parser.add_argument_group("what")
    what.add_argument(
        "--columns",
        type=columns,
        metavar="C,...",
        help="columns for history and lines; of history also expressions of them, "
        "such as friction_force_x/contact_force_y",
    )
    what.add_argument(
        "--overlay",
        type=Path,
        action="append",
        default=[],
        metavar="OTHER",
        help="another directory of results, drawn over the history in dashes; may be "
        "repeated",
    )
    what.add_argument("--force", metavar="F", help="for hysteresis")
    what.add_argument("--displacement", metavar="U", help="for hysteresis")
    what.add_argument(
        "--error",
        type=names,
        metavar="E,...",
        help="columns of study.csv for the pictures of a study",
    )
    how = parser.add_argument_group("how")
    how.add_argument(
        "--format",
        type=names,
        metavar="F,...",
        help="png (default), pdf, svg; gif (default), mp4 of animations",
    )
    how.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help="where a single picture goes; its suffix is the format",
    )
    how.add_argument(
        "--magnification",
        type=finite,
        metavar="M",
        help="of the displacement (default: 1 if it then shows, or more)",
    )
    how.add_argument(
        "--units",
        type=units,
        metavar="L,T,S",
        help="of length, time and stress, e.g. m,s,Pa, where the scene declares none",
    )
    how.add_argument(
        "--label",
        type=named_place,
        action="append",
        default=[],
        metavar="X,Y[,Z]=TEXT",
        help="words at a place of the body; in 3D also on the contact face",
    )
    how.add_argument(
        "--window",
        type=window,
        metavar="X,Y,X,Y",
        help="the part of a plane body between these two corners, with the whole "
        "beside it",
    )
    how.add_argument(
        "--mirror",
        action=argparse.BooleanOptionalAction,
        help="the other half of a body of revolution, too (default: where its section "
        "meets the axis)",
    )
    how.add_argument(
        "--view",
        type=view,
        default=VIEW,
        metavar="E,A",
        help="elevation and azimuth in degrees, 3D (default: {:g},{:g})".format(*VIEW),
    )
    how.add_argument(
        "--dpi", type=positive, default=130, help="dots per inch (default: %(default)s)"
    )
    options = parser.parse_intermixed_args(arguments)
    formats = options.format or []
    if options.output:
        if not options.output.name:
            parser.error(f"--output {options.output} is not the name of a file")
        if not options.output.suffix:
            options.output = options.output.with_suffix(".png")
        formats = [options.output.suffix.lstrip(".").lower()]
    if formats and formats[0] in MOVING:
        options.animate = True
    allowed = MOVING if options.animate else STILL
    for name in formats:
        if name not in allowed:
            parser.error(
                f'there is no format "{name}" '
                + ("of animations" if options.animate else "of pictures")
                + "; there are "
                + ", ".join(allowed)
            )
    options.formats = formats or [allowed[0]]
    several = len(options.pictures) > 1 or "fields" in options.pictures
    if is_study(options.results):
        several = len(options.pictures) != 1 or len(options.error or [None]) > 1
    if options.output and (several or options.all):
        parser.error("--output is for a single picture")
    if options.magnification is not None and not options.magnification > 0.0:
        parser.error("--magnification must be positive")
    if (
        (options.columns or options.overlay)
        and not options.pictures
        and not options.all
    ):
        options.pictures = ["history"]
    return options


class Jobs:
    """Draws pictures of one directory and tells where they are."""

    def __init__(self, results, options):
        self.results = results
        self.options = options

    def path(self, name, suffix, index=None):
        if self.options.output:
            return self.options.output
        directory = self.results.directory
        stem = name
        if name == "overview" and not self.options.all:
            stem = self.results.name
        else:
            directory = directory / "pictures"
        asked = self.options.step is not None or self.options.time is not None
        if index is not None and asked:
            stem += f"_{index:05d}"
        directory.mkdir(exist_ok=True)
        return directory / f"{stem}.{suffix}"

    def source(self):
        """What a PNG says of where it comes from."""
        try:
            about = self.results.info
        except UserError:
            about = {}
        words = (about.get(name) for name in ("version", "git_revision", "date"))
        return ", ".join([self.results.name, *filter(None, words)])

    def save(self, figure, name, index=None):
        for suffix in self.options.formats:
            path = self.path(name, suffix, index)
            figure.savefig(
                path,
                dpi=self.options.dpi,
                bbox_inches="tight",
                pad_inches=0.15,
                metadata={"Source": self.source()} if suffix == "png" else None,
            )
            print(path)
        plt.close(figure)

    def at_a_time(self, module, name, *arguments):
        """A picture of one output, or an animation of all."""
        results, options = self.results, self.options
        if options.animate:
            results.index()
            indices = range(len(results.solution))
            scale = module.scale(results, indices, options, *arguments)
            for suffix in options.formats:
                path = self.path(name, suffix)
                frames = (module.draw(results, i, options, scale) for i in indices)
                animation.write(path, frames, len(indices), options.dpi)
                print(path)
        else:
            index = results.index(options.step, options.time)
            scale = module.scale(results, [index], options, *arguments)
            self.save(module.draw(results, index, options, scale), name, index)

    def draw(self, name):
        if name in AT_A_TIME:
            self.at_a_time(AT_A_TIME[name], name)
        elif name not in OVER_TIME:
            self.at_a_time(fields, name, name)
        elif self.options.animate:
            raise NoPicture(f"{name} shows all times: there is no animation of it")
        else:
            self.save(OVER_TIME[name].draw(self.results, self.options), name)


def wanted(results, options):
    """The names of the pictures to draw, "fields" replaced by their names."""
    chosen = options.pictures or ["overview"]
    if options.all:
        chosen = list(PICTURES)
        if options.animate:
            chosen = ["overview", "von_mises", "contact"]
    if "fields" not in chosen or not results.solution:
        return [name for name in chosen if name != "fields"]
    body = results.body(results.index())
    # On one rank its number is no news.
    every = [
        name
        for name in available_fields(body)
        if name != "subdomain" or body[name].max() > 0.0
    ]
    at = chosen.index("fields")
    return chosen[:at] + every + chosen[at + 1 :]


def describe(results):
    """What --list prints."""
    statistics = results.statistics
    lines = []
    if results.solution:
        outputs = [f"{number(path)} (t = {time:g})" for time, path in results.solution]
        found = available_fields(results.body(results.index()))
        lines += ["outputs: " + ", ".join(outputs), "fields: " + ", ".join(found)]
    if len(statistics.get("t", ())):
        lines += ["forces: " + ", ".join(hysteresis.forces(statistics))]
        found = hysteresis.displacements(results, statistics)
        lines += ["displacements: " + ", ".join(found)]
        lines += ["columns: " + ", ".join(statistics)]
    return "\n".join(lines)


def main(arguments=None):
    options = parse(arguments)
    style.set_up()
    failed = drawn = 0
    try:
        if is_study(options.results):
            return study_pictures.main(options)
        if effects.is_there(options.results):
            return effects.main(options)
        if options.error:
            raise UserError(
                f"{options.results} holds no study.csv, so it has no errors to draw"
            )
        results = Results(options.results)
        quantities.set_scene(results)
        if options.units:
            results.units = options.units
        if options.list:
            print(describe(results))
            return 0
        if options.paraview:
            print(write_state(results))
            if not options.pictures and not options.all:
                return 0
        jobs = Jobs(results, options)
        for name in wanted(results, options):
            try:
                jobs.draw(name)
                drawn += 1
            except NoPicture as reason:
                if options.all:
                    print(f"Not drawn: {name}: {reason}", file=sys.stderr)
                else:
                    print(f"Error: {reason}", file=sys.stderr)
                    failed += 1
    except (UserError, OSError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    return 1 if failed or not drawn else 0
