"""vbar bound: its filter and partials against analytic cases, and the bound of a flight beside the covariance of the flight software."""
import math
import os
import sys
import unittest

from vbar_program import BINARY, SOURCE, fly, main, scratch, vbar

sys.path.insert(0, str(BINARY / "python"))
os.environ["VBAR"] = str(BINARY / "vbar")
try:
    import numpy
    import pandas
except ImportError:
    numpy = None

EXPERIMENT3 = SOURCE / "missions" / "experiment3.toml"


@unittest.skipUnless(numpy, "python3-pandas is not installed")
class BoundFilter(unittest.TestCase):
    """The square-root information filter and the measured noise."""

    def test_constant_velocity_by_ranges(self):
        """N equal measurements of a uniform motion: variance of the last position 2 (2 N - 1) / (N (N + 1)) of one (Bar-Shalom 2001, 3.5)."""
        from vbar.information_filter import InformationFilter
        information, sigma = InformationFilter(2), 3.0
        for n in range(1, 41):
            if n > 1:
                information.propagate(numpy.array([[1.0, 10.0], [0.0, 1.0]]), numpy.zeros((2, 0)))
            information.measure([[1.0, 0.0]], sigma**2)
            variance = information.covariance(2)[0, 0]
            self.assertTrue(math.isinf(variance) if n == 1 else math.isclose(variance, sigma**2 * 2 * (2 * n - 1) / (n * (n + 1)), rel_tol=1e-9), n)

    def test_steady_state_of_a_random_walk(self):
        """P = (q + sqrt(q^2 + 4 q r)) / 2 before, and r P / (P + r) after a measurement: the scalar Riccati equation."""
        from vbar.information_filter import InformationFilter
        q, r = 0.3, 2.0
        information = InformationFilter(1)
        information.know(0, [100.0])
        for _ in range(200):
            information.propagate(numpy.eye(1), numpy.array([[q**0.5]]))
            information.measure([[1.0]], r)
        before = (q + (q**2 + 4 * q * r)**0.5) / 2
        self.assertAlmostEqual(information.covariance(1)[0, 0], r * before / (before + r), 12)

    def test_process_keeps_its_stationary_variance(self):
        from vbar.information_filter import GaussMarkov, InformationFilter, root
        process, information = GaussMarkov(0, 1, 0.7, 50.0), InformationFilter(1)
        information.know(0, process.sigmas())
        for _ in range(30):
            transition, noise = numpy.eye(1), numpy.zeros((1, 1))
            process.fill(0.0, 20.0, transition, noise)
            information.propagate(transition, root(noise))
        self.assertAlmostEqual(information.covariance(1)[0, 0], 0.49, 12)

    def test_correlation_of_drawn_noise(self):
        """Half white, half of a first-order process of 100 s: drawn for 20 series of 2000 values, some 400 independent ones each."""
        from vbar.measured_noise import correlation
        draw = numpy.random.default_rng(7)
        series, decay = [], math.exp(-5.0 / 100.0)
        for _ in range(20):
            state, values = draw.normal(), []
            for _ in range(2000):
                state = decay * state + (1 - decay**2)**0.5 * draw.normal()
                values.append(0.5**0.5 * (state + draw.normal()))
            series.append((5.0 * numpy.arange(2000), numpy.array(values)))
        shares, times = correlation(series, 5.0)
        self.assertAlmostEqual(sum(shares), 0.5, delta=0.05)
        self.assertAlmostEqual(numpy.average(times, weights=shares), 100.0, delta=30.0)
        self.assertEqual(correlation([(numpy.zeros(1), numpy.ones(1))], 5.0)[0], (0.0, 0.0))  # nothing to correlate: white

    def test_noise_of_an_angle_and_a_length(self):
        """Chi-square of some 10,000 draws where either prevails: both variances to 1.4 %, 1 sigma."""
        from vbar.bound_bearings import variances
        draw = numpy.random.default_rng(8)
        distances = numpy.geomspace(1e3, 1e6, 20000)
        angle, length = variances((draw.normal(size=20000) * numpy.hypot(3e-6, 0.1 / distances))**2, distances)
        self.assertAlmostEqual(angle / 9e-12, 1.0, delta=0.05)
        self.assertAlmostEqual(length / 0.01, 1.0, delta=0.05)


def circular(radius, arc=0.0):
    """State on a circular polar orbit."""
    speed = (3.986004415e14 / radius)**0.5
    c, s = math.cos(arc), math.sin(arc)
    return numpy.array([radius * c, 0.0, radius * s, -speed * s, 0.0, speed * c])


def clohessy_wiltshire(n, t):
    """Of R, T, N and their rates over a time t (1960)."""
    s, c = math.sin(n * t), math.cos(n * t)
    return numpy.array([
        [4 - 3 * c, 0, 0, s / n, 2 * (1 - c) / n, 0],
        [6 * (s - n * t), 1, 0, 2 * (c - 1) / n, (4 * s - 3 * n * t) / n, 0],
        [0, 0, c, 0, 0, s / n],
        [3 * n * s, 0, 0, c, 2 * s, 0],
        [6 * n * (c - 1), 0, 0, -2 * s, 4 * c - 3, 0],
        [0, 0, -n * s, 0, 0, c]])


@unittest.skipUnless(numpy, "python3-pandas is not installed")
class BoundDynamics(unittest.TestCase):
    """Partials of the relative motion, without J2: Clohessy and Wiltshire are then exact for a circular orbit."""
    RADIUS, STEP = 7087.3e3, 60.0

    def setUp(self):
        from vbar import relative_dynamics
        self.dynamics, self.j2 = relative_dynamics, relative_dynamics.J2
        relative_dynamics.J2 = 0.0
        self.n = (relative_dynamics.MU / self.RADIUS**3)**0.5

    def tearDown(self):
        self.dynamics.J2 = self.j2

    def to_rtn(self, state):
        """Relative inertial states to R, T, N and their rates in the rotating frame."""
        R = self.dynamics.rtn_axes(state)
        rotation = numpy.array([[0, -self.n, 0], [self.n, 0, 0], [0, 0, 0]])
        return numpy.block([[R, numpy.zeros((3, 3))], [-rotation @ R, R]])

    def test_partials_are_those_of_clohessy_and_wiltshire(self):
        arcs = self.n * self.STEP * numpy.arange(100)
        states = numpy.array([circular(self.RADIUS, arc) for arc in arcs])
        partials = self.dynamics.transitions(states, numpy.full(100, self.STEP))
        whole = numpy.eye(6)
        for part in partials:
            whole = part @ whole
        end = circular(self.RADIUS, self.n * self.STEP * 100)
        found = self.to_rtn(end) @ whole @ numpy.linalg.inv(self.to_rtn(states[0]))
        expected = clohessy_wiltshire(self.n, 100 * self.STEP)
        scale = numpy.array([1, 1, 1, self.n, self.n, self.n])
        # A step of 0.06 rad is truncated at the fifth order, 1e-8, which grows along the track with the square of the 100 steps.
        numpy.testing.assert_allclose(found / scale[:, None] * scale, expected / scale[:, None] * scale, atol=2e-4)

    def test_relative_elements_are_constants_of_the_motion(self):
        """All but the mean longitude, which drifts by -1.5 n t da (D'Amico 2010, 2.18)."""
        start, arc = circular(self.RADIUS, 0.3), self.n * self.STEP
        end = circular(self.RADIUS, 0.3 + arc)
        [partial] = self.dynamics.transitions(start[None], numpy.array([self.STEP]))
        moved = numpy.linalg.solve(self.dynamics.relative_from_roe(end), partial @ self.dynamics.relative_from_roe(start))
        expected = numpy.eye(6)
        expected[1, 0] = -1.5 * arc
        numpy.testing.assert_allclose(moved, expected, atol=1e-6)

    def sigma_by_bearings(self, burn_mps):
        """1 sigma of the position on an orbit 1 km behind, by bearings over one revolution, with a known burn across the track halfway;
        and the information along the state, relative to the largest."""
        from vbar.information_filter import InformationFilter
        information, partial = InformationFilter(6), clohessy_wiltshire(self.n, self.STEP)
        x = numpy.array([0.0, -1000.0, 0.0, 0.0, 0.0, 0.0])  # R, T, N and rates: a stationary point of the linear motion
        for k in range(100):
            x[5] -= burn_mps if k == 50 else 0.0
            distance = numpy.linalg.norm(x[:3])
            H = numpy.zeros((2, 6))
            H[:, :3] = numpy.linalg.svd(x[None, :3])[2][1:] / distance
            information.measure(H, 1e-10 * numpy.eye(2))
            x = partial @ x
            information.propagate(partial, numpy.zeros((6, 0)))
        along = numpy.linalg.norm(information.R @ x) / numpy.linalg.norm(information.R) / numpy.linalg.norm(x)
        return numpy.sqrt(numpy.trace(information.covariance(3))), along

    def test_scale_is_unobservable_without_a_burn(self):
        """A relative orbit and its multiples have the same bearings: the information along the state itself is zero, and a known burn
        determines the distance in inverse proportion to its size (Woffinden and Geller 2009)."""
        sigma_m, along = self.sigma_by_bearings(0.0)
        self.assertGreater(sigma_m, 1e6)
        self.assertLess(along, 1e-14)
        small, large = (self.sigma_by_bearings(burn)[0] for burn in (1e-4, 1e-3))
        self.assertAlmostEqual(small / large, 10.0, delta=0.01)


@unittest.skipUnless(numpy, "python3-pandas is not installed")
class BoundRun(unittest.TestCase):
    """An hour of experiment 3, to its first waypoint."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = scratch()
        cls.folder = cls.scratch.__enter__()
        fly(cls.folder / "run", "mission.duration_h=1.0", mission=EXPERIMENT3)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.__exit__(None, None, None)

    def test_covariance_of_the_flight_software_attains_the_bound(self):
        """The flight software has the same a-priori figures, and its partials are its own: no sigma is below the bound by more than the
        geometry of satellites (2 %), and 5 % are what integers found two minutes late and adapted noise may cost."""
        from vbar import bound
        from vbar.bound_flight import Flight
        flight = Flight(self.folder / "run")
        [instrument] = bound.measurements_of([flight])
        record = bound.assess(flight, instrument, [])
        ratio = record.sigma_m / record.bound_as_stated_m
        settled = flight.time > flight.time[0] + 1200
        self.assertGreater(numpy.nanmin(ratio[settled]), 0.98)
        self.assertLess(numpy.nanmax(ratio[settled]), 1.05)

    def test_visible_satellites_are_those_that_were_tracked(self):
        """The number of phases of an epoch, by masks alone: signals near the masks are weak, and rising ones are acquired late."""
        from vbar import bound
        from vbar.bound_flight import Flight
        flight = Flight(self.folder / "run")
        [instrument] = bound.measurements_of([flight])
        formed = numpy.array([1 + len(instrument.rows(k, 18, 8)[0]) for k in range(len(instrument.time))])
        used = flight.run.gnss.drop_duplicates("epoch_s").set_index("epoch_s").phases_used[instrument.time].to_numpy()
        self.assertLess(numpy.abs(formed - used).mean(), 0.1 * used.mean())

    def test_page_of_a_run(self):
        result = vbar("bound", self.folder / "run", "--budget", "--records", self.folder / "records.csv")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in result.stdout.splitlines() if line.startswith("|")]
        self.assertEqual(rows[2][0], "9")
        self.assertLess(float(rows[2][2]), float(rows[2][3]))  # burns without error, as flown
        shares = {row[0]: float(row[1]) for row in rows[5:]}
        self.assertLess(shares["antenna offsets"], 0.5)
        self.assertEqual(shares["burns"], 1.0)
        records = pandas.read_csv(self.folder / "records.csv")
        self.assertAlmostEqual(records.error_m.iloc[-1], float(rows[2][5]), delta=0.01 * records.error_m.iloc[-1])

    def test_answers_to_invalid_input(self):
        fly(self.folder / "short", "mission.duration_h=0.01", mission=EXPERIMENT3)
        for arguments, sentence in ((["no_folder"], "is not a folder"), ([self.folder], "truth.csv"),
                                    ([self.folder / "run", "--known", "wind"], "--known wind: accepted are burns, "),
                                    ([self.folder / "short"], "navigation used none of gnss, poses, images")):
            result = vbar("bound", *arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn(sentence, result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1)


if __name__ == "__main__":
    main()
