# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a fuzz case is: files, arguments of the program, and what is known
about the answer.

A case is a function of (kind, seed, number) alone, so that these three words
make it again on any machine.
"""

import random
from dataclasses import dataclass, field
from typing import Callable


@dataclass
class Case:
    """files      {name: bytes} of the working directory
    arguments  of the program, which runs there
    nonsense   why the program has to refuse this, if that is known
    sense      why it has to accept this, if that is known
    base       a directory of the driver's that is copied first
    prepare    what is then done to it, a function of the place of the copy
    expected   statistics.csv, if any answer must be this one
    told       what has been done, for people
    """

    files: dict
    arguments: list
    nonsense: str = ""
    sense: str = ""
    base: str = ""
    prepare: Callable = None
    expected: bytes = None
    told: list = field(default_factory=list)

    def examine(self, work, outcome, stdout, run):
        """What is wrong with an answer that the judge has found ok or refused;
        run(arguments, ranks, directory) runs the program again."""
        return ""

    def simpler(self):
        """Cases with a little less in them, for the search of what a defect
        needs."""
        return []


def generator(kind, seed, number):
    """Random numbers of one case; they do not depend on the other cases."""
    return random.Random(f"{kind} {seed} {number}")


# Numbers at the edges of types, of floating-point ranges and of notation.
NUMBERS = (
    "0 -0 1 -1 2 0.5 1e-320 1e-300 -1e-300 1e300 1e308 -1e308 1e309 -1e999 nan -nan "
    "inf -inf NaN infinity 2147483647 2147483648 -2147483648 -2147483649 4294967295 "
    "4294967296 4294967297 9223372036854775807 9223372036854775808 "
    "18446744073709551615 18446744073709551616 -9223372036854775809 1e30 -1e30 "
    "0x10 0x1p-3 1e 1e+ .5 5. . - + 1,5 1.5.2 1d3 1_000 00001 ١ 1e-1000000000 "
    "340282366920938463463374607431768211456 1e1000000000 0.1e0.1"
).split()

TEXTS = (
    "",
    " ",
    "\t",
    ";",
    ",",
    ":",
    ";;;;",
    ",,,,",
    "::::",
    "1;1",
    "1,1",
    "1:1",
    "free",
    "%s%n%x",
    "../../../../etc/passwd",
    "/dev/null",
    "/dev/zero",
    "$(reboot)",
    "'\"`",
    "\\",
    "#",
    "\u00e9\u4e2d\u2603",
    "x" * 300,
    "1, " * 2000 + "1",
    "1 : " * 2000 + "1",
    "2" + " " * 300000 + ": 1",
    "((((((((((",
    "true",
    "no",
    "None",
)


def mangle(random, data):
    """Bytes with a few of them changed, gone, doubled or moved."""
    data = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 4, 16))):
        if not data:
            break
        i = random.randrange(len(data))
        j = min(len(data), i + random.choice((1, 1, 2, 8, 64, 512)))
        action = random.randrange(8)
        if action == 0:
            data[i] ^= 1 << random.randrange(8)
        elif action == 1:
            data[i] = random.randrange(256)
        elif action == 2:
            del data[i:j]
        elif action == 3:
            data[i:i] = data[i:j]
        elif action == 4:
            data[i:i] = random.randbytes(j - i)
        elif action == 5:
            data[i:j] = random.choice((b"\0", b"\xff", b" ", b"9")) * (j - i)
        elif action == 6:
            k = random.randrange(len(data))
            data[i:j], data[k:k] = b"", data[i:j]
        else:
            del data[i:]
    return bytes(data)


def mangle_tokens(random, text, tokens=NUMBERS):
    """Text with some of its blank-separated words exchanged for others."""
    words = text.split(" ")
    for _ in range(random.choice((1, 1, 2, 5))):
        i = random.randrange(len(words))
        # keep the end of a line that clings to the word
        end = words[i][len(words[i].rstrip("\n")) :]
        words[i] = random.choice(tokens) + end
    return " ".join(words)


def mangle_lines(random, text):
    """Text with lines that are gone, doubled or moved."""
    lines = text.splitlines(keepends=True)
    for _ in range(random.choice((1, 1, 2, 5))):
        if not lines:
            break
        i = random.randrange(len(lines))
        action = random.randrange(4)
        line = lines[i] if action == 1 else lines.pop(i)
        if action in (1, 2):
            lines.insert(random.randint(0, len(lines)), line)
        elif action == 3:
            lines.insert(i, line[: random.randrange(len(line))])
    return "".join(lines)
