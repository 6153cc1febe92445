"""A neighbour of the board on the wire: Ethernet frames from the RFCs, as bytes."""

import select
import struct

MAC, BOARD_MAC = bytes.fromhex("525400123456"), bytes.fromhex("027662617215")
ADDRESS, BOARD_ADDRESS = bytes([10, 0, 2, 2]), bytes([10, 0, 2, 15])
ICMP, UDP = 1, 17
ECHO_REPLY, ECHO_REQUEST = 0, 8


def internet_checksum(data):
    """RFC 1071, as a remainder: ones' complement addition is addition modulo 65535."""
    total = sum(struct.unpack(f">{(len(data) + 1) // 2}H", data + b"\0" * (len(data) % 2)))
    return 65535 - (0 if total == 0 else (total - 1) % 65535 + 1)


ARP_FIXED = struct.pack(">HHHBB", 0x0806, 1, 0x0800, 6, 4)
ARP_REQUEST = b"\xff" * 6 + MAC + ARP_FIXED + b"\0\1" + MAC + ADDRESS + bytes(6) + BOARD_ADDRESS
ARP_REPLY = MAC + BOARD_MAC + ARP_FIXED + b"\0\2" + BOARD_MAC + BOARD_ADDRESS + MAC + ADDRESS


def ipv4(protocol, payload, fragment=0):
    """A frame to the board."""
    head = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(payload), 1, fragment, 64, protocol, 0) + ADDRESS + BOARD_ADDRESS
    head = head[:10] + struct.pack(">H", internet_checksum(head)) + head[12:]
    return (BOARD_MAC + MAC + b"\x08\0" + head + payload).ljust(60, b"\0")


def echo(kind, body):
    head = struct.pack(">BBHHH", kind, 0, 0, 7, 9)
    return struct.pack(">BBHHH", kind, 0, internet_checksum(head + body), 7, 9) + body


class Neighbour:
    """Sends and receives frames over an EmulatedBoard with raw_ethernet."""

    def __init__(self, board):
        self.wire, self.peer = board.frames, ("127.0.0.1", board.udp_port)

    def send(self, frame):
        self.wire.sendto(frame, self.peer)

    def receive(self, timeout=5):
        """The next frame, or None."""
        return self.wire.recv(2000) if select.select([self.wire], [], [], timeout)[0] else None

    def resolve(self):
        """Asks for the board's address until it answers; the answer."""
        for _ in range(40):
            self.send(ARP_REQUEST)
            answer = self.receive(0.5)
            if answer is not None:
                while self.receive(0.2) is not None:
                    pass  # late answers
                return answer
        raise TimeoutError("nobody answers ARP")
