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
# # A rough fault
#
# The initial stress of a real fault is not uniform. `rough` draws a random field with a given
# mean, standard deviation, correlation length and roughness. The same seed gives the same field
# on every machine.
# The rupture starts where a Gaussian at $x = 0$ raises the field to static friction.

# %%
import numpy as np

import slippulse as sp

field = sp.rough(0.5, 0.15, 2.0, 0.6, start=-30.0, stop=30.0, spacing=0.1, seed=3)
scene = sp.Scene(
    boundary="displacement",
    prestress=sp.Prestress.through(*field, width=1.0),
    gamma=0.65,
    damping_ratio=0.1,
    dx=0.05,
    duration=18.0,
)
samples = sp.Samples(np.linspace(0, 18, 181), np.linspace(-26, 26, 321))
run = sp.simulate(scene, samples)
sp.plot(run)

# %% [markdown]
# A pulse forgets every change of the pre-stress within a finite distance. The slip therefore
# follows the pre-stress with a delay. On a smooth fault with the pre-stress $\tau_0$ and without
# damping, the slip is $2\tau_0/\gamma$. Away from the nucleation, the mean slip on the rough fault
# is close to this value for the mean pre-stress. The three numbers are the mean slip, its
# standard deviation, and the slip on the smooth fault:

# %%
away = slice(5, 20)
slip = run["slip"].sel(x=away)
smooth = 2 * run["prestress"].sel(x=away).mean() / 0.65
float(slip.mean()), float(slip.std()), float(smooth)
