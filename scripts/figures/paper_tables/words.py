"""Numbers of docs/paper.md as words."""
import statistics


def digits(value, count=3):
    value = float(f"{value:.{count}g}")
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.6f}".rstrip("0").rstrip(".")


def mean_of(rows, key, **where):
    return statistics.fmean(row[key] for row in rows
                            if all(row[k] == v for k, v in where.items()))


def spread_of(rows, key, **where):
    """The mean and the reach of the seeds around it."""
    values = [row[key] for row in rows if all(row[k] == v for k, v in where.items())]
    middle, reach = statistics.fmean(values), (max(values) - min(values)) / 2
    return f"{digits(middle)} ± {digits(reach, 1)}" if len(values) > 1 else digits(middle)
