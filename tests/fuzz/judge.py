# SPDX-License-Identifier: LGPL-2.1-or-later
"""What an answer of the program is worth: ok, refused, or a defect.

ok       exit code 0, and every number that was written is finite
refused  the exit code of an error, and one sentence on the error stream
defect   all else, and what is ok although it is known to make no sense (or
         refused although it makes sense)
"""

import csv
import io
import math
import re

# What is not ours, or not for the user: libraries that speak, types, functions.
FOREIGN = re.compile(
    r"(?i:stacktrace|an error occurred|additional information|exception on processing"
    r"|terminate called|violated condition|name of the exception"
    r"|std::|__cxx|dealii::|basic_string|vector::|\bstoul\b|\bstod\b|\bstoi\b"
    r"|half-open range|failed condition|\(none\)|bad_alloc|bad_cast|segfault"
    r"|not equal to \d|invalid argument|filesystem error|regex_error|MPI_ABORT"
    r"|traceback|invalid literal|could not convert|codec can't|ufunc|has no attribute"
    r"|assertion|no_error|<unspecified>|bad variant|bad optional|map::at)"
    r"|\bExc[A-Z]\w+"
)
SANITIZER = re.compile(r"AddressSanitizer|runtime error:|UndefinedBehaviorSanitizer")
NOT_FINITE = re.compile(r"(?<![\w'])[-+]?(nan|inf)(?!\w)", re.I)

# The limit that nothing imposes is infinite.
UNBOUNDED_COLUMNS = ("step_limit",)


class Outcome:
    def __init__(self, kind, reason=""):
        self.kind = kind
        self.reason = reason


def table_without_clocks(data):
    rows = list(csv.reader(io.StringIO(data.decode())))
    kept = [i for i, name in enumerate(rows[0]) if "wall" not in name]
    return [[row[i].strip() for i in kept] for row in rows]


def defect_of_numbers(work, stdout):
    """What is wrong with the numbers of a run that ended well."""
    file = work / "results" / "statistics.csv"
    if file.is_file():
        rows = list(csv.reader(io.StringIO(file.read_text(errors="replace"))))
        for row in rows[1:]:
            if len(row) != len(rows[0]):
                return "statistics.csv has rows of unequal length"
            for name, value in zip(rows[0], row):
                try:
                    finite = math.isfinite(float(value))
                except ValueError:
                    return f"statistics.csv has {value[:20]!r} in the column {name}"
                column = name.partition(" [")[0].strip()  # without unit
                if not finite and column not in UNBOUNDED_COLUMNS:
                    return f"statistics.csv has {value.strip()} in the column {name}"
    for line in stdout.splitlines():
        # names that the scene gives are no numbers
        if NOT_FINITE.search(line) and "limit" not in line and "'" not in line:
            return f"not finite: {line[:200]}"
    return ""


def defect_of_sentence(stderr):
    """What is wrong with the words of a refusal."""
    lines = [line for line in stderr.splitlines() if line.strip()]
    if len(lines) != 1:
        return f"{len(lines)} lines on the error stream instead of one sentence"
    line = lines[0]
    if not line.startswith("viscoplastic_contact: "):
        return "the sentence is not ours"
    if FOREIGN.search(line):
        return f"the sentence has the words of a library: {FOREIGN.search(line)[0]}"
    if len(line) > 1500:
        return f"the sentence has {len(line)} characters"
    if not re.search(r"[.?][')]?$", line):
        return "the sentence does not end"
    if any(ord(c) < 32 for c in line):
        return "the sentence has control characters"
    return ""


def judge(case, work, code, stdout, stderr):
    """code is negative for the signal that ended the program."""
    if SANITIZER.search(stderr):
        first = SANITIZER.search(stderr).start()
        return Outcome("defect", "sanitizer: " + stderr[first : first + 200])
    if code < 0:
        timeout = -code in (9, 14, 24)  # kill, alarm, CPU time
        return Outcome("defect", "timeout" if timeout else f"signal {-code}")
    if code in (1, 2):
        reason = defect_of_sentence(stderr)
        if not reason and case.sense:
            reason = f"refused, but it is {case.sense}"
        if reason:
            return Outcome("defect", f"{reason}: {stderr[:300]}")
        return Outcome("refused", stderr.strip())
    if code != 0:
        return Outcome("defect", f"exit code {code}: {stderr[:300]}")
    if stderr.strip():
        return Outcome("defect", f"success with an error: {stderr[:300]}")
    if case.nonsense:
        return Outcome("defect", f"accepted, but it is nonsense: {case.nonsense}")
    reason = defect_of_numbers(work, stdout)
    if reason:
        return Outcome("defect", reason)
    if case.expected is not None:
        found = (work / "results" / "statistics.csv").read_bytes()
        if table_without_clocks(found) != table_without_clocks(case.expected):
            return Outcome("defect", "the answer is not that of the run in one piece")
    return Outcome("ok")
