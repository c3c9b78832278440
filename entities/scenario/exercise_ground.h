/* entities/scenario/exercise_ground.h: the ground of a generated exercise: smooth, in the tangent plane of its place.
 *
 * Synthetic: swells over the curved Earth, slopes below 2.4 % at 1.5 m. From files or a terrain store: through a
 * cubic B-spline of `smooth_m`, so that velocity and angular rate of vehicles on it are continuous. */
#ifndef ENTITIES_SCENARIO_EXERCISE_GROUND_H
#define ENTITIES_SCENARIO_EXERCISE_GROUND_H

#include "entities/scenario/scenario.h"
#include "terrain/elevation/elevation.h"
#include "terrain/earth/local_frame.h"
#include "terrain/landscape/landscape.h"

typedef struct ExerciseGround {
    LocalFrame frame;
    double     half_curvature[2]; /* of the ellipsoid, eastward and northward, 1/(2 m) */
    double     swell_m, phase_rad[2];
    bool       real;
    double     smooth_m;
    Elevation  elevation;
    Landscape  stored;            /* of a terrain store, in its own frame; cover NULL: none */
} ExerciseGround;

/* Reads the files of ground.elevation. Failures are logged. */
Status exercise_ground_create(ExerciseGround *out, const Scenario *scenario);
void   exercise_ground_destroy(ExerciseGround *ground);

/* z of the ENU plane, and its slope by x and y (may be NULL). Synthetic: the swells are added along z, not along the
 * local vertical: 4 mm off at 16 km. */
double exercise_ground_at(double slope[2], const ExerciseGround *ground, double x_m, double y_m);
/* The same of the ellipsoid at the height of the place: the sea. Within 1 cm at 30 km
 * (tests/entities/test_exercise_cast.c). */
double exercise_level_at(double slope[2], const ExerciseGround *ground, double x_m, double y_m);

#endif
