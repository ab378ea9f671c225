# SPDX-License-Identifier: LGPL-2.1-or-later
"""A picture at every output, as a GIF or, where there is ffmpeg, an MP4."""

import matplotlib.pyplot as plt
from matplotlib.animation import FFMpegWriter, PillowWriter

from .results import NoPicture, UserError

SECONDS = 8.0  # for the whole animation, as far as the frame rate allows


def write(path, figures, n_frames, dpi):
    """figures: an iterator over figures of equal size."""
    if n_frames < 2:
        raise NoPicture("there is only one output: nothing to animate")
    rate = max(2, min(20, round(n_frames / SECONDS)))
    if path.suffix == ".mp4":
        if not FFMpegWriter.isAvailable():
            raise UserError("ffmpeg is not installed; without it only GIF is possible")
        # Its default encoder wants even numbers of pixels.
        even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
        writer = FFMpegWriter(fps=rate, extra_args=even)
    else:
        writer = PillowWriter(fps=rate)
    first = next(figures)
    with writer.saving(first, path, dpi):
        writer.grab_frame()
        for figure in figures:
            figure.set_size_inches(first.get_size_inches())
            writer.fig = figure
            writer.grab_frame()
            plt.close(figure)
    plt.close(first)
