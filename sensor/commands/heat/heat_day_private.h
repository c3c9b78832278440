/* sensor/commands/heat/heat_day_private.h: temperatures of one vehicle over a clear day: computed, as a table, as
 * images.
 *
 * Hours are of local mean solar time; the day begins at midnight. Before that the vehicle has stood as
 * render/heat/vehicle_heat.h assumes. */
#ifndef SENSOR_COMMANDS_HEAT_HEAT_DAY_PRIVATE_H
#define SENSOR_COMMANDS_HEAT_HEAT_DAY_PRIVATE_H

#include "sensor/commands/model/model_stage.h"

enum {
    heat_day_rows = 145,
    heat_day_row_s = 600,
    heat_day_images = 8,
    heat_day_image_s = 10800,
    heat_day_name_size = 2 * model_name_size + 32,
    heat_day_most_crossings = 16
};

typedef struct HeatDayConfig {
    double drive_from_s, drive_to_s; /* of the day; equal: it does not drive */
    double heading_rad;              /* clockwise from north */
    double step_s;                   /* a divisor of heat_day_row_s */
} HeatDayConfig;

typedef struct HeatDayRow {
    double air_k, ground_k, dt_k; /* dt_k: mean of the patches by area, less the ground */
    double engine_k, cabin_k;     /* NaN: it has none */
} HeatDayRow;

typedef struct HeatDay {
    const char *model; /* its name, that of the catalog's */
    int         patches;
    char (*name)[heat_day_name_size]; /* of patches, unique: part and side */
    char (*part)[model_name_size];    /* of patches: of the first part of its body */
    double    *area_m2;               /* [patches] */
    HeatDayRow row[heat_day_rows];
    float     *patch_k; /* [heat_day_rows][patches] */
    int        crossings;
    double     crossing_h[heat_day_most_crossings]; /* when dt_k changes sign */
} HeatDay;

/* Sheets of one band's images. */
typedef struct HeatImages {
    float *radiance[2]; /* MWIR, LWIR; W/(m2 sr); [heat_day_images][pixels of one] */
} HeatImages;

Status heat_images_open(HeatImages *images);
void   heat_images_close(HeatImages *images); /* accepts zeroes */
/* Writes the images. path[2]: the PNG of MWIR and that of LWIR. Each band has one scale of apparent temperature. */
Status heat_images_write(const HeatImages *images, const ModelStage *stage, const char *const path[2]);

/* day: zeroes. Draws the images on its way. On failure heat_day_free is still due. */
Status heat_day_run(HeatDay *day, HeatImages *images, ModelStage *stage, const HeatDayConfig *config);
void   heat_day_free(HeatDay *day); /* accepts zeroes */
Status heat_day_write_csv(FILE *to, const HeatDay *day);

#endif
