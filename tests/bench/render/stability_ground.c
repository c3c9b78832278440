/* tests/bench/render/stability_ground.c: rays against a ground of cliffs, pits and spikes of one post, exactly along
 * its posts, lines and diagonals, from on it and under it.
 *
 * The reference follows a ray over every line of posts and every diagonal, in long double: over each triangle its
 * height above the surface is linear, so the sign at each crossing is sufficient. It skips nothing and orders the
 * crossings by sorting. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "render/trace/ground/ground.h"

#include <stdlib.h>

enum { side_most = 97, crossings_most = 6 * side_most + 8, kinds = 10 };

typedef struct Field {
    Elevation elevation;
    Ground    ground;
    int       shape, side; /* posts a side */
    double    spacing_m;
} Field;

/* The last four: four tiles of different bases and shifts, of posts 0.1 m and 100 m apart; as rough as the tile's range
 * allows, or with walls of 500 m from one post to the next, along the edges of tiles too. */
enum {
    shape_rough,
    shape_flat,
    shape_spikes,
    shape_cliffs,
    shape_plane,
    shapes,
    shape_tiles = shapes,
    shape_wide_tiles,
    shape_walls,
    shape_wide_walls,
    shapes_all
};

static int32_t tile_post(int shape, int i, int j, Dice *dice)
{
    const int tile = i / elevation_tile_cells + 2 * (j / elevation_tile_cells);
    if (shape >= shape_walls) return 8192 + 256000 * ((i / 16 + j / 32) % 2) + (tile == 3 ? 4000 * ((i + j) % 5) : i);
    return (int32_t)stress_uniform(dice, 0, 1 << (8 + 3 * tile)) + 100000 * tile;
}

/* Opens a field. Spacings and steps of its one range are powers of two, so posts are exact, and so are rays along them.
 */
static bool field_open(Field *f, int shape, double x0_m, double y0_m)
{
    static int32_t post[side_most * side_most];
    Dice           dice = {.stream = 100 + (uint32_t)shape};
    const bool     tiles = shape >= shapes;
    *f = (Field){.shape = shape, .side = tiles ? side_most : 33, .spacing_m = 4};
    if (tiles) f->spacing_m = (shape - shapes) % 2 ? 100 : 0.1;
    const int side = f->side;
    if (elevation_level_create(&f->elevation, 0,
                               &(ElevationGrid){side, side, x0_m, y0_m, f->spacing_m, -64, tiles ? 0x1p-9 : 0x1p-5}) !=
        STATUS_OK)
        return false;
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            int32_t *p = &post[j * side + i];
            switch (shape) {
            case shape_rough:
                *p = (int32_t)stress_uniform(&dice, 2000, 2300);
                break;
            case shape_flat:
                *p = 2048;
                break;
            case shape_spikes:
                *p = (i % 5 == 2 && j % 5 == 2) ? (i + j) % 2 ? 65535 : 0 : 2048;
                break;
            case shape_cliffs:
                *p = (i / 4 + j / 6) % 2 ? 2048 : 40000;
                break;
            case shape_plane:
                *p = 2048 + 16 * i + 8 * j;
                break;
            default:
                *p = tile_post(shape, i, j, &dice);
                break;
            }
        }
    if (elevation_fill(&f->elevation.level[0], post) != STATUS_OK) return false;
    elevation_build_pyramids(&f->elevation);
    ground_prepare(&f->ground, &f->elevation);
    return true;
}

static double post_m(const Field *f, int i, int j) { return elevation_post_m(&f->elevation.level[0], i, j); }

/* Makes a ray of one of ten degenerate kinds. */
static void field_ray(double o[3], double d[3], const Field *f, Dice *dice, int kind)
{
    const ElevationLevel *e = &f->elevation.level[0];
    const double          s = f->spacing_m;
    const int             i = (int)stress_uniform(dice, 1, f->side - 1), j = (int)stress_uniform(dice, 1, f->side - 1);
    const double          to[3] = {e->x0_m + s * i, e->y0_m + s * j, post_m(f, i, j)};
    stress_direction(d, dice);
    for (int c = 0; c < 3; c++) o[c] = to[c];
    const double sign = stress_uniform(dice, 0, 1) < 0.5 ? -1 : 1;
    const int    axis = stress_uniform(dice, 0, 1) < 0.5;
    switch (kind) {
    case 0: /* down, anywhere */
        d[2] = -fabs(d[2]);
        v3_add_scaled(o, to, -stress_log_uniform(dice, 1, 5000), d);
        o[0] += stress_uniform(dice, -s, s);
        break;
    case 1: /* exactly at a post */
        d[2] = -fabs(d[2]);
        v3_add_scaled(o, to, -stress_log_uniform(dice, 1, 300), d);
        break;
    case 2: /* straight down on a post, a line, or a face */
        d[0] = d[1] = 0, d[2] = -1;
        o[0] += i % 2 ? 0 : stress_uniform(dice, 0, s), o[1] += j % 2 ? 0 : stress_uniform(dice, 0, s), o[2] += 3000;
        break;
    case 3: /* straight up, from below and above */
        d[0] = d[1] = 0, d[2] = 1;
        o[2] += stress_uniform(dice, -5, 5);
        break;
    case 4: /* along a line of posts, level, at a post's own height or a hair off */
        d[0] = d[1] = d[2] = 0, d[axis] = sign;
        o[2] += (i % 3 - 1) * 1e-6;
        break;
    case 5: /* along a diagonal, level */
        d[0] = sign * sqrt(0.5), d[1] = sign * sqrt(0.5), d[2] = 0;
        o[2] += (i % 3 - 1) * 1e-6;
        break;
    case 6: /* along a line of posts, grazing */
        d[axis] = sign, d[!axis] = 0, d[2] = -stress_log_uniform(dice, 1e-9, 1e-2);
        v3_normalize(d, d);
        v3_add_scaled(o, to, -stress_log_uniform(dice, 1, 100), d);
        break;
    case 7: /* from on the ground */
        break;
    case 8: /* from under it, or beside the field */
        o[2] -= stress_log_uniform(dice, 1e-6, 100);
        if (i % 2) o[axis] += sign * 1000, v3_scale(d, -1, d);
        break;
    default: /* grazing, anywhere */
        d[2] = stress_uniform(dice, -1e-3, 1e-3);
        v3_normalize(d, d);
        o[2] += stress_uniform(dice, -0.5, 0.5);
        break;
    }
}

static int by_size(const void *a, const void *b)
{
    const long double x = *(const long double *)a, y = *(const long double *)b;
    return (x > y) - (x < y);
}

/* Height above the surface, on the triangle of elevation.h; cells of the outline are extended a little beyond it. */
static long double clearance(const Field *f, const double o[3], const double d[3], long double t)
{
    const ElevationLevel *e = &f->elevation.level[0];
    const long double     s = f->spacing_m;
    const int             side = f->side;
    const long double     u = (o[0] - (long double)e->x0_m + t * d[0]) / s;
    const long double     v = (o[1] - (long double)e->y0_m + t * d[1]) / s;
    int                   i = (int)floorl(u), j = (int)floorl(v);
    i = i < 0 ? 0 : i > side - 2 ? side - 2 : i;
    j = j < 0 ? 0 : j > side - 2 ? side - 2 : j;
    const long double a = u - i, b = v - j, sw = post_m(f, i, j), se = post_m(f, i + 1, j), nw = post_m(f, i, j + 1),
                      ne = post_m(f, i + 1, j + 1);
    return o[2] + t * d[2] - (a >= b ? sw + a * (se - sw) + b * (ne - se) : sw + a * (ne - nw) + b * (nw - sw));
}

typedef struct Judged {
    long double may_m, must_m; /* the first point where it may be met, and where it must; INFINITY: none */
} Judged;

/* On surfaces of 1000:1 a rounding of the position is this much height; within plus and minus this either result is
 * correct. On the walls of 500 m between posts 0.1 m apart, 5000:1, a position of 5 km (4e-12 m) is twice as much. */
static const long double hair_plain_m = 1e-8L, hair_walls_m = 2e-8L;

static Judged judge(const Field *f, const double o[3], const double d[3])
{
    const ElevationLevel *e = &f->elevation.level[0];
    const long double     s = f->spacing_m, hair_m = f->shape == shape_walls ? hair_walls_m : hair_plain_m;
    const int             side = f->side;
    long double           t[crossings_most + 2], in = 0, out = 1e7L;
    int                   n = 0;
    Judged                judged = {INFINITY, INFINITY};
    for (int c = 0; c < 2; c++) { /* over the field */
        const long double p = o[c] - (long double)(c ? e->y0_m : e->x0_m), last = s * (side - 1);
        if (d[c] == 0) {
            if (p < 0 || p > last) return judged;
            continue;
        }
        const long double a = (0 - p) / d[c], b = (last - p) / d[c];
        in = fmaxl(in, fminl(a, b));
        out = fminl(out, fmaxl(a, b));
    }
    if (!(in < out)) return judged;
    t[n++] = in, t[n++] = out;
    for (int k = -side; k <= side; k++) {
        const long double at[3] = {
            (e->x0_m + s * k - (long double)o[0]) / d[0], (e->y0_m + s * k - (long double)o[1]) / d[1],
            (s * k - ((o[0] - (long double)e->x0_m) - (o[1] - (long double)e->y0_m))) / ((long double)d[0] - d[1])};
        for (int c = 0; c < 3; c++)
            if (at[c] > in && at[c] < out && n < crossings_most) t[n++] = at[c];
    }
    qsort(t, (size_t)n, sizeof *t, by_size);
    for (int k = 0; k < n; k++) {
        /* a cliff of a line's width is on both of its sides */
        const long double off = 1e-12L,
                          c = fminl(clearance(f, o, d, fmaxl(in, t[k] - off)), clearance(f, o, d, t[k] + off));
        const long double before = k > 0 ? clearance(f, o, d, t[k - 1]) : c;
        if (c <= hair_m && judged.may_m == INFINITY)
            judged.may_m =
                k > 0 && before > hair_m ? t[k - 1] + (t[k] - t[k - 1]) * ((before - hair_m) / (before - c)) : t[k];
        if (c < -hair_m) {
            judged.must_m =
                k > 0 && before > -hair_m ? t[k - 1] + (t[k] - t[k - 1]) * ((before + hair_m) / (before - c)) : t[k];
            break;
        }
    }
    return judged;
}

enum { count_missed, count_invented, count_flat };

static double field(bool quick, int want, int from, int to)
{
    Dice   dice = {.stream = 20};
    double missed = 0, invented = 0;
    for (int shape = from; shape < to; shape++) {
        Field f;
        if (!field_open(&f, shape, -64, -64)) return INFINITY;
        for (int n = 0; n < (quick ? 3000 : 60000); n++) {
            double o[3], d[3];
            field_ray(o, d, &f, &dice, n % kinds);
            const Judged      judged = judge(&f, o, d);
            const double      got_m = ground_first_hit(NULL, &f.ground, o, d, INFINITY);
            const long double room_m = 1e-9L + 1e-14L * v3_length(o);
            missed += judged.must_m < INFINITY && !(got_m <= judged.must_m + room_m);
            invented += isnan(got_m) || (got_m < INFINITY && !(got_m >= judged.may_m - room_m));
        }
        elevation_destroy(&f.elevation);
    }
    return want == count_missed ? missed : invented;
}

static double field_missed(void *user, bool quick)
{
    (void)user;
    return field(quick, count_missed, 0, shapes);
}
static double field_invented(void *user, bool quick)
{
    (void)user;
    return field(quick, count_invented, 0, shapes);
}
static double tiles_missed(void *user, bool quick)
{
    (void)user;
    return field(quick, count_missed, shapes, shapes_all);
}

static double tiles_invented(void *user, bool quick)
{
    (void)user;
    return field(quick, count_invented, shapes, shapes_all);
}

/* Traces the same rays eight at a time and as a tile, and counts the bits, cells and halves that differ. */
static double field_company(void *user, bool quick)
{
    enum { block = 1000 };
    static double    o[3][block], d[3][block], far_m[block], range_m[2][block];
    static GroundHit hit[2][block];
    Dice             dice = {.stream = 21};
    double           wrong = 0;
    (void)user;
    for (int round = 0; round < (quick ? 2 : 20) * shapes_all; round++) {
        Field f;
        if (!field_open(&f, round % shapes_all, -64, -64)) return INFINITY;
        for (int n = 0; n < block; n++) {
            double from[3], way[3];
            field_ray(from, way, &f, &dice, n % kinds);
            if (n % 97 == 0) way[n % 3] = NAN;
            if (n % 101 == 0) from[n % 3] = 1e300;
            for (int c = 0; c < 3; c++) o[c][n] = from[c], d[c][n] = way[c];
            far_m[n] = n % 4 ? INFINITY : stress_log_uniform(&dice, 0.1, 1000);
        }
        const double *const from[3] = {o[0], o[1], o[2]}, *const way[3] = {d[0], d[1], d[2]};
        ground_first_hits(range_m[0], hit[0], &f.ground, block, from, way, far_m);
        ground_first_hits_together(range_m[1], hit[1], &f.ground, block, from, way, far_m);
        for (int n = 0; n < block; n++) {
            const double p[3] = {o[0][n], o[1][n], o[2][n]}, q[3] = {d[0][n], d[1][n], d[2][n]};
            GroundHit    alone;
            const double alone_m = ground_first_hit(&alone, &f.ground, p, q, far_m[n]);
            for (int k = 0; k < 2; k++) {
                const GroundHit *h = &hit[k][n];
                wrong += memcmp(&alone_m, &range_m[k][n], sizeof alone_m) != 0 ||
                         (alone_m < INFINITY && (h->level != alone.level || h->i != alone.i || h->j != alone.j ||
                                                 h->north_west != alone.north_west));
            }
        }
        elevation_destroy(&f.elevation);
    }
    return wrong;
}

/* Moves the field 200 km from the terrain's origin, by a whole number of its lines, and the same rays with it. An eye
 * there is rounded to 3e-11 m, which a face a thousandth of a radian from edge-on makes 3e-8 m of range. */
static double far_fields(void *user, bool quick)
{
    static const double away_m[2] = {131072, -163840};
    Dice                dice = {.stream = 22};
    double              worst_m = 0;
    Field               near, far;
    (void)user;
    if (!field_open(&near, shape_rough, -64, -64) || !field_open(&far, shape_rough, -64 + away_m[0], -64 + away_m[1]))
        return INFINITY;
    for (int n = quick ? 20000 : 200000; n > 0; n--) {
        double o[3], d[3];
        field_ray(o, d, &near, &dice, 0);
        if (!(d[2] < -0.2)) continue;
        o[1] += stress_uniform(&dice, -4, 4); /* exactly over a ridge rounding decides between before and behind */
        const double moved[3] = {o[0] + away_m[0], o[1] + away_m[1], o[2]};
        const double a_m = ground_first_hit(NULL, &near.ground, o, d, INFINITY);
        const double b_m = ground_first_hit(NULL, &far.ground, moved, d, INFINITY);
        const double error_m = a_m == b_m ? 0 : fabs(a_m - b_m);
        if (!(error_m <= worst_m)) worst_m = error_m;
    }
    elevation_destroy(&near.elevation);
    elevation_destroy(&far.elevation);
    return worst_m;
}

/* Joins two levels that meet exactly, and sends rays down on posts and outline and up to the horizon's last line.
 * Nothing may fall through. */
static double seams(void *user, bool quick)
{
    enum { side = 33 };
    Elevation e = {0};
    Ground    ground;
    Dice      dice = {.stream = 23};
    double    worst_m = 0;
    (void)user;
    if (elevation_level_create(&e, 0, &(ElevationGrid){side, side, -64, -64, 4, 0, 0.0625}) != STATUS_OK ||
        elevation_level_create(&e, 1, &(ElevationGrid){side, side, -1024, -1024, 64, 0, 0.0625}) != STATUS_OK)
        return INFINITY;
    for (int k = 0; k < 2; k++) /* one slope through both, so that the outline is on straight edges */
        for (int j = 0; j < side; j++)
            for (int i = 0; i < side; i++)
                elevation_set_post(&e.level[k], i, j, 8192 + (k ? 64 : 4) * (2 * i + j) - (k ? 3 * 1024 : 3 * 64));
    elevation_build_pyramids(&e);
    ground_prepare(&ground, &e);
    for (int n = quick ? 20000 : 200000; n > 0; n--) {
        const double step_m = n % 2 ? 4 : 0.5, x_m = step_m * floor(stress_uniform(&dice, -70, 70) * 4 / step_m);
        const double y_m = n % 3 ? step_m * floor(stress_uniform(&dice, -70, 70) * 4 / step_m) : n % 2 ? -64 : 64;
        const double o[3] = {x_m, y_m, 1000}, down[3] = {0, 0, -1};
        const double want_m = 1000 - (512 + (2 * x_m + y_m) / 16);
        const double error_m = fabs(ground_first_hit(NULL, &ground, o, down, INFINITY) - want_m);
        if (!(error_m <= worst_m)) worst_m = error_m;
    }
    elevation_destroy(&e);
    return worst_m;
}

Status bench_stability_ground(Bench *bench)
{
    static const StressCase cases[] = {
        {"ground: rough, flat, spikes, cliffs, on posts and lines: missed", field_missed, 0, "rays",
         "every post line in long double"},
        {"ground: the same: invented", field_invented, 0, "rays", "every post line in long double"},
        {"ground: tiles of several shifts, walls of 500 m, posts of 0.1 and 100 m: missed", tiles_missed, 0, "rays",
         "every post line in long double"},
        {"ground: the same tiles: invented", tiles_invented, 0, "rays", "every post line in long double"},
        {"ground: all of these: by eights and by tiles", field_company, 0, "rays", "one by one, to the bit"},
        {"ground: 200 km from the origin", far_fields, 1e-7, "m", "the same about the origin"},
        {"ground: along the seam of two levels", seams, 1e-9, "m", "one slope through both"},
    };
    stress_cases(bench, cases, sizeof cases / sizeof *cases, NULL);
    return STATUS_OK;
}
