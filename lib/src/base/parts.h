#pragma once

/// Which optional parts of the library this build has: the CMake options PLANEFOLD_WINDOW, PLANEFOLD_INERTIAL, PLANEFOLD_WALLS,
/// PLANEFOLD_MASKS and PLANEFOLD_MEMORY. Code of a missing part is behind a condition that is false at compile time, so that the linker
/// leaves it out of the archive; a config that needs it is rejected (api/config.cpp).

#ifndef PLANEFOLD_WINDOW
#define PLANEFOLD_WINDOW 1
#endif
#ifndef PLANEFOLD_INERTIAL
#define PLANEFOLD_INERTIAL 1
#endif
#ifndef PLANEFOLD_WALLS
#define PLANEFOLD_WALLS 1
#endif
#ifndef PLANEFOLD_MASKS
#define PLANEFOLD_MASKS 1
#endif
#ifndef PLANEFOLD_MEMORY
#define PLANEFOLD_MEMORY 1
#endif

namespace pf {

inline constexpr bool kHasWindow = PLANEFOLD_WINDOW != 0;      ///< the keyframe back end
inline constexpr bool kHasInertial = PLANEFOLD_INERTIAL != 0;  ///< the inertial motion model
inline constexpr bool kHasWalls = PLANEFOLD_WALLS != 0;        ///< walls of a plan, and patches
inline constexpr bool kHasMasks = PLANEFOLD_MASKS != 0;        ///< templates with masks
inline constexpr bool kHasMemory = PLANEFOLD_MEMORY != 0;      ///< places, and maps that are saved

/// A setting that is always false, and known to be, in builds without its part.
template <bool kPart>
class PartSwitch {
 public:
  constexpr operator bool() const { return kPart && on_; }
  PartSwitch& operator=(bool on) {
    on_ = kPart && on;
    return *this;
  }

 private:
  bool on_ = false;
};

/// A pointer that is always null, and known to be, in builds without its part.
template <typename T, bool kPart>
class PartPointer {
 public:
  operator T*() const { return kPart ? at_ : nullptr; }
  T* operator->() const { return at_; }
  PartPointer& operator=(T* at) {
    at_ = kPart ? at : nullptr;
    return *this;
  }

 private:
  T* at_ = nullptr;
};

}  // namespace pf
