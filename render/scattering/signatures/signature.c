/* render/scattering/signatures/signature.c: sums hits and edges over cells, and keeps their sums and moments. */
#include "render/scattering/signatures/signature.h"

#include <stdlib.h>

_Static_assert(sizeof(SignatureCentre) == 84, "written to files as it is");

static const double path_phase_rad = 0.2, across_phase_rad = 0.2, spin_phase_rad = 1, weak_share = 0.01;
enum { weak_times = 4 };

SignatureCells signature_default_cells(double frequency_hz, double bandwidth_hz, double turn_rad, double interval_s)
{
    return (SignatureCells){.frequency_hz = frequency_hz,
                            .bandwidth_hz = bandwidth_hz,
                            .turn_rad = turn_rad,
                            .path_phase_rad = path_phase_rad,
                            .across_phase_rad = across_phase_rad,
                            .interval_s = interval_s,
                            .spin_phase_rad = spin_phase_rad,
                            .weak_share = weak_share,
                            .weak_times = weak_times};
}

/* Along the path phases are even up to path_rad at the ends of the band: a third of its square, over the band a third
 * of that; across, what first moments leave at the bin's edge. */
static double error_of(double path_rad, double across_rad)
{
    const double across = 0.4 * across_rad * across_rad;
    return path_rad * path_rad / 9 + across * across;
}

double signature_cells_error(void)
{
    return (1 - weak_share) * error_of(path_phase_rad, across_phase_rad) +
           weak_share * error_of(weak_times * path_phase_rad, weak_times * across_phase_rad);
}

void signature_axes(Signature *out, const SignatureCells *cells)
{
    double u[3];
    v3_scale(u, 1, out->tx.u);
    v3_add_scaled(u, u, 1, out->rx.u); /* towards between the two */
    v3_scale(u, 1 / fmax(v3_length(u), 1e-9), u);
    scatter_basis(out->right, out->up, u);
    out->frequency_hz = cells->frequency_hz;
    out->bandwidth_hz = cells->bandwidth_hz;
    /* half a cell from the middle, at the end of the band */
    out->path_step_m = fmin(2 * cells->path_phase_rad * light_mps / (pi_rad * fmax(cells->bandwidth_hz, 1)), 10);
}

void signature_free(Signature *s)
{
    free(s->centre);
    *s = (Signature){0};
}

/* ---- cells ------------------------------------------------------------------------------------------ */

/* Number of a cell along each axis; of half of the way from first to last point where antennas differ; of range
 * rate; the node; and how many times it is as wide as others. */
typedef struct Key {
    int32_t path, right, up, half_right, half_up, rate, node, times;
} Key;

typedef struct Cell {
    Key            key;
    double complex s[4], moment[2][4]; /* hh hv vh vv; moments about the cell's middle, right and up */
    double complex along[4];           /* and along the path */
    double         p[3], half[3], weight, strongest;
    double         square; /* sum of squares of amplitudes */
    int            bounce, part;
    bool           weak; /* left empty: what it held is in a wider one */
} Cell;

typedef struct CellTable {
    int      count, capacity, slots;
    Cell    *cell;
    int32_t *slot; /* of a hash table, a power of two long */
} CellTable;

static uint64_t mix(uint64_t x)
{
    x ^= x >> 31;
    x *= 0x7fb5d329728ea185u;
    x ^= x >> 27;
    x *= 0x81dadef4bc2dd44du;
    return x ^ x >> 33;
}

static uint64_t hash_of(const Key *key)
{
    const uint64_t a = (uint64_t)(uint32_t)key->path << 32 | (uint32_t)key->right;
    const uint64_t b = (uint64_t)(uint32_t)key->up << 32 | (uint32_t)key->node;
    const uint64_t c = (uint64_t)(uint32_t)key->half_right << 32 | (uint32_t)key->half_up;
    return mix(a ^ mix(b + 1 + mix(c + 2 + mix((uint64_t)(uint32_t)key->rate << 32 | (uint32_t)key->times))));
}

static Status rehash(CellTable *t)
{
    const int slots = t->slots ? 2 * t->slots : 4096;
    int32_t  *slot = realloc(t->slot, (size_t)slots * sizeof *slot);
    if (!slot) return STATUS_NO_MEMORY;
    t->slot = slot;
    t->slots = slots;
    memset(slot, 0xff, (size_t)slots * sizeof *slot);
    for (int i = 0; i < t->count; i++) {
        uint64_t at = hash_of(&t->cell[i].key) & (uint64_t)(slots - 1);
        while (slot[at] >= 0) at = (at + 1) & (uint64_t)(slots - 1);
        slot[at] = i;
    }
    return STATUS_OK;
}

/* A new one, all zero, where there is none. NULL: no memory. Valid until the next. */
static Cell *find(CellTable *t, const Key *key)
{
    if (2 * (t->count + 1) > t->slots && rehash(t) != STATUS_OK) return NULL;
    uint64_t at = hash_of(key) & (uint64_t)(t->slots - 1);
    for (; t->slot[at] >= 0; at = (at + 1) & (uint64_t)(t->slots - 1))
        if (memcmp(&t->cell[t->slot[at]].key, key, sizeof *key) == 0) return &t->cell[t->slot[at]];
    if (t->count == t->capacity) {
        const int capacity = t->capacity ? 2 * t->capacity : 1024;
        Cell     *larger = realloc(t->cell, (size_t)capacity * sizeof *larger);
        if (!larger) return NULL;
        t->cell = larger;
        t->capacity = capacity;
    }
    t->slot[at] = t->count;
    t->cell[t->count] = (Cell){.key = *key};
    return &t->cell[t->count++];
}

/* ---- what hits and edges add ------------------------------------------------------------------------ */

typedef struct Share {
    double         path_m, first[3], last[3];
    double complex s[4]; /* hh hv vh vv, without the phase of the path */
    double         amplitude;
    int            bounce, part;
} Share;

static void share_of_hit(Share *out, const TubeHits *h, size_t i, double k)
{
    double power = 0;
    out->path_m = h->path_m[i];
    for (int x = 0; x < 3; x++) {
        out->first[x] = (double)h->first[x][i];
        out->last[x] = (double)h->last[x][i];
    }
    /* the factor -j k / 2 pi, and the share of the footprint */
    const double share =
        k / (2 * pi_rad) * scatter_sinc(k * (double)h->slope_m[0][i]) * scatter_sinc(k * (double)h->slope_m[1][i]);
    for (int p = 0; p < 4; p++) {
        const double re = (double)h->amplitude[2 * p][i], im = (double)h->amplitude[2 * p + 1][i];
        out->s[p] = CMPLX(share * im, -share * re);
        power += re * re + im * im;
    }
    out->amplitude = fabs(share) * sqrt(0.5 * power);
    out->bounce = h->bounce[i];
    out->part = h->part[i];
}

static void share_of_edge(Share *out, const EdgeSegment *e, double k)
{
    double       power = 0;
    const double share = edge_fade(e, k) * scatter_sinc(0.5 * k * e->slope * e->length_m);
    out->path_m = e->path_m;
    memcpy(out->first, e->p, sizeof e->p);
    memcpy(out->last, e->p, sizeof e->p);
    for (int p = 0; p < 4; p++) {
        const double complex a = e->amplitude[p / 2][p % 2];
        out->s[p] = share * a;
        power += creal(a) * creal(a) + cimag(a) * cimag(a);
    }
    out->amplitude = fabs(share) * sqrt(0.5 * power);
    out->bounce = 0;
    out->part = e->part;
}

/* A signature while hits and edges are added to its cells. */
typedef struct SignatureBuilder {
    const Signature *signature;
    const Model     *model;
    double           k, across_m; /* side of a cell */
    double (*rate)[3];            /* [node_count]: how many cells of range rate it is per metre, body axes; 0: none */
    int       times;              /* SignatureCells.weak_times */
    bool      monostatic;
    CellTable table;
} SignatureBuilder;

static int32_t cell_number(double x_m, double side_m) { return (int32_t)clamp(floor(x_m / side_m), -1e9, 1e9); }

/* Sets how much centres vary over a cell: half a cell from the middle and half the bin away, both ways; for range rate,
 * half the interval away. */
static Status measure_cells(SignatureBuilder *builder, const RadarTarget *target, const SignatureCells *cells)
{
    static const double rolls_mps = 20, most_m = 0.1; /* so that what hides part of a target hides whole cells */
    const int           count = builder->model ? builder->model->node_count : 0;
    builder->across_m = fmin(2 * cells->across_phase_rad / fmax(builder->k * cells->turn_rad, 1e-9), most_m);
    builder->rate = calloc((size_t)count + 1, sizeof *builder->rate);
    if (!builder->rate) return STATUS_NO_MEMORY;
    double ahead[3];
    v3_add(ahead, builder->signature->tx.u, builder->signature->rx.u);
    for (int n = 0; n < count; n++) {
        double turning[3] = {0}, axis[3];
        for (int at = n; at >= 0; at = builder->model->node[at].parent) {
            const ModelNode *of = &builder->model->node[at];
            m3_mul_v3(axis, target->pose[at].r_body_from_node, of->axis);
            v3_add_scaled(turning, turning, of->roll_radius_m > 0 ? rolls_mps / of->roll_radius_m : of->spin_rps_moving,
                          axis);
        }
        v3_cross(builder->rate[n], turning, ahead); /* -(u_t + u_r) . (w x p), to within what is the same for all p */
        v3_scale(builder->rate[n], builder->k * cells->interval_s / (4 * cells->spin_phase_rad), builder->rate[n]);
    }
    return STATUS_OK;
}

/* Place of a share along the axes of cells, m. */
typedef struct Place {
    double middle[3], half[3], right_m, up_m;
} Place;

static void place_of(Place *out, const SignatureBuilder *builder, const Share *share)
{
    for (int x = 0; x < 3; x++) {
        out->middle[x] = 0.5 * (share->first[x] + share->last[x]);
        out->half[x] = 0.5 * (share->last[x] - share->first[x]);
    }
    out->right_m = v3_dot(out->middle, builder->signature->right);
    out->up_m = v3_dot(out->middle, builder->signature->up);
}

static Key key_of(const SignatureBuilder *builder, const Share *share, const Place *at, int times)
{
    const Signature *s = builder->signature;
    const int        node = builder->model ? builder->model->part[share->part].node : 0;
    const double     across_m = times * builder->across_m;
    return (Key){.path = cell_number(share->path_m, times * s->path_step_m),
                 .right = cell_number(at->right_m, across_m),
                 .up = cell_number(at->up_m, across_m),
                 .half_right = builder->monostatic ? 0 : cell_number(v3_dot(at->half, s->right), across_m),
                 .half_up = builder->monostatic ? 0 : cell_number(v3_dot(at->half, s->up), across_m),
                 .rate = cell_number(v3_dot(at->middle, builder->rate[node]), 1),
                 .node = node,
                 .times = times};
}

/* Before anything is added: how much there will be in each cell. */
static Status weigh(SignatureBuilder *builder, const Share *share)
{
    Place at;
    place_of(&at, builder, share);
    const Key key = key_of(builder, share, &at, 1);
    Cell     *c = find(&builder->table, &key);
    if (c) c->square += share->amplitude * share->amplitude;
    return c ? STATUS_OK : STATUS_NO_MEMORY;
}

static Status add(SignatureBuilder *builder, const Share *share)
{
    const Signature *s = builder->signature;
    Place            at;
    place_of(&at, builder, share);
    Key   key = key_of(builder, share, &at, 1);
    Cell *c = find(&builder->table, &key);
    if (c && c->weak) {
        key = key_of(builder, share, &at, builder->times);
        c = find(&builder->table, &key);
    }
    if (!c) return STATUS_NO_MEMORY;
    const double across_m = key.times * builder->across_m;
    const double along_m = share->path_m - (key.path + 0.5) * key.times * s->path_step_m, phase = -builder->k * along_m;
    const double complex turn = CMPLX(cos(phase), sin(phase));
    const double         arm_m[2] = {at.right_m - (key.right + 0.5) * across_m, at.up_m - (key.up + 0.5) * across_m};
    for (int p = 0; p < 4; p++) {
        const double complex v = share->s[p] * turn;
        c->s[p] += v;
        c->along[p] += along_m * v;
        for (int x = 0; x < 2; x++) c->moment[x][p] += arm_m[x] * v;
    }
    for (int x = 0; x < 3; x++) {
        c->p[x] += share->amplitude * at.middle[x];
        c->half[x] += share->amplitude * at.half[x];
    }
    c->weight += share->amplitude;
    if (share->amplitude > c->strongest) {
        c->strongest = share->amplitude;
        c->bounce = share->bounce;
        c->part = share->part;
    }
    return STATUS_OK;
}

/* ---- as kept ---------------------------------------------------------------------------------------- */

static double largest(const double complex v[4])
{
    double most = 0;
    for (int p = 0; p < 4; p++) most = fmax(most, fmax(fabs(creal(v[p])), fabs(cimag(v[p]))));
    return most;
}

/* False: nothing to keep. */
static bool keep(SignatureCentre *out, const SignatureBuilder *builder, const Cell *c)
{
    const Signature *s = builder->signature;
    if (!(c->weight > 0)) return false;
    *out = (SignatureCentre){.weight = (float)c->weight,
                             .strongest = (float)c->strongest,
                             .part = (uint16_t)c->part,
                             .bounce = (uint8_t)c->bounce};
    double p[3];
    for (int x = 0; x < 3; x++) {
        out->p[x] = (float)(c->p[x] / c->weight);
        out->half[x] = (float)(c->half[x] / c->weight);
        p[x] = (double)out->p[x];
    }
    /* the path whose phase over the band is the sum's, to first order */
    double turning = 0, power = 0;
    for (int q = 0; q < 4; q++) {
        turning += creal(conj(c->s[q]) * c->along[q]);
        power += creal(conj(c->s[q]) * c->s[q]);
    }
    const double wide = c->key.times, middle = wide * (c->key.path + 0.5); /* steps */
    const double mean =
        clamp(middle + (power > 0 ? turning / power / s->path_step_m : 0), middle - 0.5 * wide, middle + 0.5 * wide);
    out->path = (int32_t)floor(mean);
    out->path_share = (float)(mean - out->path);
    const double         back = builder->k * (out->path + (double)out->path_share - middle) * s->path_step_m;
    const double complex turn = CMPLX(cos(back), sin(back));
    double complex       sum[4];
    for (int q = 0; q < 4; q++) sum[q] = turn * c->s[q];
    /* moments about the mean point, as it is kept */
    const double   across_m = wide * builder->across_m;
    const double   arm_m[2] = {v3_dot(p, s->right) - (c->key.right + 0.5) * across_m,
                               v3_dot(p, s->up) - (c->key.up + 0.5) * across_m};
    double complex moment[2][4];
    for (int x = 0; x < 2; x++)
        for (int q = 0; q < 4; q++) moment[x][q] = turn * c->moment[x][q] - arm_m[x] * sum[q];
    out->scale = (float)largest(sum);
    out->moment_scale = (float)fmax(largest(moment[0]), largest(moment[1]));
    for (int q = 0; q < 4; q++) {
        const double scale = out->scale > 0 ? 32767 / (double)out->scale : 0;
        const double finer = out->moment_scale > 0 ? 127 / (double)out->moment_scale : 0;
        out->s[2 * q] = (int16_t)clamp(nearbyint(scale * creal(sum[q])), -32767, 32767);
        out->s[2 * q + 1] = (int16_t)clamp(nearbyint(scale * cimag(sum[q])), -32767, 32767);
        for (int x = 0; x < 2; x++) {
            out->moment[x][2 * q] = (int8_t)clamp(nearbyint(finer * creal(moment[x][q])), -127, 127);
            out->moment[x][2 * q + 1] = (int8_t)clamp(nearbyint(finer * cimag(moment[x][q])), -127, 127);
        }
    }
    return isfinite(out->scale) && isfinite(out->moment_scale) && isfinite(out->weight);
}

static int by_square(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Marks the weakest cells, which have `part` of all squares; of some that are alike, all or none. */
static Status mark_weak(SignatureBuilder *builder, double part)
{
    const int count = builder->table.count;
    double   *square = malloc((size_t)(count + 1) * sizeof *square), sum = 0, least = 0, below = 0;
    if (!square) return STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++) sum += square[i] = builder->table.cell[i].square;
    qsort(square, (size_t)count, sizeof *square, by_square);
    for (int i = 0; i < count && (below += square[i]) <= part * sum; i++) least = square[i];
    for (int i = 0; i < count; i++) {
        Cell *c = &builder->table.cell[i];
        c->weak = c->square <= least;
    }
    free(square);
    return STATUS_OK;
}

/* Visits all hits, then all edges. */
static Status each_share(SignatureBuilder *builder, const TotalField *field,
                         Status (*take)(SignatureBuilder *, const Share *))
{
    Share  share;
    Status status = STATUS_OK;
    for (size_t i = 0; i < field->hits.count && status == STATUS_OK; i++) {
        share_of_hit(&share, &field->hits, i, builder->k);
        status = take(builder, &share);
    }
    for (int i = 0; i < field->edges.count && status == STATUS_OK; i++) {
        share_of_edge(&share, &field->edges.segment[i], builder->k);
        status = take(builder, &share);
    }
    return status;
}

Status signature_make(Signature *out, const TotalField *field, const RadarTarget *target, const SignatureCells *cells)
{
    const TubeHits *h = &field->hits;
    signature_free(out);
    out->tx = h->tx;
    out->rx = h->rx;
    signature_axes(out, cells);
    SignatureBuilder builder = {.signature = out,
                                .model = target ? target->model : NULL,
                                .k = 2 * pi_rad * cells->frequency_hz / light_mps,
                                .times = cells->weak_times,
                                .monostatic = memcmp(&h->tx, &h->rx, sizeof h->tx) == 0};
    Status           status = measure_cells(&builder, target, cells);
    if (status == STATUS_OK && cells->weak_share > 0) status = each_share(&builder, field, weigh);
    if (status == STATUS_OK && cells->weak_share > 0) status = mark_weak(&builder, cells->weak_share);
    if (status == STATUS_OK) status = each_share(&builder, field, add);
    for (size_t i = 0; i < h->count && status == STATUS_OK; i++) {
        Share share;
        share_of_hit(&share, h, i, builder.k);
        out->tubes_same_m2 += 0.5 * (scatter_power(share.s[0]) + scatter_power(share.s[3]));
        out->tubes_cross_m2 += 0.5 * (scatter_power(share.s[1]) + scatter_power(share.s[2]));
    }
    out->centre = status == STATUS_OK ? malloc((size_t)(builder.table.count + 1) * sizeof *out->centre) : NULL;
    if (!out->centre) status = STATUS_NO_MEMORY;
    for (int i = 0; i < builder.table.count && status == STATUS_OK; i++)
        out->count += keep(&out->centre[out->count], &builder, &builder.table.cell[i]);
    free(builder.table.cell);
    free(builder.table.slot);
    free(builder.rate);
    if (status != STATUS_OK) signature_free(out);
    return status;
}

bool signature_is_sound(const Signature *s, int parts)
{
    if (!(s->tubes_same_m2 >= 0 && s->tubes_same_m2 < 1e18 && s->tubes_cross_m2 >= 0 && s->tubes_cross_m2 < 1e18))
        return false;
    for (int i = 0; i < s->count; i++) {
        const SignatureCentre *c = &s->centre[i];
        bool                   good = c->path > -1000000000 && c->path < 1000000000 && c->part < parts && c->zero == 0;
        for (int x = 0; x < 3; x++) good &= fabsf(c->p[x]) < 1e5f && fabsf(c->half[x]) < 1e5f;
        good &= c->path_share >= 0 && c->path_share <= 1 && c->scale >= 0 && c->scale < 1e9f && c->moment_scale >= 0 &&
                c->moment_scale < 1e9f;
        good &= c->weight > 0 && c->weight < 1e9f && c->strongest > 0 && c->strongest <= c->weight * 1.001f;
        if (!good) return false;
    }
    return true;
}
