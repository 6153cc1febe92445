"""The text of flight code against its rules: no heap, exceptions, run-time types, threads, I/O, clock or platform mathematics.

Usage: check_sources.py ROOT. What may be included and what may be used of namespace std is listed, all else is refused, so a
new thing is a decision and not an accident. Comments and strings do not count.
"""

import pathlib
import re
import sys

FOLDERS = ["fsw", "boards/common", "boards/zynq7000"]

HEADERS = set("""
    algorithm array bit compare concepts cstddef cstdint cstring limits new optional span tuple type_traits utility
    stddef.h stdint.h Eigen/Core Eigen/Geometry Eigen/LU
""".split())
# Beside these, by folder: ARM's vector instructions; interrupt handlers share words with the main loop; libm's names are renamed where they are declared;
# LCM's generated types are met in the library that encodes them.
FOLDER_HEADERS = {
    "boards/zynq7000": {"atomic"},
    "fsw/math/newlib": {"math.h", "sys/types.h"},
    "fsw/vision/pose": {"arm_neon.h"},
    "fsw/packets": None,
}
GENERATED_HEADER = re.compile(r"vbar/(\w+\.hpp|fields\.h)|lcm/lcm_coretypes\.h")

STD_NAMES = set("""
    size_t ptrdiff_t byte int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t uintptr_t
    array span tuple tuple_size_v get apply dynamic_extent optional nullopt numeric_limits bit_cast to_integer as_bytes
    to_array has_single_bit
    min max clamp swap copy copy_n fill fill_n equal all_of any_of none_of sort lower_bound upper_bound
    memcpy memset memmove memcmp strlen strcmp strchr strrchr
    move forward exchange is_same_v is_array_v is_class_v is_floating_point_v is_trivially_copyable_v has_unique_object_representations_v is_standard_layout_v integral unsigned_integral same_as
    conditional_t declval extent_v tuple_cat tuple_element_t index_sequence make_index_sequence
    strong_ordering partial_ordering
""".split())
FOLDER_STD_NAMES = {
    "boards/zynq7000": {"atomic", "atomic_signal_fence", "memory_order_relaxed", "memory_order_acquire", "memory_order_release"},
}

LIBM = "sin cos tan asin acos atan atan2 sincos exp exp2 expm1 log log2 log10 log1p pow sqrt cbrt hypot erf erfc fmod " \
       "remainder floor ceil round trunc lround fabs abs copysign isnan isinf isfinite"

# (pattern, why); the pattern is searched in the text without comments and strings.
RULES = [(re.compile(pattern), why) for pattern, why in [
    (r"\bnew\b(?!\s*\()", "new: flight code has no heap (placement new is allowed)"),
    (r"(?<!=)(?<!= )\bdelete\b", "delete: flight code has no heap"),
    (r"\b(malloc|calloc|realloc|free|alloca|aligned_alloc)\s*\(", "flight code has no heap"),
    (r"\b(throw|try|catch)\b", "flight code has no exceptions"),
    (r"\b(dynamic_cast|typeid)\b", "flight code has no run-time types"),
    (r"\bvirtual\b", "a template or a plain function does"),
    (r"\bgoto\b", "goto"),
    (r"\blong double\b", "long double is another type on every target"),
    (r"\bthread_local\b", "flight code has no threads"),
    (r"\b(setjmp|longjmp|abort|exit|atexit|system|getenv|rand|srand|time|clock|usleep|sleep)\s*\(", "no clock and no operating system"),
    (r"(?<!static_)\bassert\s*\(", "an assert vanishes from a release: return a status"),
    (r"\b\w*(printf|scanf|puts)\s*\(", "no input or output"),
    (r"\b(MatrixX|VectorX|RowVectorX|ArrayX)\w*|\bEigen::Dynamic\b", "Eigen of dynamic size allocates"),
    (rf"(?<![\w.>:])(?:::|std::)?({LIBM.replace(' ', '|')})\s*\(", "mathematics is vbar::fsw::math::, the same bits on every target"),
    (r"\bwhile\s*\(\s*(true|1)\s*\)|\bfor\s*\(\s*;\s*;", "a loop needs a bound that a reader can see"),
]]
# What is there to do what others must not, by the beginning of the rule's reason.
EXEMPT = {
    "fsw/math": ["mathematics"],
    # Its main loop and its traps do not end.
    "boards/zynq7000": ["a loop needs a bound"],
    # Defines what the C library and the compiler would call, as traps.
    "boards/zynq7000/runtime.cpp": ["new:", "delete:", "flight code has no heap", "no clock"],
    # Proves that the trap is taken.
    "boards/zynq7000/selftest.cpp": ["new:"],
}

COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])+\'', re.S)


def without_comments_and_strings(text):
    """The same lines, with comments and literals blank."""
    return COMMENT_OR_STRING.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def of_folder(table, path):
    """Values of a folder's table that hold for a path: all entries whose key is the path or a folder above it."""
    return [value for key, value in table.items() if path == key or path.startswith(key + "/")]


def include_findings(path, text):
    allowed = HEADERS.union(*(headers for headers in of_folder(FOLDER_HEADERS, path) if headers))
    for number, line in enumerate(text.split("\n"), 1):
        included = re.match(r"\s*#\s*include\s*([<\"])([^>\"]+)[>\"]", line)
        if not included:
            continue
        bracket, name = included.groups()
        if bracket == "<":
            if name not in allowed and not (path.startswith("fsw/packets/") and GENERATED_HEADER.fullmatch(name)):
                yield number, f"<{name}> is not among the headers of flight code"
        elif path.startswith("fsw/math/newlib/"):
            continue
        elif not name.startswith(("fsw/",) if path.startswith("fsw/") else ("fsw/", "boards/")):
            yield number, f'"{name}" is outside what flight code may depend on'


def findings(path, text):
    """(line, what) of every breach in a file; `path` is relative to the root, with slashes."""
    yield from include_findings(path, text)
    allowed = STD_NAMES.union(*of_folder(FOLDER_STD_NAMES, path))
    exempt = [why for reasons in of_folder(EXEMPT, path) for why in reasons]
    rules = [(pattern, why) for pattern, why in RULES if not why.startswith(tuple(exempt))]
    for number, line in enumerate(without_comments_and_strings(text).split("\n"), 1):
        if re.match(r"\s*#\s*include", line):
            continue
        for name in re.findall(r"\bstd::(\w+)", line):
            if name not in allowed:
                yield number, f"std::{name} is not among what flight code uses"
        for pattern, why in rules:
            if pattern.search(line):
                yield number, why


def main():
    root = pathlib.Path(sys.argv[1])
    files = sorted(p for folder in FOLDERS for p in (root / folder).rglob("*") if p.suffix in {".h", ".cpp", ".c"})
    if len(files) < 50:
        sys.exit(f"only {len(files)} files found below {root}: is that the root of the tree?")
    count = 0
    for file in files:
        path = file.relative_to(root).as_posix()
        for number, what in findings(path, file.read_text(encoding="utf-8")):
            print(f"{path}:{number}: {what}")
            count += 1
    if count:
        sys.exit(f"{count} breaches")
    print(f"{len(files)} files keep the rules")


if __name__ == "__main__":
    main()
