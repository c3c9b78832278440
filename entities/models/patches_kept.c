/* entities/models/patches_kept.c: the patches of a model from the cache, and into it. */
#include "entities/models/patches.h"

#include <stdlib.h>

/* What of a model its patches follow from: all but names, materials' effects and limits that its motion alone has. */
static CacheKey key_of(const Model *m)
{
    const int64_t count[] = {m->node_count, m->part_count, m->vertex_count, m->triangle_count};
    CacheKey      key = cache_key("patches");
    cache_key_add(&key, count, sizeof count);
    for (int n = 0; n < m->node_count; n++) {
        const ModelNode *node = &m->node[n];
        const int64_t    whole[] = {node->parent, (int64_t)node->joint, node->dis_class, node->dis_metric};
        const double     number[] = {node->low,           node->high,      node->spin_rps_moving,
                                     node->roll_radius_m, node->dis_scale, node->value_slow};
        cache_key_add(&key, whole, sizeof whole);
        cache_key_add(&key, number, sizeof number);
        cache_key_add(&key, node->p_parent, sizeof node->p_parent);
        cache_key_add(&key, node->r_parent_from_node, sizeof node->r_parent_from_node);
        cache_key_add(&key, node->axis, sizeof node->axis);
    }
    for (int p = 0; p < m->part_count; p++) {
        const ModelPart *part = &m->part[p];
        const int64_t    whole[] = {part->node, (int64_t)part->role, part->first_triangle, part->triangle_count,
                                    part->damage_hidden};
        cache_key_add(&key, whole, sizeof whole);
        cache_key_add(&key, &part->thickness_m, sizeof part->thickness_m);
        cache_key_add(&key, part->material, strlen(part->material) + 1);
    }
    cache_key_add(&key, m->vertex, (size_t)m->vertex_count * sizeof *m->vertex);
    cache_key_add(&key, m->normal, (size_t)m->vertex_count * sizeof *m->normal);
    cache_key_add(&key, m->triangle, (size_t)m->triangle_count * sizeof *m->triangle);
    cache_key_add(&key, m->triangle_part, (size_t)m->triangle_count * sizeof *m->triangle_part);
    return key;
}

static void pass_int(Kept *kept, int *value, int low, int high)
{
    int32_t number = *value;
    kept_pass(kept, &number, sizeof number);
    kept_check(kept, number >= low && number <= high);
    if (kept->good) *value = number;
}

static void pass_patch(Kept *kept, Patch *p, const Model *model)
{
    int role = (int)p->role;
    pass_int(kept, &p->node, 0, model->node_count - 1);
    pass_int(kept, &p->part, 0, model->part_count - 1);
    pass_int(kept, &role, 0, HEAT_ROLE_COUNT - 1);
    p->role = (HeatRole)role;
    kept_doubles(kept, &p->area_m2, 1);
    kept_doubles(kept, &p->open_share, 1);
    kept_doubles(kept, &p->ground_m2, 1);
    kept_doubles(kept, p->p_node, 3);
    kept_doubles(kept, p->n_node, 3);
    kept_doubles(kept, &p->facing, 1);
    kept_doubles(kept, &p->reach_m, 1);
    kept_doubles(kept, p->point_node[0], (size_t)3 * patch_points);
    kept_doubles(kept, p->point_n_node[0], (size_t)3 * patch_points);
}

static void pass_link(Kept *kept, PatchLink *l, int patches)
{
    uint8_t joint = l->joint;
    pass_int(kept, &l->a, 0, patches - 1);
    pass_int(kept, &l->b, 0, patches - 1);
    kept_doubles(kept, &l->length_m, 1);
    kept_doubles(kept, &l->distance_m, 1);
    kept_pass(kept, &joint, sizeof joint);
    kept_check(kept, joint <= 1);
    l->joint = joint;
}

/* Room for what was counted, which is no more than a model may have. */
static void make_room(Kept *kept, Patches *p, bool moved)
{
    if (!kept_is_read(kept) || !kept->good) return;
    p->patch = calloc((size_t)p->count + 1, sizeof *p->patch);
    p->link = calloc((size_t)p->links + 1, sizeof *p->link);
    p->body_of_part = calloc((size_t)p->parts + 1, sizeof *p->body_of_part);
    p->first_of_body = calloc((size_t)p->bodies + 1, sizeof *p->first_of_body);
    p->body_of_node = moved ? calloc((size_t)p->parts + 1, sizeof *p->body_of_node) : NULL;
    kept_check(kept, p->patch && p->link && p->body_of_part && p->first_of_body && (p->body_of_node || !moved));
}

void patches_kept_values(Kept *kept, void *user)
{
    const PatchesKept *of = user;
    Patches           *p = of->patches;
    uint8_t            moved = p->body_of_node != NULL;
    const int          parts = of->model->part_count;
    pass_int(kept, &p->count, 0, patches_most);
    pass_int(kept, &p->links, 0, patches_most * patches_most);
    pass_int(kept, &p->bodies, 0, parts);
    pass_int(kept, &p->parts, parts, parts);
    kept_pass(kept, &moved, sizeof moved);
    kept_check(kept, moved <= 1);
    make_room(kept, p, moved);
    if (!kept->good) return;
    for (int i = 0; i < p->count; i++) pass_patch(kept, &p->patch[i], of->model);
    for (int i = 0; i < p->links; i++) pass_link(kept, &p->link[i], p->count);
    for (int i = 0; i < p->parts; i++) pass_int(kept, &p->body_of_part[i], 0, p->bodies - 1);
    for (int i = 0; i <= p->bodies; i++)
        pass_int(kept, &p->first_of_body[i], i > 0 ? p->first_of_body[i - 1] : 0,
                 i == p->bodies ? p->count : p->count - 1);
    kept_check(kept, p->first_of_body[0] == 0 && p->first_of_body[p->bodies] == p->count);
    for (int i = 0; moved && i < p->parts; i++) {
        kept_doubles(kept, p->body_of_node[i].p_body, 3);
        kept_doubles(kept, p->body_of_node[i].r_body_from_node, 9);
    }
}

Status patches_create_kept(Patches *out, const Model *model, Cache *cache)
{
    Patches patches = {0};
    if (!cache) return patches_create(out, model);
    CacheKey key = key_of(model);
    if (kept_fetch(patches_kept_values, &(PatchesKept){&patches, model}, cache, &key)) {
        *out = patches;
        return STATUS_OK;
    }
    patches_destroy(&patches);
    const Status status = patches_create(out, model);
    if (status == STATUS_OK) kept_keep(patches_kept_values, &(PatchesKept){out, model}, cache, &key);
    return status;
}
