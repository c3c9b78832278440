/* terrain/store/store_format.c: where everything is in a terrain store, and what of a header can be believed. */
#include "terrain/store/store_format_private.h"

#include "pitviper_file.h"
#include "terrain/ground/landscape_parts.h"

#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* ---- hashes ------------------------------------------------------------------------------------- */

static uint64_t mixed(uint64_t h)
{
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u; /* Stafford's thirteenth variant ("Better bit mixing", 2011) */
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

/* A hash of octets whose 64 bits are all well mixed. */
static uint64_t store_hash(uint64_t seed, const void *octets, size_t count)
{
    const uint8_t *at = octets;
    uint64_t       lane[4], word[4];
    for (uint64_t k = 0; k < 4; k++) lane[k] = mixed(seed + k * 0x9e3779b97f4a7c15u + count);
    size_t n = 0;
    for (; n + sizeof word <= count; n += sizeof word) {
        memcpy(word, at + n, sizeof word);
        for (int k = 0; k < 4; k++) {
            lane[k] = (lane[k] ^ word[k]) * 0x9fb21c651e98df25u;
            lane[k] ^= lane[k] >> 29;
        }
    }
    memset(word, 0, sizeof word);
    memcpy(word, at + n, count - n);
    uint64_t h = count;
    for (int k = 0; k < 4; k++) h = mixed(h ^ mixed(lane[k] ^ word[k]));
    return h;
}

uint64_t store_checksum(const StoreHeader *header)
{
    StoreHeader plain = *header;
    plain.checksum = 0;
    const uint64_t h = store_hash(store_version, &plain, sizeof plain);
    return store_hash(h, (const uint8_t *)header + sizeof *header, (size_t)header->header_octets - sizeof *header);
}

typedef struct ContentJob {
    const uint8_t *at;
    size_t         octets;
    uint64_t       hash[64];
} ContentJob;

enum { content_piece = 1 << 20 };

static void hash_piece(void *user, int worker, int task)
{
    (void)worker;
    ContentJob  *job = user;
    const size_t from = (size_t)task * content_piece, left = job->octets - from;
    job->hash[task] = store_hash(1, job->at + from, left < content_piece ? left : content_piece);
}

uint64_t store_content(const StoreHeader *header, const uint8_t *map, Pool *pool)
{
    StoreHeader plain = {.version = header->version,
                         .classes = header->classes,
                         .lat_rad = header->lat_rad,
                         .lon_rad = header->lon_rad,
                         .h_m = header->h_m,
                         .geoid_m = header->geoid_m,
                         .level_count = header->level_count,
                         .albedo = header->albedo,
                         .canopy_height = header->canopy_height,
                         .canopy_cover = header->canopy_cover,
                         .crown_count = header->crown_count,
                         .building_count = header->building_count};
    memcpy(plain.level, header->level, sizeof plain.level);
    memcpy(plain.surface, header->surface, sizeof plain.surface);
    memcpy(plain.mean, header->mean, sizeof plain.mean);
    uint64_t h = store_hash(2, &plain, sizeof plain);
    for (int s = 0; s < STORE_SECTIONS; s++) {
        const StoreSection section = header->section[s];
        for (uint64_t done = 0; done < section.octets;) {
            ContentJob   job = {.at = map + section.offset + done};
            const size_t most = sizeof job.hash / sizeof *job.hash * content_piece;
            job.octets = section.octets - done < most ? (size_t)(section.octets - done) : most;
            const int pieces = (int)((job.octets + content_piece - 1) / content_piece);
            if (pool) pool_run(pool, pieces, hash_piece, &job);
            else
                for (int k = 0; k < pieces; k++) hash_piece(&job, 0, k);
            h = store_hash(h, job.hash, (size_t)pieces * sizeof *job.hash);
            madvise((void *)(uintptr_t)job.at, job.octets,
                    MADV_DONTNEED); /* pages of a mapped file can be dropped: they stay in the system's cache */
            done += job.octets;
        }
    }
    return h;
}

/* ---- sizes and places --------------------------------------------------------------------------- */

static size_t aligned(size_t octets, size_t unit) { return (octets + unit - 1) / unit * unit; }

/* Octets of a level's pyramid, which begins at `at`. Where `to` is not NULL its pyramid is set to point there. */
static size_t store_pyramid(ElevationLevel *to, uint8_t *at, const ElevationLevel *level)
{
    size_t sum = 0;
    for (int k = elevation_pyramid_first; k < level->pyramid_count; k++) {
        const size_t nodes = (size_t)level->pyramid_nx[k] * (size_t)level->pyramid_ny[k];
        if (to) to->pyramid[k] = (uint16_t *)(void *)(at + sum);
        sum += aligned(nodes * sizeof **level->pyramid, 64);
        if (k < elevation_rise_level) continue;
        if (to) to->rise[k] = (ElevationRise *)(void *)(at + sum);
        sum += aligned(nodes * sizeof **level->rise, 64);
    }
    return sum;
}

static size_t store_mips(Photo *to, uint8_t *at, int nx, int ny)
{
    Photo  p = {.nx = {nx}, .ny = {ny}};
    size_t sum = 0;
    if (nx == 0) return 0;
    p.mips = photo_mips(p.nx, p.ny);
    for (int k = 0; k < p.mips; k++) {
        p.block[k] = at ? (PhotoBlock *)(void *)(at + sum) : NULL;
        sum += aligned(photo_block_count(&p, k) * sizeof(PhotoBlock), 64);
    }
    if (to) *to = p;
    return sum;
}

static size_t cells_of(const StoreGrid *grid) { return (size_t)grid->nx * (size_t)grid->ny; }

static Status describe(ElevationLevel *out, const StoreHeaderLevel *l)
{
    return elevation_level_describe(out,
                                    &(ElevationGrid){l->nx, l->ny, l->x0_m, l->y0_m, l->spacing_m, l->z0_m, l->step_m});
}

bool store_layout(StoreHeader *h)
{
    uint64_t octets[STORE_SECTIONS] = {0}, at = h->header_octets;
    for (int n = 0; n < h->level_count; n++) {
        ElevationLevel level;
        if (describe(&level, &h->level[n]) != STATUS_OK) return false;
        octets[STORE_TILES + n] = (uint64_t)level.tiles_x * (uint64_t)level.tiles_y * sizeof(ElevationTile);
        octets[STORE_POSTS + n] = elevation_level_stored(&level) * sizeof(uint16_t);
        octets[STORE_PYRAMID + n] = store_pyramid(NULL, NULL, &level);
    }
    for (int w = 0; w < cover_windows; w++) octets[STORE_SURFACE + w] = cells_of(&h->surface[w]);
    octets[STORE_ALBEDO] = store_mips(NULL, NULL, h->albedo.nx, h->albedo.ny);
    octets[STORE_CANOPY_HEIGHT] = cells_of(&h->canopy_height);
    octets[STORE_CANOPY_COVER] = cells_of(&h->canopy_cover);
    if (h->crown_count > (uint64_t)1 << 40) return false;
    octets[STORE_CROWNS] = h->crown_count * sizeof(Crown);
    for (int s = 0; s < STORE_SECTIONS; s++) {
        h->section[s] = octets[s] ? (StoreSection){at, octets[s]} : (StoreSection){0};
        at += aligned(octets[s], store_page);
    }
    h->file_octets = at;
    return true;
}

/* ---- a header checked ------------------------------------------------------------------------------ */

static bool is_place(double x_m) { return fabs(x_m) <= 2e7; /* false for NaN */ }

static const char *grid_fault(const StoreGrid *g)
{
    enum { most = 1 << 17 };
    if (g->nx == 0 && g->ny == 0) return NULL;
    return g->nx >= 1 && g->ny >= 1 && g->nx <= most && g->ny <= most && is_place(g->x0_m) && is_place(g->y0_m) &&
                   g->cell_m >= 0.01 && g->cell_m <= 1e6
               ? NULL
               : "the size or place of a raster is out of range";
}

static const char *levels_fault(const StoreHeader *h)
{
    ElevationLevel level[elevation_max_levels];
    if (h->level_count < 1 || h->level_count > elevation_max_levels) return "the number of levels is out of range";
    for (int n = 0; n < h->level_count; n++) {
        const StoreHeaderLevel *l = &h->level[n];
        if (describe(&level[n], l) != STATUS_OK) return "the size of a level is out of range";
        if (!(l->spacing_m >= 0.05 && l->spacing_m <= 1e5) || !(l->step_m >= 0x1p-20 && l->step_m <= 100) ||
            !is_place(l->x0_m) || !is_place(l->y0_m) || !is_place(l->z0_m) || !(l->worst_m >= 0 && l->worst_m <= 1e6))
            return "the place or the steps of a level are out of range";
        if (l->pyramid_shift < 0 || l->pyramid_shift > 16 || l->rise_shift < 0 || l->rise_shift > 16 ||
            l->pyramid_base < 2 * elevation_lowest_post || l->pyramid_base > elevation_highest_post ||
            (l->plain != 0 && l->plain != 1))
            return "the pyramid of a level is out of range";
        if (n > 0 && !landscape_parts_nested(&level[n - 1], &level[n]))
            return "a level does not lie on the cells of the next one";
    }
    return NULL;
}

static const char *numbers_fault(const StoreHeader *h)
{
    const StoreGrid *grid[] = {&h->surface[0], &h->surface[1], &h->albedo, &h->canopy_height, &h->canopy_cover};
    const char      *fault = levels_fault(h);
    for (size_t k = 0; k < sizeof grid / sizeof *grid && !fault; k++) fault = grid_fault(grid[k]);
    if (fault) return fault;
    if (!(fabs(h->lat_rad) <= pi_rad / 2 && fabs(h->lon_rad) <= 2 * pi_rad && fabs(h->h_m) <= 1e6))
        return "its origin is out of range";
    if (!(fabs(h->geoid_m) <= 1e4 && h->posting_m >= 0 && h->posting_m <= 1e6)) return "a number is out of range";
    for (int s = 0; s < store_classes; s++)
        for (int c = 0; c < photo_channels; c++)
            if (!(h->mean[s][c] >= 0 && h->mean[s][c] <= 1e6f)) return "the means of the photograph are out of range";
    return memchr(h->made, 0, sizeof h->made) ? NULL : "its date is damaged";
}

Status store_header_size(size_t *octets, const char **why, const StoreHeader *h, uint64_t file_octets)
{
    *why = NULL;
    if (memcmp(h->magic, store_magic, sizeof h->magic) != 0) *why = "it is not a terrain store";
    if (*why) return STATUS_BAD_VALUE;
    if (h->version != store_version || h->classes != SURFACE_COUNT) *why = "another version of Pitviper wrote it";
    if (*why) return STATUS_UNSUPPORTED;
    if (h->file_octets != file_octets) *why = "it is not as long as its header says: it was cut, or not copied whole";
    else if (h->header_octets < store_page || h->header_octets % store_page != 0 || h->header_octets > file_octets ||
             h->header_octets > store_page + (uint64_t)2 * store_most_text)
        *why = "its header is damaged";
    if (*why) return STATUS_BAD_VALUE;
    *octets = (size_t)h->header_octets;
    return STATUS_OK;
}

static const char *texts_fault(const StoreHeader *h)
{
    uint64_t    at = sizeof *h;
    const char *octets = (const char *)h;
    for (int t = 0; t < STORE_TEXTS; t++) {
        if (h->text[t] < 1 || h->text[t] > h->header_octets - at) return "its header is damaged";
        at += h->text[t];
        if (octets[at - 1] != 0) return "its header is damaged";
    }
    return NULL;
}

Status store_header_check(const char **why, const StoreHeader *h, size_t octets, uint64_t file_octets)
{
    size_t size;
    *why = octets < sizeof *h ? "it is shorter than a header" : NULL;
    Status status = *why ? STATUS_BAD_VALUE : store_header_size(&size, why, h, file_octets);
    if (status != STATUS_OK) return status;
    if (size != octets || store_checksum(h) != h->checksum) *why = "its header is damaged";
    if (!*why) *why = texts_fault(h);
    if (!*why) *why = numbers_fault(h);
    StoreHeader laid = *h;
    if (!*why && (!store_layout(&laid) || memcmp(laid.section, h->section, sizeof laid.section) != 0 ||
                  laid.file_octets != file_octets))
        *why = "its sections are not where they should be";
    return *why ? STATUS_BAD_VALUE : STATUS_OK;
}

const char *store_text(const StoreHeader *header, StoreText text)
{
    const char *at = (const char *)header + sizeof *header;
    for (int t = 0; t < (int)text; t++) at += header->text[t];
    return at;
}

/* ---- the options that a store was made with, as a record that is found and checked by itself ------- */

/* MARK HASH LENGTH\n OPTIONS: the same in every version. It lies in the header's texts, before any section. */
static const char mark[] = "terrain-import-options ";
enum { record_most = store_page + 2 * store_most_text };

static uint64_t record_hash(const char *options, size_t length) { return store_hash(3, options, length); }

char *store_record(const char *options)
{
    char        *out = NULL;
    size_t       octets = 0;
    const size_t length = strlen(options);
    FILE        *to = open_memstream(&out, &octets);
    if (!to) return NULL;
    fprintf(to, "%s%016llx %zu\n%s", mark, (unsigned long long)record_hash(options, length), length, options);
    const bool whole = !ferror(to);
    if (fclose(to) == 0 && whole) return out;
    free(out);
    return NULL;
}

/* Options within a record of `size` octets, which a 0 ends; NULL: damaged. */
static const char *options_of(const char *record, size_t size, size_t *length)
{
    unsigned long long hash;
    int                at = 0;
    if (strncmp(record, mark, sizeof mark - 1) != 0) return NULL;
    if (sscanf(record + sizeof mark - 1, "%16llx %7zu%n", &hash, length, &at) < 2 || at == 0) return NULL;
    const size_t from = sizeof mark - 1 + (size_t)at;
    if (from >= size || record[from] != '\n' || *length == 0 || *length > size - from - 1) return NULL;
    return record_hash(record + from + 1, *length) == hash ? record + from + 1 : NULL;
}

static const char *store_record_options(const char *text)
{
    size_t      length;
    const char *options = options_of(text, strlen(text), &length);
    return options ? options : text;
}

char *store_recall(const char *path)
{
    char      *all = malloc(record_most + 1), *out = NULL;
    char       why[file_why_size];
    const int  file = file_open(why, NULL, path, FILE_FROM_DISK);
    const long size = all && file >= 0 ? file_read(file, all, record_most) : 0;
    if (file >= 0) close(file);
    if (size > (long)sizeof store_magic && memcmp(all, store_magic, sizeof store_magic) == 0) {
        all[size] = 0;
        const char *end = all + size;
        for (char *at = all; !out && (at = memmem(at, (size_t)(end - at), mark, sizeof mark - 1)); at++) {
            size_t      length;
            const char *options = options_of(at, (size_t)(end - at), &length);
            if (options) out = strndup(options, length);
        }
    }
    free(all);
    return out;
}

/* ---- attached to its octets ------------------------------------------------------------------------ */

static CoverGrid cover_of(const StoreGrid *g, uint8_t *at)
{
    return (CoverGrid){.nx = g->nx,
                       .ny = g->ny,
                       .x0_m = g->x0_m,
                       .y0_m = g->y0_m,
                       .cell_m = g->cell_m,
                       .surface = g->nx ? at : NULL,
                       .borrowed = true};
}

void store_attach(TerrainStore *out, const StoreHeader *h, uint8_t *map)
{
    const StoreSection *at = h->section;
    *out = (TerrainStore){.map = map,
                          .octets = (size_t)h->file_octets,
                          .content = h->content,
                          .posting_m = h->posting_m,
                          .geoid_m = h->geoid_m,
                          .canopy_height_grid = h->canopy_height,
                          .canopy_cover_grid = h->canopy_cover,
                          .crown_count = h->crown_count,
                          .building_count = h->building_count};
    memcpy(out->made, h->made, sizeof out->made);
    out->elevation.level_count = h->level_count;
    for (int n = 0; n < h->level_count; n++) {
        const StoreHeaderLevel *l = &h->level[n];
        ElevationLevel         *level = &out->elevation.level[n];
        if (describe(level, l) != STATUS_OK) continue; /* was checked */
        level->tile = (ElevationTile *)(void *)(map + at[STORE_TILES + n].offset);
        level->stored = (uint16_t *)(void *)(map + at[STORE_POSTS + n].offset);
        store_pyramid(level, map + at[STORE_PYRAMID + n].offset, level);
        level->pyramid_base = l->pyramid_base;
        level->pyramid_shift = l->pyramid_shift;
        level->rise_shift = l->rise_shift;
        level->plain = l->plain;
        level->borrowed = true;
        out->worst_m[n] = l->worst_m;
    }
    for (int w = 0; w < cover_windows; w++)
        out->surface[w] = cover_of(&h->surface[w], map + at[STORE_SURFACE + w].offset);
    store_mips(&out->photo, map + at[STORE_ALBEDO].offset, h->albedo.nx, h->albedo.ny);
    out->photo.x0_m = h->albedo.x0_m;
    out->photo.y0_m = h->albedo.y0_m;
    out->photo.cell_m = h->albedo.cell_m;
    out->photo.borrowed = true;
    for (int s = 0; s < SURFACE_COUNT; s++) memcpy(out->photo.mean[s], h->mean[s], sizeof out->photo.mean[s]);
    if (h->canopy_height.nx) out->canopy_height = map + at[STORE_CANOPY_HEIGHT].offset;
    if (h->canopy_cover.nx) out->canopy_cover = map + at[STORE_CANOPY_COVER].offset;
    if (h->crown_count) out->crown = (const Crown *)(const void *)(map + at[STORE_CROWNS].offset);
    out->sources = store_text(h, STORE_SOURCES);
    out->options = store_record_options(store_text(h, STORE_OPTIONS));
    out->crs = store_text(h, STORE_CRS);
    out->vertical_datum = store_text(h, STORE_DATUM);
    out->provenance = store_text(h, STORE_PROVENANCE);
}
