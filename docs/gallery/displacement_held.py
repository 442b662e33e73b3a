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
# # Displacement held on top: two pulses
#
# The top of the layer does not move. A leaf spring of stiffness $\gamma$ ties every block to the
# top and pulls it back when it has slipped. A crack opens at the peak of the pre-stress, at
# $x = 0$. After the time $T_\mathrm{trans}$ the blocks in its middle stick, and two pulses run
# outwards.

# %%
import numpy as np

import slippulse as sp

scene = sp.Scene(
    boundary="displacement",
    prestress=sp.Prestress(left=0.6, right=0.6),
    gamma=0.65,
    damping_ratio=0.1,
    dx=0.05,
    duration=12.0,
)
samples = sp.Samples(np.linspace(0, 12, 121), np.linspace(-16, 16, 321))
run = sp.simulate(scene, samples)
sp.plot(run)

# %% [markdown]
# The black lines are the fronts, where blocks start to slip, and the trailing edges, where blocks
# stick again. Between them the layer slips, and the colour shows the slip velocity. The transition
# ends when the first block sticks. The paper estimates this time as $\pi/\sqrt{\gamma}$. The
# exact theory computes it without a lattice.

# %%
numbers = sp.measure(run)
exact = sp.theory.Rupture(scene.prestress, gamma=0.65, damping_ratio=0.1, duration=12.0)
times = {
    "lattice": numbers["transition_time"],
    "exact": exact.transition.time,
    "paper": np.pi / np.sqrt(0.65),
}
times

# %% [markdown]
# From then on the width and the speed of the pulse are constant:

# %%
{name: numbers[name] for name in ("front_speed_right", "pulse_width", "pulse_slip")}
