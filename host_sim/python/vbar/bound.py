"""vbar bound: the posterior Cramer-Rao bound of the relative position over recorded runs, and the efficiency of navigation."""
import argparse
import sys

import numpy

from vbar.bound_bearings import Bearings
from vbar.bound_carrier_phases import CarrierPhases
from vbar.bound_flight import Flight, columns
from vbar.bound_keypoints import Keypoints
from vbar.information_filter import GaussMarkov, InformationFilter
from vbar.relative_dynamics import is_sunlit, rtn_axes, transitions

# 1 sigma and correlation time of the unmodelled differential accelerations, as fsw/filter/relative_orbit.h states them: along the
# track (drag), and away from the Sun (radiation pressure).
ALONG_TRACK, FROM_SUN = (1e-9, 6000.0), (3e-8, 86400.0)
KNOWN = 1e-3  # factor on the sigma of what is taken as known
BURNS = "burns"


class Dynamics:
    """Deviation of the relative orbit, and of the unknown accelerations of the target, between the nodes of a flight."""
    size = 8

    def __init__(self, flight, times, empirical):
        """empirical: place of the accelerations in RTN among the states, which replace white noise; None: white noise."""
        self.psd = flight.stated("acceleration_psd_min", 1e-15) if empirical is None else 0.0
        self.unknowns = {"differential drag": GaussMarkov(6, 1, *ALONG_TRACK), "radiation pressure": GaussMarkov(7, 1, *FROM_SUN)}
        _, target = flight.states(times)
        self.steps = numpy.diff(times)
        self.partials = transitions(target[:-1], self.steps)
        sun = flight.sun(times)[:-1]
        away = -sun / numpy.linalg.norm(sun, axis=1, keepdims=True)
        rtn = rtn_axes(target[:-1])
        self.places = [6, 7]
        directions = [rtn[:, 1], away * is_sunlit(target[:-1, :3], sun)[:, None]]
        if empirical is not None:
            self.places += range(empirical, empirical + 3)
            directions += [rtn[:, axis] for axis in range(3)]
        self.directions = numpy.stack(directions, -1)

    def fill(self, k, transition, noise):
        dt = self.steps[k]
        transition[:6, :6] = self.partials[k]
        transition[:3, self.places] += dt**2 / 2 * self.directions[k]
        transition[3:6, self.places] += dt * self.directions[k]
        noise[:6, :6] += self.psd * numpy.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], numpy.eye(3))


def events_of(flight, measurements, burn_times):
    """(time, order, kind, index) of all that happens: before a record of the same time stands what navigation had received by then."""
    end = flight.time[-1]
    received = zip(measurements.time, measurements.received)
    return sorted([(time, 1, "record", k) for k, time in enumerate(flight.time)]
                  + [(time, 3, BURNS, k) for k, time in enumerate(burn_times) if time <= end]
                  + [(time, 0 if by <= time else 2, "measurement", k) for k, (time, by) in enumerate(received) if time <= end])


def bound_of(flight, measurements, known=()):
    """1 sigma of the relative position (m) at each record: root of the trace of the bound. `known`: unknowns that are taken as known."""
    burn_times, burn_sigmas = flight.burns()
    burn_sigmas = burn_sigmas * (KNOWN if BURNS in known else 1.0)
    events = events_of(flight, measurements, burn_times)
    first = Dynamics.size
    dynamics = Dynamics(flight, numpy.array([event[0] for event in events]), measurements.empirical_acceleration(first))
    unknowns = dynamics.unknowns | measurements.unknowns(first)
    for name, process in unknowns.items():
        process.sigma *= KNOWN if name in known else 1.0
    size = first + measurements.size
    information = InformationFilter(size)
    information.measure(numpy.eye(size)[:6], flight.apriori())
    for process in unknowns.values():
        information.know(process.places[0], process.sigmas())
    result = numpy.full(len(flight.time), numpy.inf)
    for k, (time, _, kind, index) in enumerate(events):
        if kind == "measurement":
            information.measure(*measurements.rows(index, size, first))
        elif kind == BURNS:
            noise = numpy.zeros((size, 3))
            noise[3:6] = burn_sigmas[index] * numpy.eye(3)
            information.propagate(numpy.eye(size), noise)
        else:
            result[index] = numpy.sqrt(numpy.trace(information.covariance(3)))
        if k + 1 < len(events) and dynamics.steps[k] > 0:
            transition, noise = numpy.eye(size), numpy.zeros((size, size))
            dynamics.fill(k, transition, noise)
            for process in unknowns.values():
                process.fill(time, dynamics.steps[k], transition, noise)
            information.propagate(transition, root(noise))
    return result


def root(covariance):
    """Columns w with w w^T = covariance, of a covariance that may be singular."""
    scale = numpy.sqrt(numpy.maximum(numpy.diagonal(covariance), 1e-300))
    values, vectors = numpy.linalg.eigh(covariance / numpy.outer(scale, scale))
    used = values > 1e-12
    return scale[:, None] * vectors[:, used] * numpy.sqrt(values[used])


def measurements_of(flights):
    """Those of the source that determines the orbit of these runs."""
    tables = flights[0].run.tables
    if "gnss" in tables and (flights[0].run.gnss.fixed > 0).any():
        return CarrierPhases.of(flights)
    return (Keypoints if "keypoints" in tables else Bearings).of(flights)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="vbar bound", description="the Cramer-Rao bound of the relative position (docs/bound.md)")
    parser.add_argument("run", nargs="+", help="run folders of one mission")
    parser.add_argument("--known", action="append", default=[], help="what is taken as known")
    options = parser.parse_args(arguments)
    flights = [Flight(folder) for folder in options.run]
    instruments = measurements_of(flights)
    print(instruments[0].noise_text())
    for flight, instrument in zip(flights, instruments):
        bound = bound_of(flight, instrument, options.known)
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
