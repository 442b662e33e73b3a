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
# # Stress held on top: a pulse needs a barrier
#
# The shear stress on top of the layer is constant, so that no leaf spring pulls a slipped block
# back. If the pre-stress is the same on both sides and positive, the rupture remains a crack. It
# turns into one pulse if its left front is stopped, here by negative pre-stress.

# %%
import numpy as np

import slippulse as sp

scene = sp.Scene(
    boundary="stress",
    prestress=sp.Prestress(left=-1.0, right=0.0),
    damping_ratio=0.1,
    dx=0.05,
    duration=20.0,
)
samples = sp.Samples(np.linspace(0, 20, 141), np.linspace(-6, 22, 281))
run = sp.simulate(scene, samples)
sp.plot(run)

# %% [markdown]
# The paper predicts where the left front stops: at the position $x_-$ for which the integral of
# the pre-stress from $x_-$ to infinity is zero. The front approaches this position ever more
# slowly, but on a lattice it stops after a finite time. The two numbers are the predicted and
# the simulated position:

# %%
predicted = sp.theory.prestress_balance_position(scene.prestress)
stopped = float(run["x"].where(np.isfinite(run["release_time"])).min())
predicted, stopped

# %% [markdown]
# The same scene with a pre-stress of 0.2 on both sides stays a crack:

# %%
from dataclasses import replace

crack = sp.simulate(replace(scene, prestress=sp.Prestress(left=0.2, right=0.2)), samples)
sp.measure(run)["regime"], sp.measure(crack)["regime"]
