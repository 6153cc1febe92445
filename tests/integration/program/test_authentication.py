#!/usr/bin/env python3
"""Authenticated telecommands from end to end: the same flight with a key, and an adversary on the line of a flight computer that is a
process of its own. Codes are recomputed by Python's hmac."""
import hashlib
import hmac
import os
import select
import socket
import struct
import subprocess
import sys
import threading
import unittest

from vbar_program import BINARY, MISSION, SOURCE, fly, hashes, main, overrides, scratch, vbar

sys.path.insert(0, str(SOURCE / "tests" / "integration" / "zynq"))
from board_link import DATA, GOODBYE, Frame, Packet, SerialLine, Session, cobs_decode, cobs_encode, crc16, frame, tick  # noqa: E402

FLIGHT = BINARY / "vbar_flight"
APID_HEALTH, APID_TELECOMMAND_REPORT = 0x503, 0x508
TRAILER = 2 + 8 + 16
HOST_INDEX = 1
PERIOD_NS = 10 * 10**9


def write_key(folder, name="key", text=None, mode=0o600):
    file = folder / name
    file.write_text(text if text is not None else os.urandom(32).hex() + "\n")
    file.chmod(mode)
    return file


def is_telecommand(packet):
    return 0x100 <= int.from_bytes(packet[:2], "big") & 0x7FF < 0x200


def sealed(packet):
    return packet[:-2] + struct.pack(">H", crc16(packet[:-2]))


class Line:
    """A Unix socket on which this test listens, and its peer."""

    def __init__(self, path):
        self.path = path
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(str(path))
        self.listener.listen(1)
        self.listener.settimeout(30)

    def accept(self):
        self.stream, _ = self.listener.accept()
        self.listener.close()
        return self.stream


class Flight:
    """A flight computer with a key, at the other end of a line of this test."""

    def __init__(self, folder, key, name="line"):
        line = Line(folder / name)
        self.process = subprocess.Popen([str(FLIGHT), "--unix", str(line.path), "--telecommand-key", str(key)], stderr=subprocess.PIPE)
        self.stream = line.accept()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stream.close()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stderr.close()


class Adversary(threading.Thread):
    """Carries the frames between vbar and a flight computer, notes telecommands, and may change them on their way."""

    def __init__(self, line, flight, change=None):
        super().__init__(daemon=True)
        self.line, self.flight, self.change = line, flight, change
        self.telecommands = []
        self.answers = b""
        self.has_ended = threading.Event()

    def run(self):
        to_host = self.line.accept()
        back = threading.Thread(target=self.carry_answers, args=(to_host,), daemon=True)
        back.start()
        line = SerialLine(to_host)
        try:
            while (data := line.receive(60)) is not None:
                if not data:
                    continue  # a zero byte ends what a line may have brought before
                sent = Frame(data)
                if sent.kind == GOODBYE:
                    break  # the flight computer stays, for the adversary
                packet = sent.payload
                if sent.kind == DATA and is_telecommand(packet):
                    if packet not in self.telecommands:  # a frame may be sent again
                        self.telecommands.append(packet)
                    if self.change is not None:
                        packet = self.change(packet)
                self.flight.sendall(cobs_encode(frame(sent.kind, sent.session, sent.step, sent.index, sent.flags, packet)))
        except ConnectionError:
            pass
        self.has_ended.set()
        back.join()
        to_host.close()

    def carry_answers(self, to_host):
        try:
            while not self.has_ended.is_set():
                if select.select([self.flight], [], [], 0.05)[0]:
                    data = self.flight.recv(65536)
                    if not data:
                        return
                    self.answers += data
                    to_host.sendall(data)
        except OSError:
            pass

    def packets(self):
        """Those of the flight computer, in their order."""
        frames = [Frame(cobs_decode(coded)) for coded in self.answers.split(b"\0") if coded]
        return [one.payload for one in frames if one.kind == DATA]


def health(packets):
    for data in packets:
        packet = Packet(data)
        if packet.apid == APID_HEALTH:
            names = ("accepted", "checksum", "type", "length", "content", "time", "other", "full")
            return dict(zip(names, struct.unpack(">8i", packet.payload[16:48])))
    raise AssertionError("no telemetry_health")


def reports(packets):
    return sum(Packet(data).apid == APID_TELECOMMAND_REPORT for data in packets)


class Authentication(unittest.TestCase):
    def test_commands_and_telemetry_are_those_of_a_run_without_a_key(self):
        with scratch() as folder:
            key = write_key(folder)
            with_key = f"flight_computer.telecommand_key_file={key}"
            without = hashes(fly(folder / "without"))
            self.assertEqual(hashes(fly(folder / "in_process", with_key)), without)
            self.assertEqual(hashes(fly(folder / "process", with_key, "flight_computer.target=host_process")), without)
            log = (folder / "without" / "packets.lcmlog").read_bytes()
            for name in ("in_process", "process"):
                self.assertEqual(len((folder / name / "packets.lcmlog").read_bytes()), len(log))
                self.check_absence(folder / name, key)
            replay = vbar("replay", folder / "process", *overrides(with_key))
            self.assertEqual(replay.returncode, 0, replay.stderr)
            # A run folder names the key of its owner: who replays it must say that it may be used.
            self.assertIn("telecommand_key_file", vbar("replay", folder / "process").stderr)

    def check_absence(self, run, key):
        digits = key.read_text().strip()
        forbidden = [digits.encode(), digits.upper().encode(), bytes.fromhex(digits),
                     hashlib.sha256(key.read_bytes()).hexdigest().encode(), hashlib.sha256(bytes.fromhex(digits)).hexdigest().encode()]
        files = [file for file in run.rglob("*") if file.is_file()]
        self.assertTrue(files)
        for file in files:
            content = file.read_bytes()
            for secret in forbidden:
                self.assertNotIn(secret, content, file)

    def test_a_reboot_does_not_end_authentication(self):
        """With and without the state, the rebooted computer takes the telecommands that follow."""
        with scratch() as folder:
            key = write_key(folder)
            for keeps in ("true", "false"):
                mission = folder / f"{keeps}.toml"
                mission.write_text(f'extends = "{MISSION}"\n[[fault]]\nkind = "computer_reboot"\nat_h = 1.0\nfor_s = 180.0\n'
                                   f"keeps_state = {keeps}\n")
                process = ("mission.duration_h=3", "flight_computer.target=host_process")
                without = fly(folder / f"without-{keeps}", *process, mission=mission)
                with_key = fly(folder / f"with-{keeps}", *process, f"flight_computer.telecommand_key_file={key}", mission=mission)
                self.assertEqual(hashes(with_key), hashes(without), keeps)

    def test_an_invalid_key_is_refused_in_one_sentence(self):
        with scratch() as folder:
            good = "0123456789abcdef" * 4
            cases = {
                "No such file": folder / "absent",
                "fewer than 64 digits": write_key(folder, "short", good[1:]),
                "more than 64 digits": write_key(folder, "long", good + "00"),
                "not hexadecimal digits": write_key(folder, "text", "x" + good[1:]),
                "accessible to others": write_key(folder, "open", good, 0o644),
                "not a file": folder,
            }
            cases["accessible to others than its owner"] = write_key(folder, "group", good, 0o640)
            for reason, file in cases.items():
                result = vbar("run", MISSION, "--force", "--out", folder / "run",
                              *overrides(f"flight_computer.telecommand_key_file={file}"))
                self.assertNotIn(result.returncode, (0, 10, 12), reason)
                self.assertIn(reason, result.stderr)
                self.assertIn("flight_computer.telecommand_key_file", result.stderr)
                self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
                self.assertNotIn(good[1:], result.stderr + result.stdout)

    def test_both_ends_must_have_a_key(self):
        with scratch() as folder:
            key = write_key(folder)
            keyless = Line(folder / "keyless")
            process = subprocess.Popen([str(FLIGHT), "--unix", str(keyless.path)])
            relay = Line(folder / "board")
            try:
                Adversary(relay, keyless.accept()).start()
                board = ("flight_computer.target=board", f"flight_computer.device=unix:{relay.path}")
                result = vbar("run", MISSION, "--out", folder / "run", *overrides(*board, f"flight_computer.telecommand_key_file={key}"))
                self.assertIn("it has no key", result.stderr)
            finally:
                process.kill()
                process.wait()
            with Flight(folder, key) as flight:
                relay = Line(folder / "board-2")
                Adversary(relay, flight.stream).start()
                board = ("flight_computer.target=board", f"flight_computer.device=unix:{relay.path}")
                result = vbar("run", MISSION, "--out", folder / "run-2", *overrides(*board))
                self.assertIn("authenticated telecommands only", result.stderr)

    def fly_through(self, folder, key, flight, name, change=None):
        relay = Line(folder / f"board-{name}")
        adversary = Adversary(relay, flight.stream, change)
        adversary.start()
        summary = fly(folder / name, "flight_computer.target=board", f"flight_computer.device=unix:{relay.path}",
                      f"flight_computer.telecommand_key_file={key}", "mission.duration_h=0.5")
        adversary.join(30)
        self.assertFalse(adversary.is_alive())
        self.assertTrue(adversary.telecommands)
        return summary, adversary

    def test_recorded_telecommands_are_refused_in_another_session(self):
        with scratch() as folder:
            key = write_key(folder)
            secret = bytes.fromhex(key.read_text())
            with Flight(folder, key) as flight:
                summary, adversary = self.fly_through(folder, key, flight, "run")
                recorded = adversary.telecommands
                self.assertEqual(hashes(summary), hashes(fly(folder / "without", "mission.duration_h=0.5")))
                sequences = []
                for packet in recorded:
                    index, sequence = struct.unpack(">HQ", packet[-2 - TRAILER:-2 - 16])
                    self.assertEqual(index, HOST_INDEX)
                    self.assertEqual(hmac.new(secret, packet[:-18], hashlib.sha256).digest()[:16], packet[-18:-2])
                    sequences.append(sequence)
                self.assertEqual(sequences, sorted(set(sequences)))

                # The adversary begins a session of its own, for which the computer starts a new flight software.
                session = Session(SerialLine(flight.stream), 77)
                self.assertTrue(session.hello().endswith("telecommands authenticated"))
                time_ns = Packet(recorded[0]).time_ns + 10**9
                answer = session.step(0, [*recorded, tick(0, time_ns, PERIOD_NS)])
                self.assertEqual(reports(answer), 0)
                counted = health(answer)
                self.assertEqual((counted["accepted"], counted["other"]), (1, len(recorded)))  # the tick

                # Each with one bit altered, at a place of its own, and with CRCs that fit.
                altered = []
                for number, packet in enumerate(recorded):
                    at = 16 + number * 7 % (len(packet) - 18)
                    altered.append(sealed(packet[:at] + bytes([packet[at] ^ 1 << number % 8]) + packet[at + 1:]))
                plain = [sealed(packet[:4] + struct.pack(">H", len(packet) - TRAILER - 7) + packet[6:-2 - TRAILER] + b"\0\0")
                         for packet in recorded]
                answer = session.step(1, [*altered, tick(1, time_ns + PERIOD_NS, PERIOD_NS)])
                self.assertEqual(reports(answer), 0)
                counted = health(answer)
                self.assertEqual((counted["accepted"], counted["checksum"]), (2, len(altered)))
                answer = session.step(2, [*plain, tick(2, time_ns + 2 * PERIOD_NS, PERIOD_NS)])
                self.assertEqual(reports(answer), 0)
                self.assertEqual(health(answer)["accepted"], 3)

                # Who has the key is heard.
                late = recorded[0][:-18 - 8] + struct.pack(">Q", max(sequences) + 1)
                genuine = sealed(late + hmac.new(secret, late, hashlib.sha256).digest()[:16] + b"\0\0")
                answer = session.step(3, [genuine, tick(3, time_ns + 3 * PERIOD_NS, PERIOD_NS)])
                self.assertEqual((reports(answer), health(answer)["accepted"]), (1, 5))
                session.goodbye()

    def test_recorded_telecommands_are_refused_by_a_process_that_starts_again(self):
        with scratch() as folder:
            key = write_key(folder)
            with Flight(folder, key) as flight:
                recorded = self.fly_through(folder, key, flight, "run")[1].telecommands
            with Flight(folder, key, "second") as flight:
                session = Session(SerialLine(flight.stream), 78)
                session.hello()
                answer = session.step(0, [*recorded, tick(0, Packet(recorded[0]).time_ns + 10**9, PERIOD_NS)])
                self.assertEqual((reports(answer), health(answer)["other"]), (0, len(recorded)))
                session.goodbye()

    def test_a_telecommand_altered_on_its_way_is_refused_and_counted(self):
        """One bit of the first telecommand: the flight goes on without it."""
        with scratch() as folder:
            key = write_key(folder)
            changed = []

            def change(packet):
                if changed and packet != changed[0]:  # a frame that is sent again is altered again
                    return packet
                changed[:] = [packet]
                return sealed(packet[:40] + bytes([packet[40] ^ 4]) + packet[41:])

            with Flight(folder, key) as flight:
                _, adversary = self.fly_through(folder, key, flight, "run", change)
            packets = adversary.packets()
            counted = health(packets)
            self.assertEqual((counted["checksum"], counted["other"]), (1, 0))
            self.assertEqual(reports(packets), len(adversary.telecommands) - 1)


if __name__ == "__main__":
    main()
