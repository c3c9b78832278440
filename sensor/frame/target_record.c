/* sensor/frame/target_record.c: a target of a frame as every format states it, and its class by the categories of
 * SISO-REF-010. */
#include "sensor/frame/target_record.h"

/* ---- classes, by the categories of SISO-REF-010 -------------------------------------------------- */

enum {
    TANK = 1,
    APC,
    ARTILLERY,
    TOWED_GUN,
    MORTAR,
    AIR_DEFENSE,
    RADAR,
    JEEP,
    TRUCK,
    TRACKED_UTILITY,
    TRAILER,
    ENGINEERING,
    CAR,
    BUS,
    MOTORCYCLE,
    TRAIN,
    ROBOT,
    SHELTER,
    TENT,
    FIGHTER,
    ATTACK_AIRCRAFT,
    BOMBER,
    TRANSPORT_AIRCRAFT,
    SURVEILLANCE_AIRCRAFT,
    TRAINER,
    AIRLINER,
    LIGHT_AIRCRAFT,
    HELICOPTER,
    UAV,
    AIRSHIP,
    AIRCRAFT_CARRIER,
    WARSHIP,
    AMPHIBIOUS_SHIP,
    PATROL_BOAT,
    LANDING_CRAFT,
    CARGO_SHIP,
    BOAT,
    SUBMARINE,
    UUV,
    SATELLITE,
    MISSILE,
    TORPEDO,
    BOMB,
    SHELL,
    MINE,
    PERSON,
    ANIMAL,
    BUILDING,
    BRIDGE,
    SUPPLIES,
    FLARE,
    DECOY,
    BUOY,
    OTHER,
    class_end,
};

static const struct {
    const char *name, *group;
} classes[] = {
    [TANK] = {"tank", "land"},
    [APC] = {"apc", "land"},
    [ARTILLERY] = {"artillery", "land"},
    [TOWED_GUN] = {"towed_gun", "land"},
    [MORTAR] = {"mortar", "land"},
    [AIR_DEFENSE] = {"air_defense", "land"},
    [RADAR] = {"radar", "land"},
    [JEEP] = {"jeep", "land"},
    [TRUCK] = {"truck", "land"},
    [TRACKED_UTILITY] = {"tracked_utility", "land"},
    [TRAILER] = {"trailer", "land"},
    [ENGINEERING] = {"engineering", "land"},
    [CAR] = {"car", "land"},
    [BUS] = {"bus", "land"},
    [MOTORCYCLE] = {"motorcycle", "land"},
    [TRAIN] = {"train", "land"},
    [ROBOT] = {"robot", "land"},
    [SHELTER] = {"shelter", "land"},
    [TENT] = {"tent", "land"},
    [FIGHTER] = {"fighter", "air"},
    [ATTACK_AIRCRAFT] = {"attack_aircraft", "air"},
    [BOMBER] = {"bomber", "air"},
    [TRANSPORT_AIRCRAFT] = {"transport_aircraft", "air"},
    [SURVEILLANCE_AIRCRAFT] = {"surveillance_aircraft", "air"},
    [TRAINER] = {"trainer", "air"},
    [AIRLINER] = {"airliner", "air"},
    [LIGHT_AIRCRAFT] = {"light_aircraft", "air"},
    [HELICOPTER] = {"helicopter", "air"},
    [UAV] = {"uav", "air"},
    [AIRSHIP] = {"airship", "air"},
    [AIRCRAFT_CARRIER] = {"aircraft_carrier", "sea"},
    [WARSHIP] = {"warship", "sea"},
    [AMPHIBIOUS_SHIP] = {"amphibious_ship", "sea"},
    [PATROL_BOAT] = {"patrol_boat", "sea"},
    [LANDING_CRAFT] = {"landing_craft", "sea"},
    [CARGO_SHIP] = {"cargo_ship", "sea"},
    [BOAT] = {"boat", "sea"},
    [SUBMARINE] = {"submarine", "sea"},
    [UUV] = {"uuv", "sea"},
    [SATELLITE] = {"satellite", "space"},
    [MISSILE] = {"missile", "munition"},
    [TORPEDO] = {"torpedo", "munition"},
    [BOMB] = {"bomb", "munition"},
    [SHELL] = {"shell", "munition"},
    [MINE] = {"mine", "munition"},
    [PERSON] = {"person", "life"},
    [ANIMAL] = {"animal", "life"},
    [BUILDING] = {"building", "fixed"},
    [BRIDGE] = {"bridge", "fixed"},
    [SUPPLIES] = {"supplies", "fixed"},
    [FLARE] = {"flare", "expendable"},
    [DECOY] = {"decoy", "expendable"},
    [BUOY] = {"buoy", "expendable"},
    [OTHER] = {"other", "other"},
};
_Static_assert(sizeof classes / sizeof *classes == class_end, "a class without a name");

int         target_class_count(void) { return class_end - 1; }
const char *target_class_name(int number) { return classes[number].name; }
const char *target_class_group(int number) { return classes[number].group; }

/* ---- the class of a type -------------------------------------------------------------------------- */

enum { any = -1 };

/* The first matching row counts: more specific rows come first. SISO-REF-010 (2006 and later), UID 7 .. 27; the
 * categories were checked against Wireshark's packet-dis.c and open-dis's siso-std-010.xml, as etc/catalog.csv was. */
static const struct Rule {
    int16_t kind, domain, country, category[2], subcategory[2]; /* from, to; any */
    uint8_t class;
} rules[] = {
    /* land */
    {1, 1, 225, {6, 6}, {25, 25}, MOTORCYCLE},
    {1, 1, 222, {6, 6}, {8, 8}, MOTORCYCLE},
    {1, 1, any, {1, 1}, {any, any}, TANK},
    {1, 1, any, {2, 3}, {any, any}, APC},
    {1, 1, any, {4, 4}, {any, any}, ARTILLERY},
    {1, 1, any, {5, 5}, {any, any}, TOWED_GUN},
    {1, 1, any, {6, 6}, {any, any}, JEEP},
    {1, 1, any, {7, 7}, {any, any}, TRUCK},
    {1, 1, any, {8, 9}, {any, any}, TRACKED_UTILITY},
    {1, 1, any, {10, 10}, {any, any}, MORTAR},
    {1, 1, any, {11, 13}, {any, any}, ENGINEERING}, /* mine plow, rake, roller */
    {1, 1, any, {14, 17}, {any, any}, TRAILER},
    {1, 1, any, {18, 18}, {any, any}, ENGINEERING},
    {1, 1, any, {19, 22}, {any, any}, TRAILER},
    {1, 1, any, {23, 23}, {any, any}, RADAR},
    {1, 1, any, {24, 26}, {any, any}, TRAIN},
    {1, 1, any, {27, 27}, {any, any}, CAR},
    {1, 1, any, {28, 28}, {any, any}, AIR_DEFENSE},
    {1, 1, any, {29, 29}, {any, any}, SHELTER},
    {1, 1, any, {30, 31}, {any, any}, BUILDING},
    {1, 1, any, {32, 32}, {any, any}, RADAR},
    {1, 1, any, {33, 36}, {any, any}, BUILDING},
    {1, 1, any, {37, 37}, {any, any}, RADAR},
    {1, 1, any, {38, 38}, {any, any}, BUILDING},
    {1, 1, any, {39, 40}, {any, any}, TENT},
    {1, 1, any, {50, 50}, {any, any}, ROBOT},
    {1, 1, any, {80, 80}, {any, any}, MOTORCYCLE},
    {1, 1, any, {81, 81}, {any, any}, CAR},
    {1, 1, any, {82, 82}, {any, any}, BUS},
    {1, 1, any, {83, 86}, {any, any}, TRUCK},
    {1, 1, any, {87, 88}, {any, any}, ENGINEERING},
    {1, 1, any, {89, 89}, {any, any}, TRAILER},
    {1, 1, any, {90, 90}, {any, any}, BUS}, /* motor homes */
    {1, 1, any, {91, 91}, {any, any}, TRAILER},
    {1, 1, any, {92, 92}, {any, any}, TRAIN},
    {1, 1, any, {93, 93}, {any, any}, CAR},
    /* air */
    {1, 2, any, {1, 1}, {any, any}, FIGHTER},
    {1, 2, any, {2, 2}, {any, any}, ATTACK_AIRCRAFT},
    {1, 2, any, {3, 3}, {any, any}, BOMBER},
    {1, 2, any, {4, 4}, {any, any}, TRANSPORT_AIRCRAFT},
    {1, 2, any, {5, 8}, {any, any}, SURVEILLANCE_AIRCRAFT}, /* patrol, EW, reconnaissance, surveillance */
    {1, 2, any, {20, 26}, {any, any}, HELICOPTER},
    {1, 2, any, {40, 40}, {any, any}, TRAINER},
    {1, 2, any, {50, 50}, {any, any}, UAV},
    {1, 2, any, {57, 57}, {any, any}, AIRLINER},
    {1, 2, any, {80, 85}, {any, any}, LIGHT_AIRCRAFT},
    {1, 2, any, {86, 88}, {any, any}, AIRLINER},
    {1, 2, any, {90, 92}, {any, any}, HELICOPTER},
    {1, 2, any, {100, 101}, {any, any}, AIRSHIP},
    /* sea */
    {1, 3, any, {1, 1}, {any, any}, AIRCRAFT_CARRIER},
    {1, 3, any, {2, 6}, {any, any}, WARSHIP},
    {1, 3, any, {7, 7}, {any, any}, PATROL_BOAT},
    {1, 3, any, {8, 8}, {any, any}, WARSHIP},
    {1, 3, any, {9, 10}, {any, any}, AMPHIBIOUS_SHIP},
    {1, 3, any, {11, 11}, {any, any}, LANDING_CRAFT},
    {1, 3, any, {12, 13}, {any, any}, AIRCRAFT_CARRIER},
    {1, 3, any, {14, 14}, {any, any}, PATROL_BOAT},
    {1, 3, any, {15, 15}, {any, any}, LANDING_CRAFT},
    {1, 3, any, {16, 17}, {any, any}, CARGO_SHIP},
    {1, 3, any, {18, 18}, {any, any}, BOAT},
    {1, 3, any, {50, 53}, {any, any}, WARSHIP},
    {1, 3, any, {54, 54}, {any, any}, AMPHIBIOUS_SHIP},
    {1, 3, any, {61, 61}, {1, 3}, CARGO_SHIP},
    {1, 3, any, {61, 61}, {any, any}, BOAT},
    {1, 3, any, {62, 63}, {any, any}, PATROL_BOAT},
    {1, 3, any, {80, 82}, {any, any}, CARGO_SHIP},
    {1, 3, any, {83, 86}, {any, any}, BOAT},
    {1, 4, any, {8, 8}, {any, any}, UUV},
    {1, 4, any, {1, 255}, {any, any}, SUBMARINE},
    {1, 5, any, {any, any}, {any, any}, SATELLITE},
    /* munitions: the category is how they fly */
    {2, 6, 225, {1, 1}, {3, 3}, TORPEDO}, /* Mk 48 and NT 37 among antiship weapons */
    {2, 6, 225, {1, 1}, {5, 5}, TORPEDO},
    {2, 6, 225, {1, 1}, {13, 14}, TORPEDO},
    {2, 7, any, {1, 1}, {any, any}, TORPEDO},
    {2, 9, 225, {1, 1}, {15, 15}, BOMB}, /* GBU-10, GBU-39 */
    {2, 9, 225, {1, 1}, {24, 24}, BOMB},
    {2, any, any, {1, 1}, {any, any}, MISSILE},
    {2, 9, 225, {2, 2}, {50, 75}, BOMB},
    {2, 11, any, {2, 2}, {any, any}, BOMB},
    {2, any, any, {2, 2}, {any, any}, SHELL},
    {2, any, any, {3, 3}, {any, any}, MINE},
    /* the rest */
    {3, any, any, {200, 201}, {any, any}, ANIMAL},
    {3, any, any, {any, any}, {any, any}, PERSON},
    {5, 1, any, {5, 5}, {any, any}, BRIDGE},
    {5, any, any, {any, any}, {any, any}, BUILDING},
    {6, any, any, {any, any}, {any, any}, SUPPLIES},
    {8, 1, any, {5, 5}, {any, any}, DECOY},
    {8, any, any, {2, 3}, {any, any}, FLARE},
    {8, any, any, {7, 7}, {any, any}, FLARE},
    {8, any, any, {12, 12}, {any, any}, FLARE},
    {8, 4, any, {any, any}, {any, any}, BUOY},
    {9, any, any, {any, any}, {any, any}, RADAR},
};

static bool within(const int16_t range[2], int value)
{
    return range[0] == any || (value >= range[0] && value <= range[1]);
}

int target_class(DisEntityType type)
{
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        const struct Rule *r = &rules[i];
        if ((r->kind == any || r->kind == type.kind) && (r->domain == any || r->domain == type.domain) &&
            (r->country == any || r->country == type.country) && within(r->category, type.category) &&
            within(r->subcategory, type.subcategory))
            return r->class;
    }
    return OTHER;
}

/* ---- the record, and its box in the forms of the formats ----------------------------------------- */

static TargetOccluder occluder_of(const Target *t)
{
    if (!t->occluder) return OCCLUDER_NONE;
    return strcmp(t->occluder, "ground") == 0    ? OCCLUDER_GROUND
           : strcmp(t->occluder, "trees") == 0   ? OCCLUDER_TREES
           : strcmp(t->occluder, "scenery") == 0 ? OCCLUDER_SCENERY
                                                 : OCCLUDER_ENTITY;
}

static TargetRecord record_of(const Target *t, const Snapshot *snapshot, const Catalog *catalog)
{
    const SnapshotEntity *entity = &snapshot->entity[t->index];
    TargetRecord          r = {.index = t->index,
                               .id = entity->id,
                               .type = entity->type,
                               .class_number = target_class(entity->type),
                               .plane_value = t->index + 1,
                               .model = catalog_model(catalog, entity->model)->name,
                               .pixels = t->pixels,
                               .visible_fraction = t->visible_fraction,
                               .foliage_fraction = t->foliage_fraction,
                               .range_m = t->range_m,
                               .closing_mps = t->closing_mps,
                               .aspect_rad = t->aspect_rad,
                               .depression_rad = t->depression_rad,
                               .los_az_rad = t->los_az_rad,
                               .los_el_rad = t->los_el_rad,
                               .occluder = occluder_of(t),
                               .age_s = entity->age_s,
                               .position_error_m = entity->position_error_m,
                               .error_px = t->error_px,
                               .dt_k = NAN};
    if (entity->first_patch >= 0) {
        r.dt_k = (double)entity->dt_k;
        r.patches = entity->patches;
        r.patch_k = snapshot->patch_k + entity->first_patch;
    }
    memcpy(r.marking, entity->marking, sizeof r.marking);
    memcpy(r.p_ecef, entity->p_ecef, sizeof r.p_ecef);
    memcpy(r.v_ecef_mps, entity->v_ecef_mps, sizeof r.v_ecef_mps);
    memcpy(r.box, t->box, sizeof r.box);
    memcpy(r.amodal_box, t->amodal_box, sizeof r.amodal_box);
    memcpy(r.los_rate_rps, t->los_rate_rps, sizeof r.los_rate_rps);
    memcpy(r.boresight_error_rad, t->boresight_error_rad, sizeof r.boresight_error_rad);
    memcpy(r.band, t->band, sizeof r.band);
    if (r.occluder == OCCLUDER_ENTITY && t->occluder_index >= 0) r.occluder_id = snapshot->entity[t->occluder_index].id;
    return r;
}

TargetRecord *target_records(const Target *target, int count, const Snapshot *snapshot, const Catalog *catalog,
                             Arena *arena)
{
    TargetRecord *record = arena_alloc(arena, (size_t)count + 1, sizeof *record);
    for (int i = 0; record && i < count; i++) record[i] = record_of(&target[i], snapshot, catalog);
    return record;
}

const char *target_occluder_text(char text[dis_id_text_size], const TargetRecord *t)
{
    if (!dis_entity_id_is_none(t->occluder_id)) {
        dis_entity_id_text(text, t->occluder_id);
        return text;
    }
    return t->occluder == OCCLUDER_NONE      ? NULL
           : t->occluder == OCCLUDER_GROUND  ? "ground"
           : t->occluder == OCCLUDER_TREES   ? "trees"
           : t->occluder == OCCLUDER_SCENERY ? "scenery"
                                             : "entity";
}

void target_box_coco(int out[4], const int box[4])
{
    out[0] = box[0];
    out[1] = box[1];
    out[2] = box[2] - box[0];
    out[3] = box[3] - box[1];
}

void target_box_u16(uint16_t out[4], const int box[4])
{
    for (int k = 0; k < 4; k++) out[k] = (uint16_t)clamp(box[k], 0, UINT16_MAX);
}

static uint64_t pixel_number(int column, int row, int width)
{
    return (uint64_t)column + (uint64_t)row * (uint64_t)width + 1;
}

void target_box_pixel_numbers(uint64_t out[2], const int box[4], int width)
{
    const bool empty = target_box_is_empty(box);
    out[0] = empty ? 0 : pixel_number(box[0], box[1], width);
    out[1] = empty ? 0 : pixel_number(box[2] - 1, box[3] - 1, width);
}

uint64_t target_box_centre_number(const int box[4], int width)
{
    return target_box_is_empty(box) ? 0 : pixel_number((box[0] + box[2]) / 2, (box[1] + box[3]) / 2, width);
}
