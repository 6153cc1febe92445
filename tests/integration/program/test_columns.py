#!/usr/bin/env python3
"""vbar columns: the columns of all tables, each with its meaning, as printed in docs/tables.md."""
import csv
import re
import unittest

from vbar_program import SOURCE, fly, main, scratch, vbar

ENTRY = re.compile(r"^(\S+) (\S+): (.+)$")


class Columns(unittest.TestCase):
    def entries(self):
        printed = vbar("columns")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        entries = [ENTRY.match(line) for line in printed.stdout.splitlines()]
        self.assertNotIn(None, entries, "a column without a meaning")
        return {(entry[1], entry[2]): entry[3] for entry in entries}

    def test_page_is_what_the_program_prints(self):
        printed = vbar("columns", "--markdown")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        self.assertEqual(printed.stdout, (SOURCE / "docs/tables.md").read_text(), "renew it: build/host/vbar columns --markdown > docs/tables.md")

    def test_every_table_of_a_run_is_described(self):
        entries = self.entries()
        self.assertGreater(len(entries), 400)
        found = set()
        with scratch() as folder:
            for mission, hours in (("experiment2", 0.02), ("experiment3", 0.1), ("experiment1", 0.1), ("range_finder", 0.1)):
                fly(folder / mission, f"mission.duration_h={hours}", mission=SOURCE / f"missions/{mission}.toml")
                for table in (folder / mission).glob("*.csv"):
                    with table.open(newline="") as file:
                        found |= {(table.name, column) for column in next(csv.reader(file))}
        self.assertGreater(len({table for table, _ in found}), 12)
        self.assertEqual(sorted(found - set(entries)), [])

    def test_search(self):
        found = vbar("columns", "passive_safety")
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertIn("estimate.csv passive_safety_distance_m: minimum over the horizon", found.stdout)
        missing = vbar("columns", "no_such_column")
        self.assertEqual((missing.returncode, missing.stderr), (2, "vbar: no column of a table has the word 'no_such_column'\n"))
        self.assertIn("(did you mean navigation_error_m?)", vbar("columns", "navigaton_error").stderr)


if __name__ == "__main__":
    main()
