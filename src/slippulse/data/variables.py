"""Units and meaning of everything that a data file may hold, all non-dimensional, and a sweep as one Dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

FRONTS = ("release_time", "stick_time")
FIELDS = ("slip", "slip_velocity", "slip_acceleration")
# What every data file says of itself.
FILE = {
    "Conventions": "CF-1.11",
    "title": "Ruptures of the minimal model for the onset of slip pulses",
    "source": "slippulse, simulations",
    "references": "https://doi.org/10.1103/PhysRevE.103.052802",
}

# Per name: units (1: a number, count, text) and meaning.
VARIABLES = {
    "boundary": ("text", "condition at the top of the layer: displacement (Gamma = 1) or stress (Gamma = 0)"),
    "gamma": ("1", "elasticity ratio 2G/(lambda + 2G); 0 under a stress boundary"),
    "beta": ("1", "damping, in units of H times the wave speed"),
    "damping_ratio": ("1", "beta/dx, which selects the front speed"),
    "left": ("1", "pre-stress level far to the left, tau_{0,l}"),
    "right": ("1", "pre-stress level far to the right, tau_{0,r}"),
    "width": ("1", "standard deviation of the Gaussian pre-stress, in units of H"),
    "peak": ("1", "pre-stress at x = 0"),
    "steps_and_bumps": (
        "text",
        "steps (position, level) and bumps (centre, amplitude, width) of the pre-stress, as JSON",
    ),
    "duration": ("1", "time that is simulated, in units of H over the wave speed"),
    "dx": ("1", "spacing of the blocks, in units of H"),
    "release": ("text", "whether the released stress includes the damping force: total or elastic"),
    "scheme": ("text", "localised, fixed_step or continuum"),
    "max_step": ("1", "largest time step over dx"),
    "order": ("1", "order of the Taylor step, or the observed order of a number as the spacing falls"),
    "half_lattice": ("1", "1 where half of a symmetric scene may be simulated"),
    "friction_ratio": ("1", "mu_k/(mu_s - mu_k)"),
    "resolved_blocks": ("count", "sliding blocks below which a pulse is flagged"),
    "rate_strengthening": (
        "1",
        "alpha, by which friction grows with slip rate, in units of the wave speed over H",
    ),
    "work_of_prestress": ("1", "work of the pre-stress on the slip"),
    "kinetic_energy": ("1", "kinetic energy at the end"),
    "elastic_energy": ("1", "elastic energy of the strain at the end"),
    "leaf_spring_energy": ("1", "energy of the leaf springs at the end"),
    "viscous_loss": ("1", "energy lost to the damping and to what friction gains with slip rate"),
    "event_loss": ("1", "energy lost as blocks stick within a step (textbook scheme)"),
    "energy_residual": ("1", "what the energy balance misses, over its largest part"),
    "end_time": ("1", "time at which the run ended"),
    "stopped_because": ("text", "why the run ended"),
    "steps": ("count", "time steps"),
    "block_updates": ("count", "sliding blocks summed over the steps"),
    "event_updates": ("count", "blocks changed by releases and sticks"),
    "releases": ("count", "releases of a block"),
    "sticks": ("count", "times a block stuck"),
    "re_releases": ("count", "releases of a block that had slid before"),
    "min_velocity": ("1", "smallest slip velocity"),
    "min_stuck_stress": ("1", "lowest stress of a block at rest"),
    "friction_ratio_needed": ("1", "mu_k/(mu_s - mu_k) above which no block slides backwards"),
    "first_stick_time": ("1", "time of the first stick"),
    "first_stick_position": ("1", "position of the first stick, in units of H"),
    "half_lattice_used": ("1", "1 where half of the scene was simulated"),
    "pulse_blocks": ("count", "blocks across the narrowest pulse at the end"),
    "run_flags": (
        "text",
        "what would make the numbers something else than the model's; empty where nothing does",
    ),
    "limit_position": ("1", "where the construction of the exact solution ends, in units of H"),
    "limit_time": ("1", "when it ends there"),
    "limit_reason": ("text", "why it ends"),
    "row_size": ("count", "blocks of a run"),
    "x": ("1", "position, in units of the layer thickness H; in a figure's table the horizontal axis"),
    "prestress": ("1", "non-dimensional pre-stress"),
    "release_time": ("1", "time of the first release, NaN where never"),
    "stick_time": ("1", "time of the last stick, NaN where never or sliding at the end"),
    "slip": ("1", "slip at the end"),
    "slip_velocity": ("1", "slip velocity at the end"),
    "slip_acceleration": ("1", "slip acceleration at the end"),
    "sample_time": ("1", "time of a sample"),
    "sample_position": ("1", "position of a sample, in units of the layer thickness H"),
    "sample_slip": ("1", "slip at the sampled times and positions"),
    "sample_velocity": ("1", "slip velocity at the sampled times and positions"),
}


def combine(results: Sequence[xr.Dataset], record: Sequence[str]) -> xr.Dataset:
    """Put the runs of a sweep into one Dataset."""
    first = results[0]

    def of_all(name: str) -> list[np.ndarray]:
        return [result.variables[name].values for result in results]

    out = xr.Dataset(
        {
            name: ("point", np.array([result.attrs[name] for result in results]))
            for name in first.attrs
            if name != "versions"
        }
    )
    kept = (*(FRONTS if "fronts" in record else ()), *(FIELDS if "fields" in record else ()))
    if kept:
        out["row_size"] = ("point", np.array([result.sizes["x"] for result in results]))
        for name in ("x", "prestress", *kept):
            out[name] = ("block", np.concatenate(of_all(name)))
    if "samples" in record:
        axes = {"sample_time": ("time",), "sample_position": ("position",)}
        for name in (*axes, "sample_slip", "sample_velocity"):
            out[name] = (("point", *axes.get(name, ("time", "position"))), np.stack(of_all(name)))
    for name, variable in out.variables.items():
        variable.attrs = {"units": "1", "long_name": VARIABLES[str(name)][1]}
    out.attrs = FILE | {"versions": first.attrs["versions"]}
    if kept:
        # CF's contiguous ragged array: the profiles of the runs over x, one after the other.
        out["row_size"].attrs["sample_dimension"] = "block"
        out.attrs["featureType"] = "profile"
    return out
