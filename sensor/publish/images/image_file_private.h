/* sensor/publish/images/image_file_private.h: what image_file.c calls: the writers of one format each, and the module
 * that reads with OpenImageIO. */
#ifndef SENSOR_PUBLISH_IMAGES_IMAGE_FILE_PRIVATE_H
#define SENSOR_PUBLISH_IMAGES_IMAGE_FILE_PRIVATE_H

#include "sensor/publish/images/image_file.h"

#include <errno.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A file that is being written, and why it could not be: a library reports only that its write failed. */
typedef struct ImagePart {
    FILE *file;
    int   reason;    /* errno at the first failure of the file; 0: none */
    char  said[160]; /* by the library, when it refused by itself */
} ImagePart;

static inline bool image_part_write(ImagePart *part, const void *octets, size_t count)
{
    errno = 0;
    if (fwrite(octets, 1, count, part->file) == count) return true;
    if (part->reason == 0) part->reason = errno;
    return false;
}

/* Write all of a file that image_file.c opened; what they are given is in the ranges of image_file.h. STATUS_IO or
 * STATUS_NO_MEMORY, the reason in `part`, nothing logged. */
Status exr_module_write(ImagePart *part, const char *compression, const Plane *plane, int plane_count,
                        const char *date_time, const ImageAttribute *attribute, int attribute_count);
Status png_file_write(ImagePart *part, const void *values, int width, int height, int channels, int bits);

/* Each is as the function of image_file.h of its name. */
Status image_module_info(ImageInfo *out, const char *path);
Status image_module_read_f32(float *out, const char *path, const char *channel);
Status image_module_read_u32(uint32_t *out, const char *path, const char *channel);
Status image_module_read_png(void *out, const char *path);
bool   image_module_read_string(char *out, size_t out_size, const char *path, const char *attribute);
bool   image_module_read_number(double *out, const char *path, const char *attribute);
Status image_module_letters(uint8_t *cover, int wide, int high, int base, int size_px);

#ifdef __cplusplus
}
#endif
#endif
