"""tshark's dissectors of GVCP and GVSP read a session of client and emulated camera. Usage: check_tshark.py TOOL"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

from gige import device, enter_own_network, expect, need, take

IMAGES, WIDTH, HEIGHT = 2, 64, 32


def fields(capture, display_filter, *names, more=()):
    """Values of the fields of every packet that passes the filter."""
    options = [word for name in names for word in ("-e", name)]
    command = ["tshark", "-r", capture, *more, "-Y", display_filter, "-T", "fields", *options]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return [line.split("\t") for line in text.splitlines()]


def record(tool, capture):
    """A session, captured on the loopback interface."""
    dump = subprocess.Popen(["dumpcap", "-q", "-i", "lo", "-w", capture], stderr=subprocess.PIPE, text=True)
    try:
        while "File:" not in dump.stderr.readline():
            expect(dump.poll() is None, "dumpcap does not start")
        with device(tool):
            code, _, errors = take(tool, IMAGES, WIDTH, HEIGHT, "Mono16", "compare")
        expect(code == 0, errors)
        time.sleep(1)  # dumpcap writes once a second
    finally:
        dump.terminate()
        dump.wait(timeout=30)


def main():
    tool = sys.argv[1]
    need("tshark", "dumpcap")
    enter_own_network()
    with tempfile.TemporaryDirectory() as folder:
        capture = str(pathlib.Path(folder) / "session.pcapng")
        record(tool, capture)
        # tshark does not follow the stream's port from the register that names it.
        ports = {row[0] for row in fields(capture, "udp && udp.port != 3956 && udp.length > 8", "udp.dstport")}
        stream = [word for port in ports for word in ("-d", f"udp.port=={port},gvsp")]
        malformed = fields(capture, "_ws.malformed || _ws.expert.severity >= 8388608", "frame.number", "_ws.col.Info", more=stream)
        expect(not malformed, f"malformed: {malformed[:5]}")
        commands = fields(capture, "gvcp", "gvcp.cmd.command")
        kinds = [row[0] for row in fields(capture, "gvsp", "gvsp.format", more=stream)]
        sizes = fields(capture, "gvsp.format == 1", "gvsp.sizex", "gvsp.sizey", "gvsp.pixel", more=stream)
    expect(len(commands) > 50, f"{len(commands)} GVCP packets")
    expect([int(kind, 0) for kind in kinds].count(1) == IMAGES, f"leaders: {kinds}")
    expect([int(kind, 0) for kind in kinds].count(2) == IMAGES, f"trailers: {kinds}")
    for width, height, pixel in sizes:
        expect((int(width), int(height), int(pixel, 0)) == (WIDTH, HEIGHT, 0x01100007), f"leader: {width} {height} {pixel}")
    print(json.dumps({"gvcp": len(commands), "gvsp": len(kinds), "malformed": 0}))


main()
