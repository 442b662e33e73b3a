"""Rough pre-stress: a Gaussian random field along the interface."""

from typing import NamedTuple

import numpy as np

from .checks import check_number
from .prestress_parts import MAX_TABLE_POINTS

# Larger values of the field are replaced by this one, because a rupture would start wherever the
# pre-stress is 1.
MAX_PRESTRESS = 0.95


class Background(NamedTuple):
    """Positions and values of a background, in the form that `Prestress.through` takes."""

    x: np.ndarray
    tau: np.ndarray


def rough(
    level: float,
    deviation: float,
    correlation_length: float,
    hurst: float,
    start: float,
    stop: float,
    spacing: float,
    seed: int,
) -> Background:
    """Make a rough background for `Prestress.through`: a Gaussian random field.

    The amplitude at wave number k is (1 + (k correlation_length)^2)^(-(hurst + 1/2)/2), which is a
    power law at lengths below the correlation length. The same seed gives the same field on every
    machine. Values above 0.95 are set to 0.95, since a rupture would start where the pre-stress
    is 1.

    Parameters
    ----------
    level : float, units of the stress drop
        Mean over the fields of all seeds, < 1.
    deviation : float, units of the stress drop
        Standard deviation over the fields of all seeds, >= 0.
    correlation_length : float, units of H
        Length above which the field is uncorrelated, > 0.
    hurst : float
        Roughness at short lengths, from 0 (rougher) to 1 (smoother).
    start, stop, spacing : float, units of H
        The positions begin at start, have a distance of spacing > 0, and end at or before stop.
    seed : int
        Seed of the random numbers, >= 0.

    Returns
    -------
    Background
        x and tau, arrays of equal length.

    Raises
    ------
    ValueError
        In one line that names the argument, its value and what is allowed.

    Notes
    -----
    Source: an addition of this project. The field is white noise that is filtered by a Fourier
    transform, which makes it periodic. It is therefore computed over twice the length, and its
    first half is returned, so that the two ends of the returned field are independent.

    Examples
    --------
    >>> field = sp.rough(0.4, 0.1, 1.0, 0.5, start=-50.0, stop=50.0, spacing=0.1, seed=7)
    >>> profile = sp.Prestress.through(*field, width=1.0)
    """
    check_number("level", level, below=1.0)
    check_number("deviation", deviation, at_least=0.0)
    check_number("correlation_length", correlation_length, above=0.0)
    check_number("hurst", hurst, at_least=0.0, at_most=1.0)
    check_number("start", start)
    check_number("stop", stop, above=start)
    check_number("spacing", spacing, above=0.0, at_most=stop - start)
    check_number("seed", seed, integer=True, at_least=0)
    spacings = (stop - start) / spacing
    check_number("points", spacings + 1.0, at_most=MAX_TABLE_POINTS)
    # A whole number of spacings can be slightly too small by rounding.
    size = int(spacings + 1e-9) + 1
    noise = np.random.Generator(np.random.PCG64(seed)).standard_normal(2 * size)
    wave_number = 2.0 * np.pi * np.fft.fftfreq(2 * size, spacing)
    amplitude = (1.0 + (wave_number * correlation_length) ** 2) ** (-0.5 * (hurst + 0.5))
    # The noise has variance 1, so the variance of the field is the mean square of the amplitudes.
    amplitude *= deviation / np.sqrt(np.mean(amplitude**2))
    field = np.fft.ifft(np.fft.fft(noise) * amplitude).real[:size]
    # Rounding removes the last digits, in which multiples of the spacing are not exact.
    x = np.round(start + spacing * np.arange(size), 12)
    return Background(x, np.minimum(level + field, MAX_PRESTRESS))
