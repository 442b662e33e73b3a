"""The laws of friction by name, and the law that a mapping or a data file names."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from .checks import check_choice, short_repr
from .friction_laws.law import Coulomb, Friction
from .friction_laws.rate import BoundedRate, LinearRate, RateWeakening
from .friction_laws.weakening import ExponentialWeakening, SlipWeakening

# A new law is one more line here.
LAWS: tuple[type[Friction], ...] = (
    Coulomb,
    LinearRate,
    BoundedRate,
    RateWeakening,
    SlipWeakening,
    ExponentialWeakening,
)
NAMES = tuple(law.law for law in LAWS)
COULOMB = Coulomb()


def friction(law: str, **parameters: float) -> Friction:
    """A law of friction with its parameters, for `Scene`.

    Parameters
    ----------
    law : {"coulomb", "linear_rate", "bounded_rate", "rate_weakening", "slip_weakening", \
"exponential_weakening"}
        0 (the paper's); alpha v; F v/(v + v_0); -min(a v, F); 1 - slip/d_c, but not below 0;
        exp(-slip/d_c). Friction is in units of the stress drop, above the kinetic one.
    **parameters : float
        "linear_rate": alpha. "bounded_rate": limit (F) and v_0. "rate_weakening": slope (a) and
        limit (F). The two last: d_c, in units of U, and nucleation, the half-length around x = 0,
        in units of H, where friction is 0.

    Returns
    -------
    Friction

    Raises
    ------
    ValueError
        One line that names the key, the value and what is allowed.

    Notes
    -----
    Source: an addition of this project; the paper has the first law, sections II A and IV.

    Examples
    --------
    >>> sp.friction("slip_weakening", d_c=0.1, nucleation=2.0).mapping()
    {'law': 'slip_weakening', 'd_c': 0.1, 'nucleation': 2.0}
    """
    check_choice("law", law, NAMES)
    kind = LAWS[NAMES.index(law)]
    needed = [field.name for field in fields(kind)]
    for name in {*needed} ^ {*parameters}:
        value = f"{name}: {short_repr(parameters[name]) if name in parameters else 'missing'}"
        raise ValueError(f"{value}; allowed: law {law!r} with {', '.join(needed) or 'nothing'}")
    return kind(**parameters)


def friction_from(mapping: Mapping[str, Any]) -> Friction:
    """The law of a mapping as `Friction.mapping` returns it, or ValueError."""
    if "law" not in mapping:
        raise ValueError(f"law: missing; allowed: {', '.join(NAMES)}")
    return friction(**mapping)
