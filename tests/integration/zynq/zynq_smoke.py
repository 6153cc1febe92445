#!/usr/bin/env python3
"""zynq_smoke.py IMAGE_FOLDER HOST_LIBRARY [TEST...]: the Zynq images on the emulator, spoken to from outside.

IMAGE_FOLDER holds the images of the preset zynq; HOST_LIBRARY is the example article as a
shared library of this computer, which must answer with the same bits. Exit status 77 when any of these, or QEMU, is
missing: then there is nothing to test."""

import ctypes
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from board_link import (ACK, APID_MANEUVER_COMMAND, APID_TELEMETRY_NAVIGATION, APID_WIRED_BYTES, HELLO, HELLO_ACK, POLL, Datagrams,
                        Packet, SerialLine, Session, StepReport, WiredBytes, frame, ideal_navigation, tick)
from emulated_board import EmulatedBoard
from neighbour import (ADDRESS, ARP_REPLY, BOARD_ADDRESS, BOARD_MAC, ECHO_REPLY, ECHO_REQUEST, ICMP, MAC, UDP,
                       Neighbour, echo, internet_checksum, ipv4)

START_NS = 1_400_000_000_000_000_000
PERIOD_NS = 10_000_000_000
STEPS = 40


def inputs(step):
    """Packets of a step: servicer on a circular orbit of 7000 km, target drifting around it."""
    mu, radius = 3.986004415e14, 7.0e6
    rate = math.sqrt(mu / radius**3)
    angle = rate * 10.0 * step
    r = (radius * math.cos(angle), radius * math.sin(angle), 0.0)
    v = (-radius * rate * math.sin(angle), radius * rate * math.cos(angle), 0.0)
    offset = (300.0 * math.sin(3.0 * angle), 200.0, 50.0 * math.cos(angle))
    states = r + v + tuple(a + b for a, b in zip(r, offset)) + v
    now = START_NS + step * PERIOD_NS
    return [ideal_navigation(step, now, states), tick(step, now, PERIOD_NS)]


class HostArticle:
    """The example article in this process, through the C interface of fsw/messaging/vbar_gnc.h."""

    def __init__(self, path, spacecraft=1):
        sink_type = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.POINTER(ctypes.c_uint8), ctypes.c_size_t)
        self.library = ctypes.CDLL(path)
        self.library.vbar_gnc_state_size.restype = ctypes.c_size_t
        self.library.vbar_gnc_step.argtypes = [ctypes.c_void_p, ctypes.c_int64]
        self.packets = []
        self.sink = sink_type(lambda _, data, size: self.packets.append(bytes(data[:size])))
        self.state = ctypes.create_string_buffer(self.library.vbar_gnc_state_size())
        assert self.library.vbar_gnc_init(self.state, ctypes.c_uint8(spacecraft), self.sink, None) == 0

    def step(self, step, packets):
        self.packets = []
        for packet in packets:
            self.library.vbar_gnc_receive(self.state, packet, ctypes.c_size_t(len(packet)))
        self.library.vbar_gnc_step(self.state, START_NS + step * PERIOD_NS)
        return self.packets


def fly(session, steps=STEPS):
    """Answers without their reports, and the reports."""
    answers, reports = [], []
    for step in range(steps):
        packets = session.step(step, inputs(step))
        answers.append(packets[:-1])
        reports.append(StepReport(Packet(packets[-1])))
    return answers, reports


def loaded_segments(image):
    """Entry point of an ELF file of 32 bits, and address and bytes of each segment that is loaded from it."""
    with open(image, "rb") as file:
        elf = file.read()
    entry, first = struct.unpack_from("<II", elf, 24)
    size, count = struct.unpack_from("<HH", elf, 42)
    headers = [struct.unpack_from("<6I", elf, first + k * size) for k in range(count)]
    pt_load = 1
    return entry, [(address, elf[offset:offset + stored]) for kind, offset, _, address, stored, _ in headers if kind == pt_load and stored]


class ZynqSmoke(unittest.TestCase):
    image_folder = ""
    host_library = ""

    def example(self, **options):
        return EmulatedBoard(os.path.join(self.image_folder, "vbar_zynq7000_example.elf"), **options)

    def datagrams(self, board):
        line = Datagrams(board.udp_port)
        self.addCleanup(line.close)
        return line

    def expected(self, steps=STEPS):
        article = HostArticle(self.host_library)
        return [article.step(step, inputs(step)) for step in range(steps)]

    def check_flight(self, answers, reports):
        self.assertEqual(answers, self.expected(len(answers)), "host and Zynq differ")
        kinds = {Packet(packet).apid for answer in answers for packet in answer}
        self.assertEqual(kinds, {APID_TELEMETRY_NAVIGATION, APID_MANEUVER_COMMAND})
        for step, report in enumerate(reports):
            self.assertEqual((report.step, report.unit), (step, 1))
            self.assertGreater(report.count, 0)
            # Above nothing, below the 256 KiB of the linker script.
            self.assertTrue(1000 < report.stack_bytes < 256 * 1024, report.stack_bytes)

    def test_serial(self):
        """Hello, steps and goodbye over the serial line: the host library's bits, and a clean end."""
        with self.example() as board:
            session = Session(SerialLine(board.serial), 11)
            self.assertIn("zynq7000", session.hello())
            self.check_flight(*fly(session))
            session.goodbye()
            self.assertEqual(board.wait(), 0, board.console())
            self.assertIn("example article in C", board.console())

    def test_ethernet(self):
        """The same over UDP."""
        with self.example() as board:
            session = Session(self.datagrams(board), 12)
            session.hello()
            self.check_flight(*fly(session))
            session.goodbye()
            self.assertEqual(board.wait(), 0, board.console())

    def test_address(self):
        """A copy of the image with another address answers there, and says so on its console."""
        image = os.path.join(self.image_folder, "vbar_zynq7000_example.elf")
        script = os.path.join(os.path.dirname(__file__), "../../../boards/zynq7000/set_address.py")
        with tempfile.TemporaryDirectory(prefix="vbar-zynq-") as folder:
            copy = os.path.join(folder, "second.elf")

            def run(*arguments):
                return subprocess.run([sys.executable, script, *arguments], capture_output=True, text=True)

            changed = run(image, "--address", "10.0.2.77", "--port", "6001", "--out", copy)
            self.assertEqual(changed.returncode, 0, changed.stderr)
            self.assertIn("10.0.2.77:6001, Ethernet 02:76:0a:00:02:4d", run(copy).stdout)
            self.assertIn("10.0.2.15:5000", run(image).stdout)
            self.assertEqual(run(image, "--address", "224.0.0.1", "--out", copy).returncode, 2)
            for content, reason in ((b"", "no network settings"), (2 * (b"vbarnet1" + bytes(12)), "twice")):
                with open(os.path.join(folder, "other"), "wb") as other:
                    other.write(content)
                refused = run(other.name)
                self.assertEqual(refused.returncode, 1)
                self.assertIn(reason, refused.stderr)
            with EmulatedBoard(copy, address="10.0.2.77:6001") as board:
                session = Session(self.datagrams(board), 12)
                session.hello()
                self.check_flight(*fly(session))
                session.goodbye()
                self.assertEqual(board.wait(), 0, board.console())
                self.assertIn("UDP 10.0.2.77:6001", board.console())

    def test_cost_repeats(self):
        """With a fixed -icount a step costs the same instructions in every run, whatever the line and the load."""
        costs = []
        for make_line in (lambda b: SerialLine(b.serial), self.datagrams, lambda b: SerialLine(b.serial)):
            with self.example() as board:
                session = Session(make_line(board), 13)
                session.hello()
                _, reports = fly(session)
                # 10 ns a tick, 2^5 ns an instruction.
                costs.append([round(report.count * 10 / 32) for report in reports])
        self.assertEqual(costs[0], costs[1])
        self.assertEqual(costs[0], costs[2])
        print(f"a step of the example article: {min(costs[0])} to {max(costs[0])} instructions")

    def test_wired_receiver(self):
        """With the link on Ethernet UART0 is the receiver's line; after the goodbye it is the link again."""
        with self.example(semihosting=False) as board:
            refused = Session(SerialLine(board.serial), 31)
            self.assertIn("error: no line to a receiver", refused.hello(receiver_baud=115200))
            refused.goodbye()
            session = Session(self.datagrams(board), 32)
            self.assertIn("zynq7000", session.hello(receiver_baud=115200))
            self.assertEqual(session.receiver_count(), 0)
            sent = 0
            for step in range(10):
                data = bytes((7 * i + step) % 256 for i in range(700 * step))
                board.serial.sendall(data)
                sent += len(data)
                start = time.monotonic()
                while session.receiver_count() < sent and time.monotonic() - start < 10:
                    pass
                answer = [Packet(packet) for packet in session.step(step, inputs(step))]
                wired = [packet for packet in answer if packet.apid == APID_WIRED_BYTES]
                self.assertEqual(b"".join(WiredBytes(packet).data for packet in wired), data)
                self.assertEqual(wired, answer[:len(wired)])
                for packet in wired:
                    self.assertEqual((packet.time_ns, packet.spacecraft), (START_NS + step * PERIOD_NS, 1))
                    self.assertEqual((WiredBytes(packet).received, WiredBytes(packet).dropped), (sent, 0))
                self.assertEqual(StepReport(answer[-1]).rejected, 0)
            session.goodbye()
            session = Session(SerialLine(board.serial), 33)
            session.hello()
            self.check_flight(*fly(session, 5))

    def test_barrier(self):
        """A step runs once, when all its packets are in, and its answer can be had again."""
        with self.example() as board:
            session = Session(SerialLine(board.serial), 14)
            session.hello()
            first, last = inputs(0)
            session.line.send(session.data(0, 0, first, last=False))
            self.assertIsNone(session.next_frame(0.3), "answered before the barrier closed")
            session.line.send(session.data(0, 0, first, last=False))  # a duplicate
            session.line.send(frame(POLL, session.number, 0, 0))
            held = session.next_frame(2.0)
            self.assertEqual((held.kind, held.step, held.index), (ACK, 0, 1))
            session.line.send(session.data(0, 1, last, last=True))
            answer = session.answer(0, acknowledge=False)
            session.send_step(0, [first, last])  # again: must not run again
            session.line.send(frame(POLL, session.number, 0, 0))
            self.assertEqual(session.answer(0), answer)
            next_answer = session.step(1, inputs(1))
            self.assertEqual([answer[:-1], next_answer[:-1]], self.expected(2))
            self.assertEqual(StepReport(Packet(next_answer[-1])).duplicated, 3)

    def test_broken_bytes(self):
        """Flipped, dropped and invented bytes on the line are detected and counted, and change no result."""
        with self.example() as board:
            session = Session(SerialLine(board.serial), 15)
            session.hello()
            for step in range(20):
                good = session.data(step, 0, inputs(step)[0], last=False)
                flipped = bytearray(good)
                flipped[20 + step] ^= 1 << (step % 8)
                session.line.send(bytes(flipped))
                session.line.send(good[:30] + good[31:])
                session.line.send_raw(b"\x05\x01\x00")  # not COBS
                session.line.send_raw(bytes(range(1, 200)) * 20 + b"\x00")  # longer than a frame
                answer = session.step(step, inputs(step))
                self.assertEqual(answer[:-1], self.expected(step + 1)[step])
            report = StepReport(Packet(answer[-1]))
            self.assertEqual(report.rejected, 4 * 20)  # two bad checksums and two bad codings a step

    def test_strangers(self):
        """A session has one peer: frames of other senders, on either interface, are ignored and counted."""
        with self.example() as board:
            session = Session(self.datagrams(board), 16)
            session.hello()
            strangers = [self.datagrams(board), SerialLine(board.serial)]
            for step in range(10):
                for stranger in strangers:
                    stranger.send(frame(HELLO, 99, payload=b"\x01"))
                    stranger.send(session.data(step, 0, inputs(step)[0], last=False))
                    stranger.send_raw(b"junk\0")
                answer = session.step(step, inputs(step))
                self.assertEqual(answer[:-1], self.expected(step + 1)[step])
                if step == 0:
                    time.sleep(0.5)  # let the serial line's bytes arrive, too
            for stranger in strangers:
                self.assertIsNone(stranger.receive(0.2), "a stranger was answered")
            session.step(10, inputs(10))
            report = StepReport(Packet(session.step(11, inputs(11))[-1]))
            self.assertEqual(report.rejected, 60)  # three frames of each of two strangers in ten steps

    def test_flood(self):
        """More frames than a buffer holds: what does not fit is lost, the board is not, and neither is the session."""
        with self.example() as board:
            session = Session(SerialLine(board.serial), 19)
            session.hello()
            stranger = self.datagrams(board)
            junk = bytes(range(256)) * 5
            for step in range(5):
                for _ in range(300):
                    stranger.send(junk)
                self.assertEqual(session.step(step, inputs(step))[:-1], self.expected(step + 1)[step])
            report = StepReport(Packet(session.step(5, inputs(5))[-1]))
            self.assertGreater(report.rejected, 0)
            session.goodbye()
            self.assertEqual(board.wait(), 0, board.console())

    def test_raw_frames(self):
        """The network as a neighbour on the wire sees it: ARP, ping at every size, and frames that are none."""
        with self.example(raw_ethernet=True) as board:
            neighbour = Neighbour(board)
            self.assertEqual(neighbour.resolve()[:42], ARP_REPLY)
            for size in (0, 1, 18, 55, 56, 999, 1471, 1472):
                body = bytes(i % 251 for i in range(size))
                request = echo(ECHO_REQUEST, body)
                for hostile in (ipv4(ICMP, request)[:33], ipv4(ICMP, request, fragment=0x2000), ipv4(UDP, bytes(7)),
                                ipv4(ICMP, request[:-1] + b"x"), b"\xff" * 60, BOARD_MAC):
                    neighbour.send(hostile)
                neighbour.send(ipv4(ICMP, request))
                answer = neighbour.receive()
                self.assertEqual(answer[:14], MAC + BOARD_MAC + b"\x08\0")
                self.assertEqual(answer[26:34], BOARD_ADDRESS + ADDRESS)
                self.assertEqual(internet_checksum(answer[14:34]), 0)
                self.assertEqual(answer[34:42 + size], echo(ECHO_REPLY, body))

    def test_two_boards(self):
        """Two boards at a time, the second one at another address: both fly, step by step in turn."""
        image = os.path.join(self.image_folder, "vbar_zynq7000_example.elf")
        script = os.path.join(os.path.dirname(__file__), "../../../boards/zynq7000/set_address.py")
        with tempfile.TemporaryDirectory(prefix="vbar-zynq-") as folder:
            second = os.path.join(folder, "second.elf")
            subprocess.run([sys.executable, script, image, "--address", "10.0.2.16", "--out", second], check=True, capture_output=True)
            with EmulatedBoard(image) as board, EmulatedBoard(second, address="10.0.2.16:5000") as other:
                sessions = [Session(self.datagrams(board), 51), Session(self.datagrams(other), 52)]
                for session in sessions:
                    session.hello()
                answers = [[session.step(step, inputs(step))[:-1] for session in sessions] for step in range(5)]
                for number in range(2):
                    self.assertEqual([both[number] for both in answers], self.expected(5))
                for session in sessions:
                    session.goodbye()
                self.assertEqual([board.wait(), other.wait()], [0, 0])
                self.assertIn("10.0.2.16:5000", other.console())

    def test_debugger(self):
        """jtag.gdb through a debug server: the image arrives whole, starts and flies."""
        if shutil.which("gdb-multiarch") is None:
            self.skipTest("gdb-multiarch is not installed")
        script = os.path.join(os.path.dirname(__file__), "../../../boards/zynq7000/jtag.gdb")
        with self.example(halted=True) as board:
            loaded = subprocess.run(["gdb-multiarch", "-nx", "-batch", "-ex", "target extended-remote " + board.gdb_socket, "-x", script,
                                     board.image], capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(loaded.returncode, 0, loaded.stderr)
            self.assertIn("Section .text", loaded.stdout)
            self.assertIn("matched.", loaded.stdout)
            self.assertNotIn("MIS-MATCHED", loaded.stdout)
            session = Session(self.datagrams(board), 53)
            session.hello()
            self.check_flight(*fly(session, 5))
            session.goodbye()
            self.assertEqual(board.wait(), 0, board.console())

    def test_flight_image(self):
        """vbar's own flight software starts, answers ticks with telemetry, and stops when told."""
        image = os.path.join(self.image_folder, "vbar_zynq7000.elf")
        with EmulatedBoard(image) as board:
            session = Session(SerialLine(board.serial), 20)
            self.assertIn("zynq7000", session.hello())
            for step in range(3):
                now = START_NS + step * PERIOD_NS
                packets = [Packet(data) for data in session.step(step, [tick(step, now, PERIOD_NS)])]
                self.assertEqual({p.apid & 0x700 for p in packets[:-1]}, {0x500})
                self.assertEqual(StepReport(packets[-1]).step, step)
            session.goodbye()
            self.assertEqual(board.wait(), 0, board.console())

    def test_next_session(self):
        """Where nobody takes the exit, as on silicon: after a goodbye the board serves whoever says hello."""
        with self.example(semihosting=False) as board:
            session = Session(SerialLine(board.serial), 17)
            session.hello()
            self.check_flight(*fly(session, 5))
            session.goodbye()
            session = Session(self.datagrams(board), 18)
            session.hello()
            self.check_flight(*fly(session, 5))
            self.assertIsNone(board.wait(0.2), "the board stopped")

    def test_watchdog(self):
        """A step that does not end: the watchdog resets the board, which says why, and serves the next hello."""
        image = os.path.join(self.image_folder, "vbar_zynq7000_overrunning.elf")

        def short_steps(session):
            for step in range(3):
                report = StepReport(Packet(session.step(step, [tick(step, 1000, PERIOD_NS)])[-1]))
                self.assertEqual(report.step, step)

        for make_line in (lambda board: SerialLine(board.serial), self.datagrams):
            with EmulatedBoard(image) as board:
                session = Session(make_line(board), 41)
                self.assertEqual(session.hello(step_budget=10_000_000), "vbar zynq7000, bare metal")
                short_steps(session)
                session.send_step(3, [tick(3, 2**60, PERIOD_NS)])
                answer = None
                for _ in range(session.TRIES):
                    answer = session.next_frame(session.PATIENCE_S)
                    if answer is not None:
                        break
                    session.line.send(frame(POLL, session.number, 3, 0))
                self.assertEqual((answer.kind, answer.session), (HELLO_ACK, session.number))
                self.assertIn(b"error: its watchdog reset it in step 3,", answer.payload)
                session.drain()
                session = Session(session.line, 42)
                self.assertEqual(session.hello(), "vbar zynq7000, bare metal, reset by its watchdog")
                short_steps(session)
                session.goodbye()
                self.assertEqual(board.wait(), 0, board.console())
                self.assertEqual(board.console().count("ready"), 2)

    def test_image_check(self):
        """The check after each link passes the flight image, and bites on one in which something asks for memory."""
        check = os.path.join(os.path.dirname(__file__), "../../../boards/zynq7000/check_image.cmake")
        with tempfile.TemporaryDirectory() as folder:
            def result(image):
                copy = shutil.copy(os.path.join(self.image_folder, image), folder)  # the check removes what it condemns
                command = ["cmake", "-DNM=arm-none-eabi-nm", "-DIMAGE=" + copy, "-P", check]
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                return done.returncode, done.stderr, os.path.exists(copy)
            self.assertEqual(result("vbar_zynq7000.elf"), (0, "", True))
            code, message, remains = result("vbar_zynq7000_selftest.elf")
            self.assertNotEqual(code, 0)
            self.assertIn("_Znaj", message)  # operator new[], which the self-test calls to see it trapped
            self.assertFalse(remains)

    def test_boot_image(self):
        """BOOT.BIN by boot.bif: a partition for each segment of the flight image, byte for byte, loaded where it was linked."""
        if shutil.which("bootgen") is None:
            self.skipTest("bootgen is not installed (xilinx-bootgen)")
        image = os.path.join(self.image_folder, "vbar_zynq7000.elf")
        with tempfile.TemporaryDirectory(prefix="vbar-zynq-") as folder:
            shutil.copy(os.path.join(os.path.dirname(__file__), "../../../boards/zynq7000/boot.bif"), folder)
            shutil.copy(image, folder)
            # In place of a loader: a loop in on-chip memory.
            subprocess.run(["arm-none-eabi-gcc", "-mcpu=cortex-a9", "-nostdlib", "-Wl,-Ttext=0", "-x", "assembler", "-o", "fsbl.elf", "-"],
                           input=".global _start\n_start: b _start\n", text=True, cwd=folder, check=True)
            subprocess.run(["bootgen", "-arch", "zynq", "-image", "boot.bif", "-o", "BOOT.BIN"], cwd=folder, check=True, capture_output=True)
            with open(os.path.join(folder, "BOOT.BIN"), "rb") as file:
                boot = file.read()
        entry, segments = loaded_segments(image)
        # Zynq-7000 Technical Reference Manual (UG585), section 6.3.2, and the partition headers of bootgen's guide (UG1283).
        self.assertEqual(struct.unpack_from("<I4s", boot, 0x20), (0xAA995566, b"XNLX"))
        headers, = struct.unpack_from("<I", boot, 0x9C)
        self.assertEqual(len(segments), 2)  # code and constants, initial values of data
        for number, (address, content) in enumerate(segments):
            _, _, words, load, start, offset = struct.unpack_from("<6I", boot, headers + 64 * (number + 1))
            self.assertEqual((load, 4 * words), (address, len(content) + -len(content) % 4))
            self.assertEqual(boot[4 * offset:4 * offset + len(content)], content)
            self.assertEqual(start, entry if number == 0 else 0)

    def test_processor(self):
        """The self-test on the emulated processor, then each fault: caught, named, and an exit code of its own."""
        image = os.path.join(self.image_folder, "vbar_zynq7000_selftest.elf")
        cases = {"": (0, "self-test passed"), "heap": (99, "HALT heap call"), "undefined": (101, "FAULT undefined"),
                 "jump": (102, "FAULT prefetch abort pc=03f00000"), "null": (103, "dfar=00000000"),
                 "code": (103, "dfar=00100000"), "stack": (103, "sp=03eff")}
        for name, (code, text) in cases.items():
            arguments = ["selftest", name] if name else ["selftest"]
            with self.subTest(name), EmulatedBoard(image, arguments=arguments) as board:
                self.assertEqual(board.wait(), code, board.console())
                self.assertIn(text, board.console())
                if not name:
                    self.check_verification(board.console())

    def check_verification(self, console):
        """The emulated timer counts every 10 ns, and an instruction takes 32 (icount shift 5)."""
        ticks = int(re.search(r"verification of a telecommand: (\d+) counts", console).group(1))
        instructions = ticks * 10 // 32
        print(f"verification of a telecommand of 1376 bytes: {instructions} instructions")
        self.assertGreater(instructions, 10_000)  # 23 blocks of 64 rounds, and not nothing
        self.assertLessEqual(instructions, 200_000)

    def test_telecommand_key(self):
        """A copy of the image with a key demands trailers, and neither the copy nor the console shows its key to others."""
        image = os.path.join(self.image_folder, "vbar_zynq7000.elf")
        script = os.path.join(os.path.dirname(__file__), "../../../boards/zynq7000/set_telecommand_key.py")
        with tempfile.TemporaryDirectory(prefix="vbar-zynq-") as folder:
            key, copy = os.path.join(folder, "key"), os.path.join(folder, "keyed.elf")
            digits = os.urandom(32).hex()

            def run(*arguments):
                return subprocess.run([sys.executable, script, *arguments], capture_output=True, text=True)

            def write(text, mode=0o600):
                with open(key, "w", encoding="ascii") as out:
                    out.write(text)
                os.chmod(key, mode)

            self.assertIn("no key", run(image).stdout)
            for text, mode, reason in ((digits[1:], 0o600, "64 hexadecimal digits"), (digits, 0o640, "accessible to others")):
                write(text, mode)
                refused = run(image, "--key", key, "--out", copy)
                self.assertEqual((refused.returncode, os.path.exists(copy)), (1, False))
                self.assertIn(reason, refused.stderr)
            write(digits + "\n")
            made = run(image, "--key", key, "--out", copy)
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertIn("index 1", made.stdout + run(copy).stdout)
            self.assertEqual(os.stat(copy).st_mode & 0o077, 0)
            with EmulatedBoard(copy) as board:
                session = Session(SerialLine(board.serial), 13)
                self.assertTrue(session.hello().endswith("telecommands authenticated"))
                session.goodbye()
                self.assertEqual(board.wait(), 0, board.console())
                self.assertNotIn(digits, board.console() + made.stdout)


def main():
    ZynqSmoke.image_folder, ZynqSmoke.host_library = sys.argv[1:3]
    images = ("vbar_zynq7000.elf", "vbar_zynq7000_example.elf", "vbar_zynq7000_overrunning.elf",
              "vbar_zynq7000_selftest.elf")
    needed = [os.path.join(sys.argv[1], image) for image in images] + [sys.argv[2]]
    missing = [path for path in needed if not os.path.exists(path)]
    if missing or shutil.which("qemu-system-arm") is None:
        print("skipped, missing:", " ".join(missing) or "qemu-system-arm")
        return 77
    suite = unittest.main(argv=[sys.argv[0], "-v"] + sys.argv[3:], exit=False)
    if suite.result.skipped and len(suite.result.skipped) == suite.result.testsRun:
        return 77
    return 0 if suite.result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
