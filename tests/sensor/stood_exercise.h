/* tests/sensor/stood_exercise.h: an exercise of a few entities that stand, drive or fly on straight lines, by hand. */
#ifndef TESTS_SENSOR_STOOD_EXERCISE_H
#define TESTS_SENSOR_STOOD_EXERCISE_H

#include "entities/motion/dead_reckoning.h"
#include "tests/check.h"

#include "sensor/node/choices/choices.h"

enum { most_tracks = 24, most_points = 16 };

static Catalog   *catalog;
static LocalFrame frame;

typedef struct Exercise {
    Survey     survey;
    Track      track[most_tracks];
    TrackPoint point[most_tracks][most_points];
    Shot       shot[4];
} Exercise;

static const DisEntityType tank = {1, 1, 225, 1, 1, 0, 0}, man = {.kind = 3}, house = {.kind = 5, .domain = 1},
                           crate = {.kind = 6}, radar_site = {.kind = 9, .domain = 1}, mine = {2, 2, 225, 3, 0, 0, 0},
                           sea_mine = {2, 6, 225, 3, 0, 0, 0}, helicopter = {1, 2, 225, 20, 1, 0, 0},
                           jet = {1, 2, 225, 1, 1, 0, 0}, ship = {1, 3, 225, 6, 1, 0, 0},
                           submarine = {1, 4, 225, 1, 0, 0, 0}, missile = {2, 2, 225, 1, 1, 0, 0};

/* Reports every 2 s along a straight line, base h_m above the ellipsoid, level; speed in x. */
static inline Track *stand(Exercise *e, DisEntityType type, double x_m, double y_m, double h_m, double speed_mps,
                           int reports)
{
    const int    t = e->survey.track_count++;
    Track       *track = &e->track[t];
    Origin       origin;
    const Model *model = catalog_model(catalog, catalog_find(catalog, type, &origin, NULL));
    assert_true(t < most_tracks && reports <= most_points);
    *track = (Track){.id = {1, 1, (uint16_t)(t + 1)}, .type = type, .count = reports, .point = e->point[t]};
    snprintf(track->marking, sizeof track->marking, "E%d", (t + 1) % 100);
    for (int n = 0; n < reports; n++) {
        TrackPoint         *p = &track->point[n];
        double              p_enu[3] = {x_m + 2 * n * speed_mps, y_m, h_m}, v_enu[3] = {speed_mps, 0, 0};
        static const double r_enu_from_body[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1}; /* eastwards */
        Geodetic            place;
        *p = (TrackPoint){.t_s = 100 + 2 * n};
        for (int k = 0; k < 4; k++) { /* to that height above the ellipsoid */
            ecef_from_enu(p->p_ecef, &frame, p_enu);
            assert_int_equal(geodetic_from_ecef(&place, p->p_ecef), STATUS_OK);
            p_enu[2] += h_m - place.h_m;
        }
        double r[9], euler[3];
        m3_mul(r, frame.r_ecef_from_enu, r_enu_from_body);
        euler_from_r_ecef_from_body(&euler[0], &euler[1], &euler[2], r);
        for (int k = 0; k < 3; k++) p->euler_rad[k] = (float)euler[k];
        survey_point_rotation(r, p);
        m3_mul_v3(p->v_ecef_mps, frame.r_ecef_from_enu, v_enu);
        if (origin == ORIGIN_CENTRE)
            for (int k = 0; k < 3; k++) p->p_ecef[k] -= 0.5 * model->height_m * r[3 * k + 2];
    }
    return track;
}

static inline Exercise *fresh(void)
{
    static Exercise e;
    memset(&e, 0, sizeof e);
    e.survey = (Survey){.track = e.track, .shot = e.shot, .first_s = 100, .last_s = 130};
    return &e;
}

static inline bool says(const Choices *choices, const char *text)
{
    for (int i = 0; i < choices->count; i++)
        if (strstr(choices->line[i], text)) return true;
    for (int i = 0; i < choices->count; i++) printf("said: %s\n", choices->line[i]);
    return false;
}

/* The ground and the woods of a plan, as a run chooses them. */
static inline Status stood_ground(Landscape *out, GroundContact *contact, Choices *choices, const Exercise *e,
                                  const Config *config, const HostPlan *plan)
{
    GroundEvidence *evidence = NULL;
    Status          status = choice_evidence(&evidence, &e->survey, catalog, &frame);
    if (status == STATUS_OK)
        status = choice_ground(out, contact, choices, &(ChoiceBasis){&e->survey, config, catalog, evidence, NULL, NULL},
                               &frame);
    if (status == STATUS_OK) choice_report_submerged(choices, &e->survey, evidence, plan);
    choice_evidence_free(evidence);
    return status;
}

static inline Status stood_woods(WoodsChoice *out, Choices *choices, const Exercise *e, const Config *config,
                                 const HostPlan *plan, const Landscape *land)
{
    static const Culture nothing;
    GroundEvidence      *evidence = NULL;
    WoodsSquare          square;
    Status               status = choice_evidence(&evidence, &e->survey, catalog, &land->frame);
    if (status == STATUS_OK) status = choice_square(&square, &e->survey, config, &land->frame, plan);
    if (status == STATUS_OK)
        status = choice_woods(out, choices, &(ChoiceBasis){&e->survey, config, catalog, evidence, NULL, NULL}, &square,
                              land, &nothing, NULL);
    choice_evidence_free(evidence);
    return status;
}

static int open_place(void **state)
{
    (void)state;
    char           path[4096];
    const Geodetic origin = {36 * rad_per_deg, -5 * rad_per_deg, 0};
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    return etc_path(path, sizeof path, "catalog.csv") && catalog_open(&catalog, path, 0.1) == STATUS_OK ? 0 : -1;
}

static int close_place(void **state)
{
    (void)state;
    catalog_close(catalog);
    return 0;
}

#endif
