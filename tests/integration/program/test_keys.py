#!/usr/bin/env python3
"""vbar keys: the reference of mission files, complete and as printed in docs/keys.md."""
import re
import tomllib
import unittest

from vbar_program import SOURCE, main, vbar

READERS = ("host_sim/mission/read_*.cpp", "host_sim/sensors/*/read_*.cpp", "host_sim/sensors/*/*_kind.cpp")
READ = re.compile(r'\b(?:section|table|fault|document|waypoint|sensor|inner)\w*\.(?:number|integer|flag|text|texts|name|numbers|pairs|three_numbers|'
                  r'six_numbers|span|choice|choices)\(\s*"(\w+)"')
# Asked for only where a mission names an orbit file of the user's.
WITH_AN_ORBIT_FILE = {"orbit_object"}


class Keys(unittest.TestCase):
    def test_page_is_what_the_program_prints(self):
        printed = vbar("keys", "--markdown")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        self.assertEqual(printed.stdout, (SOURCE / "docs/keys.md").read_text(), "renew it: build/host/vbar keys --markdown > docs/keys.md")

    def test_every_key_that_a_reader_names_is_on_the_page(self):
        page = set(re.findall(r"^\| `(\w+)` \|", (SOURCE / "docs/keys.md").read_text(), re.MULTILINE))
        named = {(key, file.name) for pattern in READERS for file in SOURCE.glob(pattern) for key in READ.findall(file.read_text())}
        self.assertGreater(len(named), 150)
        self.assertEqual(sorted((key, file) for key, file in named if key not in page | WITH_AN_ORBIT_FILE), [])

    def test_search(self):
        found = vbar("keys", "recession")
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertIn("safety.recession_m\n    a number above 0, up to 100000; default 1\n", found.stdout)
        missing = vbar("keys", "recesion_m")
        self.assertEqual(missing.returncode, 2)
        self.assertEqual(missing.stderr, "vbar: no key of a mission has the word 'recesion_m' (did you mean recession_m?)\n")
        self.assertIn("(did you mean crosslink?)", vbar("keys", "crosslnk").stderr)

    def test_search_is_for_words_and_names_come_first(self):
        self.assertNotIn("display", vbar("keys", "isp").stdout)
        found = re.findall(r"^(\S+)$", vbar("keys", "hold").stdout, re.MULTILINE)
        self.assertIn("safety.hold_distance_m", found[:2])
        self.assertFalse([name for name in found if "threshold" in name and "hold" not in name.replace("threshold", "")])

    def test_every_key_has_a_meaning_and_every_meaning_a_key(self):
        page, table = set(), ""
        for line in (SOURCE / "docs/keys.md").read_text().splitlines():
            if line.startswith("## "):
                table = line[3:].strip("[]").replace("top of the file", "")
            elif row := re.match(r"\| `(\w+)` \|.*\| (.*) \|$", line):
                page.add((table, row[1]))
                self.assertGreater(len(row[2].split()), 1, f"{table}.{row[1]}: data/mission_keys.toml has no meaning of it")

        def listed(node, path=""):
            for key, value in node.items():
                if isinstance(value, dict):
                    yield from listed(value, f"{path}.{key}".strip("."))
                else:
                    yield path, key

        meanings = set(listed(tomllib.loads((SOURCE / "data/mission_keys.toml").read_text())))
        self.assertEqual(meanings - page, set(), "meanings without a key of any bundled mission")
        self.assertGreater(len(page), 350)


if __name__ == "__main__":
    main()
