"""Bearings of a camera as measurements of the bound: partials by the true geometry, noise as measured against the truth of the runs."""
import numpy

from vbar.information_filter import GaussMarkov
from vbar.measured_noise import correlation
from vbar.relative_dynamics import rtn_axes

ARCSEC = numpy.pi / 180 / 3600
# 1 sigma and correlation time of the displacement of the light by the Earth, and correlation times of the displacement towards the Sun
# and of the bias of bearings, as fsw/measurements/state_blocks/bearing_blocks.h states them.
EARTHLIGHT, SUN_TIME_S, BIAS_TIME_S = (0.05, 1e5), 20000.0, 43200.0


def variances(squares, distances):
    """Of errors (their squares, rad^2) whose noise is an angle and a length at the target: both variances, not negative."""
    regressors = numpy.stack([numpy.ones_like(distances), distances**-2.0], 1)
    angle, length = numpy.median(squares), 0.0
    for _ in range(50):
        weight = 1 / (angle + length / distances**2)
        scaled = regressors * weight[:, None]
        solution = numpy.linalg.lstsq(scaled, squares * weight, rcond=None)[0]
        if (solution < 0).any():
            keep = int(numpy.argmax(solution))
            solution = numpy.zeros(2)
            solution[keep] = (scaled[:, keep] @ (squares * weight)) / (scaled[:, keep] @ scaled[:, keep])
        angle, length = solution
    return angle, length


class Bearings:
    """Bearings of a camera. Unknowns: bias (2), displacement of the light towards the Sun and the Earth, two processes of
    the centroid (2 each)."""
    size = 8

    def __init__(self, flight):
        images = flight.run.images
        images = images[images.fate.isin(["filter", "batch"]) & images.bearing_error_x_arcsec.notna()]
        self.time, self.received = images.time_s.to_numpy(float), images.step_time_s.to_numpy(float)
        self.error = images[["bearing_error_x_arcsec", "bearing_error_y_arcsec"]].to_numpy(float) * ARCSEC
        servicer, target = flight.states(self.time)
        sight = target[:, :3] - servicer[:, :3]
        self.range = numpy.linalg.norm(sight, axis=1)
        line = sight / self.range[:, None]
        right = numpy.cross(-rtn_axes(servicer)[:, 0], line)
        right /= numpy.linalg.norm(right, axis=1, keepdims=True)
        self.axes = numpy.stack([right, numpy.cross(line, right)], 1)  # of the image: x to the right, y down
        sun = flight.sun(self.time)
        down = -target[:, :3]
        self.displacements = numpy.stack([self.axes @ (v / numpy.linalg.norm(v, axis=1, keepdims=True))[:, :, None]
                                          for v in (sun, down)], -1)[:, :, 0]
        angles = flight.navigation.get("angles_only", {})
        self.bias_sigma = float(angles.get("bearing_bias_arcsec", 3.0)) * ARCSEC
        self.sun_sigma = float(angles.get("brightness_offset_m", 0.15))

    @classmethod
    def of(cls, flights):
        """The bearings of each flight, with the noise of all of them together."""
        all_of = [cls(flight) for flight in flights]
        residuals = [bearings.residuals() for bearings in all_of]
        squares = numpy.concatenate([(residual**2).ravel() for residual in residuals])
        distances = numpy.concatenate([numpy.repeat(bearings.range, 2) for bearings in all_of])
        kept = numpy.ones_like(squares, bool)
        for _ in range(3):
            angle, length = variances(squares[kept], distances[kept])
            kept = squares < 25 * (angle + length / distances**2)
        period = numpy.median(numpy.diff(all_of[0].time))
        series = []
        for bearings, residual in zip(all_of, residuals):
            normalised = residual / numpy.sqrt(angle + length / bearings.range**2)[:, None]
            near = bearings.range**2 < length / angle if angle > 0 else bearings.range > 0
            series += [(bearings.time[use], normalised[use, axis]) for axis in range(2) for use in [near & (abs(normalised[:, axis]) < 5)]]
        shares, times = correlation(series, period)
        for bearings in all_of:
            bearings.angle, bearings.length, bearings.shares, bearings.times = angle, length, shares, times
            fits = numpy.sqrt(numpy.mean([other.fit**2 for other in all_of], axis=0))
            bearings.flown_sigmas = {"bearing bias": numpy.hypot(*fits[:2]) / 2**0.5, "brightness offset": fits[2], "earthlight": fits[3]}
        return all_of

    def noise_text(self):
        return (f"noise of a bearing, each axis: {self.angle**0.5 / ARCSEC:.2f} arcsec and {100 * self.length**0.5:.1f} cm at the target, "
                f"{100 * self.shares[0]:.0f} % of the latter's variance correlated over {self.times[0]:.0f} s, {100 * self.shares[1]:.0f} % over {self.times[1]:.0f} s\n"
                f"lasting: bias {self.flown_sigmas['bearing bias'] / ARCSEC:.2f} arcsec, displacement of the light towards the Sun "
                f"{100 * self.flown_sigmas['brightness offset']:.1f} cm, towards the Earth {100 * self.flown_sigmas['earthlight']:.1f} cm")

    def residuals(self):
        """Errors (rad) without the bias and the displacements towards Sun and Earth that fit the whole run best."""
        weight = numpy.repeat(1 / numpy.hypot(ARCSEC, 0.1 / self.range), 2)
        displacements = (self.displacements / self.range[:, None, None]).reshape(-1, 2)
        effects = numpy.hstack([numpy.tile(numpy.eye(2), (len(self.time), 1)), displacements])
        self.fit = numpy.linalg.lstsq(effects * weight[:, None], self.error.ravel() * weight, rcond=None)[0]
        return self.error - (effects @ self.fit).reshape(-1, 2)

    def unknowns(self, first):
        return {"bearing bias": GaussMarkov(first, 2, self.bias_sigma, BIAS_TIME_S),
                "brightness offset": GaussMarkov(first + 2, 1, self.sun_sigma, SUN_TIME_S),
                "earthlight": GaussMarkov(first + 3, 1, *EARTHLIGHT),
                "centroid, short": GaussMarkov(first + 4, 2, max((self.shares[0] * self.length)**0.5, 1e-4), self.times[0]),
                "centroid, long": GaussMarkov(first + 6, 2, max((self.shares[1] * self.length)**0.5, 1e-4), self.times[1])}

    def empirical_acceleration(self, first):
        return None

    def rows(self, k, size, first):
        H = numpy.zeros((2, size))
        H[:, :3] = self.axes[k] / self.range[k]
        H[:, first:first + 2] = numpy.eye(2)
        H[:, first + 2:first + 4] = self.displacements[k] / self.range[k]
        H[:, first + 4:first + 6] = H[:, first + 6:first + 8] = numpy.eye(2) / self.range[k]
        return H, (self.angle + (1 - sum(self.shares)) * self.length / self.range[k]**2) * numpy.eye(2)
