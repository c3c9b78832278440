/* tests/render/clutter_stage.h: ground clutter of one class, drawn and seen from an antenna far away. */
#ifndef TESTS_RENDER_CLUTTER_STAGE_H
#define TESTS_RENDER_CLUTTER_STAGE_H

#include "tests/check.h"

#include "render/scattering/clutter/clutter.h"

static const double ku_hz = 16e9, ka_hz = 35e9, c_mps = 299792458.0;

static ClutterTable table;

static inline int open_table(void **state)
{
    (void)state;
    char path[512];
    return etc_path(path, sizeof path, "radar/clutter.csv") && clutter_table_open(&table, path) == STATUS_OK ? 0 : -1;
}

/* Level ground of one class, scatterers drawn and arrays for a look at it. */
typedef struct Stage {
    ClutterGrid       grid;
    ClutterGround     ground;
    ClutterCell      *cell;
    uint8_t          *surface;
    double           *p[3];
    float            *n[3];
    ClutterScatterer *scatterer;
    ScatterMatrix    *seen;
} Stage;

static inline void *need(size_t count, size_t size)
{
    void *made = calloc(count, size);
    CHECK(made);
    return made;
}

static inline void stage_draw(Stage *s, ClutterBand band)
{
    clutter_draw(s->scatterer, &s->grid, &table, band, s->ground.count, s->cell, s->surface);
}

static inline Stage *stage(int count, SurfaceClass surface, double side_m, uint64_t seed)
{
    Stage *s = need(1, sizeof *s);
    s->grid = (ClutterGrid){side_m, seed};
    s->cell = need((size_t)count, sizeof *s->cell);
    s->surface = need((size_t)count, sizeof *s->surface);
    s->scatterer = need((size_t)count, sizeof *s->scatterer);
    s->seen = need((size_t)count, sizeof *s->seen);
    memset(s->surface, surface, (size_t)count);
    for (int a = 0; a < 3; a++) {
        s->p[a] = need((size_t)count, sizeof *s->p[a]);
        s->n[a] = need((size_t)count, sizeof *s->n[a]);
    }
    for (int i = 0; i < count; i++) s->n[2][i] = 1;
    s->ground = (ClutterGround){count, s->cell, s->surface, {s->p[0], s->p[1], s->p[2]}, {s->n[0], s->n[1], s->n[2]}};
    return s;
}

static inline void stage_place(Stage *s)
{
    for (int i = 0; i < s->ground.count; i++) {
        double p_m[2];
        clutter_place(p_m, &s->grid, &s->cell[i]);
        s->p[0][i] = p_m[0], s->p[1][i] = p_m[1];
    }
}

static inline void stage_free(Stage *s)
{
    for (int a = 0; a < 3; a++) free(s->p[a]), free(s->n[a]);
    free(s->cell), free(s->surface), free(s->scatterer), free(s->seen), free(s);
}

/* Far away, at an azimuth from north and a grazing angle. */
static inline ClutterLook look_from(double azimuth_rad, double grazing_rad, double frequency_hz)
{
    static const double far_m = 1e7;
    const double        level_m = far_m * cos(grazing_rad);
    return (ClutterLook){
        .antenna_enu = {level_m * sin(azimuth_rad), level_m * cos(azimuth_rad), far_m * sin(grazing_rad)},
        .frequency_hz = frequency_hz};
}

static inline void see(Stage *s, const ClutterLook *look)
{
    clutter_see(s->seen, &s->grid, &table, s->scatterer, &s->ground, look);
}

static inline double power(double complex z) { return creal(z) * creal(z) + cimag(z) * cimag(z); }

#endif
