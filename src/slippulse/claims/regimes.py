"""Claims about which ruptures are cracks and which are pulses, and about their stability."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from .evidence import Evidence
from .ledger import Claim


def regime_claims(evidence: Evidence) -> list[Claim]:
    """Symmetric and asymmetric pre-stress, growth and decay, the steady pulse at tau = 0, only positive velocities."""
    return [
        evidence.share(
            "symmetric_displacement_pulses",
            "section III, figure 2",
            "symmetric positive pre-stress and a displacement boundary: a crack turns into two pulses",
            "regimes_displacement",
            lambda t: (t["left"] > 0.0) & (t["duration"] > 1.5 * np.pi / np.sqrt(t["gamma"])),
            lambda t: t["regime"] == "pulses, two-way",
            "regimes_displacement: regime",
            "of those that last half again as long as the predicted transition",
        ),
        evidence.share(
            "symmetric_stress_cracks",
            "section III, figure 2",
            "symmetric positive pre-stress and a stress boundary: always a crack",
            "regimes_stress",
            lambda t: (t["left"] == t["right"]) & (t["left"] > 0.0),
            lambda t: t["regime"] == "crack-like, two-way",
            "regimes_stress: regime",
        ),
        evidence.share(
            "one_way_pulse_at_zero",
            "section III, figure 2",
            "negative pre-stress on the left and none on the right, stress boundary: one pulse",
            "regimes_stress",
            lambda t: (t["left"] <= -0.1) & (t["right"] == 0.0),
            lambda t: t["regime"] == "pulse, one-way, steady",
            "regimes_stress: regime",
        ),
        evidence.share(
            "steady_only_at_zero",
            "section III A",
            "under a stress boundary a pulse is steady only where the pre-stress is 0",
            "regimes_beyond",
            lambda t: t["beyond"] == t["beyond"],
            lambda t: (t["regime"] == "pulse, one-way, steady") == (t["beyond"] == 0.0),
            "regimes_beyond: regime",
            "a pulse formed at 0 and sent into another level",
        ),
        evidence.share(
            "grows_above_zero",
            "section III A",
            "a pulse grows where the pre-stress is positive",
            "regimes_beyond",
            lambda t: t["beyond"] > 0.0,
            lambda t: t["largest_velocity_change"] > 0.02,
            "regimes_beyond: largest_velocity_change",
            "the highest levels make it a crack again, which the paper also says can happen",
        ),
        evidence.share(
            "decays_below_zero",
            "section III A",
            "a pulse decays where the pre-stress is negative",
            "regimes_beyond",
            lambda t: t["beyond"] < 0.0,
            lambda t: (t["largest_velocity_change"] < -0.02) | (t["regime"] == "arrested"),
            "regimes_beyond: largest_velocity_change, regime",
        ),
        steady_peak(evidence),
        positive_velocities(evidence),
        no_reverse_sliding(evidence),
    ]


def steady_peak(evidence: Evidence) -> Claim:
    """The energy argument: where tau = 0 nothing drives the pulse and nothing is dissipated but by the damping."""
    points = evidence.points("regimes_beyond", "largest_velocity_change", lambda t: t["beyond"] == 0.0)
    # On a coarse lattice every such run may be flagged, which leaves nothing to judge by.
    value, uncertainty = float("nan"), float("nan")
    if points["value"].notna().any():
        worst = points["value"].abs().idxmax()
        value, uncertainty = float(points["value"][worst]), float(points["uncertainty"][worst])
    return evidence.number(
        "energy_argument",
        "sections III C and IV C 1",
        "where the pre-stress equals the kinetic friction the pulse neither gains nor loses energy",
        0.0,
        value,
        uncertainty,
        "regimes_beyond: largest_velocity_change",
        "change of the largest slip velocity over the last third of the run; the damping takes what is missing",
    )


def positive_velocities(evidence: Evidence) -> Claim:
    """The smallest velocity of every run of every simulation."""
    tables = [pd.DataFrame({"v": t["min_velocity"]}) for t in evidence.measured.values()]
    smallest = float(min(table["v"].min() for table in tables))
    runs = sum(len(table) for table in tables)
    coarse = float(min(t["min_velocity"].min() for many in evidence.coarser.values() for t in many))
    claim = evidence.number(
        "only_positive_velocities",
        "section II A",
        "only positive velocities appear",
        0.0,
        smallest,
        abs(smallest - coarse),
        "every simulation: min_velocity",
        "smallest slip velocity of all runs; rounding of the instant of sticking",
    )
    return replace(claim, runs=runs)


def no_reverse_sliding(evidence: Evidence) -> Claim:
    """The friction ratio that every run under a displacement boundary needs so that no block slides backwards."""
    lowest, runs = 0.0, 0
    coarse = []
    for name, table in evidence.measured.items():
        chosen = (table["boundary"] == "displacement") & (table["left"] > 0.0)
        lowest = max(lowest, float(table["friction_ratio_needed"][chosen].max()) if chosen.any() else 0.0)
        runs += int(chosen.sum())
        for other in evidence.coarser[name]:
            chosen = (other["boundary"] == "displacement") & (other["left"] > 0.0)
            coarse.append(float(other["friction_ratio_needed"][chosen].max()) if chosen.any() else 0.0)
    claim = evidence.number(
        "threshold_as_printed",
        "section II A",
        r"a block at rest is released when $\left|\text{stress}\right|$ reaches 1",
        0.0,
        lowest,
        max(abs(lowest - other) for other in coarse),
        "every simulation under a displacement boundary: min_stuck_stress",
        r"largest $\mu_k/(\mu_s-\mu_k)$ that the runs need so that nothing slides backwards; the printed threshold,"
        r" which is that of $\mu_k=0$, is passed at blocks beside the pulses",
    )
    return replace(claim, runs=runs)
