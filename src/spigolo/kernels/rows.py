"""Search for the pixels on borders between regions. Most pixels of an image lie inside a region, so each image row is
compared with its neighbours as a whole, and pixels inside regions are then skipped eight at a time.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined

WORD = 8
"""Number of one-byte flags that are compared with 0 as one 64-bit number, for speed."""


@inlined
def border_pixels(labels):
    """Return the indices y * W + x, in ascending order, of the pixels (y, x) that have a 4-neighbour with another
    label. labels (H, W) int32.
    """
    height, width = labels.shape
    pixels, size = np.empty(labels.size + WORD, np.int32), 0
    flags = np.zeros((width + WORD - 1) // WORD * WORD, np.uint8)
    words = flags.view(np.uint64)
    for y in range(height):
        row, above, below = labels[y], labels[max(y - 1, 0)], labels[min(y + 1, height - 1)]
        for x in range(1, width - 1):
            sideways = (row[x] != row[x - 1]) | (row[x] != row[x + 1])
            flags[x] = sideways | (row[x] != above[x]) | (row[x] != below[x])
        for x in (0, width - 1):
            sideways = (row[x] != row[max(x - 1, 0)]) | (row[x] != row[min(x + 1, width - 1)])
            flags[x] = sideways | (row[x] != above[x]) | (row[x] != below[x])
        for word in range(words.size):
            for x in range(WORD * word if words[word] else WORD * (word + 1), WORD * (word + 1)):
                pixels[size] = y * width + x
                size += flags[x]
    return pixels[:size]
