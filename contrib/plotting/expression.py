# SPDX-License-Identifier: LGPL-2.1-or-later
"""Expressions of t as parameter files have them, for many times at once.

The syntax is muParser's.  What it shares with Python's is parsed by Python
and evaluated here operation by operation; nothing else is executed.
"""

import ast
import operator
import re

import numpy as np

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
FUNCTIONS = {
    "if_": lambda condition, a, b: np.where(np.asarray(condition) != 0, a, b),
    "min": lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)),
    "max": lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)),
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
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "sign": np.sign,
    "rint": np.rint,
    "floor": np.floor,
    "ceil": np.ceil,
    "pow": np.power,
}


def evaluate(text, t):
    """The values at the times t; UserError if it depends on more than t."""
    python = re.sub(r"\bif\s*\(", "if_(", text.replace("^", "**"))
    python = python.replace("&&", " and ").replace("||", " or ").strip()
    try:
        tree = ast.parse(python, mode="eval")
        with np.errstate(all="ignore"):
            value = visit(tree.body, {"t": t, "pi": np.pi, "e": np.e})
    except (SyntaxError, KeyError, TypeError, ValueError) as error:
        raise UserError(
            f'the expression "{text}" cannot be drawn: only expressions of t alone '
            "are evaluated here"
        ) from error
    return np.broadcast_to(np.asarray(value, dtype=float), t.shape)


def visit(node, names):
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return float(node.value)
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.UnaryOp):
        return OPERATIONS[type(node.op)](visit(node.operand, names))
    if isinstance(node, ast.BinOp):
        return OPERATIONS[type(node.op)](
            visit(node.left, names), visit(node.right, names)
        )
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        return OPERATIONS[type(node.ops[0])](
            visit(node.left, names), visit(node.comparators[0], names)
        )
    if isinstance(node, ast.BoolOp):
        join = np.logical_and if isinstance(node.op, ast.And) else np.logical_or
        return join.reduce(
            np.broadcast_arrays(*[visit(value, names) for value in node.values])
        )
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return FUNCTIONS[node.func.id](*[visit(a, names) for a in node.args])
    raise ValueError("not an arithmetic expression")
