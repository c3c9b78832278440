/* sensor/node/choices/place_choice.c: where the world of an exercise lies. It belongs to the exercise, not to the aim:
 * a grid of cells lies about the middle of what the recording holds, and all aims of one cell have one world. */
#include "sensor/node/choices/choices.h"

#include "terrain/ground/placed.h"

#include <stdlib.h>

/* Where entities were at their first and last reports: of those on land, else of all; on the ellipsoid. */
typedef struct Places {
    int count;
    double (*p_ecef)[3];
} Places;

static Status to_ellipsoid(double out_ecef[3], const double p_ecef[3])
{
    Geodetic place;
    Status   status = geodetic_from_ecef(&place, p_ecef);
    place.h_m = 0;
    return status == STATUS_OK ? ecef_from_geodetic(out_ecef, NULL, &place) : status;
}

static Status collect(Places *out, const Survey *survey)
{
    bool land = false;
    for (int t = 0; t < survey->track_count; t++) land |= choice_is_land(&survey->track[t]);
    *out = (Places){0, malloc((2 * (size_t)survey->track_count + 1) * sizeof *out->p_ecef)};
    if (!out->p_ecef) return STATUS_NO_MEMORY;
    for (int t = 0; t < survey->track_count; t++) {
        const Track *track = &survey->track[t];
        if (land && !choice_is_land(track)) continue;
        out->count += to_ellipsoid(out->p_ecef[out->count], track->point[0].p_ecef) == STATUS_OK;
        out->count += to_ellipsoid(out->p_ecef[out->count], track->point[track->count - 1].p_ecef) == STATUS_OK;
    }
    return STATUS_OK;
}

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* The place nearest to the median of each coordinate: one of the places, wherever on the Earth they are. */
static Status middle_of(int *out, const Places *places)
{
    double *value = malloc((size_t)places->count * sizeof *value), middle[3], least_m = INFINITY;
    if (!value) return STATUS_NO_MEMORY;
    for (int k = 0; k < 3; k++) {
        for (int n = 0; n < places->count; n++) value[n] = places->p_ecef[n][k];
        qsort(value, (size_t)places->count, sizeof *value, by_value);
        middle[k] = value[places->count / 2];
    }
    free(value);
    for (int n = 0; n < places->count; n++) {
        double d[3];
        v3_sub(d, places->p_ecef[n], middle);
        if (v3_length(d) >= least_m) continue;
        least_m = v3_length(d), *out = n;
    }
    return STATUS_OK;
}

static Status frame_about(LocalFrame *out, const double p_ecef[3])
{
    Geodetic place;
    Status   status = geodetic_from_ecef(&place, p_ecef);
    place.h_m = 0;
    return status == STATUS_OK ? local_frame_at(out, &place) : status;
}

/* The grid's middle cell is about the box of the places near the middle one: an exercise that fits into a cell has one
 * world. The grid is of three dimensions: it has no seam and no pole. */
static Status lay_grid(LocalFrame *out, const Places *places)
{
    double     low[2] = {0}, high[2] = {0}, p_ecef[3];
    LocalFrame about;
    int        middle = 0;
    Status     status = middle_of(&middle, places);
    if (status == STATUS_OK) status = frame_about(&about, places->p_ecef[middle]);
    if (status != STATUS_OK) return status;
    for (int n = 0; n < places->count; n++) {
        double p_enu[3];
        enu_from_ecef(p_enu, &about, places->p_ecef[n]);
        if (!(v3_length(p_enu) <= choice_cell_m)) continue;
        for (int k = 0; k < 2; k++) low[k] = fmin(low[k], p_enu[k]), high[k] = fmax(high[k], p_enu[k]);
    }
    ecef_from_enu(p_ecef, &about, (const double[3]){0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0});
    return frame_about(out, p_ecef);
}

static void cell_of(double cell[3], double p_enu[3], const LocalFrame *grid, const double p_ecef[3])
{
    enu_from_ecef(p_enu, grid, p_ecef);
    for (int k = 0; k < 3; k++) cell[k] = rint(p_enu[k] / choice_cell_m) + 0.0; /* no -0.0 */
}

/* The origin of a cell: the place in it that is nearest its centre, where the ground is one that was driven on; else
 * the centre. */
static Status origin_of(LocalFrame *out, const Places *places, const LocalFrame *grid, const double cell[3])
{
    double centre_enu[3], p_ecef[3], least_m = INFINITY;
    for (int k = 0; k < 3; k++) centre_enu[k] = cell[k] * choice_cell_m;
    ecef_from_enu(p_ecef, grid, centre_enu);
    for (int n = 0; n < places->count; n++) {
        double of[3], p_enu[3], d[3];
        cell_of(of, p_enu, grid, places->p_ecef[n]);
        v3_sub(d, p_enu, centre_enu);
        if (memcmp(of, cell, sizeof of) != 0 || v3_length(d) >= least_m) continue;
        least_m = v3_length(d);
        memcpy(p_ecef, places->p_ecef[n], sizeof p_ecef);
    }
    return frame_about(out, p_ecef);
}

bool choice_aim_place(double p_ecef[3], const Survey *survey, const HostPlan *plan)
{
    const Track *track = survey_track(survey, plan->aim);
    TrackPose    pose;
    if (!track) track = survey_track(survey, plan->host);
    if (!track) return false;
    survey_track_at(&pose, track, plan->end_s);
    return to_ellipsoid(p_ecef, pose.p_ecef) == STATUS_OK;
}

Status choice_frame(LocalFrame *out, const Survey *survey, const HostPlan *plan)
{
    Places     places;
    LocalFrame grid;
    double     cell[3] = {0}, p_enu[3], p_ecef[3];
    Status     status = collect(&places, survey);
    if (status == STATUS_OK && places.count == 0) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = lay_grid(&grid, &places);
    if (status == STATUS_OK && choice_aim_place(p_ecef, survey, plan)) cell_of(cell, p_enu, &grid, p_ecef);
    if (status == STATUS_OK) status = origin_of(out, &places, &grid, cell);
    free(places.p_ecef);
    return status;
}

Status choice_world_frame(LocalFrame *out, const Survey *survey, const Config *config, const HostPlan *plan)
{
    Geodetic place;
    if (!*config->terrain.place) return choice_frame(out, survey, plan);
    return landscape_place_parse(&place, config->terrain.place) ? landscape_place_frame(out, &place) : STATUS_BAD_VALUE;
}
