"""Sources of frames, by the names that pf-capture knows."""

from __future__ import annotations

import os
import warnings

from . import _core
from ._errors import Refused


def open_sequence(source: str, calibration: str | os.PathLike[str] | None = None) -> _core.Sequence | _core.Sim:
    """Frames of "images:DIR", "euroc:DIR", "tum:DIR" or "sim:NAME", to iterate over as (image, t_ns); .camera is the calibration.

    calibration  a calibration file; without, the one inside DIR
    """
    if source.startswith("sim:"):
        if calibration is not None:
            raise Refused(f"{source}: a scene knows its lens, and takes no calibration")
        return _core.Sim(source[4:])
    if not hasattr(_core, "Sequence"):
        raise Refused(f"{source}: this build reads no images; it was made without libpng, libjpeg or yaml-cpp")
    sequence = _core.Sequence(source, None if calibration is None else os.fspath(calibration))
    if sequence.warning:
        warnings.warn(sequence.warning, RuntimeWarning, stacklevel=2)
    return sequence
