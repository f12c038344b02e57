"""Copies whose frames come otherwise: which of them, in which order, and at which times."""

import numpy as np

KEPT_FIRST = 3  # of those that never come, none is among the first


def every(step):
    return lambda times, _: list(range(0, len(times), step))


def at_rate(rate_hz):
    """The frame nearest to each time of that rate."""
    def chosen(times, _):
        wanted = np.arange(times[0], times[-1] + 1e-9, 1 / rate_hz)
        return list(dict.fromkeys(int(np.argmin(np.abs(np.array(times) - t))) for t in wanted))
    return chosen


def dropped(share):
    def chosen(times, draw):
        return [k for k in range(len(times)) if k < KEPT_FIRST or draw.random() > share]
    return chosen


CHOSEN = {"second": every(2), "third": every(3), "rate-10": at_rate(10), "rate-5": at_rate(5), "dropped-20": dropped(0.2),
          "dropped-35": dropped(0.35), "backwards": lambda times, _: list(range(len(times)))[::-1]}


def rate_of(kind, rate_hz, count, kept):
    """What the calibration says of the rate of a copy."""
    if kind.startswith("rate-"):
        return min(rate_hz, float(kind.removeprefix("rate-")))
    return rate_hz / {"second": 2, "third": 3}.get(kind, 1)
