"""Claims about steady pulses: their equations, whether they are unique and stable, under either boundary condition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
import pandas as pd

from . import rules
from .evidence import Claim, Evidence, Where, agreeing

# What a steady pulse of given pre-stress and elasticity ratio is compared by.
SIZES = ("pulse_peak_velocity", "pulse_width", "pulse_slip")
# Levels beyond the step that count as a small perturbation, in units of the friction drop.
SMALL = 0.03
CHANGE = "largest_velocity_change"


def every(table: pd.DataFrame) -> pd.Series:
    return pd.Series(True, table.index)


def undamped(table: pd.DataFrame) -> pd.Series:
    return table["damping_ratio"] == 0.0


class Equation(NamedTuple):
    """A measured column, what the paper has for it (a column or a function of the table), and in which runs."""

    quantity: str
    paper: str | Callable[[pd.DataFrame], pd.Series]
    runs: dict[str, Where]


def zero(table: pd.DataFrame) -> pd.Series:
    return pd.Series(0.0, table.index)


STEADY: dict[str, Where] = {"steady_displacement": undamped}
EQUATIONS = {
    # Without leaf springs, and at the smallest gamma with them.
    "front_speed": Equation(
        "front_speed_right",
        "paper_front_speed_right",
        {"front_speed_undamped": every, "speed_against_gamma": lambda t: t["gamma"] == t["gamma"].min()},
    ),
    "pulse_profile": Equation("pulse_shape_deviation", zero, STEADY),
    **{id: Equation(id, f"paper_{id}", STEADY) for id in (*SIZES, "pulse_acceleration")},
    "stress_drop": Equation("pulse_stress_drop", lambda t: 2.0 * t["left"], STEADY),
    "energy_balance_at_zero": Equation("energy_change", zero, {"stress_pulses": undamped}),
}
# What the exact rupture decides where lattices cannot.
EXACTLY = ("pulse_width", "pulse_acceleration")


def pulse_claims(evidence: Evidence) -> list[Claim]:
    """Every claim of this module."""
    found = [equation(evidence, id) for id in EQUATIONS] + [signed(evidence, id) for id in SIGNED]
    others = (
        moderate_speed, steady_for_any_prestress, unique, settle, damping_reduces_oscillations,
        wave_equation, zero_net_stress_change, steady_only_at_zero, not_unique, set_by_prestress,
    )  # fmt: skip
    return [*found, *(judge(evidence) for judge in others)]


def equation(evidence: Evidence, id: str) -> Claim:
    """One equation; by the exact solution of a whole rupture where the lattices are too coarse."""
    quantity, paper, runs = EQUATIONS[id]
    points = pd.concat([evidence.points(name, quantity, where) for name, where in runs.items()])
    predicted = points[paper] if isinstance(paper, str) else paper(points)
    claim = evidence.exact(id, points, predicted)
    if claim.verdict != "inconclusive" or id not in EXACTLY:
        return claim
    study = exact_pulses(evidence, next(iter(runs)), quantity).reindex(points.index)
    exact = pd.DataFrame({"extrapolated": predicted + study["difference"], "uncertainty": study["change"]})
    entry = evidence.entries[id]
    return replace(
        evidence.exact(id, exact, predicted),
        note=f"{entry['note']}; by the exact solution of the whole rupture, since the lattices leave it open",
        source=f"studies.exact_pulses; {entry['source']}",
        further={"deviation on the lattices": claim.deviation, "its uncertainty": claim.uncertainty / claim.predicted},
    )  # fmt: skip


def exact_pulses(evidence: Evidence, simulation: str, quantity: str) -> pd.DataFrame:
    """Of the study of that name, by run."""
    study = evidence.tables["exact_pulses"]
    return study[(study["simulation"] == simulation) & (study["quantity"] == quantity)].set_index("run")


def moderate_speed(evidence: Evidence) -> Claim:
    """The front speed without damping for gamma up to 1."""
    tables = [
        table[undamped(table) & table["gamma"].between(0.1, 1.0)]
        for table in evidence.lattices("speed_against_gamma", "steady_displacement")
    ]
    return evidence.approximate(
        "front_speed_moderate_gamma", tables, "front_speed_right", "paper_front_speed_right"
    )


# With the displacement held


def steady_for_any_prestress(evidence: Evidence) -> Claim:
    """Two pulses whose slip does not vary, at every level."""
    id = "steady_for_any_prestress"
    decided = evidence.agreed(
        "any_prestress",
        lambda t: t["left"].between(0.0, 1.0, inclusive="neither"),
        lambda t: (t["slip_variation"] < evidence.tolerance(id)) & (t["regime"] == "pulses, two-way"),
    )
    return evidence.qualitative(id, decided)


Pairs = list[tuple[pd.Series, pd.Series]]


def unique(evidence: Evidence) -> Claim:
    """Pulses of one pre-stress from different beginnings are the same pulse."""
    id, sweeps = "displacement_pulse_unique", ("nucleation_widths", "any_prestress", "pulses_across_a_step")
    studies = [
        pd.concat([evidence.points(name, size) for name in sweeps], ignore_index=True) for size in SIZES
    ]
    groups = studies[0].groupby(["beyond", "gamma", "damping_ratio"]).groups.values()
    found = [
        apart([(study.loc[i], study.loc[j]) for study in studies], evidence.tolerance(id), sure=False)
        for rows in groups
        for i, j in combinations(rows, 2)
    ]
    return evidence.qualitative(id, [None if different is None else not different for different in found])


def apart(pairs: Pairs, allowed: float, sure: bool) -> bool | None:
    """Whether any pair of values differs by more than a tolerance; None where their uncertainty leaves that open.

    Parameters
    ----------
    sure : whether it takes the uncertainty too to say that none does
    """
    found = []
    for one, other in pairs:
        blur = (one["uncertainty"] + other["uncertainty"]) / abs(other["value"])
        found.append((abs(one["value"] / other["value"] - 1.0), blur))
    if any(difference - blur > allowed for difference, blur in found):
        return True
    return False if all(difference + sure * blur <= allowed for difference, blur in found) else None


def settle(evidence: Evidence) -> Claim:
    """A pulse sent into another pre-stress leaves the slip of that pre-stress's own steady pulse."""
    id, keys = "perturbed_pulses_settle", ["left", "gamma", "damping_ratio"]
    offs = []
    for table, own in zip(
        evidence.lattices("pulses_across_a_step", "pulses_across_wide_steps"),
        evidence.lattices("any_prestress", "steady_displacement"),
        strict=True,
    ):
        slips = own.drop_duplicates(keys).set_index(keys)["pulse_slip"]
        rows = zip(table["beyond"], table["gamma"], table["damping_ratio"], strict=True)
        new = np.array([slips.get(row, np.nan) for row in rows])
        offs.append(np.abs(table["pulse_slip"].to_numpy(float) / new - 1.0))
    claim = evidence.qualitative(id, agreeing(*(off <= evidence.tolerance(id) for off in offs[:2])))
    return replace(claim, further={"slip off by at most": float(np.nanmax(offs[0], initial=0.0))})


def damping_reduces_oscillations(evidence: Evidence) -> Claim:
    """Damping takes power from the waves of the lattice."""

    def falls(table: pd.DataFrame) -> list[bool]:
        by_level = [
            rows.sort_values("damping_ratio")["lattice_noise"] for _, rows in table.groupby(["left", "gamma"])
        ]
        return [bool(after < before) for noise in by_level for before, after in combinations(noise, 2)]

    finest, middle, *_ = evidence.lattices("steady_displacement")
    decided = agreeing(falls(finest), falls(middle))
    claim = evidence.qualitative("damping_reduces_oscillations", decided, condition=True)
    return replace(claim, why="It needs the sign opposite to the printed one." if all(decided) else "")


# With the stress held


def wave_equation(evidence: Evidence) -> Claim:
    """The exact pulse keeps its profile and runs at the wave speed; the undamped lattice rings, and has no profile."""
    runs = evidence.lattices("stress_pulses")[0]
    study = exact_pulses(evidence, "stress_pulses", "profile_change")
    study = study.rename(columns={"difference": "extrapolated", "change": "uncertainty"})
    study = study[np.isin(study.index, evidence.points("stress_pulses", "profile_change", undamped).index)]
    most = runs[runs["damping_ratio"] == runs["damping_ratio"].max()]
    return replace(
        evidence.exact("wave_equation_at_zero", study, zero(study)),
        further={"on the finest lattice, most damped": float(most["profile_change"].max())},
    )


def zero_net_stress_change(evidence: Evidence) -> Claim:
    """No strain is left behind a pulse that keeps its shape; where some is left, the pulse changes."""
    id = "zero_net_stress_change"
    points = evidence.points("stress_pulses", "strain_left", undamped)
    claim = evidence.exact(id, points, zero(points))
    decided = evidence.agreed(
        "regimes_beyond",
        lambda t: (t["beyond"] != 0.0) & (t["strain_left"] > evidence.tolerance(id)),
        lambda t: changes(t) != 0,
    )
    change = evidence.qualitative(id, decided)
    verdict = rules.worst([claim.verdict, change.verdict])
    return replace(claim, verdict=verdict, numbers={**change.numbers, **claim.numbers})


def changes(table: pd.DataFrame) -> pd.Series:
    """Of each run that meets another level: 1 if its pulse grows, -1 if it decays, by more than at level 0; else 0."""
    at_rest = table[table["beyond"] == 0.0].set_index("left")[CHANGE].abs()
    grown = table[CHANGE].abs() > table["left"].map(at_rest)
    signs = np.sign(table[CHANGE]).where(grown, 0.0)
    return signs.where(table["regime"] != "arrested", -1.0).astype(int)


SIGNED: dict[str, tuple[Where, Callable]] = {
    "grows_above_zero": (lambda t: t["beyond"] > 0.0, lambda t: 1),
    "decays_below_zero": (lambda t: t["beyond"] < 0.0, lambda t: -1),
    "small_perturbation_changes_pulse": (
        lambda t: (t["beyond"] != 0.0) & (t["beyond"].abs() <= SMALL),
        lambda t: np.sign(t["beyond"]),
    ),
}


def signed(evidence: Evidence, id: str) -> Claim:
    """Whether pulses change by the sign that each should have, beyond the uncertainty of that."""
    where, sign = SIGNED[id]
    points = evidence.points("regimes_beyond", CHANGE, where)
    sure = points["value"].abs() > points["uncertainty"]
    decided = evidence.agreed("regimes_beyond", where, lambda t: changes(t) == sign(t))
    claim = evidence.qualitative(
        id, [found if known else None for found, known in zip(decided, sure, strict=True)]
    )
    if id != "small_perturbation_changes_pulse":
        return claim
    levels = evidence.tables["regimes_beyond"]["beyond"].abs()
    return replace(claim, further={"smallest level": float(levels[levels > 0.0].min())})


def steady_only_at_zero(evidence: Evidence) -> Claim:
    """At 0 it keeps its size, elsewhere it does not."""

    def holds(table: pd.DataFrame) -> pd.Series:
        kept = table[CHANGE].abs() <= evidence.steady
        return kept.where(table["beyond"] == 0.0, changes(table) != 0)

    return evidence.qualitative("steady_only_at_zero", evidence.agreed("regimes_beyond", every, holds))


def not_unique(evidence: Evidence) -> Claim:
    """Different pre-stress makes different pulses in the same region of zero pre-stress."""
    id = "stress_pulse_not_unique"
    studies = [evidence.points("stress_pulses", name) for name in ("pulse_peak_velocity", "pulse_half_width")]
    # At the damping of the figures; without any, the lattice rings.
    ratio = studies[0].loc[studies[0]["damping_ratio"] > 0.0, "damping_ratio"].min()
    studies = [study[study["damping_ratio"] == ratio] for study in studies]
    decided = [
        apart([(study.loc[i], study.loc[j]) for study in studies], evidence.tolerance(id), sure=True)
        for i, j in combinations(studies[0].index, 2)
    ]
    return evidence.qualitative(id, decided)


def set_by_prestress(evidence: Evidence) -> Claim:
    """Peak and half-width of the exact pulse are functionals of the pre-stress alone, the same at every damping."""
    id, keys = "stress_pulse_set_by_prestress", ["left", "width", "steps_and_bumps"]
    sizes = {
        "peak": ("exact_largest_velocity", "pulse_peak_velocity"),
        "half-width": ("exact_half_width", "pulse_half_width"),
    }
    predicted = evidence.tables["stress_pulses"]
    table = evidence.lattices("stress_pulses")[0]
    holds, further = every(table), {}
    for name, (exact, measured) in sizes.items():
        alone = predicted[undamped(predicted)].drop_duplicates(keys).set_index(keys)[exact].rename("alone")
        off = (table[exact] / table.join(alone, on=keys)["alone"] - 1.0).abs()
        lattice = (table[measured] / table[exact] - 1.0).abs()[~undamped(table)]
        holds &= off <= evidence.tolerance(id)
        further[f"{name} changes with damping by at most"] = float(off.max())
        further[f"{name} on the lattice, with damping, off by at most"] = float(lattice.max())
    return replace(evidence.qualitative(id, holds), further=further)
