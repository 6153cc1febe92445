"""vbar view: the page of a run holds the bits of its tables, in any browser and whatever the names in it are."""
import base64
import csv
import html
import json
import random
import re
import shutil
import struct
import sys
import unittest
import zlib

from vbar_program import SKIP, SOURCE, fly, main, scratch, vbar

sys.path.insert(0, str(SOURCE / "tests" / "integration" / "view"))
import browser  # noqa: E402

HOSTILE = """</script><b onmouseover='alert(1)'>"&amp; \u2028<!--"""


def runs_of(page):
    """The runs of a page, by its text alone; tables with their data, which are elements of their own."""
    text = page.read_text(encoding="utf-8")
    blocks = re.findall(r'<script type="application/json" id="runs">(.*?)</script>', text, re.DOTALL)
    assert len(blocks) == 1, len(blocks)
    data = dict(re.findall(r'<script type="text/plain" id="data-(\d+-\d+)">([A-Za-z0-9+/=]*)</script>', text))
    runs = json.loads(blocks[0])
    for k, run in enumerate(runs):
        for number, table in enumerate(run["tables"]):
            table["data"] = data.pop(f"{k}-{number}")
    assert not data, list(data)
    return runs


def numbers_of(form, data, reference):
    """The bits of a column of numbers, as embedded_table.h states them."""
    rows = len(data) // 8
    numbers = [sum(data[plane * rows + row] << 8 * plane for plane in range(8)) for row in range(rows)]
    if form == "number":
        return numbers
    bits, before = [], 0
    for row, folded in enumerate(numbers):
        difference = folded >> 1 ^ -(folded & 1)
        before = ((reference[row] if form == "difference" else before) + difference) % 2**64
        bits.append(before)
    return bits


def text_of(number):
    value = struct.unpack("<d", struct.pack("<Q", number))[0]
    return "" if value != value else repr(value)


def number_bits(cells):
    return [struct.unpack("<Q", struct.pack("<d", float(cell or "nan")))[0] for cell in cells]


def tables_of(run):
    """{file: {column: cells}} as the page has them."""
    tables = []
    for table in run["tables"]:
        data, offset, columns = zlib.decompress(base64.b64decode(table["data"])), 0, []
        tables.append(columns)
        for column in table["columns"]:
            if "same" in column:
                cells = tables[column["same"][0]][column["same"][1]][1]
            else:
                part = data[offset:offset + column["bytes"]]
                offset += column["bytes"]
                if column["form"] == "text":
                    cells = part.decode().split("\n")[:-1]
                else:
                    reference = number_bits(tables[column["of"][0]][column["of"][1]][1]) if "of" in column else None
                    cells = [text_of(number) for number in numbers_of(column["form"], part, reference)]
            columns.append((column["name"], cells))
        assert offset == len(data)
    return {table["file"]: dict(columns) for table, columns in zip(run["tables"], tables)}


def same_cell(a, b):
    """Whether two cells are the same word, or numbers of the same bits."""
    try:
        return a == b or bits([a]) == bits([b])
    except ValueError:
        return False


def file_of(path):
    """{column: cells} of a CSV file."""
    rows = list(csv.reader(path.read_text().splitlines()))
    return {name: [row[k] for row in rows[1:]] for k, name in enumerate(rows[0])}


def bits(cells):
    return [struct.pack("<d", float(cell)) if cell else None for cell in cells]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def norm(a):
    return dot(a, a) ** 0.5


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def need_page(folder):
    """Skips the class where vbar was built without the page, with the sentence of vbar about that."""
    result = vbar("view", folder)
    if result.returncode == 2 and "without the page" in result.stderr:
        print(result.stderr)
        sys.exit(SKIP)
    assert result.returncode == 0, result.stderr


class View(unittest.TestCase):
    """A run of a quarter of an hour with GNSS, estimates that begin late and burns."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = scratch()
        cls.folder = cls.scratch.__enter__()
        cls.run_folder = cls.folder / "run"
        fly(cls.run_folder, "mission.duration_h=0.35", mission=SOURCE / "missions" / "experiment3.toml")
        need_page(cls.run_folder)
        cls.page = cls.run_folder / "view.html"

    @classmethod
    def tearDownClass(cls):
        cls.scratch.__exit__(None, None, None)

    def test_a_run_leaves_the_page(self):
        written_by_run = self.page.read_bytes()
        vbar("view", self.run_folder, "--out", self.folder / "again.html")
        self.assertEqual(tables_of(runs_of(self.page)[0]), tables_of(runs_of(self.folder / "again.html")[0]))
        self.assertLess(len(written_by_run), 3e6)

    def test_the_page_has_every_cell_of_every_table(self):
        tables = tables_of(runs_of(self.page)[0])
        files = sorted(path.name for path in self.run_folder.glob("*.csv") if path.read_text().count("\n") > 1)
        self.assertIn("truth.csv", files)
        self.assertEqual(sorted(name for name in tables if name), files)
        for name in files:
            columns = file_of(self.run_folder / name)
            self.assertEqual(list(tables[name]), list(columns), name)
            for column, cells in columns.items():
                self.assertEqual(len(tables[name][column]), len(cells), (name, column))
                self.assertTrue(all(map(same_cell, tables[name][column], cells)), (name, column))

    def test_the_page_loads_nothing(self):
        text = self.page.read_text(encoding="utf-8")
        self.assertIn("default-src 'none'", text)
        head = text[:text.index('id="bundle"')]
        self.assertNotRegex(head.split("<!-- This page contains")[0], r"(src|href)=")

    def test_hostile_names_stay_text(self):
        run = self.folder / "hostile"
        shutil.copytree(self.run_folder, run)
        summary = json.loads((run / "summary.json").read_text())
        summary["mission"] = HOSTILE * 100
        (run / "summary.json").write_text(json.dumps(summary))
        names = self.folder / ("<b>" + "&'" + "x" * 100)
        run.rename(names)
        result = vbar("view", names)
        self.assertEqual(result.returncode, 0, result.stderr)
        text = (names / "view.html").read_text(encoding="utf-8")
        self.assertEqual(runs_of(names / "view.html")[0]["summary"]["mission"], HOSTILE * 100)
        self.assertEqual(html.unescape(re.search("<title>(.*?)</title>", text, re.DOTALL)[1]), names.name)
        self.assertNotRegex(text.split("<!-- This page contains")[0], "<b[ >]")
        self.assertNotIn("onmouseover='alert", text.replace(json.dumps(HOSTILE).replace("<", "\\u003c")[1:-1], ""))

    def test_two_runs(self):
        result = vbar("view", self.run_folder, self.run_folder, "--out", self.folder / "both.html")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(runs_of(self.folder / "both.html")), 2)

    def test_a_run_whose_mission_is_not_read_is_shown_without_shapes(self):
        run = self.folder / "without"
        shutil.copytree(self.run_folder, run)
        (run / "mission.toml").write_text("[mission]\nnaem = 1\n")
        result = vbar("view", run)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("naem", result.stderr)
        page = runs_of(run / "view.html")[0]
        self.assertIn("naem", page["note"])
        self.assertIsNone(page["scene"])

    def test_no_run(self):
        result = vbar("view", self.folder)
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual(result.stderr.count("\n"), 1)


class ViewPropagation(unittest.TestCase):
    """The page of two spacecraft that were propagated for seven hours at steps of a second."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = scratch()
        cls.folder = cls.scratch.__enter__()
        cls.run_folder = cls.propagated("two", "truth.gravity_degree=2", "truth.gravity_order=0", "mission.duration_h=7", "mission.step_s=1")
        need_page(cls.run_folder)
        cls.page = cls.run_folder / "view.html"
        cls.shown = runs_of(cls.page)[0]
        cls.tables = tables_of(cls.shown)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.__exit__(None, None, None)

    @classmethod
    def propagated(cls, name, *settings, mission="ideal_navigation"):
        result = vbar("propagate", mission, "--out", cls.folder / name, "--quiet", *[word for one in settings for word in ("--set", one)])
        assert result.returncode == 0, result.stderr
        return cls.folder / name

    def test_rows_in_the_page_are_those_of_the_file_with_all_extremes(self):
        for name in ("servicer", "target"):
            file, page = file_of(self.run_folder / f"{name}.csv"), self.tables[f"{name}.csv"]
            self.assertEqual(list(page), [column for column in file if column != "utc"])
            row_of = {float(cell): row for row, cell in enumerate(file["time_s"])}
            rows = [row_of[float(cell)] for cell in page["time_s"]]
            self.assertEqual(rows, sorted(set(rows)))
            self.assertLess(len(rows), 25201)
            self.assertEqual((rows[0], rows[-1]), (0, 25200))
            for column, cells in page.items():
                self.assertEqual(bits(cells), bits([file[column][row] for row in rows]), column)
                numbers = list(map(float, file[column]))
                self.assertEqual((max(map(float, cells)), min(map(float, cells))), (max(numbers), min(numbers)), column)
        described = next(table for table in self.shown["tables"] if table["file"] == "target.csv")
        self.assertEqual(described["rows_of_file"], 25201)

    def test_the_relative_motion_is_that_of_both_ephemerides(self):
        """R along the position of the first, N along its angular momentum; velocities as seen in that rotating frame."""
        files = [file_of(self.run_folder / f"{name}.csv") for name in ("servicer", "target")]
        row_of = {float(cell): row for row, cell in enumerate(files[0]["time_s"])}
        motion = self.tables[""]
        for k in range(0, len(motion["time_s"]), 97):
            row = row_of[float(motion["time_s"][k])]
            (r, v), (r2, v2) = ([[float(file[f"{stem}_eci_{axis}_{unit}"][row]) for axis in "xyz"]
                                 for stem, unit in (("position", "m"), ("velocity", "mps"))] for file in files)
            h = cross(r, v)
            axes = [[x / norm(r) for x in r], None, [x / norm(h) for x in h]]
            axes[1] = cross(axes[2], axes[0])
            rho = [b - a for a, b in zip(r, r2)]
            rate = [x / dot(r, r) for x in h]
            seen = [b - a - c for a, b, c in zip(v, v2, cross(rate, rho))]
            for axis, name in zip(axes, "rtn"):
                # 75 km of differences of numbers of 7e6 m: binary64 leaves nanometres.
                self.assertAlmostEqual(float(motion[f"relative_position_rtn_{name}_m"][k]), dot(axis, rho), 6)
                self.assertAlmostEqual(float(motion[f"relative_velocity_rtn_{name}_mps"][k]), dot(axis, seen), 9)

    def test_what_is_no_propagation(self):
        damaged = self.folder / "damaged"
        shutil.copytree(self.run_folder, damaged)
        lines = (damaged / "target.csv").read_text().splitlines()
        lines[9] = lines[9].replace(",", ",x", 2)
        (damaged / "target.csv").write_text("\n".join(lines) + "\n")
        short = self.folder / "short"
        shutil.copytree(self.run_folder, short)
        (short / "target.csv").write_text("\n".join(lines[:9]) + "\n")
        incomplete = self.folder / "incomplete"
        shutil.copytree(self.run_folder, incomplete)
        record = json.loads((incomplete / "propagation.json").read_text())
        (incomplete / "propagation.json").write_text(json.dumps(record | {"complete": False}))
        outside = self.folder / "outside"
        shutil.copytree(self.run_folder, outside)
        record["spacecraft"][0]["name"] = "../two/servicer"
        (outside / "propagation.json").write_text(json.dumps(record))
        for folders, expected in (([damaged], "target.csv, line 10: found 'x"), ([short], "target.csv, line 10"), ([incomplete], "incomplete"),
                                  ([outside], "found '../two/servicer'"), ([self.run_folder, self.run_folder], "one propagation alone")):
            result = vbar("view", *folders)
            self.assertNotEqual(result.returncode, 0, expected)
            self.assertIn(expected, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1)

    def test_the_page_in_a_browser(self):
        if not browser.program():
            self.skipTest("no browser")
        single = self.propagated("one", "mission.duration_h=6", mission="full_force_orbit")
        self.assertEqual(vbar("view", single).returncode, 0)
        with browser.browser() as page:
            page.show()
            page.open(self.page.as_uri() + "#t=2h&tab=relative")
            x, y, z = (float(self.tables[""][f"relative_position_rtn_{axis}_m"][0]) for axis in "rtn")
            page.evaluate("vbarView.cursor.set(0)")
            self.assertAlmostEqual(page.evaluate("vbarView.scene.target.position.length()"), (x * x + y * y + z * z) ** 0.5, 6)
            for tab in ("orbit", "relative", "columns"):
                page.evaluate(f"vbarView.choose('{tab}')")
            self.assertEqual(page.errors, [])
        with browser.browser() as page:
            page.show()
            page.open((single / "view.html").as_uri())
            self.assertEqual(page.evaluate("document.querySelectorAll('.scene canvas').length"), 1)
            self.assertGreater(page.evaluate("document.querySelectorAll('.uplot').length"), 4)
            # The orbit of the mission: 7087.3 km with eccentricity 0.0015.
            orbit = page.evaluate("vbarView.elementsAt(0)")
            self.assertAlmostEqual(orbit["semiMajorAxis"] / 1e3, 7087.30, 2)
            self.assertAlmostEqual(orbit["eccentricity"], 0.0015, 6)
            self.assertAlmostEqual(orbit["inclination"], 98.18, 4)
            self.assertAlmostEqual(orbit["ascendingNode"], 270.0, 4)
            self.assertEqual(page.errors, [])


kContrast = """(() => {
  const rgb = (text) => text.match(/[0-9.]+/g).slice(0, 3).map((x) => { const c = x / 255; return c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; });
  const light = (text) => { const [r, g, b] = rgb(text); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const ground = light(getComputedStyle(document.body).backgroundColor);
  return Math.min(...[...document.querySelectorAll('.numbers th, .numbers td, .clock, .facts dt, .facts dd, .u-title')].map((e) => {
    const ink = light(getComputedStyle(e).color);
    return (Math.max(ink, ground) + 0.05) / (Math.min(ink, ground) + 0.05); })); })()"""


class ViewInBrowser(unittest.TestCase):
    """The page in Chromium (Debian's package chromium); skipped where there is none."""

    @classmethod
    def setUpClass(cls):
        if not browser.program():
            print(f"none of {', '.join(browser.PROGRAMS)} is installed")
            sys.exit(SKIP)
        cls.scratch = scratch()
        cls.folder = cls.scratch.__enter__()
        cls.run_folder = cls.folder / "run"
        fly(cls.run_folder, "mission.duration_h=0.35", mission=SOURCE / "missions" / "experiment3.toml")
        need_page(cls.run_folder)
        cls.address = (cls.run_folder / "view.html").as_uri()

    @classmethod
    def tearDownClass(cls):
        cls.scratch.__exit__(None, None, None)

    def test_values_at_random_instants(self):
        with browser.browser() as page:
            page.show()
            page.open(self.address)
            truth, estimate = file_of(self.run_folder / "truth.csv"), file_of(self.run_folder / "estimate.csv")
            times = [float(cell) for cell in truth["time_s"]]
            draw = random.Random(1)
            instants = [draw.uniform(times[0], times[-1]) for _ in range(100)]
            for t, shown in zip(instants, page.evaluate(f"{instants}.map((t) => vbarView.valuesAt(t).rows)")):
                row = max(k for k, time in enumerate(times) if time <= t)
                for name, column in (("R", "r_m"), ("T", "t_m"), ("N", "n_m")):
                    values = next(value for value in shown if value["name"] == name)
                    self.assertEqual(bits([truth[f"relative_position_rtn_{column}"][row]]), bits([repr(values["truth"])]))
                    cell = estimate[f"relative_position_rtn_{column}"][row]
                    self.assertEqual(bits([cell]), bits([repr(values["estimate"]) if values["estimate"] is not None else ""]))
            page.evaluate(f"vbarView.cursor.set({instants[-1]!r})")
            shown = page.evaluate("document.querySelectorAll('.numbers tbody tr')[1].cells[1].dataset.raw")
            self.assertEqual(bits([truth["relative_position_rtn_r_m"][row]]), bits([shown]))
            self.assertEqual(page.errors, [])
            self.assertEqual([load for load in page.loads if not load.startswith(("file:", "data:", "blob:"))], [])

    def test_every_tab_has_curves_with_as_many_points_as_the_table(self):
        with browser.browser() as page:
            page.show()
            page.open(self.address + "#t=39.2h&tab=navigation")
            self.assertAlmostEqual(page.evaluate("vbarView.cursor.t"), 39.2 * 3600, 3)
            rows = len(file_of(self.run_folder / "truth.csv")["time_s"])
            for tab in ("relative", "navigation", "roe", "burns"):
                page.evaluate(f"vbarView.choose('{tab}')")
                self.assertGreater(page.evaluate("document.querySelectorAll('.uplot canvas').length"), 0, tab)
            page.evaluate("vbarView.choose('columns')")
            self.assertEqual(page.evaluate("vbarView.runs[0].table('truth').time.length"), rows)
            columns = [f"{path.stem}.{name}" for path in self.run_folder.glob("*.csv") for name in file_of(path)
                       if path.read_text().count("\n") > 1]
            listed = page.evaluate("[...document.querySelectorAll('.columns label')].map((label) => label.innerText)")
            self.assertEqual(sorted(column for column in columns if column not in listed), [])
            self.assertEqual(page.errors, [])

    def test_scene_is_drawn(self):
        with browser.browser() as page:
            page.show(dark=True)
            page.open(self.address)
            colours = page.evaluate("""(() => {
              const from = document.querySelector('.scene canvas'), to = document.createElement('canvas');
              Object.assign(to, {width: from.width, height: from.height});
              const g = to.getContext('2d');
              g.drawImage(from, 0, 0);
              const pixels = new Uint32Array(g.getImageData(0, 0, to.width, to.height).data.buffer);
              return new Set(pixels).size; })()""")
            self.assertGreater(colours, 20)
            # Position and attitude by one frame: the scene's target is as far away as the table says.
            self.assertAlmostEqual(page.evaluate("vbarView.scene.target.position.length()"),
                                   page.evaluate("vbarView.valuesAt(vbarView.cursor.t).rows[0].truth"), 6)

    def test_a_plot_states_how_often_its_error_is_within_three_sigma(self):
        truth, estimate = file_of(self.run_folder / "truth.csv"), file_of(self.run_folder / "estimate.csv")
        true = dict(zip(map(float, truth["time_s"]), map(float, truth["relative_position_rtn_r_m"])))
        rows = [(abs(float(x) - true[float(t)]), float(s)) for t, x, s in
                zip(estimate["time_s"], estimate["relative_position_rtn_r_m"], estimate["sigma_rtn_r_m"]) if x and float(t) in true]
        share = 100 * sum(error <= 3 * sigma for error, sigma in rows) / len(rows)
        with browser.browser() as page:
            page.show()
            page.open(self.address + "#tab=navigation")
            title = page.evaluate("document.querySelector('.u-title').innerText")
            self.assertTrue(title.startswith("R position error"), title)
            self.assertAlmostEqual(float(re.search(r"in 3σ ([0-9.]+) %", title)[1]), share, 0)

    def test_the_time_bar_explains_what_is_under_the_pointer(self):
        burn = file_of(self.run_folder / "maneuvers.csv")
        k = next(row for row, size in enumerate(burn["executed_dv_rtn_t_mps"]) if size)
        time_s = float(burn["execution_time_s"][k])
        size = sum(float(burn[f"executed_dv_rtn_{axis}_mps"][k]) ** 2 for axis in "rtn") ** 0.5
        with browser.browser() as page:
            page.show()
            page.open(self.address)
            page.point(*page.evaluate(f"vbarView.timeBar.placeOf('burns', {time_s})"))
            note = page.evaluate("document.querySelector('.pointed').innerText")
            value, unit, hours = re.search(r"burn of ([0-9.]+) (m/s|mm/s|µm/s) at ([0-9.]+) h", note).groups()
            self.assertAlmostEqual(float(value) * {"m/s": 1, "mm/s": 1e-3, "µm/s": 1e-6}[unit] / size, 1, 3)
            self.assertAlmostEqual(float(hours), time_s / 3600, 4)

    def test_a_run_without_cameras_has_no_view_through_one(self):
        with browser.browser() as page:
            page.show()
            page.open(self.address + "#view=camera")
            self.assertFalse(page.evaluate("vbarView.scene.through"))
            self.assertTrue(page.evaluate("vbarView.scene.servicer.visible"))
            self.assertEqual(page.errors, [])

    def test_without_webgl_plots_and_numbers_stand(self):
        with browser.browser("--disable-gpu", "--disable-3d-apis") as page:
            page.show()
            page.open(self.address)
            self.assertIn("WebGL", page.evaluate("document.querySelector('.scene').innerText"))
            self.assertGreater(page.evaluate("document.querySelectorAll('.uplot').length"), 3)

    def test_keyboard_alone(self):
        """Tab reaches controls, views, time bar and tabs; keys act on what has the focus, and the focus is visible."""
        with browser.browser() as page:
            page.show()
            page.open(self.address)

            def press(key, code, **more):
                for kind in ("keyDown", "keyUp"):
                    page.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, **more)

            reached = []
            for _ in range(60):
                press("Tab", 9)
                focus = page.evaluate("(() => { const e = document.activeElement; return [e.className || e.innerText || e.title, getComputedStyle(e).outlineStyle]; })()")
                reached.append(focus[0])
                self.assertNotEqual(focus[1], "none", focus)
                if focus[0] == "ROE":
                    break
            for name in ("play", "time", "timeBar", "Target", "Navigation", "ROE"):
                self.assertIn(name, reached)
            press("Enter", 13, text="\r")
            self.assertEqual(page.evaluate("document.querySelector('[role=tab][aria-selected=true]').innerText"), "ROE")
            page.evaluate("document.querySelector('.timeBar').focus()")
            press("End", 35)
            self.assertEqual(page.evaluate("vbarView.cursor.t === vbarView.cursor.end"), True)
            press("Home", 36)
            self.assertEqual(page.evaluate("vbarView.cursor.t === vbarView.cursor.start"), True)
            press("3", 51, text="3")
            self.assertEqual(page.evaluate("vbarView.scene.options.view"), "target")
            self.assertEqual(page.errors, [])

    def test_nothing_is_cut_at_1280_by_720_and_on_paper(self):
        with browser.browser() as page:
            for dark in (False, True):
                page.show((1280, 720), dark=dark)
                page.open(self.address)
                self.assertEqual(page.evaluate("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"), [1280, 720])
                # Of text on its ground: WCAG 2.1, 1.4.3 asks for 4.5.
                self.assertGreater(page.evaluate(kContrast), 4.5, "dark" if dark else "light")
            page.show((794, 1123))  # A4 at 96 pixels an inch
            page.call("Emulation.setEmulatedMedia", media="print")
            self.assertEqual(page.evaluate("getComputedStyle(document.querySelector('.controls')).display"), "none")
            width = page.evaluate("document.documentElement.clientWidth")
            self.assertEqual(page.evaluate("[document.documentElement.scrollWidth, document.querySelector('.scene').clientWidth]"), [width, width])
            self.assertGreater(page.evaluate("document.documentElement.scrollHeight"), 1123)  # plots below each other, none behind a scroll bar
            self.assertEqual(page.evaluate("getComputedStyle(document.querySelector('.plots')).overflow"), "visible")
            self.assertEqual(page.errors, [])

    def test_keys(self):
        with browser.browser() as page:
            page.show()
            page.open(self.address)
            for key, change in (("ArrowRight", 10), ("ArrowLeft", -10)):
                before = page.evaluate("vbarView.cursor.t")
                page.call("Input.dispatchKeyEvent", type="keyDown", key=key)
                self.assertAlmostEqual(page.evaluate("vbarView.cursor.t") - before, change, 6)


if __name__ == "__main__":
    main()
