#!/usr/bin/env python3
"""Shows whether an image for the Zynq-7000 (.elf, or .bin made from it) has a key of telecommands, or writes one to a copy.

    set_telecommand_key.py IMAGE                                     states whether it has a key, and never which
    set_telecommand_key.py IMAGE --key FILE --out COPY               FILE: 64 hexadecimal digits, accessible to its owner alone

The copy, accessible to its owner alone, accepts authenticated telecommands only: of this key, with index 1, and sent after it was made.
telecommand_key.h defines the bytes.
"""
import argparse
import os
import pathlib
import re
import stat
import sys
import time

LABEL = b"vbarkey1"
INDEX, SEQUENCE, KEY = slice(8, 10), slice(10, 18), slice(18, 50)
SIZE = KEY.stop
HOST_INDEX = 1
GPS_EPOCH_UNIX_NS = 315_964_800 * 10**9


class SettingsError(Exception):
    pass


def place_of(image, name):
    """Of the settings in the bytes of an image."""
    first = image.find(LABEL)
    if first < 0 or len(image) < first + SIZE:
        raise SettingsError(f"{name}: no place for a key; an image of vbar for the Zynq-7000 has one")
    if image.find(LABEL, first + 1) >= 0:
        raise SettingsError(f"{name}: places of keys twice; this is not one image")
    return first


def read_key(file):
    with open(file, encoding="ascii", errors="replace") as opened:
        if stat.S_IMODE(os.fstat(opened.fileno()).st_mode) & 0o077:
            raise SettingsError(f"{file}: accessible to others than its owner (chmod 600)")
        text = opened.read(4096).rstrip()
    if not re.fullmatch(r"[0-9a-fA-F]{64}", text):
        raise SettingsError(f"{file}: 64 hexadecimal digits are expected")
    return bytes.fromhex(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image", type=pathlib.Path)
    parser.add_argument("--key", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--out", type=pathlib.Path, help="the copy that gets the key")
    options = parser.parse_args()
    if bool(options.key) != bool(options.out):
        parser.error("--out names the copy that gets the key of --key")
    try:
        image = bytearray(options.image.read_bytes())
        at = place_of(image, options.image)
        settings = image[at:at + SIZE]
        if options.key:
            settings[KEY] = read_key(options.key)
            settings[INDEX] = HOST_INDEX.to_bytes(2, "big")
            settings[SEQUENCE] = (time.time_ns() - GPS_EPOCH_UNIX_NS).to_bytes(8, "big")
            image[at:at + SIZE] = settings
            options.out.unlink(missing_ok=True)
            descriptor = os.open(options.out, os.O_WRONLY | os.O_CREAT | os.O_EXCL, options.image.stat().st_mode & 0o700)
            with os.fdopen(descriptor, "wb") as out:
                out.write(image)
        index = int.from_bytes(settings[INDEX], "big")
        print(f"{options.out or options.image}: {f'telecommands need its key, index {index}' if index else 'no key, telecommands need none'}")
    except (OSError, SettingsError) as error:
        print(f"set_telecommand_key.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
