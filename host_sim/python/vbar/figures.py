"""Standard figures of a run, drawn by matplotlib."""
import matplotlib.pyplot as plt
import numpy

HOUR = 3600.0
AXES = {"r": "R", "t": "T", "n": "N"}


def scaled(values, unit="m"):
    """A factor and a unit in which the largest of the values is a number of one to three digits before the point."""
    finite = numpy.abs(numpy.asarray(values, dtype=float))
    largest = numpy.nanmax(finite) if numpy.isfinite(finite).any() else 1.0
    return (1e-3, f"k{unit}") if largest >= 1e3 else (1.0, unit) if largest >= 1.0 else (1e3, f"m{unit}")


def hours(table, time="time_s"):
    return table[time] / HOUR


def relative(run):
    """The target about the servicer: in the orbital plane, across it, and its distance over time."""
    truth, estimate = run.truth, run.estimate
    names = {axis: f"relative_position_rtn_{axis}_m" for axis in AXES}
    factor, unit = scaled(truth[list(names.values())])
    figure, (plane, across, distance) = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
    for axes, other in ((plane, "r"), (across, "n")):
        for table, label in ((truth, "true"), (estimate, "estimated")):
            axes.plot(factor * table[names["t"]], factor * table[names[other]], label=label, linewidth=1)
        axes.plot(0, 0, "k+")
        axes.set_xlabel(f"T ({unit})")
        axes.set_ylabel(f"{AXES[other]} ({unit})")
    plane.legend()
    ranges = numpy.linalg.norm(truth[list(names.values())].to_numpy(), axis=1)
    distance.semilogy(hours(truth), ranges)
    distance.set_xlabel("time (h)")
    distance.set_ylabel("range (m)")
    return figure


def navigation(run):
    """Errors of the estimated relative position and velocity between three sigmas."""
    errors = run.errors()
    figure, rows = plt.subplots(3, 2, figsize=(11, 7), sharex=True, layout="constrained")
    for column, (quantity, ending, unit) in enumerate((("position", "m", "m"), ("velocity", "mps", "m/s"))):
        names = [f"{quantity}_error_{axis}_{ending}" for axis in AXES]
        bounds = 3.0 * errors[[name.replace("error", "sigma") for name in names]].to_numpy().ravel()
        usual = numpy.nanpercentile(bounds, 90) if numpy.isfinite(bounds).any() else 1.0
        factor, unit = scaled([usual], unit)
        for axes, axis, name in zip(rows[:, column], AXES, names):
            sigma = 3.0 * factor * errors[name.replace("error", "sigma")]
            axes.set_ylim(-2.0 * factor * usual, 2.0 * factor * usual)  # of most of the run: not of its first minutes
            axes.fill_between(hours(errors), -sigma, sigma, alpha=0.25, label="3 sigma", linewidth=0)
            axes.plot(hours(errors), factor * errors[name], linewidth=1, label="estimated minus true")
            axes.set_ylabel(f"{AXES[axis]} ({unit})")
        rows[0, column].set_title(quantity)
        rows[-1, column].set_xlabel("time (h)")
    rows[0, 0].legend()
    if errors[names[0]].isna().all():
        figure.suptitle("no estimate in this run")
    return figure


def roe(run):
    """Mean relative orbital elements times the reference semi-major axis: true, estimated, and desired at the waypoints."""
    figure, rows = plt.subplots(3, 2, figsize=(11, 7), sharex=True, layout="constrained")
    for axes, element in zip(rows.flat, ("da", "dlambda", "dex", "dey", "dix", "diy")):
        factor, unit = scaled(run.truth[f"a_roe_mean_{element}_m"])
        for table, label in ((run.truth, "true"), (run.estimate, "estimated")):
            axes.plot(hours(table), factor * table[f"a_roe_mean_{element}_m"], label=label, linewidth=1)
        if "waypoints" in run.tables:
            axes.plot(hours(run.waypoints), factor * run.waypoints[f"a_roe_desired_{element}_m"], "x", label="desired at a waypoint")
        axes.set_ylabel(f"a {element} ({unit})")
    rows[0, 0].legend()
    for axes in rows[-1]:
        axes.set_xlabel("time (h)")
    return figure


def burns(run):
    """Executed burns by axis, and their sum over time."""
    table = run.maneuvers
    columns = [f"executed_dv_rtn_{axis}_mps" for axis in AXES]
    factor, unit = scaled(table[columns], "m/s")
    figure, (each, total) = plt.subplots(2, 1, figsize=(9, 6), sharex=True, layout="constrained")
    time = hours(table, "execution_time_s")
    for axis, column in zip(AXES, columns):
        each.plot(time, factor * table[column], "o", markersize=3, label=AXES[axis])
    each.axhline(0, color="black", linewidth=0.5)
    each.set_ylabel(f"burn ({unit})")
    each.legend()
    total.step(time, numpy.linalg.norm(table[columns].to_numpy(), axis=1).cumsum(), where="post")
    total.set_ylabel("sum (m/s)")
    total.set_xlabel("time (h)")
    return figure


FIGURES = {function.__name__: function for function in (relative, navigation, roe, burns)}


def figure(run, name):
    if name not in FIGURES:
        raise ValueError(f"figure {name!r}: accepted are {', '.join(FIGURES)}")
    return FIGURES[name](run)
