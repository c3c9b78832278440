/* sensor/publish/images/exr_module.cpp: writes EXR files, through OpenEXR: a module, which image_file.c loads. */
#include "sensor/publish/images/image_file_private.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

class PartStream final : public Imf::OStream
{
  public:
    explicit PartStream(ImagePart *part) : OStream("the file"), part_(part) {}

    void write(const char octets[], int count) override
    {
        if (!image_part_write(part_, octets, (size_t)count)) throw std::runtime_error("short write");
        at_ += (uint64_t)count;
    }

    uint64_t tellp() override { return at_; }

    void seekp(uint64_t at) override
    {
        errno = 0;
        if (fseeko(part_->file, (off_t)at, SEEK_SET) != 0) {
            if (part_->reason == 0) part_->reason = errno;
            throw std::runtime_error("seek");
        }
        at_ = at;
    }

  private:
    ImagePart *part_;
    uint64_t   at_ = 0;
};

/* `zip:4` is zip at zlib's level 4. */
static void set_compression(Imf::Header *header, const std::string &name)
{
    static const struct {
        const char      *name;
        Imf::Compression value;
    } known[] = {{"none", Imf::NO_COMPRESSION},
                 {"rle", Imf::RLE_COMPRESSION},
                 {"zips", Imf::ZIPS_COMPRESSION},
                 {"zip", Imf::ZIP_COMPRESSION},
                 {"piz", Imf::PIZ_COMPRESSION}};
    const size_t colon = name.find(':');
    for (const auto &k : known)
        if (name.compare(0, colon, k.name) == 0) {
            header->compression() = k.value;
            if (colon != std::string::npos) header->zipCompressionLevel() = atoi(name.c_str() + colon + 1);
            return;
        }
    throw std::invalid_argument("no such compression: " + name);
}

static void set_attribute(Imf::Header *header, const ImageAttribute &a)
{
    switch (a.type) {
    case IMAGE_STRING:
        header->insert(a.name, Imf::StringAttribute(a.text));
        break;
    case IMAGE_INT:
        header->insert(a.name, Imf::IntAttribute(a.integer));
        break;
    case IMAGE_FLOAT:
        header->insert(a.name, Imf::FloatAttribute((float)a.number));
        break;
    case IMAGE_DOUBLE:
        header->insert(a.name, Imf::DoubleAttribute(a.number));
        break;
    }
}

static Status refused(ImagePart *part, Status status, const char *said)
{
    snprintf(part->said, sizeof part->said, "%s", said);
    return part->reason ? STATUS_IO : status;
}

/* In the caller's thread alone: the pool has one frame per worker, and the octets must not depend on threads. */
Status exr_module_write(ImagePart *part, const char *compression, const Plane *plane, int plane_count,
                        const char *date_time, const ImageAttribute *attribute, int attribute_count)
try {
    const int    width = plane[0].width, height = plane[0].height;
    const size_t pixels = (size_t)width * (size_t)height;
    Imf::Header  header(width, height);
    set_compression(&header, compression);
    header.insert("capDate", Imf::StringAttribute(date_time));
    for (int i = 0; i < attribute_count; i++) set_attribute(&header, attribute[i]);

    Imf::FrameBuffer                   rows;
    std::vector<std::vector<uint32_t>> widened; /* planes of octets */
    for (int i = 0; i < plane_count; i++) {
        const void *values = plane[i].values;
        if (plane[i].type == PLANE_U8) {
            const uint8_t *octets = (const uint8_t *)values;
            values = widened.emplace_back(octets, octets + pixels).data();
        }
        const Imf::PixelType type = plane[i].type == PLANE_F32 ? Imf::FLOAT : Imf::UINT;
        header.channels().insert(plane[i].name, Imf::Channel(type));
        rows.insert(plane[i].name, Imf::Slice(type, (char *)values, 4, 4 * (size_t)width));
    }

    PartStream stream(part);
    {
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(rows);
        file.writePixels(height);
    } /* here it writes where its lines are, and keeps to itself what the stream throws */
    return part->reason ? STATUS_IO : STATUS_OK;
} catch (const std::bad_alloc &) {
    return refused(part, STATUS_NO_MEMORY, "out of memory");
} catch (const std::exception &e) {
    return refused(part, STATUS_IO, e.what());
}
