"""Claims about steady pulses: their equations, whether they are unique and stable, under either boundary condition."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import pandas as pd

from . import rules
from .evidence import Claim, Evidence, agreeing, evaluated

UNDAMPED = "damping_ratio == 0"
STEADY = {"steady_displacement": UNDAMPED}
# What is known to a block at either end of a pulse is judged where blocks are narrow.
NARROW = {"undamped_pulses": ""}
# Pulses that meet another pre-stress, and come back from it or not; and those that began in each.
PERTURBED = ("pulses_across_a_step", "pulses_across_wide_steps", "pulses_perturbed_elsewhere")
UNPERTURBED = ("any_prestress", "steady_displacement", "steady_elsewhere")
# What a steady pulse of given pre-stress and elasticity ratio is compared by.
SIZES = ("pulse_peak_velocity", "pulse_width", "pulse_slip")
# Of each equation what is measured, what the paper has for it, and in which runs.
EQUATIONS: dict[str, tuple[str, str, dict[str, str]]] = {
    # Without leaf springs, and at the smallest gamma with them.
    "front_speed": (
        "front_speed_right",
        "paper_front_speed_right",
        {"front_speed_undamped": "", "speed_against_gamma": "gamma == gamma.min()"},
    ),
    "pulse_profile": ("pulse_shape_deviation", "0", STEADY),
    **{id: (id, f"paper_{id}", STEADY) for id in ("pulse_peak_velocity", "pulse_slip")},
    **{id: (id, f"paper_{id}", NARROW) for id in ("pulse_width", "pulse_acceleration")},
    "stress_drop": ("pulse_stress_drop", "2 * left", STEADY),
    "energy_balance_at_zero": ("energy_change", "0", {"stress_pulses": UNDAMPED}),
}
# Pulses that formed at level 0 and meet another, `beyond`: which of them, and what is to hold (`changes`, `widens`).
CHANGE = "largest_velocity_change"
MEETING = {
    "grows_above_zero": ("beyond > 0", "changed == 1 and widened == 1"),
    "decays_below_zero": ("beyond < 0", "changed == -1 and widened == -1"),
    # Within what counts as a small perturbation, in units of the friction drop.
    "small_perturbation_changes_pulse": (
        "0 < abs(beyond) <= 0.03",
        "changed * beyond > 0 and widened * beyond > 0",
    ),
}


def pulse_claims(evidence: Evidence) -> list[Claim]:
    """Every claim of this module."""
    evidence.assign("regimes_beyond", changed=changes, widened=widens)
    meeting = {
        id: evidence.agreed("regimes_beyond", *row, told=f"abs({CHANGE}) > uncertainty_{CHANGE}")
        for id, row in MEETING.items()
    }
    keeps = f"(beyond == 0 and abs({CHANGE}) <= {evidence.steady}) or (beyond != 0 and changed != 0)"
    meeting["steady_only_at_zero"] = evidence.agreed("regimes_beyond", "", keeps)
    found = {id: evidence.qualitative(id, decided) for id, decided in meeting.items()}
    for id in ("grows_above_zero", "decays_below_zero"):
        ends = evidence.lattices("regimes_beyond", where=MEETING[id][0])[0]["regime"].value_counts()
        found[id]["further"] = {f"at the end: {regime}": float(count) for regime, count in ends.items()}
    levels = evidence.tables["regimes_beyond"]["beyond"].abs()
    found["small_perturbation_changes_pulse"]["further"] = {
        "smallest level": float(levels[levels > 0.0].min())
    }
    others = (
        moderate_speed, steady_for_any_prestress, unique, settle, damping_reduces_oscillations,
        zero_net_stress_change, not_unique, set_by_prestress,
    )  # fmt: skip
    equations = [equation(evidence, id) for id in EQUATIONS]
    return [*found.values(), *equations, *(judge(evidence) for judge in others)]


def equation(evidence: Evidence, id: str) -> Claim:
    """One equation, by the values of its runs at spacing 0."""
    quantity, paper, runs = EQUATIONS[id]
    table = pd.concat([evidence.lattices(name, where=where)[0] for name, where in runs.items()])
    extrapolated, blur = (table[f"{name}_{quantity}"] for name in ("extrapolated", "uncertainty"))
    return evidence.exact(id, extrapolated, blur, evaluated(table, paper))


def moderate_speed(evidence: Evidence) -> Claim:
    """The front speed without damping for gamma up to 1."""
    where = f"{UNDAMPED} and 0.1 <= gamma <= 1"
    tables = evidence.lattices("speed_against_gamma", "steady_displacement", where=where)
    return evidence.approximate(
        "front_speed_moderate_gamma", tables, "front_speed_right", "paper_front_speed_right"
    )


# With the displacement held


def steady_for_any_prestress(evidence: Evidence) -> Claim:
    """Two pulses whose slip does not vary, at every level."""
    id = "steady_for_any_prestress"
    holds = f"slip_variation < {evidence.tolerance(id)} and regime == 'pulses, two-way'"
    sweeps = ("any_prestress", "steady_elsewhere")
    return evidence.qualitative(
        id, [found for sweep in sweeps for found in evidence.agreed(sweep, "0 < left < 1", holds)]
    )


def unique(evidence: Evidence) -> Claim:
    """Pulses of one pre-stress from different beginnings are the same pulse."""
    id = "displacement_pulse_unique"
    table = evidence.lattices("nucleation_widths", "any_prestress", "steady_elsewhere", *PERTURBED)[0]
    groups = table.groupby(["beyond", "gamma", "damping_ratio"])
    found = [
        different for _, rows in groups for different in apart(rows, SIZES, evidence.tolerance(id), False)
    ]
    return evidence.qualitative(id, [None if different is None else not different for different in found])


def apart(table: pd.DataFrame, sizes: Sequence[str], allowed: float, sure: bool) -> list[bool | None]:
    """Of each pair of runs whether a size differs by more than a tolerance; None where the uncertainty leaves it open.

    ``sure``: whether it takes the uncertainty too to say that none does.
    """
    out: list[bool | None] = []
    for one, other in combinations(table.to_dict("records"), 2):
        differences = np.array([abs(one[size] / other[size] - 1.0) for size in sizes])
        both = [one[f"uncertainty_{size}"] + other[f"uncertainty_{size}"] for size in sizes]
        blur = np.array(both) / np.abs([other[size] for size in sizes])
        equal = False if np.all(differences + sure * blur <= allowed) else None
        out.append(True if np.any(differences - blur > allowed) else equal)
    return out


def settle(evidence: Evidence) -> Claim:
    """A pulse sent into another pre-stress leaves the slip of that pre-stress's own steady pulse."""
    id, keys = "perturbed_pulses_settle", ["gamma", "damping_ratio"]
    offs, exact = [], evidence.lattices(*UNPERTURBED)[0]
    for table, own in zip(evidence.lattices(*PERTURBED), evidence.lattices(*UNPERTURBED), strict=True):
        slips = own[["left", *keys]].assign(own=own["pulse_slip"])
        for who in ("exact", "paper"):
            slips[who] = exact[f"{who}_pulse_slip"].to_numpy()
        slips = slips.drop_duplicates(["left", *keys]).set_index(["left", *keys])
        found = table[["beyond", *keys, "pulse_slip"]].join(slips, on=["beyond", *keys])
        offs.append(found[["own", "exact", "paper"]].rdiv(found["pulse_slip"], axis=0).sub(1.0).abs())
    claim = evidence.qualitative(id, agreeing(*(off["own"] <= evidence.tolerance(id) for off in offs[:2])))
    names = {
        "slip off by at most": "own",
        "slip off the exact slip by at most": "exact",
        "slip off that without damping by at most": "paper",
    }
    return claim | {
        "further": {name: float(np.nanmax(offs[0][who], initial=0.0)) for name, who in names.items()}
    }


def damping_reduces_oscillations(evidence: Evidence) -> Claim:
    """Damping takes power from the waves of the lattice."""

    def falls(table: pd.DataFrame) -> list[bool]:
        by_level = table.sort_values("damping_ratio").groupby(["left", "gamma"])["lattice_noise"]
        return [after < before for _, noise in by_level for before, after in combinations(noise, 2)]

    finest, middle, *_ = evidence.lattices("steady_displacement")
    decided = agreeing(falls(finest), falls(middle))
    claim = evidence.qualitative("damping_reduces_oscillations", decided, condition=True)
    return claim | {"why": "It needs the sign opposite to the printed one." if all(decided) else ""}


# With the stress held


def zero_net_stress_change(evidence: Evidence) -> Claim:
    """No strain is left behind a pulse that keeps its shape; where some is left, the pulse changes."""
    id = "zero_net_stress_change"
    where = f"beyond != 0 and strain_left > {evidence.tolerance(id)}"
    change = evidence.qualitative(id, evidence.agreed("regimes_beyond", where, "changed != 0"))
    runs = evidence.lattices("stress_pulses", where=UNDAMPED)[0]
    claim = evidence.exact(id, runs["extrapolated_strain_left"], runs["uncertainty_strain_left"], 0.0)
    return change | claim | {"verdict": rules.worst([claim["verdict"], change["verdict"]])}


def changes(table: pd.DataFrame) -> pd.Series:
    """Of each run that meets another level: 1 if its pulse grows, -1 if it decays, by more than at level 0; else 0."""
    grown = table[CHANGE].abs() > at_rest(table, CHANGE).abs()
    signs = np.sign(table[CHANGE]).where(grown, 0.0)
    return signs.where(table["regime"] != "arrested", -1.0).astype(int)


def widens(table: pd.DataFrame) -> pd.Series:
    """Of each run that meets another level: 1 if its pulse ends wider than at level 0, -1 if narrower or gone."""
    signs = np.sign(table["pulse_half_width"] - at_rest(table, "pulse_half_width"))
    return signs.where(table["regime"] != "arrested", -1.0).fillna(0.0).astype(int)


def at_rest(table: pd.DataFrame, quantity: str) -> pd.Series:
    """A number of the run that began alike and meets level 0."""
    return table["left"].map(table[table["beyond"] == 0.0].set_index("left")[quantity])


def not_unique(evidence: Evidence) -> Claim:
    """Different pre-stress makes different pulses in the same region of zero pre-stress."""
    id = "stress_pulse_not_unique"
    table = evidence.lattices("stress_pulses", where="damping_ratio > 0")[0]
    # At the damping of the figures; without any, the lattice rings.
    table = table[table["damping_ratio"] == table["damping_ratio"].min()]
    sizes = ("pulse_peak_velocity", "pulse_half_width")
    return evidence.qualitative(id, apart(table, sizes, evidence.tolerance(id), True))


def set_by_prestress(evidence: Evidence) -> Claim:
    """Peak and half-width on the damped lattices are the functionals of the pre-stress that the exact solution has."""
    id = "stress_pulse_set_by_prestress"
    sizes = {
        "peak": ("exact_largest_velocity", "pulse_peak_velocity"),
        "half-width": ("exact_half_width", "pulse_half_width"),
    }
    table = evidence.lattices("stress_pulses", where="damping_ratio > 0")[0]
    off = {name: (table[ours] / table[exact] - 1.0).abs() for name, (exact, ours) in sizes.items()}
    sure = {
        name: off[name] - table[f"uncertainty_{ours}"] / table[exact] for name, (exact, ours) in sizes.items()
    }
    allowed = evidence.tolerance(id)
    within, beyond = pd.DataFrame(off).le(allowed).all(axis=1), pd.DataFrame(sure).gt(allowed).any(axis=1)
    holds = [True if near else False if far else None for near, far in zip(within, beyond, strict=True)]
    further = {f"{name} on the lattice, with damping, off by at most": float(off[name].max()) for name in off}
    return evidence.qualitative(id, holds) | {"further": further}
