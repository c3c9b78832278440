#include "sensor/node/choices.h"

#include "dis/enumerations.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { who_size = 80 };

void choice_add(Choices *choices, const char *format, ...)
{
    if (choices->count >= choices_capacity) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(choices->line[choices->count++], choice_text_size, format, arguments);
    va_end(arguments);
}

static bool is_land(const Track *track)
{
    return track->type.kind == dis_kind_platform && track->type.domain == dis_domain_land;
}

static bool flies(const Track *track)
{
    return track->type.kind == dis_kind_munition ||
           (track->type.kind == dis_kind_platform && track->type.domain == dis_domain_air);
}

static double path_m(const Track *track)
{
    double sum = 0;
    for (int i = 1; i < track->count; i++) {
        double d[3];
        v3_sub(d, track->point[i].p_ecef, track->point[i - 1].p_ecef);
        sum += v3_length(d);
    }
    return sum;
}

static const Shot *shot_of(const Survey *survey, DisEntityId munition)
{
    for (int i = 0; i < survey->shot_count; i++)
        if (dis_entity_id_compare(survey->shot[i].munition, munition) == 0) return &survey->shot[i];
    return NULL;
}

static const char *who(char out[who_size], const Survey *survey, DisEntityId id)
{
    char         id_text[dis_id_text_size], marking[48];
    const Track *track = survey_track(survey, id);
    dis_entity_id_text(id_text, id);
    text_escape(marking, sizeof marking, track ? track->marking : "", track ? strnlen(track->marking, 11) : 0);
    snprintf(out, who_size, "%s%s%s", id_text, *marking ? " " : "", marking);
    return out;
}

int choose_exercise(Choices *choices, const DisLog *log, const Config *config)
{
    int64_t     heard[256] = {0};
    DisCounters ignored    = {0};
    int         most = 0, exercises = 0;
    if (config->exercise.exercise != -1) return config->exercise.exercise < 0 ? -1 : config->exercise.exercise;
    for (int i = 0; i < log->count; i++) {
        const uint8_t *at = log->datagram[i].bytes, *pdu;
        DisHeader      header;
        while (dis_next_pdu(&header, &pdu, &at, log->datagram[i].bytes + log->datagram[i].octets, &ignored))
            heard[header.exercise] += header.type == dis_pdu_entity_state;
    }
    for (int e = 0; e < 256; e++) {
        exercises += heard[e] > 0;
        if (heard[e] > heard[most]) most = e;
    }
    if (exercises <= 1) return -1;
    choice_add(choices, "exercise: %d, heard most of %d (exercise.exercise)", most, exercises);
    return most;
}

/* ---- host and aim --------------------------------------------------------------------------- */

/* Entity nearest a place at an instant, other than `not`; munitions do not count. */
static DisEntityId nearest_entity(const Survey *survey, const double p_ecef[3], double t_s, DisEntityId not)
{
    DisEntityId nearest = {0};
    double      least_m = 200; /* farther than that, it is not what was shot at */
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        TrackPose    pose;
        double       d[3];
        if (track->type.kind == dis_kind_munition || dis_entity_id_compare(track->id, not) == 0) continue;
        if (track->point[0].t_s > t_s) continue;
        track_at(&pose, track, t_s);
        v3_sub(d, pose.p_ecef, p_ecef);
        if (v3_length(d) < least_m) {
            least_m = v3_length(d);
            nearest = track->id;
        }
    }
    return nearest;
}

static void choose_aim(HostPlan *plan, Choices *choices, const Survey *survey, const Config *config)
{
    char        name[who_size];
    const Shot *shot = shot_of(survey, plan->host);
    if (*config->exercise.aim) {
        dis_entity_id_parse(&plan->aim, config->exercise.aim);
        return;
    }
    if (shot && !dis_entity_id_is_none(shot->target) && survey_track(survey, shot->target)) {
        plan->aim = shot->target;
        choice_add(choices, "aim: %s, the target of its Fire PDU (exercise.aim)", who(name, survey, plan->aim));
        return;
    }
    if (shot && !dis_entity_id_is_none(shot->hit) && survey_track(survey, shot->hit)) {
        plan->aim = shot->hit;
        choice_add(choices, "aim: %s, which it hit (exercise.aim)", who(name, survey, plan->aim));
        return;
    }
    if (shot && isfinite(shot->detonation_s)) {
        plan->aim = nearest_entity(survey, shot->p_burst_ecef, shot->detonation_s, plan->host);
        if (!dis_entity_id_is_none(plan->aim)) {
            choice_add(choices, "aim: %s, nearest the burst (exercise.aim)", who(name, survey, plan->aim));
            return;
        }
    }
    choice_add(choices, "aim: along the body axis, no target is known (exercise.aim)");
}

static Status aim_is_heard(const Survey *survey, const Config *config)
{
    DisEntityId aim;
    if (!*config->exercise.aim) return STATUS_OK;
    if (!dis_entity_id_parse(&aim, config->exercise.aim)) {
        log_error("replay: exercise.aim: '%s' is not site:application:entity", config->exercise.aim);
        return STATUS_BAD_VALUE;
    }
    if (!survey_track(survey, aim)) {
        log_error("replay: exercise.aim: %s is not in the log; `pitviper inspect LOG` lists who is", config->exercise.aim);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

Status plan_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config, DisEntityId host)
{
    char         text[dis_id_text_size];
    const Track *track = survey_track(survey, host);
    Status       status = aim_is_heard(survey, config);
    if (status != STATUS_OK) return status;
    if (!track) {
        dis_entity_id_text(text, host);
        log_error("replay: host %s is not in the log; `pitviper inspect LOG` lists who is", text);
        return STATUS_BAD_VALUE;
    }
    HostPlan    plan = {.host = host, .munition = track->type.kind == dis_kind_munition};
    const Shot *shot = plan.munition ? shot_of(survey, host) : NULL;
    plan.start_s     = track->point[0].t_s;
    plan.end_s       = track->point[track->count - 1].t_s;
    if (shot && isfinite(shot->detonation_s) && shot->detonation_s > plan.start_s) plan.end_s = shot->detonation_s;
    choose_aim(&plan, choices, survey, config);
    *out = plan;
    return STATUS_OK;
}

/* Longest flight among munitions; impact: only those whose Detonation says entity impact. NULL: none. */
static const Track *longest_flight(const Survey *survey, bool impact)
{
    const Track *longest = NULL;
    double       most_s  = 0;
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        const Shot  *shot  = shot_of(survey, track->id);
        if (track->type.kind != dis_kind_munition) continue;
        if (impact && !(shot && shot->result == dis_result_entity_impact)) continue;
        const double end_s    = shot && isfinite(shot->detonation_s) ? shot->detonation_s
                                                                     : track->point[track->count - 1].t_s;
        const double flight_s = end_s - track->point[0].t_s;
        if (flight_s > most_s) {
            most_s  = flight_s;
            longest = track;
        }
    }
    return longest;
}

static Status plan_observer(HostPlan *out, Choices *choices, const Survey *survey, const Config *config)
{
    char         name[who_size];
    HostPlan     plan   = {.start_s = survey->first_s, .end_s = survey->last_s};
    const Track *target = NULL;
    double       most_m = -1;

    for (int i = 0; i < survey->track_count; i++) /* land first, then anybody; who went farthest */
        if (is_land(&survey->track[i]) && path_m(&survey->track[i]) > most_m) {
            target = &survey->track[i];
            most_m = path_m(target);
        }
    for (int i = 0; !target && i < survey->track_count; i++) target = &survey->track[i];
    if (!target) {
        log_error("replay: the log holds no entity with a usable position; `pitviper inspect LOG` says what it holds");
        return STATUS_BAD_VALUE;
    }
    plan.aim     = target->id;
    plan.start_s = target->point[0].t_s;
    memcpy(plan.p_aim_ecef, target->point[0].p_ecef, sizeof plan.p_aim_ecef);
    if (*config->exercise.aim) {
        dis_entity_id_parse(&plan.aim, config->exercise.aim);
        const Track *aim = survey_track(survey, plan.aim);
        plan.start_s     = aim->point[0].t_s;
        memcpy(plan.p_aim_ecef, aim->point[0].p_ecef, sizeof plan.p_aim_ecef);
    }
    choice_add(choices, "host: a stand-off observer, no munition flies here (exercise.host)");
    choice_add(choices, "aim: %s, circled at %g m, %g m above (exercise.aim, observer.*)", who(name, survey, plan.aim),
               config->observer.range_m, config->observer.height_m);
    *out = plan;
    return STATUS_OK;
}

Status choose_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config)
{
    char        name[who_size];
    DisEntityId host;
    Status      status = aim_is_heard(survey, config);
    if (status != STATUS_OK) return status;
    if (*config->exercise.host) {
        if (!dis_entity_id_parse(&host, config->exercise.host)) {
            log_error("replay: exercise.host: '%s' is not site:application:entity", config->exercise.host);
            return STATUS_BAD_VALUE;
        }
        return plan_host(out, choices, survey, config, host);
    }
    const Track *impact = longest_flight(survey, true), *any = longest_flight(survey, false);
    if (impact || any) {
        choice_add(choices, "host: %s, %s; its seeker is a notional one (exercise.host)",
                   who(name, survey, impact ? impact->id : any->id),
                   impact ? "the longest flight that hit an entity" : "the longest flight");
        return plan_host(out, choices, survey, config, impact ? impact->id : any->id);
    }
    return plan_observer(out, choices, survey, config);
}

void choose_rate(HostPlan *plan, Choices *choices, const Config *config)
{
    plan->rate_hz = config->sensor.rate_hz;
    if (plan->rate_hz > 0) return;
    plan->rate_hz = plan->munition ? 5 : 1; /* a flight lasts seconds, a watch minutes */
    choice_add(choices, "rate: %g frames a second (sensor.rate_hz)", plan->rate_hz);
}

/* ---- time of day ---------------------------------------------------------------------------- */

/* Days since 1970-01-01 of a proleptic Gregorian date. Source: Hinnant, "chrono-compatible low-level date
 * algorithms", by the count of days in 400-year eras. */
static long long days_from_date(int year, int month, int day)
{
    const long long y   = month <= 2 ? year - 1 : year;
    const long long era = (y >= 0 ? y : y - 399) / 400;
    const long long yoe = y - era * 400;
    const long long doy = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + yoe * 365 + yoe / 4 - yoe / 100 + doy - 719468;
}

static bool parse_utc(double *unix_s, const char *text)
{
    static const int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int    year, month, day, hour, minute, used = 0;
    double second;
    if (sscanf(text, "%4d-%2d-%2dT%2d:%2d:%lfZ%n", &year, &month, &day, &hour, &minute, &second, &used) != 6 ||
        text[used] || year < 1900 || year > 2100 || month < 1 || month > 12 || day < 1 ||
        day > days[month - 1] + (month == 2 && year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)) || hour < 0 ||
        hour > 23 || minute < 0 || minute > 59 || !(second >= 0 && second < 60))
        return false;
    *unix_s = (double)days_from_date(year, month, day) * 86400 + hour * 3600 + minute * 60 + second;
    return true;
}

Status choose_time(double *unix_s, Choices *choices, const Survey *survey, const Config *config, const LocalFrame *frame)
{
    double first_unix_s;
    if (*config->exercise.utc) {
        if (!parse_utc(&first_unix_s, config->exercise.utc)) {
            log_error("replay: exercise.utc: '%s' is not a time such as 2026-06-21T10:00:00Z, 1900 .. 2100",
                      config->exercise.utc);
            return STATUS_BAD_VALUE;
        }
        *unix_s = first_unix_s - survey->first_s;
    } else if (isfinite(survey->clock_start_unix_s)) {
        *unix_s = survey->clock_start_unix_s;
        choice_add(choices, "time of day: the clock of a Start/Resume PDU (exercise.utc)");
    } else if (isfinite(survey->absolute_unix_s)) {
        *unix_s = survey->absolute_unix_s;
        choice_add(choices, "time of day: absolute time stamps and the date of the capture (exercise.utc)");
    } else {
        /* mean solar time: 86400 s for 2 pi of longitude */
        const double ten_local_s = (double)days_from_date(2026, 6, 21) * 86400 + 10 * 3600;
        *unix_s = ten_local_s - frame->origin.lon_rad / (2 * pi_rad) * 86400 - survey->first_s;
        choice_add(choices, "time of day: local solar 10:00 on 21 June, the log does not say (exercise.utc)");
    }
    return STATUS_OK;
}

/* ---- ground --------------------------------------------------------------------------------- */

Status choose_frame(LocalFrame *out, const Survey *survey, const HostPlan *plan)
{
    const Track *track = survey_track(survey, plan->aim);
    if (!track) track = survey_track(survey, plan->host);
    if (!track && survey->track_count > 0) track = &survey->track[0];
    if (!track) return STATUS_BAD_VALUE;
    TrackPose pose;
    track_at(&pose, track, plan->end_s);
    Geodetic place;
    Status   status = geodetic_from_ecef(&place, pose.p_ecef);
    if (status != STATUS_OK) return status;
    place.h_m = 0;
    return local_frame_at(out, &place);
}

typedef struct Evidence {
    GroundFix *fix;
    ClearLine *line;
    int        fixes, lines, vehicles, impacts;
} Evidence;

/* Places far outside the landscape say nothing about it. */
static const double evidence_reach_m = 60000;

static void add_fix(Evidence *e, const LocalFrame *frame, const double p_ecef[3])
{
    GroundFix fix;
    enu_from_ecef(fix.p_enu, frame, p_ecef);
    if (hypot(fix.p_enu[0], fix.p_enu[1]) < evidence_reach_m) e->fix[e->fixes++] = fix;
}

static void add_line(Evidence *e, const LocalFrame *frame, const double a_ecef[3], const double b_ecef[3])
{
    ClearLine line;
    double    d[3];
    enu_from_ecef(line.a_enu, frame, a_ecef);
    enu_from_ecef(line.b_enu, frame, b_ecef);
    v3_sub(d, line.b_enu, line.a_enu);
    if (v3_length(d) < evidence_reach_m && hypot(line.a_enu[0], line.a_enu[1]) < evidence_reach_m)
        e->line[e->lines++] = line;
}

/* A vehicle's base at its reports. */
static void add_vehicle(Evidence *e, const LocalFrame *frame, const Track *track, double base_below_m)
{
    for (int i = 0; i < track->count; i++) {
        const TrackPoint *point = &track->point[i];
        double            base_ecef[3];
        for (int k = 0; k < 3; k++) /* third column: body z, down */
            base_ecef[k] = point->p_ecef[k] + base_below_m * point->r_ecef_from_body[3 * k + 2];
        add_fix(e, frame, base_ecef);
    }
}

static void add_flight(Evidence *e, const LocalFrame *frame, const Survey *survey, const Track *track,
                       const HostPlan *plan)
{
    const Shot  *shot   = track->type.kind == dis_kind_munition ? shot_of(survey, track->id) : NULL;
    const Track *target = shot ? survey_track(survey, shot->hit) : NULL;
    /* a hit that names nobody: what the host's own was found to have hit */
    if (shot && !target && shot->result == dis_result_entity_impact && dis_entity_id_compare(track->id, plan->host) == 0)
        target = survey_track(survey, plan->aim);
    for (int i = 0; i + 1 < track->count; i++)
        add_line(e, frame, track->point[i].p_ecef, track->point[i + 1].p_ecef);
    /* a shot that hit saw its target all the way */
    for (int i = 0; target && i < track->count; i++) {
        TrackPose pose;
        double    centre_ecef[3];
        track_at(&pose, target, track->point[i].t_s);
        for (int k = 0; k < 3; k++) centre_ecef[k] = pose.p_ecef[k] - pose.r_ecef_from_body[3 * k + 2];
        add_line(e, frame, track->point[i].p_ecef, centre_ecef);
    }
}

Status choose_ground(Landscape *out, Choices *choices, const Survey *survey, const Config *config,
                     const LocalFrame *frame, const Catalog *catalog, const HostPlan *plan)
{
    LandscapeConfig land = landscape_default_config();
    Evidence        e    = {0};
    size_t          points = (size_t)survey->shot_count;
    for (int i = 0; i < survey->track_count; i++) points += (size_t)survey->track[i].count;

    Status status = STATUS_NO_MEMORY;
    e.fix         = calloc(points + 1, sizeof *e.fix);
    e.line        = calloc(2 * points + (size_t)survey->track_count + 1, sizeof *e.line);
    if (!e.fix || !e.line) goto done;

    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        if (is_land(track)) {
            Origin       origin;
            const int    model        = catalog_find(catalog, track->type, &origin, NULL);
            const double base_below_m = origin == ORIGIN_CENTRE ? 0.5 * catalog_model(catalog, model)->height_m : 0;
            add_vehicle(&e, frame, track, base_below_m);
            e.vehicles++;
        } else if (flies(track)) {
            add_flight(&e, frame, survey, track, plan);
        }
    }
    for (int i = 0; i < survey->shot_count; i++)
        if (survey->shot[i].result == dis_result_ground_impact && isfinite(survey->shot[i].detonation_s)) {
            add_fix(&e, frame, survey->shot[i].p_burst_ecef);
            e.impacts++;
        }

    land.seed      = (uint64_t)config->seed;
    land.relief_m  = config->terrain.relief_m;
    land.spacing_m = config->terrain.spacing_m;
    status         = landscape_create(out, &land, frame, e.fix, e.fixes, e.line, e.lines);
    if (status != STATUS_OK) {
        log_error("replay: no landscape could be made: %s", status_name(status));
        goto done;
    }
    choice_add(choices, "ground: invented, fitted to %d land entities and %d ground impacts within %.2f m (terrain.*)",
               e.vehicles, e.impacts, out->fit_worst_m);
    if (out->fixes_dropped > 0)
        choice_add(choices, "ground: %d of %d places contradict others or a flight path and were left out", out->fixes_dropped,
                   e.fixes);

done:
    free(e.fix);
    free(e.line);
    return status;
}
