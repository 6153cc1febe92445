"""tshark's dissector of E1.31 reads what the source of the lights sends. Usage: check_tshark.py TOOL"""

import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "gige"))
from gige import enter_own_network, expect, need  # noqa: E402

UNIVERSE, START_SLOT = 7, 3
VALUES = [0, 1, 255, 256, 257, 4660, 32767, 32768, 43981, 65279, 65280, 65535]
NAMES = ("acn.dmx.source_name", "acn.dmx.priority", "acn.dmx.seq_number", "acn.dmx.universe", "acn.dmx.options")


def record(tool, capture):
    """A source that sends, keeps alive and ends, captured on the loopback interface."""
    dump = subprocess.Popen(["dumpcap", "-q", "-i", "lo", "-w", capture], stderr=subprocess.PIPE, text=True)
    try:
        while "File:" not in dump.stderr.readline():
            expect(dump.poll() is None, "dumpcap does not start")
        command = [tool, "send", "127.0.0.1", str(UNIVERSE), str(START_SLOT)]
        source = subprocess.Popen(command, stdin=subprocess.PIPE, text=True)
        source.stdin.write(" ".join(map(str, VALUES)) + "\n")
        source.stdin.flush()
        time.sleep(1)
        source.stdin.close()
        expect(source.wait(timeout=30) == 0, "the source fails")
        time.sleep(1)  # dumpcap writes once a second
    finally:
        dump.terminate()
        dump.wait(timeout=30)


def layers(capture):
    options = [word for name in NAMES for word in ("-e", name)]
    command = ["tshark", "-r", capture, "--enable-heuristic", "acn", "-o", "acn.dmx_enable:TRUE", "-Y", "acn && !icmp", "-T", "fields", *options]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return [line.split("\t") for line in text.splitlines()]


def main():
    tool = sys.argv[1]
    need("tshark", "dumpcap")
    enter_own_network()
    with tempfile.TemporaryDirectory() as folder:
        capture = str(pathlib.Path(folder) / "lights.pcapng")
        record(tool, capture)
        command = ["tshark", "-r", capture, "--enable-heuristic", "acn", "-o", "acn.dmx_enable:TRUE", "-Y", "_ws.malformed || _ws.expert.severity >= 8388608"]
        malformed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        expect(not malformed, malformed)
        packets = layers(capture)
    expect(len(packets) >= 4, f"{len(packets)} packets of E1.31")
    for number, (name, priority, sequence, universe, options) in enumerate(packets):
        is_end = number >= len(packets) - 3
        found = (name, int(priority, 0), int(sequence, 0), int(universe, 0), int(options, 0))
        expect(found == ("vbar tron", 100, number % 256, UNIVERSE, 0x40 if is_end else 0), f"packet {number}: {found}")
    print(f"{len(packets)} packets read the same")


main()
