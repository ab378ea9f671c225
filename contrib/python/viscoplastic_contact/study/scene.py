# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the program says of a scene (`--check=json'), and the entries that make a
run of it one of a study."""

import copy
import json
import math

from ..scene import set_options
from ..tables import UserError
from .record import MethodVariant, RunKey

# Runs with larger tolerances have hardly an error that obeys a law.
LARGEST_TOLERANCE = 0.5

# `Time/Phases' are pairs of the end of a phase, as the scene gives it, and its number
# of steps.
MOST_STEPS = 10**8


def read_phases(text):
    pairs = (phase.split(":") for phase in text.split(",") if phase.strip())
    return [(end.strip(), int(float(n))) for end, n in pairs]


def write_phases(phases):
    return ", ".join(f"{end}: {n}" for end, n in phases)


def scale_phases(phases, factor):
    """Every phase with factor times its steps, rounded up."""
    return [
        (end, int(min(max(math.ceil(factor * n * (1.0 - 1e-12)), 1), MOST_STEPS)))
        for end, n in phases
    ]


def n_steps(phases):
    return sum(n for _, n in phases)


def largest_step(phases):
    """The longest step."""
    ends = [0.0, *(float(end) for end, _ in phases)]
    pairs = zip(ends, ends[1:], phases)
    return max(((end - start) / n for start, end, (_, n) in pairs), default=0.0)


class Scene:
    """Values of all entries, in numbers or as texts, the first mesh, and where
    results go. With means the program has computed those of the data, too."""

    def __init__(self, program, files, overrides, means=False):
        check = f"--check={'means' if means else 'json'}"
        words = [check, *set_options(overrides), *files]
        self.use(json.loads(program.alone().call(*words)))

    def use(self, about):
        """Take over what the program says."""
        self.about, self.values = about, about["values"]
        self.file, self.directory = about["file"], about["directory"]
        self.dimension = about["dimension"]
        self.n_cells, self.h = float(about["cells"]), about["h"]
        self.phases = read_phases(self["Time/Phases"])
        self.budget = self.number("Study/Budget")
        self.has_tolerance = self.number("Error control/Tolerance") > 0.0
        self.has_step_control = self.number("Step control/Tolerance") > 0.0
        # Whether the scene itself says when its mesh changes, and by how much.
        is_refined = self["Mesh refinement/Strategy"] != "none"
        self.is_adaptive = is_refined and not self.has_tolerance
        # What errors are is known from it, or from fields of a reference of the user's.
        names = "Displacement", "Reference directory"
        self.has_exact_solution = any(self[f"Exact solution/{name}"] for name in names)

    def with_entries(self, entries):
        """The scene with other entries `Section/Entry=value', on the same mesh."""
        values = {**self.values, **dict(entry.split("=", 1) for entry in entries)}
        result = copy.copy(self)
        directory = (values["Output/Directory"] or self.directory).rstrip("/") + "/"
        result.use({**self.about, "values": values, "directory": directory})
        return result

    def __getitem__(self, path):
        return self.values[path].strip()

    def number(self, path):
        return float(self.values[path])

    def items(self, path):
        return [item.strip() for item in self.values[path].split(",") if item.strip()]

    def key(self):
        """The run of the scene as it is."""
        strategy = "adaptive" if self.is_adaptive else "uniform"
        return RunKey(
            MethodVariant(strategy, self["Time/Scheme"], self["Material/Stress history"])
        )

    def steps_per_mesh(self, n_steps):
        """After how many of its steps an adaptive run has a new mesh: as the scene says
        if that is adaptive, else ten times in all."""
        if self.is_adaptive:
            return int(self.number("Mesh refinement/Every n steps"))
        return max(1, n_steps // 10)

    def n_set_ups(self, strategy, n_steps, n_planned):
        """How often a run of so many steps is set up, once for each of its meshes,
        where its phases have n_planned steps: by step control these are others."""
        if strategy != "adaptive":
            return 1.0
        return max(1.0, math.ceil(n_steps / self.steps_per_mesh(n_planned)))

    def phases_of(self, key):
        """Those of the scene with twice the steps for each time level."""
        return scale_phases(self.phases, 2.0**key.time_level)

    def planned_steps(self, key):
        return n_steps(self.phases_of(key))

    def step_tolerance(self, key):
        """That of a run's steps where step control chooses them, so that they are
        half as long for each time level: half of the scene's, or a quarter with a
        scheme of second order. 0 where steps are given."""
        return self.number("Step control/Tolerance") * 2.0 ** (
            -key.variant.order * key.time_level
        )

    def tolerance(self, key):
        """That of a run that chooses meshes and steps itself: the scene's, halved
        level by level. 0 of other runs."""
        if key.variant.strategy != "tolerance":
            return 0.0
        return self.number("Error control/Tolerance") * 0.5**key.mesh_level

    def coarsest_tolerance_level(self):
        """The level of the largest tolerance that still asks for something."""
        ratio = self.number("Error control/Tolerance") / LARGEST_TOLERANCE
        return math.ceil(math.log2(ratio) - 1e-9)

    def subdivisions(self):
        """Numbers of cells by direction, as the mesh generator has them."""
        return [int(n) for n in self["Geometry/Arguments"].split(":")[0].split(",")]

    def n_coarser_meshes(self):
        """How often the mesh can be made coarser by halving."""
        n = int(self.number("Geometry/Global refinements"))
        generator = self["Geometry/Generator"]
        if not self["Geometry/File"] and generator == "subdivided_hyper_rectangle":
            n += (min(self.subdivisions()) - 1).bit_length()
        return n

    def name(self, key):
        """The name of a run and of its directory."""
        text = key.variant.strategy
        for choice, of_scene in zip(key.variant[1:], self.key().variant[1:]):
            if choice != of_scene:
                text += "_" + identifier(choice)
        if text.startswith("tolerance"):
            text += f"_{self.tolerance(key):g}"
        else:
            text += f"_h{key.mesh_level}_k{key.time_level}"
        return text + ("_timing" if key.is_timing else "")

    def discretization(self, key, steps, step_tolerance, may_subdivide=False):
        """The entries that choose mesh, steps and method of a run, for steps of any
        number, or to any tolerance of the steps where the scene has one."""
        strategy, scheme, history = key.variant
        entries = {"Time/Scheme": scheme, "Material/Stress history": history}
        if self.has_tolerance:
            entries["Error control/Tolerance"] = self.tolerance(key)
            # Where it depends on the scheme, which is set above.
            entries["Time/Stiffness policy"] = self["Time/Stiffness policy"]
        if strategy != "tolerance":
            self.add_mesh_and_steps(entries, key, steps, step_tolerance, may_subdivide)
        return [
            f"{path}={value:.12g}" if isinstance(value, float) else f"{path}={value}"
            for path, value in entries.items()
        ]

    def add_mesh_and_steps(self, entries, key, steps, step_tolerance, may_subdivide):
        """What is given of runs that do not choose it themselves."""
        adaptive = key.variant.strategy == "adaptive"
        # Adaptive runs begin one level coarser: from a much coarser mesh,
        # refinement at singular points would leave the rest too coarse.
        level = key.mesh_level - (1 if adaptive and key.mesh_level > 0 else 0)
        base = int(self.number("Geometry/Global refinements"))
        refinements = max(0, base + level)
        if -level > self.n_coarser_meshes():
            raise UserError(
                f"The mesh of the scene cannot be made coarser by {-level} levels: "
                f"'Geometry/Global refinements' = {base}."
            )
        entries["Geometry/Global refinements"] = refinements
        entries["Time/Phases"] = write_phases(steps)
        if self.has_step_control:
            entries["Step control/Tolerance"] = step_tolerance
        # Runs have the steps that the study says, or none.
        elif not may_subdivide and self["Time/Stiffness policy"] == "subdivide":
            entries["Time/Stiffness policy"] = "refuse"
        if base + level < 0:
            factor = 2.0 ** (base + level)
            cells = [max(1, math.floor(factor * n + 0.5)) for n in self.subdivisions()]
            rest = self["Geometry/Arguments"].split(":", 1)[1]
            entries["Geometry/Arguments"] = f"{', '.join(map(str, cells))} :{rest}"
        refinement = {"Strategy": "none"}
        if adaptive:
            cells = self.n_cells * 2.0 ** (self.dimension * key.mesh_level)
            refinement = {} if self.is_adaptive else self.own_refinement(n_steps(steps))
            refinement |= {
                "Minimal level": min(refinements, base),
                "Maximal level": max(refinements, base + key.mesh_level + 2),
                "Cell budget": max(1, math.floor(cells + 0.5)),
            }
        for name, value in refinement.items():
            entries[f"Mesh refinement/{name}"] = value

    def own_refinement(self, n_steps):
        """Of adaptive runs of a scene that is not adaptive."""
        return {
            "Strategy": "residual",
            "Refinement fraction": 0.6,
            "Coarsening fraction": 0.05,
            "Every n steps": self.steps_per_mesh(n_steps),
        }


def identifier(text):
    """For directories: letters, digits and `_'."""
    return "".join(c if c.isascii() and c.isalnum() else "_" for c in text)
