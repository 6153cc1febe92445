"""The checker finds each form that lets a NaN pass, and none of those that retain it."""

import unittest

from check_tests import findings

BREACHES = """
largest = std::max(largest, (a - b).norm());
largest = std::fmax(f(x, y), largest);
least = std::min<double>(least, x);
result.worst = std::max({std::abs(a), result.worst, std::abs(b)});
if (error > largest) largest = error;
if (largest < error) { largest = error; }
EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-9);
EXPECT_GE(v.minCoeff(), 0.0);
const double largest = v.lpNorm<Eigen::Infinity>();
EXPECT_LT(*std::max_element(v.begin(), v.end()), 1.0);
std::ranges::nth_element(v, v.begin());
EXPECT_FALSE(error > limit) << k;
ASSERT_FALSE(std::abs(f(x)) >= 1e-3);
if (std::abs(found - expected) > 1e-9) ++wrong;
if ((a - b).norm() > 0.1) return false;
""".strip().split("\n")

CLEAN = """
largest.add((a - b).norm());
const int side = std::max(width, height);
dt = std::min(seconds(part), seconds(end - now));
x = f(std::max(x, y));
x = std::max(x, 0.0) + y;
side = std::max<int>(side, width);
if (d < best[1]) { best[1] = d; place = k; }
// largest = std::max(largest, x);
if (k < count) ++k;
if (first < second) third = first;
EXPECT_LT(accuracy::largest_entry(a - b), 1e-9);
EXPECT_FALSE(list.empty()) << (a < b);
EXPECT_FALSE(static_cast<std::optional<int>>(x).has_value());
if (!(std::abs(found - expected) <= 1e-9)) ++wrong;
if ((a - b).norm() > 2.5) continue;
""".strip().split("\n")


class CheckTests(unittest.TestCase):
    def test_each_form_is_found(self):
        for line in BREACHES:
            with self.subTest(line):
                self.assertEqual([1], [number for number, _ in findings(line)])

    def test_what_retains_a_nan_is_not(self):
        for line in CLEAN:
            with self.subTest(line):
                self.assertEqual([], list(findings(line)))

    def test_over_the_end_of_a_line(self):
        text = "a;\nworst =\n    std::max(worst,\n             f(x));\nif (error > worst)\n  worst = error;\n"
        self.assertEqual([2, 5], [number for number, _ in findings(text)])


if __name__ == "__main__":
    unittest.main()
