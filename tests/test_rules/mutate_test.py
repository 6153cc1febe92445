"""ci/mutate.py reports a mutant that a test does not notice, and one that it does. Usage: mutate_test.py ROOT BUILD_FOLDER."""

import pathlib
import subprocess
import sys
import unittest

ROOT, BUILD = (pathlib.Path(argument) for argument in sys.argv[1:3])
sys.path.insert(0, str(ROOT / "ci"))
from mutate import declaration, name_of, read_table, split  # noqa: E402


def mutate(*arguments):
    return subprocess.run([sys.executable, ROOT / "ci/mutate.py", "--build", BUILD, *arguments], capture_output=True, text=True)


class Mutate(unittest.TestCase):
    def test_a_test_that_cannot_fail_lets_all_survive(self):
        done = mutate("--tests=-*", "sun_position_gcrf")
        self.assertEqual(1, done.returncode, done.stderr)
        self.assertEqual(3, done.stdout.count("SURVIVED"), done.stdout)
        self.assertIn("1 kernels, 3 mutants, 3 survived", done.stdout)

    def test_a_test_that_does_not_call_the_kernel_is_refused(self):
        done = mutate("--tests=Rtn.*", "sun_position_gcrf")
        self.assertEqual(1, done.returncode)
        self.assertIn("does not call it", done.stderr)

    def test_the_kernels_own_test_detects_all(self):
        done = mutate("sun_position_gcrf")
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        self.assertIn("1 kernels, 3 mutants, 0 survived", done.stdout)

    def test_a_word_of_no_kernel_is_refused(self):
        done = mutate("no_such_kernel")
        self.assertEqual(1, done.returncode)
        self.assertIn("no kernel of ci/mutants.toml has no_such_kernel in its name", done.stderr)

    def test_the_table_is_complete(self):
        kernels = read_table([])
        self.assertGreaterEqual(len(kernels), 20)
        for kernel in kernels:
            with self.subTest(kernel["name"]):
                self.assertLessEqual({"name", "header", "program", "tests"}, set(kernel))
                returns, parameters = declaration(kernel)
                self.assertTrue(returns)
                self.assertTrue(all(name_of(p) for p in split(parameters)))

    def test_a_declaration_is_read_from_the_header(self):
        kernel = {"name": "vbar::fsw::gnss::single_point", "header": "fsw/gnss/single_point.h"}
        returns, parameters = declaration(kernel)
        self.assertEqual("Result<SinglePoint>", returns)
        self.assertNotIn("=", parameters)  # no default arguments
        with self.assertRaisesRegex(ValueError, "declares vbar::fsw::gnss::no_such_kernel 0 times"):
            declaration({**kernel, "name": "vbar::fsw::gnss::no_such_kernel"})

    def test_parameters_are_split_outside_brackets(self):
        parameters = split("std::span<float, kChunk> numbers, const double (&shape)[33], int k")
        self.assertEqual(["numbers", "shape", "k"], [name_of(p) for p in parameters])


if __name__ == "__main__":
    if not (BUILD / "tests/unit/fsw_orbit_test").exists():
        print("fsw_orbit_test is not built")
        sys.exit(77)  # skipped
    unittest.main(argv=sys.argv[:1])
