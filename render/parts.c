#include "render/parts.h"

#include <stdatomic.h>
#include <stdlib.h>

#include <embree3/rtcore.h>

struct NodeMesh {
    const Model *model;
    int          node;
    uint8_t      damage_hidden; /* of all its parts: ModelPart */
    RTCScene     scene;
    int          triangle_count;
    uint32_t    *triangle;  /* of the model, by Embree's primID */
    double       centre[3]; /* of a sphere and a box round its vertices, node axes */
    double       radius_m;  /* both with room for the narrowing to float */
    double       half[3];
};

typedef struct ModelMeshes {
    const Model *model;
    float      (*vertex)[4]; /* narrowed; Embree reads 16 bytes at a time */
    int          count;
    NodeMesh    *mesh;       /* nodes that have triangles; one more for each way in which damage hides some */
} ModelMeshes;

struct Tracer {
    RTCDevice    device;
    atomic_int   error; /* the first that Embree reported */
    int          count;
    ModelMeshes *model;
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
    case RTC_ERROR_NONE:            return STATUS_OK;
    case RTC_ERROR_OUT_OF_MEMORY:   return STATUS_NO_MEMORY;
    case RTC_ERROR_UNSUPPORTED_CPU: return STATUS_UNSUPPORTED;
    default:                        return STATUS_BAD_VALUE;
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
                low[a]  = fmin(low[a], p[a]);
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
    /* a float of that size steps by 1e-7 of it: a hundred steps of room */
    const double room_m = (sqrt(square) + v3_length(mesh->centre)) * 1e-5 + 1e-4;
    mesh->radius_m = sqrt(square) + room_m;
    for (int a = 0; a < 3; a++) mesh->half[a] = 0.5 * (high[a] - low[a]) + room_m;
}

/* Parts of a node that are hidden in the same states of damage are one mesh; state 0 hides nothing. */
enum { hidden_groups = 1 << (model_damage_states - 1) };
static int hidden_group_of(uint8_t hidden) { return hidden >> 1 & (hidden_groups - 1); }
static int hidden_group(const ModelPart *part) { return hidden_group_of(part->damage_hidden); }

static Status build_mesh(NodeMesh *mesh, Tracer *tracer, const ModelMeshes *meshes, int node, uint8_t hidden, int triangle_count)
{
    const Model *model = meshes->model;
    mesh->model    = model;
    mesh->node     = node;
    mesh->damage_hidden = hidden;
    mesh->triangle_count = triangle_count;
    mesh->triangle = calloc((size_t)triangle_count, sizeof *mesh->triangle);
    if (!mesh->triangle) return STATUS_NO_MEMORY;
    int at = 0;
    for (int t = 0; t < model->triangle_count; t++) {
        const ModelPart *part = &model->part[model->triangle_part[t]];
        if (part->node == node && hidden_group(part) == hidden_group_of(hidden)) mesh->triangle[at++] = (uint32_t)t;
    }
    bound_mesh(mesh);

    mesh->scene = rtcNewScene(tracer->device);
    if (!mesh->scene) return status_of_error(tracer->error);
    rtcSetSceneFlags(mesh->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneBuildQuality(mesh->scene, RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry) return status_of_error(tracer->error);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, meshes->vertex, 0,
                               sizeof *meshes->vertex, (size_t)model->vertex_count);
    uint32_t *index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof *index,
                                              (size_t)triangle_count);
    if (index) {
        for (int t = 0; t < triangle_count; t++)
            for (int c = 0; c < 3; c++) index[3 * t + c] = model->triangle[mesh->triangle[t]][c];
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(mesh->scene, geometry);
        rtcCommitScene(mesh->scene);
    }
    rtcReleaseGeometry(geometry);
    return index ? status_of_error(tracer->error) : STATUS_NO_MEMORY;
}

static Status build_model(ModelMeshes *meshes, Tracer *tracer, const Model *model)
{
    meshes->model  = model;
    meshes->vertex = calloc((size_t)model->vertex_count + 1, sizeof *meshes->vertex);
    const int groups = model->node_count * hidden_groups;
    meshes->mesh     = calloc((size_t)groups + 1, sizeof *meshes->mesh);
    int *triangle_count = calloc((size_t)groups + 1, sizeof *triangle_count);
    Status status = meshes->vertex && meshes->mesh && triangle_count ? STATUS_OK : STATUS_NO_MEMORY;
    if (status != STATUS_OK) goto done;

    for (int v = 0; v < model->vertex_count; v++)
        for (int c = 0; c < 3; c++) meshes->vertex[v][c] = (float)model->vertex[v][c];
    for (int t = 0; t < model->triangle_count; t++) {
        const ModelPart *part = &model->part[model->triangle_part[t]];
        triangle_count[part->node * hidden_groups + hidden_group(part)]++;
    }
    for (int g = 0; g < groups && status == STATUS_OK; g++)
        if (triangle_count[g] > 0) {
            status = build_mesh(&meshes->mesh[meshes->count], tracer, meshes, g / hidden_groups,
                                (uint8_t)(g % hidden_groups << 1), triangle_count[g]);
            meshes->count++; /* a half-built one is closed as well */
        }
done:
    free(triangle_count);
    return status;
}

Status tracer_create_models(Tracer **out, const Model *const *models, int count, const char *isa)
{
    char        config[128] = "threads=1,start_threads=0,set_affinity=0";
    Status      status = STATUS_OK;
    const bool  chosen = isa && isa[0];
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
    tracer->device = rtcNewDevice(config);
    if (!tracer->device) {
        status = status_of_error((int)rtcGetDeviceError(NULL));
        if (status == STATUS_OK) status = STATUS_UNSUPPORTED;
        goto fail;
    }
    rtcSetDeviceErrorFunction(tracer->device, latch_error, tracer);
    tracer->model = calloc((size_t)count + 1, sizeof *tracer->model);
    if (!tracer->model) { status = STATUS_NO_MEMORY; goto fail; }
    for (; tracer->count < count; ) {
        status = build_model(&tracer->model[tracer->count], tracer, models[tracer->count]);
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

Status tracer_create(Tracer **out, const Catalog *catalog, const char *isa)
{
    const int     count = catalog_model_count(catalog);
    const Model **models = calloc((size_t)count + 1, sizeof *models);
    if (!models) return STATUS_NO_MEMORY;
    for (int m = 0; m < count; m++) models[m] = catalog_model(catalog, m);
    const Status status = tracer_create_models(out, models, count, isa);
    free(models);
    return status;
}

void tracer_destroy(Tracer *tracer)
{
    if (!tracer) return;
    for (int m = 0; m < tracer->count; m++) {
        ModelMeshes *meshes = &tracer->model[m];
        for (int k = 0; k < meshes->count; k++) {
            if (meshes->mesh[k].scene) rtcReleaseScene(meshes->mesh[k].scene);
            free(meshes->mesh[k].triangle);
        }
        free(meshes->mesh);
        free(meshes->vertex);
    }
    free(tracer->model);
    if (tracer->device) rtcReleaseDevice(tracer->device);
    free(tracer);
}

int          tracer_model_count(const Tracer *tracer) { return tracer->count; }
const Model *tracer_model(const Tracer *tracer, int model) { return tracer->model[model].model; }
int          parts_node_count(const Tracer *tracer, int model) { return tracer->model[model].count; }

const uint32_t *parts_node_triangles(const PosedNode *node, int *count)
{
    *count = node->mesh->triangle_count;
    return node->mesh->triangle;
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
        entity->box_low[a]  = fmin(entity->box_low[a], pose->p_body[a] + centre[a] - half);
        entity->box_high[a] = fmax(entity->box_high[a], pose->p_body[a] + centre[a] + half);
    }
}

void parts_pose(PosedEntity *out, const Tracer *tracer, int model, const NodePose *pose, const double p_enu[3],
                const double r_enu_from_body[9], int damage)
{
    const ModelMeshes *meshes = &tracer->model[model];
    double             low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    out->model      = model;
    out->damage     = damage;
    out->node_count = 0;
    out->radius_m   = 0;
    memset(out->centre_enu, 0, sizeof out->centre_enu);
    if (!pose_is_finite(p_enu, r_enu_from_body)) {
        out->model = -1;
        return;
    }
    memcpy(out->p_enu, p_enu, sizeof out->p_enu);
    memcpy(out->r_enu_from_body, r_enu_from_body, sizeof out->r_enu_from_body);
    for (int a = 0; a < 3; a++) {
        out->box_low[a]  = INFINITY;
        out->box_high[a] = -INFINITY;
    }
    for (int k = 0; k < meshes->count; k++) {
        PosedNode      *node = &out->node[out->node_count];
        const NodePose *p    = &pose[meshes->mesh[k].node];
        double          offset[3], centre[3];
        if (!pose_is_finite(p->p_body, p->r_body_from_node)) continue;
        if (meshes->mesh[k].damage_hidden >> damage & 1) continue;
        node->mesh = &meshes->mesh[k];
        m3_mul_v3(offset, r_enu_from_body, p->p_body);
        v3_add(node->p_enu, p_enu, offset);
        m3_mul(node->r_enu_from_node, r_enu_from_body, p->r_body_from_node);
        mesh_centre(centre, node);
        for (int c = 0; c < 3; c++) {
            low[c]  = fmin(low[c], centre[c] - node->mesh->radius_m);
            high[c] = fmax(high[c], centre[c] + node->mesh->radius_m);
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
        mesh_centre(centre, &out->node[k]);
        v3_sub(centre, centre, out->centre_enu);
        out->radius_m = fmax(out->radius_m, v3_length(centre) + out->node[k].mesh->radius_m);
    }
    out->radius_m = out->radius_m * (1 + 1e-9) + 1e-6; /* the roundings above, at any distance from the origin */
}

/* ---- tracing ------------------------------------------------------------------------------ */

/* Whether a ray may meet the entity's box ahead: one look that spares most rays a look at every node. */
static bool meets_box(const PosedEntity *entity, const double o_enu[3], const double d_enu[3])
{
    double from[3], o[3], d[3], in = 0, out = INFINITY;
    v3_sub(from, o_enu, entity->p_enu);
    m3_tmul_v3(o, entity->r_enu_from_body, from);
    m3_tmul_v3(d, entity->r_enu_from_body, d_enu);
    for (int a = 0; a < 3; a++) {
        const double per_d = fabs(d[a]) < 1e-30 ? 1e30 : 1 / d[a]; /* along a side: in or out, by its sign */
        const double low = (entity->box_low[a] - o[a]) * per_d, high = (entity->box_high[a] - o[a]) * per_d;
        const double near = low < high ? low : high, far = low < high ? high : low;
        in  = near > in ? near : in;
        out = far < out ? far : out;
    }
    return in <= out;
}

/* A ray in a node's axes, from where it enters the node's sphere. */
typedef struct NodeRay {
    double o[3], d[3];
    double start_m, length_m; /* of o along the ray that was asked; through the sphere */
} NodeRay;

/* False: the sphere is missed, behind, or farther than far_m. With ask_all such a ray is given a start as near
 * as it comes. */
static bool node_ray(NodeRay *r, const PosedNode *node, const double o_enu[3], const double d_enu[3], double far_m,
                     bool ask_all)
{
    const NodeMesh *mesh = node->mesh;
    double          from[3], o[3], m[3], across[3];
    v3_sub(from, o_enu, node->p_enu);
    m3_tmul_v3(o, node->r_enu_from_node, from);
    m3_tmul_v3(r->d, node->r_enu_from_node, d_enu);
    v3_sub(m, mesh->centre, o);
    const double along = v3_dot(m, r->d);
    v3_add_scaled(across, m, -along, r->d); /* not |m|^2 - along^2, which cancels from afar */
    const double left   = mesh->radius_m * mesh->radius_m - v3_dot(across, across);
    const double half_m = left > 0 ? sqrt(left) : 0;
    r->start_m  = along > half_m ? along - half_m : 0;
    r->length_m = along + half_m - r->start_m;
    v3_add_scaled(r->o, o, r->start_m, r->d);
    if (ask_all) {
        r->length_m = fmax(r->length_m, mesh->radius_m);
        return true;
    }
    return left > 0 && r->length_m > 0 && r->start_m < far_m;
}

static struct RTCRay narrowed(const NodeRay *r)
{
    return (struct RTCRay){.org_x = (float)r->o[0], .org_y = (float)r->o[1], .org_z = (float)r->o[2],
                           .dir_x = (float)r->d[0], .dir_y = (float)r->d[1], .dir_z = (float)r->d[2],
                           .tnear = 0, .tfar = (float)(r->length_m * 1.001 + 1e-3), .mask = 0xFFFFFFFFu};
}

/* Distance from r->o to the plane of a triangle. Where the triangle is seen edge-on its plane says nothing:
 * the answer is held between the triangle's own corners. */
static double plane_distance(const NodeRay *r, const Model *model, uint32_t triangle)
{
    double e[3][3], ab[3], ac[3], n[3];
    for (int c = 0; c < 3; c++) v3_sub(e[c], model->vertex[model->triangle[triangle][c]], r->o);
    v3_sub(ab, e[1], e[0]);
    v3_sub(ac, e[2], e[0]);
    v3_cross(n, ab, ac);
    const double at[3] = {v3_dot(e[0], r->d), v3_dot(e[1], r->d), v3_dot(e[2], r->d)};
    const double low = fmin(at[0], fmin(at[1], at[2])), high = fmax(at[0], fmax(at[1], at[2]));
    const double t = v3_dot(n, e[0]) / v3_dot(n, r->d);
    if (!(t >= low)) return low; /* and when t is not a number */
    return t <= high ? t : high;
}

/* How far inside its triangle a ray passes, m: the least distance to an edge, below 0 outside; NaN edge-on. */
static double inside_m(const NodeRay *r, const Model *model, uint32_t triangle)
{
    double e[3][3], side[3], across[3], ab[3], ac[3], n[3], least = INFINITY;
    for (int c = 0; c < 3; c++) v3_sub(e[c], model->vertex[model->triangle[triangle][c]], r->o);
    v3_sub(ab, e[1], e[0]);
    v3_sub(ac, e[2], e[0]);
    v3_cross(n, ab, ac);
    for (int c = 0; c < 3; c++) {
        v3_cross(across, e[c], e[(c + 1) % 3]);
        side[c] = v3_dot(across, r->d);
    }
    const double whole = side[0] + side[1] + side[2];
    for (int c = 0; c < 3; c++) {
        double edge[3];
        v3_sub(edge, e[(c + 1) % 3], e[c]);
        const double height_m = v3_length(n) / v3_length(edge), at_m = side[c] / whole * height_m;
        if (!(at_m >= least)) least = at_m;
    }
    return least;
}

/* Which of the triangles that lie in one place. Faces of two parts often do, a tyre's and its disc's, and at an edge
 * two always do; which of them Embree names hangs on its instruction set. Every triangle that the ray passes through,
 * or by within 20 um, at this distance to 0.1 mm is looked at, in double, and the lowest taken: floats in a node of
 * 20 m are good to a few um. None is accepted, so that none hides another. */
static const double same_edge_m = 2e-5, same_range_m = 1e-4;

typedef struct TieContext {
    struct RTCIntersectContext base;
    const PosedNode           *node;
    const NodeRay             *ray;
    double                     at_m;
    uint32_t                   lowest;
} TieContext;

static void note_tie(const struct RTCFilterFunctionNArguments *a)
{
    TieContext     *tie      = (TieContext *)a->context;
    const NodeMesh *mesh     = tie->node->mesh;
    const uint32_t  triangle = mesh->triangle[((const struct RTCHit *)a->hit)->primID]; /* a->N is 1 */
    a->valid[0] = 0;
    if (triangle < tie->lowest && inside_m(tie->ray, mesh->model, triangle) >= -same_edge_m &&
        fabs(plane_distance(tie->ray, mesh->model, triangle) - tie->at_m) <= same_range_m)
        tie->lowest = triangle;
}

/* Asks along the ray, moved aside by a_m and b_m. */
static void find_ties(TieContext *tie, const double a[3], const double b[3], double a_m, double b_m)
{
    NodeRay r = *tie->ray;
    v3_add_scaled(r.o, r.o, a_m, a);
    v3_add_scaled(r.o, r.o, b_m, b);
    struct RTCRayHit ray = {.ray = narrowed(&r), .hit.geomID = RTC_INVALID_GEOMETRY_ID,
                            .hit.instID[0] = RTC_INVALID_GEOMETRY_ID};
    ray.ray.tnear = (float)fmax(0, tie->at_m - 10 * same_range_m);
    ray.ray.tfar  = (float)(tie->at_m + 10 * same_range_m);
    rtcIntersect1(tie->node->mesh->scene, &tie->base, &ray);
}

static uint32_t lowest_of_ties(const PosedNode *node, const NodeRay *r, uint32_t triangle)
{
    const Model *model = node->mesh->model;
    double       a[3], b[3], other[3] = {0, 0, 0};
    TieContext   tie = {.node = node, .ray = r, .at_m = plane_distance(r, model, triangle), .lowest = triangle};
    rtcInitIntersectContext(&tie.base);
    tie.base.filter = note_tie;
    find_ties(&tie, other, other, 0, 0);
    if (inside_m(r, model, triangle) > 2 * same_edge_m) return tie.lowest;
    other[fabs(r->d[0]) < 0.6 ? 0 : 1] = 1;
    v3_cross(a, r->d, other);
    if (!v3_normalize(a, a)) return tie.lowest;
    v3_cross(b, r->d, a);
    for (int k = 0; k < 4; k++)
        find_ties(&tie, a, b, k < 2 ? (k ? 2 : -2) * same_edge_m : 0, k < 2 ? 0 : (k == 2 ? 2 : -2) * same_edge_m);
    return tie.lowest;
}

double parts_first_hit(PartHit *hit, const PosedEntity *entity, const double o_enu[3], const double d_enu[3],
                       double far_m, bool ask_all)
{
    double best_m = far_m;
    bool   found = false;
    if (!ask_all && !meets_box(entity, o_enu, d_enu)) return INFINITY;
    for (int k = 0; k < entity->node_count; k++) {
        const PosedNode *node = &entity->node[k];
        NodeRay          r;
        if (!node_ray(&r, node, o_enu, d_enu, best_m, ask_all)) continue;

        struct RTCIntersectContext context;
        struct RTCRayHit           ray = {.ray = narrowed(&r), .hit.geomID = RTC_INVALID_GEOMETRY_ID,
                                          .hit.instID[0] = RTC_INVALID_GEOMETRY_ID};
        rtcInitIntersectContext(&context);
        rtcIntersect1(node->mesh->scene, &context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;

        const uint32_t named = node->mesh->triangle[ray.hit.primID];
        const uint32_t triangle = lowest_of_ties(node, &r, named);
        const double   range_m = fmax(0, r.start_m + plane_distance(&r, node->mesh->model, triangle));
        if (!(range_m < best_m)) continue;
        best_m = range_m;
        found  = true;
        *hit   = (PartHit){.node = k, .triangle = triangle};
    }
    return found ? best_m : INFINITY;
}

bool parts_occluded(const PosedEntity *entity, const double o_enu[3], const double d_enu[3], bool ask_all)
{
    bool met = false;
    if (!ask_all && !meets_box(entity, o_enu, d_enu)) return false;
    for (int k = 0; k < entity->node_count && !(met && !ask_all); k++) {
        NodeRay r;
        if (!node_ray(&r, &entity->node[k], o_enu, d_enu, INFINITY, ask_all)) continue;
        struct RTCIntersectContext context;
        struct RTCRay              ray = narrowed(&r);
        rtcInitIntersectContext(&context);
        rtcOccluded1(entity->node[k].mesh->scene, &context, &ray);
        met |= ray.tfar < 0;
    }
    return met;
}

void parts_normals(double n_geo[3], double n_enu[3], const Model *model, const PosedEntity *entity, const PartHit *hit,
                   const double o_enu[3], const double d_enu[3], double range_m)
{
    const PosedNode *node  = &entity->node[hit->node];
    const uint32_t  *index = model->triangle[hit->triangle];
    double           ab[3], ac[3], n[3], at_enu[3], at[3], shading[3] = {0, 0, 0};
    v3_sub(ab, model->vertex[index[1]], model->vertex[index[0]]);
    v3_sub(ac, model->vertex[index[2]], model->vertex[index[0]]);
    v3_cross(n, ab, ac);
    const double area2 = v3_dot(n, n);

    /* barycentric weights of the place on the plane; just outside the triangle they are held to it */
    for (int c = 0; c < 3; c++) at_enu[c] = o_enu[c] + range_m * d_enu[c] - node->p_enu[c];
    m3_tmul_v3(at, node->r_enu_from_node, at_enu);
    v3_sub(at, at, model->vertex[index[0]]);
    double w[3], cross[3];
    v3_cross(cross, at, ac);
    w[1] = clamp(v3_dot(cross, n) / area2, 0, 1);
    v3_cross(cross, ab, at);
    w[2] = clamp(v3_dot(cross, n) / area2, 0, 1);
    w[0] = fmax(0, 1 - w[1] - w[2]);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) shading[c] += w[k] * model->normal[index[k]][c];

    const double to_eye[3] = {-d_enu[0], -d_enu[1], -d_enu[2]};
    m3_mul_v3(n_geo, node->r_enu_from_node, n);
    if (!v3_normalize(n_geo, n_geo)) v3_scale(n_geo, 1, to_eye); /* a triangle without area */
    m3_mul_v3(n_enu, node->r_enu_from_node, shading);
    if (!v3_normalize(n_enu, n_enu)) v3_scale(n_enu, 1, n_geo);
    if (v3_dot(n_geo, d_enu) > 0) {
        v3_scale(n_geo, -1, n_geo);
        v3_scale(n_enu, -1, n_enu);
    }
}
