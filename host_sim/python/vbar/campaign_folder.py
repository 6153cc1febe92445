"""Campaigns and verifications of vbar as tables of pandas.

    campaign = vbar.campaign("runs/e3")
    campaign.results.groupby("links.crosslink.loss_probability")["figures.dv_mps"].describe()
    campaign.kept()                       # {case: its run} of the run folders that the campaign keeps
    vbar.verification("docs/verification.json")
"""
import json
import pathlib
import subprocess

import pandas

from vbar import run_folder
from vbar.programs import program


class Campaign:
    """A campaign folder."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        file = self.folder / "campaign.json"
        if not file.is_file():
            raise FileNotFoundError(f"{self.folder} has no campaign.json: it is not a campaign folder")
        self.description = json.loads(file.read_text())

    @property
    def results(self):
        """results.csv, which vbar campaign report writes again: a row for each case."""
        done = subprocess.run([program(), "campaign", "report", str(self.folder)], capture_output=True, text=True)
        file = self.folder / "results.csv"
        if not file.is_file():
            raise RuntimeError(done.stderr.strip())
        return run_folder.read_table(file)

    def dispersed(self):
        """The keys that vary from case to case, which are columns of `results`."""
        return self.description["keys"]

    def kept(self):
        """{number of the case: its run}, of the cases whose run folders are kept."""
        folders = self.results.set_index("case")["folder"].dropna()
        return {case: run_folder.Run(self.folder / folder) for case, folder in folders.items()
                if folder and (self.folder / folder / "truth.csv").is_file()}


def campaign(folder):
    """The campaign of a folder."""
    return Campaign(folder)


def start_campaign(file, out):
    """Flies the campaign of a file into the folder `out`, and returns it. RuntimeError has the sentence of vbar if it is refused."""
    done = subprocess.run([program(), "campaign", "run", str(file), "--out", str(out)], capture_output=True, text=True)
    if not (pathlib.Path(out) / "campaign.json").is_file():
        raise RuntimeError(done.stderr.strip() or f"vbar campaign run ended with exit code {done.returncode}")
    return Campaign(out)


def verification(file):
    """The rows of a verification.json, nested figures as columns with dots in their names; commit and date are in attrs."""
    record = json.loads(pathlib.Path(file).read_text())
    table = pandas.json_normalize(record.pop("rows"))
    table.attrs.update({key: value for key, value in record.items() if not isinstance(value, (dict, list))})
    return table
