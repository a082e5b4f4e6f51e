# %% [markdown]
# # A basis for my material
# Bases and forms are weighed against each other: error, bytes, and the smallest file within an
# error. Put the path of a measured file in the place of the specification.

# %%
import matplotlib.pyplot as plt

import hshfit

material = hshfit.open("disney:baseColor=0.7/0.3/0.1,roughness=0.45,specular=0.6")
material

# %% [markdown]
# Captured energy of every basis at order 8, from one quadrature:

# %%
everything = hshfit.project_all(material, order=8, outgoing=16, cosine=True)
names = sorted(everything, key=lambda name: everything[name].accuracy)
plt.barh(names, [100 * everything[name].accuracy for name in names])
plt.xlabel("captured energy of f cos θ, %")
plt.show()

# %% [markdown]
# The forms of a coefficient file: per outgoing direction in full, factored, in fewer bits, and
# the halfway form, two exponentials over half and difference vectors. Errors are relative to f
# cos θ over outgoing elevations.

# %%
forms = {
    "order 8, float32": dict(order=8, cosine=True, precision="float32"),
    "order 8, half": dict(order=8, cosine=True, precision="half"),
    "order 8, rank 4": dict(order=8, cosine=True, rank=4, precision="half"),
    "order 12, half": dict(order=12, cosine=True, precision="half"),
    "halfway 7,6,5": dict(form="halfway", halfway=(7, 6, 5), precision="half"),
    "halfway 9,8,6": dict(form="halfway", halfway=(9, 8, 6), precision="half"),
}
rows = {}
for name, options in forms.items():
    form = hshfit.project(material, **options).form
    error = hshfit.compare(material, form, metrics="relative-l2-cosine",
                           outgoing=16)["relative-l2-cosine"]
    rows[name] = (form.bytes, error)
    print(f"{name:18} {form.bytes:7} bytes, error {100 * error:6.2f} %")

# %%
for name, (size, error) in rows.items():
    plt.loglog(size, 100 * error, "o")
    plt.annotate(name, (size, 100 * error), textcoords="offset points", xytext=(5, 4), fontsize=8)
plt.xlabel("bytes")
plt.ylabel("relative L2 error of f cos θ, %")
plt.margins(0.25)
plt.show()

# %% [markdown]
# The smallest of those within 5 %:

# %%
within = {name: row for name, row in rows.items() if row[1] <= 0.05}
best = min(within, key=lambda name: within[name][0])
print(best, within[best])
chosen = hshfit.project(material, **forms[best])
chosen.save("material.json")
chosen
