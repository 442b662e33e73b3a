"""A scene by name: its samples, figure, numbers beside theory, and page."""

import re
from types import SimpleNamespace

import matplotlib
import numpy as np
import pandas as pd
import pytest
import tolerances as tol
from matplotlib.collections import QuadMesh
from PIL import Image

import slippulse as sp
from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.plotting import space_time
from slippulse.plotting.style import COLOUR_CYCLE
from slippulse.prediction.comparison import measured_table
from slippulse_paper.configuration.expand import expand
from slippulse_paper.configuration.resolve import resolve, scene_simulation
from slippulse_paper.configuration.runs import runs
from slippulse_paper.configuration.schema import Model, NamedScene
from slippulse_paper.figures import scene_animation, user_defined_sweep
from slippulse_paper.figures import scene_figure as figure
from slippulse_paper.figures.scene_animation import FRAME_COUNT, save_animation
from slippulse_paper.steps import draw_scene, measure, predict, simulate, study_grid

TITLE = "A <scene> & its $title"
HELD = {"boundary": "displacement", "gamma": 0.65}
STRESS = {"boundary": "stress"}
SCENES = {
    "displacement": HELD | {"left": 0.6, "right": 0.6, "dx": 0.04, "duration": 40.0},
    "stress": STRESS | {"left": -0.75, "right": 0.0, "width": 2.0, "dx": 0.08, "duration": 25.0},
    "barrier": HELD | {"left": 0.5, "right": 0.2, "dx": 0.05, "duration": 15.0},
    "arrested at once": STRESS | {"left": -3.0, "right": -3.0, "dx": 0.05, "duration": 2.0},
}
SCENES["barrier"] |= {"bumps": [[10.0, -2.5, 1.0]], "damping_ratio": 0.0}
SCENES["arrested at once"]["width"] = 0.5
# A run as a picture, in one call.
PLAIN = sp.Scene("displacement", sp.Prestress(0.5, 0.4), 8.0, 0.05, 0.65, scheme="continuum")
SAMPLES = sp.Samples(np.linspace(0.0, 8.0, 41), np.linspace(-12.0, 12.0, 81))


def draw_one(shipped, folder, name, scene):
    """Run, measure and draw a scene as the rules do: its run, tables and files."""
    model, accuracy = Model.model_validate(shipped["model"]), shipped["presets"]["draft"]
    common = {"measure": shipped["measure"], "threads": 1}
    kinds = ("measured", "predicted", "uncertainties", "coarser")
    files = {kind: folder / f"{kind}.csv" for kind in kinds} | {"data": folder / "one.nc"}
    endings = ("numbers", "csv", "png", "pdf", "html")
    outputs = {ending: folder / f"one.{ending}" for ending in endings}
    named = NamedScene.model_validate(scene | {"title": TITLE})
    sweep = resolve(scene_simulation(named, model, accuracy["dx"]), model, accuracy)
    sweeps = {factor: sweep | {"coarser": factor} for factor in accuracy["coarser"]}
    settings = {"simulation": name, "sweep": sweep, "sweeps": sweeps} | common
    settings["solver"] = simulate.SOLVERS[settings["sweep"]["scheme"]]
    simulate.run({}, files, settings)
    measure.run(files, files, settings)
    predict.run({}, files, settings | shipped["measure"] | {"topics": predict.TOPICS})
    study_grid.run({"finest": files["measured"]}, files, settings)
    texts = {"scene": name, "title": TITLE, "altered": "", "layer": named.layer_parameters()}
    draw_scene.run(files, outputs, texts)
    numbers, table = load_table(outputs["numbers"]), load_table(outputs["csv"])
    run = sp.point(load_dataset(files["data"]), 0)
    return SimpleNamespace(run=run, numbers=numbers, table=table, outputs=outputs)


@pytest.fixture(scope="module")
def drawn(shipped, tmp_path_factory):
    folders = {name: tmp_path_factory.mktemp("scene") for name in SCENES}
    return {name: draw_one(shipped, folders[name], name, SCENES[name]) for name in SCENES}


LAYER = {"thickness": 100.0, "shear_modulus": 5.2e9, "poisson_ratio": 0.25, "density": 2300.0}
LAYER |= {"static_friction": 0.6, "kinetic_friction": 0.5, "normal_stress": 40e6, "top": "held"}
IN_SI = {"layer": LAYER, "left": 21.6e6, "right": 21.6e6, "duration": 0.6, "dx": 5.0}
IN_SI |= {"bumps": [[900.0, -0.2e6, 100.0]]}


def test_a_scene_with_a_layer_is_drawn_in_si_units(drawn, shipped, tmp_path, monkeypatch):
    scene, layer = draw_one(shipped, tmp_path, "zone", IN_SI), sp.Layer(**LAYER)
    roles = dict([*scene.table.groupby("role")])
    units = roles["unit"].set_index("series")["unit"]
    assert units.to_dict() == {
        "position": "km",
        "time": "ms",
        "stress": "MPa",
        "slip_velocity": "m/s",
        "slip": "mm",
    }
    run = layer.to_si(scene.run)
    released = run["release_time"].dropna("x")
    front = roles["front"].sort_values("position")
    times = np.interp(front["position"] * 1e3, released["x"], released)
    assert front["time"].to_numpy() * 1e-3 == pytest.approx(times, rel=1e-6, abs=1e-9)
    assert roles["largest"]["value"].iloc[0] == pytest.approx(
        float(run["sample_velocity"].max()), rel=1e-6
    )
    assert roles["prestress"]["value"].max() == pytest.approx(24.0)
    assert roles["strength"]["value"].tolist() == pytest.approx([20.0, 24.0])
    number = scene.numbers.set_index("quantity").loc["transition_time"]
    stick = sp.measure(scene.run)["transition_time"] * layer.scales.time
    assert (number["value"] * 1e-3, number["unit"]) == (pytest.approx(stick), "ms")
    peak = scene.numbers.set_index("quantity").loc["pulse_peak_velocity"]
    printed = layer.strength_drop / np.sqrt(2.0 * layer.shear_modulus * layer.density)
    assert peak["paper"] == pytest.approx(printed * (1.0 if peak["unit"] == "m/s" else 1e3))
    drawing = figure.draw(scene.table)
    labels = {axes.get_xlabel() for axes in drawing.axes}
    assert {"time $t$ (ms)", "position $x$ (km)", "stress (MPa)"} <= labels
    page = scene.outputs["html"].read_text(encoding="utf-8")
    for text in ("<td>600 ms</td>", "<td>21.6 MPa</td>", "bump of \N{MINUS SIGN}200 kPa and width"):
        assert text in page
    assert "The layer" not in drawn["barrier"].outputs["html"].read_text(encoding="utf-8")
    # Three frames show that it can be drawn in these units, too.
    monkeypatch.setattr(scene_animation, "FRAME_COUNT", 3)
    save_animation(scene.run, TITLE, tmp_path / "one.gif", layer)
    with Image.open(tmp_path / "one.gif") as film:
        assert film.n_frames == 3


@pytest.mark.parametrize("name", SCENES)
def test_samples_reach_beyond_the_fronts_and_the_figure_shows_them(drawn, name):
    scene, run = drawn[name], drawn[name].run
    slipped = run["x"].values[np.isfinite(run["release_time"].values)]
    first, last = run["sample_position"].values[[0, -1]]
    assert first < slipped[0] and last > slipped[-1]
    drawing = figure.draw(scene.table)
    assert scene.outputs["png"].stat().st_size > 20_000
    assert sum(map(bool, [axes.get_xlabel() + axes.get_ylabel() for axes in drawing.axes])) >= 4
    label = "velocity $\\dot u$ at the end"
    (profile,) = (axes for axes in drawing.axes if label in axes.get_ylabel())
    shown = profile.lines[1].get_ydata()
    assert np.max(shown) == pytest.approx(float(run["slip_velocity"].max()), rel=1e-8)
    texts = " ".join(text.get_text() for part in drawing.subfigs for text in part.texts)
    for label in scene.numbers["label"]:
        assert label.split("_")[0].strip("|") in texts
    assert texts.count("(theory ") == scene.numbers["theory"].notna().sum()


def test_the_pre_stress_goes_on_beyond_the_lattice(drawn):
    """The front stops inside the barrier, so the lattice ends there, and the level lies beyond."""
    run, table = drawn["barrier"].run, drawn["barrier"].table
    profile = table[table["role"] == "prestress"]
    position, value = profile["position"].to_numpy(), profile["value"].to_numpy()
    assert position[-1] > run["x"].values[-1] and run["prestress"].values[-1] < 0.0
    prestress = sp.Prestress(0.5, 0.2, bumps=((10.0, -2.5, 1.0),))
    # Positions are written to nine digits, and the barrier is steep.
    assert value == pytest.approx(prestress(position), rel=1e-6, abs=1e-6)
    assert position[np.argmax(value)] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_legend_of_the_map_lies_beside_a_rupture_to_either_side(drawn, sign):
    table = drawn["stress"].table
    table = table.assign(position=sign * table["position"])
    drawing = figure.draw(table)
    drawing.draw_without_rendering()
    (axes,) = (axes for axes in drawing.axes if axes.get_xlabel() == "time $t$")
    box = axes.get_legend().get_window_extent().transformed(axes.transData.inverted())
    front = table[table["role"] == "front"]
    is_covered = front["time"].between(box.x0, box.x1) & front["position"].between(box.y0, box.y1)
    assert not is_covered.any()


def test_numbers_agree_with_theory_where_there_is_one(drawn):
    numbers = drawn["displacement"].numbers.set_index("quantity")
    for quantity in ("front_speed_right", "transition_time", "pulse_peak_velocity", "pulse_slip"):
        row = numbers.loc[quantity]
        allowed = max(tol.SCENE_SHARE * row["theory"], 2.0 * row["uncertainty"])
        assert abs(row["value"] - row["theory"]) < allowed
    # A barrier leaves the transition without theory.
    numbers = drawn["barrier"].numbers.set_index("quantity")
    assert np.isnan(numbers["theory"].get("first_stick_time", np.nan))
    assert np.isfinite(numbers["theory"]["front_speed_left"])


@pytest.mark.parametrize(("name", "sides"), [("displacement", 2), ("barrier", 1), ("stress", 0)])
def test_each_side_with_a_pulse_has_the_line_of_its_own_steady_pulse(drawn, name, sides):
    """The barrier stops the right pulse, and no theory is that of a pulse under a held stress."""
    panels = [axes for axes in figure.draw(drawn[name].table).axes if "end" in axes.get_ylabel()]
    for axes in panels:
        lines = [line for line in axes.lines if line.get_gid() == "steady"]
        assert len(lines) == sides
        x, value = axes.lines[1].get_data()
        for line in lines:
            end = line.get_xdata()[1]
            assert line.get_xdata()[0] == 0.0 and abs(end) > 5.0
            far = (np.sign(x) == np.sign(end)) & (np.abs(x) > 5.0)
            assert value[far].max() == pytest.approx(line.get_ydata()[0], rel=0.05)


def test_a_left_pulse_that_has_stopped_has_no_line():
    barrier = sp.Prestress(0.5, 0.5, bumps=((-12.0, -3.0, 1.0),))
    run = sp.simulate(sp.Scene("displacement", barrier, 15.0, dx=0.1, gamma=0.65, beta=0.01))
    columns = figure.LARGEST_VALUE_COLUMNS.values()
    theory = {f"{prefix}{name}": 1.0 for prefix in ("exact_", "exact_left_") for name in columns}
    rows = figure.steady_rows(run, pd.Series(theory | {"pulse_state": "steady"}))
    assert len(rows) == 2 and (rows["position"] > 0.0).all()


@pytest.mark.parametrize("name", ["displacement", "barrier"])
def test_the_page_stands_alone_and_escapes_what_it_shows(drawn, name):
    scene, text = drawn[name], drawn[name].outputs["html"].read_text(encoding="utf-8")
    assert "A &lt;scene&gt; &amp; its $title" in text and "<scene>" not in text
    assert not re.search(r'(src|href)="(https?:|//|file:|/)', text)
    assert re.findall(r'<img src="(.{21})', text) == ["data:image/png;base64"]
    assert re.search(r'<img [^>]*alt="[^"]{40,}"', text) and '<html lang="en">' in text
    for label in scene.numbers["label"]:
        assert label in text


@pytest.mark.slow
def test_the_animation_runs_from_rest_to_the_end(drawn, tmp_path):
    save_animation(drawn["displacement"].run, TITLE, tmp_path / "scene.gif")
    with Image.open(tmp_path / "scene.gif") as film:
        assert film.n_frames == FRAME_COUNT
        first = np.asarray(film.convert("RGB"))
        film.seek(film.n_frames - 1)
        assert (np.asarray(film.convert("RGB")) != first).any()


SPRINGS = {"boundary": "displacement", "left": [0.5], "right": "same", "gamma": [0.65]}
GAMMAS, LEVELS, RATIOS = {"gamma": [0.3, 0.65]}, {"left": [0.4, 0.5]}, {"damping_ratio": [0.0, 0.1]}
# Lists, number of lines, and number of runs on each line.
SWEEPS = {
    "over gamma": (SPRINGS | GAMMAS, 1, 2),
    "over levels": ({"boundary": "stress", "left": [-1.0, -0.5], "right": [0.0]}, 1, 2),
    "one run": (SPRINGS, 1, 1),
    "over three": (SPRINGS | LEVELS | GAMMAS | RATIOS, 4, 2),
}


@pytest.mark.parametrize("name", SWEEPS)
def test_a_user_defined_sweep_is_drawn_whatever_varies(config, tmp_path, name):
    varied, lines, count = SWEEPS[name]
    sweep = varied | {"duration": {"time": 8.0}, "dx": [0.05], "record": ["fronts"]}
    resolved = resolve(sweep, config["model"], config["presets"]["draft"])
    scenes, samples = expand(resolved)
    measured = measured_table(sp.run_sweep(scenes, samples, sweep["record"]), config["measure"])
    predicted = predict.predictions(predict.TOPICS, [*runs(resolved)], config["measure"])
    table = user_defined_sweep.table({}, {name: measured.join(predicted)}, {})
    save_table(table, tmp_path / "sweep.csv")
    drawn = user_defined_sweep.draw(load_table(tmp_path / "sweep.csv"))
    speeds = drawn.axes[0]
    assert len(speeds.lines) == 3 * lines
    assert all(len(line.get_xdata()) == count for line in speeds.lines[::3])
    held = sweep["boundary"] == "displacement"
    assert drawn.get_suptitle().startswith(rf"$\Gamma = {int(held)}$")
    assert ("$b = " in drawn.get_suptitle()) is ("damping_ratio" not in varied)
    (legend,) = drawn.legends
    texts = [text.get_text() for text in legend.get_texts()]
    assert {"simulation", "exact theory"} <= {*texts}
    assert len(texts) >= (2 + lines if lines > 1 else 2)
    shown = [axes for axes in drawn.axes if axes.get_visible()]
    values = [tuple(np.round(axes.lines[1].get_ydata(), 9)) for axes in shown]
    assert len({*values}) == len(values), "no panel twice"
    assert len({axes.get_xlabel() for axes in shown}) == 1


def _texts_of_sweep(series):
    numbers = {"quantity": "q", "label": "label", "axis": "gamma", "x": 1.0, "fixed": "fixed"}
    columns = [*numbers, "series", "value", "theory", "run_flags"]
    rows = pd.DataFrame(
        [numbers | {"series": name, "value": 1.0} for name in series], None, columns
    )
    drawn = user_defined_sweep.draw(rows)
    (legend,) = drawn.legends
    return drawn.get_suptitle(), [text.get_text() for text in legend.get_texts()]


def test_a_sweep_without_measured_numbers_says_so():
    title, _ = _texts_of_sweep(series=[])
    assert title == "no run gives a number that this figure shows"


@pytest.mark.parametrize(("extra", "named"), [(0, len(COLOUR_CYCLE)), (1, 0)])
def test_the_legend_of_a_sweep_names_only_coloured_series(extra, named):
    series = [f"seed = {seed}" for seed in range(len(COLOUR_CYCLE) + extra)]
    assert _texts_of_sweep(series) == ("fixed", [*series[:named], "simulation"])


@pytest.mark.parametrize("samples", [None, SAMPLES], ids=["edges", "map"])
def test_fronts_trailing_edge_and_slip_are_drawn(samples):
    run = sp.simulate(PLAIN, samples)
    before = matplotlib.rcParams["font.size"]
    figure = sp.plot(run)
    assert matplotlib.rcParams["font.size"] == before
    _, times, slip = figure.axes[:3]
    lines = {line.get_label(): line for line in times.lines}
    releases = run["release_time"].values[np.isfinite(run["release_time"].values)]
    assert lines["front"].get_xdata() == pytest.approx(releases, abs=0.1)
    stick = run.attrs["first_stick_time"]
    assert np.nanmin(lines["trailing edge"].get_xdata()) == pytest.approx(stick, abs=0.01)
    assert np.max(slip.lines[0].get_xdata()) == pytest.approx(float(run["slip"].max()))
    assert bool(times.findobj(QuadMesh)) is (samples is not None)
    assert figure._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize("scheme", ["localised", "continuum"])
@pytest.mark.parametrize(
    ("gamma", "peak", "times", "positions"), [(0.65, 1.0, 0, 0), (0.0, 0.9, 1, 9), (0.0, 1.0, 5, 1)]
)
def test_every_run_is_drawn(scheme, gamma, peak, times, positions):
    boundary, prestress = "displacement" if gamma else "stress", sp.Prestress(-0.5, 0.0, peak=peak)
    scene = sp.Scene(boundary, prestress, 4.0, 0.1, gamma=gamma, scheme=scheme)
    samples = sp.Samples(np.linspace(0.0, 4.0, times), np.linspace(-3.0, 3.0, positions))
    assert sp.plot(sp.simulate(scene, samples))._repr_png_().startswith(b"\x89PNG")


def test_samples_in_any_order_and_repeated_samples_give_the_same_map():
    times, positions = np.linspace(0.0, 4.0, 9), np.linspace(-3.0, 3.0, 13)
    maps = []
    for given_times, given_positions in (
        (times, positions),
        (np.repeat(times, 2), np.append(positions[::-1], 0.0)),
    ):
        scene = sp.Scene("stress", sp.Prestress(-0.5, 0.3), 4.0, 0.1)
        figure = sp.plot(sp.simulate(scene, sp.Samples(given_times, given_positions)))
        (drawn_map,) = figure.axes[1].findobj(QuadMesh)
        maps.append(drawn_map.get_array())
    assert np.array_equal(*maps)


def test_a_scene_shows_its_parameters():
    html = PLAIN._repr_html_()
    for name, value in PLAIN.attributes().items():
        assert f"<th>{name}</th>" in html
        assert isinstance(value, str) or f"<td>{value}</td>" in html


def test_blocks_that_no_rupture_reaches_are_drawn_at_rest():
    """A barrier at x = 8 stops the two ruptures that begin at x = 0 and at x = 16."""
    barrier, second_nucleation = (8.0, -3.0, 1.0), (16.0, 0.65, 1.0)
    profile = sp.Prestress(0.4, 0.4, peak=1.1, bumps=(barrier, second_nucleation))
    run = sp.simulate(sp.Scene("displacement", profile, 8.0, 0.1, gamma=0.65, beta=0.01))
    for rows in space_time.edge_rows(run):
        at_barrier = rows.loc[abs(rows["position"] - 8.0) < 0.4, "time"]
        assert len(at_barrier) > 2 and at_barrier.isna().all()


def test_a_map_in_which_nothing_slides_can_be_drawn():
    pre_stress = sp.Prestress(0.5, 0.5, peak=0.9)
    scene = sp.Scene("displacement", pre_stress, duration=2.0, dx=0.1, gamma=0.6)
    run = sp.simulate(scene, sp.Samples(np.linspace(0.0, 2.0, 11), np.linspace(-5.0, 5.0, 21)))
    rows = space_time.velocity_rows(run).groupby("role")
    assert (rows.get_group("map")["value"] == 0.0).all()
    assert rows.get_group("largest")["value"].tolist() == [0.0]


def test_the_drawn_pre_stress_ends_with_the_drawn_positions():
    """The rupture stays on the right of x = 0."""
    profile = sp.Prestress(0.4, 0.4, peak=0.4, bumps=((20.0, 0.65, 1.0),))
    run = sp.simulate(sp.Scene("displacement", profile, 5.0, 0.1, gamma=0.65, beta=0.01))
    positions = space_time.prestress_rows(run)["position"]
    assert (positions.min(), positions.max()) == space_time.drawn_range(run)
    assert positions.min() > 0.0
