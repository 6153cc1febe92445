"""Pictures of the pages: each is there, is used, and states which run or model it was made of. Usage: pictures_test.py ROOT."""

import json
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv[1])
IMAGES = ROOT / "docs" / "images"
INDEX = json.loads((IMAGES / "index.json").read_text(encoding="utf-8"))
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")
TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")  # which has missions of its own
MAX_BYTES, MAX_BYTES_OF_ONE = 4_000_000, 2_000_000  # a clone and a page stay small


def named():
    """(page, text in place of the picture, file) of all pictures in the pages."""
    return [(page, text, (page.parent / link).resolve()) for page in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
            for text, link in PICTURE.findall(page.read_text(encoding="utf-8")) if "://" not in link]


class Pictures(unittest.TestCase):
    def test_each_picture_of_a_page_is_there_and_described(self):
        pictures = named()
        self.assertGreater(len(pictures), 10)
        for page, text, file in pictures:
            self.assertTrue(file.is_file(), f"{page}: {file}")
            self.assertGreater(len(text), 10, f"{page}: {file.name} has no description")

    def test_none_is_unused(self):
        files = {file for file in IMAGES.iterdir() if file.name != "index.json"}
        self.assertEqual(sorted(file.name for file in files - {file for _, _, file in named()}), [])

    def test_each_states_what_it_was_made_of(self):
        self.assertEqual(sorted(INDEX), sorted(file.name for file in IMAGES.iterdir() if file.name != "index.json"))
        for name, origins in INDEX.items():
            self.assertTrue(origins, name)
            for origin in origins:
                self.assertRegex(origin["commit"], r"^[0-9a-f]{7,40}$", f"{name}: of a tree with changes")
                if "model" in origin:
                    self.assertTrue((ROOT / "data" / "models" / f"{origin['model']}.obj").exists(), f"{name}: model {origin['model']}")
                elif f"File `{origin['mission']}.toml`" not in TUTORIAL:
                    self.assertTrue((ROOT / "missions" / f"{origin['mission']}.toml").is_file(), f"{name}: mission {origin['mission']}")

    def test_they_are_small(self):
        sizes = {file.name: file.stat().st_size for file in IMAGES.iterdir()}
        self.assertLessEqual(sum(sizes.values()), MAX_BYTES)
        self.assertLessEqual(max(sizes.values()), MAX_BYTES_OF_ONE, max(sizes, key=sizes.get))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
