# ---
# jupytext:
#   text_representation:
#     extension: .py
#     format_name: percent
# kernelspec:
#   display_name: Python 3
#   language: python
#   name: python3
# ---

# %% [markdown]
# # Friction that strengthens with slip velocity
#
# In the paper kinetic friction is constant. Here it grows in proportion to the slip velocity, $f
# = \alpha \dot u$, which opposes the pulse. `sp.friction` has this law and others.

# %%
from dataclasses import replace

import numpy as np

import slippulse as sp

scene = sp.Scene(
    boundary="displacement",
    prestress=sp.Prestress(left=0.7, right=0.7),
    gamma=0.65,
    damping_ratio=0.1,
    dx=0.05,
    duration=20.0,
)
samples = sp.Samples(np.linspace(0, 20, 101), np.linspace(-32, 32, 321))
strengthening = replace(scene, friction=sp.friction("linear_rate", alpha=0.3))
run = sp.simulate(strengthening, samples)
sp.plot(run)

# %% [markdown]
# The rupture becomes slower, wider and leaves less slip behind than without strengthening.

# %%
without, with_it = sp.measure(sp.simulate(scene)), sp.measure(run)
{
    name: (without[name], with_it[name])
    for name in ("front_speed_right", "pulse_width", "pulse_slip", "pulse_peak_velocity")
}

# %% [markdown]
# Above a critical $\alpha$ no pulse is steady. It depends on the front speed:

# %%
critical = sp.theory.critical_rate_strengthening(0.65, speed=with_it["front_speed_right"])
critical
