/* entities/survey/survey.c: one pass over all PDUs of a log: tracks, shots, clocks, counters. */
#include "entities/survey/survey.h"
#include "dis/capture/log.h"
#include "dis/pdu/decode.h"
#include "dis/pdu/pdu.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/table/entity_index.h"
#include "entities/traces/effect_history.h"

#include <stdlib.h>

enum {
    most_points = 20000000, /* 72 octets each: under 1.5 GB */
    most_tracks = 1 << 20,
    most_walks = 4096, /* Stop/Freeze and Start/Resume PDUs that are heeded */
    most_warfare = 4000000,
    most_absolute = 65536, /* absolute stamps that are compared; the first ones */
};

static const double largest_speed_mps = 2e4; /* the limit of entity_report.c: nothing faster stays near the Earth */
static const double year_1990_s = 631152000, year_2100_s = 4102444800;
static const double absolute_agree_s =
    10; /* difference of absolute stamps that still agree: clocks of one exercise, and network delays */
static const double invented_epoch_s = 1e9; /* captures converted from logs without dates start here */

typedef struct TrackBuild {
    int     capacity;
    uint8_t algorithm; /* algorithm of the last Entity State, which gives the axes of an update's velocity */
    bool    held;      /* stopped by a Stop/Freeze that its reports do not end */
} TrackBuild;

typedef struct Building {
    Survey       *survey;
    DisLogTimes   times;
    size_t        next; /* of them */
    DisPdu        pdu;  /* the log that is read */
    EntityIndex   index;
    int           track_capacity;
    TrackBuild   *build; /* one for each survey->track */
    WarfareEvent *warfare;
    int           warfare_count, warfare_capacity;
    uint64_t      points;
    bool          date_is_credible;
    int           walks;   /* over all tracks, at Stop/Freeze and Start/Resume */
    DisEntityId   stopped; /* by the latest Stop/Freeze, and how many points there were then */
    uint64_t      stopped_points;
    bool          held;            /* a Stop/Freeze holds some tracks that go on reporting */
    double       *absolute_unix_s; /* for each absolute stamp, in the order received: Unix time of exercise time 0 */
    int           absolute_capacity;
} Building;

/* ---- tracks ------------------------------------------------------------------------------- */

static Status grow(void **array, int *capacity, size_t size, int at_least)
{
    if (at_least <= *capacity) return STATUS_OK;
    const int larger = *capacity < 8 ? 16 : *capacity < 4096 ? *capacity * 2 : *capacity + *capacity / 4;
    void     *moved = realloc(*array, (size_t)larger * size);
    if (!moved) return STATUS_NO_MEMORY;
    *array = moved;
    *capacity = larger;
    return STATUS_OK;
}

/* Finds the index of an id's track; -1 when there is none and none may be added. */
static Status find_or_add_track(int *out, Building *b, DisEntityId id, bool add)
{
    Survey *survey = b->survey;
    *out = entity_index_find(&b->index, entity_key(id));
    if (*out >= 0 || !add || survey->track_count == most_tracks) return STATUS_OK;

    int    build_capacity = b->track_capacity;
    Status status = grow((void **)&b->build, &build_capacity, sizeof *b->build, survey->track_count + 1);
    if (status == STATUS_OK)
        status = grow((void **)&survey->track, &b->track_capacity, sizeof *survey->track, survey->track_count + 1);
    if (status == STATUS_OK && 2 * ((uint32_t)survey->track_count + 1) > b->index.mask)
        status = entity_index_grow(&b->index);
    if (status != STATUS_OK) return status;
    *out = survey->track_count++;
    survey->track[*out] = (Track){.id = id};
    b->build[*out] = (TrackBuild){0};
    entity_index_insert(&b->index, entity_key(id), *out);
    return STATUS_OK;
}

static Status add_point(Building *b, int t, const double p_ecef[3], const float v_mps[3], const float euler_rad[3],
                        uint32_t appearance, double t_s)
{
    Track *track = b->survey->track + t;
    if (track->count > 0 && t_s < track->point[track->count - 1].t_s) {
        b->survey->late++;
        return STATUS_OK;
    }
    if (b->points == most_points) {
        b->survey->refused++;
        return STATUS_OK;
    }
    const Status status = grow((void **)&track->point, &b->build[t].capacity, sizeof *track->point, track->count + 1);
    if (status != STATUS_OK) return status;

    TrackPoint  *point = track->point + track->count++;
    const double v[3] = {v_mps[0], v_mps[1], v_mps[2]};
    b->points++;
    *point = (TrackPoint){.t_s = t_s,
                          .frozen = appearance >> dis_appearance_frozen_bit & 1,
                          .deactivated = appearance >> dis_appearance_deactivated_bit & 1,
                          .engine = appearance >> dis_appearance_power_plant_bit & 1,
                          .damage = appearance >> dis_appearance_damage_shift & 3,
                          .paused = b->build[t].held};
    memcpy(point->p_ecef, p_ecef, sizeof point->p_ecef);
    memcpy(point->euler_rad, euler_rad, sizeof point->euler_rad);
    if (!(v3_length(v) <= largest_speed_mps)) return STATUS_OK;
    if (dead_reckoning_in_body_axes(b->build[t].algorithm)) {
        double r[9];
        survey_point_rotation(r, point);
        m3_mul_v3(point->v_ecef_mps, r, v);
    } else memcpy(point->v_ecef_mps, v, sizeof v);
    return STATUS_OK;
}

static Status receive_entity_state(Building *b, const DisEntityState *pdu, double t_s)
{
    const float euler_rad[3] = {pdu->psi_rad, pdu->theta_rad, pdu->phi_rad};
    DisDrop     why;
    int         t;

    if (!dis_entity_state_is_usable(&why, pdu)) {
        b->survey->counters.dropped[why]++;
        return STATUS_OK;
    }
    const Status status = find_or_add_track(&t, b, pdu->id, true);
    if (status != STATUS_OK) return status;
    if (t < 0) {
        b->survey->refused++;
        return STATUS_OK;
    }
    Track *track = b->survey->track + t;
    b->build[t].algorithm = pdu->dead_reckoning;
    track->type = pdu->type;
    track->force = pdu->force;
    memcpy(track->marking, pdu->marking, sizeof pdu->marking);
    return add_point(b, t, pdu->p_ecef, pdu->velocity_mps, euler_rad, pdu->appearance, t_s);
}

static Status receive_entity_state_update(Building *b, const DisEntityStateUpdate *pdu, double t_s)
{
    const float euler_rad[3] = {pdu->psi_rad, pdu->theta_rad, pdu->phi_rad};
    DisDrop     why;
    int         t;

    if (!dis_entity_state_update_is_usable(&why, pdu)) {
        b->survey->counters.dropped[why]++;
        return STATUS_OK;
    }
    const Status status = find_or_add_track(&t, b, pdu->id, false);
    if (status != STATUS_OK || t < 0) return status;
    return add_point(b, t, pdu->p_ecef, pdu->velocity_mps, euler_rad, pdu->appearance, t_s);
}

/* ---- events and clocks -------------------------------------------------------------------- */

static Status add_warfare(Building *b, const WarfareEvent *event)
{
    if (b->warfare_count == most_warfare) {
        b->survey->refused++;
        return STATUS_OK;
    }
    const Status status = grow((void **)&b->warfare, &b->warfare_capacity, sizeof *b->warfare, b->warfare_count + 1);
    if (status == STATUS_OK) b->warfare[b->warfare_count++] = *event;
    return status;
}

/* A burst must have a valid position: the ground is fitted through it. */
static Status receive_detonation(Building *b, const DisDetonation *pdu, double t_s)
{
    const DisEntityId any_id = {1, 1, 1}; /* only the position is checked */
    const float       euler_rad[3] = {0, 0, 0};
    DisDrop           why;

    if (!dis_entity_is_usable(&why, any_id, pdu->p_ecef, euler_rad, euler_rad)) {
        b->survey->counters.dropped[why]++;
        return STATUS_OK;
    }
    WarfareEvent event = {.t_s = t_s,
                          .firing = pdu->firing,
                          .target = pdu->target,
                          .munition = pdu->munition,
                          .event = pdu->event,
                          .result = pdu->result,
                          .charge_kg = (float)effect_charge_kg(&pdu->descriptor, false),
                          .is_detonation = true};
    memcpy(event.p_ecef, pdu->p_ecef, sizeof event.p_ecef);
    return add_warfare(b, &event);
}

/* Reads exercise time 0 on the simulation's own calendar. A clock of zero, or past 2100, is ignored. */
static void receive_start(Building *b, const DisStartResume *pdu, double t_s)
{
    const double unix_s = pdu->simulation.hour * 3600.0 + dis_timestamp_seconds(pdu->simulation.past_hour);
    if (pdu->simulation.hour == 0 || !(unix_s < year_2100_s) || !isnan(b->survey->clock_start_unix_s)) return;
    b->survey->clock_start_unix_s = unix_s - t_s;
}

/* An absolute stamp gives the second of the hour; the capture date gives the hour. */
static Status receive_time_stamp(Building *b, uint32_t timestamp, double capture_s, double t_s)
{
    if (!dis_timestamp_is_absolute(timestamp) || !b->date_is_credible) return STATUS_OK;
    if (!(capture_s >= year_1990_s && capture_s < year_2100_s)) return STATUS_OK;
    if (b->survey->absolute_stamps == most_absolute) return STATUS_OK;
    const Status status = grow((void **)&b->absolute_unix_s, &b->absolute_capacity, sizeof *b->absolute_unix_s,
                               b->survey->absolute_stamps + 1);
    if (status != STATUS_OK) return status;
    const double past_s = dis_timestamp_seconds(timestamp);
    b->absolute_unix_s[b->survey->absolute_stamps++] = past_s + 3600 * round((capture_s - past_s) / 3600) - t_s;
    return STATUS_OK;
}

static int compare_doubles(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return p < q ? -1 : p > q;
}

/* The consensus of absolute stamps, with the value of the first of them: a single outlier does not determine the
 * date. */
static Status settle_date(Building *b)
{
    Survey   *survey = b->survey;
    const int count = survey->absolute_stamps;
    if (count == 0) return STATUS_OK;
    double *sorted = malloc((size_t)count * sizeof *sorted);
    if (!sorted) return STATUS_NO_MEMORY;
    memcpy(sorted, b->absolute_unix_s, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, compare_doubles);
    int most = 0, from = 0;
    for (int low = 0, high = 0; high < count; high++) {
        while (sorted[high] - sorted[low] > absolute_agree_s) low++;
        if (high - low + 1 > most) most = high - low + 1, from = low;
    }
    survey->absolute_left_out = count - most;
    for (int i = 0; most >= 2 && 2 * most > count && isnan(survey->absolute_unix_s); i++)
        if (b->absolute_unix_s[i] >= sorted[from] && b->absolute_unix_s[i] <= sorted[from + most - 1])
            survey->absolute_unix_s = b->absolute_unix_s[i];
    free(sorted);
    return STATUS_OK;
}

/* Notes at the last points of all that a Stop/Freeze names that they stand from there on. Repetitions and floods of
 * them must not cost a walk over all tracks each. */
static void receive_stop(Building *b, const DisStopFreeze *pdu)
{
    const bool again = b->stopped_points == b->points && dis_entity_id_compare(b->stopped, pdu->receiving) == 0;
    if (again || b->walks == most_walks) return;
    b->walks++;
    b->stopped = pdu->receiving;
    b->stopped_points = b->points;
    b->held |= dis_stop_lets_report(pdu);
    for (int t = 0; t < b->survey->track_count; t++) {
        Track *track = b->survey->track + t;
        if (track->count == 0 || !dis_simulation_names(pdu->receiving, track->id)) continue;
        track->point[track->count - 1].paused = true;
        b->build[t].held = dis_stop_lets_report(pdu);
    }
}

static void release(Building *b, const DisStartResume *pdu)
{
    b->stopped_points = UINT64_MAX;
    if (!b->held || b->walks == most_walks) return;
    b->walks++;
    b->held = false;
    for (int t = 0; t < b->survey->track_count; t++) {
        if (dis_simulation_names(pdu->receiving, b->survey->track[t].id)) b->build[t].held = false;
        b->held |= b->build[t].held;
    }
}

/* ---- the pass ----------------------------------------------------------------------------- */

static Status hear(Building *b, const DisPdu *pdu, double t_s)
{
    switch (pdu->type) {
    case dis_pdu_entity_state:
        return receive_entity_state(b, &pdu->entity_state, t_s);
    case dis_pdu_entity_state_update:
        return receive_entity_state_update(b, &pdu->update, t_s);
    case dis_pdu_fire:
        return add_warfare(b, &(WarfareEvent){.t_s = t_s,
                                              .firing = pdu->fire.firing,
                                              .target = pdu->fire.target,
                                              .munition = pdu->fire.munition,
                                              .event = pdu->fire.event});
    case dis_pdu_detonation:
        return receive_detonation(b, &pdu->detonation, t_s);
    case dis_pdu_start_resume:
    case dis_pdu_start_resume_r:
        receive_start(b, &pdu->start, t_s);
        release(b, &pdu->start);
        return STATUS_OK;
    case dis_pdu_stop_freeze:
    case dis_pdu_stop_freeze_r:
        receive_stop(b, &pdu->stop);
        return STATUS_OK;
    default:
        return STATUS_OK;
    }
}

static Status receive_datagram(Building *b, int d, const DisDatagram *datagram, int exercise)
{
    Survey        *survey = b->survey;
    const uint8_t *at = datagram->bytes, *pdu;
    DisHeader      header;

    survey->counters.datagrams++;
    while (dis_next_pdu(&header, &pdu, &at, datagram->bytes + datagram->octets, &survey->counters)) {
        if (exercise >= 0 && header.exercise != exercise) {
            survey->counters.dropped[DIS_DROP_OTHER_EXERCISE]++;
            continue;
        }
        const ExerciseInstant *instant = &b->times.pdu[b->next++];
        const double           t_s = instant->t_s;
        if (isnan(t_s)) continue; /* PDUs of unknown type that name no sender */
        if (d < survey_times_most && isnan(survey->datagram_s[d])) survey->datagram_s[d] = t_s;
        if (!(survey->first_s <= t_s)) survey->first_s = t_s;
        if (!(survey->last_s >= t_s)) survey->last_s = t_s;
        Status status = STATUS_OK;
        if (instant->by_stamp || instant->stamp == 0)
            status = receive_time_stamp(b, header.timestamp, datagram->capture_s, t_s);
        const Status refused = dis_decode(&b->pdu, pdu, header.length);
        if (refused != STATUS_OK) dis_count_refused(&survey->counters, header.type, refused);
        else if (status == STATUS_OK) status = hear(b, &b->pdu, t_s);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

static int track_order(const void *a, const void *b)
{
    return dis_entity_id_compare(((const Track *)a)->id, ((const Track *)b)->id);
}

/* A track without a point, since all its reports were dropped for lack of memory, is removed. */
static void drop_empty_tracks(Survey *survey)
{
    int kept = 0;
    for (int t = 0; t < survey->track_count; t++)
        if (survey->track[t].count > 0) survey->track[kept++] = survey->track[t];
    survey->track_count = kept;
}

/* Ends the flight of a munition that has a Detonation after its last report: the burst becomes the last point of its
 * track. */
static Status end_flights(Building *b)
{
    static const double longest_silence_s = 60;
    for (int i = 0; i < b->survey->shot_count; i++) {
        const Shot *shot = &b->survey->shot[i];
        int         t = -1;
        Status      status = find_or_add_track(&t, b, shot->munition, false);
        if (status != STATUS_OK) return status;
        if (t < 0 || b->survey->track[t].count == 0 || !isfinite(shot->detonation_s)) continue;
        Track           *track = b->survey->track + t;
        const TrackPoint last = track->point[track->count - 1];
        const double     dt_s = shot->detonation_s - last.t_s;
        double           way_ecef[3];
        v3_sub(way_ecef, shot->p_burst_ecef, last.p_ecef);
        if (track->type.kind != dis_kind_munition || !(dt_s > 1e-3 && dt_s < longest_silence_s) || last.deactivated ||
            !(v3_length(way_ecef) / dt_s <= largest_speed_mps))
            continue;
        status = grow((void **)&track->point, &b->build[t].capacity, sizeof *track->point, track->count + 1);
        if (status != STATUS_OK) return status;
        TrackPoint *end = track->point + track->count++;
        *end = last;
        end->t_s = shot->detonation_s;
        memcpy(end->p_ecef, shot->p_burst_ecef, sizeof end->p_ecef);
        v3_scale(end->v_ecef_mps, 1 / dt_s, way_ecef);
    }
    return STATUS_OK;
}

Status survey_log(Survey *out, const DisLog *log, int exercise)
{
    Survey   survey = {.first_s = NAN, .last_s = NAN, .clock_start_unix_s = NAN, .absolute_unix_s = NAN};
    Building b = {.survey = &survey};
    b.date_is_credible = log->count > 0 && !(fabs(log->datagram[0].capture_s - invented_epoch_s) <= 1);

    Status status = dis_log_times(&b.times, log, exercise);
    if (status == STATUS_OK) status = entity_index_create(&b.index, 512);
    const int times = log->count < survey_times_most ? log->count : survey_times_most;
    survey.datagram_s = calloc((size_t)times + 1, sizeof *survey.datagram_s);
    if (!survey.datagram_s) status = STATUS_NO_MEMORY;

    for (int d = 0; d < log->count && status == STATUS_OK; d++) {
        if (d < times) survey.datagram_s[d] = NAN;
        const DisDatagram datagram = dis_log_datagram(log, d);
        status = receive_datagram(&b, d, &datagram, exercise);
    }
    if (status == STATUS_OK) status = survey_join_shots(&survey.shot, &survey.shot_count, b.warfare, b.warfare_count);
    if (status == STATUS_OK) status = survey_order_shots(&survey.shot_by_munition, survey.shot, survey.shot_count);
    if (status == STATUS_OK) status = end_flights(&b);
    if (status == STATUS_OK) status = settle_date(&b);
    if (status == STATUS_OK) {
        survey.doubts = b.times.doubts;
        survey.counters.stamps_doubted = survey.doubts.by_arrival;
        drop_empty_tracks(&survey);
        if (survey.track_count > 1) qsort(survey.track, (size_t)survey.track_count, sizeof *survey.track, track_order);
        *out = survey;
    } else {
        log_error("survey: cannot keep the log's tracks: reason=%s tracks=%d points=%llu", status_name(status),
                  survey.track_count, (unsigned long long)b.points);
        survey_destroy(&survey);
    }
    dis_log_times_release(&b.times);
    entity_index_destroy(&b.index);
    free(b.build);
    free(b.warfare);
    free(b.absolute_unix_s);
    return status;
}

void survey_destroy(Survey *survey)
{
    for (int t = 0; t < survey->track_count; t++) free(survey->track[t].point);
    free(survey->track);
    free(survey->shot);
    free(survey->shot_by_munition);
    free(survey->datagram_s);
    memset(survey, 0, sizeof *survey);
}

const Track *survey_track(const Survey *survey, DisEntityId id)
{
    int low = 0, high = survey->track_count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        const int order = dis_entity_id_compare(survey->track[middle].id, id);
        if (order == 0) return survey->track + middle;
        if (order < 0) low = middle + 1;
        else high = middle;
    }
    return NULL;
}

const Shot *survey_shot(const Survey *survey, DisEntityId munition)
{
    int low = 0, high = survey->shot_count;
    if (!survey->shot_by_munition) { /* the survey was made by hand, as in a test */
        for (int i = 0; i < survey->shot_count; i++)
            if (dis_entity_id_compare(survey->shot[i].munition, munition) == 0) return survey->shot + i;
        return NULL;
    }
    while (low < high) { /* searches the first shot that is not before */
        const int   middle = low + (high - low) / 2;
        const Shot *shot = survey->shot + survey->shot_by_munition[middle];
        if (dis_entity_id_compare(shot->munition, munition) < 0) low = middle + 1;
        else high = middle;
    }
    if (low == survey->shot_count) return NULL;
    const Shot *found = survey->shot + survey->shot_by_munition[low];
    return dis_entity_id_compare(found->munition, munition) == 0 ? found : NULL;
}
