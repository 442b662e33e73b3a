"""Claims about the pulse under a stress boundary: steady at zero pre-stress only, many shapes."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pandas as pd

from ..measure.shape import FAR
from ..model.roots import root_between
from ..model.scene import prestress_from
from ..theory.arrest import ArrestingCrack
from ..theory.rupture import Rupture
from . import rules
from .evidence import Evidence
from .ledger import Claim

SOURCE = "stress_pulses"
CHANGES = "regimes_beyond: largest_velocity_change"
# Levels beyond the step that count as a small perturbation, in units of the friction drop.
SMALL = 0.03
# Points at which a profile is compared with itself.
POINTS = 41


def stress_pulse_claims(evidence: Evidence) -> list[Claim]:
    """The wave equation, energy and stress at tau = 0, growth and decay elsewhere, and what sets the pulse."""
    return [
        wave_equation(evidence), energy_balance(evidence),
        zero_net_stress_change(evidence),
        grows(evidence), decays(evidence), small_perturbation(evidence), steady_only_at_zero(evidence),
        not_unique(evidence), set_by_prestress(evidence),
    ]  # fmt: skip


def undamped(evidence: Evidence, quantity: str) -> pd.DataFrame:
    """Runs without damping."""
    points = evidence.points(SOURCE, quantity)
    return points[points["damping_ratio"] == 0.0]


def energy_balance(evidence: Evidence) -> Claim:
    """The pulse neither gains nor loses energy."""
    points = undamped(evidence, "energy_change")
    return evidence.exact(
        "energy_balance_at_zero", f"{SOURCE}: energy_change", points, np.zeros(len(points)),
        "relative change of kinetic plus strain energy over the last third of the run",
    )  # fmt: skip


def wave_equation(evidence: Evidence) -> Claim:
    """The exact pulse keeps its profile and runs at the wave speed; the undamped lattice rings, and has no profile."""
    runs = undamped(evidence, "profile_change")
    changes = pd.DataFrame(
        [profile_change(row) for row in runs.itertuples()], columns=["extrapolated", "uncertainty"]
    )
    claim = evidence.exact(
        "wave_equation_at_zero", f"theory.Rupture; {SOURCE}: profile_change", changes, np.zeros(len(changes)),
        "largest change of the exact velocity profile, moved at the wave speed, over the last third of the run; on the"
        " undamped lattice the pulse rings, so that its profile has no limit",
    )  # fmt: skip
    damped = evidence.lattices(SOURCE)[0]
    most = damped[damped["damping_ratio"] == damped["damping_ratio"].max()]
    return replace(claim, further={"on the finest lattice, most damped": float(most["profile_change"].max())})


def profile_change(row) -> tuple[float, float]:
    """The same of the exact solution, and what it changes when its panels are cut in two."""
    found = []
    for refinement in (1, 2):
        rupture = Rupture(prestress_from(row._asdict()), 0.0, 0.0, row.release, row.duration, refinement)
        moved = row.duration / 3.0
        x = np.linspace(FAR * row.width, row.duration - moved, POINTS)
        early = rupture.slip_velocity(x, row.duration - moved)
        late = rupture.slip_velocity(x + moved, row.duration)
        # Near nucleation the construction may not reach the later time.
        found.append(float(np.nanmax(np.abs(late - early)) / np.nanmax(early)))
    return found[0], abs(found[0] - found[1])


def zero_net_stress_change(evidence: Evidence) -> Claim:
    """No strain is left behind a pulse that keeps its shape; where some is left, the pulse changes."""
    id = "zero_net_stress_change"
    points = undamped(evidence, "strain_left")
    claim = evidence.exact(
        id, f"{SOURCE}, regimes_beyond: strain_left", points, np.zeros(len(points)),
        "strain left behind the pulse, which is the stress change over what it swept, over its largest strain; and of"
        " the pulses that leave more than the tolerance, where the pre-stress is not 0, those that grow or decay",
    )  # fmt: skip
    allowed = evidence.tolerance(id)
    finest, middle, *_ = evidence.lattices("regimes_beyond")
    leaves = (finest["beyond"] != 0.0) & (finest["strain_left"] > allowed)
    changing = [
        bool(a) if a == b else None for a, b in zip(changes(finest) != 0, changes(middle) != 0, strict=True)
    ]
    decided = [found for found, chosen in zip(changing, leaves, strict=True) if chosen]
    held, failed = (sum(found is want for found in decided) for want in (True, False))
    undecided = len(decided) - held - failed
    return replace(
        claim, held=held, failed=failed, undecided=undecided,
        verdict=rules.worst([claim.verdict, rules.qualitative(held, failed, undecided)]),
    )  # fmt: skip


def changes(table: pd.DataFrame) -> np.ndarray:
    """Of each run that meets another level: 1 if its pulse grows, -1 if it decays, by more than at level 0; else 0."""
    at_rest = table[table["beyond"] == 0.0].set_index("left")["largest_velocity_change"].abs()
    change = table["largest_velocity_change"].to_numpy(float)
    baseline = table["left"].map(at_rest).to_numpy(float)
    signs = np.where(np.abs(change) > baseline, np.sign(change), 0.0)
    return np.where(table["regime"] == "arrested", -1.0, signs).astype(int)


def signed(evidence: Evidence, where, sign) -> list[bool | None]:
    """Of some runs whether their pulses change by the sign that each should have, beyond the uncertainty of that."""
    study = evidence.points("regimes_beyond", "largest_velocity_change")
    blurred = set(study.index[~(study["value"].abs() > study["uncertainty"])])
    decided = evidence.agreed("regimes_beyond", where, lambda table: changes(table) == sign(table))
    rows = study.index[where(study.reset_index(drop=True)).to_numpy(bool)]
    return [None if row in blurred else found for row, found in zip(rows, decided, strict=True)]


def grows(evidence: Evidence) -> Claim:
    """Above 0 it grows."""
    decided = signed(evidence, lambda t: t["beyond"] > 0.0, lambda t: 1)
    note = "the largest slip velocity rises, by more than at level 0; at the highest levels the pulse becomes a crack"
    return evidence.qualitative("grows_above_zero", CHANGES, decided, note)


def decays(evidence: Evidence) -> Claim:
    """Below 0 it decays."""
    decided = signed(evidence, lambda t: t["beyond"] < 0.0, lambda t: -1)
    note = "the largest slip velocity falls, by more than at level 0, or the pulse is gone"
    return evidence.qualitative("decays_below_zero", CHANGES, decided, note)


def small_perturbation(evidence: Evidence) -> Claim:
    """The smallest levels change it too."""
    decided = signed(
        evidence,
        lambda t: (t["beyond"] != 0.0) & (t["beyond"].abs() <= SMALL),
        lambda t: np.sign(t["beyond"]),
    )
    claim = evidence.qualitative(
        "small_perturbation_changes_pulse", CHANGES, decided, "runs at the smallest levels, by sign"
    )
    levels = evidence.measured["regimes_beyond"]["beyond"].abs()
    return replace(claim, further={"smallest level": float(levels[levels > 0.0].min())})


def steady_only_at_zero(evidence: Evidence) -> Claim:
    """At 0 it keeps its size, elsewhere it does not."""

    def holds(table: pd.DataFrame) -> np.ndarray:
        kept = table["largest_velocity_change"].abs() <= evidence.steady
        return np.where(table["beyond"] == 0.0, kept, changes(table) != 0)

    decided = evidence.agreed("regimes_beyond", lambda t: t["beyond"].notna(), holds)
    return evidence.qualitative(
        "steady_only_at_zero",
        CHANGES,
        decided,
        "a pulse formed at level 0 and sent into each level, 0 among them",
    )


def not_unique(evidence: Evidence) -> Claim:
    """Different pre-stress makes different pulses in the same region of zero pre-stress."""
    allowed = evidence.tolerance("stress_pulse_not_unique")
    studies = [evidence.points(SOURCE, name) for name in ("pulse_peak_velocity", "pulse_half_width")]
    # At the damping of the figures; without any, the lattice rings.
    ratio = studies[0].loc[studies[0]["damping_ratio"] > 0.0, "damping_ratio"].min()
    studies = [study[study["damping_ratio"] == ratio] for study in studies]
    decided = [
        different([(study.loc[i], study.loc[j]) for study in studies], allowed)
        for i, j in combinations(studies[0].index, 2)
    ]
    return evidence.qualitative(
        "stress_pulse_not_unique", f"{SOURCE}: pulse_peak_velocity, pulse_half_width", decided,
        "pairs of profiles whose pulses differ in peak or half-width by more than the tolerance",
    )  # fmt: skip


def different(pairs, allowed: float) -> bool | None:
    """Whether any pair of values differs by more than a tolerance; None where their uncertainty leaves that open."""
    found = []
    for one, other in pairs:
        apart = abs(one["value"] - other["value"]) / abs(other["value"])
        blur = (one["uncertainty"] + other["uncertainty"]) / abs(other["value"])
        found.append(True if apart - blur > allowed else False if apart + blur <= allowed else None)
    return True if True in found else None if None in found else False


def set_by_prestress(evidence: Evidence) -> Claim:
    """Peak and half-width of the exact pulse are functionals of the pre-stress alone, the same at every damping."""
    allowed = evidence.tolerance("stress_pulse_set_by_prestress")
    table = evidence.lattices(SOURCE)[0]
    exact = pd.DataFrame(
        [far_pulse(row, row.damping_ratio) for row in table.itertuples()], columns=["peak", "width"]
    )
    alone = pd.DataFrame([far_pulse(row, 0.0) for row in table.itertuples()], columns=["peak", "width"])
    off = (exact / alone - 1.0).abs()
    claim = evidence.qualitative(
        "stress_pulse_set_by_prestress",
        f"theory.ArrestingCrack; {SOURCE}: pulse_peak_velocity, pulse_half_width",
        list((off <= allowed).all(axis=1)),
        "profiles and dampings at which peak and half-width of the exact pulse are those without damping",
    )
    runs = pd.DataFrame({"peak": table["pulse_peak_velocity"], "width": table["pulse_half_width"]})
    lattice = (runs / exact - 1.0).abs()[table["damping_ratio"] > 0.0]
    further = {
        "peak changes with damping by at most": float(off["peak"].max()),
        "half-width changes with damping by at most": float(off["width"].max()),
        "peak on the lattice, with damping, off by at most": float(lattice["peak"].max()),
        "half-width on the lattice, with damping, off by at most": float(lattice["width"].max()),
    }
    return replace(claim, further=further)


def far_pulse(row, damping_ratio: float) -> tuple[float, float]:
    """Peak and half-width of the exact far-field pulse of a row's pre-stress at a damping ratio.

    Source: du/dt is half the integral of tau from the entry point on, on each side of its zero (`ArrestingCrack`).
    """
    crack = ArrestingCrack(prestress_from(row._asdict()), damping_ratio, row.release)
    far = 4.0 * crack.far

    def above_half(x: float) -> float:
        return crack.prestress.integral(x, far) - crack.peak_velocity

    ahead = root_between(above_half, crack.zero, far, xtol=1e-12)
    behind = root_between(above_half, crack.balance_position, crack.zero, xtol=1e-12)
    width = (ahead - float(crack.fronts.arrival(ahead))) - (behind - crack.time_at(behind))
    return crack.peak_velocity, float(width)
