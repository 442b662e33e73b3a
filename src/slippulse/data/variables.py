"""Meaning of every variable that a data file may hold: plain numbers, counts and text."""

import xarray as xr

VARIABLES = {
    "boundary": "condition at the top of the layer: displacement (Gamma = 1) or stress (Gamma = 0)",
    "gamma": "elasticity ratio 2G/(lambda + 2G); 0 under a stress boundary",
    "beta": "damping, in units of H times the wave speed",
    "damping_ratio": "beta/dx, which selects the front speed",
    "left": "pre-stress level far to the left, tau_{0,l}",
    "right": "pre-stress level far to the right, tau_{0,r}",
    "width": "standard deviation of the Gaussian pre-stress, in units of H",
    "peak": "pre-stress at x = 0",
    "steps_and_bumps": "steps (position, level) and bumps (centre, amplitude, width), as JSON",
    "duration": "time that is simulated, in units of H over the wave speed",
    "dx": "spacing of the blocks, in units of H",
    "release": "whether the released stress includes the damping force: total or elastic",
    "scheme": "localised, fixed_step or continuum",
    "max_step": "largest time step over dx",
    "order": "order of the Taylor step, or the observed order of a number as the spacing falls",
    "half_lattice": "1 where half of a symmetric scene may be simulated",
    "friction_ratio": "mu_k/(mu_s - mu_k)",
    "resolved_blocks": "sliding blocks below which a pulse is flagged",
    "friction": "law of friction of sliding blocks with its parameters, as JSON",
    "rate_strengthening": "alpha, by which friction grows with slip rate, in units of c/H",
    "work_of_prestress": "work of the pre-stress on the slip",
    "kinetic_energy": "kinetic energy at the end",
    "elastic_energy": "elastic energy of the strain at the end",
    "leaf_spring_energy": "energy of the leaf springs at the end",
    "viscous_loss": "energy lost to the damping and to what friction gains with slip rate",
    "friction_loss": "work against friction above the kinetic one: the fracture energy of slip "
    "weakening; with law linear_rate a part of viscous_loss",
    "event_loss": "energy lost as blocks stick within a step (textbook scheme)",
    "energy_residual": "what the energy balance misses, over its largest part",
    "end_time": "time at which the run ended",
    "stopped_because": "why the run ended",
    "steps": "time steps",
    "block_updates": "sliding blocks summed over the steps",
    "event_updates": "blocks changed by releases and sticks",
    "releases": "releases of a block",
    "sticks": "times a block stuck",
    "re_releases": "releases of a block that had slid before",
    "min_velocity": "smallest slip velocity",
    "min_stuck_stress": "lowest stress of a block at rest",
    "friction_ratio_needed": "mu_k/(mu_s - mu_k) above which no block slides backwards",
    "first_stick_time": "time of the first stick",
    "first_stick_position": "position of the first stick, in units of H",
    "half_lattice_used": "1 where half of the scene was simulated",
    "pulse_blocks": "blocks across the narrowest pulse at the end",
    "run_flags": "what makes the numbers other than the model's; empty where nothing does",
    "limit_position": "where the construction of the exact solution ends, in units of H",
    "limit_time": "when it ends there",
    "limit_reason": "why it ends",
    "row_size": "blocks of a run",
    "row_start": "number of the first block of a run",
    "x": "position, in units of the layer thickness H; in a figure's table the horizontal axis",
    "prestress": "non-dimensional pre-stress",
    "release_time": "time of the first release, NaN where never",
    "stick_time": "time of the last stick, NaN where never or sliding at the end",
    "slip": "slip at the end",
    "slip_velocity": "slip velocity at the end",
    "slip_acceleration": "slip acceleration at the end",
    "sample_time": "time of a sample",
    "sample_position": "position of a sample, in units of the layer thickness H",
    "sample_slip": "slip at the sampled times and positions",
    "sample_velocity": "slip velocity at the sampled times and positions",
}


def described(data: xr.Dataset) -> xr.Dataset:
    """Give each variable of a Dataset units and long_name, and return the Dataset."""
    for name, variable in data.variables.items():
        variable.attrs = {"units": "1", "long_name": VARIABLES[str(name)]} | variable.attrs
    return data
