"""A real receiver's log through the flight decoder and through RTKLIB's convbin: the same observations and ephemerides.

Usage: check_convbin.py RECEIVER_TOOL LOG
"""

import pathlib
import sys

import rtklib

# Our signal and the receiver's code, to RINEX.
RINEX_TYPE = {(0, 0): "1C", (1, 9): "2W", (1, 5): "2P", (1, 17): "2S"}


def compare_observations(ours, theirs):
    """Both ways: what either has, the other has, with the same numbers."""
    largest = {"pseudorange": 0.0, "phase": 0.0, "doppler": 0.0}
    seen = set()
    for (time, system, prn, signal), o in ours.items():
        name = RINEX_TYPE[signal, o.code]
        where = (time, f"{system}{prn:02d}")
        pseudorange = theirs.get((*where, "C" + name))
        rtklib.expect(pseudorange is not None, f"{where}: convbin has no C{name}")
        largest["pseudorange"] = max(largest["pseudorange"], abs(pseudorange[0] - o.pseudorange))
        seen.add((*where, "C" + name))
        phase = theirs.get((*where, "L" + name))
        # convbin leaves a phase without lock blank, and marks an unknown half cycle by bit 1 of the indicator.
        rtklib.expect(o.phase_usable == (phase is not None and not phase[1] & 2), f"{where}: phase of {name} usable?")
        if phase is not None:
            largest["phase"] = max(largest["phase"], abs(phase[0] - o.phase))
        doppler = theirs.get((*where, "D" + name))
        if doppler is not None:
            largest["doppler"] = max(largest["doppler"], abs(doppler[0] - o.doppler))
        strength = theirs[(*where, "S" + name)]
        rtklib.expect(strength[0] == o.cn0, f"{where}: C/N0 of {name} is {o.cn0}, convbin's {strength[0]}")
    missed = [key for key in theirs if key[1][0] == "G" and key[2][0] == "C" and key not in seen]
    rtklib.expect(not missed, f"only convbin has {missed[:5]}")
    # RINEX prints three decimals, so half a unit of them, and what doubles of 1e8 hold.
    for what, difference in largest.items():
        rtklib.expect(difference <= 0.5e-3 + 2e-7, f"{what} differs by {difference}")
    return len(seen), largest


def compare_ephemerides(ours, theirs):
    ours = {(e.system, e.prn, e.issue): e for e in ours}
    gps = [e for e in theirs if e.system == "G"]
    rtklib.expect({(e.system, e.prn, e.issue) for e in gps} == set(ours), "not the same sets of ephemerides")
    for e in gps:
        rtklib.expect_same_ephemeris(ours[e.system, e.prn, e.issue], e)
    return len(gps)


def main():
    tool, log = sys.argv[1:]
    data = pathlib.Path(log).read_bytes()
    obs, nav = rtklib.convbin(data)
    observations, ephemerides, counters = rtklib.flight_decoder(tool, data)
    count, largest = compare_observations(observations, rtklib.rinex_observations(obs))
    sets = compare_ephemerides(ephemerides, rtklib.rinex_ephemerides(nav))
    epochs = len({key[0] for key in observations})
    print(f"{epochs} epochs, {count} observations, {sets} ephemerides as convbin's; largest differences {largest}; {counters}")
    rtklib.expect(epochs == 46 and count > 700 and sets > 0, "less than the log holds")


if __name__ == "__main__":
    main()
