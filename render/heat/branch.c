/* render/heat/branch.c: heat of trunks and branches (heat.h). */
#include "render/heat/heat.h"

static const double upright_m = 0.03;

double heat_branch_film_w_m2k(double radius_m, double wind_mps)
{
    static const double viscosity_m2s = 1.5e-5, prandtl = 0.71, air_w_mk = 0.025, least_wind_mps = 0.3;
    const double        re = fmax(wind_mps, least_wind_mps) * 2 * radius_m / viscosity_m2s;
    const double        nu = 0.3 + 0.62 * sqrt(re) * cbrt(prandtl) / pow(1 + pow(0.4 / prandtl, 2.0 / 3), 0.25) *
                                pow(1 + pow(re / 282000, 0.625), 0.8);
    return nu * air_w_mk / (2 * radius_m);
}

void heat_branch_start(Branch *out, const BranchKind *kind, double radius_m, double temp_k)
{
    *out = (Branch){.kind = kind, .radius_m = radius_m};
    for (int i = 0; i < branch_rings; i++) out->part[0][i] = temp_k;
    out->face_k[0] = temp_k;
}

/* Outer radius of ring i, over the whole: rings are thinner outside. */
static double edge(int i)
{
    const double left = (double)(branch_rings - i) / branch_rings;
    return left * (2 - left); /* 1 at the bark, 0 in the middle */
}

/* One part over a step: (C / dt + K) T = C T0 / dt + A (gain + loss (reference - T_surface)), angle: order of its
 * cosine. */
static void ring_step(double t[branch_rings], double *face_k, const Branch *b, int order, double gain_w_m2,
                      double loss_w_m2k, double dt_s)
{
    const double k = b->kind->conductivity_w_mk, c = b->kind->capacity_j_m3k, r = b->radius_m;
    double       g[branch_rings], over[branch_rings], line[branch_rings], share[branch_rings];
    const double outer = edge(0) * r, first = 0.5 * (edge(0) + edge(1)) * r;
    /* from the bark's face to the middle of the first ring: the face is in balance with the air */
    const double face = k / (outer - first), through = loss_w_m2k * face / (loss_w_m2k + face),
                 enters = gain_w_m2 * face / (loss_w_m2k + face);
    for (int i = 0; i < branch_rings; i++) {
        const double here = 0.5 * (edge(i) + edge(i + 1)) * r,
                     next = i + 1 < branch_rings ? 0.5 * (edge(i + 1) + edge(i + 2)) * r : 0;
        g[i] = i + 1 < branch_rings ? k * edge(i + 1) * r / (here - next) : 0; /* over the angle, per length */
    }
    for (int i = branch_rings - 1; i >= 0; i--) {
        const double a = edge(i) * r, z = edge(i + 1) * r, here = 0.5 * (a + z), volume = 0.5 * (a * a - z * z);
        double       steep =
            c * volume / dt_s + order * order * k * volume / (here * here) + (i > 0 ? g[i - 1] : outer * through);
        line[i] = c * volume / dt_s * t[i] + (i == 0 ? outer * enters : 0);
        if (i + 1 < branch_rings) {
            share[i] = g[i] * over[i + 1];
            steep += g[i] * (1 - share[i]);
            line[i] += share[i] * line[i + 1];
        }
        over[i] = 1 / steep;
    }
    t[0] = line[0] * over[0];
    for (int i = 1; i < branch_rings; i++) t[i] = line[i] * over[i] + share[i - 1] * t[i - 1];
    *face_k = (face * t[0] + gain_w_m2) / (loss_w_m2k + face);
}

/* What all parts share in a step. */
typedef struct Exchange {
    double mean_w_m2, side_w_m2[3], twice_w_m2[2], loss_w_m2k;
} Exchange;

static void exchange(Exchange *out, const Branch *b, const GroundWeather *w, double sun, double ground_k)
{
    const BranchKind *k = b->kind;
    const bool        upright = b->radius_m > upright_m;
    const double      surface_k = b->face_k[0], t3 = surface_k * surface_k * surface_k;
    const double      film = heat_branch_film_w_m2k(b->radius_m, w->air.wind_mps),
                 direct = w->sun_d_enu[2] > 0 ? sun * w->direct_w_m2 : 0;
    const double ground_w_m2 = stefan_w_m2k4 * ground_k * ground_k * ground_k * ground_k;
    const double below = 0.15 * (direct * fmax(w->sun_d_enu[2], 0) + w->diffuse_w_m2); /* that the ground returns */
    const double sky = k->absorptance * w->diffuse_w_m2 + k->emissivity * w->longwave_w_m2;
    const double ground = k->absorptance * below + k->emissivity * ground_w_m2;
    const double flat = hypot(w->sun_d_enu[0], w->sun_d_enu[1]);
    out->loss_w_m2k = film + 4 * k->emissivity * stefan_w_m2k4 * t3;
    /* about the surface's temperature before */
    out->mean_w_m2 = k->absorptance * direct * (upright ? flat / pi_rad : 0.25) + 0.5 * (sky + ground) +
                     film * w->air.temp_k + 3 * k->emissivity * stefan_w_m2k4 * t3 * surface_k;
    for (int a = 0; a < 3; a++)
        out->side_w_m2[a] = 0.5 * k->absorptance * direct * w->sun_d_enu[a] * (upright && a == 2 ? 0 : 1);
    if (!upright) out->side_w_m2[2] += 0.5 * (sky - ground);
    const double narrow = upright && flat > 1e-6 ? 2 / (3 * pi_rad) * k->absorptance * direct * flat : 0;
    out->twice_w_m2[0] =
        narrow > 0 ? narrow * (w->sun_d_enu[0] * w->sun_d_enu[0] - w->sun_d_enu[1] * w->sun_d_enu[1]) / (flat * flat)
                   : 0;
    out->twice_w_m2[1] = narrow > 0 ? narrow * 2 * w->sun_d_enu[0] * w->sun_d_enu[1] / (flat * flat) : 0;
}

void heat_branch_step(Branch *b, const GroundWeather *after, double sun, double ground_k, double dt_s)
{
    const int parts = (int)fmax(1, ceil(dt_s / 300 - 1e-9));
    for (int p = 0; p < parts; p++) {
        Exchange e;
        exchange(&e, b, after, sun, ground_k);
        ring_step(b->part[0], &b->face_k[0], b, 0, e.mean_w_m2, e.loss_w_m2k, dt_s / parts);
        for (int a = 0; a < 3; a++)
            ring_step(b->part[1 + a], &b->face_k[1 + a], b, 1, e.side_w_m2[a], e.loss_w_m2k, dt_s / parts);
        for (int a = 0; a < 2; a++)
            ring_step(b->part[4 + a], &b->face_k[4 + a], b, 2, e.twice_w_m2[a], e.loss_w_m2k, dt_s / parts);
    }
}

void heat_branch_sides(BranchSides *out, const Branch *b)
{
    const double *k = b->face_k;
    *out = (BranchSides){(float)k[0], {(float)k[1], (float)k[2], (float)k[3]}, {(float)k[4], (float)k[5]}};
}
