#!/usr/bin/env python3
"""vbar completion: the scripts for bash and zsh, as these shells use them."""
import shutil
import subprocess
import unittest

from vbar_program import VBAR, main, scratch, vbar

# What readline does with a line that ends at the cursor: "=" parts words.
COMPLETE = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_vbar
printf '%s\\n' "${COMPREPLY[@]}"
"""


class Completion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.scripts = {}
        for shell in ("bash", "zsh"):
            made = vbar("completion", shell)
            assert made.returncode == 0, made.stderr
            cls.scripts[shell] = cls.folder / shell
            cls.scripts[shell].write_text(made.stdout)

    def completed(self, *words):
        (self.folder / "mine.toml").touch()
        result = subprocess.run(["bash", "-c", COMPLETE, "bash", str(self.scripts["bash"]), str(VBAR), *words], cwd=self.folder,
                                capture_output=True, text=True, timeout=60, check=True)
        self.assertEqual(result.stderr, "")
        return result.stdout.split()

    def test_commands(self):
        self.assertEqual(self.completed("prop"), ["propagate"])
        self.assertEqual(self.completed("campaign", "re"), ["report", "rerun"])
        self.assertIn("completion", self.completed(""))

    def test_options_are_those_of_the_command(self):
        self.assertEqual(self.completed("run", "--se"), ["--seed", "--set"])
        self.assertEqual(self.completed("campaign", "run", "x.toml", "--j"), ["--jobs"])
        for option in self.completed("replay", "--"):
            self.assertIn(option, vbar("replay", "--help").stdout)

    def test_missions_and_files(self):
        self.assertEqual(self.completed("run", "experiment3_g"), ["experiment3_grand", "experiment3_grand_gnss_sdr", "experiment3_grand_live"])
        self.assertEqual(self.completed("run", "--seed", "3", "mi"), ["mine.toml"])
        self.assertEqual(self.completed("run", "--out", "mi"), ["mine.toml"])
        self.assertNotIn("experiment3", self.completed("report", "ex"))

    def test_keys_after_set_are_those_of_the_mission(self):
        self.assertEqual(self.completed("run", "experiment3", "--set", "links.crosslink.lo"), ["links.crosslink.loss_probability="])
        self.assertEqual(self.completed("run", "experiment3", "--set", "mission.seed", "=", "3", "--set", "flight_computer.ta"),
                         ["flight_computer.target="])
        self.assertEqual(self.completed("run", "experiment1", "--set", "camera.exposure_"), ["camera.exposure_s="])
        self.assertEqual(self.completed("run", "no_such_mission", "--set", "links."), [])

    def test_every_key_that_is_offered_can_be_set(self):
        """Refused, if at all, for its value: no key is unknown."""
        for mission in ("ideal_navigation", "full_range_faults"):
            keys = vbar("completion", "keys", mission).stdout.split()
            self.assertGreater(len(keys), 100)
            for key in keys[::9]:
                answer = vbar("run", mission, "--check", "--set", key + "nonsense").stderr
                for no_place in ("unknown key", "a path ", "nothing, the mission file has no"):
                    self.assertNotIn(no_place, answer, key)

    def test_zsh_accepts_its_script(self):
        self.assertTrue(self.scripts["zsh"].read_text().startswith("#compdef vbar\n"))
        if shutil.which("zsh") is None:
            self.skipTest("zsh is not installed")
        subprocess.run(["zsh", "-n", self.scripts["zsh"]], check=True, timeout=60)


if __name__ == "__main__":
    main()
