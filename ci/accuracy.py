#!/usr/bin/env python3
"""The accuracy page, docs/accuracy.md: results of the tests against independent references.

usage: ci/accuracy.py [--build build/host] [--bench FILE.json]    run the tests that record rows, write the page
       ci/accuracy.py [--build build/host] --check                run nothing: does the page name what the tests record?

Tests record rows and tables by tests/support/accuracy.h. --bench adds tables of cost from a run of vbar_bench with
--benchmark_format=json; without it the page keeps its tables of cost. (ci/accuracy.sh builds first.)
"""
import argparse
import json
import pathlib
import platform
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/accuracy.md"
HEAD = ["claim", "reference", "measured", "at most", "test"]
CALL = re.compile(r"accuracy::(?:expect_below|expect_count|record_table)\s*\(\s*")
LITERALS = re.compile(r'((?:"(?:[^"\\]|\\.)*"\s*)+)\s*([,)+])')

# Effects that the truth model omits.
LEFT_OUT = [
    ["ocean tides, but in `vbar fit`", "about 3e-8 m/s^2 in a low orbit, a tenth of the solid Earth tides; they require a tide model of some hundred coefficients",
     "IERS Conventions 2010, section 6.3"],
    ["Earth albedo and infrared radiation", "10 to 35 % of the direct radiation pressure in a low orbit",
     "Montenbruck and Gill 2000, section 3.7"],
    ["winds", "about 100 m/s of 7.5 km/s: 3 % of drag, more during geomagnetic storms", "Montenbruck and Gill 2000, section 3.5"],
    ["diurnal and semidiurnal tides in polar motion and UT1", "1 mas and 0.1 ms: 3 cm in a low orbit", "IERS Conventions 2010, chapter 8"],
]


def gtest_json(program, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "result.json"
        run = subprocess.run([str(program), f"--gtest_output=json:{output}", *arguments], cwd=program.parent,
                             capture_output=True, text=True, timeout=1800)
        if not output.exists():
            sys.exit(f"{program}: {run.stderr.strip() or run.stdout.strip()}")
        return json.loads(output.read_text())


def tests_in(result, build):
    """name, source file relative to the root, gtest's own entry. The compiler saw paths relative to the build folder."""
    for suite in result["testsuites"]:
        for test in suite["testsuite"]:
            name = f"{suite['name']}.{test['name']}"
            source = (build / test["file"]).resolve()
            yield name, (source.relative_to(ROOT) if source.is_relative_to(ROOT) else source), test


def test_programs(build):
    listed = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1"], capture_output=True, text=True,
                            check=True)
    programs = {test["command"][0] for test in json.loads(listed.stdout)["tests"]
                if any(argument.startswith("--gtest_filter") for argument in test.get("command", []))}
    return sorted(pathlib.Path(program) for program in programs)


def recording_sources():
    """Source file of a test -> the claims and titles that it contains as literals."""
    found = {}
    for source in sorted((ROOT / "tests").rglob("*_test.cpp")):
        text = source.read_text()
        claims = []
        for call in CALL.finditer(text):
            literal = LITERALS.match(text, call.end())
            composed = literal is None or literal.group(2) == "+"
            claims.append(None if composed else "".join(json.loads(part) for part in re.findall(r'"(?:[^"\\]|\\.)*"',
                                                                                          literal.group(1))))
        if claims:
            found[source.relative_to(ROOT)] = claims
    return found


def recording_tests(build, sources):
    """program -> [(name, source)] of the tests in those sources."""
    tests = {}
    for program in test_programs(build):
        if program.exists():
            listed = gtest_json(program, "--gtest_list_tests")
            tests[program] = [(name, source) for name, source, _ in tests_in(listed, build) if source in sources]
    missing = set(sources) - {source for listed in tests.values() for _, source in listed}
    if missing:
        sys.exit(f"not built: the tests of {', '.join(map(str, sorted(missing)))}")
    return {program: listed for program, listed in tests.items() if listed}


def records(build, sources):
    rows, tables = [], []
    for program, listed in recording_tests(build, sources).items():
        print(f"running {len(listed)} tests of {program.name}", flush=True)
        result = gtest_json(program, "--gtest_filter=" + ":".join(name for name, _ in listed))
        for name, source, test in tests_in(result, build):
            if "failures" in test:
                sys.exit(f"{name} fails: {test['failures'][0]['failure']}")
            for key, value in test.items():
                if not key.startswith("accuracy."):
                    continue
                _, number, field = key.split(".")
                if field == "claim":
                    rest = {f: test[f"accuracy.{number}.{f}"] for f in ("reference", "measured", "limit", "unit")}
                    rows.append({"claim": value, "test": name, "source": source, **rest})
                elif field == "table":
                    tables.append({"text": value, "test": name, "source": source})
    claims = [row["claim"] for row in rows]
    twice = sorted({claim for claim in claims if claims.count(claim) > 1})
    if twice:
        sys.exit(f"claims recorded twice: {', '.join(twice)}")
    return rows, tables


def table(head, lines):
    cell = lambda text: str(text).replace("|", "\\|")
    return "\n".join("| " + " | ".join(map(cell, line)) + " |" for line in [head, ["---"] * len(head), *lines])


def with_unit(number, unit, digits):
    """A count unchanged, a measurement to `digits` significant digits."""
    text = number if re.fullmatch(r"(= )?-?\d+", number) else f"{float(number):.{digits}g}"
    return f"{text} {unit}".strip()


def row_line(row):
    return [row["claim"], row["reference"], with_unit(row["measured"], row["unit"], 3),
            with_unit(row["limit"], row["unit"], 3), f"[`{row['test']}`](../{row['source']})"]


# Kernels of the truth model, in the page's order, with a remark on each.
COST = {
    "truth": "A day of the servicer's orbit; `one_day_full`, `days`, `spacecraft` and `degree` with 60x60 gravity (or the degree"
             " named), drag, radiation pressure, Sun and Moon at a tolerance of 1e-11; `threads`: sixteen spacecraft.",
    "gravity": "One evaluation; `vbar_portable` without vector instructions, bit-identical.",
    "nrlmsise00": "One density; `new_day`: the first evaluation of a day.",
    "drag": "", "sun_moon": "One call of both.", "third_body": "", "solid_tides": "", "relativity": "", "earth_rotation": "",
    "day_in_sunlight": "A day of 60x60 gravity, Sun, Moon and radiation pressure at a tolerance of 1e-12, by kind of shadow.",
    "attitude": "",
}
# Fields that Google Benchmark writes for every case.
BENCHMARK_FIELDS = {"name", "run_name", "run_type", "family_index", "per_family_instance_index", "repetitions",
                    "repetition_index", "threads", "iterations", "real_time", "cpu_time", "time_unit", "error_occurred"}


def where_time_goes(case):
    """Counters that a case adds in ms, as one cell: largest first."""
    shares = {k.removesuffix("_ms").replace("_", " "): v for k, v in case.items()
              if k not in BENCHMARK_FIELDS and k.endswith("_ms")}
    return ", ".join(f"{name} {share:.2g} ms" for name, share in sorted(shares.items(), key=lambda s: -s[1]))


def cost_tables(file):
    """One table a kernel: names are kernel/who/size."""
    kernels = {kernel: [] for kernel in COST}
    for case in json.loads(pathlib.Path(file).read_text())["benchmarks"]:
        if case.get("run_type", "iteration") == "iteration" and not case.get("error_occurred"):
            kernel, _, rest = case["name"].partition("/")
            if kernel in kernels:
                kernels[kernel].append(
                    [rest or kernel, *(f"{case[clock]:.4g} {case['time_unit']}" for clock in ("real_time", "cpu_time")),
                     where_time_goes(case)])
    text = ["## Cost", "", f"By `vbar_bench`, one run, {platform.machine()}.", ""]
    for kernel, lines in kernels.items():
        if not lines:
            continue
        has_shares = any(line[3] for line in lines)
        head = ["implementation, size", "wall-clock time", "processor time", "shares"]
        text += [f"### {kernel}", "", *([COST[kernel], ""] if COST[kernel] else []),
                 table(head if has_shares else head[:3], [line if has_shares else line[:3] for line in lines]), ""]
    return text


def kept_cost():
    """The section of cost that the page has: a page written without a new run of vbar_bench keeps it."""
    text = PAGE.read_text() if PAGE.exists() else ""
    start = text.find("## Cost\n")
    return [text[start:].rstrip("\n"), ""] if start >= 0 else []


def page(rows, tables, bench):
    text = ["# Accuracy", "",
            f"Written by `ci/accuracy.sh` on {time.strftime('%Y-%m-%d')}, {platform.machine()}."
            " Each row is an expectation of the test named, against a reference independent of the code under test; measured"
            " is the largest difference that the test found. Another processor may round differently.", ""]
    for folder in sorted({str(entry["source"].parent) for entry in rows + tables}):
        of_folder = lambda entries: [e for e in entries if str(e["source"].parent) == folder]
        text += [f"## {folder.removeprefix('tests/unit/')}", ""]
        if of_folder(rows):
            text += [table(HEAD, [row_line(row) for row in of_folder(rows)]), ""]
        for entry in of_folder(tables):
            title, head, *lines = entry["text"].split("\n")
            text += [f"### {title}", "", f"From [`{entry['test']}`](../{entry['source']}).", "",
                     table(head.split("\t"), [line.split("\t") for line in lines]), ""]
    text += ["## Effects not modelled", "", table(["effect", "size", "source"], LEFT_OUT), ""]
    return "\n".join(text + (cost_tables(bench) if bench else kept_cost()))


def check(build, sources):
    """The defects of the page that are found without running a test."""
    text = PAGE.read_text()
    named = set(re.findall(r"\[`([^`]+)`\]\(\.\./([^)]+)\)", text))
    existing = {(name, str(source)) for listed in recording_tests(build, sources).values() for name, source in listed}
    faults = [f"the page names {name} in {source}, which records nothing or does not exist"
              for name, source in sorted(named - existing)]
    for source, claims in sources.items():
        if str(source) not in {s for _, s in named}:
            faults.append(f"the page names no test of {source}")
        faults += [f"the page lacks \"{claim}\" of {source}" for claim in claims
                   if claim is not None and claim.replace("|", "\\|") not in text]
    return faults


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/host")
    parser.add_argument("--bench", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    sources = recording_sources()
    if arguments.check:
        faults = check(build, sources)
        print("\n".join(faults + ["run ci/accuracy.sh"]) if faults else "the page agrees with the tests")
        return 1 if faults else 0
    rows, tables = records(build, sources)
    PAGE.write_text(page(rows, tables, arguments.bench))
    print(f"{len(rows)} rows, {len(tables)} tables: {PAGE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
