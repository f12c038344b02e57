"""planefold: a camera's pose and a map of planes and points, from one camera's frames.

    import planefold
    frames = planefold.open_sequence("images:DIR")            # or "sim:desk", euroc:DIR, tum:DIR
    slam = planefold.Slam(planefold.Config(camera=frames.camera))
    for image, t_ns in frames:                                # grey, uint8; whole nanoseconds
        if slam.push_frame(image, t_ns) == planefold.Status.OK:
            print(slam.pose.p_WC)

Structures and fields have the names of planefold.h, without pf_. What the C library refuses is a planefold.Error here.
planefold.eval, planefold.plot and planefold.bags need more packages: pip install planefold[eval] or planefold[bags].
"""

from ._core import *  # noqa: F403
from ._core import version as _version
from ._errors import Error as Error
from ._errors import Refused as Refused
from ._sources import open_sequence as open_sequence

__version__ = _version()
__all__ = [name for name in dir() if not name.startswith("_")]
