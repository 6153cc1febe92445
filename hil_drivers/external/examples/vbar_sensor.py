"""The exchange of a run of vbar with a sensor or a truth in Python, over the line that `testbed.external` hands to its program.

    import vbar_sensor
    vbar_sensor.serve(MySensor)

MySensor(start, header) is made once, of the source_start and of the spacecraft and unit in the headers of its packets. It has two
functions: first_epoch_ns(start_of_run_ns), and measure(time_ns, states, earth, commands), which returns the messages and the time of the next
epoch, or None after the last. All times are GPS time in ns. `states` maps spacecraft numbers to true_state, `commands` are pairs
of the time from which one holds and its packet. Messages are the classes that lcm-gen makes of vbar.lcm.

    vbar_sensor.serve_truth(MyTruth)

MyTruth(start, time_ns, states, earth) is made once, with the states from which the spacecraft start. Its function advance(time_ns, commands)
returns pairs of a message and a spacecraft number: a true_state of each spacecraft at that time and, if it has one, a true_earth. `commands`
are what has happened at the present states, in order: tuples of message, time and spacecraft number, of executed_maneuver and pointing_command.
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


def read_packet(packet):
    """Message, time in ns, spacecraft and unit."""
    name = NAMES[struct.unpack(">H", packet[:2])[0] & 0x7FF]
    return getattr(vbar, name).decode(packet[16:-2]), *struct.unpack(">qBB", packet[6:16])


class Batch:
    """What the packets of a batch hold."""

    def __init__(self, packets):
        self.start, self.header, self.states, self.earth, self.commands = None, None, {}, None, []
        for packet in packets:
            message, self.time_ns, spacecraft, unit = read_packet(packet)
            if isinstance(message, vbar.source_start):
                self.start, self.header = message, (spacecraft, unit)
            elif isinstance(message, vbar.true_state):
                self.states[spacecraft] = message
            elif isinstance(message, vbar.true_earth):
                self.earth = message
            elif isinstance(message, vbar.source_command):
                self.commands.append((message.effective_ns, bytes(message.packet[:message.count])))


class Numbered:
    """Makes packets with the sequence counts of their messages."""

    def __init__(self):
        self.counts = {}

    def packet(self, message, time_ns, spacecraft, unit):
        name = type(message).__name__
        self.counts[name] = self.counts.get(name, -1) + 1
        return packet_of(message, time_ns, spacecraft, unit, self.counts[name])


class Served:
    """Answers batches with the messages of the sensor."""

    def __init__(self, make):
        self.make, self.sensor, self.header, self.numbered = make, None, None, Numbered()

    def answer(self, packets):
        batch = Batch(packets)
        answer = vbar.source_answer()
        answer.available_ns = batch.time_ns
        if batch.start is not None:
            self.header = batch.header
            self.sensor = self.make(batch.start, batch.header)
            messages, answer.next_epoch_ns = [], self.sensor.first_epoch_ns(batch.time_ns)
        else:
            messages, next_epoch_ns = self.sensor.measure(batch.time_ns, batch.states, batch.earth, batch.commands)
            answer.next_epoch_ns = next_epoch_ns or 0
        return [self.numbered.packet(message, batch.time_ns, *self.header) for message in [*messages, answer]]


class ServedTruth:
    """Answers batches with the states of all spacecraft."""

    def __init__(self, make):
        self.make, self.truth, self.numbered = make, None, Numbered()

    def answer(self, packets):
        batch = Batch(packets)
        answer = vbar.source_answer()
        answer.available_ns = batch.time_ns
        stated = []
        if batch.start is not None:
            self.truth = self.make(batch.start, batch.time_ns, batch.states, batch.earth)
        else:
            stated = self.truth.advance(batch.time_ns, [read_packet(packet)[:3] for _, packet in batch.commands])
        return [self.numbered.packet(message, batch.time_ns, spacecraft, 0) for message, spacecraft in [*stated, (answer, 0)]]


def send_window(line, session, step, answer, first, acknowledged):
    """Sends the packets of an answer from `first` on, as far as the window allows; where the next begins."""
    end = min(len(answer), acknowledged + WINDOW)
    for k in range(first, end):
        line.send(DATA, session, step, k, int(k + 1 == len(answer)), answer[k])
    return max(first, end)


def serve(make, name="sensor in Python"):
    """Until the goodbye of the run."""
    answer_batches(Served(make), name)


def serve_truth(make, name="truth in Python"):
    """Until the goodbye of the run."""
    answer_batches(ServedTruth(make), name)


def answer_batches(served, name):
    line = Line()
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
