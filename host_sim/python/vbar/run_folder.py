"""Runs of vbar as tables of pandas.

    import vbar
    run = vbar.run("runs/experiment3-1")
    run.truth, run["telemetry_health"], run.summary["dv_mps"], run.units("truth")["relative_position_rtn_r_m"]
    run.plot("navigation").savefig("navigation.png")

Cells have the bits of the files. A run that goes on, or was killed, is read as far as its files are whole.
"""
import functools
import io
import json
import pathlib
import subprocess

import pandas

from vbar.programs import program

# Endings of the names of columns, and their units. A name without one of them is a number of its own, or a word.
UNITS = {"m": "m", "km": "km", "mm": "mm", "mps": "m/s", "mmps": "mm/s", "m2": "m^2", "rad": "rad", "radps": "rad/s", "deg": "deg",
         "arcsec": "arcsec", "s": "s", "h": "h", "ms": "ms", "us": "us", "ns": "ns", "px": "px", "px2": "px^2", "dn": "DN",
         "dbhz": "dB Hz", "kg": "kg", "kgm2": "kg m^2", "n": "N"}
# The axis t or n of a vector without a unit is not a unit.
AXES = ("rtn_n", "prefit_s")


def unit_of(column):
    """The unit that the name of a column ends in; empty for a number without unit, and for a word."""
    return "" if column.endswith(AXES) else UNITS.get(column.rpartition("_")[2], "") if "_" in column else ""


@functools.cache
def _columns():
    """{table: {column: meaning}}, as vbar columns states them."""
    text = subprocess.run([program(), "columns", "--markdown"], check=True, capture_output=True, text=True).stdout
    tables, columns = {}, {}
    for line in text.splitlines():
        if line.startswith("## "):
            columns = tables.setdefault(line[3:].strip().removesuffix(".csv"), {})
        elif line.startswith("| `"):
            names, meaning = line.strip("| ").split(" | ", 1)
            columns.update({name.strip("` "): meaning for name in names.split(",")})
    return tables


def read_table(file):
    """A table of a run: numbers with the bits of their cells, empty ones NaN. Of a file that is being written the whole lines."""
    text = file.read_text()
    table = pandas.read_csv(io.StringIO(text[:text.rfind("\n") + 1]), float_precision="round_trip", keep_default_na=False, na_values=[""])
    table.attrs["units"] = {column: unit_of(column) for column in table.columns}
    return table


class Run:
    """A run folder. Tables are attributes, or items, and are read when they are first asked for."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.name = self.folder.name
        self._tables = {}
        if not self.folder.is_dir():
            raise FileNotFoundError(f"{self.folder} is not a folder")
        if not self._file("truth"):
            raise FileNotFoundError(f"{self.folder} has no truth.csv: it is not a run folder, or its mission has record.tables = false")

    def _file(self, table):
        return next((file for end in (".csv", ".csv.part") if (file := self.folder / f"{table}{end}").is_file()), None)

    @property
    def tables(self):
        """The names of the tables of this run."""
        return sorted({path.name.partition(".")[0] for end in (".csv", ".csv.part") for path in self.folder.glob(f"*{end}")})

    def __getitem__(self, table):
        if table not in self._tables:
            file = self._file(table)
            if not file:
                raise KeyError(f"{self.folder} has no table {table}; it has {', '.join(self.tables)}")
            self._tables[table] = read_table(file)
        return self._tables[table]

    def __getattr__(self, table):
        if table.startswith("_"):
            raise AttributeError(table)
        try:
            return self[table]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __repr__(self):
        return f"Run({str(self.folder)!r}: {', '.join(self.tables)})"

    @functools.cached_property
    def summary(self):
        """summary.json; empty until the run has ended."""
        file = self.folder / "summary.json"
        return json.loads(file.read_text()) if file.is_file() else {}

    def units(self, table):
        """{column: unit} of a table."""
        return self[table].attrs["units"]

    def columns(self, table):
        """Columns of a table with their units and meanings."""
        meanings = _columns().get(table, {})
        return pandas.DataFrame([(column, unit_of(column), meanings.get(column, "")) for column in self[table].columns],
                                columns=["column", "unit", "meaning"])

    def errors(self):
        """Estimated minus true relative state at each step, its sigmas, and the difference over the sigma."""
        both = self.estimate.merge(self.truth, on="time_s", suffixes=("", "_true"))
        table = pandas.DataFrame({"time_s": both.time_s})
        for quantity, unit in (("position", "m"), ("velocity", "mps")):
            for axis in "rtn":
                column, sigma = f"relative_{quantity}_rtn_{axis}_{unit}", both[f"sigma_rtn_{axis}_{unit}"]
                error = both[column] - both[f"{column}_true"]
                table[f"{quantity}_error_{axis}_{unit}"], table[f"{quantity}_sigma_{axis}_{unit}"] = error, sigma
                table[f"{quantity}_error_{axis}_over_sigma"] = error / sigma
        table.attrs["units"] = {column: unit_of(column) for column in table.columns}
        return table

    def plot(self, name):
        """A standard figure of matplotlib: relative, navigation, roe or burns."""
        from vbar import figures
        return figures.figure(self, name)


def run(folder):
    """The run of a folder."""
    return Run(folder)


def start(mission, out, settings=None, seed=None):
    """Flies a mission (a file, or a name that vbar missions lists) into the folder `out`, and returns the run.

    settings: {key: value} as of vbar run --set, such as {"mission.duration_h": 0.5}. A run that did not achieve its mission is
    returned as well: run.summary["verdict"]. RuntimeError has the sentence of vbar if nothing was flown.
    """
    command = [program(), "run", str(mission), "--out", str(out), "--quiet"]
    for key, value in (({} if seed is None else {"mission.seed": seed}) | (settings or {})).items():
        command += ["--set", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 10, 12):
        raise RuntimeError(done.stderr.strip() or f"vbar run ended with exit code {done.returncode}")
    return Run(out)
