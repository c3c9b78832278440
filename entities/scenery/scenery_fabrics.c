/* entities/scenery/scenery_fabrics.c: which row of etc/materials.csv a fabric of a record is: a few a fabric, by id, so
 * that a village is not of one colour. */
#include "entities/scenery/scenery_buildings_private.h"

double record_random(uint64_t id, uint32_t stream) { return random_uniform(id, stream, 0, 0); }

static const char *choose(const char *const *of, int count, uint64_t id, uint32_t stream)
{
    const int k = (int)(record_random(id, stream) * count);
    return of[k < count ? k : count - 1];
}

const char *fabric_material(int fabric, uint64_t id)
{
    static const char *const of[FABRICS][4] = {
        [FABRIC_BRICK] = {"brick_red", "brick_red", "brick_brown", "brick_yellow"},
        [FABRIC_RENDER] = {"render_white", "render_cream", "render_grey", "render_ochre"},
        [FABRIC_STONE] = {"stone_wall_grey", "stone_wall_buff", "stone_wall_grey", "stone_wall_dark"},
        [FABRIC_TIMBER] = {"timber_weathered", "timber_stained", "paint_white_wood", "timber_red"},
        [FABRIC_CONCRETE] = {"concrete", "concrete", "concrete_weathered", "concrete_panel"},
        [FABRIC_SHEET] = {"sheet_grey", "sheet_green", "sheet_white", "metal_steel_galvanized"},
        [FABRIC_TILE] = {"roof_tile_clay", "roof_tile_clay", "roof_tile_brown", "roof_tile_grey"},
        [FABRIC_SLATE] = {"slate_grey", "slate_grey", "slate_blue", "slate_weathered"},
        [FABRIC_FELT] = {"felt_black", "felt_grey", "felt_black", "felt_gravel"},
        [FABRIC_THATCH] = {"thatch_fresh", "thatch_grey", "thatch_grey", "thatch_moss"},
    };
    return choose(of[fabric >= 0 && fabric < FABRICS ? fabric : FABRIC_RENDER], 4, id, 1);
}

const char *door_material(uint64_t id)
{
    static const char *const of[5] = {"paint_brown_wood", "paint_green_wood", "paint_blue_wood", "paint_white_wood",
                                      "paint_red_wood"};
    return choose(of, 5, id, 2);
}

const char *frame_material(uint64_t id)
{
    static const char *const of[3] = {"paint_white_wood", "paint_white_wood", "paint_brown_wood"};
    return choose(of, 3, id, 3);
}
