#!/usr/bin/env python3
"""Pages of docs/ whose commands are executed in order, in an empty folder, and whose outputs have to be those printed.

    test_pages.py CLASS...          as a test
    test_pages.py --update PAGE     replaces the outputs in docs/PAGE that are no longer those of the program

A block after a line "File `NAME`:" becomes that file. In a block `console` a command follows "$ ", its output follows it; "…" stands for
anything within a line, and alone on a line for any number of lines.
"""
import difflib
import itertools
import os
import pathlib
import re
import subprocess
import sys
import unittest

from vbar_program import BINARY, SOURCE, main, scratch

BLOCK = re.compile(r"(?:File `([^`\n]+)`:\n\n)?^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
ANY = "…"


def commands_of(console):
    """Pairs of a command and the output printed below it, both as in the page."""
    pairs = []
    for line in console.splitlines(True):
        if line.startswith("$ "):
            pairs.append([line[2:], ""])
        elif pairs and not pairs[-1][1] and pairs[-1][0].endswith("\\\n"):
            pairs[-1][0] += line
        elif not pairs:
            raise ValueError(f"a console block begins without a command: {line}")
        else:
            pairs[-1][1] += line
    return pairs


def matches(expected, output):
    pattern = "".join("(?:.*\n)*?" if line.strip() == ANY else re.escape(line).replace(re.escape(ANY), ".*")
                      for line in expected.splitlines(True))
    return re.fullmatch(pattern, output) is not None


def execute(command, folder):
    environment = os.environ | {"PATH": f"{BINARY}:{os.environ['PATH']}", "PYTHONPATH": str(BINARY / "python"), "LC_ALL": "C.UTF-8"}
    result = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True, timeout=300)
    output = result.stdout
    if output and not output.endswith("\n"):
        output += "\n"
    return result.returncode, output


def follow(text, folder):
    """Executes a page. Yields each command, its status, the output in the page and the one that it has."""
    for file, language, content in BLOCK.findall(text):
        if file:
            path = folder / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content)
        elif language == "console":
            for command, expected in commands_of(content):
                status, output = execute(command, folder)
                yield command, status, expected, output


class Page:
    """Of the test cases below, each of which names its page."""

    def test_commands_have_the_outputs_of_the_page(self):
        with scratch() as folder:
            commands = 0
            for command, status, expected, output in follow((SOURCE / "docs" / self.page).read_text(), folder):
                commands += 1
                with self.subTest(command=command.strip()):
                    self.assertEqual(status, 0, output)
                    self.assertTrue(matches(expected, output), f"in the page:\n{expected}\nthe output:\n{output}")
            self.assertGreater(commands, 5)


class FirstHour(Page, unittest.TestCase):
    page = "first_hour.md"


class Limits(Page, unittest.TestCase):
    page = "limits.md"


class Tutorial(Page, unittest.TestCase):
    page = "tutorial.md"


class Figures(unittest.TestCase):
    """Figures of ideal_navigation that stand in other pages."""

    def test_no_other_page_repeats_the_table(self):
        """Its first leg, which no other mission has: 1.480728 m/s in 18 maneuvers."""
        pages = [page.name for page in (SOURCE / "docs").glob("*.md") if "1.480728" in page.read_text()]
        self.assertEqual(pages, ["first_hour.md"])


class Pages(unittest.TestCase):
    """The means of this file: a page that is wrong is not accepted, and a renewed one keeps what may differ."""

    def test_an_output_that_differs_is_noticed(self):
        self.assertTrue(matches("a … c\n", "a b c\n"))
        self.assertFalse(matches("a … c\n", "a b d\n"))
        self.assertTrue(matches("a\n…\nz\n", "a\nb\nc\nz\n"))
        self.assertFalse(matches("a\n…\nz\n", "a\nb\nc\n"))
        self.assertFalse(matches("", "a\n"))
        self.assertEqual(renewed("…\nx 1\ny … s\n…\n", "a\nb\nx 2\ny 4 s\nc\n"), "…\nx 2\ny … s\n…\n")
        self.assertEqual(renewed("x 1\n", "x 2\nz\n"), "x 2\nz\n")
        self.assertFalse(matches("a\n", ""))

    def test_files_commands_and_status(self):
        page = "File `a.txt`:\n\n```text\none\n```\n\n```console\n$ cat \\\n    a.txt\none\n$ exit 3\n```\n"
        with scratch() as folder:
            self.assertEqual([(status, expected, output) for _, status, expected, output in follow(page, folder)],
                             [(0, "one\n", "one\n"), (3, "", "")])


def renewed(expected, output):
    """The output in the form of the page: "…" remains where it stood; the lines between two of them are those of the output most like them."""
    lines = output.splitlines(True)
    result, begin = [], 0
    for any_lines, part in itertools.groupby(expected.splitlines(True), lambda line: line.strip() == ANY):
        part = list(part)
        if any_lines:
            result += part[:1]
            continue
        if ANY + "\n" in expected:
            windows = range(begin, max(begin, len(lines) - len(part)) + 1)
            begin = max(windows, key=lambda at: difflib.SequenceMatcher(None, "".join(part), "".join(lines[at:at + len(part)])).ratio())
            found = lines[begin:begin + len(part)]
        else:
            found = lines
        begin += len(found)
        result += [next((line for line in part if ANY in line and matches(line, new)), new) for new in found]
    return "".join(result)


def update(page):
    path = SOURCE / "docs" / page
    text = path.read_text()
    with scratch() as folder:
        for command, status, expected, output in follow(text, folder):
            if status != 0:
                raise SystemExit(f"{command}: {status}: {output}")
            if not matches(expected, output):
                before = f"$ {command}{expected}"
                if text.count(before) == 0:
                    raise SystemExit(f"not found in the page: {before}")
                at = text.rindex(before)
                text = text[:at] + f"$ {command}{renewed(expected, output)}" + text[at + len(before):]
    path.write_text(text)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--update"]:
        update(pathlib.PurePath(sys.argv[2]).name)
    else:
        main()
