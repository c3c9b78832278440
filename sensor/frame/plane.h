/* sensor/frame/plane.h: one named plane of numbers, for files and hashes, and the hash of several. */
#ifndef SENSOR_FRAME_PLANE_H
#define SENSOR_FRAME_PLANE_H

#include "pitviper.h"
#include "render/frame/plane_type.h"
#include "pitviper_sha256.h"

/* A plane borrows its values: float, uint32_t, double, float complex or uint8_t [height][width], rows top down. */
typedef struct Plane {
    const char *name; /* channel name; for a hash with the folder before it: `lwir/Y`, `truth/range_m` */
    PlaneType   type;
    int         width, height;
    const void *values;
} Plane;

static inline Plane plane_f32(const char *name, int width, int height, const float *values)
{
    return (Plane){name, PLANE_F32, width, height, values};
}

static inline Plane plane_u32(const char *name, int width, int height, const uint32_t *values)
{
    return (Plane){name, PLANE_U32, width, height, values};
}

static inline Plane plane_f64(const char *name, int width, int height, const double *values)
{
    return (Plane){name, PLANE_F64, width, height, values};
}

/* ---- the hash ------------------------------------------------------------------------------------ */

/* The hash that identifies equal frames, as 64 hexadecimal digits.
 *
 * SHA-256 over the planes before encoding, never over file bytes (encoders differ, and stamp dates). Planes are
 * taken in the byte order of their names, whatever order they come in. For each plane, in turn:
 *
 *     name          its bytes, then one octet 0
 *     width, height two uint32, little-endian
 *     type          four octets: "f32\0", "u32\0", "f64\0", "c64\0" or "u8\0\0"
 *     values        rows top down, left to right, little-endian; every NaN of f32 as 0x7fc00000, of f64 as
 *                   0x7ff8000000000000; all other values bit for bit (so -0 and 0 differ)
 *
 * Nothing precedes the first plane or follows the last. */

enum { plane_hash_max_planes = 256 };

/* STATUS_BAD_VALUE: too many planes, an empty or repeated name, a size below 1. No planes: the hash of
 * nothing. out is untouched on failure. */
Status plane_hash(char out[sha256_text_size], const Plane *plane, int plane_count);

#endif
