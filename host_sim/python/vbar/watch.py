"""vbar watch: the page of a run on 127.0.0.1 while the run goes on.

A process of its own reads the tables as they grow: a viewer cannot delay the run, or change a bit of it. The address has a token;
requests of another Host or from pages of another Origin are refused. GET TOKEN/ is the page with all rows until now, TOKEN/events the rows that
follow as server-sent events, from the counts of rows that the page has.
"""
import argparse
import hmac
import http.server
import json
import os
import pathlib
import secrets
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse

from vbar.programs import program

PAGE_S = 2.0             # age of a page that is served again
PERIOD_S = 0.5           # between two looks at the files
MOST_LINES = 2000        # of a table in one event
STALL_S = 5.0            # a viewer that takes nothing for so long is left
LAST_LOOK_S = 30.0       # the page is served so long after the run has ended
POLICY = "img-src data: blob:"


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


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "vbar", ""

    def log_message(self, *_):
        pass

    def refuse(self, code, sentence):
        body = (sentence + "\n").encode()
        self.send_response(code)
        self.send_header("Content-Type", "text/plain; charset=utf-8")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def is_allowed(self):
        """Whether the request is for this address and, if a page made it, from this address."""
        hosts = {f"{name}:{self.server.server_address[1]}" for name in ("127.0.0.1", "localhost")}
        origin = self.headers.get("Origin")
        return self.headers.get("Host") in hosts and (origin is None or origin.removeprefix("http://") in hosts)

    def do_GET(self):  # noqa: N802
        self.connection.settimeout(STALL_S)
        address = urllib.parse.urlsplit(self.path)
        token, _, name = address.path.lstrip("/").partition("/")
        if not self.is_allowed():
            return self.refuse(403, "refused: another Host or Origin")
        if not hmac.compare_digest(token.encode(), self.server.token.encode()):
            return self.refuse(404, "not found")
        try:
            if name == "":
                return self.send_page()
            if name == "events":
                return self.send_events(urllib.parse.parse_qs(address.query))
        except (OSError, ValueError):
            self.close_connection = True  # the viewer left, or takes nothing
            return None
        return self.refuse(404, "not found")

    def send_page(self):
        try:
            page = self.server.run.page()
        except RuntimeError as error:
            return self.refuse(503, f"the run has no page yet: {error}")
        body = page.replace(POLICY, f"{POLICY}; connect-src 'self'", 1).encode()
        self.send_response(200)
        for header, value in (("Content-Type", "text/html; charset=utf-8"), ("Content-Length", str(len(body))), ("Cache-Control", "no-store"),
                              ("X-Content-Type-Options", "nosniff"), ("Referrer-Policy", "no-referrer"), ("X-Frame-Options", "DENY")):
            self.send_header(header, value)
        self.end_headers()
        self.wfile.write(body)
        return None

    def send_events(self, query):
        counts = {table: int(values[-1]) for table, values in query.items()}
        self.send_response(200)
        for header, value in (("Content-Type", "text/event-stream"), ("Cache-Control", "no-store"), ("Connection", "close")):
            self.send_header(header, value)
        self.end_headers()
        self.close_connection = True
        reader = Reader(self.server.run, counts)
        try:
            while not self.server.is_over.is_set():
                ended = self.server.run.has_ended()
                while news := reader.new_rows():
                    self.send_event("rows", news)
                if ended:
                    return self.send_event("end", {})
                self.wfile.write(b":\n\n")  # finds out whether the viewer is there
                time.sleep(PERIOD_S)
        finally:
            reader.close()
        return None

    def send_event(self, name, value):
        self.wfile.write(f"event: {name}\ndata: {json.dumps(value)}\n\n".encode())


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, run, port):
        super().__init__(("127.0.0.1", port), Handler)
        self.run, self.token, self.is_over = run, secrets.token_urlsafe(16), threading.Event()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.server_address[1]}/{self.token}/"

    def handle_error(self, request, client_address):
        """A connection that breaks concerns no other."""


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
    parser = argparse.ArgumentParser(prog="vbar watch", description="serve the page of a run on 127.0.0.1 while the run goes on")
    parser.add_argument("run", type=pathlib.Path, help="run folder")
    parser.add_argument("--port", type=int, default=0, help="by default any free one")
    parser.add_argument("--of-run", type=int, metavar="PID", help="of the run that started this program: it ends soon after that")
    options = parser.parse_args(arguments)
    run = WatchedRun(options.run)
    os.nice(10)  # the run comes first
    if options.of_run is None and not run.files():
        parser.error(f"{options.run}: no tables: not a run folder")
    try:
        server = Server(run, options.port)
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
