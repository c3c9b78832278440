/* sensor/node/choices/ground_evidence.c: what the reports of an exercise imply about its ground and its sea. */
#include "sensor/node/choices/ground_evidence_private.h"

#include "dis/pdu/pdu.h"
#include "entities/table/contact.h"
#include "sensor/node/choices/choices.h"

#include <stdlib.h>

typedef struct Gathering {
    GroundEvidence   *e;
    const Survey     *survey;
    const LocalFrame *frame;
    const Catalog    *catalog;
    int               voters, step; /* step: one report in so many is kept */
    int               unnamed;      /* hits whose entity was looked for */
} Gathering;

/* Reports that are kept as evidence; of a longer log every second, third ... one. */
enum { most_evidence = 1 << 19 };

/* Positions far outside of the landscape are not used. */
static const double evidence_reach_m = 60000;

/* ---- one entity --------------------------------------------------------------------------- */

void ground_evidence_base(double base_ecef[3], const TrackPoint *point, double below_m)
{
    double r[9];
    survey_point_rotation(r, point);
    for (int k = 0; k < 3; k++) /* third column: body z, down */
        base_ecef[k] = point->p_ecef[k] + below_m * r[3 * k + 2];
}

static const Model *model_of(const Gathering *g, const Track *track, Origin *origin)
{
    return catalog_model(g->catalog, catalog_find(g->catalog, track->type, origin, NULL));
}

/* Whether an aircraft can hover: rotorcraft, and unmanned aircraft, which may be such. */
static bool may_hover(DisEntityType type)
{
    const int c = type.category;
    return (c >= 20 && c <= 26) || (c >= 90 && c <= 92) || (c >= 50 && c < 60) || c >= 100 || c == 0;
}

static bool is_mine(DisEntityType type)
{
    enum { anti_ship = 6, antisubmarine = 7 };
    return type.kind == dis_kind_munition && type.category == dis_munition_fixed && type.domain != anti_ship &&
           type.domain != antisubmarine;
}

static bool is_aircraft(DisEntityType type) { return type.kind == dis_kind_platform && type.domain == dis_domain_air; }

/* Whether it is carried or falling, as in entities/table/contact.h. */
static bool goes_through_the_air(const Track *track, const TrackPoint *point)
{
    double up[3], v = v3_length(point->v_ecef_mps);
    if (!v3_normalize(up, point->p_ecef)) return true;
    const double v_up = v3_dot(point->v_ecef_mps, up);
    return v > (track->type.kind == dis_kind_platform ? 60 : 12) ||
           v_up < -fmax(2, 0.5 * sqrt(fmax(v * v - v_up * v_up, 0)));
}

static double height_m(const double p_ecef[3])
{
    Geodetic place;
    return geodetic_from_ecef(&place, p_ecef) == STATUS_OK ? place.h_m : NAN;
}

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* ---- aircraft that have landed ------------------------------------------------------------ */

static double apart_m(const TrackPoint *a, const TrackPoint *b)
{
    double d[3];
    v3_sub(d, a->p_ecef, b->p_ecef);
    return v3_length(d);
}

/* The end of the run of reports from `from` on that are all at one position, not moving and not frozen. */
static int still_until(const Track *track, int from)
{
    static const double same_m = 0.005, same_mps = 0.05;
    int                 n = from;
    for (; n < track->count; n++) {
        const TrackPoint *p = &track->point[n];
        if (p->frozen || v3_length(p->v_ecef_mps) > same_mps || apart_m(p, &track->point[from]) > same_m) break;
    }
    return n;
}

/* Whether any aircraft of this sender ever reports a running engine. If so, one that does not is parked. Tracks are
 * sorted by id, so those of a sender are contiguous. */
static bool says_engines(const Survey *survey, const bool *runs, int t)
{
    const DisEntityId id = survey->track[t].id;
    for (int way = -1; way <= 1; way += 2)
        for (int k = t; k >= 0 && k < survey->track_count; k += way) {
            if (survey->track[k].id.site != id.site || survey->track[k].id.application != id.application) break;
            if (runs[k]) return true;
        }
    return false;
}

/* Finds which aircraft ever report a running engine: [track_count]. */
static void find_running(bool *runs, const Survey *survey)
{
    for (int t = 0; t < survey->track_count; t++)
        for (int n = 0; is_aircraft(survey->track[t].type) && n < survey->track[t].count && !runs[t]; n++)
            runs[t] = survey->track[t].point[n].engine;
}

typedef struct Still {
    int    track, first, end;
    bool   engine_off;
    double p_enu[3];
} Still;

/* Finds runs of reports of stationary aircraft, at most `most`. */
static int find_still(Still *out, int most, const Gathering *g)
{
    static const double least_s = 5;
    int                 count = 0;
    for (int t = 0; t < g->survey->track_count; t++) {
        const Track *track = &g->survey->track[t];
        for (int n = 0, end; is_aircraft(track->type) && n < track->count && count<most; n = end> n ? end : n + 1) {
            end = still_until(track, n);
            if (end < n + 2 || track->point[end - 1].t_s - track->point[n].t_s < least_s) continue;
            Still s = {.track = t, .first = n, .end = end, .engine_off = true};
            for (int k = n; k < end; k++) s.engine_off &= !track->point[k].engine;
            double base_ecef[3];
            ground_evidence_base(base_ecef, &track->point[n], g->e->below_m[t]);
            enu_from_ecef(s.p_enu, g->frame, base_ecef);
            out[count++] = s;
        }
    }
    return count;
}

static void add_voter(Gathering *g, int t, bool landed);

/* Judges aircraft on the ground, which give fixes as others do. Called after the others, whose fixes it uses. */
static Status judge_landed(Gathering *g)
{
    enum { most = 4096 };
    static const double step_m = 1, slope = 0.05; /* largest distance of a landed aircraft from the plane of its
                                                   * neighbours */
    Still *still = calloc(most, sizeof *still);
    double(*place)[3] = calloc(most, sizeof *place), *above_m = calloc(2 * most, sizeof *above_m);
    bool  *runs = calloc((size_t)g->survey->track_count + 1, sizeof *runs);
    Status status = still && place && above_m && runs ? STATUS_OK : STATUS_NO_MEMORY;
    int    count = 0;
    if (status == STATUS_OK) {
        find_running(runs, g->survey);
        count = find_still(still, most, g);
    }
    for (int n = 0; n < count; n++) memcpy(place[n], still[n].p_enu, sizeof place[n]);
    if (count)
        status = invented_consensus_height(above_m, above_m + most, (const double(*)[3])place, count, g->e->fix,
                                           g->e->said.fix_count);
    for (int n = 0; status == STATUS_OK && n < count; n++) {
        const Track *track = &g->survey->track[still[n].track];
        const bool   beside = fabs(above_m[n]) <= step_m + slope * above_m[most + n]; /* NaN: no */
        const bool   off = still[n].engine_off && says_engines(g->survey, runs, still[n].track);
        if (may_hover(track->type) && !beside && !off) continue;
        for (int k = still[n].first; k < still[n].end; k++) g->e->fixed[g->e->first[still[n].track] + (size_t)k] = true;
        g->e->stance[still[n].track] = STANCE_LANDED;
    }
    for (int t = 0; status == STATUS_OK && t < g->survey->track_count; t++)
        if (g->e->stance[t] == STANCE_LANDED) add_voter(g, t, true);
    free(still);
    free(place);
    free(above_m);
    free(runs);
    return status;
}

/* ---- fixes and lines ---------------------------------------------------------------------- */

static bool add_fix(Gathering *g, const double p_ecef[3], int voter, bool keep)
{
    GroundFix fix = {.voter = voter};
    enu_from_ecef(fix.p_enu, g->frame, p_ecef);
    if (!(hypot(fix.p_enu[0], fix.p_enu[1]) < evidence_reach_m)) return false;
    if (keep) g->e->fix[g->e->said.fix_count++] = fix;
    return true;
}

static void add_line(Gathering *g, const double a_ecef[3], const double b_ecef[3])
{
    ClearLine line;
    double    d[3];
    enu_from_ecef(line.a_enu, g->frame, a_ecef);
    enu_from_ecef(line.b_enu, g->frame, b_ecef);
    v3_sub(d, line.b_enu, line.a_enu);
    if (v3_length(d) < evidence_reach_m && hypot(line.a_enu[0], line.a_enu[1]) < evidence_reach_m)
        g->e->line[g->e->said.line_count++] = line;
}

static void add_place(Gathering *g, const double p_ecef[3], bool sea)
{
    double p_enu[3];
    enu_from_ecef(p_enu, g->frame, p_ecef);
    if (hypot(p_enu[0], p_enu[1]) < 2 * evidence_reach_m)
        g->e->place[g->e->said.place_count++] = (CoastPlace){p_enu[0], p_enu[1], sea};
}

/* An entity's base at its reports; landed: at the marked ones. Dry land is along its path, every 10 m. */
static void add_voter(Gathering *g, int t, bool landed)
{
    static const double step_m = 10;
    const Track        *track = &g->survey->track[t];
    const TrackPoint   *last = NULL;
    bool                any = false;
    for (int n = 0; n < track->count; n++) {
        const TrackPoint *point = &track->point[n];
        bool             *fixed = &g->e->fixed[g->e->first[t] + (size_t)n];
        double            base_ecef[3];
        if (landed ? !*fixed : goes_through_the_air(track, point)) continue;
        ground_evidence_base(base_ecef, point, g->e->below_m[t]);
        if (!add_fix(g, base_ecef, g->voters + 1, n % g->step == 0)) continue;
        *fixed = any = true;
        if (last && apart_m(point, last) < step_m) continue;
        add_place(g, base_ecef, false);
        last = point;
    }
    g->voters += any;
}

/* What a shot hit; NULL: nothing is known of it. Only some hits are looked up by place, each of which takes a walk over
 * all entities. */
static const Track *hit_of(Gathering *g, const Shot *shot)
{
    enum { most_looked_up = 256 };
    const Track *hit = survey_track(g->survey, shot->hit);
    if (hit || shot->result != dis_result_entity_impact) return hit;
    hit = survey_track(g->survey, shot->target);
    if (hit || !isfinite(shot->detonation_s) || g->unnamed == most_looked_up) return hit;
    g->unnamed++;
    return survey_track(g->survey,
                        choice_nearest_entity(g->survey, shot->p_burst_ecef, shot->detonation_s, shot->munition));
}

static void add_flight(Gathering *g, int t)
{
    const Survey *survey = g->survey;
    const Track  *track = &survey->track[t];
    const Shot   *shot = track->type.kind == dis_kind_munition ? survey_shot(survey, track->id) : NULL;
    const Track  *target = shot ? hit_of(g, shot) : NULL;
    const bool   *fixed = g->e->fixed + g->e->first[t];
    for (int i = 0, next; i + 1 < track->count; i = next) {
        next = i + g->step < track->count ? i + g->step : track->count - 1;
        if (!(fixed[i] && fixed[next])) add_line(g, track->point[i].p_ecef, track->point[next].p_ecef);
    }
    /* a shot that hit had a clear line of sight to its target */
    for (int i = 0; target && i < track->count; i += g->step) {
        TrackPose pose;
        double    centre_ecef[3];
        survey_track_at(&pose, target, track->point[i].t_s);
        for (int k = 0; k < 3; k++) centre_ecef[k] = pose.p_ecef[k] - pose.r_ecef_from_body[3 * k + 2];
        add_line(g, track->point[i].p_ecef, centre_ecef);
    }
}

/* Bursts on the ground: those of one firing entity count as one source. At sea level they are no evidence of dry
 * land. */
static Status add_impacts(Gathering *g)
{
    static const double wave_m = 3;
    const Survey       *survey = g->survey;
    int                *voter = calloc((size_t)survey->track_count + 1, sizeof *voter);
    if (!voter) return STATUS_NO_MEMORY;
    const bool sea = g->e->count[STANCE_AFLOAT] + g->e->count[STANCE_SUBMERGED] > 0;
    for (int i = 0; i < survey->shot_count; i++) {
        const Shot *shot = &survey->shot[i];
        if (shot->result != dis_result_ground_impact || !isfinite(shot->detonation_s)) continue;
        const Track *shooter = survey_track(survey, shot->firing);
        int         *mine = &voter[shooter ? shooter - survey->track : survey->track_count];
        g->e->impacts++;
        if (!add_fix(g, shot->p_burst_ecef, *mine ? *mine : g->voters + 1, true)) continue;
        if (!*mine) *mine = ++g->voters;
        if (sea && height_m(shot->p_burst_ecef) > g->e->said.sea_h_m + wave_m) add_place(g, shot->p_burst_ecef, false);
    }
    free(voter);
    return STATUS_OK;
}

/* ---- the sea ------------------------------------------------------------------------------ */

/* Averages the height of a ship's waterline over its reports. */
static double waterline_h_m(const Gathering *g, int t, double *highest_m)
{
    enum { most = 64 };
    const Track *track = &g->survey->track[t];
    double       h_m[most];
    int          count = 0;
    for (int n = 0; n < most && n < track->count; n++) {
        double    base_ecef[3];
        const int at = track->count > most ? (int)((int64_t)n * track->count / most) : n;
        ground_evidence_base(base_ecef, &track->point[at], g->e->below_m[t]);
        const double h = height_m(base_ecef);
        if (isfinite(h)) h_m[count++] = h;
    }
    if (count == 0) return NAN;
    qsort(h_m, (size_t)count, sizeof *h_m, by_value);
    *highest_m = h_m[count - 1];
    return h_m[(count - 1) / 2];
}

static bool near_here(const Gathering *g, const Track *track)
{
    double p_enu[3];
    enu_from_ecef(p_enu, g->frame, track->point[0].p_ecef);
    return hypot(p_enu[0], p_enu[1]) < 2 * evidence_reach_m;
}

/* Sea level, then which submarines are ever at the surface; their positions, along a ship's whole hull. */
static Status find_sea(Gathering *g)
{
    static const double surface_m = 3;
    const Survey       *survey = g->survey;
    double             *level = calloc((size_t)survey->track_count + 1, sizeof *level), highest_m = -INFINITY;
    int                 ships = 0;
    if (!level) return STATUS_NO_MEMORY;
    for (int t = 0; t < survey->track_count; t++) {
        double own_m = NAN;
        if (g->e->stance[t] != STANCE_AFLOAT || !near_here(g, &survey->track[t])) continue;
        const double h_m = waterline_h_m(g, t, &own_m);
        if (!isfinite(h_m)) continue;
        if (contact_floats(survey->track[t].type)) level[ships++] = h_m;
        else highest_m = fmax(highest_m, own_m);
    }
    qsort(level, (size_t)ships, sizeof *level, by_value);
    g->e->said.sea_h_m = clamp(ships ? level[(ships - 1) / 2] : fmax(highest_m, 0), -900, 8900);
    free(level);

    for (int t = 0; t < survey->track_count; t++) {
        const Track *track = &survey->track[t];
        double       own_m = NAN;
        if (g->e->stance[t] != STANCE_AFLOAT) continue;
        if (!near_here(g, track)) {
            g->e->stance[t] = STANCE_OTHER;
            continue;
        }
        waterline_h_m(g, t, &own_m);
        if (!contact_floats(track->type) && own_m < g->e->said.sea_h_m - surface_m) g->e->stance[t] = STANCE_SUBMERGED;
        const Model      *model = model_of(g, track, NULL);
        const TrackPoint *last = NULL;
        for (int n = 0; n < track->count; n++) {
            const TrackPoint *point = &track->point[n];
            if (last && apart_m(point, last) < 0.25 * model->length_m) continue;
            last = point;
            double r[9];
            survey_point_rotation(r, point);
            for (int end = -1; end <= 1; end++) {
                double p_ecef[3];
                for (int k = 0; k < 3; k++) p_ecef[k] = point->p_ecef[k] + 0.5 * end * model->length_m * r[3 * k];
                add_place(g, p_ecef, true);
            }
        }
    }
    return STATUS_OK;
}

/* Whether an entity is within a ship's hull, or on its deck, at an instant. */
static bool is_within(const Gathering *g, const Track *ship, const TrackPoint *point)
{
    static const double side_m = 1, keel_m = 6, mast_m = 40;
    const Model        *model = model_of(g, ship, NULL);
    TrackPose           pose;
    double              d_ecef[3], d_body[3];
    survey_track_at(&pose, ship, point->t_s);
    v3_sub(d_ecef, point->p_ecef, pose.p_ecef);
    if (v3_length(d_ecef) > model->length_m + mast_m) return false;
    m3_tmul_v3(d_body, pose.r_ecef_from_body, d_ecef);
    return fabs(d_body[0]) <= 0.5 * model->length_m + side_m && fabs(d_body[1]) <= 0.5 * model->width_m + side_m &&
           d_body[2] <= keel_m && d_body[2] >= -mast_m;
}

/* Whether an entity is aboard a ship at two of its first, middle and last reports. */
static bool is_aboard(const Gathering *g, const Track *track)
{
    int aboard = 0;
    for (int k = 0; k < 3; k++)
        for (int t = 0; t < g->survey->track_count; t++)
            if (g->e->stance[t] == STANCE_AFLOAT && contact_floats(g->survey->track[t].type) &&
                is_within(g, &g->survey->track[t], &track->point[k * (track->count - 1) / 2])) {
                aboard++;
                break;
            }
    return aboard >= 2;
}

/* ---- all of it ---------------------------------------------------------------------------- */

static Stance stance_of(DisEntityType type)
{
    if (type.kind == dis_kind_platform && (type.domain == dis_domain_surface || type.domain == dis_domain_subsurface))
        return STANCE_AFLOAT;
    if (contact_applies(type) || is_mine(type)) return STANCE_GROUND;
    const bool shot = type.kind == dis_kind_munition && type.category != dis_munition_fixed; /* no sea mine */
    return shot || is_aircraft(type) ? STANCE_FLIES : STANCE_OTHER;
}

static Status make_room(Gathering *g)
{
    GroundEvidence *e = g->e;
    size_t          points = 0;
    const size_t    tracks = (size_t)g->survey->track_count, shots = (size_t)g->survey->shot_count;
    e->stance = calloc(tracks + 1, sizeof *e->stance);
    e->below_m = calloc(tracks + 1, sizeof *e->below_m);
    e->first = calloc(tracks + 1, sizeof *e->first);
    if (!e->stance || !e->below_m || !e->first) return STATUS_NO_MEMORY;
    for (size_t t = 0; t < tracks; t++) {
        Origin       origin;
        const Model *model = model_of(g, &g->survey->track[t], &origin);
        e->below_m[t] = origin == ORIGIN_CENTRE ? 0.5 * model->height_m : 0;
        e->stance[t] = stance_of(g->survey->track[t].type);
        e->first[t] = points;
        points += (size_t)g->survey->track[t].count;
    }
    e->tracks = (int)tracks, e->points = points;
    g->step = 1 + (int)(points / most_evidence);
    e->fixed = calloc(points + 1, sizeof *e->fixed);
    const size_t kept = points / (size_t)g->step + tracks;
    e->fix = calloc(kept + shots + 1, sizeof *e->fix);
    e->line = calloc(2 * kept + tracks + 1, sizeof *e->line);
    e->place = calloc(3 * points + shots + 1, sizeof *e->place);
    return e->fixed && e->fix && e->line && e->place ? STATUS_OK : STATUS_NO_MEMORY;
}

static Status gather(Gathering *g)
{
    GroundEvidence *e = g->e;
    const int       tracks = g->survey->track_count;
    Status          status = make_room(g);
    bool            sea = false;
    if (status != STATUS_OK) return status;
    for (int t = 0; t < tracks; t++) sea |= e->stance[t] == STANCE_AFLOAT;
    if (sea) status = find_sea(g);
    for (int t = 0; status == STATUS_OK && t < tracks; t++) {
        if (e->stance[t] != STANCE_GROUND) continue;
        if (sea && is_aboard(g, &g->survey->track[t])) e->stance[t] = STANCE_ABOARD;
        else add_voter(g, t, false);
    }
    if (status == STATUS_OK) status = judge_landed(g);
    for (int t = 0; status == STATUS_OK && t < tracks; t++) {
        if (e->stance[t] == STANCE_FLIES || e->stance[t] == STANCE_LANDED) add_flight(g, t);
        e->count[e->stance[t]]++;
    }
    return status == STATUS_OK ? add_impacts(g) : status;
}

Status ground_evidence_collect(GroundEvidence *out, const Survey *survey, const LocalFrame *frame,
                               const Catalog *catalog)
{
    GroundEvidence e = {0};
    Gathering      g = {.e = &e, .survey = survey, .frame = frame, .catalog = catalog};
    const Status   status = gather(&g);
    if (status != STATUS_OK) {
        ground_evidence_free(&e);
        return status;
    }
    e.said.fix = e.fix;
    e.said.line = e.line;
    e.said.place = e.place;
    *out = e;
    return STATUS_OK;
}

void ground_evidence_free(GroundEvidence *e)
{
    free(e->fix);
    free(e->line);
    free(e->place);
    free(e->stance);
    free(e->below_m);
    free(e->fixed);
    free(e->first);
    *e = (GroundEvidence){0};
}
