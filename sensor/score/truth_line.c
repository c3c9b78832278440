/* sensor/score/truth_line.c: a line of truth.jsonl: the frame, its camera and its targets. */
#include "sensor/score/truth_line.h"
#include "sensor/frame/target_record.h"
#include "sensor/score/json_member.h"
#include "sensor/score/json_pick.h"
#include "terrain/earth/geodesy.h"

#include <stdlib.h>

static Status wrong(const JsonStream *s, const char *what)
{
    log_error("score: %s:%ld: %s; this is no truth.jsonl of this program", s->path, s->line, what);
    return STATUS_BAD_VALUE;
}

/* ---- targets -------------------------------------------------------------------------------------- */

/* As left, top, width, height. False: absent, or no box. */
static bool read_box(double out[4], const json_t *from, const char *key)
{
    double edge[4];
    if (!json_member_numbers(edge, 4, from, key) || !(edge[2] >= edge[0] && edge[3] >= edge[1])) return false;
    for (int k = 0; k < 2; k++) out[k] = edge[k], out[2 + k] = edge[2 + k] - edge[k];
    return true;
}

static int class_of(const char *name, int guess)
{
    if (guess > 0 && name && strcmp(name, target_class_name(guess)) == 0) return guess; /* that of the target before */
    for (int k = 1; name && k <= target_class_count(); k++)
        if (strcmp(name, target_class_name(k)) == 0) return k;
    return 0;
}

static Status read_target(TruthTarget *t, const json_t *from, const JsonStream *s, int guess)
{
    const json_t *bands = json_object_get(from, "bands");
    *t = (TruthTarget){0};
    if (!json_is_object(from) || !json_member_entity(&t->id, from)) return wrong(s, "a target without `entity`");
    t->class_number = class_of(json_string_value(json_object_get(from, "class")), guess);
    t->range_m = json_member_number(from, "range_m");
    t->aspect_deg = json_member_number(from, "aspect_deg");
    t->pixels = json_member_number(from, "pixels");
    t->visible = json_member_number(from, "visible_fraction");
    t->foliage = json_member_number(from, "foliage_fraction");
    t->seen = json_object_get(from, "box_px") && read_box(t->box, from, "box_px");
    if (!t->class_number || !(t->range_m >= 0 && t->pixels >= 0) || !read_box(t->amodal, from, "amodal_box_px") ||
        (json_object_get(from, "box_px") && !t->seen))
        return wrong(s, "a target without `class`, `range_m`, `pixels` and `amodal_box_px`");
    for (int b = 0; b < BAND_COUNT; b++)
        t->snr[b] = json_member_number(json_object_get(bands, band_name((Band)b)), "snr");
    return STATUS_OK;
}

static int by_id(const void *a, const void *b)
{
    const uint64_t left = *(const uint64_t *)a, right = *(const uint64_t *)b;
    return (left > right) - (left < right);
}

static bool has_twice(TruthFrame *frame)
{
    if (frame->count < 2) return false;
    for (int i = 0; i < frame->count; i++) frame->sorted[i] = frame->target[i].id;
    qsort(frame->sorted, (size_t)frame->count, sizeof *frame->sorted, by_id);
    int i = 1;
    while (i < frame->count && frame->sorted[i] != frame->sorted[i - 1]) i++;
    return i < frame->count;
}

static bool make_room(TruthFrame *frame, size_t count)
{
    TruthTarget *target = realloc(frame->target, count * sizeof *target);
    if (target) frame->target = target;
    uint64_t *sorted = realloc(frame->sorted, count * sizeof *sorted);
    if (sorted) frame->sorted = sorted;
    if (target && sorted) frame->room = (int)count;
    return target && sorted;
}

static Status read_targets(TruthFrame *out, const json_t *list, const JsonStream *s)
{
    const size_t count = json_array_size(list);
    out->count = 0;
    if (!json_is_array(list) || count > 1 << 20) return wrong(s, "no list `targets`");
    if (count > (size_t)out->room && !make_room(out, 2 * count)) return STATUS_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const int    guess = i > 0 ? out->target[i - 1].class_number : 0;
        const Status status = read_target(&out->target[i], json_array_get(list, i), s, guess);
        if (status != STATUS_OK) return status;
    }
    out->count = (int)count;
    return has_twice(out) ? wrong(s, "the same `entity` twice in `targets`") : STATUS_OK;
}

/* ---- clutter -------------------------------------------------------------------------------------- */

static int clutter_class(const char *name)
{
    for (int k = CLUTTER_NONE + 1; name && k < CLUTTER_CLASSES; k++)
        if (strcmp(name, scenery_class_name((SceneryClass)k)) == 0) return k;
    return CLUTTER_NONE;
}

/* list: NULL where the frame shows none. */
static Status read_clutter(TruthFrame *out, const json_t *list, const JsonStream *s)
{
    const size_t count = json_array_size(list);
    out->clutter_count = 0;
    if (!list) return STATUS_OK;
    if (!json_is_array(list) || count > 1 << 20) return wrong(s, "`clutter` is no list");
    if (count > (size_t)out->clutter_room) {
        TruthClutter *grown = realloc(out->clutter, 2 * count * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        out->clutter = grown, out->clutter_room = (int)(2 * count);
    }
    for (size_t i = 0; i < count; i++) {
        const json_t *from = json_array_get(list, i);
        TruthClutter *c = &out->clutter[i];
        c->class_number = clutter_class(json_string_value(json_object_get(from, "class")));
        if (!json_is_object(from) || !read_box(c->box, from, "box_px"))
            return wrong(s, "an entry of `clutter` without `box_px`");
    }
    out->clutter_count = (int)count;
    return STATUS_OK;
}

/* ---- the frame ------------------------------------------------------------------------------------ */

/* Local solar time: 12 h and the sun's hour angle, from where it stands. */
static double solar_hour(double azimuth_deg, double elevation_deg, double lat_deg)
{
    const double az = azimuth_deg * rad_per_deg, el = elevation_deg * rad_per_deg, lat = lat_deg * rad_per_deg;
    const double angle = atan2(-sin(az) * cos(el), sin(el) * cos(lat) - cos(el) * sin(lat) * cos(az));
    const double hour = 12 + angle * 12 / pi_rad;
    return hour < 24 ? hour : hour - 24;
}

static Status read_lens(TruthFrame *out, const json_t *sensor, const JsonStream *s)
{
    double       c[5] = {0}; /* k1, k2, p1, p2, k3 */
    const double half[2] = {0.5 * out->width / out->focal_px, 0.5 * out->height / out->focal_px};
    const bool   given = json_object_get(sensor, "distortion") != NULL;
    if (given && !json_member_numbers(c, 5, sensor, "distortion"))
        return wrong(s, "`distortion` is no list of 5 numbers");
    const double k[3] = {c[0], c[1], c[4]}, p[2] = {c[2], c[3]};
    if (!given) out->lens = (Lens){0};
    else if (!(out->lens.reach > 0 && memcmp(k, out->lens.k, sizeof k) == 0 && memcmp(p, out->lens.p, sizeof p) == 0) &&
             view_lens_make(&out->lens, k, p, half) != STATUS_OK)
        return wrong(s, "`distortion` folds the image");
    return STATUS_OK;
}

static Status read_camera(TruthFrame *out, const json_t *host, const json_t *sensor, const JsonStream *s)
{
    double         axes[9], r_ecef_from_enu[9], p_ecef[3];
    const Geodetic place = {.lat_rad = json_member_number(host, "lat_deg") * rad_per_deg,
                            .lon_rad = json_member_number(host, "lon_deg") * rad_per_deg,
                            .h_m = json_member_number(host, "height_m")};
    if (!json_member_numbers(axes, 9, sensor, "ecef_from_cam") ||
        !(fabs(place.lat_rad) <= pi_rad && fabs(place.lon_rad) <= 7 && fabs(place.h_m) <= 1e9) ||
        ecef_from_geodetic(p_ecef, r_ecef_from_enu, &place) != STATUS_OK)
        return wrong(s, "no place and axes of the camera (`host`, `sensors[].ecef_from_cam`)");
    for (int i = 0; i < 3; i++) /* the camera's axes in ecef transposed, times those of enu */
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int n = 0; n < 3; n++) sum += axes[3 * n + i] * r_ecef_from_enu[3 * n + k];
            out->r_cam_from_enu[3 * i + k] = sum;
        }
    return read_lens(out, sensor, s);
}

static Status read_sensor(TruthFrame *out, const json_t *sensor, const JsonStream *s)
{
    long long     width, height;
    const double  across = json_member_number(sensor, "hfov_deg"), up = json_member_number(sensor, "vfov_deg");
    const json_t *bands = json_object_get(sensor, "bands");
    if (!json_member_whole(&width, sensor, "width_px", 1, 1 << 20) ||
        !json_member_whole(&height, sensor, "height_px", 1, 1 << 20) || !(across > 0 && across < 180) ||
        !(up > 0 && up < 180))
        return wrong(s, "no size and field of view of the sensor");
    out->width = (int)width, out->height = (int)height;
    out->focal_px = view_focal_px(out->width, across * rad_per_deg);
    out->deg2 = across * up;
    out->km2 = json_member_number(sensor, "ground_km2");
    if (!(out->km2 >= 0)) out->km2 = NAN;
    if (!json_is_array(bands) || json_array_size(bands) == 0) return wrong(s, "no `bands` of the sensor");
    out->bands = 0;
    for (size_t i = 0; i < json_array_size(bands); i++) {
        const char *name = json_string_value(json_array_get(bands, i));
        for (int b = 0; name && b < BAND_COUNT; b++) out->bands |= strcmp(name, band_name((Band)b)) == 0 ? 1u << b : 0;
    }
    if (out->bands) return STATUS_OK;
    log_error("score: %s:%ld: its bands are further channels; name them with --bands", s->path, s->line);
    return STATUS_BAD_VALUE;
}

static Status read_frame(TruthFrame *out, const json_t *line, const JsonStream *s)
{
    long long     frame;
    const json_t *host = json_object_get(line, "host"), *sun = json_object_get(line, "sun");
    const json_t *sensor = json_array_get(json_object_get(line, "sensors"), 0);
    out->time_s = json_member_number(line, "time_s");
    if (!json_member_whole(&frame, line, "frame", 0, INT32_MAX) || !(fabs(out->time_s) <= 1e15))
        return wrong(s, "no whole `frame`, or no `time_s`");
    out->frame = (int)frame;
    Status status = read_sensor(out, sensor, s);
    if (status == STATUS_OK) status = read_camera(out, host, sensor, s);
    if (status == STATUS_OK) status = read_targets(out, json_object_get(line, "targets"), s);
    if (status == STATUS_OK) status = read_clutter(out, json_object_get(line, "clutter"), s);
    out->hour = solar_hour(json_member_number(sun, "azimuth_deg"), json_member_number(sun, "elevation_deg"),
                           json_member_number(host, "lat_deg"));
    return status;
}

/* The line's JSON, of what is read here alone. */
static Status load(json_t **line, TruthFrame *out, const JsonStream *s)
{
    static const char *const wanted[] = {"frame",
                                         "time_s",
                                         "host",
                                         "lat_deg",
                                         "lon_deg",
                                         "height_m",
                                         "sun",
                                         "azimuth_deg",
                                         "elevation_deg",
                                         "sensors",
                                         "bands",
                                         "width_px",
                                         "height_px",
                                         "hfov_deg",
                                         "vfov_deg",
                                         "ground_km2",
                                         "distortion",
                                         "ecef_from_cam",
                                         "targets",
                                         "clutter",
                                         "entity",
                                         "class",
                                         "range_m",
                                         "aspect_deg",
                                         "pixels",
                                         "visible_fraction",
                                         "foliage_fraction",
                                         "box_px",
                                         "amodal_box_px",
                                         "snr"};
    enum { wanted_count = sizeof wanted / sizeof *wanted };
    const char *names[wanted_count + BAND_COUNT];
    memcpy(names, wanted, sizeof wanted);
    for (int b = 0; b < BAND_COUNT; b++) names[wanted_count + b] = band_name((Band)b);
    if (s->length > out->text_room) {
        char *grown = realloc(out->text, 2 * s->length);
        if (!grown) return STATUS_NO_MEMORY;
        out->text = grown;
        out->text_room = 2 * s->length;
    }
    const size_t length = json_pick(out->text, s->text, s->length, names, wanted_count + BAND_COUNT);
    return json_member_load(line, out->text, length);
}

Status truth_line_read(TruthFrame *out, const JsonStream *s)
{
    json_t *line = NULL;
    Status  status = load(&line, out, s);
    if (status == STATUS_OK && json_is_object(line)) status = read_frame(out, line, s);
    else if (status != STATUS_NO_MEMORY) status = wrong(s, "a line that is no JSON object");
    json_decref(line);
    return status;
}

void truth_frame_free(TruthFrame *frame)
{
    free(frame->target);
    free(frame->sorted);
    free(frame->clutter);
    free(frame->text);
    *frame = (TruthFrame){0};
}

bool truth_frame_point(double point_px[2], const TruthFrame *f, double azimuth_deg, double elevation_deg)
{
    const double az = azimuth_deg * rad_per_deg, el = elevation_deg * rad_per_deg;
    const double d_enu[3] = {cos(el) * sin(az), cos(el) * cos(az), sin(el)};
    const View   view = {.width = f->width, .height = f->height, .focal_px = f->focal_px, .lens = f->lens};
    double       d_cam[3];
    m3_mul_v3(d_cam, f->r_cam_from_enu, d_enu);
    if (!(d_cam[2] > 1e-9)) return false;
    view_project(point_px, &view, d_cam);
    return isfinite(point_px[0]) && isfinite(point_px[1]);
}
