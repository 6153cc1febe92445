#!/usr/bin/env python3
"""Verdicts on missions: one short flight for each of them, its exit code, last line, summary and page; and the words that a run prints."""
import unittest

from vbar_program import BINARY, SOURCE, fly, main, missing, overrides, scratch, summary_of, vbar

ACHIEVED, FAILED, REFUSED, NEVER_NAVIGATED, NOT_ACHIEVED = 0, 1, 2, 10, 12
EXPERIMENT3 = "experiment3"


def last_line(result):
    """Of the terminal, where standard error follows standard output."""
    return (result.stdout + result.stderr).rstrip("\n").rsplit("\n", 1)[-1]


class Verdict(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(scratch())

    def judge(self, word, code, *settings, mission="ideal_navigation"):
        """Flies, compares word and exit code everywhere, and returns the sentence."""
        folder = self.folder / "run"
        result = vbar("run", mission, "--force", "--out", folder, *overrides(*settings))
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        summary = summary_of(folder)
        self.assertEqual(summary["verdict"], word, summary["verdict_reason"])
        begin = "verdict" if code == ACHIEVED else f"vbar: {folder}:"
        self.assertEqual(last_line(result), f"{begin} {word}: {summary['verdict_reason']}")
        self.assertIn(f">{word}</span>", (folder / "report.html").read_text())
        return summary["verdict_reason"]

    def test_achieved(self):
        self.assertRegex(self.judge("achieved", ACHIEVED, "mission.duration_h=6.1"),
                         r"^1 waypoint reached, largest control error 0\.\d+ m at waypoint 1; the run ended at 6\.100 h, before waypoint 2$")

    def test_achieved_with_faults(self):
        fault = 'fault=[{kind="silent", unit="gnss", spacecraft="target", at_h=39.5, for_s=60.0}]'
        self.assertIn("faults: 1 injected", self.judge("achieved with faults", ACHIEVED, "mission.duration_h=1", fault, mission=EXPERIMENT3))

    def test_not_judged(self):
        self.assertIn("before waypoint 1", self.judge("not judged", ACHIEVED, "mission.duration_h=0.3"))

    def test_missed_because_no_burn_is_small_enough(self):
        reason = self.judge("missed", NOT_ACHIEVED, "mission.duration_h=6.1", "guidance.dv_max_mps=0.02")
        self.assertRegex(reason, r"waypoint 1 by \S+ m \(\S+ m accepted\); no burn was flown, guidance refused every plan \d+ times: "
                                 r"a burn above guidance\.dv_max_mps = 0\.02 m/s is refused whole")
        self.assertEqual(summary_of(self.folder / "run")["missed_waypoints"], [1])

    def test_missed_by_flight_software_that_cannot_close_the_distance(self):
        library = BINARY / "libvbar_example_article.so"
        if missing(library):
            self.skipTest(missing(library))
        self.assertIn("waypoint 1 by", self.judge("missed", NOT_ACHIEVED, f"flight_computer.library={library}", "mission.duration_h=6.1"))

    def test_a_limit_replaces_a_criterion(self):
        wide = 'limit=[{key="waypoints.1.control_error_m", most=1e6}]'
        short = ("mission.duration_h=6.1",)
        self.judge("achieved", ACHIEVED, *short, wide)
        tight = 'limit=[{key="waypoints.1.control_error_m", most=1e-6}]'
        self.assertIn("waypoints.1.control_error_m", self.judge("missed", NOT_ACHIEVED, *short, tight))

    def test_navigation_lost(self):
        """A computer that starts again without its state, seconds before a waypoint."""
        fault = 'fault=[{kind="computer_reboot", at_h=39.9972, for_s=5.0}]'
        self.assertRegex(self.judge("navigation lost", NOT_ACHIEVED, "mission.duration_h=1.02", fault, mission=EXPERIMENT3),
                         r"^at (39\.99|40\.00)\d h, no valid estimate at waypoint 9")

    def test_retreated(self):
        """An uncommanded burn of 10 mm/s, 10 m from the target."""
        fault = 'fault=[{kind="thrust_uncommanded", at_h=39.05, for_s=10.0, value_mps2=1e-3, direction_rtn=[0.0, 1.0, 0.0]}]'
        self.assertRegex(self.judge("retreated", NOT_ACHIEVED, "mission.duration_h=0.3", "safety.contact_distance_m=2", fault, mission=EXPERIMENT3),
                         r"^at 39\.\d+ h")

    def test_unsafe(self):
        """Waypoint 8 is some 10 m from the target."""
        self.assertRegex(self.judge("unsafe", NOT_ACHIEVED, "mission.duration_h=0.1", "guidance.keep_out_radius_m=20", mission=EXPERIMENT3),
                         r"^true distance \S+ m at 39\.\d+ h, keep-out radius 20 m")

    def test_never_navigated(self):
        """Angles-only navigation needs more images than there are in 0.2 h."""
        self.assertIn("no estimate was valid",
                      self.judge("never navigated", NEVER_NAVIGATED, "mission.duration_h=0.2", "guidance.navigation_timeout_s=300", mission="experiment1"))

    def test_a_resumed_report_keeps_the_verdict(self):
        self.judge("achieved", ACHIEVED, "mission.duration_h=6.1")
        before = summary_of(self.folder / "run")["verdict_reason"]
        printed = vbar("report", self.folder / "run")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        self.assertEqual(last_line(printed), f"verdict achieved: {before}")


class Answers(unittest.TestCase):
    """Flight software that answers nothing usable is not complete."""

    LIBRARY = BINARY / "tests" / "unit" / "pil_bridge" / "libvbar_article_with_faults.so"

    def test_status_garbage_and_silence(self):
        if missing(self.LIBRARY):
            self.skipTest(missing(self.LIBRARY))
        for fault, sentence in ((6, "the flight software failed at each of its 7 steps, the last with status 12345"),
                                (10, "none of the 21 packets of the flight software in 7 steps could be read"),
                                (9, "the flight software answered none of its 7 steps with a packet")):
            with self.subTest(sentence), scratch() as folder:
                result = vbar("run", "ideal_navigation", "--out", folder / "run",
                              *overrides("mission.duration_h=0.1", f"flight_computer.library={self.LIBRARY}",
                                         f"spacecraft.servicer.number={fault}", "spacecraft.target.number=30"))
                self.assertEqual(result.returncode, FAILED, result.stdout + result.stderr)
                self.assertEqual(last_line(result), f"vbar: {folder / 'run'}: run incomplete: {sentence}")
                summary = summary_of(folder / "run")
                self.assertEqual((summary["complete"], summary["verdict"], summary["incomplete_reason"]), (False, "incomplete", sentence))
                self.assertEqual(summary["flight_output"]["steps"], 7)


class Explain(unittest.TestCase):
    def test_page_is_what_the_program_prints(self):
        printed = vbar("explain", "--markdown")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        self.assertEqual(printed.stdout, (SOURCE / "docs/words.md").read_text(), "renew it: build/host/vbar explain --markdown > docs/words.md")

    def test_a_fault_has_meaning_response_and_keys(self):
        result = vbar("explain", "navigation_timeout")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("navigation_timeout: fault in telemetry_health", result.stdout)
        self.assertIn("    meaning   the estimate is valid, but", result.stdout)
        self.assertIn("    response  the flight software reports it", result.stdout)
        self.assertIn("guidance.navigation_timeout_s", result.stdout)

    def test_a_word_of_two_tables_is_explained_in_both(self):
        found = vbar("explain", "retreat").stdout
        self.assertIn("retreat: fault in telemetry_health", found)
        self.assertIn("retreat: mode in mode_command", found)

    def test_words_with_blanks_as_the_terminal_prints_them(self):
        for words in (("solver", "fallbacks"), ("solver fallbacks",), ("navigation lost",)):
            self.assertEqual(vbar("explain", *words).returncode, 0, words)

    def test_an_unknown_word_is_answered_with_the_nearest(self):
        result = vbar("explain", "navigation_timout")
        self.assertEqual((result.returncode, result.stdout), (REFUSED, ""))
        self.assertIn("did you mean navigation_timeout?", result.stderr)

    def test_columns_point_to_the_explanation_of_a_value(self):
        result = vbar("columns", "navigation_timeout")
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn("it is a value: vbar explain navigation_timeout", result.stderr)

    def test_every_word_of_a_run_is_explained(self):
        """Of the line on the terminal and of the faults in the summary."""
        with scratch() as folder:
            summary = fly(folder / "run", "mission.duration_h=6.1", "guidance.dv_max_mps=0.02")
            words = [*summary["health"]["faults"], *(key for key, value in summary["health"].items() if isinstance(value, int) and key != "step")]
        self.assertIn("hold", words)
        for word in words:
            self.assertEqual(vbar("explain", word).returncode, 0, word)


if __name__ == "__main__":
    main()
