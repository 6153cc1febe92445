#!/usr/bin/env python3
"""Requirements and their evidence: checks docs/requirements/*.toml and writes the matrix, docs/requirements.md.

usage: ci/requirements.py            writes the page
       ci/requirements.py --check    writes nothing; exit status 1 and one line for each error, the page out of date included

A file has a title and tables [[requirement]]:

    id = "NAV-001"
    text = "... shall ... {limits}."    {limits}: those of all criteria in rows; {limits0}: those of the first entry
    rationale = "..."
    source = "paper, table 8"
    rows = ["experiment1 median waypoints.*.navigation_error_m"]    rows of missions/verification: name, statistic, key. Also
                                         "ROW share achieved", "ROW pass KEY" (limits of each case), "ROW same bits"
    tests = ["Suite.Name", "Suite.*", "program.Faults"]             names of ctest, without the parameters of a parameterised test
    claims = ["gravity 60x60, *"]                                   of docs/accuracy.md, each with its test; {claims}: their limits
    analysis = ["docs/faults.md"]                                   pages or scripts with an analysis
    inspection = ["ci/install.sh"]                                  files to look at
    figures = ["docs/faults.md :: 2.0"]                             a file that states the figure of the text, and how

A requirement without rows, tests, claims, analysis and inspection is open. Verdicts are those of docs/verification.json. A requirement
that states evidence which does not exist, and a criterion of a campaign that is in no requirement, are errors.
"""
import collections
import fnmatch
import json
import pathlib
import re
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = "docs/requirements.md"
KEYS = {"id", "text", "rationale", "source", "rows", "tests", "claims", "analysis", "inspection", "figures"}
UNITS = {"_mps": "m/s", "_m": "m", "_s": "s", "_deg": "deg", "_arcsec": "arcsec"}
CLAIM = re.compile(r"^\| (?P<claim>[^|]+) \| [^|]+ \| [^|]+ \| (?P<limit>[^|]+) \| \[`(?P<test>[^`]+)`\]", re.M)
GTEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", re.M)

Criterion = collections.namedtuple("Criterion", "row statistic key limit")


class Errors(list):
    def add(self, place, what):
        self.append(f"{place}: {what}")


def number_of(value, key):
    """A limit with its unit, which is the end of the key."""
    unit = next((unit for end, unit in UNITS.items() if key.endswith(end)), "")
    if unit in ("m", "m/s") and 0 < abs(value) < 0.1:
        value, unit = value * 1000.0, "m" + unit
    return f"{value:.6g} {unit}".rstrip()


def limit_of(entry):
    key = entry.get("key", "")
    if entry.get("most") == 0:
        return "0"
    ends = [f"{word} {number_of(entry[side], key)}" for side, word in (("least", "at least"), ("most", "at most")) if side in entry]
    if entry.get("statistic") == "share":
        return f"at least {100 * entry['least']:g} % with {100 * entry['confidence']:g} % confidence"
    return " and ".join(ends)


def criteria(root):
    """Of all campaigns of the verification, in the order of their files."""
    folder = root / "missions/verification"
    found = []
    for path in sorted(folder.rglob("*.toml")):
        row, table = path.relative_to(folder).with_suffix("").as_posix(), tomllib.loads(path.read_text(encoding="utf-8"))
        for entry in table.get("require", []):
            key = entry.get("key") or ("achieved" if entry["statistic"] == "share" else "")
            found.append(Criterion(row, entry["statistic"], key, limit_of(entry)))
        found += [Criterion(row, "pass", entry["key"], f"{entry['key']} {limit_of(entry)}") for entry in table.get("pass", [])]
        if any("flight_computer.target" in sweep.get("keys", [sweep.get("key")]) for sweep in table.get("sweep", [])):
            found.append(Criterion(row, "same", "bits", "the same bits"))
    return found


def test_names(root):
    """(names of ctest, suites of GoogleTest): those of GoogleTest from the sources, those of scripts from the lists of CMake."""
    names = set()
    for path in (root / "tests").rglob("*.cpp"):
        names |= {f"{suite}.{name}" for suite, name in GTEST.findall(path.read_text(encoding="utf-8"))}
    suites = {name.split(".")[0] for name in names}
    for path in (root / "tests").rglob("CMakeLists.txt"):
        text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
        names |= set(re.findall(r"(?:NAME\s+|vbar_peer_test\()(\w+(?:\.\w+)?)(?=\s)", text))
        for prefix in set(re.findall(r"(?:NAME\s+|vbar_peer_test\()(\w+\.\w*)\$\{", text)):  # of a loop or function: with all its words
            names |= {prefix + word for word in re.findall(r"\b\w+\b", text)}
    return names, suites


def verdict_of(criterion, rows):
    """met, not met or not flown, by verification.json."""
    row = rows.get(criterion.row)
    if not row or not row["seeds_flown"]:
        return "not flown"
    for judged in row["requirements"]:
        same = {"same": judged["subject"].startswith("cases with the commands"), "pass": judged["subject"] == "cases that keep all limits",
                "share": judged.get("statistic") == "share"}.get(criterion.statistic)
        if same is None:
            same = (judged.get("statistic"), judged.get("key")) == (criterion.statistic, criterion.key)
        if same:
            return "met" if judged["met"] else "not met"
    return "not flown"  # a criterion that is younger than the verification


def in_words(limits):
    """`at most 1 m, 2 m` of (subject, limit): each subject once, one limit where all are equal."""
    limits = [limit.replace("at most = ", "exactly ") for _, limit in dict.fromkeys(limits)]
    if len(set(limits)) == 1:
        limits = limits[:1]
    word = limits and re.match(r"at (?:most|least) ", limits[0])
    if word and all(limit.startswith(word[0]) for limit in limits):
        limits[1:] = [limit.removeprefix(word[0]) for limit in limits[1:]]
    return ", ".join(limits)


class Requirement:
    def __init__(self, table, place, known):
        self.id, self.text, self.source = (table.get(key, "") for key in ("id", "text", "source"))
        self.place, self.table = f"{place}: {self.id or 'requirement without id'}", table
        self.rows, self.tests = table.get("rows", []), table.get("tests", [])
        self.of_row = [[c for c in known.criteria if self.names(reference, c)] for reference in self.rows]
        self.claims = [[claim for claim in known.claims if fnmatch.fnmatchcase(claim["claim"], pattern)] for pattern in table.get("claims", [])]
        self.criteria = list(dict.fromkeys(c for found in self.of_row for c in found))

    @staticmethod
    def names(reference, criterion):
        words = reference.split()
        return len(words) == 3 and all(map(fnmatch.fnmatchcase, criterion[:3], words))

    @property
    def methods(self):
        has = {"campaign": self.rows, "test": self.tests or self.claims, "analysis": self.table.get("analysis"), "inspection": self.table.get("inspection")}
        return [method for method, evidence in has.items() if evidence]

    def statement(self):
        limits = {"limits": in_words([((c.statistic, c.key), c.limit) for c in self.criteria])} if self.criteria else {}
        limits |= {f"limits{i}": in_words([((c.statistic, c.key), c.limit) for c in found]) for i, found in enumerate(self.of_row) if found}
        text = self.text.format(**limits, claims=in_words([(claim["claim"], f"at most {claim['limit']}") for found in self.claims for claim in found]))
        return text.replace("within at most ", "within ")

    def check(self, known, errors):
        for key in ("id", "text", "rationale", "source"):
            if not self.table.get(key):
                errors.add(self.place, f"no {key}")
        for key in self.table.keys() - KEYS:
            errors.add(self.place, f"unknown key {key}; accepted: {', '.join(sorted(KEYS))}")
        if self.text and " shall " not in self.text:
            errors.add(self.place, "the text has no 'shall'")
        for reference, found in zip(self.rows, self.of_row):
            if not found:
                errors.add(self.place, f"rows: no criterion of missions/verification is '{reference}'")
        for pattern in self.tests:
            if pattern not in known.tests and not fnmatch.filter(known.tests, pattern):
                errors.add(self.place, f"tests: no test is named '{pattern}'")
        for pattern, found in zip(self.table.get("claims", []), self.claims):
            if not found:
                errors.add(self.place, f"claims: docs/accuracy.md has no claim '{pattern}'")
        for path in self.table.get("analysis", []) + self.table.get("inspection", []):
            if not (known.root / path).exists():
                errors.add(self.place, f"no file {path}")
        for figure in self.table.get("figures", []):
            path, _, text = figure.partition(" :: ")
            if not (known.root / path).is_file() or text not in (known.root / path).read_text(encoding="utf-8"):
                errors.add(self.place, f"figures: '{text}' is not in {path}")
        try:
            self.statement()
        except (KeyError, IndexError, ValueError) as error:
            errors.add(self.place, f"text: {error} is not a limit of its rows")

    def verdict(self, rows):
        counts = collections.Counter(verdict_of(c, rows) for c in self.criteria)
        if not self.criteria:
            return "" if self.methods else "**open**"
        if len(counts) == 1:
            return {"not met": "**not met**"}.get(*counts) or next(iter(counts))
        return ", ".join(f"{'**not met**' if kind == 'not met' else kind} {counts[kind]}" for kind in ("met", "not met", "not flown") if counts[kind])

    def tests_of_claims(self):
        return list(dict.fromkeys(re.sub(r"^\w+/|(?<=\w)/\w+$", "", claim["test"]) for found in self.claims for claim in found))

    def evidence(self):
        parts = [f"`{name}`" for name in self.rows + self.tests + self.tests_of_claims()]
        parts += [f"{method}: {page_link(path)}" for method in ("analysis", "inspection") for path in self.table.get(method, [])]
        return "; ".join(parts)


def page_link(path):
    return f"[{path}]({path.removeprefix('docs/') if path.startswith('docs/') else '../' + path})"


class Known:
    """What requirements can name."""

    def __init__(self, root):
        self.root, self.criteria, (self.tests, self.suites) = root, criteria(root), test_names(root)
        self.claims = [match.groupdict() for match in CLAIM.finditer((root / "docs/accuracy.md").read_text(encoding="utf-8"))]
        self.verification = json.loads((root / "docs/verification.json").read_text(encoding="utf-8"))
        self.rows = {row["name"]: row for row in self.verification["rows"]}


def read(root):
    """(known, [(title, path, requirements)], errors)"""
    known, errors, subjects, seen = Known(root), Errors(), [], {}
    for path in sorted((root / "docs/requirements").glob("*.toml")):
        place = path.relative_to(root).as_posix()
        try:
            table = tomllib.loads(path.read_text(encoding="utf-8"))
        except tomllib.TOMLDecodeError as error:
            errors.add(place, error)
            continue
        found = [Requirement(entry, place, known) for entry in table.get("requirement", [])]
        subjects.append((table.get("title", path.stem), place, found))
        for requirement in found:
            requirement.check(known, errors)
            if requirement.id in seen:
                errors.add(requirement.place, f"the id is that of a requirement of {seen[requirement.id]}")
            seen[requirement.id] = place
    if not subjects:
        errors.add("docs/requirements", "no requirements")
    carried = {c for _, _, found in subjects for requirement in found for c in requirement.criteria}
    for c in known.criteria:
        if c not in carried:
            errors.add(f"missions/verification/{c.row}.toml", f"'{c.row} {c.statistic} {c.key}' is in no requirement")
    named = {c.row for c in known.criteria}
    for path in sorted((root / "missions/verification").rglob("*.toml")):
        row = path.relative_to(root / "missions/verification").with_suffix("").as_posix()
        if row not in named:
            errors.add(f"missions/verification/{row}.toml", "a row without a criterion")
    return known, subjects, errors


def table(head, rows):
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows), ""]


def page(known, subjects):
    every = [requirement for _, _, found in subjects for requirement in found]
    commit = known.verification["commit"]
    verdicts = collections.Counter(verdict_of(c, known.rows) for r in every for c in r.criteria)
    methods = collections.Counter(method for r in every for method in r.methods)
    opened = [r.id for r in every if not r.methods]
    lines = [
        "# Requirements and their evidence", "",
        "Written by `ci/requirements.py` from [requirements](requirements), where each has its rationale too; a test repeats it.",
        f"Verdicts are those of the [verification](verification.md) of commit {commit}: of criteria of campaigns, which hold over seeds.",
        "Tests, analyses and inspections have no verdict here: all tests pass at each commit that `ci/test.sh` accepts. Benches and Zynq are emulated.", "",
        f"{len(every)} requirements: {', '.join(f'{methods[m]} by {m}' for m in ('campaign', 'test', 'analysis', 'inspection'))}; "
        f"{len(opened)} open{': ' + ', '.join(opened) if opened else ''}. "
        f"Criteria named by them: {', '.join(f'{verdicts[v]} {v}' for v in ('met', 'not met', 'not flown'))}.", ""]
    for title, place, found in subjects:
        lines += [f"## {title}", "", f"[{place}]({place.removeprefix('docs/')})", ""]
        lines += table(["id", "requirement", "source", "evidence", "verdict"],
                       [[r.id, r.statement(), r.source, r.evidence(), r.verdict(known.rows)] for r in found])
    lines += ["## From the evidence to the requirements", "", "Rows of the verification, with the number of their criteria:", ""]
    by_row = collections.defaultdict(list)
    for c in known.criteria:
        by_row[c.row].append(c)
    lines += table(["row", "criteria", "requirements"], [
        [f"`{row}`", str(len(own)), ", ".join(r.id for r in every if set(own) & set(r.criteria))] for row, own in by_row.items()])
    by_test = collections.defaultdict(list)
    for requirement in every:
        for name in requirement.tests + requirement.tests_of_claims():
            by_test[name.split(".")[0]].append(requirement.id)
    lines += [f"Test suites; {len(known.suites & by_test.keys())} of {len(known.suites)} suites of GoogleTest are evidence of a requirement, the others test details:", ""]
    lines += table(["suite", "requirements"], [[f"`{suite}`", ", ".join(dict.fromkeys(ids))] for suite, ids in sorted(by_test.items())])
    return "\n".join(lines)


def main(arguments):
    if arguments not in ([], ["--check"]):
        raise SystemExit(__doc__)
    known, subjects, errors = read(ROOT)
    if not errors:
        text = page(known, subjects)
        if not arguments:
            (ROOT / PAGE).write_text(text, encoding="utf-8")
        elif not (ROOT / PAGE).exists() or (ROOT / PAGE).read_text(encoding="utf-8") != text:
            errors.add(PAGE, "not what ci/requirements.py writes")
    for error in errors:
        print(error, file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
