#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "unit.h"

int pf_iio_find_axes(const struct iio_device* device, int kind, struct iio_channel* axis[3]) {
  const char* const form[PF_IIO_KINDS] = {"anglvel_%c", "accel_%c"};
  for (int i = 0; i < 3; ++i) {
    char id[16];
    snprintf(id, sizeof(id), form[kind], "xyz"[i]);
    axis[i] = iio_device_find_channel(device, id, false);
    if (axis[i] == NULL) {
      return -1;
    }
  }
  return 0;
}

void pf_iio_describe(const struct iio_device* device, pf_iio_device_t* description) {
  struct iio_channel* axis[3];
  char node[64];
  const char* name = iio_device_get_name(device);
  memset(description, 0, sizeof(*description));
  snprintf(description->id, sizeof(description->id), "%s", iio_device_get_id(device));
  snprintf(description->name, sizeof(description->name), "%s", name != NULL ? name : "");
  for (int kind = 0; kind < PF_IIO_KINDS; ++kind) {
    if (pf_iio_find_axes(device, kind, axis) == 0) {
      *(kind == PF_IIO_GYRO ? &description->gyro : &description->accel) = 1;
      description->buffered = iio_channel_is_scan_element(axis[0]) ? 1 : description->buffered;
    }
  }
  snprintf(node, sizeof(node), "/dev/%s", description->id);
  description->refused = access(node, F_OK) == 0 && access(node, R_OK) != 0 ? 1 : 0;
}

int pf_iio_list(pf_iio_device_t* devices, int capacity) {
  int count = 0;
  struct iio_context* context = iio_create_local_context();
  if (context == NULL) {
    return 0;
  }
  for (unsigned i = 0; i < iio_context_get_devices_count(context); ++i) {
    const struct iio_device* device = iio_context_get_device(context, i);
    pf_iio_device_t description;
    pf_iio_describe(device, &description);
    if (iio_device_is_trigger(device) || (description.gyro == 0 && description.accel == 0)) {
      continue;
    }
    if (devices != NULL && count < capacity) {
      devices[count] = description;
    }
    ++count;
  }
  iio_context_destroy(context);
  return count;
}

const char* pf_iio_permission_hint(void) {
  return "IIO devices belong to root; a udev rule lets a group read them: SUBSYSTEM==\"iio\", GROUP=\"plugdev\", "
         "MODE=\"0660\", RUN+=\"/bin/sh -c 'chgrp -R plugdev /sys$devpath; chmod -R g+rwX /sys$devpath'\"";
}
