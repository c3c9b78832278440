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
#include "tests/scenes/faces_box.h"

#include <stdio.h>
#include <stdlib.h>

enum { sky_columns = 1024, sky_rows = 513, exact_samples = 256 };

static const char *name[faces_channels] = {"red", "green", "blue", "nir"};

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
    for (int c = 0; c < faces_channels; c++)
        for (int i = 0; i < sky_rows; i++) {
            const double zenith_rad = fmin(pi_rad * i / (sky_rows - 1), 0.5 * pi_rad);
            for (int k = 0; k < sky_columns; k++) {
                const double turn = 2 * pi_rad * (k + 0.5) / sky_columns,
                             d[3] = {sin(zenith_rad) * sin(turn), sin(zenith_rad) * cos(turn), cos(zenith_rad)};
                row[k] = (float)daylight_sky(light, faces_channel[c], d);
            }
            fwrite(row, sizeof row, 1, file);
        }
    fclose(file);
}

static void write_scene(const char *folder, const FacesBox *box)
{
    const Daylight *light = &box->light;
    FILE           *file = open_file(folder, "scene.txt");
    fprintf(file,
            "sky_size %d %d\nimage_size %d %d\nsun %.17g %.17g %.17g\nheading %.17g\nlift %.17g\ngloss %.9g %.9g\n",
            sky_columns, sky_rows, faces_width, faces_height, light->sun_d_enu[0], light->sun_d_enu[1],
            light->sun_d_enu[2], box->heading, box->lift_m, box->box_gloss[0], box->box_gloss[1]);
    for (int c = 0; c < faces_channels; c++)
        fprintf(file, "channel %s sun %.9g sky %.9g ground %.9g box %.9g\n", name[c], light->sun_w_m2[faces_channel[c]],
                light->sky_w_m2[faces_channel[c]], box->ground_rho[c], box->box_rho[c]);
    for (int v = 0; v < 2; v++) {
        const View *view = &box->view[v];
        fprintf(file, "view%d %.17g", v, view->focal_px);
        for (int k = 0; k < 3; k++) fprintf(file, " %.17g", view->p_enu[k] - (k == 2 ? box->ground_m : 0));
        for (int k = 0; k < 3; k++) fprintf(file, " %.17g", view->r_enu_from_cam[3 * k + 2]);
        fprintf(file, "\n");
    }
    fclose(file);
}

static bool see(const char *folder, FacesBox *box, int v, const char *file_name)
{
    enum { count = faces_width * faces_height };
    const View    *view = &box->view[v];
    const Picture *picture = &box->w.picture;
    FILE          *file = open_file(folder, file_name);
    bool           made = true;
    for (int exact = 0; exact < 2 && made; exact++)
        for (int infrared = 0; infrared < 2 && made; infrared++) {
            made = faces_box_see(box, v, infrared, exact ? exact_samples : 0);
            for (int c = 0; c < (infrared ? 1 : 3) && made; c++)
                fwrite(picture->optical[c], sizeof(float), count, file);
        }
    for (int c = 0; c < 3 && made; c++) fwrite(picture->normal[c], sizeof(float), count, file);
    for (int i = 0; i < count && made; i++) {
        const float entity = (float)picture->entity[i];
        fwrite(&entity, sizeof entity, 1, file);
    }
    for (int c = 0; c < 3 && made; c++)
        for (int i = 0; i < count; i++) {
            double d[3];
            view_ray(d, view, i % faces_width + 0.5, i / faces_width + 0.5);
            const float at =
                (float)(view->p_enu[c] - (c == 2 ? box->ground_m : 0) + (double)picture->range_m[i] * d[c]);
            fwrite(&at, sizeof at, 1, file);
        }
    fclose(file);
    return made;
}

int main(int argc, char **argv)
{
    static FacesBox box;
    FacesKind       kind;
    double          visibility_km, sun_deg;
    if (argc != 9 || !text_to_double(&visibility_km, argv[4]) || !text_to_double(&sun_deg, argv[5]) ||
        !text_to_double(&kind.lift_m, argv[6]))
        return fprintf(stderr,
                       "usage: faces_scene OUT nir|swir MODEL VISIBILITY_KM SUN_DEG LIFT_M GROUND glossy|matt\n"),
               2;
    kind.model = argv[3], kind.ground = argv[7], kind.glossy = strcmp(argv[8], "glossy") == 0;
    kind.visibility_m = 1e3 * visibility_km, kind.sun_rad = sun_deg * rad_per_deg;
    name[faces_channels - 1] = argv[2];
    Status                 status = channels_load();
    const SpectralChannel *infrared = channel_named(argv[2], strlen(argv[2]));
    if (status == STATUS_OK && !infrared) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) channel_choose(infrared);
    if (status == STATUS_OK) status = faces_box_open(&box, &kind, 2);
    if (status == STATUS_OK) {
        write_scene(argv[1], &box);
        write_sky(argv[1], &box.light);
    }
    for (int v = 0; v < 2 && status == STATUS_OK; v++)
        if (!see(argv[1], &box, v, v ? "view1" : "view0")) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) fprintf(stderr, "faces_scene: %s\n", status_name(status));
    faces_box_close(&box);
    return status != STATUS_OK;
}
