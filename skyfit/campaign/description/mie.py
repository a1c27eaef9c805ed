"""Mie theory for spheres of many sizes; miepython supplies the coefficients of each."""

from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from .spectra import Part, Wavelengths, spectrum_at


NUM_RADII = 160  # in the logarithm of the radius
WAVELENGTH_STEP = 25.0  # nm; between two such the cross-sections of many sizes are smooth
ANGLES_DEG = np.concatenate(
    [[0.0], np.geomspace(0.2, 12.0, 28), np.linspace(15.0, 165.0, 51), np.linspace(167.0, 180, 14)]
)


class MieOptics(NamedTuple):
    """What an average particle does.

    Attributes:
        extinction: Cross-section [m²].
        albedo: Scattering over extinction.
        angle: Scattering angles [rad].
        phase: Not normalised.
    """

    extinction: Wavelengths
    albedo: Wavelengths
    angle: Float[np.ndarray, " angle"]
    phase: Float[np.ndarray, "angle wavelength"]


def mie_optics(part: Part, wavelengths: Wavelengths) -> MieOptics:
    """Optics of spheres of a size distribution.

    Computed every 25 nm or less and interpolated; kept for the next call. Light scattered by less
    than `forward_peak_deg`, as far as there is more of it than at that angle, counts as light that
    goes on: the diffraction around large spheres is narrower than what the simulator can follow
    beyond the first order.

    Args:
        part: A table with `size`, `refractive_index`, `absorption_index`, `forward_peak_deg`.
        wavelengths: Wavelengths of the result, increasing [nm].
    """
    steps = int(np.ceil(np.ptp(wavelengths) / WAVELENGTH_STEP))
    nodes = np.linspace(wavelengths[0], wavelengths[-1], steps + 1)
    real = spectrum_at(part["refractive_index"], nodes)
    imaginary = spectrum_at(part["absorption_index"], nodes)
    size = tuple(sorted(part["size"].items()))
    peak = float(part.get("forward_peak_deg", 0.0))
    table = [
        _without_peak(peak, *_at(size, *map(float, row)))
        for row in zip(nodes, real, imaginary, strict=True)
    ]
    if steps == 0:
        table, nodes = [table[0]] * 2, np.array([nodes[0], nodes[0] + 1])

    def along(values):
        return np.interp(wavelengths, nodes, values)

    phase = np.array([np.log(row[2]) for row in table])
    return MieOptics(
        extinction=along([row[0] for row in table]),
        albedo=along([row[1] / row[0] for row in table]),
        angle=np.radians(ANGLES_DEG),
        phase=np.exp(np.stack([along(column) for column in phase.T])),
    )


def number_density(size: Part, radius: Float[np.ndarray, " radius"]) -> np.ndarray:
    """DN / d ln r of a size distribution, up to a factor.

    "lognormal" by median radius and geometric standard deviation; "gamma" after Hansen & Travis
    (1974), "Light scattering in planetary atmospheres", Space Science Reviews 16, equation 2.56,
    by effective radius and variance; "power_law", dN / d ln r ~ r^-exponent (Junge).
    """
    if size["kind"] == "lognormal":
        spread = np.log(size["geometric_deviation"])
        return np.exp(-0.5 * (np.log(radius / (1e-9 * size["median_radius_nm"])) / spread) ** 2)
    if size["kind"] == "gamma":
        a, b = 1e-9 * size["effective_radius_nm"], size["effective_variance"]
        return np.exp((1 - 2 * b) / b * np.log(radius / a) - radius / (a * b))
    return (radius / radius[0]) ** -size["exponent"]


def _without_peak(peak: float, extinction: float, scattering: float, spread: np.ndarray):
    """Count the forward peak as light that goes on."""
    angle = np.radians(ANGLES_DEG)
    level = np.interp(np.radians(peak), angle, spread)
    flat = np.where(angle < np.radians(peak), np.minimum(spread, level), spread)
    ring = 2 * np.pi * np.sin(angle)
    lost = scattering * (1 - np.trapezoid(flat * ring, angle) / np.trapezoid(spread * ring, angle))
    return extinction - lost, scattering - lost, flat


@cache
def _at(size: tuple, wavelength: float, real: float, imaginary: float):
    """Extinction and scattering cross-sections [m²] and dC/dΩ of an average particle."""
    import miepython

    part = dict(size)
    low, high = (1e-9 * part[f"{end}_radius_nm"] for end in ("smallest", "largest"))
    radii = np.geomspace(low, high, NUM_RADII)
    share = number_density(part, radii)
    share[[0, -1]] *= 0.5
    share /= share.sum()
    wavenumber = 2 * np.pi / (1e-9 * wavelength)
    largest = wavenumber * high
    terms = int(largest + 4.05 * largest ** (1 / 3) + 20)
    a, b = np.zeros((2, NUM_RADII, terms), complex)
    for row, radius in enumerate(radii):
        found = miepython.coefficients(complex(real, -imaginary), wavenumber * radius)
        a[row, : len(found[0])], b[row, : len(found[1])] = found
    n = np.arange(1, terms + 1)
    per_term = 2 * np.pi / wavenumber**2 * (2 * n + 1)
    extinction = share @ np.real(a + b) @ per_term
    scattering = share @ (abs(a) ** 2 + abs(b) ** 2) @ per_term
    pi_n, tau_n = angular_functions(np.cos(np.radians(ANGLES_DEG)), terms)
    scale = (2 * n + 1) / (n * (n + 1))
    spread = np.zeros(ANGLES_DEG.size)
    for one, other in ((pi_n, tau_n), (tau_n, pi_n)):  # both amplitudes
        for half in (np.real, np.imag):
            amplitude = (scale * half(a)) @ one + (scale * half(b)) @ other
            spread += share @ amplitude**2 / (2 * wavenumber**2)
    return float(extinction), float(scattering), spread


def angular_functions(mu: np.ndarray, terms: int) -> tuple[np.ndarray, np.ndarray]:
    """π_n and τ_n for n = 1 … terms, [term, angle], by upward recurrence.

    Source: Bohren & Huffman (1983), "Absorption and Scattering of Light by Small Particles",
    equation 4.47.
    """
    pi_n, tau_n = np.zeros((terms + 1, mu.size)), np.zeros((terms + 1, mu.size))
    pi_n[1], tau_n[1] = 1.0, mu
    for n in range(2, terms + 1):
        pi_n[n] = ((2 * n - 1) * mu * pi_n[n - 1] - n * pi_n[n - 2]) / (n - 1)
        tau_n[n] = n * mu * pi_n[n] - (n + 1) * pi_n[n - 1]
    return pi_n[1:], tau_n[1:]
