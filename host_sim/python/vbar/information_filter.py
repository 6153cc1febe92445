"""Square-root information filter (Bierman 1977, Factorization Methods for Discrete Sequential Estimation, ch. V and VI).

The information matrix is R^T R with R upper triangular. A direction without information has a zero singular value and needs no prior;
the condition of R is the root of that of the covariance. The means are not carried: for linear measurements with Gaussian noise the
covariance does not depend on them, and is the Cramer-Rao bound; with process noise the posterior bound (Tichavsky 1998).
"""
import numpy


def triangular(rows):
    return numpy.linalg.qr(rows, mode="r")


def root(covariance):
    """Columns w with w w^T = covariance, of a covariance that may be singular."""
    scale = numpy.sqrt(numpy.maximum(numpy.diagonal(covariance), 1e-300))
    values, vectors = numpy.linalg.eigh(covariance / numpy.outer(scale, scale))
    used = values > 1e-12
    return scale[:, None] * vectors[:, used] * numpy.sqrt(values[used])


class InformationFilter:
    def __init__(self, size):
        self.R = numpy.zeros((size, size))

    def measure(self, H, noise_covariance):
        """Rows H of the state (m x n), with the covariance of their noise (m x m)."""
        H = numpy.atleast_2d(H)
        whitened = numpy.linalg.solve(numpy.linalg.cholesky(numpy.atleast_2d(noise_covariance)), H)
        self.R = triangular(numpy.vstack([self.R, whitened]))[:len(self.R)]

    def know(self, first, sigmas):
        """A-priori knowledge of the states from `first` on, independent of each other."""
        H = numpy.eye(len(self.R))[first:first + len(sigmas)]
        self.measure(H, numpy.diag(numpy.square(sigmas)))

    def propagate(self, transition, noise_root):
        """x <- transition x + noise_root w, w of unit covariance."""
        n, m = noise_root.shape
        M = numpy.linalg.solve(transition.T, self.R.T).T
        rows = numpy.block([[numpy.eye(m), numpy.zeros((m, n))], [-M @ noise_root, M]])
        self.R = triangular(rows)[m:m + n, m:]

    def covariance(self, count):
        """Of the first `count` states; infinite where a direction of the state has no information at all."""
        try:
            inverse = numpy.linalg.inv(self.R)[:count]
        except numpy.linalg.LinAlgError:
            return numpy.full((count, count), numpy.inf)
        return inverse @ inverse.T


class GaussMarkov:
    """First-order Gauss-Markov processes, states `first` on, each of stationary `sigma`."""

    def __init__(self, first, count, sigma, time_s):
        self.places, self.sigma, self.time_s = range(first, first + count), sigma, time_s

    def sigmas(self):
        return [self.sigma] * len(self.places)

    def fill(self, _, dt, transition, noise):
        """Its rows of the transition from a time over dt, and of the covariance of the noise."""
        decay = numpy.exp(-dt / self.time_s)
        for place in self.places:
            transition[place, place] = decay
            noise[place, place] = self.sigma**2 * (1 - decay**2)
