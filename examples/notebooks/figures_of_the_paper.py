# %% [markdown]
# # Accuracy curves of the HSH paper
# Figures 4 and 5 of Gautron, Křivánek, Pattanaik and Bouatouch 2004, *A Novel Hemispherical Basis
# for Accurate and Efficient Rendering*: the captured share of the energy of a lobe against the
# number of coefficients, for several bases.

# %%
import matplotlib.pyplot as plt

import hshfit


def draw(curves, title):
    styles = {"hsh": "o-", "sh": "s-", "esh": "^-", "zernike": "d-", "makhotkin": "v-"}
    for curve in curves:
        plt.plot(curve.coefficients, 100 * curve.accuracy, styles[curve.basis], markersize=4,
                 label=curve.basis)
    plt.xlabel("coefficients")
    plt.ylabel("captured energy, %")
    plt.title(title)
    plt.legend()
    plt.show()


BASES = ["hsh", "sh", "esh", "zernike", "makhotkin"]

# %% [markdown]
# **Figure 4**, a Phong lobe. Functions that can be non-zero are counted: n(n+1)/2 of order n for
# even-symmetric harmonics and Zernike polynomials, n² for the others.

# %%
phong = hshfit.curves("preset:hsh-phong", bases=BASES, max_order=12, outgoing=(60, 0))
draw(phong, "Phong, outgoing direction at 60°")

# %% [markdown]
# **Figure 5**, anisotropic Ward. Without the cosine its energy does not exist, and the library
# says why:

# %%
ward = hshfit.curves("preset:hsh-ward", bases=BASES, max_order=12, outgoing=(45, 0))
print(ward.energy["finite"], "–", ward.energy["reason"])

# %%
ward = hshfit.curves("preset:hsh-ward", bases=BASES, max_order=12, outgoing=(45, 0), cosine=True)
draw(ward, "Ward f cos θ, outgoing direction at 45°")

# %% [markdown]
# The number of coefficients that each basis needs for 99 % of the energy:

# %%
for name, curves in (("Phong", phong), ("Ward", ward)):
    for curve in curves:
        order, coefficients = curve.reaching(0.99) or ("above 12", "–")
        print(f"{name:6} {curve.basis:10} order {order}, {coefficients} coefficients")

# %% [markdown]
# The curves of every basis, as the report of the program shows them:

# %%
hshfit.curves("preset:hsh-ward", max_order=10, outgoing=(45, 0), cosine=True)
