# %% [markdown]
# # First steps
# A material becomes coefficients of hemispherical harmonics, and the coefficients a material
# again.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hshfit

gold = hshfit.open("ggx:alpha=0.35,ks=1/0.77/0.34")
gold

# %% [markdown]
# `gold(wi, wo)` is f in 1/sr for arrays of directions: unit vectors that point away from the
# surface, +z the normal. Here are the plane of incidence and three outgoing directions.

# %%
theta = np.linspace(-89.5, 89.5, 400)
wi = hshfit.direction(np.abs(theta), np.where(theta < 0, 180, 0))
for outgoing in (0, 30, 60):
    f = gold(wi, hshfit.direction(outgoing, 180), cosine=True)
    plt.plot(theta, f[:, 0], label=f"outgoing at {outgoing}°")
plt.xlabel("angle of incidence, degrees")
plt.ylabel("red channel of f cos θ, 1/sr")
plt.legend()
plt.show()

# %% [markdown]
# The projection integrates f cos θ against every basis function, for a set of outgoing directions.
# Its accuracy is the captured share of the energy (Gautron et al. 2004, Eq. 15).

# %%
found = hshfit.project(gold, basis="hsh", order=10, cosine=True)
found

# %%
values = found.coefficients.values
print(values.shape, "= outgoing directions, channels, functions")
print("energy captured by the first bands:", np.round(found.captured / found.energy["value"], 3))

# %% [markdown]
# The sum of the series against the material: it rings where the lobe is narrower than the
# functions.

# %%
back = found.brdf()
wo = hshfit.direction(30, 180)
plt.plot(theta, gold(wi, wo, cosine=True)[:, 0], "k", label="GGX")
for order in (4, 7, 10):
    series = hshfit.project(gold, order=order, cosine=True).brdf()
    plt.plot(theta, series(wi, wo, cosine=True)[:, 0], label=f"HSH, order {order}")
plt.xlabel("angle of incidence, degrees")
plt.legend()
plt.show()

# %%
hshfit.compare(gold, back, metrics="relative-l2-cosine,captured-energy,maximum,negativity")

# %% [markdown]
# Files are those of the program: `hshfit export gold.json` makes textures and shaders of this one.

# %%
found.save("gold.json")
hshfit.read("gold.json")
