"""Real broadcast ephemerides in a receiver's messages: the flight decoder and RTKLIB's convbin read the same out of them.

Usage: check_ephemerides.py RECEIVER_TOOL BROADCAST_RECORDS

The messages are packed here by NovAtel's manual. convbin does not know GPSEPHEM: there, the record itself is what must come out.
"""

import pathlib
import struct
import sys
import zlib

import rtklib
import satellite_states

HARMONICS = ("cuc", "cus", "crc", "crs", "cic", "cis")
BEIDOU_FIRST_GPS_WEEK = 1356


def message(number, time_ns, body):
    week, of_week_ns = divmod(time_ns, rtklib.WEEK_S * rtklib.NS)
    header = struct.pack("<3sBHBBHHBBHIIHH", b"\xaa\x44\x12", 28, number, 0, 0x20, len(body), 0, 0, 180, week,
                         of_week_ns // 10 ** 6, 0, 0, 0)
    return header + body + struct.pack("<I", zlib.crc32(header + body, 0xffffffff) ^ 0xffffffff)


def fields(e, names):
    return struct.pack(f"<{len(names)}d", *(getattr(e, name) for name in names))


def of_week_s(time_ns, offset_s=0):
    return (time_ns // rtklib.NS + offset_s) % rtklib.WEEK_S


def gps(e):
    week = e.toe_ns // rtklib.NS // rtklib.WEEK_S
    body = struct.pack("<IdIIIII", e.prn, of_week_s(e.toe_ns), 0 if e.healthy else 63, e.issue, e.issue, week, week)
    body += struct.pack("<dd", e.toe_of_week_s, e.sqrt_a ** 2) + fields(e, ("delta_n", "m0", "e", "omega") + HARMONICS)
    body += fields(e, ("i0", "i_dot", "omega0", "omega_dot")) + struct.pack("<Id", e.issue, of_week_s(e.toc_ns))
    body += fields(e, ("group_delay_s", "af0", "af1", "af2")) + struct.pack("<Idd", 1, 0.0, 4.0)
    return 7, body


def galileo(e):
    bad = 0 if e.healthy else 1
    body = struct.pack("<III6BBBII", e.prn, 1, 1, bad, bad, bad, 0, 0, 0, 0, 0, e.issue, int(e.toe_of_week_s))
    body += fields(e, ("sqrt_a", "delta_n", "m0", "e", "omega") + HARMONICS + ("i0", "i_dot", "omega0", "omega_dot"))
    clock = struct.pack("<I", of_week_s(e.toc_ns)) + fields(e, ("af0", "af1", "af2"))
    return 1122, body + clock + clock + struct.pack("<dd", 0.0, e.group_delay_s)


def beidou(e):
    toc = of_week_s(e.toc_ns, rtklib.BEIDOU_MINUS_GPS_S)
    week = (e.toe_ns // rtklib.NS + rtklib.BEIDOU_MINUS_GPS_S) // rtklib.WEEK_S - BEIDOU_FIRST_GPS_WEEK
    body = struct.pack("<IIdIddII", e.prn, week, 2.0, 0 if e.healthy else 1, e.group_delay_s, 0.0, e.issue, toc)
    body += fields(e, ("af0", "af1", "af2")) + struct.pack("<II", e.issue, int(e.toe_of_week_s))
    body += fields(e, ("sqrt_a", "e", "omega", "delta_n", "m0", "omega0", "omega_dot", "i0", "i_dot") + HARMONICS)
    return 1696, body


PACK = {"G": gps, "E": galileo, "C": beidou}


def one_range(time_ns):
    """convbin takes its time from observations."""
    record = struct.pack("<HHdfdffffI", 1, 0, 2.2e7, 0.1, -1.2e8, 0.01, 0.0, 45.0, 100.0, 0x08101c04)
    return message(43, time_ns, struct.pack("<I", 1) + record)


def main():
    tool, records = sys.argv[1:]
    count = 0
    for e in satellite_states.read_records(pathlib.Path(records).parent):
        # A little after the reference time, so that Galileo's week, which the message does not have, is told by the header.
        time_ns = e.toe_ns + 600 * rtklib.NS
        data = one_range(time_ns) + message(PACK[e.system](e)[0], time_ns, PACK[e.system](e)[1])
        _, ours, counters = rtklib.flight_decoder(tool, data)
        rtklib.expect(len(ours) == 1, f"{e.system}{e.prn}: not read ({counters})")
        rtklib.expect_same_ephemeris(ours[0], e)
        if e.system == "G":
            continue
        _, nav = rtklib.convbin(data)
        theirs = rtklib.rinex_ephemerides(nav)
        rtklib.expect(len(theirs) == 1, f"{e.system}{e.prn}: convbin reads nothing")
        rtklib.expect_same_ephemeris(ours[0], theirs[0])
        count += 1
    print(f"{count} ephemerides of Galileo and BeiDou as convbin's")


if __name__ == "__main__":
    main()
