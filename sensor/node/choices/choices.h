/* sensor/node/choices/choices.h: automatic choices of replay and run: host, aim, time of day, ground, plants. Each
 * choice is one line with the key that changes it. Causal choices (exercise.causal) use what the survey has received
 * so far: a host or an aim given by name may appear later. */
#ifndef SENSOR_NODE_CHOICES_CHOICES_H
#define SENSOR_NODE_CHOICES_CHOICES_H

#include "entities/catalog/catalog.h"
#include "entities/survey/survey.h"
#include "sensor/frame/frame_scenery.h"
#include "sensor/settings/config.h"
#include "pitviper_sha256.h"
#include "terrain/ground/landscape.h"
#include "terrain/woods/woods.h"

/* ---- host and aim ------------------------------------------------------------------------------------- */

/* The host of the sensor, its span of exercise time, and its aim. */
typedef struct HostPlan {
    DisEntityId host;         /* 0:0:0: the stand-off observer, or the next munition */
    bool        any_munition; /* munitions become the host one after the other as they appear: player_munition */
    DisEntityId aim;          /* 0:0:0: none known: along the body axis, or the position below */
    double      start_s, end_s;
    double      p_aim_ecef[3]; /* position to aim at when there is no aim entity; valid for an observer */
    bool        munition;
    double      rate_hz; /* choice_rate */
} HostPlan;

extern const char host_munition[], host_observer[]; /* values of exercise.host that are not ids */
/* Names the host of a plan: its id, or one of these. */
void choice_host_name(char out[dis_id_text_size], const HostPlan *plan);

/* Chooses the host. First come guided munitions, else the others, never mines: the one with a Detonation of result
 * entity impact, longest flight first, else the longest flight. Then comes an observer that orbits the vehicle with the
 * longest path, then one that orbits the centre of all entities. Causal: the longest flight among munitions that are
 * still present, else the observer. */
Status choice_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config);
/* Takes a host given by name; 0:0:0 is the observer. STATUS_BAD_VALUE and a message when the log does not contain it.
 */
Status choice_named_host(HostPlan *out, Choices *choices, const Survey *survey, const Config *config, DisEntityId host);
/* Whether choice_named_host, or choice_host where host is NULL, has what it is asked for in this survey; says nothing.
 */
bool choice_host_is_known(const Survey *survey, const Config *config, const DisEntityId *host);
/* Puts the frames per second of exercise time into the plan. */
void choice_rate(HostPlan *plan, Choices *choices, const Config *config);
/* The entity nearest to a position at an instant, within 200 m, other than `not`; munitions do not count. 0:0:0: none.
 */
DisEntityId choice_nearest_entity(const Survey *survey, const double p_ecef[3], double t_s, DisEntityId not );
/* Whether it is a platform of domain land. */
bool choice_is_land(const Track *track);

/* ---- exercise, time, frame, shapes -------------------------------------------------------------------- */

/* The exercise identifier to receive: as configured, or the one with the most usable Entity States; -1: all. Causal:
 * also with a single exercise, since others may follow. */
int choice_exercise(Choices *choices, const DisLog *log, const Config *config);
/* Unix time of exercise time 0. Also reports senders whose time stamps are not a clock. */
Status choice_time(double *unix_s, Choices *choices, const Survey *survey, const Config *config,
                   const LocalFrame *frame);
/* Reports when optical images of this place will be black but for lamps: at the beginning or the end of the plan the
 * sun is more than 6 degrees below the horizon (the end of civil twilight). */
void choice_report_night(Choices *choices, unsigned bands, double unix_s, const HostPlan *plan,
                         const LocalFrame *frame);
/* The world's local frame. It is the exercise's: a grid of cells of choice_cell_m lies about the middle of what is on
 * land, else of all entities; the origin is the place of the aim's cell where an entity was, nearest the cell's centre.
 * Aims of one cell, and all hosts with them, have one world, which reaches some km beyond. */
static const double choice_cell_m = 4000;
Status              choice_frame(LocalFrame *out, const Survey *survey, const HostPlan *plan);
/* The same; with terrain.place that of its ground, whatever the exercise. */
Status choice_world_frame(LocalFrame *out, const Survey *survey, const Config *config, const HostPlan *plan);
/* Where the aim, else the host is at the end of the plan, on the ellipsoid. False: neither was heard. */
bool choice_aim_place(double p_ecef[3], const Survey *survey, const HostPlan *plan);
/* Builds the models of all types in the survey, so that no frame waits for one, and reports each type once when it
 * is not rendered (`none` in the catalog), or when no row matches (rendered as a wedge). At most four types by name. */
void choice_shapes(Choices *choices, const Survey *survey, const Catalog *catalog);

/* ---- ground and plants -------------------------------------------------------------------------------- */

/* What the reports of an exercise imply about its ground, in one frame (ground_evidence_private.h), for every host and
 * aim. choice_evidence_free accepts NULL. */
typedef struct GroundEvidence GroundEvidence;
Status choice_evidence(GroundEvidence **out, const Survey *survey, const Catalog *catalog, const LocalFrame *frame);
void   choice_evidence_free(GroundEvidence *evidence);
/* Adds all of it to a hash. False: out of memory. */
bool choice_evidence_hash(Sha256 *digest, const GroundEvidence *evidence);

/* What ground and plants follow from: no host and no aim. */
typedef struct ChoiceBasis {
    const Survey         *survey;
    const Config         *config;
    const Catalog        *catalog;
    const GroundEvidence *evidence;
    Cache                *cache;   /* where invented ground and plants that stand on it are kept; NULL: nowhere */
    const char           *follows; /* WoodsConfig.follows */
} ChoiceBasis;

/* Entities that are clamped to the ground: none, those inconsistent with synthetic terrain, or all on the ground. */
typedef enum GroundContact { GROUND_CONTACT_NONE, GROUND_CONTACT_INCONSISTENT, GROUND_CONTACT_ALL } GroundContact;

/* The ground: from terrain.store or the files of terrain.*, else synthetic terrain with its sea, fitted to the log (see
 * ground_evidence_private.h). contact: which entities are clamped to it (terrain.ground), later ones too. */
Status choice_ground(Landscape *out, GroundContact *contact, Choices *choices, const ChoiceBasis *basis,
                     const LocalFrame *frame);
/* With terrain.place: the ground, which follows from no exercise, and what an exercise is to it. */
Status choice_placed_ground(Landscape *out, const Config *config, Cache *cache);
Status choice_placed_contact(GroundContact *contact, Choices *choices, const ChoiceBasis *basis,
                             const Landscape *landscape);
/* Reports an aim under water, which is not visible from above it. */
void choice_report_submerged(Choices *choices, const Survey *survey, const GroundEvidence *evidence,
                             const HostPlan *plan);
/* With terrain.store everything uses the store's own local frame. Changed sources of the store are imported again
 * first. p_ecef: the aim, or the origin that the exercise would have without it. STATUS_BAD_VALUE, logged: that is not
 * on the store's ground. */
Status choice_store_frame(LocalFrame *out, Choices *choices, const Config *config, const double p_ecef[3]);

/* Where plants stand in a run: about what is on the ground, clear of what the exercise says.
 *
 * On invented ground no stem stands within what drove on the ground, where a burst hit it, or where a flight or the
 * line of sight of a shot that hit passes low, as far as the log tells that the world is made from; nothing else of the
 * ground and its plants follows from a path. On ground of terrain.place, whose plants the exercise was placed among,
 * what stands has its own footprint and half a metre. Real trees stay; entities that begin within a trunk are counted.
 */
typedef struct WoodsChoice {
    bool        on; /* terrain.woods */
    WoodsConfig config;
    WoodsPath  *path;  /* config.path */
    WoodsPlace *place; /* config.place */
    Woods       woods;
    int         entities, in_trunks; /* on the ground at their first report; of these within a trunk */
} WoodsChoice;

/* The square in which they stand: of the world, with room for host and entities in steps, so that neighbouring ranges
 * have one; with terrain.woods_half_m, the aim's own. */
typedef struct WoodsSquare {
    double centre_m[2], half_width_m; /* ENU */
    bool   own;
} WoodsSquare;
Status choice_square(WoodsSquare *out, const Survey *survey, const Config *config, const LocalFrame *frame,
                     const HostPlan *plan);
/* The landscape and the configuration must outlive it. With terrain.woods off: not on, nothing is done.
 * choice_woods_free after success and failure. */
Status choice_woods(WoodsChoice *out, Choices *choices, const ChoiceBasis *basis, const WoodsSquare *square,
                    const Landscape *landscape, const Culture *culture, Pool *pool);
void   choice_woods_free(WoodsChoice *woods);

/* ---- what people built, and clutter -------------------------------------------------------------------- */

/* With terrain.place: where vehicles of the log stand and drive on the ground, within the square. */
Status choice_driven(DrivenPath **out, int *count, const ChoiceBasis *basis, const WoodsSquare *square,
                     const Landscape *landscape);
/* Which buildings of it the exercise damages, and when: plan->harm. culture: indexed. At most 4096 bursts. */
Status choice_harm(SceneryPlan *plan, const Culture *culture, const ChoiceBasis *basis, const LocalFrame *frame);
/* Adds all that it follows from to a hash. False: out of memory. */
bool choice_harm_hash(Sha256 *digest, const Survey *survey);
/* Distance to which a burst of this charge does that damage, 1 .. 3, m; the damage of a burst to a building, 0 .. 3. */
double choice_harm_radius(double charge_kg, int damage);
int    choice_burst_damage(const Culture *culture, int building, const double p_enu[3], double charge_kg);
/* The building that an entity of this type and model (of the catalog; -1: none) stands for at a place: one of kind 5
 * whose model is a building, within the outline. -1: none. */
int choice_building_of(const Culture *culture, const Catalog *catalog, DisEntityType type, int model,
                       const double p_enu[3]);
/* Of the same square: terrain.buildings, terrain.trees, terrain.clutter, and what the exercise damages.
 * frame_scenery_free after success and failure. */
Status choice_scenery(FrameScenery *out, Choices *choices, const ChoiceBasis *basis, const WoodsSquare *square,
                      const Landscape *landscape);

#endif
