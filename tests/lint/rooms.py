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
