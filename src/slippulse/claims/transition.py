"""Claims about the transition from crack to pulse, and where a front ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pandas as pd

from ..comparison.exact_transition import exact_transition
from ..model.prestress import Prestress
from ..model.scene import prestress_from
from ..theory.arrest import ArrestingCrack
from . import rules
from .evidence import Evidence, compared
from .ledger import Claim

# Shares of |x_minus| at which a time that has no end is judged.
SHARES = (0.9, 0.95, 0.99)
# A front that ends within this of x_minus, in units of H, is within the smallest length of the model.
GAP = 1.0
NAN = float("nan")
LEVELS = {"scaling_displacement": ("left", "gamma"), "scaling_stress": ("left", "width")}


def transition_claims(evidence: Evidence, share: float) -> list[Claim]:
    """T_trans and L_trans under both boundary conditions, the position of arrest, and how they depend on what.

    Parameters
    ----------
    share : share of |x_minus| at which the sweeps were measured, where they stand beside the exact theory
    """
    times = share_times(evidence, share)
    return [
        *(displacement(evidence, *names) for names in (("T_trans", "time"), ("L_trans", "length"))),
        diverges(evidence), shorter_at_low_prestress(evidence), arrest_position(evidence),
        stress(evidence, times, share, "T_trans", "time"), stress(evidence, times, share, "L_trans", "length"),
        speeds_near_one(evidence, times), underestimate(evidence, times),
    ]  # fmt: skip


def displacement(evidence: Evidence, name: str, what: str) -> Claim:
    """An estimate under a displacement boundary, at the first stick."""
    sweep, quantity = "scaling_displacement", f"transition_{what}"
    claim = evidence.approximate(
        f"{name}_displacement", f"{sweep}: {quantity}", evidence.lattices(sweep), quantity, f"paper_{quantity}",
        LEVELS[sweep], "measured at the first stick, which is at the nucleation point",
    )  # fmt: skip
    points = evidence.points(sweep, quantity)
    exact = [getattr(exact_transition(row._asdict(), 1.0), what) for row in points.itertuples()]
    return compared(claim, points["extrapolated"], exact)


def share_times(evidence: Evidence, measured: float) -> pd.DataFrame:
    """Of each run of the sweep and each share the exact time and length, beside the paper's; NaN where there is none.

    Parameters
    ----------
    measured : share at which the sweep was measured, which is one of the rows too
    """
    rows = []
    for row in evidence.lattices("scaling_stress")[0].itertuples():
        distance, found = exact_times(prestress_from(row._asdict()), row.damping_ratio, row.release, measured)
        rows += [
            {
                "left": row.left, "width": row.width, "share": share, "distance": distance, "time": time,
                "length": length, "one": 1.0,
            }
            for share, (time, length) in found.items()
        ]  # fmt: skip
    table = pd.DataFrame(rows)
    return table.assign(
        twice=2.0 * table["distance"],
        left_speed=table["share"] * table["distance"] / table["time"],
        right_speed=(table["length"] - table["share"] * table["distance"]) / table["time"],
    )


@lru_cache(maxsize=1024)
def exact_times(
    prestress: Prestress, ratio: float, release: str, measured: float
) -> tuple[float, dict[float, tuple[float, float]]]:
    """|x_minus|, and by share the time at which the left front has covered it and the distance of the fronts then."""
    shares = (*SHARES, measured)
    try:
        crack = ArrestingCrack(prestress, ratio, release)
    except (ValueError, ArithmeticError):
        return NAN, dict.fromkeys(shares, (NAN, NAN))
    return -crack.balance_position, {
        share: (crack.share_time(share), crack.share_length(share)) for share in shares
    }


def last_releases(evidence: Evidence) -> list[pd.DataFrame]:
    """The same at the last release on the left, on the three lattices."""
    return [
        pd.DataFrame(
            {
                "left": table["left"], "width": table["width"], "distance": table["balance_distance"],
                "time": table["last_release_time"], "length": table["last_release_length"],
                "twice": 2.0 * table["balance_distance"], "one": 1.0, "factor": table.get("factor", np.nan),
                "left_speed": table["last_release_distance"] / table["last_release_time"],
                "right_speed": (table["last_release_length"] - table["last_release_distance"])
                / table["last_release_time"],
            }
        )
        for table in evidence.lattices("scaling_stress")
    ]  # fmt: skip


def by_share(evidence: Evidence, times: pd.DataFrame, judge: Callable[[list[pd.DataFrame]], Claim]) -> Claim:
    """A claim judged at each share by the exact solution and at the last release by the lattices, as `rules.at_shares`.

    Its numbers are those of the middle share; the verdict at each says why.
    """
    claims = {share: judge([times[times["share"] == share].reset_index(drop=True)]) for share in SHARES}
    last = judge(last_releases(evidence))
    verdict = rules.at_shares([claim.verdict for claim in claims.values()], last.verdict)
    each = {f"at {100.0 * share:g} %": claim for share, claim in claims.items()} | {
        "at the last release": last
    }
    said = ", ".join(f"{place} {claim.verdict}" for place, claim in each.items())
    shown = claims[SHARES[1]]
    further = {f"median ratio {place}": claim.measured for place, claim in each.items()}
    why = "" if verdict == "reproduced" else f"It depends on where the transition is taken to end: {said}."
    return replace(shown, verdict=verdict, further=further, why=why)


def stress(evidence: Evidence, times: pd.DataFrame, share: float, name: str, what: str) -> Claim:
    """An estimate under a stress boundary, at each share and at the last release."""
    sweep, predicted = "scaling_stress", {"time": "distance", "length": "twice"}[what]

    def judge(tables: list[pd.DataFrame]) -> Claim:
        return evidence.approximate(
            f"{name}_stress", "theory.ArrestingCrack; scaling_stress: last_release_time, last_release_length",
            tables, what, predicted, LEVELS[sweep],
            r"by the exact solution when the left front has covered the middle share of $\left|x_-\right|$",
        )  # fmt: skip

    claim = by_share(evidence, times, judge)
    exact = times[times["share"] == share]
    return compared(claim, evidence.points(sweep, f"transition_{what}")["extrapolated"], exact[what])


def speeds_near_one(evidence: Evidence, times: pd.DataFrame) -> Claim:
    """Mean speeds of both fronts; the front that is farther off counts."""

    def judge(tables: list[pd.DataFrame]) -> Claim:
        fronts = [
            evidence.approximate(
                "stress_front_speeds_near_one", "theory.ArrestingCrack; scaling_stress: last releases", tables,
                f"{side}_speed", "one", note=f"mean speed of the {side} front, which is the farther off",
            )
            for side in ("left", "right")
        ]  # fmt: skip
        return max(fronts, key=lambda claim: claim.deviation)

    return by_share(evidence, times, judge)


def underestimate(evidence: Evidence, times: pd.DataFrame) -> Claim:
    """T_trans is longer than |x_minus|, in every run."""

    def judge(tables: list[pd.DataFrame]) -> Claim:
        longer = [(table["time"] > table["distance"]).to_numpy() for table in tables[:2]]
        decided = [bool(a) if a == b else None for a, b in zip(longer[0], longer[-1], strict=True)]
        claim = evidence.qualitative(
            "T_trans_stress_underestimate", "theory.ArrestingCrack; scaling_stress: last_release_time", decided,
            r"runs with $T_\mathrm{trans}>\left|x_-\right|$",
        )  # fmt: skip
        return replace(claim, further={"median": float(np.median(tables[0]["time"] / tables[0]["distance"]))})

    found = by_share(evidence, times, judge)
    shares = [*(times[times["share"] == share] for share in SHARES), last_releases(evidence)[0]]
    places = [*(f"at {100.0 * share:g} %" for share in SHARES), "at the last release"]
    medians = {
        f"median factor {place}": float((table["time"] / table["distance"]).median())
        for place, table in zip(places, shares, strict=True)
    }
    return replace(found, further=medians)


def arrest_position(evidence: Evidence) -> Claim:
    """The last release on the left over |x_minus|, for every profile and damping; and the gap in units of H."""
    id, sweeps = (
        "front_arrest_position",
        ("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles"),
    )
    tables = evidence.lattices(*sweeps)
    claim = evidence.approximate(
        id, f"{', '.join(sweeps)}: last_release_distance", tables, "last_release_distance", "balance_distance",
        ("left", "width"), r"last release on the left over $\left|x_-\right|$",
    )  # fmt: skip

    def gaps(table: pd.DataFrame) -> pd.Series:
        return table["balance_distance"] - table["last_release_distance"]

    gap = evidence.studied(tables, lambda table: float(gaps(table).abs().median()))
    further = {
        "median gap in H": gap.value,
        "smallest ratio": float((tables[0]["last_release_distance"] / tables[0]["balance_distance"]).min()),
        "largest ratio": float((tables[0]["last_release_distance"] / tables[0]["balance_distance"]).max()),
    }
    return replace(
        claim,
        further=further,
        verdict=rules.worst([claim.verdict, rules.within(gap.value, gap.uncertainty, GAP)]),
    )


def diverges(evidence: Evidence) -> Claim:
    """T_trans and L_trans grow at every step down in gamma, with exponents below zero."""

    def grows_without_bound(rows: pd.DataFrame) -> bool | None:
        rows = rows.sort_values("gamma")
        if len(rows) < 3:
            return None
        smallest = rows.head(3)
        for quantity in ("transition_time", "transition_length"):
            if not (np.diff(rows[quantity]) < 0.0).all():
                return False
            slope, error = line_with_error(np.log(smallest["gamma"]), np.log(smallest[quantity]))
            if not slope + 3.0 * error < 0.0:
                return False
        return True

    finest, middle, *_ = (
        [grows_without_bound(rows) for _, rows in table.groupby("left")]
        for table in evidence.lattices("scaling_displacement")
    )
    claim = evidence.qualitative(
        "transition_diverges", "scaling_displacement: transition_time, transition_length",
        [one if one == other else None for one, other in zip(finest, middle, strict=True)],
        r"levels $\tau_0$ at which both grow at every step down in $\gamma$, at the smallest as powers below zero",
    )  # fmt: skip
    table = evidence.lattices("scaling_displacement")[0]
    smallest = table[table["gamma"].isin(np.sort(table["gamma"].unique())[:3])]
    exponents = {
        rf"mean exponent of $\gamma$ in ${name}_\mathrm{{trans}}$": float(
            np.mean(
                [
                    line_with_error(np.log(rows["gamma"]), np.log(rows[f"transition_{what}"]))[0]
                    for _, rows in smallest.groupby("left")
                ]
            )
        )
        for name, what in (("T", "time"), ("L", "length"))
    }
    return replace(claim, further=exponents)


def line_with_error(x: pd.Series, y: pd.Series) -> tuple[float, float]:
    """Slope of a straight line and its standard error."""
    centred = x - x.mean()
    scatter = float((centred**2).sum())
    if scatter == 0.0:
        return NAN, NAN
    slope = float((centred * (y - y.mean())).sum()) / scatter
    rest = y - y.mean() - slope * centred
    return slope, float(np.sqrt((rest**2).sum() / max(len(x) - 2, 1) / scatter))


def shorter_at_low_prestress(evidence: Evidence) -> Claim:
    """Each step down in the pre-stress shortens L_trans."""
    points = evidence.points("scaling_displacement", "transition_length")
    decided = []
    for _, rows in points.groupby("gamma"):
        rows = rows.sort_values("left")
        change = np.diff(rows["value"])
        blur = rows["uncertainty"].to_numpy()[1:] + rows["uncertainty"].to_numpy()[:-1]
        decided += [bool(c > 0.0) if abs(c) > b else None for c, b in zip(change, blur, strict=True)]
    return evidence.qualitative(
        "shorter_transition_low_prestress", "scaling_displacement: transition_length", decided,
        r"steps down in $\tau_0$, at each $\gamma$",
    )  # fmt: skip
