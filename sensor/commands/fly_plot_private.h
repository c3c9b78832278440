/* sensor/commands/fly_plot_private.h: paths of flights, as a plot: from the side and from above. */
#ifndef SENSOR_COMMANDS_FLY_PLOT_PRIVATE_H
#define SENSOR_COMMANDS_FLY_PLOT_PRIVATE_H

#include "entities/exercise/exercise.h"

enum { fly_paths_most = 100, fly_path_points = 300 };

/* m from the launch: along the direction of the launch, to its right, and up from its height. */
typedef struct FlyPath {
    int   points;
    bool  hit;
    float along_m[fly_path_points], right_m[fly_path_points], above_m[fly_path_points];
} FlyPath;

typedef struct FlyPaths {
    int     count;
    FlyPath path[fly_paths_most];
} FlyPaths;

/* Adds a flight, from its launch to its end; of more than fly_paths_most the first are kept. */
void fly_paths_take(FlyPaths *paths, const Cast *cast, const CastFlight *flight);
/* Writes an SVG file. Failures are logged. */
Status fly_paths_write(const FlyPaths *paths, const char *path, const char *scenario);

#endif
