#!/usr/bin/env python3
"""vbar verify: rows that are campaigns, one JSON for a commit, pages and comparisons that are made of it.

    test_verify.py CLASS...
"""
import json
import re
import shutil
import unittest

from vbar_program import SOURCE, main, scratch, vbar

# Half an hour of experiment 3: errors of the position by the unknown offset of the phase centres, those of the velocity by its noise.
ROW = """[campaign]
name = "{name}"
description = "Half an hour by carrier phase"
mission = "{mission}"
seeds = "{seeds}"
set = ["mission.duration_h=0.5"{set}]
expected_case_s = 0.5

[[pass]]
key = "min_distance_m"
least = {least}

[[require]]
key = "navigation_error_mean_m"
statistic = "median"
most = 0.01
paper = "table_10.sil.whole.navigation_error_mean_m"

[[require]]
key = "navigation_velocity_error_mean_mps"
statistic = "median"
most = 2.4e-5
"""


def write_row(folder, name, seeds="1..10", setting="", least=3.0):
    folder.mkdir(parents=True, exist_ok=True)
    text = ROW.format(name=name, mission=SOURCE / "missions/experiment3.toml", seeds=seeds, set=setting, least=least)
    (folder / f"{name}.toml").write_text(text)
    return folder


def verify(missions, to, *arguments):
    return vbar("verify", "--missions", missions, "--to", to, "--jobs", 2, *arguments)


def record(to):
    return json.loads((to / "verification.json").read_text())


class Verify(unittest.TestCase):
    """A row is flown in parts; its later cases do not change the earlier ones."""

    def test_a_budget_is_kept_and_the_rest_follows(self):
        with scratch() as folder:
            missions = write_row(folder / "missions", "row")
            listed = vbar("verify", "--missions", missions, "--list")
            self.assertIn("Half an hour by carrier phase", listed.stdout)
            # 3 seeds of 0.5 s by two jobs in 0.75 s.
            first = verify(missions, folder / "to", "--budget", 0.0125)
            self.assertEqual(first.returncode, 0, first.stdout + first.stderr)
            part = record(folder / "to")["rows"][0]
            self.assertEqual((part["seeds_flown"], part["seeds_asked"], part["cases_flown"]), (3, 10, 3))
            self.assertTrue(part["requirements"][0]["met"])
            second = verify(missions, folder / "to")
            self.assertEqual(second.returncode, 0, second.stdout + second.stderr)
            whole = record(folder / "to")["rows"][0]
            self.assertEqual(whole["seeds_flown"], 10)
            self.assertEqual(whole["quantities"][0]["values"][:3], part["quantities"][0]["values"])
            self.assertEqual(whole["requirements"][0]["paper"]["value"], 8.721e-3)
            self.assertGreater(whole["core_hours"], part["core_hours"])

    def test_a_broken_run_fails_and_its_command_is_named(self):
        with scratch() as folder:
            missions = write_row(folder / "missions", "row", "1..2", least=1000.0)
            result = verify(missions, folder / "to")
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("cases that keep all limits", result.stdout)
            row = record(folder / "to")["rows"][0]
            self.assertIn("vbar run experiment3 --seed 1 --set 'mission.duration_h=0.5'",
                          [one["command"] for one in row["not_achieved"]])

    def test_wrong_input_is_refused(self):
        with scratch() as folder:
            missions = write_row(folder / "missions", "row")
            unknown = verify(missions, folder / "to", "rows")
            self.assertEqual(unknown.returncode, 2)
            self.assertIn("accepted: row", unknown.stderr)
            self.assertFalse((folder / "to").exists())
            (folder / "bad.json").write_text('{"format": 1, "rows": 3}')
            bad = vbar("verify", "--page", folder / "bad.json", "--docs", folder)
            self.assertNotEqual(bad.returncode, 0)
            self.assertIn("bad.json", bad.stderr)


class VerifyCompare(unittest.TestCase):
    """A phase centre whose noise is twice as large is noticed among ten seeds of each; other seeds of the same program are not."""

    def test_an_injected_regression_is_named_and_other_seeds_are_not(self):
        with scratch() as folder:
            for name, seeds, setting in (("before", "1..10", ""), ("same", "101..110", ""),
                                         ("worse", "201..210", ', "gnss.body_frame.pco_noise_mm=2.0"')):
                flown = verify(write_row(folder / name, "row", seeds, setting), folder / "to" / name)
                self.assertIn(flown.returncode, (0, 1), flown.stderr)
            earlier = folder / "to/before/verification.json"
            same = vbar("verify", "--compare", earlier, folder / "to/same/verification.json")
            self.assertEqual(same.returncode, 0, same.stdout)
            worse = vbar("verify", "--compare", earlier, folder / "to/worse/verification.json")
            self.assertEqual(worse.returncode, 1, worse.stdout)
            self.assertIn("worse: row: navigation_velocity_error_mean_mps", worse.stdout)


class VerifiedFigures(unittest.TestCase):
    """Figures of README.md and docs that stand in docs/verification.json are those of it."""

    def written(self, folder, edit=lambda text: text, page="README.md"):
        """The files that --page changes in copies, one of which was edited."""
        shutil.copy(SOURCE / "README.md", folder)
        shutil.copytree(SOURCE / "docs", folder / "docs", ignore=lambda _, names: [n for n in names if not n.endswith(".md")])
        file = folder / page
        before = file.read_text()
        file.write_text(edit(before))
        if file.read_text() != edit(before):
            raise AssertionError("the edit was lost")
        result = vbar("verify", "--page", SOURCE / "docs/verification.json", "--docs", folder / "docs")
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def test_all_pages_have_the_figures_of_the_json(self):
        with scratch() as folder:
            self.assertEqual(self.written(folder), "", "vbar verify --page docs/verification.json")

    def test_a_figure_changed_by_hand_is_noticed(self):
        changed = lambda text: re.sub(r"\d(?=<!-- v:)", lambda digit: str((int(digit[0]) + 1) % 10), text, count=1)
        with scratch() as folder:
            self.assertIn("README.md", self.written(folder, changed))

    def test_a_cell_changed_by_hand_is_noticed(self):
        with scratch() as folder:
            self.assertIn("verification.md", self.written(folder, lambda text: text.replace("| not flown |", "| flown |", 1),
                                                          "docs/verification.md"))


if __name__ == "__main__":
    main()
