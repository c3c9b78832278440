/* sensor/node/choices/host_choice.c: the host of the sensor, its aim and its rate, where the configuration leaves
 * them open. */
#include "sensor/node/choices/choices.h"

#include "dis/pdu/pdu.h"
#include "sensor/node/player/munitions.h"

#include <stdio.h>

const char host_munition[] = "munition", host_observer[] = "observer";

void choice_host_name(char out[dis_id_text_size], const HostPlan *plan)
{
    if (!dis_entity_id_is_none(plan->host)) dis_entity_id_text(out, plan->host);
    else strcpy(out, plan->any_munition ? host_munition : host_observer);
}

enum { who_size = 80 };

bool choice_is_land(const Track *track)
{
    return track->type.kind == dis_kind_platform && track->type.domain == dis_domain_land;
}

static bool dives(const Track *track)
{
    return track->type.kind == dis_kind_platform && track->type.domain == dis_domain_subsurface;
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

static const char *who(char out[who_size], const Survey *survey, DisEntityId id)
{
    char         id_text[dis_id_text_size], marking[48];
    const Track *track = survey_track(survey, id);
    dis_entity_id_text(id_text, id);
    text_escape(marking, sizeof marking, track ? track->marking : "", track ? strnlen(track->marking, 11) : 0);
    snprintf(out, who_size, "%s%s%s", id_text, *marking ? " " : "", marking);
    return out;
}

/* ---- host and aim --------------------------------------------------------------------------- */

DisEntityId choice_nearest_entity(const Survey *survey, const double p_ecef[3], double t_s, DisEntityId not )
{
    DisEntityId nearest = {0};
    double      least_m = 200; /* farther than that, it was not the target */
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        TrackPose    pose;
        double       d[3];
        if (track->type.kind == dis_kind_munition || dis_entity_id_compare(track->id, not ) == 0) continue;
        if (track->point[0].t_s > t_s) continue;
        survey_track_at(&pose, track, t_s);
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
    const Shot *shot = dis_entity_id_is_none(plan->host) ? NULL : survey_shot(survey, plan->host);
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
        plan->aim = choice_nearest_entity(survey, shot->p_burst_ecef, shot->detonation_s, plan->host);
        if (!dis_entity_id_is_none(plan->aim)) {
            choice_add(choices, "aim: %s, nearest the burst (exercise.aim)", who(name, survey, plan->aim));
            return;
        }
    }
    if (plan->munition && config->exercise.causal)
        choice_add(choices, "aim: the target of its Fire PDU once that is heard, till then along the body axis "
                            "(exercise.aim)");
    else choice_add(choices, "aim: along the body axis, no target is known (exercise.aim)");
}

static Status aim_is_known(const Survey *survey, const Config *config)
{
    DisEntityId aim;
    if (!*config->exercise.aim) return STATUS_OK;
    if (!dis_entity_id_parse(&aim, config->exercise.aim)) {
        log_error("replay: exercise.aim: '%s' is not site:application:entity", config->exercise.aim);
        return STATUS_BAD_VALUE;
    }
    if (!survey_track(survey, aim) && !config->exercise.causal) {
        log_error("replay: exercise.aim: %s is not in the log; `pitviper inspect LOG` lists the entities",
                  config->exercise.aim);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

/* Plans an observer. asked: it was requested, and is not chosen for lack of a munition. */
static Status plan_observer(HostPlan *out, Choices *choices, const Survey *survey, const Config *config, bool asked)
{
    char         name[who_size];
    HostPlan     plan = {.start_s = survey->first_s, .end_s = survey->last_s};
    const Track *target = NULL;
    double       most_m = -1;

    for (int i = 0; i < survey->track_count; i++) /* land entities first, then any; the one with the longest path */
        if (choice_is_land(&survey->track[i]) && path_m(&survey->track[i]) > most_m) {
            target = &survey->track[i];
            most_m = path_m(target);
        }
    for (int i = 0; !target && i < survey->track_count; i++) /* water is opaque */
        if (!dives(&survey->track[i])) target = &survey->track[i];
    for (int i = 0; !target && i < survey->track_count; i++) target = &survey->track[i];
    if (!target) {
        log_error("replay: the log holds no entity with a usable position; `pitviper inspect LOG` says what it holds");
        return STATUS_BAD_VALUE;
    }
    plan.aim = target->id;
    plan.start_s = target->point[0].t_s;
    memcpy(plan.p_aim_ecef, target->point[0].p_ecef, sizeof plan.p_aim_ecef);
    if (*config->exercise.aim) {
        dis_entity_id_parse(&plan.aim, config->exercise.aim);
        const Track *aim = survey_track(survey, plan.aim);
        if (aim) {
            plan.start_s = aim->point[0].t_s;
            memcpy(plan.p_aim_ecef, aim->point[0].p_ecef, sizeof plan.p_aim_ecef);
        }
    }
    *out = plan;
    if (*config->exercise.cigi) {
        choice_add(choices, "host: an eye that a CIGI host moves (exercise.cigi)");
        choice_add(choices, "aim: %s (exercise.aim)", who(name, survey, plan.aim));
        return STATUS_OK;
    }
    if (*config->flight.missile) {
        choice_add(choices, "host: a missile of the node's own, %s, from %s (flight.missile, flight.from)",
                   config->flight.missile, config->flight.from);
        choice_add(choices, "aim: %s (exercise.aim)", who(name, survey, plan.aim));
        return STATUS_OK;
    }
    if (asked) choice_add(choices, "host: a stand-off observer (exercise.host)");
    else
        choice_add(choices, "host: a stand-off observer, no munition flies here%s (exercise.host)",
                   config->exercise.causal ? " now" : "");
    choice_add(choices, "aim: %s, circled at %g m, %g m above (exercise.aim, observer.*)", who(name, survey, plan.aim),
               config->observer.range_m, config->observer.height_m);
    return STATUS_OK;
}

Status choice_named_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config, DisEntityId host)
{
    char         text[dis_id_text_size];
    const Track *track = survey_track(survey, host);
    Status       status = aim_is_known(survey, config);
    if (status != STATUS_OK) return status;
    if (dis_entity_id_is_none(host)) return plan_observer(out, choices, survey, config, true);
    if (!track && config->exercise.causal) {
        HostPlan later = {.host = host, .munition = true, .start_s = survey->last_s, .end_s = survey->last_s};
        dis_entity_id_text(text, host);
        choice_add(choices, "host: %s, not heard so far (exercise.host)", text);
        choose_aim(&later, choices, survey, config);
        *out = later;
        return STATUS_OK;
    }
    if (!track) {
        dis_entity_id_text(text, host);
        log_error("replay: host %s is not in the log; `pitviper inspect LOG` lists the entities", text);
        return STATUS_BAD_VALUE;
    }
    HostPlan    plan = {.host = host, .munition = track->type.kind == dis_kind_munition};
    const Shot *shot = plan.munition ? survey_shot(survey, host) : NULL;
    plan.start_s = track->point[0].t_s;
    plan.end_s = track->point[track->count - 1].t_s;
    if (shot && isfinite(shot->detonation_s) && shot->detonation_s > plan.start_s) plan.end_s = shot->detonation_s;
    choose_aim(&plan, choices, survey, config);
    *out = plan;
    return STATUS_OK;
}

/* Whether a munition detonated, was removed or fell silent before the end of the received data. */
static bool has_ended(const Survey *survey, const Track *track, const Config *config)
{
    const Shot       *shot = survey_shot(survey, track->id);
    const TrackPoint *last = &track->point[track->count - 1];
    return (shot && isfinite(shot->detonation_s)) || last->deactivated ||
           survey->last_s - last->t_s > config->entities.timeout_s;
}

/* Independent of the category: a munition whose position never changes and that never reports a velocity is not in
 * flight. */
static bool lies(const Track *track)
{
    static const double still_m = 1;
    for (int i = 0; i < track->count; i++) {
        double moved[3];
        v3_sub(moved, track->point[i].p_ecef, track->point[0].p_ecef);
        if (v3_length(moved) > still_m || v3_length(track->point[i].v_ecef_mps) > munition_still_mps) return false;
    }
    return true;
}

/* Finds the longest flight among munitions, guided or not, except mines. impact: only those whose Detonation has the
 * result entity impact count. NULL: there is none. */
static const Track *longest_flight(const Survey *survey, const Config *config, bool guided, bool impact)
{
    const Track *longest = NULL;
    double       most_s = config->exercise.causal ? -1 : 0; /* a single report: the flight may continue */
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        const Shot  *shot = survey_shot(survey, track->id);
        if (track->type.kind != dis_kind_munition || track->type.category == dis_munition_fixed) continue;
        if ((track->type.category == dis_munition_guided) != guided) continue;
        if (!guided && lies(track)) continue;
        if (config->exercise.causal && has_ended(survey, track, config)) continue;
        if (impact && !(shot && shot->result == dis_result_entity_impact)) continue;
        const double end_s =
            shot && isfinite(shot->detonation_s) ? shot->detonation_s : track->point[track->count - 1].t_s;
        const double flight_s = end_s - track->point[0].t_s;
        if (flight_s > most_s) {
            most_s = flight_s;
            longest = track;
        }
    }
    return longest;
}

static bool may_fly(const Track *track)
{
    return track->type.kind == dis_kind_munition && track->type.category != dis_munition_fixed &&
           (track->type.category == dis_munition_guided || !lies(track));
}

/* From the first report of any munition in flight to the end of the last; the origin of the frame is where the
 * longest flight goes. */
static Status span_of_munitions(HostPlan *plan, const Survey *survey, const Config *config)
{
    int munitions = 0;
    plan->start_s = INFINITY, plan->end_s = -INFINITY;
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        const Shot  *shot = survey_shot(survey, track->id);
        munitions += track->type.kind == dis_kind_munition;
        if (!may_fly(track)) continue;
        const double end_s = track->point[track->count - 1].t_s;
        plan->start_s = fmin(plan->start_s, track->point[0].t_s);
        plan->end_s = fmax(plan->end_s, shot && shot->detonation_s > end_s ? shot->detonation_s : end_s);
    }
    if (!isfinite(plan->start_s)) {
        log_error("replay: exercise.host: munition: none flies in the log, which has %d munition%s, mines and what "
                  "lies still included, among %d entities; `pitviper inspect LOG` lists them, --host ID or --host "
                  "observer shows what there is",
                  munitions, munitions == 1 ? "" : "s", survey->track_count);
        return STATUS_BAD_VALUE;
    }
    const Track *flight = longest_flight(survey, config, true, false);
    if (!flight) flight = longest_flight(survey, config, false, false);
    const Shot *shot = flight ? survey_shot(survey, flight->id) : NULL;
    if (shot && dis_entity_id_is_none(plan->aim))
        plan->aim = dis_entity_id_is_none(shot->target) ? shot->hit : shot->target;
    return STATUS_OK;
}

bool choice_host_is_known(const Survey *survey, const Config *config, const DisEntityId *host)
{
    DisEntityId aim, given;
    bool        flies = false;
    if (survey->track_count == 0) return false;
    if (*config->exercise.aim && !(dis_entity_id_parse(&aim, config->exercise.aim) && survey_track(survey, aim)))
        return false;
    if (host) return dis_entity_id_is_none(*host) || survey_track(survey, *host);
    if (!*config->exercise.host || strcmp(config->exercise.host, host_observer) == 0) return true;
    if (strcmp(config->exercise.host, host_munition) != 0)
        return dis_entity_id_parse(&given, config->exercise.host) && survey_track(survey, given);
    for (int t = 0; t < survey->track_count; t++) flies |= may_fly(&survey->track[t]);
    return flies;
}

static Status plan_munitions(HostPlan *out, Choices *choices, const Survey *survey, const Config *config)
{
    HostPlan plan = {.any_munition = true, .munition = true, .start_s = survey->last_s, .end_s = survey->last_s};
    choice_add(choices, "host: the munitions that appear, guided ones first, one after the other; their seeker is "
                        "a notional one (exercise.host)");
    if (*config->exercise.aim) dis_entity_id_parse(&plan.aim, config->exercise.aim);
    else
        choice_add(choices, "aim: the target of its Fire PDU once that is heard, till then along the body axis "
                            "(exercise.aim)");
    const Status status = config->exercise.causal ? STATUS_OK : span_of_munitions(&plan, survey, config);
    if (status == STATUS_OK) *out = plan;
    return status;
}

Status choice_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config)
{
    char        name[who_size];
    DisEntityId host;
    Status      status = aim_is_known(survey, config);
    if (status != STATUS_OK) return status;
    if (strcmp(config->exercise.host, host_munition) == 0) return plan_munitions(out, choices, survey, config);
    if (*config->exercise.cigi || *config->flight.missile || strcmp(config->exercise.host, host_observer) == 0)
        return plan_observer(out, choices, survey, config, true);
    if (*config->exercise.host) {
        if (!dis_entity_id_parse(&host, config->exercise.host) || dis_entity_id_is_none(host)) {
            log_error("replay: exercise.host: '%s' is neither site:application:entity nor munition nor observer",
                      config->exercise.host);
            return STATUS_BAD_VALUE;
        }
        return choice_named_host(out, choices, survey, config, host);
    }
    for (int guided = 1; guided >= 0; guided--) {
        const Track *impact = longest_flight(survey, config, guided, true);
        const Track *flight = impact ? impact : longest_flight(survey, config, guided, false);
        if (!flight) continue;
        choice_add(choices, "host: %s, %s%s; its seeker is a notional one (exercise.host)",
                   who(name, survey, flight->id),
                   impact ? "the longest flight that hit an entity" : "the longest flight",
                   guided ? "" : ", of unguided munitions");
        return choice_named_host(out, choices, survey, config, flight->id);
    }
    return plan_observer(out, choices, survey, config, false);
}

void choice_rate(HostPlan *plan, Choices *choices, const Config *config)
{
    plan->rate_hz = config->sensor.rate_hz;
    if (plan->rate_hz > 0) return;
    /* a flight lasts seconds, an observation minutes; what steers by its frames needs more of them */
    plan->rate_hz = *config->flight.missile ? 20 : plan->munition ? 5 : 1;
    if (!*config->exercise.cigi) choice_add(choices, "rate: %g frames a second (sensor.rate_hz)", plan->rate_hz);
}
