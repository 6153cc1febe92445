"""Correlation in time of measured errors."""
import numpy


def correlation(series, period, lags=30):
    """Share and time (s) of the first-order process in unit-variance series of (times, values), beside white noise."""
    products = numpy.zeros(lags)
    for lag in range(1, lags + 1):
        pairs = [(values[late] * values[early]) for times, values in series
                 for early, late in [neighbours(times, lag * period)] if len(early)]
        products[lag - 1] = numpy.mean(numpy.concatenate(pairs)) if pairs else 0.0
    best = (numpy.inf, 0.0, period)
    for time in period * numpy.geomspace(1, 300, 60):
        shape = numpy.exp(-period * numpy.arange(1, lags + 1) / time)
        share = numpy.clip(shape @ products / (shape @ shape), 0.0, 1.0)
        misfit = ((products - share * shape)**2).sum()
        best = min(best, (misfit, share, time))
    return best[1:]


def neighbours(times, lag):
    """Indices of pairs that are `lag` apart."""
    late = numpy.searchsorted(times, times + lag - 1e-3)
    early = numpy.flatnonzero(late < len(times))
    late = late[early]
    same = numpy.abs(times[late] - times[early] - lag) < 1e-2
    return early[same], late[same]
