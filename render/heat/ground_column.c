/* render/heat/ground_column.c: kinds of ground under the weather: their rows of etc/ground_heat.csv, their soil, their
 * balance. */

#include "render/heat/ground_column_private.h"

#include "pitviper_table.h"

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
    layer[layers++] = (ColumnLayer){
        fmax(grid->depth_m - above_m, 0.5),
        soil ? ground_soil_conductivity_w_mk(kind->porosity, kind->quartz, kind->saturation) : kind->rock_w_mk,
        soil ? ground_soil_capacity_j_m3k(kind->porosity, kind->saturation) : kind->rock_j_m3k};
    return column_create(out, layer, layers, grid->first_m, grid->growth);
}

void ground_column_start(GroundColumn *out, const GroundKind *kind, const Column *layers, double temp_k)
{
    *out = (GroundColumn){.kind = kind, .column = layers, .saturation = kind->saturation};
    column_start(&out->state, layers, temp_k);
}

/* Reflectance of wet soil over that of dry soil: 1 - saturation / 2 (Idso et al., J. Appl. Meteorol. 14, 1975: 0.30 of
 * dry loam, 0.14 of wet). */
static double soil_darkening(double saturation) { return 1 - 0.5 * saturation; }

/* What it absorbs, W/m2. */
static double ground_absorbed_w_m2(const GroundColumn *c, const GroundWeather *w, const GroundExposure *e)
{
    const GroundKind *k = c->kind;
    const double      up = 0.5 * (1 + e->n_enu[2]), sky = up * e->sky;
    const double      dark =
        k->vapour == GROUND_SOIL ? 1 - (1 - k->absorptance) * soil_darkening(c->saturation) : k->absorptance;
    const double along = fmax(v3_dot(e->n_enu, w->sun_d_enu), 0),
                 level = w->direct_w_m2 * fmax(w->sun_d_enu[2], 0) + w->diffuse_w_m2;
    const double sun = e->sun * w->direct_w_m2 * along + w->diffuse_w_m2 * sky + (1 - up) * (1 - dark) * level;
    return dark * sun + k->emissivity * (sky * w->longwave_w_m2 + (1 - sky) * stefan_w_m2k4 * pow(e->around_k, 4));
}

/* Leaves: as Noilhan & Planton, Mon. Weather Rev. 117, 1989, whose stomata close in the dark (eq. 33, RGL 100 W/m2,
 * leaf area index 3). */
static double leaves_s_m(double full_sun_s_m, double sun_w_m2)
{
    const double f = 0.55 * sun_w_m2 / 100 * (2.0 / 3);
    return full_sun_s_m * (1 + f) / (f + full_sun_s_m / 5000);
}

/* Resistance of the topmost soil to the vapour that leaves it, s/m: exp(8.206 - 4.255 saturation) (Sellers et al., J.
 * Geophys. Res. 97, 1992). */
static double soil_resistance_s_m(double saturation) { return exp(8.206 - 4.255 * saturation); }

void ground_flux(SurfaceFlux *out, const GroundColumn *c, const GroundWeather *w, const GroundExposure *e)
{
    const GroundKind *k = c->kind;
    const double      level = w->direct_w_m2 * fmax(w->sun_d_enu[2], 0) * e->sun + w->diffuse_w_m2 * e->sky;
    *out = (SurfaceFlux){.air = w->air,
                         .absorbed_w_m2 = ground_absorbed_w_m2(c, w, e),
                         .emissivity = k->emissivity,
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
    const Between     *b = user;
    SurfaceFlux       *out = law;
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

/* Water at the top after dt_s: rain and evaporation (kg/(m2 s)) change it, water from below restores it within a day
 * (force-restore: Deardorff, J. Geophys. Res. 83, 1978). Saturations, 0 .. 1. */
static double soil_water_step(double top, double deep, double porosity, double rain_kg_m2s, double evaporates_kg_m2s,
                              double dt_s)
{
    static const double depth_m = 0.1, day_s = 86400, restores = 0.9;
    const double        c1 = top >= 0.75 ? 0.5 : top <= 0.15 ? 14 : 14 - 22.5 * (top - 0.15);
    const double        gain = c1 * (rain_kg_m2s - evaporates_kg_m2s) / (1000 * depth_m * porosity);
    const double        back = exp(-restores * dt_s / day_s), held = deep + gain * day_s / restores;
    return clamp(held + (top - held) * back, 0.01, 1);
}

void ground_column_step(GroundColumn *c, double tolerance_k, const GroundWeather *before, const GroundWeather *after,
                        const GroundExposure *exposure, double dt_s)
{
    Between between = {.column = c};
    ground_flux(&between.from, c, before, exposure);
    ground_flux(&between.to, c, after, exposure);
    const ColumnBoundary boundary = {surface_flux_w_m2, law_between, &between, 0, tolerance_k};
    const double         begun_k = c->state.temp_k[0];
    column_step(&c->state, c->column, c->factors, &boundary, dt_s);
    if (c->state.temp_k[0] > c->kind->melts_k) { /* what is too much melts, and runs off */
        for (int i = 0; i < c->column->nodes && c->state.temp_k[i] > c->kind->melts_k; i++)
            c->state.temp_k[i] = c->kind->melts_k;
    }
    if (c->kind->vapour != GROUND_SOIL) return;
    const double evaporates =
        0.5 * (surface_latent_w_m2(&between.from, begun_k) + surface_latent_w_m2(&between.to, c->state.temp_k[0]));
    const double rain = 0.5 * (before->rain_kg_m2s + after->rain_kg_m2s);
    c->saturation =
        soil_water_step(c->saturation, c->kind->saturation, c->kind->porosity, rain, evaporates / vapour_j_kg, dt_s);
}

/* ---- soil ------------------------------------------------------------------------------------ */

double ground_soil_conductivity_w_mk(double porosity, double quartz, double saturation)
{
    const double density = (1 - porosity) * 2700;
    const double dry = (0.135 * density + 64.7) / (2700 - 0.947 * density);
    const double solids = pow(7.7, quartz) * pow(quartz < 0.2 ? 3 : 2, 1 - quartz);
    const double wet = pow(solids, 1 - porosity) * pow(0.57, porosity);
    const double kersten = saturation > 0.1 ? fmax(log10(saturation) + 1, 0) : 0;
    return dry + kersten * (wet - dry);
}

double ground_soil_capacity_j_m3k(double porosity, double saturation)
{
    return (1 - porosity) * 2.0e6 + porosity * saturation * 4.18e6;
}

/* ---- what the ground of each surface class is made of ---------------------------------------- */

static const char *ground_kind_name(int kind)
{
    return kind == ground_forest_floor ? "forest_floor"
           : kind == ground_burnt      ? "burnt"
                                       : surface_name((SurfaceClass)kind);
}

int ground_kind_find(const char *name)
{
    for (int k = 1; k < ground_kinds; k++)
        if (strcmp(ground_kind_name(k), name) == 0) return k;
    return -1;
}

typedef struct Row {
    int        kind;
    GroundKind k; /* absorptance NaN: that of its material */
} Row;

#define KIND(member) TABLE_AT(Row, k.member)

static const TableColumn columns[] = {
    {"surface", TABLE_NAMED, TABLE_AT(Row, kind), .low = 1, .high = ground_kinds - 1, .named = ground_kind_name,
     .key = true},
    {"vapour", TABLE_CHOICE, KIND(vapour), .choices = "dry, soil, leaves, water"},
    {"absorptance", TABLE_DOUBLE, KIND(absorptance), .low = 0, .high = 1, .absent = TABLE_EMPTY, .otherwise = NAN},
    {"top_m", TABLE_DOUBLE, KIND(layer[0].thickness_m), .low = 0, .high = 10},
    {"top_w_mk", TABLE_DOUBLE, KIND(layer[0].conductivity_w_mk), .low = 0, .high = 1e4},
    {"top_j_m3k", TABLE_DOUBLE, KIND(layer[0].capacity_j_m3k), .low = 0, .high = 1e7},
    {"under_m", TABLE_DOUBLE, KIND(layer[1].thickness_m), .low = 0, .high = 10},
    {"under_w_mk", TABLE_DOUBLE, KIND(layer[1].conductivity_w_mk), .low = 0, .high = 1e4},
    {"under_j_m3k", TABLE_DOUBLE, KIND(layer[1].capacity_j_m3k), .low = 0, .high = 1e7},
    {"porosity", TABLE_DOUBLE, KIND(porosity), .low = 0, .high = 0.95},
    {"quartz", TABLE_DOUBLE, KIND(quartz), .low = 0, .high = 1},
    {"saturation", TABLE_DOUBLE, KIND(saturation), .low = 0, .high = 1},
    {"rock_w_mk", TABLE_DOUBLE, KIND(rock_w_mk), .low = 0, .high = 100},
    {"rock_j_m3k", TABLE_DOUBLE, KIND(rock_j_m3k), .low = 0, .high = 1e7},
    {"roughness_m", TABLE_DOUBLE, KIND(roughness_m), .low = 1e-5, .high = 3},
    {"leaf_s_m", TABLE_DOUBLE, KIND(resistance_s_m), .low = 0, .high = 5000},
};
static const TableFormat format = {"ground heat", columns, sizeof columns / sizeof *columns, .every = true,
                                   .next = "etc/ground_heat.csv explains the columns"};

typedef struct Reading {
    GroundKinds     *kinds;
    const Materials *materials;
} Reading;

/* Layers that are there, and none of them without its figures. */
static bool layers_fit(GroundKind *kind)
{
    kind->layers = 0;
    for (int l = 0; l < 2; l++) {
        const ColumnLayer *at = &kind->layer[l];
        if (at->thickness_m == 0) return l == 1 || kind->layer[1].thickness_m == 0;
        if (!(at->conductivity_w_mk > 0) || !(at->capacity_j_m3k > 0)) return false;
        kind->layers++;
    }
    return true;
}

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    Reading        *r = user;
    const int       k = ((const Row *)read)->kind;
    GroundKind     *kind = &r->kinds->kind[k];
    const Material *m = &r->materials->material[r->materials->surface[k < SURFACE_COUNT ? k : SURFACE_BARE_SOIL]];
    *kind = ((const Row *)read)->k;
    if (isnan(kind->absorptance)) kind->absorptance = (double)m->solar_absorptance;
    kind->emissivity = 1 - (double)m->rho_lwir;
    kind->melts_k = k == SURFACE_SNOW ? 273.15 : INFINITY;
    if (!layers_fit(kind) || (kind->porosity == 0 && !(kind->rock_w_mk > 0 && kind->rock_j_m3k > 0)))
        return table_rows_refuse(rows, number, NULL,
                                 "a layer needs conductivity and capacity, and ground without pores rock_w_mk and "
                                 "rock_j_m3k");
    snprintf(kind->name, sizeof kind->name, "%s", ground_kind_name(k));
    return STATUS_OK;
}

Status ground_kinds_open(GroundKinds *out, const char *path, const Materials *materials)
{
    Row row;
    *out = (GroundKinds){0};
    const Status status = table_each(&format, path, &row, sizeof row, take_row, &(Reading){out, materials});
    out->kind[SURFACE_NONE] = out->kind[SURFACE_BARE_SOIL];
    return status;
}
