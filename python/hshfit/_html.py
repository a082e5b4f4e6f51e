"""The objects of hshfit as HTML, for notebooks: tables, and pictures of the program's reports."""
import base64
import html
import math
import os
import tempfile

from . import _hshfit


def _text(value):
    if isinstance(value, float):
        return "–" if math.isnan(value) else f"{value:.6g}"
    return html.escape(str(value))


def _table(head, rows):
    cells = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    lines = "".join("<tr>" + "".join(f"<td>{_text(cell)}</td>" for cell in row) + "</tr>"
                    for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>"


def _title(text):
    return f"<p><b>{html.escape(text)}</b></p>"


def _png(picture, name, width):
    data = base64.b64encode(picture).decode()
    return f'<img alt="{name}" width="{width}" src="data:image/png;base64,{data}"/>'


def _sphere(brdf, size=160):
    """A lit sphere, as in the program's reports."""
    if "side=transmission-" in brdf.name:
        return ""  # a pane is dark under the lights of the sphere
    return _png(brdf._sphere_png(size), "lit sphere", size)


def _drawn(write, name, show):
    """The file `name` of a figure that `write(folder)` makes; a note where gnuplot is missing."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            write(folder)
        except _hshfit.OutputError as error:
            return f"<p>{html.escape(str(error))}</p>"
        with open(os.path.join(folder, name), "rb") as file:
            return show(file.read())


def _svg(figure):
    text = figure.decode()
    return text[text.find("<svg"):].replace("<svg", '<svg style="max-width:100%;height:auto"', 1)


def _poor(found):
    if not found.poor:
        return ""
    calls = [f"{label}: <code>{html.escape(found.poor[key])}</code>"
             for key, label in (("better", "better"), ("to_try", "to try")) if found.poor.get(key)]
    return f"<p>poor: {html.escape(found.poor['reason'])}; " \
           f"{calls[0] if calls else 'no form is known to do better'}</p>"


def brdf(self):
    kept = ", ".join(name for name, holds in self.laws.items() if holds)
    rows = [("channels", ", ".join(self.channels)), ("laws", kept), *self.facts.items()]
    return _title(self.name) + _sphere(self) + _table(("fact", "value"), rows)


def projection(self):
    head = self.form or self.coefficients
    rows = [("basis", f"{head.basis} order {head.order}"), ("outgoing", head.outgoing.spec),
            ("captured share of the energy", self.accuracy), ("quadrature error", self.error)]
    if self.form:
        rows += [("form", self.form.kind), ("bytes", self.form.bytes)]
    return _title(head.source) + _sphere(self.brdf()) + _table(("", ""), rows) + _poor(self)


def curves(self):
    rows = []
    for curve in self:
        reached = curve.reaching(0.99)
        rows.append((curve.basis, int(curve.orders[-1]), float(curve.accuracy[-1]),
                     f"{reached[1]} (order {reached[0]})" if reached else "–"))
    head = ("basis", "order", "captured", "coefficients for 99 %")
    figure = _drawn(self.save, "curves.svg", _svg) if self.energy["finite"] else ""
    return _title(self.brdf) + figure + _table(head, rows)


def comparison(self):
    rows = [(name, row["value"], row["reason"]) for name, row in self.metrics.items()]
    return _title(f"{self.b} against {self.a}") + _table(("metric", "value", ""), rows)


def fit(self):
    rows = [(p.name, p.channel, p.value, p.standard_error, p.bound) for p in self.parameters]
    head = ("parameter", "channel", "value", "standard error", "bound")
    return (_title(self.spec) + _sphere(self.brdf()) + _table(head, rows) +
            f"<p>rms {self.rms:.6g} over {self.samples} samples</p>" + _poor(self))


def basis(self):
    def write(folder):
        _hshfit.plot(self.name, os.path.join(folder, "basis.png"), order=min(self.order, 4),
                     condon_shortley=self.condon_shortley)
    figure = _drawn(write, "basis.png", lambda picture: _png(picture, "functions", 500))
    return _title(f"{self.name}, order {self.order}") + figure


def light(self):
    rows = [(name, f"order {len(curve)}", float(curve[-1])) for name, curve in self.curves.items()]
    return _title(self.source) + _table(("basis", "", "captured"), rows)


def attach():
    """Gives the classes of the extension module their HTML."""
    for name, function in (("Brdf", brdf), ("Projection", projection), ("Curves", curves),
                           ("Comparison", comparison), ("Fit", fit), ("Basis", basis),
                           ("Light", light)):
        setattr(getattr(_hshfit, name), "_repr_html_", function)
