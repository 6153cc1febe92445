#!/usr/bin/env python3
"""A truth of the user's own: every spacecraft about the Earth's point mass and its oblateness, by the classical Runge-Kutta method."""
import math

import vbar
import vbar_sensor

GM, RADIUS, J2 = 3.986004415e14, 6378136.3, 1.0826358191967e-3  # m^3/s^2, m, 1: those of GGM05S
STEP_S = 10.0  # at most


def acceleration(x, y, z):
    """m/s^2; the pole is the z axis of GCRF."""
    r2 = x * x + y * y + z * z
    central = -GM / (r2 * math.sqrt(r2))
    oblate = 1.5 * J2 * RADIUS**2 / r2
    across, along = 1.0 + oblate * (1.0 - 5.0 * z * z / r2), 1.0 + oblate * (3.0 - 5.0 * z * z / r2)
    return [central * across * x, central * across * y, central * along * z]


def rate(state):
    return state[3:] + acceleration(*state[:3])


def plus(state, h, derivative):
    return [value + h * change for value, change in zip(state, derivative)]


def step(state, h):
    k1 = rate(state)
    k2 = rate(plus(state, h / 2.0, k1))
    k3 = rate(plus(state, h / 2.0, k2))
    k4 = rate(plus(state, h, k3))
    return [value + h / 6.0 * (a + 2.0 * b + 2.0 * c + d) for value, a, b, c, d in zip(state, k1, k2, k3, k4)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [value / math.hypot(*a) for value in a]


def with_impulse(state, dv_rtn):
    radial, normal = unit(state[:3]), unit(cross(state[:3], state[3:]))
    axes = zip(radial, cross(normal, radial), normal)
    return state[:3] + [v + sum(d * e for d, e in zip(dv_rtn, axis)) for v, axis in zip(state[3:], axes)]


class TwoBodyTruth:
    def __init__(self, start, time_ns, states, earth):
        self.time_ns = time_ns
        self.states = {number: [*state.position_eci, *state.velocity_eci] for number, state in states.items()}

    def advance(self, time_ns, commands):
        for message, _, number in commands:
            if isinstance(message, vbar.executed_maneuver):
                self.states[number] = with_impulse(self.states[number], message.dv_rtn)
        span_s = (time_ns - self.time_ns) / 1e9
        steps = math.ceil(span_s / STEP_S)
        for number, state in self.states.items():
            for _ in range(steps):
                state = step(state, span_s / steps)
            self.states[number] = state
        self.time_ns = time_ns
        return [(self.message(state), number) for number, state in self.states.items()]

    def message(self, state):
        message = vbar.true_state()
        message.position_eci, message.velocity_eci, message.acceleration_eci = state[:3], state[3:], acceleration(*state[:3])
        return message


if __name__ == "__main__":
    vbar_sensor.serve_truth(TwoBodyTruth, "two bodies and J2 in Python")
