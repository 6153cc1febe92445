"""vbar watch: the page of a run or a campaign on 127.0.0.1 while it goes on.

A process of its own reads the tables as they grow: a viewer cannot delay the run, or change a bit of it. The address has a token;
requests of another Host or from pages of another Origin are refused. GET TOKEN/ is the page with all rows until now, TOKEN/events the rows that
follow as server-sent events, from the counts of rows that the page has. Of a run with --view-control the page changes the pace by POST TOKEN/pace.
"""
import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

from vbar.page_server import Refusal, Server
from vbar.programs import program
from vbar.watched_campaign import CampaignSite

PAGE_S = 2.0             # age of a page that is served again
PERIOD_S = 0.5           # between two looks at the files
MOST_LINES = 2000        # of a table in one event
LAST_LOOK_S = 30.0       # the page is served so long after the run has ended
REQUESTS = 3             # descriptor of the pipe to the run


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


class RunSite:
    """What is served of a run."""

    def __init__(self, run, pace=None):
        self.run, self.pace = run, pace
        self.routes = {("GET", ""): self.page, ("GET", "events"): self.events}
        if pace:
            self.routes["POST", "pace"] = self.change_pace

    def page(self, viewer, _):
        try:
            page = self.run.page()
        except RuntimeError as error:
            raise Refusal(503, f"the run has no page yet: {error}") from error
        viewer.send_page(page)

    def change_pace(self, viewer, _):
        self.pace.ask(viewer.json_body())
        viewer.send(200, "application/json", json.dumps(self.pace.state).encode())

    def events(self, viewer, query):
        counts = {table: int(values[-1]) for table, values in query.items()}
        viewer.send_response(200)
        for header, value in (("Content-Type", "text/event-stream"), ("Cache-Control", "no-store"), ("Connection", "close")):
            viewer.send_header(header, value)
        viewer.end_headers()
        viewer.close_connection = True
        reader, sent_pace = Reader(self.run, counts), None

        def send(name, value):
            viewer.wfile.write(f"event: {name}\ndata: {json.dumps(value)}\n\n".encode())
        try:
            while not viewer.server.is_over.is_set():
                ended = self.run.has_ended()
                if self.pace and self.pace.state != sent_pace:
                    sent_pace = self.pace.state
                    send("pace", sent_pace)
                while news := reader.new_rows():
                    send("rows", news)
                if ended:
                    return send("end", {})
                viewer.wfile.write(b":\n\n")  # finds out whether the viewer is there
                time.sleep(PERIOD_S)
        finally:
            reader.close()
        return None


class Pace:
    """The pace of a run started with --view-control: requests go to its clock through a pipe, a line each."""
    SPEEDS = 1e-3, 1e6

    def __init__(self, pipe, speed):
        self.pipe, self.lock, self.state = pipe, threading.Lock(), {"paused": False, "speed": speed}

    def ask(self, request):
        """{"do": "pause", "go_on" or "step"} or {"speed": simulated seconds per second}."""
        (key, value), *others = [*request.items()] or [(None, None)]
        if others or key not in ("do", "speed"):
            raise Refusal(400, 'pace: accepted: one of the keys "do" and "speed"')
        if key == "do":
            if value not in ("pause", "go_on", "step"):
                raise Refusal(400, f'do: found {json.dumps(value)[:40]}; accepted: "pause", "go_on", "step"')
            line, change = value, {"paused": value != "go_on"}
        else:
            if type(value) not in (int, float) or not self.SPEEDS[0] <= value <= self.SPEEDS[1]:
                raise Refusal(400, f"speed: found {json.dumps(value)[:40]}; accepted: {self.SPEEDS[0]:g} to {self.SPEEDS[1]:g}")
            line, change = f"speed {value}", {"speed": value}
        with self.lock:
            try:
                os.write(self.pipe, f"{line}\n".encode())
            except BlockingIOError as error:
                raise Refusal(503, "the run has not yet taken the requests before this one") from error
            except BrokenPipeError as error:
                raise Refusal(409, "the run has ended") from error
            self.state = self.state | change


def wait(of_run):
    """Until the run that started this program has ended and its viewers have had time to read it; else until it is interrupted."""
    while of_run is None or os.getppid() == of_run:
        time.sleep(PERIOD_S)
    time.sleep(LAST_LOOK_S)


def leave_output():
    """Closes the pipes of the run: who reads them waits for the run alone."""
    with open(os.devnull, "w") as nothing:
        for stream in (1, 2):
            os.dup2(nothing.fileno(), stream)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="vbar watch", description="serve the page of a run or a campaign on 127.0.0.1 while it goes on")
    parser.add_argument("run", type=pathlib.Path, help="folder of a run or a campaign")
    parser.add_argument("--port", type=int, default=0, help="by default any free one")
    parser.add_argument("--of-run", type=int, metavar="PID", help="of the run that started this program: it ends soon after that")
    parser.add_argument("--control", type=float, metavar="SPEED", help=argparse.SUPPRESS)  # of a run that takes requests from the pipe
    options = parser.parse_args(arguments)
    os.nice(10)  # the run comes first
    if (options.run / "campaign.json").is_file():
        site = CampaignSite(options.run)
    else:
        site = RunSite(WatchedRun(options.run), Pace(REQUESTS, options.control) if options.control else None)
        if options.of_run is None and not site.run.files():
            parser.error(f"{options.run}: neither tables nor a campaign.json: not a run folder, nor that of a campaign")
    try:
        server = Server(site, options.port)
    except (OSError, OverflowError) as error:
        parser.error(f"--port {options.port}: {error}")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print(f"watch   {server.address}", file=sys.stderr, flush=True)
    if options.of_run is not None:
        leave_output()
    try:
        wait(options.of_run)
    except KeyboardInterrupt:
        pass
    server.is_over.set()
    return 0
