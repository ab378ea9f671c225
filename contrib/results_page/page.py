# SPDX-License-Identifier: LGPL-2.1-or-later
"""doc/accuracy.md: the sentences between what is computed.

Each computed part stands between <!-- PIECE --> and <!-- end -->.  The page is
written anew each time; parts that have not been computed now are taken from
the page as it was.
"""

import re

from plotting.results import UserError

from . import plan

NOT_YET = "(not computed yet)\n"

TEMPLATE = """\
# What accuracy costs

Made by `contrib/make_results`, which runs the program on the scenes named
below, draws the pictures and writes every number of this page. The line under
each part names version, machine and date. Errors are relative: the largest of
all steps over the largest norm of the solution; where they are differences to a
finer run, of the steps that end a phase of `Time/Phases`.

- [How to read this page](#how-to-read-this-page)
- [Orders of convergence](#orders-of-convergence)
- [What an error costs](#what-an-error-costs)
- [Runs to a tolerance](#runs-to-a-tolerance)
- [What the tolerance of the solver is worth](#what-the-tolerance-of-the-solver-is-worth)
- [Reference cases](#reference-cases)

A study of your own scene makes the same pictures and prices:

    contrib/study scene.prm
    contrib/plot output/scene/study

## How to read this page

**A study** runs a scene on a ladder of mesh widths $h$ and time steps $k$, each
half of the one before: $h$ alone with the finest steps, $k$ alone on the finest
mesh, and both. Where the scene has an exact solution, errors are those of the
discrete one; elsewhere they are differences to a run with half of the finest
$h$ and $k$, so that an error of the finest run of a first-order method comes
out about half as large as it is. That run has a uniform mesh: near
singularities adaptive runs can be better than it, and their curves level out at
its error. Scenes with `Error control/Tolerance` are compared with a run to half
of it instead, which has the cells where they matter.

**Convergence.** In logarithmic scales an error $C h^p$ is a straight line with
slope $p$, which the triangles show. A curve that becomes flat has met the part
of the error that its ladder leaves alone: where the curve of $h$ alone levels
out, smaller cells buy nothing before the steps become smaller, too. The dotted
line is the fit $C_h h^p+C_k k^q$ of all runs of a way to compute, drawn where it is
within 10 % of the finest runs; prices are read off it, and the tables of fits say
how far it misses the others. In the gray below, differences say more of the error
that the reference itself is estimated to have than of the run: curves level out
there, or fall without a reason.

**Pictures show the best of each strategy**, the scheme that is cheapest at the
smallest error that all schemes of that strategy reach; the tables have all of them.

**Work and precision.** Each point is a run: to the left is cheap, below is
accurate. Compare curves along a horizontal line, at the error that you want:
the one that is met first, coming from the left, is the way to compute. Parallel
curves mean a fixed factor, curves that cross that the answer depends on the
error. A method of higher order is steeper; it pays beyond the crossing only. A
point far to the upper right of its curve was refined in one of $h$ and $k$
alone, and paid for the wrong one.

**The efficient frontier**, in yellow, joins the runs drawn that no other one beats
in both time and error, without those that gain little: an error less than a tenth
smaller than that of the one before, or more than a fifth above the line between its
neighbors. Whatever does not touch it is not worth running; which ways to compute
do is the answer to "which scheme, which mesh".

**Cost by phase.** The share of each phase in the time of a run, and its total
on a logarithmic scale. Where the contact problem takes most of the time a
better solver or fewer steps would help, where the error estimate does it can be
switched off (`Error control/Error bar = false`) at the price of not knowing.

**Prices.** For each tolerance the cheapest run of the study that is at least so
accurate. *Italics* mark predictions for runs that nobody made, from the fits of
error and time: expect them within a factor of about two, and less the further
they are from the measured runs. Their seconds are those of the linear solver
that they would have, which a few steps on finer meshes have timed. What would
take more than an hour or 16 GB is out of reach. **Bold** is the cheapest of a
scene for an error, of measured ones if there are any. Between
runs of a ladder prices jump by what one refinement costs; the run that is named
may therefore be more accurate than asked. To halve an error of first order in
$h$ and $k$ takes four times as many cells in two dimensions, eight times as many
in three, and twice as many steps: at least 8 and 16 times the seconds.

## Orders of convergence

Manufactured solutions: displacement and stress are given by formulas, loads and
a source in the law follow. The stick-slip front moves, and in three dimensions
the direction of slip turns. Orders are those between the two finest runs of a
ladder: of the error of $u$ in the energy norm, of $\\sigma$ in $L^2$ and of
$\\lambda$ on $\\Gamma_3$, the least and the largest of all meshes (uniform, distorted,
locally refined), schemes and laws of friction; each way is a row of
[accuracy_orders.csv](accuracy_orders.csv). The paper proves first order in $h$ and
$k$ for $u$ and $\\sigma$ where the solution is smooth, (5.14) and (5.20); the
$h^{{3/4}}$ of (5.13) is what remains with less, a lower bound. Of $k$ alone orders are
shown where the error is not that of the finest mesh. The effectivity is the
estimated over the true error, the largest of all steps each, over all runs of the
study.

{manufactured}
### Solutions that are not smooth

No solution is known here; errors are differences to a finer run. Theorem 4.4
promises convergence without a rate. In adaptive runs $h$ is the width of a
uniform mesh with as many cells: order one in $h$ is the best that bilinear
elements can do, with any mesh.

{low_regularity}
## What an error costs

Three scenes without known solutions, whose errors are differences to a run to a
tolerance. Below each are the fits $C_h h^p+C_k k^q$ and the factor by which they miss
the runs, as root mean square and at worst. The price list of all three:

{prices}
{diagrams}
## Runs to a tolerance

With `Error control/Tolerance` the run chooses meshes and steps by itself
([error_bar.md](error_bar.md#7-runs-to-a-tolerance)). Manufactured solutions: the largest
error in the energy norm of all steps, estimated and true, over the largest norm.

{known_to_tolerance}
Bodies that creep for 1 / 10 / 100 / 1000 relaxation times, with steps of backward
Euler; each cell has the values at these times, errors in per cent of the largest norm
or value. The reference has a quarter of the mesh width (half in three dimensions) and
four times the steps: where an error is not well above that of the reference, it
counts for both.

{long_creep}
The scenes of the pictures above and others, from their coarsest meshes, with
Heun's scheme. Errors are differences to a run to half of the smallest tolerance
at the ends of phases; cells are means over the steps, and the rate is the power
of their number by which the error has fallen from the line above: with smooth
solutions it would be 1/2 in the plane and 1/3 in space. Beside the error of the
multiplier $\\lambda$ on $\\Gamma_3$ is that of a uniform mesh with as many cells,
and beside the seconds, with the share of new meshes and estimates in them, what
uniform meshes take for the same error: between the best uniform runs of the
study, and beyond them, in *italics*, by its predictions.

{to_tolerance}
The rates are those of smooth solutions, which uniform meshes miss: 0.27 to 0.37 in
the plane, 0.24 in space. Cells that follow the front where stick turns into slip,
and the ends of the face, are what $\\lambda$ gains from; an error in the energy
norm alone asks for few of them as long as it is large. Runs of less than a tenth
of a second take up to two and a half times as long as one uniform mesh: the pilot
run and each mesh have their price, and a scene of one step
(`half_clamped_block`) pays for all of its meshes within that step. Most of the
time goes into new meshes wherever steps are few; runs with forward Euler, which
need ten times as many, spend a fifth on them and take longer in all.

## What the tolerance of the solver is worth

By default the iterations of a step stop when the bound on their error is a
fraction (`Error control/Algebraic fraction`, 0.05) of the estimated error of
discretization. Against that stands `Solver/Contact tolerance` = {fixed}, on the
ladder of $h$ and $k$ of the scenes above. Times are sums over its runs; the
last column is the largest relative change of an error of any of them.

{tolerance}
## Reference cases

Values of an independent solver in the same discretization, at equal mesh and
steps ([testing.md](testing.md) says more); the shear layer has a closed form,
from which the second of its rows differs by the error in time.

{references}"""

DIAGRAM = """\
### {title}

The scene is `prm/verification/{name}.prm`, its coarsest run with

{settings}

{part}"""


def parts_of(text):
    """{piece: what stands between its marks}"""
    found = re.findall(r"^<!-- (\w+) -->\n(.*?)^<!-- end -->$", text, re.M | re.S)
    return dict(found)


def marked(name, text):
    return f"<!-- {name} -->\n{text}<!-- end -->\n"


def settings(overrides):
    """Overrides as they would stand on the command line."""
    return "\n".join(
        f"    --set '{name}={value}'"
        for name, value in overrides.items()
        if not name.startswith("Study/Budget")
    )


def render(parts):
    """The page with these computed parts."""
    parts = {
        name: marked(name, parts.get(name, NOT_YET))
        for name in (
            "manufactured",
            "low_regularity",
            "prices",
            "known_to_tolerance",
            "long_creep",
            "to_tolerance",
            "tolerance",
            "references",
            *plan.DIAGRAMS,
        )
    }
    diagrams = "\n".join(
        DIAGRAM.format(
            title=title, name=name, settings=settings(overrides), part=parts[name]
        )
        for name, (title, overrides) in plan.DIAGRAMS.items()
    )
    return TEMPLATE.format(diagrams=diagrams, fixed=plan.FIXED_TOLERANCE, **parts)


def write(file, name=None, text=None):
    """Write the page anew with one computed part replaced, or with those it has."""
    parts = {}
    if file.exists():
        parts = parts_of(file.read_text(encoding="utf-8"))
        if not parts:
            raise UserError(f"{file} is no page of contrib/make_results")
    file.parent.mkdir(parents=True, exist_ok=True)
    if name is not None:
        parts[name] = text
    file.write_text(render(parts), encoding="utf-8")
