# SPDX-License-Identifier: LGPL-2.1-or-later
"""Expressions of t as parameter files have them, for many times at once.

The syntax is muParser's.  What it shares with Python's is parsed by Python
and evaluated here operation by operation; nothing else is executed.  Numbers
are those of IEEE 754 as in the program, where 1/0 is infinite and no error,
and as there a value that is not finite is refused in the end.
"""

import ast
import operator
import re

import numpy as np
from scipy.special import erfc

from .results import UserError

OPERATIONS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


def rounded(values):
    """To integers, halves away from zero, as deal.II's int() and if()."""
    return np.trunc(values + np.copysign(0.5, values))


def choice(condition, a, b):
    return np.where(rounded(condition) != 0.0, a, b)


def total(*values):
    return np.add.reduce(np.broadcast_arrays(*values))


# Those of one or two arguments are numpy's, whose number of arguments is
# checked: a further one would be where to write the result.
FUNCTIONS = {
    "if_": choice,
    "min": lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)),
    "max": lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)),
    "sum": total,
    "avg": lambda *values: total(*values) / len(values),
    "abs": np.abs,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "ln": np.log,
    "log": np.log,
    "log2": np.log2,
    "log10": np.log10,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "cot": lambda x: 1.0 / np.tan(x),
    "sec": lambda x: 1.0 / np.cos(x),
    "csc": lambda x: 1.0 / np.sin(x),
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "asinh": np.arcsinh,
    "acosh": np.arccosh,
    "atanh": np.arctanh,
    "erfc": erfc,
    "sign": np.sign,
    "int": rounded,
    "rint": lambda x: np.floor(x + 0.5),  # muParser's, not that of C
    "floor": np.floor,
    "ceil": np.ceil,
    "pow": np.power,
}
CONSTANTS = {"pi": np.pi, "Pi": np.pi, "_pi": np.pi, "_e": np.e}


def evaluate(text, t, **places):
    """The values at the times t, and at places x, y, z of as many; UserError if it
    depends on more or is not finite."""
    shown = shortened(text)
    value = values(
        text, {"t": t, **places}, "only expressions of t alone are evaluated here"
    )
    wrong = np.nonzero(~np.isfinite(value))[0]
    if len(wrong):
        raise UserError(
            f'the expression "{shown}" cannot be drawn: it has the value '
            f"{value[wrong[0]]:g} at t = {t[wrong[0]]:g}"
        )
    return value


def of_columns(text, columns):
    """The values of an expression of columns, row by row."""
    return values(
        text,
        columns,
        "it may have numbers, functions of parameter files and the columns that --list "
        "names",
    )


def shortened(text):
    return text.strip() if len(text) <= 80 else f"{text.strip()[:77]}..."


def values(text, variables, allowed):
    """An expression of arrays of one length, which has t."""
    python = re.sub(r"\bif\s*\(", "if_(", text.replace("^", "**"))
    python = python.replace("&&", " and ").replace("||", " or ").strip()
    shown = shortened(text)
    names = {name: np.float64(value) for name, value in CONSTANTS.items()}
    try:
        tree = ast.parse(python, mode="eval")
        with np.errstate(all="ignore"):
            value = visit(tree.body, {**names, **variables})
    except (RecursionError, MemoryError):  # the latter is that of the parser
        raise UserError(
            f'the expression "{shown}" cannot be drawn: it is nested too deeply, or '
            "has too many terms"
        ) from None
    except (SyntaxError, KeyError, TypeError, ValueError, OverflowError) as error:
        raise UserError(
            f'the expression "{shown}" cannot be drawn: {allowed}'
        ) from error
    return np.broadcast_to(np.asarray(value, dtype=float), np.shape(variables["t"]))


def visit(node, names):
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return np.float64(node.value)
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.UnaryOp):
        return OPERATIONS[type(node.op)](visit(node.operand, names))
    if isinstance(node, ast.BinOp):
        return OPERATIONS[type(node.op)](
            visit(node.left, names), visit(node.right, names)
        )
    # Truth is a number, so that one can count with it.
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        return 1.0 * OPERATIONS[type(node.ops[0])](
            visit(node.left, names), visit(node.comparators[0], names)
        )
    if isinstance(node, ast.BoolOp):
        join = np.logical_and if isinstance(node.op, ast.And) else np.logical_or
        return 1.0 * join.reduce(
            np.broadcast_arrays(*[visit(value, names) for value in node.values])
        )
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        function = FUNCTIONS[node.func.id]
        expected = getattr(function, "nin", len(node.args))
        if len(node.args) == expected and not node.keywords:
            return function(*[visit(argument, names) for argument in node.args])
    raise ValueError("not an arithmetic expression")
