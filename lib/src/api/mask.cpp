#include <cstddef>

#include "api/context.h"
#include "frame/corner_cells.h"
#include "frame/tuning.h"
#include "vision/image_mask.h"

namespace {

using pf::CornerCells;
using pf::ImageMask;
using pf::Rect;

bool overlap(const Rect& a, const pf_rectangle_t& b) {
  const auto meet = [](std::int64_t from, std::int64_t length, std::int64_t other, std::int64_t other_length) {
    return from < other + other_length && other < from + length;
  };
  return meet(a.x, a.width, b.x, b.width) && meet(a.y, a.height, b.y, b.height);
}

/// Whether the caller's mask has any pixel of a cell.
bool masks(const pf_mask_t& mask, const Rect& cell) {
  for (int i = 0; i < mask.num_rectangles; ++i)
    if (mask.rectangles[i].width > 0 && mask.rectangles[i].height > 0 && overlap(cell, mask.rectangles[i])) return true;
  if (mask.pixels == nullptr) return false;
  for (int y = cell.y; y < cell.y + cell.height && y < mask.height; ++y) {
    const std::uint8_t* row = mask.pixels + static_cast<std::ptrdiff_t>(y) * mask.stride;
    for (int x = cell.x; x < cell.x + cell.width && x < mask.width; ++x)
      if (row[x] == 0) return true;
  }
  return false;
}

/// Of the cells in which features begin, those that hold any scene.
int count_usable(const ImageMask& mask, int width, int height) {
  int usable = 0;
  for (int row = 0; row < CornerCells::kRows; ++row)
    for (int column = 0; column < CornerCells::kColumns; ++column) {
      const int x = column * width / CornerCells::kColumns, y = row * height / CornerCells::kRows;
      usable += mask.has_clear(
          Rect{x, y, (column + 1) * width / CornerCells::kColumns - x, (row + 1) * height / CornerCells::kRows - y});
    }
  return usable;
}

pf_status_t check(const pf_mask_t& mask, const pf_camera_t& camera) {
  if (mask.pixels == nullptr && mask.rectangles == nullptr) return PF_ERROR_NULL;
  if (mask.num_rectangles > 0 && mask.rectangles == nullptr) return PF_ERROR_NULL;
  if (mask.width != camera.width || mask.height != camera.height) return PF_ERROR_SIZE;
  if (mask.pixels != nullptr && mask.stride < mask.width) return PF_ERROR_SIZE;
  if (mask.num_rectangles < 0) return PF_ERROR_RANGE;
  for (int i = 0; i < mask.num_rectangles; ++i)
    if (mask.rectangles[i].width < 0 || mask.rectangles[i].height < 0) return PF_ERROR_RANGE;
  return PF_OK;
}

}  // namespace

pf_status_t pf_set_mask(pf_slam_t* slam, const pf_mask_t* mask) {
  PF_BEGIN_CHANGE(slam);
  if (mask == nullptr) return PF_ERROR_NULL;
  ImageMask* const kept = slam->session.settings().mask.mask;
  if (kept == nullptr) return PF_ERROR_FULL;
  const pf_camera_t& camera = slam->config.camera;
  const pf_status_t status = check(*mask, camera);
  if (status != PF_OK) return status;
  bool has_scene = false;
  for (int i = 0; i < kept->cells() && !has_scene; ++i) has_scene = !masks(*mask, kept->cell(i));
  if (!has_scene) return PF_ERROR_RANGE;
  kept->assign([mask](const Rect& cell) { return masks(*mask, cell); });
  const int usable = count_usable(*kept, camera.width, camera.height);
  return in_call.end(usable < pf::tuning::tracking::kMinInliers ? PF_NOTE_UNUSABLE : PF_OK);
}
