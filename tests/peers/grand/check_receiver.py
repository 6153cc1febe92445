#!/usr/bin/env python3
"""The emulated receiver's serial line under RTKLIB: str2str configures it by a file of commands and records what it sends; convbin
finds every epoch and every satellite.

    check_receiver.py TOOL
"""

import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIP = 77
SECONDS = 180
COMMANDS = """UNLOGALL THISPORT TRUE
SETAPPROXTIME 1645 230400
SETAPPROXPOS 0 0 709000
LOG RANGEB ONTIME 1
LOG RAWEPHEMB ONCHANGED
LOG BDSEPHEMERISB ONCHANGED
LOG GALEPHEMERISB ONCHANGED
LOG IONUTCB ONCHANGED
LOG BESTXYZB ONTIME 1
LOG TIMEB ONTIME 1
"""


def expect(condition, message):
    if not condition:
        print(f"FAILED: {message}")
        sys.exit(1)


def record(tool, folder):
    """The receiver's bytes as str2str writes them."""
    commands, log = folder / "commands.txt", folder / "receiver.gps"
    commands.write_text(COMMANDS, encoding="ascii")
    receiver = subprocess.Popen([tool, str(folder), str(SECONDS)], stdout=subprocess.PIPE, text=True)
    reader = None
    try:
        port = receiver.stdout.readline().strip().removeprefix("/dev/")
        expect(port, "the receiver has no terminal")
        reader = subprocess.Popen(["str2str", "-in", f"serial://{port}:115200", "-c", str(commands), "-out", f"file://{log}"],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        expect(receiver.wait(timeout=100) == 0, f"the receiver ended with {receiver.returncode}")
    finally:
        for process in (reader, receiver):
            if process is not None and process.poll() is None:
                process.terminate()
                process.wait(timeout=10)
    return log


def epochs_of(rinex):
    """Satellites of each epoch of a RINEX 3 observation file, by whole second of the day."""
    epochs, second = {}, None
    lines = rinex.read_text(encoding="ascii").splitlines()
    begin = next(k for k, line in enumerate(lines) if "END OF HEADER" in line) + 1
    for line in lines[begin:]:
        if line.startswith(">"):
            hour, minute, seconds = line[13:15], line[16:18], line[19:29]
            second = round(int(hour) * 3600 + int(minute) * 60 + float(seconds), 1)
            epochs[second] = 0
        else:
            epochs[second] += 1
    return epochs


def main():
    tool = sys.argv[1]
    for program in ("str2str", "convbin"):
        if shutil.which(program) is None:
            print(f"skipped: {program} is not installed (Debian package rtklib)")
            sys.exit(SKIP)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        log = record(tool, folder)
        answers = log.read_bytes().count(b"<OK\r\n[COM1]")
        expect(answers == COMMANDS.count("\n"), f"{answers} of {COMMANDS.count(chr(10))} commands answered with OK")
        subprocess.run(["convbin", "-r", "nov", "-v", "3.02", "-od", "-os", str(log)], check=True, capture_output=True)
        found = epochs_of(folder / "receiver.obs")
        with open(folder / "sent.csv", encoding="ascii") as file:
            # An epoch without a satellite is no epoch in RINEX.
            sent = {round(float(row["time_of_week_s"]) % 86400, 1): int(row["satellites"]) for row in csv.DictReader(file)
                    if int(row["satellites"]) > 0}
        expect(len(sent) > SECONDS - 60, f"only {len(sent)} epochs were sent")
        expect(found == sent, f"RTKLIB finds {len(found)} epochs with {sum(found.values())} satellites, sent were {len(sent)} with "
                              f"{sum(sent.values())}")
        navigation = (folder / "receiver.nav").read_text(encoding="ascii").split("END OF HEADER")[1]
        satellites = {line[:3] for line in navigation.splitlines() if line[:1] in "GC"}
        expect(len(satellites) >= 15, f"ephemerides of {len(satellites)} satellites only")
        print(f"{answers} commands, {len(found)} epochs, {sum(found.values())} satellites, ephemerides of {len(satellites)}")


if __name__ == "__main__":
    main()
