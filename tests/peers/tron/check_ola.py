"""OLA as receiver of the driver's source of sACN, and as source for the emulated lights. Usage: check_ola.py TOOL"""

import contextlib
import os
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "gige"))
from gige import enter_own_network, expect, need, skip  # noqa: E402

ADDRESS, PORT, NOBODY = "10.77.0.1", 5568, 65534
IN, OUT = 1, 2  # universes
START_SLOT = 5
VALUES = [0, 1, 255, 256, 257, 4660, 32767, 32768, 43981, 65279, 65280, 65535]
PATIENCE = 60


def wait_until(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        expect(time.monotonic() < end, f"{what} does not come")
        time.sleep(0.2)


def make_interface():
    for command in ("add v0 type veth peer name v1", "set v0 up", "set v1 up"):
        subprocess.run(["ip", "link", *command.split()], check=True)
    subprocess.run(["ip", "addr", "add", f"{ADDRESS}/24", "dev", "v0"], check=True)


def write_configuration(folder):
    """OLA with its plug-in of E1.31 alone."""
    names = ("artnet dummy espnet ftdidmx gpio karate kinet milinst nanoleaf opendmx openpixelcontrol osc pathport renard "
             "sandnet shownet spi stageprofi uartdmx usbdmx usbserial")
    for name in names.split():
        (folder / f"ola-{name}.conf").write_text("enabled = false\n")
    (folder / "ola-e131.conf").write_text(f"enabled = true\nip = {ADDRESS}\ninput_ports = 1\noutput_ports = 1\n")
    for path in (folder, *folder.iterdir()):
        os.chown(path, NOBODY, NOBODY)


@contextlib.contextmanager
def ola(folder):
    """olad does not run as root. Yields a function that calls one of its programs, and its log."""
    home = {**os.environ, "HOME": str(folder)}
    log = folder / "olad.log"
    command = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups", "olad", "-c", str(folder / "conf"),
               "--no-http", "-l", "3"]
    with log.open("w") as output:
        process = subprocess.Popen(command, env=home, stdout=output, stderr=output)

    def call(*words):
        return subprocess.run(words, env=home, capture_output=True, text=True, timeout=PATIENCE).stdout

    try:
        wait_until(lambda: process.poll() is not None or "E1.31" in call("ola_dev_info"), "OLA's device of E1.31")
        expect(process.poll() is None, log.read_text()[-2000:])
        yield call, log
    finally:
        process.terminate()
        process.wait(timeout=30)


def check_reception(tool, call, log, folder):
    call("ola_patch", "-d", "1", "-p", "0", "-i", "-u", str(IN))
    show = folder / "show"
    source = subprocess.Popen([tool, "send", ADDRESS, str(IN), str(START_SLOT)], stdin=subprocess.PIPE, text=True)
    source.stdin.write(" ".join(map(str, VALUES)) + "\n")
    source.stdin.flush()
    slots = [0] * (START_SLOT - 1) + [half for value in VALUES for half in (value >> 8, value & 255)]

    def has_arrived():
        show.unlink(missing_ok=True)
        recorder = subprocess.Popen(["ola_recorder", "-r", str(show), "-u", str(IN)], env={**os.environ, "HOME": str(folder)},
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(2)
        recorder.send_signal(signal.SIGINT)
        recorder.wait(timeout=PATIENCE)
        if not show.exists():
            return False
        frames = [line.split() for line in show.read_text().splitlines() if line.startswith(f"{IN} ")]
        received = [[int(level) for level in frame[1].split(",")] for frame in frames if len(frame) == 2]
        return any(levels[:len(slots)] == slots and not any(levels[len(slots):]) for levels in received)

    try:
        wait_until(has_arrived, "the levels in OLA's universe")
        expect("sent a termination" not in log.read_text(), "OLA takes the source for ended")
        source.stdin.close()
        expect(source.wait(timeout=30) == 0, "the source fails")
        wait_until(lambda: "sent a termination" in log.read_text(), "the end of the source in OLA's log")
    finally:
        source.kill()


def check_control(tool, call):
    """OLA sends to a multicast group; what it sends is passed on to the emulated lights, which are unicast."""
    group = f"239.255.{OUT >> 8}.{OUT & 255}"
    listener = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
    listener.bind(("v1", 0))
    listener.settimeout(1)
    call("ola_patch", "-d", "1", "-p", "0", "-u", str(OUT))
    lights = subprocess.Popen([tool, "receive", "127.0.0.1", str(OUT), "1"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        port = int(lights.stdout.readline())
        slots = [half for value in VALUES for half in (value >> 8, value & 255)]
        passed = 0
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            end = time.monotonic() + PATIENCE
            while passed < 3:
                expect(time.monotonic() < end, "OLA sends nothing")
                call("ola_set_dmx", "-u", str(OUT), "-d", ",".join(map(str, slots)))
                with contextlib.suppress(TimeoutError):
                    while passed < 3:
                        payload = datagram_to(group, listener.recv(4096))
                        if payload and payload[126:126 + len(slots)] == bytes(slots):
                            out.sendto(payload, ("127.0.0.1", port))
                            passed += 1
        powers = [float(word) for word in lights.stdout.readline().split()]
        expected = [value / 65535 for k, value in enumerate(VALUES) if k != 1]
        expect(len(powers) == 11 and all(abs(a - b) < 1e-8 for a, b in zip(powers, expected)), f"powers {powers}")
        lights.stdin.close()
        rest = lights.stdout.read()
        expect("unreadable 0" in rest, rest)
    finally:
        lights.kill()
        listener.close()


def datagram_to(group, frame):
    """Payload of an Ethernet frame with a UDP datagram to the group's port of sACN."""
    if len(frame) < 42 or frame[12:14] != b"\x08\x00" or frame[23] != 17 or frame[30:34] != socket.inet_aton(group):
        return b""
    header = 14 + 4 * (frame[14] & 15)
    port, length = struct.unpack_from(">HH", frame, header + 2)
    return frame[header + 8:header + length] if port == PORT else b""


def main():
    tool = sys.argv[1]
    need("olad", "ola_patch", "ola_dev_info", "ola_recorder", "ola_set_dmx", "setpriv", "ip")
    if os.geteuid() != 0:
        skip("olad has to be started for another user, which only root may")
    enter_own_network()
    make_interface()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        os.chmod(folder, 0o755)
        (folder / "conf").mkdir()
        write_configuration(folder / "conf")
        with ola(folder) as (call, log):
            check_reception(tool, call, log, folder)
            check_control(tool, call)
    print(f"{len(VALUES)} values each way, and the end of the source")


main()
