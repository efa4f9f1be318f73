/* The .neph file: a set as bytes and back. The format is docs/neph-format.md. */
#ifndef SHAPE_NEPH_H
#define SHAPE_NEPH_H

#include "shape/set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The newest version that is known. A file is written in the lowest that has all that is in it: 1.0, or 1.1 where a cloud
 * has details or is a layer. Files of the same major version are read, whatever their minor version. */
enum { SHAPE_NEPH_MAJOR = 1, SHAPE_NEPH_MINOR = 1 };

/* The set as the bytes of a .neph file; the same set gives the same bytes everywhere. The caller frees *bytes with
 * free(). Errors: memory; a set that shape_set_check refuses; a name or made_by that is no plain UTF-8
 * (control characters are none); an extra of a known or impossible type; numbers too large for the format. */
shape_status shape_neph_encode(const shape_set *set, unsigned char **bytes, size_t *size, shape_error *error);

/* Reads untrusted bytes. Every offset, count and CRC is checked before memory is taken, and memory stays below four
 * times `size` plus a constant. *set is the caller's to destroy; on an error it is untouched, and the text says which
 * byte or chunk is wrong and what to do. Unknown chunks go to set->extras. */
shape_status shape_neph_decode(const void *bytes, size_t size, shape_set **set, shape_error *error);

/* Writes the box around each cloud's supports, in the cloud's frame, into boxes[set->cloud_count], as a file stores them.
 * Clouds that share a list and support it alike share the work. Errors: memory; 2^28 primitives of lists walked again,
 * since many clouds share them, each with a support of its own; a box that single precision, or a placed box that double
 * precision, cannot hold. The set has passed shape_set_check. */
shape_status shape_neph_bounds(const shape_set *set, shape_box *boxes, shape_error *error);

/* The version that the bytes of a file which shape_neph_decode accepts were written in. */
void shape_neph_version(const void *bytes, unsigned *major, unsigned *minor);

/* CRC-32 of IEEE 802.3 (reflected 0xEDB88320), as in PNG and zlib. */
uint32_t shape_crc32(const void *bytes, size_t size);

#ifdef __cplusplus
}
#endif
#endif
