"""What other programs read of a run: the Python package, CCSDS ephemerides, XTCE and datagrams, MCAP. Each is read back by a reader
that shares no code with its writer."""
import collections
import csv
import datetime
import importlib.util
import json
import math
import os
import pathlib
import shutil
import socket
import struct
import subprocess
import sys
import threading
import unittest
import xml.etree.ElementTree as xml

from vbar_program import BINARY, SKIP, SOURCE, fly, main, overrides, scratch, vbar

sys.path.insert(0, str(SOURCE / "tests" / "integration" / "view"))
from xtce_decoder import N, Decoder  # noqa: E402

EXPERIMENT3 = SOURCE / "missions" / "experiment3.toml"
NODE_MODULES = SOURCE / "build" / "peers" / "mcap" / "node_modules"


def rows_of(file):
    with open(file, newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def bits(value):
    return struct.pack(">d", float(value if value != "" else "nan"))


class ExitsRun(unittest.TestCase):
    """A flight of six minutes with GNSS."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = scratch()
        cls.folder = cls.scratch.__enter__()
        cls.run_folder = cls.folder / "run"
        cls.listen_while(lambda address: fly(cls.run_folder, "mission.duration_h=0.1", *address, mission=EXPERIMENT3))

    @classmethod
    def listen_while(cls, fly_it):
        fly_it([])

    @classmethod
    def tearDownClass(cls):
        cls.scratch.__exit__(None, None, None)


def key_values(lines):
    return {key.strip(): value.strip() for line in lines if "=" in line for key, value in [line.split("=", 1)]}


class ExitsEphemerides(ExitsRun):
    """OEM and AEM by a reader after CCSDS 502.0-B-2 and 504.0-B-1."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        result = vbar("export", cls.run_folder, "--oem", cls.folder / "oem", "--aem", cls.folder / "oem")
        assert result.returncode == 0, result.stderr
        cls.truth = rows_of(cls.run_folder / "truth.csv")
        cls.epoch = datetime.datetime.fromisoformat(json.loads((cls.run_folder / "summary.json").read_text())["provenance"]["epoch_utc"].rstrip("Z"))

    def read(self, name, end_of_meta="META_STOP"):
        text = (self.folder / "oem" / name).read_text()
        head, _, body = text.partition(end_of_meta)
        return key_values(head.splitlines()), [line for line in body.splitlines() if line]

    def seconds(self, text):
        return (datetime.datetime.fromisoformat(text) - self.epoch).total_seconds()

    def test_true_orbits(self):
        for craft in ("servicer", "target"):
            meta, lines = self.read(f"{craft}_true.oem")
            self.assertEqual((meta["CCSDS_OEM_VERS"], meta["REF_FRAME"], meta["CENTER_NAME"], meta["TIME_SYSTEM"]), ("2.0", "GCRF", "EARTH", "UTC"))
            self.assertEqual(len(lines), len(self.truth))
            for line, row in zip(lines, self.truth):
                time, *state = line.split()
                self.assertAlmostEqual(self.seconds(time), float(row["time_s"]), 6)
                for axis, position, velocity in zip("xyz", state[:3], state[3:]):
                    self.assertAlmostEqual(1e3 * float(position), float(row[f"{craft}_position_eci_{axis}_m"]), 8)  # a nanometre and its half
                    self.assertAlmostEqual(1e3 * float(velocity), float(row[f"{craft}_velocity_eci_{axis}_mps"]), 8)

    def test_estimated_orbit_with_covariance(self):
        """The relative position is near the estimate, whose sum of squares in any axes is the trace of the covariance."""
        _, lines = self.read("target_estimated.oem")
        begin = lines.index("COVARIANCE_START")
        estimates = {row["time_s"]: row for row in rows_of(self.run_folder / "telemetry_navigation.csv") if row["valid"] == "1"}
        self.assertEqual(begin, len(estimates))
        blocks = lines[begin + 1:-1]
        for k, (line, (time_s, row)) in enumerate(zip(lines, estimates.items())):
            time, *state = line.split()
            self.assertAlmostEqual(self.seconds(time), float(time_s), 6)
            offset = [1e3 * float(value) - float(row[f"servicer_position_eci_{axis}_m"]) for axis, value in zip("xyz", state)]
            relative = [float(row[f"relative_position_rtn_{axis}_m"]) for axis in "rtn"]
            self.assertAlmostEqual(math.hypot(*offset), math.hypot(*relative), 6)
            block = blocks[7 * k:7 * k + 7]
            self.assertEqual(block[0].split("=")[1].strip(), time)
            matrix = [[float(cell) for cell in text.split()] for text in block[1:]]
            self.assertEqual([len(part) for part in matrix], [1, 2, 3, 4, 5, 6])
            trace = 1e6 * sum(matrix[axis][axis] for axis in range(3))
            self.assertAlmostEqual(trace, sum(float(row[f"sigma_rtn_{axis}_m"]) ** 2 for axis in "rtn"), delta=1e-9 * trace)

    def test_attitudes(self):
        """The matrix of the standard's quaternion turns inertial components into those of the body, as the table's does."""
        table = [row for row in rows_of(self.run_folder / "attitude.csv") if row["spacecraft"] == "servicer"]
        meta, lines = self.read("servicer.aem", "DATA_START")
        self.assertEqual((meta["REF_FRAME_A"], meta["REF_FRAME_B"], meta["ATTITUDE_DIR"], meta["QUATERNION_TYPE"]),
                         ("GCRF", "SC_BODY_1", "A2B", "LAST"))
        self.assertEqual(len(lines) - 1, len(table))
        v = (0.3, -0.5, 0.8)
        for line, row in zip(lines, table):
            q1, q2, q3, qc = (float(cell) for cell in line.split()[1:])
            matrix = ((q1 * q1 - q2 * q2 - q3 * q3 + qc * qc, 2 * (q1 * q2 + q3 * qc), 2 * (q1 * q3 - q2 * qc)),
                      (2 * (q1 * q2 - q3 * qc), -q1 * q1 + q2 * q2 - q3 * q3 + qc * qc, 2 * (q2 * q3 + q1 * qc)),
                      (2 * (q1 * q3 + q2 * qc), 2 * (q2 * q3 - q1 * qc), -q1 * q1 - q2 * q2 + q3 * q3 + qc * qc))
            w, x, y, z = (float(row[f"q_body_eci_{axis}"]) for axis in "wxyz")
            # v + 2 w (u x v) + 2 u x (u x v) with the vector part u
            c = (y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0])
            d = (y * c[2] - z * c[1], z * c[0] - x * c[2], x * c[1] - y * c[0])
            for axis in range(3):
                self.assertAlmostEqual(sum(a * b for a, b in zip(matrix[axis], v)), v[axis] + 2 * w * c[axis] + 2 * d[axis], 12)

    def test_a_mission_starts_from_the_file(self):
        """By vbar's own reader of OEM: the state at an epoch of the file."""
        row = self.truth[6]
        epoch = (self.epoch + datetime.timedelta(seconds=float(row["time_s"]))).isoformat() + "Z"
        settings = (f"mission.epoch_utc={epoch}", "mission.start_h=0", "mission.duration_h=0.01", f"spacecraft.servicer.orbit_file={self.folder}/oem/servicer_true.oem")
        result = vbar("propagate", SOURCE / "missions" / "user_orbit_400km.toml", "--out", self.folder / "from_oem", *overrides(*settings))
        self.assertEqual(result.returncode, 0, result.stderr)
        first = rows_of(self.folder / "from_oem" / "servicer.csv")[0]
        for axis in "xyz":
            self.assertAlmostEqual(float(first[f"position_eci_{axis}_m"]), float(row[f"servicer_position_eci_{axis}_m"]), 7)
            self.assertAlmostEqual(float(first[f"velocity_eci_{axis}_mps"]), float(row[f"servicer_velocity_eci_{axis}_mps"]), 8)

    def test_refusals(self):
        for arguments, words in ((("export", self.folder, "--oem", self.folder / "x"), "summary.json"), (("export", self.run_folder), "--oem")):
            result = vbar(*arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn(words, result.stderr)
        self.assertFalse((self.folder / "x").exists())


class ExitsCzml(ExitsRun):
    """CZML as its specification states it (czml-writer, pages "CZML Structure" and "Packet")."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        result = vbar("export", cls.run_folder, "--czml", cls.folder / "run.czml")
        assert result.returncode == 0, result.stderr
        cls.packets = json.loads((cls.folder / "run.czml").read_text())
        cls.of = {packet["id"]: packet for packet in cls.packets}

    def test_structure(self):
        document = self.packets[0]
        self.assertEqual((document["id"], document["version"]), ("document", "1.0"))
        self.assertEqual(len(self.of), len(self.packets))  # identifiers are unique
        begin, end = document["clock"]["interval"].split("/")
        self.assertEqual(document["clock"]["currentTime"], begin)
        for packet in self.packets[1:]:
            since, until = packet["availability"].split("/")
            self.assertTrue(begin <= since < until <= end, packet["id"])
            self.assertEqual(packet["position"]["referenceFrame"], "INERTIAL")
            for place in ("point", "label"):
                colour = packet[place].get("color", packet[place].get("fillColor"))["rgba"]
                self.assertTrue(len(colour) == 4 and all(0 <= value <= 255 for value in colour))

    def test_positions_are_those_of_the_table(self):
        truth = rows_of(self.run_folder / "truth.csv")
        epoch = json.loads((self.run_folder / "summary.json").read_text())["provenance"]["epoch_utc"]
        for craft in ("servicer", "target"):
            position = self.of[craft]["position"]
            self.assertEqual(datetime.datetime.fromisoformat(position["epoch"].rstrip("Z")), datetime.datetime.fromisoformat(epoch.rstrip("Z")))
            samples = [position["cartesian"][k:k + 4] for k in range(0, len(position["cartesian"]), 4)]
            expected = [[row["time_s"], *(row[f"{craft}_position_eci_{axis}_m"] for axis in "xyz")] for row in truth]
            self.assertEqual([list(map(bits, sample)) for sample in samples], [list(map(bits, row)) for row in expected])

    def test_the_estimate_and_the_burns(self):
        """The estimate is as far from the servicer as telemetry states; a burn begins when it was executed."""
        valid = [row for row in rows_of(self.run_folder / "telemetry_navigation.csv") if row["valid"] == "1"]
        values = self.of["target_estimated"]["position"]["cartesian"]
        self.assertEqual(values[::4], [float(row["time_s"]) for row in valid])
        for k, row in enumerate(valid):
            offset = [values[4 * k + 1 + axis] - float(row[f"servicer_position_eci_{name}_m"]) for axis, name in enumerate("xyz")]
            self.assertAlmostEqual(math.hypot(*offset), math.hypot(*(float(row[f"relative_position_rtn_{axis}_m"]) for axis in "rtn")), 6)
        executed = [row for row in rows_of(self.run_folder / "maneuvers.csv") if row["executed_dv_rtn_t_mps"]] if (self.run_folder / "maneuvers.csv").exists() else []
        self.assertEqual(len([name for name in self.of if name.startswith("burn_")]), len(executed))


TABLES = {"telemetry_gnss": "gnss"}  # of the messages whose table has another name


class ExitsGround(ExitsRun):
    """Datagrams of a flight, decoded by the XTCE file alone."""

    @classmethod
    def listen_while(cls, fly_it):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ground:
            ground.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 23)
            ground.bind(("127.0.0.1", 0))
            ground.settimeout(0.2)
            cls.datagrams, flying = [], threading.Event()

            def listen():
                while True:
                    try:
                        cls.datagrams.append(ground.recv(4096))
                    except socket.timeout:
                        if flying.is_set():
                            return
            listener = threading.Thread(target=listen)
            listener.start()
            try:
                fly_it([f"telemetry.udp=127.0.0.1:{ground.getsockname()[1]}"])
            finally:
                flying.set()
                listener.join()
        result = vbar("xtce")
        assert result.returncode == 0, result.stderr
        cls.file = cls.folder / "vbar.xml"
        cls.file.write_text(result.stdout)

    def logged(self):
        """The packets of the log of the run."""
        data, at, packets = (self.run_folder / "packets.lcmlog").read_bytes(), 0, []
        while at < len(data):
            _, _, _, channel, size = struct.unpack_from(">IQQII", data, at)
            if data[at + 28:at + 28 + channel] == b"VBAR_PACKET":
                packets.append(data[at + 28 + channel + 29:at + 28 + channel + size])
            at += 28 + channel + size
        return packets

    def test_each_packet_is_a_datagram(self):
        self.assertEqual(self.datagrams, self.logged())

    def test_the_cells_of_the_tables_follow_from_the_file_alone(self):
        decoder, messages, compared = Decoder(self.file), collections.defaultdict(list), 0
        for datagram in self.datagrams:
            container, values = decoder.decode(datagram)
            self.assertNotEqual(container, "/vbar/packet")
            path, _, message = container.rpartition("/")
            messages[message].append({name.removeprefix(f"{path}/"): value for name, value in values.items()})
        for message in ("telemetry_navigation", "telemetry_control", "telemetry_health", "telemetry_gnss", "telemetry_event", "telemetry_telecommand"):
            rows = rows_of(self.run_folder / f"{TABLES.get(message, message)}.csv")
            self.assertEqual(len(rows), len(messages[message]), message)
            for row, values in zip(rows, messages[message]):
                for column in row.keys() & values.keys():
                    value, cell = values[column], row[column]
                    same = cell == value if isinstance(value, str) else int(cell) == value if isinstance(value, int) else bits(cell) == bits(value)
                    self.assertTrue(same, (message, column, cell, value))
                    compared += 1
            flags = [f"faults_{word}" for word in rows[-1].get("faults", "none").split("+") if word != "none"]
            self.assertTrue(all(messages[message][-1][flag] == "set" for flag in flags))
        self.assertGreater(compared, 4000)

    def test_two_spacecraft_stay_apart(self):
        result = vbar("xtce", "--spacecraft", "chief=1", "--spacecraft", "deputy=7")
        file = self.folder / "two.xml"
        file.write_text(result.stdout)
        packet = next(datagram for datagram in self.datagrams if datagram[:2] == b"\x0d\x01")
        other = bytearray(packet)
        other[14] = 7
        containers = [Decoder(file).decode(bytes(one))[0] for one in (packet, other)]
        self.assertEqual(containers, ["/vbar/chief/telemetry_navigation/telemetry_navigation", "/vbar/deputy/telemetry_navigation/telemetry_navigation"])

    def test_structure(self):
        """The order of elements that XTCE 1.2 prescribes, unique names, and no reference to what is not there."""
        root = xml.parse(self.file).getroot()
        orders = {"SpaceSystem": ["Header", "TelemetryMetaData", "SpaceSystem"], "TelemetryMetaData": ["ParameterTypeSet", "ParameterSet", "ContainerSet"],
                  "SequenceContainer": ["EntryList", "BaseContainer"], "EnumeratedParameterType": ["UnitSet", "IntegerDataEncoding", "EnumerationList", "DefaultAlarm"],
                  "IntegerParameterType": ["UnitSet", "IntegerDataEncoding"], "FloatParameterType": ["UnitSet", "FloatDataEncoding"]}
        for element in root.iter():
            order = orders.get(element.tag.removeprefix(N))
            if order:
                places = [order.index(child.tag.removeprefix(N)) for child in element]
                self.assertEqual(places, sorted(places))
            names = [(child.tag, child.get("name")) for child in element if child.get("name")]
            self.assertEqual(len(names), len(set(names)), element.get("name"))
            self.assertRegex(element.get("name", "x"), r"^[^./:\[\]\s]+$")
        decoder = Decoder(self.file)
        self.assertLessEqual(set(decoder.parameters.values()), set(decoder.types))
        for entries, base, criteria in decoder.containers.values():
            self.assertLessEqual({*entries, *(name for name, _ in criteria)}, set(decoder.parameters))
            self.assertTrue(not base or base in decoder.containers)

    def test_refusals(self):
        for word in ("servicer", "a b=1", "x=300"):
            result = vbar("xtce", "--spacecraft", word)
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertIn(word, result.stderr)


class ExitsMcap(ExitsRun):
    """MCAP by @mcap/core and protobufjs; skipped where they are not fetched."""

    def test_read_back(self):
        node = shutil.which("node") or shutil.which("nodejs")
        if not node or not NODE_MODULES.is_dir():
            self.skipTest(f"{NODE_MODULES} or node is missing: run tests/peers/wire_formats/install_npm.sh")
        file = self.folder / "run.mcap"
        result = vbar("export", self.run_folder, "--mcap", file)
        self.assertEqual(result.returncode, 0, result.stderr)
        result = subprocess.run([node, SOURCE / "tests" / "peers" / "mcap" / "read_mcap.cjs", NODE_MODULES, file], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 0, result.stderr)
        read = json.loads(result.stdout)
        topics = read["topics"]
        self.assertEqual({topic: one["count"] for topic, one in topics.items()}, read["statistics"])
        for table in ("truth", "estimate", "gnss", "telemetry_health", "maneuvers"):
            rows = rows_of(self.run_folder / f"{table}.csv")
            if not rows:
                continue
            topic = topics[f"/tables/{table}"]
            self.assertEqual((topic["schema"], topic["count"]), (f"vbar.{table}", len(rows)))
            for row, message in ((rows[0], topic["first"]), (rows[-1], topic["last"])):
                for column, cell in row.items():
                    same = message[column] == cell if isinstance(message[column], str) and cell else bits(cell) == bits(message[column])
                    self.assertTrue(same, (table, column, cell, message[column]))
        truth = rows_of(self.run_folder / "truth.csv")
        frame = topics["/tf"]["last"]
        self.assertEqual((frame["parent_frame_id"], frame["child_frame_id"]), ("servicer_rtn", "target"))
        self.assertEqual([frame["translation"][axis] for axis in "xyz"], [float(truth[-1][f"relative_position_rtn_{axis}_m"]) for axis in "rtn"])
        self.assertEqual(len(topics["/scene"]["first"]["entities"][0]["lines"][0]["points"]), len(truth))


class Notebooks(unittest.TestCase):
    """The package of Python and the notebooks, cell by cell; skipped without pandas and matplotlib."""

    @classmethod
    def setUpClass(cls):
        for module in ("pandas", "matplotlib"):
            if not importlib.util.find_spec(module):
                print(f"python3-{module} is not installed")
                sys.exit(SKIP)
        import matplotlib
        matplotlib.use("Agg")
        sys.path.insert(0, str(BINARY / "python"))

    def execute(self, name):
        """The variables of a notebook after its last cell."""
        import matplotlib.pyplot as plt
        cells = json.loads((SOURCE / "host_sim" / "python" / "notebooks" / f"{name}.ipynb").read_text())["cells"]
        variables = {}
        with scratch() as folder:
            here = pathlib.Path.cwd()
            try:
                os.chdir(folder)
                for cell in cells:
                    if cell["cell_type"] == "code":
                        self.assertEqual(cell["outputs"], [])
                        exec(compile("".join(cell["source"]), f"{name}.ipynb", "exec"), variables)  # noqa: S102
                for number in plt.get_fignums():
                    plt.figure(number).canvas.draw()
                if name == "one_run":
                    self.check_tables(variables["run"])
            finally:
                os.chdir(here)
                plt.close("all")
        return variables

    def check_tables(self, run):
        """Cells of pandas have the bits of the files."""
        for table in ("truth", "estimate"):
            for column, cells in zip(run[table].columns, zip(*(row.values() for row in rows_of(run.folder / f"{table}.csv")))):
                if run[table][column].dtype.kind == "f":
                    self.assertEqual(list(map(bits, run[table][column])), list(map(bits, cells)), column)
        self.assertEqual(run.units("estimate")["relative_velocity_rtn_t_mps"], "m/s")
        self.assertNotIn("", list(run.columns("truth").meaning))

    def test_one_run(self):
        found = self.execute("one_run")
        self.assertLess(found["distance_m"].min(), 10.0)
        self.assertGreater(min(found["within"].values()), 0.9)

    def test_campaign(self):
        found = self.execute("campaign")
        self.assertEqual(len(found["results"]), 6)
        self.assertEqual(sorted(set(found["results"][found["loss"]])), [0.0, 0.2])

    def test_own_filter(self):
        """Mean square of the error over its sigma: 1 of a consistent filter, whose errors are correlated over minutes."""
        found = self.execute("own_filter")
        self.assertLess(found["own_rms_m"], 0.2)
        self.assertTrue(0.3 < found["own_nees"] < 3.0, found["own_nees"])

    def test_octave(self):
        octave = shutil.which("octave-cli") or shutil.which("octave")
        if not octave:
            self.skipTest("octave is not installed")
        with scratch() as folder:
            fly(folder / "run", "mission.duration_h=0.05")
            script = f'addpath ("{SOURCE}/host_sim/python"); run = vbar_run ("{folder}/run"); printf ("%.17g\\n", run.truth.relative_position_rtn_t_m);'
            result = subprocess.run([octave, "--no-gui", "--quiet", "--eval", script], capture_output=True, text=True, timeout=60)
            self.assertEqual(result.returncode, 0, result.stderr)
            truth = [row["relative_position_rtn_t_m"] for row in rows_of(folder / "run" / "truth.csv")]
            self.assertEqual(list(map(bits, result.stdout.split())), list(map(bits, truth)))

    def test_what_is_not_there(self):
        import vbar as package
        with scratch() as folder:
            with self.assertRaisesRegex(FileNotFoundError, "not a run folder"):
                package.run(folder)
            with self.assertRaisesRegex(FileNotFoundError, "not a campaign folder"):
                package.campaign(folder)
            with self.assertRaisesRegex(RuntimeError, "missing_mission"):
                package.start("missing_mission", folder / "x")


if __name__ == "__main__":
    main()
