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
# # The lattice against the exact solution
#
# The damping ratio is the damping $\beta$ divided by the block spacing $\Delta x$. If the spacing
# decreases at a fixed damping ratio, the lattice tends to a continuum limit, which can be solved
# exactly. The scheme `continuum` returns this limit in the same form as a simulation.

# %%
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import slippulse as sp

scene = sp.Scene(
    boundary="displacement",
    prestress=sp.Prestress(left=0.6, right=0.3),
    gamma=0.65,
    damping_ratio=0.1,
    dx=0.1,
    duration=8.0,
)
exact = sp.simulate(replace(scene, scheme="continuum"))

# %% [markdown]
# The damping ratio is the same at each spacing, so that $\beta$ decreases with the spacing.

# %%
errors = {}
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for dx in (0.2, 0.1, 0.05):
    run = sp.simulate(replace(scene, dx=dx, beta=0.1 * dx))
    axes.plot(run["x"], run["slip"], label=rf"$\Delta x = {dx}$")
    same_places = exact["slip"].interp(x=run["x"])
    errors[dx] = float(np.abs(run["slip"] - same_places).max())
axes.plot(exact["x"], exact["slip"], "k--", label="exact")
axes.set(xlabel="$x / H$", ylabel="slip at the end")
axes.legend()
errors

# %% [markdown]
# The largest difference is proportional to the spacing: the order of convergence is about 1.

# %%
orders = np.diff(np.log(list(errors.values()))) / np.diff(np.log(list(errors)))
orders
