"""A decoder of space packets that has nothing but an XTCE file: containers by inheritance and restriction, parameters bit by bit."""
import struct
import xml.etree.ElementTree as xml

N = "{http://www.omg.org/spec/XTCE/20180204}"


class Decoder:
    def __init__(self, file):
        self.types, self.parameters, self.containers, self.units = {}, {}, {}, {}
        self._read(xml.parse(file).getroot(), "")
        self.children = {}
        for path, (_, base, criteria) in self.containers.items():
            self.children.setdefault(base, []).append((criteria, path))

    def _read(self, system, above):
        path = f"{above}/{system.get('name')}"
        telemetry = system.find(f"{N}TelemetryMetaData")
        for element in telemetry.find(f"{N}ParameterTypeSet") or () if telemetry is not None else ():
            name = f"{path}/{element.get('name')}"
            assert name not in self.types, name
            self.types[name] = self._reader_of(element)
            self.units[name] = "".join(unit.text for unit in element.find(f"{N}UnitSet"))
        for element in telemetry.find(f"{N}ParameterSet") or () if telemetry is not None else ():
            name = f"{path}/{element.get('name')}"
            assert name not in self.parameters, name
            self.parameters[name] = self._absolute(element.get("parameterTypeRef"), path)
        for element in telemetry.find(f"{N}ContainerSet") or () if telemetry is not None else ():
            entries = [self._absolute(entry.get("parameterRef"), path) for entry in element.find(f"{N}EntryList")]
            base, criteria = element.find(f"{N}BaseContainer"), []
            if base is not None:
                for comparison in base.iter(f"{N}Comparison"):
                    criteria.append((self._absolute(comparison.get("parameterRef"), path), int(comparison.get("value"))))
            self.containers[f"{path}/{element.get('name')}"] = entries, base is not None and self._absolute(base.get("containerRef"), path), criteria
        for child in system.findall(f"{N}SpaceSystem"):
            self._read(child, path)

    @staticmethod
    def _absolute(reference, path):
        return reference if reference.startswith("/") else f"{path}/{reference}"

    @staticmethod
    def _reader_of(element):
        """(bits, function of an integer of so many bits)"""
        kind = element.tag.removeprefix(N)
        if kind == "BinaryParameterType":
            bits = int(next(element.iter(f"{N}FixedValue")).text)
            return bits, lambda raw: raw.to_bytes(bits // 8, "big")
        encoding = element.find(f"{N}FloatDataEncoding" if kind == "FloatParameterType" else f"{N}IntegerDataEncoding")
        bits = int(encoding.get("sizeInBits"))
        if kind == "FloatParameterType":
            form = {32: ">f", 64: ">d"}[bits]
            return bits, lambda raw: struct.unpack(form, raw.to_bytes(bits // 8, "big"))[0]
        signed = encoding.get("encoding") == "twosComplement"
        words = {int(value.get("value")): value.get("label") for value in element.iter(f"{N}Enumeration")}

        def number(raw):
            value = raw - (1 << bits) if signed and raw >> bits - 1 else raw
            return words.get(value, value)
        return bits, number

    def decode(self, packet, root="/vbar/packet"):
        """(path of the container, {path of the parameter: value}); the most special container whose restrictions hold."""
        whole, at, values, container = int.from_bytes(packet, "big"), 0, {}, root
        while True:
            for parameter in self.containers[container][0]:
                bits, value_of = self.types[self.parameters[parameter]]
                at += bits
                values[parameter] = value_of(whole >> 8 * len(packet) - at & (1 << bits) - 1)
            found = [path for criteria, path in self.children.get(container, ()) if all(values[name] == value for name, value in criteria)]
            if not found:
                assert container == root or at == 8 * len(packet), f"{container}: {at} of {8 * len(packet)} bits"
                return container, values
            assert len(found) == 1, found
            container = found[0]
