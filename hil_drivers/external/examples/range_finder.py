#!/usr/bin/env python3
"""A range finder of the user's own: the distance to the target once a second, with white noise that its seed and the epoch determine."""
import math
import random

import vbar
import vbar_sensor

SERVICER, TARGET = 1, 2  # spacecraft numbers, in the order of the mission file
PERIOD_NS = 1_000_000_000
SIGMA_M = 0.01


class RangeFinder:
    def __init__(self, start, header):
        self.seed = start.seed

    def first_epoch_ns(self, start_of_run_ns):
        return start_of_run_ns

    def measure(self, time_ns, states, earth, commands):
        message = vbar.range_measurement()
        noise_m = random.Random(self.seed ^ time_ns).gauss(0.0, SIGMA_M)
        message.range_m = math.dist(states[SERVICER].position_eci, states[TARGET].position_eci) + noise_m
        return [message], time_ns + PERIOD_NS


if __name__ == "__main__":
    vbar_sensor.serve(RangeFinder, "range finder in Python")
