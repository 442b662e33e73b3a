"""Wrong input is refused before any job: one line that names the key, the value and what is allowed."""

import re
import warnings

import pytest

from slippulse.configuration.expand import expand
from slippulse.configuration.limits import HOW_TO_GO_ON, bound_of_sweep
from slippulse.configuration.problems import ConfigError
from slippulse.configuration.read import LARGEST_FILE, main, read_config, read_overlay
from slippulse.configuration.resolve import accuracy_of, all_simulations, resolve

# Enough of the shipped simulations for every case, so that a refusal of scenes is quick.
KEPT = (
    "steady_displacement", "space_time_displacement", "space_time_stress", "burridge_knopoff_stress", "steady_stress",
)  # fmt: skip
# What the key of a row may begin with: a shipped simulation, or one that is there before the row is laid over.
SHORT = {"steady": "simulations.steady_displacement", "stress": "simulations.space_time_stress"}
SPRINGS = (
    "boundary: displacement, duration: {time: 10.0}, record: [fronts], left: [0.5], right: same"
)
ADDED = {
    "springs": SPRINGS,
    "level": f"{SPRINGS}, gamma: [0.5]",
    "held": "boundary: stress, left: [-1.0], record: [fronts]",
    "profile": "boundary: stress, record: [fronts], duration: {time: 1.0}",
}
SHORT |= {name: f"simulations.{name}" for name in ADDED}
SCENE = "{title: a, boundary: stress, left: 0.5, right: 0.5, duration: 1.0}"
MANY = "[" + ", ".join(f"{0.001 * i:.3f}" for i in range(1, 801)) + "]"

# Key and value of an overlay (without a key the whole of it), and what the refusal must name besides the key: the
# value, what is allowed, the remedy.
MISTAKES = r"""
 | {simulation: {}, colour: red} | simulation: unknown key (did you mean 'simulations'?) | colour: unknown key
steady.gama         | [0.3] | did you mean 'gamma'
model.dampingratio  | 0.1 | did you mean 'damping_ratio'
measure.shares      | 0.9 | did you mean 'share'
figures.fig07_damage_zon | {} | did you mean 'fig07_damage_zone'
simulations.steady_displacment | {gamma: [0.3]} | steady_displacment.boundary | did you mean 'steady_displacement'
presets.drafts      | {dx: 0.1} | did you mean 'draft'
preset              | papre | 'papre' | did you mean 'paper' | draft, paper, reference
published.front_speed.simulation | space_time_displacemnt | did you mean 'space_time_displacement'
steady.gamma        | 0.3 | gamma: 0.3 | a list of different numbers
presets.paper       | {dx: '0.01', order: 4.5, whole: yes} | dx: '0.01'; allowed: a number > 0 and <= 1 \
     | without quotes | order: 4.5; allowed: a whole number from 3 to 8 | whole: 'yes'; allowed: true or false
model               | {release: both, scheme: euler} | release: 'both'; allowed: total, elastic \
     | scheme: 'euler'; allowed: localised, fixed_step, continuum
model               | {friction_ratio: '5,5', damping_ratio: [0.1]} | friction_ratio: '5,5' | write 5.5 \
     | model.damping_ratio: [0.1] | a number >= 0
model.damping_ratio | true | model.damping_ratio: True | a number >= 0
model.damping_ratio | null | model.damping_ratio: missing | null removes a key
simulations         | [1, 2] | simulations: [1, 2] | a mapping
steady.duration     | long | duration: 'long' | one of time
preset              | 3 | preset: 3 | the name of a preset
model.friction_ratio | 1:30 | friction_ratio: '1:30' | a number >= 0
studies             | extremes | studies: 'extremes' | a list of different names
steady              | {left: [1.0]} | prestress.left: 1.0 | < 1
steady              | {boundary: free, record: [everything]} | boundary: 'free'; allowed: displacement, stress \
     | record.0: 'everything'; allowed: fronts, fields, samples
steady              | {damping_ratio: [-0.1], gamma: [0.0], left: [.nan]} \
     | damping_ratio.0: -0.1; allowed: a number >= 0 | gamma.0: 0.0; allowed: a number > 0 \
     | left.0: nan; allowed: a finite number
presets.paper       | {dx: -0.1, order: 9, coarser: [2.0]} | dx: -0.1; allowed: a number > 0 \
     | order: 9; allowed: a whole number from 3 to 8 | coarser: [2.0]; allowed: two different factors
measure.share       | .inf | measure.share: inf | a finite number
measure.share       | 1.5 | measure.share: 1.5 | > 0 and < 1
steady              | {gamma: [], left: [0.5, 0.5], chunks: 0} \
     | gamma: []; allowed: a list of different numbers > 0, at least one \
     | left: [0.5, 0.5]; allowed: a list of different | chunks: 0; allowed: a whole number from 1 to 1000
steady.duration.time | 0.0 | duration.time: 0.0 | > 0
steady.record       | [fields] | record: ['fields'] | a list of fronts (always
accuracy            | 0.5 | accuracy: 0.5 | from 0.0001 to 0.1
accuracy            | 1.0e-7 | accuracy: 1e-07 | from 0.0001 to 0.1
measure.front_window | 1.0e-6 | measure.front_window: 1e-06 | >= 0.05 and < 1
simulations.steady_stress.profiles | [{left: -1.0, right: 0.0}, {left: -1.0, right: 0.0}] | different
steady.chunks       | 1001 | chunks: 1001 | from 1 to 1000
steady.chunks       | 13 | displacement.chunks: 13 | the number of runs, 12
steady              | {gamma: [1.0e+300]} | steady_displacement
steady.gamma        | [1.0e+200] | steady_displacement.gamma: 1e+200
steady.gama         | null | steady_displacement.gama: null | did you mean 'gamma'
simulations.steady_displacment | null | steady_displacment: null | did you mean 'steady_displacement'
simulations.steady_displacement | null | steady_displacement: null | what is shipped stays
preset              | null | preset: missing | null removes a key | draft, paper, reference
presets.paper.dx    | null | presets.paper.dx: missing | null removes a key
steady.gamma        | [null] | gamma.0: None | a number > 0
scenes.barier       | null | scenes.barier: null | did you mean 'barrier'
published.front_speed.quantity | front_speed_rigt | 'front_speed_rigt' | did you mean 'front_speed_right'
 | simulations: {space_time_displacement: {record: [fronts], samples: null}} \
     | published.velocity_displacement.quantity: 'largest_velocity' | this takes record: [fronts, fields]
level.samples       | {times: 2, positions: 1, extent: 0.0} | samples: given, but not recorded | samples in record
springs             | {gamma: [0.5], record: [fronts, samples]} | springs.samples: missing
springs             | {} | springs.gamma: missing
springs             | {gamma: [0.5], left: null} | springs.left, right: missing
stress.gamma        | [0.5] | space_time_stress.gamma: [0.5] | left out under
level.profiles      | [{left: 0.5, right: 0.5}] | level.profiles | one or the other
steady.beta         | [0.001] | damping_ratio | one or the other
level               | {dx: [0.1], spacing: {scale: 2.0}} | level.dx | spacing | one or the other
level.spacing       | {fixed: 0.1, scale: 2.0} | level.spacing.fixed: given with others | alone
steady.duration     | {half_periods: 3.0} | one of time
held                | {right: [0.0], duration: {half_periods: 1.0}} | duration.half_periods | displacement
held                | {right: [0.2], duration: {balance_distances: 2.0}} | but right: 0.2 | allowed: 0
steady.duration     | {time: null, balance_distances: 2.0} | balance_distances: 2.0 times |x_minus|, but right: 0.2
figures.fig07_damage_zone.stiffness_ratios | {from: 2.0} | stiffness_ratios.to: 1.0 | > from = 2
 | {accuracy: 1.0e-2, model: {scheme: fixed_step}} | model.scheme: 'fixed_step' | 'localised' where accuracy is given
 | {accuracy: 1.0e-2, scenes: {barrier: {scheme: fixed_step}}} | barrier.scheme: 'fixed_step' | 'localised' where
 | {accuracy: 1.0e-2, simulations: {steady_displacement: {rate_strengthening: [0.2]}}} \
     | steady_displacement.rate_strengthening: [0.2] | allowed: 0 where accuracy is given
 | {accuracy: 1.0e-2, simulations: {steady_displacement: {damping_ratio: [3.0]}}} | damping_ratio: 3.0 | <= 1
profile | {profiles: [{left: 0.5, right: 0.5, peak: 0.9}]} | profile.peak: 0.9 | at most 0.9 (dx | reaches 1 somewhere
profile | {profiles: [{left: -0.2, right: 0.0, bumps: [[-3.0, -0.8, 0.7]]}]} | peak: 1, | at most 0.9999178 | reaches 1
profile | {profiles: [{left: 0, right: 0, peak: 0, bumps: [[0.003, 1, 1.0e-4]]}]} | profile.peak: 0, | reaches 1
 | simulations: {burridge_knopoff_stress: {width: [0.5]}} | prestress.width: 0.5 | >= dx = 1
steady              | {max_step: 3.0} | max_step: 3.0 | stability bound
level               | {width: [0.3], dx: [0.1]} | prestress.width: 0.3 | 4 times coarser of the grid study
springs             | {gamma: [1.0], left: [0.1], dx: [0.5]} | blocks: 8, | at least 4 blocks: a smaller dx
scenes.barrier.peak | 0.9 | scenes.barrier.peak: 0.9 | reaches 1
scenes.barrier.gama | 0.3 | did you mean 'gamma'
scenes.bariere      | {gamma: 0.3} | scenes.bariere.boundary | did you mean 'barrier'
scenes.barrier.chunks | 2 | scenes.barrier.chunks: unknown key
scenes.steady_displacement | <scene> | also the name of a simulation | another name
scenes.index        | <scene> | another file of that name is there | neither index nor SCENE_numbers
scenes.barrier_numbers | <scene> | another file of that name is there | neither index nor SCENE_numbers
scenes.barrier.title | ' ' | title: ' ' | not blank
scenes.barrier.title | "\a bell" | title: '\x07 bell' | printable
scenes.barrier.title | "a\nb" | title: 'a\nb' | one line
scenes.barrier      | {beta: 0.1, damping_ratio: 0.1} | barrier.beta | one or the
figures.fig07_damage_zone.stiffness_ratios | {from: 5.0e-324, to: 1.0e+308, count: 1000000000} \
     | from: 5e-324; allowed: a number from 1e-6 to 1e6 | to: 1e+308 | count: 1000000000 | from 2 to 10000
claims.pulse_slip.kind | exact | claims.pulse_slip.kind: unknown key
figures.fig01_system_sketch.thickness | 1.0e+308 | thickness: 1e+308 | 0.01 to 100
 | simulations: {123: {boundary: stress}} | simulations: '123' | begins with a letter
 | scenes: {../barrier: {}} | '../barrier' | lower-case letters
 | simulations: {../../etc/passwd: {}} | '../../etc/passwd' | lower-case letters
 | simulations: {$(touch written): {}} | '$(touch written)' | lower-case letters
 | simulations: {"a\nb": {}} | 'a\nb' | lower-case letters
 | simulations: {<long>: {}} | 'aaaa | ...
preset              | '`touch written`' | preset: '`touch written`' | draft, paper, reference
preset              | "paper\ndraft" | 'paper\ndraft' | draft, paper, reference
preset              | "draft'" | preset: "draft'" | did you mean 'draft'
"""

# Sweeps that take too much, and what the refusal of their job names.
EXPENSIVE = """
held                | {left: [0.9999], right: same, damping_ratio: [1.0], dx: [0.01], duration: {time: 60.0}} \
     | block updates; allowed: 4e+13
level               | {width: [1.0e+9], dx: [0.01]} | block updates
level               | {damping_ratio: [1.0e+4], dx: [0.001]} | block updates
steady              | {left: <many>, gamma: <many>} | 1.92e+06 runs; allowed: 2e+04
steady              | {duration: {time: 1.0e+6}} | block updates
stress              | {samples: {times: 100000, positions: 100000}} | bytes
steady              | {chunks: 3, left: <many>, gamma: <many>} | 6.4e+05 runs in each of 3 chunks; allowed: 2e+04
steady              | {chunks: 1000, left: <many>, gamma: <many>} | 1.92e+03 runs in each of 1000 chunks; allowed: 1e+03
"""

# What the command line may not say.
SAID = """
allow_large         | maybe | 'maybe'; allowed: true or false
allow_large         | 2     | 2; allowed: true or false
model.damping_ratio | 1:30  | '1:30'; allowed: a number >= 0
model.damping_ratio | much  | 'much'; allowed: a number >= 0
preset              | &a    | '&a'; allowed: a plain value
preset              | draft' | "draft'" (did you mean 'draft'?); allowed: draft, paper, reference
"""

# Files that are no overlay at all.
LAUGHS = b"".join(b"a%d: &a%d [%s*a0]\n" % (i, i, b"*a%d, " % (i - 1) * 10) for i in range(1, 30))
FILES = [
    (b"just some text\n", "'just some text'", "a mapping of keys"),
    (b"- preset\n- draft\n", "['preset', 'draft']", "a mapping of keys"),
    (b"42\n", "42", "a mapping of keys"),
    (b"# nothing\n", "None", "a mapping of keys"),
    (b"model: {damping_ratio: }", "line 1", "no value", "null, which removes the key"),
    (b"preset: [draft\n", "not YAML", "line 2"),
    (b"simulations:\n\tmine: 1\n", "not YAML", "line 2"),
    (b"\x89PNG\r\n\x1a\n\xff\xfe", "not text"),
    (b"preset: !!python/object/apply:os.system [touch written]\n", "line 1", "no tags"),
    (b"preset: !preset draft\n", "line 1", "'!preset'", "no tags"),
    (b"model: &a {release: total}\nmeasure: *a\n", "line 1", "anchor or alias"),
    (b"__use_yte__: true\n?if True:\n  preset: draft\n", "a template"),
    (b"preset: draft\npreset: paper\n", "line 2", 'duplicate key "preset"', "each key once"),
    (b"{[1, 2]: 3}", "line 1", "a collection as a key", "text"),
    (b"preset: draft\n---\npreset: paper\n", "line 2", "another document"),
    (b"[" * 1000, "nested too deeply"),
    (b"# " + b"x" * LARGEST_FILE, f"more than {LARGEST_FILE} bytes"),
    (b"a0: &a0 [x]\n" + LAUGHS, "anchor or alias"),
]

# Sweeps that are altered, with a key that is then gone.
ALTERED = """
steady              | {damping_ratio: null, beta: [0.001]} | damping_ratio
steady              | {boundary: stress, gamma: null, left: [0.3], right: same} | gamma
steady              | {duration: {time: null, half_periods: 3.0}}
steady              | {scheme: continuum, spacing: null}
simulations.steady_stress | {profiles: null, left: [-0.5], right: [0.0]} | profiles
"""


def rows(table: str) -> list[list[str]]:
    """The cells of each line that is not empty, the first with the whole key, and what is in angles written out."""
    for name, text in {"\\\n": "", "<scene>": SCENE, "<many>": MANY, "<long>": "a" * 900}.items():
        table = table.replace(name, text)
    cells = [
        [cell.strip() for cell in f" {line}".split(" | ")] for line in table.splitlines() if line
    ]
    return [
        [re.sub(r"^\w+", lambda key: SHORT.get(key[0], key[0]), row[0]), *row[1:]] for row in cells
    ]


def of_rows(table: str):
    return pytest.mark.parametrize("row", rows(table), ids=lambda row: f"{row[0]} {row[1]}"[:60])


@pytest.fixture(scope="module")
def shipped(project) -> dict:
    config = read_overlay(project / "config/config.yaml")
    config["simulations"] = {name: config["simulations"][name] for name in KEPT}
    return config


def overlaid(tmp_path, text: str) -> dict:
    (tmp_path / "mine.yaml").write_text(text, encoding="utf-8")
    return read_overlay(tmp_path / "mine.yaml")


def read_row(shipped, tmp_path, key: str, value: str):
    """The configuration with a value at a key."""
    added = [
        f"simulations: {{{name}: {{{ADDED[name]}}}}}"
        for name in ADDED
        if f"simulations.{name}" in key
    ]
    text = ": {".join(key.split(".")) + f": {value}" + "}" * key.count(".") if key else value
    return read_config(shipped, [overlaid(tmp_path, overlay) for overlay in (*added, text)])


def assert_one_clear_message(message: str, named: list[str]) -> None:
    for part in named:
        assert part in message
    for line in message.splitlines():
        assert re.search(r"allowed: |it is required", line) and len(line) < 400, line
    assert len(message.splitlines()) <= 6 and "Traceback" not in message


@of_rows(MISTAKES)
def test_a_mistake_in_an_overlay_is_refused(shipped, tmp_path, row):
    key, value, *named = row
    with pytest.raises(ConfigError) as refusal, warnings.catch_warnings():
        warnings.simplefilter("error")
        read_row(shipped, tmp_path, key, value)
    assert_one_clear_message(str(refusal.value), [key, *named])
    assert [path.name for path in tmp_path.iterdir()] == ["mine.yaml"]


def bound_and_chunks(config, name: str):
    sweep = all_simulations(config)[name]
    return bound_of_sweep(
        resolve(sweep, config.model, accuracy_of(config)), sweep.chunks
    ), sweep.chunks


@of_rows(EXPENSIVE)
def test_a_sweep_that_takes_too_much_is_refused(shipped, tmp_path, row):
    key, value, said = row
    bound, chunks = bound_and_chunks(read_row(shipped, tmp_path, key, value), key.split(".")[1])
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


@pytest.mark.parametrize("file", FILES, ids=lambda file: file[1])
def test_a_file_that_is_no_overlay_is_refused(tmp_path, file, capsys):
    content, *named = file
    (tmp_path / "mine.yaml").write_bytes(content)
    assert main([str(tmp_path / "mine.yaml")]) == 1
    heading, message = capsys.readouterr().err.split("\n", 1)
    assert heading == "The configuration is refused:" and message.count("\n") == 1
    assert_one_clear_message(message, [f"{tmp_path}/mine.yaml: ", *named])


def test_scalars_are_what_yaml_and_json_say(tmp_path):
    scalars = {
        "1": 1, "-2.5": -2.5, ".5": 0.5, "1e-3": 1e-3, "0x10": 16, "true": True, "null": None, "010": 10,
        "'010'": "010", "yes": "yes", "total": "total", "1:30": "1:30", "1.": 1.0,
    }  # fmt: skip
    for text, value in scalars.items():
        read = overlaid(tmp_path, f"key: {text}\n")["key"]
        assert read == value and type(read) is type(value)
    # JSON is YAML.
    assert overlaid(tmp_path, '{"presets": {"paper": {"dx": 1e-2}}}') == {
        "presets": {"paper": {"dx": 0.01}}
    }


def test_the_command_line_sets_nested_values_and_says_a_switch_in_words(shipped):
    nested = {"damping_ratio": "0.2", "release": "elastic"}
    config = read_config(shipped, (), {"model": nested, "accuracy": "1e-2"})
    assert (config.model.damping_ratio, config.model.release) == (0.2, "elastic")
    assert config.model.scheme == shipped["model"]["scheme"] and config.accuracy == 0.01
    words = {1: True, "yes": True, "on": True, "true": True, 0: False, "no": False, "False": False}
    for said, meant in words.items():
        assert read_config(shipped, (), {"allow_large": said}, every_run=False).allow_large is meant


@of_rows(SAID)
def test_what_the_command_line_may_not_say(shipped, row):
    key, given, named = row
    for part in reversed(key.split(".")):
        given = {part: given}
    with pytest.raises(ConfigError, match=re.escape(f"{key}: {named}")):
        read_config(shipped, (), given)


@of_rows(ALTERED)
def test_a_shipped_sweep_can_be_altered(shipped, tmp_path, row):
    key, value, *gone = row
    config = read_row(shipped, tmp_path, key, value)
    simulation = config.simulations[key.split(".")[1]]
    assert not {*gone} & {*simulation.given()}
    assert expand(resolve(simulation, config.model, accuracy_of(config)))[0]


def test_scenes_are_simulations_once_read(project):
    config = read_config(read_overlay(project / "config/config.yaml"))
    simulations = all_simulations(config)
    assert [*simulations] == [*config.simulations, *config.scenes]
    for name, scene in config.scenes.items():
        (run,), (samples,) = expand(resolve(simulations[name], config.model, accuracy_of(config)))
        expected = (scene.boundary, scene.duration, scene.left)
        assert (run.boundary, run.duration, run.prestress.left) == expected
        assert samples is not None and {*simulations[name].record} == {
            "fronts",
            "fields",
            "samples",
        }
