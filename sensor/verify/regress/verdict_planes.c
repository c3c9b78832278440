/* sensor/verify/regress/verdict_planes.c: the channels of a verdict, and the planes and range profile of a frame
 * compared with those of its baseline. */
#include "sensor/verify/regress/verdict.h"

#include "sensor/detector/preset.h"

#include <stdlib.h>

/* ---- channels ------------------------------------------------------------------------------------ */

enum { as_it_is, kelvin, decibel }; /* what a plane is compared as */
#define LIMIT(member) (1 + offsetof(Tolerance, member))

/* A plane names its channel (render/frame/planes.h). */
static const struct ChannelRow {
    const char *name, *about, *unit;
    size_t      absolute, relative; /* members of Tolerance: LIMIT; 0: equal */
    int         as;
    Band        band; /* of kelvin */
} rows[CHANNEL_COUNT] = {
    [CHANNEL_SIZE] = {"size", "size of the images and of the range profile", ""},
    [CHANNEL_COUNTERS] = {"counters", "PDUs, drops, entities and effects, over the whole log", ""},
    [CHANNEL_TIME] = {"time", "number and time of the frames", ""},
    [CHANNEL_POSE] = {"pose", "position and attitude of the sensor", ""},
    [CHANNEL_SUN] = {"sun", "direction of the sun, from the sensor", ""},
    [CHANNEL_MOTION] = {"motion", "which entities there are, and their dead-reckoned positions", ""},
    [CHANNEL_ENTITY] = {"entity", "entity of each pixel", ""},
    [CHANNEL_PART] = {"part", "part of the model of each pixel", ""},
    [CHANNEL_RANGE] = {"range", "range of the surface of each pixel", "m", .relative = LIMIT(range_rel)},
    [CHANNEL_NORMAL] = {"normal", "normal of the surface of each pixel", "", .absolute = LIMIT(normal)},
    [CHANNEL_TARGETS] = {"targets", "visible fraction and box of each target, and what occludes it", ""},
    [CHANNEL_MATERIAL] = {"material", "material of each pixel", ""},
    [CHANNEL_TEMP] = {"temperature", "temperature of the surface of each pixel", "K", .absolute = LIMIT(temp_k)},
    [CHANNEL_OPTICAL] = {"optical", "radiance at the sensor", "W/(m2 sr)", LIMIT(optical_w_m2_sr), LIMIT(optical_rel)},
    [CHANNEL_MWIR] = {"mwir", "radiance at the sensor as apparent temperature, 3.4-4.8 um", "K",
                      .absolute = LIMIT(mwir_k), .as = kelvin, .band = BAND_MWIR},
    [CHANNEL_LWIR] = {"lwir", "radiance at the sensor as apparent temperature, 8-12 um", "K", .absolute = LIMIT(lwir_k),
                      .as = kelvin, .band = BAND_LWIR},
    [CHANNEL_RADAR] = {"radar",
                       "of the band, power of each pixel, relative to the brightest of the baseline; of "
                       "radar.preset, detections and truth",
                       "dB", .absolute = LIMIT(radar_db), .as = decibel},
    [CHANNEL_PROFILE] = {"radar profile", "radar power over range, relative to the largest of the baseline", "dB"},
    [CHANNEL_SIGNALS] = {"target signals", "contrast, signal-to-noise ratio and intensity of each target", ""},
    [CHANNEL_SCORES] = {"scores", "detection rate, false alarms and average precision of a recogniser's answers", ""},
    [CHANNEL_ERROR] = {"error budget", "the run's estimate of its own error", ""},
};

static Channel channel_of(const PlaneRow *row)
{
    int c = 0;
    while (c < CHANNEL_COUNT - 1 && strcmp(rows[c].name, row->verdict) != 0) c++;
    return (Channel)c;
}

/* Whether its message names the plane, since others are in the same channel. */
static bool shares_channel(RecordPlane plane)
{
    const PlaneRow *row = plane_recorded(plane), *other;
    for (int p = 0; (other = plane_recorded(p)); p++)
        if (p != plane && strcmp(other->verdict, row->verdict) == 0) return true;
    return false;
}

const char *verdict_channel_name(Channel channel) { return rows[channel].name; }
const char *verdict_channel_about(Channel channel) { return rows[channel].about; }

void verdict_channel_value(char out[64], Channel channel, double value, int digits)
{
    const char *unit = rows[channel].unit, *space = *unit ? " " : "";
    const bool  thermal = rows[channel].as == kelvin;
    if (isnan(value)) snprintf(out, 64, "not a number");
    else if (isinf(value)) snprintf(out, 64, channel == CHANNEL_RANGE && value > 0 ? "no surface" : "out of range");
    else if (thermal && value <= apparent_floor_k) snprintf(out, 64, "below %.0f K", apparent_floor_k);
    else snprintf(out, 64, "%.*g%s%s", digits, value, space, unit);
}

/* ---- units ----------------------------------------------------------------------------------- */

/* Finds the largest finite value, which dB are relative to. */
static double largest(const float *value, size_t count)
{
    double most = 0;
    for (size_t i = 0; i < count; i++)
        if (isfinite(value[i]) && (double)value[i] > most) most = (double)value[i];
    return most;
}

/* Converts a plane to the unit of its channel. full: the largest value of the expected plane, which dB are relative
 * to. */
static void to_unit(float *out, const float *value, size_t count, Channel channel, double full, const Tolerance *t)
{
    double low_m, high_m;
    if (rows[channel].as == kelvin) {
        preset_band(&low_m, &high_m, rows[channel].band, OPTICAL_PAN, -1);
        verdict_plane_to_kelvin(out, value, count, low_m, high_m);
    } else if (rows[channel].as == decibel) {
        verdict_plane_to_db(out, value, count, full, t->radar_span_db);
    } else {
        memcpy(out, value, count * sizeof *out);
    }
}

/* A member of the tolerances. Both planes were rounded to floats: a difference of exactly the limit is accepted. */
static double limit_of(size_t member, const Tolerance *t)
{
    double value = 0;
    if (member) memcpy(&value, (const char *)t + member - 1, sizeof value);
    return value * (1 + 1e-6);
}

/* ---- one plane ------------------------------------------------------------------------------- */

/* Keeps the worse: a failure, then the larger share, then the larger difference. */
static void keep_worse(ChannelResult *result, const ChannelResult *found)
{
    const bool worse = !result->there || found->failed > result->failed ||
                       (found->failed == result->failed &&
                        (found->verdict.share > result->verdict.share ||
                         (found->verdict.share == result->verdict.share && found->verdict.max > result->verdict.max)));
    if (worse) *result = *found;
}

/* A plane that only the baseline (recorded) or only the run has. */
static void one_sided(ChannelResult *result, Channel channel, RecordPlane plane, int frame, bool recorded)
{
    ChannelResult found = {
        .there = true, .failed = true, .frame = frame, .plane = plane, .verdict = {.share = 1, .max = INFINITY}};
    snprintf(found.line, sizeof found.line, "%s of frame %d is %s",
             plane != record_no_plane ? record_plane_name(plane) : rows[channel].name, frame,
             recorded ? "in the baseline and not in the run" : "not in the baseline");
    keep_worse(result, &found);
}

static bool is_geometry(Channel channel) { return channel == CHANNEL_RANGE || channel == CHANNEL_NORMAL; }

static void write_line(ChannelResult *r, Channel channel)
{
    const PlaneVerdict *v = &r->verdict;
    char                limit[64], worst[160], plane[24] = "", was[64], is[64];
    const char         *unit = rows[channel].unit, *space = *unit ? " " : "";
    const bool floor = rows[channel].as == kelvin && (v->expected <= apparent_floor_k || v->got <= apparent_floor_k);
    verdict_channel_value(was, channel, v->expected, 4);
    verdict_channel_value(is, channel, v->got, 4);
    if (channel == CHANNEL_RANGE) snprintf(limit, sizeof limit, "%.3g relative", r->relative);
    else if (channel == CHANNEL_OPTICAL) snprintf(limit, sizeof limit, "%.3g %%", 100 * r->relative);
    else snprintf(limit, sizeof limit, "%.3g%s%s", r->limit, space, unit);
    if (channel == CHANNEL_OPTICAL && isfinite(v->max) && v->expected > 0)
        snprintf(worst, sizeof worst, "%.3g %%", 100 * v->max / v->expected);
    else if (isfinite(v->max) && !floor) snprintf(worst, sizeof worst, "%.3g%s%s", v->max, space, unit);
    else snprintf(worst, sizeof worst, "%s became %s", was, is);
    if (shares_channel(r->plane)) snprintf(plane, sizeof plane, "%s: ", record_plane_name(r->plane));
    snprintf(r->line, sizeof r->line, "%s%.3g %% of pixels beyond %s, worst %s at frame %d (%d, %d)", plane,
             100 * v->share, limit, worst, r->frame, v->column, v->row);
}

typedef struct FramePair {
    const RecordFrame *expected, *got;
    const Tolerance   *tolerance;
    uint8_t           *edge, *other; /* NULL: ids must be equal */
    float             *scratch;      /* [3][count] */
    size_t             count, edges;
} FramePair;

static void compare_plane(ChannelResult *result, const FramePair *h, Channel channel, RecordPlane plane)
{
    const float *was = h->expected->number_plane[plane], *is = h->got->number_plane[plane];
    if (!was && !is) return;
    if (!was || !is) {
        one_sided(result, channel, plane, h->got->number, was != NULL);
        return;
    }
    const double  full = rows[channel].as == decibel ? largest(was, h->count) : 0;
    ChannelResult found = {.there = true,
                           .picture = true,
                           .frame = h->got->number,
                           .plane = plane,
                           .unit = rows[channel].unit,
                           .limit = limit_of(rows[channel].absolute, h->tolerance),
                           .relative = limit_of(rows[channel].relative, h->tolerance)};
    to_unit(h->scratch, was, h->count, channel, full, h->tolerance);
    to_unit(h->scratch + h->count, is, h->count, channel, full, h->tolerance);
    verdict_compare_numbers(&found.verdict, NULL, h->scratch, h->scratch + h->count, h->got->width, h->got->height,
                            &(PlaneLimits){found.limit, found.relative, h->other});
    found.allowed = is_geometry(channel) ? 0 : h->tolerance->share;
    found.failed = found.verdict.share > found.allowed;
    if (found.verdict.column >= 0) write_line(&found, channel);
    keep_worse(result, &found);
}

static void compare_id_plane(ChannelResult *result, const FramePair *h, Channel channel, RecordPlane plane)
{
    const uint32_t *was = h->expected->id_plane[plane], *is = h->got->id_plane[plane];
    size_t          at_edges = 0;
    if (!was && !is) return;
    if (!was || !is) {
        one_sided(result, channel, plane, h->got->number, was != NULL);
        return;
    }
    ChannelResult found = {.there = true, .picture = true, .frame = h->got->number, .plane = plane, .unit = ""};
    verdict_compare_ids(&found.verdict, &at_edges, was, is, h->got->width, h->got->height, h->edge);
    const PlaneVerdict *v = &found.verdict;
    found.failed = v->beyond > 0 || (double)at_edges > h->tolerance->edge_share * (double)h->edges;
    if (v->beyond > 0)
        snprintf(found.line, sizeof found.line,
                 "%.3g %% of pixels have a different %s, first at frame %d (%d, %d): %.0f, was "
                 "%.0f",
                 100 * v->share, rows[channel].name, found.frame, v->column, v->row, v->got, v->expected);
    else if (at_edges > 0)
        snprintf(found.line, sizeof found.line,
                 "%zu of %zu edge pixels have a different %s in frame %d, allowed %.3g "
                 "%%",
                 at_edges, h->edges, rows[channel].name, found.frame, 100 * h->tolerance->edge_share);
    for (size_t i = 0; h->other && i < h->count; i++) h->other[i] |= was[i] != is[i];
    keep_worse(result, &found);
}

/* Compares the sum of the bounces, since a profile's bins share one scale. */
static void compare_profile(ChannelResult *result, const FramePair *h)
{
    const RecordFrame *was = h->expected, *is = h->got;
    if (was->bins == 0 && is->bins == 0) return;
    if (was->bins > 0 && is->bins > 0 && was->bins != is->bins) return; /* reported by CHANNEL_SIZE */
    if (was->bins != is->bins) {
        one_sided(result, CHANNEL_PROFILE, record_no_plane, is->number, was->bins > 0);
        return;
    }
    double full = 0;
    for (int b = 0; b < frame_bounces; b++) full = fmax(full, largest(was->profile[b], (size_t)was->bins));
    float *db = malloc(2 * (size_t)was->bins * sizeof *db);
    for (int b = 0; db && b < frame_bounces; b++) {
        ChannelResult found = {.there = true,
                               .frame = is->number,
                               .plane = record_no_plane,
                               .bounce = b,
                               .unit = "dB",
                               .limit = h->tolerance->profile_db * (1 + 1e-6),
                               .allowed = h->tolerance->share};
        PlaneVerdict *v = &found.verdict;
        verdict_plane_to_db(db, was->profile[b], (size_t)was->bins, full, h->tolerance->radar_span_db);
        verdict_plane_to_db(db + was->bins, is->profile[b], (size_t)was->bins, full, h->tolerance->radar_span_db);
        verdict_compare_numbers(v, NULL, db, db + was->bins, was->bins, 1, &(PlaneLimits){found.limit, 0, NULL});
        found.failed = v->share > h->tolerance->share;
        if (v->column >= 0)
            snprintf(found.line, sizeof found.line,
                     "bounce %d: %.3g %% of bins beyond %.3g dB, worst %.3g dB at frame %d, "
                     "%.1f m",
                     b + 1, 100 * v->share, found.limit, v->max, is->number, was->near_m + v->column * was->bin_m);
        if (b == 0 && fabs(was->near_m - is->near_m) > 0.01 * was->bin_m) {
            found.failed = true;
            snprintf(found.line, sizeof found.line, "begins at %.3f m, was %.3f m in frame %d", is->near_m, was->near_m,
                     is->number);
        }
        keep_worse(result, &found);
    }
    free(db);
}

void verdict_frame(ChannelResult result[CHANNEL_COUNT], const RecordFrame *expected, const RecordFrame *got,
                   const Tolerance *tolerance, bool edges_allowed)
{
    const size_t count = (size_t)got->width * (size_t)got->height;
    FramePair    h = {.expected = expected, .got = got, .tolerance = tolerance, .count = count};
    h.scratch = malloc(2 * count * sizeof *h.scratch);
    if (edges_allowed) {
        h.edge = calloc(count, 1);
        h.other = calloc(count, 1);
    }
    if (h.scratch && (!edges_allowed || (h.edge && h.other))) {
        for (int p = 0; p < planes_most && h.edge; p++)
            if (expected->id_plane[p] && got->id_plane[p])
                h.edges = verdict_mark_edges(h.edge, expected->id_plane[p], got->id_plane[p], got->width, got->height);
        /* ids first: pixels of different entities are left out of the comparison of numbers */
        for (int pass = 0; pass < 2; pass++)
            for (int p = 0; plane_recorded(p); p++) {
                const Channel channel = channel_of(plane_recorded(p));
                if (record_plane_is_id(p) != (pass == 0)) continue;
                if (pass == 0) compare_id_plane(&result[channel], &h, channel, p);
                else compare_plane(&result[channel], &h, channel, p);
            }
        compare_profile(&result[CHANNEL_PROFILE], &h);
    } else {
        one_sided(&result[CHANNEL_TIME], CHANNEL_TIME, record_no_plane, got->number, true);
        snprintf(result[CHANNEL_TIME].line, sizeof result->line, "out of memory at frame %d", got->number);
    }
    free(h.scratch);
    free(h.edge);
    free(h.other);
}

bool verdict_channel_planes(ChannelPlanes *out, const ChannelResult *r, const RecordFrame *expected,
                            const RecordFrame *got, const Tolerance *tolerance)
{
    const size_t  count = (size_t)got->width * (size_t)got->height;
    PlaneVerdict  verdict;
    ChannelPlanes p = {.width = got->width,
                       .height = got->height,
                       .expected = malloc(count * sizeof(float)),
                       .got = malloc(count * sizeof(float)),
                       .difference = malloc(count * sizeof(float))};
    const bool    ids = record_plane_is_id(r->plane);
    const bool    there = ids ? expected->id_plane[r->plane] && got->id_plane[r->plane]
                              : expected->number_plane[r->plane] && got->number_plane[r->plane];
    if (!p.expected || !p.got || !p.difference || !there) {
        free(p.expected);
        free(p.got);
        free(p.difference);
        return false;
    }
    if (ids) {
        for (size_t i = 0; i < count; i++) {
            p.expected[i] = (float)expected->id_plane[r->plane][i];
            p.got[i] = (float)got->id_plane[r->plane][i];
        }
    } else {
        const Channel channel = channel_of(plane_recorded(r->plane));
        const double  full = rows[channel].as == decibel ? largest(expected->number_plane[r->plane], count) : 0;
        to_unit(p.expected, expected->number_plane[r->plane], count, channel, full, tolerance);
        to_unit(p.got, got->number_plane[r->plane], count, channel, full, tolerance);
    }
    verdict_compare_numbers(&verdict, p.difference, p.expected, p.got, p.width, p.height, &(PlaneLimits){0, 0, NULL});
    *out = p;
    return true;
}
