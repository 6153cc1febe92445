"""The stand-in of a PPS device, as Debian's ppstest (package pps-tools) reads it.  check_ppstest.py SHIM

The unit tests of the kernel's edges rest on the shim; ppstest, which others wrote, must find the same edges in it.
"""
import os
import re
import shutil
import subprocess
import sys


def main():
    ppstest = shutil.which("ppstest")
    if not ppstest:
        print("skipped: ppstest (Debian's package pps-tools) is not installed")
        return 77
    environment = dict(os.environ, LD_PRELOAD=sys.argv[1], VBAR_PPS_PERIOD_MS="50")
    process = subprocess.Popen([ppstest, "/dev/null"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, bufsize=1,
                               env=environment)
    lines = []
    for line in process.stdout:
        lines.append(line)
        if len(lines) == 12:
            break
    process.kill()
    process.wait()
    print("".join(lines))
    edges = [(float(t), int(k)) for t, k in re.findall(r"assert (\d+\.\d+), sequence: (\d+)", "".join(lines))]
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(edges, edges[1:])]
    good = len(edges) >= 6 and all(k >= 1 and abs(t - 0.05 * k) < 1e-6 for t, k in steps)
    if not good:
        print("FAILED: the edges are not 50 ms apart")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
