/* sensor/node/cigi/cigi_scene.c: entities and views of a CIGI host, and their places on Earth. */
#include "sensor/node/cigi/cigi_scene.h"

#include "entities/motion/dead_reckoning.h"
#include "terrain/earth/geodesy.h"

enum { most_parents = 8 }; /* from a view's entity on */

/* ---- what is taken ------------------------------------------------------------------------------ */

static bool within(double v, double most) { return fabs(v) <= most; }

static bool place_good(const double p[3], bool offset)
{
    enum { most_offset_m = 1000000, most_height_m = 10000000 };
    if (offset) return within(p[0], most_offset_m) && within(p[1], most_offset_m) && within(p[2], most_offset_m);
    return within(p[0], 90) && within(p[1], 360) && within(p[2], most_height_m);
}

static bool turn_good(double yaw_deg, double pitch_deg, double roll_deg)
{
    return within(yaw_deg, 360) && within(pitch_deg, 360) && within(roll_deg, 360);
}

static const CigiEntityControl *find(const CigiScene *scene, uint16_t id)
{
    for (int i = 0; i < scene->entity_count; i++)
        if (scene->entity[i].id == id) return &scene->entity[i];
    return NULL;
}

static void remove_entity(CigiScene *scene, int at)
{
    const int last = --scene->entity_count;
    scene->entity[at] = scene->entity[last];
    scene->rate[at] = scene->rate[last];
    scene->rated[at] = scene->rated[last];
}

static bool take_entity(CigiScene *scene, const CigiEntityControl *e)
{
    CigiEntityControl *known = (CigiEntityControl *)find(scene, e->id);
    if (!place_good(e->p, e->attached) || !turn_good(e->yaw_deg, e->pitch_deg, e->roll_deg)) return false;
    if (known && e->state == cigi_entity_destroyed) {
        remove_entity(scene, (int)(known - scene->entity));
        return true;
    }
    if (e->state == cigi_entity_destroyed) return true;
    if (!known && scene->entity_count == cigi_entities_most) return false;
    if (!known) {
        scene->rated[scene->entity_count] = false;
        known = &scene->entity[scene->entity_count++];
    }
    *known = *e;
    return true;
}

static bool take_rate(CigiScene *scene, const CigiRateControl *r)
{
    enum { most_mps = 100000, most_deg_s = 100000 };
    const CigiEntityControl *e = find(scene, r->entity);
    for (int i = 0; i < 3; i++)
        if (!within((double)r->v_mps[i], most_mps)) return false;
    if (!within((double)r->roll_deg_s, most_deg_s) || !within((double)r->pitch_deg_s, most_deg_s) ||
        !within((double)r->yaw_deg_s, most_deg_s))
        return false;
    if (!e || r->of_part) return true;
    scene->rate[e - scene->entity] = *r;
    scene->rated[e - scene->entity] = true;
    return true;
}

/* The record of a view, which is made; NULL: there is no room. */
static CigiViewControl *view_of(CigiScene *scene, uint16_t id)
{
    for (int i = 0; i < scene->view_count; i++)
        if (scene->view[i].view == id) return &scene->view[i];
    if (scene->view_count == cigi_views_most) return NULL;
    scene->view[scene->view_count] = (CigiViewControl){.view = id};
    return &scene->view[scene->view_count++];
}

/* Only what is enabled is taken. */
static void merge(CigiViewControl *to, const CigiViewControl *v)
{
    to->entity = v->entity;
    if (v->x_on) to->offset_m[0] = v->offset_m[0];
    if (v->y_on) to->offset_m[1] = v->offset_m[1];
    if (v->z_on) to->offset_m[2] = v->offset_m[2];
    if (v->roll_on) to->roll_deg = v->roll_deg;
    if (v->pitch_on) to->pitch_deg = v->pitch_deg;
    if (v->yaw_on) to->yaw_deg = v->yaw_deg;
}

static bool take_view(CigiScene *scene, const CigiViewControl *v)
{
    const double offset_m[3] = {v->offset_m[0], v->offset_m[1], v->offset_m[2]};
    if (!place_good(offset_m, true) || !turn_good(v->yaw_deg, v->pitch_deg, v->roll_deg)) return false;
    for (int i = 0; v->group && i < scene->view_count; i++)
        if (scene->view[i].group == v->group) merge(&scene->view[i], v);
    if (v->group) return true;
    CigiViewControl *view = view_of(scene, v->view);
    if (view) merge(view, v);
    return view;
}

bool cigi_scene_take(CigiScene *scene, const CigiPacket *packet)
{
    bool good = true;
    if (packet->id == cigi_entity_control) good = take_entity(scene, &packet->of.entity_control);
    if (packet->id == cigi_rate_control) good = take_rate(scene, &packet->of.rate_control);
    if (packet->id == cigi_view_control) good = take_view(scene, &packet->of.view_control);
    if (packet->id == cigi_view_definition) {
        CigiViewControl *view = view_of(scene, packet->of.view_definition.view);
        if (view) view->group = packet->of.view_definition.group;
        good = view;
    }
    scene->refused += !good;
    return good;
}

/* ---- where they are ----------------------------------------------------------------------------- */

static bool on_earth(double p_ecef[3], double r_ecef_from_ned[9], const double p[3])
{
    static const int column[3] = {1, 0, 2}; /* of east, north, up */
    const double     turns = round(p[1] / 360);
    const Geodetic   place = {p[0] * rad_per_deg, (p[1] - 360 * turns) * rad_per_deg, p[2]};
    double           r_ecef_from_enu[9];
    if (ecef_from_geodetic(p_ecef, r_ecef_from_enu, &place) != STATUS_OK) return false;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r_ecef_from_ned[3 * i + k] = (k == 2 ? -1 : 1) * r_ecef_from_enu[3 * i + column[k]];
    return true;
}

static void turned(double out[9], const double r_ecef_from_axes[9], double yaw_deg, double pitch_deg, double roll_deg)
{
    double turn[9]; /* the same formula, from other axes */
    r_ecef_from_body_euler(turn, yaw_deg * rad_per_deg, pitch_deg * rad_per_deg, roll_deg * rad_per_deg);
    m3_mul(out, r_ecef_from_axes, turn);
}

bool cigi_scene_entity(double p_ecef[3], double r_ecef_from_body[9], const CigiScene *scene, uint16_t id)
{
    const CigiEntityControl *line[most_parents];
    int                      count = 0;
    double                   p[3], r[9], r_axes[9];
    for (const CigiEntityControl *e = find(scene, id); e; e = e->attached ? find(scene, e->parent) : NULL) {
        if (count == most_parents) return false;
        line[count++] = e;
    }
    if (count == 0 || line[count - 1]->attached || !on_earth(p, r_axes, line[count - 1]->p)) return false;
    for (int i = count - 1; i >= 0; i--) {
        const CigiEntityControl *e = line[i];
        if (e->attached) {
            double offset_ecef[3];
            m3_mul_v3(offset_ecef, r, e->p);
            v3_add(p, p, offset_ecef);
            memcpy(r_axes, r, sizeof r_axes);
        }
        turned(r, r_axes, e->yaw_deg, e->pitch_deg, e->roll_deg);
    }
    memcpy(p_ecef, p, sizeof p);
    memcpy(r_ecef_from_body, r, sizeof r);
    return true;
}

/* One that was never controlled is on entity 0. */
static CigiViewControl find_view(const CigiScene *scene, uint16_t view)
{
    for (int i = 0; i < scene->view_count; i++)
        if (scene->view[i].view == view) return scene->view[i];
    return (CigiViewControl){.view = view};
}

bool cigi_scene_carries(const CigiScene *scene, uint16_t view, uint16_t id)
{
    int                      left = most_parents;
    const CigiEntityControl *e = find(scene, find_view(scene, view).entity);
    for (; e && left > 0; e = e->attached ? find(scene, e->parent) : NULL, left--)
        if (e->id == id) return true;
    return false;
}

bool cigi_scene_rates(double v_ecef_mps[3], double w_ecef_rps[3], const CigiScene *scene, uint16_t id)
{
    const CigiEntityControl *e = find(scene, id);
    double                   p[3], r_axes[9], r_body[9];
    if (!e || e->attached || !scene->rated[e - scene->entity] || !on_earth(p, r_axes, e->p)) return false;
    const CigiRateControl *rate = &scene->rate[e - scene->entity];
    const double           v_mps[3] = {rate->v_mps[0], rate->v_mps[1], rate->v_mps[2]},
                 w_rps[3] = {rad_per_deg * (double)rate->roll_deg_s, rad_per_deg * (double)rate->pitch_deg_s,
                             rad_per_deg * (double)rate->yaw_deg_s};
    turned(r_body, r_axes, e->yaw_deg, e->pitch_deg, e->roll_deg);
    m3_mul_v3(v_ecef_mps, rate->local ? r_body : r_axes, v_mps);
    m3_mul_v3(w_ecef_rps, rate->local ? r_body : r_axes, w_rps);
    return true;
}

bool cigi_scene_view_rates(double v_ecef_mps[3], double w_ecef_rps[3], const CigiScene *scene, uint16_t view)
{
    const CigiViewControl v = find_view(scene, view);
    double                p_ecef[3], p_view[3], r[9], arm_ecef[3], swing_mps[3];
    if (!cigi_scene_rates(v_ecef_mps, w_ecef_rps, scene, v.entity) || !cigi_scene_entity(p_ecef, r, scene, v.entity) ||
        !cigi_scene_view(p_view, r, scene, view))
        return false;
    v3_sub(arm_ecef, p_view, p_ecef);
    v3_cross(swing_mps, w_ecef_rps, arm_ecef);
    v3_add(v_ecef_mps, v_ecef_mps, swing_mps);
    return true;
}

bool cigi_scene_view(double p_ecef[3], double r_ecef_from_view[9], const CigiScene *scene, uint16_t view)
{
    const CigiViewControl v = find_view(scene, view);
    const double          offset_m[3] = {v.offset_m[0], v.offset_m[1], v.offset_m[2]};
    double                p[3], r[9], offset_ecef[3];
    if (!cigi_scene_entity(p, r, scene, v.entity)) return false;
    m3_mul_v3(offset_ecef, r, offset_m);
    v3_add(p_ecef, p, offset_ecef);
    turned(r_ecef_from_view, r, v.yaw_deg, v.pitch_deg, v.roll_deg);
    return true;
}

bool cigi_scene_place(double p_ecef[3], double r_ecef_from_axes[9], const CigiScene *scene, const double p[3],
                      bool by_entity, uint16_t entity)
{
    double at[3], offset_ecef[3];
    if (!place_good(p, by_entity)) return false;
    if (!by_entity) return on_earth(p_ecef, r_ecef_from_axes, p);
    if (!cigi_scene_entity(at, r_ecef_from_axes, scene, entity)) return false;
    m3_mul_v3(offset_ecef, r_ecef_from_axes, p);
    v3_add(p_ecef, at, offset_ecef);
    return true;
}
