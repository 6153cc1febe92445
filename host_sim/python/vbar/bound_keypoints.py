"""Keypoints of a tumbling target as measurements of the bound.

The errors of the keypoints of an image act on the orbit by the pose that they imitate: the weighted least-squares fit of a rotation, of
two angles across the line of sight, and of a relative change of the distance to the recorded errors. Whitened by the covariance that
follows from the keypoints' stated ones, with the correlations of rotation and place, each of these six is white noise and two
first-order processes of measured variance: a network errs alike for views that are alike.
"""
import tomllib

import numpy

from vbar.bound_flight import columns
from vbar.information_filter import GaussMarkov
from vbar.measured_noise import correlation
from vbar.programs import data_folder

ARCSEC = numpy.pi / 180 / 3600
# As fsw/measurements/state_blocks/keypoint_blocks.h states them.
MOUNT, ORIGIN_SIGMA_M = (60 * ARCSEC, 43200.0), 0.01
SMALLEST_WHITE_SHARE = 0.01
ATTITUDE_SIGMA, RATE_SIGMA = 1.0, 0.05  # rad, rad/s: nothing is known before the first image
COMPONENTS = ("rotation", "rotation", "rotation", "angle across", "angle across", "distance")


def matrix(quaternion):
    """Of quaternions (..., 4), scalar first, that turn components of one frame into those of another."""
    w, v = quaternion[..., 0], quaternion[..., 1:]
    outer = v[..., :, None] * v[..., None, :]
    return (w**2 - (v**2).sum(-1))[..., None, None] * numpy.eye(3) + 2 * outer + 2 * w[..., None, None] * cross_matrix(v)


def cross_matrix(v):
    x, y, z = numpy.moveaxis(numpy.asarray(v), -1, 0)
    o = numpy.zeros_like(x)
    return numpy.stack([numpy.stack([o, -z, y], -1), numpy.stack([z, o, -x], -1), numpy.stack([-y, x, o], -1)], -2)


class RigidBody:
    """Deviation of attitude (body axes) and rate of a free body about its recorded motion, with white angular acceleration."""

    def __init__(self, first, times, rates, inertia, psd):
        self.places = range(first, first + 6)
        self.times, self.rates, self.inertia, self.psd = times, rates, inertia, psd
        self.sigma = 1.0  # factor on all standard deviations

    def sigmas(self):
        return self.sigma * numpy.array([ATTITUDE_SIGMA] * 3 + [RATE_SIGMA] * 3)

    def fill(self, time, dt, transition, noise):
        rate = self.rates[max(0, numpy.searchsorted(self.times, time + 1e-6) - 1)]
        W, J = cross_matrix(rate), self.inertia
        A = numpy.block([[-W, numpy.eye(3)], [numpy.zeros((3, 3)), numpy.linalg.solve(J, cross_matrix(J @ rate) - W @ J)]]) * dt
        term, partials = numpy.eye(6), numpy.eye(6)
        for k in range(1, 12):
            term = term @ A / k
            partials = partials + term
        place = slice(self.places[0], self.places[0] + 6)
        transition[place, place] = partials
        noise[place, place] = self.sigma**2 * self.psd * numpy.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], numpy.eye(3))


class Keypoints:
    size = 6 + 2 + 3 + 12

    def __init__(self, flight):
        run, keys = flight.run, flight.servicer_keys["sensors"]["camera"]
        target = next(craft for craft in flight.mission["spacecraft"] if craft["name"] == keys.get("target", "target"))
        body = tomllib.loads((data_folder() / "bodies" / f"{target['body']}.toml").read_text())
        camera = tomllib.loads((data_folder() / "cameras" / f"{keys['camera']}.toml").read_text())
        # The digital camera is mounted as stated, and the keypoints are the model's own.
        knowledge = flight.servicer_keys["sensors"].get("gnss", {}).get("body_frame", {}).get("attitude_knowledge_arcsec", 20.0)
        self.flown_sigmas = {"camera mount": float(knowledge) * ARCSEC, "keypoint origin": 1e-3 * ORIGIN_SIGMA_M}
        xx, yy, zz, xy, xz, yz = body["inertia_kgm2"]
        self.inertia = numpy.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        self.points = numpy.array([point["at_m"] for point in body["keypoints"]]) - body["centre_of_mass_m"]
        pitch_mm = 1e-3 * camera["detector"]["pixel_pitch_um"] * keys.get("detector", {}).get("binning", 1)
        self.focal_px = camera["optics"]["focal_length_mm"] / pitch_mm
        attitude = {name: rows for name, rows in run.attitude.groupby("spacecraft")}
        turned = attitude[target["name"]]
        self.record_times = turned.time_s.to_numpy(float)
        self.rates = columns(turned, *(f"rate_body_{axis}_radps" for axis in "xyz"))
        self.psd = flight.stated("angular_acceleration_psd", 1e-11)

        poses = run.poses[(run.poses.fate == "keypoints") & numpy.isin(run.poses.time_s, self.record_times)]
        used = run.keypoints[run.keypoints.fate == "used"]
        groups = dict(tuple(used.groupby("image")))
        poses = poses[[len(groups.get(image, ())) >= 4 for image in poses.image]]
        self.time, self.received = poses.time_s.to_numpy(float), poses.step_time_s.to_numpy(float)
        quaternion = [f"q_body_eci_{part}" for part in "wxyz"]
        at = numpy.searchsorted(self.record_times, self.time)
        servicer_body, self.body = (matrix(columns(attitude[name], *quaternion)[at])
                                    for name in (flight.servicer_keys["name"], target["name"]))
        self.camera = matrix(numpy.array(keys.get("q_camera_body", [1.0, 0.0, 0.0, 0.0]))) @ servicer_body
        servicer, target_states = flight.states(self.time)
        lever = numpy.swapaxes(servicer_body, 1, 2) @ numpy.array(keys.get("position_body_m", [0.0, 0.0, 0.0]))
        self.sight = (self.camera @ (target_states[:, :3] - servicer[:, :3] - lever)[:, :, None])[:, :, 0]
        self.range = numpy.linalg.norm(self.sight, axis=1)
        self.camera_body = self.camera @ numpy.swapaxes(self.body, 1, 2)
        fits = [self.pose_of(k, groups[image]) for k, image in enumerate(poses.image)]
        error, covariance = (numpy.array(part) for part in zip(*fits))
        self.root = numpy.linalg.cholesky(covariance)
        self.error = numpy.linalg.solve(self.root, error[:, :, None])[:, :, 0]

    def pose_of(self, k, rows):
        """The pose that the errors of an image's keypoints imitate, and its covariance by theirs."""
        points = self.points[rows.keypoint]
        place = self.sight[k] + points @ self.camera_body[k].T
        depth = place[:, 2]
        projection = numpy.zeros((len(rows), 2, 3))
        projection[:, 0, 0] = projection[:, 1, 1] = self.focal_px / depth
        projection[:, :, 2] = -self.focal_px * place[:, :2] / depth[:, None]**2
        J = numpy.concatenate([projection @ (-self.camera_body[k] @ cross_matrix(points)), projection * self.range[k]], 2)
        xx, xy, yy = columns(rows, "covariance_xx_px2", "covariance_xy_px2", "covariance_yy_px2").T
        weight = numpy.linalg.inv(numpy.stack([numpy.stack([xx, xy], -1), numpy.stack([xy, yy], -1)], -2))
        error = columns(rows, "error_x_px", "error_y_px")
        normal = numpy.einsum("kai,kab,kbj->ij", J, weight, J)
        covariance = numpy.linalg.inv(normal)
        return covariance @ numpy.einsum("kai,kab,kb->i", J, weight, error), covariance

    @classmethod
    def of(cls, flights):
        """The keypoints of each flight, with the noise of all of them together."""
        all_of = [cls(flight) for flight in flights]
        period = numpy.median(numpy.diff(all_of[0].time))
        noise = []
        for component in range(6):
            series = [(own.time, own.error[:, component]) for own in all_of]
            # Standard deviation and limit by quantiles: a view taken for another is rejected by the flight software, too.
            scale = numpy.median(numpy.abs(numpy.concatenate([values for _, values in series]))) / 0.6745
            series = [(times[kept], values[kept]) for times, values in series for kept in [numpy.abs(values) < 5 * scale]]
            sigma = numpy.sqrt(numpy.mean(numpy.concatenate([values for _, values in series])**2))
            noise.append((sigma, *correlation([(times, values / sigma) for times, values in series], period)))
        for own in all_of:
            own.noise = noise
        return all_of

    def noise_text(self):
        return "\n".join(f"keypoints: {name}: {sigma:.2f} times the stated sigma; {100 * shares[0]:.0f} % of the variance correlated over "
                         f"{times[0]:.0f} s, {100 * shares[1]:.0f} % over {times[1]:.0f} s" for name, (sigma, shares, times) in zip(COMPONENTS, self.noise))

    def unknowns(self, first):
        errors = {f"keypoints: {name}, {component} {which}": GaussMarkov(first + 11 + 6 * which + component, 1,
                                                                        max(sigma * shares[which]**0.5, 1e-3), times[which])
                  for which in range(2) for component, (name, (sigma, shares, times)) in enumerate(zip(COMPONENTS, self.noise))}
        return {"attitude": RigidBody(first, self.record_times, self.rates, self.inertia, self.psd),
                "camera mount": GaussMarkov(first + 6, 2, *MOUNT), "keypoint origin": GaussMarkov(first + 8, 3, ORIGIN_SIGMA_M, 1e12)} | errors

    def empirical_acceleration(self, first):
        return None

    def rows(self, k, size, first):
        H = numpy.zeros((6, size))
        H[:3, first:first + 3] = numpy.eye(3)
        H[3:, :3] = self.camera[k] / self.range[k]
        H[3:5, first + 6:first + 8] = numpy.eye(2)
        H[3:, first + 8:first + 11] = self.camera_body[k] / self.range[k]
        for which in range(2):
            H[:, first + 11 + 6 * which:first + 17 + 6 * which] = self.root[k]
        white = [sigma**2 * max(SMALLEST_WHITE_SHARE, 1 - sum(shares)) for sigma, shares, _ in self.noise]
        return H, self.root[k] @ numpy.diag(white) @ self.root[k].T
