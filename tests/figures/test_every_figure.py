"""Every figure fits the journal, is labelled and finite; and what the figures of the paper show."""

import re
from itertools import product
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import tolerances as tol
from matplotlib.legend import Legend
from matplotlib.text import Text
from PIL import Image

from slippulse.figures.style import PAGE, save_figure
from slippulse.report.texts import read_captions

MODULES = Path(__file__).parents[2] / "src/slippulse/figures"
NAMES = sorted(path.stem for pattern in ("fig*.py", "study*.py") for path in MODULES.glob(pattern))
# The figures of the paper, and among the slow tests the studies.
DRAWN = [pytest.param(name, marks=() if name.startswith("fig") else pytest.mark.slow) for name in NAMES]
# Points, at the width of the journal.
SMALLEST = 7.0
UNLABELLED = {"fig01_system_sketch", "fig06_burridge_knopoff", "fig07_damage_zone"}
BOUNDARIES = ("displacement", "stress")


@pytest.mark.parametrize("name", NAMES)
def test_it_has_a_caption(project, name):
    assert sum(name.startswith("fig") for name in NAMES) == 11
    caption = read_captions(project / "manuscript/captions.yaml")[name]
    # What the report prints below its title; expressions stand for numbers and formulas.
    text = re.sub(r"{{.*?}}|\$.*?\$", " ", f"{caption.finding} {caption.caption}")
    assert 20 < len(re.findall(r"[^\W\d_][\w'-]+", text)) <= 120


@pytest.mark.parametrize("name", DRAWN)
def test_it_fits_a_page_and_its_axes_are_labelled(draw, name):
    figure = draw(name).figure
    width, height = figure.get_size_inches()
    assert width <= PAGE + 1e-9 and height <= 9.0
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes]
    labels.append(figure.get_supxlabel() + figure.get_supylabel())
    assert sum(bool(label) for label in labels) >= 2 or name in UNLABELLED


@pytest.mark.parametrize("name", DRAWN)
def test_what_is_drawn_is_finite_and_written(draw, tmp_path, name):
    drawn = draw(name)
    assert len(drawn.table) > 0
    # The resolution is not what is tested, and takes most of the time.
    drawn.figure.set_dpi(50)
    save_figure(drawn.figure, tmp_path / "first.png", tmp_path / "first.pdf")
    for ending in ("png", "pdf"):
        assert (tmp_path / f"first.{ending}").stat().st_size > 2000
    # As many grey levels as letters and lines have.
    with Image.open(tmp_path / "first.png") as picture:
        assert len(picture.convert("L").getcolors()) > 20
    assert not np.isinf(drawn.table.select_dtypes("number").to_numpy()).any()
    texts = [text for text in drawn.figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    assert min(text.get_fontsize() for text in texts) > SMALLEST - 1e-9
    page = drawn.figure.bbox.padded(1.0)
    for legend in drawn.figure.findobj(Legend):
        assert page.count_contains(legend.get_window_extent().get_points()) == 2, "cut off"


@pytest.mark.parametrize("name", ["fig03_steady_state", pytest.param("study_arrest", marks=pytest.mark.slow)])
def test_equal_tables_give_equal_bytes(draw, tmp_path, name):
    drawn = draw(name)
    with matplotlib.rc_context({"figure.dpi": 50}):
        for take in ("first", "again"):
            save_figure(drawn.module.plot(drawn.table), tmp_path / f"{take}.png", tmp_path / f"{take}.pdf")
    for ending in ("png", "pdf"):
        assert (tmp_path / f"first.{ending}").read_bytes() == (tmp_path / f"again.{ending}").read_bytes()


# Figures 3, 8 and 9


def curves(axes, kind: str) -> dict[str, np.ndarray]:
    """Drawn lines of one kind by run."""
    named = [line for line in axes.lines if (line.get_gid() or "").startswith(f"{kind} ")]
    return {line.get_gid().removeprefix(f"{kind} "): np.column_stack(line.get_data()) for line in named}


PULSES = ("fig03_steady_state", "fig08_steady_state_displacement", "fig09_steady_state_stress")


@pytest.mark.parametrize("name", PULSES)
def test_simulated_pulses_lie_on_the_exact_ones(draw, name):
    for axes in draw(name).figure.axes[:2]:
        simulated, exact = (curves(axes, kind) for kind in ("simulation", "exact"))
        assert simulated.keys() == exact.keys() and len(simulated) >= 4
        for run, curve in simulated.items():
            # The front's layer, a few blocks wide at this coarse lattice, is the difference.
            off = np.abs(curve[:, 1] - np.interp(curve[:, 0], *exact[run].T))
            assert np.median(off) < 0.03 * exact[run][:, 1].max()
            assert len(curve) <= 400 and len(exact[run]) <= 801


def test_undamped_pulses_are_the_papers_and_damping_lowers_them(draw):
    table = draw("fig08_steady_state_displacement").table
    runs = table[table["role"] == "run"].set_index("run")
    fields = ["slip", "slip_velocity", "slip_acceleration"]
    peaks = table[table["role"] == "exact"].groupby("run")[fields].max()
    undamped = runs.index[runs["damping_ratio"] == 0.0]
    assert peaks.loc[undamped].to_numpy() == pytest.approx(1.0, rel=1e-3)
    runs["peak"] = peaks["slip_velocity"]
    by_damping = runs.pivot(index="left", columns="damping_ratio", values="peak")
    assert (np.diff(by_damping.to_numpy(), axis=1) < 0.0).all()


def test_slip_never_falls_behind_the_front(draw):
    for curve in curves(draw("fig08_steady_state_displacement").figure.axes[0], "simulation").values():
        assert (np.diff(curve[:, 1]) <= 1e-5).all()


# Figure 4


def test_the_arrows_are_the_measured_transition(draw):
    drawn = draw("fig04_space_time")
    for boundary in BOUNDARIES:
        rows = drawn.table[drawn.table["panel"] == boundary]
        measured = rows[rows["role"] == "measured"].set_index("series")
        numbers = drawn.measured[f"space_time_{boundary}"].iloc[0]
        assert measured["time"].to_list() == pytest.approx([numbers["transition_time"]] * 2)
        length = measured.loc["right", "position"] - measured.loc["left", "position"]
        assert length == pytest.approx(numbers["transition_length"])
        # The fronts are there then.
        front = rows[rows["role"] == "front"].sort_values("position")
        times = np.interp(measured["position"], front["position"], front["time"])
        assert times == pytest.approx(measured["time"].to_numpy(), rel=0.02)


# Figures 5, 10 and 11


def offsets(axes, gid: str) -> np.ndarray:
    """Positions of the markers with a name."""
    found = [group.get_offsets() for group in axes.collections if group.get_gid() == gid]
    return np.ma.getdata(np.concatenate(found))


def test_every_run_is_drawn_in_the_collapse_in_two_colours(draw):
    drawn = draw("fig05_scaling")
    for index, (quantity, boundary) in enumerate(product(("length", "time"), BOUNDARIES)):
        axes, runs = drawn.figure.axes[index], drawn.measured[f"scaling_{boundary}"]
        sound = runs[runs["run_flags"].isna()]
        expected = np.sort(sound[f"transition_{quantity}"].dropna())
        drawn_at = offsets(axes, "runs")
        assert len(drawn_at) == len(sound)
        assert np.sort(drawn_at[np.isfinite(drawn_at).all(axis=1), 1]) == pytest.approx(expected, rel=1e-6)
        assert axes.get_xscale() == axes.get_yscale() == "log"
        (line,) = [line for line in axes.lines if line.get_gid() == "equality"]
        assert np.array_equal(line.get_xdata(), line.get_ydata())
        group = next(group for group in axes.collections if group.get_gid() == "runs")
        other = "gamma" if boundary == "displacement" else "width"
        assert len(np.unique(group.get_facecolors(), axis=0)) == sound["left"].nunique()
        assert len(np.unique(group.get_edgecolors(), axis=0)) == sound[other].nunique()


@pytest.mark.parametrize("name", ["fig05_scaling", "fig10_damping_displacement", "fig11_damping_stress"])
def test_lattices_tend_to_the_exact_transition(draw, name):
    table = draw(name).table
    runs = table[table["run_flags"].isna() & (table["boundary"] == "displacement")]
    for quantity in ("length", "time"):
        assert runs[quantity].to_numpy() == pytest.approx(runs[f"exact_{quantity}"], rel=tol.DRAFT_TRANSITION)
    stress = table[(table["boundary"] == "stress") & table["time"].notna()]
    assert (stress["time"] > stress["paper_time"]).all()


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_every_damping_ratio_is_drawn(draw, boundary):
    drawn = draw(f"fig{10 if boundary == 'displacement' else 11}_damping_{boundary}")
    ratios = np.sort(drawn.measured[f"damping_{boundary}"]["damping_ratio"].unique())
    assert 0.0 in ratios
    for axes in drawn.figure.axes[:2]:
        assert np.allclose(axes.get_xticks(), ratios)
        assert np.allclose(np.unique(offsets(axes, "runs")[:, 0]), ratios)


def test_damping_lengthens_the_transition(draw):
    runs = draw("fig10_damping_displacement").table
    off = (runs["length"] / runs["paper_length"] - 1.0).abs().groupby(runs["damping_ratio"]).median()
    assert off[1.0] > 2.0 * off[0.0]
