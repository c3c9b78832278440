/* terrain/ground/landscape.c: makes and frees a landscape without files: invented from evidence, or quickly; its ways
 * and its hedgerows. */
#include "terrain/ground/landscape_private.h"

#include <stdlib.h>

LandscapeConfig landscape_default_config(void)
{
    /* 420 km: the horizon from 10 km height is at 357, and hills are beyond it */
    return (LandscapeConfig){.seed = 1, .relief_m = 15, .spacing_m = 4, .half_width_m = 6000, .horizon_m = 420000};
}

/* Copies the evidence, which a landscape keeps so that it can be made again. */
static Status keep_evidence(LandscapeEvidence *out, const LandscapeEvidence *from)
{
    const size_t fixes = (size_t)from->fix_count * sizeof *from->fix;
    const size_t lines = (size_t)from->line_count * sizeof *from->line;
    const size_t places = (size_t)from->place_count * sizeof *from->place;
    GroundFix   *fix = fixes ? malloc(fixes) : NULL;
    ClearLine   *line = lines ? malloc(lines) : NULL;
    CoastPlace  *place = places ? malloc(places) : NULL;
    *out = *from;
    out->fix = fix;
    out->line = line;
    out->place = place;
    if ((fixes && !fix) || (lines && !line) || (places && !place)) return STATUS_NO_MEMORY;
    if (fixes) memcpy(fix, from->fix, fixes);
    if (lines) memcpy(line, from->line, lines);
    if (places) memcpy(place, from->place, places);
    return STATUS_OK;
}

static void free_evidence(LandscapeEvidence *evidence)
{
    free((void *)evidence->fix);
    free((void *)evidence->line);
    free((void *)evidence->place);
}

Status landscape_create(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame, const GroundFix *fix,
                        int fix_count, const ClearLine *line, int line_count)
{
    const LandscapeEvidence evidence = {.fix = fix, .fix_count = fix_count, .line = line, .line_count = line_count};
    return landscape_create_from(out, config, frame, &evidence);
}

Status landscape_create_from(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame,
                             const LandscapeEvidence *evidence)
{
    return landscape_create_kept(out, config, frame, evidence, NULL);
}

Status landscape_create_kept(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame,
                             const LandscapeEvidence *evidence, Cache *cache)
{
    InventedTerrain terrain;
    Landscape       landscape = {.frame = *frame, .config = *config};
    /* dyadic, so that every post's position is exact */
    landscape.config.spacing_m = rint(config->spacing_m * 64) / 64;
    Cover *cover = calloc(1, sizeof *cover);
    if (!cover) return STATUS_NO_MEMORY;
    Status status = invented_create_kept(&terrain, &landscape.config, frame, evidence, cache);
    if (status != STATUS_OK) {
        free(cover);
        return status;
    }
    cover->invented = terrain.ground;
    landscape.cover = cover;
    landscape.elevation = terrain.elevation;
    landscape.fit_worst_m = terrain.fit_worst_m;
    landscape.fixes_dropped = terrain.fixes_dropped;
    status = keep_evidence(&landscape.fitted_to, evidence);
    if (status == STATUS_OK) *out = landscape;
    else landscape_destroy(&landscape);
    return status;
}

void landscape_destroy(Landscape *landscape)
{
    if (!landscape) return;
    elevation_destroy(&landscape->elevation);
    cover_free(landscape->cover);
    free_evidence(&landscape->fitted_to);
    *landscape = (Landscape){0};
}

/* ---- a large one, quickly ------------------------------------------------------------------------ */

/* Octaves of a cubic B-spline through random lattices are read off row by row. A lattice cell is a whole number of
 * posts, so the spline's four weights are a table by the post's place in its cell and the inner loop is four products:
 * 192 M posts of ten octaves in a few seconds of one core. */
enum { octaves = 10, longest_posts = 4096, rows_a_task = elevation_tile_cells };

static const double span_m = 250; /* height from valley to top, about three deviations of the octaves' sum each way */

typedef struct Octave {
    int    posts;                    /* posts in a lattice cell; a power of two */
    int    nx, ny;                   /* number of lattice points */
    float *z;                        /* [ny][nx], m */
    float  weight[4][longest_posts]; /* weights of the spline by the post's place in its cell */
} Octave;

typedef struct Maker {
    ElevationLevel *level;
    int32_t        *post;   /* [threads][elevation_tile_side][level->nx] */
    Octave         *octave; /* [octaves] */
    float          *line;   /* [threads][level->nx + longest_posts], a row of heights */
    float          *knots;  /* [threads][most nx] */
    int             line_size, knots_size;
} Maker;

static void spline_weights(double w[4], double t)
{
    const double u = 1 - t;
    w[0] = u * u * u / 6;
    w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
    w[2] = (3 * u * u * u - 6 * u * u + 4) / 6;
    w[3] = t * t * t / 6;
}

/* Makes an octave. Heights are in proportion to wavelengths, so slopes are equal at every scale except at the shortest,
 * which are smoothed. */
static Status make_octave(Octave *o, int index, int nx, int ny, uint64_t seed)
{
    o->posts = longest_posts >> index;
    o->nx = nx / o->posts + 4;
    o->ny = ny / o->posts + 4;
    o->z = malloc((size_t)o->nx * (size_t)o->ny * sizeof *o->z);
    if (!o->z) return STATUS_NO_MEMORY;
    const double height_m = 0.95 * span_m * exp2(-index) * (index > 6 ? exp2(6 - index) : 1);
    for (int j = 0; j < o->ny; j++)
        for (int i = 0; i < o->nx; i++)
            o->z[(size_t)j * (size_t)o->nx + (size_t)i] =
                (float)(height_m * (2 * invented_unit(invented_hash(seed + (uint64_t)index, i, j)) - 1));
    for (int p = 0; p < o->posts; p++) {
        double w[4];
        spline_weights(w, (double)p / o->posts);
        for (int k = 0; k < 4; k++) o->weight[k][p] = (float)w[k];
    }
    return STATUS_OK;
}

/* Adds one octave to a row of posts. */
static void add_octave(float *restrict line, float *restrict knots, const Octave *o, int nx, int j)
{
    const int    cell = j / o->posts, place = j % o->posts;
    const float *low = o->z + (size_t)cell * (size_t)o->nx;
    for (int i = 0; i < o->nx; i++) {
        float sum = 0;
        for (int k = 0; k < 4; k++) sum += o->weight[k][place] * low[(size_t)k * (size_t)o->nx + (size_t)i];
        knots[i] = sum;
    }
    for (int c = 0; c * o->posts < nx; c++) {
        float *restrict out = line + c * o->posts;
        const float a = knots[c], b = knots[c + 1], d = knots[c + 2], e = knots[c + 3];
        for (int p = 0; p < o->posts; p++)
            out[p] += a * o->weight[0][p] + b * o->weight[1][p] + d * o->weight[2][p] + e * o->weight[3][p];
    }
}

static void make_rows(void *user, int worker, int task)
{
    const Maker    *m = user;
    ElevationLevel *level = m->level;
    float          *line = m->line + (size_t)worker * (size_t)m->line_size;
    float          *knots = m->knots + (size_t)worker * (size_t)m->knots_size;
    int32_t        *rows = m->post + (size_t)worker * elevation_tile_side * (size_t)level->nx, *post = rows;
    for (int j = task * rows_a_task; j <= (task + 1) * rows_a_task && j < level->ny; j++, post += level->nx) {
        memset(line, 0, (size_t)m->line_size * sizeof *line);
        for (int o = 0; o < octaves; o++) add_octave(line, knots, &m->octave[o], level->nx, j);
        const float scale = (float)(1 / level->step_m), base = (float)(-level->z0_m / level->step_m + 0.5);
        for (int i = 0; i < level->nx; i++) {
            const float posts = line[i] * scale + base;
            post[i] = (int32_t)(posts < 0 ? 0 : posts > 65535 ? 65535 : posts);
        }
    }
    elevation_fill_tiles(level, task, rows);
}

static void make_pyramid_rows(void *user, int worker, int task)
{
    const Maker *m = user;
    (void)worker;
    elevation_build_pyramid_tiles(m->level, task);
}

Status landscape_quick(Landscape *out, double times_s[2], const LocalFrame *frame, double east_m, double north_m,
                       Pool *pool)
{
    static const uint64_t seed = 1;
    Landscape             landscape = {.frame = *frame, .config = landscape_default_config()};
    Cover                *cover = calloc(1, sizeof *cover);
    Maker                 maker = {.octave = calloc(octaves, sizeof *maker.octave)};
    const double          start_s = wall_clock_s();
    Status                status = cover && maker.octave ? STATUS_OK : STATUS_NO_MEMORY;
    if (!(east_m >= 200 && east_m <= 32000 && north_m >= 200 && north_m <= 32000)) status = STATUS_BAD_VALUE;
    landscape.cover = cover;
    if (status != STATUS_OK) goto done;

    const int nx = (int)east_m + 1, ny = (int)north_m + 1;
    cover->invented.seed = invented_hash(seed, 2, 0);
    status = elevation_level_create(
        &landscape.elevation, 0,
        &(ElevationGrid){nx, ny, -floor(0.5 * east_m), -floor(0.5 * north_m), 1, -512, landscape_quick_step_m});
    for (int o = 0; o < octaves && status == STATUS_OK; o++)
        status = make_octave(&maker.octave[o], o, nx, ny, invented_hash(seed, 3, 0));
    if (status != STATUS_OK) goto done;
    maker.level = &landscape.elevation.level[0];
    maker.line_size = nx + longest_posts;
    maker.knots_size = maker.octave[octaves - 1].nx;
    maker.line = malloc((size_t)pool_threads(pool) * (size_t)maker.line_size * sizeof *maker.line);
    maker.knots = malloc((size_t)pool_threads(pool) * (size_t)maker.knots_size * sizeof *maker.knots);
    maker.post = malloc((size_t)pool_threads(pool) * elevation_tile_side * (size_t)nx * sizeof *maker.post);
    if (!maker.line || !maker.knots || !maker.post) {
        status = STATUS_NO_MEMORY;
        goto done;
    }
    pool_run(pool, maker.level->tiles_y, make_rows, &maker);
    const double made_s = wall_clock_s();
    elevation_begin_pyramid(maker.level);
    pool_run(pool, maker.level->tiles_y, make_pyramid_rows, &maker);
    elevation_finish_pyramid(maker.level);
    times_s[0] = made_s - start_s;
    times_s[1] = wall_clock_s() - made_s;

done:
    for (int o = 0; maker.octave && o < octaves; o++) free(maker.octave[o].z);
    free(maker.octave);
    free(maker.line);
    free(maker.knots);
    free(maker.post);
    if (status == STATUS_OK) *out = landscape;
    else landscape_destroy(&landscape);
    return status;
}

void landscape_quick_bytes(size_t *posts, size_t *pyramids, const Elevation *elevation)
{
    *posts = *pyramids = 0;
    for (int n = 0; n < elevation->level_count; n++) {
        const ElevationLevel *level = &elevation->level[n];
        *posts += elevation_level_stored(level) * sizeof *level->stored +
                  (size_t)level->tiles_x * (size_t)level->tiles_y * sizeof *level->tile;
        for (int k = elevation_pyramid_first; k < level->pyramid_count; k++)
            *pyramids += (size_t)level->pyramid_nx[k] * (size_t)level->pyramid_ny[k] *
                         (sizeof **level->pyramid + (level->rise[k] ? sizeof **level->rise : 0));
    }
}

/* ---- ways ------------------------------------------------------------------------------------- */

static const Ways *ways_of(const Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    return cover ? cover->invented.ways : NULL;
}

bool landscape_way(WayPlace *out, const Landscape *landscape, double x_m, double y_m)
{
    return ways_at(out, ways_of(landscape), x_m, y_m);
}

int landscape_way_vertices(double (*out)[2], WayKind *kind, const Landscape *landscape, int way, int most)
{
    return ways_vertices(out, kind, ways_of(landscape), way, most);
}

const HousePlot *landscape_plots(const Landscape *landscape, int *count)
{
    return ways_plots(ways_of(landscape), count);
}

bool landscape_village(double place_m[2], const Landscape *landscape, int index)
{
    return ways_village(place_m, ways_of(landscape), index);
}

double landscape_wetness(const Landscape *landscape, double x_m, double y_m)
{
    return ways_wetness(ways_of(landscape), x_m, y_m);
}

bool landscape_ways_near(const Landscape *landscape, double x_m, double y_m)
{
    return ways_touch(ways_of(landscape), x_m, y_m);
}

/* ---- hedgerows -------------------------------------------------------------------------------- */

static Status reserve_place(HedgePlace **place, int *room, int count)
{
    if (count <= *room) return STATUS_OK;
    const int   wanted = count + count / 2 + 64;
    HedgePlace *more = realloc(*place, (size_t)wanted * sizeof *more);
    if (!more) return STATUS_NO_MEMORY;
    *place = more;
    *room = wanted;
    return STATUS_OK;
}

Status landscape_hedges(HedgePlace **out, int *count, const Landscape *landscape, const double south_west_m[2],
                        const double north_east_m[2], double spacing_m)
{
    const Cover *cover = landscape->cover;
    double       from[2], end[2], squares = 1;
    int          room = 0;
    *out = NULL;
    *count = 0;
    if (!(spacing_m >= 1 && spacing_m <= 50)) return STATUS_BAD_VALUE;
    for (int a = 0; a < 2; a++) {
        if (!(fabs(south_west_m[a]) < 1e6 && fabs(north_east_m[a]) < 1e6)) return STATUS_BAD_VALUE;
        from[a] = floor(south_west_m[a] / spacing_m), end[a] = ceil(north_east_m[a] / spacing_m);
        squares *= fmax(end[a] - from[a], 0);
    }
    if (!(squares <= 1 << 26)) return STATUS_BAD_VALUE;
    if (!cover || cover->real) return STATUS_OK;
    for (int64_t j = (int64_t)from[1]; j < (int64_t)end[1]; j++)
        for (int64_t i = (int64_t)from[0]; i < (int64_t)end[0]; i++) {
            HedgePlace place;
            if (!hedge_in_square(&place, cover->invented.seed, i, j, spacing_m)) continue;
            /* a class that lies over a hedgerow, such as a road, is found in the classes */
            if (landscape_surface(landscape, place.x_m, place.y_m) != SURFACE_SCRUB) continue;
            const Status status = reserve_place(out, &room, *count + 1);
            if (status != STATUS_OK) {
                free(*out);
                *out = NULL;
                *count = 0;
                return status;
            }
            (*out)[(*count)++] = place;
        }
    return STATUS_OK;
}
