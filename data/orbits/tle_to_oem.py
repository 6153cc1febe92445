#!/usr/bin/env python3
"""Writes the orbit of a two-line element set as a CCSDS OEM, an initial orbit of a mission (key orbit_file):

    tle_to_oem.py FILE --from 2026-11-20T00:00:00 --to 2026-11-20T01:00:00 [--object NAME] [--step-s 60] > orbit.oem

FILE holds one or more sets, each of two lines, or of three with its name before it, of one or more objects; of several sets of one object the
one whose epoch is nearest to --from is used and named. SGP4 is that of the package python3-sgp4, the rotation
from its frame of date (true equator, mean equinox) to EME2000 that of python3-erfa: IAU 1976 precession and 1980 nutation, without the
observed offsets of the pole, a metre in low orbit. A set is a mean of some days of observation: a kilometre from the true orbit at its epoch and one to
three more with every day from it in low orbit (Vallado et al., AIAA 2006-6753). More than three days from the epoch are stated as a note.
"""
import argparse
import datetime
import sys

UTC_FORMAT = "%Y-%m-%dT%H:%M:%S"
J2000_EPOCH = datetime.datetime(2000, 1, 1, 12)
J2000_JULIAN_DATE = 2451545.0
NOTED_AGE_DAYS = 3.0
ERROR_KM_PER_DAY = (1.0, 3.0)  # in low orbit
MAX_LISTED = 20


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


def number_of(one):
    return one[1][2:7].strip()


def epoch_of(one):
    """UTC, of columns 19 to 32 of line 1: two digits of the year, day of the year."""
    line, number = one[1], one[3]
    try:
        year = int(line[18:20])
        return datetime.datetime(1900 + year if year >= 57 else 2000 + year, 1, 1) + datetime.timedelta(days=float(line[20:32]) - 1.0)
    except ValueError as error:
        raise TleError(f"line {number}: found the epoch {line[18:32]}, accepted: YYDDD.DDDDDDDD") from error


def listing_of(sets):
    """Each object once."""
    objects = {number_of(one): one[0] for one in sets}
    names = [name if name == number else f"{name} ({number})" for number, name in objects.items()]
    return ", ".join(names[:MAX_LISTED]) + (f" and {len(names) - MAX_LISTED} more" if len(names) > MAX_LISTED else "")


def chosen(sets, wanted, begin, file):
    """Of the object of that name or number, or of the only one if none is wanted, the set nearest to a time, and how many it has."""
    of_it = [one for one in sets if wanted in (None, one[0], number_of(one))]
    objects = {number_of(one) for one in of_it}
    if not objects:
        raise TleError(f"{file}: no set of {wanted}, accepted: --object with one of {listing_of(sets)}")
    if len(objects) > 1:
        raise TleError(f"{file}: {len(objects)} objects{f' of the name {wanted}' if wanted else ''}, accepted: --object with the name or number of one of "
                       + listing_of(of_it))
    # Of two sets of one epoch the later one of the file replaces the earlier.
    return min(reversed(of_it), key=lambda one: abs(epoch_of(one) - begin)), len(of_it)


def days(span):
    return span.total_seconds() / 86400.0


def age_notes(one, count, begin, end):
    """Sentences about the set that is used: if it is one of several, and if it is far from the times that it is used for."""
    epoch = epoch_of(one)
    age = max(abs(days(begin - epoch)), abs(days(end - epoch)))
    name = f"set of {epoch.strftime(UTC_FORMAT)} (line {one[3]}), {abs(days(begin - epoch)):.2f} days {'before' if epoch <= begin else 'after'} --from"
    if count > 1:
        yield f"used: the {name}, nearest of {count}"
    if age > NOTED_AGE_DAYS:
        low, high = (age * rate for rate in ERROR_KM_PER_DAY)
        yield f"note: the {name}, is used {age:.1f} days from its epoch: an error of {low:.0f} to {high:.0f} km must be expected in low orbit"


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


def time_text(utc):
    return utc.isoformat(timespec="milliseconds" if utc.microsecond else "seconds")


def oem(name, line_1, times, states, comments):
    identifier = f"{'19' if int(line_1[9:11]) >= 57 else '20'}{line_1[9:11]}-{line_1[11:17].strip()}" if line_1[9:17].strip() else line_1[2:7].strip()
    rows = [f"{time_text(utc)} " + " ".join(f"{value:.9f}" for value in (*position, *velocity)) for utc, position, velocity in states]
    return "\n".join([
        "CCSDS_OEM_VERS = 2.0", f"CREATION_DATE = {times[0].strftime(UTC_FORMAT)}", "ORIGINATOR = VBAR", "", "META_START", f"OBJECT_NAME = {name}",
        f"OBJECT_ID = {identifier}", "CENTER_NAME = EARTH", "REF_FRAME = EME2000", "TIME_SYSTEM = UTC", f"START_TIME = {time_text(times[0])}",
        f"STOP_TIME = {time_text(times[-1])}", "META_STOP", "COMMENT SGP4 of two-line elements", *(f"COMMENT {text}" for text in comments), *rows, ""])


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
            one, of_it = chosen(sets_in(file.read(), options.file), options.object, options.begin, options.file)
        name, line_1, line_2, _ = one
        notes = list(age_notes(one, of_it, options.begin, options.end))
        for note in notes:
            print(f"{options.file}: {note}", file=sys.stderr)
        count = int((options.end - options.begin).total_seconds() // options.step_s) + 1
        times = [options.begin + datetime.timedelta(seconds=k * options.step_s) for k in range(count)]
        sys.stdout.write(oem(name, line_1, times, states_of(line_1, line_2, times, options.file), notes))
    except (TleError, OSError) as error:
        sys.exit(str(error))
    except ImportError as error:
        sys.exit(f"{error.name} is missing: packages python3-sgp4 and python3-erfa of Debian")


if __name__ == "__main__":
    main()
