"""Inputs generated from the bounds of every key and from the signatures of the library: one clear line, or valid."""

from __future__ import annotations

import copy
import dataclasses
import math
import re
import resource
import signal
import warnings
from contextlib import contextmanager
from typing import get_args, get_origin

import numpy as np
import pytest
import xarray as xr
from pydantic import BaseModel

import slippulse as sp
from slippulse import theory
from slippulse.configuration.keys import Allowed
from slippulse.configuration.overlay import read_overlay
from slippulse.configuration.read import read_config
from slippulse.configuration.schema import Configuration
from slippulse.model.checks import ConfigError, short_repr

LONGEST_SECONDS, MOST_BYTES = 5.0, 1e9
SIMULATIONS = {
    "one": {
        "boundary": "displacement", "left": [0.5], "right": [0.6], "width": [1.0], "gamma": [0.65], "dx": [0.05],
        "damping_ratio": [0.1], "beyond": {"position": 9.0, "levels": [0.2]}, "duration": {"time": 5.0},
        "release": ["total"], "scheme": "localised", "friction_ratio": 5.0, "resolved_blocks": 1, "max_step": 0.3,
        "record": ["fronts", "samples"], "samples": {"times": 3, "positions": 2, "extent": 5.0}, "chunks": 1,
    },
    "two": {
        "boundary": "stress", "beta": [0.01], "duration": {"balance_distances": 2.0}, "record": ["fronts"],
        "spacing": {"scale": 2.0, "width_power": 0.5},
        "profiles": [{
            "left": -0.5, "right": 0.0, "width": 1.0, "peak": 1.0, "steps": [[-9.0, -0.6]], "bumps": [[3.0, 0.1, 1.0]],
        }],
    },
}  # fmt: skip
SCENE = {
    "title": "A title", "boundary": "displacement", "left": 0.5, "right": 0.5, "width": 1.0, "peak": 1.0,
    "steps": [[9.0, 0.2]], "bumps": [[14.0, -0.6, 1.0]], "gamma": 0.65, "damping_ratio": 0.1, "dx": 0.05,
    "release": "total", "scheme": "localised", "max_step": 0.3, "resolved_blocks": 1, "duration": 5.0,
}  # fmt: skip
# What no number is.
NO_NUMBERS = ("much", "1e-3", True, None, [], {}, [1.0], {"a": 1.0}, math.nan, math.inf, -math.inf)


@pytest.fixture(scope="module")
def small(project) -> dict:
    """The shipped configuration with two simulations and a scene that are checked at once."""
    config = read_overlay(project / "config/config.yaml")
    claims = config["claims"]
    return config | {
        "simulations": SIMULATIONS, "scenes": {"three": SCENE}, "claims": claims, "published": {}, "accuracy": 0.01,
        "allow_large": False,
    }  # fmt: skip


def leaves(annotation, marks, value, place=()):
    """Place, type and marks of every value of a configuration."""
    if get_origin(annotation) is not None and hasattr(annotation, "__metadata__"):
        marks = [*marks, *annotation.__metadata__]
        annotation = annotation.__origin__
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        for name, field in annotation.model_fields.items():
            name = field.alias or name
            if name in value:
                yield from leaves(field.annotation, field.metadata, value[name], (*place, name))
        return
    yield place, annotation, marks
    if get_origin(annotation) is dict:
        for name, entry in list(value.items())[:2]:
            yield from leaves(get_args(annotation)[1], [], entry, (*place, name))
    elif get_origin(annotation) is list and value:
        yield from leaves(get_args(annotation)[0], [], value[0], (*place, 0))


def bounds(marks) -> dict:
    """Bounds of a number, by name."""
    found = {}
    for mark in marks:
        for part in getattr(mark, "metadata", [mark]):
            found |= {name: getattr(part, name) for name in ("gt", "ge", "lt", "le") if hasattr(part, name)}
    return found


def cases(annotation, marks):
    """Values to try at a place, each with whether it must be refused (None: either is good)."""
    if annotation in (float, int):
        whole = annotation is int
        for name, bound in bounds(marks).items():
            outwards = -1.0 if name in ("gt", "ge") else 1.0
            beyond = bound + outwards * (1 if whole else max(1e-9, abs(bound) * 1e-9))
            inside = bound - outwards * (1 if whole else max(1e-9, abs(bound) * 1e-9))
            yield int(beyond) if whole else beyond, True
            yield bound, True if name in ("gt", "lt") else None
            yield int(inside) if whole else inside, None
        yield from ((value, True) for value in NO_NUMBERS)
        if whole:
            yield 2.5, True
        yield from ((value, None) for value in (1e308, -1e308, 5e-324, 10**400, -(10**400), 1e16))
        return
    kind = get_origin(annotation)
    wrong = {
        list: ("text", 0.5, {}, [], [[]], [None], ["a"], True, [0.1, 0.1]),
        dict: ("text", 0.5, [], True),
    }
    if kind is list:
        least = any(
            getattr(part, "min_length", 0) for mark in marks for part in getattr(mark, "metadata", [mark])
        )
        row = any(isinstance(mark, Allowed) and mark.text.startswith("[") for mark in marks)
        yield from (
            (value, None if (value == [] and not least) or (row and value == [0.1, 0.1]) else True)
            for value in wrong[list]
        )
        yield [0.1] * 2000, None
    elif kind is dict:
        yield from ((value, True) for value in wrong[dict])
        yield {"1": {}, "": {}, "a b": {}}, True
    elif annotation is bool:
        yield from ((value, True) for value in (0, 1, "true", "no", [], {}, math.nan, [True]))
    else:
        yield from (
            (value, True) for value in (0.5, True, [], {}, ["a", "a"], math.nan, "nonsense" if kind else 7)
        )
        if annotation is str:
            yield from ((value, None) for value in ("", "a\nb", "x" * 5000, "$(touch written)"))


def with_value(config, place, value):
    """Nested dicts and lists with another value at one place."""
    if not place:
        return value
    changed = copy.copy(config)
    changed[place[0]] = with_value(config[place[0]], place[1:], value)
    return changed


class Slow(BaseException):
    """A case that took too long."""


@contextmanager
def limited():
    """At most so many seconds of the processor."""

    def stop(*_):
        raise Slow

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, LONGEST_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def refusal_of(config, shipped) -> str:
    """The text of the refusal; empty where there is none. Anything else that is raised is a failure of the test."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read_config(config, shipped)
    except ConfigError as error:
        return str(error)
    return ""


def generated(small):
    """Place, value, and whether it must be refused; of the studies, whose types are few, every third."""
    for place, annotation, marks in leaves(Configuration, [], small):
        stride = 3 if place[:1] == ("studies",) else 1
        for value, refused in list(cases(annotation, marks))[::stride]:
            yield place, value, refused


def test_every_key_with_values_around_its_bounds(small):
    read_config(copy.deepcopy(small), small)
    tried, wrong, memory = 0, [], resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for place, value, refused in generated(small):
        config = with_value(small, place, value)
        try:
            with limited():
                said = refusal_of(config, small)
        except (Exception, Slow) as error:
            wrong.append((place, short_repr(value), f"{type(error).__name__}: {error}"))
            continue
        tried += 1
        if refused and not said and not (value is None and place[-1] != 0):
            wrong.append((place, short_repr(value), "accepted"))
        for line in said.splitlines():
            if len(line) > 400 or not re.search(r"allowed: |it is required|^\.\.\. and", line):
                wrong.append((place, short_repr(value), line[:400]))
    assert not wrong, f"{len(wrong)} of {tried}:\n" + "\n".join(str(case)[:500] for case in wrong[:40])
    assert tried > 1000
    assert 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory) < MOST_BYTES


def test_null_removes_an_optional_key_and_no_other(small):
    for place, *_ in leaves(Configuration, [], small):
        if 0 in place or len(place) < 2:
            continue
        config = with_value(small, place, None)
        said = refusal_of(config, small)
        assert not said or re.search("allowed: |it is required", said), (place, said)
        if not said:
            for part in place[:-1]:
                config = config[part]
            assert place[-1] not in config


PLAIN = sp.Prestress(0.5, 0.5)
GOOD = {"boundary": "stress", "prestress": PLAIN, "duration": 0.2, "dx": 0.1}
TINY = sp.Scene(**GOOD)
SWEEP = sp.run_sweep([TINY, TINY])
RUPTURE = theory.Rupture(PLAIN, 0.65, duration=4.0)
FRONTS = theory.Fronts(PLAIN, 0.1, "total", 3.0)
CRACK = theory.ArrestingCrack(sp.Prestress(-0.5, 0.0))
LAYER = theory.Layer(100.0, 2500.0, 1e10, 1e10, 0.7, 0.6, 1e7)
# A call and arguments that are good; each is replaced in turn by what it may not be.
CALLS = {
    "Prestress": (sp.Prestress, {
        "left": 0.1, "right": 0.1, "width": 1.0, "peak": 1.0, "steps": ((1.0, 0.2),), "bumps": ((1.0, 0.1, 1.0),),
    }),
    "Scene": (sp.Scene, GOOD | {
        "gamma": 0.0, "beta": 0.01, "release": "total", "scheme": "localised", "max_step": 0.2, "order": 4,
        "half_lattice": True, "friction_ratio": 5.0, "resolved_blocks": 8,
    }),
    "Scene with springs": (sp.Scene, GOOD | {"boundary": "displacement", "gamma": 0.65}),
    "Samples": (sp.Samples, {"times": [0.0, 0.1], "positions": [0.0, 1.0]}),
    "simulate": (sp.simulate, {"scene": TINY, "samples": sp.Samples([0.0], [0.0]), "progress": print}),
    "run_sweep": (sp.run_sweep, {"scenes": [TINY], "samples": None, "record": ("fronts",), "threads": 1}),
    "settings_for": (sp.settings_for, {
        "accuracy": 0.01, "boundary": "displacement", "prestress": PLAIN, "gamma": 0.5, "damping_ratio": 0.1,
        "release": "total",
    }),
    "lattice_front_speed": (sp.theory.lattice_front_speed, {"tau0": 0.5, "gamma": 0.5, "dx": 0.1}),
    "steady_pulse": (sp.theory.steady_pulse, {"tau0": 0.5, "gamma": 0.5, "beta": 0.01, "speed": 1.2}),
    "paper_pulse": (sp.theory.paper_pulse, {"tau0": 0.5, "gamma": 0.5}),
    "paper_transition_displacement": (sp.theory.paper_transition_displacement, {"tau0": 0.5, "gamma": 0.5}),
    "run_sweep with progress": (sp.run_sweep, {"scenes": [TINY], "progress": lambda done, total: None}),
    "simulate strictly": (sp.simulate, {"scene": TINY, "strict": False}),
    "point": (sp.point, {"sweep": SWEEP, "index": 0}),
    "front_speed_undamped": (theory.front_speed_undamped, {"tau0": 0.5}),
    "front_speed": (theory.front_speed, {"tau0": 0.5, "damping_ratio": 0.1, "release": "total"}),
    "prestress_for_speed": (theory.prestress_for_speed, {"speed": 1.2, "damping_ratio": 0.1, "release": "total"}),
    "continuum_front_speed": (theory.continuum_front_speed, {"tau0": 0.5, "gamma": 0.5, "beta": 0.1}),
    "steady_front": (theory.steady_front, {
        "speed": 1.2, "damping_ratio": 0.1, "springs": 0.5, "release": "total", "blocks": 20,
    }),
    "admissibility_table": (theory.admissibility_table, {
        "speeds": [1.2], "ratios": [0.1], "springs": [0.5], "release": "total",
    }),
    "barrier_depth": (theory.barrier_depth, {
        "tau0": 0.5, "tau_barrier": -0.5, "gamma": 0.5, "damping_ratio": 0.1, "release": "total",
    }),
    "barrier_depth_estimate": (theory.barrier_depth_estimate, {"tau0": 0.5, "tau_barrier": -0.5, "gamma": 0.5}),
    "uniform_transition_time": (theory.uniform_transition_time, {
        "tau0": 0.5, "gamma": 0.5, "damping_ratio": 0.1, "release": "total",
    }),
    "exact_transition_displacement": (theory.exact_transition_displacement, {
        "prestress": PLAIN, "gamma": 0.5, "damping_ratio": 0.1, "release": "total",
    }),
    "paper_transition_stress": (theory.paper_transition_stress, {"prestress": sp.Prestress(-0.5, 0.0)}),
    "prestress_balance_position": (theory.prestress_balance_position, {"prestress": sp.Prestress(-0.5, 0.0)}),
    "ArrestingCrack": (theory.ArrestingCrack, {
        "prestress": sp.Prestress(-0.5, 0.0), "damping_ratio": 0.1, "release": "total",
    }),
    "Fronts": (theory.Fronts, {
        "prestress": PLAIN, "damping_ratio": 0.1, "release": "total", "reach": 3.0, "gamma": 0.5,
    }),
    "Rupture": (theory.Rupture, {
        "prestress": PLAIN, "gamma": 0.5, "damping_ratio": 0.1, "release": "total", "duration": 4.0, "refinement": 1,
    }),
    "slip_velocity": (theory.slip_velocity, {"fronts": FRONTS, "gamma": 0.5, "y": 0.0, "time": 1.0}),
    "damage_zone_stress_drop": (theory.damage_zone_stress_drop, {
        "slip": 1.0, "shear_modulus": 1e9, "rock_shear_modulus": 3e10, "thickness": 100.0, "rock_thickness": 1e3,
    }),
    "integral": (PLAIN.integral, {"lower": 0.0, "upper": 1.0}),
    "profile": (theory.paper_pulse(0.5, 0.65).profile, {"xi": -0.5}),
    "Layer.prestress": (LAYER.prestress, {"shear_stress": 1e6}),
    "Layer.pulse_width": (LAYER.pulse_width, {"tau0": 0.5, "front_speed": 1.2}),
    "Layer.transition_length": (LAYER.transition_length, {"front_speed": 1.2}),
    "arrival": (FRONTS.arrival, {"x": 1.0}),
    "reached": (FRONTS.reached, {"time": 1.0, "sign": 1.0}),
    "time_at": (CRACK.time_at, {"position": -2.0}),
    "entry_for": (CRACK.entry_for, {"position": -2.0}),
    "share_time": (CRACK.share_time, {"share": 0.5}),
    "far_pulse": (CRACK.far_pulse, {"count": 10}),
    "release_time": (RUPTURE.release_time, {"x": 1.0}),
    "stick_time": (RUPTURE.stick_time, {"x": 1.0}),
    "final_slip": (RUPTURE.final_slip, {"x": 1.0}),
    "horizon": (RUPTURE.horizon, {"x": 1.0}),
    "fronts_at": (RUPTURE.fronts_at, {"time": 1.0, "x": 0.0}),
    "pulse_width": (RUPTURE.pulse_width, {"time": 1.0, "side": "left"}),
    "slip": (RUPTURE.slip, {"x": 1.0, "time": 1.0}),
    "strain": (RUPTURE.strain, {"x": 1.0, "time": 1.0}),
    "map": (RUPTURE.map, {"times": [1.0], "positions": [0.0], "fields": ("slip",)}),
}  # fmt: skip
VALUES = (
    None, "text", "0.5", "",
    True, np.True_, 2.5, [], {}, (), object(), 1j, math.nan, math.inf, -math.inf, -1.0, 0.0, -0.0, 5e-324, 1e-300,
    1e200, 1e308, -1e308, 10**400,
    [1.0, "a"], [None], [[1.0], [2.0, 3.0]], np.array([]), np.array([math.nan]), b"bytes",
    ("x",), ("samples",), ({},), 2**70,
)  # fmt: skip
# Of these, what comes back (but for a rest that never comes) is finite.
NUMBERS = {
    "tau0", "gamma", "beta", "speed", "damping_ratio", "springs", "blocks", "tau_barrier", "slip", "shear_modulus",
    "rock_shear_modulus", "thickness", "rock_thickness", "speeds", "ratios", "shear_stress", "front_speed", "position",
}  # fmt: skip


def numbers_of(found) -> list[float]:
    """The numbers in what a function returns, as far as it returns them as such."""
    if isinstance(found, list):
        found = [value for row in found for name, value in row.items() if name != "rest"]
    elif dataclasses.is_dataclass(found):
        found = [getattr(found, field.name) for field in dataclasses.fields(found)]
    return [value for value in np.atleast_1d(np.array(found, dtype=object)) if isinstance(value, float)]


ATTRIBUTES = TINY.attributes()
FAR = sp.Prestress(0.5, 0.5, bumps=((1e9, 0.5, 1.0),))


def exact_scene(**changes):
    """A run of the exact solution."""
    scene = GOOD | {"boundary": "displacement", "gamma": 0.65, "scheme": "continuum"} | changes
    return sp.simulate(sp.Scene(**scene))


# Large numbers of these make the quadratures of the front law long.
LARGE_IS_SLOW = {("settings_for", "gamma")}


@pytest.mark.parametrize("name", CALLS)
def test_every_argument_of_the_library(name):
    call, good = CALLS[name]
    wrong, memory = [], resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        call(**good)
        for key in good:
            for value in VALUES:
                large = isinstance(value, int | float) and abs(value) > 1e3
                if (
                    large
                    and (name, key) in LARGE_IS_SLOW
                    and not (isinstance(value, float) and math.isinf(value))
                ):
                    continue
                if large and key == "duration" and name == "Scene":
                    continue
                try:
                    with limited():
                        found = call(**good | {key: value})
                except (ValueError, TypeError) as error:
                    if not re.search(r"^[^\n]{1,300}$", str(error)) or "; allowed: " not in str(error):
                        wrong.append((key, short_repr(value), str(error)))
                except (Exception, Slow) as error:
                    wrong.append((key, short_repr(value), repr(error)))
                else:
                    accepted = value is None or isinstance(value, bool | str | bytes | dict | complex)
                    nonsense = accepted and not (key in ("samples", "progress") and value is None)
                    if nonsense and not (key in ("half_lattice", "progress", "strict") and value is True):
                        wrong.append((key, value, "accepted"))
                    if isinstance(value, float) and math.isnan(value):
                        wrong.append((key, value, "accepted"))
                    if key in NUMBERS and not np.all(np.isfinite(numbers_of(found))):
                        wrong.append((key, value, f"gives {found!r}"))
    assert not wrong, "\n".join(str(case)[:300] for case in wrong)
    assert 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory) < MOST_BYTES


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
        (lambda: theory.front_speed([0.1, 0.2], [0.1, 0.2, 0.3]), "shapes (2,) and (3,); allowed"),
        (lambda: theory.slip_velocity(FRONTS, 0.65, 0.0, math.nan), "time: nan; allowed"),
        (lambda: theory.slip_velocity(FRONTS, -1, 0.0, 1.0), "gamma: -1; allowed"),
        (lambda: CRACK.time_at(-100), "position: -100; allowed"),
        (lambda: FRONTS.reached(math.nan, 1), "time: nan; allowed"),
        (lambda: RUPTURE.map([math.nan], [0.0]), "times: nan; allowed: a finite number"),
        (lambda: sp.settings_for(1e-2, boundary="displacement", prestress=PLAIN, gamma=1e308), "gamma = 1e+308"),
        (lambda: exact_scene(beta=1e300), "damping_ratio: "),
        (lambda: exact_scene(duration=1e-300), "duration: 1e-300; allowed"),
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
def test_arguments_that_once_went_through(call, named):
    with pytest.raises((ValueError, TypeError)) as refusal:
        call()
    assert named in str(refusal.value) and "\n" not in str(refusal.value)


def test_a_rigid_rock_is_allowed():
    assert theory.damage_zone_stress_drop(2.0, 3.0, math.inf, 4.0, 5.0) == 1.5
