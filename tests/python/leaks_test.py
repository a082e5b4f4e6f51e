"""Memory does not grow with the number of calls."""
import gc
import resource
import unittest

import numpy as np

import hshfit
import program


def peak():
    """The most memory that the process had, in bytes."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


class Leaks(unittest.TestCase):
    # Lost blocks of 100 bytes would be twice the bound.
    CALLS, BOUND = 100_000, 5_000_000

    def grow(self, call, calls):
        """Growth of the peak over so many calls, after a tenth of them."""
        for _ in range(calls // 10):
            call()
        gc.collect()
        before = peak()
        for _ in range(calls):
            call()
        return peak() - before

    def test_evaluations(self):
        f = hshfit.open("lambert:kd=0.3/0.2/0.1")
        up, wi = np.array([0, 0, 1.0]), hshfit.direction([10, 20, 30], 0)
        self.assertLess(self.grow(lambda: f(wi, up), self.CALLS), self.BOUND)

    def test_evaluations_of_functions_and_their_failures(self):
        f = hshfit.function(lambda wi, wo: wi[:, 2])
        broken = hshfit.function(lambda wi, wo: 1 / 0)
        up = np.array([0, 0, 1.0])

        def call():
            f(up, up)
            with self.assertRaises(ZeroDivisionError):
                broken(up, up)

        self.assertLess(self.grow(call, self.CALLS // 2), self.BOUND)

    def test_brdfs_and_messages(self):
        def call():
            hshfit.open("lambert")
            try:
                hshfit.open("lamber")
            except hshfit.UsageError:
                pass

        self.assertLess(self.grow(call, self.CALLS), self.BOUND)

    def test_projections_and_views(self):
        # 200 calls of 256 x 49 numbers are 20 MB.
        self.assertLess(self.grow(
            lambda: hshfit.project("lambert", outgoing="16x16").coefficients.values, 200),
            self.BOUND)


if __name__ == "__main__":
    program.main()
