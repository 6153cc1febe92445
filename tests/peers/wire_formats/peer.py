"""What the peer tests share: running vbar_wire_tool, random bytes from a fixed seed, and skipping."""

import random
import subprocess
import sys

SKIP = 77


def skip(reason):
    """Ends the test as skipped, with its reason."""
    print(f"skipped: {reason}")
    sys.exit(SKIP)


def ask(tool, what, lines=()):
    """The tool's answer to `lines`, line by line."""
    text = "".join(line + "\n" for line in lines)
    answer = subprocess.run([tool, what], input=text, capture_output=True, text=True, check=True)
    return answer.stdout.splitlines()


def random_buffers(count, longest, seed=1):
    """Buffers of every kind: short and long, without zeros, with some, with nothing else."""
    source = random.Random(seed)
    for number in range(count):
        size = source.randrange(longest + 1)
        zeros = (0.0, 0.004, 0.3, 1.0)[number % 4]
        yield bytes(0 if source.random() < zeros else source.randrange(1, 256) for _ in range(size))


def expect(condition, message):
    if not condition:
        print(f"FAILED: {message}")
        sys.exit(1)
