"""The friction laws by name, and the construction of a law from its name and parameters."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from .checks import check_choice, short_repr
from .friction_laws.law import Coulomb, Friction
from .friction_laws.rate import BoundedRate, LinearRate, RateWeakening
from .friction_laws.weakening import ExponentialWeakening, SlipWeakening

# To add a law, append its class to this tuple.
LAWS: tuple[type[Friction], ...] = (
    Coulomb,
    LinearRate,
    BoundedRate,
    RateWeakening,
    SlipWeakening,
    ExponentialWeakening,
)
LAW_NAMES = tuple(law.law for law in LAWS)
COULOMB = Coulomb()


def friction(law: str, **parameters: float) -> Friction:
    """Make a friction law with its parameters, for `Scene`.

    Parameters
    ----------
    law : {"coulomb", "linear_rate", "bounded_rate", "rate_weakening", "slip_weakening", \
"exponential_weakening"}
        Name of the law. At slip velocity v, and with the slip since the release, friction is

        - "coulomb": 0, as in the paper;
        - "linear_rate": alpha v;
        - "bounded_rate": limit v/(v + v_0);
        - "rate_weakening": the negative of slope v, but not below -limit;
        - "slip_weakening": 1 - slip/d_c, but not below 0;
        - "exponential_weakening": exp(-slip/d_c).

        The scale is that of the pre-stress: 0 is kinetic and 1 is static friction.
    **parameters : float
        The parameters in the formula of the law, by name. The last two laws have d_c, in units of
        U, and also ``nucleation``, in units of H: friction is 0 within this distance from x = 0.

    Returns
    -------
    Friction

    Raises
    ------
    ValueError
        If the law or a parameter is not allowed. The message names the key, the value and what is
        allowed.

    Notes
    -----
    Source: the paper uses the first law, sections II A and IV. The others are an addition of this
    project.

    Examples
    --------
    >>> sp.friction("slip_weakening", d_c=0.1, nucleation=2.0).mapping()
    {'law': 'slip_weakening', 'd_c': 0.1, 'nucleation': 2.0}
    """
    check_choice("law", law, LAW_NAMES)
    law_class = LAWS[LAW_NAMES.index(law)]
    needed = [field.name for field in fields(law_class)]
    missing_or_unknown = set(needed).symmetric_difference(parameters)
    for name in missing_or_unknown:
        value = short_repr(parameters[name]) if name in parameters else "missing"
        allowed = f"{', '.join(needed) or 'no parameter'} with law {law!r}"
        raise ValueError(f"{name}: {value}; allowed: {allowed}")
    return law_class(**parameters)


def friction_from(mapping: Mapping[str, Any]) -> Friction:
    """Make a friction law from a mapping in the form that `Friction.mapping` returns.

    Raises ValueError if the mapping does not name a law or has the wrong parameters.
    """
    if "law" not in mapping:
        raise ValueError(f"law: missing; allowed: {', '.join(LAW_NAMES)}")
    return friction(**mapping)
