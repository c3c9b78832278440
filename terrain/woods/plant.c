/* terrain/woods/plant.c: names of the kinds of plants, and a plant's transform. */
#include "terrain/woods/plant.h"

static const struct {
    const char *name;
    bool        deciduous;
    double      crown;
} kinds[PLANT_KINDS] = {
    [PLANT_PINE] = {"pine", false, 0.16},           [PLANT_ALDER] = {"alder", true, 0.18},
    [PLANT_BIRCH] = {"birch", true, 0.22},          [PLANT_ENGLISH_OAK] = {"english_oak", true, 0.29},
    [PLANT_SESSILE_OAK] = {"sessile_oak", true, 0.24}, [PLANT_RED_OAK] = {"red_oak", true, 0.24},
    [PLANT_WHITE_OAK] = {"white_oak", true, 0.32},  [PLANT_BUSH] = {"bush", true, 0.49},
    [PLANT_HEDGE] = {"hedge", true, 0.44},          [PLANT_REED] = {"reed", false, 0.17},
    [PLANT_GRASS] = {"grass_tuft", false, 0.75},    [PLANT_DRY_GRASS] = {"dry_tuft", false, 0.66},
    [PLANT_CROP] = {"crop_plant", false, 0.22},     [PLANT_ROCK] = {"boulder", false, 0.65},
};

const char *plant_name(PlantKind kind) { return kind >= 0 && kind < PLANT_KINDS ? kinds[kind].name : "none"; }

PlantKind plant_find(const char *name)
{
    for (int k = 0; k < PLANT_KINDS; k++)
        if (strcmp(kinds[k].name, name) == 0) return (PlantKind)k;
    return PLANT_KINDS;
}

bool plant_is_deciduous(PlantKind kind) { return kind >= 0 && kind < PLANT_KINDS && kinds[kind].deciduous; }

double plant_crown_share(PlantKind kind) { return kind >= 0 && kind < PLANT_KINDS ? kinds[kind].crown : 0; }

/* The shortest turn from up to the leaning axis a (Rodrigues): columns of R = I + [w] + [w]^2 / (1 + a_z), w = up x a. */
void plant_transform(double m_enu_from_plant[9], const Plant *plant, const double sway_rad[2])
{
    const double step = plant_most_tilt_rad / 127;
    const double east = plant->lean[0] * step + (sway_rad ? sway_rad[0] : 0);
    const double north = plant->lean[1] * step + (sway_rad ? sway_rad[1] : 0);
    const double up = 1 / sqrt(1 + east * east + north * north), ax = east * up, ay = north * up;
    const double per = 1 / (1 + up);
    const double lean[9] = {1 - ax * ax * per, -ax * ay * per,    ax,
                            -ax * ay * per,    1 - ay * ay * per, ay,
                            -ax,               -ay,               up};
    const double turn = plant->twist * (2 * pi_rad / 65536), c = cos(turn), s = sin(turn);
    const double high = plant_height_m(plant), wide = high * plant->width / 128;
    const double scaled[9] = {c * wide, -s * wide, 0, s * wide, c * wide, 0, 0, 0, high};
    m3_mul(m_enu_from_plant, lean, scaled);
}
