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
# # Two ruptures meet
#
# A second Gaussian raises the pre-stress to static friction at another position. Two ruptures
# then start at the same time and run into each other.

# %%
import numpy as np

import slippulse as sp

level = 0.5
second = (12.0, 1.0 - level, 1.0)  # centre, amplitude, width
scene = sp.Scene(
    boundary="displacement",
    prestress=sp.Prestress(level, level, bumps=(second,)),
    gamma=0.65,
    damping_ratio=0.1,
    dx=0.05,
    duration=14.0,
)
samples = sp.Samples(np.linspace(0, 14, 141), np.linspace(-18, 30, 321))
run = sp.simulate(scene, samples)
sp.plot(run)

# %% [markdown]
# When two pulses meet, they do not pass through each other, because the stress behind each pulse
# is too low. They meet in the middle between the two nucleations, at the position that is
# released last:

# %%
between = run["release_time"].sel(x=slice(0.0, 12.0))
meeting = float(between.idxmax())
meeting

# %% [markdown]
# The slip at the end is that of a single pulse, except near the nucleations and near the position
# where the pulses meet:

# %%
run["slip"].sel(x=[-10.0, 6.0, 22.0], method="nearest").to_pandas()
