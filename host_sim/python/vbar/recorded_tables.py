"""Tables of a run folder by the standard library alone, for programs that are run without pandas."""
import csv
import datetime
import json
import pathlib

# Leap seconds of the years that missions are flown in: a run across one has no uniform UTC.
LEAP_SECONDS = tuple(datetime.datetime.fromisoformat(day) for day in ("2012-07-01", "2015-07-01", "2017-01-01"))


class RunError(Exception):
    """A sentence for the user."""


def number(cell):
    return float(cell) if cell else float("nan")


def is_number(cell):
    try:
        number(cell)
    except ValueError:
        return False
    return True


class RecordedRun:
    """The tables of a run, each a dictionary of columns, which are lists of cells."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.read_summary()
        self.tables = {path.stem: self._read(path) for path in sorted(self.folder.glob("*.csv"))}
        if "truth" not in self.tables:
            raise RunError(f"{self.folder}: no truth.csv: its mission has record.tables = false")

    def read_summary(self):
        try:
            self.summary = json.loads((self.folder / "summary.json").read_text())
            epoch = self.summary["provenance"]["epoch_utc"]
        except (OSError, ValueError, KeyError) as error:
            raise RunError(f"{self.folder}: no summary.json with provenance.epoch_utc: not the folder of a run that has ended ({error})") from None
        self.name = self.summary.get("mission", self.folder.name)
        self.epoch = datetime.datetime.fromisoformat(epoch.removesuffix("Z"))

    @staticmethod
    def _read(file):
        with open(file, newline="", encoding="utf-8") as lines:
            rows = list(csv.reader(lines))
        return {name: [row[k] for row in rows[1:]] for k, name in enumerate(rows[0])}

    def numbers(self, table, *columns):
        """Tuples of the numbers of columns, row by row; an empty cell is NaN."""
        return list(zip(*([number(cell) for cell in self.tables[table][column]] for column in columns)))

    def utc(self, time_s):
        """The UTC of a time after the epoch of the mission."""
        time = self.epoch + datetime.timedelta(seconds=time_s)
        for leap in LEAP_SECONDS:
            if self.epoch < leap <= time:
                raise RunError(f"{self.folder}: the run crosses the leap second before {leap:%Y-%m-%d}, and is not exported")
        return time
