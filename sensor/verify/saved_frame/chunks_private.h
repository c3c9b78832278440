/* sensor/verify/saved_frame/chunks_private.h: a file of named chunks: the container of frame files (etc/FRAME_FILE.md).
 *
 *     "PVFRAME\n"   8 octets
 *     version       u32
 *     chunks        name 8 octets (padded with 0), method u32 (0: stored, 1: zlib), CRC-32 of the plain octets u32,
 *                   octets plain u64, octets stored u64, the octets stored
 *
 * The last chunk is "end", empty. All numbers are little-endian; double and float are IEEE 754. */
#ifndef SENSOR_VERIFY_SAVED_FRAME_CHUNKS_PRIVATE_H
#define SENSOR_VERIFY_SAVED_FRAME_CHUNKS_PRIVATE_H

#include "pitviper.h"

enum { chunk_name_size = 8, chunks_version = 10 };
static const uint64_t chunk_most_octets = (uint64_t)1 << 30;

/* ---- writing: a growing buffer ------------------------------------------------------------------ */

typedef struct ByteSink {
    uint8_t *bytes;
    size_t   count, capacity;
    bool     failed; /* no memory; later writes are lost */
} ByteSink;

void sink_bytes(ByteSink *sink, const void *bytes, size_t count);
void sink_text(ByteSink *sink, const char *text); /* u32 length, octets */
void sink_free(ByteSink *sink);

void chunks_begin(ByteSink *file);
/* Compressed where that is shorter. */
void chunks_put(ByteSink *file, const char *name, const ByteSink *content);
void chunks_end(ByteSink *file);

/* ---- reading: a cursor that cannot overrun ------------------------------------------------------- */

/* Once truncated all later reads return 0. */
typedef struct ByteSource {
    const uint8_t *at, *end;
    bool           truncated;
} ByteSource;

/* NULL: fewer octets are left. */
const uint8_t *source_bytes(ByteSource *source, size_t count);

typedef struct ChunkSource {
    ByteSource  rest;
    Arena      *arena;   /* of what is decompressed */
    uint64_t    octets;  /* decompressed so far */
    int         version; /* 1 .. chunks_version */
    const char *fault;   /* text of the failure; static storage */
} ChunkSource;

/* STATUS_UNSUPPORTED: the version is later; STATUS_BAD_VALUE: it is no frame file. */
Status chunks_open(ChunkSource *out, const uint8_t *bytes, size_t count, Arena *arena);
/* Reads the next chunk; STATUS_OK with an empty name is the end. */
Status chunks_next(ChunkSource *chunks, char name[chunk_name_size + 1], ByteSource *content);

/* ---- fields of a chunk --------------------------------------------------------------------------- */

/* One list of fields serves writing and reading: with a sink each field is written to it, with a
 * source it is read from it and must be in its range. The first error is kept, and ends the reading. */

typedef struct Fields {
    ByteSink   *to; /* one of the two */
    ByteSource *from;
    Arena      *arena;   /* reading: of arrays and texts */
    int         version; /* of the format (sensor/verify/saved_frame/chunks_private.h) */
    const char *fault;   /* the name of the field; static storage */
    bool        no_memory;
} Fields;

static inline bool fields_good(const Fields *f)
{
    return !f->fault && !f->no_memory && !(f->from && f->from->truncated);
}

void field_int(Fields *f, const char *name, int *value, int low, int high);
void field_u32(Fields *f, uint32_t *value);
void field_u64(Fields *f, uint64_t *value);
void field_bool(Fields *f, const char *name, bool *value);
void field_real(Fields *f, const char *name, double *value, double low, double high); /* NaN is always out of range */
void field_reals(Fields *f, const char *name, double *value, int count, double most); /* |value| <= most */
void field_floats(Fields *f, const char *name, float *value, int count, float low, float high);
void field_unit(Fields *f, const char *name, double v[3]);     /* length 1 within 1e-6 */
void field_rotation(Fields *f, const char *name, double r[9]); /* orthonormal within 1e-6, right-handed */
void field_bytes(Fields *f, void *bytes, size_t count);
void field_text(Fields *f, const char **text, size_t most); /* at most that many octets, none of them 0 */
/* In place, terminated. */
void field_chars(Fields *f, const char *name, char *text, size_t size);
/* The fields of one record: the same octets whatever it holds. */
typedef void FieldsOf(Fields *f, void *record);
/* A count and as many records, of `record` octets in memory; reading, they are allocated, if the octets left can hold
 * them. False: nothing more is to be read. */
bool field_list(Fields *f, int *count, void **array, size_t record, int most, FieldsOf *fields);

#endif
