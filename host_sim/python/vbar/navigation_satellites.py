"""Directions of navigation satellites from the broadcast elements of data/gps (IS-GPS-200 20.3.3.4), to 0.1 deg: enough for geometry."""
import csv

import numpy

MU, EARTH_RATE = 3.986005e14, 7.2921151467e-5
GEOSTATIONARY_TILT = numpy.radians(-5.0)  # BDS-SIS-ICD-B1I-3.0, table 5-11
FILES = {"gps": ("gps_2011_10_20.csv", "G"), "galileo": ("galileo_beidou_2013_07_19.csv", "E"),
         "beidou": ("galileo_beidou_2013_07_19.csv", "C")}
SIGNALS = {"G": ("GPS L1", "GPS L2"), "E": ("Galileo E1",), "C": ("BeiDou B1I",)}
DAY_S = 86400.0


def rotate_z(vectors, angle):
    c, s = numpy.cos(angle), numpy.sin(angle)
    x, y, z = numpy.moveaxis(vectors, -1, 0)
    return numpy.stack([c * x - s * y, s * x + c * y, z], -1)


class Constellation:
    """The satellites that a mission flies with the sets of its real broadcast files."""

    def __init__(self, folder, settings):
        rows = []
        for system, (file, letter) in FILES.items():
            kind = settings.get(system, "broadcast")
            if kind not in ("broadcast", "none"):
                raise ValueError(f"constellation.{system} is {kind}; the bound has the directions of broadcast or none")
            if kind == "broadcast":
                lines = [line for line in (folder / file).read_text().splitlines() if not line.startswith("#")]
                first = next(k for k, line in enumerate(lines) if line.startswith("satellite,"))
                rows += [row for row in csv.DictReader(lines[first:]) if row["satellite"].startswith(letter)]
        self.names = [row["satellite"] for row in rows]
        self.is_geostationary = numpy.array([name in ("C01", "C02", "C03", "C04", "C05") for name in self.names])
        self.elements = {key: numpy.array([float(row[key]) for row in rows])
                         for key in ("toe_s", "sqrt_a", "e", "m0", "delta_n", "omega0", "omega_dot", "i0", "omega")}

    def positions_ecef(self, second_of_day):
        """(satellites, 3), m. Elements of another day are moved by whole days, fixed to the Earth."""
        o = self.elements
        t = (second_of_day - o["toe_s"] + DAY_S / 2) % DAY_S - DAY_S / 2
        a = o["sqrt_a"]**2
        mean = o["m0"] + ((MU / a**3)**0.5 + o["delta_n"]) * t
        eccentric = mean
        for _ in range(10):
            eccentric = mean + o["e"] * numpy.sin(eccentric)
        u = o["omega"] + numpy.arctan2((1 - o["e"]**2)**0.5 * numpy.sin(eccentric), numpy.cos(eccentric) - o["e"])
        radius = a * (1 - o["e"] * numpy.cos(eccentric))
        rate = o["omega_dot"] - numpy.where(self.is_geostationary, 0.0, EARTH_RATE)
        x, y, z = radius * numpy.cos(u), radius * numpy.sin(u) * numpy.cos(o["i0"]), radius * numpy.sin(u) * numpy.sin(o["i0"])
        r = rotate_z(numpy.stack([x, y, z], -1), o["omega0"] + rate * t - EARTH_RATE * o["toe_s"])
        c, s = numpy.cos(GEOSTATIONARY_TILT), numpy.sin(GEOSTATIONARY_TILT)
        tilted = numpy.stack([r[:, 0], c * r[:, 1] + s * r[:, 2], c * r[:, 2] - s * r[:, 1]], -1)
        return numpy.where(self.is_geostationary[:, None], rotate_z(tilted, -EARTH_RATE * t), r)


def sidereal_angle(julian_date):
    """Of Greenwich, rad (Vallado 2013, 3-45, leading terms)."""
    return numpy.radians((280.46061837 + 360.98564736629 * (julian_date - 2451545.0)) % 360)


def is_visible(satellites, antenna, boresight, settings):
    """By the masks of sensors.gnss.visibility: of positions (satellites, 3) from an antenna, m."""
    line = satellites - antenna
    line = line / numpy.linalg.norm(line, axis=1, keepdims=True)
    radius = numpy.linalg.norm(antenna)
    sine = line @ antenna / radius
    closest = radius * numpy.sqrt(numpy.maximum(0, 1 - sine**2))
    free = (sine >= 0) | (closest > 6378137.0 + 1e3 * settings.get("occultation_altitude_km", 50.0))
    return (free & (sine >= numpy.sin(numpy.radians(settings.get("horizon_mask_deg", -20.0))))
            & (line @ boresight >= numpy.cos(numpy.radians(settings.get("receiver_mask_deg", 190.0) / 2)))), line
