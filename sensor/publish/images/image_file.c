/* sensor/publish/images/image_file.c: image files: loads the module that uses OpenImageIO when the first file asks
 * for it. */
#include "sensor/publish/images/image_file_private.h"

#include "pitviper_file.h"
#include "pitviper_library.h"

#include <pthread.h>

/* clang-format off */
#define IMAGE_MODULE(X)                                                                                              \
    X(image_module_write_exr) X(image_module_write_png) X(image_module_info) X(image_module_read_f32)                \
    X(image_module_read_u32) X(image_module_read_png) X(image_module_read_string) X(image_module_read_number)        \
    X(image_module_letters)
/* clang-format on */
static char path_of_module[4200];
LIBRARY(image_library, IMAGE_MODULE, "OpenImageIO", path_of_module, "libopenimageio2.4");

static bool module_is_there;

static void find_module(void)
{
    module_is_there = library_module(path_of_module, sizeof path_of_module, "pitviper-images.so");
}

Status image_file_prepare(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, find_module);
    return module_is_there ? library_load(&image_library) : STATUS_IO;
}

Status image_write_exr_as(const char *path, const char *compression, const Plane *plane, int plane_count,
                          const char *date_time, const ImageAttribute *attribute, int attribute_count)
{
    const Status status = image_file_prepare();
    return status != STATUS_OK
               ? status
               : image_module_write_exr(path, compression, plane, plane_count, date_time, attribute, attribute_count);
}

Status image_write_exr(const char *path, const Plane *plane, int plane_count, const char *date_time,
                       const ImageAttribute *attribute, int attribute_count)
{
    return image_write_exr_as(path, "none", plane, plane_count, date_time, attribute, attribute_count);
}

Status image_write_png(const char *path, const void *values, int width, int height, int channels, int bits)
{
    const Status status = image_file_prepare();
    return status != STATUS_OK ? status : image_module_write_png(path, values, width, height, channels, bits);
}

/* OpenImageIO opens by name, whatever it is. */
static Status prepare_to_read(const char *path)
{
    char why[file_why_size];
    if (file_is_regular(why, path)) return image_file_prepare();
    log_error("image: cannot read %s: %s", path, why);
    return STATUS_IO;
}

Status image_info(ImageInfo *out, const char *path)
{
    const Status status = prepare_to_read(path);
    return status != STATUS_OK ? status : image_module_info(out, path);
}

Status image_read_f32(float *out, const char *path, const char *channel)
{
    const Status status = prepare_to_read(path);
    return status != STATUS_OK ? status : image_module_read_f32(out, path, channel);
}

Status image_read_u32(uint32_t *out, const char *path, const char *channel)
{
    const Status status = prepare_to_read(path);
    return status != STATUS_OK ? status : image_module_read_u32(out, path, channel);
}

Status image_read_png(void *out, const char *path)
{
    const Status status = prepare_to_read(path);
    return status != STATUS_OK ? status : image_module_read_png(out, path);
}

bool image_read_string(char *out, size_t out_size, const char *path, const char *attribute)
{
    return prepare_to_read(path) == STATUS_OK && image_module_read_string(out, out_size, path, attribute);
}

bool image_read_number(double *out, const char *path, const char *attribute)
{
    return prepare_to_read(path) == STATUS_OK && image_module_read_number(out, path, attribute);
}

Status image_letters(uint8_t *cover, int wide, int high, int base, int size_px)
{
    const Status status = image_file_prepare();
    return status != STATUS_OK ? status : image_module_letters(cover, wide, high, base, size_px);
}
