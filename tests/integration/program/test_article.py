"""Flight software of a user: created, built and flown outside the repository with the installed package."""
import os
import shutil
import subprocess
import unittest

from vbar_program import BINARY, ZYNQ_IMAGE, hashes, main, missing, overrides, scratch, summary_of, vbar

# From waypoint 7 on, where the examples can fly.
SHORT = ("mission.start_h=36", "mission.duration_h=0.5", "spacecraft.target.relative.waypoint=7")


def run(*command, cwd):
    result = subprocess.run(list(map(str, command)), cwd=cwd, capture_output=True, text=True, timeout=300)
    if result.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: {result.stdout}{result.stderr}")


def install(prefix):
    """The build trees that exist; whether the board's is one of them."""
    has_board = missing(ZYNQ_IMAGE) is None
    for tree in (BINARY, ZYNQ_IMAGE.parent) if has_board else (BINARY,):
        run("cmake", "--install", tree, "--prefix", prefix, cwd=prefix.parent)
    return has_board


class NewArticle(unittest.TestCase):
    def fly(self, program, folder, *settings):
        result = subprocess.run([str(program), "run", "ideal_navigation", "--quiet", "--out", str(folder), *overrides(*SHORT, *settings)],
                                cwd=folder.parent, capture_output=True, text=True, timeout=300,
                                env={key: value for key, value in os.environ.items() if key != "VBAR_DATA"})
        self.assertEqual(result.returncode, 0, result.stderr)
        return summary_of(folder)

    def check_without_the_board(self, prefix, project):
        """One sentence, at the build: the configuration is no error of ten lines."""
        if shutil.which("arm-none-eabi-gcc") is None:
            return
        run("cmake", "-S", ".", "-B", "build-zynq", f"-DCMAKE_PREFIX_PATH={prefix}",
            "--toolchain", prefix / "lib/cmake/vbar/arm-none-eabi-zynq7000.cmake", cwd=project)
        built = subprocess.run(["cmake", "--build", "build-zynq"], cwd=project, capture_output=True, text=True, timeout=300)
        self.assertNotEqual(built.returncode, 0)
        self.assertIn(f"cmake --install build/zynq --prefix {prefix}", built.stdout)

    def check(self, language, prefix, has_board):
        project = prefix.parent / f"my-{language.replace('+', 'p')}"
        program = prefix / "bin/vbar"
        run(program, "new-article", project, "--language", language, cwd=prefix.parent)
        readme = (project / "README.md").read_text()
        self.assertIn(str(prefix), readme, "the commands name the prefix")
        self.assertIn("spacecraft.target.relative.waypoint=7", readme, "the first flight is one that the example can fly")
        run("cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={prefix}", cwd=project)
        run("cmake", "--build", "build", cwd=project)
        library = project / "build" / f"lib{project.name}.so"
        shared = self.fly(program, project / "shared", f"flight_computer.library={library}")
        self.assertTrue(shared["complete"])
        self.assertGreater(shared["maneuvers"], 0)
        if not has_board:
            self.check_without_the_board(prefix, project)
            return
        run("cmake", "-S", ".", "-B", "build-zynq", f"-DCMAKE_PREFIX_PATH={prefix}",
            "--toolchain", prefix / "lib/cmake/vbar/arm-none-eabi-zynq7000.cmake", cwd=project)
        run("cmake", "--build", "build-zynq", cwd=project)
        board = self.fly(program, project / "board", "flight_computer.target=zynq_qemu", "flight_computer.link=udp",
                         f"flight_computer.image={project / 'build-zynq' / (project.name + '.elf')}")
        self.assertEqual(hashes(board), hashes(shared), "the same bits")

    def test_in_both_languages_from_an_installed_prefix(self):
        with scratch() as folder:
            prefix = folder / "prefix"
            prefix.mkdir()
            has_board = install(prefix)
            for language in ("c", "c++"):
                with self.subTest(language):
                    self.check(language, prefix, has_board)
            if not has_board:
                print(missing(ZYNQ_IMAGE))


class FaultyArticle(unittest.TestCase):
    """Flight software that fails without a crash is counted, step by step and packet by packet."""

    def test_errors_are_counted_and_named(self):
        library = BINARY / "tests/unit/pil_bridge/libvbar_article_with_faults.so"
        if missing(library):
            self.skipTest(missing(library))
        with scratch() as folder:
            for fault, expected in ((6, {"steps_failed": "all", "last_status": 12345, "packets_invalid": "all", "packets_dropped": "all", "steps_silent": 0}),
                                    (9, {"steps_failed": 0, "last_status": 0, "steps_silent": "all", "packets_invalid": 0})):
                result = vbar("run", "ideal_navigation", "--force", "--out", folder / "run",
                              *overrides("mission.duration_h=0.3", f"spacecraft.servicer.number={fault}", f"flight_computer.library={library}"))
                output = summary_of(folder / "run")["flight_output"]
                steps = summary_of(folder / "run")["flight_step"]["count"]
                self.assertGreater(steps, 10)
                for key, value in expected.items():
                    self.assertEqual(output[key], steps if value == "all" else value, key)
                self.assertIn(f"{steps} of {steps} steps {'returned an error' if fault == 6 else 'sent nothing'}", result.stdout)

    def test_an_image_for_another_machine(self):
        with scratch() as folder:
            text = folder / "image"
            text.write_text("a text")
            for image in (text, "/bin/true"):
                for target in ("zynq_qemu", "zynq_linux_qemu"):
                    result = vbar("run", "ideal_navigation", "--force", "--out", folder / "run", *overrides(
                        "mission.duration_h=0.3", f"flight_computer.target={target}", f"flight_computer.image={image}"))
                    self.assertEqual(result.returncode, 1, result.stderr)
                    self.assertIn(f"flight_computer.image '{image}': found ", result.stderr)
                    self.assertIn("accepted: an ELF executable for 32-bit ARM", result.stderr)
            result = vbar("run", "ideal_navigation", "--force", "--out", folder / "run", *overrides(
                "mission.duration_h=0.3", "flight_computer.target=zynq_qemu", f"flight_computer.image={folder}"))
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn(f"flight_computer.image '{folder}': is a folder or a device", result.stderr)


class NewArticleBadInput(unittest.TestCase):
    def refused(self, sentence, *arguments):
        result = vbar("new-article", *arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(sentence, result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1)

    def test_one_sentence_and_nothing_is_written(self):
        with scratch() as folder:
            used = folder / "used"
            used.mkdir()
            (used / "mine").write_text("")
            self.refused("a new or an empty folder is accepted", used)
            self.refused("accepted: letters", folder / "my gnc")
            self.refused("accepted: c, c++", folder / "new", "--language", "ada")
            self.assertEqual(sorted(file.name for file in folder.iterdir()), ["used"])

    def test_an_image_that_does_not_exist_or_is_of_no_use(self):
        with scratch() as folder:
            result = vbar("run", "ideal_navigation", "--out", folder / "run", *overrides(*SHORT, "flight_computer.target=zynq_qemu",
                          "flight_computer.image=/nonexistent.elf"))
            self.assertEqual(result.returncode, 1)
            self.assertIn("flight_computer.image '/nonexistent.elf': there is no such file", result.stderr)
            result = vbar("run", "ideal_navigation", "--check", *overrides("flight_computer.image=/nonexistent.elf"))
            self.assertEqual(result.returncode, 2)
            self.assertIn("unless target is zynq_qemu", result.stderr)


if __name__ == "__main__":
    main()
