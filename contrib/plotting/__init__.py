# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of directories of results; contrib/plot is the command.

results     what a run wrote: records of a series, statistics, parameters
geometry    welding, boundary faces, edges: meshes without physics
faces       the contact boundary in flat pieces with coordinates of their own
units       units on axes, in handy multiples
quantities  words and kinds of units of fields and columns
style       colors, titles and keys, the same in all pictures
supports    what the scene prescribes on the boundary
body_base, body, body_3d
            a field on the deformed body, in two and in three dimensions
overview, fields, contact, history, errors, efficiency, hysteresis, lines, stick_slip
            one kind of picture each: draw(...) returns a figure
animation   a picture over time
command     the command line
"""
