#!/usr/bin/env python3
"""Converts the orbit that CODE distributes as CSV for a low satellite to SP3-c.

A line is day/month/year, hour:minute:second of GPS time, position (km) and velocity (dm/s), Earth-fixed. Usage:
csv_to_sp3.py grcb_truth.csv L09 grcb.sp3 (L09: name of the satellite in SP3, here GRACE-B's).
"""

import datetime
import sys

GPS_EPOCH = datetime.datetime(1980, 1, 6)


def states(path):
    """Yields time, position (km) and velocity (dm/s) of each line."""
    with open(path, encoding="ascii") as stream:
        for number, line in enumerate(stream, start=1):
            fields = line.strip().split(",")
            try:
                time = datetime.datetime.strptime(" ".join(fields[:2]), "%d/%m/%Y %H:%M:%S")
                values = [float(field) for field in fields[2:]]
            except ValueError:
                values = []
            if len(values) != 6:
                sys.exit(f"{path}:{number}: found {line.strip()!r}, expected day/month/year,h:m:s and six numbers")
            yield time, values[:3], values[3:]


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    source, name, target = sys.argv[1:]
    rows = list(states(source))
    if len(rows) < 2:
        sys.exit(f"{source}: found {len(rows)} states, expected at least two")
    first = rows[0][0]
    since = first - GPS_EPOCH
    interval = (rows[1][0] - first).total_seconds()
    week, of_week = since.days // 7, (since.days % 7) * 86400 + since.seconds
    mjd = 44244 + since.days
    with open(target, "w", encoding="ascii") as out:
        out.write(f"#cV{first:%Y %_m %_d %_H %_M} {first.second:11.8f} {len(rows):7d} ORBIT ITRF  FIT CODE\n")
        out.write(f"## {week:4d} {of_week:15.8f} {interval:14.8f} {mjd:5d} {since.seconds / 86400:.13f}\n")
        out.write(f"+    1   {name}" + "  0" * 16 + "\n")
        out.write("++       " + "  0" * 17 + "\n")
        out.write("%c L  cc GPS ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc\n" * 1)
        for time, position, velocity in rows:
            out.write(f"*  {time:%Y %_m %_d %_H %_M} {time.second:11.8f}\n")
            out.write(f"P{name}" + "".join(f"{x:14.6f}" for x in position) + f"{999999.999999:14.6f}\n")
            out.write(f"V{name}" + "".join(f"{x:14.6f}" for x in velocity) + f"{999999.999999:14.6f}\n")
        out.write("EOF\n")


if __name__ == "__main__":
    main()
