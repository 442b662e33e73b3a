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
# In the paper kinetic friction is constant. Here it has an additional part $f = \alpha \dot u$,
# which is proportional to the slip velocity $\dot u$ and opposes the motion. `sp.friction` offers
# this friction law and others.

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
# Compared with the run without strengthening, the front is slower, the pulse is wider, and it
# leaves less slip. Each pair of numbers is the value without and with strengthening:

# %%
without, with_it = sp.measure(sp.simulate(scene)), sp.measure(run)
{
    name: (without[name], with_it[name])
    for name in ("front_speed_right", "pulse_width", "pulse_slip", "pulse_peak_velocity")
}

# %% [markdown]
# Above a critical value of $\alpha$ there is no steady pulse. This value depends on the front
# speed:

# %%
critical = sp.theory.critical_rate_strengthening(0.65, speed=with_it["front_speed_right"])
critical
