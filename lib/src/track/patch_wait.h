#pragma once

#include <cstdint>

/// Which plane a patch lies on: every plane that may explain it is tried in each frame, until one is left (lib/docs/theory/walls.md). It
/// knows whether planes passed the gate, and no geometry.

namespace pf {

class Archive;

enum class WaitVerdict : std::uint8_t {
  kWait,   ///< too little parallax, or more than one plane explains it
  kJoin,   ///< the plane in `joined` does
  kFound,  ///< none does, and there is parallax: a plane of its own
  kGiveUp  ///< none does, and there is none
};

/// One patch's planes. Plain data.
class PatchWait {
 public:
  static constexpr int kMaxTrials = 6;

  void begin() { *this = PatchWait(), waits_ = true; }
  void end() { waits_ = false; }
  bool waits() const { return waits_; }

  /// A frame in which the patch was found: begin_frame, try_plane for each plane, decide.
  /// counts: it waits no longer than for a number of such frames.
  void begin_frame(bool counts = true);
  /// known: a wall of the plan. chi2 of the corners, eight degrees of freedom. The first ones to be tried are kept where they are too many.
  void try_plane(std::uint32_t plane, bool known, float chi2, float gate);
  /// has_parallax: another depth would show in this frame.
  WaitVerdict decide(bool has_parallax, std::uint32_t* joined);

  /// Frames in a row, up to the last one, in which no plane passed.
  int frames_without() const { return without_; }
  /// The plane that explains the last frame best; 0: none passed.
  std::uint32_t likely() const;
  /// Whether this plane explains the last frame.
  bool passes(std::uint32_t plane) const;
  /// Number of planes that are not rejected.
  int open() const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Trial {
    std::uint32_t plane = 0;  ///< id
    float chi2 = 0;           ///< in the last frame
    std::uint8_t under = 0;   ///< frames in a row that it passed with parallax
    std::uint8_t over = 0;    ///< frames in a row that it did not pass
    bool known = false, tried = false;

    bool is_open() const;
  };
  const Trial* only_open(bool walls_alone) const;

  Trial trial_[kMaxTrials];
  std::uint8_t count_ = 0;
  std::uint8_t frames_ = 0;   ///< in which it was found, that count
  std::uint8_t without_ = 0;  ///< of them in a row, without a plane that passed
  bool waits_ = false;
};

}  // namespace pf
