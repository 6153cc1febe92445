"""The checkers find what they are there to find: one breach of each kind, and the things that only look like one."""

import unittest

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


if __name__ == "__main__":
    unittest.main()
