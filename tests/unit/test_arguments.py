"""Wrong arguments are refused in one line with the argument, its value and what is allowed."""

import math
import re
from fractions import Fraction
from functools import partial

import numpy as np
import pytest

import slippulse as sp
from slippulse import theory
from slippulse.model.stability import largest_step
from slippulse.solver.fixed_step import LATTICES

PLAIN = sp.Prestress(0.5, 0.5)
SECOND_BARRIER = sp.Prestress(-0.5, 0.0, steps=((2.0, -0.3), (3.0, 0.0)))
BARRIERS = sp.Prestress(0.5, 0.5, steps=((-4.0, 0.5), (-2.0, -0.5), (2.0, -0.5), (4.0, 0.5)))
GOOD = {"boundary": "stress", "prestress": PLAIN, "duration": 0.2, "dx": 0.1}
HELD = GOOD | {"boundary": "displacement", "gamma": 0.65}
GOOD_SETTINGS = {"accuracy": 1e-2, "boundary": "displacement", "prestress": PLAIN, "gamma": 0.65}
TINY, EXACT = sp.Scene(**GOOD), sp.Scene(**GOOD, scheme="continuum")
# By the exact solution, which takes no compiled kernels while tests are collected.
SWEEP = sp.run_sweep([EXACT, EXACT])
RUN = sp.point(SWEEP, 0)
RUPTURE = theory.Rupture(PLAIN, 0.65, duration=4.0)
CRACK = theory.ArrestingCrack(sp.Prestress(-0.5, 0.0))
FAR = sp.Prestress(0.5, 0.5, bumps=((1e9, 0.5, 1.0),))
# Values that are no number to a function that takes one.
NO_NUMBERS = [None, "0.5", True, [], {}, object(), 1j, math.nan, math.inf, np.float32("inf")]
NO_NUMBERS += [10**400, [None], [[1.0], [2.0, 3.0]], b"bytes"]

NUMBERS = ["dx", "duration", "gamma", "beta", "max_step", "order"]
NUMBERS += ["friction_ratio", "resolved_blocks"]
LEVELS = {"left": 0.0, "right": 0.0, "width": 1.0, "peak": 1.0}
# Arguments that are numbers, and functions of their value.
TAKE_A_NUMBER = [
    *((name, lambda x, name=name: sp.Scene(**HELD | {name: x})) for name in NUMBERS),
    *((f"prestress.{n}", lambda x, n=n: sp.Prestress(**LEVELS | {n: x})) for n in LEVELS),
    ("prestress.bumps", lambda x: sp.Prestress(0.0, 0.0, bumps=((x, 0.1, 1.0),))),
    ("accuracy", lambda x: sp.settings_for(x, boundary="stress", prestress=PLAIN)),
    ("threads", lambda x: sp.run_sweep([TINY], threads=x)),
    ("index", lambda x: sp.point(SWEEP, x)),
    ("tau0", lambda x: theory.front_speed(x, 0.1)),
    ("damping_ratio", lambda x: theory.lattice_front_speed(0.5, 0.5, 0.1, x)),
    ("gamma", lambda x: theory.steady_pulse(0.5, x, 0.01, 1.2)),
    ("damping_ratio", lambda x: theory.steady_pulse(0.5, 1.0, damping_ratio=x or str(x))),
    ("tau0", lambda x: theory.paper_pulse(x, 0.5)),
    ("dx", lambda x: theory.lattice_front_speed(0.5, 0.5, x)),
    ("tau_barrier", lambda x: theory.barrier_depth(0.5, x, 0.5)),
    ("gamma", lambda x: theory.uniform_transition_time(0.5, x, 0.1)),
    ("gamma", lambda x: theory.Rupture(PLAIN, x, duration=4.0)),
    ("damping_ratio", lambda x: theory.Rupture(PLAIN, 0.65, x)),
    ("damping_ratio", lambda x: theory.ArrestingCrack(sp.Prestress(-0.5, 0.0), x)),
    ("x", lambda x: RUPTURE.stick_time(x)),
    ("time", lambda x: RUPTURE.pulse_width(x, "left")),
]

linear = lambda alpha: {"friction": sp.friction("linear_rate", alpha=alpha)}
WITHOUT_SPRINGS = GOOD | {"gamma": 0.0}
# Values of the right type that are refused, by the part of the message that names them.
SCENES = {
    "boundary: 'strain'; allowed: displacement, stress": {"boundary": "strain"},
    "gamma: 0.65; allowed: 0 or left out under boundary 'stress'": {"boundary": "stress"},
    "gamma: 0.0; allowed: a finite number and > 0": {"gamma": 0.0},
    "beta: -0.001; allowed: a finite number and >= 0": {"beta": -1e-3},
    "dx: 0.0; allowed: a finite number and > 0": {"dx": 0.0},
    "dx: 1e+300; allowed: a finite number and > 0 and >= 1e-100 and <= 1e+40": {"dx": 1e300},
    "prestress.width: 1.0; allowed: >= dx = 1.5": {"dx": 1.5},
    "duration: 0.0; allowed: a finite number and > 0": {"duration": 0.0},
    "duration: 1e+308; allowed: a finite number and <= 9": WITHOUT_SPRINGS | {"duration": 1e308},
    "release: 'Total'; allowed: total, elastic": {"release": "Total"},
    "scheme: 'euler'; allowed: localised, fixed_step": {"scheme": "euler"},
    "order: 2; allowed: 3, 4, 5, 6, 7, 8": {"order": 2},
    "order: 4.0; allowed: a whole number": {"order": 4.0},
    "max_step: 0.0; allowed: a finite number and > 0": {"max_step": 0.0},
    "friction_ratio: -0.1; allowed: a finite number and >= 0": {"friction_ratio": -0.1},
    "resolved_blocks: 0; allowed: a whole number and >= 1": {"resolved_blocks": 0},
    "half_lattice: 'no'; allowed: a bool": {"half_lattice": "no"},
    "prestress: 0.5; allowed: a Prestress": {"prestress": 0.5},
    "friction: 0.5; allowed: a Friction": {"friction": 0.5},
    "dx: array([0.1, 0.2]); allowed: a finite number": {"dx": np.array([0.1, 0.2])},
    "friction.alpha: -1.62; allowed: > -2 sqrt(gamma) = -1.61245, since": linear(-1.62),
    "friction.alpha: -0.01; allowed: >= 0 without leaf springs, since": WITHOUT_SPRINGS
    | linear(-0.01),
}
for name in LATTICES:
    refusal = f"max_step: 9.0; allowed: <= {largest_step(name, 4, 0.0, 0.0065):.4g}"
    SCENES[refusal] = {"scheme": name, "max_step": 9.0}
SCENES["max_step: 0.2; allowed: <= "] = {"scheme": "fixed_step", "beta": 1e200}
LAWS = {
    "law: 'velocity'; allowed: coulomb, linear_rate": ("velocity", {}),
    "alpha: 0.1; allowed: no parameter with law 'coulomb'": ("coulomb", {"alpha": 0.1}),
    "nucleation: missing; allowed: d_c, nucleation with law 'slip_weakening'": (
        "slip_weakening",
        {"d_c": 0.1},
    ),
    "d_c: 0.0; allowed: a finite number": ("slip_weakening", {"d_c": 0.0, "nucleation": 1.0}),
    "slope: -1.0; allowed: a finite number": ("rate_weakening", {"slope": -1.0, "limit": 1.0}),
    "alpha: nan; allowed: a finite number": ("linear_rate", {"alpha": math.nan}),
}
EXACT_SCENES = {
    "damping_ratio: ": {"beta": 1e300},
    "duration: 1e-300; allowed": {"duration": 1e-300},
    "dx: 1e-09; allowed": {"dx": 1e-9},
    "prestress.bumps reach: 1000000004.0; allowed": {"prestress": FAR},
}
PRESTRESSES = {
    "prestress.left: 1.2; allowed: a finite number and < 1": {"left": 1.2},
    "prestress.width: 0.0; allowed: a finite number and > 0": {"width": 0.0},
    "prestress.steps: [0.0]; allowed: different positions": {"steps": ((0.0, 0.3),)},
    "prestress.steps: ((1.0,),); allowed: a list of [position, level]": {"steps": ((1.0,),)},
    "prestress.steps: 3.0; allowed: a list of [position, level]": {"steps": 3.0},
    "prestress.steps position: inf; allowed: a finite number": {"steps": ((math.inf, 0.1),)},
    "prestress.steps level: 1.2; allowed: a finite number and < 1": {"steps": ((30.0, 1.2),)},
    "prestress.bumps width: 0.0; allowed: a finite number and > 0": {"bumps": ((1.0, 0.1, 0.0),)},
    "prestress.bumps amplitude: '0.1'; allowed: a finite": {"bumps": ((1.0, "0.1", 1.0),)},
    "prestress.bumps: 'abc'; allowed: a list of [centre, amplitude, width]": {"bumps": "abc"},
}
ATTRIBUTES = {
    "order: 4.7; allowed: 3, 4, 5, 6, 7, 8": {"order": 4.7},
    "half_lattice: 'no'; allowed": {"half_lattice": "no"},
    "steps_and_bumps: '{'; allowed": {"steps_and_bumps": "{"},
    "friction: 0.5; allowed: a JSON object with a law": {"friction": 0.5},
    "friction: 'coulomb'; allowed: a JSON object with a law": {"friction": "coulomb"},
    "dx: '0.1'; allowed: a finite number": {"dx": "0.1"},
}
RUPTURES = {
    "gamma: -1.0; allowed: a finite number and >= 0": {"gamma": -1.0},
    "damping_ratio: 1000000000.0; allowed: a finite number and >=": {"damping_ratio": 1e9},
    "release: 'both'; allowed: total, elastic": {"release": "both"},
    "duration: 0.0; allowed: a finite number and >= 1e-09": {"duration": 0.0},
    "prestress: below 1 everywhere; allowed": {"prestress": sp.Prestress(0, 0, peak=0.9)},
    "prestress: 'flat'; allowed: a Prestress": {"prestress": "flat"},
    "lowest prestress: -1e+308; allowed": {"prestress": sp.Prestress(-1e308, 0.0)},
    "rate_strengthening: -1.62; allowed: > -2 sqrt(gamma) = -1.61245": {
        "rate_strengthening": -1.62
    },
    "-0.01; allowed: >= 0 without leaf springs, since": {"rate_strengthening": -0.01, "gamma": 0.0},
    "refinement: 0; allowed: a whole number and >= 1": {"refinement": 0},
}
SETTINGS = {
    "prestress level: 1e-09; allowed: levels of 0, or": {"prestress": sp.Prestress(1e-9, 0.5)},
    "accuracy: 0.5; allowed: a finite number and >= 0.0001 and <= 0.1": {"accuracy": 0.5},
    "damping_ratio: 3.0; allowed: a finite number and >= 0 and <= 1": {"damping_ratio": 3.0},
    "boundary: 'free'; allowed: displacement, stress": {"boundary": "free"},
    "release: 'both'; allowed: total, elastic": {"release": "both"},
    "gamma: 0.0; allowed: a finite number and > 0": {"gamma": 0.0},
    "gamma: 0.65; allowed: 0 or left out under boundary 'stress'": {"boundary": "stress"},
    "at gamma = 1e+308": {"gamma": 1e308},
    "fields: 1; allowed: true": {"fields": 1},
}
SAMPLES = {
    "samples.times: decreasing or negative; allowed: increasing": ([0.0, 2.0, 1.0], [0.0]),
    "decreasing or negative; allowed: increasing times >= 0": ([-0.1, 1.0], [0.0]),
    "samples.times: nan; allowed: a finite number": ([0.0, math.nan], [0.0]),
    "samples: times or positions are not one-dimensional; allowed: 1-d arrays": (
        [0.0, 1.0],
        0.0,
    ),
}

recorded_sweep = lambda name: sp.run_sweep([TINY], record=(name,))
FIELDS_ALONE = sp.run_sweep([EXACT], record=("fields",))
LONGER = SWEEP.assign(row_size=SWEEP["row_size"] + 1)
LATE = sp.Samples([0.1, 3.5], [0.0])
TOO_LATE = "samples.times: 3.5; allowed: up to the duration of the scene, 0.2"
LARGEST = "damping_ratio: -1.0; allowed: a finite number and >= 0 and <= 1e+100"
SLOW = "tau0: 0.3; allowed: > 0.50849, so that the front is faster"
# Further calls: part of the message, the function, and its arguments.
CALLS = [
    (TOO_LATE, sp.simulate, TINY, LATE),
    (TOO_LATE, sp.simulate, EXACT, LATE),
    (TOO_LATE, sp.run_sweep, [TINY], [LATE]),
    ("allowed: a sweep that was recorded with 'fronts'", sp.measure, FIELDS_ALONE),
    ("allowed: a Dataset that simulate returned", sp.measure, TINY),
    (
        "allowed: a run from which no block was removed",
        sp.measure,
        RUN.isel(x=slice(None, None, 2)),
    ),
    ("allowed: a run from which no block was removed", sp.measure, RUN.sel(x=slice(0.0, None))),
    ("allowed: a run from which no block was removed", sp.measure, RUN.sel(x=slice(0.5, None))),
    ("scene: None; allowed: a Scene", sp.simulate, None),
    ("scenes: []; allowed: a list of Scenes, at least one", sp.run_sweep, []),
    ("allowed: 'continuum' for all scenes, or for no scene", sp.run_sweep, [TINY, EXACT]),
    ("record: 'samples' without samples; allowed: Samples", recorded_sweep, "samples"),
    ("record: ('x',); allowed: a list of fronts, fields, samples", recorded_sweep, "x"),
    ("index: 2; allowed: a whole number and >= 0 and <= 1", sp.point, SWEEP, 2),
    ("allowed: a Dataset that run_sweep returned", sp.point, sp.simulate(EXACT), 0),
    ("sweep: 'x.nc'; allowed: a Dataset", sp.point, "x.nc", 0),
    ("allowed: numbers of blocks that fit into x", sp.point, LONGER, 0),
    ("allowed: numbers of blocks that fit into x", sp.point, SWEEP.drop_vars("x"), 0),
    ("run: a sweep; allowed: one run of the sweep, such as point(sweep, 0)", sp.plot, SWEEP),
    (
        "run: a sweep; allowed: one run of the sweep",
        sp.plot,
        sp.as_grid(SWEEP.isel(point=[0]), ["left"]),
    ),
    ("run: without slip; allowed: a run with these data; a sweep records them if", sp.plot, RUN),
    ("run: int; allowed: a Dataset that simulate returned", sp.plot, 3),
    ("attributes: 3; allowed: a mapping", sp.Scene.from_attributes, 3),
    ("x: 'a'; allowed: numbers", PLAIN, "a"),
    ("x: {}; allowed: numbers", PLAIN.level, {}),
    ("dx: 'x'; allowed: a finite number", sp.measure, RUN.assign_attrs(dx="x")),
    ("dx: None; allowed: a finite number", sp.plot, sp.simulate(EXACT).assign_attrs(dx=None)),
    ("releases: 'x'; allowed: a number", sp.measure, RUN.assign_attrs(releases="x")),
    ("tau0: 1.0; allowed: a finite number and > 0 and < 1", theory.front_speed, [0.5, 1.0], 0.1),
    (LARGEST, theory.front_speed, 0.5, -1.0),
    ("damping_ratio: inf; allowed: a finite number", theory.front_speed, 0.5, [0.1, math.inf]),
    ("release: 'other'; allowed: total, elastic", theory.front_speed, 0.5, 0.1, "other"),
    ("shapes (2,) and (3,); allowed", theory.front_speed, [0.1, 0.2], [0.1, 0.2, 0.3]),
    ("damping_ratio: {}; allowed: finite numbers", theory.prestress_for_speed, 1.2, {}),
    ("speed: 1.0; allowed: a finite number and > 1 and <", theory.prestress_for_speed, 1.0, 0.1),
    (SLOW, theory.lattice_front_speed, 0.3, 1.0, 1.0, 0.1),
    ("tau0: 0.33; allowed: > 0.336545, so that", theory.lattice_front_speed, 0.33, 0.5, 1.0, 3.0),
    ("tau0: 0.5; allowed: > 1", theory.lattice_front_speed, 0.5, 1e300, 1e300),
    (
        "tau0: 0.3; allowed: a higher pre-stress, at which",
        theory.continuum_front_speed,
        0.3,
        2.0,
        0.3,
    ),
    ("beta: 0.0; allowed", theory.continuum_front_speed, 0.3, 2.0, 0.0),
    ("position: -100; allowed", CRACK.time_at, -100),
    ("fraction: 1.0; allowed", CRACK.transition, 1.0),
    ("times: nan; allowed: a finite number", RUPTURE.map, [math.nan], [0.0]),
    ("time: 5.0; allowed: <= duration = 4", RUPTURE.slip, 0.0, 5.0),
    ("tau0: 1.0; allowed", theory.barrier_depth, 1.0, -0.1, 0.65),
    ("front speed at tau0 = 0.999999999", theory.barrier_depth, 1 - 1e-9, -0.5, 0.65),
    ("tau_barrier: 0.1; allowed", theory.barrier_depth, 0.5, 0.1, 0.65),
    ("tau_barrier: -1e-05; allowed", theory.barrier_depth, 0.5, -1e-5, 0.65),
    ("tau_barrier: 0.5; allowed", theory.barrier_depth_estimate, 0.5, 0.5, 0.65),
    ("tau0: 0.0; allowed", theory.uniform_transition_time, 0.0, 0.65),
    ("tau0: 1e-09; allowed: above about 1e-8", theory.paper_pulse, 1e-9, 0.65),
    ("weakening: 0.4, at tau0 = 0.5", theory.weakening_pulse, 0.5, 2 / 3, 0.05, 0.4),
    ("at most 20000 integration panels", theory.exact_transition_displacement, PLAIN, 1e-20, 0.1),
    ("prestress: changes its sign 3 times", theory.ArrestingCrack, SECOND_BARRIER, 0.1),
    ("prestress: not symmetric, or", theory.exact_transition_displacement, BARRIERS, 0.65, 0.1),
]
REFUSED = [(named, partial(function, *arguments)) for named, function, *arguments in CALLS]
for cases, call in (
    (SCENES, lambda change: sp.Scene(**HELD | change)),
    (EXACT_SCENES, lambda change: sp.simulate(sp.Scene(**HELD | {"scheme": "continuum"} | change))),
    (LAWS, lambda law: sp.friction(law[0], **law[1])),
    (PRESTRESSES, lambda change: sp.Prestress(**{"left": 0.3, "right": 0.3} | change)),
    (ATTRIBUTES, lambda change: sp.Scene.from_attributes(TINY.attributes() | change)),
    (RUPTURES, lambda change: theory.Rupture(**{"prestress": PLAIN, "gamma": 0.65} | change)),
    (SETTINGS, lambda change: sp.settings_for(**GOOD_SETTINGS | change)),
    (SAMPLES, lambda change: sp.Samples(*change)),
):
    REFUSED += [(named, partial(call, change)) for named, change in cases.items()]


@pytest.mark.parametrize(("argument", "call"), TAKE_A_NUMBER)
def test_an_argument_that_is_not_a_number_is_refused(argument, call):
    for value in NO_NUMBERS:
        # Arrays, an empty one too, are good where one number is.
        if isinstance(value, list) and not value and argument in ("tau0", "x"):
            continue
        # The number of threads is chosen if it is None.
        if value is None and argument == "threads":
            continue
        # Without a width there is no Gaussian at x = 0.
        if value is None and argument == "prestress.width":
            continue
        with pytest.raises((ValueError, TypeError)) as refusal:
            call(value)
        assert re.fullmatch(rf"{argument}[ \w]*: .*; allowed: .+", str(refusal.value)), value


@pytest.mark.parametrize(("named", "call"), REFUSED)
def test_a_refusal_names_the_argument_its_value_and_what_is_allowed(named, call):
    with pytest.raises((ValueError, TypeError)) as refusal:
        call()
    assert named in str(refusal.value) and "\n" not in str(refusal.value)


def test_an_exact_fraction_is_a_number():
    half = Fraction(1, 2)
    settings = GOOD_SETTINGS | {"gamma": half, "damping_ratio": half}
    expected = sp.settings_for(**GOOD_SETTINGS | {"gamma": 0.5, "damping_ratio": 0.5})
    assert sp.settings_for(**settings) == expected
    assert sp.Scene(**HELD | {"gamma": half, "dx": half}) == sp.Scene(
        **HELD | {"gamma": 0.5, "dx": 0.5}
    )
    with pytest.raises(ValueError, match=r"weakening: 0\.5, at tau0 = 0\.5"):
        theory.weakening_pulse(0.5, 2 / 3, 0.05, half)
