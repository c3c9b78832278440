/* render/trace/ground/ground8.c: eight rays traverse the pyramid in SIMD lanes, each at its own node; a lane that is
 * done takes the next ray of the list. A step is the same for every lane, in two vectors of four; looking up posts,
 * the triangles of a cell and changes of ray are done a lane at a time.
 *
 * Cell numbers are doubles here: integers up to 2^16 are exact, and halving or doubling them too. */
#include "render/trace/ground/ground_private.h"

enum { lanes = 8 };

/* State of the lanes: all that a step reads and writes. */
typedef struct Walk {
    double u0[lanes], v0[lanes], w0[lanes], du[lanes], dv[lanes], dw[lanes], bend[lanes], per_du[lanes], per_dv[lanes];
    double east[lanes], north[lanes];    /* 1 where the ray goes that way, else 0 */
    double last_u[lanes], last_v[lanes]; /* last cell */
    double top[lanes], last_m[lanes], stop_m[lanes];
    double t_m[lanes], i[lanes], j[lanes];         /* now at this distance, in this cell */
    double k[lanes], size[lanes], per_size[lanes]; /* of the node: level, cells a side */
} Walk __attribute__((aligned(64)));

/* Results of half a step for four lanes. */
typedef struct Seen {
    F64x4 node_i, node_j, at_u, at_v, next_m;
    F64x4 clear; /* mask: above everything in the node */
} Seen;

/* Highest posts of four lanes' nodes. */
static inline F64x4 look_up(F64x4 node_i, F64x4 node_j, F64x4 k, const GroundLevel *const level[4])
{
    int32_t i[4], j[4], at[4], z[4];
    _mm_storeu_si128((__m128i *)i, _mm256_cvttpd_epi32(node_i));
    _mm_storeu_si128((__m128i *)j, _mm256_cvttpd_epi32(node_j));
    _mm_storeu_si128((__m128i *)at, _mm256_cvttpd_epi32(k));
    for (int l = 0; l < 4; l++)
        z[l] = at[l] > 0 ? ground_highest(level[l], at[l], i[l], j[l]) : ground_cell_highest(level[l], i[l], j[l]);
    return f64x4_of_ints(_mm_set_epi32(z[3], z[2], z[1], z[0]));
}

static inline Seen look(const Walk *w, int l, const GroundLevel *const level[4])
{
    const F64x4 t = f64x4_load(w->t_m + l), size = f64x4_load(w->size + l), per_size = f64x4_load(w->per_size + l);
    const F64x4 w0 = f64x4_load(w->w0 + l), dw = f64x4_load(w->dw + l), bend = f64x4_load(w->bend + l);
    Seen        s;
    s.node_i = f64x4_floor(f64x4_load(w->i + l) * per_size);
    s.node_j = f64x4_floor(f64x4_load(w->j + l) * per_size);
    const F64x4 highest = look_up(s.node_i, s.node_j, f64x4_load(w->k + l), level);
    s.at_u = ((s.node_i + f64x4_load(w->east + l)) * size - f64x4_load(w->u0 + l)) * f64x4_load(w->per_du + l);
    s.at_v = ((s.node_j + f64x4_load(w->north + l)) * size - f64x4_load(w->v0 + l)) * f64x4_load(w->per_dv + l);
    s.next_m = f64x4_min(f64x4_min(s.at_u, s.at_v), f64x4_load(w->last_m + l));
    const F64x4 lowest = f64x4_min(w0 + t * (dw - t * bend), w0 + s.next_m * (dw - s.next_m * bend));
    s.clear = f64x4_less(highest + f64x4_set(ground_clear_posts), lowest);
    return s;
}

/* Lanes selected by the mask step to the next node, and ascend where they leave a parent; the others descend.
 * Returns the bits of those that reached their end. */
static inline unsigned move(Walk *w, int l, const Seen *s, F64x4 on)
{
    const F64x4 t = s->next_m, one = f64x4_set(1), half = f64x4_set(0.5);
    const F64x4 k = f64x4_load(w->k + l);
    /* between the cells and the first level of the pyramid it is several levels at once */
    const F64x4 first = f64x4_set(elevation_pyramid_first);
    const F64x4 per_square = f64x4_set(1.0 / (1 << elevation_pyramid_first));
    const F64x4 cell = f64x4_at_most(k, f64x4_set(0)), above_cells = f64x4_at_most(k, first);
    const F64x4 share_up = f64x4_select(cell, per_square, half);
    const F64x4 share_down = f64x4_select(above_cells, per_square, half);
    const F64x4 n_u = (s->node_i + f64x4_load(w->east + l)) * share_up;
    const F64x4 n_v = (s->node_j + f64x4_load(w->north + l)) * share_up;
    const F64x4 even_u = f64x4_at_most(n_u, f64x4_floor(n_u)), even_v = f64x4_at_most(n_v, f64x4_floor(n_v));
    const F64x4 leaves =
        f64x4_or(f64x4_and(f64x4_at_most(s->at_u, t), even_u), f64x4_and(f64x4_at_most(s->at_v, t), even_v));
    const F64x4 up = f64x4_and(leaves, f64x4_less(k, f64x4_load(w->top + l)));
    const F64x4 i =
        cell_at(f64x4_load(w->u0 + l), f64x4_load(w->du + l), f64x4_load(w->per_du + l), t, f64x4_load(w->last_u + l));
    const F64x4 j =
        cell_at(f64x4_load(w->v0 + l), f64x4_load(w->dv + l), f64x4_load(w->per_dv + l), t, f64x4_load(w->last_v + l));

    f64x4_store(w->t_m + l, f64x4_select(on, t, f64x4_load(w->t_m + l)));
    f64x4_store(w->i + l, f64x4_select(on, i, f64x4_load(w->i + l)));
    f64x4_store(w->j + l, f64x4_select(on, j, f64x4_load(w->j + l)));
    const F64x4 k_up = f64x4_and(up, f64x4_select(cell, first, one));
    const F64x4 k_down = f64x4_select(above_cells, f64x4_set(-elevation_pyramid_first), f64x4_set(-1));
    const F64x4 square = f64x4_set(1 << elevation_pyramid_first), two = f64x4_set(2);
    const F64x4 times_up = f64x4_select(up, f64x4_select(cell, square, two), one);
    const F64x4 times_down = f64x4_select(above_cells, square, two);
    f64x4_store(w->k + l, k + f64x4_select(on, k_up, k_down));
    f64x4_store(w->size + l, f64x4_load(w->size + l) * f64x4_select(on, times_up, share_down));
    f64x4_store(w->per_size + l,
                f64x4_load(w->per_size + l) * f64x4_select(on, f64x4_select(up, share_up, one), times_down));
    return f64x4_bits(f64x4_and_not(on, f64x4_less(t, f64x4_load(w->stop_m + l))));
}

/* The rays still to be traced, and the ray of each lane. */
typedef struct Stream {
    const Ground        *ground;
    int                  count, next;
    const int           *list; /* indices; NULL: all */
    const double *const *o, *const *d;
    const double      *far_m, *from_m; /* from_m NULL: from the origins */
    double            *range_m;
    GroundHit         *hit;
    int                ray_of[lanes];
    const GroundLevel *level[lanes];
    GroundRay          ray[lanes];
} Stream;

static void put_piece(Walk *w, int l, const GroundLevel *g, const LevelRay *r, double start_m, double stop_m, int k)
{
    w->u0[l] = r->u0, w->v0[l] = r->v0, w->w0[l] = r->w0;
    w->du[l] = r->du, w->dv[l] = r->dv, w->dw[l] = r->dw, w->bend[l] = r->bend;
    w->per_du[l] = r->per_du, w->per_dv[l] = r->per_dv;
    w->east[l] = r->per_du > 0, w->north[l] = r->per_dv > 0;
    w->last_u[l] = g->cells_x - 1, w->last_v[l] = g->cells_y - 1;
    w->top[l] = g->top, w->last_m[l] = r->last_m, w->stop_m[l] = stop_m;
    w->t_m[l] = start_m;
    w->i[l] = ground_cell_at(r->u0, r->du, r->per_du, start_m, g->cells_x);
    w->j[l] = ground_cell_at(r->v0, r->dv, r->per_dv, start_m, g->cells_y);
    w->k[l] = k, w->size[l] = 1 << k, w->per_size[l] = 1 / w->size[l];
}

/* Loads the lane with its ray's next piece over a level, or with the next ray; false when there are no more. */
static bool refill(Stream *stream, Walk *w, int l)
{
    for (;;) {
        GroundRay *ray = &stream->ray[l];
        while (ray->piece < ray->piece_count) {
            const int          p = ray->piece++;
            const GroundLevel *g = &stream->ground->level[ray->level[p]];
            LevelRay          *r = &ray->of_level[ray->level[p]];
            double             start_m, stop_m;
            r->first_m = ray->first_m[p];
            r->last_m = ray->last_m[p];
            ground_walk(&start_m, &stop_m, g, r, stream->far_m[stream->ray_of[l]]);
            int k = ground_start_level(g, r);
            if (stream->from_m && stream->from_m[stream->ray_of[l]] > start_m) {
                start_m = stream->from_m[stream->ray_of[l]];
                k = elevation_pyramid_first;
            }
            if (!(start_m < stop_m)) continue;
            stream->level[l] = g;
            put_piece(w, l, g, r, start_m, stop_m, k);
            return true;
        }
        if (stream->next >= stream->count) return false;
        const int    m = stream->next++, n = stream->ray_of[l] = stream->list ? stream->list[m] : m;
        const double o[3] = {stream->o[0][n], stream->o[1][n], stream->o[2][n]};
        const double d[3] = {stream->d[0][n], stream->d[1][n], stream->d[2][n]};
        stream->range_m[n] = INFINITY;
        ground_ray(ray, stream->ground, o, d, stream->far_m[n]);
    }
}

/* Tests the triangles of a lane's cell. True: the ray is decided. */
static bool meets_cell(Stream *stream, const Walk *w, int l)
{
    GroundRay   *ray = &stream->ray[l];
    const int    level = ray->level[ray->piece - 1], n = stream->ray_of[l];
    const int    i = (int)w->i[l], j = (int)w->j[l];
    bool         north_west;
    const double range_m = ground_cell_hit(stream->level[l], &ray->of_level[level], i, j, &north_west);
    if (!(range_m < INFINITY)) return false;
    ray->piece = ray->piece_count;
    if (!(range_m < stream->far_m[n])) return true;
    stream->range_m[n] = range_m;
    if (stream->hit) stream->hit[n] = (GroundHit){.level = level, .i = i, .j = j, .north_west = north_west};
    return true;
}

void ground_first_hits_from(double *range_m, GroundHit *hit, const Ground *ground, int count,
                            const double *const o_enu[3], const double *const d_enu[3], const double *far_m,
                            const double *from_m, const int *list)
{
    if (ground->level_count == 0) {
        for (int n = 0; n < count; n++) range_m[list ? list[n] : n] = INFINITY;
        return;
    }
    Walk     w;
    Stream   stream = {.ground = ground,
                       .count = count,
                       .o = o_enu,
                       .d = d_enu,
                       .far_m = far_m,
                       .from_m = from_m,
                       .list = list,
                       .range_m = range_m,
                       .hit = hit};
    unsigned busy = 0;
    for (int l = 0; l < lanes; l++) {
        /* an idle lane is in the first cell of level 0 and its results are ignored */
        const GroundLevel *g = stream.level[l] = &ground->level[0];
        put_piece(&w, l, g, &(LevelRay){.per_du = 1, .per_dv = 1, .last_m = 1}, 0, 1, 0);
        if (refill(&stream, &w, l)) busy |= 1u << l;
    }
    while (busy) {
        const Seen     low = look(&w, 0, stream.level), high = look(&w, 4, stream.level + 4);
        const unsigned clear = f64x4_bits(low.clear) | f64x4_bits(high.clear) << 4;
        const unsigned down = f64x4_bits(f64x4_less(f64x4_set(0), f64x4_load(w.k))) |
                              f64x4_bits(f64x4_less(f64x4_set(0), f64x4_load(w.k + 4))) << 4;
        unsigned decided = 0, over;
        for (unsigned at_cell = busy & ~(clear | down); at_cell; at_cell &= at_cell - 1) {
            const int l = __builtin_ctz(at_cell);
            if (meets_cell(&stream, &w, l)) decided |= 1u << l;
        }
        /* a cell is the lowest level */
        over = move(&w, 0, &low, f64x4_or(low.clear, f64x4_at_most(f64x4_load(w.k), f64x4_set(0))));
        over |= move(&w, 4, &high, f64x4_or(high.clear, f64x4_at_most(f64x4_load(w.k + 4), f64x4_set(0)))) << 4;
        for (over = (over | decided) & busy; over; over &= over - 1) {
            const int l = __builtin_ctz(over);
            if (!refill(&stream, &w, l)) busy &= ~(1u << l);
        }
    }
}

void ground_first_hits(double *range_m, GroundHit *hit, const Ground *ground, int count, const double *const o_enu[3],
                       const double *const d_enu[3], const double *far_m)
{
    ground_first_hits_from(range_m, hit, ground, count, o_enu, d_enu, far_m, NULL, NULL);
}
