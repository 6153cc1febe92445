#!/usr/bin/env python3
"""What the programs load, and which of them flies a mission with a display, cameras or robots."""
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import unittest

from vbar_program import BINARY, MISSION, SOURCE, VBAR, main, scratch, vbar

VBAR_HIL = BINARY / "vbar_hil"
HIL_MISSION = SOURCE / "missions" / "experiment1_hil.toml"
MAX_LIBRARIES = 40  # of vbar, the loader included
# Displays, sound, desktop, cameras, fits, compilers: as the names of their libraries begin.
BALLAST = re.compile(r"lib(X\w*|xcb\w*|wayland\w*|pulse\w*|asound|glib|gio|gobject|aravis|usb|SDL\w*|ceres|opencv\w*|OSMesa|LLVM|lcm)\b", re.IGNORECASE)


def libraries_of(program):
    listed = subprocess.run(["ldd", str(program)], capture_output=True, text=True, check=True).stdout
    return [line.split()[0].rsplit("/", 1)[-1] for line in listed.splitlines() if line.strip()]


class Libraries(unittest.TestCase):
    def test_vbar_is_without_ballast(self):
        libraries = libraries_of(VBAR)
        self.assertIn("libc.so.6", libraries)
        self.assertEqual([name for name in libraries if BALLAST.match(name)], [])
        self.assertLessEqual(len(libraries), MAX_LIBRARIES, libraries)

    def test_the_pattern_finds_ballast(self):
        if not VBAR_HIL.exists():
            self.skipTest("vbar_hil is not built")
        self.assertTrue(any(BALLAST.match(name) for name in libraries_of(VBAR_HIL)))

    def test_an_image_names_the_library_that_is_missing(self):
        """A file of another kind in its place: the run is refused before it has a folder, or ends with the reason."""
        with scratch() as folder:
            (folder / "libOSMesa.so.8").write_text("no library\n")
            result = vbar("run", SOURCE / "missions/experiment2.toml", "--set", "mission.duration_h=0.01", "--out", folder / "run",
                          LD_LIBRARY_PATH=folder)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn("libOSMesa.so.8", result.stderr)
            self.assertIn("(Debian package libosmesa6)", result.stderr)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)

    def test_the_bus_names_the_library_that_is_missing(self):
        with scratch() as folder:
            (folder / "liblcm.so.1").write_text("no library\n")
            result = vbar("run", SOURCE / "missions/ideal_navigation.toml", "--set", "mission.duration_h=0.1", "--set", "lcm.mirror=true",
                          "--out", folder / "run", LD_LIBRARY_PATH=folder)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn("liblcm.so.1", result.stderr)
            self.assertIn("(lcm.url) needs it (Debian package liblcm1)", result.stderr)


class BenchMissions(unittest.TestCase):
    """vbar leaves a mission with a bench to vbar_hil beside it, and refuses it where there is none."""

    def setUp(self):
        if not VBAR_HIL.exists():
            self.skipTest("vbar_hil is not built")

    def test_vbar_hil_takes_the_command(self):
        """Only the driver itself has the keys of its table."""
        arguments = ("run", HIL_MISSION, "--check", "--set", "testbed.optical_stimulator.unheard_of=1")
        result = vbar(*arguments)
        self.assertEqual(result.returncode, 2)
        self.assertIn("testbed.optical_stimulator.unheard_of: found an unknown key", result.stderr)
        own = subprocess.run([str(VBAR_HIL), *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (own.returncode, own.stdout, own.stderr))

    def test_alone_vbar_refuses_in_one_sentence(self):
        with scratch() as folder:
            shutil.copy(VBAR, folder / "vbar")
            alone = [str(folder / "vbar")]
            environment = os.environ | {"VBAR_DATA": str(SOURCE / "data")}
            for command in (["run", HIL_MISSION, "--check"], ["run", HIL_MISSION, "--out", folder / "run"], ["propagate", HIL_MISSION]):
                result = subprocess.run(alone + [str(word) for word in command], capture_output=True, text=True, env=environment, cwd=folder)
                self.assertEqual(result.returncode, 2, command)
                self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
                for words in ("experiment1_hil.toml", "testbed.optical_stimulator", "vbar_hil", "ci/install.sh test", "libaravis-dev"):
                    self.assertIn(words, result.stderr)
            self.assertEqual(sorted(path.name for path in folder.iterdir()), ["vbar"])
            # What needs no driver stays with vbar.
            checked = subprocess.run(alone + ["run", str(SOURCE / "missions/ideal_navigation.toml"), "--check"], capture_output=True, text=True,
                                     env=environment)
            self.assertEqual(checked.returncode, 0, checked.stderr)


class StartedByLoader(unittest.TestCase):
    """As in a portable bundle: the system's loader is the program, and vbar its argument."""

    def test_vbar_finds_itself_and_the_programs_beside_it(self):
        loader = next(word for word in subprocess.run(["ldd", str(VBAR)], capture_output=True, text=True, check=True).stdout.split()
                      if word.startswith("/") and "ld-linux" in word)
        with scratch() as folder:
            # Its own folder as that of the libraries, as there: the loader searches the system's after it.
            private = pathlib.Path(shutil.copy(loader, folder))
            flown = subprocess.run([str(private), str(VBAR), "run", str(MISSION), "--quiet", "--out", str(folder / "run"), "--set",
                                    "mission.duration_h=1", "--set", "flight_computer.target=host_process"], capture_output=True, text=True)
            self.assertEqual(flown.returncode, 0, flown.stderr)
            program = hashlib.sha256(VBAR.read_bytes()).hexdigest()
            self.assertIn(program, (folder / "run/summary.json").read_text())
            tron = subprocess.run([str(private), str(VBAR), "tron", "--help"], capture_output=True, text=True)
            self.assertEqual(tron.returncode, 0, tron.stderr)
            self.assertIn("plan", tron.stdout)


if __name__ == "__main__":
    main()
