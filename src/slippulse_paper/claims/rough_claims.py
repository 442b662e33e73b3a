"""Judge claims about pulses on a rough pre-stress, and compute the numbers of our finding on them.

An ensemble is a set of runs whose pre-stress has the same statistics, with different seeds. A
function that judges a claim takes the evidence and the id of the claim, and returns the result. The
`further` numbers of the result are shown in the table of claims, and sentences quote its
`template_values`.
"""

import pandas as pd

from .evidence import Evidence
from .kinds import Qualitative

# Columns that name an ensemble.
FIELD_COLUMNS = ["level", "deviation", "correlation_length", "hurst"]
# Columns of ensembles whose slip was recorded.
SLIP_COLUMNS = ["memory", "off_mean", "off_local"]
# Ensembles with fewer deaths have death rates with wide confidence intervals.
LEAST_DEATHS = 5
# A death rate is at most 3 divided by the distance without a death, at 95 % confidence.
RULE_OF_THREE = 3.0


def ensembles(evidence: Evidence, boundary: str) -> pd.DataFrame:
    """Return one row for each ensemble of runs under a boundary condition."""
    table = evidence.tables["rough_prestress"]
    # No ensemble has these columns if no slip was recorded.
    table = table.reindex(columns=table.columns.union(SLIP_COLUMNS, sort=False))
    return table[(table["part"] == "ensemble") & (table["boundary"] == boundary)]


def rough_pulses_go_on(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether all pulses survive where the pre-stress is only a little rough.

    The paper states no limit of the roughness. Ours is that the standard deviation of the
    pre-stress, divided by its level, is at most the tolerance. If pulses die in rougher ensembles,
    the claim holds only with this limit, and has a caveat. Each pulse counts as one run.

    The template values are:

    largest_rate : upper bound of the death rate, if no pulse dies where the pre-stress is smooth
    dying, stronger : number of pulses that die in rougher ensembles, and of all pulses in them
    least_deviation : least standard deviation of these ensembles, divided by the level
    """
    rows = ensembles(evidence, "displacement")
    # The paper has pulses at positive levels only.
    rows = rows[rows["level"] > 0.0]
    roughness = rows["deviation"] / rows["level"]
    is_smooth = roughness <= evidence.tolerance(id)
    smooth, rough = rows[is_smooth], rows[~is_smooth]
    alive, dead = (smooth["pulses"] - smooth["deaths"]).sum(), smooth["deaths"].sum()
    dead_in_rough, all_in_rough = rough["deaths"].sum(), rough["pulses"].sum()
    template_values = {
        "largest_rate": RULE_OF_THREE / smooth["distance"].sum(),
        "dying": dead_in_rough,
        "stronger": all_in_rough,
        "least_deviation": roughness[~is_smooth].min(),
    }
    further = {
        "pulses that die at larger standard deviations": float(dead_in_rough),
        "all pulses at larger standard deviations": float(all_in_rough),
    }
    return Qualitative(
        decided=[True] * int(alive) + [False] * int(dead),
        has_caveat=dead_in_rough > 0,
        further=further,
        template_values=template_values,
    )


def rough_stress_pulses_change(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether a rough pre-stress changes the pulses of all ensembles under a stress boundary.

    The pulses of an ensemble have changed if their velocities differ, with a relative standard
    deviation above the tolerance, or if one of them has died.
    """
    rows = ensembles(evidence, "stress")
    velocity_spread = rows["velocity_deviation"] / rows["velocity_mean"]
    changed = (velocity_spread > evidence.tolerance(id)) | (rows["deaths"] > 0)
    if rows.empty:
        return Qualitative(decided=[])
    # The ensemble with the smoothest pre-stress is shown with the claim.
    smoothest = rows.loc[rows["deviation"].idxmin()]
    further = {
        "smallest standard deviation of the pre-stress": smoothest["deviation"],
        "spread of the velocities at the smallest standard deviation of the pre-stress": float(
            velocity_spread[smoothest.name]
        ),
        "cracks at the smallest standard deviation of the pre-stress": smoothest["cracks"],
        "deaths of pulses at the smallest standard deviation of the pre-stress": smoothest[
            "deaths"
        ],
    }
    return Qualitative(decided=[*changed], further=further)


def rough_numbers(evidence: Evidence) -> dict[str, float]:
    """Return the numbers of the findings on rough pre-stress; empty without ensembles.

    confidence, tail_... : from runs over a long distance, confidence level and interval of the
        exponent with which the survival of pulses falls as a power of the distance

    The others are explained in the functions that are called.
    """
    displacement = ensembles(evidence, "displacement")
    stress = ensembles(evidence, "stress")
    if displacement.empty or stress.empty:
        return {}
    checks = evidence.tables["rough_checks"]
    study = evidence.tables["rough_prestress"]
    numbers = death_rate_numbers(displacement) | settling_numbers(displacement, checks)
    numbers |= survival_numbers(displacement, study) | accuracy_numbers(checks)
    long_distance = study[study["part"] == "long"].iloc[0]
    numbers |= {
        "confidence": long_distance["confidence"],
        "tail_exponent": long_distance["exponent"],
        "tail_low": long_distance["exponent_low"],
        "tail_high": long_distance["exponent_high"],
    }
    numbers |= quoted_stress_ensembles(stress) | balance_numbers(checks)
    return {name: float(value) for name, value in numbers.items()}


def quoted_stress_ensembles(stress: pd.DataFrame) -> dict[str, float]:
    """Return the numbers that the texts quote on three ensembles under a stress boundary.

    The ensembles are the one with the largest standard deviation of the pre-stress (rough), the one
    with the smallest (quiet), and the one with the highest level (above).
    """
    rough = stress.loc[stress["deviation"].idxmax()]
    rough = rough[["deviation", "survival", "low", "high", "predicted", "stop"]]
    quiet = stress.loc[stress["deviation"].idxmin()]
    quiet = quiet[["deviation", "velocity_deviation", "velocity_predicted"]]
    above = stress.loc[stress["level"].idxmax()]
    above = above[["level", "pulses", "deaths", "cracks"]]
    return {
        **rough.add_prefix("rough_"),
        **quiet.add_prefix("quiet_"),
        **above.add_prefix("above_"),
    }


def death_rate_numbers(ensembles: pd.DataFrame) -> dict[str, float]:
    """Return how much measured death rates differ from the predicted rates of fatal barriers.

    The first four numbers are about the ensembles in which deaths are frequent.

    frequent_deaths : least number of deaths in such an ensemble
    frequent_least, frequent_largest : range of the measured rate divided by the predicted rate
    frequent_low, frequent_high : this range from the lower to the upper ends of the confidence
        intervals of the measured rates
    highest_level : highest level of all ensembles
    """
    frequent = ensembles[ensembles["deaths"] >= LEAST_DEATHS]
    predicted = frequent["barrier_rate"]
    ratio = frequent["rate"] / predicted
    return {
        "frequent_deaths": LEAST_DEATHS,
        "frequent_least": ratio.min(),
        "frequent_largest": ratio.max(),
        "frequent_low": (frequent["rate_low"] / predicted).min(),
        "frequent_high": (frequent["rate_high"] / predicted).max(),
        "highest_level": ensembles["level"].max(),
    }


def survival_numbers(ensembles: pd.DataFrame, study: pd.DataFrame) -> dict[str, float]:
    """Return the survival of pulses where most die, and a bound of the death rate where none dies.

    The result contains these numbers:

    worst_level, worst_deviation, worst_stop : mean and standard deviation of the pre-stress, and
        the distance at which it ceases to be rough, in the ensemble with the highest death rate
    worst_survival, worst_low, worst_high : fraction of its pulses that survive to the end, and the
        confidence interval of this fraction
    calm_rate : upper bound of the death rate over all ensembles without deaths

    study : the table rough_prestress, which also has the survival curves of the ensembles
    """
    calm = ensembles[ensembles["deaths"] == 0]
    # A rate is NaN if no pulse went far enough.
    worst = ensembles.loc[ensembles["rate"].fillna(-1.0).idxmax()]
    is_curve = (study["part"] == "survival") & (study["boundary"] == "displacement")
    is_worst = (study[FIELD_COLUMNS] == worst[FIELD_COLUMNS]).all(axis=1)
    # The rows of the survival curve are in the order of the distance.
    end_of_curve = study[is_curve & is_worst].iloc[-1]
    numbers = {"calm_rate": RULE_OF_THREE / calm["distance"].sum()}
    numbers |= {f"worst_{column}": worst[column] for column in ("level", "deviation", "stop")}
    return numbers | {f"worst_{name}": end_of_curve[name] for name in ("survival", "low", "high")}


def accuracy_numbers(checks: pd.DataFrame) -> dict[str, float]:
    """Return numbers that show how accurate the measured death rates are.

    The result contains these numbers:

    grid_..., grid_fine_... : spacing dx and number of deaths on the coarsest and the finest lattice
    grid_pulses : number of pulses on each lattice
    near_..., far_... : death rate in the near and in the far half of a longer rough pre-stress, its
        confidence interval, and the distance at which the half ends (stop)
    """
    by_spacing = checks[checks["part"] == "grid"].sort_values("dx")
    fine, coarse = by_spacing.iloc[0], by_spacing.iloc[-1]
    # The far half begins and stops at larger distances.
    halves = checks[checks["part"] == "length"].sort_values("stop")
    near_half, far_half = halves.iloc[0], halves.iloc[-1]
    numbers = {
        "grid_pulses": coarse["pulses"],
        "grid_dx": coarse["dx"],
        "grid_deaths": coarse["deaths"],
        "grid_fine_dx": fine["dx"],
        "grid_fine_deaths": fine["deaths"],
    }
    for name, half in (("near", near_half), ("far", far_half)):
        columns = ("rate", "rate_low", "rate_high", "stop")
        numbers |= {f"{name}_{column}": half[column] for column in columns}
    return numbers


def settling_numbers(ensembles: pd.DataFrame, checks: pd.DataFrame) -> dict[str, float]:
    """Return how much the final slip of pulses differs from the slip of steady pulses.

    Two ensembles are quoted: the one whose pre-stress has the shortest correlation length (short),
    and the one with the longest (smooth).

    The result contains these numbers:

    short_mean : median relative difference from a steady pulse in the mean pre-stress
    smooth_local : the same for a steady pulse in the local pre-stress
    memory : distance after which a pulse of the short ensemble has forgotten a change of pre-stress
    forgotten : largest relative change of the slip by a bump that is farther away than the memory
    """
    # Ensembles whose slip was not recorded have no value in the column memory.
    with_slip = ensembles.dropna(subset=["memory"]).sort_values("correlation_length")
    if with_slip.empty:
        # All numbers are then NaN.
        with_slip = with_slip.reindex([0])
    shortest, longest = with_slip.iloc[0], with_slip.iloc[-1]
    # In these rows the column distance has the distance from the bump, in units of the memory, and
    # the column high has the largest change of the slip over all runs.
    beyond_memory = checks[(checks["part"] == "memory") & (checks["distance"] >= 1.0)]
    return {
        "short_correlation_length": shortest["correlation_length"],
        "short_mean": shortest["off_mean"],
        "smooth_correlation_length": longest["correlation_length"],
        "smooth_local": longest["off_local"],
        "memory": shortest["memory"],
        "forgotten": beyond_memory["high"].max(),
    }


def balance_numbers(checks: pd.DataFrame) -> dict[str, float]:
    """Return how far pulses die before the balance position, at which they die by theory.

    There is a median distance over all pulses for the coarsest and one for the finest lattice. Also
    return the spacings dx of these lattices.
    """
    by_spacing = checks[checks["part"] == "balance"].sort_values("dx")
    finest, coarsest = by_spacing.iloc[0], by_spacing.iloc[-1]
    # In these rows the column change has the median distance.
    return {
        "balance_coarse": coarsest["change"],
        "balance_fine": finest["change"],
        "balance_dx": finest["dx"],
        "balance_coarse_dx": coarsest["dx"],
    }
