/* tests/entities/flight_fixture.h: missiles made by hand, and a place to fly them. */
#ifndef TESTS_ENTITIES_FLIGHT_FIXTURE_H
#define TESTS_ENTITIES_FLIGHT_FIXTURE_H

#include "tests/check.h"

#include "entities/flight/engagement.h"
#include "terrain/earth/geodesy.h"

/* 100 kg without motor or drag, whose wings lift whatever is asked at no angle of attack: speed stays what it is. */
static inline Missile ideal_missile(void)
{
    return (Missile){.name = "ideal",
                     .guidance = MISSILE_PN,
                     .mass_kg = 100,
                     .area_m2 = 0.1,
                     .lift_slope = 1e15,
                     .most_attack_rad = 1,
                     .most_lateral_mps2 = 1e9,
                     .lag_s = 0.5,
                     .gain = 4,
                     .gimbal_rad = 3,
                     .gimbal_rate_rps = 1e6,
                     .field_rad = 6.3,
                     .memory_s = 1,
                     .life_s = 100};
}

/* No gravity, axes that stand: paths are straight. */
static inline FlightWorld empty_world(void)
{
    FlightWorld w = flight_world();
    w.gravity = w.turning = 0;
    return w;
}

static inline LocalFrame place_at(double lat_deg, double lon_deg, double h_m)
{
    LocalFrame     frame;
    const Geodetic origin = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, h_m};
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    return frame;
}

static inline void to_ecef(double out[3], const LocalFrame *frame, double e, double n, double u)
{
    const double enu[3] = {e, n, u};
    m3_mul_v3(out, frame->r_ecef_from_enu, enu);
}

static inline void row_of_etc(Missile *out, const char *name)
{
    char path[1024];
    CHECK(etc_path(path, sizeof path, "missiles.csv"));
    CHECK(missile_read(out, path, name) == STATUS_OK);
}

/* Writes the table of etc/ with one cell changed. */
static inline void missiles_but(char copy[text_file_size], const char *row, const char *column, const char *value)
{
    char  path[1024], *text = NULL;
    Table t;
    CHECK(etc_path(path, sizeof path, "missiles.csv") && table_open(&t, path) == STATUS_OK);
    size_t octets;
    FILE  *to = open_memstream(&text, &octets);
    for (int r = -1; r < t.rows; r++)
        for (int c = 0; c < t.columns; c++) {
            const bool here = r >= 0 && strcmp(table_text(&t, r, 0), row) == 0 && c == table_column(&t, column);
            fprintf(to, "\"%s\"%c", here ? value : table_text(&t, r, c), c + 1 < t.columns ? ',' : '\n');
        }
    fclose(to);
    table_close(&t);
    text_file(copy, text);
    free(text);
}

/* From frame's origin at the speed of the row, towards azimuth and elevation; the target by ENU. */
static inline Engagement engagement_of(const LocalFrame *frame, const Missile *m, double azimuth_deg,
                                       double elevation_deg, const double target_enu[3], const double v_enu[3],
                                       const double a_enu[3])
{
    Engagement   e = {.target = true, .ranged = true, .until_s = INFINITY};
    const double az = azimuth_deg * rad_per_deg, el = elevation_deg * rad_per_deg, v = m->launch_mps;
    memcpy(e.p_ecef, frame->origin_ecef, sizeof e.p_ecef);
    to_ecef(e.v_ecef_mps, frame, v * sin(az) * cos(el), v * cos(az) * cos(el), v * sin(el));
    ecef_from_enu(e.target_ecef, frame, target_enu);
    m3_mul_v3(e.target_v_ecef_mps, frame->r_ecef_from_enu, v_enu);
    m3_mul_v3(e.target_a_ecef_mps2, frame->r_ecef_from_enu, a_enu);
    return e;
}

#endif
