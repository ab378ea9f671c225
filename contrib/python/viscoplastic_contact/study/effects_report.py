# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the study of effects writes: effects.csv, a row for each quantity of each
simplification; effects.json; effects.md, the same for people."""

import re
from math import isfinite, log10
from pathlib import Path

from .record import json_text
from .report import origin
from .runs import make_directory, replace_file
from .words import digits, table_head, table_row

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


def names_of(study):
    return study.scene.about.get("names", {})


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


def has_changes(result):
    """Whether there is a change to tell of."""
    return not result.failure and result.verdict not in ("never acted", "only watches")


def cells_of(result, names):
    variant, decisive = result.variant, result.decisive
    cells = [variant.effect, variant.instead, result.verdict]
    if result.failure:
        return cells + ["-"] * (len(HEADER) - len(cells))
    full, without, tells = result.with_it, result.without, has_changes(result)
    return [
        *cells,
        in_words(decisive.quantity, names) if tells else "nothing",
        percent(decisive.change) if tells else "",
        percent(decisive.error) if tells else "",
        percent(result.change_of("energy_norm")),
        share_of_time(result),
        f"{digits(full.seconds - without.seconds, 2)} s",
        with_chance(
            full.memory - without.memory,
            full.memory_chance + without.memory_chance,
            " MB",
        ),
        digits(result.cells, 9),
    ]


def lines_of(text, width):
    """The words of a text in lines of at most this width, where no word is longer."""
    lines = [""]
    for word in text.split():
        if not lines[-1]:
            lines[-1] = word
        elif len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(f"  {word}")
    return lines


def print_cells(cells):
    """A row of the table for the console: of effect, verdict, quantity, its change and
    error, and the time."""
    first, *more = lines_of(cells[0], 34)
    row = f"  {first:34} {cells[1]:13} {cells[2]:20} {cells[3]:>7} {cells[4]:>7} "
    lines = [f"{row}{cells[5]:>12}", *(f"  {words}" for words in more)]
    return "".join(f"{line}\n" for line in lines)


def print_row(result, names):
    tells, decisive = has_changes(result), result.decisive
    # Of fewer cells than the scene has.
    mesh = f" ({result.cells:.0f} cells)" if result.level < 0 and result.cells else ""
    return print_cells(
        [
            f"{result.variant.effect}: {result.variant.instead}{mesh}",
            IN_SHORT.get(result.verdict, result.verdict),
            in_words(decisive.quantity, names) if tells else "",
            percent(decisive.change) if tells else "",
            percent(decisive.error) if tells else "",
            "" if result.failure else share_of_time(result, "+-"),
        ]
    )


def without(result):
    return f"Without {result.variant.effect} ({result.variant.instead})"


def interaction_in_words(interaction, names):
    """Whether two effects interact, in numbers."""
    quantity, largest = interaction.largest.quantity, interaction.largest
    first, second = interaction.first, interaction.second
    verdict = "add up, as far as this discretization can tell."
    if interaction.is_clear:
        verdict = "interact."
    elif largest.change > largest.error:
        verdict = "may interact, which this discretization cannot tell."
    return (
        f"{without(first)} {in_words(quantity, names)} changes by {percent(first.change_of(quantity))}, "
        f"w{without(second)[1:]} by {percent(second.change_of(quantity))}, without both "
        f"by {percent(interaction.joint.change_of(quantity))}. This differs from the sum "
        f"of both changes by up to {percent(largest.change)}, where the error of this "
        f"quantity is {percent(largest.error)}: they {verdict}"
    )


def effects_in_words(study):
    """The table for the console."""
    head = ["without: instead", "", "changes most", "by", "error", "costs"]
    names = names_of(study)
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
    text = f"# Effects of {Path(study.scene.file).stem}\n\n" + (
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
    kind = ""
    for result in study.results:
        if result.variant.kind != kind:
            text += "\n" if kind else ""
            kind = result.variant.kind
            text += f"## Of the {kind}\n\n{table_head(HEADER)}"
        text += table_row(cells_of(result, names_of(study)))
    for result in study.results:
        if result.failure:
            text += f"\n{without(result)}: {result.failure}\n"
    if study.interaction:
        words = interaction_in_words(study.interaction, names_of(study))
        text += f"\n## The two largest at once\n\n{words}\n"
    if study.left_out:
        text += f"\n{study.left_out}\n"
    return text + (
        f"\n*{about['version']}, {about['machine']}, {about['ranks']} MPI rank(s), "
        f"{about['date']}*\n"
    )


def cost_of(cost):
    return {
        "seconds": cost.seconds,
        "seconds_chance": cost.seconds_chance,
        "memory_MB": cost.memory,
        "memory_chance_MB": cost.memory_chance,
    }


def contents_of(result):
    return {
        "effect": result.variant.effect,
        "instead": result.variant.instead,
        "overrides": result.variant.overrides,
        "kind": result.variant.kind,
        "verdict": result.verdict,
        "level": result.level,
        "cells": result.cells,
        "with": cost_of(result.with_it),
        "without": cost_of(result.without),
        "decisive": result.decisive.quantity,
        "failure": result.failure,
        "changes": {
            change.quantity: {"change": change.change, "error": change.error}
            for change in result.changes
        },
    }


def csv(study):
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
        contents["interaction"] = {
            "first": contents_of(pair.first),
            "second": contents_of(pair.second),
            "joint": contents_of(pair.joint),
            "quantity": pair.largest.quantity,
            "interaction": pair.largest.change,
            "error": pair.largest.error,
            "interact": pair.is_clear,
            "words": interaction_in_words(pair, names_of(study)),
        }
    make_directory(study.directory)
    replace_file(study.directory + "effects.csv", csv(study))
    replace_file(study.directory + "effects.json", json_text(contents))
    replace_file(study.directory + "effects.md", markdown(study, about))
