"""Centre-surround saliency of Montabone & Soto 2010."""

from __future__ import annotations

from spigolo.kernels._jit import kernel


@kernel
def center_surround(gray, integral, surrounds, on, off):
    """Sums over all surrounds how much brighter (on) and darker (off) each pixel is than its surround.

    gray (H, W) uint8; integral (H+1, W+1) of gray; surrounds: half-sizes n of 2n x 2n windows (rows y-n+1..y+n,
    clipped), whose centre pixel does not count. Each difference is cut to a whole grey level; on and off (H, W) int32.
    """
    height, width = gray.shape
    for y in range(height):
        for x in range(width):
            center = int(gray[y, x])
            bright, dark = 0, 0
            for n in surrounds:
                top, bottom = max(y - n + 1, 0), min(y + n + 1, height)
                left, right = max(x - n + 1, 0), min(x + n + 1, width)
                count = (bottom - top) * (right - left) - 1
                total = integral[bottom, right] - integral[bottom, left] - integral[top, right] + integral[top, left]
                if count > 0:
                    difference = center - (total - center) / count
                    bright += int(max(difference, 0.0))
                    dark += int(max(-difference, 0.0))
            on[y, x] = bright
            off[y, x] = dark
