/* terrain/woods/plant.h: the kinds of plants (and stones), and one of them where it stands. */
#ifndef TERRAIN_WOODS_PLANT_H
#define TERRAIN_WOODS_PLANT_H

#include "pitviper.h"

typedef enum PlantKind {
    /* trees */
    PLANT_PINE,
    PLANT_ALDER,
    PLANT_BIRCH,
    PLANT_ENGLISH_OAK,
    PLANT_SESSILE_OAK,
    PLANT_RED_OAK,
    PLANT_WHITE_OAK,
    PLANT_TREES,
    /* woody plants without a trunk: placed with the trees, once and for all */
    PLANT_BUSH = PLANT_TREES,
    PLANT_HEDGE,
    PLANT_STANDING, /* all before it are in Woods.plant */
    /* low plants and stones: only near the eye (woods_low_plants) */
    PLANT_REED = PLANT_STANDING,
    PLANT_GRASS,
    PLANT_DRY_GRASS,
    PLANT_CROP,
    PLANT_ROCK,
    PLANT_KINDS
} PlantKind;

const char        *plant_name(PlantKind kind); /* "pine", "english_oak", "hedge" ... */
static inline bool plant_is_tree(PlantKind kind) { return kind < PLANT_TREES; }
/* Radius of its prototype's crown over its height, about (tests/render/test_plants.c). */
double plant_crown_share(PlantKind kind);
/* Whether it drops its leaves in winter. */
bool plant_is_deciduous(PlantKind kind);

/* What a place of it is made of. */
typedef enum PlantOrgan { PLANT_BARK, PLANT_LEAF, PLANT_STONE, PLANT_ORGANS } PlantOrgan;

static const double plant_most_tilt_rad = 15 * rad_per_deg;
static const double plant_height_step_m = 0.01; /* of Plant.height */

/* One plant: a prototype of its kind, 1 m high about its own z axis, is widened by width and scaled to its height,
 * turned about its axis by twist, and leaned. 20 octets. */
typedef struct Plant {
    float    p_m[3];  /* foot, east north up from the origin of its list */
    uint16_t height;  /* of plant_height_step_m; > 0 */
    uint16_t twist;   /* of 2 pi / 65536, about the axis, from east to north */
    int8_t   lean[2]; /* of plant_most_tilt_rad / 127: the axis' slope towards east, and north */
    uint8_t  kind;    /* PlantKind */
    uint8_t  width;   /* of 1/128: horizontal scale over vertical scale; 128: as the prototype */
} Plant;

static inline double plant_height_m(const Plant *plant) { return plant->height * plant_height_step_m; }
/* The prototype's axes as the plant stands, unit, ENU; scales: across, along its axis. sway: added to the lean, rad
 * east and north; NULL: none. */
void plant_axes(double axis_enu[3][3], double scale[2], const Plant *plant, const double sway_rad[2]);
/* From the prototype's axes to ENU, with its scales: columns are the images of x, y, z. */
void plant_transform(double m_enu_from_plant[9], const Plant *plant, const double sway_rad[2]);

#endif
