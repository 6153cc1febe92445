"""ci/tron_truth.py measures the error of a pose that an emulated bench showed, and misses none. Usage: tron_truth_test.py ROOT."""

import csv
import math
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "ci"))
from tron_truth import pose_errors  # noqa: E402

BODY = ROOT / "data" / "bodies" / "tango.toml"
CENTRE_M = (0.0, 0.018823529411764704, 0.160794117647059)  # of Tango's mass, from that file


def write(file, rows):
    with open(file, "w", newline="", encoding="utf-8") as text:
        table = csv.DictWriter(text, rows[0].keys())
        table.writeheader()
        table.writerows(rows)


def attitude(time, name, q):
    return {"time_s": time, "spacecraft": name, **{f"q_body_eci_{k}": v for k, v in zip("wxyz", q)}}


class Run(unittest.TestCase):
    """The target 8 m ahead of a camera at (0, 0, 0.5) in axes of the inertial frame, turned by 90 deg about z."""

    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.directory.name)
        self.addCleanup(self.directory.cleanup)
        half = math.sqrt(0.5)
        write(self.folder / "attitude.csv", [attitude(5, "servicer", (1, 0, 0, 0)), attitude(5, "target", (half, 0, 0, -half))])
        truth = {"time_s": 5}
        for name, at in (("servicer", (7e6, 0, 0)), ("target", (7e6, 0, 8.5))):
            truth.update({f"{name}_position_eci_{k}_m": v for k, v in zip("xyz", at)})
        write(self.folder / "truth.csv", [truth])
        # By 90 deg about z the body's y axis is the camera's -x axis; the model's origin lies before the centre of mass.
        self.exact = [0.5 * CENTRE_M[1], 0.0, 0.5 * (8.0 - CENTRE_M[2])]
        self.q = (half, 0, 0, half)

    def errors(self, place, q, tries=1, failure="", rows=2):
        shown = [{"image": n, **dict(zip(("C_x_m", "C_y_m", "C_z_m"), place)), **{f"q_C_T_{k}": v for k, v in zip("wxyz", q)}}
                 for n in range(rows)]
        write(self.folder / "bench_truth.csv", shown)
        write(self.folder / "tron.csv", [{"time_s": 5, "failure": failure, "pose_source": "fused", "tries": tries}])
        return pose_errors(self.folder, (0.0, 0.0, 0.5), BODY, 0.5)

    def test_an_exact_pose_has_no_error(self):
        (error,) = self.errors(self.exact, self.q)
        self.assertLess(error[0], 1e-6)
        self.assertLess(error[1], 1e-5)

    def test_errors_are_lengths_of_the_laboratory_and_angles(self):
        angle = math.radians(45.1)
        (error,) = self.errors([self.exact[0] + 3e-3, self.exact[1], self.exact[2] - 4e-3], (math.cos(angle), 0, 0, math.sin(angle)))
        self.assertAlmostEqual(error[0], 5.0, 6)
        self.assertAlmostEqual(error[1], 0.2, 4)

    def test_the_frame_is_the_last_try(self):
        self.assertEqual(len(self.errors(self.exact, self.q, tries=2, rows=3)), 1)
        with self.assertRaises(KeyError):
            self.errors(self.exact, self.q, tries=2, rows=2)

    def test_a_run_without_an_image_is_an_error(self):
        with self.assertRaises(SystemExit):
            self.errors(self.exact, self.q, failure="the lamp is dark")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
