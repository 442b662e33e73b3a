"""Wrong arguments of the library are refused in one line: the argument, its value, what is allowed."""

import math
import re
from functools import partial

import numpy as np
import pytest
import xarray as xr

import slippulse as sp
from slippulse import theory

PLAIN = sp.Prestress(0.5, 0.5)
GOOD = {"boundary": "stress", "prestress": PLAIN, "duration": 0.2, "dx": 0.1}
HELD = GOOD | {"boundary": "displacement", "gamma": 0.65}
GOOD_SETTINGS = {"accuracy": 1e-2, "boundary": "displacement", "prestress": PLAIN, "gamma": 0.65}
TINY = sp.Scene(**GOOD)
SWEEP = sp.run_sweep([TINY, TINY])
RUPTURE = theory.Rupture(PLAIN, 0.65, duration=4.0)
FRONTS = theory.Fronts(PLAIN, 0.1, "total", 3.0)
CRACK = theory.ArrestingCrack(sp.Prestress(-0.5, 0.0))
FAR = sp.Prestress(0.5, 0.5, bumps=((1e9, 0.5, 1.0),))
# Whatever a number may not be, of functions that take one.
NO_NUMBERS = (
    None, "0.5", True, [], {}, object(), 1j, math.nan, math.inf, 10**400, [None], [[1.0], [2.0, 3.0]], b"bytes",
    np.float32("inf"),
)  # fmt: skip
OF_SCENES = (
    "dx",
    "duration",
    "gamma",
    "beta",
    "max_step",
    "order",
    "friction_ratio",
    "resolved_blocks",
)
# By the argument.
TAKE_A_NUMBER = [
    *((name, lambda x, name=name: sp.Scene(**HELD | {name: x})) for name in OF_SCENES),
    *(
        (
            f"prestress.{name}",
            lambda x, name=name: sp.Prestress(**{"left": 0.0, "right": 0.0} | {name: x}),
        )
        for name in ("left", "right", "width", "peak")
    ),
    ("prestress.bumps", lambda x: sp.Prestress(0.0, 0.0, bumps=((x, 0.1, 1.0),))),
    ("accuracy", lambda x: sp.settings_for(x, boundary="stress", prestress=PLAIN)),
    ("threads", lambda x: sp.run_sweep([TINY], threads=x)),
    ("index", lambda x: sp.point(SWEEP, x)),
    ("tau0", lambda x: theory.front_speed(x, 0.1)),
    ("damping_ratio", lambda x: theory.lattice_front_speed(0.5, 0.5, 0.1, x)),
    ("gamma", lambda x: theory.steady_pulse(0.5, x, 0.01, 1.2)),
    ("tau0", lambda x: theory.paper_pulse(x, 0.5)),
    ("dx", lambda x: theory.lattice_front_speed(0.5, 0.5, x)),
    ("tau_barrier", lambda x: theory.barrier_depth(0.5, x, 0.5)),
    ("gamma", lambda x: theory.uniform_transition_time(0.5, x, 0.1)),
    ("gamma", lambda x: theory.Rupture(PLAIN, x, duration=4.0)),
    ("damping_ratio", lambda x: theory.Rupture(PLAIN, 0.65, x)),
    ("damping_ratio", lambda x: theory.ArrestingCrack(sp.Prestress(-0.5, 0.0), x)),
    ("reach", lambda x: theory.Fronts(PLAIN, 0.1, "total", x)),
    ("x", lambda x: RUPTURE.stick_time(x)),
    ("time", lambda x: RUPTURE.pulse_width(x, "left")),
    ("upper", lambda x: PLAIN.integral(0.0, x)),
]


# What is refused where a number or a choice may be of the right kind, by the argument and its value.
SCENES = {
    "boundary: 'strain'; allowed: displacement, stress": {"boundary": "strain"},
    "boundary: None; allowed: displacement, stress": {"boundary": None},
    "gamma: 0.65; allowed: 0 or left out under boundary 'stress'": {"boundary": "stress"},
    "gamma: nan; allowed: 0 or left out": {"boundary": "stress", "gamma": math.nan},
    "gamma: 0.0; allowed: a finite number and > 0": {"gamma": 0.0},
    "gamma: 1e+200": {"gamma": 1e200},
    "gamma: 1e+250": {"gamma": 1e250, "beta": 1e200},
    "beta: -0.001; allowed: a finite number and >= 0": {"beta": -1e-3},
    "dx: 0.0; allowed: a finite number and > 0": {"dx": 0.0},
    "prestress.width: 1.0; allowed: >= dx = 1.5": {"dx": 1.5},
    "duration: 0.0; allowed: a finite number and > 0": {"duration": 0.0},
    "duration: 1e+308; allowed: a finite number and <= 9": GOOD | {"gamma": 0.0, "duration": 1e308},
    "release: 'Total'; allowed: total, elastic": {"release": "Total"},
    "scheme: 'euler'; allowed: localised, fixed_step": {"scheme": "euler"},
    "order: 2; allowed: 3, 4, 5, 6, 7, 8": {"order": 2},
    "order: 9; allowed: 3, 4, 5, 6, 7, 8": {"order": 9},
    "order: 4.0; allowed: a whole number": {"order": 4.0},
    "max_step: 0.0; allowed: a finite number and > 0": {"max_step": 0.0},
    "friction_ratio: -0.1; allowed: a finite number and >= 0": {"friction_ratio": -0.1},
    "resolved_blocks: 0; allowed: a finite number and >= 1": {"resolved_blocks": 0},
    "resolved_blocks: 1.5; allowed: a whole number >= 1": {"resolved_blocks": 1.5},
    "half_lattice: 'no'; allowed: true or false": {"half_lattice": "no"},
    "prestress: 0.5; allowed: a Prestress": {"prestress": 0.5},
}
EXACT_SCENES = {
    "damping_ratio: ": {"beta": 1e300},
    "duration: 1e-300; allowed": {"duration": 1e-300},
    "dx: 1e-09; allowed": {"dx": 1e-9},
    "prestress.bumps reach: 1000000004.0; allowed": {"prestress": FAR},
}
PRESTRESSES = {
    "prestress.left: 1.2; allowed: a finite number and < 1": {"left": 1.2},
    "prestress.right: 1.0; allowed: a finite number and < 1": {"right": 1.0},
    "prestress.width: 0.0; allowed: a finite number and > 0": {"width": 0.0},
    "prestress.steps: position is 0.0; allowed: any other number": {"steps": ((0.0, 0.3),)},
    "prestress.steps: (1.0,); allowed: a list of [position, level]": {"steps": ((1.0,),)},
    "prestress.steps: 3.0; allowed: a list of [position, level]": {"steps": 3.0},
    "prestress.steps: array(0.5); allowed: a list of": {"steps": np.array(0.5)},
    "prestress.steps position: inf; allowed: a finite number": {"steps": ((math.inf, 0.1),)},
    "prestress.steps level: 1.2; allowed: a finite number and < 1": {"steps": ((30.0, 1.2),)},
    "prestress.bumps width: 0.0; allowed: a finite number and > 0": {"bumps": ((1.0, 0.1, 0.0),)},
    "prestress.bumps: (1.0, '0.1', 1.0); allowed: a list of [centre,": {
        "bumps": ((1.0, "0.1", 1.0),)
    },
    "prestress.bumps: 'abc'; allowed: a list of [centre, amplitude, width]": {"bumps": "abc"},
}
ATTRIBUTES = {
    "order: 4.7; allowed: a whole number": {"order": 4.7},
    "half_lattice: 'no'; allowed": {"half_lattice": "no"},
    "dx: '0.1'; allowed: a finite number": {"dx": "0.1"},
    "steps_and_bumps: '{'; allowed": {"steps_and_bumps": "{"},
}
RUPTURES = {
    "gamma: -1.0; allowed: a finite number and >= 0": {"gamma": -1.0},
    "damping_ratio: 1000000000.0; allowed: a finite number and >= 0 and <= 1000000": {
        "damping_ratio": 1e9
    },
    "damping_ratio: 1e+200; allowed": {"damping_ratio": 1e200},
    "release: 'both'; allowed: total, elastic": {"release": "both"},
    "duration: 0.0; allowed: a finite number and >= 1e-09": {"duration": 0.0},
    "prestress: below 1 everywhere; allowed: a profile that": {
        "prestress": sp.Prestress(0, 0, peak=0.9)
    },
    "prestress: 'flat'; allowed: a Prestress": {"prestress": "flat"},
    "lowest prestress: -1e+308; allowed": {"prestress": sp.Prestress(-1e308, 0.0)},
    "refinement: 0; allowed: a whole number and >= 1": {"refinement": 0},
    "refinement: 2.7; allowed: a whole number and >= 1": {"refinement": 2.7},
    "refinement: 1000; allowed: a whole number and >= 1": {"refinement": 1000},
}
SETTINGS = {
    "accuracy: 0.5; allowed: a finite number and >= 0.0001 and <= 0.1": {"accuracy": 0.5},
    "accuracy: 1e-06; allowed: a finite number and >= 0.0001": {"accuracy": 1e-6},
    "damping_ratio: 3.0; allowed: a finite number and >= 0 and <= 1": {"damping_ratio": 3.0},
    "damping_ratio: -1.0; allowed: a finite number and >= 0": {"damping_ratio": -1.0},
    "boundary: 'free'; allowed: displacement, stress": {"boundary": "free"},
    "release: 'both'; allowed: total, elastic": {"release": "both"},
    "gamma: 0.0; allowed: a finite number and > 0": {"gamma": 0.0},
    "gamma: 0.65; allowed: 0 or left out under boundary 'stress'": {"boundary": "stress"},
    "at gamma = 1e+308": {"gamma": 1e308},
    "fields: 1; allowed: true": {"fields": 1},
}
SAMPLES = {
    "samples.times: not increasing or negative; allowed: increasing": ([0.0, 2.0, 1.0], [0.0]),
    "samples.times: not increasing or negative; allowed: increasing times >= 0": (
        [-0.1, 1.0],
        [0.0],
    ),
    "samples.times: nan; allowed: a finite number": ([0.0, math.nan], [0.0]),
    "samples: times and positions; allowed: one-dimensional": ([[0.0, 1.0]], [0.0]),
    "samples: times and positions; allowed: one-dimensional arrays": ([0.0, 1.0], 0.0),
    "samples.positions: inf; allowed: a finite number": ([0.0, 1.0], [math.inf]),
}
CALLS = [
    ("scene: None; allowed: a Scene", lambda: sp.simulate(None)),
    ("scene: {'boundary': 'stress'}; allowed: a Scene", lambda: sp.simulate({"boundary": "stress"})),
    ("scenes: []; allowed: a list of Scenes, at least one", lambda: sp.run_sweep([])),
    ("allowed: 'continuum' for all, or for none", lambda: sp.run_sweep([TINY, sp.Scene(**GOOD, scheme="continuum")])),
    ("record: 'samples' without samples; allowed: Samples", lambda: sp.run_sweep([TINY], record=("samples",))),
    ("record: ('x',); allowed: a list of fronts, fields, samples", lambda: sp.run_sweep([TINY], record=("x",))),
    ("index: -1; allowed: a whole number and >= 0 and <= 1", lambda: sp.point(SWEEP, -1)),
    ("index: 2; allowed: a whole number and >= 0 and <= 1", lambda: sp.point(SWEEP, 2)),
    ("allowed: a Dataset that run_sweep returned", lambda: sp.point(sp.simulate(TINY), 0)),
    ("allowed: a Dataset that run_sweep returned", lambda: sp.point(xr.Dataset(), 0)),
    ("sweep: 'x.nc'; allowed: a Dataset", lambda: sp.point("x.nc", 0)),
    ("allowed: numbers of blocks whose sum", lambda: sp.point(SWEEP.assign(row_size=SWEEP["row_size"] + 1), 0)),
    ("allowed: numbers of blocks whose sum", lambda: sp.point(SWEEP.drop_vars("x"), 0)),
    ("run: Dataset; allowed: a Dataset that simulate returned", lambda: sp.plot(SWEEP)),
    ("attributes: 3; allowed: a mapping", lambda: sp.Scene.from_attributes(3)),
    ("tau0: 0.0; allowed: a finite number and > 0 and < 1", lambda: theory.front_speed(0.0, 0.1)),
    ("tau0: 1.0; allowed: a finite number and > 0 and < 1", lambda: theory.front_speed([0.5, 1.0], 0.1)),
    ("damping_ratio: -1.0; allowed: a finite number and >= 0 and <= 1e+100", lambda: theory.front_speed(0.5, -1.0)),
    ("damping_ratio: 1e+200; allowed: a finite number", lambda: theory.front_speed(0.5, 1e200)),
    ("damping_ratio: inf; allowed: a finite number", lambda: theory.front_speed(0.5, [0.1, math.inf])),
    ("release: 'other'; allowed: total, elastic", lambda: theory.front_speed(0.5, 0.1, "other")),
    ("shapes (2,) and (3,); allowed", lambda: theory.front_speed([0.1, 0.2], [0.1, 0.2, 0.3])),
    ("damping_ratio: {}; allowed: finite numbers", lambda: theory.prestress_for_speed(1.2, {})),
    ("speed: 1.0; allowed: a finite number and > 1 and <= 1e+100", lambda: theory.prestress_for_speed(1.0, 0.1)),
    ("speed: 1e+200; allowed", lambda: theory.prestress_for_speed(1e200, 0.1)),
    ("tau0: 0.3; allowed: > 0.50849, values whose front outr", lambda: theory.lattice_front_speed(0.3, 1.0, 1.0, 0.1)),
    ("tau0: 0.33; allowed: > 0.336545, values", lambda: theory.lattice_front_speed(0.33, 0.5, 1.0, 3.0)),
    ("tau0: 0.5; allowed: > 1", lambda: theory.lattice_front_speed(0.5, 1e300, 1e300)),
    ("dx: 0.0; allowed", lambda: theory.lattice_front_speed(0.5, 1.0, 0.0)),
    ("gamma: 0.0; allowed", lambda: theory.lattice_front_speed(0.5, 0.0, 1.0)),
    ("tau0: 0.3; allowed: values whose front outruns", lambda: theory.continuum_front_speed(0.3, 2.0, 0.3)),
    ("beta: 0.0; allowed", lambda: theory.continuum_front_speed(0.3, 2.0, 0.0)),
    ("speed: 0.9; allowed: a finite number and > 1", lambda: theory.steady_front(0.9, 0.1)),
    ("damping_ratio: 1000.0; allowed", lambda: theory.steady_front(1.5, 1000.0)),
    ("time: nan; allowed", lambda: theory.slip_velocity(FRONTS, 0.65, 0.0, math.nan)),
    ("gamma: -1; allowed", lambda: theory.slip_velocity(FRONTS, -1, 0.0, 1.0)),
    ("time: nan; allowed", lambda: FRONTS.reached(math.nan, 1)),
    ("position: -100; allowed", lambda: CRACK.time_at(-100)),
    ("count: 10000000; allowed: a whole number", lambda: CRACK.far_pulse(10**7)),
    ("times: nan; allowed: a finite number", lambda: RUPTURE.map([math.nan], [0.0])),
    ("time: 5.0; allowed: <= duration = 4", lambda: RUPTURE.slip(0.0, 5.0)),
    ("tau0: 1.0; allowed", lambda: theory.barrier_depth(1.0, -0.1, 0.65)),
    ("front speed at tau0 = 0.999999999", lambda: theory.barrier_depth(1 - 1e-9, -0.5, 0.65)),
    ("tau_barrier: 0.1; allowed", lambda: theory.barrier_depth(0.5, 0.1, 0.65)),
    ("tau_barrier: -1e-05; allowed", lambda: theory.barrier_depth(0.5, -1e-5, 0.65)),
    ("gamma: 0.0; allowed", lambda: theory.barrier_depth(0.5, -0.1, 0.0)),
    ("tau_barrier: 0.5; allowed", lambda: theory.barrier_depth_estimate(0.5, 0.5, 0.65)),
    ("tau0: 0.0; allowed", lambda: theory.uniform_transition_time(0.0, 0.65)),
    ("allowed: fronts that stay within 20000", lambda: theory.exact_transition_displacement(PLAIN, 1e-20, 0.1)),
]  # fmt: skip
KINDS = (
    (SCENES, lambda change: sp.Scene(**HELD | change)),
    (EXACT_SCENES, lambda change: sp.simulate(sp.Scene(**HELD | {"scheme": "continuum"} | change))),
    (PRESTRESSES, lambda change: sp.Prestress(**{"left": 0.3, "right": 0.3} | change)),
    (ATTRIBUTES, lambda change: sp.Scene.from_attributes(TINY.attributes() | change)),
    (RUPTURES, lambda change: theory.Rupture(**{"prestress": PLAIN, "gamma": 0.65} | change)),
    (SETTINGS, lambda change: sp.settings_for(**GOOD_SETTINGS | change)),
    (SAMPLES, lambda change: sp.Samples(*change)),
)
CALLS += [
    (named, partial(call, change)) for cases, call in KINDS for named, change in cases.items()
]


@pytest.mark.parametrize(("argument", "call"), TAKE_A_NUMBER)
def test_what_no_number_is_is_refused(argument, call):
    for value in NO_NUMBERS:
        # Arrays, an empty one too, are good where one number is.
        if isinstance(value, list) and not value and argument in ("tau0", "x"):
            continue
        with pytest.raises((ValueError, TypeError)) as refusal:
            call(value)
        assert re.fullmatch(rf"{argument}[ \w]*: .*; allowed: .+", str(refusal.value)), value


@pytest.mark.parametrize(("named", "call"), CALLS)
def test_a_refusal_names_the_argument_its_value_and_what_is_allowed(named, call):
    with pytest.raises((ValueError, TypeError)) as refusal:
        call()
    assert named in str(refusal.value) and "\n" not in str(refusal.value)
