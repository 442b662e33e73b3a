"""Claims that are arithmetic: each formula beside the one derived from the paper's equations, at random parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.polynomial import polynomial as poly

from ..theory.dimensional import Layer, damage_zone_stress_drop
from ..theory.front_law import front_speed_undamped, lattice_front_speed
from ..theory.pulse import paper_pulse
from .evidence import Evidence, compared
from .ledger import Claim

# How many random layers a formula is tried on; the seed makes the ledger repeatable.
LAYERS, SEED = 200, 20210501
# Of the host rock, in units of the damage zone's.
THICKNESS = 10.0
# Polynomials in position, and in height, that stand for any displacement.
DEGREE = 4


def random_layers() -> list[tuple[Layer, float, np.random.Generator]]:
    """Layers of rock-like properties, each with a pre-stress and a generator of its own."""
    random = np.random.default_rng(SEED)
    layers = []
    for i in range(LAYERS):
        kinetic = random.uniform(0.1, 0.7)
        layer = Layer(
            thickness=10.0 ** random.uniform(-3, 5), density=random.uniform(1e3, 4e3),
            lame=10.0 ** random.uniform(6, 11), shear_modulus=10.0 ** random.uniform(6, 11),
            static_friction=kinetic + random.uniform(0.01, 0.3), kinetic_friction=kinetic,
            normal_stress=10.0 ** random.uniform(4, 8),
        )  # fmt: skip
        layers.append((layer, random.uniform(0.05, 0.95), np.random.default_rng([SEED, i])))
    return layers


def farthest(ratios: Iterable[float]) -> float:
    """The ratio that is farthest from 1."""
    found = np.array([float(ratio) for ratio in ratios])
    return float(found[np.argmax(np.abs(found - 1.0))])


def relative(one, other) -> float:
    """1 + the largest difference of two fields over the largest of them."""
    one, other = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return 1.0 + float(np.max(np.abs(one - other)) / np.max(np.abs(other)))


def formula_claims(evidence: Evidence) -> list[Claim]:
    """Reduction to one dimension, scales, closed forms, dimensional forms, damage zone, blocks and springs."""
    layers = random_layers()

    def claim(id: str, ratio: Callable, source: str, note: str = "") -> Claim:
        return evidence.arithmetic(id, source, farthest(ratio(*layer) for layer in layers), note)

    here = "claims.formulas, at random parameters"
    theory, printed = "theory.Layer, at random parameters", "printed over derived"
    return [
        claim("layer_average", layer_average, here, "any polynomial for the displacement"),
        claim("displacement_reduction", displacement_reduction, here,
              "without the curvature of the imposed displacement, whose printed sign has no consequence"),
        claim("prestress_is_initial_displacement", initial_displacement, here),
        claim("nondimensional_form", nondimensional_form, here, "every coefficient, under both boundary conditions"),
        claim("units_wave_speed", wave_speed, here, r"phase speed at the wavenumber $k$ over $\sqrt{1+\gamma/k^2}$"),
        claim("static_threshold", static_threshold, theory, "forwards"),
        claim("pulse_algebra", pulse_algebra, here, "equation of motion, the four end conditions, and each derivative"),
        claim("transition_estimate_algebra", transition_estimate, here,
              "slip and velocity at that time; the velocity is zero there, which is the first stick"),
        claim("dimensional_transition_length", lambda layer, tau, _: layer.transition_length(speed(tau))
              / (2.0 * np.pi / np.sqrt(layer.gamma * (1.0 - tau**2)) * layer.thickness), theory, printed),
        claim("dimensional_width", lambda layer, tau, _: layer.pulse_width(tau, speed(tau))
              / (paper_pulse(tau, layer.gamma).width * layer.thickness), theory, printed),
        claim("dimensional_peak_velocity", lambda layer, *_: layer.printed_peak_velocity() / layer.peak_velocity(),
              theory, f"{printed} from the paper's own $U$ and $T$: a factor two is missing"),
        claim("transition_length_scales_with_H", twice_as_thick, theory, "twice the thickness, over twice the length"),
        claim("damage_zone_stress_drop", layers_in_series, here, "stress drop of two layers in series"),
        damage_zone_limit(evidence),
        chain_speed(evidence, claim(
            "burridge_knopoff_identity", blocks_and_springs, f"{here}; burridge_knopoff_speed: front_speed_right",
            "force on each block of a random chain, over that of the difference scheme; beside it the front speed of"
            " the runs and the exact one of such a chain",
        )),
    ]  # fmt: skip


def speed(tau: float) -> float:
    return float(front_speed_undamped(tau))


def layer_average(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """Mean over the height of the divergence of stress against equation (3), at u_y = 0."""
    u = random.normal(size=(DEGREE + 1, DEGREE + 1))  # powers of x, powers of y/H
    height, x = layer.thickness, random.uniform(-1.0, 1.0)
    in_x = poly.polyval(x, u), poly.polyval(x, poly.polyder(u, 2, axis=0))
    strain_y = poly.polyder(in_x[0])
    mean = poly.polyint(in_x[1])
    moduli = layer.modulus, layer.shear_modulus / height**2
    # The mean of both terms by a quadrature that is exact for these degrees.
    nodes, weights = np.polynomial.legendre.leggauss(DEGREE)
    y = 0.5 * (nodes + 1.0)
    inside = moduli[0] * poly.polyval(y, in_x[1]) + moduli[1] * poly.polyval(y, poly.polyder(strain_y))
    averaged = 0.5 * float(weights @ inside)
    faces = moduli[1] * (poly.polyval(1.0, strain_y) - poly.polyval(0.0, strain_y))
    scale = abs(moduli[0] * poly.polyval(1.0, mean)) + abs(faces)
    return 1.0 + (averaged - (moduli[0] * poly.polyval(1.0, mean) + faces)) / scale


def displacement_reduction(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """Mean of a linear profile under a held top, in the averaged balance, against equation (A8)."""
    slip, curvature, acceleration, held = random.normal(size=4)
    mean_curvature, mean_acceleration = 0.5 * curvature, 0.5 * acceleration
    height = layer.thickness
    # Averaged balance times H: inertia, stiffness, shear stress at the top less that at the bottom.
    shear = layer.shear_modulus * (held - slip) / height
    balance = layer.density * height * mean_acceleration - layer.modulus * height * mean_curvature - shear
    printed = (
        0.5 * layer.density * height * acceleration
        - 0.5 * height * layer.modulus * curvature
        - layer.shear_modulus * held / height
        + layer.shear_modulus * slip / height
    )
    scale = max(abs(layer.modulus * height * mean_curvature), abs(shear))
    return 1.0 + (balance - printed) / max(scale, abs(layer.density * height * mean_acceleration))


def initial_displacement(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """Force on a lattice with a relative displacement u_0 at the start, against that of slip with its stress added."""
    u0, slip = random.normal(size=(2, 32))

    def force(u: np.ndarray) -> np.ndarray:
        return np.roll(u, 1) - 2.0 * u + np.roll(u, -1) - layer.gamma * u

    return relative(force(u0 + slip), force(slip) + force(u0))


def nondimensional_form(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """Each coefficient of the scaled equations of motion, with X = H and the stated T and U."""
    height, time = layer.thickness, layer.time_scale
    ratios = []
    for boundary, halved in (("displacement", 2.0), ("stress", 1.0)):
        slip = layer.slip_scale(boundary)
        # Inertia is rho H u''/halved; divided by its scale each of these is what equation (B12) has.
        inertia = layer.density * height * slip / time**2 / halved
        ratios.append(layer.modulus * height / halved * slip / height**2 / inertia)
        shear = random.uniform(0.0, 1.0) * layer.normal_stress
        driving = shear - layer.kinetic_friction * layer.normal_stress
        scale = layer.friction_drop
        ratios.append(1.0 + driving / inertia - driving / scale)
        ratios.append(1.0 + layer.prestress(shear) - driving / scale)
    slip = layer.slip_scale("displacement")
    inertia = layer.density * height * slip / time**2 / 2.0
    ratios.append(layer.shear_modulus / height * slip / inertia / layer.gamma)
    return farthest(ratios)


def wave_speed(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """Phase speed of the scaled equation against the root of 1 + gamma/k^2, which is 1 as gamma -> 0."""
    k = random.uniform(0.1, 10.0)
    metres = k / layer.thickness
    # Dimensional: rho w^2 = (lambda + 2G) k^2 + 2G/H^2.
    omega = np.sqrt(
        (layer.modulus * metres**2 + 2.0 * layer.shear_modulus / layer.thickness**2) / layer.density
    )
    return float(omega / metres / layer.wave_speed / np.sqrt(1.0 + layer.gamma / k**2))


def static_threshold(layer: Layer, *_) -> float:
    """Equation (7) at the static strength."""
    return layer.prestress(layer.static_friction * layer.normal_stress)


def pulse_algebra(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """The closed form of slip, width, velocity, peak, acceleration and stress drop against the steady equation."""
    gamma, v = layer.gamma, speed(tau)
    k = np.sqrt(gamma * (1.0 - tau**2)) / tau
    width = np.pi * tau / np.sqrt(gamma * (1.0 - tau**2))
    chi = random.uniform(-0.5, 0.5, size=8) * width
    slip = tau / gamma * (1.0 - np.sin(k * chi))
    first, second = -tau / gamma * k * np.cos(k * chi), tau / gamma * k**2 * np.sin(k * chi)
    ends = tau / gamma * (1.0 - np.sin(k * np.array([-0.5, 0.5]) * width))
    slopes = np.cos(0.5 * k * width)
    return farthest(
        [
            relative((v**2 - 1.0) * second + gamma * slip, np.full(8, tau)),
            relative(-v * first, np.cos(k * chi) / np.sqrt(gamma)),
            relative(v**2 * second, np.sin(k * chi) / tau),
            relative(gamma * (ends[0] - ends[1]), 2.0 * tau),
            1.0 + ends[1] * gamma / tau,
            1.0 + slopes,
            width / (np.pi * np.sqrt((v**2 - 1.0) / gamma)),
        ]
    )


def transition_estimate(layer: Layer, tau: float, _) -> float:
    """The oscillator without strain term at pi/sqrt(gamma): slip 2 tau/gamma, at rest; and the length."""
    gamma = layer.gamma
    time = np.pi / np.sqrt(gamma)
    slip = tau / gamma * (1.0 - np.cos(np.sqrt(gamma) * time))
    velocity = np.sin(np.sqrt(gamma) * time)
    length = 2.0 * time * speed(tau) / (2.0 * np.pi / np.sqrt(gamma * (1.0 - tau**2)))
    return farthest([slip / (2.0 * tau / gamma), 1.0 + velocity, length])


def twice_as_thick(layer: Layer, tau: float, _) -> float:
    """Transition length and width at twice the thickness."""
    thick = Layer(**{**vars(layer), "thickness": 2.0 * layer.thickness})
    v = speed(tau)
    return farthest(
        [
            thick.transition_length(v) / layer.transition_length(v) / 2.0,
            thick.pulse_width(tau, v) / layer.pulse_width(tau, v) / 2.0,
        ]
    )


def layers_in_series(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """Stress drop of two layers with one stress whose displacements add, against equation (17)."""
    slip, rock, thickness = (10.0 ** random.uniform(-3.0, 3.0) for _ in range(3))
    compliance = layer.thickness / layer.shear_modulus + thickness * layer.thickness / (
        rock * layer.shear_modulus
    )
    printed = damage_zone_stress_drop(
        slip, layer.shear_modulus, rock * layer.shear_modulus, layer.thickness, thickness * layer.thickness
    )
    return float(printed) * compliance / slip


def blocks_and_springs(layer: Layer, tau: float, random: np.random.Generator) -> float:
    """Forces on blocks at distance H, from coupling springs and leaf springs, against the scheme at dx = 1."""
    slip, load = random.normal(size=32), random.uniform(-1.0, 1.0, size=32)
    scale, time = layer.slip_scale("displacement"), layer.time_scale
    mass = 0.5 * layer.density * layer.thickness**2
    coupling, leaf = 0.5 * layer.modulus, layer.shear_modulus
    u = scale * slip
    force = coupling * (np.roll(u, 1) - 2.0 * u + np.roll(u, -1)) - leaf * u
    force += layer.thickness * layer.friction_drop * load
    scheme = np.roll(slip, 1) - 2.0 * slip + np.roll(slip, -1) - layer.gamma * slip + load
    return relative(force / mass * time**2 / scale, scheme)


def chain_speed(evidence: Evidence, claim: Claim) -> Claim:
    """The claim with how far simulated fronts are from the exact speed of a chain with leaf springs."""
    runs = evidence.lattices("burridge_knopoff_speed")[0]
    exact = [lattice_front_speed(row.left, row.gamma, row.dx) for row in runs.itertuples()]
    return compared(claim, runs["front_speed_right"], exact)


def damage_zone_limit(evidence: Evidence) -> Claim:
    """A zone much softer than its host rock."""
    ratio = 1e-9
    drop = float(damage_zone_stress_drop(1.0, 1.0, 1.0 / ratio, 1.0, THICKNESS))
    return evidence.arithmetic(
        "damage_zone_limit", "theory.damage_zone_stress_drop", drop,
        r"stress drop over $G\delta/H$; the limit is $GH_r\ll G_rH$, which a thick rock makes the stronger condition",
        **{"$G/G_r$": ratio, "$H_r/H$": THICKNESS},
    )  # fmt: skip
