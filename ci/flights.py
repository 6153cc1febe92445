"""One run of a mission by the program, for the scripts that verify."""
import datetime
import hashlib
import json
import pathlib
import subprocess

COMPLETE = (0, 10, 12)  # exit codes of vbar run whose run reached its end, whatever the verdict on its mission
ZYNQ = ["flight_computer.target=zynq_qemu", "flight_computer.link=udp"]


def flown_before(program, root, folder, overrides):
    """The summary of a complete run in `folder` by the same program with the same overrides, begun after the last change of a mission
    file; else None."""
    try:
        summary = json.loads((folder / "summary.json").read_text())
        flown = summary["provenance"]
        begun = datetime.datetime.fromisoformat(flown["started_utc"].replace("Z", "+00:00")).timestamp()
    except (OSError, ValueError, KeyError):
        return None
    same = (summary["complete"] and flown["program_sha256"] == hashlib.sha256(pathlib.Path(program).read_bytes()).hexdigest()
            and flown["overrides"] == list(overrides)
            and all(file.stat().st_mtime < begun for file in (root / "missions").rglob("*.toml")))
    return summary if same else None


def fly(build, root, mission, folder, seed=None, overrides=(), reuse=False):
    """Its summary; ends the script where it fails. With `reuse`, a run that the folder holds already is not flown again."""
    overrides = ([f"mission.seed={seed}"] if seed is not None else []) + list(overrides)
    if reuse and (summary := flown_before(build / "vbar", root, folder, overrides)) is not None:
        return summary
    command = [str(build / "vbar"), "run", mission, "--force", "--out", str(folder)]
    for override in overrides:
        command += ["--set", override]
    result = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=3600)
    if result.returncode not in COMPLETE:
        raise SystemExit(f"{' '.join(command[1:])}: {result.stderr.strip()}")
    return json.loads((folder / "summary.json").read_text())
