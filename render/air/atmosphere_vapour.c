/* render/air/atmosphere_vapour.c: gives a model its clear air by the weather, etc/atmosphere/vapour.bin, where the
 * model's tables have that file's heights and paths. */
#include "render/air/atmosphere_private.h"

#include <stdlib.h>
#include <unistd.h>

/* Rows of the file for the rows of the model's paths: the file has each pair of heights once, the lower one first.
 * False: the model has other paths. */
static bool match_rows(int *out, const Vapour *v, const PathTable *table)
{
    const int n = v->ends;
    int       first[vapour_axis_max] = {0}, rows = 0;
    if (table->nodes[0] != n || table->nodes[1] != n) return false;
    for (int i = 0; i < n; i++)
        if (table->axis[0][i] != v->end_m[i] || table->axis[1][i] != v->end_m[i]) return false;
    for (int i = 0, pair = 0; i < n; i++) {
        first[i] = rows; /* of the pair of this height with itself; those with higher ones follow */
        for (int j = i; j < n; j++) rows += (int)v->ranges[pair++];
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            const int low = i < j ? i : j, high = i < j ? j : i, to = table->first[i * n + j];
            int       pair = low * n - low * (low - 1) / 2, from = first[low];
            for (int k = low; k < high; k++) from += (int)v->ranges[pair++];
            if (table->first[i * n + j + 1] - to != (int)v->ranges[pair]) return false;
            for (int k = 0; k < (int)v->ranges[pair]; k++) {
                if (table->ln_range[to + k] != log(v->range_m[from + k])) return false;
                out[to + k] = from + k;
            }
        }
    return true;
}

static bool same_axis(const double *a, const double *b, int count)
{
    return memcmp(a, b, (size_t)count * sizeof *a) == 0;
}

/* Whether the model's tables have the file's heights, paths and weights. */
static bool fits(const Atmosphere *a, const Vapour *v, int *row)
{
    const AirColumn *clear = &a->clear;
    if (a->temperature.nodes[0] != v->levels || !same_axis(a->temperature.axis[0], v->level_m, v->levels) ||
        clear->nodes != v->heights || !same_axis(clear->height_m, v->height_m, v->heights))
        return false;
    for (int k = 0; k < air_tabled_count; k++) {
        const AirBand    band = air_tabled[k];
        const PathTable *table = &a->clear_path[band];
        if (a->vapour_channel[band] < 0) continue;
        const VapourChannel *channel = &v->channel[a->vapour_channel[band]];
        if (table->weights != channel->weights || table->values != channel->weights ||
            memcmp(table->weight_temp_k + 1, channel->temp_k, (size_t)(channel->weights - 1) * sizeof(double)) != 0 ||
            !match_rows(row, v, table))
            return false;
    }
    return true;
}

/* Radiance of the sky becomes its ratio to black air at the observer's height. */
static void sky_to_ratios(const Atmosphere *a, Vapour *v)
{
    const int count = v->sky[0] * v->sky[1];
    for (int p = 0; p < v->profiles; p++)
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < count; i++) {
                double       t;
                const int    level = interval_of(&t, v->level_m, v->levels, v->sky_m[i / v->sky[1]]);
                const float *temp_k = v->profile[p].level_k + level;
                const double black = planck_table_radiance(
                    a->planck[k], (double)temp_k[0] + (t > 0 ? t * (double)(temp_k[1] - temp_k[0]) : 0));
                for (int n = 2 * v->profile[p].first; n < 2 * (v->profile[p].first + v->profile[p].nodes); n++) {
                    float *value = v->node + (size_t)(n / 2) * v->node_floats + vapour_sky_at(v, n % 2, k) + i;
                    *value = (float)((double)*value / black);
                }
            }
}

Status atmosphere_vapour_open(Atmosphere *atmosphere, const char *model)
{
    char    path[1024];
    Vapour *v = NULL;
    if (!etc_path(path, sizeof path, "atmosphere/vapour.bin")) return STATUS_BAD_VALUE;
    if (access(path, F_OK) != 0) return STATUS_OK;
    const Status status = vapour_open(&v, path);
    if (status != STATUS_OK) return status;
    atmosphere->vapour_profile = vapour_profile(v, model);
    if (atmosphere->vapour_profile < 0) {
        vapour_close(v);
        return STATUS_OK;
    }
    const PathTable *paths = NULL; /* of the channels that follow */
    bool             alike = true;
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        const SpectralChannel *c = channel_in(b);
        /* the file's channels see all between their edges alike */
        const int channel = b == AIR_PAN || c->response ? -1 : vapour_channel(v, c->name, c->low_m, c->high_m);
        atmosphere->vapour_channel[b] = channel;
        if (channel < 0) continue;
        if (!paths) paths = &atmosphere->clear_path[b];
        alike = alike && paths_same_shape(paths, &atmosphere->clear_path[b]);
    }
    int *row = calloc(paths ? (size_t)paths->rows + 1 : 1, sizeof *row);
    atmosphere->vapour = v;
    atmosphere->vapour_row = row;
    if (!row) return STATUS_NO_MEMORY;
    if (!paths || !alike || v->both_ways != paths->rows || !fits(atmosphere, v, row)) {
        log_error("atmosphere: %s: its heights and paths are not those of model %s (clear/air.csv, clear/paths_*.csv, "
                  "temperature.csv); a model of other ones needs a name that %s does not have",
                  path, model, "vapour.bin");
        return STATUS_BAD_VALUE;
    }
    for (int i = 0; i < v->sky[1]; i++) v->sky_slant[i] = slant_x(v->sky_deg[i] * rad_per_deg);
    for (int i = 0; i < v->sun[1]; i++) v->sun_slant[i] = slant_x(v->sun_deg[i] * rad_per_deg);
    sky_to_ratios(atmosphere, v);
    return STATUS_OK;
}

void atmosphere_vapour_close(Atmosphere *atmosphere)
{
    vapour_close(atmosphere->vapour);
    free((void *)atmosphere->vapour_row);
}

bool atmosphere_follows_weather(const Atmosphere *atmosphere) { return atmosphere->vapour != NULL; }

bool atmosphere_band_follows(const Atmosphere *atmosphere, AirBand band)
{
    return atmosphere->vapour && (band == AIR_PAN || atmosphere->vapour_channel[band] >= 0);
}

double atmosphere_vapour_kg_m3(const Atmosphere *atmosphere)
{
    const Vapour *v = atmosphere->vapour;
    return v ? v->profile[atmosphere->vapour_profile].vapour_kg_m3 : atmosphere->ground_kg_m3;
}
