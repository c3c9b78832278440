/* terrain/elevation/raster_set.c: sets of rasters as the program has them: asked of the process that reads them, and
 * checked; and rows that are kept. */
#include "terrain/elevation/raster_child.h"
#include "terrain/elevation/raster.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

enum { most_side = 100000000, sources_size = 16384 };

static char only_within[PATH_MAX], sources_from[sources_size]; /* files are opened only below only_within (empty:
                                                                  anywhere); sources_from: see raster_sources_from */

void raster_stay_within(const char *folder) { snprintf(only_within, sizeof only_within, "%s", folder ? folder : ""); }

void raster_sources_from(const char *folders)
{
    snprintf(sources_from, sizeof sources_from, "%s", folders ? folders : "");
}

const char *raster_sources(void) { return sources_from; }

const char *raster_within(void) { return only_within; }

/* ---- rows that were read once, decoded, in a nameless file ---------------------------------------------- */

/* Rows of a raster that have been read, kept in a file as float, in pieces. */
typedef struct RasterKept {
    int           file;
    int           band;
    int           piece, pieces; /* width of a piece, px; pieces of a row */
    atomic_llong  left;          /* octets that may still be written */
    atomic_uchar *has;           /* [height][pieces] */
} RasterKept;

int raster_piece(const Raster *raster)
{
    enum {
        most = 65536,
        wide = 32768
    }; /* a power of two, so that no average over 2, 4, 8 ... columns is split between two pieces */
    return raster->width <= most ? raster->width : wide;
}

static bool is_kept(const Raster *raster, int band) { return raster->kept && raster->kept->band == band; }

static void kept_free(RasterKept *kept)
{
    if (!kept) return;
    if (kept->file >= 0) close(kept->file);
    free(kept->has);
    free(kept);
}

void raster_keep(Raster *raster, int band, const char *folder, double most_octets)
{
    enum { most_marks = 1 << 28 };
    RasterKept *kept = raster->kept || !(most_octets >= 1) ? NULL : calloc(1, sizeof *kept);
    if (!kept) return;
    kept->band = band;
    kept->piece = raster_piece(raster);
    kept->pieces = (raster->width - 1) / kept->piece + 1;
    atomic_init(&kept->left, (long long)fmin(most_octets, 0x1p62));
    if ((double)raster->height * kept->pieces <= most_marks)
        kept->has = calloc((size_t)raster->height * (size_t)kept->pieces, sizeof *kept->has);
    kept->file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (!kept->has || kept->file < 0)
        kept_free(kept); /* the file system does not support this, so rows are read again when needed */
    else raster->kept = kept;
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

/* Writes whole pieces (raster_piece) of rows into the file. When the disk is full they are read again later. */
static void keep_rows(const Raster *raster, float *rows, RasterWindow window)
{
    const int   x0 = window.x0, y0 = window.y0, width = window.width, height = window.height;
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

/* Returns false when part of the window has not been kept. */
static bool read_kept(float *out, const Raster *raster, RasterWindow window)
{
    const int         x0 = window.x0, y0 = window.y0, width = window.width, height = window.height;
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

/* ---- what a set is ------------------------------------------------------------------------------------ */

static void begin(WireChannel *channel, WireAsk ask, const Raster *raster, const char *key)
{
    WireRequest *r = &channel->request;
    *r = (WireRequest){.ask = ask,
                       .raster = raster ? raster->index : 0,
                       .low = raster ? raster->low : -INFINITY,
                       .high = raster ? raster->high : INFINITY};
    snprintf(r->key, sizeof r->key, "%s", key);
}

/* Status of the reply to a request that may fail. */
static Status answer(RasterChild *child, WireChannel *channel, WireReply *reply)
{
    const Status status = raster_child_ask(child, channel, reply);
    return status == STATUS_OK ? (Status)reply->status : status;
}

static bool in_range(int value, int low, int high) { return value >= low && value <= high; }

static bool is_length(double m) { return m > 0 && isfinite(m); }

/* Copies a text of the reader's, which contains what a file says: within `size`, and with nothing that a terminal would
 * obey. */
static void take_text(char *to, const char *from, size_t size)
{
    memcpy(to, from, size);
    to[size - 1] = 0;
    for (char *at = to; *at; at++)
        if ((unsigned char)*at < ' ' || *at == 0x7f) *at = '?';
}

static void take_stated(Raster *out, const WireRaster *w)
{
    RasterStated *t = &out->stated;
    RasterChoice *u = &out->choice;
    take_text(t->type, w->type, sizeof t->type);
    take_text(t->unit, w->unit, sizeof t->unit);
    take_text(t->crs, w->crs, sizeof t->crs);
    take_text(t->crs_unit, w->crs_unit, sizeof t->crs_unit);
    take_text(t->vertical, w->vertical_name, sizeof t->vertical);
    take_text(u->unit, w->chosen_unit, sizeof u->unit);
    t->unit_of_crs = w->unit_of_crs != 0, t->down = w->down != 0, t->coloured = w->coloured != 0,
    t->grey = w->grey != 0;
    t->crs_unit_m = w->crs_unit_m, t->has_nodata = w->has_nodata != 0, t->nodata = w->nodata;
    u->vertical = (RasterVertical)w->vertical, u->band = w->band, u->sense = w->sense;
    u->has_void = w->has_void != 0, u->no_void = w->no_void != 0, u->void_value = w->void_value;
}

/* Returns false when no raster can have such data. */
static bool take_raster(Raster *out, const uint8_t *data)
{
    WireRaster w;
    memcpy(&w, data, sizeof w);
    const bool sound = is_length(w.posting_m[0]) && is_length(w.posting_m[1]) && is_length(fabs(w.metres_per_unit)) &&
                       w.data_share >= 0 && w.data_share <= 1 && in_range(w.width, 2, INT_MAX / 4) &&
                       in_range(w.height, 2, INT_MAX / 4) && in_range(w.bands, 1, 65536) &&
                       in_range(w.vertical, RASTER_VERTICAL_BY_CRS, RASTER_VERTICAL_ELLIPSOID) && w.order >= 0 &&
                       in_range(w.row_block, 64, 1024) && (w.row_block & (w.row_block - 1)) == 0 &&
                       in_range(w.sheet_count, 1, wire_most_sheets) && in_range(w.band, 0, w.bands) &&
                       in_range(w.sense, -1, 1) && w.crs_unit_m >= 0 && isfinite(w.crs_unit_m);
    if (!sound) return false;
    out->width = w.width;
    out->height = w.height;
    out->bands = w.bands;
    out->posting_m[0] = w.posting_m[0];
    out->posting_m[1] = w.posting_m[1];
    out->ellipsoidal = w.ellipsoidal != 0;
    out->low = -INFINITY;
    out->high = INFINITY;
    take_stated(out, &w);
    out->order = w.order;
    out->row_block = w.row_block;
    out->metres_per_unit = w.metres_per_unit;
    out->bytes = w.bytes != 0;
    out->whole = w.whole != 0;
    out->sparse = w.sparse != 0;
    out->data_share = w.data_share;
    out->sheet_count = w.sheet_count;
    return true;
}

/* Takes the sheets that one reply holds, from number `first` on. STATUS_BAD_VALUE: no raster can have such sheets. */
static Status take_sheets(Raster *raster, int first, int count, const uint8_t *data)
{
    size_t at = 0;
    for (int n = first; n < first + count; n++) {
        WireSheet    w;
        RasterSheet *s = &raster->sheet[n];
        if (wire_data_octets - at < sizeof w) return STATUS_BAD_VALUE;
        memcpy(&w, data + at, sizeof w);
        at += sizeof w;
        if (!in_range(w.path_octets, 1, wire_path_size) || wire_data_octets - at < (size_t)w.path_octets ||
            !in_range(w.width, 2, most_side) || !in_range(w.height, 2, most_side) ||
            !in_range(w.x0, 0, raster->width - w.width) || !in_range(w.y0, 0, raster->height - w.height) ||
            !in_range(w.band, 0, raster->bands))
            return STATUS_BAD_VALUE;
        *s = (RasterSheet){.path = malloc((size_t)w.path_octets),
                           .x0 = w.x0,
                           .y0 = w.y0,
                           .width = w.width,
                           .height = w.height,
                           .band = w.band};
        if (!s->path) return STATUS_NO_MEMORY;
        memcpy(s->path, data + at, (size_t)w.path_octets);
        s->path[w.path_octets - 1] = 0;
        at += ((size_t)w.path_octets + 7) / 8 * 8;
        if (at > wire_data_octets) at = wire_data_octets;
    }
    return STATUS_OK;
}

static Status take_set(RasterSet *set, WireChannel *channel, int count, const char *key)
{
    RasterChild *child = set->child;
    WireReply    reply;
    int          sheets = 0;
    if (!in_range(count, 1, wire_most_rasters)) return raster_child_distrust(child, channel);
    set->raster = calloc((size_t)count, sizeof *set->raster);
    if (!set->raster) return STATUS_NO_MEMORY;
    for (int k = 0; k < count; k++) {
        Raster *raster = &set->raster[set->count++];
        raster->child = child;
        raster->index = k;
        begin(channel, WIRE_RASTER, raster, key);
        Status status = answer(child, channel, &reply);
        if (status == STATUS_OK && !take_raster(raster, channel->data)) status = raster_child_distrust(child, channel);
        if (status != STATUS_OK) {
            raster->sheet_count = 0;
            return status;
        }
        const int of_raster = raster->sheet_count;
        raster->sheet_count = 0;
        sheets += of_raster;
        if (sheets > wire_most_sheets) return raster_child_distrust(child, channel);
        raster->sheet = calloc((size_t)of_raster, sizeof *raster->sheet);
        if (!raster->sheet) return STATUS_NO_MEMORY;
        while (raster->sheet_count < of_raster) {
            const int first = raster->sheet_count;
            begin(channel, WIRE_SHEETS, raster, key);
            channel->request.first = first;
            status = answer(child, channel, &reply);
            if (status == STATUS_OK && !in_range(reply.count, 1, of_raster - first)) status = STATUS_BAD_VALUE;
            if (status == STATUS_OK) {
                raster->sheet_count = first + reply.count;
                status = take_sheets(raster, first, reply.count, channel->data);
            }
            if (status == STATUS_BAD_VALUE) return raster_child_distrust(child, channel);
            if (status != STATUS_OK) return status;
        }
    }
    return STATUS_OK;
}

Status raster_set_open(RasterSet *out, const char *paths, const char *key)
{
    char        here[PATH_MAX];
    const char *texts[] = {getcwd(here, sizeof here) ? here : "", paths, only_within, sources_from};
    RasterSet   set = {0};
    WireReply   reply;
    size_t      used = 0;
    Status      status = raster_child_start(&set.child, key);
    if (status != STATUS_OK) return status;
    WireChannel *channel = raster_child_take(set.child);
    begin(channel, WIRE_OPEN, NULL, key);
    for (size_t k = 0; k < sizeof texts / sizeof *texts && status == STATUS_OK; k++) {
        const size_t octets = strlen(texts[k]) + 1;
        if (octets > wire_data_octets - used) status = STATUS_BAD_VALUE;
        else memcpy(channel->data + used, texts[k], octets);
        used += octets;
    }
    if (status != STATUS_OK) log_error("%s: the names of the files are too long; name their folder instead", key);
    else status = answer(set.child, channel, &reply);
    if (status == STATUS_OK) status = take_set(&set, channel, reply.count, key);
    raster_child_give(set.child, channel);
    if (status == STATUS_OK) *out = set;
    else raster_set_close(&set);
    return status;
}

void raster_set_close(RasterSet *set)
{
    for (int k = 0; k < set->count; k++) {
        Raster *raster = &set->raster[k];
        for (int n = 0; n < raster->sheet_count; n++) free(raster->sheet[n].path);
        free(raster->sheet);
        kept_free(raster->kept);
    }
    free(set->raster);
    raster_child_stop(set->child);
    *set = (RasterSet){0};
}

/* ---- places ------------------------------------------------------------------------------------------- */

/* Converts places, in batches that fit into a channel. The result is NaN also where the reader has ended. */
static void places(WireAsk ask, const Raster *raster, int count, double *x, double *y)
{
    enum { most = wire_data_octets / (2 * sizeof(double)) };
    WireChannel *channel = raster_child_take(raster->child);
    for (int at = 0; at < count; at += most) {
        const int    n = count - at < most ? count - at : most;
        const size_t octets = (size_t)n * sizeof *x;
        WireReply    reply;
        begin(channel, ask, raster, "terrain");
        channel->request.count = n;
        memcpy(channel->data, x + at, octets);
        memcpy(channel->data + octets, y + at, octets);
        const bool good = answer(raster->child, channel, &reply) == STATUS_OK;
        if (good) memcpy(x + at, channel->data, octets);
        if (good) memcpy(y + at, channel->data + octets, octets);
        for (int k = at; k < at + n; k++) {
            const bool place = good && isfinite(x[k]) && isfinite(y[k]);
            x[k] = place ? x[k] : NAN;
            y[k] = place ? y[k] : NAN;
        }
    }
    raster_child_give(raster->child, channel);
}

void raster_px_from_earth(const Raster *raster, int count, double *lon_to_x, double *lat_to_y)
{
    places(WIRE_PX_FROM_EARTH, raster, count, lon_to_x, lat_to_y);
}

void raster_earth_from_px(const Raster *raster, int count, double *x_to_lon, double *y_to_lat)
{
    places(WIRE_EARTH_FROM_PX, raster, count, x_to_lon, y_to_lat);
}

void raster_enu_box(double low_m[2], double high_m[2], const Raster *raster, const LocalFrame *frame, double inset_px)
{
    enum { side = 16, count = 4 * (side + 1) };
    double       px[count], py[count];
    const double w = raster->width - 2 * inset_px, h = raster->height - 2 * inset_px;
    low_m[0] = low_m[1] = INFINITY;
    high_m[0] = high_m[1] = -INFINITY;
    for (int edge = 0; edge < 4; edge++)
        for (int k = 0; k <= side; k++) {
            const double along = (double)k / side;
            px[edge * (side + 1) + k] = inset_px + (edge < 2 ? along * w : edge == 2 ? 0 : w);
            py[edge * (side + 1) + k] = inset_px + (edge < 2 ? edge ? h : 0 : along * h);
        }
    raster_earth_from_px(raster, count, px, py);
    for (int k = 0; k < count; k++) {
        double         p_ecef[3], p_enu[3];
        const Geodetic place = {.lat_rad = py[k], .lon_rad = px[k]};
        if (ecef_from_geodetic(p_ecef, NULL, &place) != STATUS_OK) continue;
        enu_from_ecef(p_enu, frame, p_ecef);
        for (int c = 0; c < 2; c++) {
            low_m[c] = fmin(low_m[c], p_enu[c]);
            high_m[c] = fmax(high_m[c], p_enu[c]);
        }
    }
}

/* ---- pixels ------------------------------------------------------------------------------------------- */

/* A part of a window whose pixels, of `octets` each, fit into a channel: whole rows, or a piece of one row. */
typedef struct Part {
    int x, y, width, height; /* offset from the window's first pixel */
} Part;

static bool next_part(Part *p, int width, int height, size_t octets)
{
    const int most = (int)(wire_data_octets / octets);
    if (width < 1 || height < 1) return false;
    if (p->width == 0) {
        *p = (Part){0, 0, width < most ? width : most, width < most ? most / width : 1};
    } else if (p->x + p->width < width) {
        p->x += p->width;
    } else {
        p->x = 0;
        p->y += p->height;
        p->width = width < most ? width : most;
        p->height = width < most ? most / width : 1;
    }
    if (p->x + p->width > width) p->width = width - p->x;
    if (p->y + p->height > height) p->height = height - p->y;
    return p->y < height && p->width > 0;
}

bool raster_uniform(float *value, const Raster *raster, int band, RasterWindow window, const char *key)
{
    WireReply reply;
    if (!raster->sparse) return false;
    WireChannel *channel = raster_child_take(raster->child);
    begin(channel, WIRE_UNIFORM, raster, key);
    WireRequest *r = &channel->request;
    r->first = band, r->count = 1;
    r->x0 = window.x0, r->y0 = window.y0, r->width = window.width, r->height = window.height;
    const Status status = answer(raster->child, channel, &reply);
    raster_child_give(raster->child, channel);
    if (status != STATUS_OK || !reply.uniform) return false;
    *value = reply.value;
    return true;
}

Status raster_read(float *out, const Raster *raster, int band, RasterWindow window, const char *key)
{
    const int  width = window.width;
    const bool keeps = is_kept(raster, band);
    bool       uniform = true;
    Part       part = {0};
    WireReply  reply;
    Status     status = STATUS_OK;
    if (keeps && read_kept(out, raster, window)) return STATUS_OK;
    WireChannel *channel = raster_child_take(raster->child);
    while (status == STATUS_OK && next_part(&part, width, window.height, sizeof *out)) {
        begin(channel, WIRE_READ, raster, key);
        WireRequest *r = &channel->request;
        r->first = band, r->count = 1;
        r->x0 = window.x0 + part.x, r->y0 = window.y0 + part.y, r->width = part.width, r->height = part.height;
        status = answer(raster->child, channel, &reply);
        uniform &= reply.uniform != 0;
        for (int row = 0; row < part.height && status == STATUS_OK; row++) {
            float *to = out + (size_t)(part.y + row) * (size_t)width + (size_t)part.x;
            if (reply.uniform)
                for (int i = 0; i < part.width; i++) to[i] = reply.value;
            else
                memcpy(to, channel->data + (size_t)row * (size_t)part.width * sizeof *to,
                       (size_t)part.width * sizeof *to);
        }
    }
    raster_child_give(raster->child, channel);
    if (status == STATUS_OK && keeps && !uniform) keep_rows(raster, out, window);
    return status;
}

Status raster_read_bytes(uint8_t *out, uint8_t *valid, const Raster *raster, int first_band, int bands,
                         RasterWindow window, const char *key)
{
    const int width = window.width;
    Part      part = {0};
    WireReply reply;
    Status    status = STATUS_OK;
    if (bands < 1 || bands > 4) return STATUS_BAD_VALUE;
    WireChannel *channel = raster_child_take(raster->child);
    while (status == STATUS_OK && next_part(&part, width, window.height, (size_t)bands + 1)) {
        begin(channel, WIRE_READ_BYTES, raster, key);
        WireRequest *r = &channel->request;
        r->first = first_band, r->count = bands;
        r->x0 = window.x0 + part.x, r->y0 = window.y0 + part.y, r->width = part.width, r->height = part.height;
        status = answer(raster->child, channel, &reply);
        const size_t   row_octets = (size_t)part.width * (size_t)bands;
        const uint8_t *of_valid = channel->data + row_octets * (size_t)part.height;
        for (int row = 0; row < part.height && status == STATUS_OK; row++) {
            const size_t at = (size_t)(part.y + row) * (size_t)width + (size_t)part.x;
            memcpy(out + at * (size_t)bands, channel->data + (size_t)row * row_octets, row_octets);
            memcpy(valid + at, of_valid + (size_t)row * (size_t)part.width, (size_t)part.width);
        }
    }
    raster_child_give(raster->child, channel);
    return status;
}
