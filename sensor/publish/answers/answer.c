/* sensor/publish/answers/answer.c: answers of any form: which it is, what is checked of each, and what a frame's camera
 * adds to them. */
#include "sensor/publish/answers/answer_private.h"

#include <math.h>

const char *const answer_form_name[ANSWER_FORMS] = {"ring", "json", "klv"};
const char *const answer_reason_name[ANSWER_REASONS] = {
    "good",     "size",       "magic",         "byte_order",      "version",       "count", "band",
    "box",      "score",      "text",          "reserved_octets", "json",          "field", "local_set",
    "checksum", "image_size", "line_of_sight", "range",           "unknown_frame", "late",  "repeated"};

AnswerForm answer_form(const uint8_t *bytes, size_t size)
{
    static const uint8_t smpte[4] = {0x06, 0x0E, 0x2B, 0x34};
    if (size >= sizeof smpte && memcmp(bytes, smpte, sizeof smpte) == 0) return ANSWER_KLV;
    return size > 0 && *bytes == '{' ? ANSWER_JSON : ANSWER_RING;
}

AnswerReason answer_read(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope)
{
    static AnswerReason (*const read[ANSWER_FORMS])(Answer *, const uint8_t *, size_t, const AnswerScope *) = {
        answer_read_ring, answer_read_json, answer_read_klv};
    *out = (Answer){.form = answer_form(bytes, size)};
    return read[out->form](out, bytes, size, scope);
}

/* ---- a detection --------------------------------------------------------------------------------- */

AnswerDetection answer_detection_empty(void)
{
    return (AnswerDetection){
        .box_px = {NAN, NAN, NAN, NAN}, .los_rad = {NAN, NAN}, .range_m = NAN, .score = NAN, .point_px = {NAN, NAN}};
}

static bool box_is_good(const double b[4], const AnswerScope *scope)
{
    return b[0] >= 0 && b[2] > b[0] && b[2] <= scope->width && b[1] >= 0 && b[3] > b[1] && b[3] <= scope->height;
}

AnswerReason answer_detection_check(AnswerDetection *d, const AnswerScope *scope)
{
    static const double range_most_m = 1e9;
    const double       *box = d->box_px, *los = d->los_rad;
    const bool          boxed = !(isnan(box[0]) && isnan(box[1]) && isnan(box[2]) && isnan(box[3]));
    const bool          sighted = !(isnan(los[0]) && isnan(los[1]));
    if (boxed ? !box_is_good(box, scope) : !sighted && isnan(d->point_px[0]) && !d->located) return ANSWER_BOX;
    if (!isnan(d->score) && !(d->score >= 0 && d->score <= 1)) return ANSWER_SCORE;
    if (sighted && !(fabs(los[0]) <= 2 * pi_rad && fabs(los[1]) <= 0.5 * pi_rad)) return ANSWER_SIGHT;
    if (!isnan(d->range_m) && !(d->range_m > 0 && d->range_m <= range_most_m)) return ANSWER_RANGE;
    if (los[0] < 0) d->los_rad[0] += 2 * pi_rad;
    return ANSWER_GOOD;
}

bool answer_class_set(AnswerDetection *d, const char *text, size_t length)
{
    if (length >= sizeof d->class_name) return false;
    for (size_t i = 0; i < length; i++)
        if (text[i] < 0x20 || text[i] > 0x7e) return false;
    memset(d->class_name, 0, sizeof d->class_name);
    memcpy(d->class_name, text, length);
    return true;
}

/* ---- with the camera of its frame ---------------------------------------------------------------- */

void answer_camera(AnswerCamera *out, const FrameRecord *record)
{
    Geodetic place;
    double   origin_ecef[3];
    *out = (AnswerCamera){.view = record->request->view};
    memcpy(out->p_ecef, record->p_eye_ecef, sizeof out->p_ecef);
    memcpy(out->r_ecef_from_cam, record->r_ecef_from_cam, sizeof out->r_ecef_from_cam);
    if (geodetic_from_ecef(&place, out->p_ecef) != STATUS_OK ||
        ecef_from_geodetic(origin_ecef, out->r_ecef_from_enu, &place) != STATUS_OK)
        for (int k = 0; k < 9; k++) out->r_ecef_from_enu[k] = NAN;
}

static void sight_of(double los_rad[2], const AnswerCamera *c, const double d_ecef[3])
{
    double d_enu[3];
    m3_tmul_v3(d_enu, c->r_ecef_from_enu, d_ecef);
    los_rad[0] = atan2(d_enu[0], d_enu[1]);
    los_rad[1] = atan2(d_enu[2], hypot(d_enu[0], d_enu[1]));
    if (los_rad[0] < 0) los_rad[0] += 2 * pi_rad;
}

/* Unit direction in ECEF. */
static void direction_of(double d_ecef[3], const AnswerCamera *c, const double los_rad[2])
{
    const double level = cos(los_rad[1]);
    const double d_enu[3] = {level * sin(los_rad[0]), level * cos(los_rad[0]), sin(los_rad[1])};
    m3_mul_v3(d_ecef, c->r_ecef_from_enu, d_enu);
}

/* The view's own rotation is that of the terrain's axes: here the camera's axes themselves are asked for. */
static void direction_through(double d_ecef[3], const AnswerCamera *c, const double point_px[2])
{
    double d_cam[3];
    View   view = c->view;
    m3_identity(view.r_enu_from_cam);
    view_ray(d_cam, &view, point_px[0], point_px[1]);
    m3_mul_v3(d_ecef, c->r_ecef_from_cam, d_cam);
}

static void complete(AnswerDetection *d, const AnswerCamera *c)
{
    double d_ecef[3], p_ecef[3], r_ecef[3];
    if (isnan(d->los_rad[0]) && isnan(d->box_px[0]) && !isnan(d->point_px[0])) {
        direction_through(d_ecef, c, d->point_px);
        sight_of(d->los_rad, c, d_ecef);
    }
    if (d->located && ecef_from_geodetic(p_ecef, NULL, &d->place) == STATUS_OK) {
        v3_sub(r_ecef, p_ecef, c->p_ecef);
        if (isnan(d->los_rad[0])) sight_of(d->los_rad, c, r_ecef);
        if (isnan(d->range_m)) d->range_m = sqrt(v3_dot(r_ecef, r_ecef));
    }
    if (isnan(d->los_rad[0])) return;
    direction_of(d_ecef, c, d->los_rad);
    if (!d->located && d->range_m > 0) {
        for (int k = 0; k < 3; k++) p_ecef[k] = c->p_ecef[k] + d->range_m * d_ecef[k];
        d->located = geodetic_from_ecef(&d->place, p_ecef) == STATUS_OK;
    }
    if (!isnan(d->point_px[0])) return;
    double d_cam[3];
    m3_tmul_v3(d_cam, c->r_ecef_from_cam, d_ecef);
    if (d_cam[2] > 0) view_project(d->point_px, &c->view, d_cam);
}

void answer_complete(Answer *answer, const AnswerCamera *camera)
{
    for (int i = 0; i < answer->count; i++) complete(&answer->detection[i], camera);
}
