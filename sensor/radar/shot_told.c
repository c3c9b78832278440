/* sensor/radar/shot_told.c: which detections are of scenery: in the cell of each, the field that its points make by
 * themselves. */
#include "sensor/radar/seeker_radar_private.h"

enum { sources_most = 12 };

static const double near_cells = 1.5;  /* of a point's response that counts */
static const double least_share = 0.5; /* of the power of a detection that is of scenery */

/* What is in the cell of a detection. */
typedef struct Told {
    double complex scenery, entities;
    int            sources, source[sources_most];
    double complex of[sources_most];
} Told;

/* Where the map has an echo, in cells. */
typedef struct MapPlace {
    double         row, column;
    double complex field; /* of the sum channel, at its peak */
} MapPlace;

static bool place_of(MapPlace *out, const RadarShot *shot, const RadarPoint *point)
{
    const RadarFrame   *f = shot->frame;
    const Waveform     *wave = &shot->preset->wave;
    const RangeDoppler *map = &f->map;
    Echo                echo;
    if (!shot_echo(&echo, shot, point)) return false;
    const double followed_mps = wave->uncompensated ? shot->reference_rate_mps : 0;
    const double rate_mps = 0.5 * echo.path_per_pulse_m * wave->repeat_hz + followed_mps;
    const double off_m = waveform_appears_m(wave, 0.5 * echo.path_m, rate_mps);
    out->column = off_m / map->metre_per_column + map->columns / 2;
    out->row = rate_mps / map->mps_per_row + map->rows / 2;
    out->field = echo.amplitude[CHANNEL_SUM] * cexp(-2 * pi_rad * I * wave->centre_hz / light_mps * echo.path_m);
    return true;
}

static void add_to(Told *told, const RadarPoint *point, double complex field, bool entity)
{
    if (entity) told->entities += field;
    if (point->source == 0) return;
    told->scenery += field;
    for (int k = 0; k < told->sources; k++)
        if (told->source[k] == point->source) {
            told->of[k] += field;
            return;
        }
    if (told->sources == sources_most) return;
    told->source[told->sources] = point->source;
    told->of[told->sources++] = field;
}

static void tell_points(Told *told, const RadarShot *shot, const bool *near, const Detection *detection)
{
    const RadarFrame   *f = shot->frame;
    const SeekerRadar  *r = shot->radar;
    const RangeDoppler *map = &f->map;
    for (int i = 0; i < r->points.count; i++) {
        const RadarPoint *point = &r->points.point[i];
        const bool        entity = i < r->target_points;
        MapPlace          at;
        if ((point->source == 0 && !entity) || !place_of(&at, shot, point)) continue;
        const int column = (int)clamp(floor(at.column + 0.5), 0, map->columns - 1);
        if (!near[column]) continue;
        for (int d = 0; d < f->detections; d++) {
            const double x = at.column - detection[d].column;
            double       y = at.row - detection[d].row;
            y -= map->rows * nearbyint(y / map->rows);
            if (!(fabs(x) < near_cells && fabs(y) < near_cells)) continue;
            add_to(&told[d], point,
                   at.field * interval_lobe(r->plan, false, fabs(x)) * interval_lobe(r->plan, true, fabs(y)), entity);
        }
    }
}

Status shot_tell(RadarShot *shot, Detection *detection)
{
    RadarFrame         *f = shot->frame;
    const RangeDoppler *map = &f->map;
    if (!shot->scenery || f->sources == 0 || f->detections == 0) return STATUS_OK;
    Told *told = arena_alloc(shot->arena, (size_t)f->detections, sizeof *told);
    bool *near = arena_alloc(shot->arena, (size_t)map->columns, sizeof *near);
    if (!told || !near) return STATUS_NO_MEMORY;
    for (int d = 0; d < f->detections; d++)
        for (int x = detection[d].column - 2; x <= detection[d].column + 2; x++)
            if (x >= 0 && x < map->columns) near[x] = true;
    tell_points(told, shot, near, detection);
    for (int d = 0; d < f->detections; d++) {
        const double complex cell =
            map->cell[(size_t)detection[d].row * (size_t)map->columns + (size_t)detection[d].column];
        const double     power = scatter_power(told[d].scenery);
        int              most = -1;
        DetectedScenery *of = &detection[d].scenery;
        of->share = fmin(power / fmax(scatter_power(cell), 1e-300), 1);
        if (!(of->share >= least_share) || !(power > scatter_power(told[d].entities))) continue;
        for (int k = 0; k < told[d].sources; k++)
            if (most < 0 || scatter_power(told[d].of[k]) > scatter_power(told[d].of[most])) most = k;
        if (most < 0) continue;
        of->source = told[d].source[most];
        of->id = f->source[of->source - 1].id;
        of->class = f->source[of->source - 1].class;
        f->scenery.detections++;
    }
    return STATUS_OK;
}
