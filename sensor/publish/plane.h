/* sensor/publish/plane.h: one named plane of numbers, for files and hashes. */
#ifndef SENSOR_PUBLISH_PLANE_H
#define SENSOR_PUBLISH_PLANE_H

#include "pitviper.h"

/* C64: two floats, real, imaginary. */
typedef enum PlaneType { PLANE_F32, PLANE_U32, PLANE_F64, PLANE_C64, PLANE_U8 } PlaneType;

/* Borrowed, never owned. values: float, uint32_t, double, float complex or uint8_t [height][width], rows top down. */
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

#endif
