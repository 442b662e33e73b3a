"""The mirror, half the lattice, its first size and the length of a call do not change a result."""

import pytest
import tolerances as tol

import slippulse as sp
from slippulse.solver import lattice
from slippulse.solver.fixed_step import LATTICES

FIELDS = ("release_time", "stick_time", "slip", "slip_velocity", "slip_acceleration")
COUNTS = ("releases", "sticks", "re_releases")
ENERGIES = ("work_of_prestress", "kinetic_energy", "elastic_energy", "leaf_spring_energy")
NUMBERS = (*ENERGIES, "viscous_loss", "min_stuck_stress", "first_stick_time")
# The peak is a little above 1: bumps add to it.
UNEVEN = sp.Prestress(0.25, 0.6, peak=1.05, steps=((4.0, 0.4),), bumps=((-3.0, -0.3, 0.5),))
MIRRORED = sp.Prestress(0.6, 0.25, peak=1.05, steps=((-4.0, 0.4),), bumps=((3.0, -0.3, 0.5),))
EVEN = sp.Prestress(0.4, 0.4, peak=1.05, bumps=((5.0, -0.5, 0.7), (-5.0, -0.5, 0.7)))


def simulated(
    profile, boundary="displacement", scheme="localised", ratio=0.1, progress=None, **changes
):
    gamma = 0.65 if boundary == "displacement" else 0.0
    values = {"gamma": gamma, "beta": ratio * 0.05, "scheme": scheme, "max_step": 0.3} | changes
    return sp.simulate(sp.Scene(boundary, profile, 8.0, 0.05, **values), progress=progress)


def assert_equal_but_for_rounding(one, two) -> None:
    assert one.attrs["releases"] > 100
    for name in ("x", *FIELDS):
        tolerance = {"rel": 0.0, "abs": 0.0 if name == "x" else tol.MIRROR, "nan_ok": True}
        assert one[name].values == pytest.approx(two[name].values, **tolerance), name
    for name in NUMBERS:
        expected = pytest.approx(two.attrs[name], rel=1e3 * tol.MIRROR, nan_ok=True)
        assert one.attrs[name] == expected, name


@pytest.mark.parametrize("ratio", [0.0, 0.1])
@pytest.mark.parametrize("scheme", LATTICES)
@pytest.mark.parametrize("boundary", ["displacement", "stress"])
def test_the_mirror_image_and_half_the_lattice_give_the_same(boundary, scheme, ratio):
    case = boundary, scheme, ratio
    one, two = simulated(UNEVEN, *case), simulated(MIRRORED, *case).isel(x=slice(None, None, -1))
    assert_equal_but_for_rounding(one, two.assign_coords(x=-two["x"]))
    assert [one.attrs[name] for name in COUNTS] == [two.attrs[name] for name in COUNTS]
    half, full = simulated(EVEN, *case), simulated(EVEN, *case, half_lattice=False)
    assert half.attrs["half_lattice_used"] == 1 and full.attrs["half_lattice_used"] == 0
    assert_equal_but_for_rounding(half, full)


@pytest.mark.parametrize("scheme", LATTICES)
@pytest.mark.parametrize("profile", [EVEN, UNEVEN], ids=["even", "uneven"])
def test_the_first_size_and_the_length_of_a_call_do_not_change_a_bit(monkeypatch, profile, scheme):
    plain = simulated(profile, scheme=scheme)
    for name, value in {"FIRST_BLOCKS": 16, "PAGE": 8, "BEYOND_PAGES": 3, "CALL_STEPS": 7}.items():
        monkeypatch.setattr(lattice, name, value)
    fractions = []
    grown = simulated(profile, scheme=scheme, progress=fractions.append)
    assert grown.equals(plain)
    assert grown.attrs["block_updates"] == plain.attrs["block_updates"]
    assert len(fractions) > 10
    assert fractions == sorted(fractions) and fractions[0] > 0.0 and fractions[-1] <= 1.0
