#ifndef PLANEFOLD_PLATFORM_LIBCAMERA_NODES_H
#define PLANEFOLD_PLATFORM_LIBCAMERA_NODES_H

namespace pf::libcamera {

/// How many video devices that this process has open are no longer in /dev, as when a camera was unplugged.
int count_gone_nodes();

}  // namespace pf::libcamera

#endif
