/* sensor/node/choices.h: automatic choices of replay and run: host, aim, time of day, ground. Each choice is one
 * line with the key that changes it. Causal choices (exercise.causal) use what the survey has received so far: a
 * host or an aim given by name may appear later. */
#ifndef SENSOR_NODE_CHOICES_H
#define SENSOR_NODE_CHOICES_H

#include "entities/catalog/catalog.h"
#include "entities/survey/survey.h"
#include "sensor/settings/choice_lines.h"
#include "sensor/settings/config.h"
#include "terrain/landscape/landscape.h"

/* The host of the sensor, its span of exercise time, and its aim. */
typedef struct HostPlan {
    DisEntityId host;      /* 0:0:0: the stand-off observer, or the next munition */
    bool        any_munition; /* munitions become the host one after the other as they appear: player_munition */
    DisEntityId aim;       /* 0:0:0: none known: along the body axis, or the position below */
    double      start_s, end_s;
    double      p_aim_ecef[3]; /* position to aim at when there is no aim entity; valid for an observer */
    bool        munition;
    double      rate_hz;   /* choose_rate */
} HostPlan;

extern const char host_munition[], host_observer[]; /* values of exercise.host that are not ids */

/* Of the guided munitions, else of the others, never mines: the one with a Detonation of result entity impact,
 * longest flight first; else the longest flight; else an observer orbiting the vehicle with the longest path; else
 * an observer orbiting the centre of all entities received. Causal: the longest flight among munitions that are
 * still present, else the observer. */
Status choose_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config);
/* For a host given by name; 0:0:0: the observer. STATUS_BAD_VALUE and a message when the log does not contain it. */
Status plan_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config, DisEntityId host);

/* Frames per second of exercise time, into the plan. */
void choose_rate(HostPlan *plan, Choices *choices, const Config *config);
/* Unix time of exercise time 0. Also reports senders whose time stamps are not a clock. */
Status choose_time(double *unix_s, Choices *choices, const Survey *survey, const Config *config,
                   const LocalFrame *frame);
/* Reports when optical images of this place will be black: the sun more than 6 degrees below the horizon, the end of
 * civil twilight, at the beginning or the end of the plan. */
void choice_report_night(Choices *choices, unsigned bands, double unix_s, const HostPlan *plan, const LocalFrame *frame);
/* The exercise identifier to receive: as configured, or the one with the most usable Entity States; -1: all. Causal:
 * also with a single exercise, since others may follow. */
int    choose_exercise(Choices *choices, const DisLog *log, const Config *config);
/* The local frame, with its origin amid the entities. */
Status choose_frame(LocalFrame *out, const Survey *survey, const HostPlan *plan);
/* Entities that are clamped to the ground: none, those inconsistent with synthetic terrain, or all on the ground. */
typedef enum GroundContact { GROUND_CONTACT_NONE, GROUND_CONTACT_INCONSISTENT, GROUND_CONTACT_ALL } GroundContact;

/* The ground: from the files of terrain.*, else synthetic terrain with its sea, fitted to the log (see
 * ground_evidence.h). contact: which entities are clamped to it (terrain.ground), later ones too. */
Status choose_ground(Landscape *out, GroundContact *contact, Choices *choices, const Survey *survey,
                     const Config *config, const LocalFrame *frame, const Catalog *catalog, const HostPlan *plan);

/* Shared by the files of choices. */
bool        choice_is_land(const Track *track);
bool        choice_flies(const Track *track);
const Shot *choice_shot_of(const Survey *survey, DisEntityId munition); /* NULL: none received */

#endif
