"""Keys of the configuration whose old name is read for one more version."""

import pytest

from slippulse_paper.configuration.problems import ConfigError
from slippulse_paper.configuration.read import read_config
from slippulse_paper.configuration.renamed_keys import rename_warnings


def test_an_old_name_sets_the_new_key_with_a_warning(shipped):
    old, new = {"measure": {"share": 0.9}}, {"measure": {"fraction": 0.9}}
    configs = [read_config(shipped, [overlay], every_run=False) for overlay in (old, new)]
    assert configs[0].given() == configs[1].given()
    assert configs[0].measure.fraction == 0.9
    (line,) = rename_warnings([old, new, old])
    assert line.startswith("measure.share is now measure.fraction;")
    assert rename_warnings([new, {}, {"measure": 1}]) == []


def test_an_old_name_on_the_command_line_is_read_too(shipped):
    config = read_config(shipped, (), {"measure": {"share": "0.9"}}, every_run=False)
    assert config.measure.fraction == 0.9


def test_an_old_and_a_new_name_together_are_refused(shipped):
    both = {"measure": {"share": 0.9, "fraction": 0.8}}
    with pytest.raises(ConfigError, match=r"measure\.share: 0\.9.*allowed: .*measure\.fraction"):
        read_config(shipped, [both], every_run=False)


def test_a_refused_value_is_reported_under_the_new_name(shipped):
    with pytest.raises(ConfigError, match=r"measure\.fraction: 1\.5; allowed: .*> 0 and < 1"):
        read_config(shipped, [{"measure": {"share": 1.5}}], every_run=False)
