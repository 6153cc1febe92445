#!/usr/bin/env python3
"""The pictures of README and docs, made of real runs: screenshots of their pages, what their cameras saw, and an animation.

usage: ci/pictures.py [--build build/host] [--runs build/pictures] [NAME...]

Flies what is missing in the folder of runs, opens pages in a headless Chromium, and writes docs/images/NAME and its lines in
docs/images/index.json: the mission, seed, settings and commit that it shows. Without names all pictures are made again. Needed:
chromium, and ffmpeg, which reduces PNG to 256 colours and joins the frames of the animation (ci/install.sh peers).
"""
import argparse
import base64
import contextlib
import csv
import dataclasses
import html
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from flights import COMPLETE

ROOT = pathlib.Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"
sys.path.insert(0, str(ROOT / "tests" / "integration" / "view"))
import browser  # noqa: E402

# Runs by the name of their folder: arguments of `vbar run`.
RUNS = {
    "ideal_navigation": ["ideal_navigation"],
    "experiment1": ["experiment1"],
    "experiment2": ["experiment2"],
    "experiment2-seed-2": ["experiment2", "--set", "mission.seed=2"],
    "experiment3": ["experiment3"],
    "experiment3_grand": ["experiment3_grand"],
    "experiment1_hil": ["experiment1_hil", "--set", "mission.duration_h=0.5",
                        "--set", "testbed.optical_stimulator.calibration=stimulator_calibration/calibration.toml"],
    "experiment2_hil": ["experiment2_hil", "--set", "mission.duration_h=0.42"],
    "tutorial": ["tutorial_missions/gnss.toml"],
}
CALIBRATION = "stimulator_calibration"  # of the emulated Optical Stimulator, which experiment1_hil needs
CAMPAIGN = """[campaign]
name = "experiment3"
mission = "{root}/missions/experiment3.toml"
seeds = "1..40"
seed = 7
keep = "all"

[[disperse]]
key = "spacecraft.servicer.actuators.thruster.magnitude_error_percent"
distribution = "uniform"
low = 0.0
high = 5.0

[[disperse]]
key = "gnss.clock.h0_s"
distribution = "log_uniform"
low = 1e-21
high = 1e-18
"""
PAGE = (1280, 720)


@dataclasses.dataclass
class Page:
    """A page of the runs, at an address; of it the part with a heading, or all that is seen. `pointer`:
    the lane of the time bar and the time (h) that the pointer is at."""
    runs: list
    file: str = "view.html"
    address: str = ""
    heading: str = ""
    size: tuple = PAGE
    pointer: tuple = ()


@dataclasses.dataclass
class Film:
    """Frames of the scene at a step (s) between two times (h): through the camera and from beside, over the time bar."""
    runs: list
    begin_h: float
    end_h: float
    step_s: float


@dataclasses.dataclass
class Strip:
    """What cameras saw: the picture of the gallery nearest to a time (h), and how much of it (px, about its middle)."""
    runs: list
    times_h: list


@dataclasses.dataclass
class Drawing:
    """What a program draws of a model of data/models."""
    model: str
    program: str
    size: tuple = PAGE


PICTURES = {
    "approach.png": Strip(["experiment1", "experiment2"],
                          [("experiment1", 0.1167, 360), ("experiment1", 18, 360), ("experiment1", 36, 360), ("experiment2", 39.75, 500)]),
    "rendezvous.webp": Film(["experiment2"], 39.30, 39.80, 20),
    "trajectory.png": Page(["ideal_navigation"], "report.html", heading="Trajectory"),
    "report.png": Page(["experiment3"], "report.html", size=(1280, 900)),
    "images.png": Page(["experiment2"], "report.html", heading="Images", size=(1280, 820)),
    "experiment1.png": Page(["experiment1"], "report.html", heading="Mission at a glance"),
    "experiment2.png": Page(["experiment2"], "report.html", heading="Mission at a glance"),
    "experiment3.png": Page(["experiment3"], "report.html", heading="Mission at a glance"),
    "campaign.png": Page(["campaign"], "campaign.html", size=(1280, 1000)),
    "campaign_flights.png": Page(["campaign"], "campaign.html", heading="Flights over time"),
    "comparison.png": Page(["experiment2", "experiment2-seed-2"], "comparison.html", heading="Flights over each other"),
    "propagation.png": Page(["propagation"], address="t=20h&tab=relative&view=whole"),
    "view.png": Page(["experiment2"], address="t=39.75h"),
    "view_lost.png": Page(["experiment2"], address="t=40.6889h&tab=sensors", pointer=("keypoints", 40.75)),
    "view_burn.png": Page(["experiment1"], address="t=2.0633h&tab=burns", pointer=("burns", 2.0631)),
    "view_range.png": Page(["experiment2"], address="t=40h"),
    "view_eclipse.png": Page(["experiment2"], address="t=40.8h&tab=navigation"),
    "view_picture.png": Page(["experiment2"], address="t=39.7h&picture=large"),
    "view_difference.png": Page(["experiment2", "experiment2-seed-2"], address="t=39.7h&tab=difference"),
    "grand.png": Page(["experiment3_grand"], address="t=39.5h&tab=sensors"),
    "optical_stimulator.png": Page(["experiment1_hil"], address="t=0.45h&tab=sensors&picture=large"),
    "optical_stimulator_calibration.png": Page([CALIBRATION], "calibration.html", heading="Residuals"),
    "tron.png": Page(["experiment2_hil"], address="t=39.4h&tab=sensors&picture=large"),
    "tutorial.png": Page(["tutorial"], address="t=5h&view=whole"),
    "winged_box_keypoints.png": Drawing("winged_box", "vbar_target_keypoints", size=(1020, 690)),
}


class Maker:
    def __init__(self, build, runs):
        self.build, self.runs = build.resolve(), runs.resolve()
        self.runs.mkdir(parents=True, exist_ok=True)
        self.environment = os.environ | {"VBAR_DATA": str(ROOT / "data")}

    def vbar(self, *arguments, codes=(0,)):
        result = subprocess.run([self.build / "vbar", *map(str, arguments)], cwd=self.runs, env=self.environment,
                                capture_output=True, text=True)
        if result.returncode not in codes:
            raise SystemExit(f"vbar {' '.join(map(str, arguments))}: {result.stderr}")

    def run_folder(self, name):
        """The folder of a run, flown if it is not there, with its pages."""
        folder = self.runs / name
        if name == "campaign":
            if not (folder / "campaign.html").exists():
                (self.runs / "campaign.toml").write_text(CAMPAIGN.format(root=ROOT))
                self.vbar("campaign", "run", "campaign.toml", "--out", folder, "--jobs", "1", "--quiet", codes=(0, 75))
                self.vbar("campaign", "report", folder)
            return folder
        if name == CALIBRATION:
            if not (folder / "calibration.html").exists():
                folder.mkdir(exist_ok=True)
                subprocess.run([self.build / "vbar_os_calibrate", "--quick", "--seed", "1", "--out", folder / "calibration.toml", "--bench",
                                f"{self.build}/vbar_os_bench {{data}}/benches/optical_stimulator.toml --directory {{directory}} --seed {{seed}}"],
                               env=self.environment, check=True, capture_output=True)
            return folder
        if name == "propagation":
            if not (folder / "view.html").exists():
                self.vbar("propagate", "ideal_navigation", "--out", folder, "--quiet")
                self.vbar("view", folder)
            return folder
        if not (folder / "view.html").exists():
            if name == "experiment1_hil":
                self.run_folder(CALIBRATION)
            if name == "tutorial":
                (self.runs / "tutorial_missions").mkdir(exist_ok=True)
                for file, text in re.findall(r"^File `([^`]+)`:\n\n```toml\n(.*?)^```$", (ROOT / "docs" / "tutorial.md").read_text(), re.M | re.S):
                    (self.runs / "tutorial_missions" / file).write_text(text)
            self.vbar("run", *RUNS[name], "--out", folder, "--force", "--quiet", codes=COMPLETE)
        return folder

    def shown(self, page, name, picture):
        """Takes the screenshot of a page."""
        folders = [self.run_folder(run) for run in picture.runs]
        file = folders[0] / picture.file
        if len(folders) > 1:
            file = self.runs / ("both.html" if picture.file == "view.html" else picture.file)
            self.vbar("view" if picture.file == "view.html" else "report", *folders, "--out", file)
        page.show(picture.size)
        if file.name in ("view.html", "both.html"):
            page.open(f"{file.as_uri()}#{picture.address}")
        else:
            page.call("Page.navigate", url=file.as_uri())
            page.evaluate("new Promise((resolve) => setTimeout(resolve, 500))")
        if picture.pointer:
            lane, time_h = picture.pointer
            page.point(*page.evaluate(f"vbarView.timeBar.placeOf({json.dumps(lane)}, {time_h} * 3600)"))
        page.evaluate("new Promise((resolve) => setTimeout(resolve, 700))")
        clip = None
        if picture.heading:
            clip = page.evaluate(f"""(() => {{
              const found = [...document.querySelectorAll('h2, h3')].find((h) => h.innerText === {json.dumps(picture.heading)});
              if (!found) return null;
              const section = found.tagName === 'H2' ? found.closest('section') : undefined;
              const top = (section ?? found).getBoundingClientRect().top + scrollY;
              const height = section ? section.getBoundingClientRect().height : {picture.size[1]};
              return {{x: 0, y: top, width: {picture.size[0]}, height}}; }})()""")
            if clip is None:
                raise SystemExit(f"{file}: no heading '{picture.heading}' for {name}")
        page.picture(IMAGES / name, clip)
        reduce(IMAGES / name)
        return folders

    def strip(self, page, name, picture):
        """Joins pictures of galleries, with what they show, side by side."""
        tiles = []
        for run, time_h, side in picture.times_h:
            folder = self.run_folder(run)
            with (folder / "gallery.csv").open(newline="") as file:
                row = min(csv.DictReader(file), key=lambda r: abs(float(r["time_s"]) / 3600 - time_h))
            png = base64.b64encode((folder / "gallery" / f"{int(row['image']):05}.png").read_bytes()).decode()
            width = int(row["crop_left"]) or int(row["width_px"])
            left, top = (side - width) / 2, (side - int(row["height_px"])) / 2
            ring = ring_of(folder, row, left, top, 300 / side)
            tiles.append(f"""<figure><div style="position:relative;width:300px;height:300px;overflow:hidden;background:#000">
              <img src="data:image/png;base64,{png}" style="transform-origin:0 0;transform:scale({300 / side})
              translate({left}px,{top}px)">{ring}</div>
              <figcaption><b>{float(row['time_s']) / 3600:.2f} h</b> {html.escape(row['caption'])}</figcaption></figure>""")
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "strip.html"
            file.write_text("""<!doctype html><meta charset="utf-8"><style>body{margin:12px;display:flex;gap:10px;background:#fff;
              font:13px/1.35 "DejaVu Sans",sans-serif;color:#222}figure{margin:0;width:300px}figcaption{padding-top:5px}</style>"""
                            + "".join(tiles), encoding="utf-8")
            page.show((24 + 310 * len(tiles) - 10, 380))
            page.call("Page.navigate", url=file.as_uri())
            page.evaluate("new Promise((resolve) => setTimeout(resolve, 500))")
            page.picture(IMAGES / name)
        reduce(IMAGES / name)
        return [self.run_folder(run) for run in picture.runs]

    def drawing(self, page, name, picture):
        """Takes the picture that a program draws of a model."""
        file = self.runs / "drawing.svg"
        subprocess.run([self.build / picture.program, picture.model, "--picture", file], env=self.environment, check=True, capture_output=True)
        page.show(picture.size)
        page.call("Page.navigate", url=file.as_uri())
        page.evaluate("new Promise((resolve) => setTimeout(resolve, 500))")
        page.picture(IMAGES / name)
        reduce(IMAGES / name)
        return picture.model

    def film(self, page, name, picture):
        """Joins frames of both views of the scene over the time bar."""
        folder = self.run_folder(picture.runs[0])
        page.show((480, 480))
        page.open((folder / "view.html").as_uri())
        page.evaluate("""document.head.append(Object.assign(document.createElement('style'), {textContent: `
          .plotSection, .picture, .side, .views, header h1, header .status, .controls { display: none !important; }
          html { overflow: hidden; } .scene { height: auto !important; } .upper { grid-template-columns: 1fr !important; }
          #page { display: grid !important; height: 100vh !important; grid-template-rows: auto 1fr auto 0 !important; }`}))""")
        count = round((picture.end_h - picture.begin_h) * 3600 / picture.step_s)
        with tempfile.TemporaryDirectory() as frames:
            for view in ("camera", "both"):
                page.evaluate(f"vbarView.scene.setView('{view}')")
                for k in range(count):
                    page.evaluate(f"""vbarView.cursor.set({picture.begin_h * 3600 + k * picture.step_s});
                      new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))""")
                    page.picture(pathlib.Path(frames) / f"{view}{k:04}.png")
            convert("-framerate", "10", "-i", f"{frames}/camera%04d.png", "-framerate", "10", "-i", f"{frames}/both%04d.png",
                    "-filter_complex", "hstack", "-c:v", "libwebp_anim", "-quality", "70", "-compression_level", "5", "-loop", "0",
                    IMAGES / name)
        return [folder]

    def make(self, names):
        index_file = IMAGES / "index.json"
        index = json.loads(index_file.read_text()) if index_file.exists() else {}
        kinds = {Page: self.shown, Strip: self.strip, Film: self.film, Drawing: self.drawing}
        for name in names:
            with browser.browser() as page:
                made_of = kinds[type(PICTURES[name])](page, name, PICTURES[name])
            index[name] = [{"model": made_of, "commit": head()}] if isinstance(made_of, str) else [origin_of(folder) for folder in made_of]
            print(f"{name}: {(IMAGES / name).stat().st_size / 1024:.0f} kB", flush=True)
        index_file.write_text(json.dumps({name: index[name] for name in sorted(PICTURES) if name in index}, indent=1) + "\n")


def origin_of(folder):
    """What flew: from the summary of a run, or of the first case of a campaign; of other folders what made them, now."""
    if (folder / "propagation.json").exists():
        return {"mission": json.loads((folder / "propagation.json").read_text())["mission"], "propagated": True, "commit": head()}
    if (folder / "calibration.toml").exists():
        return {"mission": "experiment1_hil", "calibrated": True, "commit": head()}
    if not (folder / "summary.json").exists():
        campaign = json.loads((folder / "campaign.json").read_text())
        return {"mission": campaign["name"], "commit": campaign["commit"]}
    summary = json.loads((folder / "summary.json").read_text())
    return {"mission": summary["mission"], "seed": summary["seed"], "settings": summary["provenance"]["overrides"],
            "commit": summary["provenance"]["commit"]}


def ring_of(folder, picture, left, top, scale):
    """A ring about the object that the flight software took for the target, in a picture that is moved by (left, top) px."""
    if not (folder / "objects.csv").exists():
        return ""
    with (folder / "objects.csv").open(newline="") as file:
        found = next((row for row in csv.DictReader(file) if row["image"] == picture["image"] and row["kind"] == "target"), None)
    if found is None:
        return ""
    radius = max(scale * float(picture["target_radius_px"]) + 4, 12)
    x, y = (scale * (float(found[f"{axis}_px"]) - float(picture[f"origin_{axis}_px"]) + shift) for axis, shift in (("x", left), ("y", top)))
    return (f'<i style="position:absolute;left:{x - radius}px;top:{y - radius}px;width:{2 * radius}px;height:{2 * radius}px;'
            'border:1.5px solid #30d060;border-radius:50%;box-sizing:border-box"></i>')


def head():
    return subprocess.run(["git", "-C", ROOT, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()


def convert(*arguments):
    subprocess.run(["ffmpeg", "-v", "error", "-y", *map(str, arguments)], check=True)


def reduce(file):
    """A PNG of 256 colours, a third as long."""
    with tempfile.TemporaryDirectory() as folder:
        small = pathlib.Path(folder) / "small.png"
        convert("-i", file, "-vf", "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=dither=none",
                "-pred", "mixed", "-compression_level", "9", small)
        if small.stat().st_size < file.stat().st_size:
            file.write_bytes(small.read_bytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "host")
    parser.add_argument("--runs", type=pathlib.Path, default=ROOT / "build" / "pictures")
    parser.add_argument("names", nargs="*", metavar="NAME")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in PICTURES]
    if unknown:
        raise SystemExit(f"ci/pictures.py: '{unknown[0]}' is not a picture; accepted: {', '.join(PICTURES)}")
    if not browser.program():
        raise SystemExit(f"ci/pictures.py: none of {', '.join(browser.PROGRAMS)} is installed")
    Maker(arguments.build, arguments.runs).make(arguments.names or PICTURES)


if __name__ == "__main__":
    main()
