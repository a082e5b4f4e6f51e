"""hshfit: BRDFs as hemispherical-basis coefficients.

A BRDF, analytic, measured or a function of Python, becomes coefficients of hemispherical harmonics
or of another basis, with an error estimate; they are compared, fitted, compressed, rotated and
exported. The same work as by the program hshfit, on NumPy arrays.

    import hshfit
    gold = hshfit.open("ggx:alpha=0.3,ks=1/0.77/0.34")
    found = hshfit.project(gold, basis="hsh", order=10, cosine=True)
    found.accuracy, found.coefficients.values.shape

Directions are unit vectors (..., 3) that point away from the surface, +z the normal, +x the
tangent; angles are in degrees; f is in 1/sr and never has a cosine.
"""
from ._hshfit import (
    Basis, Brdf, Coefficients, Comparison, Curve, Curves, Error, Fit, FittedParameter, Form,
    InputError, Library, Light, NumericError, Outgoing, OutputError, Projection, Rotation,
    UsageError, __version__, catalog, choose, compare, convert, curves, describe, direction,
    export, export_lighting, export_material, fit, function, gaussians, illuminate,
    import_coefficients, irradiance, light, ltc, matrix, open, picture_error, plan, plot,
    project, project_all, rank_models, read, render, sample, set_threads, stress, svbrdf,
    threads, tradeoff, transfer)
from . import _arguments, _html

_html.attach()

__all__ = [
    "Basis", "Brdf", "Coefficients", "Comparison", "Curve", "Curves", "Error", "Fit",
    "FittedParameter", "Form", "InputError", "Library", "Light", "NumericError", "Outgoing",
    "OutputError", "Projection", "Rotation", "UsageError", "catalog", "choose", "compare",
    "convert", "curves", "describe", "direction", "export", "export_lighting",
    "export_material", "fit", "function", "gaussians",
    "illuminate", "import_coefficients", "irradiance", "light", "ltc", "matrix", "open",
    "picture_error", "plan", "plot", "project", "project_all", "rank_models", "read",
    "render", "sample", "set_threads", "stress", "svbrdf", "threads", "tradeoff", "transfer"]

_arguments.attach(globals(), __all__)
