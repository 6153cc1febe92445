"""The exchange of a run of vbar with a sensor in Python, over the line that `testbed.external` hands to its program.

    import vbar_sensor
    vbar_sensor.serve(MySensor)

MySensor(start, header) is made once, of the source_start and of the spacecraft and unit in the headers of its packets. It has two
functions: first_epoch_ns(start_of_run_ns), and measure(time_ns, states, earth, commands), which returns the messages and the time of the next
epoch, or None after the last. All times are GPS time in ns. `states` maps spacecraft numbers to true_state, `commands` are pairs
of the time from which one holds and its packet. Messages are the classes that lcm-gen makes of vbar.lcm.
"""
import binascii
import socket
import struct
import zlib

import vbar
from vbar_apids import APIDS

NAMES = {apid: name for name, apid in APIDS.items()}
HELLO, HELLO_ACK, DATA, ACK, POLL, GOODBYE = 1, 2, 3, 4, 5, 6
WINDOW = 32  # packets without acknowledgement


def cobs_encoded(data):
    blocks = []
    for zero_free in data.split(b"\0"):
        while len(zero_free) >= 254:
            blocks.append(b"\xff" + zero_free[:254])
            zero_free = zero_free[254:]
        blocks.append(bytes([len(zero_free) + 1]) + zero_free)
    return b"".join(blocks) + b"\0"


def cobs_decoded(code):
    data, at = bytearray(), 0
    while at < len(code):
        size = code[at]
        data += code[at + 1:at + size]
        at += size
        if size < 255 and at < len(code):
            data.append(0)
    return bytes(data)


class Line:
    """Frames of fsw/link/frame.h over the stream at a descriptor."""

    def __init__(self, descriptor=3):
        self.stream = socket.socket(fileno=descriptor)
        self.received = b""

    def frames(self):
        while True:
            while b"\0" in self.received:
                code, self.received = self.received.split(b"\0", 1)
                frame = cobs_decoded(code)
                if len(frame) >= 18 and zlib.crc32(frame[:-4]) == struct.unpack("<I", frame[-4:])[0]:
                    kind, session, step, index, flags = struct.unpack(">xBIIHBx", frame[:14])
                    yield kind, session, step, index, flags, frame[14:-4]
            more = self.stream.recv(65536)
            if not more:
                raise SystemExit("the run has closed the line")
            self.received += more

    def send(self, kind, session, step, index, flags, payload=b""):
        frame = struct.pack(">BBIIHBx", 1, kind, session, step, index, flags) + payload
        self.stream.sendall(cobs_encoded(frame + struct.pack("<I", zlib.crc32(frame))))


def packet_of(message, time_ns, spacecraft, unit, count):
    payload = message.encode()
    apid = APIDS[type(message).__name__]
    type_bit = 0x1000 if apid < 0x400 else 0
    head = struct.pack(">HHHqBB", type_bit | 0x0800 | apid, 0xC000 | (count & 0x3FFF), len(payload) + 11, time_ns, spacecraft, unit)
    return head + payload + struct.pack(">H", binascii.crc_hqx(head + payload, 0xFFFF))


class Served:
    """Answers batches with the messages of the sensor."""

    def __init__(self, make):
        self.make, self.sensor, self.counts = make, None, {}

    def answer(self, batch):
        start, states, earth, commands = None, {}, None, []
        for packet in batch:
            apid = struct.unpack(">H", packet[:2])[0] & 0x7FF
            time_ns, spacecraft, unit = struct.unpack(">qBB", packet[6:16])
            name = NAMES[apid]
            message = getattr(vbar, name).decode(packet[16:-2])
            if name == "source_start":
                start = message
                self.header = (spacecraft, unit)
            elif name == "true_state":
                states[spacecraft] = message
            elif name == "true_earth":
                earth = message
            elif name == "source_command":
                commands.append((message.effective_ns, bytes(message.packet[:message.count])))
        answer = vbar.source_answer()
        answer.available_ns = time_ns
        if start is not None:
            self.sensor = self.make(start, self.header)
            messages, answer.next_epoch_ns = [], self.sensor.first_epoch_ns(time_ns)
        else:
            messages, next_epoch_ns = self.sensor.measure(time_ns, states, earth, commands)
            answer.next_epoch_ns = next_epoch_ns or 0
        return [self.numbered(message, time_ns) for message in [*messages, answer]]

    def numbered(self, message, time_ns):
        name = type(message).__name__
        self.counts[name] = self.counts.get(name, -1) + 1
        return packet_of(message, time_ns, *self.header, self.counts[name])


def send_window(line, session, step, answer, first, acknowledged):
    """Sends the packets of an answer from `first` on, as far as the window allows; where the next begins."""
    end = min(len(answer), acknowledged + WINDOW)
    for k in range(first, end):
        line.send(DATA, session, step, k, int(k + 1 == len(answer)), answer[k])
    return max(first, end)


def serve(make, name="sensor in Python"):
    """Until the goodbye of the run."""
    line, served = Line(), Served(make)
    batch, answer, answered, sent = [], [], None, 0
    for kind, session, step, index, flags, payload in line.frames():
        if kind == HELLO:
            line.send(HELLO_ACK, session, 0, 0, 0, name.encode())
        elif kind == GOODBYE:
            return
        elif kind == DATA and step != answered and index == len(batch):
            batch.append(payload)
            if flags & 1:
                answer, batch, answered = served.answer(batch), [], step
                sent = send_window(line, session, step, answer, 0, 0)
            elif flags & 2 or len(batch) % (WINDOW // 2) == 0:
                line.send(ACK, session, step, len(batch), 0)
        elif kind == ACK and step == answered:
            sent = send_window(line, session, step, answer, sent, index)
        elif kind == POLL and step == answered:
            sent = send_window(line, session, step, answer, index, index)
