/* sensor/publish/images/image_module.cpp: image files, through OpenImageIO: a module, which image_file.c loads. */
#include "sensor/publish/images/image_file_private.h"
#include "pitviper_output.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/* Measured, 720 x 486, a frame of the demonstration, one core, ms of CPU and kB:
 *
 *                           optical       lwir      truth      radar
 *     filter none           32  453    12  175    3   14    2   21
 *     sub                   30  388    11  155    4   15    4   21
 *     up                    26  485    12  193    6   20    2   30
 *     sub, rle              28  316     9  129    5   11    3   15 (as here)
 *     sub, huffman          20  303     7  127   19  135    7   50 */
static const int  png_level = 1;
static const int  png_filter = 0x10; /* libpng's PNG_FILTER_SUB */
static const char png_strategy[] = "rle";

/* The library uses one thread: the caller's pool has one frame per worker, and the bytes must not depend on threads. */
static void library_set_up()
{
    static std::once_flag once;
    std::call_once(once, [] {
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", 1);
    });
}

/* Never throws: logging must be possible when memory is out. */
static Status refuse(Status status, const char *what, const char *path, const char *reason)
{
    log_error("image: cannot %s %s: %s", what, path, reason);
    return status;
}

/* A file of output_begin. The library writes into it chunk by chunk; errno at the first failure is kept, as the library
 * reports only that it failed. */
class PartFile final : public OIIO::Filesystem::IOFile
{
  public:
    PartFile(const char *path, FILE *file) : IOFile(file, Write), path_(path), file_(file) {}
    PartFile(const PartFile &) = delete;
    PartFile &operator=(const PartFile &) = delete;
    ~PartFile() override
    {
        if (file_) output_abandon(file_, path_);
    }

    size_t write(const void *bytes, size_t count) override
    {
        errno = 0;
        const size_t written = IOFile::write(bytes, count);
        if (written != count) keep_reason();
        return written;
    }

    bool seek(int64_t offset) override
    {
        errno = 0;
        const bool ok = IOFile::seek(offset);
        if (!ok) keep_reason();
        return ok;
    }

    /* A full disk may be detected only here. */
    bool finish()
    {
        errno = 0;
        FILE *file = file_;
        file_ = nullptr;
        if (output_end(file, path_)) return true;
        keep_reason();
        return false;
    }

    int reason() const { return reason_; }

  private:
    void keep_reason()
    {
        if (reason_ == 0) reason_ = errno;
    }

    const char *path_;
    FILE       *file_;
    int         reason_ = 0;
};

/* FORMAT is the library's name for the format. write_rows is a `bool (ImageOutput *)`. */
template <typename WriteRows>
static Status write_file(const char *path, const char *format, const ImageSpec &spec, WriteRows write_rows)
{
    FILE *open = output_begin(path, 0);
    if (!open) return refuse(errno == ENOMEM ? STATUS_NO_MEMORY : STATUS_IO, "write", path, output_reason(errno));

    PartFile          file(path, open);
    const std::string name = std::string("out.") + format;
    auto              out = ImageOutput::create(format);
    if (!out) return refuse(STATUS_UNSUPPORTED, "write", path, "OpenImageIO without this format");
    bool              ok = out->set_ioproxy(&file) && out->open(name, spec) && write_rows(out.get()) && out->close();
    const std::string said = ok ? "short write" : out->geterror();
    out.reset(); /* it may write until then */
    if (ok && file.finish()) return STATUS_OK;
    return refuse(STATUS_IO, "write", path, file.reason() ? strerror(file.reason()) : said.c_str());
}

static const char *planes_size_error(const Plane *plane, int plane_count)
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
    return nullptr;
}

static void set_attribute(ImageSpec *spec, const ImageAttribute &a)
{
    switch (a.type) {
    case IMAGE_STRING:
        spec->attribute(a.name, a.text);
        break;
    case IMAGE_INT:
        spec->attribute(a.name, a.integer);
        break;
    case IMAGE_FLOAT:
        spec->attribute(a.name, (float)a.number);
        break;
    case IMAGE_DOUBLE:
        spec->attribute(a.name, TypeDesc(TypeDesc::DOUBLE), &a.number);
        break;
    }
}

/* Native calls only: the library converts uint32 to float and back otherwise, which loses bits. They need the
 * channels of a pixel interleaved, so a band of lines at a time is interleaved; a single plane is written as it is. */
static bool write_planes(ImageOutput *out, const Plane *plane, int plane_count)
{
    const int    width = plane[0].width, height = plane[0].height, band = 16; /* a block of zip */
    const size_t step = (size_t)plane_count;
    if (plane_count == 1 && plane->type != PLANE_U8)
        return out->write_scanlines(0, height, 0, TypeDesc::UNKNOWN, plane[0].values);
    std::vector<uint32_t> pixels(step * (size_t)width * band);

    for (int y0 = 0; y0 < height; y0 += band) {
        const int    y1 = std::min(y0 + band, height);
        const size_t first = (size_t)y0 * (size_t)width, count = (size_t)(y1 - y0) * (size_t)width;
        for (size_t c = 0; c < step; c++) {
            if (plane[c].type == PLANE_U8) {
                const uint8_t *narrow = (const uint8_t *)plane[c].values + first;
                for (size_t i = 0; i < count; i++) pixels[i * step + c] = narrow[i];
                continue;
            }
            const unsigned char *from = (const unsigned char *)plane[c].values + 4 * first;
            for (size_t i = 0; i < count; i++) memcpy(&pixels[i * step + c], from + 4 * i, 4);
        }
        if (!out->write_scanlines(y0, y1, 0, TypeDesc::UNKNOWN, pixels.data())) return false;
    }
    return true;
}

Status image_module_write_exr(const char *path, const char *compression, const Plane *plane, int plane_count,
                              const char *date_time, const ImageAttribute *attribute, int attribute_count)
try {
    const char *misfit = planes_size_error(plane, plane_count);
    if (misfit) return refuse(STATUS_BAD_VALUE, "write", path, misfit);
    library_set_up();

    ImageSpec spec(plane[0].width, plane[0].height, plane_count, TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (int i = 0; i < plane_count; i++) {
        spec.channelnames.push_back(plane[i].name);
        spec.channelformats.push_back(plane[i].type == PLANE_F32 ? TypeDesc::FLOAT : TypeDesc::UINT32);
    }
    spec.attribute("compression", compression);
    spec.attribute("DateTime", date_time ? date_time : "1970:01:01 00:00:00");
    for (int i = 0; i < attribute_count; i++) set_attribute(&spec, attribute[i]);

    return write_file(path, "exr", spec, [&](ImageOutput *out) { return write_planes(out, plane, plane_count); });
} catch (const std::exception &e) {
    return refuse(STATUS_NO_MEMORY, "write", path, e.what());
}

Status image_module_write_png(const char *path, const void *values, int width, int height, int channels, int bits)
try {
    if (width < 1 || height < 1 || width > image_max_size_px || height > image_max_size_px ||
        (channels != 1 && channels != 3) || (bits != 8 && bits != 16))
        return refuse(STATUS_BAD_VALUE, "write", path, "a size, channel count or depth outside the range");
    library_set_up();

    const TypeDesc format = bits == 8 ? TypeDesc::UINT8 : TypeDesc::UINT16;
    ImageSpec      spec(width, height, channels, format);
    spec.attribute("png:compressionLevel", png_level);
    spec.attribute("png:filter", png_filter);
    spec.attribute("compression", png_strategy);
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    return write_file(path, "png", spec, [&](ImageOutput *out) { return out->write_image(format, values); });
} catch (const std::exception &e) {
    return refuse(STATUS_NO_MEMORY, "write", path, e.what());
}

/* ---- reading ------------------------------------------------------------------------------ */

static std::unique_ptr<ImageInput> open_input(const char *path)
{
    library_set_up();
    auto in = ImageInput::open(path);
    if (!in) refuse(STATUS_IO, "read", path, OIIO::geterror().c_str());
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
    return refuse(STATUS_NO_MEMORY, "read", path, e.what());
}

/* Channels come back in alphabetical order, not in the writer's, so they are found by name only. */
static Status read_channel(void *out, const char *path, const char *channel, TypeDesc type)
try {
    auto in = open_input(path);
    if (!in) return STATUS_IO;
    const ImageSpec &spec = in->spec();
    const int        c = spec.channelindex(channel);
    if (c < 0) return refuse(STATUS_BAD_VALUE, "read", path, "no such channel");
    if (spec.channelformat(c) != type) return refuse(STATUS_BAD_VALUE, "read", path, "the channel has another type");
    std::vector<uint32_t> values((size_t)spec.width * (size_t)spec.height);
    if (!in->read_image(0, 0, c, c + 1, TypeDesc::UNKNOWN, values.data()))
        return refuse(STATUS_IO, "read", path, in->geterror().c_str());
    memcpy(out, values.data(), values.size() * sizeof values[0]);
    return STATUS_OK;
} catch (const std::exception &e) {
    return refuse(STATUS_NO_MEMORY, "read", path, e.what());
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
        return refuse(STATUS_IO, "read", path, in->geterror().c_str());
    return STATUS_OK;
} catch (const std::exception &e) {
    return refuse(STATUS_NO_MEMORY, "read", path, e.what());
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
