"""Which room of the house may include which. The lint tests share it."""

GROUND = ["base", "covariance", "geometry", "vision"]
BLOCKS = GROUND[:3] + ["model", "observe"]
SHARED = GROUND + ["model", "observe", "filter", "bundle", "track", "map"]
FRAME = SHARED + ["belief", "frame", "frame/start"]
UNIT = FRAME + ["inertial"]
POSE = UNIT + ["filter_slam/pose"]
FEATURES = POSE + ["filter_slam/features"]
KEYFRAME_MAP = FRAME + ["memory", "keyframe_slam/map"]
KEYFRAME_PLANES = KEYFRAME_MAP + ["keyframe_slam/planes"]
KEYFRAME_MEMORY = KEYFRAME_PLANES + ["keyframe_slam/memory"]
KEYFRAME_TRACKING = KEYFRAME_MEMORY + ["keyframe_slam/tracking"]

# Rooms of lib/src, each with the other rooms of lib/src that it may include. A folder that is not named is part of the one that it is in.
LIBRARY = {
    "base": [],
    "covariance": ["base"],
    "geometry": ["base"],
    "vision": ["base"],
    "model": ["base", "geometry"],
    "observe": ["base", "geometry", "model"],
    "filter": BLOCKS,
    "bundle": BLOCKS,
    "track": GROUND,
    "map": GROUND,
    "belief": ["base"],
    "memory": GROUND + ["track", "map"],
    "frame": SHARED + ["belief"],
    "frame/start": SHARED + ["belief", "frame"],
    "inertial": FRAME,
    "filter_slam/pose": UNIT,
    "filter_slam/features": POSE,
    "filter_slam/planes": FEATURES,
    "filter_slam/patches": FEATURES,
    "filter_slam/memory": FEATURES + ["memory", "filter_slam/planes"],
    "filter_slam/recovery": FEATURES + ["memory", "filter_slam/planes", "filter_slam/memory"],
    "filter_slam/start": FEATURES + ["memory", "filter_slam/planes", "filter_slam/memory"],
    "filter_slam": FEATURES + ["memory"] + [f"filter_slam/{part}" for part in ("planes", "patches", "memory", "recovery", "start")],
    "keyframe_slam/map": FRAME + ["memory"],
    "keyframe_slam/planes": KEYFRAME_MAP,
    "keyframe_slam/memory": KEYFRAME_PLANES,
    "keyframe_slam/tracking": KEYFRAME_MEMORY,
    "keyframe_slam/adjustment": KEYFRAME_TRACKING,
    "keyframe_slam/walls": KEYFRAME_TRACKING + ["keyframe_slam/adjustment"],
    "keyframe_slam/loops": KEYFRAME_TRACKING + ["keyframe_slam/adjustment"],
    "keyframe_slam/start": KEYFRAME_TRACKING + ["keyframe_slam/adjustment"],
    "keyframe_slam/inertial": KEYFRAME_TRACKING + ["keyframe_slam/adjustment", "inertial"],
    "keyframe_slam": KEYFRAME_TRACKING + ["keyframe_slam/adjustment", "keyframe_slam/walls", "keyframe_slam/loops", "keyframe_slam/start", "keyframe_slam/inertial", "inertial"],
    "session": UNIT + ["memory", "filter_slam", "keyframe_slam"],
    "api": FRAME + ["session"],
}


def room_of(path):
    """The room that a path below lib/src lies in."""
    folders = path.split("/")[:-1]
    while folders and "/".join(folders) not in LIBRARY:
        folders.pop()
    return "/".join(folders)


# Rooms of lib/src that may see the public header: the door.
SEE_PUBLIC_HEADER = ["api"]

# What of the standard libraries lib/src may include: nothing that allocates, throws, prints, or depends on a locale.
STANDARD = {
    "algorithm", "array", "cfloat", "climits", "cmath", "cstddef", "cstdint", "cstring", "limits", "new", "numeric",
    "tuple", "type_traits", "utility",
    "float.h", "limits.h", "math.h", "stddef.h", "stdint.h", "string.h",
}

# What files compiled for one processor feature may include besides headers of the project that hold to the same.
FOR_ONE_PROCESSOR = {"immintrin.h", "emmintrin.h", "arm_neon.h", "float.h", "limits.h", "math.h", "stddef.h", "stdint.h", "string.h",
                     "cstddef", "cstdint"}

# Where the kernel set is chosen, the processor is asked what it can do.
PLATFORM_PROBES = {"cpuid.h", "sys/auxv.h", "asm/hwcap.h"}

# In sanitizer builds only: red zones of the arena.
SANITIZERS = {"sanitizer/asan_interface.h"}

# Folders above the public header that may look into lib/src all the same: kernels are timed where they are.
LOOK_INSIDE = {"tools/pf-bench"}

# Inside rooms: headers that only these files may include themselves. A name that ends in * stands for all that begin so.
ONLY_FOR = {
    # The API reads and drives a session; which back end works behind it is the session's and the view's affair.
    "filter_slam/filter_slam.h": ["filter_slam/filter_slam*", "filter_slam/carry.cpp", "session/*"],
    "keyframe_slam/keyframe_slam.h": ["keyframe_slam/keyframe_slam*", "keyframe_slam/carry.cpp", "session/*"],
    "session/session.h": ["session/session.cpp", "session/carry.cpp", "session/live_map.cpp", "api/*"],
    # Starts and the state that the caller sees know no filter; nor do the frame's results.
    "filter/filter.h": ["filter/*", "inertial/*", "filter_slam/*", "keyframe_slam/inertial/*", "frame/settings.h"],
}

# Folders of these rooms hold at most so many files (.h and .cpp, without those of folders in them).
LIMITED = ("session", "frame", "filter_slam", "keyframe_slam", "observe", "bundle")
MAX_FILES = 25

# Files of these folders have at most so many lines.
MAX_LINES = {"filter": 300}
