"""vbar bound: the posterior Cramer-Rao bound of the relative position over recorded runs, and the efficiency of navigation."""
import argparse
import sys
import tomllib

import numpy

from vbar.bound_measurements import Bearings
from vbar.information_filter import GaussMarkov, InformationFilter
from vbar.relative_dynamics import is_sunlit, propagate, relative_from_roe, rtn_axes, sun_position, transitions
from vbar.run_folder import Run

# 1 sigma and correlation time of the unmodelled differential accelerations, as fsw/filter/relative_orbit.h states them: along the
# track (drag), and away from the Sun (radiation pressure).
ALONG_TRACK, FROM_SUN = (1e-9, 6000.0), (3e-8, 86400.0)
# 1 sigma, times the semi-major axis, of da, dlambda, de, di, where a mission states no a-priori orbit.
WITHOUT_APRIORI_M = (1e3, 1e5, 1e4, 1e4)
J2000 = numpy.datetime64("2000-01-01T12:00:00")
LONGEST_STEP_S = 60.0


def columns(table, *names):
    return table[list(names)].to_numpy(float)


def vector(table, name, unit, axes="xyz"):
    return columns(table, *(f"{name}_{axis}_{unit}" for axis in axes))


class Flight:
    """What a run folder records of the truth, and what its mission states to navigation."""

    def __init__(self, folder):
        self.run = Run(folder)
        self.mission = tomllib.loads((self.run.folder / "mission.toml").read_text())
        truth = self.run.truth
        self.time = truth.time_s.to_numpy(float)
        self.servicer, self.target = (
            numpy.hstack([vector(truth, f"{craft}_position_eci", "m"), vector(truth, f"{craft}_velocity_eci", "mps")])
            for craft in ("servicer", "target"))
        self.epoch = numpy.datetime64(self.mission["mission"]["epoch_utc"].rstrip("Z"))
        self.navigation = self.mission.get("navigation", {})
        self.craft = {craft["name"]: craft for craft in self.mission["spacecraft"]}

    def stated(self, key, default):
        return float(self.navigation.get(key, default))

    def states(self, times):
        """Of servicer and target: the record before each time, propagated with J2."""
        before = numpy.clip(numpy.searchsorted(self.time, times + 1e-6) - 1, 0, None)
        return tuple(propagate(states[before], times - self.time[before]) for states in (self.servicer, self.target))

    def sun(self, times):
        days = (self.epoch - J2000) / numpy.timedelta64(1, "s") / 86400
        return sun_position(2451545.0 + days + numpy.asarray(times) / 86400)

    def burns(self):
        """Times, and 1 sigma per axis that the mission states of each (m/s)."""
        if "maneuvers" not in self.run.tables:
            return numpy.zeros(0), numpy.zeros(0)
        table = self.run.maneuvers
        table = table[table.accepted == 1]
        size = numpy.linalg.norm(vector(table, "executed_dv_rtn", "mps", "rtn"), axis=1)
        share = self.stated("maneuver_sigma_percent", 0.2) / 100
        return table.execution_time_s.to_numpy(float), numpy.hypot(share * size, 1e-3 * self.stated("maneuver_sigma_mmps", 0.002))

    def apriori(self):
        """Covariance (6, 6) of the relative inertial state at the first record."""
        stated = self.navigation.get("apriori", {})
        da, dlambda, de, di = (float(stated.get(f"sigma_a_{name}_m", default))
                               for name, default in zip(("da", "dlambda", "de", "di"), WITHOUT_APRIORI_M))
        partials = relative_from_roe(self.servicer[0])
        return partials @ numpy.diag(numpy.square([da, dlambda, de, de, di, di])) @ partials.T


class Dynamics:
    """Deviation of the relative orbit, and of the unknown accelerations of the target, between the nodes of a flight."""

    def __init__(self, flight, times):
        self.psd = flight.stated("acceleration_psd_min", 1e-15)
        self.processes = [GaussMarkov(6, 1, *ALONG_TRACK), GaussMarkov(7, 1, *FROM_SUN)]
        _, target = flight.states(times)
        self.steps = numpy.diff(times)
        self.partials = transitions(target[:-1], self.steps)
        sun = flight.sun(times)[:-1]
        away = -sun / numpy.linalg.norm(sun, axis=1, keepdims=True)
        self.directions = numpy.stack([rtn_axes(target[:-1])[:, 1], away * is_sunlit(target[:-1, :3], sun)[:, None]], -1)
        self.size = 8

    def fill(self, k, transition, noise):
        dt = self.steps[k]
        transition[:6, :6] = self.partials[k]
        transition[:3, 6:8] += dt**2 / 2 * self.directions[k]
        transition[3:6, 6:8] += dt * self.directions[k]
        noise[:6, :6] += self.psd * numpy.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], numpy.eye(3))


def bound_of(flight, measurements):
    """1 sigma of the relative position (m) at each record: root of the trace of the bound."""
    burn_times, burn_sigmas = flight.burns()
    # Before a record of the same time stands what navigation had received by then.
    events = sorted([(time, 1, "record", k) for k, time in enumerate(flight.time)]
                    + [(time, 3, "burn", k) for k, time in enumerate(burn_times) if time <= flight.time[-1]]
                    + [(time, 0 if received <= time else 2, "measurement", k)
                       for k, (time, received) in enumerate(zip(measurements.time, measurements.received)) if time <= flight.time[-1]])
    nodes = numpy.array([event[0] for event in events])
    dynamics = Dynamics(flight, nodes)
    processes = dynamics.processes + measurements.unknowns(dynamics.size)
    size = dynamics.size + measurements.size
    information = InformationFilter(size)
    information.measure(numpy.eye(size)[:6], flight.apriori())
    for process in processes:
        information.know(process.places[0], process.sigmas())
    result = numpy.full(len(flight.time), numpy.inf)
    for k, (_, _, kind, index) in enumerate(events):
        if kind == "measurement":
            information.measure(*measurements.rows(index, size, dynamics.size))
        elif kind == "burn":
            noise = numpy.zeros((size, 3))
            noise[3:6] = burn_sigmas[index] * numpy.eye(3)
            information.propagate(numpy.eye(size), noise)
        else:
            result[index] = numpy.sqrt(numpy.trace(information.covariance(3)))
        if k + 1 < len(events) and dynamics.steps[k] > 0:
            transition, noise = numpy.eye(size), numpy.zeros((size, size))
            dynamics.fill(k, transition, noise)
            for process in processes:
                process.fill(dynamics.steps[k], transition, noise)
            information.propagate(transition, root(noise))
    return result


def root(covariance):
    """Columns w with w w^T = covariance, of a covariance that may be singular."""
    scale = numpy.sqrt(numpy.maximum(numpy.diagonal(covariance), 1e-300))
    values, vectors = numpy.linalg.eigh(covariance / numpy.outer(scale, scale))
    used = values > 1e-12
    return scale[:, None] * vectors[:, used] * numpy.sqrt(values[used])


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="vbar bound", description="the Cramer-Rao bound of the relative position (docs/bound.md)")
    parser.add_argument("run", nargs="+", help="run folders of one mission")
    options = parser.parse_args(arguments)
    flights = [Flight(folder) for folder in options.run]
    instruments = Bearings.of(flights)
    print(instruments[0].noise_text)
    for flight, instrument in zip(flights, instruments):
        bound = bound_of(flight, instrument)
        errors = flight.run.errors()
        error = numpy.linalg.norm(columns(errors, *(f"position_error_{a}_m" for a in "rtn")), axis=1)
        sigma = numpy.linalg.norm(columns(errors, *(f"position_sigma_{a}_m" for a in "rtn")), axis=1)
        for way in flight.run.waypoints.itertuples():
            k = numpy.searchsorted(flight.time, way.time_s - 1e-6)
            k = min(k, len(error) - 1)
            last = slice(max(0, k - 100), k + 1)
            rms = [numpy.sqrt(numpy.nanmean(x[last]**2)) for x in (error, sigma, bound)]
            rng = numpy.linalg.norm(flight.target[k, :3] - flight.servicer[k, :3])
            print(f"{way.index:3.0f} range {rng:9.1f} bound {bound[k]:8.4f} sigma {sigma[k]:8.4f} error {error[k]:8.4f} s/b {sigma[k]/bound[k]:6.2f} e/b {error[k]/bound[k]:6.2f}"
                  f" | last orbit rms e {rms[0]:8.4f} s {rms[1]:8.4f} b {rms[2]:8.4f} e/b {rms[0]/rms[2]:6.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
