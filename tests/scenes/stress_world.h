/* tests/scenes/stress_world.h: blocks of 4 x 2 x 1.5 m in a vacuum, or on flat ground: pictures with
 * closed-form results. */
#ifndef TESTS_SCENES_STRESS_WORLD_H
#define TESTS_SCENES_STRESS_WORLD_H

#include "tests/bench/stress.h"
#include "render/frame/render.h"

enum { stress_entities = 10000 };

typedef struct StressWorld {
    Catalog        *catalog;
    Landscape       landscape;
    World           world; /* without ground; .landscape = &landscape puts it there */
    Pool           *pool;
    Arena          *arena, *air_arena;
    Air             air;
    SnapshotEntity *entity; /* [stress_entities] */
    NodePose       *pose;
    Snapshot        snapshot;
    Picture         picture; /* the last one, valid until the next */
} StressWorld;

static const float  stress_rho = 0.5f, stress_rho_ir = 0.2f;
static const double stress_sun_w_m2 = 300;
static const double stress_size_m[3] = {4, 2, 1.5}; /* forward, right, up */

Status stress_world_open(StressWorld *out, int threads);
void   stress_world_close(StressWorld *w);
void   stress_clear(StressWorld *w);
/* A block with the middle of its left side at p_enu; r_enu_from_body: forward, right, down. */
void stress_add(StressWorld *w, const double p_enu[3], const double r_enu_from_body[9]);
/* A sun, with no other source, extinction or emission. */
void stress_no_air(StressWorld *w, const double sun_enu[3]);
/* The air of the tables. */
Status stress_real_air(StressWorld *w, double sun_elevation_rad, double eye_m);
/* Camera at p_enu towards d_enu, columns rotated about it. */
View stress_view(const double p_enu[3], const double d_enu[3], double turn_rad, int width, int height, double focal_px);
RenderRequest stress_request(const View *view);
/* Into w->picture. */
bool stress_render(StressWorld *w, const RenderRequest *request);
/* Of all its planes: values that are not finite (range and temperature of the sky apart) or below 0 where they must
 * not be. */
double stress_bad_values(const Picture *picture);
/* Values of all planes in which two pictures differ, over a window of both. */
double stress_differences(const Picture *a, int ax, int ay, const Picture *b, int bx, int by, int width, int height);

#endif
