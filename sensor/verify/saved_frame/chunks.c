/* sensor/verify/saved_frame/chunks.c: named chunks, each with its size and checksum: written to memory, and read from
 * it. */

#include "sensor/verify/saved_frame/chunks_private.h"

#include <stdlib.h>
#include <zlib.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are copied as they lie in memory");

static const char magic[8] = "PVFRAME\n";

enum { method_plain, method_zlib };

/* ---- writing ------------------------------------------------------------------------------------ */

/* Space for count more octets; NULL: none. */
static uint8_t *make_room(ByteSink *sink, size_t count)
{
    if (sink->failed) return NULL;
    if (count > sink->capacity - sink->count) {
        size_t capacity = sink->capacity ? 2 * sink->capacity : 4096;
        while (capacity - sink->count < count) capacity *= 2;
        uint8_t *bytes = realloc(sink->bytes, capacity);
        sink->failed = !bytes;
        if (!bytes) return NULL;
        sink->bytes = bytes;
        sink->capacity = capacity;
    }
    uint8_t *at = sink->bytes + sink->count;
    sink->count += count;
    return at;
}

void sink_bytes(ByteSink *sink, const void *bytes, size_t count)
{
    uint8_t *to = count ? make_room(sink, count) : NULL;
    if (to) memcpy(to, bytes, count);
}

void sink_text(ByteSink *sink, const char *text) { field_text(&(Fields){.to = sink}, &text, 0); }

void sink_free(ByteSink *sink)
{
    free(sink->bytes);
    *sink = (ByteSink){0};
}

void chunks_begin(ByteSink *file)
{
    uint32_t version = chunks_version;
    sink_bytes(file, magic, sizeof magic);
    field_u32(&(Fields){.to = file}, &version);
}

typedef struct ChunkHeader {
    char     name[chunk_name_size];
    uint32_t method, crc;
    uint64_t plain, stored;
} ChunkHeader;

static void header_fields(Fields *f, ChunkHeader *h)
{
    field_bytes(f, h->name, sizeof h->name);
    field_u32(f, &h->method);
    field_u32(f, &h->crc);
    field_u64(f, &h->plain);
    field_u64(f, &h->stored);
}

void chunks_put(ByteSink *file, const char *name, const ByteSink *content)
{
    ChunkHeader h = {.plain = content->count};
    uLongf      stored = compressBound((uLong)content->count);
    uint8_t    *packed = malloc(stored);
    file->failed |= content->failed || !packed;
    if (file->failed) goto done;
    const bool shorter =
        content->count > 0 && stored > 0 &&
        compress2(packed, &stored, content->bytes, (uLong)content->count, Z_DEFAULT_COMPRESSION) == Z_OK &&
        stored < content->count;
    memcpy(h.name, name, strnlen(name, sizeof h.name));
    h.method = shorter ? method_zlib : method_plain;
    h.crc = content->count ? (uint32_t)crc32_z(0, content->bytes, content->count) : 0;
    h.stored = shorter ? stored : content->count;
    header_fields(&(Fields){.to = file}, &h);
    sink_bytes(file, shorter ? packed : content->bytes, h.stored);
done:
    free(packed);
}

void chunks_end(ByteSink *file) { header_fields(&(Fields){.to = file}, &(ChunkHeader){.name = "end"}); }

/* ---- reading ------------------------------------------------------------------------------------ */

const uint8_t *source_bytes(ByteSource *source, size_t count)
{
    if ((size_t)(source->end - source->at) < count) {
        source->at = source->end;
        source->truncated = true;
        return NULL;
    }
    const uint8_t *bytes = source->at;
    source->at += count;
    return bytes;
}

Status chunks_open(ChunkSource *out, const uint8_t *bytes, size_t count, Arena *arena)
{
    *out = (ChunkSource){.rest = {bytes, bytes + count, false}, .arena = arena};
    const uint8_t *mark = source_bytes(&out->rest, sizeof magic);
    uint32_t       version;
    field_u32(&(Fields){.from = &out->rest}, &version);
    if (!mark || memcmp(mark, magic, sizeof magic) != 0) {
        out->fault = "it does not begin as a frame file does";
        return STATUS_BAD_VALUE;
    }
    out->version = (int)version;
    if (version >= 1 && version <= chunks_version && !out->rest.truncated) return STATUS_OK;
    out->fault = "it has another version of the format";
    return STATUS_UNSUPPORTED;
}

static Status damaged(ChunkSource *chunks, Status status, const char *fault)
{
    chunks->fault = fault;
    return status;
}

Status chunks_next(ChunkSource *chunks, char name[chunk_name_size + 1], ByteSource *content)
{
    ByteSource *rest = &chunks->rest;
    ChunkHeader h;
    header_fields(&(Fields){.from = rest}, &h);
    if (rest->truncated || h.stored > (uint64_t)(rest->end - rest->at))
        return damaged(chunks, STATUS_TRUNCATED, "it ends too early");
    memcpy(name, h.name, chunk_name_size);
    name[chunk_name_size] = 0;
    *content = (ByteSource){0};
    if (strcmp(name, "end") == 0) {
        name[0] = 0;
        return h.plain == 0 && h.stored == 0 ? STATUS_OK : damaged(chunks, STATUS_BAD_VALUE, "its end is damaged");
    }
    const uint8_t *bytes = source_bytes(rest, h.stored);
    /* zlib compresses by a factor of 1000 at most: no more is allocated than the octets can hold */
    if (h.method > method_zlib || (h.method == method_plain && h.plain != h.stored) || h.plain / 1032 > h.stored ||
        h.plain > chunk_most_octets - chunks->octets)
        return damaged(chunks, STATUS_BAD_VALUE, "the size of a chunk is damaged");
    chunks->octets += h.plain;
    if (h.method == method_zlib) {
        uint8_t *unpacked = arena_alloc(chunks->arena, h.plain + 1, 1);
        uLongf   octets = (uLongf)h.plain;
        if (!unpacked) return damaged(chunks, STATUS_NO_MEMORY, "there is no memory for it");
        if (uncompress(unpacked, &octets, bytes, (uLong)h.stored) != Z_OK || octets != h.plain)
            return damaged(chunks, STATUS_BAD_VALUE, "a chunk is damaged");
        bytes = unpacked;
    }
    if (crc32_z(0, bytes, h.plain) != h.crc && h.plain > 0)
        return damaged(chunks, STATUS_BAD_VALUE, "a chunk is damaged");
    *content = (ByteSource){bytes, bytes + h.plain, false};
    return STATUS_OK;
}

/* ---- fields of a chunk, written, or read and checked --------------------------------------------- */

static void expect(Fields *f, const char *name, bool good)
{
    if (!good && fields_good(f)) f->fault = name;
}

void field_bytes(Fields *f, void *bytes, size_t count)
{
    if (f->to) {
        sink_bytes(f->to, bytes, count);
        return;
    }
    const uint8_t *from = source_bytes(f->from, count);
    if (from && count) memcpy(bytes, from, count);
    else if (count) memset(bytes, 0, count);
}

void field_int(Fields *f, const char *name, int *value, int low, int high)
{
    field_bytes(f, value, sizeof *value);
    if (f->to || (*value >= low && *value <= high)) return;
    expect(f, name, false);
    *value = low; /* an index is never out of its array */
}

void field_u32(Fields *f, uint32_t *value) { field_bytes(f, value, sizeof *value); }
void field_u64(Fields *f, uint64_t *value) { field_bytes(f, value, sizeof *value); }

void field_bool(Fields *f, const char *name, bool *value)
{
    int number = *value;
    field_int(f, name, &number, 0, 1);
    *value = number != 0;
}

void field_real(Fields *f, const char *name, double *value, double low, double high)
{
    field_bytes(f, value, sizeof *value);
    if (f->from) expect(f, name, *value >= low && *value <= high);
}

void field_reals(Fields *f, const char *name, double *value, int count, double most)
{
    for (int i = 0; i < count; i++) field_real(f, name, &value[i], -most, most);
}

void field_floats(Fields *f, const char *name, float *value, int count, float low, float high)
{
    field_bytes(f, value, (size_t)count * sizeof *value);
    for (int i = 0; f->from && i < count; i++) expect(f, name, value[i] >= low && value[i] <= high);
}

void field_unit(Fields *f, const char *name, double v[3])
{
    field_reals(f, name, v, 3, 2);
    if (f->from) expect(f, name, fabs(v3_dot(v, v) - 1) <= 1e-6);
}

void field_rotation(Fields *f, const char *name, double r[9])
{
    double across[3];
    field_reals(f, name, r, 9, 2);
    if (!f->from) return;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) expect(f, name, fabs(v3_dot(r + 3 * i, r + 3 * j) - (i == j)) <= 1e-6);
    v3_cross(across, r, r + 3);
    expect(f, name, v3_dot(across, r + 6) > 0);
}

void field_text(Fields *f, const char **text, size_t most)
{
    uint32_t length = f->to ? (uint32_t)strlen(*text) : 0;
    field_u32(f, &length);
    if (f->to) {
        sink_bytes(f->to, *text, length);
        return;
    }
    const uint8_t *bytes = length <= most ? source_bytes(f->from, length) : NULL;
    char          *copy = bytes && !memchr(bytes, 0, length) ? arena_alloc(f->arena, (size_t)length + 1, 1) : NULL;
    f->from->truncated |= !copy;
    *text = copy ? memcpy(copy, bytes, length) : "";
}

void field_chars(Fields *f, const char *name, char *text, size_t size)
{
    field_bytes(f, text, size);
    if (!f->from) return;
    expect(f, name, memchr(text, 0, size) != NULL);
    text[size - 1] = 0;
}

/* The octets of a record in a file of this version: those of one that is all 0. */
static size_t octets_of(int version, size_t record, FieldsOf *fields)
{
    ByteSink sink = {0};
    void    *zeros = calloc(1, record);
    if (zeros) fields(&(Fields){.to = &sink, .version = version}, zeros);
    free(zeros);
    const size_t octets = sink.count;
    sink_free(&sink);
    return octets;
}

bool field_list(Fields *f, int *count, void **array, size_t record, int most, FieldsOf *fields)
{
    if (!fields_good(f)) return false;
    uint32_t number = f->to ? (uint32_t)*count : 0;
    field_u32(f, &number);
    if (f->from) {
        const uint64_t left = (uint64_t)(f->from->end - f->from->at);
        f->from->truncated |=
            number > (uint32_t)most || number * (uint64_t)octets_of(f->version, record, fields) > left;
        *array = fields_good(f) ? arena_alloc(f->arena, (size_t)number + 1, record) : NULL;
        f->no_memory |= fields_good(f) && !*array;
        *count = *array ? (int)number : 0;
    }
    for (int i = 0; i < *count && fields_good(f); i++) fields(f, (char *)*array + (size_t)i * record);
    return fields_good(f);
}
