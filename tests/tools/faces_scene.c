/* faces_scene OUT INFRARED MODEL VISIBILITY_KM SUN_DEG LIFT_M GROUND PAINT: a painted box of 4 x 2 x 1.5 m over flat
 * diffuse ground under the sun and the sky of an atmosphere, seen by Pitviper without air before it, with everything
 * that another renderer needs to see the same: tests/system/faces_judge.py.
 *
 * INFRARED: nir or swir, beside red, green, blue. LIFT_M: of the box over the ground. GROUND: a material. PAINT: glossy
 * or matt. Files of OUT, float32: sky    [channels][sky_rows][sky_columns]: radiance that lights the scene, rows from
 * the zenith to the nadir, nodes at both; columns clockwise from north, at their middles; below the horizontal the
 * horizontal's view0, view1 from the sun's side and from the other: [channels][height][width] with contact shadows, the
 * same by hemisphere sampling, then normals [3], entity, places [3] and scene.txt: names and numbers of the light, the
 * surfaces and the cameras. */
#include "render/air/air_private.h"
#include "tests/scenes/stress_world.h"

#include <stdio.h>
#include <stdlib.h>

enum { sky_columns = 1024, sky_rows = 513, width = 160, height = 108, exact_samples = 256, channels = 4 };

static const AirBand channel[channels] = {AIR_R, AIR_G, AIR_B, AIR_NIR};
static const char   *name[channels] = {"red", "green", "blue", "nir"};
static double        ground_rho[channels], box_rho[channels], box_gloss[2]; /* share and roughness */
static const double  sun_turn_rad = 2.2;                           /* of the sun's azimuth, clockwise from north */
static const double  face_turn_rad = 25 * 0.017453292519943295769; /* of a lit face's normal from it */

static FILE *open_file(const char *folder, const char *file_name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, file_name);
    FILE *file = fopen(path, "wb");
    if (!file) log_error("faces_scene: cannot write %s", path), exit(1);
    return file;
}

static void write_sky(const char *folder, const Daylight *light)
{
    static float row[sky_columns];
    FILE        *file = open_file(folder, "sky");
    for (int c = 0; c < channels; c++)
        for (int i = 0; i < sky_rows; i++) {
            const double zenith_rad = fmin(pi_rad * i / (sky_rows - 1), 0.5 * pi_rad);
            for (int k = 0; k < sky_columns; k++) {
                const double turn = 2 * pi_rad * (k + 0.5) / sky_columns,
                             d[3] = {sin(zenith_rad) * sin(turn), sin(zenith_rad) * cos(turn), cos(zenith_rad)};
                row[k] = (float)daylight_sky(light, channel[c], d);
            }
            fwrite(row, sizeof row, 1, file);
        }
    fclose(file);
}

static void write_scene(const char *folder, const Daylight *light, const View view[2], double lift_m, double heading,
                        double ground_m)
{
    FILE *file = open_file(folder, "scene.txt");
    fprintf(file,
            "sky_size %d %d\nimage_size %d %d\nsun %.17g %.17g %.17g\nheading %.17g\nlift %.17g\ngloss %.9g %.9g\n",
            sky_columns, sky_rows, width, height, light->sun_d_enu[0], light->sun_d_enu[1], light->sun_d_enu[2],
            heading, lift_m, box_gloss[0], box_gloss[1]);
    for (int c = 0; c < channels; c++)
        fprintf(file, "channel %s sun %.9g sky %.9g ground %.9g box %.9g\n", name[c], light->sun_w_m2[channel[c]],
                light->sky_w_m2[channel[c]], ground_rho[c], box_rho[c]);
    for (int v = 0; v < 2; v++) {
        fprintf(file, "view%d %.17g", v, view[v].focal_px);
        for (int k = 0; k < 3; k++) fprintf(file, " %.17g", view[v].p_enu[k] - (k == 2 ? ground_m : 0));
        for (int k = 0; k < 3; k++) fprintf(file, " %.17g", view[v].r_enu_from_cam[3 * k + 2]);
        fprintf(file, "\n");
    }
    fclose(file);
}

/* Paint on the box, as it is or without its gloss; ground of one class, diffuse. The mean of the land, which lights
 * from farther off, stays. */
static void make_surfaces(Materials *m, const char *ground, bool glossy)
{
    Material paint = m->material[materials_find(m, "paint_olive_flat")];
    Material soil = m->material[materials_find(m, ground)];
    soil.gloss = 0;
    if (!glossy) paint.gloss = 0;
    for (int k = 0; k < m->count; k++) m->material[k] = paint;
    for (int k = 0; k < SURFACE_COUNT; k++) m->material[m->surface[k]] = soil;
    for (int c = 0; c < channels; c++)
        ground_rho[c] = (double)soil.rho[channel[c]], box_rho[c] = (double)paint.rho[channel[c]];
    box_gloss[0] = (double)paint.gloss, box_gloss[1] = (double)paint.roughness;
}

static Status see(const char *folder, StressWorld *w, const View *view, double ground_m, const char *file_name)
{
    FILE  *file = open_file(folder, file_name);
    Status status = STATUS_OK;
    for (int exact = 0; exact < 2 && status == STATUS_OK; exact++)
        for (int nir = 0; nir < 2 && status == STATUS_OK; nir++) {
            const RenderRequest request = {.view = *view,
                                           .bands = 1 << BAND_OPTICAL,
                                           .truth = true,
                                           .optical = nir ? OPTICAL_NIR : OPTICAL_RGB,
                                           .samples = 1,
                                           .sky_samples = exact ? exact_samples : 0,
                                           .sky_visibility = true,
                                           .hidden_entity = -1};
            if (!stress_render(w, &request)) status = STATUS_NO_MEMORY;
            for (int c = 0; c < (nir ? 1 : 3) && status == STATUS_OK; c++)
                fwrite(w->picture.optical[c], sizeof(float), width * height, file);
        }
    for (int c = 0; c < 3 && status == STATUS_OK; c++)
        fwrite(w->picture.normal[c], sizeof(float), width * height, file);
    for (int i = 0; i < width * height && status == STATUS_OK; i++) {
        const float entity = (float)w->picture.entity[i];
        fwrite(&entity, sizeof entity, 1, file);
    }
    for (int c = 0; c < 3 && status == STATUS_OK; c++)
        for (int i = 0; i < width * height; i++) {
            double d[3];
            view_ray(d, view, i % width + 0.5, i / width + 0.5);
            const float at = (float)(view->p_enu[c] - (c == 2 ? ground_m : 0) + (double)w->picture.range_m[i] * d[c]);
            fwrite(&at, sizeof at, 1, file);
        }
    fclose(file);
    return status;
}

int main(int argc, char **argv)
{
    StressWorld w = {0};
    double      visibility_km, sun_rad, lift_m;
    if (argc != 9 || !text_to_double(&visibility_km, argv[4]) || !text_to_double(&sun_rad, argv[5]) ||
        !text_to_double(&lift_m, argv[6]))
        return fprintf(stderr,
                       "usage: faces_scene OUT nir|swir MODEL VISIBILITY_KM SUN_DEG LIFT_M GROUND glossy|matt\n"),
               2;
    sun_rad *= rad_per_deg;
    name[channels - 1] = argv[2];
    Status                 status = channels_load();
    const SpectralChannel *infrared = channel_named(argv[2], strlen(argv[2]));
    if (status == STATUS_OK && !infrared) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) channel_choose(infrared);
    if (status == STATUS_OK) status = stress_world_open(&w, 2);
    if (status == STATUS_OK) {
        atmosphere_close(w.world.atmosphere);
        w.world.atmosphere = NULL;
        status = atmosphere_open(&w.world.atmosphere, argv[3]);
    }
    if (status == STATUS_OK) {
        static Daylight light;
        w.world.landscape = &w.landscape;
        detail_table_close(w.world.detail);
        w.world.detail = NULL;
        make_surfaces(&w.world.materials, argv[7], strcmp(argv[8], "glossy") == 0);
        const double    heading = sun_turn_rad + face_turn_rad, c = cos(heading), s = sin(heading);
        const double    r_enu_from_body[9] = {s, c, 0, c, -s, 0, 0, 0, -1}, middle_body[3] = {0, -1, -0.75};
        const double    ground_m = elevation_height(&w.landscape.elevation, 0, 0, NULL);
        double          p_enu[3];
        const AirSource source = world_air_source(&w.world, 0);
        Weather         weather = weather_default();
        const Sun       sun = {.elevation_rad = sun_rad,
                               .distance_au = 1,
                               .d_enu = {cos(sun_rad) * sin(sun_turn_rad), cos(sun_rad) * cos(sun_turn_rad), sin(sun_rad)}};
        const double    dark[AIR_BAND_COUNT] = {0};
        m3_mul_v3(p_enu, r_enu_from_body, middle_body);
        p_enu[2] += ground_m + lift_m;
        stress_add(&w, p_enu, r_enu_from_body);
        weather.visibility_m = 1e3 * visibility_km;
        weather.air_temp_k = NAN;
        air_even(&w.air, sun.d_enu, 0, dark, 0, w.world.planck_mwir, w.world.planck_lwir);
        status =
            daylight_by_direction(&light, &source, &weather, &sun, (1u << AIR_BAND_COUNT) - 1, w.pool, w.air_arena);
        w.air.light = light;
        View view[2];
        for (int v = 0; v < 2; v++) {
            const double turn = sun_turn_rad - 20 * rad_per_deg + v * pi_rad;
            const double eye[3] = {14 * sin(turn), 14 * cos(turn), ground_m + 6},
                         d[3] = {-eye[0], -eye[1], 0.7 + lift_m - 6};
            view[v] = stress_view(eye, d, 0, width, height, 340);
        }
        if (status == STATUS_OK) {
            write_scene(argv[1], &light, view, lift_m, heading, ground_m);
            write_sky(argv[1], &light);
        }
        for (int v = 0; v < 2 && status == STATUS_OK; v++)
            status = see(argv[1], &w, &view[v], ground_m, v ? "view1" : "view0");
    }
    if (status != STATUS_OK) fprintf(stderr, "faces_scene: %s\n", status_name(status));
    stress_world_close(&w);
    return status != STATUS_OK;
}
