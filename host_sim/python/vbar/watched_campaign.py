"""The page of a campaign while it is flown: campaign.html, made again as results come, with the lines of vbar campaign status above it."""
import csv
import html
import pathlib
import subprocess
import threading
import time

from vbar.page_server import Refusal
from vbar.programs import program

PERIOD_S = 5.0
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
LEFT = ("not_begun", "flying", "killed")  # states of cases that are still to be flown
FIRST_PAGE = "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"/><title>campaign</title></head>\n<body>\n<main>\n</main>\n</body>\n</html>\n"


class CampaignSite:
    """What is served of a campaign."""

    def __init__(self, folder):
        self.folder, self.lock = pathlib.Path(folder), threading.Lock()
        self.seen, self.made_s, self.made = None, -PERIOD_S, ""
        self.routes = {("GET", ""): self.page}

    def state(self):
        """What changes when a case begins or ends."""
        files = [file for kind in ("attempts", "results") for file in (self.folder / kind).glob("*")]
        return sorted((str(file), file.stat().st_size) for file in files)

    def is_over(self):
        try:
            with (self.folder / "results.csv").open(newline="", encoding="utf-8") as file:
                return all(row["state"] not in LEFT for row in csv.DictReader(file))
        except (OSError, KeyError):
            return False

    def page(self, viewer, _):
        with self.lock:
            if time.monotonic() - self.made_s >= PERIOD_S:
                try:
                    state = self.state()
                except OSError:
                    state = None  # a file that goes at this moment
                if state is None or state != self.seen:
                    self.made, self.seen = self._make(), state
                self.made_s = time.monotonic()
            page = self.made
        headers = {} if self.is_over() else {"Refresh": f"{PERIOD_S:g}"}
        viewer.send_page(page, Content_Security_Policy=POLICY, **headers)

    def _make(self):
        done = subprocess.run([program(), "campaign", "report", str(self.folder)], capture_output=True, text=True)
        standing = [line for line in done.stdout.splitlines() if not line.startswith(("results  ", "page  "))]
        file = self.folder / "campaign.html"
        if not standing and not file.is_file():
            raise Refusal(503, f"the campaign has no page yet: {done.stderr.strip()}")
        page = file.read_text(encoding="utf-8") if file.is_file() else FIRST_PAGE
        text = html.escape("\n".join(standing + done.stderr.splitlines()))
        return page.replace("<main>\n", f"<main>\n<pre class=\"standing\">{text}</pre>\n", 1)
