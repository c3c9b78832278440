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
    /* woody plants without a trunk, placed once with the trees */
    PLANT_BUSH = PLANT_TREES,
    PLANT_HEDGE,
    PLANT_STANDING, /* kinds before this one are in Woods.plant */
    /* low plants and stones, which exist only near the eye (woods_low_plants) */
    PLANT_REED = PLANT_STANDING,
    PLANT_GRASS,
    PLANT_DRY_GRASS,
    PLANT_CROP,
    PLANT_ROCK,
    PLANT_KINDS
} PlantKind;

const char        *plant_name(PlantKind kind); /* "pine", "english_oak", "hedge" ... */
static inline bool plant_is_tree(PlantKind kind) { return kind < PLANT_TREES; }
/* Radius of the crown of the kind's prototype as a share of its height, approximate (tests/render/test_plants.c). */
double plant_crown_share(PlantKind kind);
/* Whether it drops its leaves in winter. */
bool plant_is_deciduous(PlantKind kind);

/* What a place on a plant is made of. */
typedef enum PlantOrgan { PLANT_BARK, PLANT_LEAF, PLANT_STONE, PLANT_ORGANS } PlantOrgan;

/* What a trunk is painted with, in a ring from plant_mark_low_m to plant_mark_high_m over its foot. */
typedef enum PlantMark { PLANT_UNMARKED, MARK_WHITE, MARK_RED, MARK_GREEN, MARK_BLUE, PLANT_MARKS } PlantMark;
static const double plant_mark_low_m = 1.0, plant_mark_high_m = 1.6;
const char         *plant_mark_name(PlantMark mark); /* "no", "white", "red" ... */

static const double plant_most_tilt_rad = 15 * rad_per_deg;
static const double plant_height_step_m = 0.01; /* unit of Plant.height */

/* One plant: a prototype of its kind, 1 m high about its own z axis, is widened by width and scaled to its height,
 * turned about its axis by twist, and leaned. 20 octets. */
typedef struct Plant {
    float    p_m[3]; /* position of its foot: east, north, up from the origin of its list */
    uint16_t height; /* in plant_height_step_m; > 0; plant_marked added: it has a mark */
    uint16_t twist;  /* angle of its turn about the axis, from east to north, in 2 pi / 65536; its two lowest bits are
                      * the mark of what has one */
    int8_t  lean[2]; /* slope of its axis towards east and north, in plant_most_tilt_rad / 127 */
    uint8_t kind;    /* PlantKind */
    uint8_t width;   /* ratio of horizontal to vertical scale in 1/128; 128: as the prototype */
} Plant;

enum { plant_marked = 1 << 15, plant_most_height = plant_marked - 1 };

static inline double plant_height_m(const Plant *plant)
{
    return (plant->height & plant_most_height) * plant_height_step_m;
}
static inline PlantMark plant_mark(const Plant *plant)
{
    return plant->height & plant_marked ? (PlantMark)(MARK_WHITE + (plant->twist & 3)) : PLANT_UNMARKED;
}
static inline void plant_paint(Plant *plant, PlantMark mark)
{
    if (mark == PLANT_UNMARKED || mark >= PLANT_MARKS || !plant_is_tree((PlantKind)plant->kind)) return;
    plant->height |= plant_marked;
    plant->twist = (uint16_t)((plant->twist & ~3) | ((int)mark - MARK_WHITE));
}
/* Axes of the prototype as the plant stands, unit vectors in ENU, and its scales across and along its axis. sway: added
 * to the lean, rad towards east and north; NULL: none. */
void plant_axes(double axis_enu[3][3], double scale[2], const Plant *plant, const double sway_rad[2]);
/* Matrix from the prototype's axes to ENU, scales included: its columns are the images of x, y, z. */
void plant_transform(double m_enu_from_plant[9], const Plant *plant, const double sway_rad[2]);

#endif
