# SPDX-License-Identifier: LGPL-2.1-or-later
"""The page of a run: what was computed, how well, for how much, and how to do it
again."""

import contextlib
import io
import tempfile
from html import escape
from pathlib import Path

from plotting import quantities
from plotting.command import main as plot
from plotting.results import NoPicture, Results, UserError, read_parameters
from plotting.units import Units, plain_number

from . import bill, tables, written
from .body import fitting_body
from .curves import curves, info
from .markup import folded_up, formula, items, listing, picture, section, value
from .page import Page, as_link


def page(directory):
    """The Page of a directory of results."""
    results = Results(directory)
    quantities.set_scene(results)
    about, units = info(results), Units.of(results)
    found = Page(name_of(results))
    found.add(summary(results, about, units))
    found.add(remarks(results, about))
    found.add(view(results, found))
    found.add(section("results", "Results", tables.quantities(results, units)))
    found.add(over_time(results, found))
    found.add(section("error", "Estimated error", tables.errors(results, about, units)))
    found.add(section("bill", "Where the seconds went", bill.bars(results, about)))
    found.add(section("balances", "Balances", tables.balances(results, units)))
    found.add(again(results, about))
    for name, title in written.TITLES.items():
        inner = results.directory / name
        if written.has_run(results.directory):
            inner = results.directory
        if (inner / f"{name}.md").exists():
            found.add(section(name, title, folded_up("Show", written.content(inner))))
    return found


def name_of(results):
    """The run of a price is in a directory below that of its scene."""
    directory = results.directory
    if written.has_run(directory):
        return f"{directory.parent.name}: {directory.name}"
    return results.name


def summary(results, about, units):
    """What was computed, in sentences and a picture."""
    statistics = results.statistics
    dimension = about.get("dimension")
    space = {2: "a body in plane strain", 3: "a body in three dimensions"}
    if results.is_of_revolution():
        space[2] = "a body of revolution"
    text = f"The quasi-static deformation of {space.get(dimension, 'a body')}"
    if len(statistics.get("t", ())):
        first, last = statistics["t"][[0, -1]]
        time = units.unit("time", [first, last])
        n_steps = len(statistics["t"]) - 1
        text += (
            f", from <i>t</i> = {value(time, first)} to "
            f"{value(time, last)} in {counted(n_steps, 'step')}"
        )
    if "cells" in statistics:
        text += f", on a mesh of {span(statistics['cells'], 'cell')}"
    if "dofs" in statistics:
        text += f" with {span(statistics['dofs'], 'unknown')}"
    text = f"<p>{text}.</p>\n"
    if about.get("effects"):
        effects = items(map(escape, about["effects"]))
        text += f"<p>With these effects:</p>\n{effects}"
    text += f'<p class="answer">{answer(results, about)}</p>\n'
    return section("computed", "What was computed", text + overview(results))


def counted(n, what):
    return f"{n} {what}" + ("s" if n != 1 else "")


def span(values, what):
    low, high = int(values.min()), int(values.max())
    return counted(high, what) if low == high else f"{low} to {counted(high, what)}"


def answer(results, about):
    """Accuracy and price in one line."""
    parts = []
    for key, of in (
        ("estimated_error", "the solution in the energy norm"),
        ("estimated_error_of_quantity", "the quantity of interest"),
    ):
        if key in about:
            if "quantity" in about[key]:
                of = formula(quantities.column(about[key]["quantity"])[0])
            share = about[key]["relative"]
            words = f"<b>{tables.data(share, tables.percent(share))}</b>"
            if about[key].get("largest_value") == 0.0:
                words = "<b>not known</b>, since it has been zero throughout"
            parts.append(f"estimated error of {of} {words}")
    if not parts:
        parts.append(
            "the error has not been estimated (<code>Error bar</code> = false)"
        )
    seconds = bill.total(results)
    if seconds is not None:
        ranks = counted(about.get("n_mpi_ranks", 1), "MPI rank")
        words = plain_number(seconds, 3)
        parts.append(f"price <b>{tables.data(seconds, words)} s</b> on {ranks}")
    memory = about.get("costs", {}).get("peak_memory_MB")
    if memory:
        parts.append(f"{tables.data(memory, plain_number(memory, 3))} MB of memory")
    text = ", ".join(parts) + "."
    return text[0].upper() + text[1:]


def overview(results):
    """The picture of contrib/plot, with supports and loads; the one that is there if
    it is not older than the results."""
    path = results.directory / f"{results.name}.png"
    newest = results.directory / "statistics.csv"
    if not newest.exists():
        newest = results.directory / "solution.pvd"
    words = f"{results.name} at the last time: the body, its supports, forces"
    if path.exists() and path.stat().st_mtime >= newest.stat().st_mtime:
        return f"<figure>{picture(path, words)}</figure>\n"
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "overview.png"
        arguments = [str(results.directory), "--output", str(path)]
        silence = io.StringIO()
        with contextlib.redirect_stdout(silence), contextlib.redirect_stderr(silence):
            failed = plot(arguments)
        return "" if failed else f"<figure>{picture(path, words)}</figure>\n"


def remarks(results, about):
    """What the run has warned of, and what its numbers say."""
    found = [escape(sentence) for sentence in about.get("remarks", ())]
    if about and "costs" not in about:
        found.append(
            "The run has not ended, or was interrupted: this is what it had written."
        )
    if not about:
        found.append(
            "There is no <code>run.json</code>: version and effects are unknown."
        )
    if not found:
        found = ["The run had nothing to warn of."]
    if about and "remarks" not in about and "processor" not in about:
        found = ["Of this version of the program, run.json has no warnings."]
    return section("remarks", "Warnings and remarks", items(found))


def view(results, found):
    """The body to turn."""
    try:
        body = fitting_body(results)
    except NoPicture as reason:
        return section("view", "The body", f"<p>{escape(str(reason))}.</p>\n")
    found.show_body(body)
    text = ""
    if body.thinned:
        text = (
            '<p class="thinned">For the size of this page it shows '
            f"{', '.join(body.thinned)}. The files of the run have all.</p>\n"
        )
    return section("view", "The body", VIEWER + text)


VIEWER = """\
<div id="viewer"><p>The view needs JavaScript and WebGL.</p></div>
"""


def over_time(results, found):
    data = curves(results)
    if data is None:
        return section("curves", "Over time", "<p>There is only one time.</p>\n")
    found.show_curves(data)
    text = '<div id="panels"></div>\n'
    shown, there = data["rows"]
    if shown < there:
        text += f"<p>The curves show {shown} of {there} steps.</p>\n"
    return section("curves", "Over time", text)


def again(results, about):
    """How to reproduce the run."""
    path = results.directory / "parameters.prm"
    facts = [
        ("program", f"{about.get('program', 'viscoplastic_contact')} "
         f"{about.get('version', 'of unknown version')}"),
        ("revision", about.get("git_revision")),
        ("deal.II", about.get("dealii_version")),
        ("MPI ranks", about.get("n_mpi_ranks")),
        ("processor", about.get("processor")),
        ("ended", about.get("date") if "costs" in about else None),
    ]
    facts = [f"{name}: {escape(str(value))}" for name, value in facts if value]
    for table in about.get("tables", ()):
        facts.append(
            f"table {escape(table['section'])}: {escape(table['file'])}, "
            f"CRC-32 {escape(str(table['crc32']))}"
        )
    libraries = about.get("shared_libraries", ())
    facts += [f"shared library: {escape(str(library))}" for library in libraries]
    text = items(facts)
    try:
        entries = read_parameters(path)
        prm = path.read_text(encoding="utf-8") if entries else ""
    except (OSError, UserError):
        prm = ""
    if not prm:
        text += "<p>There is no parameters.prm to run again.</p>\n"
        return section("again", "To do it again", text)
    name = f"{results.name}.prm"
    ranks = about.get("n_mpi_ranks", 1)
    launcher = f"mpirun -n {ranks} " if ranks > 1 else ""
    text += f"<p>Save {as_link(name, prm)}, all parameters of the run, "
    text += "beside the files that it names, and run</p>\n"
    text += listing(
        f"{launcher}viscoplastic_contact {name} --set Output/Directory=output/again"
    )
    text += folded_up("The parameters that are not empty", listing(shortened(entries)))
    return section("again", "To do it again", text)


def shortened(entries):
    """Parameters without comments and without what is empty."""
    lines, open_sections = [], ()
    for path, value in entries.items():
        *sections, name = path
        # Of laws only that of the material.
        law = entries.get((path[0], "Law")) if len(path) == 3 else None
        if not value or law and path[1] not in law:
            continue
        if tuple(sections) != open_sections:
            open_sections = tuple(sections)
            lines.append(f"\n{' / '.join(sections)}" if sections else "")
        lines.append(f"  {name} = {value}")
    return "\n".join(lines).strip("\n")
