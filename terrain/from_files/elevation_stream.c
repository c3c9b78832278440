/* terrain/from_files/elevation_stream.c: level 0 of terrain from files, a strip of rows at a time. */
#include "terrain/from_files/elevation_import.h"

#include "terrain/from_files/elevation_import_private.h"

#include <stdlib.h>

enum { most_side_streamed = 32768, margin_px = 64, keep_px = 8 << 20 };

struct ElevationStream {
    Import          m;
    ElevationFiles  files;
    LocalFrame      frame;
    View            wide; /* a view of level 1 */
    Samples         samples;
    ElevationReport report;
    int             drawn;
};

Status elevation_stream_open(ElevationStream **out, const ElevationFiles *files, const LocalFrame *frame,
                             const ElevationStream *like, Pool *pool)
{
    ElevationStream *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->files = *files;
    s->frame = *frame;
    s->m = (Import){.files = &s->files, .frame = &s->frame, .pool = pool, .streamed = true};
    Import *m = &s->m;
    levels_curve(&m->curve, frame);
    Status status = elevation_import_open(m);
    if (status == STATUS_OK) status = elevation_import_choose(m, &s->report);
    if (status == STATUS_OK && !like) elevation_import_plan(m, most_side_streamed);
    if (status == STATUS_OK && like) {
        m->level_count = like->m.level_count;
        for (int k = 0; k < m->level_count; k++) {
            m->level[k] = like->m.level[k];
            m->level[k].z.v = NULL;
            m->spacing_m[k] = like->m.spacing_m[k];
        }
    }
    if (status == STATUS_OK) {
        m->geoid_m = m->geoid.n_m ? geoid_height_m(&m->geoid, frame->origin.lat_rad, frame->origin.lon_rad) : 0;
    }
    if (status == STATUS_OK) *out = s;
    else elevation_stream_close(s);
    return status;
}

double elevation_stream_reads_px(const ElevationStream *s)
{
    double px = 0;
    for (int k = 0; k < s->m.set.count; k++) px += elevation_import_reads_px(&s->m, k);
    return px;
}

Status elevation_stream_begin(ElevationStream *s, double keep_octets)
{
    Import *m = &s->m;
    for (int k = 0; s->files.keep_folder && k < m->set.count; k++) {
        Raster      *raster = &m->set.raster[k];
        const double octets = fmin(sizeof(float) * elevation_import_reads_px(m, k), keep_octets);
        if ((double)raster->width * raster->height <= keep_px) continue;
        raster_keep(raster, 1, s->files.keep_folder, octets);
        keep_octets -= octets;
    }
    Status status = elevation_import_levels(m, false, &s->wide);
    for (int k = m->level_count - 1; status == STATUS_OK && k >= 1; k--) {
        Field *z = &m->level[k].z;
        status = view_bend(z->v, m, z, 0, z->ny);
        if (status == STATUS_OK && !m->level[k].outermost) view_join(z->v, z, 0, z->ny, &m->level[k + 1].z);
    }
    return status;
}

void elevation_stream_close(ElevationStream *s)
{
    if (!s) return;
    view_free(&s->wide);
    samples_free(&s->samples);
    for (int k = 0; k < elevation_max_levels; k++) levels_field_destroy(&s->m.level[k].z);
    geoid_close(&s->m.geoid);
    raster_set_close(&s->m.set);
    free(s);
}

const RasterSet *elevation_stream_files(const ElevationStream *stream) { return &stream->m.set; }

int elevation_stream_levels(const ElevationStream *stream) { return stream->m.level_count; }

void elevation_stream_level(StreamLevel *out, const ElevationStream *stream, int level)
{
    const Field *z = &stream->m.level[level].z;
    *out = (StreamLevel){z->spacing_m, z->i0, z->j0, z->nx, z->ny, z->v};
}

/* Reads what the strip needs of one grid. Where that is as coarse as in the levels around, their patch is borrowed. */
static Status read_patch(View *view, bool *borrowed, const ElevationStream *s, int grid)
{
    const RasterPatch *wide = &s->wide.patch[grid];
    RasterPatchWindow  w;
    *borrowed = false;
    if (wide->mips == 0 || !view_window(&w, view, &s->m, grid)) return STATUS_OK;
    if (w.factor >= wide->factor) {
        view->patch[grid] = *wide;
        *borrowed = true;
        return STATUS_OK;
    }
    w.x0 -= margin_px * w.factor; /* the margin makes voids filled alike from strip to strip */
    w.y0 -= margin_px * w.factor;
    w.x1 += margin_px * w.factor;
    w.y1 += margin_px * w.factor;
    w.wider = wide;
    const RasterPatchSource source = elevation_import_source(&s->m, grid);
    return raster_patches_read(&view->patch[grid], &w, 1, &source);
}

/* Marks where posts come from. 1: the nearest pixel of the finest grid there is valid; 2: it is a void filled from its
 * surroundings; 3: a coarser grid; 0: beyond the data. */
static void mark(uint8_t *from_file, const View *view, const Import *m)
{
    enum { inner = 4 }; /* posts this far inside a hole may come from a coarser grid */
    const int nx = view->level.nx;
    memset(from_file, 0, (size_t)view->rows * (size_t)nx);
    for (int grid = 0; grid < m->grids; grid++) {
        const RasterPatch *p = &view->patch[grid];
        const Sight       *s = &view->sight[grid];
        if (p->mips == 0) continue;
        const double w = m->grid[grid].raster->width, h = m->grid[grid].raster->height;
        for (int r = 0; r < view->rows; r++) {
            const int    j = view->row0 + r - view->node_row0;
            const double b = (double)(j % view->stride) / view->stride;
            for (int i = 0; i < nx; i++) {
                const size_t  node = (size_t)(j / view->stride) * (size_t)view->nodes_x + (size_t)(i / view->stride);
                const double  a = (double)(i % view->stride) / view->stride;
                const double *x = s->x + node, *y = s->y + node;
                const int     n = view->nodes_x;
                const double  px = (1 - b) * (x[0] + a * (x[1] - x[0])) + b * (x[n] + a * (x[n + 1] - x[n]));
                const double  py = (1 - b) * (y[0] + a * (y[1] - y[0])) + b * (y[n] + a * (y[n + 1] - y[n]));
                if (!(px >= 0 && py >= 0 && px < w && py < h)) continue;
                const int c = ((int)px - p->x0) / p->factor, q = ((int)py - p->y0) / p->factor;
                if (c < 0 || q < 0 || c >= p->nx[0] || q >= p->ny[0]) continue;
                uint8_t   *to = &from_file[(size_t)r * (size_t)nx + (size_t)i];
                const bool hole = p->hole[(size_t)q * (size_t)p->nx[0] + (size_t)c] != 0;
                if (*to == 0) *to = !hole ? 1 : raster_patch_hole(p, px, py) > 0.5 ? inner : 2;
                else if (*to == inner && !hole) *to = 3;
            }
        }
    }
    for (size_t n = 0; n < (size_t)view->rows * (size_t)nx; n++)
        if (from_file[n] == inner) from_file[n] = 2;
}

/* Counts the filled posts of the strip within the data. */
static void count_voids(ElevationStream *s, const View *view)
{
    const RasterPatch *p = &view->patch[s->m.main];
    if (p->voids == 0 || p->mips == 0) return;
    uint8_t *seen = malloc((size_t)view->rows * (size_t)view->level.nx);
    if (!seen) return;
    mark(seen, view, &s->m);
    for (size_t n = 0; n < (size_t)view->rows * (size_t)view->level.nx; n++) {
        s->report.voids += seen[n] == 2;
        s->report.voids_coarser += seen[n] == 3;
    }
    free(seen);
}

static Status heights(ElevationStream *s, int row0, int rows, float *h_m, float *cell_m, uint8_t *from_file,
                      bool counted)
{
    Import   *m = &s->m;
    View      view = {0};
    bool      borrowed[import_most_grids] = {false};
    const int ny = m->level[0].z.ny;
    Status    status = view_create(&view, m, &m->level[0].z, row0, rows);
    for (int grid = 0; grid < m->grids && status == STATUS_OK; grid++)
        status = read_patch(&view, &borrowed[grid], s, grid);
    view.cell_m = cell_m;
    if (status == STATUS_OK) status = view_heights(h_m, &view, m);
    if (status == STATUS_OK && from_file) mark(from_file, &view, m);
    const RasterPatch *patch = &view.patch[m->main];
    if (status == STATUS_OK && counted) {
        count_voids(s, &view);
        const int end = (int)(2.0 * samples_places * (row0 + rows) / ny);
        if (end > s->drawn && patch->mips > 0 && patch->factor == 1 && patch->nx[0] > 1 && patch->ny[0] > 1)
            status = samples_draw(&s->samples, m, patch, s->drawn, end, (s->drawn + end) / 2);
        s->drawn = end > s->drawn ? end : s->drawn;
    }
    for (int grid = 0; grid < import_most_grids; grid++)
        if (borrowed[grid]) view.patch[grid] = (RasterPatch){0};
    view_free(&view);
    return status;
}

Status elevation_stream_heights(ElevationStream *s, int row0, int rows, float *h_m, uint8_t *from_file, bool counted)
{
    return heights(s, row0, rows, h_m, NULL, from_file, counted);
}

Status elevation_stream_cells(ElevationStream *s, int row0, int rows, float *h_m, float *cell_m, uint8_t *from_file)
{
    return heights(s, row0, rows, h_m, cell_m, from_file, false);
}

Status elevation_stream_bend(const ElevationStream *s, int row0, int rows, float *h_m)
{
    const Status status = view_bend(h_m, &s->m, &s->m.level[0].z, row0, rows);
    if (status == STATUS_OK) view_join(h_m, &s->m.level[0].z, row0, rows, &s->m.level[1].z);
    return status;
}

double elevation_stream_around(const ElevationStream *s, double x_m, double y_m)
{
    for (int k = 1; k < s->m.level_count; k++) {
        int          corner[3];
        double       weight[3];
        const double z_m = levels_height(&s->m.level[k].z, x_m, y_m, corner, weight);
        if (isfinite(z_m)) return z_m;
    }
    return 0;
}

Status elevation_stream_report(ElevationReport *out, const ElevationStream *s, const Elevation *stored)
{
    ElevationReport r = s->report;
    elevation_import_describe(&r, &s->m);
    const Status status = stored && s->samples.count > 0 ? samples_measure(&r, &s->samples, stored) : STATUS_OK;
    if (status == STATUS_OK) *out = r;
    return status;
}

Status elevation_middle(Geodetic *out, RasterSet *opened, const char *paths)
{
    RasterSet set = {0};
    Status    status = raster_set_open(&set, paths, "terrain.elevation");
    if (status != STATUS_OK) return status;
    double x = 0.5 * set.raster[0].width, y = 0.5 * set.raster[0].height;
    raster_earth_from_px(&set.raster[0], 1, &x, &y);
    if (isfinite(x) && isfinite(y)) *out = (Geodetic){y, x, 0};
    else status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) *opened = set;
    else raster_set_close(&set);
    return status;
}
