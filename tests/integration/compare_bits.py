#!/usr/bin/env python3
"""usage: compare_bits.py HOST_PROGRAM ARM_LINUX_PROGRAM -- do both print the same digests? 77: cannot be tested here."""
import difflib
import pathlib
import shutil
import subprocess
import sys

host, arm = map(pathlib.Path, sys.argv[1:])
if not arm.exists() or not shutil.which("qemu-arm"):
    print(f"{arm} is not built, or qemu-arm is not installed")
    sys.exit(77)


def lines_of(command):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=100).stdout.splitlines()


here = lines_of([host])
there = lines_of(["qemu-arm", "-L", "/usr/arm-linux-gnueabihf", arm])
differences = list(difflib.unified_diff(here, there, "host", "arm", lineterm=""))
print("\n".join(differences) or f"{len(here)} digests, all the same")
sys.exit(1 if differences or len(here) < 10 else 0)
