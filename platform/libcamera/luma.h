#ifndef PLANEFOLD_PLATFORM_LIBCAMERA_LUMA_H
#define PLANEFOLD_PLATFORM_LIBCAMERA_LUMA_H

#include <planefold_platform/libcamera.h>

#include <cstddef>

namespace pf::libcamera {

/// Bytes that a row of the first plane takes without padding.
size_t row_bytes(uint32_t format, int32_t width);

/// true: the first plane is 8-bit grey as it is.
bool has_grey_plane(uint32_t format);

/// The first plane of a frame to grey levels; rows of in are stride bytes apart, rows of out width bytes.
///
///   colours: (77 R + 150 G + 29 B + 128) / 256, the weights of ITU-R BT.601 in 256ths
void to_grey(uint32_t format, const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out);

}  // namespace pf::libcamera

#endif
