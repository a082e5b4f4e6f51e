# %% [markdown]
# # A BRDF of your own
# A function of NumPy arrays is projected, compared and fitted like any other material. The library
# calls it with batches: many incoming directions at once, one outgoing direction.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np

import hshfit

sizes = []


def satin(wi, wo):
    """A diffuse base and an anisotropic lobe about the half vector, stretched along y."""
    sizes.append(len(wi))
    half = wi + wo
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    slope2 = ((half[:, 0] / 0.25) ** 2 + (half[:, 1] / 0.6) ** 2) / half[:, 2] ** 2
    return 0.08 / np.pi + 0.5 * np.exp(-slope2) / half[:, 2] ** 4


material = hshfit.function(satin, reciprocal=True, mirror_symmetric=True, non_negative=True,
                           halfway_width=0.25)
material

# %%
sizes.clear()
start = time.perf_counter()
found = hshfit.project(material, order=8, outgoing="32x32", cosine=True)
seconds = time.perf_counter() - start
print(f"{found.accuracy:.4f} of the energy; {sum(sizes)} values in {len(sizes)} calls, "
      f"{np.mean(sizes):.0f} at a time, {seconds:.2f} s")
found

# %% [markdown]
# The laws that are promised save work. The function keeps the mirror symmetry, to rounding:

# %%
random = np.random.default_rng(1)
wi, wo = (v / np.linalg.norm(v, axis=-1, keepdims=True)
          for v in np.abs(random.normal(size=(2, 1000, 3))) + 0.01)
flip = np.array([-1, 1, 1])
difference = material(wi * flip, wo * flip) - material(wi, wo)
print("largest difference of mirrored pairs:", np.abs(difference).max())

# %% [markdown]
# The models of the library come close; their errors at directions that the fit did not see:

# %%
for row in hshfit.rank_models(material, ["ward+lambert", "beckmann+lambert", "ggx+lambert"],
                              starts=2, samples=1000):
    print(f"{row['model']:18}", row["failure"] or f"{row['held_out_rms']:.4f}  {row['spec']}")

# %%
theta = np.linspace(-85, 85, 300)
for phi, colour in ((0, "C0"), (90, "C1")):
    wi = hshfit.direction(np.abs(theta), np.where(theta < 0, phi + 180, phi))
    wo = hshfit.direction(20, phi + 180)
    plt.plot(theta, material(wi, wo, cosine=True), colour,
             label=f"f cos θ, plane of azimuth {phi}°")
    plt.plot(theta, found.brdf()(wi, wo, cosine=True), colour, linestyle="--",
             label="series of order 8")
plt.xlabel("angle of incidence, degrees")
plt.legend()
plt.show()
