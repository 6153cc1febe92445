"""The checker finds each banned expression and accepts expressions that only resemble one."""

import unittest

from check_terms import NAMES, TERMS, findings

BREACHES = """
an attitude that is none
it is no value of that column
a quaternion that is no rotation
the filter is told of the camera
what the telemetry tells
the fate of an image
the obstacle met first
the attitude is taken anew
an honest filter
mends broken frames
the place in doubt
strangers are ignored
so many images
while the target is in the dark
the push fades
what pushes the two apart
nobody on board
the filter knows it
follows by the slope
its matt part
lets go of the integers
forgets the epochs
the board is put to rest
folded in at its time
what became of the image
worked out once
turns about N
a whole number of cycles
handed over by navigation
the camera shall look there
wherever it runs
done by ones
""".strip().split("\n")

CLEAN = """
returns nullptr if there is none
if there is no star within the margin
the result is no longer valid
at least one, at most four
above the dark level
a turnover of one day
the least-squares solution
whole-second spans
rests on this assumption
wholesale
""".strip().split("\n")

NAME_BREACHES = ["constexpr int kLeastRows = 3;", "constexpr int kMost = 4;", "double least_rate = 0.0;", "int x_most = 0;",
                 "filter.absorb_turn();", "struct Pushes {};", "PoseFate fate() const;", "report.obstacle = x;",
                 "int doubts_ = 0;", "constexpr double kLittle = 1e-6;"]
NAME_CLEAN = ["Solver::kLeastSquares", "least_squares_only()", "least_norm_correction(x)", "p.acceleration_psd_least",
              "message.fate = x;", "message.obstacle = y;", "message.keypoint_fate[k] = z;", "queue.push(x);",
              "telemetry_gnss::kObstacleSearch", 'print("kMost");']


class CheckTerms(unittest.TestCase):
    def test_each_expression_is_found_in_documents_and_comments(self):
        for line in BREACHES:
            for path, text in [("docs/page.md", line), ("fsw/orbit/example.h", "int a;  ///< " + line),
                               ("boards/examples/example.c", "/* first line\n * " + line + " */"),
                               ("missions/example.toml", "key = 1.0  # " + line)]:
                with self.subTest(text):
                    self.assertTrue(list(findings(path, text)))

    def test_each_pattern_has_a_breach(self):
        for patterns, breaches in [(TERMS, BREACHES), (NAMES, NAME_BREACHES)]:
            for pattern, _ in patterns:
                with self.subTest(pattern.pattern):
                    self.assertTrue(any(pattern.search(line) for line in breaches))

    def test_expressions_that_resemble_one_are_accepted(self):
        for line in CLEAN:
            with self.subTest(line):
                self.assertEqual([], list(findings("docs/page.md", line)))

    def test_names(self):
        for line in NAME_BREACHES:
            with self.subTest(line):
                self.assertTrue(list(findings("fsw/gnc/example.cpp", line)))
        for line in NAME_CLEAN:
            with self.subTest(line):
                self.assertEqual([], list(findings("fsw/gnc/example.cpp", line)))

    def test_code_in_documents_and_strings_in_sources_do_not_count(self):
        self.assertEqual([], list(findings("docs/page.md", "`fate`\n\n    told\n\n```\nanew\n```\n[x](honest.md)")))
        self.assertEqual([], list(findings("fsw/gnc/example.cpp", 'print("told");')))
        self.assertEqual([], list(findings("ci/example.sh", "echo 'told' # a command")))

    def test_lines_keep_their_numbers(self):
        self.assertEqual([3], [n for n, _, _ in findings("fsw/gnc/x.h", "/* one\n two */ int a;\n// told\n")])


if __name__ == "__main__":
    unittest.main()
