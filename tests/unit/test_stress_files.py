"""Pre-stress from files: reading, refusals, and results that depend on a file."""

import os

import numpy as np
import pytest
import xarray as xr

import slippulse as sp
from slippulse_paper.configuration.expand import expand
from slippulse_paper.configuration.problems import ConfigError
from slippulse_paper.configuration.profiles import ExpandedProfiles
from slippulse_paper.configuration.read import read_config, read_overlay
from slippulse_paper.configuration.resolve import (
    all_simulations,
    resolve,
    scene_simulation,
    with_ends_of_lists,
)
from slippulse_paper.configuration.runs import profile_labels, run_count

POINTS = ((-2.0, 0.3), (0.0, 1.0), (3.0, 0.4), (3.0, 0.2))
TEXT = "x,tau\n-2,0.3\n0,1\n3,0.4\n3,0.2\n"
GOOD = {
    "a header": TEXT,
    "units": TEXT.replace("tau\n", "tau\nH,S\n"),
    "other columns": "depth;Position ;Stress\n1;-2;.3\n2;0;1.\n3;3;4e-1\n4;3;+.2\n",
    "comments and a mark": "\ufeff# measured\n\n" + TEXT.replace("0,1\n", "# here\n0,1\n"),
    "spaces": "x   tau\n -2 0.3\n0 1\n3 0.4\n3 0.2",
}


@pytest.mark.parametrize("case", GOOD)
def test_the_table_of_a_csv_file_is_read(case, tmp_path):
    path = tmp_path / "stress.csv"
    path.write_text(GOOD[case], encoding="utf-8")
    profile = sp.Prestress.from_file(path)
    assert (profile.points, profile.width) == (POINTS, None)
    assert sp.Prestress.from_file(path, width=0.5, peak=1.1) == sp.Prestress.through(
        *zip(*POINTS, strict=True), width=0.5, peak=1.1
    )


def test_columns_may_be_named(tmp_path):
    path = tmp_path / "stress.csv"
    path.write_text("x,s,tau,t\n0,1,.1,.2\n1,2,.3,.4\n", encoding="utf-8")
    assert sp.Prestress.from_file(path, x="s", prestress="t").points == ((1.0, 0.2), (2.0, 0.4))


@pytest.mark.parametrize("engine", ["h5netcdf", "scipy"])
def test_the_table_of_a_netcdf_file_is_read(engine, tmp_path):
    x, tau = np.array(POINTS).T
    data = xr.Dataset({"tau": ("place", tau, {"units": "1"}), "x": ("place", x, {"units": "H"})})
    data.to_netcdf(tmp_path / "stress.nc", engine=engine)
    assert sp.Prestress.from_file(tmp_path / "stress.nc").points == POINTS
    data["tau"].attrs["units"] = "Pa"
    data.to_netcdf(tmp_path / "pascal.nc", engine=engine)
    with pytest.raises(ValueError, match=r"pascal.nc: unit 'Pa' of prestress; allowed: 1, -, S"):
        sp.Prestress.from_file(tmp_path / "pascal.nc")
    data["tau"][1] = np.nan
    data.to_netcdf(tmp_path / "nan.nc", engine=engine)
    with pytest.raises(ValueError, match=r"nan.nc: row 2: tau = nan; allowed: a finite number"):
        sp.Prestress.from_file(tmp_path / "nan.nc")


BAD = {
    "empty; allowed: a row of names": "",
    "no row of numbers": "x,tau\n",
    "one row of numbers; allowed: at least 2": "x,tau\n0,1\n",
    "row 3: position -1; allowed: >= 0": "x,tau\n0,.1\n-1,.2\n",
    "row 4: position 0; allowed: at most 2 rows": "x,tau\n0,.1\n0,.2\n0,.3\n",
    "row 3: tau = 'high'; allowed: a finite number": "x,tau\n0,.1\n1,high\n",
    "row 2: tau = nothing": "x,tau\n0,\n1,.2\n",
    "row 2: tau = '0,5'": "x;tau\n0;0,5\n1;0,5\n",
    "row 3: tau = 'nan'": "x,tau\n0,.1\n1,nan\n",
    "row 3: x = '1e999'": "x,tau\n0,.1\n1e999,.2\n",
    "row 3: a value is missing": "x,tau\n0,.1\n1\n",
    "no column tau or prestress": "x,y\n0,.1\n1,.2\n",
    "unit 'm' of x; allowed: 1, -, H": "x,tau\nm,Pa\n0,.1\n1,.2\n",
    "last prestress 1.2; allowed: < 1": "x,tau\n0,.1\n1,1.2\n",
    "not text (byte 8); allowed: CSV in UTF-8": b"x,tau\n0,\xff\n",
    "more than 20000000 bytes; allowed: at most 100000 rows": b"1,0\n" * 10_000_000,
    "row 100003: one row too many": "x,tau\nH,S\n" + "0,0\n" * 100_001,
}


@pytest.mark.parametrize("words", BAD)
def test_a_bad_file_is_refused_in_one_line_with_its_row(words, tmp_path):
    path, content = tmp_path / "stress.csv", BAD[words]
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ValueError, match="allowed") as refusal:
        sp.Prestress.from_file(path)
    text = str(refusal.value)
    assert text.startswith(f"{path}: {words}") and "\n" not in text
    overlay = tmp_path / "mine.yaml"
    overlay.write_text(OVERLAY.format(file="stress.csv"), encoding="utf-8")
    with pytest.raises(ConfigError) as refusal:
        read_overlay(overlay)
    assert str(refusal.value) == f"{overlay}: scenes.mine.file: {text}"


OVERLAY = """
scenes:
  mine: {{title: t, boundary: displacement, gamma: 0.65, duration: 1.0, dx: 0.05, file: {file}}}
"""


@pytest.mark.parametrize("name", ["none.csv", "../none.csv", "/none/none.nc", "."])
def test_a_missing_file_is_refused_with_its_path(name, tmp_path):
    overlay = tmp_path / "mine.yaml"
    overlay.write_text(OVERLAY.format(file=name), encoding="utf-8")
    for read in (lambda: read_overlay(overlay), lambda: sp.Prestress.from_file(tmp_path / name)):
        with pytest.raises(
            ValueError, match=r"(No such file|not a regular file).*; allowed: a CSV"
        ):
            read()


@pytest.mark.parametrize("name", ["damaged.nc", "damaged.csv"])
def test_a_damaged_netcdf_file_is_refused(name, tmp_path):
    (tmp_path / name).write_bytes(b"\x89HDF\r\n\x1a\n" + b"\x00" * 50)
    with pytest.raises(ValueError, match=r"not netCDF .*; allowed: netCDF-3 or netCDF-4"):
        sp.Prestress.from_file(tmp_path / name)


def resolved_of(overlay, shipped, name="mine"):
    config = read_config(shipped, [overlay])
    return resolve(
        all_simulations(config)[name], config.model, {"dx": 0.04, "max_step": 0.5, "order": 4}
    )


def test_results_depend_on_the_content_of_a_file_not_on_its_name_or_time(tmp_path, shipped):
    overlay, digests = tmp_path / "mine.yaml", []
    for name, text, seconds in (
        ("a.csv", TEXT, 1e9),
        ("b.csv", TEXT.replace("0.2", "2e-1"), 1.5e9),
        ("b.csv", TEXT.replace("0.2", "0.21"), 1.5e9),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
        os.utime(tmp_path / name, (seconds, seconds))
        overlay.write_text(OVERLAY.format(file=name), encoding="utf-8")
        digests.append(resolved_of(read_overlay(overlay), shipped))
    assert digests[0] == digests[1] != digests[2]


ROUGH = {"level": 0.4, "deviation": 0.1, "correlation_length": 1.0, "hurst": 0.5}
ROUGH |= {"start": -8.0, "stop": 8.0, "spacing": 0.1}
SWEEP = {"boundary": "displacement", "gamma": [0.5, 0.65], "duration": {"time": 1.0}}
SWEEP |= {"record": ["fronts"], "dx": [0.1]}
PROFILES = [
    {"rough": ROUGH | {"seed": [3, 5]}},
    {"points": [list(row) for row in POINTS]},
    {"points": [[-1.0, 0.5], [1.0, 0.3]], "width": 2.0, "bumps": [[4.0, 0.1, 1.0]]},
    {"left": 0.5, "right": 0.5},
]


def test_profiles_of_a_sweep_become_points_with_one_rough_profile_per_seed(shipped):
    sweep = resolved_of({"simulations": {"mine": SWEEP | {"profiles": PROFILES}}}, shipped)
    scenes, _ = expand(sweep)
    rough = [sp.Prestress.through(*sp.rough(**ROUGH, seed=seed), width=1.0) for seed in (3, 5)]
    tables = [sp.Prestress.through(*zip(*POINTS, strict=True))]
    tables.append(sp.Prestress.through([-1.0, 1.0], [0.5, 0.3], 2.0, bumps=((4.0, 0.1, 1.0),)))
    expected = [*rough, *tables, sp.Prestress(0.5, 0.5)]
    assert [scene.prestress for scene in scenes] == [one for one in expected for _ in range(2)]
    labels = profile_labels(sweep)
    assert [label["profile"] for label in labels] == [1, 1, 1, 1, 2, 2, 3, 3, 4, 4]
    assert [label["seed"] for label in labels[:5]] == pytest.approx(
        [3, 3, 5, 5, np.nan], nan_ok=True
    )
    chunk = profile_labels(sweep | {"chunk": [2, 2]})
    assert [label["profile"] for label in chunk] == [1, 1, 2, 3, 4]


def test_lists_of_a_rough_profile_give_all_combinations_with_the_seeds_fastest(shipped):
    lists = {"level": [0.3, 0.4], "hurst": [0.2, 0.5], "seed": {"from": 3, "to": 5}}
    sweep = resolved_of({"simulations": {"mine": profile_sweep({"rough": ROUGH | lists})}}, shipped)
    expected = [
        {**ROUGH, "level": level, "hurst": hurst, "seed": seed}
        for level in (0.3, 0.4)
        for hurst in (0.2, 0.5)
        for seed in (3, 4, 5)
    ]
    scenes, _ = expand(sweep)
    for scene, background in zip(scenes[::2], expected, strict=True):
        assert scene.prestress == sp.Prestress.through(*sp.rough(**background), width=1.0)
    assert run_count(sweep) == len(scenes) == 24
    labels = profile_labels(sweep)
    assert [label["profile"] for label in labels] == [*np.repeat([1, 2, 3, 4], 6)]
    # The checks before a run take the first and the last seed of each ensemble.
    seeds = [
        profile["rough"]["seed"]
        for profile in ExpandedProfiles(with_ends_of_lists(sweep)["profiles"])
    ]
    assert seeds == [3, 5] * 4


def test_a_range_of_seeds_is_a_list_of_them(shipped):
    scenes = []
    for seeds in ([3, 4, 5], {"from": 3, "to": 5}):
        sweep = profile_sweep({"rough": ROUGH | {"seed": seeds}})
        scenes.append(expand(resolved_of({"simulations": {"mine": sweep}}, shipped))[0])
    assert scenes[0] == scenes[1]


def test_the_runs_of_a_long_range_are_counted_without_making_their_profiles(shipped):
    sweep = profile_sweep({"rough": ROUGH | {"seed": {"from": 0, "to": 10**12}}})
    resolved = resolved_of({"simulations": {"mine": sweep}}, shipped)
    assert run_count(resolved) == 2 * (10**12 + 1)


def profile_sweep(*profiles: dict) -> dict:
    """Return a simulation with these profiles, on blocks that resolve them."""
    return SWEEP | {"profiles": [*profiles], "dx": [0.02]}


def test_profiles_without_a_table_have_no_labels(shipped):
    sweep = resolved_of({"simulations": {"mine": SWEEP | {"profiles": PROFILES[3:]}}}, shipped)
    assert profile_labels(sweep) == []
    assert set(sweep["profiles"][0]) == {"left", "right", "width", "peak", "steps", "bumps"}


def test_a_scene_is_sampled_as_far_as_its_fronts_can_go(shipped):
    """Beyond a ramp, the front speed is that of the last level."""
    common = {"title": "t", "boundary": "displacement", "gamma": 0.65, "duration": 20.0}
    profile = {"points": [[0.0, 0.8], [1.0, 0.3]], "width": 1.0, "damping_ratio": 0.0}
    left = {"points": [[-1.0, 0.3], [0.0, 0.3]], "width": 1.0, "damping_ratio": 0.0}
    for given, expected in (
        (profile, 20.0 / 0.6 + 3.0),
        (left, 20.0 / np.sqrt(1.0 - 0.3**2) + 3.0),
        # With a large damping ratio the front is much faster than at a ratio of 1.
        (
            left | {"damping_ratio": None, "beta": 0.05},
            20.0 * sp.theory.front_speed(0.3, 5.0) + 3.0,
        ),
        (left | {"damping_ratio": None, "beta": 0.005}, 20.0 / 0.7 + 3.0),
    ):
        config = read_config(shipped, [{"scenes": {"mine": common | given}}])
        simulation = scene_simulation(config.scenes["mine"], config.model, 0.01)
        assert simulation.samples.extent == pytest.approx(expected, rel=1e-3)
