#include "filter_slam/pose/zoom_evidence.h"

#include "bundle/zoom_fit.h"

namespace pf {

void weigh_lens(const Settings& settings, const Filter& filter, const PixelMeasurement* observations,
                const unsigned char* keep, int count, const Body& pose, PoseConsensus* consensus) {
  ZoomPoints points;
  for (int i = 0; i < count; ++i) {
    const PixelMeasurement& o = observations[i];
    if (keep[i] == 0) continue;
    const bool is_open = filter.state().block[o.block].kind == BlockKind::kInverseDepth;
    const Mat2 noise = is_open ? Mat2(o.R_gate + filter.innovation_block(i, i)) : o.R_gate;
    points.add({filter.point(o.block), Scalar(1), o.measured}, noise.trace() / 2);
  }
  note_zoom(points.fit(filter.lens(), {pose.q_WC, pose.p_W}), settings, consensus);
}

}  // namespace pf
