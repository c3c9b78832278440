/* tests/bench/render/precision_faces.c: unlit sides of a painted box against a path tracer. */
#include "tests/bench/suites.h"

#include "tests/bench/bench.h"
#include "tests/scenes/faces_box.h"

enum { sides = 2 };

/* Radiance of the box's two unlit sides, 115 and 155 degrees of azimuth from the sun, red, green, blue and nir, in
 * thousandths of the light on level ground (sun and sky, W/m2): Mitsuba 3.9.1 with the same sky by direction, sun,
 * ground, paint and rays, unlimited depth, standard error 0.3 % (tests/system/faces_judge.py, which made them). A sky
 * of another strength has the same share. */
static const struct {
    const char *what;
    FacesKind   kind;
    double      share[sides][faces_channels];
} boxes[] = {
    {"faces: unlit sides of a box, over grass, sun 45 degrees up",
     {"us1976", 23000, 45 * 0.017453292519943295769, 0.4, "grass_green", true},
     {{4.862, 9.919, 6.976, 47.15}, {4.141, 8.729, 6.329, 41.19}}},
    {"faces: unlit sides of a box, over dark soil, sun 70 degrees up",
     {"midlat_summer", 23000, 70 * 0.017453292519943295769, 0.4, "soil_plowed_dark", false},
     {{5.396, 8.296, 5.829, 28.04}, {4.896, 7.568, 5.406, 25.63}}},
    {"faces: unlit sides of a box, over concrete in haze, sun 20 degrees up",
     {"midlat_summer", 5000, 20 * 0.017453292519943295769, 0, "concrete", true},
     {{17.17, 27.28, 17.17, 66.22}, {16.24, 26.27, 16.87, 58.81}}},
    {"faces: unlit sides of a box, over snow in haze, sun 45 degrees up",
     {"us1976", 5000, 45 * 0.017453292519943295769, 0, "snow_coarse", false},
     {{22.75, 38.16, 25.32, 82.84}, {20.79, 35.68, 24.31, 72.02}}},
};

/* Mean over the pixels of an unlit side; NaN: there are fewer than 200. */
static double side_mean(const FacesBox *box, int side, const float *plane)
{
    static const double between[sides + 1] = {-0.2, -0.7, -1.1}; /* cosines of 115 and 155 degrees: -0.42, -0.91 */
    const Picture      *p = &box->w.picture;
    const double       *sun = box->light.sun_d_enu, level = hypot(sun[0], sun[1]);
    double              sum = 0;
    int                 count = 0;
    for (int i = 0; i < p->width * p->height; i++) {
        const double n[3] = {p->normal[0][i], p->normal[1][i], p->normal[2][i]};
        const double to_sun = (n[0] * sun[0] + n[1] * sun[1]) / level;
        if (p->entity[i] == 0 || n[2] > 0.5 || !(to_sun < between[side] && to_sun > between[side + 1])) continue;
        sum += (double)plane[i];
        count++;
    }
    return count >= 200 ? sum / count : NAN;
}

/* The largest error over sides and channels, %. */
static double worst_side(FacesBox *box, const double share[sides][faces_channels])
{
    double worst = 0;
    for (int infrared = 0; infrared < 2; infrared++) {
        if (!faces_box_see(box, 1, infrared, 0)) return INFINITY;
        for (int k = 0; k < (infrared ? 1 : 3); k++)
            for (int side = 0; side < sides; side++) {
                const int     c = infrared ? 3 : k;
                const AirBand band = faces_channel[c];
                const double  level = box->light.sun_w_m2[band] * box->light.sun_d_enu[2] + box->light.sky_w_m2[band];
                const double  want = 1e-3 * share[side][c] * level;
                bench_worse(&worst, 100 * (side_mean(box, side, box->w.picture.optical[k]) / want - 1));
            }
    }
    return fabs(worst);
}

Status bench_precision_faces(Bench *bench)
{
    static FacesBox box;
    Status          status = STATUS_OK;
    for (size_t k = 0; k < sizeof boxes / sizeof *boxes && status == STATUS_OK; k++) {
        bench_progress(bench, "faces");
        status = faces_box_open(&box, &boxes[k].kind, bench_threads(bench));
        if (status == STATUS_OK)
            bench_stress(bench, boxes[k].what, worst_side(&box, boxes[k].share), 5, "%",
                         "Mitsuba 3, unlimited depth: same sky, paint, rays; four channels");
        faces_box_close(&box);
    }
    if (status != STATUS_OK) log_error("bench: precision: faces: %s", status_name(status));
    return status;
}
