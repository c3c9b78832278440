/* sensor/verify/saved_frame/saved_fields.c: the content of each chunk of a frame file: the fields, in order, with their
 * ranges. */
#include "sensor/verify/saved_frame/saved_frame_private.h"

#include "entities/traces/effect_history.h"

#include <stdlib.h>

static const double fast_mps = 1e6;
static const double long_s = 1e12;

/* ---- identification ------------------------------------------------------------------------------ */

void saved_fields_about(Fields *f, SavedFrame *file)
{
    field_text(f, &file->version, 64);
    field_text(f, &file->host, 64);
    field_text(f, &file->config_sha256, sha256_text_size - 1);
    field_int(f, "frame", &file->frame, 0, 999999999);
    field_real(f, "time_s", &file->time_s, -long_s, long_s);
    field_real(f, "unix_s", &file->unix_s, -long_s, long_s);
}

void saved_fields_settings(Fields *f, SavedFrame *file) { field_text(f, &file->settings, settings_file_octets); }

void saved_fields_tables(Fields *f, SavedFrame *file)
{
    field_int(f, "tables", &file->tables.count, 0, tables_used_max);
    for (int i = 0; i < file->tables.count && fields_good(f); i++) {
        field_chars(f, "table name", file->tables.table[i].name, table_used_name_size);
        field_chars(f, "table sha256", file->tables.table[i].sha256, sha256_text_size);
    }
}

static void model_fields(Fields *f, void *record)
{
    SavedModel *m = record;
    field_int(f, "model", &m->model, 0, INT32_MAX - 1);
    field_int(f, "nodes of a model", &m->node_count, 1, 1 << 20);
    field_chars(f, "model name", m->name, sizeof m->name);
    field_chars(f, "model sha256", m->sha256, sizeof m->sha256);
}

void saved_fields_models(Fields *f, SavedFrame *file)
{
    field_list(f, &file->model_count, (void **)&file->model, sizeof *file->model, saved_models_max, model_fields);
}

/* ---- snapshot ----------------------------------------------------------------------------------- */

static void entity_fields(Fields *f, void *record)
{
    SnapshotEntity *e = record;
    uint32_t        id[3] = {e->id.site, e->id.application, e->id.entity}, appearance = e->appearance;
    uint8_t         type[9] = {e->type.kind,
                               e->type.domain,
                               (uint8_t)(e->type.country >> 8),
                               (uint8_t)e->type.country,
                               e->type.category,
                               e->type.subcategory,
                               e->type.specific,
                               e->type.extra,
                               e->force};
    for (int k = 0; k < 3; k++) field_u32(f, &id[k]);
    field_bytes(f, type, sizeof type);
    e->id = (DisEntityId){(uint16_t)id[0], (uint16_t)id[1], (uint16_t)id[2]};
    e->type = (DisEntityType){type[0], type[1], (uint16_t)(type[2] << 8 | type[3]), type[4], type[5], type[6], type[7]};
    e->force = type[8];
    field_chars(f, "marking", e->marking, sizeof e->marking);
    field_u32(f, &appearance);
    e->appearance = appearance;
    field_int(f, "model of an entity", &e->model, -1, INT32_MAX - 1);
    field_reals(f, "place of an entity", e->p_ecef, 3, earth_m);
    field_reals(f, "velocity of an entity", e->v_ecef_mps, 3, fast_mps);
    field_reals(f, "turning of an entity", e->w_body_rps, 3, 1e6);
    field_rotation(f, "attitude of an entity", e->r_ecef_from_body);
    field_real(f, "age of an entity", &e->age_s, 0, long_s);
    field_real(f, "position error of an entity", &e->position_error_m, 0, INFINITY);
    field_real(f, "drift of an entity", &e->drift_m, 0, INFINITY);
    field_real(f, "drift of an entity", &e->drift_rad, 0, INFINITY);
    field_int(f, "nodes of an entity", &e->first_node, 0, INT32_MAX - 1);
    if (f->version >= 3) {
        field_int(f, "patches of an entity", &e->first_patch, -1, INT32_MAX - 1);
        field_int(f, "patches of an entity", &e->patches, 0, INT32_MAX - 1);
        field_floats(f, "warmth of an entity", &e->dt_k, 1, -1e5f, 1e5f);
    } else { /* heat by role, of which nothing is made any more */
        float heat[21] = {0};
        e->first_patch = -1, e->patches = 0, e->dt_k = 0;
        field_floats(f, "heat of an entity", heat, 21, -1000, 10000);
    }
}

static void puff_fields(Fields *f, void *record)
{
    EffectPuff *p = record;
    int         kind = (int)p->kind;
    field_int(f, "kind of a puff", &kind, 0, EFFECT_KIND_COUNT - 1);
    p->kind = (EffectKind)kind;
    field_u64(f, &p->owner);
    field_u32(f, &p->group);
    field_u32(f, &p->seed);
    field_real(f, "age of a puff", &p->age_s, 0, long_s);
    field_reals(f, "place of a puff", p->p_ecef, 3, earth_m);
    field_unit(f, "up of a puff", p->up_ecef);
    field_reals(f, "throw of a puff", p->throw_mps, 3, fast_mps);
    field_real(f, "throw of a puff", &p->throw_s, 0, long_s);
    field_real(f, "scale of a puff", &p->scale, 0, 1e6);
    field_real(f, "mass of a puff", &p->mass_kg, 0, 1e12);
    field_reals(f, "axis of a puff", p->axis_ecef, 3, 2);
    field_real(f, "length of a puff", &p->along_m, 0, local_m);
    field_bool(f, "puff on the ground", &p->grounded);
    field_reals(f, "height of a puff", &p->above_m, 1, local_m);
}

static void node_fields(Fields *f, void *record)
{
    NodePose *n = record;
    field_reals(f, "place of a node", n->p_body, 3, local_m);
    field_rotation(f, "attitude of a node", n->r_body_from_node);
}

static void patch_fields(Fields *f, void *record) { field_floats(f, "temperature of a patch", record, 1, 0.1f, 1e5f); }

static void check_order(Fields *f, const Snapshot *s)
{
    for (int e = 0; e < s->count && fields_good(f); e++)
        if (s->entity[e].first_node > s->node_count ||
            (e > 0 && dis_entity_id_compare(s->entity[e - 1].id, s->entity[e].id) >= 0))
            f->fault = "order of the entities";
}

void saved_fields_snapshot(Fields *f, SavedFrame *file)
{
    Snapshot *s = &file->snapshot;
    int64_t   left = s->puffs_left_out;
    field_real(f, "time of the snapshot", &s->t_s, -long_s, long_s);
    field_int(f, "entities left out", &s->left_out, 0, INT32_MAX - 1);
    field_bytes(f, &left, sizeof left);
    s->puffs_left_out = left;
    field_list(f, &s->count, (void **)&s->entity, sizeof *s->entity, saved_entities_max, entity_fields);
    field_list(f, &s->node_count, (void **)&s->node, sizeof *s->node, INT32_MAX - 1, node_fields);
    field_list(f, &s->puff_count, (void **)&s->puff, sizeof *s->puff, effect_puff_capacity, puff_fields);
    if (f->version >= 3)
        field_list(f, &s->patch_count, (void **)&s->patch_k, sizeof *s->patch_k, INT32_MAX - 1, patch_fields);
    for (int e = 0; f->from && e < s->count && fields_good(f); e++)
        if (s->entity[e].first_patch >= 0 && s->entity[e].first_patch > s->patch_count - s->entity[e].patches)
            f->fault = "patches of an entity";
    if (f->from) check_order(f, s);
}

/* ---- ground marks ------------------------------------------------------------------------------- */

static const float largest_m = 1000, hottest_j_m2 = 1e9f;

static void blow_fields(Fields *f, GroundBlow *b)
{
    field_floats(f, "outlet of a stand", b->at_m, 3, -largest_m, largest_m);
    field_floats(f, "exhaust of a stand", b->d, 3, -1.001f, 1.001f);
    field_floats(f, "exhaust of a stand", &b->radius_m, 1, 0, largest_m);
    field_floats(f, "exhaust of a stand", &b->speed_mps, 1, 0, 1000);
    field_floats(f, "exhaust of a stand", &b->excess_k, 1, 0, 5000);
    field_real(f, "exhaust of a stand", &b->from_s, -long_s, long_s);
    field_real(f, "exhaust of a stand", &b->to_s, -long_s, INFINITY);
}

static void stand_fields(Fields *f, void *record)
{
    GroundStand *s = record;
    field_reals(f, "place of a stand", s->p_ecef, 3, earth_m);
    field_rotation(f, "attitude of a stand", s->r_ecef_from_body);
    field_floats(f, "box of a stand", s->low_m, 3, -largest_m, largest_m);
    for (int k = 0; k < 3; k++)
        field_floats(f, "box of a stand", &s->high_m[k], 1, f->from ? s->low_m[k] : 0, largest_m);
    field_real(f, "begin of a stand", &s->from_s, -long_s, long_s);
    field_real(f, "end of a stand", &s->to_s, s->from_s, INFINITY);
    field_u64(f, &s->owner);
    if (f->version >= 4) blow_fields(f, &s->blow);
}

static void track_fields(Fields *f, void *record)
{
    GroundTrack *t = record;
    field_reals(f, "begin of a track", t->a_ecef, 3, earth_m);
    field_reals(f, "end of a track", t->b_ecef, 3, earth_m);
    field_real(f, "time of a track", &t->a_s, -long_s, long_s);
    field_real(f, "time of a track", &t->b_s, t->a_s, long_s);
    field_floats(f, "width of a track", &t->width_m, 1, 0, largest_m);
    field_floats(f, "width of a track", &t->apart_m, 1, 0, largest_m);
    field_floats(f, "heat of a track", &t->heat_j_m2, 1, 0, hottest_j_m2);
    field_bool(f, "kind of a track", &t->tracked);
}

static void burn_fields(Fields *f, void *record)
{
    GroundBurn *b = record;
    field_reals(f, "place of a burn", b->p_ecef, 3, earth_m);
    field_real(f, "time of a burn", &b->t_s, -long_s, long_s);
    field_floats(f, "size of a burn", &b->radius_m, 1, 0, largest_m);
    field_floats(f, "size of a burn", &b->crater_m, 1, 0, largest_m);
    field_floats(f, "heat of a burn", &b->heat_j_m2, 1, 0, hottest_j_m2);
}

void saved_fields_marks(Fields *f, SavedFrame *file)
{
    GroundMarks *m = &file->snapshot.marks;
    uint64_t     forgotten = (uint64_t)m->forgotten;
    field_u64(f, &forgotten);
    m->forgotten = (int64_t)forgotten;
    if (f->from && m->forgotten < 0 && fields_good(f)) f->fault = "marks forgotten";
    field_list(f, &m->stands, (void **)&m->stand, sizeof *m->stand, ground_stand_capacity, stand_fields);
    field_list(f, &m->tracks, (void **)&m->track, sizeof *m->track, ground_tracks_most, track_fields);
    field_list(f, &m->burns, (void **)&m->burn, sizeof *m->burn, ground_burn_capacity, burn_fields);
}

/* ---- view and request ---------------------------------------------------------------------------- */

/* A lens is rebuilt from its coefficients: its other fields follow from them. */
static void lens_fields(Fields *f, View *view)
{
    bool has = view_has_lens(view);
    field_bool(f, "lens", &has);
    field_reals(f, "lens", view->lens.k, 3, 1e6);
    field_reals(f, "lens", view->lens.p, 2, 1e6);
    if (!f->from || !has || !fields_good(f)) return;
    const double half[2] = {0.5 * view->width / view->focal_px, 0.5 * view->height / view->focal_px};
    const double k[3] = {view->lens.k[0], view->lens.k[1], view->lens.k[2]}, p[2] = {view->lens.p[0], view->lens.p[1]};
    if (view_lens_make(&view->lens, k, p, half) != STATUS_OK) f->fault = "lens";
}

void saved_fields_request(Fields *f, SavedFrame *file)
{
    RenderRequest *r = &file->request;
    View          *v = &r->view;
    int            bands = (int)r->bands, optical = (int)r->optical, sampling = (int)r->sampling;
    double         km2 = file->ground_km2 >= 0 ? file->ground_km2 : -1; /* -1: not known */
    field_int(f, "picture width", &v->width, 8, 8192);
    field_int(f, "picture height", &v->height, 8, 8192);
    field_real(f, "focal length", &v->focal_px, 1e-3, 1e9);
    field_reals(f, "place of the eye", v->p_enu, 3, local_m);
    field_rotation(f, "attitude of the eye", v->r_enu_from_cam);
    lens_fields(f, v);
    field_int(f, "bands", &bands, 1, (1 << BAND_COUNT) - 1);
    field_bool(f, "truth", &r->truth);
    field_int(f, "optical channels", &optical, OPTICAL_PAN, OPTICAL_NIR);
    field_reals(f, "lateral colour", r->lateral, 2, view_most_lateral);
    field_int(f, "sky samples", &r->sky_samples, 0, 4096);
    field_bool(f, "sky visibility", &r->sky_visibility);
    field_int(f, "samples", &r->samples, 1, 16);
    field_int(f, "edge samples", &r->edge_samples, 0, 16);
    field_int(f, "target samples", &r->target_samples, 0, 256);
    field_int(f, "hidden entity", &r->hidden_entity, -1, saved_entities_max);
    field_bool(f, "budget", &r->budget);
    field_bool(f, "cells of small targets", &r->hand_over_cells);
    field_real(f, "range profile", &r->profile_near_m, 0, earth_m);
    field_real(f, "range profile", &r->profile_bin_m, 0, 100);
    field_int(f, "range profile", &r->profile_bins, 0, 65536);
    r->bands = (unsigned)bands;
    r->optical = (OpticalChannels)optical;

    field_reals(f, "place of the eye", file->eye.p_ecef, 3, earth_m);
    field_reals(f, "velocity of the eye", file->eye.v_ecef_mps, 3, fast_mps);
    field_rotation(f, "attitude of the eye", file->eye.r_ecef_from_cam);
    field_int(f, "host", &file->eye.host_index, -1, saved_entities_max);
    field_rotation(f, "attitude of the host", file->r_ecef_from_body);
    field_reals(f, "rate of the scene", file->rate_px_s, 2, INFINITY);
    field_bool(f, "gimbal", &file->at_limit);
    field_bool(f, "contact", &file->all_on_ground);
    if (f->version >= 5) field_int(f, "sampling", &sampling, SAMPLING_ALL, SAMPLING_QUARTER);
    else sampling = SAMPLING_ALL;
    r->sampling = (Sampling)sampling;
    if (f->version >= 7) field_bool(f, "refraction", &r->refraction);
    else r->refraction = false;
    if (f->version >= 9) field_real(f, "ground in the image", &km2, -1, 1e6);
    else km2 = -1;
    file->ground_km2 = km2 >= 0 ? km2 : NAN;
    if (f->version >= 10) field_real(f, "time of the request", &r->t_s, -long_s, long_s);
}

/* ---- plants -------------------------------------------------------------------------------------- */

static void path_fields(Fields *f, void *record)
{
    WoodsPath *path = record;
    field_reals(f, "path", path->a_m, 2, local_m);
    field_reals(f, "path", path->b_m, 2, local_m);
    field_real(f, "path", &path->half_m, 0, 1e4);
    field_real(f, "path", &path->low_half_m, 0, path->half_m);
}

static void place_fields(Fields *f, void *record)
{
    WoodsPlace *place = record;
    field_reals(f, "place of plants", place->p_m, 2, local_m);
}

void saved_fields_woods(Fields *f, SavedFrame *file)
{
    enum { most_paths = 1 << 22, most_places = 1 << 16 };
    WoodsConfig *w = &file->woods;
    file->planted = true;
    field_real(f, "time of plants", &file->request.t_s, -long_s, long_s);
    field_real(f, "reach of low plants", &file->request.low_plants_m, 0, 1000);
    field_u64(f, &w->seed);
    field_reals(f, "centre of plants", w->centre_m, 2, local_m);
    field_real(f, "width of plants", &w->half_width_m, 50, 50000);
    field_int(f, "trees", &w->most_trees, 0, woods_most_trees);
    field_list(f, &w->path_count, (void **)&w->path, sizeof *w->path, most_paths, path_fields);
    if (f->version >= 6)
        field_list(f, &w->place_count, (void **)&w->place, sizeof *w->place, most_places, place_fields);
    if (f->version >= 8) field_real(f, "width of far plants", &w->far_half_m, 0, 50000);
}

/* ---- radar --------------------------------------------------------------------------------------- */

static void joint_fields(Fields *f, void *record) { field_real(f, "a joint", record, -1e12, 1e12); }

void saved_fields_radar(Fields *f, SavedFrame *file)
{
    SavedRadar *r = &file->radar;
    file->measured = true;
    field_reals(f, "velocity of a radar", r->v_enu_mps, 3, 1e6);
    field_bool(f, "aim of a radar", &r->has_aim);
    field_real(f, "range of a radar", &r->aim_m, 0, 1e9);
    field_reals(f, "velocity of a radar's aim", r->aim_v_enu_mps, 3, 1e6);
    field_u32(f, &r->number);
    field_chars(f, "map of a radar", r->map_sha256, sizeof r->map_sha256);
    field_int(f, "detections of a radar", &r->detections, 0, INT32_MAX - 1);
    field_list(f, &r->joint_count, (void **)&r->joint, sizeof *r->joint, INT32_MAX - 1, joint_fields);
}

void saved_fields_coarse(Fields *f, SavedFrame *file)
{
    field_bool(f, "coarse signatures of a radar", &file->radar.coarse);
}

/* ---- results ------------------------------------------------------------------------------ */

static void plane_fields(Fields *f, void *record)
{
    SavedPlane *p = record;
    field_chars(f, "plane name", p->name, sizeof p->name);
    field_chars(f, "plane sha256", p->sha256, sizeof p->sha256);
    field_real(f, "plane", &p->finite, 0, 1e12);
    field_real(f, "plane", &p->mean, -INFINITY, INFINITY);
    field_real(f, "plane", &p->low, -INFINITY, INFINITY);
    field_real(f, "plane", &p->high, -INFINITY, INFINITY);
}

void saved_fields_planes(Fields *f, SavedFrame *file)
{
    field_chars(f, "frame sha256", file->frame_sha256, sizeof file->frame_sha256);
    field_list(f, &file->plane_count, (void **)&file->plane, sizeof *file->plane, frame_max_planes, plane_fields);
}
