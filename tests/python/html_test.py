"""Objects as notebooks show them: HTML that parses, with the pictures of the program."""
import base64
import html.parser
import shutil
import unittest

import hshfit
import program


class Page(html.parser.HTMLParser):
    """Names of elements, and pictures, of a well-formed piece of HTML."""

    VOID = {"img", "br", "path", "circle"}

    def __init__(self, text):
        super().__init__()
        self.open, self.names, self.pictures = [], [], []
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        self.names.append(tag)
        source = dict(attrs).get("src") or ""
        if source.startswith("data:image/png;base64,"):
            self.pictures.append(base64.b64decode(source.partition(",")[2]))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in self.VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if tag in self.VOID:
            return
        assert self.open and self.open.pop() == tag, tag


class Notebooks(unittest.TestCase):
    def test_every_class_with_html_gives_a_page(self):
        brdf = hshfit.open("ggx:alpha=0.4,ks=1/0.7/0.3")
        found = hshfit.project(brdf, outgoing=4)
        shown = [brdf, found, hshfit.compare(brdf, found, metrics="relative-l2-cosine"),
                 hshfit.fit(brdf, "beckmann", starts=1), hshfit.light("uniform:radiance=1")]
        for value in shown:
            page = Page(value._repr_html_())
            self.assertIn("table", page.names, type(value))
            for picture in page.pictures:
                self.assertTrue(picture.startswith(b"\x89PNG\r\n"))
        self.assertEqual(len(Page(brdf._repr_html_()).pictures), 1)

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed")
    def test_curves_and_bases_are_drawn(self):
        curves = Page(hshfit.curves("ggx:alpha=0.4", max_order=4, outgoing=4)._repr_html_())
        self.assertIn("svg", curves.names)
        self.assertEqual(len(Page(hshfit.Basis("hsh", 3)._repr_html_()).pictures), 1)

    def test_names_cannot_break_out_of_the_page(self):
        brdf = hshfit.function(lambda wi, wo: wi[:, 2], name="<script>alert(1)</script>")
        self.assertNotIn("script", Page(brdf._repr_html_()).names)


if __name__ == "__main__":
    program.main()
