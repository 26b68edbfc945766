"""Kernels for a Potts model of an image with Metropolis updates (Abramov et al., 2012).

In a Potts model, every pixel has a spin, which is an integer. Two neighbouring pixels have an interaction J, which is
positive if their colours are similar and negative otherwise. The energy of the image is E = -(sum of J over all pairs
of neighbouring pixels with equal spins). Interactions are stored in four planes, one for each direction to a neighbour.
The interaction J is 0 for pairs that leave the image.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

NEIGHBOURS = 8
LOW_BITS = np.uint64(0xFFFFFFFF)
ODD_A, ODD_B, ODD_C = np.uint64(0x9E3779B1), np.uint64(0x85EBCA77), np.uint64(0xC2B2AE3D)
"""Multipliers of a hash function that makes random bits from counters (primes from xxHash and MurmurHash)."""
TO_UNIT = 1.0 / (1 << 32)


@inlined
def scatter_bits(value):
    """Mix the 32 lower bits of a uint64, so that consecutive integers give unrelated bits."""
    value = ((value ^ (value >> np.uint64(15))) * ODD_B) & LOW_BITS
    value = ((value ^ (value >> np.uint64(13))) * ODD_C) & LOW_BITS
    return value ^ (value >> np.uint64(16))


@inlined
def draw(seed, sweep, pixel, which):
    """Return 32 pseudo-random bits that depend only on the numbers `seed`, `sweep`, `pixel` and `which`, not on the
    order of calls.
    """
    first = scatter_bits((np.uint64(seed) * ODD_A + np.uint64(sweep)) & LOW_BITS)
    second = scatter_bits((first * ODD_A + np.uint64(pixel)) & LOW_BITS)
    return scatter_bits((second * ODD_A + np.uint64(which)) & LOW_BITS)


@inlined
def color_interaction(distance, mean, repulsion):
    """Return the interaction J of two colours: 1 for equal colours, 0 at the colour distance `mean`, and at least
    `-repulsion`.
    """
    return max(np.float32(1.0) - distance / mean, -repulsion)


@inlined
def is_step(z_here, z_there, step, step_per_m):
    """Return True if two depth values, in metres, differ by a depth step. If one depth is missing, the result
    is False.
    """
    near = min(z_here, z_there)
    return near > 0.0 and abs(z_here - z_there) > max(step, step_per_m * near * near)


@kernel
def interaction_plane(distance, depth, mean, repulsion, step, step_per_m, penalty, dy, dx, out):
    """Compute the interaction J of all pairs of pixels with the offset (dy, dx).

    Across a depth step of more than max(step, step_per_m d^2), the interaction is `-penalty`, where d is the smaller
    depth of the pair.

    - distance (H, W) float32: colour distance of each pair, +inf where a pair leaves the image.
    - depth (H, W): depth map in metres, 0 = missing.
    - mean, repulsion: parameters of the function `color_interaction`.
    - step: minimum depth step, in metres.
    - step_per_m: minimum depth step per squared depth, 1/m.
    - out (H, W) float32: interaction of each pair.
    """
    height, width = depth.shape
    mean, repulsion, penalty = np.float32(mean), np.float32(repulsion), np.float32(penalty)
    step, step_per_m = np.float32(step), np.float32(step_per_m)
    out[:] = 0.0
    for y in range(max(0, -dy), height - max(0, dy)):
        for x in range(width - dx):
            stepped = is_step(depth[y, x], depth[y + dy, x + dx], step, step_per_m)
            out[y, x] = -penalty if stepped else color_interaction(distance[y, x], mean, repulsion)


@inlined
def look_around(spins, planes, y, x, spin, force):
    """Read the spins and the interactions of the 8 neighbours of a pixel into the arrays `spin` and `force`.

    Neighbours outside the image have spin -1 and interaction 0.
    """
    height, width = spins.shape
    k = 0
    for dy in range(-1, 2):
        for dx in range(-1, 2):
            if dy == 0 and dx == 0:
                continue
            v, u = y + dy, x + dx
            if v < 0 or u < 0 or v >= height or u >= width:
                spin[k], force[k] = -1, 0.0
            else:
                # a pair is stored at its first pixel, in the plane of its direction: right, down, down-right, up-right
                plane = 0 if dy == 0 else (1 if dx == 0 else (2 if dy == dx else 3))
                from_here = dx > 0 or (dx == 0 and dy > 0)
                spin[k] = spins[v, u]
                force[k] = planes[plane, y, x] if from_here else planes[plane, v, u]
            k += 1


@inlined
def energy(spin, force, of):
    """Return the part of the energy E that depends on one pixel, for the case that its spin is `of`. The arrays `spin`
    and `force` contain the spins and interactions of the neighbours of the pixel.
    """
    total = np.float32(0.0)
    for k in range(NEIGHBOURS):
        if spin[k] == of:
            total -= force[k]
    return total


@inlined
def best_other(spin, force, own, stranger):
    """Return the spin with the lowest energy, and the energy for this spin. Candidates are the random spin `stranger`,
    and the spins of the neighbours that differ from the spin `own`.
    """
    best, least = stranger, energy(spin, force, stranger)
    for k in range(NEIGHBOURS):
        if spin[k] >= 0 and spin[k] != own:
            here = energy(spin, force, spin[k])
            if here < least:
                best, least = spin[k], here
    return best, least


@kernel
def sweep(spins, planes, values, temperature, seed, number):
    """Run one Metropolis sweep over all pixels. The spin proposed for a pixel is the spin with the lowest energy, apart
    from its current spin.

    A new spin that changes the energy by dE <= 0 is always accepted. A new spin with dE > 0 is accepted with the
    probability exp(-dE / temperature). Pixels are updated in four groups, each with every second pixel of every second
    row. Pixels of one group are not neighbours, so that the order of updates in a group does not matter.

    - spins (H, W) int32: spins from 0 to values - 1, changed in place.
    - planes (4, H, W) float32: interactions.
    - seed, number: seed of the random bits, and number of the sweep.

    Returns the number of changed spins.
    """
    height, width = spins.shape
    spin, force = np.empty(NEIGHBOURS, np.int32), np.empty(NEIGHBOURS, np.float32)
    changed = 0
    for quarter in range(4):
        for y in range(quarter // 2, height, 2):
            for x in range(quarter % 2, width, 2):
                own, pixel = spins[y, x], y * width + x
                look_around(spins, planes, y, x, spin, force)
                stranger = np.int32(draw(seed, number, pixel, 0) % np.uint64(values))
                other, least = best_other(spin, force, own, stranger)
                rise = least - energy(spin, force, own)
                chance = draw(seed, number, pixel, 1) * TO_UNIT
                if other != own and (rise <= 0.0 or chance < np.exp(-rise / temperature)):
                    spins[y, x] = other
                    changed += 1
    return changed
