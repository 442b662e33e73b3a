"""Wrong arguments of the library are refused in one line: the argument, its value, what is allowed."""

import math

import numpy as np
import pytest
import xarray as xr

import slippulse as sp
from slippulse import theory

PLAIN = sp.Prestress(0.5, 0.5)
GOOD = {"boundary": "stress", "prestress": PLAIN, "duration": 0.2, "dx": 0.1}
TINY = sp.Scene(**GOOD)
SWEEP = sp.run_sweep([TINY, TINY])
RUPTURE = theory.Rupture(PLAIN, 0.65, duration=4.0)
FRONTS = theory.Fronts(PLAIN, 0.1, "total", 3.0)
CRACK = theory.ArrestingCrack(sp.Prestress(-0.5, 0.0))
ATTRIBUTES = TINY.attributes()
FAR = sp.Prestress(0.5, 0.5, bumps=((1e9, 0.5, 1.0),))
# Whatever a number may not be, of functions that take one.
NO_NUMBERS = (
    None, "0.5", True, [], {}, object(), 1j, math.nan, math.inf, 10**400, [None], [[1.0], [2.0, 3.0]], b"bytes",
)  # fmt: skip
TAKE_A_NUMBER = {
    "Scene.dx": lambda x: sp.Scene(**GOOD | {"dx": x}),
    "Scene.duration": lambda x: sp.Scene(**GOOD | {"duration": x}),
    "Scene.beta": lambda x: sp.Scene(**GOOD, beta=x),
    "Scene.max_step": lambda x: sp.Scene(**GOOD, max_step=x),
    "Scene.order": lambda x: sp.Scene(**GOOD, order=x),
    "Prestress.left": lambda x: sp.Prestress(x, 0.0),
    "Prestress.peak": lambda x: sp.Prestress(0.0, 0.0, 1.0, x),
    "Prestress.bumps": lambda x: sp.Prestress(0.0, 0.0, bumps=((x, 0.1, 1.0),)),
    "settings_for.accuracy": lambda x: sp.settings_for(x, boundary="stress", prestress=PLAIN),
    "run_sweep.threads": lambda x: sp.run_sweep([TINY], threads=x),
    "point.index": lambda x: sp.point(SWEEP, x),
    "front_speed": lambda x: theory.front_speed(x, 0.1),
    "steady_pulse.gamma": lambda x: theory.steady_pulse(0.5, x, 0.01, 1.2),
    "paper_pulse.tau0": lambda x: theory.paper_pulse(x, 0.5),
    "lattice_front_speed.dx": lambda x: theory.lattice_front_speed(0.5, 0.5, x),
    "barrier_depth.tau_barrier": lambda x: theory.barrier_depth(0.5, x, 0.5),
    "uniform_transition_time.gamma": lambda x: theory.uniform_transition_time(0.5, x, 0.1),
    "Rupture.gamma": lambda x: theory.Rupture(PLAIN, x, duration=4.0),
    "ArrestingCrack.damping_ratio": lambda x: theory.ArrestingCrack(sp.Prestress(-0.5, 0.0), x),
    "Fronts.reach": lambda x: theory.Fronts(PLAIN, 0.1, "total", x),
    "stick_time": lambda x: RUPTURE.stick_time(x),
    "pulse_width": lambda x: RUPTURE.pulse_width(x, "left"),
    "integral": lambda x: PLAIN.integral(0.0, x),
}


def exact_scene(**changes):
    """A run of the exact solution."""
    scene = GOOD | {"boundary": "displacement", "gamma": 0.65, "scheme": "continuum"} | changes
    return sp.simulate(sp.Scene(**scene))


@pytest.mark.parametrize("name", TAKE_A_NUMBER)
def test_what_no_number_is_is_refused(name):
    call = TAKE_A_NUMBER[name]
    for value in NO_NUMBERS:
        # Arrays, an empty one too, are good where one number is.
        if isinstance(value, list) and value == [] and name in ("front_speed", "stick_time"):
            continue
        with pytest.raises((ValueError, TypeError)) as refusal:
            call(value)
        assert "; allowed: " in str(refusal.value) and "\n" not in str(refusal.value), (name, value)


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: sp.simulate(None), "scene: None; allowed: a Scene"),
        (lambda: sp.simulate({"boundary": "stress"}), "scene: {'boundary': 'stress'}; allowed: a Scene"),
        (lambda: sp.theory.front_speed("x", 0.1), "tau0: 'x'; allowed: finite numbers"),
        (lambda: sp.theory.prestress_for_speed(1.2, {}), "damping_ratio: {}; allowed: finite numbers"),
        (lambda: sp.run_sweep([]), "scenes: []; allowed: a list of Scenes, at least one"),
        (lambda: sp.run_sweep([TINY], record=("samples",)), "record: 'samples' without samples; allowed: Samples"),
        (lambda: sp.run_sweep([TINY], record=("x",)), "record: ('x',); allowed: a list of fronts, fields, samples"),
        (lambda: sp.Scene(**GOOD | {"boundary": "displacement", "gamma": 1e200}), "gamma: 1e+200"),
        (lambda: sp.point(SWEEP, -1), "index: -1; allowed: a whole number and >= 0 and <= 1"),
        (lambda: sp.point(SWEEP, 2), "index: 2; allowed: a whole number and >= 0 and <= 1"),
        (lambda: sp.point(sp.simulate(TINY), 0), "allowed: a Dataset that run_sweep returned"),
        (lambda: sp.point(xr.Dataset(), 0), "allowed: a Dataset that run_sweep returned"),
        (lambda: sp.point("x.nc", 0), "sweep: 'x.nc'; allowed: a Dataset"),
        (lambda: sp.point(SWEEP.assign(row_size=SWEEP["row_size"] + 1), 0), "allowed: numbers of blocks whose sum"),
        (lambda: sp.point(SWEEP.drop_vars("x"), 0), "allowed: numbers of blocks whose sum"),
        (lambda: sp.plot(SWEEP), "run: Dataset; allowed: a Dataset that simulate returned"),
        (lambda: sp.Scene.from_attributes(ATTRIBUTES | {"order": 4.7}), "order: 4.7; allowed: a whole number"),
        (lambda: sp.Scene.from_attributes(ATTRIBUTES | {"half_lattice": "no"}), "half_lattice: 'no'; allowed"),
        (lambda: sp.Scene.from_attributes(ATTRIBUTES | {"dx": "0.1"}), "dx: '0.1'; allowed: a finite number"),
        (lambda: sp.Scene.from_attributes(ATTRIBUTES | {"steps_and_bumps": "{"}), "steps_and_bumps: '{'; allowed"),
        (lambda: sp.Scene.from_attributes(3), "attributes: 3; allowed: a mapping"),
        (lambda: sp.Prestress(0.5, 0.6, steps=np.array(0.5)), "prestress.steps: array(0.5); allowed: a list of"),
        (lambda: theory.front_speed([0.1, 0.2], [0.1, 0.2, 0.3]), "shapes (2,) and (3,); allowed"),
        (lambda: theory.slip_velocity(FRONTS, 0.65, 0.0, math.nan), "time: nan; allowed"),
        (lambda: theory.slip_velocity(FRONTS, -1, 0.0, 1.0), "gamma: -1; allowed"),
        (lambda: CRACK.time_at(-100), "position: -100; allowed"),
        (lambda: FRONTS.reached(math.nan, 1), "time: nan; allowed"),
        (lambda: RUPTURE.map([math.nan], [0.0]), "times: nan; allowed: a finite number"),
        (lambda: sp.settings_for(1e-2, boundary="displacement", prestress=PLAIN, gamma=1e308), "gamma = 1e+308"),
        (lambda: sp.settings_for(1e-2, boundary="stress", prestress=PLAIN, fields=1), "fields: 1; allowed: true"),
        (lambda: exact_scene(beta=1e300), "damping_ratio: "),
        (lambda: exact_scene(duration=1e-300), "duration: 1e-300; allowed"),
        (lambda: sp.Scene(**GOOD | {"duration": 1e308}), "duration: 1e+308; allowed: a finite number and <= 9"),
        (lambda: exact_scene(dx=1e-9), "dx: 1e-09; allowed"),
        (lambda: exact_scene(prestress=FAR), "prestress.bumps reach: 1000000004.0; allowed"),
        (lambda: theory.barrier_depth(0.5, -1e-5, 0.65), "tau_barrier: -1e-05; allowed"),
        (lambda: theory.barrier_depth(1 - 1e-9, -0.5, 0.65), "front speed at tau0 = 0.999999999"),
        (lambda: theory.Rupture(PLAIN, 0.65, 1e200), "damping_ratio: 1e+200; allowed"),
        (lambda: theory.Rupture(PLAIN, 0.65, refinement=1000), "refinement: 1000; allowed: a whole number and >= 1"),
        (lambda: theory.Rupture(sp.Prestress(-1e308, 0.0), 0.65), "lowest prestress: -1e+308; allowed"),
        (lambda: theory.exact_transition_displacement(PLAIN, 1e-20, 0.1), "allowed: fronts that stay within 20000"),
        (lambda: CRACK.far_pulse(10**7), "count: 10000000; allowed: a whole number"),
    ],
)  # fmt: skip
def test_a_refusal_names_the_argument_its_value_and_what_is_allowed(call, named):
    with pytest.raises((ValueError, TypeError)) as refusal:
        call()
    assert named in str(refusal.value) and "\n" not in str(refusal.value)


# Changes of a scene and of a pre-stress, by how the refusal begins.
UNDER_STRESS = {"boundary": "stress", "gamma": 0.0}
OF_SCENES = {
    "boundary: 'strain'; allowed: displacement, stress": {"boundary": "strain"},
    "boundary: None; allowed: displacement, stress": {"boundary": None},
    "gamma: 0.65; allowed: 0 or left out under boundary 'stress'": UNDER_STRESS | {"gamma": 0.65},
    "gamma: nan; allowed: 0 or left out": UNDER_STRESS | {"gamma": math.nan},
    "gamma: 0.0; allowed: a finite number and > 0": {"gamma": 0.0},
    "gamma: '0.65'; allowed: a finite number": {"gamma": "0.65"},
    "gamma: inf; allowed: a finite number": {"gamma": math.inf},
    "beta: -0.001; allowed: a finite number and >= 0": {"beta": -1e-3},
    "beta: '1e-3'; allowed: a finite number": {"beta": "1e-3"},
    "dx: 0.0; allowed: a finite number and > 0": {"dx": 0.0},
    "prestress.width: 1.0; allowed: >= dx = 1.5": {"dx": 1.5},
    "duration: 0.0; allowed: a finite number and > 0": {"duration": 0.0},
    "duration: inf; allowed: a finite number": {"duration": math.inf},
    "release: 'Total'; allowed: total, elastic": {"release": "Total"},
    "scheme: 'euler'; allowed: localised, fixed_step": {"scheme": "euler"},
    "order: 2; allowed: 3, 4, 5, 6, 7, 8": {"order": 2},
    "order: 9; allowed: 3, 4, 5, 6, 7, 8": {"order": 9},
    "order: 4.0; allowed: a whole number": {"order": 4.0},
    "max_step: 0.0; allowed: a finite number and > 0": {"max_step": 0.0},
    "max_step: nan; allowed: a finite number": {"max_step": math.nan},
    "max_step: 2.0; allowed: <= ": {"max_step": 2.0},
    "friction_ratio: -0.1; allowed: a finite number and >= 0": {"friction_ratio": -0.1},
    "resolved_blocks: 0; allowed: a finite number and >= 1": {"resolved_blocks": 0},
    "resolved_blocks: 1.5; allowed: a whole number >= 1": {"resolved_blocks": 1.5},
    "half_lattice: 'no'; allowed: true or false": {"half_lattice": "no"},
    "prestress: 0.5; allowed: a Prestress": {"prestress": 0.5},
}
OF_PRESTRESSES = {
    "prestress.left: nan; allowed: a finite number": {"left": math.nan},
    "prestress.right: inf; allowed: a finite number": {"right": math.inf},
    "prestress.right: '0.3'; allowed: a finite number": {"right": "0.3"},
    "prestress.left: None; allowed: a finite number": {"left": None},
    "prestress.left: True; allowed: a finite number": {"left": True},
    "prestress.left: 1.2; allowed: a finite number and < 1": {"left": 1.2},
    "prestress.right: 1.0; allowed: a finite number and < 1": {"right": 1.0},
    "prestress.peak: nan; allowed: a finite number": {"peak": math.nan},
    "prestress.width: 0.0; allowed: a finite number and > 0": {"width": 0.0},
    "prestress.width: -1.0; allowed: a finite number and > 0": {"width": -1.0},
    "prestress.steps: position is 0.0; allowed: any other number": {"steps": ((0.0, 0.3),)},
    "prestress.steps: (1.0,); allowed: a list of [position, level]": {"steps": ((1.0,),)},
    "prestress.steps: 3.0; allowed: a list of [position, level]": {"steps": 3.0},
    "prestress.steps position: inf; allowed: a finite number": {"steps": ((math.inf, 0.1),)},
    "prestress.steps level: 1.2; allowed: a finite number and < 1": {"steps": ((30.0, 1.2),)},
    "prestress.bumps width: 0.0; allowed: a finite number and > 0": {"bumps": ((1.0, 0.1, 0.0),)},
    "prestress.bumps: (1.0, '0.1', 1.0); allowed: a list of [centre,": {"bumps": ((1.0, "0.1", 1.0),)},
    "prestress.bumps: 'abc'; allowed: a list of [centre, amplitude, width]": {"bumps": "abc"},
}


@pytest.mark.parametrize("begins", [*OF_SCENES, *OF_PRESTRESSES])
def test_what_a_scene_or_a_prestress_may_not_be(begins):
    with pytest.raises(ValueError) as refusal:
        if begins in OF_SCENES:
            good = {
                "boundary": "displacement",
                "prestress": PLAIN,
                "duration": 5.0,
                "dx": 0.01,
                "gamma": 0.65,
            }
            sp.Scene(**good | OF_SCENES[begins])
        else:
            sp.Prestress(**{"left": 0.3, "right": 0.3} | OF_PRESTRESSES[begins])
    assert str(refusal.value).startswith(begins) and "\n" not in str(refusal.value)


def test_a_rigid_rock_is_allowed():
    assert theory.damage_zone_stress_drop(2.0, 3.0, math.inf, 4.0, 5.0) == 1.5
