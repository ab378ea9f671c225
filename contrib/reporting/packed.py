# SPDX-License-Identifier: LGPL-2.1-or-later
"""Arrays of numbers as text that a page can hold; viewer.js reads them."""

import base64
import gzip

import numpy as np


class Packed:
    """Arrays one after the other. Each is known by [kind, first byte, length]."""

    KINDS = {"u1": np.uint8, "u2": np.uint16, "u4": np.uint32}

    def __init__(self):
        self.parts = []
        self.size = 0

    def add(self, kind, values):
        data = np.ascontiguousarray(values, dtype=self.KINDS[kind]).ravel()
        # In a browser an array begins at a multiple of the size of its numbers.
        content = data.astype(data.dtype.newbyteorder("<")).tobytes()
        content += bytes(-len(content) % 4)
        reference = [kind, self.size, len(data)]
        self.parts.append(content)
        self.size += len(content)
        return reference

    def indices(self, values):
        small = np.max(values, initial=0) < 2**16
        return self.add("u2" if small else "u4", values)

    def text(self):
        # The date in the header would make pages of the same results differ.
        content = gzip.compress(b"".join(self.parts), compresslevel=9, mtime=0)
        return base64.b64encode(content).decode("ascii")


def levels(values, low, high):
    """Numbers from 0 to 255 for values between low and high, and for those beyond
    the ends: as many as there are colors."""
    share = (np.asarray(values, dtype=float) - low) / (high - low)
    return np.rint(255.0 * np.clip(share, 0.0, 1.0))
