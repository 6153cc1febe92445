"""vbar xtce: the packets of vbar.lcm as a database of XTCE 1.2 (OMG), for ground systems that decode space packets by it.

One SpaceSystem for each spacecraft, in it one for each message, whose parameters have the names of the columns of the tables: equal
parameters of two spacecraft stay apart. A container of a message inherits that of the space packet, and is chosen by the
APID, the number of the spacecraft and the hash of the message's type.
"""
import argparse
import re
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import vbar
from vbar import message_fields

sys.path.append(str(Path(__file__).resolve().parent.parent))
from vbar_apids import APIDS  # noqa: E402

NAMESPACE = "http://www.omg.org/spec/XTCE/20180204"
SIZES = {"byte": 8, "int8_t": 8, "int16_t": 16, "int32_t": 32, "int64_t": 64, "float": 32, "double": 64}
HEADER = (("version", 3, "of the space packet: 0"), ("type", 1, "1: to the flight software, 0: from it"), ("secondary_header", 1, "1"),
          ("apid", 11, "kind of message"), ("sequence_flags", 2, "3: whole message; 1, 0, 2: first, middle, last segment"),
          ("sequence_count", 14, "of the packets of an APID, wraps"), ("length", 16, "bytes after this field, less one"),
          ("time_gps_ns", -64, "GPS time since 1980-01-06: of what, vbar.lcm states for each message"),
          ("spacecraft", 8, "number of the spacecraft"), ("unit", 8, "index of the sensor or actuator of its kind"),
          ("type_hash", 64, "of the message's type, which changes with its fields"))
UNITS = {"mps": "m/s", "radps": "rad/s", "m2": "m2", "px2": "px2"}


class Field:
    """A field of a message: its type, its size and what its comment states."""

    def __init__(self, struct, name, kind, count, comment, structs):
        self.name, self.kind, self.count = name, kind, count
        unit = message_fields.UNIT.search(comment)
        self.unit = (unit[1] if unit else "").strip()
        self.elements = (unit[2] or "").split() if unit else []
        stem, _, last = name.rpartition("_")
        self.stem, self.ending = name, self.unit.replace("/", "p")
        if last in message_fields.UNITS_IN_NAMES and self.ending in ("", last):
            self.stem, self.ending, self.unit = stem, last, UNITS.get(last, last)
        self.codes = message_fields.code_table_of(struct, comment, structs)
        self.meaning = message_fields.CODES.sub("", message_fields.UNIT.sub("", message_fields.CODES.sub("", comment).rstrip()).rstrip()).strip()

    def columns(self):
        """Names of its elements, as the tables have them."""
        ending = f"_{self.ending}" if self.ending else ""
        if self.count is None:
            return [self.stem + ending]
        elements = self.elements if len(self.elements) == self.count else range(self.count)
        return [f"{self.stem}_{element}{ending}" for element in elements]


def layout_of(text):
    """{struct: [(field, type, number of elements or None)]} of vbar.lcm."""
    return {struct: [(match[2], match[1], int(match[3][1:-1]) if match[3] else None)
                     for line in body.split("\n") if (match := message_fields.FIELD.match(line))]
            for struct, body in message_fields.STRUCT.findall(text)}


class Database:
    """The XTCE document, built element by element."""

    def __init__(self, name):
        xml.register_namespace("", NAMESPACE)
        text = (Path(__file__).parent / "vbar.lcm").read_text()
        self.structs = message_fields.structs_of(text)
        self.layout = layout_of(text)
        self.root = self.system(None, name, "Packets of vbar, from vbar.lcm")
        self.types, self.known = self.meta(self.root)
        self.parameters = self.child(self.root[1], "ParameterSet")
        for field, size, meaning in HEADER:
            self.parameter(self.parameters, field, self.integer(abs(size), size < 0, "ns" if size < 0 else ""), meaning)
        self.parameter(self.parameters, "crc", self.integer(16, False, ""), "CRC-16/CCITT-FALSE over all bytes before it")
        container = self.child(self.child(self.root[1], "ContainerSet"), "SequenceContainer", name="packet", abstract="true")
        entries = self.child(container, "EntryList")
        for field, _, _ in HEADER:
            self.child(entries, "ParameterRefEntry", parameterRef=field)

    @staticmethod
    def child(parent, tag, text=None, **attributes):
        element = xml.SubElement(parent, f"{{{NAMESPACE}}}{tag}", attributes)
        element.text = text
        return element

    def system(self, parent, name, description):
        tag, attributes = f"{{{NAMESPACE}}}SpaceSystem", {"name": name, "shortDescription": description}
        return xml.Element(tag, attributes) if parent is None else xml.SubElement(parent, tag, attributes)

    def meta(self, system):
        self.child(system, "Header", version="1", date="1980-01-06", validationStatus="Working")
        telemetry = self.child(system, "TelemetryMetaData")
        return self.child(telemetry, "ParameterTypeSet"), {}

    def new_type(self, name, tag, unit, **attributes):
        """The element of a type that is not there yet, with its unit; None for a known one."""
        if name in self.known:
            return None
        self.known[name] = element = self.child(self.types, tag, name=name, **attributes)
        units = self.child(element, "UnitSet")
        if unit:
            self.child(units, "Unit", unit)
        return element

    @staticmethod
    def type_name(*parts):
        return "_".join(re.sub(r"\W", "", part.replace("/", "p").replace("^", "")) for part in parts if part)

    def encoded(self, element, size, signed):
        self.child(element, "IntegerDataEncoding", sizeInBits=str(size), encoding="twosComplement" if signed else "unsigned")

    def integer(self, size, signed, unit):
        name = self.type_name(f"{'int' if signed else 'uint'}{size}", unit)
        element = self.new_type(name, "IntegerParameterType", unit, signed=str(signed).lower(), sizeInBits=str(size))
        if element is not None:
            self.encoded(element, size, signed)
        return name

    def floating(self, size, unit):
        name = self.type_name(f"float{size}", unit)
        element = self.new_type(name, "FloatParameterType", unit, sizeInBits=str(size))
        if element is not None:
            self.child(element, "FloatDataEncoding", sizeInBits=str(size), encoding="IEEE754_1985")
        return name

    def binary(self, size):
        name = f"binary{size}"
        element = self.new_type(name, "BinaryParameterType", "")
        if element is not None:
            self.child(self.child(self.child(element, "BinaryDataEncoding"), "SizeInBits"), "FixedValue", str(size))
        return name

    def enumeration(self, name, size, signed, values, alarm=None):
        element = self.new_type(name, "EnumeratedParameterType", "")
        if element is not None:
            self.encoded(element, size, signed)
            labels = self.child(element, "EnumerationList")
            for value, label, meaning in values:
                self.child(labels, "Enumeration", value=str(value), label=label, **({"shortDescription": meaning} if meaning else {}))
            if alarm:
                alarms = self.child(self.child(element, "DefaultAlarm"), "EnumerationAlarmList")
                self.child(alarms, "EnumerationAlarm", alarmLevel="warning", enumerationLabel=alarm)
        return name

    def parameter(self, parameters, name, kind, meaning):
        self.child(parameters, "Parameter", name=name, parameterTypeRef=kind if parameters is self.parameters else f"/{self.root.get('name')}/{kind}",
                   **({"shortDescription": meaning} if meaning else {}))

    def values_of(self, field):
        """(value, word, meaning) of the codes of a field."""
        _, owner, prefix, constants = field.codes
        message = getattr(vbar, owner)
        return [(getattr(message, constant), message_fields.words_of(constant, prefix), " ".join(comment.partition("Turn:")[0].split()))
                for constant, comment in constants]

    def entries_of(self, field):
        """(name, type, meaning) of the parameters of a field, in the order of their bits."""
        size = SIZES[field.kind]
        if field.kind == "byte":
            return [(field.name, self.binary(8 * (field.count or 1)), field.meaning)]
        if field.codes and field.codes[0]:
            words = {value.bit_length() - 1 if value > 0 else size - 1: (word, meaning) for value, word, meaning in self.values_of(field)}
            kind = self.enumeration("flag", 1, False, ((0, "clear", ""), (1, "set", "")), alarm="set")
            return [(f"{field.name}_{words[bit][0]}" if bit in words else f"{field.name}_bit_{bit}", kind, words.get(bit, ("", ""))[1])
                    for bit in reversed(range(size))]
        if field.codes:
            kind = self.enumeration(f"{field.codes[1]}_{field.codes[2]}_{size}", size, True, self.values_of(field))
        elif field.kind in ("float", "double"):
            kind = self.floating(size, field.unit)
        else:
            kind = self.integer(size, True, field.unit)
        return [(column, kind, field.meaning) for column in field.columns()]

    def fields_of(self, struct, prefix=""):
        """The parameters of a message; those of a message inside it have its name and number before theirs."""
        comments = dict(self.structs[struct][1])
        for name, kind, count in self.layout[struct]:
            if kind in SIZES:
                field = Field(struct, name, kind, count, comments[name], self.structs)
                yield from ((prefix + column, type_name, meaning) for column, type_name, meaning in self.entries_of(field))
            else:
                for k in range(count):
                    yield from self.fields_of(kind, f"{prefix}{name}_{k}_")

    def add_spacecraft(self, name, number):
        craft = self.system(self.root, name, f"spacecraft number {number} of the packets' headers")
        for message, apid in APIDS.items():
            system = self.system(craft, message, f"APID {apid:#05x}")
            telemetry = self.child(system, "TelemetryMetaData")
            parameters = self.child(telemetry, "ParameterSet")
            container = self.child(self.child(telemetry, "ContainerSet"), "SequenceContainer", name=message)
            entries = self.child(container, "EntryList")
            for column, kind, meaning in self.fields_of(message):
                self.parameter(parameters, column, kind, meaning)
                self.child(entries, "ParameterRefEntry", parameterRef=column)
            root = self.root.get("name")
            self.child(entries, "ParameterRefEntry", parameterRef=f"/{root}/crc")
            criteria = self.child(self.child(container, "BaseContainer", containerRef=f"/{root}/packet"), "RestrictionCriteria")
            comparisons = self.child(criteria, "ComparisonList")
            type_hash = int.from_bytes(getattr(vbar, message)._get_packed_fingerprint(), "big")
            for field, value in (("apid", apid), ("spacecraft", number), ("type_hash", type_hash)):
                self.child(comparisons, "Comparison", parameterRef=f"/{root}/{field}", value=str(value), useCalibratedValue="false")

    def text(self):
        xml.indent(self.root)
        return '<?xml version="1.0" encoding="UTF-8"?>\n' + xml.tostring(self.root, encoding="unicode") + "\n"


def spacecraft(text):
    name, equals, number = text.partition("=")
    if not equals or not re.fullmatch(r"\w+", name) or not number.isdecimal() or not 0 <= int(number) <= 255:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a name of letters, digits and underscores, and a number from 0 to 255, as servicer=1")
    return name, int(number)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="vbar xtce", description="write the packets of vbar.lcm as an XTCE 1.2 database to standard output")
    parser.add_argument("--spacecraft", action="append", type=spacecraft, metavar="NAME=NUMBER",
                        help="a SpaceSystem of this name for the packets of this number; default servicer=1; may be repeated")
    options = parser.parse_args(arguments)
    crafts = options.spacecraft or [("servicer", 1)]
    for what, values in (("name", [name for name, _ in crafts]), ("number", [number for _, number in crafts])):
        if len(set(values)) != len(values):
            parser.error(f"--spacecraft: two spacecraft have one {what}")
    database = Database("vbar")
    for name, number in crafts:
        database.add_spacecraft(name, number)
    sys.stdout.write(database.text())
    return 0
