"""Mutants of the kernels in ci/mutants.toml against the unit tests of their modules; called by ci/mutate.sh.

No library is built again: the linker directs all calls of the kernel (its option --wrap) to a function that calls the real one
and then corrupts what it returned. One link serves all mutations, of which the environment chooses one. A kernel's calls within
its own translation unit are not redirected.
"""

import argparse
import concurrent.futures
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
MUTATIONS = ["nan", "zero", "sign"]
SECONDS = 60  # time limit of a run: a mutant may result in an endless loop
CALLED = "this kernel is called"

WRAPPER = """
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include <Eigen/Geometry>

#include "fsw/core/result.h"
#include "@header@"

namespace {

bool is_mutation(const char* name) {
  const char* const asked = std::getenv("VBAR_MUTATION");
  return asked != nullptr && std::strcmp(asked, name) == 0;
}

template <class Number>
  requires std::is_floating_point_v<Number>
void mutate(Number& number) {
  static const bool to_nan = is_mutation("nan"), to_zero = is_mutation("zero"), to_negative = is_mutation("sign");
  if (to_nan) number = std::numeric_limits<Number>::quiet_NaN();
  if (to_zero) number = 0;
  if (to_negative) number = -number;
}
template <class Matrix>
void mutate(Eigen::PlainObjectBase<Matrix>& matrix) {
  for (Eigen::Index k = 0; k < matrix.size(); ++k) mutate(matrix.data()[k]);
}
void mutate(Eigen::Quaterniond& q) {  // the opposite of a rotation is its inverse
  if (is_mutation("sign")) {
    q = q.conjugate();
  } else {
    mutate(q.coeffs());
  }
}
template <class Number, std::size_t size>
void mutate(std::array<Number, size>& numbers) {
  for (Number& number : numbers) mutate(number);
}
template <class Number, std::size_t size>
void mutate(std::span<Number, size> numbers) {
  for (Number& number : numbers) mutate(number);
}
template <class Value>
void mutate(std::optional<Value>& value) {
  if (value) mutate(*value);
}

template <class Value, class Corrupt>
void corrupted(Value& value, const Corrupt& corrupt) {
  corrupt(value);
}
template <class Value, class Corrupt>
void corrupted(std::optional<Value>& result, const Corrupt& corrupt) {
  if (result) corrupt(*result);
}
template <class Value, class Corrupt>
void corrupted(vbar::fsw::Result<Value>& result, const Corrupt& corrupt) {
  if (!result.ok()) return;
  Value value = result.value();
  corrupt(value);
  result = value;
}

void note_call() {
  static const int noted = std::puts("@called@");
  static_cast<void>(noted);
}

}  // namespace

namespace @namespace@ {
@check@
@returns@ real_kernel(@parameters@) __asm__("__real_@symbol@");
@returns@ wrapped_kernel(@parameters@) __asm__("__wrap_@symbol@");
@returns@ wrapped_kernel(@parameters@) {
  note_call();
@body@
}
}  // namespace @namespace@
"""


def read_table(words):
    kernels = tomllib.loads((ROOT / "ci/mutants.toml").read_text(encoding="utf-8"))["kernel"]
    return [k for k in kernels if not words or any(w in k["name"] for w in words)]


def declaration(kernel):
    """What a kernel returns and takes, as its header declares it, without default arguments."""
    text = re.sub(r"//[^\n]*", "", (ROOT / kernel["header"]).read_text(encoding="utf-8"))
    if "of" in kernel:
        text = text[re.search(rf"\b(class|struct) {kernel['of']}\b[^;]*?{{", text).end():]
    name = kernel["name"].rsplit("::", 1)[1]
    found = re.findall(rf"(?:^|[;{{}}]|\n\s*\n)\s*(?:\[\[nodiscard\]\]\s*)?((?:[^;{{}}()])*?)\b{name}\(((?:[^;{{}}]|{{}})*?)\)"
                       r"(?:\s|const|noexcept)*[;{]", text)
    found = [(returns.strip(), ", ".join(re.sub(r"\s*=.*", "", p, flags=re.DOTALL) for p in split(" ".join(parameters.split()))))
             for returns, parameters in found if returns.split()[-1:] not in ([], ["return"]) and kernel.get("overload", "") in parameters]
    if len(found) != 1:
        raise ValueError(f"ci/mutants.toml: {kernel['header']} declares {kernel['name']} {len(found)} times")
    return found[0]


def split(parameters):
    """Parameters of a declaration, at the commas outside brackets."""
    found, depth, word = [], 0, ""
    for c in parameters:
        depth += (c in "(<[") - (c in ")>]")
        if c == "," and depth == 0:
            found.append(word.strip())
            word = ""
        else:
            word += c
    return found + [word.strip()]


def name_of(parameter):
    in_parentheses = re.search(r"\(&\s*(\w+)\)", parameter)
    return in_parentheses[1] if in_parentheses else re.search(r"\w+$", parameter)[0]


def wrapper_source(kernel, symbol):
    namespace = kernel["name"].rsplit("::", 2 if "of" in kernel else 1)[0]
    returns, parameters = declaration(kernel)
    check = ""
    if "of" in kernel:
        parameters = f"{kernel['of']}* self, {parameters}"
    else:  # the compiler compares the declaration with the table's
        check = f"[[maybe_unused]] {returns} (*const declared)({parameters}) = &{kernel['name']};"
    names = ", ".join(name_of(p) for p in split(parameters))
    lines = [e if "mutate(" in e else f"mutate({e})" for e in kernel.get("corrupt", ["value"])]
    corrupt = "; ".join(lines) + ";"
    if returns == "void":
        body = f"  real_kernel({names});\n  {corrupt}"
    else:
        body = f"  {returns} result = real_kernel({names});\n" \
               f"  corrupted(result, []([[maybe_unused]] auto& value) {{ {corrupt} }});\n  return result;"
    text = WRAPPER
    for key, value in {"header": kernel["header"], "called": CALLED, "namespace": namespace, "check": check, "returns": returns,
                       "parameters": parameters, "symbol": symbol, "body": body}.items():
        text = text.replace(f"@{key}@", value)
    return text


class Build:
    """Build commands of a test program."""

    def __init__(self, folder):
        self.folder = folder

    def commands(self, program):
        text = subprocess.run(["ninja", "-C", self.folder, "-t", "commands", program], check=True, capture_output=True, text=True)
        return text.stdout.strip().split("\n")

    def link(self, program):
        """The command that links it."""
        line = next(l for l in reversed(self.commands(program)) if l.startswith(": && "))
        return shlex.split(line.removeprefix(": && ").split(" && ")[0])

    def compile(self, program, source, target):
        """The command that compiles the program's first source, for another one: unoptimised, without the precompiled header."""
        first = next(w for w in self.link(program) if w.endswith(".o"))
        line = next(l for l in self.commands(program) if f" -o {first} " in l)
        old = shlex.split(line)
        old = old[next(k for k, w in enumerate(old) if re.search(r"(g|clang)\+\+[-\d]*$", w)):]
        new, k = [], 0
        while k < len(old):
            if old[k] in {"-include", "-MT", "-MF", "-o", "-c"}:
                if old[k] == "-include" and "cmake_pch" not in old[k + 1]:
                    new += old[k:k + 2]
                k += 2
                continue
            if old[k] not in {"-MD", "-O2", "-O1", "-g1", "-Werror", "-Wshadow"}:
                new.append(old[k])
            k += 1
        return new + ["-O0", "-w", "-o", target, "-c", source]

    def symbol(self, kernel, words):
        """The linker's name of the kernel, from the libraries that the program is linked with."""
        libraries = [w for w in words if w.endswith(".a") and not w.startswith("/usr")]
        names = [subprocess.run(["nm", "--defined-only", *options, *libraries], cwd=self.folder, check=True, capture_output=True,
                                text=True).stdout.split("\n") for options in ([], ["-C"])]
        found = {plain.split()[2] for plain, readable in zip(*names)
                 if re.match(r"[0-9a-f]+ T " + re.escape(kernel["name"]) + r"\(", readable) and kernel.get("overload", "") in readable}
        if len(found) != 1:
            raise ValueError(f"{kernel['name']}: {len(found)} functions of this name in {', '.join(libraries)}")
        return found.pop()


def call(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise ValueError(f"{shlex.join(map(str, command))[-300:]}\n{done.stdout}{done.stderr}")


def run(program, tests, mutation):
    """Result of a test program: 'passed', or how a mutant is detected; and its output."""
    environment = {**os.environ, "VBAR_MUTATION": mutation, "GTEST_FILTER": tests, "GTEST_FAIL_FAST": "1", "GTEST_BRIEF": "1"}
    try:
        done = subprocess.run([program], env=environment, capture_output=True, text=True, errors="replace", timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "time limit", ""
    verdict = "passed" if done.returncode == 0 else "failed" if done.returncode == 1 else "crashed"
    return verdict, done.stdout


def judge(build, kernel, scratch):
    """Verdicts by mutation."""
    words = build.link(kernel["program"])
    symbol = build.symbol(kernel, words)
    source, compiled, mutant = (str(scratch / (symbol + kernel["program"])) + end for end in (".cpp", ".o", ""))
    pathlib.Path(source).write_text(wrapper_source(kernel, symbol), encoding="utf-8")
    call(build.compile(kernel["program"], source, compiled), build.folder)
    output_at = words.index("-o")  # the wrapper before the libraries, because it references the real kernel
    call([*words[:output_at], compiled, f"-Wl,--wrap={symbol}", "-o", mutant, *words[output_at + 2:]], build.folder)
    verdict, output = run(mutant, kernel["tests"], "none")
    if verdict != "passed":
        raise ValueError(f"{kernel['name']}: its tests do not pass before it is changed: {verdict}\n{output[-2000:]}")
    if CALLED not in output and kernel["tests"] != "-*":
        raise ValueError(f"{kernel['name']}: {kernel['program']} with {kernel['tests']} does not call it")
    verdicts = {mutation: run(mutant, kernel["tests"], mutation)[0] for mutation in MUTATIONS}
    pathlib.Path(mutant).unlink()
    return verdicts


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("words", nargs="*")
    parser.add_argument("--programs", action="store_true", help="only names the test programs, for a build")
    parser.add_argument("--build", default=ROOT / "build/host", type=pathlib.Path)
    parser.add_argument("--tests", help="this filter for all kernels; -* is a test that cannot fail")
    options = parser.parse_args()
    kernels = read_table(options.words)
    for kernel in kernels:  # before anything is built
        try:
            declaration(kernel)
        except (ValueError, OSError) as error:
            sys.exit(f"{error}")
    if not kernels:
        sys.exit(f"no kernel of ci/mutants.toml has {' or '.join(options.words)} in its name")
    if options.programs:
        print(*sorted({k["program"] for k in kernels}))
        return
    survivors = 0
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        build = Build(options.build)
        for kernel in kernels:
            kernel["tests"] = options.tests or kernel["tests"]
        names = [kernel["name"].removeprefix("vbar::") for kernel in kernels]
        tests = [f"{kernel['program']} {kernel['tests']}" for kernel in kernels]
        widths = [2 + max(len(text) for text in column) for column in (names, tests)]
        print(f"{'kernel':{widths[0]}}{'tests':{widths[1]}}" + "".join(f"{m:12}" for m in MUTATIONS).rstrip())
        judged = [pool.submit(judge, build, kernel, pathlib.Path(scratch)) for kernel in kernels]
        for name, test, verdicts in zip(names, tests, judged):
            try:
                verdicts = verdicts.result()
            except ValueError as error:
                pool.shutdown(cancel_futures=True)
                sys.exit(f"{error}")
            survivors += sum(v == "passed" for v in verdicts.values())
            words = [f"{'SURVIVED' if v == 'passed' else v:12}" for v in verdicts.values()]
            print(f"{name:{widths[0]}}{test:{widths[1]}}{''.join(words).rstrip()}", flush=True)
    print(f"{len(kernels)} kernels, {len(kernels) * len(MUTATIONS)} mutants, {survivors} survived")
    sys.exit(1 if survivors else 0)


if __name__ == "__main__":
    main()
