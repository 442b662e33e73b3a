"""Claims and numbers about pulses on a rough pre-stress, over ensembles."""

import pandas as pd

from .evidence import Evidence
from .kinds import Qualitative

# Names of the exponent and of the ends of its interval, and numbers of ensembles under held stress.
ENDS = (("exponent", ""), ("low", "_low"), ("high", "_high"))
# Columns that name an ensemble.
FIELD = ["level", "deviation", "correlation_length", "hurst"]
# Death rates of ensembles in which fewer pulses die say little.
LEAST_DEATHS = 5
STRESS_KEYS = ("level", "deviation", "pulses", "deaths", "cracks", "survival", "low", "high")
DISTANCES, VELOCITIES = ("death_scale", "stop"), ("velocity_deviation", "velocity_predicted")


def ensembles(evidence: Evidence, boundary: str) -> pd.DataFrame:
    """Ensembles of one boundary."""
    table = evidence.tables["rough_prestress"]
    return table[(table["part"] == "ensemble") & (table["boundary"] == boundary)]


def rough_pulses_go_on(evidence: Evidence, id: str) -> Qualitative:
    """No pulse dies where the deviation is a small part of the level, a limit of ours."""
    rows = ensembles(evidence, "displacement")
    relative = rows["deviation"] / rows["level"]
    small = relative <= evidence.tolerance(id)
    alive, dead = (rows["pulses"] - rows["deaths"])[small].sum(), rows["deaths"][small].sum()
    stronger = rows[~small]
    dying = stronger["deaths"].sum()
    template_values = {"largest_rate": 3.0 / rows["distance"][small].sum(), "dying": dying}
    template_values |= {
        "stronger": stronger["pulses"].sum(),
        "least_deviation": relative[~small].min(),
    }
    further = {"pulses that die at larger deviations": float(dying)}
    further["of"] = float(template_values["stronger"])
    decided = [True] * int(alive) + [False] * int(dead)
    return Qualitative(
        decided=decided, condition=dying > 0, further=further, template_values=template_values
    )


def rough_stress_pulses_change(evidence: Evidence, id: str) -> Qualitative:
    """Judge that a rough pre-stress changes the pulses under a stress boundary, in all ensembles.

    The pulses of an ensemble have changed if their velocities differ, with a relative standard
    deviation above the tolerance, or if one of them has died.
    """
    rows = ensembles(evidence, "stress")
    velocity_spread = rows["velocity_deviation"] / rows["velocity_mean"]
    changed = (velocity_spread > evidence.tolerance(id)) | (rows["deaths"] > 0)
    # The ensemble with the smoothest pre-stress is shown with the claim.
    smoothest = rows.loc[rows["deviation"].idxmin()]
    further = {
        "smallest deviation": smoothest["deviation"],
        "spread of its velocities": float(velocity_spread[smoothest.name]),
        "its cracks": smoothest["cracks"],
        "its deaths": smoothest["deaths"],
    }
    return Qualitative(decided=[*changed], further=further)


def rough_numbers(evidence: Evidence) -> dict[str, float]:
    """Numbers of the findings on rough pre-stress."""
    held, stress = (ensembles(evidence, name) for name in ("displacement", "stress"))
    if held.empty or stress.empty:
        return {}
    study, checks = evidence.tables["rough_prestress"], evidence.tables["rough_checks"]
    dying = held[held["deaths"] > 0]
    ratio = dying["rate"] / dying["barrier_rate"]
    frequent = dying[dying["deaths"] >= LEAST_DEATHS]
    frequent_ratios = {
        name: frequent[column] / frequent["barrier_rate"]
        for name, column in (("ratio", "rate"), ("low", "rate_low"), ("high", "rate_high"))
    }
    calm, worst = held[held["deaths"] == 0], held.loc[held["rate"].idxmax()]
    lives = study[(study["part"] == "survival") & (study["boundary"] == "displacement")]
    lives = lives[(lives[FIELD] == worst[FIELD]).all(axis=1)].iloc[-1]
    near, far = (row for _, row in checks[checks["part"] == "length"].iterrows())
    grid = checks[checks["part"] == "grid"].sort_values("dx")
    fine, coarse = grid.iloc[0], grid.iloc[-1]
    settled = held.dropna(subset=["memory"]).sort_values("correlation_length")
    forgotten = checks[(checks["part"] == "memory") & (checks["distance"] >= 1.0)]
    exponent = study[study["part"] == "long"].iloc[0]
    rough = stress.loc[stress["deviation"].idxmax()]
    quiet = stress.loc[stress["deviation"].idxmin()]
    above = stress.loc[stress["level"].idxmax()]
    balance = checks[checks["part"] == "balance"].sort_values("dx")
    first, last = settled.iloc[0], settled.iloc[-1]
    out = {"least_ratio": ratio.min(), "largest_ratio": ratio.max()}
    out |= {"confidence": exponent["confidence"], "frequent_deaths": LEAST_DEATHS}
    out |= {"frequent_least": frequent_ratios["ratio"].min()}
    out |= {"frequent_largest": frequent_ratios["ratio"].max()}
    out |= {"frequent_low": frequent_ratios["low"].min()}
    out |= {"frequent_high": frequent_ratios["high"].max()}
    out |= {"calm_pulses": calm["pulses"].sum(), "calm_rate": calm["rate_high"].max()}
    out |= {f"worst_{key}": worst[key] for key in ("level", "deviation", "stop")}
    out |= {f"worst_{key}": lives[key] for key in ("survival", "low", "high")}
    for name, row in (("near", near), ("far", far)):
        out |= {f"{name}_{key}": row[key] for key in ("rate", "rate_low", "rate_high", "stop")}
    out |= {"grid_pulses": coarse["pulses"], "grid_dx": coarse["dx"], "grid_fine_dx": fine["dx"]}
    out |= {"grid_deaths": coarse["deaths"], "grid_fine_deaths": fine["deaths"]}
    out |= {"highest_level": held["level"].max()}
    for name, row in (("short", first), ("smooth", last)):
        out |= {f"{name}_{key}": row[key] for key in ("correlation_length", "deviation")}
        out |= {f"{name}_local": row["off_local"], f"{name}_mean": row["off_mean"]}
        out |= {f"{name}_slowness": row["slowness_off"]}
    out |= {"memory": first["memory"], "forgotten": forgotten["high"].max()}
    out |= {f"tail_{name}": exponent[f"exponent{end}"] for name, end in ENDS}
    keys = (*STRESS_KEYS, *DISTANCES, *VELOCITIES, "predicted", "velocity_mean")
    out |= {f"rough_{key}": rough[key] for key in keys}
    out |= {f"quiet_{key}": quiet[key] for key in keys}
    out |= {f"above_{key}": above[key] for key in keys}
    out |= {"balance_coarse": balance["change"].iloc[-1], "balance_fine": balance["change"].iloc[0]}
    out |= {"balance_dx": balance["dx"].iloc[0], "balance_coarse_dx": balance["dx"].iloc[-1]}
    return {name: float(value) for name, value in out.items()}
