"""A layer in SI units: its scales, its scenes and runs, and the paper's dimensional results."""

import dataclasses
import json
import math

import numpy as np
import pytest

import slippulse as sp
from slippulse.data.readable_units import readable_unit
from slippulse.data.variables import VARIABLES as NAMES
from slippulse.model.measured_columns import RECORD_FOR
from slippulse.model.run import Run
from slippulse.model.si_quantities import QUANTITIES, UNITS
from slippulse.prediction import predicted_front, predicted_pulse, predicted_transition

BLOCK = sp.Layer(
    0.02,
    2e9,
    poisson_ratio=0.3,
    density=1200.0,
    static_friction=0.6,
    kinetic_friction=0.5,
    normal_stress=5e6,
)
TOPS = ("held", "stress")
# A stress that reaches static friction, 3 MPa, only around x = 0.
X = np.linspace(-0.3, 0.3, 121)
STRESS = 2.7e6 + 0.35e6 * np.exp(-0.5 * (X / 0.02) ** 2)
DURATION, DX = 45e-6, 1e-3


def random_layers(count=5):
    random, layers = np.random.default_rng(3), []
    for _ in range(count):
        kinetic = random.uniform(0.0, 0.7)
        layer = sp.Layer(
            10.0 ** random.uniform(-3.0, 3.0),
            10.0 ** random.uniform(6.0, 11.0),
            poisson_ratio=random.uniform(-0.9, 0.49),
            density=random.uniform(500.0, 8000.0),
            static_friction=kinetic + random.uniform(0.01, 0.3),
            kinetic_friction=kinetic,
            normal_stress=10.0 ** random.uniform(4.0, 9.0),
            top=TOPS[random.integers(2)],
        )
        layers.append(layer)
    return layers


def changed(**values):
    return dataclasses.replace(BLOCK, **values)


@pytest.fixture(scope="module", params=TOPS)
def ruptured(request):
    """A layer, a scene under it, and its run with samples."""
    layer = changed(top=request.param)
    # Without leaf springs nothing may hold a positive stress: it ends in a negative one.
    stress = STRESS if request.param == "held" else STRESS - 0.4e6 * (np.abs(X) > 0.05)
    scene = layer.scene((X, stress), DURATION, DX, damping_ratio=0.1)
    samples = layer.samples(np.linspace(0.0, DURATION, 7), np.linspace(-0.1, 0.1, 9))
    return layer, scene, sp.simulate(scene, samples)


@pytest.mark.parametrize("layer", random_layers())
def test_the_scales_make_every_term_of_the_equation_of_motion_one(layer):
    """The terms of the mean equation of motion (appendix A) are divided by the strength drop."""
    scales, modulus = layer.scales, layer.longitudinal_modulus
    fraction = 0.5 if layer.top == "held" else 1.0
    inertia = fraction * layer.density * layer.thickness * scales.slip / scales.time**2
    strain = fraction * modulus * layer.thickness * scales.slip / scales.length**2
    springs = layer.shear_modulus * scales.slip / layer.thickness
    assert inertia == pytest.approx(layer.strength_drop, rel=1e-12)
    assert strain == pytest.approx(layer.strength_drop, rel=1e-12)
    if layer.top == "held":
        assert springs == pytest.approx(layer.gamma * layer.strength_drop, rel=1e-12)
    poisson = layer.poisson_ratio
    assert layer.gamma == pytest.approx((1.0 - 2.0 * poisson) / (1.0 - poisson), rel=1e-12)
    assert scales.length / scales.time == pytest.approx(layer.wave_speed, rel=1e-12)


def test_only_slip_and_energy_scales_depend_on_the_top_of_the_layer():
    held, free = (changed(top=top).scales._asdict() for top in TOPS)
    ratios = {name: held[name] / free[name] for name in held}
    twice = {"slip", "slip_velocity", "slip_acceleration", "energy"}
    assert ratios == {name: 2.0 if name in twice else 1.0 for name in held}


def test_either_second_modulus_gives_the_same_layer():
    lame = 2.0 * 2e9 * 0.3 / (1.0 - 2.0 * 0.3)
    other = changed(poisson_ratio=None, lame_parameter=lame)
    assert other.scales == pytest.approx(BLOCK.scales, rel=1e-14)
    assert {BLOCK: 1}[changed()] == 1


def integrate_in_si(layer, x, stress, duration):
    """Return the slip of a layer by Euler-Cromer steps of its dimensional equation (appendix A)."""
    fraction, springs = (0.5, layer.shear_modulus) if layer.top == "held" else (1.0, 0.0)
    mass = fraction * layer.density * layer.thickness
    stiffness = fraction * layer.longitudinal_modulus * layer.thickness / (x[1] - x[0]) ** 2
    slip, velocity, sliding = np.zeros_like(x), np.zeros_like(x), np.zeros(x.shape, bool)
    step = 1e-3 * (x[1] - x[0]) / layer.wave_speed
    for _ in range(round(duration / step)):
        bent = np.zeros_like(x)
        bent[1:-1] = slip[2:] - 2.0 * slip[1:-1] + slip[:-2]
        traction = stress + stiffness * bent - springs / layer.thickness * slip
        sliding |= traction >= layer.static_friction * layer.normal_stress
        force = traction - layer.kinetic_friction * layer.normal_stress
        velocity += np.where(sliding, step * force / mass, 0.0)
        sliding &= velocity > 0.0
        velocity[~sliding] = 0.0
        slip += step * velocity
    return slip, velocity


@pytest.mark.parametrize("top", TOPS)
def test_a_run_in_si_units_solves_the_dimensional_equation(top):
    layer = changed(top=top)
    dx, duration = 5e-3, 20e-6
    x = dx * np.arange(-30, 31)
    stress = np.interp(x, X, STRESS)
    slip, velocity = integrate_in_si(layer, x, stress, duration)
    run = layer.to_si(sp.simulate(layer.scene((x, stress), duration, dx)))
    assert np.interp(x, run["x"], run["slip"]) == pytest.approx(slip, abs=2e-3 * slip.max())
    simulated = np.interp(x, run["x"], run["slip_velocity"])
    assert simulated == pytest.approx(velocity, abs=0.01 * velocity.max())


def test_a_run_converted_to_si_units_and_back_is_unchanged(ruptured):
    layer, scene, run = ruptured
    there = layer.to_si(run)
    back = layer.from_si(there)
    rounding = 4.0 * np.finfo(float).eps * (1.0 + layer.friction_ratio)
    for name in run.variables:
        largest = float(np.max(np.abs(np.nan_to_num(run[name]))))
        assert np.allclose(back[name], run[name], rtol=0.0, atol=rounding * largest, equal_nan=True)
        assert there[name].attrs["units"] == UNITS[QUANTITIES[name]]
        assert "units of" not in there[name].attrs["long_name"]
    again = layer.scene(
        np.transpose(json.loads(there.attrs["steps_and_bumps"])["points"]),
        there.attrs["duration"],
        there.attrs["dx"],
        damping_ratio=there.attrs["damping_ratio"],
    )
    points = np.array(scene.prestress.points)
    assert np.allclose(again.prestress.points, points, rtol=0.0, atol=rounding * np.max(points))
    returned = sp.Scene.from_attributes(back.attrs)
    for one in (again, returned):
        assert one.duration == pytest.approx(scene.duration, rel=rounding)
        assert one.dx == pytest.approx(scene.dx, rel=rounding)
        assert one.beta == pytest.approx(scene.beta, rel=rounding)
        assert (one.boundary, one.gamma) == (scene.boundary, scene.gamma)


def test_attributes_and_measured_numbers_are_in_si_units(ruptured):
    layer, _, run = ruptured
    there = layer.to_si(run)
    scales = layer.scales
    assert there.attrs["end_time"] == run.attrs["end_time"] * scales.time
    units = json.loads(there.attrs["units_of_attributes"])
    assert units["dx"] == "m" and units["left"] == "Pa" and "gamma" not in units
    assert there.attrs["left"] == pytest.approx(STRESS[0] if layer.top == "held" else 2.3e6)
    fraction = 0.5 if layer.top == "held" else 1.0
    mass = fraction * layer.density * layer.thickness * there.attrs["dx"]
    kinetic = 0.5 * mass * float((there["slip_velocity"] ** 2).sum())
    assert there.attrs["kinetic_energy"] == pytest.approx(kinetic, rel=1e-9)
    numbers, plain = sp.measure(there), sp.measure(run)
    assert numbers["transition_time"] == pytest.approx(
        plain["transition_time"] * scales.time, nan_ok=True
    )
    assert numbers["front_speed_right"] == pytest.approx(
        plain["front_speed_right"] * layer.wave_speed
    )
    assert numbers["largest_velocity"] == pytest.approx(
        plain["largest_velocity"] * scales.slip_velocity
    )
    assert not [name for name in numbers if name.startswith("trailing_edge")]
    # The scene has a table of stresses, so that the stresses on the paths of fronts are measured.
    for name in ("lowest_prestress_left", "lowest_prestress_right", "level_ahead_right"):
        in_pascal = layer.convert_to_si(plain[name], "stress")
        assert numbers[name] == pytest.approx(in_pascal, nan_ok=True)


def test_every_number_with_a_unit_is_converted():
    """Measured and predicted numbers have a unit, unless they are ratios."""
    without = {"gamma", "friction_ratio", "max_step", "damping_ratio", "rate_strengthening"}
    named = {name for name, text in NAMES.items() if "in units of" in text or "position" in text}
    assert named - {"steps_and_bumps"} - without <= {*QUANTITIES}
    ratios = {"transition_longest_wait", "slip_variation", "pulse_shape_deviation", "strain_left"}
    ratios |= {"lattice_noise", "sliding_at_once", "centre_velocity_share", "profile_change"}
    ratios |= {"largest_velocity_change", "energy_change"}
    assert {*RECORD_FOR} - ratios <= {*QUANTITIES}
    run = Run(
        "displacement", sp.Prestress(0.5, 0.5), 0.65, 0.05, 0.005, "total", {"law": "coulomb"}
    )
    crack = run._replace(boundary="stress", prestress=sp.Prestress(-0.5, 0.0), gamma=0.0)
    for module in (predicted_front, predicted_pulse, predicted_transition):
        for one in (run, crack):
            columns = module.predictions([one], {"fraction": 0.95}).columns
            assert {*columns} <= {*QUANTITIES}


@pytest.mark.parametrize("factor", [2.0**-6, 0.3, 128.0])
def test_a_thicker_layer_scales_lengths_and_times(factor):
    thicker = changed(thickness=factor * BLOCK.thickness)
    scenes = [
        BLOCK.scene((X, STRESS), DURATION, DX),
        thicker.scene((factor * X, STRESS), factor * DURATION, factor * DX),
    ]
    runs = [
        one.to_si(sp.simulate(scene)) for one, scene in zip((BLOCK, thicker), scenes, strict=True)
    ]
    small, large = runs
    for name, power in (("x", 1), ("release_time", 1), ("slip", 1), ("slip_velocity", 0)):
        scaled = factor**power * small[name].values
        assert np.allclose(
            large[name], scaled, rtol=1e-6, atol=1e-9 * np.nanmax(scaled), equal_nan=True
        )


@pytest.mark.parametrize("layer", random_layers())
def test_the_paper_prints_half_of_the_peak_velocity(layer):
    """Compare the numbers printed in section IV A with the exact numbers without damping."""
    layer = dataclasses.replace(layer, top="held")
    tau = 0.37
    stress = layer.convert_to_si(tau, "stress")
    results = sp.theory.layer_results(layer, stress)
    modulus, shear = layer.longitudinal_modulus, layer.shear_modulus
    speed = 1.0 / math.sqrt(1.0 - tau**2)
    lengths = layer.thickness * math.sqrt(modulus / (2.0 * shear)) * speed
    printed = {
        "transition_length": 2.0 * math.pi * lengths,
        "pulse_width": math.pi * tau * lengths,
        "pulse_peak_velocity": layer.strength_drop / math.sqrt(2.0 * shear * layer.density),
        "transition_time": math.pi * layer.thickness * math.sqrt(layer.density / (2.0 * shear)),
    }
    for name, value in printed.items():
        assert results.paper[name] == pytest.approx(value, rel=1e-9)
    ratio = results.exact / results.paper
    assert ratio["pulse_peak_velocity"] == pytest.approx(2.0, rel=1e-9)
    assert ratio["pulse_stress_drop"] == pytest.approx(2.0 * tau, rel=1e-9)
    assert ratio[["pulse_width", "pulse_slip", "front_speed_right"]].values == pytest.approx(1.0)
    assert "twice as large" in results.note["pulse_peak_velocity"]
    assert results.unit["pulse_peak_velocity"] == "m s-1"


def test_units_of_a_file(tmp_path):
    rows = [*zip(X, STRESS, strict=True)]
    for head, length, stress in (("m,Pa", 1.0, 1.0), ("mm,MPa", 1e-3, 1e6), ("", 1.0, 1.0)):
        file = tmp_path / "stress.csv"
        lines = ["x,stress", *([head] if head else [])]
        lines += [f"{x / length:.17g},{value / stress:.17g}" for x, value in rows]
        file.write_text("\n".join(lines))
        profile = BLOCK.scene(file, DURATION, DX).prestress
        expected = BLOCK.scene((X, STRESS), DURATION, DX).prestress
        assert np.allclose(profile.points, expected.points, rtol=1e-13, atol=1e-13)
    file.write_text("x,stress\nm,psi\n0,1\n1,1\n")
    with pytest.raises(ValueError, match="unit 'psi' of stress; allowed: Pa, kPa, MPa, GPa, bar"):
        BLOCK.scene(file, DURATION, DX)


REFUSED = {
    "shear_modulus: 0; allowed: a finite number and > 0": {"shear_modulus": 0},
    "poisson_ratio: 0.5; allowed: a finite number and > -1 and < 0.5": {"poisson_ratio": 0.5},
    "poisson_ratio: -1; allowed": {"poisson_ratio": -1},
    "static_friction: 0.5; allowed: a number above kinetic_friction = 0.5": {
        "static_friction": 0.5
    },
    "kinetic_friction: -0.1; allowed: a finite number and >= 0": {"kinetic_friction": -0.1},
    "normal_stress: nan; allowed: a finite number and > 0": {"normal_stress": math.nan},
    "top: 'free'; allowed: held, stress": {"top": "free"},
    "lame_parameter and poisson_ratio; allowed: one of the two": {"lame_parameter": 1e9},
    "lame_parameter, poisson_ratio: missing; allowed: one": {"poisson_ratio": None},
    "lame_parameter: -1400000000.0; allowed: a finite number and > -1333333333": {
        "poisson_ratio": None,
        "lame_parameter": -1.4e9,
    },
    "allowed: numbers of a size that real materials have": {"thickness": 1e-300},
}


@pytest.mark.parametrize("line", REFUSED)
def test_a_layer_is_refused_in_one_line(line):
    with pytest.raises(ValueError) as refused:
        changed(**REFUSED[line])
    assert line in str(refused.value) and "\n" not in str(refused.value)


STRESSES_REFUSED = {
    "at least 3.7e+06 Pa everywhere; allowed: somewhere below static friction": STRESS + 1e6,
    "-3.3e+06 Pa; allowed: > -3e+06 Pa, which is minus static friction, since": STRESS - 6e6,
    "at most 2950000 Pa at a block; allowed: at least static friction (3e+06 Pa)": STRESS - 1e5,
    "last value 3.2e+06 Pa; allowed: below static friction": STRESS + 5e5 * (X > 0.2),
    "stresses: nan; allowed: a finite number": np.where(X > 0.1, np.nan, STRESS),
    "as many stresses": STRESS[:-1],
}


@pytest.mark.parametrize("line", STRESSES_REFUSED)
def test_a_stress_is_refused_in_one_line_in_pascal(line):
    with pytest.raises(ValueError) as refused:
        BLOCK.scene((X, STRESSES_REFUSED[line]), DURATION, DX)
    assert line in str(refused.value) and "\n" not in str(refused.value)


CALLS = {
    "position 0.295 m in row 2; allowed: >= 0.3 m": lambda: BLOCK.scene(
        (X[::-1], STRESS), DURATION, DX
    ),
    "at most 2700000 Pa at a block; allowed: at least static friction": lambda: BLOCK.scene(
        2.7e6, DURATION, DX
    ),
    "duration_in_seconds: 0; allowed": lambda: BLOCK.scene((X, STRESS), 0, DX),
    "gamma: 0.6; allowed: no value, since the layer or the arg": lambda: BLOCK.scene(
        (X, STRESS), DURATION, DX, gamma=0.6
    ),
    "beta: 0.1; allowed: none, since damping_ratio is given": lambda: BLOCK.scene(
        (X, STRESS), DURATION, DX, beta=0.1, damping_ratio=0.1
    ),
    "order: 99; allowed: 3, 4, 5, 6, 7, 8 (lengths are in units of 0.02 m": lambda: BLOCK.scene(
        (X, STRESS), DURATION, DX, order=99
    ),
    "peak_in_pascal: 3000000.0; allowed: none unless width_in_metres": lambda: BLOCK.scene(
        (X, STRESS), DURATION, DX, peak_in_pascal=3e6
    ),
    "run: 'int'; allowed: a Dataset": lambda: BLOCK.to_si(3),
    "layer.top: 'stress'; allowed: 'held'": lambda: sp.theory.layer_results(
        changed(top="stress"), 2.7e6
    ),
    "initial_stress: 3000000.0; allowed: a finite number and > 2500000 and < 3000000": lambda: (
        sp.theory.layer_results(BLOCK, 3e6)
    ),
}


@pytest.mark.parametrize("line", CALLS)
def test_a_call_is_refused_in_one_line(line):
    with pytest.raises(ValueError) as refused:
        CALLS[line]()
    assert line in str(refused.value) and "\n" not in str(refused.value)


def test_a_run_of_another_layer_is_refused(ruptured):
    layer, _, run = ruptured
    other = dataclasses.replace(layer, poisson_ratio=0.2)
    if layer.top == "held":
        with pytest.raises(ValueError, match=r"run: gamma: 0\.571.*allowed: 0\.749"):
            other.to_si(run)
    with pytest.raises(ValueError, match=r"layer\.poisson_ratio: 0\.2; allowed: 0\.\d+, as in the"):
        other.from_si(layer.to_si(run))
    with pytest.raises(ValueError, match="run: already in SI units; allowed: a run in the"):
        layer.to_si(layer.to_si(run))
    with pytest.raises(
        ValueError, match="run: not in SI units; allowed: a run that to_si returned"
    ):
        layer.from_si(run)
    in_millimetres = layer.to_si(run).assign_coords(x=layer.to_si(run)["x"] * 1e3)
    in_millimetres["x"].attrs["units"] = "mm"
    with pytest.raises(ValueError, match="run: units of x: 'mm'; allowed: 'm'"):
        layer.from_si(in_millimetres)


def test_a_run_of_a_sweep_is_converted_too(ruptured):
    layer, scene, run = ruptured
    sweep = sp.run_sweep([scene, scene], record=("fronts", "fields"))
    converted, expected = layer.to_si(sp.point(sweep, 1)), layer.to_si(run)
    assert np.array_equal(converted["slip"], expected["slip"])
    assert converted["release_time"].attrs["units"] == "s"
    with pytest.raises(ValueError, match="the function point takes one run out of a sweep"):
        layer.to_si(sweep)


def test_static_friction_starts_a_rupture_in_spite_of_rounding():
    for layer in random_layers(20):
        scene = layer.scene(
            layer.convert_to_si(0.3, "stress"),
            layer.scales.time,
            0.1 * layer.thickness,
            width_in_metres=layer.thickness,
            peak_in_pascal=layer.static_friction * layer.normal_stress,
        )
        assert scene.prestress.peak == 1.0
        assert scene.prestress(0.0) == 1.0


@pytest.mark.parametrize(
    ("quantity", "numbers", "text", "value"),
    [
        ("length", [0.2, -0.3], "mm", 1e-3),
        ("length", [1200.0, math.nan], "km", 1e3),
        ("time", [6e-5], "\N{MICRO SIGN}s", 1e-6),
        ("stress", [1e6], "MPa", 1e6),
        ("slip_velocity", [0.35], "mm/s", 1e-3),
        ("damping", [4.2e-4], "m\N{SUPERSCRIPT TWO}/s", 1.0),
        ("slip", [0.0], "m", 1.0),
        ("slip", [1e-30], "m", 1.0),
    ],
)
def test_units_have_a_readable_prefix(quantity, numbers, text, value):
    assert readable_unit(quantity, numbers) == (text, value)


def test_axes_have_the_units_of_the_run(ruptured):
    layer, _, run = ruptured
    figure = sp.plot(layer.to_si(run))
    labels = {axes.get_xlabel() for axes in figure.axes} | {figure.axes[0].get_ylabel()}
    assert {"stress (MPa)", "time $t$ (\N{MICRO SIGN}s)", "position $x$ (mm)"} <= labels
    assert any(label.startswith("slip $u$ (") for label in labels)
    slip = figure.axes[2].lines[0].get_xdata()
    assert np.max(slip) == pytest.approx(float(layer.to_si(run)["slip"].max()) * 1e6)
    plain = {axes.get_xlabel() for axes in sp.plot(run).axes}
    assert not any("(" in label for label in plain)
