"""Claims that are arithmetic: dimensional forms and the damage zone, tested at random parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..theory.dimensional import Layer, damage_zone_stress_drop
from ..theory.front_law import front_speed_undamped
from ..theory.pulse import paper_pulse
from .evidence import Evidence
from .ledger import Claim

# How many random layers a formula is tried on; the seed makes the ledger repeatable.
LAYERS, SEED = 200, 20210501
# Of the host rock, in units of the damage zone's.
THICKNESS = 10.0


def random_layers() -> list[tuple[Layer, float]]:
    """Layers of rock-like properties with a pre-stress each."""
    random = np.random.default_rng(SEED)
    layers = []
    for _ in range(LAYERS):
        kinetic = random.uniform(0.1, 0.7)
        layers.append(
            (
                Layer(
                    thickness=10.0 ** random.uniform(-3, 5),
                    density=random.uniform(1e3, 4e3),
                    lame=10.0 ** random.uniform(6, 11),
                    shear_modulus=10.0 ** random.uniform(6, 11),
                    static_friction=kinetic + random.uniform(0.01, 0.3),
                    kinetic_friction=kinetic,
                    normal_stress=10.0 ** random.uniform(4, 8),
                ),
                random.uniform(0.05, 0.95),
            )
        )
    return layers


def formula_claims(evidence: Evidence) -> list[Claim]:
    """The dimensional peak velocity, transition length and width, and the limit of the damage zone."""
    layers = random_layers()
    rounding = float(np.finfo(float).eps) * 8.0
    source = "theory.Layer"

    def ratio(printed, derived) -> float:
        values = np.array([printed(layer, tau) / derived(layer, tau) for layer, tau in layers])
        return float(values[np.argmax(np.abs(values - 1.0))])

    def length(layer: Layer, tau: float) -> float:
        return 2.0 * np.pi / np.sqrt(layer.gamma * (1.0 - tau**2)) * layer.thickness

    ratios = np.geomspace(1.0, 1e-9, 10)
    drops = damage_zone_stress_drop(1.0, 1.0, 1.0 / ratios, 1.0, THICKNESS)
    return [
        evidence.number(
            "dimensional_peak_velocity",
            "section IV A",
            r"the dimensional peak slip velocity is $(\mu_s-\mu_k)\sigma_n/\sqrt{2G\rho}$",
            1.0,
            ratio(lambda layer, _: layer.printed_peak_velocity(), lambda layer, _: layer.peak_velocity()),
            rounding,
            source,
            "printed over derived from the paper's own $U$ and $T$: a factor 2 is missing",
        ),
        evidence.number(
            "dimensional_transition_length",
            "section IV A",
            r"$L_\mathrm{trans}=2\pi H\sqrt{(\lambda+2G)/2G}\,v_c/v_s$",
            1.0,
            ratio(lambda layer, tau: layer.transition_length(float(front_speed_undamped(tau))), length),
            rounding,
            source,
            "printed over derived",
        ),
        evidence.number(
            "dimensional_width",
            "section IV A",
            r"$W=\pi\tau_0H\sqrt{(\lambda+2G)/2G}\,v_c/v_s$",
            1.0,
            ratio(
                lambda layer, tau: layer.pulse_width(tau, float(front_speed_undamped(tau))),
                lambda layer, tau: paper_pulse(tau, layer.gamma).width * layer.thickness,
            ),
            rounding,
            source,
            "printed over derived",
        ),
        replace(
            evidence.number(
                "damage_zone_limit",
                "section IV C 2, figure 7",
                r"a damage zone much softer than its host rock has the stress drop $G\delta/H$",
                1.0,
                float(drops[-1]),
                rounding,
                "theory.damage_zone_stress_drop",
                r"stress drop over $G\delta/H$",
            ),
            further={"$G/G_r$": float(ratios[-1]), "$H_r/H$": THICKNESS},
        ),
    ]
