"""The checkers find what they are there to find: one breach of each kind, and the things that only look like one."""

import unittest

from check_layers import BEGIN, END, Table, draft, findings as layer_findings, matches, picture, section_of
from check_objects import shared_with_other_objects, strangers
from check_sources import findings, without_comments_and_strings

BREACHES = """
#include <vector>
#include <cmath>
#include <iostream>
#include <chrono>
#include "host_sim/engine/clock.h"
auto* p = new Thing;
delete p;
void* q = malloc(3);
throw 1;
auto* d = dynamic_cast<Thing*>(p);
virtual void f();
goto out;
long double x;
assert(x > 0);
printf(x);
Eigen::MatrixXd m;
double s = std::sin(x);
double t = sin(x);
double u = ::floor(x);
while (true) {}
for (;;) {}
std::string name;
std::vector<int> v;
""".strip().split("\n")

CLEAN = """
#include <array>
#include <Eigen/Core>
#include "fsw/math/math.h"
::new (memory) Thing;
Thing(const Thing&) = delete;
static_assert(sizeof(int) == 4);
double s = math::sin(x);
double t = vbar::fsw::math::floor(x);
double n = v.array().abs().maxCoeff();
step_time(x); set_clock(y);
while (place > 0 && next()) --place;
std::array<std::uint8_t, 3> bytes{};
// new std::vector<int>, throw, sin(x)
const char* text = "assert(false); /* malloc(3)";
std::size_t million = 1'000'000; new (memory) Thing;
""".strip().split("\n")


class CheckSources(unittest.TestCase):
    def test_each_breach_is_found(self):
        for line in BREACHES:
            with self.subTest(line):
                self.assertTrue(list(findings("fsw/orbit/example.cpp", line)))

    def test_what_only_looks_like_a_breach_is_not(self):
        for line in CLEAN:
            with self.subTest(line):
                self.assertEqual([], list(findings("fsw/orbit/example.cpp", line)))

    def test_lines_keep_their_numbers(self):
        text = "a;\n/* one\n two */\nstd::string s;\n"
        self.assertEqual([4], [number for number, _ in findings("fsw/gnc/example.cpp", text)])
        self.assertEqual(text.count("\n"), without_comments_and_strings(text).count("\n"))

    def test_a_folders_allowance_ends_with_the_folder(self):
        for path, number in [("boards/zynq7000/uart.cpp", 0), ("boards/common/outbox.cpp", 2), ("boards/zynq7000_linux/x.cpp", 2)]:
            self.assertEqual(number, len(list(findings(path, "#include <atomic>\nstd::atomic<int> a;\n"))), path)


class CheckObjects(unittest.TestCase):
    def test_open_calls_are_strangers(self):
        first = "archive.a[a.o]:\nvbar_f T 0 10\nvbar_g U         \nmemcpy U         \nmalloc U         \nsin U\n"
        second = "archive.a[b.o]:\nvbar_g T 0 10\nvbar_gnc_step U\n__aeabi_uldivmod U\nweak_one w\n"
        self.assertEqual(["malloc", "sin", "weak_one"], strangers([first, second])[0])

    def test_an_object_for_special_processors_defines_nothing_that_others_may(self):
        listing = "a.a[sums.cpp.o]:\ncommon W 0 10\na.a[sums_avx2.cpp.o]:\nmine T 0 10\nhidden t 0 10\ncommon W 0 10\na.a[b.cpp.o]:\nother W 0 1\n"
        self.assertEqual(["common"], shared_with_other_objects(listing))


LAYERS = """
folders = ["fsw", "host"]
[[floor]]
name = "ground"
rooms = { "fsw/core" = [], "fsw/math" = [] }
[[floor]]
name = "flight"
rooms = { "fsw/orbit" = ["fsw/*"] }
[[floor]]
name = "host"
rooms = { "host" = ["fsw/**"], "host/*/wire" = [] }
"""
TREE = {
    "fsw/core/core.h": "#pragma once\n",
    "fsw/math/math.h": "#pragma once\n",
    "fsw/orbit/roe.h": '#include "fsw/core/core.h"\n',
    "fsw/orbit/roe.cpp": '#include "roe.h"\n// #include "host/sim/run.h"\n/*\n#include "host/sim/run.h"\n*/\n#include "fsw/math/math.h"\n',
    "host/sim/run.h": '#include "fsw/orbit/roe.h"\n#include <host/sim/wire/frame.h>\n',
    "host/sim/wire/frame.h": "",
}


class CheckLayers(unittest.TestCase):
    def found(self, changes=None, table=LAYERS):
        return list(layer_findings(Table(table), {**TREE, **(changes or {})}))

    def test_a_tree_that_keeps_to_its_table_has_no_findings(self):
        self.assertEqual([], self.found())

    def test_an_include_of_a_higher_floor_is_named_with_file_line_and_rule(self):
        found = self.found({"fsw/math/math.h": '#pragma once\n#include "host/sim/run.h"\n'})
        self.assertIn('fsw/math/math.h:2: "host/sim/run.h": room fsw/math may not include room host, only no other room; '
                      "it is not below: floor 1 includes floor 3", found)

    def test_each_include_that_is_changed_is_found(self):
        for path in TREE:
            for other in ("host/sim/run.h", "fsw/orbit/roe.h"):
                room, target = Table(LAYERS).room_of(path)[0], Table(LAYERS).room_of(other)[0]
                if room == target or (room, target) == ("host", "fsw/orbit"):
                    continue
                with self.subTest(f"{path} includes {other}"):
                    found = self.found({path: TREE[path] + f'#include "{other}"\n'})
                    self.assertTrue(any(line.startswith(f"{path}:{TREE[path].count(chr(10)) + 1}:") for line in found), found)

    def test_a_header_that_is_generated_is_in_the_room_of_its_path(self):
        self.assertEqual(1, len(self.found({"fsw/math/math.h": '#include "fsw/core/generated.h"\n'})))

    def test_rooms_that_include_each_other_are_named(self):
        found = self.found({"fsw/math/math.h": '#include "fsw/orbit/roe.h"\n'})
        self.assertIn("rooms that include each other: fsw/math, fsw/orbit; by fsw/math -> fsw/orbit, fsw/orbit -> fsw/math", found)

    def test_a_room_that_the_table_lacks_is_named(self):
        found = self.found({"fsw/link/frame.h": "", "fsw/link/batch.h": ""})
        self.assertEqual(["tests/flight_rules/layers.toml: lacks the room fsw/link (2 files, the first is fsw/link/frame.h)"], found)

    def test_entries_that_are_upward_without_use_or_without_rooms_are_named(self):
        for old, new, what in [('"fsw/math" = []', '"fsw/math" = ["fsw/orbit"]', "not below floor 1 (ground)"),
                               ('"host/*/wire" = []', '"host/*/wire" = ["fsw/core"]', "which no file of it does"),
                               ('"fsw/core" = []', '"fsw/core" = ["fsw/link"]', "which names no other room"),
                               ('"host/*/wire" = []', '"host/*/line" = []', "holds no file")]:
            with self.subTest(new):
                found = self.found(table=LAYERS.replace(old, new))
                self.assertEqual(1, len(found), found)
                self.assertIn(what, found[0])

    def test_the_longest_folder_is_the_room(self):
        rooms = [Table(LAYERS).room_of(path)[0] for path in ("host/sim/run.h", "host/sim/wire/frame.h", "host/sim/wire/old/frame.h", "other/a.h")]
        self.assertEqual(["host", "host/sim/wire", "host/sim/wire", None], rooms)

    def test_patterns(self):
        self.assertTrue(all(matches(*pair) for pair in [("fsw/**", "fsw"), ("fsw/**", "fsw/vision/pose"), ("fsw/*", "fsw/core"), ("**", "a")]))
        self.assertFalse(any(matches(*pair) for pair in [("fsw/*", "fsw/vision/pose"), ("fsw/**", "fswx"), ("fsw", "fsw/core")]))

    def test_a_draft_of_the_table_passes(self):
        self.assertEqual([], self.found(table="\n".join(draft(Table(LAYERS), TREE))))

    def test_a_draft_names_the_includes_that_close_a_cycle(self):
        lines = draft(Table(LAYERS), {**TREE, "fsw/math/math.h": '#include "fsw/orbit/roe.h"\n'})
        self.assertEqual(['# cycle: fsw/math/math.h:1 of fsw/math includes "fsw/orbit/roe.h" of fsw/orbit'], [line for line in lines if "cycle" in line])

    def test_the_picture_changes_with_an_include(self):
        before = picture(Table(LAYERS), TREE)
        self.assertIn("  fsw_orbit --> fsw_core\n", before)
        self.assertNotEqual(before, picture(Table(LAYERS), {**TREE, "fsw/math/math.h": '#include "fsw/core/core.h"\n'}))
        self.assertEqual(before, section_of(f"# Page\n\n{before}\n\nmore\n"))
        self.assertIsNone(section_of(f"{END} {BEGIN}"))


if __name__ == "__main__":
    unittest.main()
