"""Survival statistics of pulses, some of which die and some of which outlive their simulation.

A pulse that is alive at the end of its run would have gone farther than its recorded distance.
Statisticians call such an observation censored. The estimates use its distance, but count no death.
"""

import math
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.stats import CensoredData, beta, chi2, ecdf

# Confidence level of all bands and intervals, and the probability beyond each of their two ends.
CONFIDENCE = 0.95
PROBABILITY_BEYOND_END = 0.5 * (1.0 - CONFIDENCE)


class Fate(NamedTuple):
    """The distance that one pulse has gone, and whether it died there."""

    distance: float
    died: bool


def survival(fates: Sequence[Fate]) -> pd.DataFrame:
    """Return the Kaplan-Meier estimate of the fraction of pulses that live beyond a distance.

    There is one row for the distance 0 and one for each distance at which a pulse died or was last
    seen. The columns are the distance, the fraction (survival), and the ends of its confidence band
    (low and high).
    """
    deaths = [fate.distance for fate in fates if fate.died]
    last_seen_alive = [fate.distance for fate in fates if not fate.died]
    estimate = ecdf(CensoredData(uncensored=deaths, right=last_seen_alive)).sf
    with np.errstate(all="ignore"), warnings.catch_warnings():
        # The formula of the band has no value before the first death.
        warnings.simplefilter("ignore", RuntimeWarning)
        band = estimate.confidence_interval(CONFIDENCE, method="log-log")
    fractions = {
        "survival": estimate.probabilities,
        "low": band.low.probabilities,
        "high": band.high.probabilities,
    }
    # At distance 0 all pulses are alive.
    columns = {"distance": np.concatenate([[0.0], estimate.quantiles])}
    for name, values in fractions.items():
        columns[name] = np.concatenate([[1.0], values])
    # Where the band has no value, the previous one still holds. But if no pulse is alive, the band
    # begins at 0.
    curve = pd.DataFrame(columns).ffill()
    return curve.assign(low=curve["low"].where(curve["survival"] > 0.0, 0.0))


def death_rate(fates: Sequence[Fate], start: float) -> dict[str, float]:
    """Return the number of deaths divided by the distance that all pulses have gone in total.

    Only deaths and distances beyond ``start`` count. The result also has the confidence interval.
    The rate and the interval are NaN if no pulse passed ``start``.
    """
    passed = [fate for fate in fates if fate.distance > start]
    deaths = sum(fate.died for fate in passed)
    total_distance = sum(fate.distance - start for fate in passed)
    divisor = total_distance if passed else math.nan
    low, high = poisson_interval(deaths)
    return {
        "pulses": len(fates),
        "deaths": deaths,
        "distance": total_distance,
        "rate": deaths / divisor,
        "rate_low": low / divisor,
        "rate_high": high / divisor,
        "confidence": CONFIDENCE,
    }


def survival_exponent(fates: Sequence[Fate], start: float) -> dict[str, float]:
    """Return the exponent a of a survival fraction that falls as distance^-a beyond ``start``.

    The estimate of maximum likelihood is the number of deaths beyond ``start``, divided by the sum
    of log(distance/start) over all pulses that passed ``start``. The result also has its confidence
    interval. The exponent and the interval are NaN if no pulse died beyond ``start``.
    """
    passed = [fate for fate in fates if fate.distance > start]
    deaths = sum(fate.died for fate in passed)
    sum_of_logs = math.nan
    if deaths:
        sum_of_logs = sum(math.log(fate.distance / start) for fate in passed)
    low, high = poisson_interval(deaths)
    return {
        "exponent": deaths / sum_of_logs,
        "exponent_deaths": deaths,
        "exponent_start": start,
        "exponent_low": low / sum_of_logs,
        "exponent_high": high / sum_of_logs,
    }


def poisson_interval(count: int) -> tuple[float, float]:
    """Return the exact confidence interval of a Poisson mean, if ``count`` events were observed.

    The level is CONFIDENCE. The formula with quantiles of chi-square is Garwood's (1936).
    """
    low = 0.0
    if count > 0:
        low = 0.5 * chi2.ppf(PROBABILITY_BEYOND_END, 2 * count)
    high = 0.5 * chi2.ppf(1.0 - PROBABILITY_BEYOND_END, 2 * count + 2)
    return float(low), float(high)


def fraction_interval(count: int, total: int) -> tuple[float, float]:
    """Return the exact (Clopper-Pearson) confidence interval of the fraction count/total.

    The interval is 0 to 1 if ``total`` is 0.
    """
    low, high = 0.0, 1.0
    if count > 0:
        low = beta.ppf(PROBABILITY_BEYOND_END, count, total - count + 1)
    if count < total:
        high = beta.ppf(1.0 - PROBABILITY_BEYOND_END, count + 1, total - count)
    return float(low), float(high)
