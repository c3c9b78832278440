/* terrain/ground/landscape_parts.c: a landscape to plain arrays, and back. */
#include "terrain/ground/landscape_parts.h"

#include "terrain/ground/landscape_private.h"

#include <stdlib.h>

static const double farthest_m = 2e7; /* no place of a local frame is farther from its origin */

void landscape_parts(LandscapeParts *out, const Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    *out = (LandscapeParts){.frame = landscape->frame,
                            .config = landscape->config,
                            .invented = !cover->real,
                            .said = landscape->fitted_to,
                            .cover_seed = cover->invented.seed,
                            .geoid_m = cover->geoid_m,
                            .treeline_m = cover->treeline_m};
    if (out->invented) return;
    if (cover->store.path) {
        out->store = cover->store.path;
        out->store_content = cover->store.content;
        return;
    }
    out->elevation = landscape->elevation;
    out->photo = cover->photo;
    memcpy(out->cover, cover->grid, sizeof out->cover);
}

/* ---- checks ------------------------------------------------------------------------------------ */

static bool is_place(double x_m) { return fabs(x_m) <= farthest_m; /* false for NaN */ }

static const char *evidence_fault(const LandscapeEvidence *said)
{
    const int count[3] = {said->fix_count, said->line_count, said->place_count};
    for (int k = 0; k < 3; k++)
        if (count[k] < 0 || count[k] > landscape_parts_rows) return "too many places that the ground was fitted to";
    if (!is_place(said->sea_h_m)) return "the height of the sea";
    for (int i = 0; i < said->fix_count; i++) {
        const GroundFix *fix = &said->fix[i];
        for (int k = 0; k < 3; k++)
            if (!is_place(fix->p_enu[k])) return "a place that the ground was fitted to";
        if (fix->voter < 0 || fix->voter > said->fix_count) return "the voter of a place that the ground was fitted to";
    }
    for (int i = 0; i < said->line_count; i++)
        for (int k = 0; k < 3; k++)
            if (!is_place(said->line[i].a_enu[k]) || !is_place(said->line[i].b_enu[k])) return "a clear line";
    for (int i = 0; i < said->place_count; i++)
        if (!is_place(said->place[i].x_m) || !is_place(said->place[i].y_m)) return "a place of sea or land";
    return NULL;
}

/* Whether x is a whole number of at least `low`, to within rounding. */
static bool is_whole(double x, double low) { return x >= low && x <= 1e6 && fabs(x - rint(x)) <= 1e-6; }

bool landscape_parts_nested(const ElevationLevel *fine, const ElevationLevel *coarse)
{
    const double ratio = coarse->spacing_m / fine->spacing_m;
    const double low[2] = {fine->x0_m - coarse->x0_m, fine->y0_m - coarse->y0_m};
    const int    posts[2] = {fine->nx, fine->ny}, outer[2] = {coarse->nx, coarse->ny};
    if (!is_whole(ratio, 2)) return false;
    for (int k = 0; k < 2; k++) {
        const double from = low[k] / coarse->spacing_m, cells = (posts[k] - 1) / ratio;
        if (!is_whole(from, 0) || !is_whole(cells, 1) || !(from + cells <= outer[k] - 1 + 1e-6)) return false;
    }
    return true;
}

static const char *levels_fault(const Elevation *e)
{
    size_t posts = 0;
    if (e->level_count < 1 || e->level_count > elevation_max_levels) return "the number of levels";
    for (int n = 0; n < e->level_count; n++) {
        const ElevationLevel *l = &e->level[n];
        const int             most = elevation_most_posts;
        if (l->nx < 2 || l->ny < 2 || l->nx > most || l->ny > most || !l->stored || !l->tile ||
            l->tiles_x != (l->nx - 2) / elevation_tile_cells + 1 ||
            l->tiles_y != (l->ny - 2) / elevation_tile_cells + 1)
            return "the size of a level";
        posts += (size_t)l->nx * (size_t)l->ny;
        if (posts > landscape_parts_posts) return "the number of posts";
        if (!(l->spacing_m >= 0.1 && l->spacing_m <= 1e5) || !(l->step_m > 0 && l->step_m <= 100) ||
            !is_place(l->x0_m) || !is_place(l->y0_m) || !is_place(l->z0_m))
            return "the place or the steps of a level";
        if (n > 0 && !landscape_parts_nested(&e->level[n - 1], l))
            return "a level that does not lie on the next one's cells";
    }
    return NULL;
}

static const char *cover_fault(const CoverGrid *g)
{
    const size_t cells = (size_t)(g->nx > 0 ? g->nx : 0) * (size_t)(g->ny > 0 ? g->ny : 0);
    if (g->nx == 0 && g->ny == 0) return NULL;
    if (g->nx < 1 || g->ny < 1 || cells > landscape_parts_cells || !g->surface) return "the size of the cover";
    if (!(g->cell_m > 0 && g->cell_m <= 1e6) || !is_place(g->x0_m) || !is_place(g->y0_m))
        return "the place of the cover";
    for (size_t i = 0; i < cells; i++)
        if (g->surface[i] >= SURFACE_COUNT) return "a class of the cover";
    return NULL;
}

static const char *photo_fault(const Photo *p)
{
    if (p->mips == 0) return NULL;
    if (p->mips < 0 || p->mips > ground_image_mips) return "the sizes of the photograph";
    for (int k = 0; k < p->mips; k++) {
        const bool half = k == 0 || (p->nx[k] == (p->nx[k - 1] + 1) / 2 && p->ny[k] == (p->ny[k - 1] + 1) / 2);
        if (p->nx[k] < 1 || p->ny[k] < 1 || !half || !p->block[k] ||
            (size_t)p->nx[k] * (size_t)p->ny[k] > landscape_parts_pixels)
            return "the sizes of the photograph";
    }
    if (!(p->cell_m > 0 && p->cell_m <= 1e6) || !is_place(p->x0_m) || !is_place(p->y0_m))
        return "the place of the photograph";
    for (int s = 0; s < SURFACE_COUNT; s++)
        for (int c = 0; c < photo_channels; c++)
            if (!(p->mean[s][c] >= 0 && p->mean[s][c] <= 1e6f)) return "the mean of the photograph";
    return NULL;
}

/* ---- made again -------------------------------------------------------------------------------- */

/* Copies octets. NULL: no memory, or nothing to copy. */
static void *copied(const void *from, size_t octets)
{
    void *to = octets ? malloc(octets) : NULL;
    return to ? memcpy(to, from, octets) : NULL;
}

static void copy_posts(ElevationLevel *to, const ElevationLevel *from)
{
    memcpy(to->tile, from->tile, (size_t)to->tiles_x * (size_t)to->tiles_y * sizeof *to->tile);
    memcpy(to->stored, from->stored, elevation_level_stored(to) * sizeof *to->stored);
    to->plain = from->plain;
}

static Status copy_levels(Elevation *out, const Elevation *from)
{
    Status status = STATUS_OK;
    for (int n = 0; n < from->level_count && status == STATUS_OK; n++) {
        const ElevationLevel *l = &from->level[n];
        status = elevation_level_create(
            out, n, &(ElevationGrid){l->nx, l->ny, l->x0_m, l->y0_m, l->spacing_m, l->z0_m, l->step_m});
        if (status == STATUS_OK) copy_posts(&out->level[n], l);
    }
    if (status == STATUS_OK) elevation_build_pyramids(out);
    return status;
}

static Status copy_cover(Cover *out, const LandscapeParts *parts)
{
    for (int w = 0; w < cover_windows; w++) {
        const CoverGrid *from = &parts->cover[w];
        if (from->nx == 0) continue;
        out->grid[w] = *from;
        out->grid[w].borrowed = false;
        out->grid[w].surface = copied(from->surface, (size_t)from->nx * (size_t)from->ny);
        if (!out->grid[w].surface) return STATUS_NO_MEMORY;
    }
    if (parts->photo.mips == 0) return STATUS_OK;
    out->photo = parts->photo;
    out->photo.borrowed = false;
    memset(out->photo.block, 0, sizeof out->photo.block);
    for (int k = 0; k < parts->photo.mips; k++) {
        out->photo.block[k] = copied(parts->photo.block[k], photo_block_count(&parts->photo, k) * sizeof(PhotoBlock));
        if (!out->photo.block[k]) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

static Status from_arrays(Landscape *out, const LandscapeParts *parts)
{
    Landscape landscape = {.frame = parts->frame, .config = parts->config};
    Cover    *cover = landscape.cover = calloc(1, sizeof *cover);
    if (!cover) return STATUS_NO_MEMORY;
    cover->invented.seed = parts->cover_seed;
    cover->real = true;
    cover->geoid_m = parts->geoid_m;
    cover->treeline_m = parts->treeline_m;
    levels_curve(&cover->curve, &parts->frame);
    Status status = copy_levels(&landscape.elevation, &parts->elevation);
    if (status == STATUS_OK) status = copy_cover(cover, parts);
    if (status == STATUS_OK) *out = landscape;
    else landscape_destroy(&landscape);
    return status;
}

static const char *arrays_fault(const LandscapeParts *parts)
{
    const char *fault = levels_fault(&parts->elevation);
    for (int w = 0; w < cover_windows && !fault; w++) fault = cover_fault(&parts->cover[w]);
    if (!fault) fault = photo_fault(&parts->photo);
    if (!fault && !(is_place(parts->geoid_m) && is_place(parts->treeline_m)))
        fault = "the height of the sea or the trees";
    return fault;
}

Status landscape_from_parts(Landscape *out, const char **why, const LandscapeParts *parts)
{
    *why = parts->store && *parts->store ? "it is in a terrain store" : NULL;
    if (*why) return STATUS_BAD_VALUE;
    *why = parts->invented ? evidence_fault(&parts->said) : arrays_fault(parts);
    if (!*why && !v3_is_finite(parts->frame.origin_ecef)) *why = "the origin";
    if (*why) return STATUS_BAD_VALUE;
    const Status status = parts->invented ? landscape_create_from(out, &parts->config, &parts->frame, &parts->said)
                                          : from_arrays(out, parts);
    if (status == STATUS_BAD_VALUE) *why = "the figures of the invented ground";
    return status;
}

/* ---- borrowed ------------------------------------------------------------------------------------ */

/* Height above the sea up to which trees grow, a rough estimate: some 3900 m within 30 degrees of the equator, and the
 * sea's level at 70. */
static double treeline_m(double lat_rad) { return clamp(3900 - 97.5 * (fabs(lat_rad) / rad_per_deg - 30), 0, 3900); }

Status landscape_borrow(Landscape *out, const LandscapeParts *parts, const LandscapeMap *map)
{
    Cover *cover = calloc(1, sizeof *cover);
    if (!cover) return STATUS_NO_MEMORY;
    cover->invented.seed = parts->cover_seed;
    cover->real = true;
    cover->geoid_m = parts->geoid_m;
    cover->treeline_m = treeline_m(parts->frame.origin.lat_rad);
    cover->photo = parts->photo;
    memcpy(cover->grid, parts->cover, sizeof cover->grid);
    levels_curve(&cover->curve, &parts->frame);
    if (map) cover->store = *map;
    *out = (Landscape){.frame = parts->frame, .config = parts->config, .elevation = parts->elevation, .cover = cover};
    return STATUS_OK;
}

LandscapeMap landscape_map(const Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    return cover ? cover->store : (LandscapeMap){0};
}

void landscape_photo_means(float mean[SURFACE_COUNT][photo_channels], Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    cover_measure_photo(landscape);
    memcpy(mean, cover->photo.mean, sizeof cover->photo.mean);
}

uint64_t landscape_cover_seed(uint64_t seed) { return invented_hash(seed, 2, 0); }
