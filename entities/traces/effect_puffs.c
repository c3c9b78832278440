/* entities/traces/effect_puffs.c: the rows of etc/effects.csv, and a puff's closed form. */
#include "entities/traces/effect_puffs.h"

#include <stdio.h>

/* mean density of the spheroid as a share of its peak density */
static const double mean_density = 8.0 / 35;

static const char *const kind_names[EFFECT_KIND_COUNT] = {
    "muzzle_flash", "muzzle_smoke", "launch_flash", "launch_smoke", "burst_flash",     "fireball",    "burst_smoke",
    "burst_dust",   "sparks",       "flame",        "smoke",        "engine_smoke",    "dust",        "contrail",
    "motor_plume",  "motor_smoke",  "afterburner",  "exhaust",      "turbine_exhaust", "jet_exhaust", "flare_fire"};

/* ---- table -------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    size_t      offset;
    double      low, high;
} columns[] = {
    {"asymmetry", offsetof(EffectModel, asymmetry), -0.95, 0.95},
    {"mass_kg", offsetof(EffectModel, mass_kg), 0, 1e4},
    {"radius_start_m", offsetof(EffectModel, radius_start_m), 0.01, 100},
    {"radius_end_m", offsetof(EffectModel, radius_end_m), 0.01, 1000},
    {"grow_s", offsetof(EffectModel, grow_s), 1e-4, 1e4},
    {"spread_mps", offsetof(EffectModel, spread_mps), 0, 10},
    {"rise_mps", offsetof(EffectModel, rise_mps), 0, 50},
    {"rise_s", offsetof(EffectModel, rise_s), 0.01, 1e4},
    {"temp_rise_k", offsetof(EffectModel, temp_rise_k), 0, 5000},
    {"cool_s", offsetof(EffectModel, cool_s), 1e-4, 1e4},
    {"life_s", offsetof(EffectModel, life_s), 1e-3, 1e4},
    {"time_power", offsetof(EffectModel, time_power), 0, 1},
    {"billow", offsetof(EffectModel, billow), 0, 1},
    {"co2_share", offsetof(EffectModel, co2_share), 0, 1},
    {"h2o_share", offsetof(EffectModel, h2o_share), 0, 1},
};
enum { column_count = sizeof columns / sizeof *columns };

/* columns of ext_ and albedo_ for the channel in each place except pan's */
typedef struct ChannelColumns {
    int of[2][effect_band_count]; /* columns of extinction and albedo; -1: pan */
} ChannelColumns;

static bool find_channel_columns(ChannelColumns *out, const Table *table)
{
    bool all = channels_load() == STATUS_OK;
    for (int which = 0; which < 2; which++)
        for (int b = 0; b < effect_band_count; b++) {
            char name[32];
            out->of[which][b] = -1;
            if (b == effect_band_pan) continue;
            snprintf(name, sizeof name, "%s_%s", which ? "albedo" : "ext", channel_in((ChannelPlace)b)->name);
            out->of[which][b] = table_column(table, name);
            if (out->of[which][b] >= 0) continue;
            log_error("effects: a column is missing: file=%s column=%s", table->path, name);
            all = false;
        }
    return all;
}

static Status read_row(EffectTable *effects, bool seen[EFFECT_KIND_COUNT], const Table *table, int row, int name_column,
                       const int column[column_count], const ChannelColumns *channels)
{
    const char *name = table_text(table, row, name_column);
    int         kind = 0;
    while (kind < EFFECT_KIND_COUNT && strcmp(kind_names[kind], name) != 0) kind++;
    if (kind == EFFECT_KIND_COUNT || seen[kind]) {
        log_error("effects: %s: file=%s line=%d name=\"%s\"",
                  kind == EFFECT_KIND_COUNT ? "no such effect" : "a second row for an effect", table->path,
                  table->line[row + 1], name);
        return STATUS_BAD_VALUE;
    }
    seen[kind] = true;
    EffectModel *law = &effects->law[kind];
    for (int c = 0; c < column_count; c++) {
        double      *to = (double *)((char *)law + columns[c].offset);
        const Status status = table_number(to, table, row, column[c], columns[c].low, columns[c].high);
        if (status != STATUS_OK) return status;
    }
    for (int which = 0; which < 2; which++) {
        double *of = which ? law->albedo : law->extinction_m2_kg;
        for (int b = 0; b < effect_band_count; b++) {
            if (channels->of[which][b] < 0) continue;
            const Status status = table_number(&of[b], table, row, channels->of[which][b], 0, which ? 1 : 1e5);
            if (status != STATUS_OK) return status;
        }
        of[effect_band_pan] = (of[effect_band_b] + of[effect_band_g] + of[effect_band_r]) / 3;
    }
    return STATUS_OK;
}

Status effect_table_open(EffectTable *out, const char *path)
{
    EffectTable effects = {0};
    bool        seen[EFFECT_KIND_COUNT] = {false};
    Table       table = {0};
    int         column[column_count];
    Status      status = table_open(&table, path);

    if (status != STATUS_OK) return status;
    const int name_column = table_column(&table, "name");
    for (int c = -1; c < column_count; c++) {
        const int at = c < 0 ? name_column : table_column(&table, columns[c].name);
        if (c >= 0) column[c] = at;
        if (at >= 0) continue;
        log_error("effects: a column is missing: file=%s column=%s", path, c < 0 ? "name" : columns[c].name);
        status = STATUS_BAD_VALUE;
    }
    ChannelColumns channels;
    if (!find_channel_columns(&channels, &table)) status = STATUS_BAD_VALUE;
    for (int row = 0; row < table.rows && status == STATUS_OK; row++)
        status = read_row(&effects, seen, &table, row, name_column, column, &channels);
    for (int kind = 0; kind < EFFECT_KIND_COUNT && status == STATUS_OK; kind++) {
        if (seen[kind]) continue;
        log_error("effects: an effect has no row: file=%s name=%s", path, kind_names[kind]);
        status = STATUS_BAD_VALUE;
    }
    table_close(&table);
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
    out->temp_k = weather->air_temp_k + law->temp_rise_k * exp(-age_s / (law->cool_s * times));

    /* the puff thins out towards its end, where density and slope reach zero, so it does not end abruptly */
    const double thin = (1 - lived * lived) * (1 - lived * lived);
    const double volume_m3 = 4.0 / 3 * pi_rad * out->across_m * out->across_m * out->along_m;
    const double peak_kg_m3 = puff->mass_kg * thin / (volume_m3 * mean_density);
    for (int b = 0; b < effect_band_count; b++) out->extinction_per_m[b] = law->extinction_m2_kg[b] * peak_kg_m3;
    out->co2_kg_m3 = law->co2_share * peak_kg_m3;
    out->h2o_kg_m3 = law->h2o_share * peak_kg_m3;
    return true;
}
