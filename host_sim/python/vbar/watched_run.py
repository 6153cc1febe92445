"""A run folder that grows: its page, and its rows as they come."""
import pathlib
import subprocess
import tempfile
import threading
import time

from vbar.programs import program

PAGE_S = 2.0             # age of a page that is served again
MOST_LINES = 2000        # of a table in one event


class WatchedRun:
    """A run folder that grows."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.lock, self.made, self.made_s = threading.Lock(), "", -PAGE_S

    def files(self):
        """{table: file}; a table that is complete has a file without .part."""
        found = {}
        for end in (".csv.part", ".csv"):
            for file in self.folder.glob(f"*{end}"):
                found[file.name.removesuffix(end)] = file
        return found

    def has_ended(self):
        return (self.folder / "truth.csv").exists() and not any(self.folder.glob("*.csv.part"))

    def page(self):
        """The page of all rows until now, made by vbar view; viewers that come together have the same."""
        with self.lock:
            if time.monotonic() - self.made_s > PAGE_S:
                self.made, self.made_s = self._make(), time.monotonic()
            return self.made

    def _make(self):
        with tempfile.TemporaryDirectory(prefix="vbar-watch-") as scratch:
            file = pathlib.Path(scratch) / "view.html"
            done = subprocess.run([program(), "view", str(self.folder), "--out", str(file)], capture_output=True, text=True)
            if done.returncode != 0:
                raise RuntimeError(done.stderr.strip())
            return file.read_text(encoding="utf-8")


class Reader:
    """The rows of a run behind those that a viewer has."""

    def __init__(self, run, counts):
        self.run, self.counts, self.open = run, counts, {}

    def new_rows(self):
        """{table: {"columns": names, "rows": lines}} of whole lines since the last call, at most MOST_LINES of each table."""
        news = {}
        for table, file in self.run.files().items():
            try:
                if table not in self.open:
                    stream = open(file, encoding="utf-8", newline="\n")
                    self.open[table] = [stream, "", None]
                    for _ in range(1 + self.counts.get(table, 0)):
                        self._line(table)
                lines = []
                while len(lines) < MOST_LINES and (line := self._line(table)) is not None:
                    lines.append(line)
            except OSError:
                continue  # renamed at this moment: its other name is there next time
            if lines:
                news[table] = {"columns": self.open[table][2], "rows": lines}
        return news

    def _line(self, table):
        """The next whole line; the first one is that of the columns. None if there is none yet."""
        stream, rest, columns = self.open[table]
        rest += stream.readline()
        if not rest.endswith("\n"):
            self.open[table][1] = rest
            return None
        self.open[table][1] = ""
        if columns is None:
            self.open[table][2] = rest.rstrip("\n").split(",")
        return rest.rstrip("\n")

    def close(self):
        for stream, _, _ in self.open.values():
            stream.close()
