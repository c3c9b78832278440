/* render/air/atmosphere_day_open.c: opens the air of a day: what of the tables holds for its visibility and its sun. */
#include "render/air/atmosphere_private.h"

#include <assert.h>

static int merge_nodes(double *out, const AirColumn *const *column, int count)
{
    int at[3] = {0}, nodes = 0;
    for (;;) {
        double next = INFINITY;
        for (int c = 0; c < count; c++)
            if (at[c] < column[c]->nodes) next = fmin(next, column[c]->height_m[at[c]]);
        if (!(next < INFINITY)) return nodes;
        for (int c = 0; c < count; c++) at[c] += at[c] < column[c]->nodes && column[c]->height_m[at[c]] == next;
        out[nodes++] = next;
    }
}

static void add_up(double *sum, const double *value, const double *height_m, int nodes)
{
    sum[0] = 0;
    for (int i = 0; i + 1 < nodes; i++)
        sum[i + 1] = sum[i] + 0.5 * (height_m[i + 1] - height_m[i]) * (value[i] + value[i + 1]);
}

static Status fill_column(AirDay *day, Arena *arena)
{
    const Atmosphere      *a = day->atmosphere;
    const AirColumn *const from[3] = {&a->clear, &day->blend.low->haze, &day->blend.high->haze};
    DayColumn             *c = &day->column;
    c->height_m = arena_alloc(arena, 3 * column_max, sizeof *c->height_m);
    if (!c->height_m) return STATUS_NO_MEMORY;
    c->nodes = merge_nodes(c->height_m, from, 3);
    c->top_m = a->clear.height_m[a->clear.nodes - 1];
    c->per_bucket_m = day_buckets / (c->height_m[c->nodes - 1] * (1 + 1e-9));
    for (int k = 0, i = 0; k < day_buckets; k++) {
        while (i + 2 < c->nodes && c->height_m[i + 1] * c->per_bucket_m <= k) i++;
        c->start[k] = (uint16_t)i;
    }
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        if (!wants(day->parts, b)) continue;
        double **const row[] = {&c->clear[b],   &c->clear_sum[b],   &c->clear_scatter[b],
                                &c->haze[0][b], &c->haze_sum[0][b], &c->haze_scatter[0][b],
                                &c->haze[1][b], &c->haze_sum[1][b], &c->haze_scatter[1][b]};
        for (size_t k = 0; k < sizeof row / sizeof *row; k++)
            if (!(*row[k] = arena_alloc(arena, (size_t)c->nodes, sizeof(double)))) return STATUS_NO_MEMORY;
        for (int i = 0; i < c->nodes; i++) {
            const double h_m = c->height_m[i];
            c->clear[b][i] = column_mean(&a->clear, b, h_m, h_m);
            c->clear_scatter[b][i] = column_scatter(&a->clear, b, h_m);
            for (int which = 0; which < 2; which++) {
                c->haze[which][b][i] = column_mean(from[1 + which], b, h_m, h_m);
                c->haze_scatter[which][b][i] = column_scatter(from[1 + which], b, h_m);
            }
        }
        add_up(c->clear_sum[b], c->clear[b], c->height_m, c->nodes);
        for (int which = 0; which < 2; which++) add_up(c->haze_sum[which][b], c->haze[which][b], c->height_m, c->nodes);
    }
    return STATUS_OK;
}

static void fill_sun(AirDay *day, int which)
{
    const Slice *slice = slice_of(day, which);
    DaySun      *sun = &day->sun[which];
    sun->nodes = slice->sun.nodes[0];
    sun->height_m = slice->sun.axis[0];
    for (int i = 0; i < sun->nodes; i++)
        for (int k = 0; k < air_tabled_count; k++) {
            double node[2];
            if (!wants(day->parts, air_tabled[k])) continue;
            sun_node(node, day->atmosphere, slice, air_tabled[k], i, slant_x(day->sun_zenith_rad));
            sun->ln_depth[air_tabled[k]][i] = node[0];
            sun->ln_diffuse[air_tabled[k]][i] = node[1];
        }
}

/* Interpolates the sun's axis out of blocks of [suns][inner] values. */
static double *without_sun(const double *value, size_t blocks, int suns, int inner, int sun, double share, Arena *arena)
{
    double *out = arena_alloc(arena, blocks * (size_t)inner, sizeof *out);
    for (size_t k = 0; out && k < blocks; k++) {
        const double *low = value + (k * (size_t)suns + (size_t)sun) * (size_t)inner,
                     *high = share > 0 ? low + inner : low;
        for (int i = 0; i < inner; i++) out[k * (size_t)inner + (size_t)i] = low[i] + share * (high[i] - low[i]);
    }
    return out;
}

static Status fill_scattered(AirDay *day, int which, Arena *arena)
{
    const Slice *slice = slice_of(day, which);
    const double x = slant_x(day->sun_zenith_rad);
    double       t;
    int          i = interval_of(&t, slice->scattered.sun_x, slice->scattered.suns, x);
    day->ratio[which] = without_sun(slice->scattered.value, (size_t)slice->scattered.rows, slice->scattered.suns,
                                    slice->scattered.azimuths * air_tabled_count, i, t, arena);
    const Grid *sky = &slice->sky_scattered;
    i = interval_of(&t, sky->axis[2], sky->nodes[2], x);
    day->sky[which] = without_sun(sky->value, (size_t)sky->nodes[0] * (size_t)sky->nodes[1], sky->nodes[2],
                                  sky->nodes[3] * sky->values, i, t, arena);
    return day->ratio[which] && day->sky[which] ? STATUS_OK : STATUS_NO_MEMORY;
}

Status air_day_at(const AirDay **out, const Atmosphere *atmosphere, double visibility_m, double sun_zenith_rad,
                  unsigned bands, const double *temp_k, int temps, Arena *arena)
{
    AirDay *day = arena_alloc(arena, 1, sizeof *day);
    if (!day) return STATUS_NO_MEMORY;
    assert(temps <= day_temps_max);
    const PathTable *heights = &atmosphere->clear_path[AIR_B];
    *day = (AirDay){.atmosphere = atmosphere,
                    .sun_zenith_rad = sun_zenith_rad,
                    .sun_cos = cos(sun_zenith_rad),
                    .sun_sin = sin(sun_zenith_rad),
                    .bands = bands,
                    .parts = bands & ~(1u << AIR_PAN),
                    .temps = temps,
                    .top_m = fmin(heights->axis[0][heights->nodes[0] - 1], heights->axis[1][heights->nodes[1] - 1])};
    if (wants(bands, AIR_PAN)) day->parts |= 1u << AIR_B | 1u << AIR_G | 1u << AIR_R;
    blend_at(&day->blend, atmosphere, visibility_m);
    day->hazes = day->blend.low != day->blend.high;
    Status status = fill_column(day, arena);
    for (int which = 0; which <= day->hazes && status == STATUS_OK && sun_zenith_rad <= pi_rad / 2; which++) {
        fill_sun(day, which);
        status = fill_scattered(day, which, arena);
    }
    day->suns_alike =
        day->hazes && day->sun[0].nodes == day->sun[1].nodes && day->sun[0].nodes > 0 &&
        memcmp(day->sun[0].height_m, day->sun[1].height_m, (size_t)day->sun[0].nodes * sizeof(double)) == 0;
    for (int b = 0; b < 2; b++)
        for (int which = 0; which < 3; which++)
            for (int k = 0; k < temps; k++)
                day->temp[b][which][k] = temp_in(table_of(day, (AirBand)(AIR_MWIR + b), which), temp_k[k]);
    if (status == STATUS_OK) *out = day;
    return status;
}
