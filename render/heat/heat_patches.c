/* render/heat/heat_patches.c: the patches of models, cut when they are needed; what each sees of sky, ground, its own
 * parts and neighbours. */

#include "render/heat/vehicle_heat.h"
#include "render/heat/vehicle_load_private.h"

#include <pthread.h>
#include <stdlib.h>

typedef struct PatchCut {
    pthread_t    thread;
    const Model *model;
    Cache       *cache;
    Patches      patches;
    Status       status;
} PatchCut;

Status heat_patches_create(PatchSet *out, int models)
{
    PatchSet set = {models,
                    calloc((size_t)models + 1, sizeof *set.of),
                    calloc((size_t)models + 1, sizeof *set.cut),
                    calloc((size_t)models + 1, sizeof *set.ahead),
                    NULL,
                    view_memory_create()};
    if (!set.of || !set.cut || !set.ahead || !set.seen) {
        heat_patches_destroy(&set);
        return STATUS_NO_MEMORY;
    }
    *out = set;
    return STATUS_OK;
}

static void *cut(void *user)
{
    PatchCut *c = user;
    thread_flush_denormals();
    c->status = patches_create_kept(&c->patches, c->model, c->cache);
    return NULL;
}

void heat_patches_begin(PatchSet *set, int index, const Model *model)
{
    if (index < 0 || index >= set->models || set->cut[index] || set->ahead[index]) return;
    PatchCut *c = calloc(1, sizeof *c);
    if (!c) return;
    c->model = model, c->cache = set->cache;
    if (pthread_create(&c->thread, NULL, cut, c) == 0) set->ahead[index] = c;
    else free(c);
}

/* Waits for a model that is being cut. */
static Status take(PatchSet *set, int index)
{
    PatchCut *c = set->ahead[index];
    pthread_join(c->thread, NULL);
    const Status status = c->status;
    if (status == STATUS_OK) set->of[index] = c->patches;
    set->ahead[index] = NULL;
    free(c);
    return status;
}

void heat_patches_destroy(PatchSet *set)
{
    for (int m = 0; set->ahead && m < set->models; m++)
        if (set->ahead[m]) take(set, m);
    for (int m = 0; set->of && m < set->models; m++) patches_destroy(&set->of[m]);
    free(set->of);
    free(set->cut);
    free(set->ahead);
    view_memory_destroy(set->seen);
    *set = (PatchSet){0};
}

Status heat_patches_need(PatchSet *set, int index, const Model *model)
{
    if (index < 0 || index >= set->models || set->cut[index]) return STATUS_OK;
    const Status status =
        set->ahead[index] ? take(set, index) : patches_create_kept(&set->of[index], model, set->cache);
    set->cut[index] = status == STATUS_OK;
    return status;
}

/* ---- what patches see ------------------------------------------------------------------------ */

static const double leave_m = 2e-3;

static void to_enu(double out_enu[3], const PatchPose *pose, int node, const double v_node[3], bool place)
{
    double body[3];
    m3_mul_v3(body, pose->node[node].r_body_from_node, v_node);
    for (int k = 0; place && k < 3; k++) body[k] += pose->node[node].p_body[k];
    m3_mul_v3(out_enu, pose->r_enu_from_body, body);
}

void vehicle_view_normal(double n_enu[3], const PatchPose *pose, int patch)
{
    to_enu(n_enu, pose, pose->patches->patch[patch].node, pose->patches->patch[patch].n_node, false);
}

/* A point of a patch, off its surface, with its normal. */
static void stand(double o_enu[3], double n_enu[3], const PatchPose *pose, int patch, int point)
{
    const Patch *p = &pose->patches->patch[patch];
    to_enu(o_enu, pose, p->node, p->point_node[point], true);
    to_enu(n_enu, pose, p->node, p->point_n_node[point], false);
    v3_add_scaled(o_enu, o_enu, leave_m, n_enu);
}

/* Direction k of some rays about a normal, by the cosine: rings of equal share, turned by the golden angle from one
 * to the next, and from point to point. */
static void direction(double d_enu[3], const double n_enu[3], int k, int point, int rays)
{
    static const double golden_rad = 2.399963229728653;
    double              u[3], v[3];
    const int           thin = fabs(n_enu[0]) < fabs(n_enu[1]) ? (fabs(n_enu[0]) < fabs(n_enu[2]) ? 0 : 2)
                                                               : (fabs(n_enu[1]) < fabs(n_enu[2]) ? 1 : 2);
    const double        axis[3] = {thin == 0, thin == 1, thin == 2};
    v3_cross(u, n_enu, axis);
    v3_normalize(u, u);
    v3_cross(v, n_enu, u);
    const double s2 = (k + 0.25 + 0.5 * (point % 2)) / rays, turn = golden_rad * (k + 0.5 * point) + point;
    const double sine = sqrt(s2), cosine = sqrt(1 - s2);
    for (int i = 0; i < 3; i++) d_enu[i] = cosine * n_enu[i] + sine * (cos(turn) * u[i] + sin(turn) * v[i]);
}

/* The patch of a triangle that a ray met at a place: of its body the one that is nearest and faces the same way. */
static int patch_met(const PatchPose *pose, const PartHit *hit, const double p_enu[3], const double d_enu[3])
{
    const Patches   *patches = pose->patches;
    const int        part = pose->model->triangle_part[hit->triangle], body = patches->body_of_part[part];
    const PosedNode *node = &pose->posed->node[hit->node];
    double           local[3], p_node[3], back[3] = {-d_enu[0], -d_enu[1], -d_enu[2]}, b_node[3], best = INFINITY;
    int              found = patches->first_of_body[body];
    v3_sub(local, p_enu, node->p_enu);
    m3_tmul_v3(p_node, node->r_enu_from_node, local);
    m3_tmul_v3(b_node, node->r_enu_from_node, back);
    for (int i = patches->first_of_body[body]; i < patches->first_of_body[body + 1]; i++) {
        double away[3];
        if (!(patches->patch[i].open_share > 0)) continue; /* it is inside */
        v3_sub(away, patches->patch[i].p_node, p_node);
        const double facing = v3_dot(patches->patch[i].n_node, b_node),
                     d2 = v3_dot(away, away) + (facing > 0 ? 0 : 1e3);
        if (d2 < best) best = d2, found = i;
    }
    return found;
}

/* Whether a ray from o meets the ground within the outline of the entity. */
static bool meets_under(const PatchPose *pose, const double o_enu[3], const double d_enu[3])
{
    static const double more_m = 0.2, low_m = 1.5;
    const double       *low = pose->posed->box_low, *high = pose->posed->box_high;
    double              at_enu[3], at[3];
    if (!(pose->above_m < low_m) || !(d_enu[2] < 0)) return false;
    v3_add_scaled(at_enu, o_enu, fmax(o_enu[2] + pose->above_m, 0) / -d_enu[2], d_enu);
    m3_tmul_v3(at, pose->r_enu_from_body, at_enu);
    return at[0] > low[0] - more_m && at[0] < high[0] + more_m && at[1] > low[1] - more_m && at[1] < high[1] + more_m;
}

void vehicle_view_look(PatchView *out, const PatchPose *pose, int patch)
{
    static const float each = 1.0f / (patch_points * patch_view_rays);
    uint16_t           met[patches_most] = {0};
    int                others = 0;
    *out = (PatchView){0};
    if (!(pose->patches->patch[patch].open_share > 0)) return; /* inside: it meets nothing */
    for (int point = 0; point < patch_points; point++) {
        double o_enu[3], n_enu[3];
        stand(o_enu, n_enu, pose, patch, point);
        for (int k = 0; k < patch_view_rays; k++) {
            double  d_enu[3], at_enu[3];
            PartHit hit;
            direction(d_enu, n_enu, k, point, patch_view_rays);
            const double t_m = parts_first_hit(&hit, pose->posed, o_enu, d_enu, INFINITY, false);
            if (t_m < INFINITY) {
                v3_add_scaled(at_enu, o_enu, t_m, d_enu);
                others += met[patch_met(pose, &hit, at_enu, d_enu)]++ == 0;
            } else if (d_enu[2] >= 0) {
                out->sky += each;
            } else if (meets_under(pose, o_enu, d_enu)) {
                out->under += each;
            } else {
                out->ground += each;
            }
        }
    }
    /* the largest shares are kept, and stand for all */
    int kept = 0, all = 0;
    for (int i = 0; i < pose->patches->count; i++) all += met[i];
    while (out->partners < patch_partners && out->partners < others) {
        int most = 0;
        for (int i = 1; i < pose->patches->count; i++)
            if (met[i] > met[most]) most = i;
        out->partner[out->partners] = (uint8_t)most;
        out->share[out->partners++] = (float)met[most];
        kept += met[most];
        met[most] = 0;
    }
    for (int k = 0; k < out->partners; k++) out->share[k] *= each * (float)all / (float)kept;
}

/* The nearest of others that a ray meets; INFINITY: none. passes: those that may be. */
static double meets_other(int *slot, PartHit *hit, const PatchPose *const *other, int others, const bool *passes,
                          const double o_enu[3], const double d_enu[3])
{
    double nearest_m = INFINITY;
    for (int n = 0; n < others; n++) {
        PartHit met;
        double  to[3];
        if (!passes[n]) continue;
        v3_sub(to, other[n]->posed->centre_enu, o_enu);
        const double along_m = v3_dot(to, d_enu), radius_m = other[n]->posed->radius_m;
        if (v3_dot(to, to) - fmax(along_m, 0) * along_m > radius_m * radius_m) continue;
        const double t_m = parts_first_hit(&met, other[n]->posed, o_enu, d_enu, nearest_m, false);
        if (t_m < nearest_m) nearest_m = t_m, *slot = n, *hit = met;
    }
    return nearest_m;
}

void vehicle_view_near(NearView *out, const PatchPose *pose, int patch, const PatchPose *const *other, int others)
{
    enum { most = patch_points * patch_near_rays };
    struct {
        int slot, patch, rays;
    } met[most];
    bool passes[patch_others];
    int  kinds = 0;
    *out = (NearView){0};
    if (!(pose->patches->patch[patch].open_share > 0)) return; /* inside: it meets nothing */
    for (int point = 0; point < patch_points; point++) {
        double o_enu[3], n_enu[3];
        bool   any = false;
        stand(o_enu, n_enu, pose, patch, point);
        for (int n = 0; n < others; n++) {
            double to[3];
            passes[n] = false;
            if (!other[n]) continue;
            v3_sub(to, other[n]->posed->centre_enu, o_enu);
            passes[n] = v3_dot(to, n_enu) > -other[n]->posed->radius_m;
            any |= passes[n];
        }
        for (int k = 0; k < patch_near_rays && any; k++) {
            double  d_enu[3], at_enu[3];
            PartHit hit = {0}, own;
            int     slot = 0, at = 0;
            direction(d_enu, n_enu, k, point, patch_near_rays);
            const double t_m = meets_other(&slot, &hit, other, others, passes, o_enu, d_enu);
            if (!(t_m < INFINITY)) continue;
            const double own_m = parts_first_hit(&own, pose->posed, o_enu, d_enu, INFINITY, false);
            if (own_m <= t_m) continue;
            if (own_m < INFINITY) out->own++;
            else if (d_enu[2] >= 0) out->sky++;
            else if (meets_under(pose, o_enu, d_enu)) out->under++;
            else out->ground++;
            v3_add_scaled(at_enu, o_enu, t_m, d_enu);
            const int found = patch_met(other[slot], &hit, at_enu, d_enu);
            while (at < kinds && (met[at].slot != slot || met[at].patch != found)) at++;
            if (at == kinds) met[kinds].slot = slot, met[kinds].patch = found, met[kinds++].rays = 0;
            met[at].rays++;
        }
    }
    while (out->partners < near_partners && out->partners < kinds) { /* as above */
        int best = 0;
        for (int i = 1; i < kinds; i++)
            if (met[i].rays > met[best].rays) best = i;
        out->slot[out->partners] = (uint8_t)met[best].slot, out->patch[out->partners] = (uint8_t)met[best].patch;
        out->rays[out->partners++] = (uint8_t)met[best].rays;
        met[best].rays = 0;
    }
}

void vehicle_view_sun(float *out, const PatchPose *pose, const double sun_d_enu[3], const PosedEntity *const *other,
                      int others)
{
    for (int i = 0; i < pose->patches->count; i++) {
        double     sum = 0;
        const bool outside = pose->patches->patch[i].open_share > 0;
        for (int point = 0; point < patch_points && sun_d_enu[2] > 0 && outside; point++) {
            double o_enu[3], n_enu[3];
            stand(o_enu, n_enu, pose, i, point);
            const double cosine = v3_dot(n_enu, sun_d_enu);
            bool         open = cosine > 0 && !parts_occluded(pose->posed, o_enu, sun_d_enu, false);
            for (int n = 0; n < others && open; n++) open = !parts_occluded(other[n], o_enu, sun_d_enu, false);
            if (open) sum += cosine;
        }
        out[i] = (float)(sum / patch_points);
    }
}

void vehicle_view_gas(float *excess_k, float *speed_mps, const PatchPose *pose, int patch, const JetPath *path)
{
    double     sum_k = 0, sum_mps = 0;
    const bool outside = pose->patches->patch[patch].open_share > 0;
    for (int point = 0; point < patch_points && outside; point++) {
        double  o_enu[3], n_enu[3], from_enu[3], way[3], here_k, here_mps;
        PartHit hit;
        stand(o_enu, n_enu, pose, patch, point);
        if (!jet_path_at(&here_k, &here_mps, from_enu, path, o_enu, true)) continue;
        v3_sub(way, from_enu, o_enu);
        const double far_m = v3_length(way);
        if (!(v3_dot(way, n_enu) > 0) || !v3_normalize(way, way)) continue;
        if (parts_first_hit(&hit, pose->posed, o_enu, way, far_m, false) < far_m) continue;
        sum_k += here_k, sum_mps += here_mps;
    }
    *excess_k = (float)(sum_k / patch_points);
    *speed_mps = (float)(sum_mps / patch_points);
}
