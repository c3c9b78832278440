/* tests/bench/render/stability_built.c: walls to a radar, under stress: faces without area, needles, seen along their
 * plane, with the antenna on them, behind them or beneath the ground, and from a metre to a million kilometres. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"

#include "render/scattering/built/facade_echo.h"

static const FacadeRow    row = {.scattered = {0.3, 0.3, 0.3}, .hv = 0.1, .uneven_m = 2e-3, .uneven_length_m = 0.5};
static const RadarSurface brick = {.kind = RADAR_HALF_SPACE, .eps = 3.91 - 0.02 * I, .rough_m = 5e-4};

typedef struct Looks {
    Facade     facade;
    FacadeLook look;
    double     wrong, area_m2, power_m2;
    int        pieces;
} Looks;

static void look_at_piece(void *user, const Piece *piece)
{
    static const GroundSurface road = {.eps = 4 - 0.2 * I, .rms_m = 1e-3};
    static const double        origin[3] = {0, 0, -1}, up[3] = {0, 0, 1};
    Looks                     *l = user;
    ScatterMatrix              s;
    FacadeGround               ground;
    l->pieces++;
    l->area_m2 += piece->area_m2;
    facade_echo(&s, &l->facade, piece, &l->look, true);
    const double power_m2 = scatter_power(s.hh) + scatter_power(s.hv) + scatter_power(s.vh) + scatter_power(s.vv);
    l->wrong += !isfinite(power_m2);
    l->power_m2 += power_m2;
    if (!facade_ground(&ground, &l->facade, piece, &l->look, origin, up)) return;
    facade_by_ground(&s, &l->facade, piece, &l->look, &ground, &road);
    l->wrong += !isfinite(scatter_power(s.hh) + scatter_power(s.hv) + scatter_power(s.vh) + scatter_power(s.vv));
}

static void look_from(Looks *l, const double from[3], double f_hz)
{
    static const double right[3] = {1, 0, 0};
    l->look = (FacadeLook){.frequency_hz = f_hz, .k = 2 * pi_rad * f_hz / light_mps, .band = CLUTTER_KA};
    memcpy(l->look.p_enu, from, sizeof l->look.p_enu);
    memcpy(l->look.right, right, sizeof l->look.right);
}

/* Faces of no area, needles, slivers across an axis, upright, level and any: values that are not finite, and areas that
 * are not the triangle's. */
static double faces(void *user, bool quick)
{
    Dice   dice = {.stream = 93};
    double wrong = 0;
    (void)user;
    for (int n = 0; n < (quick ? 40 : 400); n++) {
        double corner[3][3], from[3];
        Looks  l = {.facade = {.row = &row, .surface = brick, .bumps = (uint64_t)n, .number = 1}};
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++) corner[v][c] = stress_uniform(&dice, -3, 3);
        if (n % 6 == 1) memcpy(corner[2], corner[1], sizeof corner[2]);
        if (n % 6 == 2) v3_add_scaled(corner[2], corner[1], 1e-9, corner[0]);
        if (n % 6 == 3)
            for (int v = 0; v < 3; v++) corner[v][2] = 1e-12 * v;
        if (n % 6 == 4)
            for (int v = 0; v < 3; v++) corner[v][n % 2] = 0.25;
        for (int c = 0; c < 3; c++) from[c] = stress_uniform(&dice, -50, 50);
        look_from(&l, from, 35e9);
        const double area_m2 = piece_plane(&l.facade.plane, (const double(*)[3])corner);
        if (!(area_m2 > 0)) continue;
        pieces_cut(&l.facade.plane, (const double(*)[3])corner, (const double[2]){0.25, 0.125}, look_at_piece, &l);
        /* slivers under 1e-6 of a cell are left out: some hundred of them */
        wrong += l.wrong + !(fabs(l.area_m2 - area_m2) <= 1e-5);
    }
    return wrong;
}

/* An upright wall of 2 by 2 m from places in its plane, on it, behind it, beneath the ground, at 1 mm and at 1e9 m,
 * from 0.1 to 300 GHz: finite, and nothing from behind. */
static double places(void *user, bool quick)
{
    static const double corner[3][3] = {{2, 0, 0}, {0, 0, 0}, {0, 0, 2}};
    static const double from[][3] = {{1, 0, 1},      {1, 1e-9, 1},   {1, 1e-3, 1}, {40, 0, 1},
                                     {40, 1e-12, 1}, {1, -5, 1},     {1, 50, -20}, {1, 50, -1},
                                     {1, 1e9, 3},    {0, 1e-300, 0}, {1, 0, 1e6},  {1, 30, 1e-7}};
    double              wrong = 0;
    (void)user;
    for (int f = 0; f < (quick ? 2 : 8); f++)
        for (size_t n = 0; n < sizeof from / sizeof *from; n++) {
            Looks l = {.facade = {.row = &row, .surface = brick, .bumps = 9, .number = 1}};
            look_from(&l, from[n], 1e8 * pow(3000, f / 7.0));
            if (!(piece_plane(&l.facade.plane, corner) > 0)) return INFINITY;
            pieces_cut(&l.facade.plane, corner, (const double[2]){0.5, 0.5}, look_at_piece, &l);
            wrong += l.wrong + (from[n][1] < 0 && l.power_m2 != 0);
        }
    return wrong;
}

Status bench_stability_built(Bench *bench)
{
    static const StressCase cases[] = {
        {"walls to radar: no area, needles, level, upright, any", faces, 0, "values", "finite, areas"},
        {"walls to radar: in their plane, on, behind, beneath, far", places, 0, "values", "finite, 0 from behind"},
    };
    stress_cases(bench, cases, sizeof cases / sizeof *cases, NULL);
    return STATUS_OK;
}
