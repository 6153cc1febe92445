"""Correlation in time of measured errors."""
import numpy

LAGS = numpy.unique(numpy.geomspace(1, 240, 30).astype(int))
TIMES = numpy.geomspace(1, 500, 25)  # periods


def neighbours(times, lag):
    """Indices of pairs that are `lag` apart."""
    late = numpy.searchsorted(times, times + lag - 1e-3)
    early = numpy.flatnonzero(late < len(times))
    late = late[early]
    same = numpy.abs(times[late] - times[early] - lag) < 1e-2
    return early[same], late[same]


def correlation(series, period):
    """Shares and times (s) of two first-order processes, the rest being white, in series [(times, values)] of unit mean square: least
    squares of the autocorrelation, each lag by its number of pairs."""
    products, weights = numpy.zeros(len(LAGS)), numpy.zeros(len(LAGS))
    for k, lag in enumerate(LAGS):
        for times, values in series:
            early, late = neighbours(times, lag * period)
            products[k] += values[early] @ values[late]
            weights[k] += len(early)
    seen = weights > 0
    if not seen.any():
        return (0.0, 0.0), (period, 2 * period)
    target, weight = products[seen] / weights[seen], numpy.sqrt(weights[seen])
    best = (numpy.inf, (0.0, 0.0), (period, period))
    for k, fast in enumerate(TIMES):
        for slow in TIMES[k + 1:]:
            shapes = numpy.exp(-LAGS[seen, None] / numpy.array([fast, slow]))
            shares = not_negative(shapes * weight[:, None], target * weight)
            shares = shares / max(1.0, shares.sum())
            misfit = (((target - shapes @ shares) * weight)**2).sum()
            if misfit < best[0]:
                best = (misfit, tuple(shares), (fast * period, slow * period))
    return best[1:]


def not_negative(columns, values):
    """Least squares with two factors that are not negative."""
    solution = numpy.linalg.lstsq(columns, values, rcond=None)[0]
    if (solution >= 0).all():
        return solution
    single = numpy.maximum(0, columns.T @ values / (columns**2).sum(0))
    keep = int(numpy.argmax(single**2 * (columns**2).sum(0)))
    return numpy.where(numpy.arange(2) == keep, single, 0.0)
