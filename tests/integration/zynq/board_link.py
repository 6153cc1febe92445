"""The host's end of the board link, written from fsw/link/frame.h and fsw/packets/packet.h alone: it shares no code
with the flight side, so that a misreading on one side shows on the other."""

import select
import socket
import struct
import zlib

HELLO, HELLO_ACK, DATA, ACK, POLL, GOODBYE, RECEIVER_POLL, RECEIVER_COUNT = 1, 2, 3, 4, 5, 6, 7, 8
LAST, ACKNOWLEDGE_NOW = 1, 2
WINDOW = 32


def frame(kind, session, step=0, index=0, flags=0, payload=b""):
    body = struct.pack(">BBIIHBB", 1, kind, session, step, index, flags, 0) + payload
    return body + struct.pack("<I", zlib.crc32(body))


class Frame:
    """A received frame; raises ValueError if it is not one."""

    def __init__(self, data):
        if len(data) < 18 or struct.unpack("<I", data[-4:])[0] != zlib.crc32(data[:-4]):
            raise ValueError("not a frame: " + data.hex())
        version, self.kind, self.session, self.step, self.index, self.flags, _ = struct.unpack(">BBIIHBB", data[:14])
        if version != 1:
            raise ValueError(f"version {version}")
        self.payload = data[14:-4]


def cobs_encode(data):
    out = bytearray()
    for group in data.split(b"\0"):
        while len(group) >= 254:
            out += b"\xff" + group[:254]
            group = group[254:]
        out += bytes([len(group) + 1]) + group
    return bytes(out) + b"\0"


def cobs_decode(data):
    out = bytearray()
    at = 0
    while at < len(data):
        code = data[at]
        if code == 0 or at + code > len(data):
            raise ValueError("not COBS: " + data.hex())
        out += data[at + 1 : at + code]
        at += code
        if code < 255 and at < len(data):
            out.append(0)
    return bytes(out)


class SerialLine:
    """Frames over a connected stream socket, as over a serial line."""

    def __init__(self, stream):
        self.stream = stream
        self.buffer = b""

    def send(self, data):
        self.stream.sendall(cobs_encode(data))

    def send_raw(self, data):
        self.stream.sendall(data)

    def receive(self, timeout):
        """The next frame's bytes, or None."""
        while b"\0" not in self.buffer:
            if not select.select([self.stream], [], [], timeout)[0]:
                return None
            data = self.stream.recv(65536)
            if not data:
                raise ConnectionError("the emulator closed the line")
            self.buffer += data
        coded, self.buffer = self.buffer.split(b"\0", 1)
        return cobs_decode(coded)


class Datagrams:
    """Frames over UDP."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.peer = ("127.0.0.1", port)

    def send(self, data):
        self.socket.sendto(data, self.peer)

    send_raw = send

    def receive(self, timeout):
        if not select.select([self.socket], [], [], timeout)[0]:
            return None
        return self.socket.recv(65536)

    def close(self):
        self.socket.close()


class Session:
    """A run on a board: hello, steps behind a barrier, goodbye."""

    PATIENCE_S = 0.3
    TRIES = 50

    def __init__(self, line, number, spacecraft=1):
        self.line = line
        self.number = number
        self.spacecraft = spacecraft

    def next_frame(self, timeout):
        data = self.line.receive(timeout)
        return None if data is None else Frame(data)

    def hello(self, receiver_baud=None, step_budget=None):
        """Says hello until somebody answers; the board's name. With a rate, the receiver is wired to the board."""
        payload = bytes([self.spacecraft]) + (b"" if receiver_baud is None else struct.pack(">I", receiver_baud))
        if step_budget is not None:
            payload = struct.pack(">BIQ", self.spacecraft, receiver_baud or 0, step_budget)
        for _ in range(self.TRIES):
            self.line.send(frame(HELLO, self.number, payload=payload))
            answer = self.next_frame(self.PATIENCE_S)
            while answer is not None:
                if answer.kind == HELLO_ACK and answer.session == self.number:
                    self.drain()  # of hellos that were answered late
                    return answer.payload.decode("ascii")
                answer = self.next_frame(self.PATIENCE_S)
        raise TimeoutError("the board does not answer")

    def drain(self):
        while self.next_frame(0.1) is not None:
            pass

    def data(self, step, index, packet, last):
        return frame(DATA, self.number, step, index, LAST if last else 0, packet)

    def send_step(self, step, packets):
        assert len(packets) <= WINDOW
        for index, packet in enumerate(packets):
            self.line.send(self.data(step, index, packet, index + 1 == len(packets)))

    def answer(self, step, acknowledge=True):
        """The board's packets of `step`; polls when nothing comes."""
        packets = []
        for _ in range(self.TRIES):
            received = self.next_frame(self.PATIENCE_S)
            if received is None:
                self.line.send(frame(POLL, self.number, step, len(packets)))
                continue
            if received.kind != DATA or received.step != step or received.index != len(packets):
                continue
            packets.append(received.payload)
            if received.flags & LAST:
                if acknowledge:
                    self.line.send(frame(ACK, self.number, step, len(packets)))
                return packets
            if len(packets) % (WINDOW // 2) == 0 or received.flags & ACKNOWLEDGE_NOW:
                self.line.send(frame(ACK, self.number, step, len(packets)))
        raise TimeoutError(f"no answer to step {step}")

    def step(self, step, packets):
        self.send_step(step, packets)
        return self.answer(step)

    def receiver_count(self):
        """Bytes that the receiver's line has brought to the board."""
        for _ in range(self.TRIES):
            self.line.send(frame(RECEIVER_POLL, self.number))
            received = self.next_frame(self.PATIENCE_S)
            if received is not None and received.kind == RECEIVER_COUNT:
                return struct.unpack(">Q", received.payload)[0]
        raise TimeoutError("the board does not count")

    def goodbye(self):
        self.line.send(frame(GOODBYE, self.number))


# ------------------------------------------------------------------------------------------------------------- packets


def crc16(data):
    """CRC-16/CCITT-FALSE."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1
        crc &= 0xFFFF
    return crc


def telecommand(apid, count, time_ns, spacecraft, payload):
    """A space packet to the flight software."""
    head = struct.pack(">HHH", 0x1800 | apid, 0xC000 | (count & 0x3FFF), 10 + len(payload) + 2 - 1)
    body = head + struct.pack(">qBB", time_ns, spacecraft, 0) + payload
    return body + struct.pack(">H", crc16(body))


class Packet:
    """A space packet from the flight software, checked."""

    def __init__(self, data):
        identification, self.sequence, length = struct.unpack(">HHH", data[:6])
        if length + 7 != len(data) or crc16(data[:-2]) != struct.unpack(">H", data[-2:])[0]:
            raise ValueError("not a packet: " + data.hex())
        self.apid = identification & 0x7FF
        self.time_ns, self.spacecraft, self.unit = struct.unpack(">qBB", data[6:16])
        self.payload = data[16:-2]


# LCM type hashes of fsw/packets/vbar.lcm, from the C++ types that lcm-gen makes of it.
TICK = struct.pack(">Q", 0x864DD63EDF53B0E7)
IDEAL_NAVIGATION = struct.pack(">Q", 0xC7135961C1142A68)
APID_TICK, APID_IDEAL_NAVIGATION = 0x001, 0x010
APID_MANEUVER_COMMAND, APID_TELEMETRY_NAVIGATION, APID_STEP_REPORT, APID_WIRED_BYTES = 0x401, 0x501, 0x601, 0x602


def tick(step, time_ns, period_ns, spacecraft=1):
    return telecommand(APID_TICK, step, time_ns, spacecraft, TICK + struct.pack(">qq", step, period_ns))


def ideal_navigation(step, time_ns, states, spacecraft=1):
    payload = IDEAL_NAVIGATION + struct.pack(">12d", *states)
    return telecommand(APID_IDEAL_NAVIGATION, step, time_ns, spacecraft, payload)


class StepReport:
    def __init__(self, packet):
        (_, self.step, self.unit, self.count, self.stack_bytes, self.received, self.rejected, self.duplicated,
         self.resent, self.packets_dropped, self.ticks_missing) = struct.unpack(">QqbqiiiiIII", packet.payload)


class WiredBytes:
    def __init__(self, packet):
        _, self.received, self.dropped, count, data = struct.unpack(">Qqqi1280s", packet.payload)
        self.data = data[:count]
