"""Space packets as tshark's CCSDS dissector reads them. Usage: check_tshark.py TOOL"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

from peer import ask, expect, skip

UDP_PORT = 5001
UNSEGMENTED, FIRST, LAST, CONTINUATION = 3, 1, 2, 0


def dissected(packets):
    """tshark's CCSDS layer of each packet, sent as a UDP datagram."""
    with tempfile.TemporaryDirectory() as folder:
        text = pathlib.Path(folder) / "packets.txt"
        capture = pathlib.Path(folder) / "packets.pcap"
        text.write_text("".join("000000 " + p.hex(" ") + "\n" for p in packets))
        subprocess.run(["text2pcap", "-q", "-u", f"5000,{UDP_PORT}", text, capture], check=True, capture_output=True)
        command = ["tshark", "-r", capture, "-d", f"udp.port=={UDP_PORT},ccsds", "-T", "json"]
        answer = subprocess.run(command, check=True, capture_output=True, text=True)
    return [frame["_source"]["layers"]["ccsds"] for frame in json.loads(answer.stdout)]


def check_primary(layer, packet, apid, flags, count):
    """The primary header, and that tshark finds the length right."""
    primary = layer["Primary CCSDS Header"]
    identification = primary["ccsds.header_flags_tree"]
    found = (int(identification["ccsds.version"]), int(identification["ccsds.type"]),
             int(identification["ccsds.secheader"]), int(identification["ccsds.apid"]),
             int(primary["ccsds.seqflag"]), int(primary["ccsds.seqnum"]), int(primary["ccsds.length"]))
    to_flight = 1 if apid < 0x400 else 0
    expect(found == (0, to_flight, 1, apid, flags, count, len(packet) - 7), f"{packet.hex()}: {found}")
    expect("ccsds.length.error" not in json.dumps(layer), f"{packet.hex()}: length error")


def main():
    tool = sys.argv[1]
    if not shutil.which("tshark") or not shutil.which("text2pcap"):
        skip("tshark is not installed")
    examples = json.loads(ask(tool, "packets")[0])
    packets = [bytes.fromhex(e["packet"]) for e in examples]
    layers = dissected(packets)
    expect(len(layers) == len(packets), "one dissection a packet")
    for layer, packet, example in zip(layers, packets, examples):
        check_primary(layer, packet, example["apid"], UNSEGMENTED, example["sequence_count"])
        # tshark knows another secondary header (Space Station), but of the same length: its first field is the high word of
        # our time.
        secondary = layer["Secondary CCSDS Header"]
        high_word = (example["time_ns"] >> 32) & 0xFFFFFFFF
        expect(int(secondary["ccsds.coarse_time"]) == high_word, f"time of {packet.hex()}")
        # A bit that belongs to the time here makes tshark take the last two bytes for a checkword of its own kind.
        payload = layer["ccsds.user_data"].replace(":", "")
        expect(payload in (packet[16:].hex(), packet[16:-2].hex()), f"payload of {packet.hex()}: {payload}")

    segments = [bytes.fromhex(p) for p in ask(tool, "segments", [bytes(range(256)).hex() * 16])[0].split()]
    layers = dissected(segments)
    flags = [FIRST] + [CONTINUATION] * (len(segments) - 2) + [LAST]
    for number, (layer, packet) in enumerate(zip(layers, segments)):
        check_primary(layer, packet, 0x010, flags[number], (0x3FFF + number) & 0x3FFF)
    print(f"{len(packets)} packets and {len(segments)} segments read the same")


main()
