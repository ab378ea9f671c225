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

Made by `contrib/make_results`, which writes every number; the line under each part names version,
machine and date. Each run is of one process. `contrib/study scene.prm` makes the same of your own
scene ([study.md](study.md)).

## How to read this page

Errors are relative: the largest of all steps over the largest norm of the solution; where
they are differences to a finer run, of the steps that end a phase of `Time/Phases`.

**Convergence.** Where a curve is flat the error is the part that its ladder leaves alone. The
dotted line is the fit $C_h h^p+C_k k^q$ of all runs, by which prices are predicted. In the gray
below, differences say more of the reference than of the run.

**Work and precision.** Each point is a run; yellow are those that no other one beats in both time
and error.

**Prices.** For each tolerance the cheapest run of the study that is at least so
accurate. *Italics* are predictions for runs that nobody made, good to a factor of about two near
the measured ones. **Bold** is the cheapest of a scene, of measured ones if there are any.

## Orders of convergence

Manufactured solutions, in which the stick-slip front moves and in three dimensions the direction
of slip turns. Orders are those between the two finest runs of a
ladder: of the error of $u$ in the energy norm, of $\\sigma$ in $L^2$ and of
$\\lambda$ on $\\Gamma_3$, the least and the largest of all meshes (uniform, distorted,
locally refined), schemes and laws of friction
([accuracy_manufactured.csv](accuracy_manufactured.csv)). The paper proves first order in
$h$ and $k$ for $u$ and $\\sigma$ where the solution is smooth, (5.14) and (5.20). The
effectivity is the estimated over the true error. Orders below 0.5 are not shown, here and
below: there the error is that of what the ladder leaves alone, or of the reference.

{manufactured}
### Solutions that are not smooth

A kink of the load in time and a jump of the bound (`kinked_load_2d`), clamped and
loaded pieces of one side (`junction_2d`), a re-entrant corner. Errors are differences
to a finer run, orders those in the energy norm (all norms:
[accuracy_low_regularity.csv](accuracy_low_regularity.csv)). In adaptive runs $h$ is the width of a uniform mesh with as
many cells.

{low_regularity}
## What an error costs

Three scenes without known solutions, whose errors are differences to a run to a
tolerance. The fits and the factors by which they miss the runs are in
`doc/accuracy_<scene>.csv`. All have

{every_way}

The price list:

{prices}
{diagrams}
## Runs to a tolerance

With `Error control/Tolerance` the run chooses meshes and steps by itself
([error_bar.md](error_bar.md#7-runs-to-a-tolerance)). Manufactured solutions: the largest
true error in the energy norm of all steps over the tolerance; size and seconds of the first
law at the smallest tolerance ([all](accuracy_known_to_tolerance.csv)).

{known_to_tolerance}
Bodies that have crept for 1000 relaxation times, with steps of backward Euler: estimates
over errors on uniform and adaptive meshes and in runs to a tolerance, and the errors of
these, of the energy norm and of a quantity. The reference has an eighth of the mesh width
(of Lee and Radok's a quarter) and four times the steps. Each way, also at 1, 10 and 100
relaxation times, is a row of [accuracy_long_creep.csv](accuracy_long_creep.csv).

{long_creep}
Four scenes drawn at random by the grammar of `contrib/fuzz`, with references of a quarter of the
mesh width ([accuracy_drawn.csv](accuracy_drawn.csv)). The ring has no solution of finite energy, as
its runs say: prescribed displacements jump where boundaries meet.

{drawn}
The scenes of the pictures above and others, from their coarsest meshes, with
Heun's scheme, to the two smallest tolerances (others, errors of $\\lambda$ and shares of
the seconds: [accuracy_to_tolerance.csv](accuracy_to_tolerance.csv)). Errors are
differences to a run to half of the smallest tolerance; cells are
means over the steps. The last column is what uniform meshes take for the same error, in
*italics* as predicted.

{to_tolerance}
## What the tolerance of the solver is worth

The default (`Error control/Algebraic fraction`) against `Solver/Contact tolerance` =
{fixed}, on the ladder of $h$ and $k$ of the scenes above. Times are sums over its runs; the
last column is the largest relative change of an error.

{tolerance}
## Reference cases

The largest relative difference from values of an independent solver in the same
discretization, at equal mesh and steps ([testing.md](testing.md)); the shear layer has
a closed form, from which it differs by the error in time. All values:
[accuracy_references.csv](accuracy_references.csv).

{references}"""

DIAGRAM = """\
### {title}

`prm/verification/{name}.prm`, its coarsest run with

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
    return "\n".join(f"    --set '{name}={value}'" for name, value in overrides.items())


def own_settings(overrides):
    """Those of a scene that the others do not have."""
    common = {"Study/Budget": None, **plan.EVERY_WAY}
    return settings({name: v for name, v in overrides.items() if name not in common})


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
            "drawn",
            "to_tolerance",
            "tolerance",
            "references",
            *plan.DIAGRAMS,
        )
    }
    diagrams = "\n".join(
        DIAGRAM.format(
            title=title, name=name, settings=own_settings(overrides), part=parts[name]
        )
        for name, (title, overrides) in plan.DIAGRAMS.items()
    )
    return TEMPLATE.format(
        diagrams=diagrams,
        every_way=settings(plan.EVERY_WAY),
        fixed=plan.FIXED_TOLERANCE,
        **parts,
    )


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
