/* sensor/publish/images/image_file.c: image files: checks, opens and closes what the writers write, and loads the
 * modules that use OpenEXR and OpenImageIO when the first file asks for them. */
#include "sensor/publish/images/image_file_private.h"

#include "pitviper_file.h"
#include "pitviper_library.h"
#include "pitviper_output.h"

#include <pthread.h>

/* OpenImageIO needs 250 libraries, OpenEXR five: a run that only writes pictures loads no more than these five. */
/* clang-format off */
#define EXR_MODULE(X) X(exr_module_write)
#define IMAGE_MODULE(X)                                                                                              \
    X(image_module_info) X(image_module_read_f32) X(image_module_read_u32) X(image_module_read_png)                  \
    X(image_module_read_string) X(image_module_read_number) X(image_module_letters)
/* clang-format on */
enum { module_path_size = 4200 };
static char exr_path[module_path_size], image_path[module_path_size];
LIBRARY(exr_library, EXR_MODULE, "OpenEXR", exr_path, "libopenexr-3-1-30");
LIBRARY(image_library, IMAGE_MODULE, "OpenImageIO", image_path, "libopenimageio2.4");

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static Status load(Library *library, char path[module_path_size], const char *name)
{
    pthread_mutex_lock(&lock);
    const bool there = *path || library_module(path, module_path_size, name);
    if (!there) *path = 0;
    pthread_mutex_unlock(&lock);
    return there ? library_load(library) : STATUS_IO;
}

Status image_file_prepare(void) { return load(&exr_library, exr_path, "pitviper-exr.so"); }

Status image_read_prepare(void) { return load(&image_library, image_path, "pitviper-images.so"); }

/* ---- writing -------------------------------------------------------------------------------- */

static Status refuse(Status status, const char *what, const char *path, const char *reason)
{
    log_error("image: cannot %s %s: %s", what, path, reason);
    return status;
}

static Status begin(ImagePart *part, const char *path)
{
    *part = (ImagePart){.file = output_begin(path, 0)};
    if (part->file) return STATUS_OK;
    return refuse(errno == ENOMEM ? STATUS_NO_MEMORY : STATUS_IO, "write", path, output_reason(errno));
}

/* written: the writer's status. A full disk may be detected only here. */
static Status end(ImagePart *part, const char *path, Status written)
{
    errno = 0;
    if (written != STATUS_OK) output_abandon(part->file, path);
    else if (output_end(part->file, path)) return STATUS_OK;
    else {
        written = STATUS_IO;
        part->reason = errno;
    }
    return refuse(written, "write", path, part->reason ? output_reason(part->reason) : part->said);
}

static const char *planes_fault(const Plane *plane, int plane_count)
{
    if (plane_count < 1 || plane_count > image_max_planes) return "no planes, or too many";
    for (int i = 0; i < plane_count; i++) {
        if (!plane[i].name || !plane[i].name[0]) return "a plane without a name";
        if (plane[i].type != PLANE_F32 && plane[i].type != PLANE_U32 && plane[i].type != PLANE_U8)
            return "a plane that is neither float32, uint32 nor uint8";
        if (plane[i].width != plane[0].width || plane[i].height != plane[0].height) return "planes of different size";
        for (int j = 0; j < i; j++)
            if (strcmp(plane[i].name, plane[j].name) == 0) return "two planes of one name";
    }
    if (plane[0].width < 1 || plane[0].height < 1 || plane[0].width > image_max_size_px ||
        plane[0].height > image_max_size_px)
        return "a size outside 1 .. 32768";
    return NULL;
}

Status image_write_exr_as(const char *path, const char *compression, const Plane *plane, int plane_count,
                          const char *date_time, const ImageAttribute *attribute, int attribute_count)
{
    ImagePart   part;
    const char *fault = planes_fault(plane, plane_count);
    if (fault) return refuse(STATUS_BAD_VALUE, "write", path, fault);
    Status status = image_file_prepare();
    if (status == STATUS_OK) status = begin(&part, path);
    if (status != STATUS_OK) return status;
    status = exr_module_write(&part, compression, plane, plane_count, date_time ? date_time : "1970:01:01 00:00:00",
                              attribute, attribute_count);
    return end(&part, path, status);
}

Status image_write_exr(const char *path, const Plane *plane, int plane_count, const char *date_time,
                       const ImageAttribute *attribute, int attribute_count)
{
    return image_write_exr_as(path, "none", plane, plane_count, date_time, attribute, attribute_count);
}

Status image_write_png(const char *path, const void *values, int width, int height, int channels, int bits)
{
    ImagePart part;
    if (width < 1 || height < 1 || width > image_max_size_px || height > image_max_size_px ||
        (channels != 1 && channels != 3) || (bits != 8 && bits != 16))
        return refuse(STATUS_BAD_VALUE, "write", path, "a size, channel count or depth outside the range");
    const Status status = begin(&part, path);
    return status != STATUS_OK ? status
                               : end(&part, path, png_file_write(&part, values, width, height, channels, bits));
}

/* ---- reading -------------------------------------------------------------------------------- */

/* OpenImageIO opens by name, whatever it is. */
static Status prepare_to_read(const char *path)
{
    char why[file_why_size];
    if (file_is_regular(why, path)) return image_read_prepare();
    return refuse(STATUS_IO, "read", path, why);
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
    const Status status = image_read_prepare();
    return status != STATUS_OK ? status : image_module_letters(cover, wide, high, base, size_px);
}
