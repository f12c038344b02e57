#include "filter/frame_pixels.h"

namespace pf {

Vec2 at_frame_time(const Filter& filter, int slot, const Vec2& measured) {
  const Camera& lens = filter.lens();
  if (lens.readout == Scalar(0)) return measured;
  Camera at_once = lens;
  at_once.readout = Scalar(0);
  PixelMeasurement by_rows, still;
  if (!filter.predict_pixel(lens, slot, &by_rows) || !filter.predict_pixel(at_once, slot, &still)) return measured;
  return measured - (by_rows.predicted - still.predicted);
}

}  // namespace pf
