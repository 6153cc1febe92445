"""What the checks of GigE Vision share: a network of one's own, the emulated camera, and the client."""

import contextlib
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "wire_formats"))
from peer import expect, skip  # noqa: E402,F401

INSIDE = "VBAR_OWN_NETWORK"


def need(*programs):
    """Skips the test if a program is not installed."""
    for program in programs:
        if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin"):
            skip(f"{program} is not installed")


def enter_own_network():
    """Starts this script again in a network namespace with a loopback interface only; skips where that is not allowed."""
    if os.environ.get(INSIDE):
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        return
    need("unshare", "ip")
    options = ["unshare", "-n"] if os.geteuid() == 0 else ["unshare", "-rn"]
    if subprocess.run([*options, "true"], capture_output=True).returncode != 0:
        skip("the kernel refuses a network namespace")
    sys.exit(subprocess.run([*options, sys.executable, *sys.argv], env={**os.environ, INSIDE: "1"}).returncode)


@contextlib.contextmanager
def device(tool, address="127.0.0.1"):
    """The emulated camera, listening."""
    process = subprocess.Popen([tool, "device", address], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        expect(line == "listening\n", f"the emulated camera does not start: {line}")
        yield process
    finally:
        process.stdin.close()
        process.wait(timeout=30)


def take(tool, count, width, height, pixel_format, *more, address="127.0.0.1"):
    """Lines of the client, and its exit code."""
    command = [tool, "take", address, str(count), str(width), str(height), pixel_format, *more]
    result = subprocess.run(command, capture_output=True, text=True, timeout=200)
    return result.returncode, result.stdout.splitlines(), result.stderr


def total(lines, word):
    """The sum of the numbers behind `word` in the lines of images."""
    return sum(int(parts[parts.index(word) + 1]) for parts in (line.split() for line in lines) if parts[0] == "image")
