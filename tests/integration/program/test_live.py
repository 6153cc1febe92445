"""vbar run --view: the page of a run that goes on, which no viewer changes."""
import contextlib
import http.client
import json
import os
import re
import signal
import socket
import sys
import threading
import time
import unittest
import urllib.parse

from test_view import need_page
from vbar_program import COMPLETE, SOURCE, children_of, fly, hashes, main, overrides, scratch, start, summary_of, vbar

sys.path.insert(0, str(SOURCE / "tests" / "integration" / "view"))
import browser  # noqa: E402

EXPERIMENT3 = SOURCE / "missions" / "experiment3.toml"
LIMIT_S = 60
DURATION = "mission.duration_h=0.1"


@contextlib.contextmanager
def watched(folder, seconds):
    """A run that takes about so many seconds, and the address of its page."""
    settings = overrides(DURATION, "clock.mode=real_time", f"clock.speed_factor={360 / seconds}", "clock.compute_budget_s=60")
    run = start("run", EXPERIMENT3, "--out", folder, "--view", *settings)
    viewers = []
    try:
        for line in run.stderr:
            if found := re.fullmatch(r"watch   (http://127\.0\.0\.1:\d+/\S+/)\n", line):
                break
            assert line.startswith("vbar"), line
        viewers = children_of(run.pid)
        deadline = time.monotonic() + LIMIT_S
        while not list(folder.glob("truth.csv*")) and time.monotonic() < deadline:
            time.sleep(0.05)
        yield run, urllib.parse.urlsplit(found[1])
        run.wait(timeout=LIMIT_S)
    finally:
        run.kill()
        for pid in viewers:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGTERM)
        run.stdout.close()
        run.stderr.close()


def get(address, path, **headers):
    connection = http.client.HTTPConnection(address.hostname, address.port, timeout=LIMIT_S)
    connection.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
    return connection, connection.getresponse()


def events(address, counts=""):
    """(name, value) of the events of a run until its end."""
    connection, answer = get(address, f"{address.path}events?{counts}")
    name = None
    try:
        for line in answer:
            text = line.decode().rstrip("\n")
            if text.startswith("event: "):
                name = text[7:]
            elif text.startswith("data: "):
                yield name, json.loads(text[6:])
                if name == "end":
                    return
    finally:
        connection.close()


class Live(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = scratch()
        cls.folder = cls.scratch.__enter__()
        fly(cls.folder / "alone", DURATION, mission=EXPERIMENT3)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.__exit__(None, None, None)

    def test_viewers_change_no_bit(self):
        """Ten that read, one that stalls, one that is gone, one that comes late and has all rows."""
        rows = [[] for _ in range(10)]

        def read(address, k):
            for name, value in events(address):
                rows[k] += value.get("truth", {}).get("rows", []) if name == "rows" else []
        with watched(self.folder / "watched", 8) as (run, address):
            viewers = [threading.Thread(target=read, args=(address, k)) for k in range(9)]
            for viewer in viewers:
                viewer.start()
            stalled = socket.create_connection((address.hostname, address.port))
            stalled.sendall(f"GET {address.path}events HTTP/1.1\r\nHost: {address.netloc}\r\n\r\n".encode())
            gone = socket.create_connection((address.hostname, address.port))
            gone.sendall(f"GET {address.path}events HTTP/1.1\r\nHost: {address.netloc}\r\n\r\n".encode())
            gone.close()
            run.wait(timeout=LIMIT_S)
            viewers.append(threading.Thread(target=read, args=(address, 9)))
            viewers[-1].start()
            for viewer in viewers:
                viewer.join(timeout=LIMIT_S)
            stalled.close()
            self.assertIn(run.returncode, COMPLETE)
        self.assertEqual(hashes(summary_of(self.folder / "watched")), hashes(summary_of(self.folder / "alone")))
        table = (self.folder / "watched" / "truth.csv").read_text().splitlines()[1:]
        for k in range(10):
            self.assertEqual(rows[k], table, k)

    def test_who_is_refused(self):
        with watched(self.folder / "refusing", 4) as (_, address):
            def status(path, **headers):
                connection, answer = get(address, path, **headers)
                answer.read()
                connection.close()
                return answer.status
            self.assertEqual(status("/"), 404)
            self.assertEqual(status("/" + "x" * 22 + "/events"), 404)
            self.assertEqual(status(address.path, Host="attacker.example"), 403)
            self.assertEqual(status(address.path, Origin="http://attacker.example"), 403)
            self.assertEqual(status(address.path, Origin="null"), 403)
            self.assertEqual(status(address.path + "summary.json"), 404)

    def test_rows_behind_those_of_a_viewer(self):
        with watched(self.folder / "counted", 4) as (run, address):
            run.wait(timeout=LIMIT_S)
            rows = [line for name, value in events(address, "truth=30") if name == "rows" for line in value["truth"]["rows"]]
        self.assertEqual(rows, (self.folder / "counted" / "truth.csv").read_text().splitlines()[31:])

    def test_no_run(self):
        result = vbar("watch", self.folder / "nothing")
        self.assertEqual(result.returncode, 2)
        self.assertIn("not a run folder", result.stderr)


class LiveInBrowser(unittest.TestCase):
    """The page of a folder that grows by hand: half of the rows of a run, then the others."""

    def test_the_page_follows_the_run(self):
        if not browser.program():
            self.skipTest(f"none of {', '.join(browser.PROGRAMS)} is installed")
        with scratch() as folder:
            fly(folder / "run", DURATION, mission=EXPERIMENT3)
            need_page(folder / "run")
            summary, texts = summary_of(folder / "run"), {}
            (folder / "run" / "summary.json").write_text(json.dumps(summary | {"complete": False, "incomplete_reason": "goes on"}))
            for file in (folder / "run").glob("*.csv"):
                lines = file.read_text().splitlines(keepends=True)
                texts[file.with_name(f"{file.name}.part")] = "".join(lines[1 + len(lines) // 2:])
                file.with_name(f"{file.name}.part").write_text("".join(lines[:1 + len(lines) // 2]))
                file.unlink()
            viewer = start("watch", folder / "run")
            try:
                address = re.fullmatch(r"watch   (\S+)\n", viewer.stderr.readline())[1]
                with browser.browser() as page:
                    page.show()
                    page.open(address)
                    before = page.evaluate("[vbarView.runs[0].table('truth').rows, vbarView.cursor.end, vbarView.cursor.t]")
                    self.assertEqual(before[1], before[2])
                    for part, text in texts.items():
                        with part.open("a") as file:
                            file.write(text)
                    whole = page.evaluate("""new Promise((done) => { const look = () => {
                      const { runs: [run], cursor } = vbarView;
                      if (cursor.end > %r) done([run.table('truth').rows, cursor.end, cursor.t, run.table('estimate').column('relative_position_rtn_t_m').cells.at(-1)]);
                      else setTimeout(look, 100); }; look(); })""" % before[1])
                    rows = [line.split(",") for line in (folder / "run" / "truth.csv.part").read_text().splitlines()]
                    self.assertEqual(whole[:3], [len(rows) - 1, float(rows[-1][0]), float(rows[-1][0])])
                    names, *_, last = [line.split(",") for line in (folder / "run" / "estimate.csv.part").read_text().splitlines()]
                    self.assertEqual(whole[3], last[names.index("relative_position_rtn_t_m")])
                    self.assertEqual(page.errors, [])
            finally:
                viewer.terminate()
                viewer.communicate(timeout=LIMIT_S)


if __name__ == "__main__":
    main()
