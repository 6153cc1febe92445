"""Configures the host build without optional libraries, with each of them alone, and with all of them.

usage: check_configure.py SOURCE CMAKE LIBRARY...
A library that is left out shall not be in any command of the build; one that is installed shall be. One folder serves all
combinations: what does not depend on the libraries is found once.
"""
import pathlib
import subprocess
import sys
import tempfile


def configure(cmake: str, source: str, build: pathlib.Path, libraries: list[str], chosen: set[str]) -> str:
    """The commands of the build; exits with the output of a configure that fails."""
    switches = [f'-DVBAR_WITH_{name}={"ON" if name in chosen else "OFF"}' for name in libraries]
    done = subprocess.run([cmake, '-S', source, '-B', str(build), '-G', 'Ninja', '-DVBAR_TESTS=OFF', '-DVBAR_PRECOMPILE=OFF', *switches],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f'with {", ".join(sorted(chosen)) or "no optional library"}: does not configure:\n{done.stdout}')
    missing = [name for name in chosen if f'({name}: ' in done.stdout]
    if missing:
        sys.exit(f'{", ".join(missing)}: not installed (ci/install.sh test)')
    return (build / 'build.ninja').read_text().lower()


def main() -> None:
    source, cmake, *libraries = sys.argv[1:]
    if len(libraries) < 2:
        sys.exit('found no list of optional libraries')
    combinations = [set(), *({name} for name in libraries), set(libraries)]
    with tempfile.TemporaryDirectory() as folder:
        for chosen in combinations:
            commands = configure(cmake, source, pathlib.Path(folder), libraries, chosen)
            for name in libraries:
                is_linked = f'lib{name.lower()}' in commands
                if is_linked and name not in chosen:
                    sys.exit(f'with {", ".join(sorted(chosen)) or "no optional library"}: the build names {name}')
                if not is_linked and chosen == set(libraries):
                    sys.exit(f'with all optional libraries: the build does not name {name}')
            print(f'configures with {", ".join(sorted(chosen)) or "no optional library"}', flush=True)


main()
