# SPDX-License-Identifier: LGPL-2.1-or-later
"""Expressions: random ones from a grammar, broken ones, and such as muParser
takes but that mean nothing."""

from case import Case, mangle
from scenes import SCENES, as_prm

# (scene, entry, value with {} for the expression, variables)
PLACES = (
    ("elastic", "Boundary 0/Traction", "{}; 0", "xyt"),
    ("elastic", "Boundary 0/Traction", "0; {}", "xyt"),
    ("elastic", "Boundary 0/Pressure", "{}", "xyt"),
    ("elastic", "Boundary 2/Friction bound", "{}", "xyt"),
    ("elastic", "Material/Young's modulus", "{}", "xy"),
    ("elastic", "Material/Poisson's ratio", "{}", "xy"),
    ("elastic", "Loads/Body force", "{}; {}", "xyt"),
    ("elastic", "Boundary 2/Foundation motion", "{}; 0", "xyt"),
    ("elastic", "Boundary 2/Foundation displacement", "{}", "xyt"),
    ("maxwell", "Material/maxwell/Viscosity", "{}", "xyt"),
    ("norton", "Material/norton/Exponent", "{}", "xyt"),
    ("norton", "Material/norton/Stress cap", "{}", "xyt"),
    ("parsed", "Material/parsed/Strain rate", "{}", ("sigma_eq", "p", "eps_eq", "t")),
    ("parsed", "Material/parsed/Factor", "{}", "xyt"),
    ("layers", "Geometry/Material ids", "{}", ("x", "y", "id")),
    ("elastic", "Geometry/Boundary ids", "{}", ("x", "y", "id")),
    ("initial", "Initial state/Stress", "{}; 0; 0; 0", "xy"),
    ("initial", "Initial state/Displacement", "{}; 0", "xy"),
    ("solid", "Boundary 4/Normal stress", "{}", "xyt"),
    ("solid", "Boundary 5/Displacement", "0; 0; {}", "xyt"),
    ("solid", "Boundary 4/Friction coefficient", "{}", "xyt"),
)

FUNCTIONS = {
    1: "sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh log2 log10 log ln "
    "exp sqrt sign rint abs int ceil floor cot csc sec erf erfc rand_seed".split(),
    2: "min max sum avg pow fmod atan2".split(),
    3: ["if", "min", "sum"],
}
OPERATORS = "+ - * / ^ && || <= >= != == < > | &".split()

# None of these is an expression of finite value that is the same whenever it
# is asked for.
BROKEN = (
    "(",
    ")",
    "(((1)",
    "1))",
    "1 +",
    "* 2",
    "1 2",
    "1..2",
    "sin",
    "sin(",
    "sin()",
    "sin(1, 2)",
    "min()",
    "if(1)",
    "if(1, 2)",
    "if(1,2,3,4)",
    "q",
    "foo(1)",
    "xx",
    "1 = 1",
    "x = 2",
    "1 ? 2",
    "1 ? : 2",
    "1 : 2",
    "'a'",
    '"a"',
    "\\",
    "$x",
    "@",
    "1,2",
    "nan",
    "inf",
    "0/0",
    "1/0",
    "-1/0",
    "0^-1",
    "log(0)",
    "log(-1)",
    "sqrt(-1)",
    "asin(2)",
    "exp(1000)",
    "10^400",
    "1e400",
    "(-8)^(1/3)",
    "fmod(1, 0)",
    "rand()",
    "0.5*rand()",
    "rand_seed(1)",
    "rand_seed(x)",
    "é",
    "١",
    "1\u00a0+\u00a01",
    "free",
    "()",
    "(())",
    "-",
    "--",
    "!",
    "^",
    "_pi()",
    "sum()",
    "max(,)",
    "min(1,)",
    "x(1)",
    "sin sin 1",
    "1 < ",
    "t t",
    "#",
    "x #",
    "..",
    "1e",
    "1e+",
    "0x",
    "0xg",
)


def random_expression(random, variables, depth):
    """From the grammar: parsable, whatever its value."""
    if depth == 0 or random.random() < 0.15:
        return random.choice(
            list(variables) * 3
            + ["0", "1", "2", "0.5", "-1", "1e-3", "pi", "_pi", "1e300", "1e-300", "_e"]
        )
    inner = lambda: random_expression(random, variables, depth - 1)
    choice = random.randrange(6)
    if choice < 3:
        return f"({inner()} {random.choice(OPERATORS[:5 if choice else None])} {inner()})"
    if choice == 3:
        return f"(-{inner()})"
    n = random.choice((1, 1, 2, 3))
    name = random.choice(FUNCTIONS[n])
    return f"{name}({', '.join(inner() for _ in range(n))})"


def tower(random, variables):
    """Deep, long, or both."""
    n = random.choice((10, 100, 1000, 10000, 100000))
    x = random.choice(variables)
    small = min(n, 10000)
    return random.choice(
        (
            "(" * n + x + ")" * n,
            "sin(" * small + x + ")" * small,
            "-" * n + x,
            "+".join([x] * n),
            "^".join(["1"] * small),
            "if(" * small + x + ",1,1)" * small,
            "1?" * small + x + ":1" * small,
            "max(" + ",".join([x] * small) + ")",
            "x" * n,
            "1" * n,
            "0." + "0" * n + "1",
            " " * n + x,
            x + " " * n,
            "(" * n,
            "-(" * small + x + ")" * small,
            "if(1," * small + x,
            "min(" * small,
            "1+(" * n,
            "&&".join([x] * small),
        )
    )


def case(random, context):
    scene, path, value, variables = random.choice(PLACES)
    entries = dict(SCENES[scene])
    action = random.choice(("grammar",) * 4 + ("broken",) * 3 + ("tower", "mangled"))
    nonsense = ""
    if action == "grammar":
        text = random_expression(random, variables, random.randint(1, 5))
        # what gives another value whenever it is asked for, and a name of one
        if "rand" in text:
            nonsense = "a random value"
    elif action == "broken":
        text = random.choice(BROKEN)
        # what is broken remains so within what is not
        wrap = random.choice(("{}", "{}", "{}", "1 + {}", "({})*0"))
        # `free' is a value of one entry, and what follows # is a comment
        has_meaning = text == "free" and path == "Boundary 5/Displacement"
        if has_meaning or "#" in text:
            wrap = "{}"
        text = wrap.format(text)
        if not (has_meaning or "#" in text):
            nonsense = f"'{text}' for '{path}'"
    elif action == "tower":
        text = tower(random, variables)
    else:
        text = random_expression(random, variables, 4)
        text = mangle(random, text.encode()).replace(b"\n", b" ").decode("latin-1")
    if value.count("{}") == 2:
        value = value.replace("{}", "0", 1)
    before, after = value.split("{}")
    entries[path] = f"{before}\0{after}"
    data = as_prm(entries).encode()
    data = data.replace(b"\0", text.encode("utf-8" if action != "mangled" else "latin-1"))
    arguments = ["scene.prm"] if random.random() < 0.4 else ["--check", "scene.prm"]
    return Case(
        {"scene.prm": data},
        arguments,
        nonsense=nonsense,
        told=[f"{path} = {text[:60]}"],
    )
