/* terrain/elevation/raster_kept.c: decoded rows of a raster, kept in a nameless file. */
#include "terrain/elevation/raster_kept.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

/* The raster's rows in float, those that have been read, in pieces. */
struct RasterKept {
    int           file;
    int           band;
    int           piece, pieces; /* px; of a row */
    atomic_llong  left;          /* octets that may be written yet */
    atomic_uchar *has;           /* [height][pieces] */
};

int raster_piece(const Raster *raster)
{
    enum { most = 65536, wide = 32768 }; /* a power of two: averages of 2, 4, 8 ... columns do not straddle pieces */
    return raster->width <= most ? raster->width : wide;
}

void raster_keep(Raster *raster, int band, const char *folder, double most_octets)
{
    enum { most_marks = 1 << 28 };
    RasterKept *kept = raster->kept || !(most_octets >= 1) ? NULL : calloc(1, sizeof *kept);
    if (!kept) return;
    kept->band   = band;
    kept->piece  = raster_piece(raster);
    kept->pieces = (raster->width - 1) / kept->piece + 1;
    atomic_init(&kept->left, (long long)fmin(most_octets, 0x1p62));
    if ((double)raster->height * kept->pieces <= most_marks)
        kept->has = calloc((size_t)raster->height * (size_t)kept->pieces, sizeof *kept->has);
    kept->file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (!kept->has || kept->file < 0) raster_kept_free(kept); /* no such file system: read twice */
    else raster->kept = kept;
}

bool raster_keeps(const Raster *raster, int band) { return raster->kept && raster->kept->band == band; }

void raster_kept_free(RasterKept *kept)
{
    if (!kept) return;
    if (kept->file >= 0) close(kept->file);
    free(kept->has);
    free(kept);
}

static bool whole_io(bool write, int file, float *at, size_t count, size_t offset)
{
    char  *octets = (char *)at;
    size_t left = count * sizeof *at;
    off_t  where = (off_t)(offset * sizeof *at);
    while (left > 0) {
        const ssize_t n = write ? pwrite(file, octets, left, where) : pread(file, octets, left, where);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        octets += n;
        where += n;
        left -= (size_t)n;
    }
    return true;
}

void raster_keep_rows(const Raster *raster, float *rows, int x0, int y0, int width, int height)
{
    RasterKept *kept = raster->kept;
    const bool  whole = x0 % kept->piece == 0 && (x0 + width == raster->width || width % kept->piece == 0);
    if (x0 < 0 || y0 < 0 || x0 + width > raster->width || y0 + height > raster->height || !whole) return;
    const int first = x0 / kept->piece, pieces = (width - 1) / kept->piece + 1;
    for (int y = y0; y < y0 + height; y++) {
        atomic_uchar *has = kept->has + (size_t)y * (size_t)kept->pieces + (size_t)first;
        bool          all = true;
        for (int p = 0; p < pieces; p++) all &= atomic_load(&has[p]) != 0;
        if (all) continue;
        const long long octets = (long long)width * (long long)sizeof *rows;
        if (atomic_fetch_sub(&kept->left, octets) < octets) {
            atomic_fetch_add(&kept->left, octets);
            return;
        }
        if (!whole_io(true, kept->file, rows + (size_t)(y - y0) * (size_t)width, (size_t)width,
                      (size_t)y * (size_t)raster->width + (size_t)x0))
            return;
        for (int p = 0; p < pieces; p++) atomic_store(&has[p], 1);
    }
}

bool raster_read_kept(float *out, const Raster *raster, int x0, int y0, int width, int height)
{
    const RasterKept *kept = raster->kept;
    if (x0 < 0 || y0 < 0 || x0 + width > raster->width || y0 + height > raster->height) return false;
    for (int y = y0; y < y0 + height; y++)
        for (int p = x0 / kept->piece; p <= (x0 + width - 1) / kept->piece; p++)
            if (!atomic_load(&kept->has[(size_t)y * (size_t)kept->pieces + (size_t)p])) return false;
    if (x0 == 0 && width == raster->width)
        return whole_io(false, kept->file, out, (size_t)width * (size_t)height, (size_t)y0 * (size_t)width);
    for (int y = y0; y < y0 + height; y++)
        if (!whole_io(false, kept->file, out + (size_t)(y - y0) * (size_t)width, (size_t)width,
                        (size_t)y * (size_t)raster->width + (size_t)x0))
            return false;
    return true;
}
