/* sensor/publish/target_record.c: the record of each target, and its box in the forms of the formats. */
#include "sensor/publish/target_record.h"

#include "sensor/publish/target_class.h"

static TargetOccluder occluder_of(const Target *t)
{
    if (!t->occluder) return OCCLUDER_NONE;
    return strcmp(t->occluder, "ground") == 0   ? OCCLUDER_GROUND
           : strcmp(t->occluder, "trees") == 0 ? OCCLUDER_TREES
                                               : OCCLUDER_ENTITY;
}

static TargetRecord record_of(const Target *t, const Snapshot *snapshot, const Catalog *catalog)
{
    const SnapshotEntity *entity = &snapshot->entity[t->index];
    TargetRecord          r = {
                 .index = t->index, .id = entity->id, .type = entity->type, .class_number = target_class(entity->type),
                 .plane_value = t->index + 1, .model = catalog_model(catalog, entity->model)->name, .pixels = t->pixels,
                 .visible_fraction = t->visible_fraction, .foliage_fraction = t->foliage_fraction,
                 .range_m = t->range_m, .closing_mps = t->closing_mps,
                 .aspect_rad = t->aspect_rad, .depression_rad = t->depression_rad, .los_az_rad = t->los_az_rad,
                 .los_el_rad = t->los_el_rad, .occluder = occluder_of(t), .age_s = entity->age_s,
                 .position_error_m = entity->position_error_m, .error_px = t->error_px, .dt_k = NAN};
    if (entity->first_patch >= 0) {
        r.dt_k    = (double)entity->dt_k;
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
    return t->occluder == OCCLUDER_NONE     ? NULL
           : t->occluder == OCCLUDER_GROUND ? "ground"
           : t->occluder == OCCLUDER_TREES  ? "trees"
                                            : "entity";
}

void box_coco(int out[4], const int box[4])
{
    out[0] = box[0];
    out[1] = box[1];
    out[2] = box[2] - box[0];
    out[3] = box[3] - box[1];
}

void box_u16(uint16_t out[4], const int box[4])
{
    for (int k = 0; k < 4; k++) out[k] = (uint16_t)clamp(box[k], 0, UINT16_MAX);
}

static uint64_t pixel_number(int column, int row, int width)
{
    return (uint64_t)column + (uint64_t)row * (uint64_t)width + 1;
}

void box_pixel_numbers(uint64_t out[2], const int box[4], int width)
{
    const bool empty = box_is_empty(box);
    out[0] = empty ? 0 : pixel_number(box[0], box[1], width);
    out[1] = empty ? 0 : pixel_number(box[2] - 1, box[3] - 1, width);
}

uint64_t box_centre_number(const int box[4], int width)
{
    return box_is_empty(box) ? 0 : pixel_number((box[0] + box[2]) / 2, (box[1] + box[3]) / 2, width);
}
