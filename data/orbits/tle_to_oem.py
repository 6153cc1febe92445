#!/usr/bin/env python3
"""Writes the orbit of a two-line element set as a CCSDS OEM, an initial orbit of a mission (key orbit_file):

    tle_to_oem.py FILE --from 2026-11-20T00:00:00 --to 2026-11-20T01:00:00 [--object NAME] [--step-s 60] > orbit.oem

FILE holds one or more sets, each of two lines, or of three with its name before it. SGP4 is that of the package python3-sgp4, the rotation
from its frame of date (true equator, mean equinox) to EME2000 that of python3-erfa: IAU 1976 precession and 1980 nutation, without the
observed offsets of the pole, a metre in low orbit. A set is a mean of some days of observation: kilometres from the true orbit, more with every day
from its epoch.
"""
import argparse
import datetime
import sys

UTC_FORMAT = "%Y-%m-%dT%H:%M:%S"
J2000_EPOCH = datetime.datetime(2000, 1, 1, 12)
J2000_JULIAN_DATE = 2451545.0


class TleError(Exception):
    pass


def sets_in(text, file):
    """(name, line 1, line 2, number of line 1) of each set."""
    from sgp4.io import verify_checksum
    lines = [(number, line.rstrip()) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    found = []
    for k, (number, line) in enumerate(lines):
        if not line.startswith("1 "):
            continue
        name = lines[k - 1][1].removeprefix("0 ").strip() if k > 0 and not lines[k - 1][1].startswith(("1 ", "2 ")) else line[2:7].strip()
        second = lines[k + 1][1] if k + 1 < len(lines) else ""
        if len(line) < 69 or len(second) < 69 or not second.startswith("2 ") or second[2:7] != line[2:7]:
            raise TleError(f"{file}:{number}: found a first line without the second line of the same object, accepted: two lines of 69 characters")
        try:
            verify_checksum(line, second)
        except ValueError as error:
            raise TleError(f"{file}:{number}: {str(error).splitlines()[0]}") from error
        found.append((name, line, second, number))
    if not found:
        raise TleError(f"{file}: found no two-line elements, accepted: lines that begin with \"1 \" and \"2 \"")
    return found


def chosen(sets, wanted, file):
    """The set of that name or number; the only one if none is wanted."""
    of_it = [one for one in sets if wanted in (None, one[0], one[1][2:7].strip())]
    if len(of_it) != 1:
        raise TleError(f"{file}: {len(of_it)} sets of {wanted or 'an object that is not named'}, accepted: --object with one of "
                       + ", ".join(one[0] for one in sets))
    return of_it[0]


def julian_date(utc):
    """Two parts, days; UTC as quasi-Julian date."""
    since = utc - J2000_EPOCH
    return J2000_JULIAN_DATE + since.days, (since.seconds + 1e-6 * since.microseconds) / 86400.0


def eme2000_of_teme(utc, vector):
    import erfa
    import numpy
    tt = erfa.taitt(*erfa.utctai(*julian_date(utc)))
    equinoxes = erfa.eqeq94(*tt)
    cosine, sine = numpy.cos(equinoxes), numpy.sin(equinoxes)
    # The true equinox is east of the mean one by the equation of the equinoxes.
    true_of_mean = numpy.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return erfa.pnm80(*tt).T @ true_of_mean @ numpy.array(vector)


def states_of(line_1, line_2, times, file):
    """(time, position km, velocity km/s) in EME2000."""
    from sgp4.api import SGP4_ERRORS, Satrec
    satellite = Satrec.twoline2rv(line_1, line_2)
    for utc in times:
        error, position, velocity = satellite.sgp4(*julian_date(utc))
        if error:
            raise TleError(f"{file}: no orbit at {utc.strftime(UTC_FORMAT)}: {SGP4_ERRORS[error]}")
        yield utc, eme2000_of_teme(utc, position), eme2000_of_teme(utc, velocity)


def oem(name, line_1, times, states):
    identifier = f"{'19' if int(line_1[9:11]) >= 57 else '20'}{line_1[9:11]}-{line_1[11:17].strip()}" if line_1[9:17].strip() else line_1[2:7].strip()
    rows = [f"{utc.strftime(UTC_FORMAT)} " + " ".join(f"{value:.9f}" for value in (*position, *velocity)) for utc, position, velocity in states]
    return "\n".join([
        "CCSDS_OEM_VERS = 2.0", f"CREATION_DATE = {times[0].strftime(UTC_FORMAT)}", "ORIGINATOR = VBAR", "", "META_START", f"OBJECT_NAME = {name}",
        f"OBJECT_ID = {identifier}", "CENTER_NAME = EARTH", "REF_FRAME = EME2000", "TIME_SYSTEM = UTC", f"START_TIME = {times[0].strftime(UTC_FORMAT)}",
        f"STOP_TIME = {times[-1].strftime(UTC_FORMAT)}", "META_STOP", "COMMENT SGP4 of two-line elements", *rows, ""])


def utc_of(text):
    return datetime.datetime.strptime(text.rstrip("Z"), UTC_FORMAT)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--from", dest="begin", type=utc_of, required=True)
    parser.add_argument("--to", dest="end", type=utc_of, required=True)
    parser.add_argument("--object")
    parser.add_argument("--step-s", type=float, default=60.0)
    options = parser.parse_args()
    if not 1.0 <= options.step_s <= 3600.0 or options.end < options.begin:
        parser.error("--to lies before --from, or --step-s outside 1 to 3600")
    try:
        with open(options.file, encoding="ascii", errors="replace") as file:
            name, line_1, line_2, _ = chosen(sets_in(file.read(), options.file), options.object, options.file)
        count = int((options.end - options.begin).total_seconds() // options.step_s) + 1
        times = [options.begin + datetime.timedelta(seconds=k * options.step_s) for k in range(count)]
        sys.stdout.write(oem(name, line_1, times, states_of(line_1, line_2, times, options.file)))
    except (TleError, OSError) as error:
        sys.exit(str(error))
    except ImportError as error:
        sys.exit(f"{error.name} is missing: packages python3-sgp4 and python3-erfa of Debian")


if __name__ == "__main__":
    main()
