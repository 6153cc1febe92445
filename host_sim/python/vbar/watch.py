"""vbar watch: the page of a run or a campaign on 127.0.0.1 while it goes on.

A process of its own reads the tables as they grow: a viewer cannot delay the run, or change a bit of it. The address has a token;
requests of another Host or from pages of another Origin are refused. GET TOKEN/ is the page with all rows until now, TOKEN/events the rows that
follow as server-sent events, from the counts of rows that the page has. Of a run with --view-control the page changes the pace by POST TOKEN/pace.
TOKEN/foxglove is the run by Foxglove's WebSocket protocol.
"""
import argparse
import json
import os
import pathlib
import signal
import sys
import threading
import time

from vbar import foxglove
from vbar.page_server import Refusal, Server
from vbar.watched_campaign import CampaignSite
from vbar.watched_run import Reader, WatchedRun

PERIOD_S = 0.5           # between two looks at the files
LAST_LOOK_S = 30.0       # the page is served so long after the run has ended
REQUESTS = 3             # descriptor of the pipe to the run


class RunSite:
    """What is served of a run."""

    def __init__(self, run, pace=None):
        self.run, self.pace = run, pace
        feed = foxglove.Feed(run)
        self.routes = {("GET", ""): self.page, ("GET", "events"): self.events, ("GET", "foxglove"): lambda viewer, _: foxglove.serve(viewer, feed)}
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
    parser.add_argument("--origin", action="append", default=[], metavar="URL", help="a site whose pages may connect too, as https://app.foxglove.dev")
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
        server = Server(site, options.port, options.origin)
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
