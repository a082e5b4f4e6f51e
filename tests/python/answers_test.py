"""Studies that answer with the document of their command give that of the program."""
import hshfit
import program


class Answers(program.InFolder):
    def test_choices_and_fitted_lobes_are_those_of_the_program(self):
        spec = "lambert:kd=.2/.1/.05+ggx:alpha=.3,F0=.04"
        ours = hshfit.choose(spec, renderer="three", kinds=["model", "halfway"], bytes=800)
        theirs = self.json_of("choose", spec, "--for", "three", "--kinds", "model,halfway",
                              "--bytes", "800")
        for document in ours, theirs:
            for row in document["rows"]:
                row.pop("spec")  # words the call that makes a form
        self.assertEqual(program.without_calls(ours), program.without_calls(theirs))
        ours = hshfit.ltc("ggx", "ours.json", size=4, mapping="linear")
        theirs = self.json_of("ltc", "ggx", "-o", "theirs.json", "--size", "4", "--mapping",
                              "linear")
        for document in ours, theirs:
            for key in ("outputs", "seconds"):
                document.pop(key)
        self.assertEqual(ours, theirs)
        self.assertEqual(self.bytes_of("ours.json"), self.bytes_of("theirs.json"))
        ours = hshfit.gaussians("ggx:alpha=.3", "ours.json", lobes=2, kind="asg", outgoing=3,
                                loss="l2", keep_energy=True, metrics="log")
        theirs = self.json_of("gaussians", "ggx:alpha=.3", "-o", "theirs.json", "--lobes", "2",
                              "--kind", "asg", "--outgoing", "3", "--loss", "l2",
                              "--keep-energy", "--metrics", "log")
        self.assertGreater(ours["picture"]["false_peak"]["value"], 0.1)
        for answer in (ours, theirs):  # the call is worded as one of the program or of the package
            self.assertTrue(answer["poor"].pop("to_try"))
        self.assertEqual(ours | {"output": ""}, theirs | {"output": ""})
        self.assertEqual(self.bytes_of("ours.json"), self.bytes_of("theirs.json"))

    def test_stress_is_that_of_the_program(self):
        ours = hshfit.stress(["phong:exponent=22"], bases=["hsh", "sh"], max_order=4)
        theirs = self.json_of("stress", "phong:exponent=22", "--bases", "hsh,sh", "--max-order",
                              "4")
        self.assertEqual(ours, theirs)


if __name__ == "__main__":
    program.main()
