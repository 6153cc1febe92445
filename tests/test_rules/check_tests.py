"""The text of tests against the forms that let a NaN pass: std::max(0.0, NaN) is 0.0, and every comparison with NaN is false.

Usage: check_tests.py ROOT. Comments and strings do not count. tests/support/figures.h has what to write instead.
"""

import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "flight_rules"))
from check_sources import without_comments_and_strings  # noqa: E402

NAME = r"[A-Za-z_*][\w.\[\]>-]*"
# std::max<int>, of a type that has no NaN, may accumulate.
ASSIGNED_EXTREME = re.compile(rf"(?<![\w.])({NAME})\s*=\s*std::(?:ranges::)?f?(?:max|min)(?:<(?:double|float)>)?\(")
EXPECTED_FALSE = re.compile(r"\b(?:EXPECT|ASSERT)_FALSE\(")

# (pattern, why); searched in the text without comments and strings, over the ends of lines.
RULES = [(re.compile(pattern), why) for pattern, why in [
    (rf"\bif \(({NAME}) [<>]=? ({NAME})\)\s*(?:(?:\2 = \1|\1 = \2);|\{{\s*(?:\2 = \1|\1 = \2);\s*\}})",
     "an accumulator that drops a NaN: accuracy::Largest or Smallest"),
    (r"\.(?:max|min)Coeff\(|\blpNorm<(?:Eigen::)?Infinity>", "Eigen passes over a NaN: accuracy::largest_entry()"),
    (r"\b(?:max|min|minmax|nth)_element\(", "the place of a NaN is undefined: accuracy::Largest, Smallest, median() or quantile()"),
    (r"\bif \([^;{!]*(?:\babs\(|[nN]orm\(\))[^;{]* >=? [^;{]*\)\s*\{?\s*(?:\+\+|ADD_FAILURE|FAIL\(|return false)",
     "counts no NaN: if (!(error <= limit))"),
]]


def arguments(text, begin):
    """The arguments of a call (or of the braces in it), from behind its parenthesis, and what follows the call."""
    found, depth, word = [], 0, ""
    for end, c in enumerate(text[begin:], begin + 1):
        if c in ")}" and depth == 0:
            break
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            found.append(word.strip())
            word = ""
        else:
            word += c
    found.append(word.strip())
    return (arguments(found[0], 1)[0] if len(found) == 1 and found[0].startswith("{") else found), text[end:end + 1]


def findings(text):
    """(line, what) of every form that lets a NaN pass."""
    text = without_comments_and_strings(text)
    for match in ASSIGNED_EXTREME.finditer(text):
        among, follows = arguments(text, match.end())
        if match[1] in among and follows == ";":
            yield text.count("\n", 0, match.start()) + 1, f"{match[1]} drops a NaN: accuracy::Largest or Smallest"
    for match in EXPECTED_FALSE.finditer(text):
        if re.search(r"\s[<>]=?\s", arguments(text, match.end())[0][0]):
            yield text.count("\n", 0, match.start()) + 1, "passes with a NaN: write what must hold"
    for pattern, why in RULES:
        for match in pattern.finditer(text):
            yield text.count("\n", 0, match.start()) + 1, why


def main():
    root = pathlib.Path(sys.argv[1]) / "tests"
    files = sorted(p for p in root.rglob("*") if p.suffix in {".h", ".cpp"})
    if len(files) < 100:
        sys.exit(f"only {len(files)} files found below {root}: is its parent the root of the tree?")
    count = 0
    for file in files:
        for number, what in sorted(findings(file.read_text(encoding="utf-8"))):
            print(f"{file.relative_to(root.parent).as_posix()}:{number}: {what}")
            count += 1
    if count:
        sys.exit(f"{count} places where a NaN passes")
    print(f"{len(files)} files of tests retain a NaN")


if __name__ == "__main__":
    main()
