"""The server's side of a WebSocket connection (RFC 6455), for messages that fit into memory."""
import base64
import hashlib
import select
import struct

KEY_SUFFIX = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # section 1.3
CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0, 1, 2, 8, 9, 10
MOST_BYTES = 1 << 20  # of a message of the client


class Closed(Exception):
    """code of the closing frame, reason"""


def accept_key(key):
    return base64.b64encode(hashlib.sha1((key + KEY_SUFFIX).encode()).digest()).decode()


def frame(opcode, data):
    size = len(data)
    head = bytes([0x80 | opcode, size]) if size < 126 else struct.pack(">BBH", 0x80 | opcode, 126, size) if size < 1 << 16 else \
        struct.pack(">BBQ", 0x80 | opcode, 127, size)
    return head + data


def take_frame(buffer):
    """(is the last of its message, opcode, data) of the first frame, which is removed from the buffer; None if it is not whole yet."""
    if len(buffer) < 2:
        return None
    first, second = buffer[0], buffer[1]
    if first & 0x70 or not second & 0x80:
        raise Closed(1002, "frames of a client are masked and have no extension")
    size, at = second & 0x7F, 2
    if size >= 126:
        at = 4 if size == 126 else 10
        if len(buffer) < at:
            return None
        size = int.from_bytes(buffer[2:at], "big")
    if size > MOST_BYTES:
        raise Closed(1009, f"a message has at most {MOST_BYTES} bytes")
    if len(buffer) < at + 4 + size:
        return None
    mask, data = buffer[at:at + 4], bytes(buffer[at + 4:at + 4 + size])
    del buffer[:at + 4 + size]
    repeated = (bytes(mask) * (size // 4 + 1))[:size]
    return bool(first & 0x80), first & 0x0F, (int.from_bytes(data, "big") ^ int.from_bytes(repeated, "big")).to_bytes(size, "big")


class Connection:
    def __init__(self, socket):
        self.socket, self.buffer, self.parts, self.kind = socket, bytearray(), bytearray(), TEXT

    def send(self, opcode, data):
        self.socket.sendall(frame(opcode, data))

    def close(self, code, reason):
        self.send(CLOSE, struct.pack(">H", code) + reason.encode()[:120])

    def receive(self, wait_s):
        """The whole messages (opcode, data) that came within that time, as soon as there is one. Raises Closed when the client closes, or does what it must not."""
        if not select.select([self.socket], [], [], wait_s)[0]:
            return []
        data = self.socket.recv(1 << 16)
        if not data:
            raise Closed(1006, "the connection ended")
        self.buffer += data
        messages = []
        while (taken := take_frame(self.buffer)) is not None:
            is_last, opcode, data = taken
            if opcode == CLOSE:
                raise Closed(1000, "closed by the client")
            if opcode == PING:
                self.send(PONG, data)
            elif opcode in (TEXT, BINARY, CONTINUATION):
                self.kind = opcode or self.kind
                self.parts += data
                if len(self.parts) > MOST_BYTES:
                    raise Closed(1009, f"a message has at most {MOST_BYTES} bytes")
                if is_last:
                    messages.append((self.kind, bytes(self.parts)))
                    self.parts.clear()
        return messages
