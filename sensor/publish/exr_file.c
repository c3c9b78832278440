/* sensor/publish/exr_file.c: planes into an OpenEXR file of scan lines.
 *
 * Layout: "Technical Introduction to OpenEXR" and "OpenEXR File Layout" (openexr.com): a header of named attributes, a
 * table of offsets, then chunks of 16 lines, in each line the channels one after the other in the alphabet's order.
 * Compression ZIP: the bytes of a chunk, the even ones before the odd ones, as differences, deflated. A chunk that does
 * not shrink is stored as it is, which every reader knows by its size.
 *
 * Radiance of a noisy ground does not shrink by more than a quarter and takes most of the time, so a chunk is only
 * tried
 * where the last one tried was worth it, and one of every eight.
 * Measured, 720 x 486, a frame of the demonstration, one core, ms and kB: truth, 8 planes; a thermal plane; colour, 3:
 *
 *     zlib 1 (before)              281  5502    45  1021   148  3366
 *     deflate 1, every chunk       124  5423    19  1019    69  3364
 *     as here                      124  5426     8  1276    20  3963 */
#include "sensor/publish/image_file.h"
#include "sensor/publish/part_file.h"

#include <libdeflate.h>
#include <stdlib.h>

enum { chunk_lines = 16, deflate_level = 1, try_every = 8 };
static const double worth = 0.7; /* of its size, or less */

/* ---- header ----------------------------------------------------------------------------------- */

/* Bytes that grow; `failed` for want of memory. x86-64 writes numbers as the file has them: little-endian. */
typedef struct Bytes {
    uint8_t *at;
    size_t   count, capacity;
    bool     failed;
} Bytes;

static void put(Bytes *b, const void *from, size_t count)
{
    if (b->count + count > b->capacity && !b->failed) {
        const size_t larger = 2 * (b->count + count) + 1024;
        uint8_t     *at     = realloc(b->at, larger);
        if (at) b->at = at;
        else b->failed = true;
        b->capacity = at ? larger : b->capacity;
    }
    if (b->failed) return;
    memcpy(b->at + b->count, from, count);
    b->count += count;
}

static void put_i32(Bytes *b, int32_t value) { put(b, &value, sizeof value); }
static void put_text(Bytes *b, const char *text) { put(b, text, strlen(text) + 1); }

static void put_attribute(Bytes *b, const char *name, const char *type, const void *value, size_t size)
{
    put_text(b, name);
    put_text(b, type);
    put_i32(b, (int32_t)size);
    put(b, value, size);
}

static void put_named(Bytes *b, const ImageAttribute *a)
{
    const float number = (float)a->number;
    switch (a->type) {
    case IMAGE_STRING: put_attribute(b, a->name, "string", a->text, strlen(a->text)); break;
    case IMAGE_INT: put_attribute(b, a->name, "int", &a->integer, 4); break;
    case IMAGE_FLOAT: put_attribute(b, a->name, "float", &number, 4); break;
    case IMAGE_DOUBLE: put_attribute(b, a->name, "double", &a->number, 8); break;
    }
}

static void put_channels(Bytes *b, const Plane *const *plane, int plane_count)
{
    Bytes list = {0};
    for (int i = 0; i < plane_count; i++) {
        put_text(&list, plane[i]->name);
        put_i32(&list, plane[i]->type == PLANE_U32 ? 0 : 2);
        put_i32(&list, 0); /* not perceptually linear; reserved */
        put_i32(&list, 1); /* a value a pixel */
        put_i32(&list, 1);
    }
    put(&list, "", 1);
    if (list.failed) b->failed = true;
    else put_attribute(b, "channels", "chlist", list.at, list.count);
    free(list.at);
}

static void put_header(Bytes *b, const Plane *const *plane, int plane_count, const char *date_time,
                       const ImageAttribute *attribute, int attribute_count)
{
    static const uint8_t magic[4] = {0x76, 0x2f, 0x31, 0x01}, zip = 3, increasing = 0;
    static const float   one = 1, centre[2] = {0, 0};
    const int32_t        window[4] = {0, 0, plane[0]->width - 1, plane[0]->height - 1};
    int32_t              version   = 2;
    for (int i = 0; i < plane_count; i++)
        if (strlen(plane[i]->name) > 31) version = 2 | 0x400;
    for (int i = 0; i < attribute_count; i++)
        if (strlen(attribute[i].name) > 31) version = 2 | 0x400;
    put(b, magic, sizeof magic);
    put_i32(b, version);
    put_channels(b, plane, plane_count);
    put_attribute(b, "compression", "compression", &zip, 1);
    put_attribute(b, "dataWindow", "box2i", window, sizeof window);
    put_attribute(b, "displayWindow", "box2i", window, sizeof window);
    put_attribute(b, "lineOrder", "lineOrder", &increasing, 1);
    put_attribute(b, "pixelAspectRatio", "float", &one, 4);
    put_attribute(b, "screenWindowCenter", "v2f", centre, sizeof centre);
    put_attribute(b, "screenWindowWidth", "float", &one, 4);
    put_attribute(b, "capDate", "string", date_time, strlen(date_time));
    for (int i = 0; i < attribute_count; i++) put_named(b, &attribute[i]);
    put(b, "", 1);
}

/* ---- chunks ----------------------------------------------------------------------------------- */

/* Even bytes before odd ones, then each as the difference to the one before. */
static void predict(uint8_t *restrict out, uint8_t *restrict halves, const uint8_t *restrict in, size_t count)
{
    const size_t half = count / 2; /* values have four bytes: even */
    for (size_t i = 0; i < half; i++) {
        halves[i]        = in[2 * i];
        halves[half + i] = in[2 * i + 1];
    }
    out[0] = halves[0];
    for (size_t i = 1; i < count; i++) out[i] = (uint8_t)(halves[i] - halves[i - 1] + 128);
}

typedef struct Chunks {
    struct libdeflate_compressor *compressor;
    size_t   size;             /* of a whole one */
    uint8_t *lines, *halves, *predicted, *packed; /* [size] each */
    uint64_t *offset;          /* [count], in the file */
    int      count;
} Chunks;

static bool chunks_open(Chunks *c, const Plane *plane, int plane_count)
{
    *c       = (Chunks){.size = (size_t)chunk_lines * 4 * (size_t)plane->width * (size_t)plane_count,
                        .count = (plane->height + chunk_lines - 1) / chunk_lines};
    c->lines = malloc(4 * c->size);
    if (c->lines) {
        c->halves    = c->lines + c->size;
        c->predicted = c->halves + c->size;
        c->packed    = c->predicted + c->size;
    }
    c->offset     = calloc((size_t)c->count, sizeof *c->offset);
    c->compressor = libdeflate_alloc_compressor(deflate_level);
    return c->lines && c->offset && c->compressor;
}

static void chunks_close(Chunks *c)
{
    free(c->lines);
    free(c->offset);
    libdeflate_free_compressor(c->compressor);
}

static void write_chunks(PartFile *file, Chunks *c, const Plane *const *plane, int plane_count, uint64_t at)
{
    const int    width = plane[0]->width, height = plane[0]->height;
    const size_t row = 4 * (size_t)width;
    bool         worthwhile = true;
    for (int k = 0; k < c->count && file->status == STATUS_OK; k++) {
        const int first = k * chunk_lines, last = first + chunk_lines < height ? first + chunk_lines : height;
        size_t    size = 0, packed = 0;
        for (int y = first; y < last; y++)
            for (int i = 0; i < plane_count; i++, size += row)
                memcpy(c->lines + size, (const uint8_t *)plane[i]->values + (size_t)y * row, row);
        if (worthwhile || k % try_every == 0) {
            predict(c->predicted, c->halves, c->lines, size);
            packed = libdeflate_zlib_compress(c->compressor, c->predicted, size, c->packed, size - 1);
            worthwhile = packed > 0 && (double)packed <= worth * (double)size;
        }
        const uint8_t *bytes   = packed > 0 ? c->packed : c->lines;
        const int32_t  head[2] = {first, (int32_t)(packed > 0 ? packed : size)};
        c->offset[k] = at;
        part_file_write(file, head, sizeof head);
        part_file_write(file, bytes, (size_t)head[1]);
        at += sizeof head + (size_t)head[1];
    }
}

/* ---- the file --------------------------------------------------------------------------------- */

static const char *planes_misfit(const Plane *plane, int plane_count)
{
    if (plane_count < 1 || plane_count > image_max_planes) return "no planes, or too many";
    for (int i = 0; i < plane_count; i++) {
        if (!plane[i].name || !plane[i].name[0]) return "a plane without a name";
        if (plane[i].type != PLANE_F32 && plane[i].type != PLANE_U32)
            return "a plane that is neither float32 nor uint32";
        if (plane[i].width != plane[0].width || plane[i].height != plane[0].height) return "planes of different size";
        for (int j = 0; j < i; j++)
            if (strcmp(plane[i].name, plane[j].name) == 0) return "two planes of one name";
    }
    if (plane[0].width < 1 || plane[0].height < 1 || plane[0].width > image_max_size_px ||
        plane[0].height > image_max_size_px)
        return "a size outside 1 .. 32768";
    if ((int64_t)plane[0].width * plane_count > INT32_MAX / (4 * chunk_lines)) return "planes too wide together";
    return NULL;
}

Status image_write_exr(const char *path, const Plane *plane, int plane_count, const char *date_time,
                       const ImageAttribute *attribute, int attribute_count)
{
    const Plane *sorted[image_max_planes];
    const char  *misfit = planes_misfit(plane, plane_count);
    if (misfit) {
        log_error("image: cannot write %s: %s", path, misfit);
        return STATUS_BAD_VALUE;
    }
    for (int i = 0; i < plane_count; i++) {
        int at = i;
        for (; at > 0 && strcmp(sorted[at - 1]->name, plane[i].name) > 0; at--) sorted[at] = sorted[at - 1];
        sorted[at] = &plane[i];
    }

    PartFile file;
    Chunks   chunks = {0};
    Bytes    header = {0};
    if (part_file_open(&file, path) == STATUS_OK) {
        put_header(&header, sorted, plane_count, date_time ? date_time : "1970:01:01 00:00:00", attribute,
                   attribute_count);
        if (header.failed || !chunks_open(&chunks, plane, plane_count)) part_file_fail(&file, STATUS_NO_MEMORY);
    }
    if (file.status == STATUS_OK) {
        const size_t table = (size_t)chunks.count * sizeof *chunks.offset;
        part_file_write(&file, header.at, header.count);
        part_file_write(&file, chunks.offset, table); /* its place */
        write_chunks(&file, &chunks, sorted, plane_count, header.count + table);
        part_file_rewrite(&file, (long)header.count, chunks.offset, table);
    }
    if (file.status == STATUS_NO_MEMORY) log_error("image: cannot write %s: out of memory", path);
    chunks_close(&chunks);
    free(header.at);
    return part_file_close(&file);
}
