"""CRC-16/CCITT-FALSE and CRC-32 against python3-crcmod. Usage: check_crcmod.py TOOL"""

import sys

from peer import ask, expect, random_buffers, skip

try:
    from crcmod.predefined import mkPredefinedCrcFun
except ImportError:
    skip("python3-crcmod is not installed")


def main():
    crc16 = mkPredefinedCrcFun("crc-ccitt-false")
    crc32 = mkPredefinedCrcFun("crc-32")
    buffers = [b"", b"123456789"] + list(random_buffers(400, 1400))
    answers = ask(sys.argv[1], "checksums", [data.hex() for data in buffers])
    expect(len(answers) == len(buffers), "one answer a line")
    for data, answer in zip(buffers, answers):
        expect(answer == f"{crc16(data)} {crc32(data)}", f"{data.hex()}: {answer}")
    print(f"{len(buffers)} buffers agree")


main()
