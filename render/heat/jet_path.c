/* render/heat/jet_path.c: the path of an exhaust jet in the wind, and the boxes that contain it
 * (vehicle_load_private.h). */
#include "render/heat/vehicle_load_private.h"

static const double along_share = 0.08, across_share = 0.6, gravity_mps2 = 9.80665, least_k = 1;
static const double developed = 13; /* diameters from the outlet, after which a jet mixes evenly (Hill 1972) */

/* Fluxes over pi and the air's density: of mass (m3/s), momentum, heat. */
typedef struct JetState {
    double p[3], mass, momentum[3], heat, way_m;
} JetState;

typedef struct JetNow {
    double d[3], speed_mps, radius_m, excess_k;
} JetNow;

static bool jet_now(JetNow *out, const JetState *s, double air_k)
{
    out->excess_k = s->heat / s->mass;
    out->speed_mps = v3_length(s->momentum) / s->mass;
    const double density = air_k / (air_k + out->excess_k);
    out->radius_m = sqrt(s->mass / (density * out->speed_mps));
    return v3_normalize(out->d, s->momentum) && out->speed_mps > 1e-3 && isfinite(out->radius_m);
}

/* Along a metre of the axis. */
static void jet_slope(JetState *out, const JetNow *now, double mixes, const double flow[3], double air_k)
{
    double       across[3];
    const double along_mps = v3_dot(flow, now->d), density = air_k / (air_k + now->excess_k);
    v3_add_scaled(across, flow, -along_mps, now->d);
    memcpy(out->p, now->d, sizeof out->p);
    out->mass =
        2 * now->radius_m * (mixes * along_share * fabs(now->speed_mps - along_mps) + across_share * v3_length(across));
    for (int k = 0; k < 3; k++) out->momentum[k] = flow[k] * out->mass;
    out->momentum[2] += now->radius_m * now->radius_m * (1 - density) * gravity_mps2;
    out->heat = 0;
}

static JetState moved(const JetState *s, const JetState *slope, double way_m)
{
    JetState to = *s;
    v3_add_scaled(to.p, s->p, way_m, slope->p);
    v3_add_scaled(to.momentum, s->momentum, way_m, slope->momentum);
    to.mass += way_m * slope->mass;
    to.way_m += way_m;
    return to;
}

static bool is_in(const JetBox *box, const double p[3])
{
    for (int k = 0; k < 3; k++)
        if (p[k] < box->low_m[k] || p[k] > box->high_m[k]) return false;
    return true;
}

static double widest(double excess_k) { return fmax(0.5 * log(2 * excess_k / least_k), 0); } /* 2: before a wall */

/* Nothing between two points is wider than the wider, or warmer than the warmer of them. */
static void put_boxes(JetPath *path)
{
    static const JetBox nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    path->box = nothing;
    for (int first = 0; first < path->count; first += jet_run) {
        JetBox *box = &path->run[first / jet_run];
        double  radius_m = 0, excess_k = 0;
        *box = nothing;
        for (int i = first; i <= first + jet_run && i < path->count; i++) {
            const JetPoint *at = &path->point[i];
            radius_m = fmax(radius_m, at->radius_m), excess_k = fmax(excess_k, at->excess_k);
            for (int k = 0; k < 3; k++) {
                box->low_m[k] = fmin(box->low_m[k], at->p_enu[k]);
                box->high_m[k] = fmax(box->high_m[k], at->p_enu[k]);
            }
        }
        const double reach_m = radius_m * sqrt(widest(excess_k));
        for (int k = 0; k < 3; k++) {
            box->low_m[k] -= reach_m, box->high_m[k] += reach_m;
            path->box.low_m[k] = fmin(path->box.low_m[k], box->low_m[k]);
            path->box.high_m[k] = fmax(path->box.high_m[k], box->high_m[k]);
        }
    }
}

void jet_path(JetPath *out, const ExhaustJet *jet, const double p_enu[3], const double d_enu[3],
              const double flow_enu_mps[3], double air_k)
{
    const double density = air_k / (air_k + jet->excess_k), developed_m = 2 * developed * jet->radius_m;
    JetState     s = {.mass = density * jet->radius_m * jet->radius_m * jet->speed_mps};
    JetNow       now;
    out->count = 0;
    for (int k = 0; k < 3; k++) {
        s.p[k] = p_enu[k];
        s.momentum[k] = s.mass * jet->speed_mps * d_enu[k];
    }
    s.heat = s.mass * jet->excess_k;
    while (out->count < jet_points && s.mass > 0 && jet_now(&now, &s, air_k)) {
        JetPoint *at = &out->point[out->count];
        JetState  slope;
        /* a Gaussian of the same flux is twice as high on the axis, but not before it has mixed that far */
        *at = (JetPoint){.radius_m = now.radius_m,
                         .excess_k = fmin(2 * now.excess_k, jet->excess_k),
                         .speed_mps = fmin(2 * now.speed_mps, fmax(jet->speed_mps, now.speed_mps))};
        memcpy(at->p_enu, s.p, sizeof at->p_enu);
        if (!(at->excess_k >= least_k)) break;
        out->count++;
        const double way_m = 0.4 * now.radius_m;
        jet_slope(&slope, &now, fmin(s.way_m / developed_m, 1), flow_enu_mps, air_k);
        const JetState half = moved(&s, &slope, 0.5 * way_m);
        if (!jet_now(&now, &half, air_k)) break;
        jet_slope(&slope, &now, fmin(half.way_m / developed_m, 1), flow_enu_mps, air_k);
        s = moved(&s, &slope, way_m);
    }
    out->widest = widest(jet->excess_k) + 1e-9;
    for (int i = 0; i + 1 < out->count; i++) {
        JetPoint *at = &out->point[i];
        v3_sub(at->way_enu, out->point[i + 1].p_enu, at->p_enu);
        at->per_m2 = 1 / v3_dot(at->way_enu, at->way_enu);
    }
    put_boxes(out);
}

static double away_m(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

bool jet_path_at(double *excess_k, double *speed_mps, double from_enu[3], const JetPath *path, const double p_enu[3],
                 bool wall)
{
    double best = 0;
    *excess_k = *speed_mps = 0;
    if (!is_in(&path->box, p_enu)) return false;
    for (int i = 0; i + 1 < path->count; i++) {
        if (i % jet_run == 0 && !is_in(&path->run[i / jet_run], p_enu)) {
            i += jet_run - 1;
            continue;
        }
        const JetPoint *a = &path->point[i], *b = &path->point[i + 1];
        double          off[3], at[3];
        v3_sub(off, p_enu, a->p_enu);
        const double along = v3_dot(off, a->way_enu) * a->per_m2;
        if (along < (i == 0 ? 0 : -0.3)) continue; /* of the piece before, or behind the outlet */
        const double share = clamp(along, 0, 1);
        v3_add_scaled(at, a->p_enu, share, a->way_enu);
        v3_sub(off, p_enu, at);
        const double radius_m = a->radius_m + share * (b->radius_m - a->radius_m), off_m2 = v3_dot(off, off);
        if (off_m2 > path->widest * radius_m * radius_m) continue;
        const double profile = fmin((wall ? 2 : 1) * exp(-2 * off_m2 / (radius_m * radius_m)), 1);
        const double here_k = profile * (a->excess_k + share * (b->excess_k - a->excess_k));
        if (!(here_k > best)) continue;
        best = here_k;
        *excess_k = here_k;
        *speed_mps = profile * (a->speed_mps + share * (b->speed_mps - a->speed_mps));
        int up = i;
        for (double off_m = away_m(at, path->point[up].p_enu); up > 0 && off_m < 2 * radius_m;)
            off_m = away_m(at, path->point[--up].p_enu);
        if (from_enu) memcpy(from_enu, path->point[up].p_enu, sizeof at);
    }
    return best >= least_k;
}
