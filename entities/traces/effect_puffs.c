/* entities/traces/effect_puffs.c: the rows of etc/effects.csv, and a puff's closed form. */
#include "entities/traces/effect_puffs.h"

#include "pitviper_table.h"

#include <stdio.h>

/* mean density of the spheroid as a share of its peak density */
static const double mean_density = 8.0 / 35;

static const char *const kind_names[EFFECT_KIND_COUNT] = {
    "muzzle_flash", "muzzle_smoke",  "launch_flash", "launch_smoke", "burst_flash",     "fireball",    "burst_smoke",
    "burst_dust",   "sparks",        "flame",        "smoke",        "engine_smoke",    "dust",        "contrail",
    "motor_plume",  "motor_smoke",   "afterburner",  "exhaust",      "turbine_exhaust", "jet_exhaust", "flare_fire",
    "wood_smoke",   "smoulder_smoke"};

/* ---- table -------------------------------------------------------------------------------- */

typedef struct Row {
    int         kind;
    EffectModel law;
} Row;

static const char *kind_named(int kind) { return kind_names[kind]; }

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    Row row = *(const Row *)read;
    (void)rows, (void)number;
    for (int which = 0; which < 2; which++) {
        double *of = which ? row.law.albedo : row.law.extinction_m2_kg;
        of[effect_band_pan] = (of[effect_band_b] + of[effect_band_g] + of[effect_band_r]) / 3;
    }
    /* delta-Eddington (Joseph, Wiscombe & Weinman 1976): what is scattered forward goes on */
    const double peak = row.law.asymmetry_ir * row.law.asymmetry_ir;
    for (int b = effect_band_mwir; b <= effect_band_lwir; b++) {
        const double albedo = row.law.albedo[b], left = 1 - albedo * peak;
        row.law.extinction_m2_kg[b] *= left;
        row.law.albedo[b] = albedo * (1 - peak) / left;
    }
    ((EffectTable *)user)->law[row.kind] = row.law;
    return STATUS_OK;
}

#define FIELD(member) TABLE_AT(Row, member)

static const TableColumn own_columns[] = {
    {"name", TABLE_NAMED, FIELD(kind), .high = EFFECT_KIND_COUNT - 1, .named = kind_named, .key = true},
    {"asymmetry", TABLE_DOUBLE, FIELD(law.asymmetry), .low = -0.95, .high = 0.95},
    {"mass_kg", TABLE_DOUBLE, FIELD(law.mass_kg), .low = 0, .high = 1e4},
    {"radius_start_m", TABLE_DOUBLE, FIELD(law.radius_start_m), .low = 0.01, .high = 100},
    {"radius_end_m", TABLE_DOUBLE, FIELD(law.radius_end_m), .low = 0.01, .high = 1000},
    {"grow_s", TABLE_DOUBLE, FIELD(law.grow_s), .low = 1e-4, .high = 1e4},
    {"spread_mps", TABLE_DOUBLE, FIELD(law.spread_mps), .low = 0, .high = 10},
    {"rise_mps", TABLE_DOUBLE, FIELD(law.rise_mps), .low = 0, .high = 50},
    {"rise_s", TABLE_DOUBLE, FIELD(law.rise_s), .low = 0.01, .high = 1e4},
    {"temp_rise_k", TABLE_DOUBLE, FIELD(law.temp_rise_k), .low = 0, .high = 5000},
    {"cool_s", TABLE_DOUBLE, FIELD(law.cool_s), .low = 1e-4, .high = 1e4},
    {"life_s", TABLE_DOUBLE, FIELD(law.life_s), .low = 1e-3, .high = 1e4},
    {"time_power", TABLE_DOUBLE, FIELD(law.time_power), .low = 0, .high = 1},
    {"billow", TABLE_DOUBLE, FIELD(law.billow), .low = 0, .high = 1},
    {"asymmetry_ir", TABLE_DOUBLE, FIELD(law.asymmetry_ir), .low = 0, .high = 0.95, .absent = TABLE_LATER},
    {"ground_share", TABLE_DOUBLE, FIELD(law.ground_share), .low = 0, .high = 1, .absent = TABLE_LATER},
    {"co2_share", TABLE_DOUBLE, FIELD(law.co2_share), .low = 0, .high = 1, .absent = TABLE_LATER},
    {"h2o_share", TABLE_DOUBLE, FIELD(law.h2o_share), .low = 0, .high = 1, .absent = TABLE_LATER},
};
enum { own_count = sizeof own_columns / sizeof *own_columns, channel_columns = 2 * effect_band_count };

Status effect_table_open(EffectTable *out, const char *path)
{
    TableColumn columns[own_count + channel_columns];
    char        name[channel_columns][32];
    TableFormat format = {"effects", columns, own_count, .every = true, .next = "etc/effects.csv explains the columns"};
    EffectTable effects = {0};
    Row         row;
    if (channels_load() != STATUS_OK) return STATUS_BAD_VALUE;
    memcpy(columns, own_columns, sizeof own_columns);
    /* ext_ and albedo_ of the channel in each place except pan's */
    for (int k = 0; k < channel_columns; k++) {
        const int    b = k % effect_band_count, albedo = k / effect_band_count;
        const size_t of = albedo ? offsetof(Row, law.albedo) : offsetof(Row, law.extinction_m2_kg);
        if (b == effect_band_pan) continue;
        snprintf(name[k], sizeof name[k], "%s_%s", albedo ? "albedo" : "ext", channel_in((ChannelPlace)b)->name);
        columns[format.count++] =
            (TableColumn){.name = name[k], .offset = of + (size_t)b * sizeof(double), .high = albedo ? 1 : 1e5};
    }
    const Status status = table_each(&format, path, &row, sizeof row, take_row, &effects);
    if (status == STATUS_OK) *out = effects;
    return status;
}

/* ---- puff over time ----------------------------------------------------------------------- */

static double time_scale(const EffectModel *law, double scale)
{
    return law->time_power > 0 ? pow(scale, law->time_power) : 1;
}

double effect_life_s(const EffectTable *table, EffectKind kind, double scale)
{
    const EffectModel *law = &table->law[kind];
    return law->life_s * time_scale(law, scale);
}

/* Distance covered at an initial speed `first` that decays with tau: exact, and never more than first * t. */
static double dying_way(double first, double tau_s, double t_s) { return first * tau_s * -expm1(-t_s / tau_s); }

bool effect_volume(EffectVolume *out, const EffectTable *table, const EffectPuff *puff, const Weather *weather,
                   const LocalFrame *frame)
{
    const EffectModel *law = &table->law[puff->kind];
    const double       times = time_scale(law, puff->scale), age_s = puff->age_s, lived = age_s / (law->life_s * times);
    double             p_ecef[3], way[3];

    if (!(age_s >= 0 && lived < 1 && puff->mass_kg > 0)) return false;

    /* rise and throw are in the place's own axes; the wind is in the frame's, whose north is within a degree */
    v3_add_scaled(p_ecef, puff->p_ecef, puff->scale * dying_way(law->rise_mps, law->rise_s, age_s), puff->up_ecef);
    for (int i = 0; i < 3; i++) way[i] = dying_way(puff->throw_mps[i], puff->throw_s, age_s);
    v3_add(p_ecef, p_ecef, way);
    enu_from_ecef(out->p_enu, frame, p_ecef);
    const double drift_m = weather->wind_mps * age_s;
    out->p_enu[0] -= drift_m * sin(weather->wind_from_rad);
    out->p_enu[1] -= drift_m * cos(weather->wind_from_rad);
    m3_tmul_v3(out->axis_enu, frame->r_ecef_from_enu, puff->axis_ecef);

    const double grown = -expm1(-age_s / (law->grow_s * times));
    out->across_m = puff->scale * (law->radius_start_m + (law->radius_end_m - law->radius_start_m) * grown) +
                    law->spread_mps * age_s;
    out->along_m = fmax(out->across_m, puff->along_m);
    const double warm = exp(-age_s / (law->cool_s * times));
    out->temp_k = weather->air_temp_k + law->temp_rise_k * warm;
    out->ground_share = law->ground_share * warm;

    /* the puff thins out towards its end, where density and slope reach zero, so it does not end abruptly */
    const double thin = (1 - lived * lived) * (1 - lived * lived);
    const double volume_m3 = 4.0 / 3 * pi_rad * out->across_m * out->across_m * out->along_m;
    const double peak_kg_m3 = puff->mass_kg * thin / (volume_m3 * mean_density);
    for (int b = 0; b < effect_band_count; b++) out->extinction_per_m[b] = law->extinction_m2_kg[b] * peak_kg_m3;
    out->co2_kg_m3 = law->co2_share * peak_kg_m3;
    out->h2o_kg_m3 = law->h2o_share * peak_kg_m3;
    return true;
}
