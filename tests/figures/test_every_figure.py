"""Every figure fits the journal and has labels, and the figures of the paper show runs."""

from itertools import combinations, product
from pathlib import Path
from string import ascii_lowercase

import numpy as np
import pandas as pd
import pytest
import tolerances as tol
from matplotlib.axis import Axis
from matplotlib.colors import to_rgba
from matplotlib.legend import Legend
from matplotlib.path import Path as Outline
from matplotlib.text import Text
from PIL import Image
from selection import small_sweep

from slippulse.measurement.regime import REGIMES
from slippulse.plotting.style import PAGE_WIDTH, colour_scale, save_figure
from slippulse_paper.configuration.runs import runs
from slippulse_paper.figures import fig02_phase_diagram as phases
from slippulse_paper.studies import pulse_profiles

MODULES = Path(__file__).parents[2] / "src/slippulse_paper/figures"
NAMES = sorted(path.stem for path in (*MODULES.glob("fig*.py"), *MODULES.glob("study*.py")))
# Studies are among the slow tests.
DRAWN = [name for name in NAMES if name.startswith("fig")]
DRAWN += [pytest.param(name, marks=pytest.mark.slow) for name in NAMES if name not in DRAWN]
# Points, at the width of the journal.
SMALLEST = 7.0
# Inches by which the boxes of two texts may overlap, since letters do not fill them.
TOUCHING = 0.012
UNLABELLED = {"fig01_system_sketch", "fig06_burridge_knopoff", "fig07_damage_zone"}
BOUNDARIES = ("displacement", "stress")
SHAPE = ["boundary", "role", "series", "regime"]
PULSES = ("fig03_steady_state", "fig08_steady_state_displacement", "fig09_steady_state_stress")


@pytest.mark.parametrize("name", DRAWN)
def test_it_fits_a_page_is_labelled_and_finite_and_no_two_texts_overlap(draw, tmp_path, name):
    table, figure = draw(name).table, draw(name).figure
    # At the width of the journal; the labels of two axes may meet in their corner.
    figure.draw_without_rendering()
    ticks, unseen = set(), set()
    for axis in figure.findobj(Axis):
        low, high = sorted(axis.get_view_interval())
        for tick in axis.get_major_ticks() + axis.get_minor_ticks():
            labels = {tick.label1, tick.label2}
            ticks |= labels
            unseen |= set() if low <= tick.get_loc() <= high else labels
    texts = {text for text in figure.findobj(Text) if text.get_visible() and text.get_text()}
    boxes = {text: text.get_window_extent() for text in texts - unseen}
    for (one, first), (other, second) in combinations(boxes.items(), 2):
        across = min(first.x1, second.x1) - max(first.x0, second.x0)
        upwards = min(first.y1, second.y1) - max(first.y0, second.y0)
        apart = min(across, upwards) <= TOUCHING * figure.dpi
        assert apart or {one, other} <= ticks, (one.get_text(), other.get_text())
    width, height = figure.get_size_inches()
    assert width <= PAGE_WIDTH + 1e-9 and height <= 9.0
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes]
    labels.append(figure.get_supxlabel() + figure.get_supylabel())
    assert sum(bool(label) for label in labels) >= 2 or name in UNLABELLED
    # Panels beside others have letters in the order of reading.
    letters = [*filter(None, (axes.get_title(loc="left") for axes in figure.axes))]
    assert letters or len(figure.axes) == 1
    assert letters == [f"({letter})" for letter in ascii_lowercase[: len(letters)]]
    assert len(table) > 0 and not np.isinf(table.select_dtypes("number").to_numpy()).any()
    # The resolution is not what is tested, and the layout is found: both take most of the time.
    figure.set_layout_engine("none")
    figure.set_dpi(50)
    save_figure(figure, tmp_path / "first.png", tmp_path / "first.pdf")
    assert all((tmp_path / f"first.{ending}").stat().st_size > 2000 for ending in ("png", "pdf"))
    # Letters and lines have more than 20 grey levels.
    with Image.open(tmp_path / "first.png") as picture:
        assert len(picture.convert("L").getcolors()) > 20
    assert min(text.get_fontsize() for text in texts if text.get_text().strip()) > SMALLEST - 1e-9
    page = figure.bbox.padded(1.0)
    for legend in figure.findobj(Legend):
        assert page.count_contains(legend.get_window_extent().get_points()) == 2, "cut off"


def holds(corners: np.ndarray, point: list[float]) -> bool:
    """Return True if a point is in an area, or on a line from the middle of the plane of levels."""
    if len(corners) > 2:
        return Outline(corners).contains_point(point, radius=1e-9)
    return (corners.sum(axis=0) * point).sum() > 0.0


def test_areas_and_lines_have_the_regime_that_the_runs_on_them_end_in(draw):
    drawn = draw("fig02_phase_diagram")
    shapes, compared = {}, 0
    for (boundary, role, _, regime), part in drawn.table.groupby(SHAPE):
        corners = part[["left", "right"]].to_numpy()
        shapes.setdefault((boundary, role), []).append((regime, corners))
    for run in pd.concat([drawn.measured[sweep] for sweep in phases.LEVEL_COUNTS]).itertuples():
        levels, on_line = [run.left, run.right], run.left * run.right == 0.0
        without_line = on_line and (max(levels) > 0.0 or levels == [0.0, 0.0])
        if run.exact_regime not in REGIMES or without_line:
            continue
        drawn_there = shapes[run.boundary, "line" if on_line else "area"]
        # The wedge of growing pulses lies upon the quadrant of cracks.
        shown = [regime for regime, corners in drawn_there if holds(corners, levels)][-1]
        assert shown == run.exact_regime, run
        compared += 1
    assert compared > 200


def test_runs_are_filled_where_they_end_as_theory_says_and_crossed_out_where_flagged(draw):
    drawn = draw("fig02_phase_diagram")
    runs = drawn.table[drawn.table["role"] == "run"].copy()
    runs.loc[runs.index[0], "run_flags"] = "energy"
    out = drawn.module.draw(pd.concat([drawn.table[drawn.table["role"] != "run"], runs]))
    marks = [line for axes in out.axes for line in axes.lines if line.get_gid() == "run"]
    assert len(marks) == len(runs)
    assert [mark.get_marker() for mark in marks].count("x") == runs["run_flags"].notna().sum() > 0
    sound = runs[runs["run_flags"].isna()]
    faces = {(*np.ravel(mark.get_xydata()), *to_rgba(mark.get_markerfacecolor())) for mark in marks}
    for run in sound.itertuples():
        early = run.exact_regime in REGIMES and run.exact_regime != run.regime
        colour = "white" if early else phases.LOOKS[run.regime][0]
        assert (run.left, run.right, *to_rgba(colour)) in faces
    assert set(phases.LOOKS) == set(REGIMES)
    for looks in zip(*phases.LOOKS.values(), strict=True):
        assert len(set(looks)) == len(REGIMES)


def test_equal_levels_end_alike_at_every_gamma_and_otherwise_without_leaf_springs(draw):
    drawn = draw("fig02_phase_diagram")
    runs = drawn.table[drawn.table["role"] == "symmetric"]
    marked = lambda axes: [line for line in axes.lines if line.get_gid() == "symmetric"]
    planes = list(filter(marked, drawn.figure.axes))
    for axes, boundary in zip(planes, BOUNDARIES, strict=True):
        rows = runs[runs["boundary"] == boundary]
        shown = sorted(tuple(np.ravel(mark.get_xydata())) for mark in marked(axes))
        assert shown == sorted(rows[["left", "gamma"]].itertuples(index=False, name=None))
        halves = {patch.get_x(): patch.get_gid() for patch in axes.patches}
        settled = rows[(rows["left"] != 0.0) & (rows["exact_regime"] == rows["regime"])]
        assert len(settled) >= 8
        expected = np.where(settled["left"] < 0.0, halves[-1.0], halves[0.0])
        assert settled["regime"].to_list() == list(expected)
    held = runs[(runs["boundary"] == "displacement") & (runs["left"] > 0.0)]
    assert held["gamma"].nunique() >= 4 and held["regime"].nunique() == 1
    lines = [line for axes in drawn.figure.axes for line in axes.lines]
    shown = [line for line in lines if line.get_gid() == "prestress"]
    assert len(shown) == len(phases.NUMBERS), "each velocity has its pre-stress"


def curves(axes, kind: str) -> dict[str, np.ndarray]:
    """Return the drawn lines of one kind by run."""
    prefix = f"{kind} "
    lines = [line for line in axes.lines if (line.get_gid() or "").startswith(prefix)]
    return {line.get_gid().removeprefix(prefix): line.get_xydata() for line in lines}


@pytest.mark.parametrize("name", PULSES)
def test_simulated_pulses_lie_on_the_exact_ones(draw, name):
    for axes in draw(name).figure.axes[:2]:
        simulated, exact = (curves(axes, kind) for kind in ("simulation", "exact"))
        assert simulated.keys() == exact.keys() and len(simulated) >= 4
        for run, curve in simulated.items():
            # The front's layer, a few blocks wide at this coarse lattice, is the difference.
            distance = np.abs(curve[:, 1] - np.interp(curve[:, 0], *exact[run].T))
            assert np.median(distance) < 0.03 * exact[run][:, 1].max()
            assert len(curve) <= 400 and len(exact[run]) <= 801


def test_undamped_pulses_are_the_papers_and_damping_lowers_them(draw):
    table = draw(PULSES[1]).table
    runs = table[table["role"] == "run"].set_index("run")
    fields = ["slip", "slip_velocity", "slip_acceleration"]
    peaks = table[table["role"] == "exact"].groupby("run")[fields].max()
    undamped = runs.index[runs["damping_ratio"] == 0.0]
    assert peaks.loc[undamped].to_numpy() == pytest.approx(1.0, rel=1e-3)
    runs["peak"] = peaks["slip_velocity"]
    by_damping = runs.pivot(index="left", columns="damping_ratio", values="peak")
    assert (np.diff(by_damping.to_numpy(), axis=1) < 0.0).all()


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


def drawn_runs(axes, runs: pd.DataFrame, quantity: str):
    """Return the markers of a panel and its sound runs, after checking that their heights agree."""
    (group,) = [group for group in axes.collections if group.get_gid() == "runs"]
    sound, heights = runs[runs["run_flags"].isna()], np.ma.getdata(group.get_offsets())[:, 1]
    measured = np.sort(sound[f"transition_{quantity}"].dropna())
    assert len(heights) == len(sound)
    assert np.sort(heights[np.isfinite(heights)]) == pytest.approx(measured, rel=1e-6)
    return group, sound


def test_every_run_is_drawn_in_the_collapse_in_two_colours(draw):
    drawn = draw("fig05_scaling")
    for index, (quantity, boundary) in enumerate(product(("length", "time"), BOUNDARIES)):
        axes = drawn.figure.axes[index]
        group, sound = drawn_runs(axes, drawn.measured[f"scaling_{boundary}"], quantity)
        assert axes.get_xscale() == axes.get_yscale() == "log"
        (line,) = [line for line in axes.lines if line.get_gid() == "equality"]
        assert np.array_equal(line.get_xdata(), line.get_ydata())
        other = "gamma" if boundary == "displacement" else "width"
        assert len(np.unique(group.get_facecolors(), axis=0)) == sound["left"].nunique()
        assert len(np.unique(group.get_edgecolors(), axis=0)) == sound[other].nunique()


@pytest.mark.parametrize(
    "name", ["fig05_scaling", "fig10_damping_displacement", "fig11_damping_stress"]
)
def test_lattices_tend_to_the_exact_transition(draw, name):
    table = draw(name).table
    runs = table[table["run_flags"].isna() & (table["boundary"] == "displacement")]
    for quantity in ("length", "time"):
        exact = pytest.approx(runs[f"exact_{quantity}"], rel=tol.DRAFT_TRANSITION)
        assert runs[quantity].to_numpy() == exact
    stress = table[(table["boundary"] == "stress") & table["time"].notna()]
    assert (stress["time"] > stress["paper_time"]).all()


def test_every_run_is_drawn_in_the_colour_of_its_damping_ratio_which_lengthens_the_transition(draw):
    drawn = [draw(name) for name in ("fig10_damping_displacement", "fig11_damping_stress")]
    for one, boundary in zip(drawn, BOUNDARIES, strict=True):
        runs = one.measured[f"damping_{boundary}"]
        ratios = np.sort(runs["damping_ratio"].unique())
        colours = {to_rgba(colour) for colour in colour_scale("damping_ratio").to_rgba(ratios)}
        assert 0.0 in ratios
        for axes, quantity in zip(one.figure.axes[:2], ("length", "time"), strict=True):
            group, _ = drawn_runs(axes, runs, quantity)
            assert {to_rgba(face) for face in group.get_facecolors()} == colours
            # The inset has the ratio against b, with lines of exact theory for a few levels.
            (inset,) = axes.child_axes
            groups = [group for group in inset.collections if group.get_gid() == "runs"]
            marks = np.concatenate([group.get_offsets() for group in groups])
            assert np.allclose(np.unique(marks[:, 0]), ratios)
            lines = [line for line in inset.lines if line.get_gid() == "exact"]
            assert len(lines) >= 2 and all(len(line.get_xdata()) == len(ratios) for line in lines)
    runs = drawn[0].table
    deviations = (runs["length"] / runs["paper_length"] - 1.0).abs()
    medians = deviations.groupby(runs["damping_ratio"]).median()
    assert medians[1.0] > 2.0 * medians[0.0]


@pytest.mark.parametrize("column", ["gamma", "damping_ratio"])
def test_one_value_of_a_parameter_is_enough_to_draw_the_influence_of_damping(draw, column):
    drawn = draw("fig10_damping_displacement")
    values = drawn.table[column]
    drawn.module.draw(drawn.table[values == values.min()]).draw_without_rendering()


def test_ensembles_in_which_no_pulse_dies_are_drawn(draw):
    drawn = draw("study_rough_prestress")
    without_deaths = drawn.table.assign(deaths=drawn.table["deaths"] * 0.0)
    figure = drawn.module.draw(without_deaths)
    figure.draw_without_rendering()
    assert "no pulse has died" in [text.get_text() for text in figure.axes[0].texts]


def test_the_survival_of_pulses_that_all_die_is_within_the_axes(draw):
    drawn = draw("study_rough_prestress")
    dying = drawn.table.assign(survival=0.1 * drawn.table["survival"])
    assert drawn.module.draw(dying).axes[0].get_ylim()[0] == 0.0


def test_the_misfits_of_a_bad_fit_are_within_the_axes(draw):
    drawn = draw("study_published_figure")
    bad = drawn.table.assign(pull=100.0 * drawn.table["pull"])
    low, high = drawn.module.draw(bad).axes[-1].get_ylim()
    pulls = bad[bad["part"] == "best"]["pull"] if "part" in bad else bad["pull"]
    assert low < pulls.min() and pulls.max() < high


def test_a_single_transition_is_not_hidden_by_an_inset(draw):
    drawn = draw("fig05_scaling")
    axes = drawn.module.draw(drawn.table.groupby("boundary", sort=False).head(1)).axes[0]
    assert np.divide(*axes.get_xlim()[::-1]) >= 9.9


def test_errors_without_any_sound_run_keep_their_entries_in_the_legend(draw):
    drawn = draw("study_exact_transition")
    flagged = drawn.table.assign(run_flags="died_out")
    figure = drawn.module.draw(flagged)
    figure.draw_without_rendering()
    (legend,) = figure.legends
    assert len(legend.get_texts()) == 4


@pytest.mark.parametrize("name", ["fig05_scaling", "fig10_damping_displacement"])
def test_a_collapse_without_any_transition_says_so(draw, name):
    drawn = draw(name)
    nothing = drawn.table.assign(length=np.nan, time=np.nan)
    figure = drawn.module.draw(nothing)
    figure.draw_without_rendering()
    assert [text.get_text() for text in figure.axes[0].texts] == [
        r"no run reaches $L_\text{trans}$"
    ]


def test_runs_without_an_exact_steady_pulse_are_left_out(shipped):
    sweep = small_sweep(shipped, "steady_displacement") | {"left": [-0.2, 0.3]}
    profiles = pulse_profiles.table({}, {}, {"sweeps": {"steady_displacement": sweep}})
    expected = [number for number, run in enumerate(runs(sweep)) if run.prestress.left > 0.0]
    assert [*profiles["run"].unique()] == expected
