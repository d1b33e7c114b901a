#!/usr/bin/env python3
"""scripts/dev/fit_expected_error.py on errors drawn with known shares: it finds them again,
whatever the scenes' brightness and the noise of their references, and tells how often they
hold."""
import pathlib
import sys
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "dev"
sys.path.insert(0, str(SCRIPTS))
try:
    import numpy as np
    import fit_expected_error as fit
except ImportError as missing:  # of the libraries that only developers' scripts need
    print(f"skipped: {missing}")
    sys.exit(77)

SHARES = {"term_change": 0.8, "term_answer": 0.1}


def drawn_scene(rng, brightness, noise, points=20000):
    """Errors that are normal with the standard deviation that SHARES say, beside a reference whose
    own error has the variance that it states."""
    terms = {name: brightness * rng.lognormal(sigma=1, size=points) for name in SHARES}
    terms["term_cache"] = brightness * rng.lognormal(sigma=1, size=points)  # has no share
    terms["term_mean"] = np.full(points, brightness)
    deviation = np.sqrt(sum((SHARES[name] * terms[name]) ** 2 for name in SHARES))
    variance = (noise * deviation) ** 2
    answer = rng.normal(size=points) * deviation
    reference = rng.normal(size=points) * np.sqrt(variance)
    grey = {f"total_{c}": answer for c in "rgb"} | {f"direct_{c}": 0 * answer for c in "rgb"}
    sample = {"indirect": np.stack([reference] * 3, 1), "variance": variance}
    return fit.Scene(sample, terms | grey)


class Fit(unittest.TestCase):
    def test_finds_the_shares_under_noise(self):
        rng = np.random.default_rng(1)
        scenes = [drawn_scene(rng, brightness, noise=0.7) for brightness in (0.01, 1, 300)]
        names = ["term_change", "term_answer", "term_cache"]
        shares = fit.fit_shares(scenes, names)
        self.assertAlmostEqual(shares["term_change"], 0.8, delta=0.03)
        self.assertAlmostEqual(shares["term_answer"], 0.1, delta=0.02)
        self.assertLess(shares.get("term_cache", 0), 0.03)

    def test_calibration_of_normal_errors(self):
        rng = np.random.default_rng(2)
        scenes = [drawn_scene(rng, brightness, noise=0) for brightness in (1, 5)]
        told = fit.calibration(scenes, SHARES)
        for multiple, share in ((0.5, 0.3829), (1, 0.6827), (2, 0.9545), (3, 0.9973)):
            self.assertAlmostEqual(told["within"][multiple], share, delta=0.01)
        for expected, true in told["tenths"]:
            self.assertAlmostEqual(true / expected, 1, delta=0.1)
        self.assertGreater(told["rank correlation"], 0.4)
        timid = fit.calibration(scenes, {name: 10 * share for name, share in SHARES.items()})
        self.assertGreater(timid["within"][0.5], 0.99)
        for expected, true in timid["tenths"]:
            self.assertAlmostEqual(true / expected, 0.1, delta=0.01)

    def test_noise_of_the_reference_is_no_error(self):
        rng = np.random.default_rng(3)
        told = fit.calibration([drawn_scene(rng, 1, noise=1)], SHARES)
        for expected, true in told["tenths"]:
            self.assertAlmostEqual(true / expected, 1, delta=0.15)


if __name__ == "__main__":
    unittest.main()
