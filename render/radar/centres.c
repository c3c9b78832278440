/* render/radar/centres.c: see centres.h. */
#include "render/radar/centres.h"

#include <stdlib.h>

typedef struct Cells {
    double path_m, across_per_rad_m; /* side; side across by the angle that is turned */
    double turn_rad;                 /* least one */
    const double *part_turn_rad;     /* NULL: none */
    double u[3], right[3], up[3];    /* line of sight, and across it */
} Cells;

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
    int32_t path, right, up, part; /* part: that turns by itself, from 1; else 0 */
} Key;

static uint64_t hash_of(Key key)
{
    const uint64_t plane = (uint64_t)(uint32_t)key.path << 32 ^ (uint64_t)(uint32_t)key.right << 16;
    return mix(plane ^ mix((uint64_t)(uint32_t)key.up + 1 + ((uint64_t)(uint32_t)key.part << 32)));
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
    const double k = 2 * pi_rad * config->frequency_hz / light_mps;
    const double k_half_band = pi_rad * config->bandwidth_hz / light_mps;
    double       h[3], v[3];
    v3_scale(cells->u, 1, tx->u);
    v3_add_scaled(cells->u, cells->u, 1, rx->u); /* towards between the two */
    v3_scale(cells->u, 1 / fmax(v3_length(cells->u), 1e-9), cells->u);
    scatter_basis(h, v, cells->u);
    memcpy(cells->right, h, sizeof h);
    memcpy(cells->up, v, sizeof v);
    /* half a side from the middle, at the end of the band, half the turn away, both ways */
    cells->path_m = 2 * config->phase_rad / fmax(k_half_band, 1e-9);
    cells->across_per_rad_m = 2 * config->phase_rad / k;
    cells->turn_rad = fmax(config->turn_rad, 1e-9 / k);
    cells->part_turn_rad = config->part_turn_rad;
}

static int32_t cell_number(double x_m, double side_m) { return (int32_t)clamp(floor(x_m / side_m), -2e9, 2e9); }

/* What one hit or edge adds. */
typedef struct Share {
    double         path_m, middle[3];
    double complex s[4];       /* hh hv vh vv, without the phase of the path */
    double         amplitude;
    int            bounce, part;
} Share;

static Status add(CellTable *table, const Cells *cells, const Share *share, double k)
{
    const double more_rad = cells->part_turn_rad ? cells->part_turn_rad[share->part] : 0;
    const double across_m = cells->across_per_rad_m / (cells->turn_rad + more_rad);
    const Key key = {cell_number(share->path_m, cells->path_m), cell_number(v3_dot(share->middle, cells->right), across_m),
                     cell_number(v3_dot(share->middle, cells->up), across_m), more_rad > 0 ? share->part + 1 : 0};
    ScatterCentre *c = find(table, key);
    if (!c) return STATUS_NO_MEMORY;
    c->path_m = (key.path + 0.5) * cells->path_m;
    const double          phase = -k * (share->path_m - c->path_m);
    const double complex  turn = CMPLX(cos(phase), sin(phase));
    double complex *const to[4] = {&c->s.hh, &c->s.hv, &c->s.vh, &c->s.vv};
    for (int p = 0; p < 4; p++) *to[p] += share->s[p] * turn;
    for (int x = 0; x < 3; x++) c->p[x] += share->amplitude * share->middle[x];
    c->weight += share->amplitude;
    if (share->amplitude > c->strongest) {
        c->strongest = share->amplitude;
        c->bounce = share->bounce;
        c->part = share->part;
    }
    return STATUS_OK;
}

static void share_of_hit(Share *out, const TubeHits *h, size_t i, double k, const ScatterAntenna *tx,
                         const ScatterAntenna *rx)
{
    double       way[3], power = 0;
    const double first[3] = {(double)h->first[0][i], (double)h->first[1][i], (double)h->first[2][i]};
    const double last[3] = {(double)h->last[0][i], (double)h->last[1][i], (double)h->last[2][i]};
    out->path_m = h->path_m[i];
    if (tx != &h->tx || rx != &h->rx)
        out->path_m += scatter_path(way, tx, first) - scatter_path(way, &h->tx, first) +
                       (scatter_path(way, rx, last) - scatter_path(way, &h->rx, last));
    for (int x = 0; x < 3; x++) out->middle[x] = 0.5 * (first[x] + last[x]);
    /* -j k / 2 pi, and the footprint's share */
    const double share = k / (2 * pi_rad) * scatter_sinc(k * (double)h->slope_m[0][i]) * scatter_sinc(k * (double)h->slope_m[1][i]);
    for (int p = 0; p < 4; p++) {
        const double re = (double)h->amplitude[2 * p][i], im = (double)h->amplitude[2 * p + 1][i];
        out->s[p] = CMPLX(share * im, -share * re);
        power += re * re + im * im;
    }
    out->amplitude = fabs(share) * sqrt(0.5 * power);
    out->bounce = h->bounce[i];
    out->part = h->part[i];
}

static void share_of_edge(Share *out, const EdgeSegment *e, const TubeHits *h, double k, const ScatterAntenna *tx,
                          const ScatterAntenna *rx)
{
    double       way[3], power = 0;
    const double share = scatter_sinc(0.5 * k * e->slope * e->length_m);
    out->path_m = e->path_m;
    if (tx != &h->tx || rx != &h->rx)
        out->path_m += scatter_path(way, tx, e->p) - scatter_path(way, &h->tx, e->p) +
                       (scatter_path(way, rx, e->p) - scatter_path(way, &h->rx, e->p));
    memcpy(out->middle, e->p, sizeof e->p);
    for (int p = 0; p < 4; p++) {
        const double a = e->amplitude[p / 2][p % 2];
        out->s[p] = share * a;
        power += a * a;
    }
    out->amplitude = fabs(share) * sqrt(0.5 * power);
    out->bounce = 0;
    out->part = e->part;
}

static double square(double complex s) { return creal(s) * creal(s) + cimag(s) * cimag(s); }

Status centres_make(Centres *out, const TotalField *field, const ScatterAntenna *tx, const ScatterAntenna *rx,
                    const CentresConfig *config)
{
    const double    k = 2 * pi_rad * config->frequency_hz / light_mps;
    const TubeHits *h = &field->hits;
    CellTable       table = {.centres = out};
    Cells           cells;
    Share           share;
    Status          status = STATUS_OK;
    out->count = out->slots = 0;
    out->tubes_same_m2 = out->tubes_cross_m2 = 0;
    if (!tx) tx = &h->tx;
    if (!rx) rx = &h->rx;
    cells_of(&cells, tx, rx, config);
    for (size_t i = 0; i < h->count && status == STATUS_OK; i++) {
        share_of_hit(&share, h, i, k, tx, rx);
        out->tubes_same_m2 += 0.5 * (square(share.s[0]) + square(share.s[3]));
        out->tubes_cross_m2 += 0.5 * (square(share.s[1]) + square(share.s[2]));
        status = add(&table, &cells, &share, k);
    }
    for (int i = 0; i < field->edges.count && status == STATUS_OK; i++) {
        share_of_edge(&share, &field->edges.segment[i], h, k, tx, rx);
        status = add(&table, &cells, &share, k);
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
