#pragma once

/// Checks for programming errors: they trap in debug builds and cost nothing in release builds. Never for untrusted
/// input.
#if defined(NDEBUG)
#define PF_ASSERT(condition) ((void)0)
#else
#define PF_ASSERT(condition) ((condition) ? (void)0 : __builtin_trap())
#endif
