/* render/heat/mark_heat.c: the heat that vehicles leave on the ground: where they stood, drove and burnt (heat.h). */
#include "render/heat/heat.h"

#include "render/heat/stand_heat_private.h"
#include "render/heat/vehicle_load_private.h"
#include "render/heat/surface_flux_private.h"

static const double cell_m = 32, least_sun = 0.1; /* lower suns cast no lasting shadow */
static const double touches_m = 1.5;              /* of a mark's height over the ground that it belongs to */

typedef struct Stand {
    StandBox       box;
    double         reach_m;
    double         blow_from_s, blow_to_s;
    const JetPath *jet; /* NULL: none reaches the ground */
} Stand;
typedef struct Track {
    double a_enu[3], d[2], length_m, a_s, b_s, width_m, apart_m, heat_j_m2, loose;
} Track;
typedef struct Burn {
    double p_enu[3], t_s, radius_m, crater_m, heat_j_m2;
} Burn;

/* A mark in a cell: chained by the hash of its cell, in the order of marks. */
typedef struct Entry {
    int32_t x, y, mark, next; /* mark: stands, then tracks, then burns */
} Entry;

enum { most_entries = 1 << 20 };

struct MarkHeat {
    const HeatNow *now;
    double         unix_s, sun_scale[ground_kinds], sky_scale[ground_kinds];
    int            stands, tracks, burns;
    Stand         *stand;
    Track         *track;
    Burn          *burn;
    int            buckets, entries, capacity;
    int32_t       *bucket;
    Entry         *entry;
};

/* ---- index ------------------------------------------------------------------------------------- */

static uint32_t bucket_of(const MarkHeat *m, int32_t x, int32_t y)
{
    const uint32_t h = (uint32_t)x * 0x9E3779B1u ^ (uint32_t)y * 0x85EBCA77u;
    return (h ^ h >> 15) & (uint32_t)(m->buckets - 1);
}

static void put(MarkHeat *m, int mark, int32_t x, int32_t y)
{
    if (m->entries == m->capacity) return;
    const uint32_t b = bucket_of(m, x, y);
    m->entry[m->entries] = (Entry){x, y, mark, m->bucket[b]};
    m->bucket[b] = m->entries++;
}

/* Cells of a square about a place. */
static void put_square(MarkHeat *m, int mark, const double p_enu[3], double reach_m)
{
    const int32_t x0 = (int32_t)floor((p_enu[0] - reach_m) / cell_m),
                  x1 = (int32_t)floor((p_enu[0] + reach_m) / cell_m);
    const int32_t y0 = (int32_t)floor((p_enu[1] - reach_m) / cell_m),
                  y1 = (int32_t)floor((p_enu[1] + reach_m) / cell_m);
    for (int32_t y = y0; y <= y1; y++)
        for (int32_t x = x0; x <= x1; x++) put(m, mark, x, y);
}

/* Cells that a trail's piece, with its width, may touch: those about points along it. */
static void put_line(MarkHeat *m, int mark, const Track *t)
{
    const double wide_m = 0.5 * (t->apart_m + t->width_m);
    int32_t      last[4][2] = {{INT32_MIN, 0}, {INT32_MIN, 0}, {INT32_MIN, 0}, {INT32_MIN, 0}};
    for (double at_m = 0;; at_m += 4) {
        const double along_m = fmin(at_m, t->length_m);
        for (int k = 0; k < 4; k++) {
            const double  x = t->a_enu[0] + along_m * t->d[0] + (k & 1 ? wide_m + 4 : -wide_m - 4);
            const double  y = t->a_enu[1] + along_m * t->d[1] + (k & 2 ? wide_m + 4 : -wide_m - 4);
            const int32_t cx = (int32_t)floor(x / cell_m), cy = (int32_t)floor(y / cell_m);
            bool          known = false;
            for (int o = 0; o < 4; o++) known |= last[o][0] == cx && last[o][1] == cy;
            if (!known) put(m, mark, cx, cy);
            last[k][0] = cx, last[k][1] = cy;
        }
        if (at_m >= t->length_m) break;
    }
}

/* Follows the exhaust of a standing vehicle, and keeps it where it comes near the ground. */
static Status blow_of(Stand *out, const GroundBlow *b, double air_k, double exercise_s, Arena *arena)
{
    static const double still[3] = {0};
    const ExhaustJet    jet = {
           .radius_m = (double)b->radius_m, .speed_mps = (double)b->speed_mps, .excess_k = (double)b->excess_k};
    double at_enu[3], d_enu[3] = {0};
    if (!(b->to_s > b->from_s) || !(jet.radius_m > 0 && jet.speed_mps > 0 && jet.excess_k > 0)) return STATUS_OK;
    const double *p_enu = out->box.p_enu;
    memcpy(at_enu, p_enu, sizeof at_enu);
    for (int a = 0; a < 3; a++) {
        v3_add_scaled(at_enu, at_enu, (double)b->at_m[a], out->box.axis[a]);
        v3_add_scaled(d_enu, d_enu, (double)b->d[a], out->box.axis[a]);
    }
    if (!v3_normalize(d_enu, d_enu)) return STATUS_OK;
    JetPath found;
    jet_path(&found, &jet, at_enu, d_enu, still, air_k);
    if (found.count < 2 || found.box.low_m[2] > p_enu[2] + touches_m) return STATUS_OK;
    JetPath *path = arena_alloc(arena, 1, sizeof *path);
    if (!path) return STATUS_NO_MEMORY;
    *path = found;
    out->jet = path;
    out->blow_from_s = exercise_s + b->from_s, out->blow_to_s = exercise_s + b->to_s;
    for (int k = 0; k < 2; k++)
        out->reach_m = fmax(out->reach_m, fmax(path->box.high_m[k] - p_enu[k], p_enu[k] - path->box.low_m[k]));
    return STATUS_OK;
}

/* Within what a float's cell can count; hostile places are left out. */
static bool near_enough(const double p_enu[3])
{
    return fabs(p_enu[0]) < 5e5 && fabs(p_enu[1]) < 5e5 && fabs(p_enu[2]) < 5e4;
}

static Status take_stand(MarkHeat *m, const GroundStand *s, const LocalFrame *frame, double exercise_s, Arena *arena)
{
    Stand    *out = &m->stand[m->stands];
    StandBox *box = &out->box;
    enu_from_ecef(box->p_enu, frame, s->p_ecef);
    for (int a = 0; a < 3; a++) {
        double axis_ecef[3];
        for (int k = 0; k < 3; k++) axis_ecef[k] = s->r_ecef_from_body[3 * k + a];
        m3_tmul_v3(box->axis[a], frame->r_ecef_from_enu, axis_ecef);
        box->low_m[a] = (double)s->low_m[a], box->high_m[a] = (double)s->high_m[a];
    }
    const double high_m = fmin(fmax(-box->low_m[2], 0), 40);
    box->from_s = exercise_s + s->from_s, box->to_s = exercise_s + s->to_s;
    out->reach_m =
        fmin(0.5 * hypot(box->high_m[0] - box->low_m[0], box->high_m[1] - box->low_m[1]) + high_m / least_sun, 120);
    out->jet = NULL;
    if (!near_enough(box->p_enu)) return STATUS_OK;
    const Status status = blow_of(out, &s->blow, m->now->table.air_k, exercise_s, arena);
    if (out->reach_m > 0) put_square(m, m->stands++, box->p_enu, fmin(out->reach_m, 120));
    return status;
}

static void take_track(MarkHeat *m, const GroundTrack *t, const LocalFrame *frame, double exercise_s)
{
    Track *out = &m->track[m->tracks];
    double b_enu[3];
    enu_from_ecef(out->a_enu, frame, t->a_ecef);
    enu_from_ecef(b_enu, frame, t->b_ecef);
    out->length_m = hypot(b_enu[0] - out->a_enu[0], b_enu[1] - out->a_enu[1]);
    if (!near_enough(out->a_enu) || !near_enough(b_enu) || !(out->length_m > 1e-3)) return;
    for (int k = 0; k < 2; k++) out->d[k] = (b_enu[k] - out->a_enu[k]) / out->length_m;
    out->a_s = exercise_s + t->a_s, out->b_s = exercise_s + t->b_s;
    out->width_m = (double)t->width_m, out->apart_m = (double)t->apart_m, out->heat_j_m2 = (double)t->heat_j_m2;
    out->loose = t->tracked ? 0.6 : 0.3;
    put_line(m, m->stands + m->tracks++, out);
}

static void take_burn(MarkHeat *m, const GroundBurn *b, const LocalFrame *frame, double exercise_s)
{
    Burn *out = &m->burn[m->burns];
    enu_from_ecef(out->p_enu, frame, b->p_ecef);
    *out = (Burn){{out->p_enu[0], out->p_enu[1], out->p_enu[2]},
                  exercise_s + b->t_s,
                  fmin((double)b->radius_m, 100),
                  (double)b->crater_m,
                  (double)b->heat_j_m2};
    if (near_enough(out->p_enu)) put_square(m, m->stands + m->tracks + m->burns++, out->p_enu, out->radius_m);
}

Status heat_marks_create(MarkHeat **out, const GroundMarks *marks, const LocalFrame *frame, double exercise_s,
                         double unix_s, const HeatNow *now, Arena *arena)
{
    const int64_t all = (int64_t)marks->stands + marks->tracks + marks->burns;
    *out = NULL;
    if (all == 0) return STATUS_OK;
    MarkHeat *m = arena_alloc(arena, 1, sizeof *m);
    if (!m) return STATUS_NO_MEMORY;
    *m = (MarkHeat){.now = now, .unix_s = unix_s, .buckets = 1024};
    for (int k = 1; k < ground_kinds; k++) heat_scales(&m->sun_scale[k], &m->sky_scale[k], now, k);
    while (m->buckets < all && m->buckets < 1 << 17) m->buckets *= 2;
    const int64_t room = 96 * (int64_t)marks->stands + 8 * (int64_t)marks->tracks + 64 * (int64_t)marks->burns + 4096;
    m->capacity = (int)(room < most_entries ? room : most_entries);
    m->stand = arena_alloc(arena, (size_t)marks->stands + 1, sizeof *m->stand);
    m->track = arena_alloc(arena, (size_t)marks->tracks + 1, sizeof *m->track);
    m->burn = arena_alloc(arena, (size_t)marks->burns + 1, sizeof *m->burn);
    m->bucket = arena_alloc(arena, (size_t)m->buckets, sizeof *m->bucket);
    m->entry = arena_alloc(arena, (size_t)m->capacity, sizeof *m->entry);
    if (!m->stand || !m->track || !m->burn || !m->bucket || !m->entry) return STATUS_NO_MEMORY;
    for (int b = 0; b < m->buckets; b++) m->bucket[b] = -1;
    for (int i = 0; i < marks->stands; i++) {
        const Status status = take_stand(m, &marks->stand[i], frame, exercise_s, arena);
        if (status != STATUS_OK) return status;
    }
    for (int i = 0; i < marks->tracks; i++) take_track(m, &marks->track[i], frame, exercise_s);
    for (int i = 0; i < marks->burns; i++) take_burn(m, &marks->burn[i], frame, exercise_s);
    *out = m;
    return STATUS_OK;
}

/* ---- heat -------------------------------------------------------------------------------------- */

/* Kelvins that the stand's exhaust gave the ground, by one time of the grid. */
static double blow_k(const Stand *s, const HeatPast *p, int kind, double excess_k, double speed_mps)
{
    const double film = plate_film_w_m2k(speed_mps) - plate_film_w_m2k(0); /* the kind has its own of free air */
    const double newest_s = p->count > 0 ? p->unix_s[0] + 0.5 * p->span_s[0] : 0;
    const double lasted_s = fmin(s->blow_to_s, newest_s) - s->blow_from_s;
    double       now_k = 0, ended_k = 0; /* for 1 W/m2: now; when it ended, or now */
    for (int i = 0; i < p->count; i++) {
        const double begin_s = p->unix_s[i] - 0.5 * p->span_s[i], end_s = begin_s + p->span_s[i],
                     k = (double)p->watt_k[kind][i];
        now_k += k * fmax(fmin(end_s, s->blow_to_s) - fmax(begin_s, s->blow_from_s), 0) / p->span_s[i];
        ended_k += k * fmax(end_s - fmax(begin_s, newest_s - lasted_s), 0) / p->span_s[i];
    }
    return film * excess_k * now_k / (1 + film * ended_k);
}

/* Kelvins that a pulse of heat, age_s ago, still makes. Within the newest interval: of a body without end. */
static double pulse_k(const HeatPast *p, int kind, double heat_j_m2, double age_s)
{
    if (p->count == 0 || !(age_s > 0)) return 0;
    const double newest_s = p->unix_s[0] + 0.5 * p->span_s[0], half_s = 0.5 * p->span_s[0];
    if (age_s < half_s) return heat_j_m2 / ((double)p->effusivity[kind] * sqrt(pi_rad * fmax(age_s, 1)));
    for (int i = 0; i < p->count; i++) {
        const double at_s = newest_s - p->unix_s[i], next_s = i + 1 < p->count ? newest_s - p->unix_s[i + 1] : INFINITY;
        if (age_s >= next_s) continue;
        const double k = (double)p->watt_k[kind][i] / p->span_s[i];
        const double l = i + 1 < p->count ? (double)p->watt_k[kind][i + 1] / p->span_s[i + 1] : 0;
        const double share = isfinite(next_s) ? clamp((age_s - at_s) / (next_s - at_s), 0, 1) : 0;
        return heat_j_m2 * (k + share * (l - k));
    }
    return 0;
}

static void add_track(MarkedGround *out, const MarkHeat *m, const Track *t, int kind, const double p_enu[3])
{
    const double x = p_enu[0] - t->a_enu[0], y = p_enu[1] - t->a_enu[1];
    const double along_m = x * t->d[0] + y * t->d[1], across_m = fabs(x * t->d[1] - y * t->d[0]);
    if (along_m < 0 || along_m > t->length_m || fabs(across_m - 0.5 * t->apart_m) > 0.5 * t->width_m) return;
    if (fabs(p_enu[2] - t->a_enu[2]) > touches_m + 0.5 * t->length_m) return;
    /* what grows there is pressed into the soil that takes the heat */
    const int warmed = ground_kind_loosens(kind) ? SURFACE_PLOUGHED : kind;
    out->add_k +=
        pulse_k(&m->now->past[1], warmed, t->heat_j_m2, m->unix_s - t->a_s - along_m / t->length_m * (t->b_s - t->a_s));
    out->loose = fmax(out->loose, t->loose);
}

static void add_burn(MarkedGround *out, const MarkHeat *m, const Burn *b, const double p_enu[3])
{
    const double r = hypot(p_enu[0] - b->p_enu[0], p_enu[1] - b->p_enu[1]) / fmax(b->radius_m, 1e-3);
    if (r >= 1) return;
    const double share = 1 - r * r * r * r;
    if (r * b->radius_m < b->crater_m) out->loose = 1; /* bare soil, thrown up */
    else out->burnt = fmax(out->burnt, share);
    out->add_k += share * pulse_k(&m->now->past[1], SURFACE_PLOUGHED, b->heat_j_m2, m->unix_s - b->t_s);
}

bool heat_marks_at(MarkedGround *out, const MarkHeat *m, int kind, const double p_enu[3], const double n_enu[3],
                   double lit)
{
    const int32_t x = (int32_t)floor(p_enu[0] / cell_m), y = (int32_t)floor(p_enu[1] / cell_m);
    const double  from_enu[3] = {p_enu[0] + 0.02 * n_enu[0], p_enu[1] + 0.02 * n_enu[1], p_enu[2] + 0.02 * n_enu[2]};
    bool          any = false;
    *out = (MarkedGround){0};
    for (int32_t e = m->bucket[bucket_of(m, x, y)]; e >= 0; e = m->entry[e].next) {
        const Entry *at = &m->entry[e];
        if (at->x != x || at->y != y) continue;
        any = true;
        if (at->mark < m->stands) {
            const Stand *s = &m->stand[at->mark];
            if (hypot(p_enu[0] - s->box.p_enu[0], p_enu[1] - s->box.p_enu[1]) > s->reach_m) continue;
            double excess_k, speed_mps;
            out->add_k -= stand_taken_k(&s->box, m->now, m->unix_s, kind, from_enu, n_enu, lit, m->sun_scale[kind],
                                        m->sky_scale[kind]);
            if (!s->jet || !jet_path_at(&excess_k, &speed_mps, NULL, s->jet, p_enu, true)) continue;
            const double blew_k = blow_k(s, &m->now->past[0], kind, excess_k, speed_mps);
            out->add_k += blew_k + m->now->share * (blow_k(s, &m->now->past[1], kind, excess_k, speed_mps) - blew_k);
        } else if (at->mark < m->stands + m->tracks) {
            add_track(out, m, &m->track[at->mark - m->stands], kind, p_enu);
        } else {
            add_burn(out, m, &m->burn[at->mark - m->stands - m->tracks], p_enu);
        }
    }
    return any;
}
