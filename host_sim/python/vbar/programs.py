"""The program vbar that belongs to this package."""
import os
import pathlib
import shutil


def program():
    """$VBAR, the program beside this package, or the first one of PATH."""
    if "VBAR" in os.environ:
        return os.environ["VBAR"]
    here = pathlib.Path(__file__).resolve().parent
    for beside in (here.parents[1] / "vbar", here.parents[3] / "bin" / "vbar"):
        if os.access(beside, os.X_OK) and beside.is_file():
            return str(beside)
    found = shutil.which("vbar")
    if not found:
        raise FileNotFoundError("the program vbar is neither beside this package nor in PATH, and VBAR does not name it")
    return found


def data_folder():
    """The folder of data that belongs to this package: of the sources, or installed."""
    here = pathlib.Path(__file__).resolve()
    for parent in here.parents:
        for folder in (parent / "data", parent):
            if (folder / "gps").is_dir() and (folder / "bodies").is_dir():
                return folder
    raise FileNotFoundError(f"no folder data with gps and bodies above {here.parent}")
