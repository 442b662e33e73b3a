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
# # Which barriers does a pulse pass?
#
# A barrier is a region of negative pre-stress. A pulse enters negative pre-stress to a finite
# depth, for which there is an exact formula. It passes a barrier that is shorter than this depth
# and stops in a longer one.

# %%
import numpy as np

import slippulse as sp

level, inside, gamma = 0.5, -0.5, 0.65
depth = sp.theory.barrier_depth(level, inside, gamma=gamma)
depth

# %% [markdown]
# Two barriers stand in the way of the right pulse. The first one is shorter than this depth, and
# the second one is longer.

# %%
barriers = ((12.0, inside), (12.0 + 0.6 * depth, level), (22.0, inside))
scene = sp.Scene(
    boundary="displacement",
    prestress=sp.Prestress(level, level, steps=barriers),
    gamma=gamma,
    dx=0.05,
    duration=26.0,
)
samples = sp.Samples(np.linspace(0, 26, 131), np.linspace(-32, 32, 321))
run = sp.simulate(scene, samples)
sp.plot(run)

# %%
farthest = float(run["x"].where(np.isfinite(run["release_time"])).max())
farthest - 22.0, depth

# %% [markdown]
# The second barrier begins at $x = 22$. The first number is the distance that the pulse has run
# into it, and the second one is the exact depth. The small difference is the error of the lattice.
