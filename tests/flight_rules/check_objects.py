"""What flight code calls, by its object code: each other, and what every target has.

Usage: check_objects.py NM ARCHIVE...                  Exit code 77: an archive is not there.
       check_objects.py NM --below FOLDER NAME...      archives by their names, anywhere in the build folder
Text can hide a call (in a macro, in a template of Eigen); an undefined symbol cannot.
"""

import pathlib
import re
import subprocess
import sys

ALLOWED = {
    # compilers make these of copies and fills
    "memcpy", "memset", "memmove", "memcmp", "bcmp",
    # the guard of LCM's type hashes, local statics of generated code: set once, with the same value each time
    "__cxa_guard_acquire", "__cxa_guard_release",
    # C's strings, for names
    "strlen", "strcmp",
    "_GLOBAL_OFFSET_TABLE_",
    # what the processor is, of the run-time of x86 compilers: a word that is set before main
    "__cpu_model",
}
# Compiled for instructions that not every processor has. The linker keeps one definition of a function that several
# objects have: it must not be one of these.
SPECIAL_OBJECT = re.compile(r"_avx\w*\.cpp\.o\]:$")
# 64-bit division and double conversions of ARM's run-time interface (AAPCS RTABI), which only the compiler calls.
ALLOWED_PREFIXES = ("__aeabi_",)
# The test article, left open in boards/common for whatever GNC the image links.
ARTICLE_PREFIX = "vbar_gnc_"


def symbols(listing):
    """(defined, undefined) of nm's portable format: a name and a letter a line."""
    defined, undefined = set(), set()
    for line in listing.splitlines():
        fields = line.split()
        if len(fields) < 2 or line.endswith(":"):
            continue
        # w, v: weak and without a definition; W, V, u: defined, in several objects maybe
        (undefined if fields[1] in "Uwv" else defined).add(fields[0])
    return defined, undefined


def shared_with_other_objects(listing):
    """The symbols of objects for special processors that another object may define as well."""
    special, found = False, []
    for line in listing.splitlines():
        fields = line.split()
        if line.endswith(":"):
            special = SPECIAL_OBJECT.search(line) is not None
        elif special and len(fields) >= 2 and fields[1] in "WVu":
            found.append(fields[0])
    return found


def strangers(listings):
    """The symbols that the archives together leave open and that are not allowed, and how many they define."""
    defined, undefined = set(), set()
    for listing in listings:
        of_this = symbols(listing)
        defined |= of_this[0]
        undefined |= of_this[1]
    return sorted(s for s in undefined - defined - ALLOWED
                  if not s.startswith(ALLOWED_PREFIXES) and not s.startswith(ARTICLE_PREFIX)), len(defined)


def main():
    nm, archives = sys.argv[1], sys.argv[2:]
    if archives[0] == "--below":
        below = {path.name: str(path) for path in pathlib.Path(archives[1]).rglob("*.a")}
        archives = [below.get(name, name) for name in archives[2:]]
    if absent := [a for a in archives if not pathlib.Path(a).exists()]:
        print(f"not built: {' '.join(absent)}")
        sys.exit(77)
    listings = [subprocess.run([nm, "-P", a], check=True, capture_output=True, text=True).stdout for a in archives]
    found, count = strangers(listings)
    if count < 100:
        sys.exit(f"only {count} symbols in {len(archives)} archives: {nm} did not read them")
    for symbol in found:
        print(f"flight code calls {symbol}")
    for symbol in (shared := [symbol for listing in listings for symbol in shared_with_other_objects(listing)]):
        print(f"an object for special processors defines what others define as well: {symbol}")
    if found or shared:
        sys.exit(f"{len(found) + len(shared)} symbols that are not allowed")
    print(f"{count} symbols of {len(archives)} archives call nothing but each other and the compiler's run-time")


if __name__ == "__main__":
    main()
