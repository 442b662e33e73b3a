"""Statistics of pulses that die, or are still alive at the end of their run."""

import math
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.stats import CensoredData, beta, chi2, ecdf

# Two-sided confidence of all bands and intervals, and the probability beyond each of their ends.
CONFIDENCE = 0.95
TAIL = 0.5 * (1.0 - CONFIDENCE)


class Fate(NamedTuple):
    """Distance that one pulse has gone, and whether it has died there."""

    distance: float
    died: bool


def survival(fates: Sequence[Fate]) -> pd.DataFrame:
    """Kaplan-Meier estimate: fraction of pulses that live beyond a distance, with its band."""
    dead = [one.distance for one in fates if one.died]
    alive = [one.distance for one in fates if not one.died]
    estimate = ecdf(CensoredData(uncensored=dead, right=alive)).sf
    columns = {"distance": np.concatenate([[0.0], estimate.quantiles])}
    columns["survival"] = np.concatenate([[1.0], estimate.probabilities])
    with np.errstate(all="ignore"), warnings.catch_warnings():
        # The formula of the band has no value before the first death.
        warnings.simplefilter("ignore", RuntimeWarning)
        band = estimate.confidence_interval(CONFIDENCE, method="log-log")
    for name, end in (("low", band.low), ("high", band.high)):
        columns[name] = np.concatenate([[1.0], end.probabilities])
    return pd.DataFrame(columns).ffill()


def death_rate(fates: Sequence[Fate], start: float) -> dict[str, float]:
    """Deaths beyond a start over the distance gone there by all pulses, with its interval."""
    beyond = [one for one in fates if one.distance > start]
    deaths, distance = sum(one.died for one in beyond), sum(one.distance - start for one in beyond)
    low, high = poisson_interval(deaths)
    return {
        "pulses": len(fates),
        "deaths": deaths,
        "distance": distance,
        "rate": deaths / distance,
        "rate_low": low / distance,
        "rate_high": high / distance,
        "confidence": CONFIDENCE,
    }


def survival_exponent(fates: Sequence[Fate], start: float) -> dict[str, float]:
    """Exponent of a power law of survival beyond a start, by maximum likelihood; NaN of no death.

    The pulses that are alive at the end are censored.
    """
    beyond = [one for one in fates if one.distance > start]
    deaths = sum(one.died for one in beyond)
    logs = sum(math.log(one.distance / start) for one in beyond) if deaths else math.nan
    low, high = poisson_interval(deaths)
    ends = {"exponent_low": low / logs, "exponent_high": high / logs}
    return {"exponent": deaths / logs, "exponent_deaths": deaths, "exponent_start": start} | ends


def poisson_interval(count: int) -> tuple[float, float]:
    """Exact interval of the mean of a Poisson distribution of which ``count`` was drawn."""
    low = 0.5 * chi2.ppf(TAIL, 2 * count) if count else 0.0
    return float(low), float(0.5 * chi2.ppf(1.0 - TAIL, 2 * count + 2))


def fraction_interval(count: int, total: int) -> tuple[float, float]:
    """Exact interval (Clopper and Pearson) of a fraction; 0 to 1 without any."""
    low = beta.ppf(TAIL, count, total - count + 1) if count else 0.0
    high = beta.ppf(1.0 - TAIL, count + 1, total - count) if count < total else 1.0
    return float(low), float(high)
