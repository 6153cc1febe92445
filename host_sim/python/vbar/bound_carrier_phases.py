"""Carrier phases of two receivers as measurements of the bound: satellites where they were, noise as the run measured it."""
import numpy

from vbar.information_filter import GaussMarkov
from vbar.navigation_satellites import SIGNALS, Constellation, is_visible, rotate_z, sidereal_angle
from vbar.programs import data_folder
from vbar.relative_dynamics import rtn_axes


class CarrierPhases:
    """Single differences of carrier phase whose integers are known: each signal has one constant. Unknowns: offset of the antennas (3,
    RTN), constants of the signals (4), acceleration (3, RTN). The clocks are free at every epoch."""
    flown_sigmas = {}
    size = 10

    def __init__(self, flight):
        run = flight.run
        phases = flight.navigation.get("carrier_phase", {})
        self.offset_sigma = 1e-3 * 2**0.5 * float(phases.get("antenna_offset_sigma_mm", 3.2))
        self.jitter = 2 * (1e-3 * float(phases.get("phase_centre_jitter_mm", 1.0)))**2
        self.acceleration = 1e-9 * flight.stated("acceleration_sigma_nmps2", 1.0), flight.stated("acceleration_correlation_time_s", 1500.0)
        table = run.gnss[(run.gnss.fixed > 3) & (run.gnss.pairs.diff() > 0)]
        self.time, self.received = table.epoch_s.to_numpy(float), table.time_s.to_numpy(float)
        noise = run.signal_noise.set_index("signal").phase_sigma_mm
        # Of double differences of independent signals, which have twice the variance of single ones.
        self.variance = {signal: (1e-3 * sigma)**2 / 2 for signal, sigma in noise.items()}
        self.signals = sorted(self.variance)
        self.constellation = Constellation(data_folder() / "gps", flight.mission.get("constellation", {}))
        self.visibility = flight.servicer_keys["sensors"]["gnss"].get("visibility", {})
        servicer, _ = flight.states(self.time)
        self.servicer, self.axes = servicer[:, :3], rtn_axes(servicer)
        self.angle = sidereal_angle(flight.julian_date(self.time))
        self.second_of_day = ((flight.epoch - flight.epoch.astype("datetime64[D]")) / numpy.timedelta64(1, "s") + self.time) % 86400

    @classmethod
    def of(cls, flights):
        return [cls(flight) for flight in flights]

    def noise_text(self):
        return "noise of a single difference: " + ", ".join(f"{signal} {1e3 * v**0.5:.2f} mm" for signal, v in self.variance.items())

    def unknowns(self, first):
        return {"antenna offsets": GaussMarkov(first, 3, self.offset_sigma, 1e12), "signal constants": GaussMarkov(first + 3, 4, 10.0, 1e12),
                "empirical acceleration": GaussMarkov(first + 7, 3, *self.acceleration)}

    def empirical_acceleration(self, first):
        return first + 7

    def rows(self, k, size, first):
        satellites = rotate_z(self.constellation.positions_ecef(self.second_of_day[k]), self.angle[k])
        seen, lines = is_visible(satellites, self.servicer[k], self.axes[k, 0], self.visibility)
        H, variance = [], []
        for satellite in numpy.flatnonzero(seen):
            for signal in SIGNALS[self.constellation.names[satellite][0]]:
                if signal not in self.variance:
                    continue
                row = numpy.zeros(size)
                row[:3] = -lines[satellite]
                row[first:first + 3] = -self.axes[k] @ lines[satellite]
                row[first + 3 + self.signals.index(signal)] = 1.0
                H.append(row)
                variance.append(self.variance[signal])
        H, lines = numpy.array(H), -numpy.array(H)[:, :3]
        covariance = numpy.diag(variance) + self.jitter * lines @ lines.T
        difference = numpy.eye(len(H))[1:] - numpy.eye(len(H))[:1]  # without the clock
        return difference @ H, difference @ covariance @ difference.T
