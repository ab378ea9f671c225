# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the study of effects writes: effects.csv, a row for each quantity of each
simplification; effects.json; effects.md, the same for people."""

import itertools
import re
import textwrap
from math import isfinite, log10
from pathlib import Path

from .record import json_text, picked
from .report import origin
from .runs import make_directory, replace_file
from .words import digits, table

HEADER = (
    "effect,instead,verdict,changes most,by,error there,energy norm,time,,memory,cells"
).split(",")

# Verdicts in a column of the console.
IN_SHORT = {
    "below the error of this discretization": "below error",
    "as large as the error of this discretization": "as the error",
    "cannot be left out": "is needed",
}


def in_words(quantity, names):
    """A quantity with the name that the scene gives its place: "reaction of roof"; those
    of other places as their columns are called."""
    match = re.fullmatch(r"(reaction|friction_force|contact_force)_(\d+)", quantity)
    place = f"boundary {match[2]}" if match else quantity.replace("point", "point ")
    if place not in names:
        return quantity
    if not match:
        return f"displacement of {names[place]}"
    where = "of" if match[1] == "reaction" else "on"
    return f"{match[1].replace('_', ' ')} {where} {names[place]}"


def percent(value):
    if 10.0 <= value < 1e9:
        rounded = round(value, 1 - int(log10(value)))
        return f"{rounded:,.0f} times".replace(",", " ")
    return f"{digits(100.0 * value, 2)} %" if isfinite(value) else "-"


def with_chance(value, chance, unit, between=" +- "):
    """A difference and the scatter of two runs, or that alone where it is larger."""
    known = f"{digits(value, 2)}{between}" if abs(value) > chance else between.strip()
    return f"{known}{digits(chance, 1)}{unit}"


def share_of_time(result, between=" +- "):
    """What the scene pays for the effect, of the seconds that it takes."""
    full, without = result.with_it, result.without
    return with_chance(
        100.0 * (1.0 - without.seconds / full.seconds),
        100.0 * (full.seconds_chance + without.seconds_chance) / full.seconds,
        " %",
        between,
    )


def summary(result, names, nothing=""):
    """The quantity that changes most, by how much, and its error."""
    if result.failure or result.verdict in ("never acted", "only watches"):
        return [nothing, "", ""]
    most = result.decisive
    return [in_words(most.quantity, names), percent(most.change), percent(most.error)]


def cells_of(result, names):
    cells = [result.variant.effect, result.variant.instead, result.verdict]
    if result.failure:
        return cells + ["-"] * (len(HEADER) - len(cells))
    full, without = result.with_it, result.without
    scatter = full.memory_chance + without.memory_chance
    return [
        *cells,
        *summary(result, names, "nothing"),
        percent(result.change_of("energy_norm")),
        share_of_time(result),
        f"{digits(full.seconds - without.seconds, 2)} s",
        with_chance(full.memory - without.memory, scatter, " MB"),
        digits(result.cells, 9),
    ]


def lines_of(text, width):
    """The words of a text in lines of at most this width, where no word is longer."""
    wrapper = textwrap.TextWrapper(width, subsequent_indent="  ", break_on_hyphens=False)
    wrapper.break_long_words = False
    return wrapper.wrap(" ".join(text.split()))


def print_cells(cells):
    """A row of the table for the console: of effect, verdict, quantity, its change and
    error, and the time."""
    first, *more = lines_of(cells[0], 34)
    row = f"  {first:34} {cells[1]:13} {cells[2]:20} {cells[3]:>7} {cells[4]:>7} "
    lines = [f"{row}{cells[5]:>12}", *(f"  {words}" for words in more)]
    return "".join(f"{line}\n" for line in lines)


def print_row(result, names):
    # Of fewer cells than the scene has.
    mesh = f" ({result.cells:.0f} cells)" if result.level < 0 and result.cells else ""
    return print_cells(
        [
            f"{result.variant.effect}: {result.variant.instead}{mesh}",
            IN_SHORT.get(result.verdict, result.verdict),
            *summary(result, names),
            "" if result.failure else share_of_time(result, "+-"),
        ]
    )


def without(result):
    return f"Without {result.variant.effect} ({result.variant.instead})"


def interaction_in_words(interaction, names):
    """Whether two effects interact, in numbers."""
    largest, first, second = interaction.largest, interaction.first, interaction.second
    results = first, second, interaction.joint
    changes = [percent(result.change_of(largest.quantity)) for result in results]
    verdict = "add up, as far as this discretization can tell."
    if interaction.is_clear:
        verdict = "interact."
    elif largest.change > largest.error:
        verdict = "may interact, which this discretization cannot tell."
    return (
        f"{without(first)} {in_words(largest.quantity, names)} changes by {changes[0]}, "
        f"w{without(second)[1:]} by {changes[1]}, without both by {changes[2]}. This "
        f"differs from the sum of both changes by up to {percent(largest.change)}, where "
        f"the error of this quantity is {percent(largest.error)}: they {verdict}"
    )


def effects_in_words(study):
    """The table for the console."""
    head = ["without: instead", "", "changes most", "by", "error", "costs"]
    names = study.names
    text = print_cells(head) + "".join(print_row(r, names) for r in study.results)
    sentences = [f"{without(r)}: {r.failure}" for r in study.results if r.failure]
    if study.interaction:
        sentences.append(interaction_in_words(study.interaction, names))
    if study.left_out:
        sentences.append(study.left_out)
    if any(share_of_time(r).startswith("-") for r in study.results if not r.failure):
        sentences.append(
            "Costs below zero: with the effect the scene takes less time than without. "
            "Where there is a scatter alone, nothing larger was measured."
        )
    lines = (line for sentence in sentences for line in lines_of(sentence, 96))
    return text + "".join(f"{line}\n" for line in lines)


def markdown(study, about):
    text = (
        f"# Effects of {Path(study.scene.file).stem}\n\n"
        "What each effect changes, beside the error of the discretization, and what it "
        "costs. Changes are the largest of all times over the largest value; the "
        "quantity is that whose change is the largest in proportion to its error, which "
        "is the difference to a run with twice the mesh width and time steps (in the "
        "energy norm: the error bar). Energy norm: of the difference of the "
        "displacements at the ends of the phases of time. Time and memory: what the "
        "scene takes less what it takes without the effect, so that what saves time is "
        "below zero; +- the difference between two runs of the same, alone where nothing "
        "larger was measured.\n\n"
    )
    if Path(study.directory, "effects.png").exists():
        text += "![What effects change and cost](effects.png)\n\n"
    by_kind = itertools.groupby(study.results, lambda result: result.variant.kind)
    text += "\n".join(
        f"## Of the {kind}\n\n" + table(HEADER, [cells_of(r, study.names) for r in alike])
        for kind, alike in by_kind
    )
    for result in study.results:
        if result.failure:
            text += f"\n{without(result)}: {result.failure}\n"
    if study.interaction:
        words = interaction_in_words(study.interaction, study.names)
        text += f"\n## The two largest at once\n\n{words}\n"
    if study.left_out:
        text += f"\n{study.left_out}\n"
    return text + (
        f"\n*{about['version']}, {about['machine']}, {about['ranks']} MPI rank(s), "
        f"{about['date']}*\n"
    )


def contents_of(result):
    names = "seconds seconds_chance memory_MB=memory memory_chance_MB=memory_chance"
    return {
        **picked(result.variant, "effect instead overrides kind"),
        **picked(result, "verdict level cells"),
        "with": picked(result.with_it, names),
        "without": picked(result.without, names),
        "decisive": result.decisive.quantity,
        "failure": result.failure,
        "changes": {c.quantity: picked(c, "change error") for c in result.changes},
    }


def table_of(study):
    lines = [
        "effect,instead,kind,verdict,level,cells,quantity,change,error,"
        "seconds_with,seconds_without,memory_with_MB,memory_without_MB"
    ]
    for result in study.results:
        variant, costs = result.variant, (result.with_it, result.without)
        head = f'"{variant.effect}","{variant.instead}",{variant.kind},'
        head += f'"{result.verdict}",{result.level},{result.cells:.12g}'
        numbers = [cost.seconds for cost in costs] + [cost.memory for cost in costs]
        for change in result.changes:
            values = (f"{v:.12g}" for v in (change.change, change.error, *numbers))
            lines.append(",".join([head, change.quantity, *values]))
    return "\n".join(lines) + "\n"


def write_effects(study, is_finished):
    """Each file is replaced at once."""
    about = origin(study.base)
    contents = {
        "scene": Path(study.scene.file).stem,
        **about,
        "finished": is_finished,
        "left_out": study.left_out,
        "effects": [contents_of(result) for result in study.results],
    }
    if study.interaction:
        pair = study.interaction
        results = picked(pair, "first second joint").items()
        contents["interaction"] = {
            **{which: contents_of(result) for which, result in results},
            **picked(pair.largest, "quantity interaction=change error"),
            "interact": pair.is_clear,
            "words": interaction_in_words(pair, study.names),
        }
    make_directory(study.directory)
    replace_file(study.directory + "effects.csv", table_of(study))
    replace_file(study.directory + "effects.json", json_text(contents))
    replace_file(study.directory + "effects.md", markdown(study, about))
