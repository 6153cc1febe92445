#!/usr/bin/env python3
"""The documentation as a site: pages of docs/ and the README by MkDocs, the headers of the flight software by Doxygen.

usage: ci/site.py [FOLDER]      default build/site; FOLDER/html/index.html is the first page

Files of the repository that pages link to are part of the site. A link that leads nowhere, and a page that is in no chapter, end
the build.
"""
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CHAPTERS = {
    "First hour": ["README.md", "docs/first_hour.md", "docs/tutorial.md", "docs/results.md", "docs/limits.md"],
    "Your mission": ["docs/keys.md", "docs/data_formats.md", "docs/run_folder.md", "docs/view.md", "docs/other_programs.md", "docs/tables.md", "docs/words.md", "docs/glossary.md", "docs/evidence.md", "docs/check.md", "docs/faults.md"],
    "Campaigns": ["docs/campaigns.md", "docs/campaign_page.md"],
    "Your flight code": ["docs/own_flight_code.md", "docs/external_sources.md", "docs/own_target.md", "docs/wire_formats.md", "docs/board_bringup.md"],
    "Testbeds": ["docs/grand.md", "docs/generator_protocols.md", "docs/protocol_sources.md", "docs/optical_stimulator.md", "docs/tron.md", "docs/testbeds.md"],
    "How far to trust it": ["docs/verification.md", "docs/requirements.md", "docs/bound.md", "docs/accuracy.md", "docs/flight.md"],
    "Source": ["docs/tour.md", "docs/recipes.md", "docs/keypoint_network.md", "CONTRIBUTING.md", "CHANGELOG.md"],
}  # the headers' page is added to the last chapter
LINK = re.compile(r"(\]\()([^)#\s]+)((?:#[^)\s]*)?\))")
HEADERS = """# Headers of the flight software

<a href="api/index.html">Classes, functions and files of fsw/</a>, with shapes, units, frames, errors and the sources of equations as the headers state them.
"""
DOXYGEN = """PROJECT_NAME = "vbar flight software"
PROJECT_BRIEF = "Headers of fsw/ and its C interface, vbar_gnc.h"
INPUT = {root}/fsw
FILE_PATTERNS = *.h
RECURSIVE = YES
STRIP_FROM_PATH = {root}
EXTRACT_ALL = YES
JAVADOC_AUTOBRIEF = YES
GENERATE_LATEX = NO
OUTPUT_DIRECTORY = {out}
HTML_OUTPUT = api
HAVE_DOT = NO
QUIET = YES
WARNINGS = NO
WARN_IF_DOC_ERROR = NO
"""


def page_name(path):
    return "index.md" if path == "README.md" else pathlib.PurePath(path).name


class Site:
    def __init__(self, folder):
        self.folder = folder
        self.source = folder / "source"
        self.pages = [page for chapter in CHAPTERS.values() for page in chapter]

    def address_of(self, page, link):
        """Of a relative link, as seen from a page of the site; None if it leads to a folder, which the site does not have."""
        if "://" in link or link.startswith("mailto:"):
            return link
        target = ((ROOT / page).parent / link).resolve()
        if not target.is_relative_to(ROOT) or not target.exists():
            raise SystemExit(f"{page}: a link to {link}, which does not exist")
        path = str(target.relative_to(ROOT))
        if path in self.pages:
            return page_name(path)
        if target.is_dir():
            return None
        # A browser shows .txt and pictures, and would save most others.
        copy = pathlib.PurePath("files") / (path if target.suffix in (".png", ".svg", ".jpg") else path + ".txt")
        (self.source / copy).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(target, self.source / copy)
        return str(copy)

    def write_page(self, page):
        def rewritten(match):
            address = self.address_of(page, match[2])
            return f"{match[1]}{address}{match[3]}" if address else f"{match[1]}#{match[3].removeprefix('#')}"

        text = (ROOT / page).read_text(encoding="utf-8")
        (self.source / page_name(page)).write_text(LINK.sub(rewritten, text), encoding="utf-8")

    def write_settings(self):
        lines = ["site_name: vbar", f"docs_dir: {self.source}", f"site_dir: {self.folder / 'html'}", "theme: {name: mkdocs, highlightjs: false}",
                 "use_directory_urls: false", "plugins: [search]", "strict: true", "nav:"]
        for chapter, pages in CHAPTERS.items():
            lines += [f"  - {chapter}:"] + [f"    - {page_name(page)}" for page in pages]
        lines.append("    - headers.md")
        (self.folder / "mkdocs.yml").write_text("\n".join(lines) + "\n", encoding="utf-8")

    def build(self):
        forgotten = {str(p.relative_to(ROOT)) for p in (ROOT / "docs").glob("*.md")} - set(self.pages)
        if forgotten:
            raise SystemExit(f"in no chapter of ci/site.py: {', '.join(sorted(forgotten))}")
        shutil.rmtree(self.folder, ignore_errors=True)
        self.source.mkdir(parents=True)
        for page in self.pages:
            self.write_page(page)
        (self.source / "headers.md").write_text(HEADERS, encoding="utf-8")
        self.write_settings()
        subprocess.run(["mkdocs", "build", "--quiet", "--config-file", self.folder / "mkdocs.yml"], check=True)
        subprocess.run(["doxygen", "-"], input=DOXYGEN.format(root=ROOT, out=self.folder / "html"), text=True, check=True)


def main():
    if any(argument.startswith("-") for argument in sys.argv[1:]) or len(sys.argv) > 2:
        raise SystemExit(__doc__)
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) == 2 else ROOT / "build/site").resolve()
    Site(folder).build()
    print(folder / "html/index.html")


if __name__ == "__main__":
    main()
