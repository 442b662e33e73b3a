"""Theory of pulses on a rough pre-stress: death rate, random walk, and the balance at death."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.special import gamma as gamma_function
from scipy.special import ndtr

from slippulse.theory.barrier import barrier_depth

# Barriers of the predicted death rate, in units of the level before them.
BARRIERS = np.geomspace(0.03, 10.0, 12)
# -zeta(1/2): how far behind 0 a walk is absorbed whose steps are an Ornstein-Uhlenbeck process, in
# units of their deviation times their correlation length (Doering, Hagan and Levermore 1987).
MILNE = 1.4603545088095868
# Correlation lengths that the sums over a spectrum cover.
PERIODS = 400


def spectrum(keys: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Wave numbers of the field of an ensemble, and the variance that each contributes."""
    length = PERIODS * keys["correlation_length"]
    wave_number = 2.0 * np.pi * np.fft.fftfreq(round(length / keys["spacing"]), keys["spacing"])
    power = (1.0 + (wave_number * keys["correlation_length"]) ** 2) ** -(keys["hurst"] + 0.5)
    return wave_number, keys["deviation"] ** 2 * power / np.sum(power)


def barrier_rate(keys: Mapping[str, Any]) -> dict[str, float]:
    """Rate of barriers that are deeper than the exact critical depth, by Rice's formula.

    A barrier of level -r tau_0 stops a steady pulse of level tau_0 if it is longer than the
    critical depth d. The mean of the pre-stress over a length d is a Gaussian field. Rice's formula
    gives the rate at which it falls below -r tau_0; the r with the largest rate is taken.
    """
    level = keys["level"]
    wave_number, power = spectrum(keys)
    best = {"barrier_rate": 0.0, "barrier": math.nan, "depth": math.nan}
    for barrier in level * BARRIERS:
        depth = barrier_depth(level, -barrier, keys["gamma"], keys["damping_ratio"])
        averaged = power * np.sinc(wave_number * depth / (2.0 * np.pi)) ** 2
        variance, slope = np.sum(averaged), np.sum(averaged * wave_number**2)
        rate = math.exp(-((level + barrier) ** 2) / (2.0 * variance))
        rate *= math.sqrt(slope / variance) / (2.0 * np.pi)
        if rate > best["barrier_rate"]:
            best = {"barrier_rate": rate, "barrier": -barrier, "depth": depth}
    return best


def diffusivity(keys: Mapping[str, Any]) -> float:
    """Variance of the integral of a field over a long distance, divided by that distance."""
    hurst = keys["hurst"]
    scale = 2.0 * math.sqrt(math.pi) * gamma_function(hurst + 0.5) / gamma_function(hurst)
    return float(scale * keys["correlation_length"] * keys["deviation"] ** 2)


def first_passage(distance: np.ndarray, push: np.ndarray, keys: Mapping[str, Any]) -> np.ndarray:
    """Probability that the push of a pulse has not come to 0 over a distance.

    The push is a random walk whose steps are correlated. Far from 0 it is Brownian motion, which is
    absorbed behind 0, at a distance that is exact for exponential correlation (`MILNE`).
    """
    rate, drift = diffusivity(keys), keys["level"]
    start = push + MILNE * rate / (2.0 * keys["deviation"])
    spread = np.sqrt(rate * distance)
    returned = np.exp(-2.0 * drift * start / rate)
    ahead, behind = start + drift * distance, start - drift * distance
    return ndtr(ahead / spread) - returned * ndtr(-behind / spread)


def balance_position(x: np.ndarray, total: np.ndarray) -> float:
    """Position on the right at which the integral of the pre-stress from x_* is back to 0.

    ``total`` is the integral up to each x, and x_* < 0 where it is smallest. Infinite if the
    integral stays positive.
    """
    lost = np.flatnonzero((x > 0.0) & (total <= total[x < 0.0].min()))
    return float(x[lost[0]]) if lost.size else math.inf
