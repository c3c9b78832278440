/* render/radar/centres.c: see centres.h. */
#include "render/radar/centres.h"

#include <stdlib.h>

typedef struct Cells {
    double path_m, across_m;         /* sides */
    double u[3], right[3], up[3];    /* line of sight, and across it */
} Cells;

static double sinc(double x) { return fabs(x) < 1e-4 ? 1 - x * x / 6 : sin(x) / x; }

static uint64_t mix(uint64_t x)
{
    x ^= x >> 31;
    x *= 0x7fb5d329728ea185u;
    x ^= x >> 27;
    x *= 0x81dadef4bc2dd44du;
    return x ^ x >> 33;
}

static Status grow(Centres *c)
{
    if (c->count < c->capacity) return STATUS_OK;
    const int      capacity = c->capacity ? 2 * c->capacity : 1024;
    ScatterCentre *centre = realloc(c->centre, (size_t)capacity * sizeof *centre);
    if (!centre) return STATUS_NO_MEMORY;
    c->centre = centre;
    c->capacity = capacity;
    return STATUS_OK;
}

/* Which cell: its number along each axis. */
typedef struct Key {
    int32_t path, right, up;
} Key;

static uint64_t hash_of(Key key)
{
    return mix((uint64_t)(uint32_t)key.path << 32 ^ (uint64_t)(uint32_t)key.right << 16 ^ mix((uint64_t)(uint32_t)key.up + 1));
}

typedef struct CellTable {
    Key     *key; /* [centres->capacity] */
    int      keys;
    Centres *centres;
} CellTable;

static Status rehash(CellTable *t)
{
    Centres   *c = t->centres;
    const int  slots = c->slots ? 2 * c->slots : 4096;
    int32_t   *slot = realloc(c->slot, (size_t)slots * sizeof *slot);
    if (!slot) return STATUS_NO_MEMORY;
    c->slot = slot;
    c->slots = slots;
    memset(slot, 0xff, (size_t)slots * sizeof *slot);
    for (int i = 0; i < c->count; i++) {
        uint64_t at = hash_of(t->key[i]) & (uint64_t)(slots - 1);
        while (slot[at] >= 0) at = (at + 1) & (uint64_t)(slots - 1);
        slot[at] = i;
    }
    return STATUS_OK;
}

/* The centre of a cell; a new one, all zero, where it has none. NULL: no memory. */
static ScatterCentre *find(CellTable *t, Key key)
{
    Centres *c = t->centres;
    if (2 * (c->count + 1) > c->slots && rehash(t) != STATUS_OK) return NULL;
    uint64_t at = hash_of(key) & (uint64_t)(c->slots - 1);
    for (; c->slot[at] >= 0; at = (at + 1) & (uint64_t)(c->slots - 1))
        if (memcmp(&t->key[c->slot[at]], &key, sizeof key) == 0) return &c->centre[c->slot[at]];
    if (grow(c) != STATUS_OK) return NULL;
    if (t->keys < c->capacity) {
        Key *larger = realloc(t->key, (size_t)c->capacity * sizeof *larger);
        if (!larger) return NULL;
        t->key = larger;
        t->keys = c->capacity;
    }
    c->slot[at] = c->count;
    t->key[c->count] = key;
    c->centre[c->count] = (ScatterCentre){0};
    return &c->centre[c->count++];
}

static void cells_of(Cells *cells, const ScatterAntenna *tx, const ScatterAntenna *rx, const CentresConfig *config)
{
    const double k = 2 * pi_rad * config->frequency_hz / light_mps, k_half_band = pi_rad * config->bandwidth_hz / light_mps;
    double       h[3], v[3];
    v3_scale(cells->u, 1, tx->u);
    v3_add_scaled(cells->u, cells->u, 1, rx->u); /* towards between the two */
    v3_scale(cells->u, 1 / fmax(v3_length(cells->u), 1e-9), cells->u);
    scatter_basis(h, v, cells->u);
    memcpy(cells->right, h, sizeof h);
    memcpy(cells->up, v, sizeof v);
    /* half a side from the middle, at the end of the band, half the turn away, both ways */
    cells->path_m = 2 * config->phase_rad / fmax(k_half_band, 1e-9);
    cells->across_m = 2 * config->phase_rad / fmax(k * config->turn_rad, 1e-9);
}

static int32_t cell_number(double x_m, double side_m) { return (int32_t)clamp(floor(x_m / side_m), -2e9, 2e9); }

Status centres_make(Centres *out, const TubeHits *h, const ScatterAntenna *tx, const ScatterAntenna *rx,
                    const CentresConfig *config)
{
    const double k = 2 * pi_rad * config->frequency_hz / light_mps;
    const bool   moved = tx || rx;
    CellTable        table = {.centres = out};
    Cells        cells;
    Status       status = STATUS_OK;
    out->count = out->slots = 0;
    if (!tx) tx = &h->tx;
    if (!rx) rx = &h->rx;
    cells_of(&cells, tx, rx, config);
    for (size_t i = 0; i < h->count; i++) {
        double       way[3], middle[3], path_m = h->path_m[i];
        const double first[3] = {(double)h->first[0][i], (double)h->first[1][i], (double)h->first[2][i]};
        const double last[3] = {(double)h->last[0][i], (double)h->last[1][i], (double)h->last[2][i]};
        if (moved)
            path_m += scatter_path(way, tx, first) - scatter_path(way, &h->tx, first) +
                      (scatter_path(way, rx, last) - scatter_path(way, &h->rx, last));
        for (int x = 0; x < 3; x++) middle[x] = 0.5 * (first[x] + last[x]);
        const Key key = {cell_number(path_m, cells.path_m), cell_number(v3_dot(middle, cells.right), cells.across_m),
                         cell_number(v3_dot(middle, cells.up), cells.across_m)};
        ScatterCentre *c = find(&table, key);
        if (!c) {
            status = STATUS_NO_MEMORY;
            break;
        }
        c->path_m = (key.path + 0.5) * cells.path_m;
        /* -j k / 2 pi, the footprint's share, and the phase to the middle of the cell */
        const double share = k / (2 * pi_rad) * sinc(k * (double)h->slope_m[0][i]) * sinc(k * (double)h->slope_m[1][i]);
        const double phase = -k * (path_m - c->path_m);
        const double complex turn = share * CMPLX(sin(phase), -cos(phase));
        double complex *const to[4] = {&c->s.hh, &c->s.hv, &c->s.vh, &c->s.vv};
        double                power = 0;
        for (int p = 0; p < 4; p++) {
            const double re = (double)h->amplitude[2 * p][i], im = (double)h->amplitude[2 * p + 1][i];
            *to[p] += CMPLX(re, im) * turn;
            power += re * re + im * im;
        }
        const double amplitude = fabs(share) * sqrt(0.5 * power);
        for (int x = 0; x < 3; x++) c->p[x] += amplitude * middle[x];
        c->weight += amplitude;
        if (amplitude > c->strongest) {
            c->strongest = amplitude;
            c->bounce = h->bounce[i];
            c->part = h->part[i];
        }
    }
    for (int i = 0; i < out->count; i++)
        if (out->centre[i].weight > 0) v3_scale(out->centre[i].p, 1 / out->centre[i].weight, out->centre[i].p);
    free(table.key);
    if (status != STATUS_OK) out->count = 0;
    return status;
}

void centres_free(Centres *c)
{
    free(c->centre);
    free(c->slot);
    *c = (Centres){0};
}
