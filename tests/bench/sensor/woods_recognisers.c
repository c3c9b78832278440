/* tests/bench/sensor/woods_recognisers.c: what algorithms make of the pictures: false alarms of a double-window
 * contrast detector, and whether a classifier finds vehicles by their surroundings alone, which a shortcut about
 * targets would let it do. One ray a pixel, whole pictures. */
#include "tests/bench/sensor/woods_private.h"

#include <stdlib.h>

enum { columns = 6, rows = 4, groups = columns * rows /* of a picture, for standard errors */ };

/* Frames: with the crowd's vehicles or the bench's, in each detail. */
typedef struct Shots {
    WoodsFrame frame[2][woods_details];
} Shots;

static const Picture *picture_of(const Shots *s, int crowded, int detail)
{
    return &s->frame[crowded][detail].frame.picture;
}

/* ---- false alarms --------------------------------------------------------------------------------- */

static const DoubleWindow window = {.inner = 3, .guard = 9, .outer = 15, .step = 3};
static const double       alarm_share = 0.02; /* of places in full detail: that sets the threshold */

typedef struct Alarms {
    double of[groups][woods_details];
} Alarms;

static double alarms_off(const void *user, int without)
{
    const Alarms *a = user;
    double        s[woods_details];
    group_sums(s, a->of[0], groups, woods_details, without);
    return 100 * (s[1] / s[0] - 1);
}

static int by_contrast(const void *pa, const void *pb)
{
    const float a = *(const float *)pa, b = *(const float *)pb;
    return (a > b) - (a < b);
}

/* The contrast that this share of the places that are known exceeds. */
static double threshold_of(const float *contrast, int places, double share, Arena *arena)
{
    float *sorted = arena_alloc(arena, (size_t)places + 1, sizeof *sorted);
    int    count = 0;
    for (int k = 0; k < places && sorted; k++)
        if (!isnan(contrast[k])) sorted[count++] = contrast[k];
    if (count == 0) return NAN;
    qsort(sorted, (size_t)count, sizeof *sorted, by_contrast);
    return (double)sorted[(int)((1 - share) * (count - 1))];
}

static Status count_alarms(WoodsBench *w, int v, const Shots *s, int plane, const uint8_t *mask)
{
    const Picture *p = picture_of(s, 0, 0);
    const int      places = double_window(NULL, &window, picture_plane(p, plane), mask, p->width, p->height);
    Alarms         alarms = {0};
    double         least = NAN, all[woods_details] = {0};
    char           what[what_size], text[160];
    for (int d = 0; d < woods_details; d++) {
        float *contrast = arena_alloc(w->arena[0], (size_t)places + 1, sizeof *contrast);
        if (!contrast) return STATUS_NO_MEMORY;
        double_window(contrast, &window, picture_plane(picture_of(s, 0, d), plane), mask, p->width, p->height);
        if (d == 0) least = threshold_of(contrast, places, alarm_share, w->arena[0]);
        for (int k = 0; k < places; k++) {
            const size_t at = double_window_centre(&window, p->width, k);
            const int    x = (int)(at % (size_t)p->width), y = (int)(at / (size_t)p->width);
            if (!((double)contrast[k] > least)) continue;
            alarms.of[y * rows / p->height * columns + x * columns / p->width][d]++;
            all[d]++;
        }
    }
    snprintf(what, sizeof what, "%s: %s, %s: false alarms", woods_pose[v].name, woods_detail[1], woods_plane[plane]);
    snprintf(text, sizeof text, "double window of 3, 9, 15 px, contrast above %.2f; %g / %g a picture", least, all[1],
             all[0]);
    woods_judge(w, what, group_estimate(alarms_off, &alarms, groups), (WoodsLimit){10, "%", false}, text);
    return STATUS_OK;
}

/* Sky and what shows a vehicle. */
static uint8_t *mask_of(const Shots *s, bool crowded, Arena *arena)
{
    const Picture *p = picture_of(s, 0, 0), *q = picture_of(s, crowded, 1);
    const size_t   count = (size_t)p->width * (size_t)p->height;
    uint8_t       *mask = arena_alloc(arena, count, sizeof *mask);
    for (size_t i = 0; i < count && mask; i++)
        mask[i] = p->entity[i] || q->entity[i] || !(p->range_m[i] < INFINITY) || !(q->range_m[i] < INFINITY);
    return mask;
}

/* ---- surroundings --------------------------------------------------------------------------------- */

static const int blank_px = 1, near_px = 5, far_px = 14; /* beyond the vehicle's box on the picture */

typedef struct Ring {
    double count, sum, square, steps, step_square; /* steps: pairs of neighbours within the ring */
} Ring;

/* 0: blank or beyond; 1: the near ring; 2: the far one. */
static int ring_of(const double box[4], int x, int y)
{
    const double off = fmax(fmax(box[0] - (x + 1), x - box[2]), fmax(box[1] - (y + 1), y - box[3]));
    return off < blank_px || off >= far_px ? 0 : off < near_px ? 1 : 2;
}

static void add_pixel(Ring ring[3], const float *plane, const uint8_t *mask, const double box[4], const int at[3])
{
    const int    x = at[0], y = at[1], width = at[2], r = ring_of(box, x, y);
    const size_t i = (size_t)y * (size_t)width + (size_t)x;
    if (r == 0 || mask[i]) return;
    const double value = (double)plane[i];
    ring[r].count++, ring[r].sum += value, ring[r].square += value * value;
    for (int k = 0; k < 2; k++) {
        const size_t next = k ? i + (size_t)width : i + 1;
        if (ring_of(box, x + !k, y + k) != r || mask[next]) continue;
        ring[r].steps++, ring[r].step_square += ((double)plane[next] - value) * ((double)plane[next] - value);
    }
}

static double variance_of(const Ring *r) { return r->square / r->count - r->sum / r->count * (r->sum / r->count); }

/* What the near ring differs by from the far one: mean, variance, energy of gradients. */
static bool features_of(double feature[3], const Picture *p, int plane, const uint8_t *mask, const double box[4])
{
    Ring      ring[3] = {{0}};
    const int x0 = (int)floor(box[0]) - far_px - 1, y0 = (int)floor(box[1]) - far_px - 1;
    const int x1 = (int)ceil(box[2]) + far_px + 1, y1 = (int)ceil(box[3]) + far_px + 1;
    if (x0 < 0 || y0 < 0 || x1 >= p->width || y1 >= p->height) return false;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            add_pixel(ring, picture_plane(p, plane), mask, box, (const int[3]){x, y, p->width});
    const Ring *near = &ring[1], *far = &ring[2];
    if (near->count < 20 || far->count < 20 || !(variance_of(near) > 0 && variance_of(far) > 0) ||
        !(near->step_square > 0 && far->step_square > 0))
        return false;
    feature[0] = (near->sum / near->count - far->sum / far->count) / sqrt(variance_of(far));
    feature[1] = log(variance_of(near) / variance_of(far));
    feature[2] = log(near->step_square / near->steps / (far->step_square / far->steps));
    return true;
}

static void note_rings(WoodsRings *rings, int v, const Shots *s, const uint8_t *mask)
{
    for (int k = 0; k < woods_sites_used(s->frame[1][0].w); k++) {
        const TargetPixels *target = &picture_of(s, 1, 0)->target[k];
        const int           site = v * woods_sites + k;
        bool                known = target->projected;
        for (int n = 0; n < 4 * woods_bands && known; n++) {
            const int crowded = n / 2 % 2, detail = n % 2, band = n / 4;
            known = features_of(&rings->feature[site][crowded][detail][3 * band], picture_of(s, crowded, detail),
                                woods_band_plane[band], mask, target->projected_box);
        }
        rings->known[site] = known;
    }
}

Status woods_alarms(WoodsCrowd *crowd, WoodsRings *rings)
{
    WoodsBench   *w = crowd->w;
    RenderRequest request = woods_request(w, crowd->v, 1);
    Shots         s;
    Arena        *arena[4] = {NULL};
    Status        status = STATUS_OK;
    request.bands &= three_bands;
    arena_reset(w->arena[0]);
    bench_progress(w->bench, "recognisers");
    for (int k = 0; k < 4 && status == STATUS_OK; k++) {
        WoodsFrame *f = &s.frame[k / 2][k % 2];
        if (!(arena[k] = arena_create())) status = STATUS_NO_MEMORY;
        if (status != STATUS_OK) break;
        *f = woods_frame(w, k % 2, &request, w->many, arena[k]);
        f->scene = k / 2 ? &crowd->scene : NULL;
        woods_render(f);
        status = f->frame.status;
    }
    const uint8_t *mask[2] = {NULL, NULL};
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        if (!(mask[k] = mask_of(&s, k, w->arena[0]))) status = STATUS_NO_MEMORY;
    for (int b = 0; b < woods_bands && status == STATUS_OK; b++)
        status = count_alarms(w, crowd->v, &s, woods_band_plane[b], mask[0]);
    if (status == STATUS_OK) note_rings(rings, crowd->v, &s, mask[1]);
    for (int k = 0; k < 4; k++) arena_destroy(arena[k]);
    return status;
}

/* ---- the classifier ------------------------------------------------------------------------------- */

enum { samples_most = 2 * woods_views * woods_sites, site_groups = 30 };

/* One question put to the classifier. */
typedef struct Question {
    int     count, group[samples_most];
    double  feature[samples_most][woods_ring_features], score[samples_most];
    uint8_t label[samples_most], fold[samples_most];
} Question;

/* Samples of a site are of one fold and one group. */
static void add_sample(Question *q, const double *feature, bool label, int site)
{
    const int i = q->count++;
    memcpy(q->feature[i], feature, sizeof q->feature[i]);
    q->label[i] = label, q->fold[i] = (uint8_t)(site % 2), q->group[i] = site % site_groups;
}

static void answer(Question *q)
{
    const LabelledSamples samples = {q->count, woods_ring_features, q->feature[0], q->label, q->fold};
    logistic_cross(q->score, &samples);
}

static double auc_off(const void *user, int without)
{
    const Question *q = user; /* [woods_details] */
    const double    judged = auc_of(q[1].score, q[1].label, q[1].group, q[1].count, without);
    return 100 * (judged / auc_of(q[0].score, q[0].label, q[0].group, q[0].count, without) - 1);
}

static double auc_alone(const void *user, int without)
{
    const Question *q = user;
    return auc_of(q->score, q->label, q->group, q->count, without);
}

Status woods_classify(WoodsBench *w, const WoodsRings *rings)
{
    Question *q = calloc(woods_details + 1, sizeof *q); /* is there a vehicle, in each detail; which detail is it */
    char      what[what_size], text[200];
    int       known = 0;
    if (!q) return STATUS_NO_MEMORY;
    for (int site = 0; site < woods_views * woods_sites; site++) {
        if (!rings->known[site]) continue;
        known++;
        for (int d = 0; d < woods_details; d++) {
            for (int k = 0; k < 2; k++) add_sample(&q[d], rings->feature[site][k][d], k, site);
            add_sample(&q[woods_details], rings->feature[site][0][d], d, site);
        }
    }
    for (int k = 0; k < woods_details + 1; k++) answer(&q[k]);
    const Estimate off = group_estimate(auc_off, q, site_groups), full = group_estimate(auc_alone, &q[0], site_groups),
                   judged = group_estimate(auc_alone, &q[1], site_groups);
    snprintf(what, sizeof what, "%s: vehicles by their surroundings: AUC", woods_detail[1]);
    snprintf(text, sizeof text, "logistic regression, target blanked, %d places; %.3f +- %.2g / %.3f +- %.2g", known,
             judged.value, judged.se, full.value, full.se);
    woods_judge(w, what, off, (WoodsLimit){10, "%", false}, text);
    snprintf(what, sizeof what, "%s: told from full detail: AUC", woods_detail[1]);
    woods_judge(w, what, group_estimate(auc_alone, &q[woods_details], site_groups), (WoodsLimit){NAN, "", false},
                "by the same features, places without vehicles; 0.5: cannot be told");
    free(q);
    return STATUS_OK;
}
