#pragma once

/// For small functions that run for each pixel or element: inlined also where their callers are compiled for size.
#define PF_ALWAYS_INLINE inline __attribute__((always_inline))
