/* render/heat/vehicle_state.c: keeps the temperatures of one entity from step to step (vehicle_state_private.h). */
#include "render/heat/vehicle_state_private.h"

#include <stdlib.h>

static const double turned_cos = 0.985; /* 10 degrees */

static size_t block_bytes(const VehicleShape *shape, const Model *model)
{
    const size_t n = (size_t)shape->nodes, p = (size_t)shape->patches->count;
    return sizeof(VehicleState) + (n + (size_t)model->node_count) * sizeof(double) + n * sizeof(NetworkLoad) +
           p * (sizeof(PatchView) + 5 * sizeof(float) + sizeof(int));
}

/* Allocates the state and all its arrays as one block. */
VehicleState *vehicle_state_create(const VehicleShape *shape, const Model *model)
{
    const size_t n = (size_t)shape->nodes, p = (size_t)shape->patches->count, j = (size_t)model->node_count;
    char        *at = calloc(1, block_bytes(shape, model));
    if (!at) return NULL;
    VehicleState *s = (VehicleState *)(void *)at;
    s->temp_k = (double *)(void *)(at + sizeof *s);
    s->joint = s->temp_k + n;
    s->load = (NetworkLoad *)(void *)(s->joint + j);
    s->view = (PatchView *)(void *)(s->load + n);
    s->now_k = (float *)(void *)(s->view + p);
    s->next_k = s->now_k + p;
    s->sent_w_m2 = s->next_k + p;
    s->was_k = s->sent_w_m2 + p;
    s->was_sent_w_m2 = s->was_k + p;
    s->given = (int *)(void *)(s->was_sent_w_m2 + p);
    s->was_s = s->checked_s = -INFINITY;
    return s;
}

void vehicle_state_destroy(VehicleState *s)
{
    if (s) free(s->near);
    free(s);
}

size_t vehicle_state_bytes(const VehicleState *s, const VehicleShape *shape, const Model *model)
{
    const size_t near = s->near ? sizeof *s->near + 2 * (size_t)shape->patches->count * sizeof(NearView) : 0;
    return block_bytes(shape, model) + near;
}

int vehicle_state_find(VehicleState *const *state, int count, DisEntityId id)
{
    int low = 0, high = count;
    while (low < high) {
        const int middle = low + (high - low) / 2, order = dis_entity_id_compare(state[middle]->id, id);
        if (order == 0) return middle;
        if (order < 0) low = middle + 1;
        else high = middle;
    }
    return -1;
}

/* Finds the given temperature of each patch: of the parts of its body, the one that is named most closely counts. */
void vehicle_state_given(VehicleState *s, const GivenHeat *given, const Patches *patches, const Model *model)
{
    int best[patches_most];
    for (int i = 0; i < patches->count; i++) s->given[i] = best[i] = -1;
    for (int part = 0; given && part < model->part_count; part++) {
        const int body = patches->body_of_part[part], first = patches->first_of_body[body],
                  end = patches->first_of_body[body + 1];
        int       rank;
        const int found = given_heat_find(&rank, given, s->id, model, part);
        if (first == end || rank <= best[first]) continue;
        best[first] = rank;
        for (int i = first; i < end; i++) s->given[i] = found;
    }
}

/* Interpolates a patch's temperature linearly between the entity's own two times. */
static float between(const VehicleState *s, int patch, double t_s)
{
    const float share = s->next_s > s->t_s ? (float)clamp((t_s - s->t_s) / (s->next_s - s->t_s), 0, 1) : 0;
    return s->now_k[patch] + share * (s->next_k[patch] - s->now_k[patch]);
}

double vehicle_state_k(const VehicleState *s, const GivenHeat *given, int patch, double t_s)
{
    if (s->given[patch] >= 0) return (double)(float)given_heat_k(given, s->given[patch], t_s);
    return (double)between(s, patch, t_s);
}

bool vehicle_state_then(double *temp_k, double *sent_w_m2, const VehicleState *s, int patch, double t_s)
{
    const bool was = s->was_s == t_s;
    if (was ? !s->was_shown : !s->shown) return false;
    *sent_w_m2 = (double)(was ? s->was_sent_w_m2 : s->sent_w_m2)[patch];
    *temp_k = (double)(was ? s->was_k[patch] : between(s, patch, t_s));
    return true;
}

void vehicle_state_remember(VehicleState *s, int patches, double t_s)
{
    for (int i = 0; i < patches; i++) s->was_k[i] = between(s, i, t_s);
    memcpy(s->was_sent_w_m2, s->sent_w_m2, (size_t)patches * sizeof *s->sent_w_m2);
    s->was_s = t_s, s->was_shown = s->shown;
}

static bool joints_moved(const VehicleMoment *m, const VehicleState *s)
{
    static const double moved = 0.17; /* rad, m */
    for (int n = 0; n < m->model->node_count; n++) {
        const ModelNode *node = &m->model->node[n];
        if (node->spin_rps_moving != 0 || node->roll_radius_m > 0) continue;
        if (fabs(m->joint[n] - s->joint[n]) > moved) return true;
    }
    return false;
}

static void up_in_body(double up_body[3], const double r_enu_from_body[9])
{
    for (int k = 0; k < 3; k++) up_body[k] = r_enu_from_body[6 + k];
}

static void ahead_in_enu(double ahead_enu[3], const double r_enu_from_body[9])
{
    for (int k = 0; k < 3; k++) ahead_enu[k] = r_enu_from_body[3 * k];
}

bool vehicle_state_sees(const VehicleState *s, const VehicleMoment *m)
{
    static const double near_m = 0.3, high_m = 1.5; /* above it nothing is under it: heat_patches.c */
    double              up_body[3];
    up_in_body(up_body, m->pose.r_enu_from_body);
    const double above_m = fmin(m->place.above_m, high_m), viewed_m = fmin(s->view_above_m, high_m);
    return v3_dot(up_body, s->view_up_body) >= turned_cos && fabs(above_m - viewed_m) <= near_m && !joints_moved(m, s);
}

void vehicle_state_stay(VehicleState *s, const VehicleMoment *m, double t_s)
{
    s->t_s = t_s;
    s->drives = m->entity->drives;
    ahead_in_enu(s->ahead_enu, m->pose.r_enu_from_body);
    up_in_body(s->up_body, m->pose.r_enu_from_body);
}

static bool differs(double a, double b, double share, double least)
{
    return fabs(a - b) > fmax(share * fmax(fabs(a), fabs(b)), least);
}

static bool drives_changed(const EntityDrives *a, const EntityDrives *b)
{
    return differs((double)a->engine, (double)b->engine, 0, 0.05) ||
           differs((double)a->speed_mps, (double)b->speed_mps, 0.1, 1) || a->burning != b->burning ||
           a->motor != b->motor || a->flare != b->flare || a->alive != b->alive || a->flying != b->flying ||
           a->fired_kg[0] != b->fired_kg[0] || a->fired_kg[1] != b->fired_kg[1];
}

bool vehicle_state_changed(const VehicleState *s, const SnapshotEntity *now, const double r_enu_from_body[9])
{
    double ahead_enu[3], up_body[3];
    ahead_in_enu(ahead_enu, r_enu_from_body);
    up_in_body(up_body, r_enu_from_body);
    return drives_changed(&s->drives, &now->drives) || v3_dot(ahead_enu, s->ahead_enu) < turned_cos ||
           v3_dot(up_body, s->up_body) < turned_cos;
}

void vehicle_state_look(VehicleState *s, const VehicleMoment *m)
{
    s->looked = 0;
    s->view_above_m = m->place.above_m;
    up_in_body(s->view_up_body, m->pose.r_enu_from_body);
    memcpy(s->joint, m->joint, (size_t)m->model->node_count * sizeof *s->joint);
    if (s->near && s->near->next_seen > 0) s->near->looked = 0;
}
