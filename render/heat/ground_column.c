/* render/heat/ground_column.c: see ground_column.h. */
#include "render/heat/ground_column.h"

#include "render/heat/soil.h"

Status ground_layers(Column *out, const GroundKind *kind, const GroundGrid *grid)
{
    ColumnLayer layer[3];
    double      above_m = 0;
    int         layers = kind->layers;
    for (int i = 0; i < layers; i++) {
        layer[i] = kind->layer[i];
        above_m += layer[i].thickness_m;
    }
    const bool soil = kind->porosity > 0;
    layer[layers++] = (ColumnLayer){fmax(grid->depth_m - above_m, 0.5),
                                    soil ? soil_conductivity_w_mk(kind->porosity, kind->quartz, kind->saturation) : kind->rock_w_mk,
                                    soil ? soil_capacity_j_m3k(kind->porosity, kind->saturation) : kind->rock_j_m3k};
    return column_create(out, layer, layers, grid->first_m, grid->growth);
}

void ground_column_start(GroundColumn *out, const GroundKind *kind, const Column *layers, double temp_k)
{
    *out = (GroundColumn){.kind = kind, .column = layers, .saturation = kind->saturation};
    column_start(&out->state, layers, temp_k);
}

double ground_absorbed_w_m2(const GroundColumn *c, const GroundWeather *w, const GroundExposure *e)
{
    const GroundKind *k = c->kind;
    const double up = 0.5 * (1 + e->n_enu[2]), sky = up * e->sky;
    const double dark = k->vapour == GROUND_SOIL ? 1 - (1 - k->absorptance) * soil_darkening(c->saturation) : k->absorptance;
    const double along = fmax(v3_dot(e->n_enu, w->sun_d_enu), 0), level = w->direct_w_m2 * fmax(w->sun_d_enu[2], 0) + w->diffuse_w_m2;
    const double sun = e->sun * w->direct_w_m2 * along + w->diffuse_w_m2 * sky + (1 - up) * (1 - dark) * level;
    return dark * sun + k->emissivity * (sky * w->longwave_w_m2 + (1 - sky) * stefan_w_m2k4 * pow(e->around_k, 4));
}

/* Leaves: as Noilhan & Planton, Mon. Weather Rev. 117, 1989, whose stomata close in the dark (eq. 33, RGL 100 W/m2, leaf
 * area index 3). */
static double leaves_s_m(double full_sun_s_m, double sun_w_m2)
{
    const double f = 0.55 * sun_w_m2 / 100 * (2.0 / 3);
    return full_sun_s_m * (1 + f) / (f + full_sun_s_m / 5000);
}

void ground_flux(SurfaceFlux *out, const GroundColumn *c, const GroundWeather *w, const GroundExposure *e)
{
    const GroundKind *k = c->kind;
    const double level = w->direct_w_m2 * fmax(w->sun_d_enu[2], 0) * e->sun + w->diffuse_w_m2 * e->sky;
    *out = (SurfaceFlux){.air = w->air, .absorbed_w_m2 = ground_absorbed_w_m2(c, w, e), .emissivity = k->emissivity,
                         .roughness_m = k->roughness_m,
                         .resistance_s_m = k->vapour == GROUND_SOIL     ? soil_resistance_s_m(c->saturation)
                                           : k->vapour == GROUND_LEAVES ? leaves_s_m(k->resistance_s_m, level)
                                           : k->vapour == GROUND_WATER  ? 0
                                                                        : INFINITY};
    surface_flux_prepare(out);
}

typedef struct Between {
    const GroundColumn *column;
    SurfaceFlux         from, to;
} Between;

/* Straight between the two. */
static void law_between(void *law, double share, const void *user)
{
    const Between *b = user;
    SurfaceFlux   *out = law;
    const SurfaceFlux *p = &b->from, *q = &b->to;
    _Static_assert(sizeof *out <= column_law_octets, "room for the law");
    *out = *p;
    out->air.temp_k += share * (q->air.temp_k - p->air.temp_k);
    out->air.vapour_pa += share * (q->air.vapour_pa - p->air.vapour_pa);
    out->neutral_mps += share * (q->neutral_mps - p->neutral_mps);
    out->stable_per_k += share * (q->stable_per_k - p->stable_per_k);
    out->unstable += share * (q->unstable - p->unstable);
    out->absorbed_w_m2 += share * (q->absorbed_w_m2 - p->absorbed_w_m2);
    out->air_kg_m3 += share * (q->air_kg_m3 - p->air_kg_m3);
    if (p->resistance_s_m < INFINITY) out->resistance_s_m += share * (q->resistance_s_m - p->resistance_s_m);
}

void ground_column_step(GroundColumn *c, double tolerance_k, const GroundWeather *before, const GroundWeather *after,
                        const GroundExposure *exposure, double dt_s)
{
    Between between = {.column = c};
    ground_flux(&between.from, c, before, exposure);
    ground_flux(&between.to, c, after, exposure);
    const ColumnBoundary boundary = {surface_flux_w_m2, law_between, &between, 0, tolerance_k};
    const double begun_k = c->state.temp_k[0];
    column_step(&c->state, c->column, c->factors, &boundary, dt_s);
    if (c->state.temp_k[0] > c->kind->melts_k) { /* what is too much melts, and runs off */
        for (int i = 0; i < c->column->nodes && c->state.temp_k[i] > c->kind->melts_k; i++)
            c->state.temp_k[i] = c->kind->melts_k;
    }
    if (c->kind->vapour != GROUND_SOIL) return;
    const double evaporates = 0.5 * (surface_latent_w_m2(&between.from, begun_k) + surface_latent_w_m2(&between.to, c->state.temp_k[0]));
    const double rain = 0.5 * (before->rain_kg_m2s + after->rain_kg_m2s);
    c->saturation = soil_water_step(c->saturation, c->kind->saturation, c->kind->porosity, rain, evaporates / vapour_j_kg, dt_s);
}
