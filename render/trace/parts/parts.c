/* render/trace/parts/parts.c: prepares models for ray tracing: facets in double, and an Embree scene for each node. */
#include "render/trace/parts/parts_private.h"

#include <stdatomic.h>
#include <stdlib.h>

typedef struct ModelMeshes {
    const Model *model; /* NULL: not built yet */
    int          count;
    NodeMesh    *mesh; /* nodes that have triangles; one more for each combination of parts hidden by damage */
} ModelMeshes;

struct Tracer {
    RTCDevice      device;
    atomic_int     error; /* the first that Embree reported */
    int            count;
    ModelMeshes   *model;
    const Catalog *catalog; /* NULL: the models were given, and are built */
    bool           thin;    /* thin pieces are listed */
};

/* ---- building ----------------------------------------------------------------------------- */

static void latch_error(void *user, enum RTCError code, const char *text)
{
    Tracer *tracer = user;
    int     none = RTC_ERROR_NONE;
    if (atomic_compare_exchange_strong(&tracer->error, &none, (int)code))
        log_warn("tracer: Embree: %s", text ? text : "?");
}

static Status status_of_error(int code)
{
    switch (code) {
    case RTC_ERROR_NONE:
        return STATUS_OK;
    case RTC_ERROR_OUT_OF_MEMORY:
        return STATUS_NO_MEMORY;
    case RTC_ERROR_UNSUPPORTED_CPU:
        return STATUS_UNSUPPORTED;
    default:
        return STATUS_BAD_VALUE;
    }
}

static void bound_mesh(NodeMesh *mesh)
{
    const Model *model = mesh->model;
    const int    triangle_count = mesh->triangle_count;
    double       low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int t = 0; t < triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            const double *p = model->vertex[model->triangle[mesh->triangle[t]][c]];
            for (int a = 0; a < 3; a++) {
                low[a] = fmin(low[a], p[a]);
                high[a] = fmax(high[a], p[a]);
            }
        }
    double square = 0;
    for (int a = 0; a < 3; a++) mesh->centre[a] = 0.5 * (low[a] + high[a]);
    for (int t = 0; t < triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            double d[3];
            v3_sub(d, model->vertex[model->triangle[mesh->triangle[t]][c]], mesh->centre);
            square = fmax(square, v3_dot(d, d));
        }
    /* a float of that size has steps of 1e-7 of it: a margin of a hundred steps */
    const double room_m = (sqrt(square) + v3_length(mesh->centre)) * 1e-5 + 1e-4;
    mesh->radius_m = sqrt(square) + room_m;
    for (int a = 0; a < 3; a++) mesh->half[a] = 0.5 * (high[a] - low[a]) + room_m;
}

/* Parts of a node that are hidden in the same states of damage are one mesh. */
enum { hidden_groups = 1 << model_damage_states };
static int hidden_group_of(uint8_t hidden) { return hidden & (hidden_groups - 1); }
static int hidden_group(const ModelPart *part) { return hidden_group_of(part->damage_hidden); }

/* Embree only finds candidates, by boxes with conservative tests and a hundred times the margin that the floats of a
 * node of R metres may need. Candidates are tested exactly in double. */
static void nominate_box(const struct RTCBoundsFunctionArguments *a)
{
    const NodeMesh *mesh = a->geometryUserPtr;
    const double    room_m = 1e-4 + 1e-5 * mesh->radius_m;
    double          low[3], high[3];
    parts_bound_patch(low, high, mesh, a->primID);
    if (!(low[0] <= high[0])) {
        *a->bounds_o = (struct RTCBounds){.lower_x = NAN, .upper_x = NAN};
        return;
    }
    *a->bounds_o = (struct RTCBounds){.lower_x = (float)(low[0] - mesh->centre[0] - room_m),
                                      .lower_y = (float)(low[1] - mesh->centre[1] - room_m),
                                      .lower_z = (float)(low[2] - mesh->centre[2] - room_m),
                                      .upper_x = (float)(high[0] - mesh->centre[0] + room_m),
                                      .upper_y = (float)(high[1] - mesh->centre[1] + room_m),
                                      .upper_z = (float)(high[2] - mesh->centre[2] + room_m)};
}

/* Brings to the front the vertices that lie outermost along the axes, edges and diagonals of a cube: few others lie
 * outermost in an image. */
static void outermost_first(NodeMesh *mesh)
{
    int front = 0;
    for (int k = 0; k < 27; k++) {
        const double d[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        int          farthest = 0;
        if (k == 13) continue;
        for (int i = 1; i < mesh->corner_count; i++)
            if (v3_dot(mesh->corner[i], d) > v3_dot(mesh->corner[farthest], d)) farthest = i;
        if (farthest < front) continue;
        double kept[3];
        memcpy(kept, mesh->corner[farthest], sizeof kept);
        memmove(mesh->corner + front + 1, mesh->corner + front, (size_t)(farthest - front) * sizeof *mesh->corner);
        memcpy(mesh->corner[front++], kept, sizeof kept);
    }
}

/* Lists the corners in the order in which triangles use them, so that those of a block lie close together. */
static Status list_corners(NodeMesh *mesh)
{
    const Model *model = mesh->model;
    uint8_t     *seen = calloc((size_t)model->vertex_count + 1, 1);
    mesh->corner = calloc(3 * (size_t)mesh->triangle_count, sizeof *mesh->corner);
    mesh->block = calloc(3 * (size_t)mesh->triangle_count / parts_block_corners + 1, sizeof *mesh->block);
    if (!seen || !mesh->corner || !mesh->block) {
        free(seen);
        return STATUS_NO_MEMORY;
    }
    for (int t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            const uint32_t v = model->triangle[mesh->triangle[t]][c];
            if (!seen[v]) v3_scale(mesh->corner[mesh->corner_count++], 1, model->vertex[v]);
            seen[v] = 1;
        }
    free(seen);
    outermost_first(mesh);
    for (int i = 0; i < mesh->corner_count; i++)
        for (int c = 0; c < 3; c++) {
            double(*box)[3] = mesh->block[i / parts_block_corners];
            const double at = mesh->corner[i][c], room_m = 1e-7 * (1 + fabs(at));
            const bool   first = i % parts_block_corners == 0;
            box[0][c] = first || at - room_m < box[0][c] ? at - room_m : box[0][c];
            box[1][c] = first || at + room_m > box[1][c] ? at + room_m : box[1][c];
        }
    return STATUS_OK;
}

static Status commit_mesh(NodeMesh *mesh, Tracer *tracer)
{
    mesh->scene = rtcNewScene(tracer->device);
    if (!mesh->scene) return status_of_error(tracer->error);
    rtcSetSceneFlags(mesh->scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(mesh->scene, RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_USER);
    if (!geometry) return status_of_error(tracer->error);
    rtcSetGeometryUserPrimitiveCount(geometry, (unsigned)mesh->patch_count);
    rtcSetGeometryUserData(geometry, mesh);
    rtcSetGeometryBoundsFunction(geometry, nominate_box, NULL);
    rtcSetGeometryIntersectFunction(geometry, parts_intersect);
    rtcSetGeometryOccludedFunction(geometry, parts_occlude);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(mesh->scene, geometry);
    rtcCommitScene(mesh->scene);
    rtcReleaseGeometry(geometry);
    return status_of_error(tracer->error);
}

static Status build_mesh(NodeMesh *mesh, Tracer *tracer, const ModelMeshes *meshes, int node, uint8_t hidden,
                         int triangle_count)
{
    const Model *model = meshes->model;
    mesh->model = model;
    mesh->node = node;
    mesh->damage_hidden = hidden;
    mesh->triangle_count = triangle_count;
    mesh->triangle = calloc((size_t)triangle_count, sizeof *mesh->triangle);
    if (!mesh->triangle) return STATUS_NO_MEMORY;
    int at = 0;
    for (int t = 0; t < model->triangle_count; t++) {
        const ModelPart *part = &model->part[model->triangle_part[t]];
        if (part->node == node && hidden_group(part) == hidden_group_of(hidden)) mesh->triangle[at++] = (uint32_t)t;
    }
    if (parts_list_patches(mesh) != STATUS_OK || list_corners(mesh) != STATUS_OK) return STATUS_NO_MEMORY;
    if (tracer->thin && parts_list_thin(mesh) != STATUS_OK) return STATUS_NO_MEMORY;
    bound_mesh(mesh);
    return commit_mesh(mesh, tracer);
}

static Status build_model(ModelMeshes *meshes, Tracer *tracer, const Model *model)
{
    meshes->model = model;
    const int groups = model->node_count * hidden_groups;
    meshes->mesh = calloc((size_t)groups + 1, sizeof *meshes->mesh);
    int   *triangle_count = calloc((size_t)groups + 1, sizeof *triangle_count);
    Status status = meshes->mesh && triangle_count ? STATUS_OK : STATUS_NO_MEMORY;
    if (status != STATUS_OK) goto done;

    for (int t = 0; t < model->triangle_count; t++) {
        const ModelPart *part = &model->part[model->triangle_part[t]];
        triangle_count[part->node * hidden_groups + hidden_group(part)]++;
    }
    for (int g = 0; g < groups && status == STATUS_OK; g++)
        if (triangle_count[g] > 0) {
            status = build_mesh(&meshes->mesh[meshes->count], tracer, meshes, g / hidden_groups,
                                (uint8_t)(g % hidden_groups), triangle_count[g]);
            meshes->count++; /* a partly built one is closed as well */
        }
done:
    free(triangle_count);
    return status;
}

static void close_model(ModelMeshes *meshes)
{
    for (int k = 0; k < meshes->count; k++) {
        if (meshes->mesh[k].scene) rtcReleaseScene(meshes->mesh[k].scene);
        free(meshes->mesh[k].triangle);
        free(meshes->mesh[k].patch);
        free(meshes->mesh[k].corner);
        free(meshes->mesh[k].thin);
        free(meshes->mesh[k].block);
    }
    free(meshes->mesh);
    *meshes = (ModelMeshes){0};
}

Status tracer_need(Tracer *tracer, int model)
{
    ModelMeshes *meshes = &tracer->model[model];
    if (meshes->model || !tracer->catalog) return STATUS_OK;
    const Status status = build_model(meshes, tracer, catalog_model(tracer->catalog, model));
    if (status != STATUS_OK) close_model(meshes);
    return status;
}

static Status create(Tracer **out, const Model *const *models, int count, const char *isa, bool thin)
{
    char       config[128] = "threads=1,start_threads=0,set_affinity=0";
    Status     status = STATUS_OK;
    const bool chosen = isa && isa[0];
    if (chosen && strcmp(isa, "avx512") && strcmp(isa, "avx2") && strcmp(isa, "sse4.2")) {
        log_error("tracer: unknown instruction set: isa=%s accepted=avx512,avx2,sse4.2", isa);
        return STATUS_BAD_VALUE;
    }
    if (chosen) {
        strcat(config, ",isa=");
        strcat(config, isa);
    }
    Tracer *tracer = calloc(1, sizeof *tracer);
    if (!tracer) return STATUS_NO_MEMORY;
    tracer->thin = thin;
    tracer->device = rtcNewDevice(config);
    if (!tracer->device) {
        status = status_of_error((int)rtcGetDeviceError(NULL));
        if (status == STATUS_OK) status = STATUS_UNSUPPORTED;
        goto fail;
    }
    rtcSetDeviceErrorFunction(tracer->device, latch_error, tracer);
    tracer->model = calloc((size_t)count + 1, sizeof *tracer->model);
    if (!tracer->model) {
        status = STATUS_NO_MEMORY;
        goto fail;
    }
    for (; tracer->count < count;) {
        if (models[tracer->count]) status = build_model(&tracer->model[tracer->count], tracer, models[tracer->count]);
        tracer->count++;
        if (status != STATUS_OK) goto fail;
    }
    *out = tracer;
    return STATUS_OK;

fail:
    log_error("tracer: cannot start Embree: config=%s: %s", config, status_name(status));
    tracer_destroy(tracer);
    return status;
}

Status tracer_create_models(Tracer **out, const Model *const *models, int count, const char *isa)
{
    return create(out, models, count, isa, false);
}

int64_t tracer_embree(const Tracer *tracer)
{
    return (int64_t)rtcGetDeviceProperty(tracer->device, RTC_DEVICE_PROPERTY_VERSION);
}

Status tracer_create(Tracer **out, const Catalog *catalog, const char *isa)
{
    const int     count = catalog_model_count(catalog);
    const Model **models = calloc((size_t)count + 1, sizeof *models);
    if (!models) return STATUS_NO_MEMORY;
    for (int m = 0; m < count; m++) models[m] = catalog_is_built(catalog, m) ? catalog_model(catalog, m) : NULL;
    const Status status = create(out, models, count, isa, true);
    if (status == STATUS_OK) (*out)->catalog = catalog;
    free(models);
    return status;
}

void tracer_destroy(Tracer *tracer)
{
    if (!tracer) return;
    for (int m = 0; m < tracer->count; m++) close_model(&tracer->model[m]);
    free(tracer->model);
    if (tracer->device) rtcReleaseDevice(tracer->device);
    free(tracer);
}

int          tracer_model_count(const Tracer *tracer) { return tracer->count; }
const Model *tracer_model(const Tracer *tracer, int model) { return tracer->model[model].model; }
int          parts_node_count(const Tracer *tracer, int model) { return tracer->model[model].count; }

double parts_largest_node_m(const Tracer *tracer, int model)
{
    double largest_m = 0;
    for (int k = 0; k < tracer->model[model].count; k++)
        largest_m = fmax(largest_m, tracer->model[model].mesh[k].radius_m);
    return largest_m;
}

const double (*parts_node_corners(const PosedNode *node, int *count))[3]
{
    *count = node->mesh->corner_count;
    return (const double(*)[3])node->mesh->corner;
}

void parts_node_box(double corner[8][3], const PosedNode *node)
{
    const NodeMesh *mesh = node->mesh;
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 3; c++) corner[k][c] = mesh->centre[c] + (k >> c & 1 ? mesh->half[c] : -mesh->half[c]);
}

void parts_block_box(double corner[8][3], const PosedNode *node, int block)
{
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 3; c++) corner[k][c] = node->mesh->block[block][k >> c & 1][c];
}

int parts_largest_node(const PosedEntity *entity)
{
    int largest = 0;
    for (int k = 1; k < entity->node_count; k++)
        if (entity->node[k].mesh->radius_m > entity->node[largest].mesh->radius_m) largest = k;
    return largest;
}

bool parts_node_triangle(double corner[3][3], const PosedNode *node, int k)
{
    if (k >= node->mesh->triangle_count) return false;
    for (int c = 0; c < 3; c++) memcpy(corner[c], parts_corner(node->mesh, k, c), sizeof corner[c]);
    return true;
}

/* ---- posing ------------------------------------------------------------------------------- */

static bool pose_is_finite(const double p[3], const double r[9])
{
    return v3_is_finite(p) && v3_is_finite(r) && v3_is_finite(r + 3) && v3_is_finite(r + 6);
}

static void mesh_centre(double centre_enu[3], const PosedNode *node)
{
    double d[3];
    m3_mul_v3(d, node->r_enu_from_node, node->mesh->centre);
    v3_add(centre_enu, node->p_enu, d);
}

/* Widens the entity's box by that of one node. */
static void include_box(PosedEntity *entity, const NodeMesh *mesh, const NodePose *pose)
{
    double centre[3];
    m3_mul_v3(centre, pose->r_body_from_node, mesh->centre);
    for (int a = 0; a < 3; a++) {
        double half = 0;
        for (int c = 0; c < 3; c++) half += fabs(pose->r_body_from_node[3 * a + c]) * mesh->half[c];
        const double low = pose->p_body[a] + centre[a] - half, high = pose->p_body[a] + centre[a] + half;
        entity->box_low[a] = low < entity->box_low[a] ? low : entity->box_low[a];
        entity->box_high[a] = high > entity->box_high[a] ? high : entity->box_high[a];
    }
}

void parts_pose(PosedEntity *out, const Tracer *tracer, int model, const NodePose *pose, const double p_enu[3],
                const double r_enu_from_body[9], int damage)
{
    const ModelMeshes *meshes = &tracer->model[model];
    double             low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    out->model = model;
    out->damage = damage;
    out->node_count = 0;
    out->radius_m = 0;
    memset(out->centre_enu, 0, sizeof out->centre_enu);
    if (!pose_is_finite(p_enu, r_enu_from_body)) {
        out->model = -1;
        return;
    }
    memcpy(out->p_enu, p_enu, sizeof out->p_enu);
    memcpy(out->r_enu_from_body, r_enu_from_body, sizeof out->r_enu_from_body);
    for (int a = 0; a < 3; a++) {
        out->box_low[a] = INFINITY;
        out->box_high[a] = -INFINITY;
    }
    for (int k = 0; k < meshes->count; k++) {
        PosedNode      *node = &out->node[out->node_count];
        const NodePose *p = &pose[meshes->mesh[k].node];
        double          offset[3], centre[3];
        if (!pose_is_finite(p->p_body, p->r_body_from_node)) continue;
        if (meshes->mesh[k].damage_hidden >> damage & 1) continue;
        node->mesh = &meshes->mesh[k];
        m3_mul_v3(offset, r_enu_from_body, p->p_body);
        v3_add(node->p_enu, p_enu, offset);
        m3_mul(node->r_enu_from_node, r_enu_from_body, p->r_body_from_node);
        mesh_centre(centre, node);
        memcpy(node->centre_enu, centre, sizeof centre);
        for (int c = 0; c < 3; c++) {
            const double from = centre[c] - node->mesh->radius_m, to = centre[c] + node->mesh->radius_m;
            low[c] = from < low[c] ? from : low[c];
            high[c] = to > high[c] ? to : high[c];
        }
        include_box(out, node->mesh, p);
        out->node_count++;
    }
    if (out->node_count == 0) {
        out->model = -1;
        return;
    }
    for (int c = 0; c < 3; c++) out->centre_enu[c] = 0.5 * (low[c] + high[c]);
    for (int k = 0; k < out->node_count; k++) {
        double centre[3];
        v3_sub(centre, out->node[k].centre_enu, out->centre_enu);
        const double reach_m = v3_length(centre) + out->node[k].mesh->radius_m;
        out->radius_m = reach_m > out->radius_m ? reach_m : out->radius_m;
    }
    out->radius_m = out->radius_m * (1 + 1e-9) + 1e-6; /* the roundings above, at any distance from the origin */
}

bool parts_posed_box(double low[3], double high[3], const PosedEntity *e)
{
    static const double near_miss_m = 1e-3; /* ample: 20 um */
    if (e->model < 0) return false;
    for (int r = 0; r < 3; r++) {
        double middle = e->p_enu[r], half = near_miss_m;
        for (int c = 0; c < 3; c++) {
            middle += e->r_enu_from_body[3 * r + c] * 0.5 * (e->box_low[c] + e->box_high[c]);
            half += fabs(e->r_enu_from_body[3 * r + c]) * 0.5 * (e->box_high[c] - e->box_low[c]);
        }
        low[r] = middle - half, high[r] = middle + half;
        /* its sphere's middle, by which it is raised, is in the box */
        low[r] = fmin(low[r], e->centre_enu[r]), high[r] = fmax(high[r], e->centre_enu[r]);
    }
    return true;
}

void parts_on_part(double p_node[3], double n_node[3], const Model *model, const PosedEntity *entity, uint32_t triangle,
                   const double p_enu[3], const double n_enu[3])
{
    const int node = model->part[model->triangle_part[triangle]].node;
    memset(p_node, 0, 3 * sizeof *p_node);
    memset(n_node, 0, 3 * sizeof *n_node);
    for (int k = 0; k < entity->node_count; k++) {
        const PosedNode *posed = &entity->node[k];
        double           from_node[3];
        if (posed->mesh->node != node) continue;
        v3_sub(from_node, p_enu, posed->p_enu);
        m3_tmul_v3(p_node, posed->r_enu_from_node, from_node);
        m3_tmul_v3(n_node, posed->r_enu_from_node, n_enu);
    }
}
