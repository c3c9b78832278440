/* render/scattering/clutter/foliage_fan.c: crowns by the directions in which they are seen from one place. */
#include "render/scattering/clutter/foliage_fan.h"

#include "render/scattering/clutter/foliage_private.h"

enum { side = 192, crowns_most = 1 << 18, listed_most = 1 << 22 };

/* A crown in one of its squares: in as many of these as squares list it. */
typedef struct FanCrown {
    double   p[3], over[2]; /* where the rays start, in half axes from its middle; 1 / half axis across, up */
    double   off;           /* |p|^2 less a little more than 1: the square of what the line may be off it at most */
    double   near_m;        /* no ray meets it before that */
    int      x, y;          /* square */
    uint8_t  surface;
    uint16_t low[2], high[2]; /* cells that it reaches into */
} FanCrown;

struct FoliageFan {
    const Foliage *foliage;
    FoliageFanOf   of;
    int            crowns;
    FanCrown      *crown;  /* [crowns]: by squares, row by row */
    uint32_t      *first;  /* [side * side + 1] */
    uint32_t      *listed; /* crowns of each cell, ascending */
};

/* ---- the cone's crowns ----------------------------------------------------------------------------- */

/* Squares that the cone lies over: those of the pyramid of its apex and the corners of its base. */
static void squares_of(int low[2], int high[2], const Foliage *f, const FoliageFanOf *of)
{
    const int count[2] = {f->nx, f->ny};
    for (int k = 0; k < 2; k++) {
        const double apex = of->o_enu[k] - f->origin_enu[k];
        double       least = apex, most = apex;
        for (int corner = 0; corner < 4; corner++) {
            const double right = corner % 2 ? of->half : -of->half, down = corner / 2 ? of->half : -of->half;
            const double at = apex + of->far_m * (of->axis[2][k] + right * of->axis[0][k] + down * of->axis[1][k]);
            least = fmin(least, at), most = fmax(most, at);
        }
        low[k] = foliage_square_at(least - 1, f->side_m, count[k]);
        high[k] = foliage_square_at(most + 1, f->side_m, count[k]);
    }
}

/* Whether rays of the cone may meet a crown, and in which cells.
 *
 * Along an axis of the picture plane the crown's outline is within that of a circle about its middle in the plane of
 * this axis and the cone's: its radius is the most that a spheroid reaches in a direction of that plane, and a little
 * more for rounding. Its tangents through the start have the slopes (e z -+ r sqrt(e^2 + z^2 - r^2)) / (z^2 - r^2). */
static bool find_cells(FanCrown *out, const FoliageFanOf *of, const FoliageCrown *c, const double to[3])
{
    const double z = v3_dot(of->axis[2], to), across = (double)c->across_m, up = (double)c->up_m;
    const double tall = fmax(up * up - across * across, 0), most = fmax(across, up);
    if (v3_length(to) > of->far_m + 1.001 * most || z < -1.001 * most) return false;
    for (int a = 0; a < 2; a++) {
        const double *axis = of->axis[a], *ahead = of->axis[2], e = v3_dot(axis, to);
        const double  upright = fmin(axis[2] * axis[2] + ahead[2] * ahead[2], 1);
        const double  r = 1.001 * sqrt(across * across + tall * upright) + 1e-3;
        out->low[a] = 0, out->high[a] = side - 1;
        if (fabs(e) - of->half * z > r * sqrt(1 + of->half * of->half)) return false; /* beyond a side of the cone */
        if (z <= r) continue; /* beside the start or around it */
        const double root = sqrt(fmax(e * e + z * z - r * r, 0)), below = z * z - r * r;
        const double least = (e * z - r * root) / below, last = (e * z + r * root) / below;
        if (!(least < of->half && last > -of->half)) return false;
        const double cells = 0.5 * side / of->half;
        out->low[a] = (uint16_t)clamp(floor((least + of->half) * cells), 0, side - 1);
        out->high[a] = (uint16_t)clamp(floor((last + of->half) * cells), 0, side - 1);
    }
    return true;
}

static bool find_crowns(FoliageFan *fan, Arena *arena)
{
    const Foliage *f = fan->foliage;
    int            low[2], high[2];
    size_t         count = 0;
    double         start[3];
    squares_of(low, high, f, &fan->of);
    for (int y = low[1]; y <= high[1]; y++) {
        const size_t row = (size_t)y * (size_t)f->nx;
        count += f->first[row + (size_t)high[0] + 1] - f->first[row + (size_t)low[0]];
    }
    if (count > crowns_most) return false;
    fan->crown = arena_alloc_raw(arena, count + 1, sizeof *fan->crown);
    if (!fan->crown) return false;
    for (int k = 0; k < 3; k++) start[k] = fan->of.o_enu[k] - f->origin_enu[k];
    for (int y = low[1]; y <= high[1]; y++)
        for (int x = low[0]; x <= high[0]; x++) {
            const size_t s = (size_t)y * (size_t)f->nx + (size_t)x;
            for (uint32_t at = f->first[s]; at < f->first[s + 1]; at++) {
                const FoliageCrown *c = &f->crown[f->listed[at]];
                FanCrown           *to = &fan->crown[fan->crowns];
                double              away[3];
                for (int k = 0; k < 3; k++) away[k] = (double)c->centre_m[k] - start[k];
                if (!find_cells(to, &fan->of, c, away)) continue;
                to->over[0] = 1 / (double)c->across_m, to->over[1] = 1 / (double)c->up_m;
                for (int k = 0; k < 3; k++) to->p[k] = (start[k] - (double)c->centre_m[k]) * to->over[k / 2];
                to->near_m = v3_length(away) - 1.001 * fmax((double)c->across_m, (double)c->up_m) - 1e-3;
                to->off = v3_dot(to->p, to->p) - 1.001;
                to->x = x, to->y = y, to->surface = c->surface;
                fan->crowns++;
            }
        }
    return true;
}

/* ---- lists ------------------------------------------------------------------------------------------- */

static bool list_crowns(FoliageFan *fan, Arena *arena)
{
    size_t sum = 0;
    fan->first = arena_alloc(arena, side * side + 1, sizeof *fan->first);
    if (!fan->first) return false;
    uint32_t *next = fan->first + 1; /* next[c]: where cell c is filled next, and so ends up at its end */
    for (int i = 0; i < fan->crowns; i++) {
        const FanCrown *c = &fan->crown[i];
        sum += (size_t)(c->high[0] - c->low[0] + 1) * (size_t)(c->high[1] - c->low[1] + 1);
        if (sum > listed_most) return false;
        for (int y = c->low[1]; y <= c->high[1]; y++)
            for (int x = c->low[0]; x <= c->high[0]; x++) next[y * side + x]++;
    }
    fan->listed = arena_alloc_raw(arena, sum + 1, sizeof *fan->listed);
    if (!fan->listed) return false;
    uint32_t before = 0;
    for (int cell = 0; cell < side * side; cell++) {
        const uint32_t here = next[cell];
        next[cell] = before;
        before += here;
    }
    for (int i = 0; i < fan->crowns; i++) {
        const FanCrown *c = &fan->crown[i];
        for (int y = c->low[1]; y <= c->high[1]; y++)
            for (int x = c->low[0]; x <= c->high[0]; x++) fan->listed[next[y * side + x]++] = (uint32_t)i;
    }
    return true;
}

void foliage_fan_create(FoliageFan **out, const Foliage *foliage, const FoliageFanOf *of, Arena *arena)
{
    *out = NULL;
    if (!(of->half > 0 && of->half <= 1 && of->far_m > 0 && of->far_m < 1e6) || foliage->count == 0) return;
    FoliageFan *fan = arena_alloc(arena, 1, sizeof *fan);
    if (!fan) return;
    fan->foliage = foliage;
    fan->of = *of;
    if (find_crowns(fan, arena) && list_crowns(fan, arena)) *out = fan;
}

bool foliage_fan_is_from(const FoliageFan *fan, const double o_enu[3])
{
    return fan && memcmp(fan->of.o_enu, o_enu, sizeof fan->of.o_enu) == 0;
}

/* ---- along a ray --------------------------------------------------------------------------------------- */

/* The cell of a direction. False: it is not in the cone. */
static bool cell_of(int *cell, const FoliageFanOf *of, const double d_enu[3])
{
    const double ahead = v3_dot(of->axis[2], d_enu), cells = 0.5 * side / of->half;
    const double right = v3_dot(of->axis[0], d_enu) / ahead, down = v3_dot(of->axis[1], d_enu) / ahead;
    if (!(ahead > 0 && fabs(right) < of->half && fabs(down) < of->half)) return false;
    const int x = (int)((right + of->half) * cells), y = (int)((down + of->half) * cells);
    *cell = (y < side ? y : side - 1) * side + (x < side ? x : side - 1);
    return true;
}

/* The square at hand, and the part of the ray in it. */
typedef struct FanSquare {
    int     x, y, first, last, west, east; /* first, last: rows that the ray passes; west, east: squares of row y */
    bool    in_row, in_square;
    Stretch here;
} FanSquare;

/* Whether a ray passes a crown's square, below its highest crown. */
static bool passes_square(FanSquare *at, const FoliageFan *fan, const Stretch *ray, const FanCrown *c)
{
    if (c->y != at->y) {
        at->y = c->y, at->x = -1;
        at->in_row =
            c->y >= at->first && c->y <= at->last && stretch_columns(&at->west, &at->east, fan->foliage, ray, c->y);
    }
    if (!at->in_row || c->x < at->west || c->x > at->east) return false;
    if (c->x != at->x) {
        at->x = c->x;
        at->in_square = stretch_in_square(&at->here, fan->foliage, ray, c->x, c->y);
    }
    return at->in_square;
}

double foliage_fan_loss_db(const FoliageFan *fan, const double d_enu[3], double range_m)
{
    const Foliage *f = fan->foliage;
    double         depth[SURFACE_COUNT] = {0};
    Stretch        ray;
    FanSquare      at = {.x = -1, .y = -1};
    int            cell;
    if (!(range_m <= fan->of.far_m) || !cell_of(&cell, &fan->of, d_enu))
        return foliage_loss_db(NULL, f, fan->of.o_enu, d_enu, range_m);
    if (!stretch_open(&ray, f, fan->of.o_enu, d_enu, range_m)) return 0;
    stretch_rows(&at.first, &at.last, f, &ray);
    for (uint32_t i = fan->first[cell]; i < fan->first[cell + 1]; i++) {
        const FanCrown *c = &fan->crown[fan->listed[i]];
        if (c->near_m > ray.to_m) continue;
        const double d[3] = {ray.d[0] * c->over[0], ray.d[1] * c->over[0], ray.d[2] * c->over[1]};
        const double along = v3_dot(c->p, d);
        double       middle_m, half_m;
        if (c->off * v3_dot(d, d) > along * along || !line_meets_crown(&middle_m, &half_m, c->p, d)) continue;
        /* a part is no longer than the whole */
        if (!(stretch_within(middle_m, half_m, ray.from_m, ray.to_m) > 0) || !passes_square(&at, fan, &ray, c))
            continue;
        depth[c->surface] += stretch_within(middle_m, half_m, at.here.from_m, at.here.to_m);
    }
    return foliage_db_of(NULL, f, depth);
}
