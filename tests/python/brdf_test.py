"""BRDFs as functions of arrays: shapes, formulas, functions of Python."""
import threading
import unittest

import numpy as np

import hshfit
import program


def directions(count, seed):
    random = np.random.default_rng(seed)
    z = random.uniform(0.05, 1, count)
    phi = random.uniform(0, 2 * np.pi, count)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)


def phong(wi, wo, exponent=5):
    """0.1 / pi + 0.4 (cos alpha)^n about the mirror direction of wo."""
    mirror = wo * np.array([-1, -1, 1])
    return 0.1 / np.pi + 0.4 * np.maximum((wi * mirror).sum(-1), 0) ** exponent


class Evaluation(unittest.TestCase):
    def test_formula_of_phong(self):
        wi, wo = directions(1000, 1), directions(1000, 2)
        found = hshfit.open("phong:kd=0.1,ks=0.4,exponent=5")(wi, wo)
        np.testing.assert_allclose(found[:, 0], phong(wi, wo), rtol=1e-13)

    def test_cosine_multiplies_by_that_of_wi(self):
        wi, wo = directions(100, 3), directions(100, 4)
        f = hshfit.open("ggx:ks=1/0.5/0.2,alpha=0.3")
        # 1/|wi| is 1 but for rounding.
        np.testing.assert_allclose(f(wi, wo, cosine=True), f(wi, wo) * wi[:, 2:], rtol=1e-15)

    def test_shapes_broadcast_as_in_numpy(self):
        f = hshfit.open("ggx:ks=1/0.5/0.2,alpha=0.3")
        wi, wo = directions(12, 5).reshape(3, 4, 3), directions(4, 6)
        self.assertEqual(f(wi[0, 0], wo[0]).shape, (3,))
        self.assertEqual(f(wi, wo[0]).shape, (3, 4, 3))
        table = f(wi, wo)
        self.assertEqual(table.shape, (3, 4, 3))
        outer = f(wi[:, :, None], wo)
        self.assertEqual(outer.shape, (3, 4, 4, 3))
        for i in range(3):
            for j in range(4):
                np.testing.assert_array_equal(table[i, j], f(wi[i, j], wo[j]))
                for k in range(4):
                    np.testing.assert_array_equal(outer[i, j, k], f(wi[i, j], wo[k]))
        self.assertEqual(f(np.empty((0, 3)), wo[0]).shape, (0, 3))

    def test_layout_of_the_memory_does_not_matter(self):
        f = hshfit.open("ggx:alpha=0.3")
        wi, wo = directions(300, 7), directions(300, 8)
        expected = f(wi, wo)
        columns = np.asfortranarray(wi)
        records = np.zeros(300, dtype=[("pad", "i1"), ("d", "f8", 3)])
        records["d"] = wi
        for other in (columns, wi[::-1][::-1], records["d"], wi.tolist(), np.repeat(wi, 2, 0)[::2]):
            np.testing.assert_array_equal(f(other, wo), expected)
        np.testing.assert_array_equal(f(wi[::-1], wo[::-1]), expected[::-1])

    def test_pairs_have_the_values_of_single_calls_for_every_model(self):
        wi, wo = directions(37, 9), directions(3, 10)
        wo_rows = np.repeat(wo, [20, 1, 16], axis=0)
        for row in hshfit.catalog("models"):
            spec = row["name"]
            try:
                f = hshfit.open(spec)
            except hshfit.UsageError:  # parameters that have to be given
                continue
            with self.subTest(model=spec):
                # The outgoing light of a transmission is below the surface.
                below = "side=transmission-" in f.name
                rows = wo_rows * [1, 1, -1] if below else wo_rows
                together = f(wi, rows)
                apart = np.array([f(a, b) for a, b in zip(wi, rows)])
                np.testing.assert_array_equal(together, apart)

    def test_albedo_of_lambert_is_its_parameter(self):
        f = hshfit.open("lambert:kd=0.3/0.2/0.1")
        found = f.albedo(hshfit.direction([0, 45, 80], 10))
        np.testing.assert_allclose(found, np.tile([0.3, 0.2, 0.1], (3, 1)), rtol=1e-9)

    def test_transmission_leaves_below_the_surface(self):
        f = hshfit.open("lambert-transmission:kt=0.4")
        wi, wo = hshfit.direction(30, 0), hshfit.direction(150, 180)
        np.testing.assert_allclose(f(wi, wo), [0.4 / np.pi], rtol=1e-14)
        np.testing.assert_allclose(f.reflectance(wi), [0.4], rtol=1e-6)
        np.testing.assert_allclose(f.albedo(wo), [0.4], rtol=1e-6)
        for refused in (lambda: f(wi, wi), lambda: f.albedo(wi)):
            with self.assertRaisesRegex(hshfit.InputError, "above the surface"):
                refused()
        with self.assertRaisesRegex(hshfit.UsageError, "takes reflections"):
            f.sphere(16)

    def test_directions_from_angles(self):
        np.testing.assert_allclose(hshfit.direction(30, 90), [0, 0.5, np.sqrt(0.75)], atol=1e-15)
        self.assertEqual(hshfit.direction(np.zeros((2, 1)), np.zeros(5)).shape, (2, 5, 3))
        horizon = hshfit.direction([90, -90, 270], [0, 40, 10])
        np.testing.assert_array_equal(horizon[:, 2], 0)
        np.testing.assert_array_equal(hshfit.open("lambert")(horizon, [0, 0, 1.0]), 0)

    def test_spheres_are_pictures(self):
        picture = hshfit.open("lambert:kd=0.5").sphere(32)
        self.assertEqual((picture.shape, picture.dtype), ((32, 32, 3), np.float32))
        self.assertGreater(picture[16, 16, 0], 0)


class Functions(unittest.TestCase):
    def test_projection_of_a_function_is_that_of_the_model(self):
        for cosine in (False, True):
            options = {"order": 8, "outgoing": 6, "cosine": cosine}
            model = hshfit.project("phong:kd=0.1,ks=0.4,exponent=5", **options)
            f = hshfit.function(phong, isotropic=True, mirror_symmetric=True)
            found = hshfit.project(f, **options)
            difference = np.abs(found.coefficients.values - model.coefficients.values).max()
            # Both are within the tolerance of quadrature, 1e-6 of the largest coefficient.
            self.assertLess(difference, 1e-6 * np.abs(model.coefficients.values).max())

    def test_functions_are_called_with_batches(self):
        sizes = []

        def f(wi, wo):
            self.assertEqual(wo.shape, (3,))
            self.assertEqual(wi.shape[1], 3)
            np.testing.assert_allclose((wi ** 2).sum(-1), 1, atol=1e-12)
            sizes.append(len(wi))
            return np.full(len(wi), 0.2)

        found = hshfit.project(hshfit.function(f, isotropic=True), outgoing=4, order=3)
        self.assertGreaterEqual(sum(sizes), found.evaluations)
        self.assertGreater(sum(sizes), 10 * len(sizes))

    def test_functions_have_channels(self):
        def f(wi, wo):
            return np.ones((len(wi), 1)) * np.array([0.1, 0.2, 0.3])

        brdf = hshfit.function(f, channels="rgb", name="stripes")
        self.assertEqual((brdf.name, brdf.channels), ("stripes", ["R", "G", "B"]))
        wi = directions(5, 11)
        np.testing.assert_array_equal(brdf(wi, [0, 0, 1.0]), np.tile([0.1, 0.2, 0.3], (5, 1)))
        lambda_nm = hshfit.function(lambda wi, wo: np.ones((len(wi), 2)), channels=[500, 600])
        self.assertEqual(lambda_nm.channels, ["500nm", "600nm"])
        np.testing.assert_array_equal(lambda_nm.wavelengths, [500, 600])

    def test_what_a_function_raises_reaches_the_caller(self):
        def f(wi, wo):
            raise KeyError("broken")

        brdf = hshfit.function(f)
        for use in (lambda: brdf([0, 0, 1.0], [0, 0, 1.0]), lambda: hshfit.project(brdf),
                    lambda: hshfit.curves(brdf), lambda: hshfit.compare(brdf, "lambert"),
                    lambda: brdf.albedo([0, 0, 1.0]), lambda: brdf.sphere(16),
                    lambda: hshfit.fit(brdf, "lambert")):
            with self.assertRaisesRegex(KeyError, "broken"):
                use()

    def test_a_function_works_again_after_it_failed(self):
        fail = [True]

        def f(wi, wo):
            return [1, 2] if fail[0] else np.full(len(wi), 0.5)

        brdf = hshfit.function(f, name="half")
        message = "half: for 4 directions the function returned an array of shape \\(2\\); " \
                  "right would be \\(4,\\)"
        with self.assertRaisesRegex(hshfit.UsageError, message):
            brdf(directions(4, 12), [0, 0, 1.0])
        fail[0] = False
        np.testing.assert_array_equal(brdf(directions(4, 12), [0, 0, 1.0]), np.full((4, 1), 0.5))

    def test_functions_may_use_the_package(self):
        inner = hshfit.open("ggx:alpha=0.5")
        mixed = hshfit.function(lambda wi, wo: 0.5 * inner(wi, wo), isotropic=True,
                                halfway_width=0.5)
        found = hshfit.project(mixed, outgoing=4, order=5).coefficients.values
        expected = hshfit.project(inner, outgoing=4, order=5).coefficients.values / 2
        np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())

    def test_fit_of_a_function_recovers_its_parameters(self):
        fit = hshfit.fit(hshfit.function(phong, isotropic=True), "phong", starts=4)
        values = {parameter.name: parameter.value for parameter in fit.parameters}
        for name, value in {"kd": 0.1, "ks": 0.4, "exponent": 5}.items():
            self.assertAlmostEqual(values[name], value, 6)


class Threads(unittest.TestCase):
    def test_eight_threads_at_once(self):
        wi, wo = directions(2000, 13), directions(2000, 14)
        f = hshfit.open("ggx:alpha=0.3")
        own = hshfit.function(phong, isotropic=True)
        expected = (f(wi, wo), hshfit.project(f, outgoing=4).coefficients.values,
                    hshfit.project(own, outgoing=4).coefficients.values)
        wrong = []

        def work():
            try:
                for _ in range(5):
                    np.testing.assert_array_equal(f(wi, wo), expected[0])
                    np.testing.assert_array_equal(
                        hshfit.project(f, outgoing=4).coefficients.values, expected[1])
                    np.testing.assert_array_equal(
                        hshfit.project(own, outgoing=4).coefficients.values, expected[2])
            except BaseException as error:  # noqa: a thread's failure is the test's
                wrong.append(error)

        workers = [threading.Thread(target=work) for _ in range(8)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(wrong, [])

    def test_the_number_of_threads_changes_nothing(self):
        before = hshfit.threads()
        expected = hshfit.project("ward:ax=0.2,ay=0.4", outgoing="6x6", cosine=True)
        try:
            hshfit.set_threads(1)
            self.assertEqual(hshfit.threads(), 1)
            found = hshfit.project("ward:ax=0.2,ay=0.4", outgoing="6x6", cosine=True)
        finally:
            hshfit.set_threads(0)
        self.assertEqual(hshfit.threads(), before)
        np.testing.assert_array_equal(found.coefficients.values, expected.coefficients.values)


if __name__ == "__main__":
    program.main()
