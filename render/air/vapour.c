/* render/air/vapour.c: reads etc/atmosphere/vapour.bin, and mixes its nodes. */
#include "render/air/vapour_private.h"

#include "pitviper_file.h"
#include "terrain/weather/weather.h"

#include <stdlib.h>

static double relative_humidity(double temp_k, double vapour_kg_m3)
{
    const Weather full = {.air_temp_k = temp_k, .humidity = 1};
    return clamp(vapour_kg_m3 / weather_vapour_kg_m3(&full), 0, 1);
}

/* ---- the file --------------------------------------------------------------------------------- */

enum { head_octets = 40, count_octets = 48, file_most = 64 << 20 };
_Static_assert(sizeof(double) == 8 && sizeof(float) == 4, "the file is read as it lies");

typedef struct Parse {
    const char *path, *at, *end;
    const char *wrong; /* what is; NULL: nothing yet */
} Parse;

static const void *take(Parse *p, size_t count, size_t octets)
{
    const char *at = p->at;
    if (p->wrong || count > (size_t)(p->end - p->at) / octets) {
        p->wrong = p->wrong ? p->wrong : "it ends before its numbers do";
        return NULL;
    }
    p->at += count * octets;
    return at;
}

static void refuse(Parse *p, const char *why)
{
    if (!p->wrong) p->wrong = why;
}

static const double *take_axis(Parse *p, int count, double low, double high)
{
    const double *axis = take(p, (size_t)count, sizeof *axis);
    for (int i = 0; axis && i < count; i++)
        if (!(axis[i] >= low && axis[i] <= high && (i == 0 || axis[i] > axis[i - 1])))
            refuse(p, "an axis does not rise within its range");
    return axis;
}

static bool floats_within(const float *value, size_t count, float low, float high)
{
    bool good = true;
    for (size_t i = 0; value && i < count; i++) good &= value[i] >= low && value[i] <= high;
    return good;
}

static const float *take_floats(Parse *p, size_t count, float low, float high)
{
    const float *value = take(p, count, sizeof *value);
    if (!floats_within(value, count, low, high)) refuse(p, "a number is outside its range");
    return value;
}

static double number_at(const char *at)
{
    double x;
    memcpy(&x, at, sizeof x);
    return x;
}

static uint32_t word_at(const char *at)
{
    uint32_t x;
    memcpy(&x, at, sizeof x);
    return x;
}

/* The sum of all words, and the sum of the sums. */
static void checksum(uint64_t sum[2], const char *at, size_t octets)
{
    uint64_t a = 0, b = 0;
    for (size_t i = 0; i < octets; i += sizeof(uint32_t)) {
        a += word_at(at + i);
        b += a;
    }
    sum[0] = a, sum[1] = b;
}

static void read_counts(Vapour *v, Parse *p)
{
    static const int most[12] = {vapour_channels_max, vapour_profiles_max, vapour_nodes_max, vapour_levels_max,
                                 vapour_axis_max,     vapour_axis_max,     vapour_rows_max,  vapour_axis_max,
                                 vapour_axis_max,     vapour_axis_max,     vapour_axis_max,  vapour_axis_max};
    int *const       to[12] = {&v->channels, &v->profiles, &v->nodes,  &v->levels, &v->heights, &v->ends,
                               &v->rows,     &v->sky[0],   &v->sky[1], &v->sun[0], &v->sun[1],  &v->humidities};
    for (int i = 0; i < 12; i++) {
        const uint32_t count = word_at(p->at + 4 * i);
        if (count < 1 || count > (uint32_t)most[i]) refuse(p, "a count is outside its range");
        *to[i] = (int)(count < (uint32_t)most[i] ? count : (uint32_t)most[i]);
    }
    p->at += count_octets;
    v->pairs = v->ends * (v->ends + 1) / 2;
}

static void read_channels(Vapour *v, Parse *p)
{
    for (int c = 0; c < v->channels; c++) {
        const char    *from = take(p, 1, 136);
        VapourChannel *channel = &v->channel[c];
        if (!from) return;
        memcpy(channel->name, from, sizeof channel->name - 1);
        channel->low_um = number_at(from + 16), channel->high_um = number_at(from + 24);
        const uint32_t weights = word_at(from + 32), self = word_at(from + 36);
        if (!(channel->low_um > 0 && channel->high_um > channel->low_um) || weights < 1 || self > 1 ||
            weights > vapour_temps_max)
            refuse(p, "a channel is impossible");
        channel->weights = weights <= vapour_temps_max ? (int)weights : 1;
        channel->self = self == 1;
        memcpy(channel->temp_k, from + 40, sizeof channel->temp_k);
    }
}

/* Where a node has what. */
static void lay_out(Vapour *v)
{
    size_t at = vapour_opaque_at(v, 2);
    for (int c = 0; c < v->channels; c++) {
        v->channel[c].at = at;
        at = vapour_path_at(v, c) + (size_t)v->rows * (size_t)v->channel[c].weights;
    }
    v->node_floats = at;
}

static void read_profiles(Vapour *v, Parse *p)
{
    int first = 0;
    for (int i = 0; i < v->profiles; i++) {
        const char    *from = take(p, 1, 56);
        VapourProfile *profile = &v->profile[i];
        if (!from) return;
        memcpy(profile->name, from, sizeof profile->name - 1);
        profile->temp_k = number_at(from + 32), profile->vapour_kg_m3 = number_at(from + 40);
        const uint32_t nodes = word_at(from + 52);
        if (word_at(from + 48) != (uint32_t)first || nodes < 1 || nodes > (uint32_t)(v->nodes - first) ||
            !(profile->temp_k >= 150 && profile->temp_k <= 400) ||
            !(profile->vapour_kg_m3 > 0 && profile->vapour_kg_m3 < 1) ||
            (i > 0 && !(profile->temp_k > v->profile[i - 1].temp_k))) {
            refuse(p, "a profile is impossible");
            return;
        }
        profile->first = first, profile->nodes = (int)nodes;
        profile->humidity = relative_humidity(profile->temp_k, profile->vapour_kg_m3);
        first += (int)nodes;
    }
    if (first != v->nodes) refuse(p, "nodes without a profile");
}

/* Factors rise in each profile, and one of them is 1. */
static void read_factors(Vapour *v, Parse *p)
{
    v->factor = take(p, (size_t)v->nodes, sizeof *v->factor);
    for (int i = 0; i < v->profiles && !p->wrong; i++) {
        VapourProfile *profile = &v->profile[i];
        profile->own = -1;
        for (int n = profile->first; n < profile->first + profile->nodes; n++) {
            const double f = v->factor[n];
            if (!(f > 0 && f <= 1000) || (n > profile->first && !(f > v->factor[n - 1])))
                refuse(p, "factors of the vapour do not rise");
            if (f == 1) profile->own = n;
        }
        if (profile->own < 0) refuse(p, "a profile without its own vapour");
    }
}

static void read_paths(Vapour *v, Parse *p)
{
    double rows = 0;
    v->end_m = take_axis(p, v->ends, 0, 1e5);
    v->ranges = take(p, (size_t)v->pairs, sizeof *v->ranges);
    for (int i = 0; v->ranges && i < v->pairs; i++) rows += v->ranges[i] >= 1 ? floor(v->ranges[i]) : NAN;
    if (!(rows == v->rows)) refuse(p, "its paths are not as many as it says");
    v->both_ways = 2 * v->rows;
    for (int i = 0, pair = 0; !p->wrong && i < v->ends; pair += v->ends - i, i++) v->both_ways -= (int)v->ranges[pair];
    v->range_m = take(p, (size_t)v->rows, sizeof *v->range_m);
    for (int i = 0; v->range_m && i < v->rows; i++)
        if (!(v->range_m[i] >= 1 && v->range_m[i] <= 2e6)) refuse(p, "a range is impossible");
}

static void read_body(Vapour *v, Parse *p)
{
    read_counts(v, p);
    if (p->wrong) return;
    read_channels(v, p);
    read_profiles(v, p);
    read_factors(v, p);
    v->level_m = take_axis(p, v->levels, 0, 2e5);
    v->height_m = take_axis(p, v->heights, 0, 2e5);
    read_paths(v, p);
    v->sky_m = take_axis(p, v->sky[0], 0, 2e5);
    v->sky_deg = take_axis(p, v->sky[1], 0, 90);
    v->sun_m = take_axis(p, v->sun[0], 0, 2e5);
    v->sun_deg = take_axis(p, v->sun[1], 0, 90);
    v->humidity = take_axis(p, v->humidities, 0, 1);
    for (int i = 0; i < v->profiles; i++) v->profile[i].level_k = take_floats(p, (size_t)v->levels, 100, 400);
    if (p->wrong) return;
    lay_out(v);
    const size_t both = 2 * (size_t)v->channels;
    v->haze = take_floats(p, (size_t)v->profiles * both * (size_t)v->heights, 0, 1e3f);
    v->humid = take_floats(p, both * (size_t)v->humidities, 1e-9f, 1e3f);
    const size_t numbers = (size_t)v->nodes * v->node_floats;
    v->node = (float *)(p->wrong ? NULL : v->file + (p->at - v->file));
    take_floats(p, numbers, 0, 1e6f);
    if (!p->wrong && p->at != p->end) refuse(p, "it goes on behind its numbers");
}

Status vapour_open(Vapour **out, const char *path)
{
    size_t  octets;
    Vapour *v = calloc(1, sizeof *v);
    Status  status =
        v ? file_read_whole(&v->file, &octets, "atmosphere", path, file_most, FILE_FROM_DISK) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        Parse    p = {.path = path, .at = v->file + head_octets, .end = v->file + octets};
        uint64_t said[3], sum[2];
        if (octets < head_octets + count_octets || octets % 4 != 0) refuse(&p, "it is too short, or cut off");
        else if (memcmp(v->file, "PVVAPOUR", 8) != 0) refuse(&p, "it does not begin as such a file does");
        else if (word_at(v->file + 8) != 1 || word_at(v->file + 12) != 0) refuse(&p, "it is of another version");
        if (!p.wrong) {
            memcpy(said, v->file + 16, sizeof said);
            if (said[0] != octets) refuse(&p, "it is not as long as it says");
        }
        if (!p.wrong) {
            checksum(sum, p.at, octets - head_octets);
            if (sum[0] != said[1] || sum[1] != said[2]) refuse(&p, "it is damaged: its sums are others");
        }
        if (!p.wrong) read_body(v, &p);
        if (p.wrong) {
            log_error("atmosphere: %s: %s; etc/atmosphere/make/vapour.py makes it, README.md there has its layout",
                      path, p.wrong);
            status = STATUS_BAD_VALUE;
        }
    }
    if (status == STATUS_OK) *out = v;
    else vapour_close(v);
    return status;
}

void vapour_close(Vapour *vapour)
{
    if (!vapour) return;
    free(vapour->file);
    free(vapour);
}

int vapour_profile(const Vapour *vapour, const char *name)
{
    for (int i = 0; i < vapour->profiles; i++)
        if (strcmp(vapour->profile[i].name, name) == 0) return i;
    return -1;
}

int vapour_channel(const Vapour *vapour, const char *name, double low_m, double high_m)
{
    for (int c = 0; c < vapour->channels; c++) {
        const VapourChannel *channel = &vapour->channel[c];
        if (strcmp(channel->name, name) == 0 && fabs(channel->low_um * 1e-6 - low_m) < 1e-9 &&
            fabs(channel->high_um * 1e-6 - high_m) < 1e-9)
            return c;
    }
    return -1;
}

/* ---- between the nodes ------------------------------------------------------------------------- */

/* A place between ascending nodes. */
static int cell_of(double *share, const double *node, int count, double x)
{
    int low = 0, high = count - 1;
    *share = 0;
    if (count < 2 || !(x > node[0])) return 0;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (node[middle] <= x) low = middle;
        else high = middle;
    }
    *share = fmin((x - node[low]) / (node[high] - node[low]), 1);
    return low;
}

static double between(const float *value, int i, double t)
{
    return (double)value[i] + (t > 0 ? t * (double)(value[i + 1] - value[i]) : 0);
}

/* Lagrange's cubic at x through the nodes about it. */
static void cubic_shares(double share[vapour_cubic], const double *node, int count, double x)
{
    for (int i = 0; i < count; i++) {
        share[i] = 1;
        for (int j = 0; j < count; j++)
            if (j != i) share[i] *= (x - node[j]) / (node[i] - node[j]);
    }
}

/* The nodes of one profile about a vapour. */
static void add_profile(VapourMix *out, const Vapour *v, int profile, double share, double vapour_kg_m3)
{
    const VapourProfile *p = &v->profile[profile];
    const double        *factor = v->factor + p->first;
    const double         f = clamp(vapour_kg_m3 / p->vapour_kg_m3, factor[0], factor[p->nodes - 1]);
    int                  cell = 0;
    while (cell + 2 < p->nodes && f >= factor[cell + 1]) cell++;
    const int first = cell > 0 ? cell - 1 : 0, last = cell + 2 < p->nodes ? cell + 2 : p->nodes - 1;
    const int count = last - first + 1, which = out->profiles++;
    double    root[vapour_cubic], of_root[vapour_cubic], of_self[vapour_cubic];
    for (int i = 0; i < count; i++) root[i] = sqrt(factor[first + i]);
    cubic_shares(of_root, root, count, sqrt(f));
    cubic_shares(of_self, factor + first, count, f);
    out->profile[which] = profile;
    out->profile_share[which] = share;
    out->temp_k += share * p->temp_k;
    for (int i = 0; i < count; i++) {
        if (of_root[i] == 0 && of_self[i] == 0) continue;
        out->node[out->nodes] = p->first + first + i;
        out->of[out->nodes] = which;
        out->share[0][out->nodes] = share * of_root[i];
        out->share[1][out->nodes++] = share * of_self[i];
    }
}

/* What a humidity makes of haze, over what a profile's own makes. */
static void add_swell(VapourMix *out, const Vapour *v, int which)
{
    double    s, t;
    const int now = cell_of(&t, v->humidity, v->humidities, out->humidity);
    const int own = cell_of(&s, v->humidity, v->humidities, v->profile[out->profile[which]].humidity);
    for (int c = 0; c < v->channels; c++)
        for (int part = 0; part < 2; part++) {
            const float *value = v->humid + (size_t)(2 * c + part) * (size_t)v->humidities;
            out->swell[which][c][part] = between(value, now, t) / between(value, own, s);
        }
}

void vapour_mix(VapourMix *out, const Vapour *vapour, double temp_k, double vapour_kg_m3)
{
    const VapourProfile *p = vapour->profile;
    int                  low = 0;
    *out = (VapourMix){.humidity = relative_humidity(temp_k, vapour_kg_m3)};
    while (low + 2 < vapour->profiles && temp_k >= p[low + 1].temp_k) low++;
    const double share =
        vapour->profiles > 1 ? clamp((temp_k - p[low].temp_k) / (p[low + 1].temp_k - p[low].temp_k), 0, 1) : 0;
    if (share < 1) add_profile(out, vapour, low, 1 - share, vapour_kg_m3);
    if (share > 0) add_profile(out, vapour, low + 1, share, vapour_kg_m3);
    for (int k = 0; k < out->profiles; k++) add_swell(out, vapour, k);
}

/* ---- haze ---------------------------------------------------------------------------------------- */

double vapour_haze_scale(const Vapour *vapour, const VapourMix *mix, int own_profile, int channel, int part,
                         const VapourPlace *at)
{
    /* LOWTRAN7's rural haze swells with the relative humidity up to 2 km; up to 3 km it goes over into that of the
     * troposphere, which has the same humidity everywhere */
    const double humid = clamp((3000 - at->height_m) / 1000, 0, 1), t = at->share;
    const size_t heights = (size_t)vapour->heights, step = 2 * (size_t)vapour->channels * heights;
    const float *haze = vapour->haze + (size_t)(2 * channel + part) * heights;
    const int    i = at->cell;
    double       sum = 0;
    const double own = between(haze + (size_t)own_profile * step, i, t);
    if (!(own > 0)) return 1;
    for (int k = 0; k < mix->profiles; k++)
        sum += mix->profile_share[k] * (1 + humid * (mix->swell[k][channel][part] - 1)) *
               between(haze + (size_t)mix->profile[k] * step, i, t);
    return sum / own;
}
