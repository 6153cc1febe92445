"""The bill of materials: what the programs are made of is named in NOTICE, and what is not named is found. Usage: sbom_test.py ROOT BUILD."""

import contextlib
import io
import json
import pathlib
import shutil
import sys
import unittest

ROOT, BUILD = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "ci"))
import sbom  # noqa: E402

NOTICE = """vbar
Linked: ERFA (BSD-3), {fmt} (MIT), LCM 1.3 (LGPL-2.1; by a bus), Eigen 3.4 (MPL-2.0 parts only), OpenSSL
(Apache-2.0), libpng (libpng licence), GCC's run-time libraries (GPL-3 with the GCC Runtime Library Exception).
In the page: three.js
(MIT, Copyright), uPlot (MIT, Copyright (c) 2022).

Data:

  data/gravity/field.txt   A field
  data/earth/space_weather_*.csv
                           Indices
  data/gps/                Ephemerides

Test data:
  pugixml
"""
SOURCES = {name: ("1.0", [name]) for name in ("erfa", "fmtlib", "lcm", "eigen3", "openssl", "gcc-14")}
NPM = [("three", "0.1", "MIT"), ("uplot", "1.6", "MIT")]
DATA = [("00", path) for path in ("gravity/field.txt", "earth/space_weather_2009.csv", "gps/gps_2011.csv", "bodies/tango.toml")]


def found(sources=(), npm=(), data=()):
    return list(sbom.check(sbom.Notice(NOTICE), sources, npm, data))


class Check(unittest.TestCase):
    def test_what_is_named_is_accepted(self):
        self.assertEqual(found(SOURCES, NPM, DATA), [])

    def test_a_component_that_is_not_named_is_found(self):
        self.assertEqual(found({"zlib": ("1", [])}), ["NOTICE: the component zlib (source package zlib) is not named"])
        self.assertEqual(len(found({"pugixml": ("1", [])})), 1, "test data names no component")
        self.assertEqual(len(found({"libpng": ("1", []), "png": ("1", [])})), 1, "a part of a word is no name")
        self.assertEqual(found(npm=[("esbuild", "1", "MIT")]), ["NOTICE: the component esbuild 1 of npm is not named"])

    def test_another_licence_is_found(self):
        self.assertEqual(found(npm=[("three", "0.1", "BSD-3-Clause")]), ["NOTICE: three.js is under 'MIT', and by package-lock.json under 'BSD-3-Clause'"])

    def test_data_of_unknown_origin_are_found(self):
        self.assertEqual(len(found(data=[("00", "gravity/other.txt")])), 1)

    def test_licences_are_those_of_the_notice(self):
        notice = sbom.Notice(NOTICE)
        self.assertEqual([sbom.SPDX[notice.licence_of(sbom.name_of(name))] for name in SOURCES], [
            "BSD-3-Clause", "MIT", "LGPL-2.1-or-later", "MPL-2.0", "Apache-2.0", "GPL-3.0-or-later WITH GCC-exception-3.1"])


@unittest.skipUnless(shutil.which("dpkg-query") and (BUILD / "vbar").exists(), "no package database, or no program")
class Programs(unittest.TestCase):
    def test_every_component_of_this_build_is_named(self):
        output = io.StringIO()
        sys.argv = ["sbom.py", "--build", str(BUILD), "vbar"]
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            status = sbom.main()
        self.assertEqual(status, 0, output.getvalue())
        document = json.loads(output.getvalue())
        names = {package["name"] for package in document["packages"]}
        self.assertLessEqual({"vbar", "erfa", "eigen3", "openssl", "glibc", "three", "uplot"}, names)  # by link, header, lock file
        identifiers = [element["SPDXID"] for element in document["packages"] + document["files"]]
        self.assertEqual(len(identifiers), len(set(identifiers)))
        related = {relation["relatedSpdxElement"] for relation in document["relationships"]}
        self.assertEqual(related, set(identifiers))
        sums = dict(reversed(line.split(maxsplit=1)) for line in (ROOT / "data/SHA256SUMS").read_text(encoding="utf-8").splitlines())
        self.assertEqual({file["fileName"].removeprefix("./data/"): file["checksums"][0]["checksumValue"] for file in document["files"]}, sums)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
