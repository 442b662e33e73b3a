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
# # A laboratory block in SI units
#
# A plate of acrylic glass (PMMA), 1 cm thick, is pressed onto a rigid base. `Layer` takes the
# properties of the material, the friction coefficients and the normal stress in SI units. It
# makes a scene of the model from them, and converts the results of the run to SI units.

# %%
import numpy as np

import slippulse as sp

layer = sp.Layer(
    thickness=0.01,  # m
    shear_modulus=2.1e9,  # Pa
    poisson_ratio=0.33,
    density=1170.0,  # kg/m3
    static_friction=0.6,
    kinetic_friction=0.5,
    normal_stress=5e6,  # Pa
    top="held",
)
layer.wave_speed, layer.scales.time  # m/s, s

# %% [markdown]
# The shear stress is 2.8 MPa, with a peak at $x = 0$ that reaches static friction, 3 MPa. The
# stress could also come from a file.

# %%
x = np.linspace(-0.2, 0.2, 801)  # m
stress = 2.8e6 + 0.2e6 * np.exp(-0.5 * (x / 0.01) ** 2)  # Pa
scene = layer.scene((x, stress), 60e-6, 5e-4, damping_ratio=0.1)  # s, m
samples = layer.samples(np.linspace(0.0, 60e-6, 121), np.linspace(-0.15, 0.15, 301))
run = layer.to_si(sp.simulate(scene, samples))
sp.plot(run)

# %%
numbers = sp.measure(run)
{
    name: numbers[name]
    for name in ("transition_time", "front_speed_right", "pulse_width", "pulse_slip")
}

# %% [markdown]
# The units are seconds, metres per second and metres. The next table compares the printed
# formulas of the paper with the exact values for a rupture that starts at a point. Where the two
# differ, it gives the reason:

# %%
sp.theory.layer_results(layer, 2.8e6, damping_ratio=0.1)
