"""PPS edges as chronyd sees them.  check_chrony.py PPS_TOOL

chronyd (Debian's package chrony) runs with -x: it never touches the system's clock. The edges lie a known time after whole
seconds of that clock; chronyd has to select them as its source and to report this offset.
"""
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

EDGES = 9
OFFSET_US = 250
# A sample is a difference of two clocks, read one after the other by a program that may be interrupted in between; the
# median of the samples, which chronyd's estimate follows, is much better than this.
TOLERANCE_US = 150.0


def find(program):
    return shutil.which(program) or shutil.which(program, path="/usr/sbin:/sbin")


def query(chronyc, socket, command):
    return subprocess.run([chronyc, "-n", "-c", "-h", socket, command], capture_output=True, text=True, timeout=10).stdout


def start(chronyd, folder):
    config = os.path.join(folder, "chrony.conf")
    with open(config, "w") as file:
        file.write(f"""refclock SOCK {folder}/edges.sock refid VBAR poll 0 filter 1 precision 1e-6
bindcmdaddress {folder}/chronyd.sock
pidfile {folder}/chronyd.pid
cmdport 0
port 0
logdir {folder}
log refclocks
""")
    user = subprocess.run(["id", "-un"], capture_output=True, text=True).stdout.strip()
    log = open(os.path.join(folder, "chronyd.log"), "w")
    return subprocess.Popen([chronyd, "-x", "-U", "-u", user, "-d", "-f", config], stdout=log, stderr=log)


def main():
    tool = sys.argv[1]
    chronyd, chronyc = find("chronyd"), find("chronyc")
    if not chronyd or not chronyc:
        print("skipped: chronyd (Debian's package chrony) is not installed")
        return 77
    # Clients of chronyd require a folder that others cannot write to.
    with tempfile.TemporaryDirectory(prefix="vbar_chrony_") as folder:
        os.chmod(folder, 0o700)
        process = start(chronyd, folder)
        try:
            for _ in range(50):
                if os.path.exists(f"{folder}/edges.sock") or process.poll() is not None:
                    break
                time.sleep(0.1)
            if process.poll() is not None:
                print(f"chronyd has ended with exit status {process.returncode}:\n" + open(f"{folder}/chronyd.log").read())
                return 1
            run = subprocess.run([tool, f"{folder}/pps.sock", f"{folder}/edges.sock", str(EDGES), str(OFFSET_US)],
                                 capture_output=True, text=True, timeout=60)
            sources = query(chronyc, f"{folder}/chronyd.sock", "sources")
        finally:
            process.terminate()
            process.wait()
        samples = open(f"{folder}/refclocks.log").read() if os.path.exists(f"{folder}/refclocks.log") else ""
        print(run.stdout + run.stderr + sources + samples + open(f"{folder}/chronyd.log").read())
    return judge(run, sources, samples)


def judge(run, sources, samples):
    failures = []
    if run.returncode != 0 or int(run.stdout or 0) < EDGES - 1:
        failures.append("not all edges were forwarded")
    if sources.strip().split(",")[:3] != ["#", "*", "VBAR"]:
        failures.append("chronyd has not selected the source")
    # Date, time, source, pulse, leap, position in the filter, raw offset, cooked offset, dispersion. The offset is positive
    # if the system's clock is behind: the edge says that a second begins now, and the system that it began OFFSET_US ago.
    rows = [line.split() for line in samples.splitlines()]
    offsets_us = [1e6 * float(row[6]) for row in rows if len(row) == 9 and row[2] == "VBAR" and row[3].isdigit()]
    if len(offsets_us) < EDGES - 2:
        failures.append(f"chronyd has used {len(offsets_us)} of {EDGES} edges")
    else:
        offset_us = statistics.median(offsets_us)
        print(f"offset {offset_us:.1f} us, {-OFFSET_US} us expected")
        if not abs(offset_us + OFFSET_US) <= TOLERANCE_US:
            failures.append("chronyd reports another offset")
    for failure in failures:
        print("FAILED:", failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
