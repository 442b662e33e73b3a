"""Known deviations of the paper's estimates, to three digits, over the grids of figure 5."""

import pytest

from slippulse_paper.configuration.resolve import resolve
from slippulse_paper.steps.inputs import load_inputs
from slippulse_paper.studies import open_choices

# Medians of L_trans under leaf springs in percent, by release rule and damping ratio.
LENGTHS = {("total", 0.0): 13.6, ("total", 0.058): 20.4, ("total", 0.08): 22.2}
LENGTHS |= {("total", 0.1): 23.5, ("elastic", 0.1): 15.6}
LENGTHS |= {("elastic", 0.16): 16.7, ("elastic", 0.23): 17.9}
# Medians of T_trans and L_trans by fraction of the way, at the damping of the figures.
ARRESTS = {0.9: (8.96, 5.64), 0.95: (21.8, 12.6), 0.99: (41.0, 24.1)}


@pytest.mark.slow
def test_known_cases(project, shipped):
    settings, names = (shipped["model"], shipped["presets"]["paper"]), open_choices.NEEDS["sweeps"]
    sweeps = {name: resolve(shipped["simulations"][name], *settings) for name in names}
    lists = load_inputs({"lists": [project / path for path in open_choices.NEEDS["lists"]]}).tables
    table = open_choices.table({}, lists, {"sweeps": sweeps})
    for quantity in ("time", "length"):
        ratio = table[f"transition_{quantity}"] / table[f"paper_transition_{quantity}"]
        table[quantity] = 100.0 * (ratio - 1.0).abs()
    springs = table[table["boundary"] == "displacement"].groupby(["release", "damping_ratio"])
    times, lengths = springs["time"].median(), springs["length"].median()
    assert {choice: round(lengths[choice], 1) for choice in LENGTHS} == LENGTHS
    assert round(times.min(), 1) == 6.6 and round(times.max(), 1) == 7.0 and len(times) == 8
    plain = table.query("nucleation == 'Gaussian' and release == 'total' and damping_ratio == 0.1")
    medians = plain.query("-1 < left < 0").groupby("fraction")[["time", "length"]].median()
    for fraction, known in ARRESTS.items():
        assert medians.loc[fraction].to_list() == pytest.approx(known, rel=5e-3)
