"""Trains the keypoint network on shards of crops, for a given time. Crops may still be arriving.

An interrupted run goes on from its last checkpoint. `--export-every M` writes the weights so far every M minutes.
"""

import argparse
import copy
import math
import os
import pathlib
import time

os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

import numpy
import torch

import augment
import crops
import decode
import keypoint_network

BATCH = 64
TARGET_SIGMA_CELLS = 1.0
AVERAGE = 0.998  # of the weights, kept each step
CHECKPOINT_S = 180.0


class Crops:
    """All shards of a kind, as they appear."""

    def __init__(self, folder, kind):
        self.folder, self.kind, self.shards = folder, kind, {}
        self.rescan()

    def rescan(self):
        for path in crops.shards(self.folder, self.kind):
            if path not in self.shards:
                crops.read_shard(path)  # whole?
                self.shards[path] = numpy.memmap(path, crops.RECORD, "r", crops.HEADER)
        self.tables = list(self.shards.values())
        self.starts = numpy.cumsum([0] + [len(t) for t in self.tables])
        return int(self.starts[-1])

    def batch(self, indices):
        """Bytes, positions in cells, validity."""
        tables = numpy.searchsorted(self.starts, indices, "right") - 1
        records = numpy.stack([self.tables[t][i - self.starts[t]] for t, i in zip(tables, indices)])
        return records["image"].copy(), records["cells"].copy(), records["counts"].copy()


def target_maps(cells):
    """Normalised Gaussians about the keypoints, batch x 11 x 1024."""
    axis = torch.arange(crops.MAP_SIDE)
    along = torch.exp(-0.5 * ((axis - cells[..., None]) / TARGET_SIGMA_CELLS)**2)  # batch x 11 x (x, y) x 32
    maps = along[..., 1, :, None] * along[..., 0, None, :]
    maps = maps.flatten(2)
    return maps / maps.sum(2, keepdim=True)


def loss_of(logits, cells, counts):
    entropy = -(target_maps(cells) * torch.log_softmax(logits.flatten(2), 2)).sum(2)
    return (entropy * counts).sum() / counts.sum().clamp(min=1.0)


def maps_of(model, images):
    """Logits for bytes, in batches."""
    model.eval()
    with torch.no_grad():
        return torch.cat([model(augment.standardised(augment.samples_of(images[i:i + 100])))
                          for i in range(0, len(images), 100)])


def errors_of(model, table):
    """Errors of the valid keypoints, samples of the crop."""
    places = decode.decode(maps_of(model, table["image"]), TARGET_SIGMA_CELLS).places
    return 4.0 * numpy.linalg.norm(places - table["cells"], axis=2)[table["counts"] > 0.5]


class Training:
    def __init__(self, options):
        self.options = options
        # Channels last is a third faster on processors.
        self.model = keypoint_network.KeypointNetwork().to(memory_format=torch.channels_last)
        self.averaged = copy.deepcopy(self.model)
        self.optimiser = torch.optim.AdamW(self.model.parameters(), lr=options.rate, weight_decay=0.01)
        self.step, self.elapsed_s = 0, 0.0
        self.checkpoint = options.out.with_suffix(".checkpoint")
        if self.checkpoint.exists():
            self.resume()

    def resume(self):
        kept = torch.load(self.checkpoint)
        self.model.load_state_dict(kept["model"])
        self.averaged.load_state_dict(kept["averaged"])
        self.optimiser.load_state_dict(kept["optimiser"])
        self.step, self.elapsed_s = kept["step"], kept["elapsed_s"]
        print(f"continuing at step {self.step}, {self.elapsed_s / 60:.1f} min", flush=True)

    def save(self):
        part = self.checkpoint.with_suffix(".part")
        torch.save({"model": self.model.state_dict(), "averaged": self.averaged.state_dict(),
                    "optimiser": self.optimiser.state_dict(), "step": self.step, "elapsed_s": self.elapsed_s}, part)
        os.replace(part, self.checkpoint)

    def export(self):
        layers = keypoint_network.folded(self.averaged.eval())
        part = self.options.out.with_suffix(".part")
        part.write_bytes(keypoint_network.weights_file(layers, (1.0, 0.05, TARGET_SIGMA_CELLS, 0.3, 0.0)))
        os.replace(part, self.options.out)

    def rate(self):
        """Linear increase over 3 % of the time, then cosine decay to zero."""
        part = min(self.elapsed_s / (60.0 * self.options.minutes), 1.0)
        if part < 0.03:
            return self.options.rate * (0.1 + 0.9 * part / 0.03)
        return self.options.rate * 0.5 * (1.0 + math.cos(math.pi * (part - 0.03) / 0.97))

    def one_step(self, images, cells, counts):
        x, places = augment.augmented(images, cells)
        for group in self.optimiser.param_groups:
            group["lr"] = self.rate()
        self.model.train()
        x = x.contiguous(memory_format=torch.channels_last)
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=self.options.bfloat16):
            logits = self.model(x)
        loss = loss_of(logits.float(), places, torch.from_numpy(counts))
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), 5.0)
        self.optimiser.step()
        keep = min(AVERAGE, (1.0 + self.step) / (10.0 + self.step))
        with torch.no_grad():
            ours, theirs = self.averaged.state_dict(), self.model.state_dict()
            for name, value in ours.items():
                if value.dtype.is_floating_point:
                    value.lerp_(theirs[name], 1.0 - keep)
        self.step += 1
        return float(loss.detach())

    def report(self, losses, rate, available, held_out):
        errors = errors_of(self.averaged, held_out)
        print(f"{self.elapsed_s / 60:6.1f} min  step {self.step:6}  {rate:5.0f} images/s  crops {available:6}  "
              f"loss {numpy.mean(losses):.4f}  held out: median {numpy.median(errors):.2f}, "
              f"90 % {numpy.quantile(errors, 0.9):.2f} samples", flush=True)

    def run(self):
        options = self.options
        shards = Crops(options.crops, "training")
        while shards.rescan() < min(options.least_crops, 10**9):
            time.sleep(5.0)
        held_out = next(iter(Crops(options.crops, "held_out").tables))[:500]
        generator = numpy.random.default_rng(options.seed + self.step)
        torch.manual_seed(options.seed + self.step)
        last = time.monotonic()
        saved = reported = exported = self.elapsed_s
        losses, seen = [], 0
        available = shards.rescan()
        while self.elapsed_s < 60.0 * options.minutes:
            available = shards.rescan()
            order = generator.permutation(available)
            for i in range(0, available - BATCH + 1, BATCH):
                losses.append(self.one_step(*shards.batch(order[i:i + BATCH])))
                seen += BATCH
                now = time.monotonic()
                self.elapsed_s += now - last
                last = now
                if self.elapsed_s >= 60.0 * options.minutes:
                    break
                if self.elapsed_s - reported > options.report_s:
                    self.report(losses, seen / (self.elapsed_s - reported), available, held_out)
                    reported, losses, seen = self.elapsed_s, [], 0
                if self.elapsed_s - saved > CHECKPOINT_S:
                    self.save()
                    saved = self.elapsed_s
                if self.elapsed_s - exported > 60.0 * options.export_every:
                    self.export()
                    exported = self.elapsed_s
                    print("intermediate weights written", flush=True)
        self.save()
        self.export()
        self.report(losses or [0.0], 0.0, available, held_out)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--crops", type=pathlib.Path, required=True, help="folder of the shards")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="weights file; the checkpoint is stored with it")
    parser.add_argument("--minutes", type=float, default=50.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate", type=float, default=2.5e-3, help="maximum learning rate")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--least-crops", type=int, default=3000, help="minimum number of crops to start")
    parser.add_argument("--export-every", type=float, default=1e9, help="minutes")
    parser.add_argument("--report-s", type=float, default=120.0)
    options = parser.parse_args()
    # Half the time if the processor supports bfloat16, otherwise much more.
    options.bfloat16 = "avx512_bf16" in pathlib.Path("/proc/cpuinfo").read_text()
    torch.set_num_threads(options.threads)
    torch.set_flush_denormal(True)
    Training(options).run()


if __name__ == "__main__":
    main()
