"""One run of a mission by the program, for the scripts that verify."""
import json
import subprocess

ZYNQ = ["flight_computer.target=zynq_qemu", "flight_computer.link=udp"]


def fly(build, root, mission, folder, seed=None, overrides=()):
    """Its summary; ends the script where it fails."""
    command = [str(build / "vbar"), "run", mission, "--force", "--out", str(folder)]
    if seed is not None:
        command += ["--seed", str(seed)]
    for override in overrides:
        command += ["--set", override]
    result = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=3600)
    if result.returncode != 0:
        raise SystemExit(f"{' '.join(command[1:])}: {result.stderr.strip()}")
    return json.loads((folder / "summary.json").read_text())
