/* sensor/publish/images/image_module.cpp: reads image files and draws letters, through OpenImageIO: a module, which
 * image_file.c loads. */
#include "sensor/publish/images/image_file_private.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <cstdio>
#include <memory>
#include <mutex>
#include <vector>

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/* The library uses one thread: the caller's pool has one frame per worker. */
static void library_set_up()
{
    static std::once_flag once;
    std::call_once(once, [] {
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", 1);
    });
}

/* Never throws: logging must be possible when memory is out. */
static Status refuse(Status status, const char *path, const char *reason)
{
    log_error("image: cannot read %s: %s", path, reason);
    return status;
}

static std::unique_ptr<ImageInput> open_input(const char *path)
{
    library_set_up();
    auto in = ImageInput::open(path);
    if (!in) refuse(STATUS_IO, path, OIIO::geterror().c_str());
    return in;
}

static PlaneType plane_type(const ImageSpec &spec, int channel)
{
    return spec.channelformat(channel) == TypeDesc::UINT32 ? PLANE_U32 : PLANE_F32;
}

Status image_module_info(ImageInfo *out, const char *path)
try {
    auto in = open_input(path);
    if (!in) return STATUS_IO;
    const ImageSpec &spec = in->spec();
    if (spec.nchannels < 1 || spec.nchannels > image_max_planes) return STATUS_UNSUPPORTED;
    *out = ImageInfo{};
    out->width = spec.width;
    out->height = spec.height;
    out->channels = spec.nchannels;
    out->bits = (int)(8 * spec.channelformat(0).size());
    for (int i = 0; i < spec.nchannels; i++) {
        snprintf(out->name[i], sizeof out->name[i], "%s", spec.channel_name(i).c_str());
        out->type[i] = plane_type(spec, i);
    }
    return STATUS_OK;
} catch (const std::exception &e) {
    return refuse(STATUS_NO_MEMORY, path, e.what());
}

/* Channels come back in alphabetical order, not in the writer's, so they are found by name only. */
static Status read_channel(void *out, const char *path, const char *channel, TypeDesc type)
try {
    auto in = open_input(path);
    if (!in) return STATUS_IO;
    const ImageSpec &spec = in->spec();
    const int        c = spec.channelindex(channel);
    if (c < 0) return refuse(STATUS_BAD_VALUE, path, "no such channel");
    if (spec.channelformat(c) != type) return refuse(STATUS_BAD_VALUE, path, "the channel has another type");
    std::vector<uint32_t> values((size_t)spec.width * (size_t)spec.height);
    if (!in->read_image(0, 0, c, c + 1, TypeDesc::UNKNOWN, values.data()))
        return refuse(STATUS_IO, path, in->geterror().c_str());
    memcpy(out, values.data(), values.size() * sizeof values[0]);
    return STATUS_OK;
} catch (const std::exception &e) {
    return refuse(STATUS_NO_MEMORY, path, e.what());
}

Status image_module_read_f32(float *out, const char *path, const char *channel)
{
    return read_channel(out, path, channel, TypeDesc::FLOAT);
}

Status image_module_read_u32(uint32_t *out, const char *path, const char *channel)
{
    return read_channel(out, path, channel, TypeDesc::UINT32);
}

Status image_module_read_png(void *out, const char *path)
try {
    auto in = open_input(path);
    if (!in) return STATUS_IO;
    if (!in->read_image(0, 0, 0, in->spec().nchannels, in->spec().format, out))
        return refuse(STATUS_IO, path, in->geterror().c_str());
    return STATUS_OK;
} catch (const std::exception &e) {
    return refuse(STATUS_NO_MEMORY, path, e.what());
}

bool image_module_read_string(char *out, size_t out_size, const char *path, const char *attribute)
try {
    auto                    in = open_input(path);
    const OIIO::ParamValue *value = in ? in->spec().find_attribute(attribute, TypeDesc::STRING) : nullptr;
    if (!value) return false;
    snprintf(out, out_size, "%s", value->get_ustring().c_str());
    return true;
} catch (const std::exception &) {
    return false;
}

bool image_module_read_number(double *out, const char *path, const char *attribute)
try {
    auto                    in = open_input(path);
    const OIIO::ParamValue *value = in ? in->spec().find_attribute(attribute) : nullptr;
    if (!value) return false;
    if (value->type() == TypeDesc::INT) *out = value->get_int();
    else if (value->type() == TypeDesc::FLOAT) *out = value->get_float();
    else if (value->type() == TypeDesc::DOUBLE) memcpy(out, value->data(), sizeof *out);
    else return false;
    return true;
} catch (const std::exception &) {
    return false;
}

Status image_module_letters(uint8_t *cover, int wide, int high, int base, int size_px)
try {
    library_set_up();
    const char *const debian = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf";
    const char *const font = OIIO::Filesystem::exists(debian) ? debian : "DejaVuSansMono";
    for (int letter = 0; letter < image_letter_count; letter++, cover += (size_t)wide * (size_t)high) {
        OIIO::ImageBuf cell(ImageSpec(wide, high, 1, TypeDesc::UINT8));
        OIIO::ImageBufAlgo::zero(cell);
        const char text[2] = {(char)(' ' + letter), 0};
        if (!OIIO::ImageBufAlgo::render_text(cell, 0, base, text, size_px, font)) return STATUS_IO;
        if (!cell.get_pixels(cell.roi(), TypeDesc::UINT8, cover)) return STATUS_IO;
    }
    return STATUS_OK;
} catch (const std::exception &) {
    return STATUS_NO_MEMORY;
}
