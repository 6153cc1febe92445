"""vbar export: a run in the formats of other programs."""
import argparse
import pathlib
import sys

from vbar import czml_file, orbit_messages
from vbar.recorded_tables import RecordedRun, RunError


def write(file, data):
    """Writes the whole file or none."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(file.name + ".part")
    part.write_bytes(data if isinstance(data, bytes) else data.encode())
    part.replace(file)
    print(f"export  {file}")


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="vbar export", description="write a run in the formats of other programs (docs/other_programs.md)")
    parser.add_argument("run", help="run folder")
    parser.add_argument("--oem", metavar="FOLDER", type=pathlib.Path, help="orbits as CCSDS OEM, that of the estimated target with covariance")
    parser.add_argument("--aem", metavar="FOLDER", type=pathlib.Path, help="attitudes as CCSDS AEM")
    parser.add_argument("--czml", metavar="FILE", type=pathlib.Path, help="orbits and burns as CZML 1.0 for CesiumJS")
    parser.add_argument("--mcap", metavar="FILE", type=pathlib.Path, help="tables, frames, scene and pictures as MCAP in Protobuf")
    options = parser.parse_args(arguments)
    if not (options.oem or options.aem or options.czml or options.mcap):
        parser.error("none of --oem, --aem, --czml and --mcap is given")
    try:
        run = RecordedRun(options.run)
        for folder, messages in ((options.oem, orbit_messages.orbits), (options.aem, orbit_messages.attitudes)):
            for name, text in messages(run).items() if folder else ():
                write(folder / name, text)
        if options.czml:
            write(options.czml, czml_file.czml(run))
        if options.mcap:
            from vbar import mcap_file
            from vbar.run_channels import RunChannels
            file = mcap_file.Writer("vbar")
            RunChannels(run, file).add_new()
            write(options.mcap, file.finish())
    except (RunError, OSError) as error:
        print(f"vbar export: {error}", file=sys.stderr)
        return 2
    return 0
