"""True partials of the relative motion along a recorded trajectory, and the directions of Sun and eclipse.

Written after Montenbruck and Gill (2000) and D'Amico (2010) without the code of the simulation or of the flight software.
"""
import numpy

MU, RADIUS_M, J2 = 3.986004415e14, 6378136.3, 1.08262668e-3
AU_M = 1.495978707e11


def acceleration(r):
    """Point mass and J2 at positions (..., 3), ECI."""
    d2 = (r**2).sum(-1, keepdims=True)
    z2 = r[..., 2:]**2 / d2
    factor = 1.5 * J2 * RADIUS_M**2 / d2 * numpy.stack([1 - 5 * z2, 1 - 5 * z2, 3 - 5 * z2], -1)[..., 0, :]
    return -MU * r / d2**1.5 * (1 + factor)


def propagate(states, dt):
    """States (..., 6) after dt (...), s, by one step of Runge and Kutta of fourth order: a minute is 1/16 of a radian."""
    dt = numpy.asarray(dt)[..., None]

    def rate(x):
        return numpy.concatenate([x[..., 3:], acceleration(x[..., :3])], -1)
    k1 = rate(states)
    k2 = rate(states + dt / 2 * k1)
    k3 = rate(states + dt / 2 * k2)
    k4 = rate(states + dt * k3)
    return states + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def transitions(states, dt):
    """Partials (k, 6, 6) of states after dt (k) with respect to states (k, 6), by central differences."""
    steps = numpy.diag([10.0] * 3 + [0.01] * 3)
    shifted = states[:, None, None, :] + numpy.array([1.0, -1.0])[None, :, None, None] * steps
    ends = propagate(shifted, numpy.broadcast_to(numpy.asarray(dt)[:, None, None], shifted.shape[:-1]))
    return numpy.swapaxes((ends[:, 0] - ends[:, 1]) / (2 * numpy.diagonal(steps)[None, :, None]), 1, 2)


def rtn_axes(states):
    """Rows R, T, N (..., 3, 3) of states (..., 6)."""
    r, v = states[..., :3], states[..., 3:]
    radial = r / numpy.linalg.norm(r, axis=-1, keepdims=True)
    normal = numpy.cross(r, v)
    normal /= numpy.linalg.norm(normal, axis=-1, keepdims=True)
    return numpy.stack([radial, numpy.cross(normal, radial), normal], -2)


def relative_from_roe(chief):
    """Partials (6, 6) of the relative inertial state with respect to a delta-alpha (m): near-circular orbits (D'Amico 2010, 2.17)."""
    R = rtn_axes(chief)
    a = 1 / (2 / numpy.linalg.norm(chief[:3]) - chief[3:] @ chief[3:] / MU)
    n = (MU / a**3)**0.5
    ascending = numpy.cross([0.0, 0.0, 1.0], R[2])
    ascending /= numpy.linalg.norm(ascending)
    u = numpy.arctan2(chief[:3] @ numpy.cross(R[2], ascending), chief[:3] @ ascending)
    s, c = numpy.sin(u), numpy.cos(u)
    position = numpy.array([[1, 0, -c, -s, 0, 0], [0, 1, 2 * s, -2 * c, 0, 0], [0, 0, 0, 0, s, -c]])
    velocity = n * numpy.array([[0, 0, s, -c, 0, 0], [-1.5, 0, 2 * c, 2 * s, 0, 0], [0, 0, 0, 0, c, s]])
    velocity += numpy.cross([0.0, 0.0, n], position.T).T
    return numpy.vstack([R.T @ position, R.T @ velocity])


def sun_position(julian_date):
    """Of the Sun from the Earth, m, equator and equinox of date to 0.2 deg (Montenbruck and Gill 2000, 3.3.2)."""
    centuries = (julian_date - 2451545.0) / 36525
    anomaly = numpy.radians(357.5256 + 35999.049 * centuries)
    longitude = numpy.radians(282.94) + anomaly + numpy.radians((6892 * numpy.sin(anomaly) + 72 * numpy.sin(2 * anomaly)) / 3600)
    obliquity = numpy.radians(23.43929)
    distance = (149.619 - 2.499 * numpy.cos(anomaly)) * 1e9
    return distance[..., None] * numpy.stack(
        [numpy.cos(longitude), numpy.sin(longitude) * numpy.cos(obliquity), numpy.sin(longitude) * numpy.sin(obliquity)], -1)


def is_sunlit(r, sun):
    """Outside a cylindrical shadow."""
    direction = sun / numpy.linalg.norm(sun, axis=-1, keepdims=True)
    along = (r * direction).sum(-1)
    return (along > 0) | ((r**2).sum(-1) - along**2 > RADIUS_M**2)
