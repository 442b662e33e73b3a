"""Descriptions of all variables that a data file can have."""

import xarray as xr

from ..model.scene import SCENE_NUMBERS

VARIABLES = {name: definition.meaning for name, definition in SCENE_NUMBERS.items()}
VARIABLES |= {
    "boundary": "what is held at the top of the layer: `displacement` (Gamma = 1) or `stress` "
    "(Gamma = 0)",
    "damping_ratio": "damping ratio beta/dx, which determines the front speed",
    "left": "pre-stress level far to the left, tau_{0,l}",
    "right": "pre-stress level far to the right, tau_{0,r}",
    "width": "standard deviation of the Gaussian pre-stress, in units of H",
    "peak": "pre-stress at x = 0",
    "steps_and_bumps": "steps (position, level) and bumps (centre, amplitude, width), as JSON",
    "profile": "number of the pre-stress profile in the list `profiles`, counted from 1. The "
    "number is given only if one of the profiles is a table",
    "seed": "seed of the random numbers of a rough pre-stress; NaN if the pre-stress is not rough",
    "release": "release rule: `total` if the stress at release includes the damping force, "
    "`elastic` if it does not. In the tables of `exact_rupture`: exact time of release",
    "scheme": "numerical scheme: `localised`, `fixed_step` or `continuum`",
    "half_lattice": "1 if simulating only half of a symmetric scene is allowed, otherwise 0",
    "friction": "law of friction of sliding blocks with its parameters, as JSON",
    "rate_strengthening": "coefficient alpha of friction that grows in proportion to slip rate, "
    "in units of c/H",
    "work_of_prestress": "work of the pre-stress on the slip",
    "kinetic_energy": "kinetic energy at the end of the run",
    "elastic_energy": "elastic energy of the strain at the end of the run",
    "leaf_spring_energy": "energy of the leaf springs at the end of the run",
    "viscous_loss": "energy lost to damping and to the increase of friction with slip rate",
    "friction_loss": "work against friction above kinetic friction, such as the fracture energy "
    "of slip weakening. With the law `linear_rate`, the variable `viscous_loss` contains this "
    "work instead",
    "event_loss": "energy that the scheme `fixed_step` loses when blocks stick within a time step",
    "energy_residual": "error of the energy balance divided by the largest term of the balance",
    "end_time": "time at which the run ended",
    "stopped_because": "reason why the run ended",
    "steps": "number of time steps",
    "block_updates": "number of sliding blocks, summed over all time steps",
    "event_updates": "number of blocks that a release or a stick changes, summed over all "
    "releases and sticks",
    "releases": "number of times that a block is released, summed over all blocks",
    "sticks": "number of times that a block sticks, summed over all blocks",
    "re_releases": "number of releases of blocks that have slid before",
    "min_velocity": "smallest slip velocity",
    "min_stuck_stress": "lowest stress on a block at rest",
    "friction_ratio_needed": "value of the friction ratio mu_k/(mu_s - mu_k) above which no block "
    "slides backwards",
    "first_stick_time": "time at which a block first sticks",
    "first_stick_position": "position of the block that first sticks, in units of H",
    "half_lattice_used": "1 if only one half of a symmetric scene was simulated, otherwise 0",
    "pulse_blocks": "number of blocks in the narrowest pulse at the end of the run",
    "run_flags": "reasons why the numbers of the run may differ from the numbers of the model; "
    "empty if there is no such reason",
    "limit_position": "position of the event after which the exact solution is not known "
    "everywhere, in units of H",
    "limit_time": "time of the event after which the exact solution is not known everywhere",
    "limit_reason": "reason why the exact solution is unknown where a wave from the event at "
    "`limit_time` has arrived; empty if it is known everywhere",
    "point": "number of the run in its simulation, counted from 0",
    "row_size": "number of blocks of a run",
    "row_start": "index of the first block of a run in the arrays of all blocks",
    "x": "position, in units of H. In a figure's table: value on the horizontal axis",
    "prestress": "non-dimensional pre-stress",
    "release_time": "time at which the block is first released; NaN if it is never released",
    "stick_time": "time at which the block last sticks; NaN if it slides at the end or never "
    "sticks",
    "slip": "slip at the end of the run",
    "slip_velocity": "slip velocity at the end of the run",
    "slip_acceleration": "slip acceleration at the end of the run",
    "sample_time": "time of a sample",
    "sample_position": "position of a sample, in units of H",
    "sample_slip": "slip at the sampled times and positions",
    "sample_velocity": "slip velocity at the sampled times and positions",
}


def with_descriptions(data: xr.Dataset) -> xr.Dataset:
    """Add the attributes units and long_name to each variable of a Dataset, and return it."""
    for name, variable in data.variables.items():
        variable.attrs = {"units": "1", "long_name": VARIABLES[str(name)]} | variable.attrs
    return data
