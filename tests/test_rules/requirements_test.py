"""Requirements and their evidence: the page is that of ci/requirements.py, and each kind of broken reference is found. Usage: requirements_test.py ROOT."""

import json
import pathlib
import shutil
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[1])
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "ci"))
import requirements  # noqa: E402

CAMPAIGN = """require = [
  { key = "waypoints.1.navigation_error_m", statistic = "median", most = 0.05 },
  { key = "waypoints.2.navigation_error_m", statistic = "median", most = 2.0 },
  { statistic = "share", verdict = ["achieved"], least = 0.95, confidence = 0.9 },
]
pass = [{ key = "min_distance_m", least = 3.0 }]
[[sweep]]
keys = ["flight_computer.target"]
rows = [["in_process"], ["zynq_qemu"]]
"""
REQUIREMENTS = """title = "Navigation"
[[requirement]]
id = "NAV-001"
text = "The error shall be {limits0}, in a share of {limits1}, gravity within {claims}."
rationale = "because"
source = "paper"
rows = ["flown median waypoints.*.navigation_error_m", "flown share achieved", "flown pass min_distance_m", "flown same bits"]
tests = ["Filter.IsConsistent", "Pose.*", "program.Faults"]
claims = ["gravity *"]
figures = ["page.md :: 2.0 m"]
inspection = ["page.md"]
[[requirement]]
id = "NAV-002"
text = "It shall be proven."
rationale = "because"
source = "paper"
"""
FILES = {
    "missions/verification/flown.toml": CAMPAIGN,
    "docs/requirements/navigation.toml": REQUIREMENTS,
    "docs/accuracy.md": "| gravity 60x60 | other program | 1e-15 | 1e-13 relative | [`Gravity.Agrees`](x.cpp) |\n",
    "page.md": "at least 2.0 m\n",
    "tests/filter_test.cpp": "TEST(Filter, IsConsistent) {\nTEST_F(Pose,\n       IsFound) {\nTEST_P(Gravity, Agrees) {\n",
    "tests/CMakeLists.txt": "add_test(NAME program.${case} COMMAND x)\nvbar_program_test(x.py Faults)\n# Comment\n",
}


def judged(subject, met, **of):
    return {"subject": subject, "met": met} | of


class Page(unittest.TestCase):
    def test_evidence_exists_and_the_page_is_up_to_date(self):
        known, subjects, errors = requirements.read(ROOT)
        self.assertEqual(errors, [])
        self.assertEqual((ROOT / requirements.PAGE).read_text(encoding="utf-8"), requirements.page(known, subjects),
                         "ci/requirements.py writes the page")

    def test_most_requirements_have_evidence(self):
        every = [r for _, _, found in requirements.read(ROOT)[1] for r in found]
        self.assertGreater(len(every), 100)
        self.assertGreater(sum(bool(r.methods) for r in every), 0.9 * len(every))


class Broken(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="vbar-requirements-"))
        self.addCleanup(shutil.rmtree, self.root)
        for name, text in FILES.items():
            self.write(name, text)
        self.verify(3)

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def verify(self, seeds_flown, met_second=False):
        of = {"statistic": "median"}
        self.write("docs/verification.json", json.dumps({"commit": "abc", "rows": [{"name": "flown", "seeds_flown": seeds_flown, "requirements": [
            judged("a", True, key="waypoints.1.navigation_error_m", **of), judged("b", met_second, key="waypoints.2.navigation_error_m", **of),
            judged("share of", True, statistic="share"), judged("cases that keep all limits", True),
            judged("cases with the commands and telemetry of the first computer", True)]}]}))

    def errors_of(self, old="", new="", name="docs/requirements/navigation.toml"):
        self.assertIn(old, FILES[name])
        self.write(name, FILES[name].replace(old, new, 1))
        return requirements.read(self.root)[2]

    def test_nothing_is_wrong_before(self):
        known, subjects, errors = requirements.read(self.root)
        self.assertEqual(errors, [])
        page = requirements.page(known, subjects)
        self.assertIn("shall be at most 50 mm, 2 m, in a share of at least 95 % with 90 % confidence, gravity within 1e-13 relative.", page)
        self.assertIn("| met 4, **not met** 1 |", page)
        self.assertIn("| **open** |", page)
        self.assertIn("| `flown` | 5 | NAV-001 |", page)
        self.assertIn("| `Gravity` | NAV-001 |", page)

    def test_verdicts_follow_the_verification(self):
        for flown, met, verdict in ((3, True, "| met |"), (0, True, "| not flown |")):
            self.verify(flown, met)
            known, subjects, _ = requirements.read(self.root)
            self.assertIn(verdict, requirements.page(known, subjects))

    def test_each_broken_reference_is_found(self):
        for old, new, what in (
                ("Filter.IsConsistent", "Filter.IsWrong", "'Filter.IsWrong'"),
                ("Pose.*", "Attitude.*", "'Attitude.*'"),
                ("program.Faults", "program.Comment", "'program.Comment'"),
                ("gravity *", "drag *", "'drag *'"),
                ("flown share achieved", "flown worst dv_mps", "'flown worst dv_mps'"),
                ("2.0 m", "2.1 m", "'2.1 m' is not in page.md"),
                ('inspection = ["page.md"]', 'inspection = ["none.md"]', "none.md"),
                ("NAV-002", "NAV-001", "the id is that of"),
                ("{limits1}", "{limits7}", "limits7"),
                ("shall be proven", "is proven", "'shall'"),
                ('rationale = "because"', "", "no rationale"),
                ("inspection", "inspections", "unknown key inspections")):
            with self.subTest(what):
                self.assertTrue(any(what in error for error in self.errors_of(old, new)), self.errors_of(old, new))

    def test_evidence_that_vanished_is_found(self):
        self.assertTrue(any("Filter.IsConsistent" in error for error in self.errors_of("TEST(Filter", "TEST(Other", "tests/filter_test.cpp")))

    def test_a_criterion_without_a_requirement_is_found(self):
        self.assertEqual(self.errors_of(', "flown same bits"', ""), ["missions/verification/flown.toml: 'flown same bits' is in no requirement"])

    def test_a_row_without_a_criterion_is_found(self):
        self.write("missions/verification/empty.toml", "")
        self.assertEqual(requirements.read(self.root)[2], ["missions/verification/empty.toml: a row without a criterion"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
