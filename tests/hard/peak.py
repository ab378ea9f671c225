# SPDX-License-Identifier: LGPL-2.1-or-later
"""Run a command and write its peak of memory: peak.py FILE LIMIT COMMAND ...

The peak is in KiB; LIMIT is that of addresses in bytes, or 0.  A program of its
own, since the peak of a child contains that of who started it, and the suite
grows with the results it has read.
"""

import os
import resource
import subprocess
import sys


def main():
    file, limit, command = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    if limit:
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    with open(file, "w") as out:
        out.write(str(usage.ru_maxrss))
    return process.returncode if process.returncode >= 0 else 128 - process.returncode


if __name__ == "__main__":
    sys.exit(main())
