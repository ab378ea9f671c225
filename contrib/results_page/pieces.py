# SPDX-License-Identifier: LGPL-2.1-or-later
"""The parts of the page that are computed, each by itself."""

import csv
import datetime
import os
import sys
from concurrent.futures import ThreadPoolExecutor

import matplotlib.pyplot as plt

from plotting import convergence, cost, style, work_precision
from plotting.results import UserError, read_parameters
from viscoplastic_contact import Program

from . import plan, program, references, tables

SCENES = program.SOURCE / "prm" / "verification"

ABOUT = {
    "manufactured": "orders of convergence of all manufactured solutions",
    "low_regularity": "orders where solutions are not smooth",
    **{name: title for name, (title, _) in plan.DIAGRAMS.items()},
    "prices": "what errors of some per cent cost on these scenes",
    "known_to_tolerance": "true errors of runs to a tolerance",
    "long_creep": "estimated over true errors after long creep",
    "drawn": "the same of scenes drawn at random",
    "to_tolerance": "what runs to a tolerance cost, beside uniform meshes",
    "tolerance": "what coupling the solver's tolerance to the error saves",
    "references": "reference cases beside independent values",
}


def make(name, runner, images):
    """The Markdown of a piece."""
    style.set_up()
    if name in tables.SHORTENED:
        rows, about = SHORTENED[name](runner)
        write_csv(images.parent, name, [tables.SHORTENED[name][0], *rows])
        return tables.shortened(name, rows) + stamp(runner, about)
    if name == "tolerance":
        return tolerance(runner)
    if name == "prices":
        return prices(runner)
    return diagram(name, runner, images)


def csv_file(folder, name):
    """All that was computed for a piece of which the page shows less."""
    return folder / f"accuracy_{name}.csv"


def write_csv(folder, name, lines):
    with open(csv_file(folder, name), "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(lines)


def read_rows(folder, name):
    """The rows that are shown in short."""
    with open(csv_file(folder, name), newline="", encoding="utf-8") as file:
        _, *rows = csv.reader(file)
    return rows


def stamp(runner, about=None):
    """Machine, date and version of what was computed."""
    about = about or {}
    words = [
        f"viscoplastic_contact {about['version']}"
        if about.get("version")
        else runner.version(),
        Program.processor(),
        str(about.get("date") or datetime.date.today())[:10],
    ]
    return f"\n*{', '.join(word for word in words if word)}.*\n"


def both_cores(function, arguments):
    """Two at a time, if there are two cores; errors are collected."""
    workers = min(2, len(os.sched_getaffinity(0)))
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(function, argument) for argument in arguments]
    found, errors = [], []
    for future in futures:
        try:
            found.append(future.result())
        except UserError as error:
            errors.append(error)
    return found, errors


def manufactured_cases():
    """(scene, law or None, mesh, {ladder: overrides}) of all cases."""
    folder = SCENES / "manufactured"
    laws = sorted(folder.glob("law_*.prm"))
    cases = []
    for scene in sorted(set(folder.glob("*.prm")) - set(laws)):
        dimension = int(read_parameters(scene).get(("Dimension",), "2"))

        def case(law=None, mesh="uniform", scheme=plan.SCHEMES[0], **overrides):
            of_law = plan.LAW_LADDERS.get(law.stem if law else "", {})
            ladders = {
                ladder: {
                    **plan.COUPLED,
                    **plan.MANUFACTURED,
                    "Study/Ladders": ladder,
                    "Study/Time schemes": scheme,
                    **own,
                    **of_law.get(ladder, {}),
                    **overrides,
                }
                for ladder, own in plan.MANUFACTURED_LADDERS[dimension].items()
            }
            cases.append((scene, law, mesh, ladders))

        case(scheme=", ".join(plan.SCHEMES))
        for mesh, overrides in plan.MESHES.items():
            case(
                mesh=mesh,
                **{
                    name: text.format(folder=folder, dimension=dimension)
                    for name, text in overrides.items()
                },
            )
        for law in laws:
            case(law)
    return cases


def unilateral(friction_law, contact_law):
    """What a contact piece has: its friction law, and whether it may open."""
    held = None, "not given", "bilateral", "given normal stress"
    opens = contact_law not in held
    return f"{friction_law}, {contact_law}" if opens else friction_law


def facts(scene, law, mesh):
    """What the table of convergence says of a case."""
    parameters = read_parameters(scene)
    friction = dict.fromkeys(
        unilateral(value, parameters.get((key[0], "Contact law")))
        for key, value in parameters.items()
        if key[1:] == ("Friction law",)
    )
    name = parameters.get(("Material", "Law"), "elastic")
    if law is not None:
        name = law.stem.removeprefix("law_").replace("_", ", ")
    return {
        "scene": f"`{scene.stem}`",
        "law": name,
        "friction": ", ".join(friction) or tables.UNKNOWN,
        "d": parameters.get(("Dimension",), "2"),
        "mesh": mesh,
    }


def manufactured(runner):
    cases = manufactured_cases()
    if not cases:
        raise UserError(f"there are no scenes in {SCENES / 'manufactured'}")

    def one(case):
        scene, law, mesh, ladders = case
        name = "_".join([scene.stem, *([law.stem] if law else []), *mesh.split()])
        files = [scene, law] if law else [scene]
        studies = {
            ladder: runner.study(f"manufactured/{name}_{ladder}", files, overrides)
            for ladder, overrides in ladders.items()
        }
        rows = tables.convergence_rows(studies, facts(scene, law, mesh))
        return rows, studies["both"].about

    found, errors = both_cores(one, cases)
    for error in errors:
        print(f"Left out: {error}", file=sys.stderr)
    if not found:
        raise errors[0]
    return [row for rows, _ in found for row in rows], found[0][1]


def low_regularity(runner):
    def one(item):
        name, (why, overrides) = item
        study = runner.study(
            f"low_regularity/{name}",
            [SCENES / f"{name}.prm"],
            {**plan.COUPLED, **overrides},
        )
        rows = tables.low_regularity_rows(f"`{name}`", why, study)
        return rows, study.about

    found, errors = both_cores(one, plan.LOW_REGULARITY.items())
    if errors:
        raise errors[0]
    return [row for rows, _ in found for row in rows], found[0][1]


def diagram_study(name, runner):
    overrides = plan.DIAGRAMS[name][1]
    return runner.study(name, [SCENES / f"{name}.prm"], {**plan.COUPLED, **overrides})


def draw_diagram(name, study, images):
    """Draw the pictures of one scene; {module: path from the page}."""
    style.set_up()
    pictures = {}
    for module in (work_precision, convergence, cost):
        picture = f"accuracy_{name}_{module.__name__.rpartition('.')[2]}.png"
        images.mkdir(parents=True, exist_ok=True)
        figure = module.draw(study, study.error())
        figure.savefig(images / picture, dpi=130, bbox_inches="tight", pad_inches=0.15)
        plt.close(figure)
        pictures[module] = f"images/{picture}"
    return pictures


def diagram(name, runner, images):
    """Pictures of one scene; its fits go to a file."""
    study = diagram_study(name, runner)
    error = study.error()
    pictures = draw_diagram(name, study, images)
    write_csv(images.parent, name, [tables.FIT_HEADER, *tables.fit_rows(study, error)])
    return (
        f"![Error over seconds]({pictures[work_precision]})\n\n"
        + f"![Error over mesh width and time step]({pictures[convergence]})\n\n"
        + f"![Seconds by phase]({pictures[cost]})\n"
        + stamp(runner, study.about)
    )


def prices(runner):
    """One table of all scenes."""
    rows, about = [], None
    for name in plan.DIAGRAMS:
        study = diagram_study(name, runner)
        about = about or study.about
        rows += tables.price_rows(
            f"`{name}`", study, plan.TOLERANCES, study.error()
        )
    return tables.table(tables.price_header(plan.TOLERANCES), rows) + stamp(
        runner, about
    )


def known_to_tolerance(runner):
    folder = SCENES / "manufactured"
    rows = []
    for scene, law, tolerances in plan.KNOWN_TO_TOLERANCE:
        files = [folder / f"{scene}.prm", *([folder / f"{law}.prm"] if law else [])]
        facts_of = facts(files[0], files[1] if law else None, "")
        for eps in tolerances:
            name = "_".join([scene, *([law] if law else []), str(eps)])
            columns = runner.run(
                f"to_tolerance/{name}",
                files,
                {
                    "Error control/Tolerance": eps,
                    "Mesh refinement/Cell budget": plan.CELL_BUDGET,
                    "Output/Fields every": "0",
                },
            )
            rows.append(
                tables.known_to_tolerance_row(
                    facts_of["scene"], facts_of["law"], eps, columns
                )
            )
    return rows, None


def long_creep(runner):
    return effectivities(runner, "long_creep", plan.LONG_CREEP)


def drawn(runner):
    return effectivities(runner, "drawn", plan.DRAWN)


def effectivities(runner, piece, scenes):
    """Runs beside references; without a quantity those for the energy norm."""
    rows = []
    for name, (scene, quantity, tolerances, halved, entries) in scenes.items():
        files = [SCENES.parent / f"{scene}.prm"]
        entries = {**plan.COUPLED, **entries}
        folder = f"{piece}/{name.replace(', ', '_').replace(' ', '_')}"
        level = int(entries.get("Geometry/Global refinements", 0))
        reference = f"{folder}/reference"
        finest = runner.run(
            reference,
            files,
            {
                **entries,
                "Geometry/Global refinements": level + halved,
                "Time/Phases": plan.more_steps(entries["Time/Phases"]),
                "Output/Reference fields": "true",
            },
        )
        entries["Exact solution/Reference directory"] = runner.directory / reference
        level_limit = {"Mesh refinement/Maximal level": level + 1}
        of_quantity = {"Error control/Quantity": quantity} if quantity else {}
        norm, value = tolerances
        ways = {
            "uniform": of_quantity,
            "adaptive": {**plan.ADAPTIVE_CREEP, **level_limit, **of_quantity},
            f"to {tables.percent(norm)}": {"Error control/Tolerance": norm},
        }
        if quantity:
            ways[f"quantity to {tables.percent(value)}"] = {
                "Error control/Tolerance": value,
                **of_quantity,
            }
        for way, overrides in ways.items():
            columns = runner.run(
                f"{folder}/{way.replace(' ', '_').replace('%', 'percent')}",
                files,
                {**entries, **overrides},
            )
            rows.append(
                tables.long_creep_row(name, way, quantity, columns, finest)
            )
    return rows, None


def to_tolerance(runner):
    rows, about = [], None
    for name in (*plan.DIAGRAMS, *plan.TO_TOLERANCE):
        if name in plan.DIAGRAMS:
            study = diagram_study(name, runner)
        else:
            study = runner.study(
                f"to_tolerance/{name}",
                [SCENES / f"{name}.prm"],
                {**plan.COUPLED, **plan.TO_TOLERANCE[name]},
            )
        about = about or study.about
        rows += tables.to_tolerance_rows(
            f"`{name}`",
            study,
            plan.TARGETS,
            study.error(),
            plan.TO_TOLERANCE_SCHEME,
        )
    return rows, about


def tolerance(runner):
    rows = []
    for name, (_, overrides) in plan.DIAGRAMS.items():
        files = [SCENES / f"{name}.prm"]
        overrides = {**plan.COUPLED, **overrides, **plan.TOLERANCE_STUDY}
        coupled = runner.study(f"tolerance/{name}_coupled", files, overrides)
        overrides["Solver/Contact tolerance"] = plan.FIXED_TOLERANCE
        fixed = runner.study(f"tolerance/{name}_fixed", files, overrides)
        rows.append(tables.saving_row(f"`{name}`", coupled, fixed))
    return tables.table(tables.SAVING_HEADER, rows) + stamp(runner)


# What is computed for the pieces of tables.SHORTENED: rows, and about.
SHORTENED = {
    "manufactured": manufactured,
    "low_regularity": low_regularity,
    "known_to_tolerance": known_to_tolerance,
    "long_creep": long_creep,
    "drawn": drawn,
    "to_tolerance": to_tolerance,
    "references": lambda runner: (references.rows(runner), None),
}
