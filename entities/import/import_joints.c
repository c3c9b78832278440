/* entities/import/import_joints.c: which nodes move, about which axes, and together with which nodes. */
#include "entities/import/model_import_private.h"

#include <stdlib.h>
#include <strings.h>

enum { path_max = 1024 };

/* ---- patterns --------------------------------------------------------------------------------------- */

/* On a mismatch the last star takes one character more: pattern times text steps at most. */
bool import_matches(const char *pattern, const char *text)
{
    const char *star = NULL, *resume = NULL;
    while (*text) {
        if (*pattern == '*') {
            star = ++pattern;
            resume = text;
        } else if (*pattern == *text || *pattern == '?') {
            pattern++;
            text++;
        } else if (star) {
            pattern = star;
            text = ++resume;
        } else {
            return false;
        }
    }
    while (*pattern == '*') pattern++;
    return *pattern == 0;
}

static bool node_matches(const char *pattern, const ImportScene *scene, const ImportPlace *place, int node)
{
    return import_matches(pattern, scene->node[node].name) || import_matches(pattern, place[node].path);
}

const SidecarRule *import_rule(const SidecarRules *rules, const ImportScene *scene, const ImportPlace *place, int node,
                               int damage)
{
    for (int at = node; at >= 0; at = scene->node[at].parent)
        for (int i = rules->count - 1; i >= 0; i--)
            if (rules->rule[i].damage == damage && node_matches(rules->rule[i].pattern, scene, place, at))
                return &rules->rule[i];
    return NULL;
}

/* ---- places ------------------------------------------------------------------------------------------- */

static void affine_mul(double out[12], const double a[12], const double b[12])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            double sum = j == 3 ? a[4 * i + 3] : 0;
            for (int k = 0; k < 3; k++) sum += a[4 * i + k] * b[4 * k + j];
            out[4 * i + j] = sum;
        }
}

static void affine_point(double out[3], const double m[12], const double p[3])
{
    for (int i = 0; i < 3; i++) out[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
}

static void affine_vector(double out[3], const double m[12], const double d[3])
{
    for (int i = 0; i < 3; i++) out[i] = m[4 * i] * d[0] + m[4 * i + 1] * d[1] + m[4 * i + 2] * d[2];
}

/* Finds each node's position, its path from the root, and whether it is in the tree. */
static Status place_nodes(ImportPlace *place, const ImportScene *scene, const Sidecar *sidecar)
{
    for (int i = 0; i < scene->node_count; i++) {
        const ImportNode *node = &scene->node[i];
        char              path[path_max + model_name_size + 2];
        if (node->parent < 0) {
            memcpy(place[i].m, node->m, sizeof place[i].m);
            snprintf(path, sizeof path, "%s", node->name);
        } else {
            affine_mul(place[i].m, place[node->parent].m, node->m);
            snprintf(path, sizeof path, "%s/%s", place[node->parent].path, node->name);
        }
        /* a path deeper than any pattern: only the name is kept, so that memory does not grow with depth */
        place[i].path = strdup(strlen(path) < path_max ? path : node->name);
        if (!place[i].path) return STATUS_NO_MEMORY;
        place[i].joint = -1;
        place[i].dropped = node->parent >= 0 && place[node->parent].dropped;
        for (int d = 0; d < sidecar->drop.count && !place[i].dropped; d++)
            place[i].dropped = node_matches(sidecar->drop.rule[d].pattern, scene, place, i);
    }
    return STATUS_OK;
}

/* ---- joints --------------------------------------------------------------------------------------------- */

typedef struct Builder {
    const ImportScene *scene;
    const Sidecar     *sidecar;
    const double      *r_body_from_file;
    double             scale_m;
    ImportJoints      *out;
    int                spec[sidecar_max_joints + 1]; /* entry of the sidecar for each joint; -1: none */
    int                first[sidecar_max_joints];    /* joint of each entry that has one; -1: not found yet */
} Builder;

static Status refuse_joint(const Builder *b, const SidecarJoint *spec, const char *what, const char *which)
{
    log_error("sidecar: %s:%d: joints: %s: '%s'", b->sidecar->path, spec->line, what, which);
    return STATUS_BAD_VALUE;
}

static const ImportDof *dof_of(const ImportScene *scene, int node)
{
    for (int i = 0; i < scene->dof_count; i++)
        if (scene->dof[i].node == node) return &scene->dof[i];
    return NULL;
}

static int spec_of(const Builder *b, int node)
{
    for (int j = b->sidecar->joint_count - 1; j >= 0; j--) {
        const SidecarJoint *spec = &b->sidecar->joint[j];
        for (int p = 0; p < spec->pattern_count; p++)
            if (node_matches(spec->pattern[p], b->scene, b->out->place, node)) return j;
    }
    return -1;
}

/* Turns an axis so that DIS's sign is the joint's: azimuth about body down, elevation about body right. */
static void turn_to_dis_sign(ImportJoint *joint)
{
    const double along = joint->dis_metric == 11   ? joint->axis_body[2]
                         : joint->dis_metric == 13 ? joint->axis_body[1]
                                                   : 1;
    if (along >= 0) return;
    for (int i = 0; i < 3; i++) joint->axis_body[i] = 0.0 - joint->axis_body[i];
    const double low = joint->low;
    if (joint->low <= joint->high) {
        joint->low = -joint->high;
        joint->high = -low;
    }
}

/* Takes over the properties of a degree of freedom in the file. OpenFlight has no articulation class; it may follow
 * from the name. */
static void fill_from_dof(ImportJoint *joint, const Builder *b, const ImportDof *dof)
{
    const int   parent = b->scene->node[dof->node].parent;
    double      axis_file[3];
    const char *name = b->scene->node[dof->node].name;
    joint->from_file = true;
    joint->kind = dof->slides ? JOINT_TRANSLATION : JOINT_ROTATION;
    if (parent >= 0) {
        affine_point(joint->p_pivot_file, b->out->place[parent].m, dof->p_pivot_parent);
        affine_vector(axis_file, b->out->place[parent].m, dof->axis_parent);
    } else {
        memcpy(joint->p_pivot_file, dof->p_pivot_parent, sizeof joint->p_pivot_file);
        memcpy(axis_file, dof->axis_parent, sizeof axis_file);
    }
    m3_mul_v3(joint->axis_body, b->r_body_from_file, axis_file);
    if (!v3_normalize(joint->axis_body, joint->axis_body)) joint->axis_body[2] = 1;
    joint->low = dof->limited ? dof->low : 1;
    joint->high = dof->limited ? dof->high : -1;
    if (dof->slides) {
        joint->low *= b->scale_m;
        joint->high *= b->scale_m;
    } else if (fabs(joint->axis_body[2]) > 0.9 && strcasestr(name, "turret")) {
        joint->dis_class = 4096;
        joint->dis_metric = 11;
    } else if (fabs(joint->axis_body[1]) > 0.9 && (strcasestr(name, "gun") || strcasestr(name, "barrel"))) {
        joint->dis_class = 4416;
        joint->dis_metric = 13;
    }
    turn_to_dis_sign(joint);
}

/* Calls `each` for all of a joint's vertices, in the file's axes. */
static void walk_vertices(const Builder *b, int joint, void (*each)(void *user, const double p_file[3]), void *user)
{
    for (int i = 0; i < b->scene->mesh_count; i++) {
        const ImportMesh  *mesh = &b->scene->mesh[i];
        const ImportPlace *place = &b->out->place[mesh->node];
        if (place->joint != joint || place->dropped) continue;
        for (int v = mesh->first_vertex; v < mesh->first_vertex + mesh->vertex_count; v++) {
            double p[3];
            affine_point(p, place->m, b->scene->vertex[v]);
            each(user, p);
        }
    }
}

static void grow_box(void *user, const double p_file[3])
{
    double(*box)[3] = user;
    for (int i = 0; i < 3; i++) {
        box[0][i] = fmin(box[0][i], p_file[i]);
        box[1][i] = fmax(box[1][i], p_file[i]);
    }
}

typedef struct Radius {
    const double *p_pivot_file, *axis_file;
    double        most;
} Radius;

static void grow_radius(void *user, const double p_file[3])
{
    Radius *radius = user;
    double  off[3];
    v3_sub(off, p_file, radius->p_pivot_file);
    v3_add_scaled(off, off, -v3_dot(off, radius->axis_file), radius->axis_file);
    radius->most = fmax(radius->most, v3_length(off));
}

/* The sidecar's values override those of the file. */
static Status fill_from_spec(ImportJoint *joint, const Builder *b, const SidecarJoint *spec, int index)
{
    const char *node = b->scene->node[joint->source].name;
    const bool  sided = !joint->from_file || spec->axis != AXIS_DEFAULT; /* the sign of the axis is set explicitly */
    if (spec->slides) joint->kind = JOINT_TRANSLATION;
    else if (!joint->from_file || spec->dis_metric >= 11) joint->kind = JOINT_ROTATION;
    if (spec->dis_class) {
        joint->dis_class = spec->dis_class;
        joint->dis_metric = spec->dis_metric;
    }
    if (spec->axis == AXIS_BODY) {
        memcpy(joint->axis_body, spec->axis_xyz, sizeof joint->axis_body);
    } else if (spec->axis == AXIS_FILE) {
        m3_mul_v3(joint->axis_body, b->r_body_from_file, spec->axis_xyz);
    } else if (!joint->from_file) {
        const double  yaw[3] = {0, 0, 1}, pitch[3] = {0, 1, 0}, rolling[3] = {0, -1, 0};
        const double *axis = joint->dis_metric == 11    ? yaw
                             : joint->dis_metric == 13  ? pitch
                             : spec->roll_radius_m != 0 ? rolling
                                                        : NULL;
        if (!axis) return refuse_joint(b, spec, "axis: is missing, about what it turns or slides along", node);
        memcpy(joint->axis_body, axis, sizeof joint->axis_body);
    }
    if (!sided) turn_to_dis_sign(joint);
    if (spec->has_limits) {
        joint->low = spec->low;
        joint->high = spec->high;
    }
    if (joint->kind == JOINT_TRANSLATION && joint->low > joint->high)
        return refuse_joint(b, spec, "limits_m: is missing for what slides", node);

    if (spec->pivot == PIVOT_GIVEN) {
        memcpy(joint->p_pivot_file, spec->p_pivot_file, sizeof joint->p_pivot_file);
    } else if (spec->pivot == PIVOT_CENTRE) {
        double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        walk_vertices(b, index, grow_box, box);
        if (!(box[0][0] <= box[1][0]))
            return refuse_joint(b, spec, "pivot: centre of nothing: no triangles move with", node);
        for (int i = 0; i < 3; i++) joint->p_pivot_file[i] = 0.5 * (box[0][i] + box[1][i]);
    } else if (!joint->from_file) {
        const double *m = b->out->place[joint->source].m;
        for (int i = 0; i < 3; i++) joint->p_pivot_file[i] = m[4 * i + 3];
        bool placed = false;
        for (int n = joint->source; n >= 0 && !placed; n = b->scene->node[n].parent)
            placed = b->scene->node[n].m[3] != 0 || b->scene->node[n].m[7] != 0 || b->scene->node[n].m[11] != 0;
        if (!placed)
            return refuse_joint(b, spec, "pivot: is missing (x y z or centre), for no place is in the file for node",
                                node);
    }
    joint->rest = spec->rest;
    joint->spin_rps = spec->spin_rps;
    joint->roll_radius_m = spec->roll_radius_m;
    if (spec->roll_radius_m < 0) {
        double axis_file[3];
        m3_tmul_v3(axis_file, b->r_body_from_file, joint->axis_body);
        Radius radius = {joint->p_pivot_file, axis_file, 0};
        walk_vertices(b, index, grow_radius, &radius);
        joint->roll_radius_m = radius.most * b->scale_m;
        if (!(joint->roll_radius_m > 0))
            return refuse_joint(b, spec, "roll_radius: auto of nothing: no triangles move with", node);
    }
    return STATUS_OK;
}

static Status new_joint(Builder *b, int node, int spec)
{
    if (b->out->count == sidecar_max_joints) {
        log_error("model: more than %d joints: sidecar=%s", sidecar_max_joints, b->sidecar->path);
        return STATUS_BAD_VALUE;
    }
    ImportJoint *joint = &b->out->joint[b->out->count];
    *joint = (ImportJoint){.parent = -1, .source = node, .kind = JOINT_ROTATION, .low = 1, .high = -1};
    const char *name =
        spec >= 0 && b->sidecar->joint[spec].name[0] ? b->sidecar->joint[spec].name : b->scene->node[node].name;
    snprintf(joint->name, sizeof joint->name, "%s", *name ? name : "joint");
    b->spec[b->out->count] = spec;
    b->out->place[node].joint = b->out->count++;
    return STATUS_OK;
}

/* Assigns a joint to each node: its own, or that of the node above it. */
static Status assign_joints(Builder *b)
{
    for (int j = 0; j < sidecar_max_joints; j++) b->first[j] = -1;
    for (int i = 0; i < b->scene->node_count; i++) {
        ImportPlace *place = &b->out->place[i];
        const int    parent = b->scene->node[i].parent, spec = spec_of(b, i);
        const int    above = parent >= 0 ? b->out->place[parent].joint : -1;
        Status       status = STATUS_OK;
        place->joint = above;
        if (place->dropped) continue;
        if (spec < 0) {
            if (dof_of(b->scene, i)) status = new_joint(b, i, -1);
        } else if (b->sidecar->joint[spec].each) {
            if (above < 0 || b->spec[above] != spec) status = new_joint(b, i, spec);
            b->first[spec] = place->joint;
        } else if (b->first[spec] >= 0) {
            place->joint = b->first[spec];
        } else {
            status = new_joint(b, i, spec);
            b->first[spec] = place->joint;
        }
        if (status != STATUS_OK) return status;
    }
    for (int j = 0; j < b->sidecar->joint_count; j++)
        if (b->first[j] < 0) {
            import_report_missing_node(b->scene, b->out->place, b->sidecar, j);
            return STATUS_BAD_VALUE;
        }
    return STATUS_OK;
}

static Status find_parents(Builder *b)
{
    for (int j = 0; j < b->out->count; j++) {
        ImportJoint        *joint = &b->out->joint[j];
        const SidecarJoint *spec = b->spec[j] >= 0 ? &b->sidecar->joint[b->spec[j]] : NULL;
        const int           above = b->scene->node[joint->source].parent;
        joint->parent = above >= 0 ? b->out->place[above].joint : -1;
        if (!spec || !spec->parent[0]) continue;
        for (joint->parent = b->out->count - 1; joint->parent >= 0; joint->parent--)
            if (joint->parent != j && strcmp(b->out->joint[joint->parent].name, spec->parent) == 0) break;
        if (joint->parent < 0) return refuse_joint(b, spec, "parent: no joint has this name", spec->parent);
    }
    return STATUS_OK;
}

/* Sorts joints: parents first, otherwise in their present order. */
static Status sort_joints(Builder *b)
{
    ImportJoint sorted[sidecar_max_joints];
    int         to[sidecar_max_joints];
    int         count = 0, before;
    for (int j = 0; j < b->out->count; j++) to[j] = -1;
    do {
        before = count;
        for (int j = 0; j < b->out->count; j++) {
            const int parent = b->out->joint[j].parent;
            if (to[j] >= 0 || (parent >= 0 && to[parent] < 0)) continue;
            sorted[count] = b->out->joint[j];
            sorted[count].parent = parent >= 0 ? to[parent] : -1;
            to[j] = count++;
        }
    } while (count > before);
    if (count < b->out->count) {
        log_error("sidecar: %s: joints: each is the parent of the other in a ring", b->sidecar->path);
        return STATUS_BAD_VALUE;
    }
    memcpy(b->out->joint, sorted, (size_t)count * sizeof *sorted);
    for (int i = 0; i < b->scene->node_count; i++)
        if (b->out->place[i].joint >= 0) b->out->place[i].joint = to[b->out->place[i].joint];
    return STATUS_OK;
}

Status import_joints(ImportJoints *out, const ImportScene *scene, const Sidecar *sidecar,
                     const double r_body_from_file[9], double scale_m)
{
    ImportJoints joints = {.joint = calloc(sidecar_max_joints, sizeof *joints.joint),
                           .place = calloc((size_t)scene->node_count, sizeof *joints.place)};
    Builder     *b = calloc(1, sizeof *b);
    Status       status = b && joints.joint && joints.place ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        *b = (Builder){.scene = scene,
                       .sidecar = sidecar,
                       .r_body_from_file = r_body_from_file,
                       .scale_m = scale_m,
                       .out = &joints};
        status = place_nodes(joints.place, scene, sidecar);
    }
    if (status == STATUS_OK) status = assign_joints(b);
    if (status == STATUS_OK) status = find_parents(b);
    for (int j = 0; j < joints.count && status == STATUS_OK; j++) {
        const ImportDof *dof = dof_of(scene, joints.joint[j].source);
        if (dof) fill_from_dof(&joints.joint[j], b, dof);
        if (b->spec[j] >= 0) status = fill_from_spec(&joints.joint[j], b, &sidecar->joint[b->spec[j]], j);
    }
    if (status == STATUS_OK) status = sort_joints(b);
    free(b);
    if (status == STATUS_OK) *out = joints;
    else import_joints_close(&joints, scene->node_count);
    return status;
}

void import_joints_close(ImportJoints *joints, int node_count)
{
    for (int i = 0; joints->place && i < node_count; i++) free(joints->place[i].path);
    free(joints->place);
    free(joints->joint);
    memset(joints, 0, sizeof *joints);
}
