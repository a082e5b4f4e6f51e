"""Files that the package writes for other programs are the program's, byte for byte."""
import hshfit
import program


class Exports(program.InFolder):
    def test_exports_and_conversions_are_those_of_the_program(self):
        self.run_program("project", "ggx:alpha=0.5", "--outgoing", "8", "-o", "c.json")
        done = hshfit.export("c.json", "ours", targets=["bin", "glsl-es"])
        self.run_program("export", "c.json", "-o", "theirs", "--target", "bin,glsl-es")
        self.assertTrue(done["files"])
        for file in done["files"]:
            self.assertEqual(self.bytes_of(f"ours/{file['path']}"),
                             self.bytes_of(f"theirs/{file['path']}"))
        sidecar = f"ours/{done['sidecar']}"
        hshfit.import_coefficients(sidecar, "back.json")
        self.run_program("import", sidecar, "-o", "theirs_back.json")
        self.assertEqual(self.bytes_of("back.json"), self.bytes_of("theirs_back.json"))
        hshfit.open("phong:exponent=9").write("ours.bsdf", format="rgl")
        self.run_program("convert", "phong:exponent=9", "theirs.bsdf")
        self.assertEqual(self.bytes_of("ours.bsdf"), self.bytes_of("theirs.bsdf"))

    def test_materials_and_lighting_are_those_of_the_program(self):
        for call, options, words in (
                (hshfit.export_material, {"targets": "gltf,materialx", "name": "m"},
                 ["--target", "gltf,materialx", "--name", "m"]),
                (hshfit.export_lighting,
                 {"lighting": "split-sum,prefiltered", "lobes": 2, "lights": "uniform:",
                  "measure_error": False, "targets": ["hlsl"]},
                 ["--lighting", "split-sum,prefiltered", "--lobes", "2", "--light", "uniform:",
                  "--no-error", "--target", "hlsl"])):
            with self.subTest(call.__name__):
                name = call.__name__
                done = call("gltf-pbr:roughnessFactor=0.5", f"{name}_ours", **options)
                expected = self.json_of("export", "gltf-pbr:roughnessFactor=0.5", "-o",
                                        f"{name}_theirs", *words)
                self.assertEqual(list(done), list(expected))
                for file in done["files"]:
                    path = file if isinstance(file, str) else file["path"]
                    if path.endswith(".json"):
                        continue  # seconds
                    self.assertEqual(self.bytes_of(f"{name}_ours/{path}"),
                                     self.bytes_of(f"{name}_theirs/{path}"))


if __name__ == "__main__":
    program.main()
