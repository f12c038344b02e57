#include <errno.h>
#include <fcntl.h>
#include <linux/dma-buf.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "device.h"

void pf_v4l2_sync(const pf_v4l2_buffer_t* buffer, int begin) {
  if (buffer->dma_fd >= 0) {
    struct dma_buf_sync sync;
    sync.flags = DMA_BUF_SYNC_READ | (begin ? DMA_BUF_SYNC_START : DMA_BUF_SYNC_END);
    pf_v4l2_call(buffer->dma_fd, DMA_BUF_IOCTL_SYNC, &sync);
  }
}

void pf_v4l2_name_buffer(const pf_v4l2_t* camera, uint32_t index, pf_v4l2_named_t* named) {
  memset(named, 0, sizeof(*named));
  named->buffer.index = index;
  named->buffer.type = (uint32_t)camera->type;
  named->buffer.memory = V4L2_MEMORY_MMAP;
  if (camera->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
    named->buffer.m.planes = named->planes;
    named->buffer.length = camera->planes;
  }
}

static int map_one(pf_v4l2_t* camera, uint32_t index, char message[PF_V4L2_MESSAGE]) {
  const pf_v4l2_device_t* device = &camera->info.device;
  pf_v4l2_buffer_t* buffer = &camera->buffers[index];
  const int has_planes = camera->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  pf_v4l2_named_t asked;
  uint32_t length, offset;
  void* memory;
  pf_v4l2_name_buffer(camera, index, &asked);
  if (pf_v4l2_call(camera->fd, VIDIOC_QUERYBUF, &asked.buffer) != 0) {
    return pf_v4l2_refuse(message, "%s (%s): does not tell where its buffers are (%s)", device->path, device->name,
                          strerror(errno));
  }
  length = has_planes ? asked.planes[0].length : asked.buffer.length;
  offset = has_planes ? asked.planes[0].m.mem_offset : asked.buffer.m.offset;
  if (length < camera->image_bytes) {
    return pf_v4l2_refuse(message, "%s (%s): its buffers of %u bytes are too small for a picture", device->path,
                          device->name, length);
  }
  if (camera->options.dma_buf != 0) {
    struct v4l2_exportbuffer exported;
    memset(&exported, 0, sizeof(exported));
    exported.type = (uint32_t)camera->type;
    exported.index = index;
    exported.flags = O_CLOEXEC | O_RDWR;
    if (pf_v4l2_call(camera->fd, VIDIOC_EXPBUF, &exported) != 0) {
      return pf_v4l2_refuse(message, "%s (%s): its driver exports no buffers (%s); leave --dma-buf away", device->path,
                            device->name, strerror(errno));
    }
    buffer->dma_fd = exported.fd;
    memory = mmap(NULL, length, PROT_READ, MAP_SHARED, exported.fd, 0);
  } else {
    memory = mmap(NULL, length, PROT_READ | PROT_WRITE, MAP_SHARED, camera->fd, (off_t)offset);
  }
  if (memory == MAP_FAILED) {
    return pf_v4l2_refuse(message, "%s (%s): its buffers cannot be mapped (%s)", device->path, device->name,
                          strerror(errno));
  }
  buffer->mapped = (uint8_t*)memory;
  buffer->length = length;
  return 0;
}

int pf_v4l2_map(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  const pf_v4l2_device_t* device = &camera->info.device;
  const size_t area = (size_t)camera->info.width * (size_t)camera->info.height;
  struct v4l2_requestbuffers request;
  for (int i = 0; i < PF_V4L2_MAX_BUFFERS; ++i) {
    memset(&camera->buffers[i], 0, sizeof(camera->buffers[i]));
    camera->buffers[i].dma_fd = -1;
  }
  memset(&request, 0, sizeof(request));
  request.count = (uint32_t)camera->options.buffers;
  request.type = (uint32_t)camera->type;
  request.memory = V4L2_MEMORY_MMAP;
  if (pf_v4l2_call(camera->fd, VIDIOC_REQBUFS, &request) != 0) {
    return pf_v4l2_refuse(
        message,
        errno == EBUSY ? "%s (%s): another program streams from it (%s)" : "%s (%s): has no buffers to map (%s)",
        device->path, device->name, strerror(errno));
  }
  camera->info.buffers = (int32_t)(request.count < PF_V4L2_MAX_BUFFERS ? request.count : PF_V4L2_MAX_BUFFERS);
  if (camera->info.buffers < 2) {
    pf_v4l2_unmap(camera);
    return pf_v4l2_refuse(message, "%s (%s): gives %u buffers, and two are needed", device->path, device->name,
                          request.count);
  }
  camera->own = (uint8_t*)malloc(area * (size_t)camera->info.buffers);
  if (camera->own == NULL) {
    pf_v4l2_unmap(camera);
    return pf_v4l2_refuse(message, "not enough memory for pictures of %d x %d", camera->info.width,
                          camera->info.height);
  }
  for (int32_t i = 0; i < camera->info.buffers; ++i) {
    camera->buffers[i].own = camera->own + area * (size_t)i;
    if (map_one(camera, (uint32_t)i, message) != 0) {
      pf_v4l2_unmap(camera);
      return -1;
    }
  }
  return 0;
}

void pf_v4l2_unmap(pf_v4l2_t* camera) {
  struct v4l2_requestbuffers none;
  for (int32_t i = 0; i < camera->info.buffers; ++i) {
    pf_v4l2_buffer_t* buffer = &camera->buffers[i];
    if (buffer->mapped != NULL) {
      munmap(buffer->mapped, buffer->length);
      if (buffer->dma_fd >= 0) {
        close(buffer->dma_fd);
      }
    } else if (buffer->own != NULL && buffer->dma_fd >= 0) {
      close(buffer->dma_fd);
    }
    memset(buffer, 0, sizeof(*buffer));
    buffer->dma_fd = -1;
  }
  camera->info.buffers = 0;
  free(camera->own);
  camera->own = NULL;
  memset(&none, 0, sizeof(none));
  none.type = (uint32_t)camera->type;
  none.memory = V4L2_MEMORY_MMAP;
  pf_v4l2_call(camera->fd, VIDIOC_REQBUFS, &none);
}

static uint64_t sum(const uint8_t* bytes, size_t count) {
  uint64_t total = 0;
  for (size_t i = 0; i + 8 <= count; i += 8) {
    uint64_t word;
    memcpy(&word, bytes + i, 8);
    total += word;
  }
  return total;
}

double pf_v4l2_read_slowness(const uint8_t* mapped, size_t bytes) {
  int64_t best[2] = {INT64_MAX, INT64_MAX};
  volatile uint64_t keep = 0;
  uint8_t* ordinary;
  bytes = bytes < 65536 ? bytes : 65536; /* stays in the cache where there is one */
  ordinary = (uint8_t*)malloc(bytes);
  if (ordinary == NULL || bytes < 4096) {
    free(ordinary);
    return 0.0;
  }
  memset(ordinary, 1, bytes);
  for (int round = 0; round < 4; ++round) {
    for (int which = 0; which < 2; ++which) {
      const int64_t before = pf_v4l2_now_ns();
      keep = keep + sum(which == 0 ? mapped : ordinary, bytes);
      {
        const int64_t took = pf_v4l2_now_ns() - before;
        best[which] = took < best[which] ? took : best[which];
      }
    }
  }
  free(ordinary);
  return best[1] > 0 ? (double)best[0] / (double)best[1] : 0.0;
}
