"""Names that were removed are refused with their replacement, which CHANGELOG.md lists too."""

import pytest

import slippulse as sp
from slippulse.model.removed import REMOVED

PROFILE = sp.Prestress(-0.5, 0.0)
OWNERS = {
    "Prestress": PROFILE,
    "Rupture": sp.theory.Rupture(sp.Prestress(0.5, 0.5), 0.65, duration=1.0),
    "ArrestingCrack": sp.theory.ArrestingCrack(PROFILE),
    "theory": sp.theory,
}


@pytest.mark.parametrize("owner", OWNERS)
def test_a_removed_attribute_is_refused_with_its_replacement(owner):
    for name, instead in REMOVED[owner].items():
        with pytest.raises(AttributeError) as refusal:
            getattr(OWNERS[owner], name)
        assert str(refusal.value) == f"{owner}: {name} was removed; write {instead}"
    with pytest.raises(AttributeError, match=r"has no attribute|No slippulse\.theory attribute"):
        _ = OWNERS[owner].no_such_name


def test_a_removed_argument_is_refused_with_its_replacement():
    with pytest.raises(TypeError, match="rate_strengthening was removed; write friction="):
        sp.Scene("stress", PROFILE, 1.0, 0.1, rate_strengthening=0.1)
    with pytest.raises(TypeError, match="unexpected keyword argument 'no_such_name'"):
        sp.Scene("stress", PROFILE, 1.0, 0.1, no_such_name=0.1)


def test_the_list_of_changes_has_every_removed_name(project):
    text = (project / "CHANGELOG.md").read_text(encoding="utf-8")
    for owner, names in REMOVED.items():
        for name, instead in names.items():
            assert f"| `{owner}.{name}` | `{instead}` |" in text
