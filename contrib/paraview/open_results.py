# SPDX-License-Identifier: LGPL-2.1-or-later
"""ParaView opens a directory of results, ready colored.

The body is warped by its displacement and colored by the von Mises stress;
on the contact face slip, stick and places without friction have the colors
of contrib/plot.  In three dimensions a second view shows that face from the
foundation, with arrows for the slip.  The time is that of the last output.

    contrib/plot RESULTS --paraview    writes RESULTS/view.py, this file with
                                       the directory filled in; open it with
    paraview --state=RESULTS/view.py   or File > Load State in ParaView

Without contrib/plot, in the directory of results or with its name in the
variable VISCOPLASTIC_RESULTS:

    paraview --script=.../contrib/paraview/open_results.py

Without a window, and for a state file that needs no script (Debian's ParaView
cannot draw without a display; xvfb-run, package xvfb, lends it one):

    xvfb-run pvbatch open_results.py RESULTS --screenshot FILE.png \\
      --state FILE.pvsm
"""

import argparse
import json
import math
import os
import sys

import paraview.simple as pv

RESULTS = None
SERIES = "solution.pvd", "solution.xdmf"

SLIP = (0.835, 0.369, 0.0)
STICK = (1.0, 1.0, 1.0)
NO_FRICTION = (0.6, 0.6, 0.6)
PAPER = (0.87, 0.87, 0.87)  # white sticks have to be seen on it
INK = (0.1, 0.1, 0.1)


def parse():
    """The arguments of pvbatch and pvpython; ParaView's window has none."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("results", nargs="?")
    parser.add_argument("--screenshot", metavar="FILE.png")
    parser.add_argument("--state", metavar="FILE.pvsm")
    return parser.parse_args(sys.argv[1:] if is_script() else [])


def is_script():
    return len(sys.argv) > 1 and sys.argv[0].endswith(".py")


def find(directory):
    """The directory of results, as an absolute path.

    Results that have been moved are found beside this file or from where
    ParaView was started.
    """
    asked = directory or os.environ.get("VISCOPLASTIC_RESULTS")
    here = os.path.dirname(globals().get("__file__") or "")
    places = [asked] if asked else [RESULTS or ".", here or ".", "."]
    for place in map(os.path.abspath, places):
        if any(os.path.exists(os.path.join(place, name)) for name in SERIES):
            return place
    raise SystemExit(
        f"Error: {os.path.abspath(places[0])} holds no solution.pvd, so it is no "
        "directory of results"
    )


def magnification(largest, size):
    """1 where the deformation shows, otherwise 1, 2 or 5 times 10^k."""
    if largest <= 0.0 or largest > 0.02 * size:
        return 1.0
    wanted = 0.07 * size / largest
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(m for m in (1, 2, 5) if m * power <= wanted)


class Box:
    """Center of mass and extents of what a source shows."""

    def __init__(self, source):
        bounds = source.GetDataInformation().GetBounds()
        integral = pv.IntegrateVariables(Input=source)
        self.center = list(pv.servermanager.Fetch(integral).GetPoint(0))
        pv.Delete(integral)
        self.extent = [bounds[2 * d + 1] - bounds[2 * d] for d in range(3)]
        self.size = max(self.extent)


def last_time(reader):
    return max(reader.TimestepValues, default=0.0)


def read(path, name):
    """A series at its last time, or None where it is missing or empty."""
    if not os.path.exists(path):
        return None
    if path.endswith(".xdmf"):
        reader = pv.XDMFReader(registrationName=name, FileNames=[path])
    else:
        reader = pv.PVDReader(registrationName=name, FileName=path)
    reader.UpdatePipeline(last_time(reader))
    if reader.GetDataInformation().GetNumberOfPoints() == 0:
        return None
    return reader


def named(source, name):
    """The name of a field as it is there, which a unit may follow: `slip [m]'."""
    names = [array.Name for data in (source.PointData, source.CellData) for array in data]
    return next((n for n in names if n.split(" [")[0] == name), name)


def largest(source, name):
    name = named(source, name)
    array = source.PointData.GetArray(name) or source.CellData.GetArray(name)
    return array.GetRange(-1)[1] if array else 0.0


def warp(reader, name, factor):
    warped = pv.WarpByVector(registrationName=name, Input=reader)
    warped.Vectors = ["POINTS", named(reader, "displacement")]
    warped.ScaleFactor = factor
    warped.UpdatePipeline(pv.GetAnimationScene().AnimationTime)
    return warped


def prepare(view):
    view.UseColorPaletteForBackground = 0
    view.Background = PAPER
    view.OrientationAxesLabelColor = INK
    return view


def show_bar(lut, view, title, place, length):
    bar = pv.GetScalarBar(lut, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleColor = bar.LabelColor = INK
    bar.TitleFontSize, bar.LabelFontSize = 15, 13
    bar.TextPosition = "Ticks left/bottom, annotations right/top"
    bar.Orientation = "Horizontal"
    bar.WindowLocation = "Any Location"
    bar.Position = place
    bar.ScalarBarLength = length
    return bar


def show_body(warped, view, flat):
    display = pv.Show(warped, view)
    display.Representation = "Surface With Edges"
    display.EdgeColor = (0.55, 0.55, 0.55)
    field = named(warped, "von_mises")
    # In HDF5 means are data of cells.
    is_nodal = warped.PointData.GetArray(field) is not None
    pv.ColorBy(display, ("POINTS" if is_nodal else "CELLS", field))
    lut = pv.GetColorTransferFunction(field)
    lut.ApplyPreset("Viridis (matplotlib)", True)
    lut.RescaleTransferFunction(0.0, largest(warped, "von_mises") or 1.0)
    lut.AutomaticRescaleRangeMode = "Grow and update every timestep"
    display.SetScalarBarVisibility(view, True)
    bar = show_bar(
        lut, view, field.replace("von_mises", "von Mises stress"), (0.08, 0.1), 0.4
    )
    bar.UseCustomLabels, bar.RangeLabelFormat = 0, "%-#.3g"
    if flat:
        display.Ambient, display.Diffuse = 1.0, 0.0  # no light from an angle
    else:
        display.Ambient, display.Diffuse = 0.35, 0.65


def add_state(contact):
    """The state as one field: 1 slip, 0 stick, -1 no friction."""
    state = pv.Calculator(registrationName="state", Input=contact)
    state.ResultArrayName = "state"
    has_friction = contact.PointData.GetArray("stick") is not None
    bound = named(contact, "bound")
    bound = f'"{bound}"' if " " in bound else bound
    state.Function = f"if ({bound} > 0, 1 - stick, -1)" if has_friction else "-1"
    state.UpdatePipeline(last_time(contact))
    return state


def state_colors(source):
    """A map of three steps, and what they mean."""
    lut = pv.GetColorTransferFunction("state")
    lut.AutomaticRescaleRangeMode = "Never"
    lut.ColorSpace = "Step"
    lut.Discretize = 0
    steps = (  # a color holds up to its value
        (-0.5, NO_FRICTION, "no friction"),
        (0.5, STICK, "stick"),
        (1.5, SLIP, "slip"),
    )
    if source.PointData.GetArray("stick") is None:
        steps = steps[:1]
    points = [(-1.5, NO_FRICTION), *((end, rgb) for end, rgb, _ in steps)]
    lut.RGBPoints = [number for value, rgb in points for number in (value, *rgb)]
    return lut, ", ".join(name for _, _, name in steps)


def show_state(source, view, size, flat, shift=None):
    """shift: the direction off the body, in the view of that in 3D."""
    display = pv.Show(source, view)
    display.Representation = "Surface"
    display.InterpolateScalarsBeforeMapping = 1
    pv.ColorBy(display, ("POINTS", "state"))
    display.Ambient, display.Diffuse = 1.0, 0.0  # white is white from every side
    if flat:
        # A band in front of the body, on a wider one that outlines it.
        display.LineWidth = 7.0
        display.Position = (0.0, 0.0, 2e-3 * size)
        back = pv.ExtractSurface(registrationName="outline of the band", Input=source)
        back_display = pv.Show(back, view)
        pv.ColorBy(back_display, None)
        back_display.AmbientColor = back_display.DiffuseColor = INK
        back_display.Ambient, back_display.Diffuse = 1.0, 0.0
        back_display.LineWidth = 11.0
        back_display.Position = (0.0, 0.0, 1e-3 * size)
    if not flat and shift:
        display.Position = [2e-3 * size * d for d in shift]
    else:
        display.SetScalarBarVisibility(view, True)
    lut, names = state_colors(source)  # last: what is before rescales the map
    if not flat and shift:
        return  # the other view has the bar
    bar = show_bar(lut, view, names, (0.57 if flat else 0.32, 0.1), 0.35)
    bar.DrawTickLabels = bar.DrawTickMarks = bar.AddRangeLabels = 0
    bar.DrawAnnotations = 0


def show_arrows(source, view, size):
    longest = largest(source, "slip")
    if longest <= 0.0:
        return
    arrows = pv.Glyph(registrationName="slip", Input=source, GlyphType="Arrow")
    arrows.OrientationArray = ["POINTS", named(source, "slip")]
    arrows.ScaleArray = ["POINTS", named(source, "slip")]
    arrows.ScaleFactor = 0.1 * size / longest
    arrows.GlyphMode = "Every Nth Point"  # one corner of some faces
    arrows.Stride = 4 * max(1, source.GetDataInformation().GetNumberOfCells() // 250)
    display = pv.Show(arrows, view)
    pv.ColorBy(display, None)
    display.AmbientColor = display.DiffuseColor = INK


def time_unit(directory):
    """" day", as run.json has it, or nothing."""
    try:
        with open(os.path.join(directory, "run.json"), encoding="utf-8") as file:
            return " " + json.load(file)["units"]["time"]
    except (OSError, ValueError, LookupError, TypeError):
        return ""


def show_time(reader, view, unit):
    annotation = pv.AnnotateTimeFilter(registrationName="time", Input=reader)
    version = pv.GetParaViewVersion()
    modern = (version.major, version.minor) >= (5, 10)
    annotation.Format = ("t = {time:g}" if modern else "t = %g") + unit
    display = pv.Show(annotation, view)
    display.Color = INK
    display.FontSize = 14
    display.WindowLocation = "Upper Center"


def outwards(body, face):
    """From the body towards the foundation: a normal of the face, or so."""
    away = [face.center[d] - body.center[d] for d in range(3)]
    for d in range(3):
        if face.extent[d] <= 1e-6 * face.size:
            return [math.copysign(1.0, away[d]) if i == d else 0.0 for i in range(3)]
    length = math.sqrt(sum(a * a for a in away))
    return [a / length for a in away] if length > 0.0 else [0.0, 0.0, -1.0]


def look_from_foundation(view, body, face):
    normal = outwards(body, face)
    up = [0.0, 0.0, 1.0]
    if 1.0 in map(abs, normal):
        # The first axis of space across the normal points to the right.
        right = normal.index(0.0)
        e = [float(d == right) for d in range(3)]
        up = [
            normal[(d + 1) % 3] * e[(d + 2) % 3] - normal[(d + 2) % 3] * e[(d + 1) % 3]
            for d in range(3)
        ]
    view.CameraParallelProjection = 1
    view.CameraFocalPoint = face.center
    away = 3.0 * face.size
    view.CameraPosition = [face.center[d] + away * normal[d] for d in range(3)]
    view.CameraViewUp = up
    view.CameraParallelScale = max(0.8 * face.size, 0.58 * math.hypot(*face.extent))


def look_at_body(view, flat):
    if flat:
        view.InteractionMode = "2D"
    else:
        view.CameraPosition = (1.4, -2.0, 1.0)
        view.CameraFocalPoint = (0.0, 0.0, 0.0)
        view.CameraViewUp = (0.0, 0.0, 1.0)
    view.CameraParallelProjection = 1
    pv.ResetCamera(view)
    view.CameraParallelScale *= 1.0 if flat else 1.25
    # Up a little: the color bars are below.
    shift = 0.1 * view.CameraParallelScale
    for name in ("CameraPosition", "CameraFocalPoint"):
        place = list(getattr(view, name))
        place[1 if flat else 2] -= shift
        setattr(view, name, place)


def main():
    options = parse()
    directory = find(options.results)
    series = [os.path.join(directory, name) for name in SERIES]
    solution = next(filter(None, (read(path, "solution") for path in series)), None)
    if solution is None:
        raise SystemExit(f"Error: solution.pvd in {directory} contains no cells")
    contact = read(os.path.join(directory, "contact.pvd"), "contact")

    body = Box(solution)
    flat = body.extent[2] == 0.0
    factor = magnification(largest(solution, "displacement"), body.size)
    view = prepare(pv.GetActiveViewOrCreate("RenderView"))
    scene = pv.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.GoToLast()
    warped = warp(solution, f"body, displacement x {factor:g}", factor)
    show_body(warped, view, flat)
    show_time(solution, view, time_unit(directory))
    if contact is not None:
        state = add_state(contact)
        moved = warp(state, f"contact, displacement x {factor:g}", factor)
        face = Box(contact)
        show_state(moved, view, body.size, flat, outwards(body, face))
        if not flat:
            layout = pv.GetLayout(view)
            layout.SplitHorizontal(0, 0.55)
            below = prepare(pv.CreateView("RenderView"))
            pv.AssignViewToLayout(view=below, layout=layout, hint=2)
            show_state(state, below, body.size, flat)
            show_arrows(state, below, face.size)
            look_from_foundation(below, body, face)

    look_at_body(view, flat)
    pv.SetActiveView(view)
    pv.SetActiveSource(warped)

    layout = pv.GetLayout(view)
    if is_script():
        layout.SetSize(1200 if flat or contact is None else 1800, 800)
    pv.RenderAllViews()
    if options.state:
        pv.SaveState(options.state)
    if options.screenshot:
        pv.SaveScreenshot(options.screenshot, layout=layout)


main()
