# SPDX-License-Identifier: LGPL-2.1-or-later
"""How doc/accuracy.md is made; contrib/make_results is the command.

    plan      what is computed, on which meshes and with which steps
    program   running the program and its studies
    tables    Markdown from studies: pure functions
    pieces    the parts of the page, each of which can be made alone
    page      the sentences between them
"""
