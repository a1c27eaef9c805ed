"""Paths of light followed backward through shells: the compiled half of `monte_carlo.py`.

Collisions, reflections and whole paths; `photon_rays.py` has the rays between them.
"""

import numpy as np
from numba import njit
from photon_rays import below, coefficient, depth_at, depth_to_top, dot, place_at, shadow, trace


# Share of the paths that go on around the sun after their first collision, second, and so on.
AIMED = np.array([0.2, 0.1, 0.05, 0.03])
NUM_ANGLES = 3000  # of a phase function, at angles π (i / NUM_ANGLES)²


@njit(cache=True)
def tabulated(table, cos_angle):
    """A table of angles at a cosine."""
    place = NUM_ANGLES * np.sqrt(np.arccos(min(max(cos_angle, -1.0), 1.0)) / np.pi)
    k = min(int(place), NUM_ANGLES - 1)
    # The share is linear in the angle, which is the square of the place.
    t = (place * place - k * k) / (2 * k + 1)
    return table[k] + t * (table[k + 1] - table[k])


@njit(cache=True)
def draw_angle(table, chance, rng):
    """Draw an angle: a bin by its probability, then within it by rejection."""
    k = below(chance, rng.random(), NUM_ANGLES)
    a, b = np.pi * (k / NUM_ANGLES) ** 2, np.pi * ((k + 1) / NUM_ANGLES) ** 2
    sine = 1.0 if a < 0.5 * np.pi < b else max(np.sin(a), np.sin(b))
    bound = sine * max(table[k], table[k + 1])
    while True:
        t = rng.random()
        theta = a + t * (b - a)
        value = (table[k] + t * (table[k + 1] - table[k])) * np.sin(theta)
        if rng.random() * bound <= value:
            return theta


@njit(cache=True)
def turned(axis, cosine, sine, rng):
    """A direction at an angle from an axis, at a random azimuth."""
    # Two directions across the axis, after Duff et al. (2017), "Building an orthonormal basis,
    # revisited", Journal of Computer Graphics Techniques 6(1).
    x, y, z = axis
    sign = 1.0 if z >= 0 else -1.0
    a = -1 / (sign + z)
    b = x * y * a
    phi = 2 * np.pi * rng.random()
    one, other = sine * np.cos(phi), sine * np.sin(phi)
    d = np.empty(3)
    d[0] = cosine * x + one * (1 + sign * x * x * a) + other * b
    d[1] = cosine * y + one * sign * b + other * (sign + y * y * a)
    d[2] = cosine * z - one * sign * x - other * y
    return d / np.sqrt(dot(d, d))


@njit(cache=True)
def axis_of_aim(p, to_sun):
    """Toward the sun, or 3° above the horizon if it is lower."""
    up = p / np.sqrt(dot(p, p))
    height = dot(up, to_sun)
    level = to_sun - height * up
    size = np.sqrt(dot(level, level))
    if height > np.sin(np.radians(3)) or size < 1e-6:
        return to_sun
    return np.cos(np.radians(3)) * level / size + np.sin(np.radians(3)) * up


@njit(cache=True)
def scattered(air, i, r, cos_angle):
    """Sum over constituents of coefficient times phase function, and of coefficients."""
    t = (r - air.shells[i]) / (air.shells[i + 1] - air.shells[i])
    into, all_ways = 0.0, 0.0
    for k in range(len(air.scattering)):
        beta = air.scattering[k, i] + t * (air.scattering[k, i + 1] - air.scattering[k, i])
        if beta > 0:
            into += beta * tabulated(air.phase[k], cos_angle)
            all_ways += beta
    return into, all_ways


@njit(cache=True)
def sunlight(air, p, r, to_sun):
    """Transmittance to the sun."""
    depth = depth_to_top(air.shells, air.extinction, r, dot(p, to_sun) / r)
    return np.exp(-depth) if depth >= 0 else 0.0


@njit(cache=True)
def end_of(air, ray, p, d):
    """The spot of the ground where a ray ends."""
    spot = p + (ray.ends[ray.pieces] - ray.ends[0]) * d
    return spot * (air.shells[0] / np.sqrt(dot(spot, spot)))


@njit(cache=True)
def reflected(air, ray, p, d, to_sun):
    """Sunlight that the ground at the end of a ray sends along it."""
    if not ray.hit or air.albedo == 0:
        return 0.0
    ground = air.shells[0]
    spot = end_of(air, ray, p, d)
    cosine = dot(spot, to_sun) / ground
    if cosine <= 0:
        return 0.0
    through = np.exp(-ray.depths[ray.pieces])
    return air.albedo / np.pi * cosine * through * sunlight(air, spot, ground, to_sun)


@njit(cache=True)
def collide(air, ray, p, d, to_sun, share):
    """Estimate what the sun sends along a ray by one collision, where the planet lets it.

    Returns:
        The estimate, whether the point was drawn from the whole ray, so that a path may go on from
        it, its distance and its shell.
    """
    whole = ray.depths[ray.pieces]
    length = ray.ends[ray.pieces] - ray.ends[0]
    start, end = shadow(air.shells[0], p, d, to_sun, length)
    before, after, two = -np.expm1(-whole), 0.0, 0.0
    if end > start:
        one = depth_at(air, ray, ray.ends[0] + start)
        two = depth_at(air, ray, ray.ends[0] + end)
        before = -np.expm1(-one)
        after = -np.exp(-two) * np.expm1(two - whole)
    mass = before + after
    if mass <= 0:
        return 0.0, False, 0.0, 0
    u = share * mass
    depth = -np.log1p(-u) if u < before else two - np.log1p(-(u - before) * np.exp(two))
    x, i = place_at(air, ray, min(depth, whole))
    r = np.sqrt(x * x + ray.b2)
    into, _ = scattered(air, i, r, dot(d, to_sun))
    light = sunlight(air, p + (x - ray.ends[0]) * d, r, to_sun)
    extinction = coefficient(air.shells, air.extinction, ray.b2, i, x)
    return mass * into / extinction * light, end <= start, x, i


@njit(cache=True)
def buffers(air):
    """Room for the pieces of a ray."""
    size = 2 * len(air.shells) + 2
    return np.empty(size), np.empty(size), np.empty(size, np.int64)


@njit(cache=True)
def single(air, p, d, to_sun, node, weight):
    """First order of one ray, by Gauss's rule on each piece and each side of the shadow's edges."""
    ends, depths, where = buffers(air)
    ray = trace(air, p, d, ends, depths, where)
    first, last = ends[0], ends[ray.pieces]
    start, end = shadow(air.shells[0], p, d, to_sun, last - first)
    radiance = reflected(air, ray, p, d, to_sun)
    for k in range(ray.pieces):
        cuts = np.array([ends[k], first + start, first + end, ends[k + 1]])
        cuts = np.minimum(np.maximum(cuts, ends[k]), ends[k + 1])
        for m in range(3):
            width = cuts[m + 1] - cuts[m]
            if width <= 0:
                continue
            for j in range(len(node)):
                x = cuts[m] + width * node[j]
                r = np.sqrt(x * x + ray.b2)
                light = sunlight(air, p + (x - first) * d, r, to_sun)
                into, _ = scattered(air, where[k], r, dot(d, to_sun))
                through = np.exp(-depth_at(air, ray, x))
                radiance += width * weight[j] * into * light * through
    return radiance


@njit(cache=True)
def walk(air, eye, view, to_sun, number, rng):
    """Follow paths; sums of their estimates of order 2, of order 3 and of all beyond."""
    ends, depths, where = buffers(air)
    ends2, depths2, where2 = buffers(air)
    sums = np.zeros(3)
    for path in range(number):
        p, d = eye, view
        weight, heuristic, order, floor = 1.0, 1.0, 1, 0.0
        while True:
            ray = trace(air, p, d, ends, depths, where)
            whole = depths[ray.pieces]
            drawn, x, i = False, 0.0, 0
            share = rng.random()
            if order > 1:
                estimate, drawn, x, i = collide(air, ray, p, d, to_sun, share)
                estimate += reflected(air, ray, p, d, to_sun)
                sums[min(order - 2, 2)] += weight * heuristic * estimate
                share = rng.random()
            else:
                share = (path + share) / number
            # Go on from the air or from the ground.
            met = -np.expm1(-whole)
            if not drawn:
                x, i = place_at(air, ray, min(-np.log1p(-share * met), whole))
            r = np.sqrt(x * x + ray.b2)
            _, beta = scattered(air, i, r, 0.0)
            in_air = met * beta / coefficient(air.shells, air.extinction, ray.b2, i, x)
            on_ground = np.exp(-whole) * air.albedo if ray.hit else 0.0
            weight *= in_air + on_ground
            if order == 1:
                floor = 0.1 * weight
            if weight <= 0:
                break
            if weight < floor:
                if rng.random() < 0.5:
                    break
                weight *= 2
            order += 1
            grounded = rng.random() * (in_air + on_ground) < on_ground
            old, up = d, p
            if grounded:
                p = end_of(air, ray, p, d)
                up = p / air.shells[0]
            else:
                p = p + (x - ends[0]) * d
            axis = axis_of_aim(p, to_sun)
            angle = draw_angle(air.aim, air.aim_chance, rng)
            aside = turned(axis, np.cos(angle), np.sin(angle), rng)
            near = AIMED[min(order - 2, len(AIMED) - 1)]
            if rng.random() < near:
                angle = draw_angle(air.aim, air.aim_chance, rng)
                d = turned(axis, np.cos(angle), np.sin(angle), rng)
            elif grounded:
                cosine = np.sqrt(rng.random())
                d = turned(up, cosine, np.sqrt(1 - cosine * cosine), rng)
            else:
                k = species(air, i, r, beta * rng.random())
                angle = draw_angle(air.phase[k], air.chance[k], rng)
                d = turned(old, np.cos(angle), np.sin(angle), rng)
            # Densities of both directions as the matter at hand spreads light.
            if grounded:
                true, beside = max(dot(d, up), 0.0) / np.pi, max(dot(aside, up), 0.0) / np.pi
            else:
                true = scattered(air, i, r, dot(old, d))[0] / beta
                beside = scattered(air, i, r, dot(old, aside))[0] / beta
            if beside > 0:
                # Followed for one collision.
                ray = trace(air, p, aside, ends2, depths2, where2)
                estimate, _, _, _ = collide(air, ray, p, aside, to_sun, rng.random())
                estimate += reflected(air, ray, p, aside, to_sun)
                # Over the sum of the densities with which either way would draw it.
                aim = tabulated(air.aim, dot(aside, axis))
                beside /= (1 - near) * beside + (1 + near) * aim
                sums[min(order - 2, 2)] += weight * beside * estimate
            if true <= 0:
                break
            aim = tabulated(air.aim, dot(d, axis))
            drawn_from = (1 - near) * true + near * aim
            heuristic = drawn_from / (drawn_from + aim)
            weight *= true / drawn_from
    return sums


@njit(cache=True)
def species(air, i, r, left):
    """The constituent at which a running sum of scattering coefficients passes a value."""
    t = (r - air.shells[i]) / (air.shells[i + 1] - air.shells[i])
    k = 0
    while k < len(air.scattering) - 1:
        left -= air.scattering[k, i] + t * (air.scattering[k, i + 1] - air.scattering[k, i])
        if left < 0:
            break
        k += 1
    return k
