/* render/scattering/field/radar_target.c: prepares a target for radar rays. */
#include "render/scattering/field/radar_target_private.h"

#include <stdlib.h>

/* ---- how curved it is ------------------------------------------------------------------------------- */

typedef struct Bend {
    double per_m, chord_m, area_m2;
} Bend;

static const double flat_per_m = 1e-6; /* curved less: rounding of normals */

static int by_bend(const void *a, const void *b)
{
    const Bend *p = a, *q = b;
    return p->per_m < q->per_m ? 1 : p->per_m > q->per_m ? -1 : 0;
}

/* The largest change of the vertex normals over a side's length; and how far the surface that they are of is from the
 * middle of a side: an eighth of the side times what the normal turns along it, to within its square. */
static Bend bend_of(const Model *model, int t)
{
    Bend   bend = {0};
    double ab[3], ac[3], n[3];
    for (int c = 0; c < 3; c++) {
        const uint32_t i = model->triangle[t][c], j = model->triangle[t][(c + 1) % 3];
        double         along[3], turn = 0, towards_m = 0;
        v3_sub(along, model->vertex[j], model->vertex[i]);
        for (int x = 0; x < 3; x++) {
            const double d = (double)model->normal[j][x] - (double)model->normal[i][x];
            turn += d * d;
            towards_m += d * along[x];
        }
        bend.chord_m = fmax(bend.chord_m, fabs(towards_m) / 8);
        const double side_m = v3_length(along);
        if (side_m > 0) bend.per_m = fmax(bend.per_m, sqrt(turn) / side_m);
    }
    v3_sub(ab, model->vertex[model->triangle[t][1]], model->vertex[model->triangle[t][0]]);
    v3_sub(ac, model->vertex[model->triangle[t][2]], model->vertex[model->triangle[t][0]]);
    v3_cross(n, ab, ac);
    bend.area_m2 = 0.5 * v3_length(n);
    return bend;
}

static Status measure_curve(RadarTarget *target)
{
    const Model *model = target->model;
    Bend        *bend = calloc((size_t)model->triangle_count + 1, sizeof *bend);
    double       whole_m2 = 0, bent_m2 = 0, curved_m2 = 0, square = 0;
    if (!bend) return STATUS_NO_MEMORY;
    for (int t = 0; t < model->triangle_count; t++) {
        bend[t] = bend_of(model, t);
        whole_m2 += bend[t].area_m2;
        if (!(bend[t].per_m > flat_per_m)) continue;
        curved_m2 += bend[t].area_m2;
        square += bend[t].area_m2 * bend[t].chord_m * bend[t].chord_m;
        target->chord_m = fmax(target->chord_m, bend[t].chord_m);
    }
    target->chord_rms_m = curved_m2 > 0 ? sqrt(square / curved_m2) : 0;
    qsort(bend, (size_t)model->triangle_count, sizeof *bend, by_bend);
    target->curve_m = INFINITY;
    for (int t = 0; t < model->triangle_count && bend[t].per_m > flat_per_m; t++) {
        bent_m2 += bend[t].area_m2;
        target->curve_m = 1 / bend[t].per_m;
        if (bent_m2 > 0.05 * whole_m2) break;
    }
    free(bend);
    return STATUS_OK;
}

/* ---- the target ------------------------------------------------------------------------------------- */

Status radar_target_create(RadarTarget **out, const Model *model, const RadarMaterials *materials, const char *isa)
{
    RadarTarget *target = calloc(1, sizeof *target);
    if (!target) return STATUS_NO_MEMORY;
    target->model = model;
    target->materials = materials;
    Status status = tracer_create_models(&target->tracer, &model, 1, isa);
    if (status != STATUS_OK) goto fail;
    target->entity.node = calloc((size_t)parts_node_count(target->tracer, 0) + 1, sizeof *target->entity.node);
    target->pose = calloc((size_t)model->node_count + 1, sizeof *target->pose);
    target->material = calloc((size_t)model->part_count + 1, sizeof *target->material);
    status = target->entity.node && target->pose && target->material ? measure_curve(target) : STATUS_NO_MEMORY;
    const WedgeConfig edges = wedges_default_config();
    if (status == STATUS_OK) status = wedges_find(&target->wedges, model, &edges);
    if (status != STATUS_OK) goto fail;
    status = radar_flat_faces_find(&target->faces, model);
    if (status != STATUS_OK) goto fail;
    status = edge_pairs_find(&target->pairs, target->wedges.wedge, target->wedges.count);
    if (status != STATUS_OK) goto fail;
    target->wedge = calloc((size_t)target->wedges.count + 1, sizeof *target->wedge);
    target->placed = calloc((size_t)target->wedges.count + 1, sizeof *target->placed);
    target->pair = calloc((size_t)target->pairs.count + 1, sizeof *target->pair);
    if (!target->wedge || !target->placed || !target->pair) {
        status = STATUS_NO_MEMORY;
        goto fail;
    }
    for (int p = 0; p < model->part_count && materials; p++) {
        target->material[p] = radar_materials_find(materials, model->part[p].material);
        if (target->material[p] < 0) {
            log_error("radar: no radar material of this name: model=%s part=%s material=%s", model->name,
                      model->part[p].name, model->part[p].material);
            status = STATUS_BAD_VALUE;
            goto fail;
        }
    }
    radar_target_pose(target, NULL, 0);
    *out = target;
    return STATUS_OK;

fail:
    radar_target_destroy(target);
    return status;
}

void radar_target_destroy(RadarTarget *target)
{
    if (!target) return;
    tracer_destroy(target->tracer);
    free(target->entity.node);
    free(target->pose);
    free(target->material);
    free(target->wedge);
    free(target->placed);
    free(target->pair);
    edge_pairs_destroy(&target->pairs);
    wedges_destroy(&target->wedges);
    radar_flat_faces_free(&target->faces);
    free(target);
}

static bool is_metal(const RadarTarget *target, int part)
{
    if (!target->materials) return true;
    const RadarSurfaceKind kind = target->materials->material[target->material[part]].kind;
    return kind == RADAR_METAL || kind == RADAR_COATED;
}

static void place_wedges(RadarTarget *target, int damage)
{
    static const double origin[3] = {0, 0, 0};
    wedges_place(target->wedge, &target->wedges, target->pose, origin);
    target->wedge_count = target->pair_count = 0;
    for (int i = 0; i < target->wedges.count; i++) {
        const int part = target->wedges.wedge[i].part;
        target->placed[i] = -1;
        if (!is_metal(target, part) || target->model->part[part].damage_hidden >> damage & 1) continue;
        target->placed[i] = target->wedge_count;
        target->wedge[target->wedge_count++] = target->wedge[i];
    }
    for (int i = 0; i < target->pairs.count; i++) { /* of one part, so both are there or neither is */
        EdgePair pair = target->pairs.pair[i];
        for (int e = 0; e < 2; e++) pair.wedge[e] = target->placed[pair.wedge[e]];
        if (pair.wedge[0] >= 0 && pair.wedge[1] >= 0) target->pair[target->pair_count++] = pair;
    }
}

void radar_target_pose(RadarTarget *target, const NodePose *pose, int damage)
{
    static const double origin[3] = {0, 0, 0};
    double              attitude[9];
    m3_identity(attitude);
    if (pose) memcpy(target->pose, pose, (size_t)target->model->node_count * sizeof *pose);
    else model_pose(target->pose, target->model, NULL);
    parts_pose(&target->entity, target->tracer, 0, target->pose, origin, attitude, damage);
    place_wedges(target, damage);
}

void radar_antenna(ScatterAntenna *out, const double p_antenna[3], const double p_target[3],
                   const double r_from_body[9])
{
    double from[3];
    v3_sub(from, p_antenna, p_target);
    m3_tmul_v3(out->u, r_from_body, from);
    out->range_m = v3_length(out->u);
    v3_scale(out->u, 1 / out->range_m, out->u);
}

void radar_look(ScatterAntenna *out, double azimuth_rad, double elevation_rad, double range_m)
{
    out->u[0] = cos(elevation_rad) * cos(azimuth_rad);
    out->u[1] = cos(elevation_rad) * sin(azimuth_rad);
    out->u[2] = -sin(elevation_rad);
    v3_normalize(out->u, out->u);
    out->range_m = range_m;
}

double radar_sag_m(double frequency_hz) { return clamp(light_mps / frequency_hz / 300, 1e-5, 0.1); }
