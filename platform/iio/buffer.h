/* The kernel's buffer of a device: which channels, and where they lie in a scan. libiio's own buffers write to stderr. */
#ifndef PLANEFOLD_PLATFORM_IIO_BUFFER_H
#define PLANEFOLD_PLATFORM_IIO_BUFFER_H

#include <iio.h>
#include <stdint.h>

#define PF_IIO_CHANNELS 7 /* two sensors of three axes, and the time */
#define PF_IIO_BATCH 64   /* scans that are fetched at once */

typedef struct pf_iio_place {
  const struct iio_channel* channel;
  unsigned begin; /* byte of the scan */
} pf_iio_place_t;

typedef struct pf_iio_buffer {
  int fd; /* -1: not open */
  char device[32];
  pf_iio_place_t place[PF_IIO_CHANNELS];
  int channels;
  unsigned step;                           /* bytes from scan to scan */
  unsigned char bytes[PF_IIO_BATCH * 128]; /* a channel has at most 16 bytes with what fills up */
} pf_iio_buffer_t;

/* These channels and no others begin to stream. 0, or a negative errno. */
int pf_iio_buffer_open(pf_iio_buffer_t* buffer, const struct iio_device* device,
                       const struct iio_channel* const channels[], int count);
void pf_iio_buffer_close(pf_iio_buffer_t* buffer);

/* Number of scans in bytes, 0 for nothing yet, or a negative errno. */
int pf_iio_buffer_read(pf_iio_buffer_t* buffer);

/* The number of a channel in a scan, as the driver gave it. */
int64_t pf_iio_buffer_number(const pf_iio_buffer_t* buffer, int scan, const struct iio_channel* channel);

/* The bits that a channel's format names, out of bytes in its order. */
int64_t pf_iio_decode(const struct iio_data_format* format, const unsigned char* bytes);

#endif
