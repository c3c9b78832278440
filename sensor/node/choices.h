/* sensor/node/choices.h: what replay and run pick when nobody said: host, aim, time of day, ground. Each choice is one
 * line with the key that changes it. Causal choices (exercise.causal) know what the survey has heard, and that more may
 * come: a host or an aim given by name may appear later. */
#ifndef SENSOR_NODE_CHOICES_H
#define SENSOR_NODE_CHOICES_H

#include "entities/catalog/catalog.h"
#include "entities/survey/survey.h"
#include "sensor/settings/choice_lines.h"
#include "sensor/settings/config.h"
#include "terrain/landscape/landscape.h"

/* Who carries the sensor, over which span of exercise time, and what it looks at. */
typedef struct HostPlan {
    DisEntityId host;      /* 0:0:0: the stand-off observer, or whoever comes */
    bool        any_munition; /* the munitions that appear are the host, one after the other: player_munition */
    DisEntityId aim;       /* 0:0:0: none known: along the body axis, or the place below */
    double      start_s, end_s;
    double      p_aim_ecef[3]; /* where to look when there is no aim entity; valid for an observer */
    bool        munition;
    double      rate_hz;   /* choose_rate */
} HostPlan;

extern const char host_munition[], host_observer[]; /* what exercise.host says but ids */

/* Of the guided munitions, else of the others, mines never: the one whose Detonation says entity impact, longest
 * flight first; else the longest flight; else an observer circling the vehicle that went farthest; else an observer of
 * the middle of whatever was heard. Causal: the longest flight among munitions that are still there, else the
 * observer. */
Status choose_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config);
/* For a host that was asked for by name; 0:0:0: the observer. STATUS_BAD_VALUE and a message when the log does not hold
 * it. */
Status plan_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config, DisEntityId host);

/* Frames a second of exercise time, into the plan. */
void choose_rate(HostPlan *plan, Choices *choices, const Config *config);
/* Unix time of exercise time 0. Also says whose time stamps are no clock. */
Status choose_time(double *unix_s, Choices *choices, const Survey *survey, const Config *config,
                   const LocalFrame *frame);
/* A line when optical pictures of this place will be black: the sun more than 6 degrees below the horizon, the end of
 * civil twilight, at the beginning or the end of the plan. */
void choice_report_night(Choices *choices, unsigned bands, double unix_s, const HostPlan *plan, const LocalFrame *frame);
/* The exercise identifier to hear: as configured, or the one with most usable Entity States; -1: all. Causal: also
 * where there is but one, others may come. */
int    choose_exercise(Choices *choices, const DisLog *log, const Config *config);
/* The local frame amid the action. */
Status choose_frame(LocalFrame *out, const Survey *survey, const HostPlan *plan);
/* Which entities are set onto the ground: none, those that invented ground does not fit, or all that stand on it. */
typedef enum GroundContact { GROUND_CONTACT_NONE, GROUND_CONTACT_INCONSISTENT, GROUND_CONTACT_ALL } GroundContact;

/* The ground: of the files of terrain.*, else the invented landscape with its sea, fitted to the log (see
 * ground_evidence.h). contact: which entities are set onto it (terrain.ground); later ones too. */
Status choose_ground(Landscape *out, GroundContact *contact, Choices *choices, const Survey *survey,
                     const Config *config, const LocalFrame *frame, const Catalog *catalog, const HostPlan *plan);

/* Shared by the files of choices. */
bool        choice_is_land(const Track *track);
bool        choice_flies(const Track *track);
const Shot *choice_shot_of(const Survey *survey, DisEntityId munition); /* NULL: none heard */

#endif
