"""Messages of Protocol Buffers by the standard library: descriptors of what a file holds, and their encoding.

A schema is {message: [(field, number, kind)]}: kind is a scalar type, the full name of another message, or {label: value} of an
enumeration; behind "repeated " there are any number of them.
"""
import struct

SCALARS = {"double": 1, "int64": 3, "int32": 5, "fixed32": 7, "bool": 8, "string": 9, "bytes": 12}
MESSAGE, ENUM = 11, 14
VARINT, FIXED64, LENGTH, FIXED32 = 0, 1, 2, 5


def varint(value):
    value &= (1 << 64) - 1
    data = bytearray()
    while value > 0x7F:
        data.append(value & 0x7F | 0x80)
        value >>= 7
    data.append(value)
    return bytes(data)


def key(number, wire):
    return varint(number << 3 | wire)


def piece(number, data):
    """A field of bytes, of text or of an encoded message."""
    data = data.encode() if isinstance(data, str) else data
    return key(number, LENGTH) + varint(len(data)) + data


def whole(number, value):
    return key(number, VARINT) + varint(value)


class Schema:
    def __init__(self, messages, prefix_of_files=""):
        self.messages = messages
        self.prefix = prefix_of_files

    def encode(self, message, values):
        """The bytes of a message; a field that `values` lacks is left out."""
        data = b""
        for field, number, kind in self.messages[message]:
            if field not in values:
                continue
            repeated = isinstance(kind, str) and kind.startswith("repeated ")
            for value in values[field] if repeated else [values[field]]:
                data += self._field(number, kind.removeprefix("repeated ") if repeated else kind, value)
        return data

    def _field(self, number, kind, value):
        if isinstance(kind, dict):
            return whole(number, kind[value])
        if kind == "double":
            return key(number, FIXED64) + struct.pack("<d", value)
        if kind == "fixed32":
            return key(number, FIXED32) + struct.pack("<I", value)
        if kind in ("int32", "int64", "bool"):
            return whole(number, int(value))
        return piece(number, value if kind in ("string", "bytes") else self.encode(kind, value))

    def _needed(self, message, found):
        if message not in found:
            found.append(message)
            for _, _, kind in self.messages[message]:
                if isinstance(kind, str) and (kind := kind.removeprefix("repeated ")) not in SCALARS:
                    self._needed(kind, found)
        return found

    @staticmethod
    def _file(message):
        package, _, name = message.rpartition(".")
        name = name.lower() if package == "google.protobuf" else name
        return f"{package.replace('.', '/')}/{name}.proto"

    def _descriptor(self, message):
        """FileDescriptorProto of a file with this message alone."""
        package, _, name = message.rpartition(".")
        fields, enums, others = b"", b"", []
        for field, number, kind in self.messages[message]:
            repeated = isinstance(kind, str) and kind.startswith("repeated ")
            kind = kind.removeprefix("repeated ") if repeated else kind
            text = piece(1, field) + whole(3, number) + whole(4, 3 if repeated else 1)
            if isinstance(kind, dict):
                text += whole(5, ENUM) + piece(6, f".{message}.{field.capitalize()}")
                enums += piece(4, piece(1, field.capitalize()) + b"".join(
                    piece(2, piece(1, label) + whole(2, value)) for label, value in kind.items()))
            elif kind in SCALARS:
                text += whole(5, SCALARS[kind])
            else:
                text += whole(5, MESSAGE) + piece(6, f".{kind}")
                others.append(kind)
            fields += piece(2, text)
        imports = b"".join(piece(3, self._file(other)) for other in dict.fromkeys(others) if other != message)
        return piece(1, self._file(message)) + piece(2, package) + imports + piece(4, piece(1, name) + fields + enums) + piece(12, "proto3")

    def descriptor_set(self, message):
        """FileDescriptorSet of a message and of all that it needs, those first."""
        return b"".join(piece(1, self._descriptor(needed)) for needed in reversed(self._needed(message, [])))
