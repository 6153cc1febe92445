"""The vbar program as a user has it: helpers for the tests of this folder."""
import contextlib
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

COMPLETE = (0, 10, 12)  # exit codes of a run that reached its end
SKIP = 77  # ctest's exit code for "cannot be tested here"

SOURCE = pathlib.Path(os.environ["VBAR_SOURCE_DIR"])
BINARY = pathlib.Path(os.environ["VBAR_BINARY_DIR"])
VBAR = BINARY / "vbar"
MISSION = SOURCE / "missions" / "ideal_navigation.toml"
ZYNQ_IMAGE = BINARY.parent / "zynq" / "vbar_zynq7000.elf"
ZYNQ_LINUX_PROGRAM = BINARY.parent / "zynq-linux" / "vbar_flight"


def missing(*files):
    """A sentence about the first of `files` that does not exist, or None."""
    for file in files:
        if not pathlib.Path(file).exists():
            return f"{file} is not built"
    return None


@contextlib.contextmanager
def scratch():
    with tempfile.TemporaryDirectory(prefix="vbar-test-") as folder:
        yield pathlib.Path(folder)


def start(*arguments, **keywords):
    return subprocess.Popen([str(VBAR), *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            **keywords)


def vbar(*arguments, timeout=300, **environment):
    return subprocess.run([str(VBAR), *map(str, arguments)], capture_output=True, text=True, timeout=timeout,
                          env=os.environ | {name: str(value) for name, value in environment.items()})


def overrides(*settings):
    return [part for setting in settings for part in ("--set", setting)]


def fly(folder, *settings, mission=MISSION, timeout=300, **environment):
    """Flies a mission to its end, whatever the verdict on it; its summary."""
    result = vbar("run", mission, "--force", "--out", folder, *overrides(*settings), timeout=timeout, **environment)
    if result.returncode not in COMPLETE:
        raise AssertionError(f"vbar run failed: {result.stderr}")
    return summary_of(folder)


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text())


def hashes(summary):
    return summary["commands_sha256"], summary["telemetry_sha256"]


def children_of(pid):
    """All living descendants of a process."""
    found = []
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            found += [int(child), *children_of(int(child))]
    return found


def is_running(pid):
    try:
        state = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def main():
    """Runs the test case named on the command line; skipped alone means SKIP."""
    result = unittest.main(exit=False, verbosity=2).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIP if result.skipped and len(result.skipped) >= result.testsRun else 0)
