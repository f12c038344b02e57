#include "anchors.h"

#include <algorithm>
#include <cinttypes>

#include "maths.h"
#include "text_file.h"

namespace pf::capture {

namespace {

constexpr size_t kMaxAnchors = 64;  ///< of any config

/// Standard deviation of the anchor's position along the worst direction.
double sigma_of(const pf_anchor_t& anchor) {
  double position[9];
  for (size_t i = 0; i < 3; ++i) {
    for (size_t k = 0; k < 3; ++k) {
      position[3 * i + k] = anchor.covariance[6 * (3 + i) + 3 + k];
    }
  }
  return largest_sigma(position);
}

}  // namespace

void set_anchor(pf_slam_t* slam, const double pixel[2], bool metric, std::string& line) {
  pf_hit_t hit{};
  uint32_t id = 0;
  pf_anchor_t anchor{};
  if (pf_hit_test(slam, pixel, &hit) != PF_OK) {
    line += "no anchor: no plane is there";
    return;
  }
  const pf_status_t status = pf_add_anchor_hit(slam, &hit, &id);
  if (status != PF_OK || pf_get_anchor(slam, id, &anchor) != PF_OK) {
    line += std::string("no anchor: ") +
            (status == PF_ERROR_FULL    ? "there is no room for one more; --max-anchors and --max-state-dim make some"
             : status == PF_ERROR_STATE ? "the frame is not tracked"
                                        : pf_status_text(status));
    return;
  }
  append(line, "anchor %u on plane %u, at %.4g %.4g %.4g, sigma %.2g %s", id, anchor.plane, anchor.p_WA[0],
         anchor.p_WA[1], anchor.p_WA[2], metric ? 1e3 * sigma_of(anchor) : 1e2 * sigma_of(anchor) / hit.range,
         metric ? "mm" : "% of its distance");
}

std::vector<pf_anchor_t> read_anchors(const pf_slam_t* slam) {
  std::vector<pf_anchor_t> anchors(kMaxAnchors);
  size_t count = 0;
  if (pf_get_anchors(slam, anchors.data(), anchors.size(), &count) < 0) {
    count = 0;
  }
  anchors.resize(std::min(count, anchors.size()));
  return anchors;
}

void put_anchors(std::string& rows, const FrameView& view) {
  for (const pf_anchor_t& anchor : view.anchors) {
    if (anchor.map_id != view.report.map_id) {
      continue;
    }
    append(rows, "%" PRId64 ",%u,%d,%u", view.index, anchor.id, view.map, anchor.plane);
    for (const double value : anchor.q_WA) {
      append(rows, ",%.9g", value);
    }
    for (const double value : anchor.p_WA) {
      append(rows, ",%.9g", value);
    }
    for (const double value : anchor.covariance) {
      append(rows, ",%.9g", value);
    }
    rows += '\n';
  }
}

}  // namespace pf::capture
