"""vbar run --view: the page of a run that goes on, which no viewer changes."""
import contextlib
import http.client
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import unittest
import urllib.parse

from test_view import need_page
from vbar_program import BINARY, COMPLETE, SOURCE, children_of, fly, hashes, main, overrides, scratch, start, summary_of, vbar

sys.path.insert(0, str(SOURCE / "tests" / "integration" / "view"))
import browser  # noqa: E402
sys.path.insert(0, str(BINARY / "python"))
from vbar import foxglove, websocket  # noqa: E402
from vbar.watched_run import WatchedRun  # noqa: E402

EXPERIMENT3 = SOURCE / "missions" / "experiment3.toml"
PEERS = SOURCE / "tests" / "peers" / "mcap"
NODE_MODULES = SOURCE / "build" / "peers" / "mcap" / "node_modules"
LIMIT_S = 60
DURATION = "mission.duration_h=0.1"


@contextlib.contextmanager
def watched(folder, seconds, option="--view"):
    """A run that takes about so many seconds, and the address of its page."""
    settings = overrides(DURATION, "clock.mode=real_time", f"clock.speed_factor={360 / seconds}", "clock.compute_budget_s=60")
    run = start("run", EXPERIMENT3, "--out", folder, option, *settings)
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


def post(address, path, body, **headers):
    """(status, text) of the answer."""
    connection = http.client.HTTPConnection(address.hostname, address.port, timeout=LIMIT_S)
    connection.request("POST", address.path + path, body=body, headers=headers)
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer.status, text


def rows_of(folder):
    """The rows of truth that are in the folder."""
    for file in folder.glob("truth.csv*"):
        return len(file.read_text().splitlines()) - 1
    return 0


def wait_for_rows(folder, count):
    deadline = time.monotonic() + LIMIT_S
    while rows_of(folder) < count:
        assert time.monotonic() < deadline, f"{rows_of(folder)} of {count} rows"
        time.sleep(0.05)


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

    def test_pace_changes_no_bit(self):
        """Paused, stepped, at other speeds: the run of 100 h of wall-clock time ends by request alone, with the bits of the other."""
        with watched(self.folder / "paced", 3.6e5, "--view-control") as (run, address):
            viewer = events(address)
            self.assertEqual(next(viewer), ("pace", {"paused": False, "speed": 1e-3}))
            for request in ({"do": "pause"}, {"speed": 1e6}):
                self.assertEqual(post(address, "pace", json.dumps(request))[0], 200)
            wait_for_rows(self.folder / "paced", 1)
            for count in (2, 3, 4):
                before = rows_of(self.folder / "paced")
                self.assertEqual(post(address, "pace", '{"do": "step"}'), (200, json.dumps({"paused": True, "speed": 1e6})))
                wait_for_rows(self.folder / "paced", before + 1)
                self.assertEqual(rows_of(self.folder / "paced"), count)
            self.assertIsNone(run.poll())
            self.assertEqual(post(address, "pace", '{"do": "go_on"}')[0], 200)
            run.wait(timeout=LIMIT_S)
            self.assertEqual([value for name, value in viewer if name == "pace"][-1], {"paused": False, "speed": 1e6})
            self.assertEqual(post(address, "pace", '{"do": "pause"}'), (409, "the run has ended\n"))
        self.assertEqual(hashes(summary_of(self.folder / "paced")), hashes(summary_of(self.folder / "alone")))
        self.assertEqual((self.folder / "paced" / "truth.csv").read_bytes(), (self.folder / "alone" / "truth.csv").read_bytes())

    def test_which_pace_is_refused(self):
        with watched(self.folder / "uncontrolled", 4) as (_, address):
            self.assertEqual(post(address, "pace", '{"do": "pause"}')[0], 404)
        with watched(self.folder / "controlled", 3.6e5, "--view-control") as (run, address):
            for body, sentence in (("[]", "a JSON object"), ("{", "a JSON object"), ("[" * 999, "a JSON object"), ('{"do": "stop"}', '"go_on"'),
                                   ('{"speed": 0}', "0.001 to 1e+06"), ('{"speed": NaN}', "0.001"), ('{"speed": "9"}', "0.001"), ('{"speed": true}', "0.001"),
                                   ('{"do": "step", "speed": 1}', "one of the keys"), ("{}", "one of the keys"), (" " * 2000, "0 to 1000")):
                status, text = post(address, "pace", body)
                self.assertEqual(status, 400, body[:20])
                self.assertIn(sentence, text)
            for header in ({"Host": "attacker.example"}, {"Origin": "http://attacker.example"}, {"Origin": "null"}):
                self.assertEqual(post(address, "pace", '{"speed": 1000000}', **header)[0], 403)
            self.assertEqual(post(address._replace(path="/" + "x" * 22 + "/"), "pace", '{"speed": 1000000}')[0], 404)
            self.assertIsNone(run.poll())
            run.send_signal(signal.SIGINT)
        result = vbar("run", EXPERIMENT3, "--out", self.folder / "lock_step", "--view-control")
        self.assertEqual(result.returncode, 2)
        self.assertIn('--view-control: clock.mode: found "lock_step"; accepted: "real_time"', result.stderr)
        self.assertFalse((self.folder / "lock_step").exists())

    def test_no_run(self):
        result = vbar("watch", self.folder / "nothing")
        self.assertEqual(result.returncode, 2)
        self.assertIn("not a run folder, nor that of a campaign", result.stderr)


class LiveFoxglove(unittest.TestCase):
    """The run by Foxglove's WebSocket protocol."""

    def node(self, script, *arguments):
        node = shutil.which("node") or shutil.which("nodejs")
        if not node or not (NODE_MODULES / "ws").is_dir():
            self.skipTest(f"{NODE_MODULES} or node is missing: run tests/peers/wire_formats/install_npm.sh")
        result = subprocess.run([node, PEERS / script, NODE_MODULES, *map(str, arguments)], capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_its_own_client_reads_the_run(self):
        """@foxglove/ws-protocol while the run goes on: every row of the tables, with the bits of the files, in the channels of the MCAP file."""
        with scratch() as folder:
            fly(folder / "alone", DURATION, mission=EXPERIMENT3)
            truth = [line.split(",") for line in (folder / "alone" / "truth.csv").read_text().splitlines()]
            with watched(folder / "run", 4) as (_, address):
                read = self.node("subscribe.cjs", f"ws://{address.netloc}{address.path}foxglove", f"/tables/truth={len(truth) - 1}", f"/tf={2 * len(truth) - 2}")
            self.assertEqual(vbar("export", folder / "run", "--mcap", folder / "run.mcap").returncode, 0)
            file = self.node("read_mcap.cjs", folder / "run.mcap")["topics"]
            self.assertEqual(hashes(summary_of(folder / "run")), hashes(summary_of(folder / "alone")))
        self.assertEqual(read["info"]["op"], "serverInfo")
        for topic, schema in read["channels"].items():
            self.assertEqual(schema, file[topic]["schema"])
        rows, frames = read["topics"]["/tables/truth"], read["topics"]["/tf"]
        self.assertEqual((rows["count"], frames["count"]), (len(truth) - 1, 2 * len(truth) - 2))
        for message, row in ((rows["first"], truth[1]), (rows["last"], truth[-1])):
            self.assertEqual([message[name] for name in truth[0]], list(map(float, row)))
            self.assertEqual(int(message["time_ns"]), 10**9 * int(message["timestamp"]["seconds"]) + message["timestamp"]["nanos"])
        for one in ("first", "last"):
            self.assertEqual({name: frames[one][name] for name in ("translation", "rotation", "child_frame_id")},
                             {name: file["/tf"][one][name] for name in ("translation", "rotation", "child_frame_id")})

    def test_frames_of_the_standard(self):
        """RFC 6455, sections 1.3 and 5.7."""
        self.assertEqual(websocket.accept_key("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=")
        masked = bytearray.fromhex("818537fa213d7f9f4d5158")
        self.assertIsNone(websocket.take_frame(masked[:10]))
        self.assertEqual(websocket.take_frame(masked), (True, websocket.TEXT, b"Hello"))
        self.assertEqual(masked, b"")
        self.assertEqual(websocket.frame(websocket.TEXT, b"Hello").hex(), "810548656c6c6f")
        self.assertEqual(websocket.frame(websocket.BINARY, bytes(256))[:4].hex(), "827e0100")
        self.assertEqual(websocket.frame(websocket.BINARY, bytes(65536))[:10].hex(), "827f0000000000010000")
        for bad, code in (("810548656c6c6f", 1002), ("c18537fa213d7f9f4d5158", 1002), ("82ff0000000100000000", 1009)):
            with self.assertRaises(websocket.Closed) as raised:
                websocket.take_frame(bytearray.fromhex(bad))
            self.assertEqual(raised.exception.args[0], code)

    def test_a_table_whose_cells_become_text(self):
        """Its channel is replaced by one whose message holds all rows."""
        with scratch() as folder:
            fly(folder / "run", "mission.duration_h=0.02", mission=EXPERIMENT3)
            table = folder / "run" / "growing.csv"
            table.write_text("time_s,value\n1,2.5\n")
            feed = foxglove.Feed(WatchedRun(folder / "run"))

            def channel():
                return next(number for number, advert in feed.renew().items() if advert["topic"] == "/tables/growing")
            before = channel()
            self.assertEqual(len(feed.messages[before]), 1)
            table.write_text("time_s,value\n1,2.5\n2,none\n")
            feed.renewed_s -= 1.0
            after = channel()
            self.assertNotEqual(before, after)
            self.assertNotIn(before, feed.messages)
            self.assertEqual([b"2.5" in message or b"none" in message for _, message in feed.messages[after]], [True, True])

    def test_who_is_refused(self):
        with watched(self.enterContext(scratch()) / "run", 4) as (_, address):
            def answer(path=address.path, **headers):
                upgrade = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
                           "Sec-WebSocket-Protocol": "foxglove.websocket.v1"} | headers
                connection = http.client.HTTPConnection(address.hostname, address.port, timeout=LIMIT_S)
                connection.request("GET", f"{path}foxglove", headers={name: value for name, value in upgrade.items() if value})
                status = connection.getresponse().status
                connection.close()
                return status
            self.assertEqual(answer(), 101)
            self.assertEqual(answer(Origin=f"http://{address.netloc}"), 101)
            for headers, status in (({"Origin": "http://attacker.example"}, 403), ({"Host": "attacker.example"}, 403), ({"path": "/" + "x" * 22 + "/"}, 404),
                                    ({"Sec-WebSocket-Protocol": "other"}, 400), ({"Sec-WebSocket-Key": None}, 400), ({"Upgrade": None}, 400)):
                self.assertEqual(answer(**headers), status, headers)


CAMPAIGN = """[campaign]
name = "short"
description = "</title><script>document.title='x'</script>"
mission = "{mission}"
seeds = "1..2"
set = ["mission.duration_h=0.02"]
"""


class LiveCampaign(unittest.TestCase):
    def test_the_page_follows_the_campaign(self):
        """The page of a campaign of which one case is flown states that, and is the report once the other is, too."""
        with scratch() as folder:
            file, campaign = folder / "campaign.toml", folder / "campaign"
            file.write_text(CAMPAIGN.format(mission=EXPERIMENT3))
            self.assertEqual(vbar("campaign", "run", file, "--out", campaign, "--cases", "0").returncode, 75)
            viewer = start("campaign", "status", campaign, "--view")
            try:
                address = urllib.parse.urlsplit(re.fullmatch(r"watch   (\S+)\n", viewer.stderr.readline())[1])

                def page():
                    connection, answer = get(address, address.path)
                    text = answer.read().decode()
                    connection.close()
                    return answer, text
                answer, text = page()
                self.assertEqual((answer.status, answer.headers["Refresh"]), (200, "5"))
                self.assertRegex(text, "2 cases: (1 not_begun, 1 complete|1 complete, 1 not_begun)")
                self.assertNotIn("<script", text)
                self.assertIn("default-src 'none'", answer.headers["Content-Security-Policy"])
                self.assertEqual(vbar("campaign", "run", campaign).returncode, 0)
                deadline = time.monotonic() + LIMIT_S
                while "2 cases: 2 complete" not in text and time.monotonic() < deadline:
                    time.sleep(0.5)
                    answer, text = page()
                self.assertIn("2 cases: 2 complete", text)
                self.assertIsNone(answer.headers["Refresh"])
                self.assertIn((campaign / "campaign.html").read_text().split("<main>\n")[1], text)
                for path, headers, status in (("/", {}, 404), (address.path + "events", {}, 404), (address.path, {"Host": "attacker.example"}, 403)):
                    connection, answer = get(address, path, **headers)
                    self.assertEqual(answer.status, status)
                    connection.close()
            finally:
                viewer.terminate()
                viewer.communicate(timeout=LIMIT_S)


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


class LiveControlInBrowser(unittest.TestCase):
    def test_the_page_sets_the_pace(self):
        """Its buttons pause a run, let one step pass, and end it at another speed."""
        if not browser.program():
            self.skipTest(f"none of {', '.join(browser.PROGRAMS)} is installed")
        with scratch() as folder, watched(folder / "run", 3.6e5, "--view-control") as (run, address), browser.browser() as page:
            wait_for_rows(folder / "run", 1)
            connection, answer = get(address, address.path)
            connection.close()
            if answer.status == 503:
                self.skipTest("this build has no page")
            page.show()
            page.open(address.geturl())
            label = """new Promise((done) => { const look = () => { const [hold] = document.querySelectorAll('.pace:not([hidden]) button');
                hold?.textContent === %r ? done(document.querySelector('.pace select').value) : setTimeout(look, 100); }; look(); })"""
            self.assertEqual(page.evaluate(label % "Pause"), "0.001")
            page.evaluate("document.querySelector('.pace button').click()")
            page.evaluate(label % "Go on")
            for count in (2, 3):
                page.evaluate("document.querySelectorAll('.pace button')[1].click()")
                wait_for_rows(folder / "run", count)
            page.evaluate("{ const speed = document.querySelector('.pace select'); speed.value = '10000'; speed.dispatchEvent(new Event('change')); }")
            page.evaluate("document.querySelector('.pace button').click()")
            run.wait(timeout=LIMIT_S)
            self.assertIn(run.returncode, COMPLETE)
            self.assertEqual(page.errors, [])


if __name__ == "__main__":
    main()
