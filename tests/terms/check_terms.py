"""Documents, comments and names against the vocabulary of the project: the wording of a paper in this field.

Usage: check_terms.py ROOT. Each banned expression has a replacement, which is printed with file and line. Documents are
checked without code, source files in their comments and names. DOCUMENTS and SOURCES list what is checked.
"""

import pathlib
import re
import sys

# Documents, folders of sources, and folders of scripts and mission files, whose comments begin with #.
DOCUMENTS = ["README.md", "NOTICE", "docs", "data"]
SOURCES = ["fsw", "boards", "pil_bridge", "toolchains/star_tables", "host_sim/engine", "host_sim/files", "host_sim/io",
           "host_sim/mission", "host_sim/training", "host_sim/truth", "host_sim/twins"]
SCRIPTS = ["ci", "missions"]
# Generated.
EXEMPT = ["fsw/orbit/gravity_coefficients.h", "docs/images"]

# (expression, write instead), searched without regard to case.
TERMS = [(re.compile(pattern, re.I), instead) for pattern, instead in [
    (r"(?<!\bthere )\b(is|are|was|were) none\b", "an invalid, unknown or missing X"),
    (r"\b(that|which) (is|are) no (?!longer\b|t\b)\w+", "an invalid X; is not a valid X"),
    (r"(?<!\bthere )\b(is|are) no (number|text|value|body|map|point|bound|stars?)\b", "is not a valid X"),
    (r"\btold\b|\btells?\b", "commanded, configured; reports, states, determines"),
    (r"\bfates?\b", "edit status"),
    (r"\bobstacles?\b", "rejection reason"),
    (r"\banew\b", "restarted, re-initialised"),
    (r"\bhonest\w*", "consistent (filter)"),
    (r"\bmend(s|ed|ing)?\b", "correct; recover"),
    (r"\bdoubt(s|ed|ful)?\b", "uncertain; inflate the covariance"),
    (r"\bstrangers?\b", "foreign datagrams; other senders"),
    (r"\bso many\b|\bso much (?!as\b|less\b|more\b)", "number of; this amount"),
    (r"\bthe dark\b(?! (level|minutes|current))|\b(is|are|be|stays?) dark for\b|\bin the dark\b", "eclipse, in eclipse"),
    (r"\bfad(es?|ed|ing)\b", "decay (Gauss-Markov)"),
    (r"\bpush(es|ed)\b", "differential accelerations"),
    (r"\b(nobody|somebody|anybody|everybody)\b", "unknown on board; other senders; no program"),
    (r"\bknows\b", "has access to; depends on"),
    (r"\bby the slope\b|\bmean, slope\b|\bfor its slope\b", "Jacobian, gain"),
    (r"\bmatt\b|\bglossy\b", "diffuse, specular"),
    (r"\blets? go of\b|\blet go\b", "release, drop"),
    (r"\bforg(et|ets|ot|otten)\b", "reset, discard"),
    (r"\b(put|at|comes?) to rest\b|\brests until\b|\bthen\s+rest\b", "deactivate (states); halt (a board)"),
    (r"\bfold(s|ed)? (in|it in)\b", "process, update"),
    (r"\bwhat (came|becomes?|became) of\b", "result of, edit status of"),
    (r"\bworked out\b|\bworks out\b", "computed, computes"),
    (r"\bturns? (of|round|about)\b|\bsmall turns?\b|\ba turn\b", "rotation, rotation vector"),
    (r"\bwhole numbers?\b", "integers"),
    (r"\bhanded over\b", "a-priori; passed to"),
    (r"\bshall (look|be)\b", "is commanded to; must be"),
    (r"\bwherever\b", "on any target; at every position"),
    (r"\bby ones\b", "elementary operations"),
]]

# (expression in code, write instead).
NAMES = [(re.compile(pattern), instead) for pattern, instead in [
    (r"\bkLeast(?!Squares\b|Angle_rad\b|RangeM\b)[A-Z]\w*|\bkLeast\b", "kMin..."),
    (r"\bkMost(?!RangeM\b)[A-Z]\w*|\bkMost\b", "kMax..."),
    (r"\bleast_(?!squares|norm|peak|certain|fitting|reach\b)\w+|\b(?!acceleration_psd)\w+_least\b", "min_...; ..._min"),
    (r"\bmost_\w+|\b(?!acceleration_psd)\w+_most\b", "max_...; ..._max"),
    (r"\babsorb_turn\b|\bturned_on\b", "reset_attitude_error, propagate_attitude"),
    (r"\b\w*[Pp]ushe[sd]\w*\b", "differential accelerations"),
    (r"\b(\w+_)?fate_?\b(?<!keypoint_fate)(?<!message\.fate)|\b\w+Fate\b", "edit_status"),
    (r"(?<!telemetry_gnss::)\b\w*[Oo]bstacle\w*\b(?<!message\.obstacle)", "rejection_reason"),
    (r"\b\w*[Dd]oubt\w*\b", "inflate..., uncertainty"),
    (r"\bkLittle\w*\b", "kDifferenceStep"),
]]

STRING = re.compile(r'"(?:\\.|[^"\\\n])*"')


def prose_of_document(text):
    """The same lines without fenced and indented code, code spans and the targets of links."""
    lines, fenced = [], False
    for line in text.split("\n"):
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            lines.append(re.sub(r"`[^`]*`|\]\([^)]*\)", " ", line))
            continue
        lines.append("")
    return "\n".join(lines)


def split_source(text):
    """(comments, code), each with the lines of the text; strings are in neither."""
    comments, code = [], []
    in_block = False
    for line in text.split("\n"):
        line = STRING.sub('""', line)
        if in_block:
            comment, end, rest = line.partition("*/")
            in_block = not end
            comments.append(comment)
            code.append(rest)
            continue
        before, marker, after = re.match(r"(.*?)(//|/\*|$)(.*)", line).groups()
        if marker == "/*":
            in_block = "*/" not in after
            after = after.partition("*/")[0]
        comments.append(re.sub(r"`[^`]*`", " ", after))
        code.append(before)
    return "\n".join(comments), "\n".join(code)


def comments_of_script(text):
    """The same lines with their comments alone, which begin with # outside strings."""
    lines = (re.sub(r"'[^'\n]*'", "''", STRING.sub('""', line)).partition("#")[2] for line in text.split("\n"))
    return "\n".join(re.sub(r"`[^`]*`", " ", line) for line in lines)


def matches(rules, text):
    """(line, what was found, what to write instead). A comment that goes on in the next line is read as one."""
    for number, line in enumerate(text.split("\n"), 1):
        for pattern, instead in rules:
            for match in pattern.finditer(line):
                yield number, match[0], instead


def findings(path, text):
    """Of one file; `path` is relative to the root, with slashes."""
    suffix = pathlib.PurePosixPath(path).suffix
    if suffix in {".h", ".cpp", ".c"}:
        comments, code = split_source(text)
        yield from matches(TERMS, comments)
        yield from matches(NAMES, code)
    elif suffix in {".py", ".sh", ".toml"}:
        yield from matches(TERMS, comments_of_script(text))
    else:
        yield from matches(TERMS, prose_of_document(text))


def files_below(root):
    for entry in DOCUMENTS:
        path = root / entry
        yield from [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.suffix == ".md")
    for folder in SOURCES:
        yield from sorted(p for p in (root / folder).rglob("*") if p.suffix in {".h", ".cpp", ".c"})
    for folder in SCRIPTS:
        yield from sorted(p for p in (root / folder).rglob("*") if p.suffix in {".py", ".sh", ".toml"})


def main():
    root = pathlib.Path(sys.argv[1])
    files = [f for f in files_below(root) if not f.relative_to(root).as_posix().startswith(tuple(EXEMPT))]
    if len(files) < 200:
        sys.exit(f"only {len(files)} files found below {root}: is that the root of the tree?")
    count = 0
    for file in files:
        path = file.relative_to(root).as_posix()
        for number, found, instead in findings(path, file.read_text(encoding="utf-8")):
            print(f"{path}:{number}: '{found}'; write: {instead}")
            count += 1
    if count:
        sys.exit(f"{count} expressions outside the vocabulary")
    print(f"{len(files)} files keep to the vocabulary")


if __name__ == "__main__":
    main()
