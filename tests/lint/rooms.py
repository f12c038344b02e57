"""Which room of the house may include which. The lint tests share it."""

# Rooms of lib/src, each with the other rooms of lib/src that it may include.
LIBRARY = {
    "base": [],
    "covariance": ["base"],
    "geometry": ["base"],
    "vision": ["base"],
    "filter": ["base", "covariance", "geometry"],
    "track": ["base", "covariance", "geometry", "vision"],
    "window": ["base", "covariance", "geometry"],
    "map": ["base", "covariance", "geometry", "vision"],
    "slam": ["base", "covariance", "geometry", "vision", "filter", "track", "window", "map"],
    "api": ["base", "covariance", "geometry", "vision", "filter", "track", "window", "map", "slam"],
}

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
    "slam/frame_loop.h": ["slam/frame_loop*", "slam/session*", "slam/view*"],
    "slam/session.h": ["slam/session.cpp", "api/*"],
    # Starts and the state that the caller sees know no filter; nor do the frame's results.
    "filter/filter.h": ["filter/*", "slam/body_motion*", "slam/consensus*", "slam/feature_keeper*", "slam/filter_start*", "slam/frame_loop*",
                        "slam/image_front_end*", "slam/leave_one_out*", "slam/observation_front_end*", "slam/pixel_update*", "slam/patch_*", "slam/plane_*",
                        "slam/pose_mark*", "slam/proposed_poses*", "slam/relocaliser*", "slam/rest_hold*", "slam/settings.h", "slam/triple_consensus*", "slam/unit_watch*",
                        "slam/usable_pose*"],
    "slam/patch_keeper.h": ["slam/patch_*", "slam/frame_loop*", "slam/view*"],
    "slam/plane_keeper.h": ["slam/plane_*", "slam/frame_loop*", "slam/view*"],
    "slam/image_front_end.h": ["slam/image_*", "slam/filter_start*", "slam/frame_loop*", "slam/relocaliser*"],
    "slam/relocaliser.h": ["slam/relocaliser.cpp", "slam/frame_loop*"],
    "slam/observation_front_end.h": ["slam/observation_front_end.cpp", "slam/frame_loop*"],
    "slam/filter_start.h": ["slam/filter_start*", "slam/frame_loop*"],
}

# Rooms whose files have at most so many lines.
MAX_LINES = {"slam": 300, "filter": 300}
