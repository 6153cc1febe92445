"""No dead link in the documentation: files and headings that it links to exist. Usage: links_test.py ROOT."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv[1])
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def anchors(page):
    """Of its headings, as the common renderers form them."""
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    found = set()
    for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE):
        plain = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower())
        found.add(plain.replace(" ", "-"))
    return found


def dead_links(page):
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    text = re.sub(r"^(?: {4}|\t).*$", "", text, flags=re.MULTILINE)  # code
    for link in LINK.findall(re.sub(r"`[^`\n]*`", "", text)):
        if "://" in link or link.startswith("mailto:"):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists():
            yield link
        elif anchor and (target.suffix != ".md" or anchor not in anchors(target)):
            yield link


class Links(unittest.TestCase):
    def test_pages_are_found(self):
        self.assertGreater(len(PAGES), 20)

    def test_no_link_is_dead(self):
        self.assertEqual([(str(page.relative_to(ROOT)), link) for page in PAGES for link in dead_links(page)], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
