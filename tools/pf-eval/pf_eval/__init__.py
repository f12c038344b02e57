"""Comparison of runs of pf-capture with ground truth, and their plots."""


class Refused(Exception):
    """What the user gave cannot be used; the message is one line that names the file and says why."""
