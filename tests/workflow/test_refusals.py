"""Refusals of wrong input before any job: one line with the key, the value and what is allowed."""

import random
import re
import warnings
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest

from slippulse.model.cost import OPTION_TO_ALLOW
from slippulse_paper.configuration.drawn import drawing_problems
from slippulse_paper.configuration.limits import bound_of_sweep
from slippulse_paper.configuration.problems import ConfigError
from slippulse_paper.configuration.read import MAX_FILE_BYTES, read_config, read_overlay
from slippulse_paper.configuration.resolve import accuracy_of, all_simulations, resolve
from slippulse_paper.steps.needs import declared, needs_of

# These shipped simulations serve every case, so that a refusal of scenes is quick.
KEPT = ["steady_displacement", "space_time_displacement", "space_time_stress"]
KEPT += ["burridge_knopoff_stress", "steady_stress"]
# Each case has an overlay and texts that its refusal must contain.
MISTAKES = read_overlay(Path(__file__).with_name("refusals.yaml"))
LONG_NAME = {"simulations": {"a" * 900: {}}}
MISTAKES["name of 900 letters"] = {"overlay": LONG_NAME, "refusal": ["'aaaa", "..."]}
MANY = [0.001 * i for i in range(1, 801)]
GRID, SAMPLES = {"left": MANY, "gamma": MANY}, {"times": 100_000, "positions": 100_000}
# Changes of simulations whose cost is then too high, and words of the refusal.
EXPENSIVE = {
    "many runs": ("steady_displacement", GRID, "1.92e+06 runs; allowed: 2e+04"),
    "long duration": ("steady_displacement", {"duration": {"time": 1e6}}, "allowed: 4e+13"),
    "many samples": ("space_time_stress", {"samples": SAMPLES}, "bytes"),
    "few chunks": ("steady_displacement", GRID | {"chunks": 3}, "6.4e+05 runs in each of 3 chunks"),
    "many chunks": ("steady_displacement", GRID | {"chunks": 1000}, "1000 chunks; allowed: 1e+03"),
}
# Values of the command line, and their refusals.
COMMAND_LINE_VALUES = {
    "word for a switch": ({"allow_large": "maybe"}, "allow_large: 'maybe'; allowed: true or false"),
    "number for a switch": ({"allow_large": "2"}, "allow_large: 2; allowed: true or false"),
    "word for a number": ({"model": {"damping_ratio": "much"}}, "'much'; allowed: a number >= 0"),
    "number for a preset": ({"preset": "01"}, "preset: '01'; allowed: draft, paper, reference"),
    "anchor": ({"preset": "&a"}, "preset: '&a'; allowed: a plain value"),
}
# Files that are not overlays.
FILES = {
    "text": (b"just some text\n", "'just some text'", "a mapping of keys"),
    "list": (b"- preset\n- draft\n", "['preset', 'draft']", "a mapping of keys"),
    "nothing": (b"# nothing\n", "empty", "a mapping of keys"),
    "key without value": (
        b"model:\n  damping_ratio:\n# a comment\n\nmeasure: {}\n",
        "line 2: damping_ratio: no value",
        "null, which removes",
    ),
    "entry without value": (b"simulations: {}\nstudies:\n  -\n  - layer\n", "line 3: no value"),
    "decimal comma in braces": (
        b"model:\n  {release: total, damping_ratio: 0,1}\n",
        "line 2: damping_ratio: 0,1",
        "write 0.1",
    ),
    "open bracket": (b"preset: [draft\nmodel: {}\n", "not YAML", "line 1"),
    "open quote": (b"model: {}\npreset: 'draft\nmeasure: {}\n", "not YAML", "line 2"),
    "line without a colon": (b"model: {}\npreset\nmeasure: {}\n", "not YAML", "line 2"),
    "picture": (b"\x89PNG\r\n\x1a\n\xff\xfe", "not text"),
    "older YAML": (b"# as it was\n%YAML 1.1\n---\nallow_large: yes\n", "'%YAML 1.1'", "YAML 1.2"),
    "python tag": (b"preset: !!python/object/apply:os.system [touch x]\n", "line 1", "no tags"),
    "anchor": (b"model: &a {release: total}\nmeasure: *a\n", "line 1", "anchor or alias"),
    "template": (b"__use_yte__: true\n?if True:\n  preset: draft\n", "a template"),
    "key twice": (b"preset: draft\npreset: paper\n", "line 2", 'duplicate key "preset"', "once"),
    "collection as a key": (b"{[1, 2]: 3}", "line 1", "a collection as a key", "text"),
    "two documents": (b"preset: draft\n---\npreset: paper\n", "line 2", "another document"),
    "deep nesting": (b"[" * 1000, "nested too deeply"),
    "large file": (b"# " + b"x" * MAX_FILE_BYTES, f"more than {MAX_FILE_BYTES} bytes"),
}
# A scene in SI units, and changes of it with their refusals.
BLOCK = {
    "title": "A block",
    "layer": {
        "thickness": 0.01,
        "shear_modulus": 2.1e9,
        "poisson_ratio": 0.33,
        "density": 1170.0,
        "static_friction": 0.6,
        "kinetic_friction": 0.5,
        "normal_stress": 5e6,
        "top": "held",
    },
    "points": [[-0.1, 1e6], [-0.08, 2.7e6], [0.08, 2.7e6], [0.1, 1e6]],
    "width": 0.005,
    "duration": 40e-6,
    "dx": 2e-4,
}
EVERYWHERE, BACKWARDS = [[-0.1, 3.1e6], [0.1, 3.2e6]], [[-0.1, 2e6], [0.1, -3.1e6]]
LAYERS = {
    "layer.shear_modulus: 0; allowed: a number > 0": {"layer": {"shear_modulus": 0}},
    "layer.poisson_ratio: 0.5; allowed: a finite number and > -1 and < 0.5": {
        "layer": {"poisson_ratio": 0.5}
    },
    "layer.static_friction: 0.5; allowed: a number above kinetic_friction = 0.5": {
        "layer": {"static_friction": 0.5}
    },
    "layer.lame_parameter, poisson_ratio: missing": {"layer": {"poisson_ratio": None}},
    "layer.top: 'free'; allowed: held, stress": {"layer": {"top": "free"}},
    "layer.density: missing": {"layer": {"density": None}},
    "points: at least 3.1e+06 Pa everywhere; allowed: somewhere below static": {
        "points": EVERYWHERE
    },
    "points: -3.1e+06 Pa; allowed: > -3e+06 Pa": {"points": BACKWARDS},
    "gamma: 0.6; allowed: no value, since the layer determines gamma": {"gamma": 0.6},
    "boundary: 'stress'; allowed: the boundary that layer.top = 'held' implies": {
        "boundary": "stress"
    },
    "dx: 0.02; allowed: a number > 0 and <= the thickness, 0.01 m": {"dx": 0.02},
    "peak: 1, and the pre-stress of a block is at most 0.4": {
        "points": [[-0.1, 2.7e6], [0.1, 2.7e6]],
        "width": None,
    },
    "left: 3e+06 Pa; allowed: below static friction (3e+06 Pa)": {
        "points": None,
        "left": 3e6,
        "right": 2.7e6,
    },
}
# Values that replace any other value.
ODD = [None, True, -1, 0, 1, 3.5, 1e308, 10**400, float("nan"), float("inf"), "", "same", "0.1"]
ODD += ["x" * 2000, "a\nb", "stress", [], [[]], [1, 0.2], [[1, 0.2]], [[1, 0.2, 0.3]], [None], {}]
ODD += [{"a": 1}, {"time": 1.0}, {"": {}}, [{"left": 1}], ["samples"], {"fixed": 0.1}, [1e-300]]


@pytest.fixture(scope="module")
def shipped(project) -> dict:
    config = read_overlay(project / "config/config.yaml")
    config["simulations"] = {name: config["simulations"][name] for name in KEPT}
    return config


def assert_clear(message: str, parts: Sequence[str] = ()) -> None:
    for part in parts:
        assert part in message
    assert len(message.splitlines()) <= 6
    for line in message.splitlines():
        assert re.search(r"allowed: |it is required|\.\.\. and \d+ more", line), line
        assert len(line) < 400 and "http" not in line, line


@pytest.mark.parametrize(("line", "change"), LAYERS.items())
def test_a_mistake_in_a_layer_is_refused_in_si_units(shipped, line, change):
    layer, changes = change.get("layer", {}), {**change}
    scene = BLOCK | changes | {"layer": BLOCK["layer"] | layer}
    with pytest.raises(ConfigError) as refusal:
        read_config(shipped, [{"scenes": {"block": scene}}])
    assert_clear(str(refusal.value), [f"scenes.block.{line}"])


@pytest.mark.parametrize("case", MISTAKES)
def test_a_mistake_in_an_overlay_is_refused(shipped, tmp_path, monkeypatch, case):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigError) as refusal, warnings.catch_warnings():
        warnings.simplefilter("error")
        read_config(shipped, [MISTAKES[case]["overlay"]])
    parts = MISTAKES[case]["refusal"]
    parts = parts.splitlines() if isinstance(parts, str) else parts
    assert_clear(str(refusal.value), parts)
    assert not [*tmp_path.iterdir()]


def mutated(value, chance: random.Random) -> object:
    """Return an overlay that changes a value, a value nested in it, or a key."""
    if chance.random() < 0.2 or not (value and isinstance(value, dict | list)):
        return chance.choice(ODD)
    if isinstance(value, list):
        index = chance.randrange(len(value))
        other = mutated(value[index], chance)
        return value[:index] + [other] * chance.randrange(3) + value[index + 1 :]
    key = chance.choice([*value])
    if chance.random() < 0.1:
        return {key + chance.choice("sx_ "): value[key]}
    return {key: mutated(value[key], chance)}


def test_any_of_2000_changes_is_allowed_or_refused_in_clear_lines(shipped):
    chance, counts = random.Random(41), Counter()
    scene = shipped["scenes"]["barrier"] | {"steps": [[3, 0]]}
    small = shipped | {"published": {}, "scenes": {"one": scene, "block": BLOCK}}
    for _ in range(2000):
        overlay = mutated(small, chance)
        if not isinstance(overlay, dict):
            continue
        try:
            read_config(small, [overlay])
            counts["allowed"] += 1
        except ConfigError as refusal:
            counts["refused"] += 1
            assert_clear(str(refusal))
    assert counts["allowed"] > 100 and counts["refused"] > 1000


def bound_and_chunks(config, name: str):
    sweep = all_simulations(config)[name]
    block = resolve(sweep, config.model, accuracy_of(config))
    return bound_of_sweep(block, sweep.chunks), sweep.chunks


@pytest.mark.parametrize("case", EXPENSIVE)
def test_a_sweep_that_takes_too_much_is_refused(shipped, case):
    name, changes, words = EXPENSIVE[case]
    config = read_config(shipped, [{"simulations": {name: changes}}])
    bound, chunks = bound_and_chunks(config, name)
    reason = bound.exceeded(chunks)
    assert words in reason and OPTION_TO_ALLOW in reason and "\n" not in reason


@pytest.mark.parametrize("preset", ["draft", "paper", "reference"])
def test_nothing_that_is_shipped_takes_too_much(project, preset):
    config = read_config(read_overlay(project / "config/config.yaml"), [{"preset": preset}])
    bounds = [bound_and_chunks(config, name)[0] for name in all_simulations(config)]
    assert not any(bound.exceeded() for bound in bounds)
    assert max(bound.block_updates for bound in bounds) < 1e-2 * 4e13
    assert max(bound.bytes for bound in bounds) < 0.5 * 4e9


@pytest.mark.parametrize("case", FILES)
def test_a_file_that_is_no_overlay_is_refused(tmp_path, case):
    content, *parts = FILES[case]
    (tmp_path / "mine.yaml").write_bytes(content)
    with pytest.raises(ConfigError) as refusal:
        read_overlay(tmp_path / "mine.yaml")
    assert "\n" not in str(refusal.value)
    assert_clear(str(refusal.value), [f"{tmp_path}/mine.yaml: ", *parts])


def test_scalars_are_what_yaml_and_json_say(tmp_path):
    text = "key: [1, -2.5, .5, 1e-3, 0x10, true, null, 010, '010', yes, total, 1:30, 1.]"
    values = [1, -2.5, 0.5, 1e-3, 16, True, None, 10, "010", "yes", "total", "1:30", 1.0]
    # YAML has the braces and quoted keys of JSON, too.
    (tmp_path / "mine.yaml").write_text(f'{{{text}, "dx": 1e-2}}', encoding="utf-8")
    overlay = read_overlay(tmp_path / "mine.yaml")
    assert overlay == {"key": values, "dx": 0.01}
    assert [*map(type, overlay["key"])] == [*map(type, values)]


def test_the_command_line_sets_nested_values_and_switches_in_words(shipped):
    nested = {"damping_ratio": "0.2", "release": "elastic"}
    config = read_config(shipped, (), {"model": nested, "accuracy": "1e-2"})
    assert (config.model.damping_ratio, config.model.release) == (0.2, "elastic")
    assert config.model.scheme == shipped["model"]["scheme"] and config.accuracy == 0.01
    words = {1: True, "yes": True, "on": True, "true": True, 0: False, "no": False, "False": False}
    for word, meaning in words.items():
        config = read_config(shipped, (), {"allow_large": word}, every_run=False)
        assert config.allow_large is meaning


@pytest.mark.parametrize("case", COMMAND_LINE_VALUES)
def test_the_command_line_is_refused(shipped, case):
    values, refusal = COMMAND_LINE_VALUES[case]
    with pytest.raises(ConfigError, match=re.escape(refusal)):
        read_config(shipped, (), values)


# Figures, simulations that they draw, changes of these, and the refusals.
EQUAL = "at least one run with `boundary: displacement` and equal levels > 0"
BALANCED = "at least one run with `boundary: stress`, left level < 0, right level 0, no steps"
OTHER = "; put other runs into a simulation with another name"
NOW = {"time": 5.0, "balance_distances": None}
STRESS_PROFILE = {"profiles": [{"left": -0.3, "right": 0.1}]}
NOT_DRAWN = [
    ("fig05_scaling", "scaling_displacement", {"left": [0.3], "right": [0.5]}, EQUAL),
    ("fig05_scaling", "scaling_stress", {"right": [0.1], "duration": NOW}, BALANCED),
    ("fig10_damping_displacement", "damping_displacement", {"left": [-0.3]}, EQUAL),
    ("fig09_steady_state_stress", "steady_stress", STRESS_PROFILE, BALANCED),
]


@pytest.mark.parametrize(("figure", "name", "changes", "allowed"), NOT_DRAWN)
def test_a_sweep_that_a_figure_cannot_draw_is_refused(project, figure, name, changes, allowed):
    whole = read_overlay(project / "config/config.yaml")
    config = read_config(whole, [{"simulations": {name: changes}}], every_run=False)
    draws = {figure: declared(f"figures.{figure}", "DRAWS")}
    (line,) = drawing_problems(config, draws)
    assert line == f"simulations.{name}: no run that {figure} can draw; allowed: {allowed}{OTHER}"


def test_every_figure_says_what_it_draws_and_draws_what_is_shipped(project):
    config = read_config(read_overlay(project / "config/config.yaml"), every_run=False)
    needs = needs_of("figures")
    draws = {name: declared(f"figures.{name}", "DRAWS") or {} for name in needs}
    assert drawing_problems(config, draws) == []
    for name, drawn in draws.items():
        read = {*needs[name].get("measured", {}), *needs[name].get("data", ())}
        assert {*drawn} <= read and (name.startswith("study") or {*drawn} == read), name
