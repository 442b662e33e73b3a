"""Wrong input is refused before any job: one line that names the key, the value and what is allowed."""

import re
import warnings

import pytest

from slippulse.configuration.expand import expand
from slippulse.configuration.read import LARGEST_FILE, main, read_config, read_overlay
from slippulse.configuration.resolve import (
    HOW_TO_GO_ON,
    accuracy_of,
    all_simulations,
    bound_of_sweep,
    resolve,
)
from slippulse.model.checks import ConfigError

# Enough of the shipped simulations for every case, so that a refusal of scenes is quick.
KEPT = (
    "steady_displacement", "space_time_displacement", "space_time_stress", "burridge_knopoff_stress", "steady_stress",
)  # fmt: skip
STEADY, STRESS = "simulations: {steady_displacement: ", "simulations: {space_time_stress: "
OWN = "simulations: {mine: {boundary: displacement, duration: {time: 10.0}, record: [fronts], "
OWN_LEVEL = OWN + "gamma: [0.5], left: [0.5], right: same, "
OWN_STRESS = "simulations: {mine: {boundary: stress, left: [-1.0], record: [fronts], "
OWN_PROFILE = (
    "simulations: {mine: {boundary: stress, record: [fronts], duration: {time: 1.0}, profiles: [{left: "
)
MANY = "[" + ", ".join(f"{0.001 * i:.3f}" for i in range(1, 801)) + "]"

# Overlay, and what the refusal must name: the key, the value, what is allowed or the remedy.
CASES = {
    # unknown and misspelt keys
    "misspelt root key": ("simulation: {}", ["simulation", "did you mean 'simulations'"]),
    "unknown root key": ("colour: red", ["colour: unknown key", "allowed: preset"]),
    "misspelt key of a simulation": (STEADY + "{gama: [0.3]}}", ["steady_displacement.gama", "did you mean 'gamma'"]),
    "misspelt key of the model": ("model: {dampingratio: 0.1}", ["model.dampingratio", "did you mean 'damping_ratio'"]),
    "misspelt key of measure": ("measure: {shares: 0.9}", ["measure.shares", "did you mean 'share'"]),
    "misspelt figure": ("figures: {fig07_damage_zon: {}}", ["fig07_damage_zon", "did you mean 'fig07_damage_zone'"]),
    "misspelt simulation": (
        "simulations: {steady_displacment: {gamma: [0.3]}}",
        ["steady_displacment.boundary", "did you mean 'steady_displacement'"],
    ),
    "misspelt preset": ("presets: {drafts: {dx: 0.1}}", ["presets.drafts", "did you mean 'draft'"]),
    "preset that is not there": ("preset: papre", ["'papre'", "did you mean 'paper'", "draft, paper, reference"]),
    "simulation that is not there": (
        "published: {front_speed: {simulation: space_time_displacemnt}}",
        ["published.front_speed.simulation", "did you mean 'space_time_displacement'"],
    ),
    # wrong types
    "number in quotes": ("presets: {paper: {dx: '0.01'}}", ["presets.paper.dx", "'0.01'", "without quotes"]),
    "decimal comma": ("model: {friction_ratio: '5,5'}", ["friction_ratio", "'5,5'", "write 5.5"]),
    "one number for a list": (STEADY + "{gamma: 0.3}}", ["gamma: 0.3", "a list of different numbers"]),
    "a list for one number": ("model: {damping_ratio: [0.1]}", ["model.damping_ratio: [0.1]", "a number >= 0"]),
    "a switch for a number": ("model: {damping_ratio: true}", ["model.damping_ratio: True", "a number >= 0"]),
    "null for a number": ("model: {damping_ratio: null}", ["model.damping_ratio: missing", "null removes a key"]),
    "a fraction for a whole number": ("presets: {paper: {order: 4.5}}", ["order: 4.5", "a whole number from 3 to 8"]),
    "a list for a mapping": ("simulations: [1, 2]", ["simulations: [1, 2]", "a mapping"]),
    "text for a mapping": (STEADY + "{duration: long}}", ["duration: 'long'", "one of time"]),
    "yes for a switch": ("presets: {paper: {whole: yes}}", ["presets.paper.whole: 'yes'", "true or false"]),
    "a preset that is a number": ("preset: 3", ["preset: 3", "the name of a preset"]),
    # ranges
    "negative spacing": ("presets: {paper: {dx: -0.1}}", ["presets.paper.dx: -0.1", "> 0"]),
    "order 9": ("presets: {paper: {order: 9}}", ["order: 9", "from 3 to 8"]),
    "negative damping": (STEADY + "{damping_ratio: [-0.1]}}", ["damping_ratio.0: -0.1", ">= 0"]),
    "zero gamma": (STEADY + "{gamma: [0.0]}}", ["gamma.0: 0.0", "> 0"]),
    "level at the threshold": (STEADY + "{left: [1.0]}}", ["prestress.left: 1.0", "< 1"]),
    "infinity": ("measure: {share: .inf}", ["measure.share: inf", "a finite number"]),
    "not a number": (STEADY + "{left: [.nan]}}", ["left.0: nan", "a finite number"]),
    "share above 1": ("measure: {share: 1.5}", ["measure.share: 1.5", "> 0 and < 1"]),
    "zero duration": (STEADY + "{duration: {time: 0.0}}}", ["duration.time: 0.0", "> 0"]),
    "one factor in the grid study": ("presets: {paper: {coarser: [2.0]}}", ["coarser: [2.0]", "two different factors"]),
    "release rule": ("model: {release: both}", ["model.release: 'both'", "total, elastic"]),
    "scheme": ("model: {scheme: euler}", ["model.scheme: 'euler'", "localised, fixed_step, continuum"]),
    "boundary": (STEADY + "{boundary: free}}", ["boundary: 'free'", "displacement, stress"]),
    "record": (STEADY + "{record: [everything]}}", ["record.0: 'everything'", "fronts, fields, samples"]),
    "fields without fronts": (STEADY + "{record: [fields]}}", ["record: ['fields']", "a list of fronts (always"]),
    "range of stiffness turned round": (
        "figures: {fig07_damage_zone: {stiffness_ratios: {from: 2.0}}}", ["stiffness_ratios.to: 1.0", "> from = 2"],
    ),
    "accuracy above a tenth": ("accuracy: 0.5", ["accuracy: 0.5", "from 0.0001 to 0.1"]),
    "accuracy too small to reach": ("accuracy: 1.0e-7", ["accuracy: 1e-07", "from 0.0001 to 0.1"]),
    "misspelt null": (STEADY + "{gama: null}}", ["steady_displacement.gama: null", "did you mean 'gamma'"]),
    "null for a name that is not there": (
        "simulations: {steady_displacment: null}", ["steady_displacment: null", "did you mean 'steady_displacement'"],
    ),
    "null for a shipped simulation": (
        "simulations: {steady_displacement: null}", ["steady_displacement: null", "what is shipped stays"],
    ),
    "null for the preset": ("preset: null", ["preset: missing", "null removes a key", "draft, paper, reference"]),
    "null for a preset's key": ("presets: {paper: {dx: null}}", ["presets.paper.dx: missing", "null removes a key"]),
    "null in a list": (STEADY + "{gamma: [null]}}", ["gamma.0: None", "a number > 0"]),
    "a number as a name": ("simulations: {123: {boundary: stress}}", ["simulations: '123'", "begins with a letter"]),
    "reading of a quantity that is not measured": (
        "published: {front_speed: {quantity: front_speed_rigt}}",
        ["published.front_speed.quantity: 'front_speed_rigt'", "did you mean 'front_speed_right'"],
    ),
    "reading of a quantity that is not recorded": (
        "simulations: {space_time_displacement: {record: [fronts], samples: null}}",
        ["published.velocity_displacement.quantity: 'largest_velocity'", "this takes record: [fronts, fields]"],
    ),
    "null for a scene that is not there": (
        "scenes: {barier: null}", ["scenes.barier: null", "did you mean 'barrier'"],
    ),
    "name of a simulation for a scene": (
        "scenes: {steady_displacement: {title: a, boundary: stress, left: 0.0, right: 0.0, duration: 1.0}}",
        ["scenes.steady_displacement: also the name of a simulation", "another name"],
    ),
    # what belongs together
    "samples that are not recorded": (
        OWN_LEVEL + "samples: {times: 2, positions: 1, extent: 0.0}}}",
        ["mine.samples: given, but not recorded", "samples in record"],
    ),
    "peak below 1 everywhere": (
        OWN_PROFILE + "0.5, right: 0.5, peak: 0.9}]}}", ["mine.peak: 0.9", "at most 0.9 ", "reaches 1 somewhere"],
    ),
    "a dent that reaches the peak": (
        OWN_PROFILE + "-0.2, right: 0.0, bumps: [[-3.0, -0.8, 0.7]]}]}}",
        ["mine.peak: 1", "at most 0.9999178", "reaches 1 somewhere"],
    ),
    "a bump between two blocks": (
        OWN_PROFILE + "0, right: 0, peak: 0, bumps: [[0.003, 1, 1.0e-4]]}]}}", ["mine.peak: 0,", "reaches 1 somewhere"],
    ),
    "balance distances of positive levels": (
        STEADY + "{duration: {time: null, balance_distances: 2.0}}}",
        ["steady_displacement.duration.balance_distances: 2.0 times |x_minus|, but right: 0.2", "allowed: 0"],
    ),
    "fixed spacing with a rule": (
        OWN_LEVEL + "spacing: {fixed: 0.1, scale: 2.0}}}", ["mine.spacing.fixed: given with others", "alone"],
    ),
    "gamma that leaves no stable step": (STEADY + "{gamma: [1.0e+200]}}", ["steady_displacement.gamma: 1e+200"]),
    "accuracy of the textbook scheme": (
        "{accuracy: 1.0e-2, model: {scheme: fixed_step}}",
        ["model.scheme: 'fixed_step'", "'localised' where accuracy is given"],
    ),
    "accuracy of one scene in the textbook scheme": (
        "{accuracy: 1.0e-2, scenes: {barrier: {scheme: fixed_step}}}",
        ["scenes.barrier.scheme: 'fixed_step'", "'localised' where accuracy is given"],
    ),
    "accuracy with friction that depends on slip rate": (
        "{accuracy: 1.0e-2, simulations: {steady_displacement: {rate_strengthening: [0.2]}}}",
        ["steady_displacement.rate_strengthening: [0.2]", "allowed: 0 where accuracy is given"],
    ),
    "accuracy at strong damping": (
        "{accuracy: 1.0e-2, simulations: {steady_displacement: {damping_ratio: [3.0]}}}",
        ["steady_displacement.damping_ratio: 3.0", "<= 1"],
    ),
    "gamma under stress": (STRESS + "{gamma: [0.5]}}", ["space_time_stress.gamma: [0.5]", "left out under"]),
    "no gamma under displacement": (OWN + "left: [0.5], right: same}}", ["mine.gamma: missing"]),
    "no levels": (OWN + "gamma: [0.5]}}", ["mine.left, right: missing"]),
    "profiles and levels": (
        OWN_LEVEL + "profiles: [{left: 0.5, right: 0.5}]}}", ["mine.profiles", "one or the other"],
    ),
    "beta and damping ratio": (STEADY + "{beta: [0.001]}}", ["beta", "damping_ratio", "one or the other"]),
    "dx and spacing": (OWN_LEVEL + "dx: [0.1], spacing: {scale: 2.0}}}", ["mine.dx", "spacing", "one or the other"]),
    "two durations": (STEADY + "{duration: {half_periods: 3.0}}}", ["duration", "one of time"]),
    "half periods under stress": (
        OWN_STRESS + "right: [0.0], duration: {half_periods: 1.0}}}", ["duration.half_periods", "displacement"],
    ),
    "samples not stated": (
        OWN.replace("fronts", "fronts, samples") + "gamma: [0.5], left: [0.5], right: same}}",
        ["mine.samples: missing"],
    ),
    "balance that does not exist": (
        OWN_STRESS + "right: [0.2], duration: {balance_distances: 2.0}}}", ["but right: 0.2", "allowed: 0"],
    ),
    # the lattice
    "peak narrower than the spacing": (
        "simulations: {burridge_knopoff_stress: {width: [0.5]}}", ["prestress.width: 0.5", ">= dx = 1"],
    ),
    "unstable step": (STEADY + "{max_step: 3.0}}", ["max_step: 3.0", "stability bound"]),
    "unstable on a coarser lattice": (
        OWN_LEVEL + "width: [0.3], dx: [0.1]}}", ["prestress.width: 0.3", "4 times coarser of the grid study"],
    ),
    "pulse of a few blocks": (
        OWN + "gamma: [1.0], left: [0.1], right: same, dx: [0.5]}}",
        ["mine.resolved_blocks: 8", "blocks; allowed: a pulse of at least 4 blocks", "a smaller dx"],
    ),
    # scenes
    "scene in which nothing moves": ("scenes: {barrier: {peak: 0.9}}", ["scenes.barrier.peak: 0.9", "reaches 1"]),
    "misspelt key of a scene": ("scenes: {barrier: {gama: 0.3}}", ["scenes.barrier.gama", "did you mean 'gamma'"]),
    "misspelt scene": ("scenes: {bariere: {gamma: 0.3}}", ["scenes.bariere.boundary", "did you mean 'barrier'"]),
    "scene with a path as a name": ("scenes: {../barrier: {}}", ["'../barrier'", "lower-case letters"]),
    "a scene named as the page of all": (
        "scenes: {index: {title: a, boundary: stress, left: 0.5, right: 0.5, duration: 1.0}}",
        ["scenes.index: another file of that name is there", "neither index nor SCENE_numbers"],
    ),
    "a scene named as the numbers of another": (
        "scenes: {barrier_numbers: {title: a, boundary: stress, left: 0.5, right: 0.5, duration: 1.0}}",
        ["scenes.barrier_numbers: another file of that name is there", "neither index nor SCENE_numbers"],
    ),
    "blank title": ("scenes: {barrier: {title: ' '}}", ["scenes.barrier.title: ' '", "not blank"]),
    "title that rings": ('scenes: {barrier: {title: "\\a bell"}}', [r"scenes.barrier.title: '\x07 bell'", "printable"]),
    "title of two lines": ('scenes: {barrier: {title: "a\\nb"}}', [r"scenes.barrier.title: 'a\nb'", "one line"]),
    "two dampings in a scene": ("scenes: {barrier: {beta: 0.1, damping_ratio: 0.1}}", ["barrier.beta", "one or the"]),
    # figures
    "a thousand million points of a curve": (
        "figures: {fig07_damage_zone: {stiffness_ratios: {count: 1000000000}}}",
        ["stiffness_ratios.count: 1000", "to 10000"],
    ),
    "stiffness from nothing to everything": (
        "figures: {fig07_damage_zone: {stiffness_ratios: {from: 5.0e-324, to: 1.0e+308}}}",
        ["stiffness_ratios.from: 5e-324", "stiffness_ratios.to: 1e+308", "from 1e-6 to 1e6"],
    ),
    "a sketch of the universe": (
        "figures: {fig01_system_sketch: {thickness: 1.0e+308}}", ["system_sketch.thickness: 1e+308", "0.01 to 100"],
    ),
    "a window of no block": ("measure: {front_window: 1.0e-6}", ["measure.front_window: 1e-06", ">= 0.05 and < 1"]),
    # sweeps
    "empty axis": (STEADY + "{gamma: []}}", ["gamma: []", "at least one"]),
    "duplicate value": (STEADY + "{left: [0.5, 0.5]}}", ["left: [0.5, 0.5]", "different"]),
    "duplicate profile": (
        "simulations: {steady_stress: {profiles: [{left: -1.0, right: 0.0}, {left: -1.0, right: 0.0}]}}",
        ["profiles", "different"],
    ),
    "no chunks": (STEADY + "{chunks: 0}}", ["steady_displacement.chunks: 0", "a whole number from 1 to 1000"]),
    "more chunks than a system opens files": (STEADY + "{chunks: 1001}}", ["chunks: 1001", "from 1 to 1000"]),
    "more chunks than runs": (STEADY + "{chunks: 13}}", ["displacement.chunks: 13", "the number of runs, 12"]),
    "chunks of a scene": ("scenes: {barrier: {chunks: 2}}", ["scenes.barrier.chunks: unknown key"]),
    "a number that overflows": (STEADY + "{gamma: [1.0e+300]}}", ["steady_displacement"]),
    # hostile
    "path as a name": ("simulations: {../../etc/passwd: {}}", ["'../../etc/passwd'", "lower-case letters"]),
    "command as a name": ("simulations: {$(touch written): {}}", ["'$(touch written)'", "lower-case letters"]),
    "newline in a name": ('simulations: {"a\\nb": {}}', [r"'a\nb'", "lower-case letters"]),
    "command as a preset": ("preset: '`touch written`'", ["preset: '`touch written`'", "draft, paper, reference"]),
    "newline in a preset": ('preset: "paper\\ndraft"', [r"'paper\ndraft'", "draft, paper, reference"]),
    "a very long name": ("simulations: {" + "a" * 900 + ": {}}", ["'aaaa", "..."]),
    "claim with an unknown key": ("claims: {pulse_slip: {kind: exact}}", ["claims.pulse_slip.kind: unknown key"]),
    "study that is text": ("studies: extremes", ["studies: 'extremes'", "a list of different names"]),
    "sexagesimal": ("model: {friction_ratio: 1:30}", ["friction_ratio: '1:30'", "a number >= 0"]),
    "a quote in a preset": ("preset: \"draft'\"", ["preset: \"draft'\"", "did you mean 'draft'"]),
}  # fmt: skip

# Sweeps that take too much: overlay, simulation, and what the refusal of its job names.
EXPENSIVE = {
    "fronts that outrun the waves": (
        OWN_STRESS.replace("-1.0", "0.9999")
        + "right: same, damping_ratio: [1.0], dx: [0.01], duration: {time: 60.0}}}",
        "mine", "block updates; allowed: 4e+13",
    ),
    "a nucleation of a million layers": (OWN_LEVEL + "width: [1.0e+9], dx: [0.01]}}", "mine", "block updates"),
    "damping of ten thousand": (OWN_LEVEL + "damping_ratio: [1.0e+4], dx: [0.001]}}", "mine", "block updates"),
    "too many runs": (
        STEADY + f"{{left: {MANY}, gamma: {MANY}}}}}", "steady_displacement", "1.92e+06 runs; allowed: 2e+04",
    ),
    "too many hours": (STEADY + "{duration: {time: 1.0e+6}}}", "steady_displacement", "block updates"),
    "too much memory": (
        "simulations: {space_time_stress: {samples: {times: 100000, positions: 100000}}}", "space_time_stress", "bytes",
    ),
    "too many runs for the chunks": (
        STEADY + f"{{chunks: 3, left: {MANY}, gamma: {MANY}}}}}", "steady_displacement",
        "6.4e+05 runs in each of 3 chunks; allowed: 2e+04",
    ),
    "too many runs in all chunks": (
        STEADY + f"{{chunks: 1000, left: {MANY}, gamma: {MANY}}}}}", "steady_displacement",
        "1.92e+03 runs in each of 1000 chunks; allowed: 1e+03",
    ),
}  # fmt: skip

# Files that are no overlay at all.
FILES = {
    "text": (b"just some text\n", ["'just some text'", "a mapping of keys"]),
    "list": (b"- preset\n- draft\n", ["['preset', 'draft']", "a mapping of keys"]),
    "number": (b"42\n", ["42", "a mapping of keys"]),
    "empty": (b"# nothing\n", ["None", "a mapping of keys"]),
    "nothing for a number": (b"model: {damping_ratio: }", ["line 1", "no value", "null, which removes the key"]),
    "broken": (b"preset: [draft\n", ["not YAML", "line 2"]),
    "tabs": (b"simulations:\n\tmine: 1\n", ["not YAML", "line 2"]),
    "binary": (b"\x89PNG\r\n\x1a\n\xff\xfe", ["not text"]),
    "python tag": (b"preset: !!python/object/apply:os.system [touch written]\n", ["line 1", "no tags"]),
    "own tag": (b"preset: !preset draft\n", ["line 1", "'!preset'", "no tags"]),
    "alias": (b"model: &a {release: total}\nmeasure: *a\n", ["line 1", "anchor or alias"]),
    "template": (b"__use_yte__: true\n?if True:\n  preset: draft\n", ["a template"]),
    "duplicate key": (b"preset: draft\npreset: paper\n", ["line 2", 'duplicate key "preset"', "each key once"]),
    "a collection as a key": (b"{[1, 2]: 3}", ["line 1", "a collection as a key", "text"]),
    "two documents": (b"preset: draft\n---\npreset: paper\n", ["line 2", "another document"]),
    "deep": (b"[" * 5000, ["nested too deeply"]),
    "huge": (b"# " + b"x" * LARGEST_FILE, [f"more than {LARGEST_FILE} bytes"]),
    "laughs": (
        b"a0: &a0 [x]\n" + b"".join(b"a%d: &a%d [%s*a0]\n" % (i, i, b"*a%d, " % (i - 1) * 10) for i in range(1, 30)),
        ["anchor or alias"],
    ),
}  # fmt: skip

SWITCHES = {1: True, "yes": True, "on": True, 0: False, "no": False, "False": False}


@pytest.fixture(scope="module")
def shipped(project) -> dict:
    config = read_overlay(project / "config/config.yaml")
    config["simulations"] = {name: config["simulations"][name] for name in KEPT}
    return config


def assert_one_clear_message(message: str, named: list[str]) -> None:
    for part in named:
        assert part in message
    for line in message.splitlines():
        assert re.search(r"allowed: |it is required", line) and len(line) < 400, line
    assert len(message.splitlines()) <= 6 and "Traceback" not in message


def test_what_is_shipped_passes_here_too(shipped):
    read_config(shipped)


def overlaid(tmp_path, text: str) -> dict:
    (tmp_path / "mine.yaml").write_text(text, encoding="utf-8")
    return read_overlay(tmp_path / "mine.yaml")


@pytest.mark.parametrize("case", CASES)
def test_a_mistake_in_an_overlay_is_refused(shipped, tmp_path, case):
    text, named = CASES[case]
    with pytest.raises(ConfigError) as refusal, warnings.catch_warnings():
        warnings.simplefilter("error")
        read_config(shipped, [overlaid(tmp_path, text)])
    assert_one_clear_message(str(refusal.value), named)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.yaml"]


def bound_and_chunks(config, name: str):
    sweep = all_simulations(config)[name]
    return bound_of_sweep(resolve(sweep, config.model, accuracy_of(config)), sweep.chunks), sweep.chunks


@pytest.mark.parametrize("case", EXPENSIVE)
def test_a_sweep_that_takes_too_much_is_refused(shipped, tmp_path, case):
    text, name, said = EXPENSIVE[case]
    bound, chunks = bound_and_chunks(read_config(shipped, [overlaid(tmp_path, text)]), name)
    reason = bound.exceeded(chunks)
    assert said in reason and HOW_TO_GO_ON in reason and "\n" not in reason


@pytest.mark.parametrize("preset", ["draft", "paper", "reference"])
def test_nothing_that_is_shipped_takes_too_much(project, preset):
    config = read_config(read_overlay(project / "config/config.yaml"), [{"preset": preset}])
    bounds = [bound_and_chunks(config, name)[0] for name in all_simulations(config)]
    assert not any(bound.exceeded() for bound in bounds)
    # Far from the limits.
    assert max(bound.block_updates for bound in bounds) < 1e-2 * 4e13
    assert max(bound.bytes for bound in bounds) < 0.5 * 4e9


@pytest.mark.parametrize("case", FILES)
def test_a_file_that_is_no_overlay_is_refused(tmp_path, case, capsys):
    content, named = FILES[case]
    (tmp_path / "mine.yaml").write_bytes(content)
    assert main([str(tmp_path / "mine.yaml")]) == 1
    heading, message = capsys.readouterr().err.split("\n", 1)
    assert heading == "The configuration is refused:" and message.count("\n") == 1
    assert_one_clear_message(message, [f"{tmp_path}/mine.yaml: ", *named])


@pytest.mark.parametrize(
    ("text", "value"),
    [("1", 1), ("-2.5", -2.5), (".5", 0.5), ("1e-3", 1e-3), ("0x10", 16), ("true", True), ("null", None),
     ("010", 10), ("'010'", "010"), ("yes", "yes"), ("total", "total"), ("1:30", "1:30"), ("1.", 1.0)],
)  # fmt: skip
def test_scalars_are_what_yaml_says(tmp_path, text, value):
    read = overlaid(tmp_path, f"key: {text}\n")["key"]
    assert read == value and type(read) is type(value)


def test_json_is_read_as_json(tmp_path):
    assert overlaid(tmp_path, '{"presets": {"paper": {"dx": 1e-2}}}') == {"presets": {"paper": {"dx": 0.01}}}


def test_the_command_line_sets_nested_values(shipped):
    given = {
        "model": {"damping_ratio": "0.2", "release": "elastic"},
        "allow_large": "true",
        "accuracy": "1e-2",
    }
    config = read_config(shipped, (), given)
    assert (config.model.damping_ratio, config.model.release) == (0.2, "elastic")
    assert config.model.scheme == shipped["model"]["scheme"]
    assert config.allow_large is True and config.accuracy == 0.01


@pytest.mark.parametrize("said", SWITCHES)
def test_words_for_a_switch_on_the_command_line(shipped, said):
    assert read_config(shipped, (), {"allow_large": said}, every_run=False).allow_large is SWITCHES[said]


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"allow_large": "maybe"}, "allow_large: 'maybe'; allowed: true or false"),
        ({"allow_large": 2}, "allow_large: 2; allowed: true or false"),
        ({"model": {"damping_ratio": "1:30"}}, "model.damping_ratio: '1:30'; allowed: a number >= 0"),
        ({"preset": "&a"}, "preset: '&a'; allowed: a plain value"),
        (
            {"preset": "draft'"},
            "preset: \"draft'\" (did you mean 'draft'?); allowed: draft, paper, reference",
        ),
        ({"model": {"damping_ratio": "much"}}, "model.damping_ratio: 'much'; allowed: a number >= 0"),
    ],
)
def test_what_the_command_line_may_not_say(shipped, given, named):
    with pytest.raises(ConfigError) as refusal:
        read_config(shipped, (), given)
    assert named in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "change", "gone"),
    [
        ("steady_displacement", "{damping_ratio: null, beta: [0.001]}", "damping_ratio"),
        ("steady_displacement", "{boundary: stress, gamma: null, left: [0.3], right: same}", "gamma"),
        ("steady_displacement", "{duration: {time: null, half_periods: 3.0}}", ""),
        ("steady_stress", "{profiles: null, left: [-0.5], right: [0.0]}", "profiles"),
        ("steady_displacement", "{scheme: continuum, spacing: null}", ""),
    ],
)
def test_a_shipped_sweep_can_be_altered(shipped, tmp_path, name, change, gone):
    config = read_config(shipped, [overlaid(tmp_path, f"simulations: {{{name}: {change}}}")])
    assert gone not in config.simulations[name].given()
    assert expand(resolve(config.simulations[name], config.model, accuracy_of(config)))[0]


def test_scenes_are_simulations_once_read(project):
    config = read_config(read_overlay(project / "config/config.yaml"))
    simulations = all_simulations(config)
    assert [*simulations] == [*config.simulations, *config.scenes]
    for name, scene in config.scenes.items():
        (run,), (samples,) = expand(resolve(simulations[name], config.model, accuracy_of(config)))
        found = (run.boundary, run.duration, run.prestress.left)
        assert found == (scene.boundary, scene.duration, scene.left)
        assert samples is not None and {*simulations[name].record} == {"fronts", "fields", "samples"}
