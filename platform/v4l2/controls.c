#include <string.h>

#include "device.h"

static int has(int fd, uint32_t id, struct v4l2_queryctrl* control) {
  memset(control, 0, sizeof(*control));
  control->id = id;
  return pf_v4l2_call(fd, VIDIOC_QUERYCTRL, control) == 0 && (control->flags & V4L2_CTRL_FLAG_DISABLED) == 0;
}

static int set(int fd, uint32_t id, int32_t value) {
  struct v4l2_control control;
  control.id = id;
  control.value = value;
  return pf_v4l2_call(fd, VIDIOC_S_CTRL, &control);
}

static int32_t within(const struct v4l2_queryctrl* control, double value) {
  if (value <= (double)control->minimum) {
    return control->minimum;
  }
  return value >= (double)control->maximum ? control->maximum : (int32_t)(value + 0.5);
}

/* Exposure is in units of 100 microseconds. */
static int lock_exposure(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  struct v4l2_queryctrl control;
  const char* path = camera->info.device.path;
  int32_t value;
  if (!has(camera->fd, V4L2_CID_EXPOSURE_ABSOLUTE, &control)) {
    return pf_v4l2_refuse(message, "%s (%s): has no control for the time of exposure; leave --exposure away", path,
                          camera->info.device.name);
  }
  value = within(&control, camera->options.exposure_s * 1e4);
  if (has(camera->fd, V4L2_CID_EXPOSURE_AUTO, &control)) {
    /* Some cameras know one of these two names for "not automatic" only. */
    if (set(camera->fd, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL) != 0) {
      set(camera->fd, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_SHUTTER_PRIORITY);
    }
  }
  if (has(camera->fd, V4L2_CID_EXPOSURE_AUTO_PRIORITY, &control)) {
    set(camera->fd, V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0); /* the rate must not sink in the dark */
  }
  if (set(camera->fd, V4L2_CID_EXPOSURE_ABSOLUTE, value) != 0) {
    return pf_v4l2_refuse(message, "%s (%s): refuses a fixed exposure; leave --exposure away", path,
                          camera->info.device.name);
  }
  camera->info.exposure_s = 1e-4 * value;
  return 0;
}

static int lock_focus(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  struct v4l2_queryctrl control;
  const char* path = camera->info.device.path;
  if (has(camera->fd, V4L2_CID_FOCUS_AUTO, &control) && set(camera->fd, V4L2_CID_FOCUS_AUTO, 0) != 0) {
    return pf_v4l2_refuse(message, "%s (%s): does not let go of its autofocus; leave --focus away", path,
                          camera->info.device.name);
  }
  if (camera->options.focus >= 0) {
    if (!has(camera->fd, V4L2_CID_FOCUS_ABSOLUTE, &control) ||
        set(camera->fd, V4L2_CID_FOCUS_ABSOLUTE, within(&control, camera->options.focus)) != 0) {
      return pf_v4l2_refuse(message, "%s (%s): has no control for the focus; leave --focus away", path,
                            camera->info.device.name);
    }
  }
  return 0;
}

int pf_v4l2_set_controls(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  camera->info.exposure_s = 0.0;
  if (camera->options.exposure_s > 0.0 && lock_exposure(camera, message) != 0) {
    return -1;
  }
  return camera->options.lock_focus != 0 ? lock_focus(camera, message) : 0;
}
