#!/usr/bin/env python3
"""Shows or changes the network addresses of an image for the Zynq-7000 (.elf, or .bin made from it).

    set_address.py IMAGE                                             shows them
    set_address.py IMAGE --address 10.0.2.16 [--port 5000] [--mac 02:76:0a:00:02:10] --out COPY

Without --mac the Ethernet address is 02:76 and the four bytes of the IP address, so that boards with different IP addresses have
different Ethernet addresses. network_settings.h defines the bytes.
"""
import argparse
import ipaddress
import pathlib
import re
import sys

LABEL = b"vbarnet1"
MAC, ADDRESS, PORT = slice(8, 14), slice(14, 18), slice(18, 20)
SIZE = PORT.stop


class SettingsError(Exception):
    pass


def place_of(image, name):
    """Of the settings in the bytes of an image."""
    first = image.find(LABEL)
    if first < 0 or len(image) < first + SIZE:
        raise SettingsError(f"{name}: no network settings; an image of vbar for the Zynq-7000 has them")
    if image.find(LABEL, first + 1) >= 0:
        raise SettingsError(f"{name}: network settings twice; this is not one image")
    return first


def mac_of(text):
    if not re.fullmatch(r"[0-9a-fA-F]{2}(:[0-9a-fA-F]{2}){5}", text):
        raise argparse.ArgumentTypeError(f"{text}: six bytes like 02:76:0a:00:02:10 are expected")
    mac = bytes.fromhex(text.replace(":", ""))
    if mac[0] & 1 or not any(mac):
        raise argparse.ArgumentTypeError(f"{text}: a group address, or none")
    return mac


def address_of(text):
    try:
        address = ipaddress.IPv4Address(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: not an IPv4 address") from None
    if address.is_multicast or address.is_unspecified or address.is_loopback or address == ipaddress.IPv4Address("255.255.255.255"):
        raise argparse.ArgumentTypeError(f"{text}: not the address of one host on a network")
    return address.packed


def port_of(text):
    if not text.isdecimal() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"{text}: accepted is 1 to 65535")
    return int(text)


def line_of(settings):
    address, port = ipaddress.IPv4Address(bytes(settings[ADDRESS])), int.from_bytes(settings[PORT], "big")
    return f"{address}:{port}, Ethernet {settings[MAC].hex(':')}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image", type=pathlib.Path)
    parser.add_argument("--address", type=address_of)
    parser.add_argument("--port", type=port_of)
    parser.add_argument("--mac", type=mac_of)
    parser.add_argument("--out", type=pathlib.Path, help="the changed copy")
    options = parser.parse_args()
    changes = (options.address, options.port, options.mac)
    if any(changes) != bool(options.out):
        parser.error("--out names the copy that gets --address, --port or --mac")
    try:
        image = bytearray(options.image.read_bytes())
        at = place_of(image, options.image)
        settings = image[at:at + SIZE]
        if options.address:
            settings[ADDRESS] = options.address
            settings[MAC] = b"\x02\x76" + options.address
        if options.mac:
            settings[MAC] = options.mac
        if options.port:
            settings[PORT] = options.port.to_bytes(2, "big")
        image[at:at + SIZE] = settings
        if options.out:
            options.out.write_bytes(image)
            options.out.chmod(options.image.stat().st_mode & 0o777)
        print(f"{options.out or options.image}: {line_of(settings)}")
    except (OSError, SettingsError) as error:
        print(f"set_address.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
