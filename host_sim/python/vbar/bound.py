"""vbar bound: the posterior Cramer-Rao bound of the relative position over recorded runs, and the efficiency of navigation."""
import argparse
import sys

import numpy
import pandas

from vbar.bound_bearings import Bearings
from vbar.bound_carrier_phases import CarrierPhases
from vbar.bound_flight import BoundError, Flight, columns
from vbar.bound_keypoints import Keypoints
from vbar.information_filter import GaussMarkov, InformationFilter, root
from vbar.relative_dynamics import is_sunlit, rtn_axes, transitions

# 1 sigma and correlation time of the unmodelled differential accelerations, as fsw/filter/relative_orbit.h states them: along the
# track (drag), and away from the Sun (radiation pressure).
ALONG_TRACK, FROM_SUN = (1e-9, 6000.0), (3e-8, 86400.0)
HEADER = ["waypoint", "range, m", "bound as flown, m", "bound as stated, m", "sigma, m", "error, m", "sigma / bound as stated",
          "error / bound as flown", "the same, second half of the leg"]
KNOWN = 1e-3  # factor on the sigma of what is taken as known
BURNS, PROCESS_NOISE = "burns", "process noise"
DYNAMICS = ("differential drag", "radiation pressure")


class Dynamics:
    """Deviation of the relative orbit, and of the unknown accelerations of the target, between the nodes of a flight."""
    size = 8

    def __init__(self, flight, times, empirical):
        """empirical: place of the accelerations in RTN among the states, which replace white noise; None: white noise."""
        self.psd = flight.stated("acceleration_psd_min", 1e-15) if empirical is None else 0.0
        self.unknowns = dict(zip(DYNAMICS, (GaussMarkov(6, 1, *ALONG_TRACK), GaussMarkov(7, 1, *FROM_SUN))))
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
        """Its rows of the transition from node k to the next, and of the covariance of the noise."""
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


def bound_of(flight, measurements, known=(), flown=False):
    """1 sigma of the relative position (m) at each record: root of the trace of the bound. `known`: unknowns that are taken as known;
    `flown`: sizes of burn errors and of lasting errors of measurements as they were in these runs, in place of those stated to
    navigation."""
    burn_times, burn_sigmas = flight.burns(flown)
    burn_sigmas = burn_sigmas * (KNOWN if BURNS in known else 1.0)
    events = events_of(flight, measurements, burn_times)
    first = Dynamics.size
    dynamics = Dynamics(flight, numpy.array([event[0] for event in events]), measurements.empirical_acceleration(first))
    dynamics.psd *= KNOWN**2 if PROCESS_NOISE in known else 1.0
    unknowns = dynamics.unknowns | measurements.unknowns(first)
    for name, process in unknowns.items():
        process.sigma = (measurements.flown_sigmas.get(name, process.sigma) if flown else process.sigma) * (KNOWN if group(name) in known else 1.0)
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


def measurements_of(flights):
    """Those of the source that determines the orbit of these runs."""
    run = flights[0].run
    used = {"gnss": lambda table: (table.fixed > 0).any(), "poses": lambda table: (table.fate == "keypoints").any(),
            "images": lambda table: (table.fate == "filter").any()}
    kinds = {"gnss": CarrierPhases, "poses": Keypoints, "images": Bearings}
    sources = [table for table in kinds if table in run.tables and used[table](run[table])]
    if len(sources) != 1:
        raise BoundError(f"{run.folder}: navigation used {' and '.join(sources) or 'none'} of {', '.join(kinds)}; the bound is of one of them")
    return kinds[sources[0]].of(flights)


def assess(flight, instrument, known):
    """By record: range, bounds, and sigma and error of navigation."""
    errors = flight.run.errors()
    position = {name: columns(errors, *(f"position_{name}_{axis}_m" for axis in "rtn")) for name in ("sigma", "error")}
    return pandas.DataFrame({"run": flight.run.name, "time_s": flight.time,
                             "range_m": numpy.linalg.norm(flight.target[:, :3] - flight.servicer[:, :3], axis=1),
                             "bound_as_flown_m": bound_of(flight, instrument, known, flown=True),
                             "bound_as_stated_m": bound_of(flight, instrument, known),
                             **{f"{name}_m": numpy.linalg.norm(values, axis=1) for name, values in position.items()}})


def rms(values):
    return numpy.sqrt(numpy.nanmean(numpy.square(values))) if numpy.isfinite(values).any() else numpy.nan


def legs_of(flight):
    """(waypoint, its record, records of the second half of the leg to it)."""
    ways = flight.run.waypoints
    ends = numpy.minimum(numpy.searchsorted(flight.time, ways.time_s.to_numpy(float) - 1e-6), len(flight.time) - 1)
    return [(int(index), end, slice((begin + end) // 2, end + 1)) for index, begin, end in zip(ways["index"][1:], ends[:-1], ends[1:])]


def efficiency(flights, records):
    """{waypoint: [range, bound as flown, bound as stated, sigma, error; sigma over the bound as stated; error over the bound as flown at
    the waypoint, and in the second half of the leg to it]}: medians over the runs, of the last two root mean squares."""
    rows = {}
    for flight, record in zip(flights, records):
        ratio = (record.error_m / record.bound_as_flown_m).to_numpy()
        for index, at, late in legs_of(flight):
            numbers = record.iloc[at][["range_m", "bound_as_flown_m", "bound_as_stated_m", "sigma_m", "error_m"]].to_numpy(float)
            rows.setdefault(index, []).append([*numbers, numbers[3] / numbers[2], ratio[at], rms(ratio[late])])
    return {index: [*numpy.nanmedian(numpy.array(values)[:, :6], axis=0), *(rms(numpy.array(values)[:, k]) for k in (6, 7))]
            for index, values in rows.items()}


def group(name):
    """Processes whose names agree up to a comma are one unknown for a reader."""
    return name.partition(",")[0]


def unknowns_of(instrument):
    is_white = instrument.empirical_acceleration(Dynamics.size) is None
    return list(dict.fromkeys([BURNS, *([PROCESS_NOISE] if is_white else []), *DYNAMICS, *map(group, instrument.unknowns(Dynamics.size))]))


def budget(flight, instrument, known):
    """{unknown: bound at each waypoint if it were known, as share of the bound}."""
    ends = [at for _, at, _ in legs_of(flight)]
    whole = bound_of(flight, instrument, known, flown=True)[ends]
    return {name: bound_of(flight, instrument, {*known, name}, flown=True)[ends] / whole for name in unknowns_of(instrument) if name not in known}


def table(header, rows):
    """Lines of Markdown."""
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (header, ["---"] * len(header), *rows))


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="vbar bound", description="the Cramer-Rao bound of the relative position, and the efficiency of navigation (docs/bound.md)")
    parser.add_argument("run", nargs="+", help="run folders of one mission")
    parser.add_argument("--known", action="append", default=[], metavar="UNKNOWN", help="taken as known; may be given again")
    parser.add_argument("--budget", action="store_true", help="of the first run: the bound if one unknown after the other were known")
    parser.add_argument("--records", metavar="FILE", help="write bounds, sigma and error at each record of each run as CSV")
    options = parser.parse_args(arguments)
    try:
        flights = [Flight(folder) for folder in options.run]
        if len(names := {flight.mission["mission"].get("name", "") for flight in flights}) > 1:
            raise BoundError(f"runs of the missions {', '.join(sorted(names))}: the noise is measured over all runs, which must be of one mission")
        instruments = measurements_of(flights)
        accepted = unknowns_of(instruments[0])
        for name in options.known:
            if name not in accepted:
                raise BoundError(f"--known {name}: accepted are {', '.join(accepted)}")
        print(f"{names.pop()}, {len(flights)} run{'s' * (len(flights) > 1)}\n{instruments[0].noise_text()}\n")
        records = [assess(flight, instrument, options.known) for flight, instrument in zip(flights, instruments)]
        if options.records:
            pandas.concat(records).to_csv(options.records, index=False)
        rows = efficiency(flights, records)
        if not rows:
            raise BoundError(f"{flights[0].run.folder}: no waypoint was reached")
        print(table(HEADER,
                    [[str(index), f"{values[0]:.1f}", *(f"{value:.3g}" for value in values[1:5]), *(f"{value:.2f}" for value in values[5:])]
                     for index, values in rows.items()]))
        if options.budget:
            shares = budget(flights[0], instruments[0], options.known)
            print("\n" + table(["known", *(f"waypoint {index}" for index in rows)],
                               [[name, *(f"{share:.2f}" for share in values)] for name, values in shares.items()]))
    except (BoundError, OSError, KeyError, ValueError) as error:
        print(f"vbar bound: {error.args[0] if isinstance(error, KeyError) else error}", file=sys.stderr)
        return 2
    return 0
