"""The package gives the numbers of the program, bit for bit."""
import csv
import json
import os
import shutil
import subprocess

import numpy as np

import hshfit
import program

MATERIALS = ["lambert:kd=0.3/0.2/0.1", "phong:kd=0.1,ks=0.4,exponent=37", "ggx:alpha=0.2",
             "ward:ks=0.3,ax=0.1,ay=0.4", "disney:roughness=0.4", "preset:hsh-ward",
             "lambert:kd=0.2 + 0.5 * ggx:alpha=0.3"]


def directions(count, seed):
    """Unit vectors, a tenth of them below the horizon."""
    random = np.random.default_rng(seed)
    z = random.uniform(-0.1, 1, count)
    phi = random.uniform(0, 2 * np.pi, count)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)


class SameNumbers(program.InFolder):
    def eval_by_program(self, spec, wi, wo, *words):
        with open("in.csv", "w", newline="", encoding="ascii") as file:
            out = csv.writer(file)
            out.writerow("wi_x wi_y wi_z wo_x wo_y wo_z".split())
            for row in np.concatenate([wi, wo], axis=1):
                out.writerow([repr(float(number)) for number in row])
        self.run_program("eval", spec, "--pairs", "in.csv", "-o", "out.csv", *words)
        with open("out.csv", encoding="ascii") as file:
            rows = list(csv.reader(file))[1:]
        return np.array([[float(cell) for cell in row[6:]] for row in rows])

    def test_eval_of_pairs_is_that_of_the_program(self):
        wi, wo = directions(500, 1), directions(500, 2)
        for spec in MATERIALS:
            for cosine in (False, True):
                values = hshfit.open(spec)(wi, wo, cosine=cosine)
                expected = self.eval_by_program(spec, wi, wo, *["--cosine"] * cosine)
                with self.subTest(spec=spec, cosine=cosine):
                    self.assertTrue(np.array_equal(np.broadcast_to(values, expected.shape),
                                                   expected))

    def test_files_of_projections_are_those_of_the_program(self):
        cases = [("ggx:alpha=0.4", {}, []),
                 ("ggx:alpha=0.4", {"outgoing": (52, 0), "order": 12, "cosine": True},
                  ["--outgoing", "52,0", "--order", "12", "--cosine"]),
                 ("ward:ax=0.2,ay=0.4", {"basis": "sh", "outgoing": "6x6", "cosine": True},
                  ["--basis", "sh", "--outgoing", "6x6", "--cosine"]),
                 ("phong:exponent=10", {"outgoing": 8, "rank": 3, "precision": "half"},
                  ["--outgoing", "8", "--rank", "3", "--precision", "half"]),
                 ("phong:exponent=10", {"form": "halfway", "halfway": (8, 4, 2)},
                  ["--form", "halfway", "--halfway", "8,4,2"])]
        for spec, options, words in cases:
            for extension in ("json", "exr"):
                if extension == "exr" and ("rank" in options or "form" in options):
                    continue  # a form that only JSON can hold
                with self.subTest(spec=spec, options=options, extension=extension):
                    hshfit.project(spec, **options).save(f"ours.{extension}")
                    self.assertEqual(
                        self.bytes_of(f"ours.{extension}"),
                        self.bytes_from("project", spec, *words, extension=extension))

    def test_values_of_a_projection_are_those_in_the_file(self):
        found = hshfit.project("ggx:alpha=0.4", outgoing=8)
        self.run_program("project", "ggx:alpha=0.4", "--outgoing", "8", "-o", "c.json")
        with open("c.json", encoding="utf-8") as file:
            document = json.load(file)
        self.assertTrue(np.array_equal(found.coefficients.values, document["coefficients"]))
        self.assertEqual(found.energy["value"], document["energy"])

    def test_all_bases_at_once_are_those_one_by_one(self):
        for name, found in hshfit.project_all("ggx:alpha=0.5", order=4, outgoing=4).items():
            order = found.coefficients.order
            alone = hshfit.project("ggx:alpha=0.5", basis=name, order=order, outgoing=4)
            scale = np.abs(alone.coefficients.values).max()
            difference = found.coefficients.values - alone.coefficients.values
            # One grid for all bases may be finer than that for one: both are within 1e-6.
            self.assertLess(np.abs(difference).max() / scale, 2e-6, name)

    def test_fits_are_those_of_the_program(self):
        for options, words in (({}, []), ({"loss": "log", "samples": 500, "seed": 7},
                                          ["--loss", "log", "--samples", "500", "--seed", "7"])):
            hshfit.fit("beckmann:alpha=0.3", "ggx", starts=2, **options).save("ours.json")
            self.run_program("fit", "beckmann:alpha=0.3", "--model", "ggx", "--starts", "2",
                             "-o", "theirs.json", *words)
            self.assertEqual(self.bytes_of("ours.json"), self.bytes_of("theirs.json"))

    def test_errors_of_fits_are_those_of_the_program(self):
        cases = [({"bands": "plane:30", "bands_to": "bands.csv", "residuals": "rows.csv"},
                  ["--bands", "plane:30", "--bands-to", "bands.csv", "--residuals", "rows.csv"]),
                 ({"at": "nodes", "sigma": "2%+0.001", "bootstrap": 5, "bands": "plane:30",
                   "bands_to": "bands.csv", "residuals": "rows.csv"},
                  ["--at", "nodes", "--sigma", "2%+0.001", "--bootstrap", "5", "--bands",
                   "plane:30", "--bands-to", "bands.csv", "--residuals", "rows.csv"])]
        for options, words in cases:
            with self.subTest(options=options):
                found = hshfit.fit("beckmann:alpha=0.3", "ggx", starts=2, **options)
                files = [self.bytes_of("bands.csv"), self.bytes_of("rows.csv")]
                for name in ("bands.csv", "rows.csv"):
                    os.remove(name)
                expected = self.json_of("fit", "beckmann:alpha=0.3", "--model", "ggx",
                                        "--starts", "2", *words)
                self.assertEqual(files, [self.bytes_of("bands.csv"), self.bytes_of("rows.csv")])
                self.assertEqual(found.bands, expected["bands"])
                self.assertEqual(found.preset["fit"], expected["fit"])
                with open("bands.csv", encoding="ascii") as file:
                    rows = list(csv.DictReader(file))
                wi, wo = (np.array([[float(row[f"{side}_{axis}"]) for axis in "xyz"]
                                    for row in rows]) for side in ("wi", "wo"))
                at = found.predict(wi, wo)
                self.assertEqual(at["f"].shape, (len(wi), 1))
                np.testing.assert_allclose(at["f"][:, 0], [row["f"] for row in found.bands],
                                           rtol=1e-12)
                np.testing.assert_allclose(at["standard_error"][:, 0],
                                           [row["standard_error"] for row in found.bands],
                                           rtol=1e-9)

    def test_figures_are_files_of_the_program(self):
        found = hshfit.compare("ggx:alpha=0.4", "beckmann:alpha=0.4", outgoing=4, figures="ours",
                               font_size=7)
        expected = self.json_of("compare", "ggx:alpha=0.4", "beckmann:alpha=0.4", "--outgoing",
                                "4", "--figures", "theirs", "--font-size", "7")["figures"]
        self.assertEqual(found.figures, expected["files"])
        self.assertEqual(sorted(os.listdir("ours")), sorted(os.listdir("theirs")))

    def test_certificates_are_those_of_the_program(self):
        if not shutil.which("gnuplot"):
            self.skipTest("gnuplot is not installed")
        folder = os.path.join(os.environ["HSHFIT_SOURCE"], "examples", "goniometer")
        data, fields = (os.path.join(folder, name) for name in ("scans.csv", "fields.json"))
        fit = {"starts": 2, "sigma": "column", "scans": "column"}
        words = ["fit", data, "--model", "lambert+ggx", "--starts", "2", "--sigma", "column",
                 "--scans", "column"]
        for options, more in (({}, []), ({"certificate_fields": fields},
                                         ["--certificate-fields", fields])):
            with self.subTest(options=options):
                hshfit.fit(data, "lambert+ggx", certificate="ours.pdf", **fit, **options)
                self.run_program(*words, "--force", "--certificate", "theirs.pdf", *more)
                self.assertEqual(self.bytes_of("ours.pdf"), self.bytes_of("theirs.pdf"))
        for name, text in (("ours.txt", "certificate='ours.txt' has to end in .pdf"),
                           ("", "certificate: an empty path")):
            with self.assertRaisesRegex(hshfit.UsageError, text):
                hshfit.fit(data, "lambert+ggx", certificate=name, **fit)
        with open("wrong.json", "w", encoding="ascii") as file:
            json.dump({"format": "hshfit-certificate-fields", "version": 1, "labratory": "x"}, file)
        with self.assertRaisesRegex(hshfit.InputError, "wrong.json: unknown field 'labratory'"):
            hshfit.fit(data, "lambert+ggx", certificate="new.pdf",
                       certificate_fields="wrong.json", **fit)
        with self.assertRaisesRegex(hshfit.UsageError, "certificate_fields is for certificate="):
            hshfit.fit(data, "lambert+ggx", certificate_fields=fields, **fit)
        self.assertFalse(os.path.exists("new.pdf"))

    def write_scans(self, columns):
        """Scans of a lobe with a dark signal, as ASTM E1392."""
        with open("scans.astm", "w", encoding="ascii") as file:
            file.write("VARS theta_i,phi_i,theta_s,phi_s," + ",".join(columns) + "\n")
            for incident in np.linspace(0.1, 0.9, 14):
                for out in np.linspace(0.05, 1.25, 9):
                    f = 0.1 + 0.4 * np.cos(out - incident) ** 20 + 0.003 / np.cos(out)
                    cells = ",".join(f"{f + 0.01 * k:.6f}" for k in range(len(columns)))
                    file.write(f"{incident:.6f},0,{out:.6f},3.14159265,{cells}\n")

    def test_instruments_and_laws_of_fits_are_those_of_the_program(self):
        cases = [(["BRDF"], {"sigma": "1%+0.001", "instrument": {"source_aperture": "cone:0.5",
                                                                 "dark": "fit"}},
                  ["--sigma", "1%+0.001", "--source-aperture", "cone:0.5", "--dark", "fit"]),
                 (["BRDF"], {"sigma": "1%+0.001", "calibration": "0.8%",
                             "instrument": {"detector_zero": "0.05"}},
                  ["--sigma", "1%+0.001", "--calibration", "0.8%", "--detector-zero", "0.05"]),
                 (["400nm", "410nm", "420nm", "430nm"],
                  {"loss": "l2", "dispersion": "kd=poly:1,ks=shared,exponent=shared"},
                  ["--loss", "l2", "--dispersion", "kd=poly:1,ks=shared,exponent=shared"])]
        for columns, options, words in cases:
            with self.subTest(options=options):
                self.write_scans(columns)
                found = hshfit.fit("scans.astm", "phong", starts=2, **options)
                found.save("ours.json")
                self.run_program("fit", "scans.astm", "--model", "phong", "--starts", "2", "-o",
                                 "theirs.json", *words)
                self.assertEqual(self.bytes_of("ours.json"), self.bytes_of("theirs.json"))
                self.assertEqual(found.brdf().channels, hshfit.open("ours.json").channels)
        self.write_scans(["BRDF"])
        with_dark = hshfit.fit("scans.astm", "phong", starts=2, sigma="1%+0.001",
                               instrument={"dark": "fit"})
        at = with_dark.predict([0, 0, 1], [0, 0, 1])
        np.testing.assert_allclose(at["f"], with_dark.brdf()([0, 0, 1], [0, 0, 1]))
        self.assertTrue((at["standard_error"] > 0).all())

    def test_curves_are_those_of_the_program(self):
        found = hshfit.curves("ward:ax=0.2,ay=0.3", max_order=5, outgoing=(40, 10), cosine=True)
        expected = self.run_program("report", "ward:ax=0.2,ay=0.3", "--max-order", "5",
                                    "--outgoing", "40,10", "--cosine", "--json")
        self.assertEqual(found.json(), expected)
        by_name = {curve["basis"]: curve for curve in json.loads(expected)["reports"][0]["curves"]}
        for curve in found:
            points = by_name[curve.basis]["points"]
            self.assertEqual(curve.accuracy.tolist(), [point["accuracy"] for point in points])
            self.assertEqual(curve.coefficients.tolist(),
                             [point["coefficients"] for point in points])

    def test_metrics_are_those_of_the_program(self):
        found = hshfit.compare("ggx:alpha=0.4", "beckmann:alpha=0.4", outgoing=4)
        expected = self.json_of("compare", "ggx:alpha=0.4", "beckmann:alpha=0.4", "--outgoing",
                                "4")
        self.assertEqual(found.pairs, expected["pairs"])
        self.assertEqual(found.picture, expected["picture"])
        self.assertEqual(hshfit.picture_error("ggx:alpha=0.4", "beckmann:alpha=0.4"),
                         expected["picture"])
        for row in expected["metrics"]:
            if row["value"] is None:
                self.assertTrue(np.isnan(found[row["name"]]), row["name"])
            else:
                self.assertEqual(found[row["name"]], row["value"], row["name"])

    def test_a_sun_is_split_off_as_by_the_program(self):
        pixels = np.ones((16, 32, 3), "<f4")
        for name, peak in (("plain.pfm", 1), ("sun.pfm", 5e4)):
            pixels[9, 10] = peak
            with open(name, "wb") as file:
                file.write(b"PF\n32 16\n-1\n" + pixels.tobytes())
        light = hshfit.light("sun.pfm:turn=20", order=4, split_sun="day.json")
        ours = [self.bytes_of(name) for name in ("day.json", "day_rest.exr")]
        for name in ("day.json", "day_rest.exr"):
            os.remove(name)
        expected = self.json_of("light", "sun.pfm:turn=20", "--order", "4", "--split-sun", "-o",
                                "day.json")["split"]
        self.assertEqual(ours, [self.bytes_of(name) for name in ("day.json", "day_rest.exr")])
        self.assertEqual(light.split, expected)
        self.assertIsNone(hshfit.light("sun.pfm", order=4).split)
        total = hshfit.light(light.split["specification"], order=4)
        np.testing.assert_allclose(total.values[:, 0], light.values[:, 0], rtol=1e-5)
        for spec, kind, text in (("plain.pfm", hshfit.InputError, "has no sun"),
                                 ("uniform:", hshfit.UsageError, "one picture"),
                                 (["sun.pfm", "uniform:"], hshfit.UsageError, "a sum")):
            with self.assertRaisesRegex(kind, text):
                hshfit.light(spec, split_sun="new.json")
        with self.assertRaisesRegex(hshfit.UsageError, "split_sun: an empty path"):
            hshfit.light("sun.pfm", split_sun="")
        self.assertFalse([name for name in os.listdir(".") if name.startswith("new")])

    def test_light_is_that_of_the_program(self):
        light = hshfit.light("sky:type=12,elevation=40", order=6)
        light.save("ours.json")
        self.run_program("light", "sky:type=12,elevation=40", "--order", "6", "-o", "theirs.json")
        self.assertEqual(self.bytes_of("ours.json"), self.bytes_of("theirs.json"))
        turned, _ = light.rotate(hshfit.Rotation(euler=(10, 20, 30)))
        turned.save("ours_turned.json")
        self.run_program("rotate", "theirs.json", "-o", "theirs_turned.json", "--euler",
                         "10,20,30")
        self.assertEqual(self.bytes_of("ours_turned.json"), self.bytes_of("theirs_turned.json"))
        nine = hshfit.irradiance("sky:type=12,elevation=40")
        expected = self.json_of("irradiance", "sky:type=12,elevation=40")
        self.assertEqual(nine["radiance"].tolist(), expected["radiance"])
        self.assertEqual(nine["error"]["maximum"], expected["error"]["maximum"])
        self.assertEqual(nine["nine_error"]["maximum"], expected["nine"]["error"]["maximum"])

    def test_rotated_coefficients_and_matrices_are_those_of_the_program(self):
        found = hshfit.project("ggx:alpha=0.5", outgoing=4, order=4).coefficients
        found.save("c.json")
        turned, cost = found.rotate(hshfit.Rotation(up=(20, 30)))
        turned.save("ours.json")
        expected = self.json_of("rotate", "c.json", "-o", "theirs.json", "--up", "20,30")
        self.assertEqual(self.bytes_of("ours.json"), self.bytes_of("theirs.json"))
        self.assertEqual(cost["lost_energy"], expected["lost_energy"])
        other, _ = found.rotate(hshfit.Rotation(up=(20, 30)), method="table", tables=11)
        other.save("ours.json")
        self.run_program("rotate", "c.json", "-o", "theirs.json", "--up", "20,30", "--method",
                         "table", "--tables", "11", "--force")
        self.assertEqual(self.bytes_of("ours.json"), self.bytes_of("theirs.json"))
        matrix = hshfit.matrix("hsh", "sh", order=2, weight="cosine")
        expected = self.json_of("matrix", "hsh", "sh", "--order", "2", "--weight", "cosine")
        self.assertEqual(matrix.tolist(), expected["matrix"])
        matrix = hshfit.matrix("sh", "hsh", order=3, from_order=4)
        expected = self.json_of("matrix", "sh", "hsh", "--order", "3", "--from-order", "4")
        self.assertEqual(matrix.tolist(), expected["matrix"])

    def test_pictures_are_those_of_the_program(self):
        hshfit.render(["lambert", "ggx:alpha=0.3"], "ours.png", size=24, light=[(30, 90, 2)])
        self.assertEqual(self.bytes_of("ours.png"),
                         self.bytes_from("render", "lambert", "ggx:alpha=0.3", "--size", "24",
                                         "--light", "30,90,2", extension="png"))
        options = ["render", "ggx:alpha=0.5", "--light", "uniform:", "--size", "8",
                   "--samples", "1", "--orders", "2,4", "--view", "60,10"]
        done = hshfit.render("ggx:alpha=0.5", "ours.exr", light="uniform:", size=8, samples=1,
                             orders=[2, 4], view=(60, 10), by=None)
        self.assertEqual(self.bytes_of("ours.exr"), self.bytes_from(*options, extension="exr"))
        expected = self.json_of(*options, "-o", "theirs.exr")
        expected["output"] = "ours.exr"
        self.assertEqual(done, expected)

    def scene(self, name):
        return os.path.join(os.environ["HSHFIT_SOURCE"], "examples", "scenes", name)

    def assert_same_but_times(self, ours, theirs, times):
        """Two answers, without the keys that say how long something took."""
        def without(value):
            if isinstance(value, dict):
                return {key: without(each) for key, each in value.items() if key not in times}
            return [without(each) for each in value] if isinstance(value, list) else value
        self.assertEqual(without(ours), without(theirs))

    def test_illuminated_scenes_are_those_of_the_program(self):
        times = {"seconds", "cpu_seconds", "preparation_seconds", "cache_cpu_seconds"}
        for method, options, words in [
                ("path", {"samples": 1, "bounces": 2}, ["--samples", "1", "--bounces", "2"]),
                ("radiance-cache", {"samples": 1, "rays": 64, "choose_by": "loss", "basis": None},
                 ["--samples", "1", "--rays", "64", "--choose-by", "loss"]),
                ("radiance-cache", {"samples": 1, "rays": 64, "choose_by": "loss", "memory": 9.5,
                                    "gradient": "none", "without": ["error-control"]},
                 ["--samples", "1", "--rays", "64", "--choose-by", "loss", "--memory", "9.5",
                  "--gradient", "none", "--without", "error-control"])]:
            ours = hshfit.illuminate(self.scene("box.json"), "ours", method=method, force=True,
                                     **options)
            theirs = self.json_of("illuminate", self.scene("box.json"), "-o", "theirs", "--method",
                                  method, "--force", *words)
            for document in ours, theirs:
                for camera in document["cameras"]:
                    camera["files"] = [os.path.basename(file) for file in camera["files"]]
            with self.subTest(method=method):
                self.assert_same_but_times(ours, theirs, times)

    def test_transfer_is_that_of_the_program(self):
        scene = self.scene("ball_and_wall.json")
        ours = hshfit.transfer(scene, "ours", rays=16, edge=0, passes=1, order=3)
        theirs = self.json_of("transfer", scene, "-o", "theirs", "--rays", "16", "--edge", "0",
                              "--passes", "1", "--order", "3")
        self.assertEqual(self.bytes_of("ours/transfer.tensor"),
                         self.bytes_of("theirs/transfer.tensor"))
        self.assertEqual(ours["energy"], theirs["energy"])
        self.assertEqual(ours["vertices"], theirs["vertices"])

    def test_maps_of_materials_are_those_of_the_program(self):
        maps = os.path.join(os.environ["HSHFIT_SOURCE"], "examples", "maps")
        times = {"seconds", "texels_per_second"}
        for name, folder, options, words in [
                ("coin.json", "low-rank",
                 {"form": "low-rank", "order": 3, "error": 0.02, "checks": 2},
                 ["--form", "low-rank", "--order", "3", "--error", "0.02", "--checks", "2"]),
                ("coin.json", "halfway",
                 {"form": "halfway", "clusters": 2, "halfway": "4,2,1", "checks": 1, "mips": False},
                 ["--form", "halfway", "--clusters", "2", "--halfway", "4,2,1", "--checks", "1",
                  "--mips", "none"]),
                ("bumpy.json", "filtered", {"form": "ellipse", "checks": 1},
                 ["--form", "ellipse", "--checks", "1"])]:
            source = os.path.join(maps, name)
            ours = hshfit.svbrdf(source, "ours/" + folder, force=True, **options)
            theirs = self.json_of("svbrdf", source, "-o", "theirs/" + folder, "--force", *words)
            for document in ours, theirs:
                document["files"] = [os.path.basename(file) for file in document["files"]]
            for word in ("better", "to_try"):  # the call of the program
                theirs.get("captured", {}).pop(word, None)
            with self.subTest(folder=folder):
                self.assert_same_but_times(ours, theirs, times)
                self.assertEqual(self.bytes_of(f"ours/{folder}/material.ktx2"),
                                 self.bytes_of(f"theirs/{folder}/material.ktx2"))

    def test_plans_are_those_of_the_program(self):
        ours = hshfit.plan(self.scene("car_paint.json"), "ours", bases=["hsh"], max_order=4)
        with open("ours/plan.json", encoding="utf-8") as file:
            self.assertEqual(json.load(file), ours)
        done = subprocess.run([program.PROGRAM, "plan", self.scene("car_paint.json"), "-o",
                               "theirs", "--bases", "hsh", "--max-order", "4", "--json",
                               "--quiet"], check=False, capture_output=True, text=True)
        theirs = json.loads(done.stdout)
        self.assertEqual(program.without_calls(ours), program.without_calls(theirs))

    def test_trades_are_those_of_the_program(self):
        ours = hshfit.tradeoff("ggx:alpha=0.5", bases=["hsh"], orders=[3], forms=["outgoing"],
                               ranks=[0, 2], precisions=["half"], outgoing=["8"], timing=False,
                               pair_count=256)
        theirs = self.json_of("tradeoff", "ggx:alpha=0.5", "--bases", "hsh", "--orders", "3",
                              "--forms", "outgoing", "--ranks", "0,2", "--precisions", "half",
                              "--outgoing", "8", "--no-timing", "--pair-count", "256")
        self.assertEqual(program.without_calls(ours), program.without_calls(theirs))

    def test_libraries_are_those_of_the_program(self):
        specs = ["ggx:alpha=.2,F0=.9/.6/.3", "ggx:alpha=.3,F0=.8/.7/.6", "lambert:kd=.5/.5/.1",
                 "lambert:kd=.3/.2/.1+ggx:alpha=.35,F0=.04"]
        ours = hshfit.Library.learn(specs, "ours.library", components=4, limit=10,
                                    limit_maximum=10, limit_flip=1)
        words = ["--components", "4", "--limit", "10", "--limit-maximum", "10", "--limit-flip", "1"]
        self.run_program("library", "learn", *specs, *words, "-o", "theirs.library")
        self.assertEqual(self.bytes_of("ours.library"), self.bytes_of("theirs.library"))
        self.assertEqual(hshfit.Library("theirs.library").names, ours.names)
        name = ours.names[1]
        self.assertEqual(ours.coefficients(name).shape, (3, ours.components.shape[0]))
        self.assertEqual(ours.components.shape[1:], ours.mean.shape)
        done = ours.encode("lambert:kd=.2/.4/.2", "one.library")
        theirs = self.json_of("library", "encode", "theirs.library", "lambert:kd=.2/.4/.2", "-o",
                              "two.library")
        for key in ("name", "kind", "bytes", "picture", "fallback"):
            self.assertEqual(done[key], theirs[key])
        placed = ours.map("ours.html", near=0.2)
        theirs = self.json_of("library", "map", "ours.library", "--near", "0.2", "-o",
                              "theirs.html")
        self.assertEqual(placed, {key: theirs[key] for key in placed})
        self.assertEqual(self.bytes_of("ours.html"), self.bytes_of("theirs.html"))
        pairs = self.json_of("library", "next", "--library", "theirs.library", "--count", "5")
        mine = ours.next(5)
        self.assertEqual([row["expected_error"] for row in pairs["pairs"]], mine[:, 4].tolist())
        with open("scan.csv", "w", encoding="ascii") as file:
            file.write("theta_i,phi_i,theta_o,phi_o,R,G,B\n")
            for row in mine[:, :4].tolist():
                file.write(",".join(map(repr, [*row, 0.1, 0.08, 0.06])) + "\n")
        found = ours.reconstruct("scan.csv", "found.library", sigma="5%")
        again = self.json_of("library", "reconstruct", "scan.csv", "--library", "theirs.library",
                             "--sigma", "5%", "-o", "again.library")
        for key, value in found.items():
            self.assertEqual(value, again[key])
        self.assertEqual(ours.left_out, [])
        with self.assertRaises(hshfit.UsageError):
            ours.coefficients("nobody")
        with self.assertRaises(hshfit.UsageError):
            ours.next(3, instrument="hand")

    def test_arguments_are_refused_where_the_program_refuses_them(self):
        for work in [lambda: hshfit.render("lambert", "x.png", size=4),
                     lambda: hshfit.render("lambert", "x.png", light=[(200, 0)]),
                     lambda: hshfit.render("lambert", "x.png", by="paint"),
                     lambda: hshfit.illuminate("s.json", "x", method="guess"),
                     lambda: hshfit.illuminate("s.json", "x", samples=0),
                     lambda: hshfit.transfer("s.json", "x", kind="most"),
                     lambda: hshfit.transfer("s.json", "x", order=17),
                     lambda: hshfit.plan("s.json", "x", max_order=33),
                     lambda: hshfit.svbrdf("m.json", "x", form="outgoing", rank=2),
                     lambda: hshfit.svbrdf("m.json", "x", form="ellipse", order=4),
                     lambda: hshfit.svbrdf("m.json", "x", form="cluster"),
                     lambda: hshfit.svbrdf("m.json", "x", form="outgoing", precision="byte"),
                     lambda: hshfit.svbrdf("m.json", "x", form="clusters", clusters=65537),
                     lambda: hshfit.tradeoff("lambert", orders=[0]),
                     lambda: hshfit.choose("lambert", renderer="threa"),
                     lambda: hshfit.ltc("ggx", "x.json", mapping="cube"),
                     lambda: hshfit.gaussians("lambert", "x.json", kind="gauss"),
                     lambda: hshfit.gaussians("lambert", "x.json", lobes=17),
                     lambda: hshfit.stress(max_order=1)]:
            with self.assertRaises(hshfit.UsageError):
                work()
        for option in [{"basis": "hsh"}, {"order": 4}, {"loss": 0.1}, {"rays": 64},
                       {"accuracy": 0.2}, {"choose_by": "loss"}, {"records": "r.bin"}]:
            with self.assertRaisesRegex(hshfit.UsageError, "is for the method radiance-cache"):
                hshfit.illuminate("s.json", "x", **option)
        for option in [{"instrument": {"slit": 1}}, {"bands_to": "b.csv"}, {"bootstrap": 1},
                       {"figures": "f", "figure_width": "wide"}]:
            with self.assertRaises(hshfit.UsageError):
                hshfit.fit("lambert", "lambert", **option)
        with self.assertRaises(hshfit.UsageError):
            hshfit.compare("lambert", "lambert", sigma="2%")
        for work in [lambda: hshfit.illuminate("absent.json", "x"),
                     lambda: hshfit.transfer("absent.json", "x"),
                     lambda: hshfit.svbrdf("absent.json", "x"),
                     lambda: hshfit.plan("absent.json", "x")]:
            with self.assertRaises(hshfit.InputError):
                work()

    def test_files_come_back_as_what_they_are(self):
        plain = hshfit.project("ggx:alpha=0.5", outgoing=4)
        plain.save("plain.json")
        self.assertTrue(np.array_equal(hshfit.read("plain.json").values,
                                       plain.coefficients.values))
        hshfit.project("ggx:alpha=0.5", outgoing=4, precision="unorm8").save("form.json")
        form = hshfit.read("form.json")
        self.assertEqual(form.kind, "outgoing")
        form.save("again.json")
        self.assertEqual(self.bytes_of("form.json"), self.bytes_of("again.json"))
        hshfit.light("uniform:radiance=2", order=2).save("light.json")
        # The constant 2 over the sphere is 2 sqrt(4 pi) times the first function.
        self.assertAlmostEqual(hshfit.read("light.json").values[0, 0], 2 * np.sqrt(4 * np.pi), 12)
        self.assertEqual(hshfit.read("preset:hsh-phong").channels, ["grey"])


if __name__ == "__main__":
    program.main()
