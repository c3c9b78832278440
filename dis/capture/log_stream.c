/* dis/capture/log_stream.c: a file's octets in order, through the decoder selected by its first octets.
 *
 * Sources: RFC 1952 (gzip), RFC 8878 (zstd), the xz file format 1.1.0, and the manuals of zlib, libzstd, libbz2 and
 * liblzma, with decoders that verify the checksums of the formats. */
#include "dis/capture/log_private.h"

#include "pitviper_file.h"

#include <bzlib.h>
#include <errno.h>
#include <lzma.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

enum { in_octets = 1 << 16, magic_octets = 6, window_log_most = 27 };

static const uint64_t xz_memory_most = (uint64_t)256 << 20;

typedef enum Packing { PACKING_NONE, PACKING_GZIP, PACKING_ZSTD, PACKING_BZIP2, PACKING_XZ, PACKING_COUNT } Packing;

static const char *const packing_name[PACKING_COUNT] = {NULL, "gzip", "zstd", "bzip2", "xz"};

struct DisStream {
    int           file; /* the file's descriptor */
    char         *path;
    Packing       packing;
    bool          pipe;
    DisStreamTap *tap; /* NULL: none */
    void         *tap_user;
    bool          file_over; /* the file has no more octets */
    bool          over;      /* the decoder has no more octets either */
    Status        status;
    const char   *problem;
    uint64_t      read, made; /* read: octets read from the file; made: octets handed out */
    size_t        at, count;  /* of the octets in `in`: where the next is, and where they end */
    uint8_t       in[in_octets];
    z_stream      gzip;
    ZSTD_DStream *zstd;
    bz_stream     bzip2;
    lzma_stream   xz;
};

/* How one call of a decoder ended. */
typedef enum Step { STEP_MORE, STEP_STREAM_ENDS, STEP_DAMAGED, STEP_NO_MEMORY, STEP_TOO_WIDE } Step;

/* ---- the file ---------------------------------------------------------------------------------------- */

static void stop(DisStream *s, Status status, const char *problem)
{
    s->over = true;
    s->status = status;
    s->problem = problem;
}

/* Reads ahead until the buffer has at least `octets`, or all that the file still has. */
static void fill(DisStream *s, size_t octets)
{
    if (s->count - s->at >= octets || s->file_over) return;
    memmove(s->in, s->in + s->at, s->count - s->at);
    s->count -= s->at;
    s->at = 0;
    const long got = file_read(s->file, s->in + s->count, sizeof s->in - s->count);
    s->count += got > 0 ? (size_t)got : 0;
    s->read += got > 0 ? (uint64_t)got : 0;
    if (s->tap && got > 0) s->tap(s->tap_user, s->in + s->count - got, (size_t)got);
    s->file_over = s->count < sizeof s->in;
    if (got < 0) stop(s, STATUS_IO, errno == ECANCELED ? "stopped by a signal" : strerror(errno));
}

static Packing packing_of(const uint8_t *p, size_t octets)
{
    if (octets >= 3 && p[0] == 0x1F && p[1] == 0x8B && p[2] == 8) return PACKING_GZIP;
    if (octets >= 4 && p[0] == 0x28 && p[1] == 0xB5 && p[2] == 0x2F && p[3] == 0xFD) return PACKING_ZSTD;
    if (octets >= 4 && p[0] >> 4 == 5 && p[1] == 0x2A && p[2] == 0x4D && p[3] == 0x18)
        return PACKING_ZSTD; /* skippable */
    if (octets >= 4 && memcmp(p, "BZh", 3) == 0 && p[3] >= '1' && p[3] <= '9') return PACKING_BZIP2;
    if (octets >= 6 && memcmp(p,
                              "\xFD"
                              "7zXZ",
                              6) == 0)
        return PACKING_XZ;
    return PACKING_NONE;
}

/* ---- the decoders: from in[at .. count) to out, as far as both go ------------------------------------- */

static Step step_gzip(DisStream *s, uint8_t *out, size_t room, size_t *made)
{
    s->gzip.next_in = s->in + s->at;
    s->gzip.avail_in = (uInt)(s->count - s->at);
    s->gzip.next_out = out;
    s->gzip.avail_out = (uInt)room;
    const int result = inflate(&s->gzip, Z_NO_FLUSH);
    s->at = s->count - s->gzip.avail_in;
    *made = room - s->gzip.avail_out;
    if (result == Z_STREAM_END) return STEP_STREAM_ENDS;
    if (result == Z_OK || result == Z_BUF_ERROR) return STEP_MORE;
    return result == Z_MEM_ERROR ? STEP_NO_MEMORY : STEP_DAMAGED;
}

static Step step_zstd(DisStream *s, uint8_t *out, size_t room, size_t *made)
{
    ZSTD_inBuffer  in = {s->in, s->count, s->at};
    ZSTD_outBuffer to = {out, room, 0};
    const size_t   result = ZSTD_decompressStream(s->zstd, &to, &in);
    s->at = in.pos;
    *made = to.pos;
    if (!ZSTD_isError(result)) return result == 0 ? STEP_STREAM_ENDS : STEP_MORE;
    switch (ZSTD_getErrorCode(result)) {
    case ZSTD_error_memory_allocation:
        return STEP_NO_MEMORY;
    case ZSTD_error_frameParameter_windowTooLarge:
        return STEP_TOO_WIDE;
    default:
        return STEP_DAMAGED;
    }
}

static Step step_bzip2(DisStream *s, uint8_t *out, size_t room, size_t *made)
{
    s->bzip2.next_in = (char *)s->in + s->at;
    s->bzip2.avail_in = (unsigned)(s->count - s->at);
    s->bzip2.next_out = (char *)out;
    s->bzip2.avail_out = (unsigned)room;
    const int result = BZ2_bzDecompress(&s->bzip2);
    s->at = s->count - s->bzip2.avail_in;
    *made = room - s->bzip2.avail_out;
    if (result == BZ_STREAM_END) return STEP_STREAM_ENDS;
    if (result == BZ_OK) return STEP_MORE;
    return result == BZ_MEM_ERROR ? STEP_NO_MEMORY : STEP_DAMAGED;
}

static Step step_xz(DisStream *s, uint8_t *out, size_t room, size_t *made)
{
    s->xz.next_in = s->in + s->at;
    s->xz.avail_in = s->count - s->at;
    s->xz.next_out = out;
    s->xz.avail_out = room;
    const lzma_ret result = lzma_code(&s->xz, LZMA_RUN);
    s->at = s->count - s->xz.avail_in;
    *made = room - s->xz.avail_out;
    if (result == LZMA_STREAM_END) return STEP_STREAM_ENDS;
    if (result == LZMA_OK || result == LZMA_BUF_ERROR) return STEP_MORE;
    return result == LZMA_MEM_ERROR ? STEP_NO_MEMORY : result == LZMA_MEMLIMIT_ERROR ? STEP_TOO_WIDE : STEP_DAMAGED;
}

static Step step(DisStream *s, uint8_t *out, size_t room, size_t *made)
{
    switch (s->packing) {
    case PACKING_GZIP:
        return step_gzip(s, out, room, made);
    case PACKING_ZSTD:
        return step_zstd(s, out, room, made);
    case PACKING_BZIP2:
        return step_bzip2(s, out, room, made);
    default:
        return step_xz(s, out, room, made);
    }
}

static bool begin_decoder(DisStream *s)
{
    switch (s->packing) {
    case PACKING_GZIP:
        return inflateInit2(&s->gzip, 15 + 16) == Z_OK; /* 32 KiB of window; 16 stands for gzip's header alone */
    case PACKING_ZSTD:
        s->zstd = ZSTD_createDStream();
        return s->zstd && !ZSTD_isError(ZSTD_DCtx_setParameter(s->zstd, ZSTD_d_windowLogMax, window_log_most));
    case PACKING_BZIP2:
        return BZ2_bzDecompressInit(&s->bzip2, 0, 0) == BZ_OK;
    case PACKING_XZ:
        return lzma_stream_decoder(&s->xz, xz_memory_most, 0) == LZMA_OK;
    default:
        return true;
    }
}

static void end_decoder(DisStream *s)
{
    if (s->packing == PACKING_GZIP) inflateEnd(&s->gzip);
    if (s->packing == PACKING_ZSTD) ZSTD_freeDStream(s->zstd);
    if (s->packing == PACKING_BZIP2) BZ2_bzDecompressEnd(&s->bzip2);
    if (s->packing == PACKING_XZ) lzma_end(&s->xz);
    s->gzip = (z_stream){0};
    s->zstd = NULL;
    s->bzip2 = (bz_stream){0};
    s->xz = (lzma_stream)LZMA_STREAM_INIT;
}

/* Handles what follows the end of one stream: another stream of the same kind, padding, or something else, which is not
 * read. */
static void next_stream(DisStream *s)
{
    for (;;) {
        fill(s, magic_octets);
        while (s->at < s->count && s->in[s->at] == 0) s->at++;
        if (s->over || (s->at == s->count && s->file_over)) break;
        if (s->count - s->at >= magic_octets || s->file_over) break;
    }
    if (s->over) return;
    if (s->at == s->count) {
        stop(s, STATUS_OK, NULL);
    } else if (packing_of(s->in + s->at, s->count - s->at) == s->packing) {
        end_decoder(s);
        if (!begin_decoder(s)) stop(s, STATUS_NO_MEMORY, "out of memory");
    } else {
        log_warn("log: %s: what stands behind the end of its %s stream is no %s and is left", s->path,
                 packing_name[s->packing], packing_name[s->packing]);
        stop(s, STATUS_OK, NULL);
    }
}

static size_t expand(DisStream *s, uint8_t *out, size_t room)
{
    size_t made = 0;
    fill(s, 1);
    if (s->over) return 0;
    const size_t before = s->at;
    const bool   bare = s->at == s->count; /* the decoder may still hold octets of its output */
    const Step   how = step(s, out, room, &made);
    switch (how) {
    case STEP_STREAM_ENDS:
        next_stream(s);
        break;
    case STEP_MORE:
        if (made == 0 && s->at == before && (bare || s->file_over))
            stop(s, STATUS_OK, bare ? "the compressed stream ends before its end" : "the compressed stream is damaged");
        break;
    case STEP_DAMAGED:
        stop(s, STATUS_OK, "the compressed stream is damaged");
        break;
    case STEP_NO_MEMORY:
        stop(s, STATUS_NO_MEMORY, "out of memory");
        break;
    case STEP_TOO_WIDE:
        stop(s, STATUS_UNSUPPORTED, "expanding it takes too large a window; expand it with its own program first");
        break;
    }
    if (s->made + made > dis_stream_free_octets + dis_stream_ratio_most * s->read)
        stop(s, STATUS_UNSUPPORTED,
             "it expands to more than 256 times its size, which no capture does; if it is one, "
             "expand it with its own program first");
    return made;
}

/* ---- reading ------------------------------------------------------------------------------------------ */

size_t dis_stream_read(DisStream *s, void *out, size_t octets)
{
    uint8_t *to = out;
    size_t   done = 0;
    while (done < octets && !s->over) {
        size_t made = 0;
        if (s->packing != PACKING_NONE) {
            made = expand(s, to + done, octets - done < in_octets ? octets - done : in_octets);
        } else {
            fill(s, 1);
            made = s->count - s->at < octets - done ? s->count - s->at : octets - done;
            memcpy(to + done, s->in + s->at, made);
            s->at += made;
            if (made == 0 && !s->over) stop(s, STATUS_OK, NULL);
        }
        done += made;
        s->made += made;
    }
    return done;
}

bool dis_stream_skip(DisStream *s, uint64_t octets)
{
    uint8_t scratch[4096];
    while (octets > 0) {
        const size_t part = octets < sizeof scratch ? (size_t)octets : sizeof scratch;
        if (dis_stream_read(s, scratch, part) < part) return false;
        octets -= part;
    }
    return true;
}

const char *dis_stream_problem(const DisStream *s) { return s->problem; }
Status      dis_stream_status(const DisStream *s) { return s->status; }
const char *dis_stream_packing(const DisStream *s) { return packing_name[s->packing]; }

/* ---- open and close ----------------------------------------------------------------------------------- */

static Status open_stream(DisStream *s, const char *path)
{
    s->path = strdup(path);
    if (!s->path) return STATUS_NO_MEMORY;
    char     why[file_why_size];
    uint64_t octets = 0;
    s->file = file_open(why, &octets, path, FILE_FROM_PIPE);
    s->pipe = octets == UINT64_MAX;
    if (s->file < 0) {
        log_error("log: cannot open %s: %s", path, why);
        return STATUS_IO;
    }
    fill(s, magic_octets);
    if (s->over) {
        log_error("log: cannot read %s: %s", path, s->problem);
        return STATUS_IO;
    }
    if (s->count == 0) {
        log_error("log: %s is empty; a pcap or pcapng capture is wanted", path);
        return STATUS_TRUNCATED;
    }
    s->packing = packing_of(s->in, s->count);
    return begin_decoder(s) ? STATUS_OK : STATUS_NO_MEMORY;
}

void dis_stream_drain(DisStream *s)
{
    while (s->tap && !s->file_over && s->status == STATUS_OK) {
        s->at = s->count;
        fill(s, 1);
    }
}

uint64_t dis_stream_offset(const DisStream *s)
{
    return s->packing == PACKING_NONE && !s->pipe ? s->read - (s->count - s->at) : UINT64_MAX;
}

int dis_stream_file(const DisStream *s) { return s->file; }

Status dis_stream_open_tapped(DisStream **out, const char *path, DisStreamTap *tap, void *user)
{
    DisStream *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->file = -1;
    s->tap = tap;
    s->tap_user = user;
    s->xz = (lzma_stream)LZMA_STREAM_INIT;
    const Status status = open_stream(s, path);
    if (status == STATUS_OK) *out = s;
    else dis_stream_close(s);
    return status;
}

void dis_stream_close(DisStream *s)
{
    if (!s) return;
    end_decoder(s);
    if (s->file >= 0) close(s->file);
    free(s->path);
    free(s);
}
