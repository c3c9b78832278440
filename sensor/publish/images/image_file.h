/* sensor/publish/images/image_file.h: image files: written through OpenEXR (exr_module.cpp) and libpng (png_file.c),
 * read through OpenImageIO (image_module.cpp); no other file uses these libraries.
 *
 * A file appears complete or not at all: it is written chunk by chunk as `PATH.part` and renamed. Every failure is
 * one log line with path and reason, and a Status; nothing of a failed file is left behind. Thread-safe for
 * different paths. Each call allocates and frees its own memory. */
#ifndef SENSOR_PUBLISH_IMAGES_IMAGE_FILE_H
#define SENSOR_PUBLISH_IMAGES_IMAGE_FILE_H

#include "sensor/frame/plane.h"

typedef enum ImageAttributeType { IMAGE_STRING, IMAGE_INT, IMAGE_FLOAT, IMAGE_DOUBLE } ImageAttributeType;

/* One piece of metadata. EXR has int (32 bits), float and string; IMAGE_DOUBLE is stored as EXR's double. */
typedef struct ImageAttribute {
    const char        *name;
    ImageAttributeType type;
    const char        *text;    /* IMAGE_STRING */
    int                integer; /* IMAGE_INT */
    double             number;  /* IMAGE_FLOAT, IMAGE_DOUBLE */
} ImageAttribute;

static inline ImageAttribute image_string(const char *name, const char *text)
{
    return (ImageAttribute){name, IMAGE_STRING, text, 0, 0};
}

static inline ImageAttribute image_int(const char *name, int integer)
{
    return (ImageAttribute){name, IMAGE_INT, NULL, integer, 0};
}

static inline ImageAttribute image_float(const char *name, double number)
{
    return (ImageAttribute){name, IMAGE_FLOAT, NULL, 0, number};
}

static inline ImageAttribute image_double(const char *name, double number)
{
    return (ImageAttribute){name, IMAGE_DOUBLE, NULL, 0, number};
}

enum { image_max_planes = 64, image_max_size_px = 32768 };

/* Loads what writing needs (some ms), and what reading and letters need (OpenImageIO, some 0.15 s). Every function
 * below does it by itself; a command that will call them from a pool prepares on the main thread, before the pool
 * starts. STATUS_IO, logged with what to install. */
Status image_file_prepare(void);
Status image_read_prepare(void);

/* EXR, one channel per plane, float32 or uint32 each, bit for bit (a uint32 never passes through a float), in a
 * compression by name (`none`, `rle`, `zips`, `zip:1`, `piz`, ...; frame_files.c has measurements). date_time:
 * `YYYY:MM:DD HH:MM:SS`, stored as capDate, which OpenImageIO calls DateTime; never the wall clock; NULL: 1970:01:01
 * 00:00:00. STATUS_BAD_VALUE: no planes or too many, sizes that differ, PLANE_F64, a name that is empty or used
 * twice. STATUS_IO: the disk or the library refused. */
Status image_write_exr_as(const char *path, const char *compression, const Plane *plane, int plane_count,
                          const char *date_time, const ImageAttribute *attribute, int attribute_count);

/* The same without compression. */
Status image_write_exr(const char *path, const Plane *plane, int plane_count, const char *date_time,
                       const ImageAttribute *attribute, int attribute_count);

/* PNG, channels 1 (grey) or 3 (RGB interleaved), bits 8 (uint8_t) or 16 (uint16_t, machine order), rows
 * top down. Values are written as they are: display encoding is the caller's. */
Status image_write_png(const char *path, const void *values, int width, int height, int channels, int bits);

/* ---- reading, for tests and for tools ------------------------------------------------------- */

enum { image_name_size = 64 };

typedef struct ImageInfo {
    int       width, height, channels;
    char      name[image_max_planes][image_name_size];
    PlaneType type[image_max_planes]; /* PLANE_F32 for any other format */
    int       bits;                   /* of the first channel */
} ImageInfo;

Status image_info(ImageInfo *out, const char *path);
/* One channel by name, [height][width] as image_info gives them. The type must be the one in the file: no
 * conversion, hence no loss. STATUS_BAD_VALUE: no such channel, or of another type. */
Status image_read_f32(float *out, const char *path, const char *channel);
Status image_read_u32(uint32_t *out, const char *path, const char *channel);
/* Reads all channels interleaved, with 8 or 16 bits as in the file. */
Status image_read_png(void *out, const char *path);
/* These return false when the attribute is absent or of another kind. */
bool image_read_string(char *out, size_t out_size, const char *path, const char *attribute);
bool image_read_number(double *out, const char *path, const char *attribute);

/* Printable ASCII, ' ' to '~', in a font of equal widths: cover[image_letter_count][high][wide], the share of 255 that
 * each pixel is covered; base: the row below the lowest of a letter without a tail; size_px: of the font, 0.6 of which
 * is the width of a letter. STATUS_IO: no such font. */
enum { image_letter_count = '~' - ' ' + 1 };
Status image_letters(uint8_t *cover, int wide, int high, int base, int size_px);

#endif
