#!/usr/bin/env python3
"""vbar check: runs judged by the limits of their mission, as a CI uses it."""
import unittest
import xml.etree.ElementTree

from vbar_program import fly, main, scratch, summary_of, vbar

SHORT = "mission.duration_h=1"
MET, REFUSED, MISSED, NOT_ACHIEVED = 0, 2, 11, 12


def limits(*tables):
    return "limit=[" + ", ".join(tables) + "]"


class Check(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())
        cls.run_folder = cls.folder / "flown"
        fly(cls.run_folder, SHORT, limits('{key="navigation_error_mean_m", most=1000.0}', '{key="dv_mps", least=0.0, most=10.0}'))

    def check(self, *arguments, expected):
        result = vbar("check", *arguments)
        self.assertEqual(result.returncode, expected, result.stdout + result.stderr)
        return result

    def limits_file(self, text):
        file = self.folder / "limits.toml"
        file.write_text(text)
        return file

    def test_limits_of_the_runs_own_mission(self):
        result = self.check(self.run_folder, expected=MET)
        self.assertIn("navigation_error_mean_m", result.stdout)
        self.assertNotIn("MISSED", result.stdout)

    def test_a_run_prints_how_it_stands_to_its_limits(self):
        def printed(*settings, expected=MET):
            result = vbar("run", "ideal_navigation", "--force", "--out", self.folder / "printed",
                          *(argument for setting in (SHORT, *settings) for argument in ("--set", setting)))
            self.assertEqual(result.returncode, expected, result.stderr)
            return result.stdout
        found = printed(limits('{key="navigation_error_mean_m", most=1000.0}', '{key="dv_mps", least=1e6}'), expected=NOT_ACHIEVED)
        self.assertRegex(found, r"(?m)^  met +navigation_error_mean_m ")
        self.assertRegex(found, r"(?m)^  MISSED dv_mps +.*not at least 1e\+06")
        self.assertNotIn("limits", printed())

    def test_a_missed_limit_and_a_missing_number_fail(self):
        error = summary_of(self.run_folder)["navigation_error_m"]["mean"]
        file = self.limits_file(f'[[limit]]\nkey = "navigation_error_mean_m"\nmost = {0.5 * error:e}\n'
                                '[[limit]]\nkey = "navigation_eror_mean_m"\nmost = 1.0\n')
        result = self.check(self.run_folder, "--limits", file, expected=MISSED)
        self.assertIn("did you mean navigation_error_mean_m?", result.stdout)
        self.assertEqual(result.stdout.count("MISSED"), 2)

    def test_junit_of_several_runs(self):
        file = self.limits_file('[[limit]]\nkey = "dv_mps"\nleast = 1e6\n')
        report = self.folder / "junit.xml"
        self.check(self.run_folder, self.run_folder, "--limits", file, "--junit", report, expected=MISSED)
        suites = xml.etree.ElementTree.parse(report).getroot()
        self.assertEqual(suites.tag, "testsuites")
        self.assertEqual([(s.get("tests"), s.get("failures")) for s in suites], [("2", "1"), ("2", "1")])
        failed = suites[0].findall("testcase[@name='dv_mps']/failure")
        self.assertIn("not at least 1e+06", failed[0].get("message"))

    def test_numbers_are_those_that_a_limit_can_name(self):
        numbers = self.check(self.run_folder, "--numbers", expected=MET).stdout.splitlines()
        keys = [line.split(" = ")[0] for line in numbers]
        self.assertIn("navigation_error_mean_m", keys)
        file = self.limits_file("".join(f'[[limit]]\nkey = "{key}"\nleast = -1e300\n' for key in keys))
        self.check(self.run_folder, "--limits", file, expected=MET)
        self.assertIn("--numbers", self.check(self.run_folder, "--limits", file, "--numbers", expected=REFUSED).stderr)

    def test_an_interrupted_run_fails_whatever_its_numbers(self):
        cut = self.folder / "cut"
        fly(cut, SHORT)
        summary = cut / "summary.json"
        summary.write_text(summary.read_text().replace('"complete": true', '"complete": false'))
        file = self.limits_file('[[limit]]\nkey = "dv_mps"\nleast = 0.0\n')
        self.assertIn("did not reach its end", self.check(cut, "--limits", file, expected=MISSED).stdout)

    def test_nothing_to_judge_is_refused(self):
        bare = self.folder / "bare"
        fly(bare, SHORT)
        self.assertIn("no [[limit]]", self.check(bare, expected=REFUSED).stderr)
        self.assertIn("summary.json", self.check(self.folder, expected=REFUSED).stderr)
        file = self.limits_file('[[limit]]\nkey = "dv_mps"\n')
        self.assertIn("neither most nor least", self.check(bare, "--limits", file, expected=REFUSED).stderr)


if __name__ == "__main__":
    main()
