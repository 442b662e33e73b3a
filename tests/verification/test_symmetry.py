"""What must not change a result: the mirror, half the lattice, the size of the first lattice, the length of a call."""

import pytest
import tolerances as tol

import slippulse as sp
from slippulse.solver import lattice
from slippulse.solver.fixed_step import LATTICES

FIELDS = ("release_time", "stick_time", "slip", "slip_velocity", "slip_acceleration")
COUNTS = ("releases", "sticks", "re_releases")
NUMBERS = (
    "work_of_prestress", "kinetic_energy", "elastic_energy", "leaf_spring_energy", "viscous_loss",
    "min_stuck_stress", "first_stick_time",
)  # fmt: skip
# The peak is a little above 1: bumps add to it.
UNEVEN = sp.Prestress(0.25, 0.6, peak=1.05, steps=((4.0, 0.4),), bumps=((-3.0, -0.3, 0.5),))
MIRRORED = sp.Prestress(0.6, 0.25, peak=1.05, steps=((-4.0, 0.4),), bumps=((3.0, -0.3, 0.5),))
EVEN = sp.Prestress(0.4, 0.4, peak=1.05, bumps=((5.0, -0.5, 0.7), (-5.0, -0.5, 0.7)))


def simulated(
    profile, boundary="displacement", scheme="localised", ratio=0.1, progress=None, **changes
):
    gamma = 0.65 if boundary == "displacement" else 0.0
    values = {
        "duration": 8.0,
        "gamma": gamma,
        "beta": ratio * 0.05,
        "scheme": scheme,
        "max_step": 0.3,
    }
    return sp.simulate(sp.Scene(boundary, profile, dx=0.05, **values | changes), progress=progress)


def assert_equal_but_for_rounding(one, two) -> None:
    assert one.attrs["releases"] > 100
    for name in ("x", *FIELDS):
        tolerance = 0.0 if name == "x" else tol.MIRROR
        assert one[name].values == pytest.approx(
            two[name].values, rel=0, abs=tolerance, nan_ok=True
        ), name
    for name in NUMBERS:
        assert one.attrs[name] == pytest.approx(
            two.attrs[name], rel=1e3 * tol.MIRROR, nan_ok=True
        ), name


@pytest.mark.parametrize("ratio", [0.0, 0.1])
@pytest.mark.parametrize("scheme", LATTICES)
@pytest.mark.parametrize("boundary", ["displacement", "stress"])
def test_the_mirror_image_and_half_the_lattice_give_the_same(boundary, scheme, ratio):
    case = boundary, scheme, ratio
    one, two = simulated(UNEVEN, *case), simulated(MIRRORED, *case).isel(x=slice(None, None, -1))
    assert_equal_but_for_rounding(one, two.assign_coords(x=-two["x"]))
    assert [one.attrs[name] for name in COUNTS] == [two.attrs[name] for name in COUNTS]
    half, whole = simulated(EVEN, *case), simulated(EVEN, *case, half_lattice=False)
    assert half.attrs["half_lattice_used"] == 1 and whole.attrs["half_lattice_used"] == 0
    assert_equal_but_for_rounding(half, whole)


@pytest.mark.parametrize("scheme", LATTICES)
@pytest.mark.parametrize("profile", [EVEN, UNEVEN], ids=["even", "uneven"])
def test_the_first_size_and_the_length_of_a_call_do_not_change_a_bit(monkeypatch, profile, scheme):
    whole = simulated(profile, scheme=scheme)
    for name, value in {"FIRST_BLOCKS": 16, "PAGE": 8, "BEYOND_PAGES": 3, "CALL_STEPS": 7}.items():
        monkeypatch.setattr(lattice, name, value)
    shares = []
    grown = simulated(profile, scheme=scheme, progress=shares.append)
    assert grown.equals(whole)
    assert grown.attrs["block_updates"] == whole.attrs["block_updates"]
    assert len(shares) > 10
    assert shares == sorted(shares) and shares[0] > 0.0 and shares[-1] <= 1.0
