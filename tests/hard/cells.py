# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hard cases of the shapes of cells."""

import tempfile
from pathlib import Path

import numpy as np

from harness import run
from suite import case


@case(
    "Elasticity",
    "Cells a thousand times as long as high have the answer of square cells, with "
    "both solvers, in 2D and 3D",
)
def aspect_ratio(size, report):
    n = size(8, 32)
    square = run(
        "hard/aspect_ratio", {"Geometry/Arguments": f"{n}, {n} : 0, 0 : 1, 1 : true"}
    )
    report.figure("foot in square cells, exact 0.31", square["point0_x"][-1])

    def compare(what, n, lengths, solver):
        """A box of n cells over the height and 4 in the other directions."""
        dim = len(lengths) + 1
        entries = {
            "Dimension": dim,
            "Geometry/Arguments": ", ".join((dim - 1) * ["4"] + [str(n)])
            + f" : {', '.join(dim * ['0'])} : "
            + ", ".join([*map(str, lengths), "1"])
            + " : true",
            "Solver/Linear solver": solver,
            "Output/Points": ", ".join(dim * ["0"]),
        }
        if dim == 3:
            # the height is z: the sides y are free, as the solution has no
            # stress there but in the plane of x and z
            tau = "min(0.2*t, 0.1) - 0.4*t*z"
            entries |= {
                "Loads/Body force": "0.4*t; 0; 0",
                "Boundary 0/Traction": f"0; 0; -({tau})",
                "Boundary 1/Traction": f"0; 0; {tau}",
                "Boundary 2/Role": "free",
                "Boundary 3/Role": "free",
                "Boundary 4/Role": "contact",
                "Boundary 4/Friction law": "tresca",
                "Boundary 4/Friction bound": 0.1,
                "Boundary 5/Role": "clamped",
            }
        result = run("hard/aspect_ratio", entries)
        # Of what bends so easily the run tells what rounding may leave.
        told = max(result["algebraic_error"])
        report.identities(result, min(max(1e-9, told), 1e-6), balance=1e-7)
        report.figure(
            f"{what}, {solver}: difference of the foot from square cells",
            abs(result["point0_x"] - square["point0_x"]).max()
            / abs(square["point0_x"]).max(),
            0,
            # A column 2000 times as high as wide bends so easily that the
            # tolerance of 1e-9 in energy, and rounding, are some thousand times
            # as much at the foot.
            1e-5,
        )
        if solver == "multigrid":
            report.figure(
                f"{what}: multigrid iterations a step",
                result["linear_iterations"][1:].mean(),
            )

    for solver in "direct", "multigrid":
        compare("2D, long cells", n, (4000 / n,), solver)
        compare("3D, plates", n, (4000 / n, 4000 / n), solver)
        # The scheme is exact at the nodes, so that fewer cells are no worse;
        # more of them would make a thinner column.
        compare("2D, high cells", 8, (0.0005,), solver)
        compare("3D, needles", 8, (0.0005, 0.0005), solver)


def sliver_mesh(file, n, gap, length=1):
    """A rectangle in Gmsh's format, in squares; every other vertex in both
    directions is moved along a diagonal of a cell to within @p gap of half the
    diagonal's length from its middle, where the angle is 180 degrees."""
    rng = np.random.default_rng(3)
    columns = length * n
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes"]
    lines.append(str((columns + 1) * (n + 1)))
    for j in range(n + 1):
        for i in range(columns + 1):
            x = np.array([i, j], float)
            if i % 2 and j % 2:
                x += (1 - gap) / 2 * rng.choice((-1, 1), 2)
            index = j * (columns + 1) + i + 1
            lines.append(f"{index} {x[0] / n:.17g} {x[1] / n:.17g} 0")
    lines += ["$EndNodes", "$Elements", str(columns * n)]
    for j in range(n):
        for i in range(columns):
            a = j * (columns + 1) + i + 1
            b = a + columns + 1
            lines.append(f"{j * columns + i + 1} 3 2 0 0 {a} {a + 1} {b + 1} {b}")
    lines += ["$EndElements", ""]
    file.write_text("\n".join(lines))


@case(
    "Elasticity",
    "Cells with an angle next to 180 degrees: the error stays bounded, as many "
    "iterations as on squares",
)
def slivers(size, report):
    gaps = 1e-1, 1e-3, 1e-6
    # of the whole body in one cell of this kind
    one = {
        gap: run(
            "hard/slivers",
            {
                "Geometry/Arguments": f"0, 0; 1, 0; 0, 1; {(1 + gap) / 2}, "
                f"{(1 + gap) / 2} : false"
            },
        )
        for gap in gaps
    }

    def relative(result):
        return result["error_energy"][-1] / result["exact_energy"][-1]

    report.figure("one cell halved 4 times, gap 0.1: relative error", relative(one[0.1]))
    report.figure(
        "the same, gap 1e-6 / gap 0.1", relative(one[1e-6]) / relative(one[0.1]), 0, 1.2
    )

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "slivers.msh"

        def error(n, gap):
            sliver_mesh(file, n, gap)
            return relative(
                run(
                    "hard/slivers",
                    {
                        "Geometry/Generator": "",
                        "Geometry/Arguments": "",
                        "Geometry/File": file,
                        "Geometry/Global refinements": 0,
                    },
                )
            )

        n = size(16, 64)
        squares = error(n, 1)
        errors = [error(n, gap) for gap in gaps]
        report.figure(f"relative error in squares, n = {n}", squares)
        # their longest edges are 1.6 times those of squares
        report.figure(
            "largest error over gaps / error in squares", max(errors) / squares, 0, 2.5
        )
        report.figure("gap 1e-6 / gap 0.1", errors[-1] / errors[0], 0, 1.5)
        order = np.log2(error(n // 2, gaps[-1]) / errors[-1])
        report.figure("order in h, gap 1e-6", order, 0.9, 1.1)

        for solver in "direct", "multigrid":
            counts, linear = {}, {}
            for gap in (1, *gaps):
                sliver_mesh(file, n, gap, 2)
                result = run(
                    "hard/incompressible_slab",
                    {
                        "Geometry/Generator": "",
                        "Geometry/Arguments": "",
                        "Geometry/File": file,
                        "Geometry/Boundary ids": "if(x < 1e-9, 0, if(x > 2 - 1e-9, 1, "
                        "if(y < 1e-9, 2, 3)))",
                        "Material/Poisson's ratio": 0.3,
                        "Solver/Linear solver": solver,
                    },
                )
                report.identities(result, 1e-8)
                counts[gap] = result["contact_iterations"][1:].mean()
                linear[gap] = result["linear_iterations"][1:].mean()
            report.figure(
                f"active-set iterations a step, largest over gaps, {solver}",
                max(counts.values()),
                0,
                counts[1] + 1,
            )
            if solver == "multigrid":
                report.figure("multigrid iterations a step, squares", linear[1])
                report.figure(
                    "the same, largest over gaps",
                    max(linear.values()),
                    0,
                    2 * linear[1],
                )
