# SPDX-License-Identifier: LGPL-2.1-or-later
"""contrib/report: one HTML page of a directory of results.

command       what is there, and where its page goes
run           the page of a run: what was computed, results, balances, origin
curves        columns of statistics.csv over time, for curves.js
body          meshes and fields over time, for viewer.js
bill, tables  parts of it
surface       the faces that can be seen
thinning      fewer of them where they are many
packed        arrays as text
written       the page of a study, from the Markdown that it wrote
markup        pieces of HTML; formulas of labels
page          the frame around all that

page.css, curves.js and viewer.js go into each page, and so does vtk/vtk.min.js,
the parts of vtk.js that viewer.js uses (vtk/build makes it). What is said of
quantities, their units and colors comes from contrib/plotting.
"""
