"""A recorded run for the bound: its true orbits, its burns, and what its mission states to navigation."""
import tomllib

import numpy

from vbar.relative_dynamics import propagate, relative_from_roe, sun_position
from vbar.run_folder import Run

# 1 sigma, times the semi-major axis, of da, dlambda, de, di, where a mission states no a-priori orbit.
WITHOUT_APRIORI_M = (1e3, 1e5, 1e4, 1e4)
SMALLEST_BURN_ERROR_MPS = 1e-9
J2000 = numpy.datetime64("2000-01-01T12:00:00")


class BoundError(Exception):
    """A sentence for the user."""


def set_keys(mission, overrides):
    """Applies the lines key=value of overrides.txt to the tables of a mission."""
    for line in overrides.splitlines():
        path, _, text = line.partition("=")
        *folders, key = path.strip().split(".")
        place = mission
        for folder in folders:
            place = next((item for item in place if item.get("name") == folder), {}) if isinstance(place, list) else place.setdefault(folder, {})
        try:
            place[key] = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            place[key] = text


def columns(table, *names):
    return table[list(names)].to_numpy(float)


def vector(table, name, unit, axes="xyz"):
    return columns(table, *(f"{name}_{axis}_{unit}" for axis in axes))


class Flight:
    """What a run folder records of the truth, and what its mission states to navigation."""

    def __init__(self, folder):
        self.run = Run(folder)
        self.mission = tomllib.loads((self.run.folder / "mission.toml").read_text())
        overrides = self.run.folder / "overrides.txt"
        set_keys(self.mission, overrides.read_text() if overrides.is_file() else "")
        truth = self.run.truth
        self.time = truth.time_s.to_numpy(float)
        self.servicer, self.target = (
            numpy.hstack([vector(truth, f"{craft}_position_eci", "m"), vector(truth, f"{craft}_velocity_eci", "mps")])
            for craft in ("servicer", "target"))
        self.epoch = numpy.datetime64(self.mission["mission"]["epoch_utc"].rstrip("Z"))
        self.navigation = self.mission.get("navigation", {})
        self.servicer_keys = next((craft for craft in self.mission.get("spacecraft", []) if "flight_computer" in craft), None)
        if self.servicer_keys is None:
            raise BoundError(f"{folder}: no spacecraft of its mission has a flight_computer")

    def stated(self, key, default):
        return float(self.navigation.get(key, default))

    def states(self, times):
        """Of servicer and target: the record before each time, propagated with J2."""
        before = numpy.clip(numpy.searchsorted(self.time, times + 1e-6) - 1, 0, None)
        return tuple(propagate(states[before], times - self.time[before]) for states in (self.servicer, self.target))

    def julian_date(self, times):
        return 2451545.0 + ((self.epoch - J2000) / numpy.timedelta64(1, "s") + times) / 86400

    def sun(self, times):
        return sun_position(self.julian_date(times))

    def burns(self, flown):
        """Times, and 1 sigma per axis of each (m/s): by the errors of the thruster that flies, or as stated to navigation."""
        if "maneuvers" not in self.run.tables:
            return numpy.zeros(0), numpy.zeros(0)
        table = self.run.maneuvers
        table = table[table.accepted == 1]
        size = numpy.linalg.norm(vector(table, "executed_dv_rtn", "mps", "rtn"), axis=1)
        thruster = self.servicer_keys.get("actuators", {}).get("thruster", {})
        share = (max(float(thruster.get("magnitude_error_percent", 0.0)) / 100, numpy.radians(float(thruster.get("pointing_error_deg", 0.0))))
                 if flown else self.stated("maneuver_sigma_percent", 0.2) / 100)
        floor = SMALLEST_BURN_ERROR_MPS if flown else 1e-3 * self.stated("maneuver_sigma_mmps", 0.002)
        return table.execution_time_s.to_numpy(float), numpy.hypot(share * size, floor)

    def apriori(self):
        """Covariance (6, 6) of the relative inertial state at the first record."""
        stated = self.navigation.get("apriori", {})
        da, dlambda, de, di = (float(stated.get(f"sigma_a_{name}_m", default))
                               for name, default in zip(("da", "dlambda", "de", "di"), WITHOUT_APRIORI_M))
        partials = relative_from_roe(self.servicer[0])
        return partials @ numpy.diag(numpy.square([da, dlambda, de, de, di, di])) @ partials.T
