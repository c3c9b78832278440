/* entities/table/contact.c: clamps entities to the ground or the water along the local vertical. */
#include "entities/table/contact.h"

#include "dis/pdu/pdu.h"

/* Whether pitch and roll of such an entity follow the ground. */
static bool leans(DisEntityType type)
{
    return (type.kind == dis_kind_platform && type.domain == dis_domain_land) ||
           (type.kind == dis_kind_life_form && type.domain <= dis_domain_land); /* domain 0: no domain is given */
}

bool contact_applies(DisEntityType type)
{
    const bool lies =
        type.kind == dis_kind_cultural_feature || type.kind == dis_kind_supply || type.kind == dis_kind_sensor_emitter;
    return leans(type) || (lies && type.domain <= dis_domain_land);
}

bool contact_floats(DisEntityType type) { return type.kind == dis_kind_platform && type.domain == dis_domain_surface; }

/* Whether such an entity is lifted out of the ground. Where all entities are clamped, aircraft may be below the ground,
 * over real relief that their sender did not know. Those that stand still are moved onto it; others are moved as far
 * above it as they were below, at most 20 m. */
static bool is_lifted(DisEntityType type) { return type.kind == dis_kind_platform && type.domain == dis_domain_air; }

double contact_share(DisEntityType type, double above_m)
{
    const double keep_m = contact_floats(type) ? 1.5 : 0.1, set_m = contact_floats(type) ? 3 : 0.5;
    const double t = clamp((fabs(above_m) - keep_m) / (set_m - keep_m), 0, 1);
    return t * t * (3 - 2 * t);
}

/* Unit normal of the ellipsoid at a place, ECEF. */
static bool vertical(double up_ecef[3], const double p_ecef[3])
{
    Geodetic place;
    double   same_ecef[3], r_ecef_from_enu[9];
    if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK ||
        ecef_from_geodetic(same_ecef, r_ecef_from_enu, &place) != STATUS_OK)
        return false;
    for (int k = 0; k < 3; k++) up_ecef[k] = r_ecef_from_enu[3 * k + 2];
    return true;
}

/* Distance along the vertical from p to the ground. The vertical is inclined to ENU's z, so the query is repeated at
 * the last result; each error is below a hundredth of the one before (inclination times slope). */
static double way_up_m(const ContactGround *ground, const double p_enu[3], const double up_enu[3])
{
    double way_m = 0;
    if (!(up_enu[2] > 0.5)) return NAN; /* the far side of the Earth */
    for (int step = 0; step < 4; step++) {
        double q_enu[3];
        v3_add_scaled(q_enu, p_enu, way_m, up_enu);
        way_m += (elevation_height(ground->elevation, q_enu[0], q_enu[1], NULL) - q_enu[2]) / up_enu[2];
    }
    return way_m;
}

double contact_above_m(const ContactGround *ground, const double p_ecef[3])
{
    double up_ecef[3], up_enu[3], p_enu[3];
    if (!ground->elevation || !vertical(up_ecef, p_ecef)) return NAN;
    m3_tmul_v3(up_enu, ground->frame->r_ecef_from_enu, up_ecef);
    enu_from_ecef(p_enu, ground->frame, p_ecef);
    return -way_up_m(ground, p_enu, up_enu);
}

/* Whether an entity is carried through the air, or falls through it. */
static bool is_airborne(DisEntityType type, const double v_ecef_mps[3], const double up_ecef[3])
{
    const double v_up = v3_dot(v_ecef_mps, up_ecef), v = v3_length(v_ecef_mps);
    const double along = sqrt(fmax(v * v - v_up * v_up, 0));
    return v > (type.kind == dis_kind_platform ? 60 : 12) || v_up < -fmax(2, 0.5 * along);
}

/* The vertical line from an entity's base to the ground. */
typedef struct WayUp {
    double up_ecef[3], up[3], p[3]; /* the vertical in ECEF; the vertical and the base in ENU */
    double way_m, share;            /* way_m: distance to the ground; share: the part of it that the entity is moved */
} WayUp;

/* The share of the way to the ground that an entity is moved; p_enu is its base. It is 1 where all entities are
 * clamped. */
static double share_of(const WayUp *w, DisEntityType type, const double v_ecef_mps[3], const ContactGround *ground)
{
    if (!ground->landscape) return 1;
    const double share = contact_share(type, w->way_m);
    if (!(share > 0)) return 0;
    if (contact_floats(type)) return share;
    if (is_airborne(type, v_ecef_mps, w->up_ecef)) return 0;
    const bool at_sea = w->way_m < 0 && landscape_surface(ground->landscape, w->p[0], w->p[1]) == SURFACE_WATER;
    return at_sea ? 0 : share;
}

/* Whether an entity is clearly consistent with the ground, however the vertical is inclined. */
static bool stands_near(DisEntityType type, const ContactGround *ground, const double p_enu[3])
{
    const double above_m = p_enu[2] - elevation_height(ground->elevation, p_enu[0], p_enu[1], NULL);
    return ground->landscape && fabs(p_enu[0]) + fabs(p_enu[1]) < 20000 && contact_share(type, 1.01 * above_m) == 0;
}

/* Finds the way to the ground; returns false where the entity stays where it is. */
static bool way_to_ground(WayUp *w, DisEntityType type, const double p_ecef[3], const double v_ecef_mps[3],
                          const ContactGround *ground)
{
    if (!ground->elevation) return false;
    if (!contact_applies(type) && !(ground->landscape && contact_floats(type))) return false;
    enu_from_ecef(w->p, ground->frame, p_ecef);
    if (stands_near(type, ground, w->p) || !vertical(w->up_ecef, p_ecef)) return false;
    m3_tmul_v3(w->up, ground->frame->r_ecef_from_enu, w->up_ecef);
    w->way_m = way_up_m(ground, w->p, w->up);
    if (!isfinite(w->way_m)) return false;
    w->share = share_of(w, type, v_ecef_mps, ground);
    return w->share > 0;
}

void contact_move(double p_ecef[3], DisEntityType type, const double v_ecef_mps[3], const ContactGround *ground)
{
    WayUp w;
    if (way_to_ground(&w, type, p_ecef, v_ecef_mps, ground))
        v3_add_scaled(p_ecef, p_ecef, w.share * w.way_m, w.up_ecef);
}

static void lift(SnapshotEntity *e, const ContactGround *ground)
{
    static const double still_mps = 0.3, most_m = 20;
    double              up_ecef[3], up[3], p[3];
    enu_from_ecef(p, ground->frame, e->p_ecef);
    if (!(p[2] < elevation_height(ground->elevation, p[0], p[1], NULL)) || !vertical(up_ecef, e->p_ecef)) return;
    m3_tmul_v3(up, ground->frame->r_ecef_from_enu, up_ecef);
    const double way_m = way_up_m(ground, p, up);
    if (!(way_m > 0)) return;
    v3_add_scaled(e->p_ecef, e->p_ecef, way_m + (v3_length(e->v_ecef_mps) < still_mps ? 0 : fmin(way_m, most_m)),
                  up_ecef);
}

void contact_set(SnapshotEntity *e, const ContactGround *ground, const Model *model)
{
    enum { along = 5, across = 3 };
    static const double steepest =
        1; /* tan 45 degrees; what is steeper, such as a wall in a surface model, is not a road */
    double r_enu_from_body[9], forward[3], right[3];
    WayUp  w;
    if (ground->elevation && !ground->landscape && is_lifted(e->type)) lift(e, ground);
    if (!way_to_ground(&w, e->type, e->p_ecef, e->v_ecef_mps, ground)) return;
    const double *up = w.up, *up_ecef = w.up_ecef, *p = w.p, share = w.share;
    double        way_m = w.way_m;
    m3_tmul(r_enu_from_body, ground->frame->r_ecef_from_enu, e->r_ecef_from_body);
    const double nose[3] = {r_enu_from_body[0], r_enu_from_body[3], r_enu_from_body[6]};
    const double down[3] = {r_enu_from_body[2], r_enu_from_body[5], r_enu_from_body[8]};

    v3_add_scaled(forward, nose, -v3_dot(nose, up), up);
    const bool upright =
        leans(e->type) && v3_length(forward) > 0.3 && v3_dot(down, up) < -0.3 && v3_normalize(forward, forward);
    double slope_forward = 0, slope_right = 0;
    if (upright) {
        v3_cross(right, forward, up);
        const double half_length_m = fmax(fmin(-model->box_low[0], model->box_high[0]), 0.2);
        const double half_width_m = fmax(fmin(-model->box_low[1], model->box_high[1]), 0.2);
        double       sum = 0, sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0;
        for (int i = 0; i < along; i++)
            for (int j = 0; j < across; j++) {
                const double a = half_length_m * (2.0 * i / (along - 1) - 1),
                             b = half_width_m * (2.0 * j / (across - 1) - 1);
                double q[3];
                v3_add_scaled(q, p, a, forward);
                v3_add_scaled(q, q, b, right);
                const double h_m = way_up_m(ground, q, up);
                sum += h_m;
                sum_a += a * h_m;
                sum_b += b * h_m;
                sum_aa += a * a;
                sum_bb += b * b;
            }
        if (!isfinite(sum)) return; /* the box is partly outside of the elevation data */
        way_m = sum / (along * across);
        slope_forward = clamp(sum_a / sum_aa, -steepest, steepest);
        slope_right = clamp(sum_b / sum_bb, -steepest, steepest);
    }
    v3_add_scaled(e->p_ecef, e->p_ecef, share * way_m, up_ecef);
    if (!upright) return;
    if (share < 1) { /* it is turned a share of the way from its own tilt to the ground's */
        const double own[3] = {r_enu_from_body[1], r_enu_from_body[4], r_enu_from_body[7]};
        const double right_m = fmax(v3_dot(own, right), 0.1);
        /* of the plane through both its axes: the right one points forward or back, too, where the nose is up or down
         */
        const double own_forward = v3_dot(nose, up) / v3_dot(nose, forward);
        const double own_right = (v3_dot(own, up) - own_forward * v3_dot(own, forward)) / right_m;
        slope_forward = own_forward + share * (slope_forward - own_forward);
        slope_right = own_right + share * (slope_right - own_right);
    }

    double x[3], y[3], z[3], v[3];
    v3_add_scaled(x, forward, slope_forward, up);
    v3_add_scaled(y, right, slope_right, up);
    v3_cross(z, x, y);
    if (!v3_normalize(x, x) || !v3_normalize(z, z)) return;
    v3_cross(y, z, x);
    for (int k = 0; k < 3; k++) {
        r_enu_from_body[3 * k] = x[k];
        r_enu_from_body[3 * k + 1] = y[k];
        r_enu_from_body[3 * k + 2] = z[k];
    }
    m3_mul(e->r_ecef_from_body, ground->frame->r_ecef_from_enu, r_enu_from_body);
    m3_tmul_v3(v, ground->frame->r_ecef_from_enu, e->v_ecef_mps);
    const double climb = slope_forward * v3_dot(v, forward) + slope_right * v3_dot(v, right) - v3_dot(v, up);
    v3_add_scaled(v, v, climb, up);
    m3_mul_v3(e->v_ecef_mps, ground->frame->r_ecef_from_enu, v);
}
