/* sensor/publish/images/image_file_private.h: what image_file.c calls of the module that uses OpenImageIO; each is as
 * the function of image_file.h of its name. */
#ifndef SENSOR_PUBLISH_IMAGES_IMAGE_FILE_PRIVATE_H
#define SENSOR_PUBLISH_IMAGES_IMAGE_FILE_PRIVATE_H

#include "sensor/publish/images/image_file.h"

#ifdef __cplusplus
extern "C" {
#endif

Status image_module_write_exr(const char *path, const char *compression, const Plane *plane, int plane_count,
                              const char *date_time, const ImageAttribute *attribute, int attribute_count);
Status image_module_write_png(const char *path, const void *values, int width, int height, int channels, int bits);
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
