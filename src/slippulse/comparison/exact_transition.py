"""The exact transition of a run, whichever its boundary."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from ..model.prestress import Prestress
from ..model.scene import prestress_from
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import ExactTransition, exact_transition_displacement


def exact_transition(attributes: Mapping, share: float) -> ExactTransition:
    """Exact T_trans and L_trans in the continuum limit.

    Parameters
    ----------
    attributes : of a run's Dataset, or a row of a measured table
    share : share of |x_minus| that the left front covers at T_trans under a stress boundary

    Raises
    ------
    ValueError
        Where theory has none.
    """
    gamma = float(attributes["gamma"]) if attributes["boundary"] == "displacement" else 0.0
    ratio = float(attributes["damping_ratio"])
    return _transition(prestress_from(attributes), gamma, ratio, str(attributes["release"]), share)


@lru_cache(maxsize=4096)
def _transition(
    prestress: Prestress, gamma: float, ratio: float, release: str, share: float
) -> ExactTransition:
    if gamma > 0.0:
        return exact_transition_displacement(prestress, gamma, ratio, release)
    crack = ArrestingCrack(prestress, ratio, release)
    return ExactTransition(crack.share_time(share), crack.share_length(share))
