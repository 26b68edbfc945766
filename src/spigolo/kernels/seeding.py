"""Kernels that assign the pixels near the borders of objects anew, by a spanning forest that grows from other pixels.

Pixels whose label is assigned anew are called open. Labelled pixels next to open pixels are called seeds.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

f32 = np.float32
LOW_PART, HIGH_PART = f32(0.15), f32(0.85)
"""Lower and upper limit of depth values on the ramp of a depth step, as a share of the height of the step."""
UNREACHED = 255
OPEN, FIRST_COLUMN, LAST_COLUMN = 1, 2, 4
"""Bits that mark a pixel as open, as in the first image column, and as in the last image column."""
LEVELS = 2048
"""Number of integer weights that are distinguished, in grey levels. Larger weights count as LEVELS - 1."""
WORD = 8
"""Number of pixel flags that are compared with 0 in one step, for speed."""
MARGIN = f32(0.01)
"""Upper bound of the rounding error of a weight, in grey levels."""


@inlined
def outermost(depth, start, step, count):
    """Return the first valid depth among the `count` pixels start, start + step, ..., or 0 if all are missing."""
    for k in range(count):
        z = depth[start + k * step]
        if z > f32(0.0):
            return z
    return f32(0.0)


@kernel
def count_ramps(labels, depth, reach_px, step_m, step_share, sums):
    """Measure the width in pixels over which depth steps on the borders of objects are smeared (ramps).

    For each pair of neighbours with different labels, a depth profile of reach_px pixels to both sides is read along
    the image row or column. A profile counts if the depth at its ends differs by more than max(step_m, step_share *
    nearer depth).

    - labels (H, W) int32, 0 = background.
    - depth (H, W) float32 metres, 0 = missing.
    - sums (2,) int64, initially zero: number of profiles, number of pixels between both depths of a step.
    """
    height, width = labels.shape
    flat = depth.reshape(-1)
    flags = np.zeros((width + WORD - 1) // WORD * WORD, np.uint8)
    words = flags.view(np.uint64)
    for y in range(height):
        flag_differences(labels[y], labels[min(y + 1, height - 1)], flags)
        for word in range(words.size):
            for x in range(WORD * word if words[word] else WORD * (word + 1), WORD * (word + 1)):
                if not flags[x]:
                    continue
                if x + 1 < width and labels[y, x + 1] != labels[y, x]:
                    count_profile(flat, y * width + x, 1, x, width, reach_px, step_m, step_share, sums)
                if y + 1 < height and labels[y + 1, x] != labels[y, x]:
                    count_profile(flat, y * width + x, width, y, height, reach_px, step_m, step_share, sums)


@inlined
def flag_differences(row, other, flags):
    """Flag the pixels of an image row whose label differs from the next pixel or from the pixel of the other row."""
    for x in range(row.size - 1):
        flags[x] = (row[x] != row[x + 1]) | (row[x] != other[x])
    flags[row.size - 1] = row[-1] != other[-1]


@inlined
def count_profile(flat, p, step, place, length, reach_px, step_m, step_share, sums):
    """Add the depth profile between pixel p and its neighbour p + step to the sums of `count_ramps`.

    flat (H * W,): depth map. place: position of pixel p in its image row or column. length: length of this image row or
    column.
    """
    if place + 1 < reach_px or place + 1 + reach_px > length:
        return
    ends, first = max(reach_px // 3, 1), p - (reach_px - 1) * step
    last = first + (2 * reach_px - 1) * step
    a, b = outermost(flat, first, step, ends), outermost(flat, last, -step, ends)
    near, far = min(a, b), max(a, b)
    if near == f32(0.0) or far - near <= max(step_m, step_share * near):
        return
    low, high = near + LOW_PART * (far - near), near + HIGH_PART * (far - near)
    sums[0] += 1
    for k in range(ends, 2 * reach_px - ends):
        z = flat[first + k * step]
        sums[1] += (z > low) & (z < high)


@inlined
def mark_borders(labels, layer):
    """Set layer to 1 at the pixels next to another label. Return the indices y * width + x of the pixels in layer 1."""
    height, width = labels.shape
    queue, size = np.empty(labels.size, np.int64), 0
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
                if flags[x]:
                    layer[y, x] = 1
                    queue[size] = y * width + x
                    size += 1
    return queue[:size]


@kernel
def measure_layers(labels, near_hole, width_px, hole_width_px, layer, inner):
    """Number the pixels near borders in layers: layer 1 touches another label, layer 2 touches layer 1, and so on.

    The maximum layer is width_px, or hole_width_px where near_hole is nonzero.

    - labels (H, W) int32: label of each pixel.
    - near_hole (H, W) uint8: nonzero near missing depth.
    - layer (H, W) uint8: 255 in pixels beyond the maximum layer.
    - inner (N,) int32: number of layers of each label, or 255 if the label has pixels beyond the maximum layer.
    """
    height, width = labels.shape
    layer[:] = UNREACHED
    inner[:] = 0
    queue = mark_borders(labels, layer)
    size, number = queue.size, 1
    while size > 0:
        following = np.empty(8 * size, np.int64)
        found = 0
        for k in range(size):
            y = queue[k] // width
            x = queue[k] - y * width
            here = labels[y, x]
            inner[here] = max(inner[here], number)
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    if number % 2 == 0 and dy != 0 and dx != 0:
                        continue  # 8-neighbours and 4-neighbours alternate, so that layers are nearly round
                    v, u = y + dy, x + dx
                    if v < 0 or u < 0 or v >= height or u >= width or layer[v, u] != UNREACHED:
                        continue
                    if number >= (hole_width_px if near_hole[v, u] else width_px):
                        inner[labels[v, u]] = UNREACHED
                        continue
                    layer[v, u] = number + 1
                    following[found] = v * width + u
                    found += 1
        queue, size = following, found
        number += 1


@kernel
def open_layers(labels, layer, inner, share, opened):
    """Mark the outer layers of each label as open, up to `share` of its layers. Return the number of open pixels.

    If a label has pixels beyond the maximum layer, all layers of this label become open.

    labels (H, W) int32. layer (H, W) uint8, inner (N,) int32: results of `measure_layers`. opened (H, W) uint8: flags
    of open pixels, 0 for other pixels.
    """
    height, width = labels.shape
    count = 0
    for y in range(height):
        for x in range(width):
            k = layer[y, x]
            limit = inner[labels[y, x]]
            is_open = k != UNREACHED and (limit == UNREACHED or k <= share * limit)
            sides = (FIRST_COLUMN if x == 0 else 0) | (LAST_COLUMN if x == width - 1 else 0)
            opened[y, x] = (OPEN | sides) if is_open else 0
            count += is_open
    return count


@kernel
def flag_columns(opened):
    """Set the column flags of the open pixels in the first and last image column. opened (H, W) uint8."""
    last = opened.shape[1] - 1
    for y in range(opened.shape[0]):
        if opened[y, 0]:
            opened[y, 0] |= FIRST_COLUMN
        if opened[y, last]:
            opened[y, last] |= LAST_COLUMN


@inlined
def distance_2(red, green, blue, color, p):
    """Return the squared distance in RGB between a colour and the colour of pixel p."""
    red, green, blue = red - f32(color[p, 0]), green - f32(color[p, 1]), blue - f32(color[p, 2])
    return red * red + green * green + blue * blue


@inlined
def step_cost(z, other, full, step_weight):
    """Return the cost of a depth step between two depths, from 0 to step_weight. The cost is 0 if one depth is missing.

    full: depth difference in metres from which the cost is step_weight.
    """
    if z <= f32(0.0) or other <= f32(0.0):
        return f32(0.0)
    step = abs(z - other)
    return step_weight if step >= full else step_weight * step / full


@inlined
def neighbour(p, k, flags, width, size):
    """Return the index of the k-th of the four neighbours of an open pixel p, or a negative number outside the image.

    flags: flags of pixel p.
    """
    if k == 0:
        return -1 if flags & LAST_COLUMN else p + 1
    if k == 1:
        return p + width if p + width < size else -1
    if k == 2:
        return -1 if flags & FIRST_COLUMN else p - 1
    return p - width


@inlined
def offer(bucket, p, s, size, least, head, tail, edges):
    """Add the edge from labelled pixel s to open pixel p to the queue, unless a lighter edge to p is known.

    bucket: weight of the edge in whole grey levels. size: number of edges in the queue. Returns the new number of edges
    in the queue.
    """
    if bucket >= least[p]:
        return size
    least[p] = bucket
    edges[size, 0], edges[size, 1], edges[size, 2] = p, s, -1
    if head[bucket] < 0:
        head[bucket] = size
    else:
        edges[tail[bucket], 2] = size
    tail[bucket] = size
    return size + 1


@inlined
def sow(points, flat, state, step_m, step_per_m, step_weight, width, least, head, tail, edges, tree, source_of):
    """Add all edges from labelled to open pixels to the queue. Return the number of edges and the lightest weight."""
    size, level = 0, LEVELS
    for p in range(state.size):
        for k in range(4 if state[p] else 0):
            q = neighbour(p, k, state[p], width, state.size)
            if q < 0 or state[q]:
                continue
            red, green, blue = f32(points[q, 0]), f32(points[q, 1]), f32(points[q, 2])
            tree[q, 0], tree[q, 1], tree[q, 2] = red, green, blue
            source_of[q] = q
            full = max(step_m, step_per_m * flat[q] * flat[q])
            weight = np.sqrt(distance_2(red, green, blue, points, p)) + step_cost(flat[q], flat[p], full, step_weight)
            bucket = min(int(weight), LEVELS - 1)
            size = offer(bucket, p, q, size, least, head, tail, edges)
            level = min(level, bucket)
    return size, level


@kernel
def grow_seeds(color, depth, labels, opened, count, memory, carry, step_m, step_per_m, step_weight, source_of):
    """Give each open pixel the label of a seed, by a spanning forest whose roots are the seeds.

    The forest grows by Prim's algorithm, always along the lightest edge from a labelled to an open pixel. The weight of
    an edge is a sum of three terms:

    - the RGB distance between the open pixel and the mean colour of the tree
    - the cost of a depth step between both pixels of the edge
    - `carry` times the weight of the previous edge of the tree, so that a blurred image edge is as heavy as a sharp one

    The mean colour of a tree is `memory` times the previous mean plus (1 - memory) times the colour of the new pixel.
    With memory = carry = 0 the result is a minimum spanning forest. Weights are rounded down to whole grey levels.
    Among edges of equal weight, the edge that was found first is used.

    - color (H, W, 3) uint8: RGB image.
    - depth (H, W) float32 metres, 0 = missing.
    - labels (H, W) int32: changed at open pixels.
    - opened (H, W) uint8: flags of `open_layers`, set to 0 at pixels that get a label.
    - count: number of open pixels.
    - step_m, step_per_m float32: a depth step of max(step_m, step_per_m z^2) costs step_weight.
    - source_of (H * W,) int32: index y * W + x of the seed of each open pixel.
    """
    width = labels.shape[1]
    points, flat, label, state = color.reshape(-1, 3), depth.reshape(-1), labels.reshape(-1), opened.reshape(-1)
    head, tail = np.full(LEVELS, -1, np.int32), np.empty(LEVELS, np.int32)
    edges = np.empty((4 * count + 1, 3), np.int32)  # open pixel, labelled pixel, next edge of equal weight
    least = np.full(label.size, LEVELS, np.int16)  # weight of the lightest edge to each pixel so far
    tree = np.empty((label.size, 3), np.float32)  # mean colour of the tree at each labelled pixel
    keep, own, carried = f32(memory), f32(1.0 - memory), f32(carry)
    size, level = sow(
        points, flat, state, step_m, step_per_m, step_weight, width, least, head, tail, edges, tree, source_of
    )
    while level < LEVELS:
        edge = head[level]
        if edge < 0:
            level += 1
            continue
        head[level] = edges[edge, 2]
        p, s = edges[edge, 0], edges[edge, 1]
        if not state[p]:
            continue
        flags, state[p] = state[p], 0
        source_of[p], label[p] = source_of[s], label[s]
        red = keep * tree[s, 0] + own * f32(points[p, 0])
        green = keep * tree[s, 1] + own * f32(points[p, 1])
        blue = keep * tree[s, 2] + own * f32(points[p, 2])
        tree[p, 0], tree[p, 1], tree[p, 2] = red, green, blue
        z, before = flat[p], carried * f32(level)
        full = max(step_m, step_per_m * z * z)
        for k in range(4):
            q = neighbour(p, k, flags, width, state.size)
            if q < 0 or not state[q]:
                continue
            room = f32(least[q]) - before
            colors_2 = distance_2(red, green, blue, points, q)
            if room <= f32(0.0) or colors_2 > (room + MARGIN) * (room + MARGIN):
                continue  # the edge is heavier than a known edge, even without the cost of a depth step
            bucket = min(int(before + np.sqrt(colors_2) + step_cost(z, flat[q], full, step_weight)), LEVELS - 1)
            size = offer(bucket, q, p, size, least, head, tail, edges)
            level = min(level, bucket)


@kernel
def follow_seeds(before, after, source_of, regions, out, areas):
    """Give each pixel whose label changed the region number of its seed, and count the pixels of each region.

    - before, after: labels (H, W) int32 before and after `grow_seeds`.
    - source_of (H * W,) int32: result of `grow_seeds`.
    - regions, out: old and new region numbers (H, W) int32.
    - areas (R,) int64, initially zero: number of pixels of each region.
    """
    width, flat = before.shape[1], regions.reshape(-1)
    for y in range(before.shape[0]):
        for x in range(width):
            here = regions[y, x] if after[y, x] == before[y, x] else flat[source_of[y * width + x]]
            out[y, x] = here
            areas[here] += 1
