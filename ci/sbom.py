#!/usr/bin/env python3
"""A bill of materials (SPDX 2.3, JSON) of what the installed programs are made of, checked against NOTICE.

usage: ci/sbom.py [--build build/host] [PROGRAM...]    writes it to standard output; default: all programs that are installed
       ci/sbom.py [--build build/host] --check         writes nothing
Exit status 1: a component is not named in NOTICE, or with another licence; one line for each.

Components are source packages of Debian: those of all headers that the objects of the programs were compiled with, of the
libraries that they link or load, and of the flight image; packages of npm in the page of a run; data files, with the checksums of
data/SHA256SUMS. Libraries of libraries are listed and need no place in NOTICE: ci/bundle.sh ships their licences.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LOADED = ("libOSMesa.so.8", "liblcm.so.1")  # by vbar, where a mission needs them
FLIGHT_IMAGE = ("newlib-source", "libnewlib-arm-none-eabi", "gcc-arm-none-eabi", "libstdc++-arm-none-eabi-dev")
# Source packages, and packages of npm, whose name in NOTICE is another one.
NAMES = {"aravis": "Aravis", "atlas": "LAPACK", "boost": "Boost", "ceres-solver": "Ceres", "charls": "CharLS", "cli11": "CLI11", "eigen3": "Eigen", "erfa": "ERFA",
         "fmtlib": "{fmt}", "gcc": "GCC's run-time libraries", "gcc-arm-none-eabi": "gcc-arm-none-eabi", "geographiclib": "GeographicLib",
         "glib2.0": "GLib", "glibc": "GNU C library", "lapack": "LAPACK", "lcm": "LCM", "libpng1.6": "libpng", "librandom123": "Random123", "libsdl2": "SDL2",
         "libstdc++-arm-none-eabi": "gcc-arm-none-eabi", "libx11": "Xlib", "libxrandr": "Xrandr", "libxrender": "Xrender", "linux": "Linux's headers",
         "mesa": "Mesa's OSMesa", "nlohmann-json3": "nlohmann/json", "openblas": "LAPACK", "opencv": "OpenCV", "openssl": "OpenSSL", "suitesparse": "SuiteSparse",
         "three": "three.js", "tomlplusplus": "toml++", "uplot": "uPlot", "xorgproto": "Xorgproto"}
SPDX = {"Apache-2.0": "Apache-2.0", "BSD-3": "BSD-3-Clause", "BSL-1.0": "BSL-1.0", "GPL-2": "GPL-2.0-or-later", "GPL-2 with the syscall exception": "GPL-2.0-only WITH Linux-syscall-note",
        "GPL-3 with the GCC Runtime Library Exception": "GPL-3.0-or-later WITH GCC-exception-3.1", "LGPL-2.1": "LGPL-2.1-or-later", "MIT": "MIT",
        "MPL-2.0": "MPL-2.0", "libpng licence": "libpng-2.0", "zlib": "Zlib"}
# Data of this project, under its licence; other data is named in NOTICE.
OWN_DATA = ("benches/", "bodies/", "calibrations/", "cameras/", "models/", "networks/", "mission_keys.toml", "gps/receiver_antenna_typical_patch.csv")


def name_of(package):
    """In NOTICE; packages of GCC and Boost have their version in their name."""
    package = re.sub(r"^(gcc|boost)-?[\d.]+$", r"\1", package)
    return NAMES.get(package, package)


def output_of(*command, **settings):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True, **settings).stdout


class Notice:
    def __init__(self, text):
        self.text = re.sub(r"\s+", " ", text.split("\nTest data:")[0])
        self.data = re.findall(r"^  (data/[^\s*]+)\*?", text.split("\nData:")[-1], re.M)

    def licence_of(self, name):
        """As NOTICE states it, behind the name and a version: `LCM 1.3 (LGPL-2.1; ...)`. None: not named."""
        match = re.search(r"(?<![\w.])" + re.escape(name) + r"(?![\w.])(?: [\d.]+)?(?: \(([^)]*)\))?", self.text)
        return None if not match else re.split(r"[;,]| parts", match[1] or "")[0].strip()

    def names_data(self, path):
        return any(f"data/{path}".startswith(start) for start in self.data)


def installed_programs(build):
    listed = re.search(r"foreach\(program ([\w ]+)\)", (ROOT / "toolchains/cmake/vbar_install.cmake").read_text(encoding="utf-8"))[1].split()
    return [program for program in listed if (build / program).exists()]


def headers_of(build, programs):
    """Headers of the system that the objects of the programs include."""
    objects = {line for line in output_of("ninja", "-C", build, "-t", "inputs", *programs, errors="replace").splitlines() if line.endswith((".o", ".gch", ".pch"))}
    headers, counts = set(), False
    for line in output_of("ninja", "-C", build, "-t", "deps").splitlines():
        if line.startswith(" "):
            if counts and line.lstrip().startswith("/usr/"):
                headers.add(line.strip())
        else:
            counts = line.split(": #deps")[0] in objects
    return headers


def libraries_of(build, programs):
    """(linked or loaded by a program, by one of those): their files."""
    direct, every = set(), set()
    cache = dict(re.findall(r"(\S+) \(.*x86-64.*\) => (\S+)", output_of("/sbin/ldconfig", "-p")))
    loaded = [cache[name] for name in LOADED if name in cache]
    for file in [*(build / program for program in programs), *loaded]:
        found = dict(re.findall(r"^\s*(\S+) => (/\S+)", output_of("ldd", file), re.M))
        every |= set(found.values())
        if file not in loaded:
            direct |= {found[name] for name in re.findall(r"NEEDED.*\[(.*)\]", output_of("readelf", "-d", file)) if name in found}
    return direct | set(loaded), every


def packages_of(files):
    """Packages of Debian that own files; of libraries its lists name some by /lib and others by /usr/lib."""
    wanted = {name for file in files for name in (file, f"/usr{file}", file.removeprefix("/usr"), *([os.path.realpath(file)] if ".so" in file else []))}
    return {path.name.removesuffix(".list") for path in pathlib.Path("/var/lib/dpkg/info").glob("*.list")
            if not wanted.isdisjoint(path.read_text(encoding="utf-8").split("\n"))}


def sources_of(packages):
    """{source package: (version, [package])} of installed packages."""
    listed = subprocess.run(["dpkg-query", "-W", "-f=${db:Status-Status} ${binary:Package} ${source:Package} ${source:Version}\n", *sorted(packages)],
                            capture_output=True, text=True)  # those that are not installed are an error of dpkg-query
    found = {}
    for status, package, name, version in (line.split() for line in listed.stdout.splitlines() if len(line.split()) == 4):
        if status == "installed":
            found.setdefault(name, (version, []))[1].append(package)
    return found


def npm_packages(root):
    """[(name, version, licence)] of those that are in the page, not those that bundle it."""
    lock = json.loads((root / "host_sim/view/web/package-lock.json").read_text(encoding="utf-8"))
    return [(path.removeprefix("node_modules/"), entry["version"], entry.get("license", ""))
            for path, entry in lock["packages"].items() if path and not entry.get("dev")]


def data_files(root):
    """[(SHA-256, path below data)]"""
    return [tuple(line.split(maxsplit=1)) for line in (root / "data/SHA256SUMS").read_text(encoding="utf-8").splitlines()]


def check(notice, sources, npm, data):
    """Sentences on what NOTICE lacks."""
    for name in sources:
        if notice.licence_of(name_of(name)) is None:
            yield f"NOTICE: the component {name_of(name)} (source package {name}) is not named"
    for name, version, licence in npm:
        stated = notice.licence_of(name_of(name))
        if stated is None:
            yield f"NOTICE: the component {name_of(name)} {version} of npm is not named"
        elif stated != licence:
            yield f"NOTICE: {name_of(name)} is under '{stated}', and by package-lock.json under '{licence}'"
    for _, path in data:
        if not notice.names_data(path) and not path.startswith(OWN_DATA):
            yield f"NOTICE: data/{path} is not named, and is not among the project's own data (OWN_DATA of ci/sbom.py)"


def identifier(*words):
    return "SPDXRef-" + re.sub(r"[^\w.-]", "-", "-".join(words)).replace("_", "-")


def document(build, programs, direct, indirect, npm, data, notice):
    logged = subprocess.run(["git", "-C", ROOT, "log", "-1", "--format=%H %ct"], capture_output=True, text=True)
    commit, date = logged.stdout.split() if logged.returncode == 0 else ("unknown", "0")
    version = re.search(r"project\(vbar VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    created = datetime.datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", date)), datetime.timezone.utc)
    packages, files, relations = [], [], []

    def add(name, kind, version, licence, relation, **of):
        packages.append({"SPDXID": identifier(kind, name), "name": name, "versionInfo": version, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
                         "licenseConcluded": SPDX.get(licence, "NOASSERTION"), "licenseDeclared": SPDX.get(licence, "NOASSERTION"),
                         "copyrightText": "NOASSERTION"} | of)
        relations.append({"spdxElementId": "SPDXRef-vbar", "relationshipType": relation, "relatedSpdxElement": identifier(kind, name)})

    add("vbar", "program", version, "Apache-2.0", "DESCRIBES", comment=f"programs: {', '.join(programs)}; commit {commit}")
    packages[0]["SPDXID"] = "SPDXRef-vbar"
    relations[0] = {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-vbar"}
    for sources, comment in ((direct, "linked, loaded or compiled in"), (indirect, "library of a library")):
        for name, (version, of) in sorted(sources.items()):
            reference = {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": f"pkg:deb/debian/{name}@{version}?arch=source"}
            add(name, "deb", version, notice.licence_of(name_of(name)) or "", "DEPENDS_ON", comment=f"{comment}: {', '.join(of)}", externalRefs=[reference])
    for name, version, licence in npm:
        reference = {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": f"pkg:npm/{name}@{version}"}
        add(name, "npm", version, licence, "CONTAINS", comment="in the page of a run", externalRefs=[reference])
    for checksum, path in data:
        files.append({"SPDXID": identifier("data", path), "fileName": f"./data/{path}", "checksums": [{"algorithm": "SHA256", "checksumValue": checksum}],
                      "licenseConcluded": "Apache-2.0" if path.startswith(OWN_DATA) else "NOASSERTION", "copyrightText": "NOASSERTION",
                      "comment": "" if path.startswith(OWN_DATA) else "origin and terms: NOTICE"})
        relations.append({"spdxElementId": "SPDXRef-vbar", "relationshipType": "CONTAINS", "relatedSpdxElement": identifier("data", path)})
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"vbar-{version}",
            "documentNamespace": f"urn:vbar:{commit}:{'+'.join(programs)}",
            "creationInfo": {"created": created.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: ci/sbom.py"]},
            "packages": packages, "files": files, "relationships": relations}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/host")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("programs", nargs="*")
    options = parser.parse_args()
    programs = options.programs or installed_programs(options.build)
    notice = Notice((ROOT / "NOTICE").read_text(encoding="utf-8"))
    linked, every = libraries_of(options.build, programs)
    direct = sources_of(packages_of(headers_of(options.build, programs) | linked) | set(FLIGHT_IMAGE))
    indirect = {name: of for name, of in sources_of(packages_of(every)).items() if name not in direct}
    npm, data = npm_packages(ROOT), data_files(ROOT)
    missing = list(check(notice, direct, npm, data))
    for sentence in missing:
        print(sentence, file=sys.stderr)
    if not options.check:
        print(json.dumps(document(options.build, programs, direct, indirect, npm, data, notice), indent=1))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
