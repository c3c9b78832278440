/* entities/traces/ground_marks.c: three ring buffers of ground marks, and trails from points on them. */
#include "entities/traces/ground_marks_private.h"

#include <stdlib.h>

Status ground_history_create(GroundHistory **out)
{
    GroundHistory *history = calloc(1, sizeof *history);
    if (!history) return STATUS_NO_MEMORY;
    history->latest_s = -INFINITY;
    *out = history;
    return STATUS_OK;
}

void    ground_history_destroy(GroundHistory *history) { free(history); }
int64_t ground_history_forgotten(const GroundHistory *history) { return history->forgotten; }

/* ---- stands --------------------------------------------------------------------------------- */

bool ground_stand_same_place(const double p_ecef[3], const double r_ecef_from_body[9], const double q_ecef[3],
                             const double r_other[9])
{
    static const double near_m = 0.5, cos_5_deg = 0.99619469809174555;
    double              away[3], trace = 0;
    v3_sub(away, p_ecef, q_ecef);
    for (int i = 0; i < 9; i++) trace += r_ecef_from_body[i] * r_other[i]; /* trace of the rotation between the two */
    return v3_dot(away, away) <= near_m * near_m && 0.5 * (trace - 1) >= cos_5_deg;
}

uint64_t ground_stand_open(GroundHistory *h, const GroundStand *stand)
{
    const size_t at = h->stands % ground_stand_capacity;
    h->forgotten += h->stands >= ground_stand_capacity;
    h->stand[at] = *stand;
    h->owner[at] = stand->owner;
    h->latest_s = fmax(h->latest_s, stand->from_s);
    return ++h->stands;
}

static bool stand_is_kept(const GroundHistory *h, uint64_t handle)
{
    return handle != 0 && handle <= h->stands && h->stands - handle < ground_stand_capacity;
}

void ground_stand_until(GroundHistory *h, uint64_t handle, double to_s)
{
    if (!stand_is_kept(h, handle)) return;
    GroundStand *stand = &h->stand[(handle - 1) % ground_stand_capacity];
    stand->to_s = fmax(stand->from_s, to_s);
}

void ground_stand_blows(GroundHistory *h, uint64_t handle, const GroundBlow *blow)
{
    if (stand_is_kept(h, handle)) h->stand[(handle - 1) % ground_stand_capacity].blow = *blow;
}

uint64_t ground_stand_again(double *from_s, const GroundHistory *h, const GroundStand *stand, double since_s)
{
    uint64_t  found = 0; /* number of the latest entry with this owner */
    const int count = ring_count(h->stands, ground_stand_capacity);
    for (int at = 0; at < count; at++) {
        if (h->owner[at] != stand->owner) continue;
        const uint64_t newest = (h->stands - 1) % ground_stand_capacity;
        const uint64_t age = (newest + ground_stand_capacity - (uint64_t)at) % ground_stand_capacity;
        if (h->stands - age > found) found = h->stands - age;
    }
    if (found == 0) return 0;
    const GroundStand *was = &h->stand[(found - 1) % ground_stand_capacity];
    if (!(was->to_s >= since_s && was->from_s <= stand->to_s) ||
        !ground_stand_same_place(was->p_ecef, was->r_ecef_from_body, stand->p_ecef, stand->r_ecef_from_body))
        return 0;
    *from_s = was->from_s;
    return found;
}

/* ---- trails --------------------------------------------------------------------------------- */

static const double cos_1_deg = 0.99984769515639124, cos_3_deg = 0.99862953475457387;
static const double longest_piece_m = 50;
enum { most_divisions = 32 };

static void add_piece(GroundHistory *h, const GroundTrack *piece)
{
    h->forgotten += h->tracks >= ground_track_capacity;
    h->track[h->tracks++ % ground_track_capacity] = *piece;
    h->latest_s = fmax(h->latest_s, piece->a_s);
}

/* Extends the trail's last piece by this one, if it may be merged. */
static bool merge_piece(GroundHistory *h, const GroundTrail *trail, const GroundTrack *piece, double length_m)
{
    const uint64_t handle = trail->piece;
    if (handle == 0 || h->tracks - handle >= ground_track_capacity) return false;
    GroundTrack *was = &h->track[(handle - 1) % ground_track_capacity];
    double       along[3], next[3];
    v3_sub(along, was->b_ecef, was->a_ecef);
    v3_sub(next, piece->b_ecef, piece->a_ecef);
    const double was_m = v3_length(along), was_mps = was_m / (was->b_s - was->a_s);
    const double mps = length_m / (piece->b_s - piece->a_s);
    if (!(was_m + length_m <= longest_piece_m) || !(v3_dot(along, next) >= cos_1_deg * was_m * length_m) ||
        !(fabs(mps - was_mps) <= 0.1 * was_mps))
        return false;
    memcpy(was->b_ecef, piece->b_ecef, sizeof was->b_ecef);
    was->b_s = piece->b_s;
    return true;
}

static void begin_again(GroundTrail *trail, const double p_ecef[3], double t_s)
{
    memcpy(trail->p_ecef, p_ecef, sizeof trail->p_ecef);
    trail->t_s = t_s;
    trail->has_course = false;
    trail->piece = 0;
}

/* Whether a vehicle can have driven there in dt_s. 10 m: the correction of an extrapolation. */
static bool is_driven(const GroundTrail *trail, const double way_m[3], double length_m, double dt_s)
{
    static const double fastest_mps = 60, correction_m = 10, margin = 1.5;
    const double        rise_m = v3_dot(way_m, trail->p_ecef) / v3_length(trail->p_ecef);
    return dt_s > 0 && length_m <= fmin(fastest_mps * dt_s, ground_track_longest_m) &&
           length_m <= correction_m + margin * trail->speed_mps * dt_s && fabs(rise_m) <= 0.71 * length_m;
}

/* Makes the next piece of a trail, from its end. Returns false when it is not due yet. */
static bool next_piece(GroundTrack *piece, double *length_m, GroundTrail *trail, const double p_ecef[3], double t_s,
                       bool last)
{
    static const double least_m = 1, least_last_m = 0.5, often_m = 4;
    double              way[3];
    v3_sub(way, p_ecef, trail->p_ecef);
    *length_m = v3_length(way);
    if (!trail->on || !isfinite(*length_m) || *length_m < (last ? least_last_m : least_m)) return false;
    const bool turned = !trail->has_course || v3_dot(way, trail->course_ecef) < cos_3_deg * *length_m;
    if (!last && !turned && *length_m < often_m) return false;
    if (!is_driven(trail, way, *length_m, t_s - trail->t_s)) {
        begin_again(trail, p_ecef, t_s);
        return false;
    }
    *piece = trail->shape;
    memcpy(piece->a_ecef, trail->p_ecef, sizeof piece->a_ecef);
    memcpy(piece->b_ecef, p_ecef, sizeof piece->b_ecef);
    piece->a_s = trail->t_s;
    piece->b_s = t_s;
    memcpy(trail->p_ecef, p_ecef, sizeof trail->p_ecef);
    trail->t_s = t_s;
    v3_scale(trail->course_ecef, 1 / *length_m, way);
    trail->has_course = true;
    return true;
}

void ground_trail_point(GroundHistory *h, GroundTrail *trail, const double p_ecef[3], double t_s, bool last)
{
    GroundTrack piece;
    double      length_m;
    if (!next_piece(&piece, &length_m, trail, p_ecef, t_s, last)) return;
    if (merge_piece(h, trail, &piece, length_m)) return;

    const int   parts = (int)clamp(ceil(length_m / longest_piece_m), 1, most_divisions);
    GroundTrack part = piece;
    for (int i = 1; i <= parts; i++) {
        const double share = (double)i / parts;
        for (int k = 0; k < 3; k++)
            part.b_ecef[k] =
                i < parts ? piece.a_ecef[k] + share * (piece.b_ecef[k] - piece.a_ecef[k]) : piece.b_ecef[k];
        part.b_s = i < parts ? piece.a_s + share * (piece.b_s - piece.a_s) : piece.b_s;
        add_piece(h, &part);
        memcpy(part.a_ecef, part.b_ecef, sizeof part.a_ecef);
        part.a_s = part.b_s;
    }
    trail->piece = h->tracks;
}

int ground_trail_tail(GroundTrack *out, GroundTrail *trail, const double p_ecef[3], double t_s, bool last)
{
    double length_m;
    return next_piece(out, &length_m, trail, p_ecef, t_s, last);
}

/* ---- burns ---------------------------------------------------------------------------------- */

void ground_burn(GroundHistory *h, const GroundBurn *burn)
{
    static const double same_s = 0.5; /* a burst repeated within this time is one PDU sent twice */
    const uint64_t      look = h->burns < 8 ? h->burns : 8;
    for (uint64_t i = 1; i <= look; i++) {
        const GroundBurn *was = &h->burn[(h->burns - i) % ground_burn_capacity];
        if (memcmp(was->p_ecef, burn->p_ecef, sizeof was->p_ecef) == 0 && fabs(was->t_s - burn->t_s) <= same_s) return;
    }
    h->forgotten += h->burns >= ground_burn_capacity;
    h->burn[h->burns++ % ground_burn_capacity] = *burn;
    h->latest_s = fmax(h->latest_s, burn->t_s);
}

/* ---- at one instant ------------------------------------------------------------------------- */

/* Copies a ring into an array, the oldest entry first. */
static void copy_ring(void *out, const void *ring, size_t record, uint64_t ever, int capacity)
{
    const size_t count = (size_t)ring_count(ever, capacity), first = (size_t)ring_first(ever, capacity);
    if (count == 0) return;
    memcpy(out, (const char *)ring + first * record, (count - first) * record);
    if (first > 0) memcpy((char *)out + (count - first) * record, ring, first * record);
}

/* Leaves out marks that begin after t_s, which exist only when t_s is before the last PDU, or marks were loaded from a
 * later time. */
static void leave_out_later(GroundMarks *m, GroundStand *stand, GroundTrack *track, GroundBurn *burn, double t_s)
{
    int kept = 0;
    for (int i = 0; i < m->stands; i++)
        if (stand[i].from_s <= t_s) stand[kept++] = stand[i];
    m->stands = kept, kept = 0;
    for (int i = 0; i < m->tracks; i++)
        if (track[i].a_s <= t_s) track[kept++] = track[i];
    m->tracks = kept, kept = 0;
    for (int i = 0; i < m->burns; i++)
        if (burn[i].t_s <= t_s) burn[kept++] = burn[i];
    m->burns = kept;
}

Status ground_marks_at(GroundMarks *out, GroundTrack **tail, const GroundHistory *h, double t_s, int tail_capacity,
                       Arena *arena)
{
    GroundMarks  m = {.stands = ring_count(h->stands, ground_stand_capacity),
                      .tracks = ring_count(h->tracks, ground_track_capacity),
                      .burns = ring_count(h->burns, ground_burn_capacity),
                      .forgotten = h->forgotten};
    const size_t tracks = (size_t)m.tracks + (size_t)tail_capacity;
    GroundStand *stand = m.stands ? arena_alloc(arena, (size_t)m.stands, sizeof *stand) : NULL;
    GroundTrack *track = tracks ? arena_alloc(arena, tracks, sizeof *track) : NULL;
    GroundBurn  *burn = m.burns ? arena_alloc(arena, (size_t)m.burns, sizeof *burn) : NULL;
    if ((m.stands && !stand) || (tracks && !track) || (m.burns && !burn)) return STATUS_NO_MEMORY;

    copy_ring(stand, h->stand, sizeof *stand, h->stands, ground_stand_capacity);
    copy_ring(track, h->track, sizeof *track, h->tracks, ground_track_capacity);
    copy_ring(burn, h->burn, sizeof *burn, h->burns, ground_burn_capacity);
    if (h->latest_s > t_s) leave_out_later(&m, stand, track, burn, t_s);
    for (int i = 0; i < m.stands; i++)
        if (stand[i].to_s > t_s) stand[i].to_s = INFINITY;
    m.stand = stand, m.track = track, m.burn = burn;
    *out = m;
    *tail = track ? track + m.tracks : NULL;
    return STATUS_OK;
}
