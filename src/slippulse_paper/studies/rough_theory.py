"""Theory of pulses on a rough pre-stress: death rate, random walk, and the balance at death.

The parameters of an ensemble of rough pre-stress fields are passed as a mapping, with the mean of
the field (level), its standard deviation, correlation_length, hurst exponent and grid spacing. The
death rate also needs the gamma and the damping_ratio of the runs.
"""

import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from scipy.special import gamma as gamma_function
from scipy.special import ndtr

from slippulse.theory.barrier import barrier_depth

# The death rate is maximised over these barriers, given as -(stress of the barrier)/(mean level).
RELATIVE_BARRIERS = np.geomspace(0.03, 10.0, 12)
# A random walk with exponentially correlated steps that ends at 0 is like a Brownian motion that
# ends below 0. This is the distance from 0 to that end, divided by the standard deviation of the
# steps and by their correlation length. It is -zeta(1/2) (Doering, Hagan and Levermore 1987).
MILNE = 1.4603545088095868
# Length of the field over which sums over the spectrum run, in correlation lengths.
PERIOD_IN_CORRELATION_LENGTHS = 400


def spectrum(parameters: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return the wave numbers of a rough field, and the variance that each of them contributes.

    The field has a von Karman spectrum, which falls as (1 + k^2 l^2)^-(hurst + 1/2), where l is the
    correlation length. It is periodic here, so that the wave numbers k are discrete.
    """
    correlation_length, spacing = parameters["correlation_length"], parameters["spacing"]
    point_count = round(PERIOD_IN_CORRELATION_LENGTHS * correlation_length / spacing)
    wave_numbers = 2.0 * np.pi * np.fft.fftfreq(point_count, spacing)
    scaled = 1.0 + (wave_numbers * correlation_length) ** 2
    shape = scaled ** -(parameters["hurst"] + 0.5)
    return wave_numbers, parameters["deviation"] ** 2 * shape / np.sum(shape)


def barrier_rate(parameters: Mapping[str, Any], release: str) -> dict[str, float]:
    """Return the predicted number of fatal barriers per length, with the most frequent barrier.

    A barrier is a stretch of negative pre-stress. It stops a steady pulse if it is longer than the
    critical depth, which theory gives for each stress of the barrier. So a pulse dies where the
    mean of the pre-stress over a critical depth falls below that stress. This mean is a Gaussian
    field, and Rice's formula gives the rate of its downcrossings. The stress with the largest rate
    is chosen from RELATIVE_BARRIERS.
    """
    level = parameters["level"]
    wave_numbers, variances = spectrum(parameters)
    most_frequent = {"barrier_rate": 0.0, "barrier": math.nan, "depth": math.nan}
    for barrier in level * RELATIVE_BARRIERS:
        depth = critical_depth(
            level, -barrier, parameters["gamma"], parameters["damping_ratio"], release
        )
        # Averaging over a length multiplies each amplitude by sin(k depth/2)/(k depth/2).
        averaging_factors = np.sinc(wave_numbers * depth / (2.0 * np.pi))
        averaged = variances * averaging_factors**2
        variance_of_mean = np.sum(averaged)
        variance_of_slope = np.sum(averaged * wave_numbers**2)
        # Rice's formula for the rate at which the mean falls this far below its average.
        fall = level + barrier
        rate = math.exp(-(fall**2) / (2.0 * variance_of_mean))
        rate *= math.sqrt(variance_of_slope / variance_of_mean) / (2.0 * np.pi)
        if rate > most_frequent["barrier_rate"]:
            most_frequent = {"barrier_rate": rate, "barrier": -barrier, "depth": depth}
    return most_frequent


@cache
def critical_depth(
    level: float, barrier: float, gamma: float, damping_ratio: float, release: str
) -> float:
    """Return the exact depth to which a pulse enters a barrier.

    The depth is computed only once for all ensembles that have the same level.
    """
    return barrier_depth(level, barrier, gamma, damping_ratio, release)


def diffusivity(parameters: Mapping[str, Any]) -> float:
    """Return the variance of the integral of a rough field over a long distance, per distance.

    The result is 2 pi S(0), where S(k) is the power spectrum of the field. S(k) is proportional to
    (1 + k^2 l^2)^-(H + 1/2), where l is the correlation length and H the Hurst exponent. The
    integral of S(k) over all k is the variance of the field. From this follows
    S(0) = variance l Gamma(H + 1/2)/(sqrt(pi) Gamma(H)).
    """
    hurst, deviation = parameters["hurst"], parameters["deviation"]
    shape = 2.0 * math.sqrt(math.pi) * gamma_function(hurst + 0.5) / gamma_function(hurst)
    return float(shape * parameters["correlation_length"] * deviation**2)


def first_passage(
    distance: np.ndarray, push: np.ndarray, parameters: Mapping[str, Any]
) -> np.ndarray:
    """Return the probability that the push of a pulse stays positive over a distance.

    The push is the integral of the pre-stress from where the left front stopped up to the pulse.
    The pulse dies when its push reaches 0. As the pulse advances, the push makes a random walk with
    correlated steps. Far from 0 this is like a Brownian motion with drift. Near 0 the correlation
    matters: the Brownian motion must end at a distance below 0, which is known exactly for
    exponential correlation (`MILNE`).

    distance : distances over which pulses go on
    push : push of each pulse at the beginning; the two arrays are broadcast against each other
    """
    variance_rate, drift = diffusivity(parameters), parameters["level"]
    # The Brownian motion starts at this height above the level at which it must end. MILNE is in
    # units of deviation * correlation_length, which is variance_rate/(2 deviation) for exponential
    # correlation.
    height = push + MILNE * variance_rate / (2.0 * parameters["deviation"])
    spread = np.sqrt(variance_rate * distance)
    # The method of images: a mirror image of the walk starts at -height, with this weight.
    image_weight = np.exp(-2.0 * drift * height / variance_rate)
    mean = height + drift * distance
    mean_of_image = -height + drift * distance
    return ndtr(mean / spread) - image_weight * ndtr(mean_of_image / spread)


def balance_position(x: np.ndarray, prestress_integral: np.ndarray) -> float:
    """Return the first position x > 0 up to which the integral of the pre-stress is 0.

    The integral starts at x_* < 0, where the left front stopped. This is where the integral from
    any origin is smallest. The position is infinite if the integral from x_* stays positive.

    x : positions in ascending order
    prestress_integral : integral of the pre-stress up to each position, from any origin
    """
    smallest = prestress_integral[x < 0.0].min()
    is_balanced = (x > 0.0) & (prestress_integral <= smallest)
    balanced = np.flatnonzero(is_balanced)
    return float(x[balanced[0]]) if balanced.size else math.inf
