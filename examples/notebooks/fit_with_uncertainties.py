# %% [markdown]
# # Fits with uncertainties
# A model is fitted to data; the covariance of its parameters tells how well the data determine
# them.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hshfit

data = hshfit.open("beckmann:alpha=0.3,ks=0.4 + lambert:kd=0.25/0.15/0.1")
fit = hshfit.fit(data, "ggx+lambert", starts=4, seed=1)
fit

# %% [markdown]
# GGX has longer tails than Beckmann, so that the residuals are more than noise. Models are ranked
# by directions that a fit did not see:

# %%
models = ["beckmann+lambert", "ggx+lambert", "ward+lambert", "phong+lambert"]
for row in hshfit.rank_models(data, models, starts=2, samples=1500):
    if row["failure"]:
        print(f"{row['model']:18} {row['failure']}")
    else:
        print(f"{row['model']:18} held out {row['held_out_rms']:.2e}, AIC {row['aic']:.0f}")

# %% [markdown]
# Standard errors and correlations:

# %%
free = [k for k, p in enumerate(fit.parameters) if np.isfinite(p.standard_error)]
names = [f"{fit.parameters[k].name} {fit.parameters[k].channel}".strip() for k in free]
matrix = fit.correlations[np.ix_(free, free)]
plt.imshow(matrix, vmin=-1, vmax=1, cmap="RdBu")
plt.xticks(range(len(free)), names, rotation=60, ha="right")
plt.yticks(range(len(free)), names)
plt.colorbar(label="correlation")
plt.show()

# %% [markdown]
# Draws from the covariance carry the uncertainty over to f: here the 90 % band of draws around the
# fit, magnified tenfold about it. The misfit is far wider than the band: the covariance takes the
# model for true, and GGX is not the model of these data.

# %%
random = np.random.default_rng(1)
theta = np.linspace(0, 85, 60)
wi, wo = hshfit.direction(theta, 0), hshfit.direction(30, 180)
values = np.array([fit.parameters[k].value for k in free])
draws = random.multivariate_normal(values, fit.covariance[np.ix_(free, free)], size=200)


def spec_of(numbers):
    """The specification with other values of the free parameters."""
    parameters = {}
    for k, number in zip(free, numbers):
        parameters.setdefault(fit.parameters[k].name, []).append(number)
    terms = []
    for term in fit.spec.split(" + "):
        model, _, settings = term.partition(":")
        changed = []
        for setting in settings.split(","):
            key, _, old = setting.partition("=")
            new = parameters.get(f"{model}.{key}")
            complete = new and len(new) == len(old.split("/"))
            numbers = "/".join(repr(float(max(x, 0))) for x in new) if complete else old
            changed.append(f"{key}={numbers}")
        terms.append(f"{model}:{','.join(changed)}")
    return " + ".join(terms)


center = fit.brdf()(wi, wo)[:, 0]
curves = np.array([hshfit.open(spec_of(numbers))(wi, wo)[:, 0] for numbers in draws])
low, high = np.percentile(curves, [5, 95], axis=0)
plt.plot(theta, data(wi, wo)[:, 0], "k.", label="data")
plt.plot(theta, center, label="fit")
plt.fill_between(theta, center + 10 * (low - center), center + 10 * (high - center), alpha=0.3,
                 label="90 % of draws, deviations times 10")
plt.xlabel("angle of incidence, degrees")
plt.ylabel("f, red channel, 1/sr")
plt.legend()
plt.show()

# %%
fit.save("fit.json")
hshfit.open("fit.json")
